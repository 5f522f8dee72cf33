//! Devices with no more than WebGL2 has.

use umbrae_render::Gpu;

/// Whatever there is, held to the limits of WebGL2, and without any feature; `None` where there is nothing.
pub(crate) fn held_to_webgl2(backends: wgpu::Backends) -> Option<Gpu> {
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor {
        backends,
        ..wgpu::InstanceDescriptor::new_without_display_handle()
    });
    let adapter = pollster::block_on(instance.enumerate_adapters(backends)).into_iter().next()?;
    let descriptor = wgpu::DeviceDescriptor {
        label: Some("as WebGL2"),
        required_limits: wgpu::Limits::downlevel_webgl2_defaults(),
        ..wgpu::DeviceDescriptor::default()
    };
    let (device, queue) = pollster::block_on(adapter.request_device(&descriptor)).unwrap();
    Some(Gpu::of_device(&adapter, device, queue))
}
