//! WGSL modules: shared parts first, then the pass's own.

const VIEW: &str = include_str!("shaders/view.wgsl");
const LIGHT: &str = include_str!("shaders/light.wgsl");
const SURFACE: &str = include_str!("shaders/surface.wgsl");

pub(crate) fn surface(device: &wgpu::Device) -> wgpu::ShaderModule {
    module(device, "surface", &[VIEW, LIGHT, SURFACE])
}

pub(crate) fn glass(device: &wgpu::Device) -> wgpu::ShaderModule {
    module(device, "glass", &[VIEW, LIGHT, SURFACE, include_str!("shaders/glass.wgsl")])
}

pub(crate) fn volume(device: &wgpu::Device) -> wgpu::ShaderModule {
    module(device, "volume", &[VIEW, LIGHT, include_str!("shaders/volume.wgsl")])
}

pub(crate) fn tone(device: &wgpu::Device) -> wgpu::ShaderModule {
    module(device, "tone", &[VIEW, include_str!("shaders/tone.wgsl")])
}

pub(crate) fn overlay(device: &wgpu::Device) -> wgpu::ShaderModule {
    module(device, "overlay", &[VIEW, include_str!("shaders/overlay.wgsl")])
}

pub(crate) fn pose(device: &wgpu::Device) -> wgpu::ShaderModule {
    module(device, "pose", &[include_str!("shaders/pose.wgsl")])
}

fn module(device: &wgpu::Device, label: &str, parts: &[&str]) -> wgpu::ShaderModule {
    device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some(label),
        source: wgpu::ShaderSource::Wgsl(parts.concat().into()),
    })
}
