//! Compute kernels: WGSL text in, a compiled pipeline with a fixed binding layout out.
//!
//! Group 0 of every kernel:
//!
//! | binding | WGSL | contents |
//! |---|---|---|
//! | 0 .. inputs | `var<uniform>` or `var<storage, read>` | the inputs, in the order given to [`Gpu::dispatch`] |
//! | inputs | `var<storage, read_write>` | the output, kept from one dispatch to the next |
//!
//! WebGPU's default limits leave room for 7 inputs in storage and an output. Pass the number of elements in a buffer rather than asking `arrayLength`:
//! an empty buffer is padded.

use std::time::{Duration, Instant};

use vol_compiler::wgsl::{Arithmetic, Space, WgslError};

use crate::device::Gpu;
use crate::error::GpuError;
use crate::passthrough;

/// A compiled compute shader, ready to be dispatched on the [`Gpu`] that made it.
#[derive(Debug)]
pub struct Kernel {
    pub(crate) pipeline: wgpu::ComputePipeline,
    pub(crate) layout: wgpu::BindGroupLayout,
    label: String,
    compile_time: Duration,
}

impl Kernel {
    /// The name given when the kernel was made; it appears in error messages.
    pub fn label(&self) -> &str {
        &self.label
    }

    /// How long parsing, validating and creating the pipeline took.
    ///
    /// Some drivers, Mesa's software one among them, leave the machine code to the first dispatch: that part is not in here.
    pub fn compile_time(&self) -> Duration {
        self.compile_time
    }
}

impl Gpu {
    /// Compiles the entry point `entry` of `wgsl`, whose bindings follow the table of this module.
    ///
    /// # Errors
    ///
    /// [`GpuError::Shader`] when the text or its bindings are refused, [`GpuError::TooLarge`] for more buffers than a kernel may have.
    pub fn kernel(&self, label: &str, wgsl: &str, entry: &str, inputs: &[Space]) -> Result<Kernel, GpuError> {
        let allowed = self.device.limits().max_storage_buffers_per_shader_stage;
        let in_storage = inputs.iter().filter(|&&space| space == Space::Storage).count() as u64;
        if in_storage >= u64::from(allowed) {
            return Err(GpuError::TooLarge {
                what: format!("the kernel `{label}`"),
                needed: in_storage + 1,
                allowed: u64::from(allowed),
                unit: "storage buffers",
            });
        }
        let start = Instant::now();
        let refused = |error: &wgpu::Error| GpuError::from_shader(label, error);
        // The module has scopes of its own: a bad one would only be called "invalid" by the pipeline.
        let module = self.guarded(refused, || self.create_module(label, wgsl, entry))?;
        let module = module.map_err(|error| GpuError::untranslatable(label, &error))?;
        let (layout, pipeline) =
            self.guarded(refused, || self.create_pipeline(label, &module, entry, inputs))?;
        Ok(Kernel { pipeline, layout, label: label.to_owned(), compile_time: start.elapsed() })
    }

    fn create_module(&self, label: &str, wgsl: &str, entry: &str) -> Result<wgpu::ShaderModule, WgslError> {
        match self.arithmetic {
            Arithmetic::Free => Ok(self.device.create_shader_module(wgpu::ShaderModuleDescriptor {
                label: Some(label),
                source: wgpu::ShaderSource::Wgsl(wgsl.into()),
            })),
            Arithmetic::Strict => passthrough::module(&self.device, label, wgsl, entry),
        }
    }

    fn create_pipeline(
        &self,
        label: &str,
        module: &wgpu::ShaderModule,
        entry: &str,
        inputs: &[Space],
    ) -> (wgpu::BindGroupLayout, wgpu::ComputePipeline) {
        let output = wgpu::BufferBindingType::Storage { read_only: false };
        let types = inputs.iter().map(|&space| input_type(space)).chain([output]);
        let entries: Vec<_> = (0..).zip(types).map(|(binding, ty)| buffer_entry(binding, ty)).collect();
        let layout = self.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some(label),
            entries: &entries,
        });
        let pipeline_layout = self.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some(label),
            bind_group_layouts: &[Some(&layout)],
            immediate_size: 0,
        });
        let pipeline = self.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some(label),
            layout: Some(&pipeline_layout),
            module,
            entry_point: Some(entry),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            cache: None,
        });
        (layout, pipeline)
    }
}

fn input_type(space: Space) -> wgpu::BufferBindingType {
    match space {
        Space::Uniform => wgpu::BufferBindingType::Uniform,
        Space::Storage => wgpu::BufferBindingType::Storage { read_only: true },
    }
}

fn buffer_entry(binding: u32, ty: wgpu::BufferBindingType) -> wgpu::BindGroupLayoutEntry {
    wgpu::BindGroupLayoutEntry {
        binding,
        visibility: wgpu::ShaderStages::COMPUTE,
        ty: wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None },
        count: None,
    }
}
