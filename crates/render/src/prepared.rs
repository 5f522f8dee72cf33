//! The lights of a frame, wherever their silhouettes are found.

use std::sync::{Mutex, MutexGuard, PoisonError};

use umbrae_core::{Extent, Light};

use crate::frame::{FrameLight, Passes, Shadowing};
use crate::shadow::ShadowView;
use crate::soft::{SoftLight, SoftPass};
use crate::{FoundShadows, Gpu, GpuError, LightReport, ShadowLight, Shot, SilhouetteSource, Smooth, Targets};

/// What finds the silhouettes of one scene on the GPU, made when it is first asked for, and kept.
#[derive(Debug, Default)]
pub(crate) struct KeptFinder(Mutex<Option<(KeptFor, FoundShadows)>>);

/// What decides what is found: the source, the samples of the passes that draw it, and the bodies that were given.
type KeptFor = (SilhouetteSource, u32, u64);

/// The lights of one frame, from when they are prepared until they are submitted.
#[derive(Debug)]
pub(crate) struct PreparedLights<'a> {
    /// For each light, if it is drawn soft; the others are the hard ones, in order.
    soft: Vec<Option<SoftLight>>,
    hard: HardLights<'a>,
}

#[derive(Debug)]
enum HardLights<'a> {
    Own(Vec<ShadowLight>),
    /// Nobody else may plan before this frame is submitted.
    Found(MutexGuard<'a, Option<(KeptFor, FoundShadows)>>),
}

impl<'a> PreparedLights<'a> {
    /// `lights` with the casters and options of `shot`, to be drawn by `passes` as `view` sees them.
    ///
    /// # Errors
    ///
    /// [`GpuError::TooLarge`], [`GpuError::NoSilhouettes`].
    pub(crate) fn new(
        gpu: &Gpu,
        passes: &Passes,
        shot: &Shot<'a>,
        view: &ShadowView,
        lights: &[Light],
    ) -> Result<Self, GpuError> {
        let (casters, uploaded, options) = (shot.casters, &shot.scene.shadow_casters, &shot.shadows);
        let is_soft = |light: &Light| options.soft && light.extent != Extent::Point;
        let soft = |light: &Light| {
            let soft = passes.soft.get_or_init(|| SoftPass::new(gpu, passes.shadows.samples()));
            is_soft(light).then(|| soft.light(gpu, casters, uploaded, view, light, options)).transpose()
        };
        let soft = lights.iter().map(|light| if is_soft(light) { soft(light) } else { Ok(None) });
        let soft = soft.collect::<Result<_, _>>()?;
        let lights = lights.iter().filter(|light| !is_soft(light));
        let shadows = &passes.shadows;
        let source = options.silhouettes;
        let is_on_cpu = match source {
            SilhouetteSource::Auto | SilhouetteSource::Cpu(_) => true,
            // Textures hold no smooth silhouettes.
            SilhouetteSource::GpuBasic => options.smooth != Smooth::Off,
            SilhouetteSource::Gpu => false,
        };
        if is_on_cpu {
            let own = lights.map(|light| shadows.light(gpu, casters, uploaded, view, light, options));
            return Ok(Self { soft, hard: HardLights::Own(own.collect::<Result<_, _>>()?) });
        }
        // What is kept is planned anew in each frame, so that a panic in another leaves nothing wrong in it.
        let mut kept = shot.scene.finder.0.lock().unwrap_or_else(PoisonError::into_inner);
        let kept_for = (source, shadows.samples(), uploaded.bodies_given());
        if kept.as_ref().is_none_or(|(other, _)| *other != kept_for) {
            *kept = Some((kept_for, shadows.finder(gpu, casters, uploaded, source)?));
        }
        if let Some((_, found)) = &mut *kept {
            let lights: Vec<Light> = lights.cloned().collect();
            shadows.compile_found(gpu, source, found);
            found.plan(gpu, casters, uploaded, view, &lights, options);
            found.upload(gpu)?;
        }
        Ok(Self { soft, hard: HardLights::Found(kept) })
    }

    /// What must be recorded before any light is drawn.
    pub(crate) fn found(&self) -> Option<&FoundShadows> {
        match &self.hard {
            HardLights::Own(_) => None,
            HardLights::Found(kept) => kept.as_ref().map(|(_, found)| found),
        }
    }

    /// For the frame, with the names of `lights`; `targets` are made ready for them.
    ///
    /// # Errors
    ///
    /// [`GpuError::PictureTooLarge`], [`GpuError::NoSoftSamples`].
    pub(crate) fn for_frame<'b>(
        &'b self,
        gpu: &Gpu,
        lights: &'b [Light],
        targets: &Targets,
    ) -> Result<Vec<FrameLight<'b>>, GpuError> {
        let mut hard = self.hard();
        if self.hard().any(ShadowLight::needs_sums) {
            targets.make_sums(gpu)?;
        }
        if self.soft.iter().any(Option::is_some) {
            targets.make_soft(gpu)?;
        }
        let shadows = |soft: &'b Option<SoftLight>| match soft {
            Some(soft) => Some(Shadowing::Soft(soft)),
            None => hard.next().map(Shadowing::Hard),
        };
        let shadows = self.soft.iter().filter_map(shadows);
        Ok(lights.iter().zip(shadows).map(|(light, shadows)| FrameLight { name: &light.name, shadows }).collect())
    }

    fn hard(&self) -> Box<dyn Iterator<Item = &ShadowLight> + '_> {
        match &self.hard {
            HardLights::Own(own) => Box::new(own.iter()),
            HardLights::Found(_) => Box::new(self.found().into_iter().flat_map(FoundShadows::lights)),
        }
    }

    /// What was drawn of each light.
    pub(crate) fn reports(self) -> Vec<LightReport> {
        let mut hard = self.hard().map(|light| light.report.clone()).collect::<Vec<_>>().into_iter();
        let report = |soft: Option<SoftLight>| soft.map(|soft| soft.report).or_else(|| hard.next());
        self.soft.into_iter().filter_map(report).collect()
    }
}
