//! Where shadows fall over a period: the outlines of its instants, and what any of them covers.
//!
//! After G. Wallner 2007, section 8 (his figures 5 to 7), who draws such profiles from the stencil buffer; here they are polygons.
//!
//! A profile is a union of instants. Between two of them a shadow sweeps over more than both: the finer the steps, the closer the union comes to what was in
//! shadow at any time.

use std::ops::ControlFlow;

use glam::DVec3;
use rayon::prelude::*;

use crate::{Outline, Projection};

/// The shadows of a period on one plane.
///
/// Keeps one outline for each instant and a few for each object; those of each object at each instant are gone when they are added.
///
/// ```
/// use glam::DVec2;
/// use umbrae_study::{Outline, Profile};
///
/// // One object, whose shadow of ten by ten metres moves by five.
/// let shadow = |x: f64| Outline::rectangle(DVec2::new(x, 0.0), DVec2::new(x + 10.0, 10.0));
/// let mut profile = Profile::new(1);
/// profile.add(36, &[shadow(0.0)]);
/// profile.add(37, &[shadow(5.0)]);
/// assert_eq!(profile.period().area_m2(), 150.0);
/// assert_eq!(profile.moments()[1].outline.area_m2(), 100.0);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Profile {
    moments: Vec<Moment>,
    period: Merger,
    objects: Vec<Merger>,
}

/// The shadows of one moment.
#[derive(Debug, Clone, PartialEq)]
pub struct Moment {
    /// Index into [`crate::Timetable::steps`].
    pub step: usize,
    /// What any object's shadow covers.
    pub outline: Outline,
}

impl Profile {
    /// Nothing yet, of `object_count` objects.
    pub fn new(object_count: usize) -> Self {
        Self { moments: Vec::new(), period: Merger::default(), objects: vec![Merger::default(); object_count] }
    }

    /// The profile of what `projection` casts under `suns`, the direction towards the sun for each step of a timetable and `None` at night.
    ///
    /// Works on as many instants at a time as there are threads in rayon's pool. After each, in order, `visit` is told the step, the shadow of each object,
    /// and that of all; where it breaks, the profile is of the instants so far.
    pub fn cast(
        projection: &Projection<'_>,
        suns: &[Option<DVec3>],
        mut visit: impl FnMut(usize, &[Outline], &Outline) -> ControlFlow<()>,
    ) -> Self {
        let mut profile = Self::new(projection.len());
        let days: Vec<(usize, DVec3)> = suns.iter().enumerate().filter_map(|(step, &sun)| Some((step, sun?))).collect();
        for some in days.chunks(rayon::current_num_threads()) {
            let shadows: Vec<_> = some.par_iter().map(|&(_, to_sun)| projection.outlines(to_sun)).collect();
            for (&(step, _), shadows) in some.iter().zip(shadows) {
                let Some(shadows) = shadows else { continue };
                let all = profile.add(step, &shadows);
                if visit(step, &shadows, all).is_break() {
                    return profile;
                }
            }
        }
        profile
    }

    /// Adds the moment of step `step`, at which each object has its one of `shadows`; gives back what all of them cover.
    ///
    /// # Panics
    ///
    /// If there is not one shadow for each object.
    pub fn add(&mut self, step: usize, shadows: &[Outline]) -> &Outline {
        assert_eq!(shadows.len(), self.objects.len(), "each object has one shadow");
        let outline = Outline::union(shadows);
        self.period.add(outline.clone());
        self.objects.par_iter_mut().zip(shadows).for_each(|(object, shadow)| object.add(shadow.clone()));
        self.moments.push(Moment { step, outline });
        &self.moments[self.moments.len() - 1].outline
    }

    /// The moments, in the order in which they were added.
    pub fn moments(&self) -> &[Moment] {
        &self.moments
    }

    /// What was in shadow at any of the moments. Takes a union of a few large outlines.
    pub fn period(&self) -> Outline {
        self.period.merged()
    }

    /// What object `index` alone shaded at any of the moments, whatever the others did.
    ///
    /// # Panics
    ///
    /// If there is no such object.
    pub fn object(&self, index: usize) -> Outline {
        self.objects[index].merged()
    }

    /// How many objects there are.
    pub fn object_count(&self) -> usize {
        self.objects.len()
    }
}

/// A union that grows: each outline is united with others that stand for as many as it does, so that of n outlines none goes through more than log n unions.
#[derive(Debug, Clone, PartialEq, Default)]
struct Merger {
    /// Each with how many it stands for, powers of two, falling.
    parts: Vec<(usize, Outline)>,
}

impl Merger {
    fn add(&mut self, outline: Outline) {
        let mut last = (1, outline);
        while let Some((_, part)) = self.parts.pop_if(|(count, _)| *count == last.0) {
            last = (2 * last.0, Outline::union([&part, &last.1]));
        }
        self.parts.push(last);
    }

    fn merged(&self) -> Outline {
        Outline::union(self.parts.iter().map(|(_, outline)| outline))
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use glam::{DAffine3, DVec2, Vec3};
    use umbrae_core::{Caster, Mesh, Object, Topology, shapes};

    use super::*;

    fn boxes(places: &[[f32; 2]]) -> Vec<Caster> {
        let caster = |&[x, y]: &[f32; 2]| {
            let surface = shapes::cuboid(Vec3::new(x, y, 0.0), Vec3::new(x + 10.0, y + 10.0, 20.0));
            let mesh = Arc::new(Mesh::new(surface).expect("a box"));
            let topology = Arc::new(Topology::new(&mesh));
            Caster::new(&Object::new("box", mesh, DAffine3::IDENTITY), topology)
        };
        places.iter().map(caster).collect()
    }

    /// From the south, rising.
    fn suns(count: usize) -> Vec<Option<DVec3>> {
        let sun = |i| DVec3::new(i as f64 / 4.0, -1.0, 1.0 + i as f64 / 8.0);
        (0..count).map(|i| (i % 5 != 4).then(|| sun(i))).collect()
    }

    #[test]
    fn a_period_covers_a_point_exactly_if_some_instant_does() {
        let casters = boxes(&[[0.0, 0.0], [30.0, 5.0], [5.0, 5.0]]);
        let projection = Projection::new(&casters, 0.0);
        let profile = Profile::cast(&projection, &suns(11), |_, _, _| ControlFlow::Continue(()));
        let steps: Vec<usize> = profile.moments().iter().map(|moment| moment.step).collect();
        assert_eq!(steps, [0, 1, 2, 3, 5, 6, 7, 8, 10], "nights are left out");
        let period = profile.period();
        let objects: Vec<Outline> = (0..3).map(|i| profile.object(i)).collect();
        for i in 0..2000 {
            let p = DVec2::new(
                (f64::from(i) * 0.618_034).fract() * 80.0 - 30.0,
                (f64::from(i) * 0.7548).fract() * 60.0 - 10.0,
            );
            let is_covered = profile.moments().iter().any(|moment| moment.outline.contains(p));
            assert_eq!(period.contains(p), is_covered, "{p}");
            assert_eq!(objects.iter().any(|object| object.contains(p)), is_covered, "{p}");
        }
    }

    #[test]
    fn an_object_s_profile_is_the_same_with_and_without_others() {
        let all = boxes(&[[0.0, 0.0], [8.0, 3.0]]);
        let go_on = |_: usize, _: &[Outline], _: &Outline| ControlFlow::Continue(());
        let together = Profile::cast(&Projection::new(&all, 0.0), &suns(4), go_on);
        let alone = Profile::cast(&Projection::new(&all[1..], 0.0), &suns(4), go_on);
        assert_eq!(together.object(1), alone.object(0));
        assert_eq!(alone.object(0), alone.period());
    }

    #[test]
    fn breaking_off_leaves_the_profile_of_the_instants_so_far() {
        let casters = boxes(&[[0.0, 0.0]]);
        let projection = Projection::new(&casters, 0.0);
        let broken = Profile::cast(&projection, &suns(11), |step, shadows, all| {
            assert_eq!(shadows, std::slice::from_ref(all));
            if step == 2 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        });
        assert_eq!(broken, Profile::cast(&projection, &suns(3), |_, _, _| ControlFlow::Continue(())));
    }
}
