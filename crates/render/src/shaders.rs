//! WGSL modules: shared parts first, then the pass's own.

const VIEW: &str = include_str!("shaders/view.wgsl");
const LIGHT: &str = include_str!("shaders/light.wgsl");
const JOB: &str = include_str!("shaders/job.wgsl");
const NEAR: &str = include_str!("shaders/near.wgsl");
const DARK_CAP: &str = include_str!("shaders/dark_cap.wgsl");
const SMOOTH_JOB: &str = include_str!("shaders/smooth_job.wgsl");
const SURFACE: &str = include_str!("shaders/surface.wgsl");
const FLAT_NORMAL: &str = include_str!("shaders/flat_normal.wgsl");
const FOUND_TABLES: &str = include_str!("shaders/found_tables.wgsl");

pub(crate) fn surface(device: &wgpu::Device) -> wgpu::ShaderModule {
    module(device, "surface", &[VIEW, LIGHT, SURFACE])
}

pub(crate) fn glass(device: &wgpu::Device) -> wgpu::ShaderModule {
    module(device, "glass", &[VIEW, LIGHT, SURFACE, include_str!("shaders/glass.wgsl")])
}

/// With `is_per_sample`, edges are found at each sample; devices that can't do that find them at each pixel.
pub(crate) fn sphere(device: &wgpu::Device, is_per_sample: bool) -> wgpu::ShaderModule {
    let source = include_str!("shaders/sphere.wgsl");
    let per_pixel;
    let source = if is_per_sample {
        source
    } else {
        per_pixel = source.replace("@interpolate(perspective, sample)", "@interpolate(perspective, center)");
        &per_pixel
    };
    module(device, "sphere", &[VIEW, LIGHT, SURFACE, source])
}

/// A light with a size on surfaces, `samples` samples a pixel.
pub(crate) fn soft_light(device: &wgpu::Device, samples: u32) -> wgpu::ShaderModule {
    let source = if samples > 1 {
        include_str!("shaders/soft_light_samples.wgsl")
    } else {
        include_str!("shaders/soft_light.wgsl")
    };
    module(device, "soft light", &[VIEW, LIGHT, SURFACE, source])
}

/// The same on spheres.
pub(crate) fn soft_sphere(device: &wgpu::Device, samples: u32) -> wgpu::ShaderModule {
    let source = if samples > 1 {
        include_str!("shaders/soft_sphere_samples.wgsl")
    } else {
        include_str!("shaders/soft_sphere.wgsl")
    };
    module(device, "soft light on spheres", &[VIEW, LIGHT, SURFACE, include_str!("shaders/sphere.wgsl"), source])
}

/// What casters cover of a light with a size.
pub(crate) fn soft_coverage(device: &wgpu::Device, samples: u32) -> wgpu::ShaderModule {
    let depth = if samples > 1 {
        include_str!("shaders/soft_depth_samples.wgsl")
    } else {
        include_str!("shaders/soft_depth.wgsl")
    };
    let volume = include_str!("shaders/volume.wgsl");
    let (face, coverage) = (include_str!("shaders/light_face.wgsl"), include_str!("shaders/soft_coverage.wgsl"));
    module(device, "coverage", &[VIEW, LIGHT, volume, face, coverage, depth])
}

/// What they leave of it.
pub(crate) fn soft_composite(device: &wgpu::Device, samples: u32) -> wgpu::ShaderModule {
    let source = if samples > 1 {
        include_str!("shaders/soft_composite_samples.wgsl")
    } else {
        include_str!("shaders/soft_composite.wgsl")
    };
    module(device, "composite", &[source])
}

pub(crate) fn volume(device: &wgpu::Device) -> wgpu::ShaderModule {
    module(device, "volume", &[VIEW, LIGHT, include_str!("shaders/volume.wgsl")])
}

/// Volumes whose silhouettes were found on the GPU.
pub(crate) fn found_volume(device: &wgpu::Device) -> wgpu::ShaderModule {
    let volume = include_str!("shaders/volume.wgsl");
    module(device, "found volume", &[VIEW, LIGHT, volume, DARK_CAP, JOB, include_str!("shaders/found_volume.wgsl")])
}

/// Sums of `samples` samples a pixel.
pub(crate) fn fold_sums(device: &wgpu::Device, samples: u32) -> wgpu::ShaderModule {
    let source =
        if samples > 1 { include_str!("shaders/fold_samples.wgsl") } else { include_str!("shaders/fold_sums.wgsl") };
    module(device, "fold sums", &[source])
}

pub(crate) fn find(device: &wgpu::Device) -> wgpu::ShaderModule {
    module(device, "find silhouettes", &[JOB, FLAT_NORMAL, NEAR, include_str!("shaders/find.wgsl")])
}

/// The passes that find smooth silhouettes.
pub(crate) fn find_smooth(device: &wgpu::Device) -> wgpu::ShaderModule {
    let [curve, find] = [include_str!("shaders/curve.wgsl"), include_str!("shaders/find_smooth.wgsl")];
    let facing = include_str!("shaders/find_smooth_facing.wgsl");
    let creases = include_str!("shaders/find_smooth_creases.wgsl");
    module(device, "find smooth silhouettes", &[SMOOTH_JOB, FLAT_NORMAL, NEAR, curve, find, facing, creases])
}

/// Volumes of smooth silhouettes that were found on the GPU.
pub(crate) fn found_smooth_volume(device: &wgpu::Device) -> wgpu::ShaderModule {
    let volume = include_str!("shaders/volume.wgsl");
    let found = include_str!("shaders/found_smooth_volume.wgsl");
    module(device, "found smooth volume", &[VIEW, LIGHT, volume, DARK_CAP, SMOOTH_JOB, found])
}

/// The passes that find silhouettes in textures.
pub(crate) fn find_basic(device: &wgpu::Device) -> wgpu::ShaderModule {
    module(
        device,
        "find silhouettes in textures",
        &[FOUND_TABLES, FLAT_NORMAL, include_str!("shaders/find_basic.wgsl")],
    )
}

/// Volumes whose silhouettes were found in textures.
pub(crate) fn found_basic_volume(device: &wgpu::Device) -> wgpu::ShaderModule {
    let volume = include_str!("shaders/volume.wgsl");
    let found = include_str!("shaders/found_basic_volume.wgsl");
    module(device, "volume found in textures", &[VIEW, LIGHT, volume, FOUND_TABLES, found])
}

pub(crate) fn tone(device: &wgpu::Device) -> wgpu::ShaderModule {
    module(device, "tone", &[VIEW, include_str!("shaders/tone.wgsl")])
}

pub(crate) fn overlay(device: &wgpu::Device) -> wgpu::ShaderModule {
    module(device, "overlay", &[VIEW, include_str!("shaders/overlay.wgsl")])
}

/// `moved` is the source of a function of that name: see [`crate::Displacement`].
pub(crate) fn pose(device: &wgpu::Device, moved: &str) -> wgpu::ShaderModule {
    module(device, "pose", &[FLAT_NORMAL, include_str!("shaders/pose.wgsl"), moved])
}

/// `moved` as for [`pose`].
pub(crate) fn displace(device: &wgpu::Device, moved: &str) -> wgpu::ShaderModule {
    module(device, "displace", &[FOUND_TABLES, FLAT_NORMAL, include_str!("shaders/displace.wgsl"), moved])
}

fn module(device: &wgpu::Device, label: &str, parts: &[&str]) -> wgpu::ShaderModule {
    device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some(label),
        source: wgpu::ShaderSource::Wgsl(parts.concat().into()),
    })
}
