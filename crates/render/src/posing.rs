//! Showing a scene at another moment, wherever that is done.

use std::sync::Arc;

use umbrae_core::{Caster, Material, Object};

use crate::{Gpu, GpuError, GpuPoser, GpuScene, Tier};

/// Where vertices are moved.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Posing {
    /// In `f64`, and uploaded again.
    Cpu,
    /// By compute shaders, and read back.
    Gpu,
}

impl Posing {
    /// The GPU where it can.
    pub fn of(gpu: &Gpu) -> Self {
        match gpu.caps.tier {
            Tier::Full => Self::Gpu,
            Tier::Basic => Self::Cpu,
        }
    }
}

/// Moves the objects of one scene: from one frame to the next, whatever the device can.
#[derive(Debug)]
pub struct Poser {
    on_gpu: Option<GpuPoser>,
    materials: Arc<[Material]>,
}

impl Poser {
    /// For `objects`, whose casters are `casters`, of which `scene` is made; they name `materials`.
    ///
    /// # Errors
    ///
    /// Those of [`GpuPoser::new`].
    ///
    /// # Panics
    ///
    /// As [`GpuPoser::new`].
    pub fn new(
        gpu: &Gpu,
        posing: Posing,
        objects: &[Object],
        casters: &[Caster],
        scene: &GpuScene,
        materials: &[Material],
    ) -> Result<Self, GpuError> {
        let on_gpu = match posing {
            Posing::Cpu => None,
            Posing::Gpu => Some(GpuPoser::new(gpu, objects, casters, scene)?),
        };
        Ok(Self { on_gpu, materials: materials.into() })
    }

    /// Moves `scene` and `casters` to where `objects` are. On the CPU that is linear in vertices and triangles, moved or not; see
    /// [`GpuPoser::pose`] for the GPU.
    ///
    /// # Errors
    ///
    /// Those of [`GpuPoser::pose`].
    ///
    /// # Panics
    ///
    /// As [`GpuPoser::pose`].
    pub async fn pose(
        &mut self,
        gpu: &Gpu,
        scene: &mut GpuScene,
        objects: &[Object],
        casters: &mut [Caster],
    ) -> Result<(), GpuError> {
        if let Some(poser) = &mut self.on_gpu {
            return poser.pose(gpu, scene, objects, casters).await;
        }
        for (caster, object) in casters.iter_mut().zip(objects) {
            caster.pose_to(object);
        }
        scene.update(gpu, casters, &self.materials);
        Ok(())
    }
}
