//! Playing the animations of a file.

use std::collections::BTreeSet;
use std::sync::Arc;

use umbrae_core::Scene;

use crate::error::quoted;
use crate::gltf::Rig;
use crate::warnings::Words;
use crate::{Model, Warning};

/// What is said of a model that was loaded and not played.
pub(crate) const NOT_PLAYED: Words = [
    "animation is not played: the model is at rest; use --time SECONDS to see it at a moment",
    "animations are not played: the model is at rest; use --time SECONDS to see it at a moment",
];

/// The animations of a file; none for formats that have none.
///
/// Cheap to clone.
///
/// ```
/// use umbrae_formats::{Format, LoadOptions, load_bytes};
///
/// let still = load_bytes(b"v 0 0 0\nv 4 0 0\nv 4 3 0\nf 1 2 3\n", Format::Obj, "wall.obj", None, &LoadOptions::default())?;
/// assert_eq!(still.animations.iter().count(), 0);
/// # Ok::<(), umbrae_formats::LoadError>(())
/// ```
#[derive(Debug, Clone, Default)]
pub struct Animations(Option<Arc<Rig>>);

/// An animation of a file.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Animation<'a> {
    /// As in the file, or "animation 3" (from 0) for one without a name; two may share one.
    pub name: &'a str,
    /// The time of its last key; nothing moves after it.
    pub duration_s: f64,
}

/// Animations that are played together.
#[derive(Debug, Clone, PartialEq)]
pub struct Playing {
    clips: Vec<usize>,
    duration_s: f64,
    note: Option<Warning>,
}

/// Why an animation can't be played.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum AnimationError {
    /// No animation has that name.
    #[error("there is no animation {}; {}", quoted(name), have(names))]
    NoSuchName {
        /// The name.
        name: String,
        /// Those that there are.
        names: Vec<String>,
    },
    /// The time is not a number.
    #[error("a model can't be shown at {time_s} s")]
    BadTime {
        /// What was asked for.
        time_s: f64,
    },
    /// The scene has not the objects, cameras or lights that are moved.
    #[error("the scene lacks what its animations move; play them before it is joined with others or taken apart")]
    OtherScene,
}

fn have(names: &[String]) -> String {
    match names {
        [] => "the model has none".to_owned(),
        names => format!("the model has {}", names.iter().map(|name| quoted(name)).collect::<Vec<_>>().join(", ")),
    }
}

impl Animations {
    pub(crate) fn new(rig: Option<Rig>) -> Self {
        Self(rig.map(Arc::new))
    }

    /// The animations, in the order of the file.
    pub fn iter(&self) -> impl Iterator<Item = Animation<'_>> {
        let clips = self.0.iter().flat_map(|rig| &rig.clips);
        clips.map(|clip| Animation { name: &clip.name, duration_s: clip.duration_s })
    }

    /// Whether the file has none.
    pub fn is_empty(&self) -> bool {
        self.0.is_none()
    }

    /// What is played when `name` is asked for, the first if several have it; or when nothing is asked for: all animations together, if no
    /// two of them move the same thing, else only the first that moves anything, and [`Playing::note`] says so.
    ///
    /// # Errors
    ///
    /// [`AnimationError::NoSuchName`].
    pub fn choose(&self, name: Option<&str>) -> Result<Playing, AnimationError> {
        let Some(name) = name else { return Ok(self.usual()) };
        let named = self.iter().position(|animation| animation.name == name);
        let names = || self.iter().map(|animation| animation.name.to_owned()).collect();
        let named = named.ok_or_else(|| AnimationError::NoSuchName { name: name.to_owned(), names: names() })?;
        Ok(self.playing(vec![named]))
    }

    fn usual(&self) -> Playing {
        let clips = self.0.as_ref().map_or(&[][..], |rig| &rig.clips);
        let moving: Vec<usize> = (0..clips.len()).filter(|&clip| !clips[clip].channels.is_empty()).collect();
        let mut moved = BTreeSet::new();
        let channels = moving.iter().flat_map(|&clip| &clips[clip].channels);
        if channels.into_iter().all(|channel| moved.insert((channel.node, channel.path))) {
            return self.playing(moving);
        }
        let names: Vec<String> = moving.iter().map(|&clip| quoted(&clips[clip].name)).collect();
        let message = format!(
            "animations move the same things, so only the first is played; choose with --animation NAME ({})",
            names.join(", ")
        );
        let note = Some(Warning { message, count: names.len() });
        Playing { note, ..self.playing(moving[..1].to_vec()) }
    }

    fn playing(&self, clips: Vec<usize>) -> Playing {
        let duration_s =
            self.0.iter().flat_map(|rig| clips.iter().map(|&clip| rig.clips[clip].duration_s)).fold(0.0, f64::max);
        Playing { clips, duration_s, note: None }
    }

    /// Shows `scene`, which must be the one that was loaded with these animations, as it is `time_s` seconds into them.
    ///
    /// Depends on nothing but its arguments: transforms, poses, cameras and lights that any animation of the file moves are set from rest,
    /// whatever was shown before, and nothing else is touched. Before the first key of a channel its value holds, and after the last one
    /// that one's; nothing loops. What can't be where its animation puts it (too far away, or nowhere) is at rest, and a warning says so.
    ///
    /// Linear in the number of nodes that move, and of their joints; looks at no vertex.
    ///
    /// # Errors
    ///
    /// [`AnimationError::BadTime`] if the time is not finite, [`AnimationError::OtherScene`] if `scene` has fewer objects, cameras or lights
    /// than are moved; then nothing is changed.
    pub fn pose(&self, scene: &mut Scene, playing: &Playing, time_s: f64) -> Result<Vec<Warning>, AnimationError> {
        if !time_s.is_finite() {
            return Err(AnimationError::BadTime { time_s });
        }
        let Some(rig) = &self.0 else { return Ok(Vec::new()) };
        rig.pose(scene, &playing.clips, time_s).ok_or(AnimationError::OtherScene)
    }
}

impl Playing {
    /// The time of the last key of all.
    pub fn duration_s(&self) -> f64 {
        self.duration_s
    }

    /// What a user who did not choose should know: that there was a choice.
    pub fn note(&self) -> Option<&Warning> {
        self.note.as_ref()
    }
}

impl Model {
    /// Shows the model as it is `time_s` seconds into the animation that is called `animation`, or those that [`Animations::choose`] says.
    ///
    /// The warnings then say what happened, and no longer that nothing is played. A model without animations stays as it is. See
    /// [`Animations::pose`], which does the same again and again for less.
    ///
    /// ```
    /// use umbrae_core::Caster;
    /// use umbrae_formats::{LoadOptions, load};
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// # let path = std::path::Path::new("../../../shared/data/gltf/BoxAnimated.glb");
    /// # if !path.exists() { return Ok(()) }
    /// let mut model = load(path, &LoadOptions::default())?;
    /// model.play(None, 1.5)?;
    /// let mut casters = Caster::of_scene(&model.scene);
    ///
    /// // Another moment, with the same topology.
    /// let playing = model.animations.choose(None)?;
    /// model.animations.pose(&mut model.scene, &playing, 2.0)?;
    /// for (caster, object) in casters.iter_mut().zip(&model.scene.objects) {
    ///     caster.pose_to(object);
    /// }
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    ///
    /// Those of [`Animations::choose`] and [`Animations::pose`]; then nothing is changed.
    pub fn play(&mut self, animation: Option<&str>, time_s: f64) -> Result<(), AnimationError> {
        let playing = self.animations.choose(animation)?;
        let posed = self.animations.pose(&mut self.scene, &playing, time_s)?;
        self.warnings.retain(|warning| !NOT_PLAYED.contains(&warning.message.as_str()));
        self.warnings.extend(playing.note);
        self.warnings.extend(posed);
        Ok(())
    }
}
