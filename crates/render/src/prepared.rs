//! The lights of a frame, wherever their silhouettes are found.

use std::sync::{Mutex, MutexGuard, PoisonError};

use umbrae_core::Light;

use crate::frame::FrameLight;
use crate::shadow::{ShadowView, Shadows};
use crate::{FoundShadows, Gpu, GpuError, LightReport, ShadowLight, Shot, SilhouetteSource, Smooth, Targets};

/// What finds the silhouettes of one scene on the GPU, made when it is first asked for, and kept.
#[derive(Debug, Default)]
pub(crate) struct KeptFinder(Mutex<Option<(KeptFor, FoundShadows)>>);

/// What decides what is found: the source, the samples of the passes that draw it, and the bodies that were given.
type KeptFor = (SilhouetteSource, u32, u64);

/// The lights of one frame, from when they are prepared until they are submitted.
#[derive(Debug)]
pub(crate) enum PreparedLights<'a> {
    Own(Vec<ShadowLight>),
    /// Nobody else may plan before this frame is submitted.
    Found(MutexGuard<'a, Option<(KeptFor, FoundShadows)>>),
}

impl<'a> PreparedLights<'a> {
    /// `lights` with the casters and options of `shot`, to be drawn by `shadows` as `view` sees them.
    ///
    /// # Errors
    ///
    /// [`GpuError::TooLarge`], [`GpuError::NoSilhouettes`].
    pub(crate) fn new(
        gpu: &Gpu,
        shadows: &Shadows,
        shot: &Shot<'a>,
        view: &ShadowView,
        lights: &[Light],
    ) -> Result<Self, GpuError> {
        let (casters, uploaded, options) = (shot.casters, &shot.scene.shadow_casters, &shot.shadows);
        let source = options.silhouettes;
        let is_on_cpu = match source {
            SilhouetteSource::Auto | SilhouetteSource::Cpu(_) => true,
            // Textures hold no smooth silhouettes.
            SilhouetteSource::GpuBasic => options.smooth != Smooth::Off,
            SilhouetteSource::Gpu => false,
        };
        if is_on_cpu {
            let own = lights.iter().map(|light| shadows.light(gpu, casters, uploaded, view, light, options));
            return Ok(Self::Own(own.collect::<Result<_, _>>()?));
        }
        // What is kept is planned anew in each frame, so that a panic in another leaves nothing wrong in it.
        let mut kept = shot.scene.finder.0.lock().unwrap_or_else(PoisonError::into_inner);
        let kept_for = (source, shadows.samples(), uploaded.bodies_given());
        if kept.as_ref().is_none_or(|(other, _)| *other != kept_for) {
            *kept = Some((kept_for, shadows.finder(gpu, casters, uploaded, source)?));
        }
        if let Some((_, found)) = &mut *kept {
            shadows.compile_found(gpu, source, found);
            found.plan(gpu, casters, uploaded, view, lights, options);
            found.upload(gpu)?;
        }
        Ok(Self::Found(kept))
    }

    /// What must be recorded before any light is drawn.
    pub(crate) fn found(&self) -> Option<&FoundShadows> {
        match self {
            Self::Own(_) => None,
            Self::Found(kept) => kept.as_ref().map(|(_, found)| found),
        }
    }

    /// For the frame, with the names of `lights`; `targets` are made ready for them.
    ///
    /// # Errors
    ///
    /// [`GpuError::PictureTooLarge`].
    pub(crate) fn for_frame<'b>(
        &'b self,
        gpu: &Gpu,
        lights: &'b [Light],
        targets: &Targets,
    ) -> Result<Vec<FrameLight<'b>>, GpuError> {
        let named = |(light, shadows): (&'b Light, &'b ShadowLight)| FrameLight { name: &light.name, shadows };
        let lights: Vec<FrameLight<'b>> = match self {
            Self::Own(own) => lights.iter().zip(own).map(named).collect(),
            Self::Found(_) => {
                let found = self.found().into_iter().flat_map(FoundShadows::lights);
                lights.iter().zip(found).map(named).collect()
            }
        };
        if lights.iter().any(|light| light.shadows.needs_sums()) {
            targets.make_sums(gpu)?;
        }
        Ok(lights)
    }

    /// What was drawn of each light.
    pub(crate) fn reports(self) -> Vec<LightReport> {
        match self {
            Self::Own(own) => own.into_iter().map(|light| light.report).collect(),
            Self::Found(_) => {
                self.found().into_iter().flat_map(FoundShadows::lights).map(|light| light.report.clone()).collect()
            }
        }
    }
}
