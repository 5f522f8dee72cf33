//! Finding an adapter and making a device of it.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use wgpu::util::DeviceExt as _;

use crate::Caps;
use crate::readback::TextureCopy;

/// Which adapter to use.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct AdapterChoice {
    /// Part of the adapter's label, as [`adapter_labels`] gives it, in any case.
    pub name: Option<String>,
    /// Take a software adapter even where there is hardware.
    pub is_software: bool,
}

/// Why there is no device.
#[derive(Debug, Clone, thiserror::Error)]
#[non_exhaustive]
pub enum GpuError {
    /// The machine has no driver at all.
    #[error(
        "no Vulkan or OpenGL driver was found; on Debian or Ubuntu, `apt install mesa-vulkan-drivers` gives a software one"
    )]
    NoDriver,
    /// There are adapters, but not the one asked for.
    #[error("no {wanted}; this machine has: {}", available.join("; "))]
    NoSuchAdapter {
        /// What was asked for.
        wanted: String,
        /// Labels of what there is.
        available: Vec<String>,
    },
    /// The driver refused to make a device.
    #[error("{adapter} can't be used: {reason}")]
    Device {
        /// The adapter's label.
        adapter: String,
        /// What the driver says.
        reason: String,
    },
    /// The scene does not fit into one buffer of this device.
    #[error(
        "the model needs a buffer of {needed_bytes} bytes, and {adapter} allows {allowed_bytes}; use a smaller model or another adapter"
    )]
    TooLarge {
        /// The adapter's label.
        adapter: String,
        /// The buffer's size.
        needed_bytes: u64,
        /// The largest one that the device can make.
        allowed_bytes: u64,
    },
    /// The device has no compute shaders.
    #[error("{adapter} can't pose models, as it has no compute shaders; pose them on the CPU (--posing cpu)")]
    NoCompute {
        /// The adapter's label.
        adapter: String,
    },
    /// A shader of the user's own is no good.
    #[error("the function that moves vertices can't be used: {reason}")]
    Shader {
        /// What is wrong with it, and where.
        reason: String,
    },
    /// The device can't find silhouettes in the way that was asked for.
    #[error(
        "{adapter} can't find silhouettes so, as it lacks what that takes; find them on the CPU (--silhouette auto)"
    )]
    NoSilhouettes {
        /// The adapter's label.
        adapter: String,
    },
    /// The device can't shade the samples of a pixel one by one.
    #[error("{adapter} can't draw soft shadows with several samples a pixel; draw one (--samples 1)")]
    NoSoftSamples {
        /// The adapter's label.
        adapter: String,
    },
    /// The picture does not fit into one texture of this device.
    #[error("a picture of {}x{} pixels can't be drawn: {adapter} allows {allowed} a side", size_px[0], size_px[1])]
    PictureTooLarge {
        /// The adapter's label.
        adapter: String,
        /// Pixels across and down.
        size_px: [u32; 2],
        /// The largest side.
        allowed: u32,
    },
    /// The device has no memory left for the picture or the model.
    #[error(
        "{adapter} ran out of memory; draw a smaller picture (--size), fewer samples (--samples 1) or a smaller model"
    )]
    OutOfMemory {
        /// The adapter's label.
        adapter: String,
    },
    /// The device was lost, or a result could not be read back.
    #[error("the device failed while drawing: {reason}")]
    Lost {
        /// What the driver says.
        reason: String,
    },
}

/// The device and what it can do.
#[derive(Debug)]
pub struct Gpu {
    /// Makes everything.
    pub device: wgpu::Device,
    /// Takes finished recordings.
    pub queue: wgpu::Queue,
    /// Name, driver and backend, as [`adapter_labels`] gives it.
    pub label: String,
    /// See [`Caps`].
    pub caps: Caps,
    /// Set once the device has reported so.
    is_out_of_memory: Arc<AtomicBool>,
}

impl Gpu {
    /// Makes a device of the adapter chosen: by default the fastest kind there is, hardware before software and
    /// Vulkan, Metal or DX12 before OpenGL.
    ///
    /// # Errors
    ///
    /// [`GpuError::NoDriver`], [`GpuError::NoSuchAdapter`] or [`GpuError::Device`].
    pub async fn new(choice: &AdapterChoice) -> Result<Self, GpuError> {
        let wanted_name = choice.name.as_ref().map(|name| name.to_lowercase());
        let is_wanted = |adapter: &wgpu::Adapter| {
            let is_named = wanted_name.as_ref().is_none_or(|name| label(adapter).to_lowercase().contains(name));
            is_named && (!choice.is_software || adapter.get_info().device_type == wgpu::DeviceType::Cpu)
        };
        let mut available = Vec::new();
        let mut wanted = None;
        for backends in BACKENDS_IN_ORDER {
            let adapters = adapters(backends).await;
            available.extend(adapters.iter().map(label));
            wanted = adapters.into_iter().find(is_wanted);
            if wanted.is_some() {
                break;
            }
        }
        if available.is_empty() {
            return Err(GpuError::NoDriver);
        }
        let Some(adapter) = wanted else {
            let kind = if choice.is_software { "software adapter" } else { "adapter" };
            let wanted = choice.name.as_ref().map_or(kind.to_owned(), |name| format!("{kind} named `{name}`"));
            return Err(GpuError::NoSuchAdapter { wanted, available });
        };
        Self::of_adapter(&adapter).await
    }

    /// Takes a device that the caller made of `adapter`, for drawing beside the caller's own passes or into its window.
    ///
    /// Ask for [`Gpu::wanted_features`] when making it: without them passes are not timed, depth has 24 bits, and tallies 16.
    pub fn of_device(adapter: &wgpu::Adapter, device: wgpu::Device, queue: wgpu::Queue) -> Self {
        let caps = Caps::of(adapter, &device);
        Self { device, queue, label: label(adapter), caps, is_out_of_memory: Arc::default() }
    }

    /// Running out of memory is the user's to mend; any other report is a bug of ours, unless it follows from that.
    fn expect_only_memory_to_fail(&self) {
        let is_out_of_memory = Arc::clone(&self.is_out_of_memory);
        self.device.on_uncaptured_error(Arc::new(move |error| {
            if matches!(error, wgpu::Error::OutOfMemory { .. }) {
                is_out_of_memory.store(true, Ordering::Relaxed);
            }
            assert!(is_out_of_memory.load(Ordering::Relaxed), "wgpu refused what we asked for: {error}");
        }));
    }

    /// `result`, unless the device has run out of memory, which would be why there is none.
    ///
    /// Only a device of [`Gpu::new`] is watched; that of [`Gpu::of_device`] reports to its owner.
    pub(crate) fn unless_out_of_memory<T>(&self, result: Result<T, GpuError>) -> Result<T, GpuError> {
        if self.is_out_of_memory.load(Ordering::Relaxed) {
            return Err(GpuError::OutOfMemory { adapter: self.label.clone() });
        }
        result
    }

    /// # Errors
    ///
    /// [`GpuError::TooLarge`] when the device makes no buffers of `bytes`.
    pub(crate) fn ensure_buffer_fits(&self, bytes: usize) -> Result<(), GpuError> {
        let (needed_bytes, allowed_bytes) = (bytes as u64, self.device.limits().max_buffer_size);
        if needed_bytes > allowed_bytes {
            return Err(GpuError::TooLarge { adapter: self.label.clone(), needed_bytes, allowed_bytes });
        }
        Ok(())
    }

    /// A buffer of `bytes`, filled up with zeros to whole words (16-bit indices may be an odd number); `None` without any.
    ///
    /// # Errors
    ///
    /// [`GpuError::TooLarge`] when the device makes no buffers of so many.
    pub(crate) fn upload(
        &self,
        label: &str,
        bytes: &[u8],
        usage: wgpu::BufferUsages,
    ) -> Result<Option<wgpu::Buffer>, GpuError> {
        self.ensure_buffer_fits(bytes.len())?;
        let mut padded;
        let contents = if bytes.len().is_multiple_of(4) {
            bytes
        } else {
            padded = bytes.to_vec();
            padded.resize(bytes.len().next_multiple_of(4), 0);
            &padded
        };
        let descriptor = wgpu::util::BufferInitDescriptor { label: Some(label), contents, usage };
        Ok((!bytes.is_empty()).then(|| self.device.create_buffer_init(&descriptor)))
    }

    /// # Errors
    ///
    /// [`GpuError::TooLarge`] when shaders can't be given a buffer of `bytes`.
    pub(crate) fn ensure_binding_fits(&self, bytes: u64) -> Result<(), GpuError> {
        let allowed_bytes = self.device.limits().max_storage_buffer_binding_size;
        if bytes > allowed_bytes {
            return Err(GpuError::TooLarge { adapter: self.label.clone(), needed_bytes: bytes, allowed_bytes });
        }
        Ok(())
    }

    /// The features of `adapter` that this crate makes use of; it needs none.
    pub fn wanted_features(adapter: &wgpu::Adapter) -> wgpu::Features {
        adapter.features()
            & (wgpu::Features::TIMESTAMP_QUERY
                | wgpu::Features::DEPTH32FLOAT_STENCIL8
                | wgpu::Features::FLOAT32_BLENDABLE)
    }

    /// The texels of `texture`, which must be `COPY_SRC`, row by row from the top without padding, once all submitted work is done.
    ///
    /// # Errors
    ///
    /// [`GpuError::Lost`], [`GpuError::OutOfMemory`].
    pub async fn read(&self, texture: &wgpu::Texture) -> Result<Vec<u8>, GpuError> {
        let mut encoder = self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("read") });
        let copy = TextureCopy::record(self, &mut encoder, texture);
        self.queue.submit([encoder.finish()]);
        self.unless_out_of_memory(copy.read(self).await)
    }

    async fn of_adapter(adapter: &wgpu::Adapter) -> Result<Self, GpuError> {
        let (device, queue) = adapter
            .request_device(&wgpu::DeviceDescriptor {
                label: Some("umbrae"),
                required_features: Self::wanted_features(adapter),
                // Whatever the adapter has: a city is larger than the smallest guaranteed buffer.
                required_limits: adapter.limits(),
                ..wgpu::DeviceDescriptor::default()
            })
            .await
            .map_err(|e| GpuError::Device { adapter: label(adapter), reason: e.to_string() })?;
        let gpu = Self::of_device(adapter, device, queue);
        gpu.expect_only_memory_to_fail();
        Ok(gpu)
    }
}

/// OpenGL is asked only when nothing better will do: its loaders take time and talk on standard error.
const BACKENDS_IN_ORDER: [wgpu::Backends; 2] = [wgpu::Backends::PRIMARY, wgpu::Backends::GL];

/// For each adapter of this machine, best first: its name, kind, driver and backend. Empty without a driver.
pub async fn adapter_labels() -> Vec<String> {
    let mut labels = Vec::new();
    for backends in BACKENDS_IN_ORDER {
        labels.extend(adapters(backends).await.iter().map(label));
    }
    labels
}

/// The adapters of `backends`, hardware first.
async fn adapters(backends: wgpu::Backends) -> Vec<wgpu::Adapter> {
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor {
        backends,
        ..wgpu::InstanceDescriptor::new_without_display_handle()
    });
    let mut adapters = instance.enumerate_adapters(backends).await;
    adapters.sort_by_key(|adapter| match adapter.get_info().device_type {
        wgpu::DeviceType::DiscreteGpu => 0,
        wgpu::DeviceType::IntegratedGpu => 1,
        wgpu::DeviceType::VirtualGpu => 2,
        wgpu::DeviceType::Other => 3,
        wgpu::DeviceType::Cpu => 4,
    });
    adapters
}

fn label(adapter: &wgpu::Adapter) -> String {
    let info = adapter.get_info();
    let kind = match info.device_type {
        wgpu::DeviceType::DiscreteGpu => "discrete",
        wgpu::DeviceType::IntegratedGpu => "integrated",
        wgpu::DeviceType::VirtualGpu => "virtual",
        wgpu::DeviceType::Other => "unknown kind",
        wgpu::DeviceType::Cpu => "software",
    };
    let driver = [info.driver.as_str(), info.driver_info.as_str()].join(" ");
    format!("{}, {kind}, {} {}", info.name, info.backend, driver.trim()).trim().to_owned()
}
