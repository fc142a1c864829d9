//! The graphics device.

use pollster::block_on;

/// A graphics device and what it can do.
#[derive(Debug)]
pub struct Gpu {
    info: wgpu::AdapterInfo,
    device: wgpu::Device,
    queue: wgpu::Queue,
}

/// Why there is no graphics device.
#[derive(Debug, thiserror::Error)]
pub enum GpuError {
    /// There is no adapter, neither hardware nor software.
    #[error(
        "no graphics adapter found ({0})\n  hint: install the driver of the graphics card or a software renderer (Debian: `apt-get install libvulkan1 mesa-vulkan-drivers`)"
    )]
    NoAdapter(wgpu::RequestAdapterError),
    /// The adapter does not work.
    #[error("graphics adapter \"{name}\" cannot be used: {error}")]
    NoDevice {
        /// Its name.
        name: String,
        /// What the driver says.
        error: wgpu::RequestDeviceError,
    },
}

impl Gpu {
    /// A device without a window: the fastest, or a software device if there is no other.
    ///
    /// Blocks until the driver answers. `WGPU_BACKEND` chooses among vulkan, metal, dx12 and gl.
    ///
    /// # Errors
    /// [`GpuError`] if there is none; it says what to install.
    pub fn headless() -> Result<Self, GpuError> {
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle_from_env());
        let options = wgpu::RequestAdapterOptions {
            power_preference: wgpu::PowerPreference::HighPerformance,
            ..Default::default()
        };
        let adapter = block_on(instance.request_adapter(&options)).map_err(GpuError::NoAdapter)?;
        let (device, queue) = block_on(adapter.request_device(&Self::device_descriptor(&adapter)))
            .map_err(|error| GpuError::NoDevice { name: adapter.get_info().name, error })?;
        Ok(Self::new(&adapter, device, queue))
    }

    /// An existing device, such as that of a UI; create it with [`Self::device_descriptor`] where possible.
    pub fn new(adapter: &wgpu::Adapter, device: wgpu::Device, queue: wgpu::Queue) -> Self {
        Self { info: adapter.get_info(), device, queue }
    }

    /// What to request from an adapter: wireframes if supported, and limits for large scenes.
    pub fn device_descriptor(adapter: &wgpu::Adapter) -> wgpu::DeviceDescriptor<'static> {
        let offered = adapter.limits();
        let fits = |limits: &wgpu::Limits| limits.check_limits(&offered);
        let usual = [wgpu::Limits::default(), wgpu::Limits::downlevel_defaults()];
        let mut limits = usual.into_iter().find(fits).unwrap_or_else(|| offered.clone());
        limits.max_buffer_size = offered.max_buffer_size;
        limits.max_texture_dimension_2d = offered.max_texture_dimension_2d;
        wgpu::DeviceDescriptor {
            label: Some("lumel"),
            required_features: WIREFRAME & adapter.features(),
            required_limits: limits,
            ..Default::default()
        }
    }

    /// Name, driver and interface, for display: `llvmpipe (LLVM 15.0.6, 256 bits), Vulkan`.
    pub fn name(&self) -> String {
        format!("{}, {:?}", self.info.name, self.info.backend)
    }

    /// Whether it is a software renderer, which takes tens of milliseconds per picture.
    pub fn is_software(&self) -> bool {
        self.info.device_type == wgpu::DeviceType::Cpu
    }

    /// Whether [`Frame::wireframe`](crate::Frame::wireframe) shows anything.
    pub fn draws_wireframes(&self) -> bool {
        self.device.features().contains(WIREFRAME)
    }

    /// The device.
    pub fn device(&self) -> &wgpu::Device {
        &self.device
    }

    /// The queue for its work.
    pub fn queue(&self) -> &wgpu::Queue {
        &self.queue
    }
}

const WIREFRAME: wgpu::Features = wgpu::Features::POLYGON_MODE_LINE;
