//! Opening a Vulkan device for compute, with no window and no display.
//!
//! * in: nothing but the Vulkan drivers installed on the machine (`VK_DRIVER_FILES` narrows them down, as for any program)
//! * out: a [`Gpu`] that compiles [`Kernel`](crate::Kernel)s, holds [`Buffer`](crate::Buffer)s and runs the ones on the others
//!
//! No call panics on what wgpu or the driver reports. Each call that can make wgpu complain runs inside error scopes of its own thread;
//! whatever escapes them, and the loss of the device, is kept and returned by the next call.
//!
//! ```no_run
//! # fn main() -> Result<(), vol_runtime_gpu::GpuError> {
//! let gpu = vol_runtime_gpu::open(Default::default())?;
//! let kernel = gpu.kernel("double", include_str!("shaders/double.wgsl"), "main", &[vol_compiler::wgsl::Space::Storage])?;
//! let input = gpu.upload(&[1, 2, 3])?;
//! let output = gpu.zeroed(3)?;
//! gpu.dispatch(&kernel, &[&input], &output, vol_runtime_gpu::groups_for(3, 64)?)?;
//! assert_eq!(gpu.read(&output)?, [2, 4, 6]);
//! # Ok(())
//! # }
//! ```

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, Mutex, PoisonError};

use vol_compiler::wgsl::Arithmetic;

use crate::error::GpuError;
use crate::passthrough;

/// An opened graphics device.
///
/// Shared freely between threads; the work of all of them goes through one queue, in the order of the calls.
#[derive(Debug)]
pub struct Gpu {
    pub(crate) device: wgpu::Device,
    pub(crate) queue: wgpu::Queue,
    info: wgpu::AdapterInfo,
    pub(crate) arithmetic: Arithmetic,
    faults: Arc<Faults>,
    /// Kept alive for as long as its device.
    _instance: wgpu::Instance,
}

/// What the driver reported outside any call: written by wgpu's callbacks, read by [`Gpu::check`].
#[derive(Debug, Default)]
struct Faults {
    /// Set once, when the device is lost.
    lost: Mutex<Option<String>>,
    /// The first error that no error scope caught.
    stray: Mutex<Option<GpuError>>,
}

/// Opens the best Vulkan device of this machine: a discrete GPU before an integrated one, software last.
///
/// Asks for WebGPU's default limits only, so that what works here works on any device; buffer sizes alone are raised to what the device
/// has. Strict arithmetic needs one optional feature, that SPIR-V reaches the driver unchanged.
///
/// # Errors
///
/// [`GpuError::NoDevice`] when there is no driver, or when no device can be opened; the reason names each device tried.
pub fn open(arithmetic: Arithmetic) -> Result<Gpu, GpuError> {
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor {
        backends: wgpu::Backends::VULKAN,
        // No validation layers, whatever the build profile: the tests and the released program see the same driver.
        flags: wgpu::InstanceFlags::empty(),
        ..wgpu::InstanceDescriptor::new_without_display_handle()
    });
    let mut adapters = pollster::block_on(instance.enumerate_adapters(wgpu::Backends::VULKAN));
    adapters.sort_by_key(|adapter| preference(adapter.get_info().device_type));
    let mut refusals = Vec::new();
    for adapter in adapters {
        match open_adapter(&instance, &adapter, arithmetic) {
            Ok(gpu) => return Ok(gpu),
            Err(error) => refusals.push(format!("{}: {error}", adapter.get_info().name)),
        }
    }
    let reason = if refusals.is_empty() { "no driver found".to_owned() } else { refusals.join("; ") };
    Err(GpuError::NoDevice { reason })
}

/// The order in which devices are tried, smallest first.
fn preference(device_type: wgpu::DeviceType) -> u8 {
    match device_type {
        wgpu::DeviceType::DiscreteGpu => 0,
        wgpu::DeviceType::IntegratedGpu => 1,
        wgpu::DeviceType::VirtualGpu => 2,
        wgpu::DeviceType::Other => 3,
        wgpu::DeviceType::Cpu => 4,
    }
}

fn open_adapter(
    instance: &wgpu::Instance,
    adapter: &wgpu::Adapter,
    arithmetic: Arithmetic,
) -> Result<Gpu, wgpu::RequestDeviceError> {
    let offered = adapter.limits();
    let (required_features, experimental_features) = match arithmetic {
        Arithmetic::Free => Default::default(),
        Arithmetic::Strict => (wgpu::Features::PASSTHROUGH_SHADERS, passthrough::allowed()),
    };
    let descriptor = wgpu::DeviceDescriptor {
        label: Some("vol"),
        required_features,
        experimental_features,
        required_limits: wgpu::Limits {
            max_buffer_size: offered.max_buffer_size,
            max_storage_buffer_binding_size: offered.max_storage_buffer_binding_size,
            ..wgpu::Limits::defaults()
        },
        ..Default::default()
    };
    let (device, queue) = pollster::block_on(adapter.request_device(&descriptor))?;
    let faults = Arc::new(Faults::default());
    faults.watch(&device);
    Ok(Gpu { device, queue, info: adapter.get_info(), arithmetic, faults, _instance: instance.clone() })
}

impl Faults {
    /// Has wgpu report to this object instead of panicking.
    fn watch(self: &Arc<Self>, device: &wgpu::Device) {
        let faults = Arc::clone(self);
        device.on_uncaptured_error(Arc::new(move |error| {
            let error = GpuError::from_wgpu("between two calls", &error);
            set_once(&faults.stray, error);
        }));
        let faults = Arc::clone(self);
        device.set_device_lost_callback(move |reason, message| {
            let closed = matches!(reason, wgpu::DeviceLostReason::Destroyed);
            let reason = if closed { "it was closed" } else { &message };
            set_once(&faults.lost, reason.to_owned());
        });
    }
}

/// Keeps the first value; the later ones are usually consequences of it.
fn set_once<T>(slot: &Mutex<Option<T>>, value: T) {
    let mut slot = slot.lock().unwrap_or_else(PoisonError::into_inner);
    slot.get_or_insert(value);
}

impl Gpu {
    /// One line for people: the device's name, its driver, what kind of device it is, and whether its arithmetic is strict.
    ///
    /// Example: `llvmpipe (LLVM 15.0.6, 256 bits), llvmpipe Mesa 25.0.7-2~bpo12+1 (LLVM 15.0.6), software`.
    pub fn description(&self) -> String {
        let kind = match self.info.device_type {
            wgpu::DeviceType::DiscreteGpu => "discrete GPU",
            wgpu::DeviceType::IntegratedGpu => "integrated GPU",
            wgpu::DeviceType::VirtualGpu => "virtual GPU",
            wgpu::DeviceType::Other => "unknown kind",
            wgpu::DeviceType::Cpu => "software",
        };
        let driver = format!("{} {}", self.info.driver, self.info.driver_info);
        let strict = if self.arithmetic == Arithmetic::Strict { "strict" } else { "" };
        let parts = [self.info.name.as_str(), driver.trim(), kind, strict];
        parts.into_iter().filter(|part| !part.is_empty()).collect::<Vec<_>>().join(", ")
    }

    /// True for a driver that runs shaders on the CPU: no faster than the CPU backend, but good enough to test with.
    pub fn is_software(&self) -> bool {
        self.info.device_type == wgpu::DeviceType::Cpu
    }

    /// The largest buffer that a kernel can use on this device, in bytes.
    pub fn max_buffer_bytes(&self) -> u64 {
        let limits = self.device.limits();
        limits.max_buffer_size.min(limits.max_storage_buffer_binding_size)
    }

    /// Closes the device at once, for all threads: work in flight is finished, every later call answers [`GpuError::Lost`].
    ///
    /// Dropping the last [`Gpu`] does the same without a word; this is for a program that stops early, and for testing the loss itself.
    pub fn close(&self) {
        self.device.destroy();
        // wgpu reports the loss, through the callback above, when it is next asked for news.
        let _ = self.poll(wgpu::PollType::wait_indefinitely());
    }

    /// Blocks until all work handed in so far is done.
    ///
    /// # Errors
    ///
    /// [`GpuError::Lost`], or an error left over from earlier work.
    pub fn wait(&self) -> Result<(), GpuError> {
        self.poll(wgpu::PollType::wait_indefinitely())
    }

    /// An error if the device is lost or something went wrong outside any call.
    pub(crate) fn check(&self) -> Result<(), GpuError> {
        let lost = &self.faults.lost;
        if let Some(reason) = &*lost.lock().unwrap_or_else(PoisonError::into_inner) {
            return Err(GpuError::Lost { reason: reason.clone() });
        }
        let stray = &self.faults.stray;
        let error = stray.lock().unwrap_or_else(PoisonError::into_inner).take();
        error.map_or(Ok(()), Err)
    }

    /// Lets wgpu make progress, then reports what it found.
    pub(crate) fn poll(&self, poll_type: wgpu::PollType) -> Result<(), GpuError> {
        self.check()?;
        // wgpu 30 panics in `Device::poll` when the driver answers "device lost", after calling the callback above.
        let polled = catch_unwind(AssertUnwindSafe(|| self.device.poll(poll_type)));
        self.check()?;
        match polled {
            Ok(Ok(_)) => Ok(()),
            Ok(Err(error)) => Err(GpuError::Lost { reason: error.to_string() }),
            Err(_) => Err(GpuError::Lost { reason: "the driver failed while we waited".to_owned() }),
        }
    }

    /// Runs `work` and returns the first error that wgpu reported during it, as `describe` words it.
    ///
    /// Error scopes belong to a thread, so calls from several threads do not see each other's errors.
    pub(crate) fn guarded<T>(
        &self,
        describe: impl FnOnce(&wgpu::Error) -> GpuError,
        work: impl FnOnce() -> T,
    ) -> Result<T, GpuError> {
        self.check()?;
        let validation = self.device.push_error_scope(wgpu::ErrorFilter::Validation);
        let memory = self.device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
        let internal = self.device.push_error_scope(wgpu::ErrorFilter::Internal);
        let value = work();
        let internal = pollster::block_on(internal.pop());
        let memory = pollster::block_on(memory.pop());
        let validation = pollster::block_on(validation.pop());
        // A lost device explains all the other errors, and memory the rest.
        self.check()?;
        match memory.or(internal).or(validation) {
            Some(error) => Err(describe(&error)),
            None => Ok(value),
        }
    }
}
