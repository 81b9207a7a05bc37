//! Compute kernels: WGSL text in, a compiled pipeline with a fixed binding layout out.
//!
//! Group 0 of every kernel:
//!
//! | binding | WGSL | contents |
//! |---|---|---|
//! | 0 .. `read_buffers` | `var<storage, read>` | the inputs, in the order given to [`Gpu::dispatch`] |
//! | `read_buffers` | `var<storage, read_write>` | the output, kept from one dispatch to the next |
//!
//! WebGPU's default limits leave room for 7 inputs and an output. Pass the number of elements in a buffer rather than asking `arrayLength`:
//! an empty buffer is padded.

use std::time::{Duration, Instant};

use crate::device::Gpu;
use crate::error::GpuError;

/// A compiled compute shader, ready to be dispatched on the [`Gpu`] that made it.
#[derive(Debug)]
pub struct Kernel {
    pub(crate) pipeline: wgpu::ComputePipeline,
    pub(crate) layout: wgpu::BindGroupLayout,
    label: String,
    read_buffers: u32,
    compile_time: Duration,
}

impl Kernel {
    /// The name given when the kernel was made; it appears in error messages.
    pub fn label(&self) -> &str {
        &self.label
    }

    /// How many input buffers each dispatch takes.
    pub fn read_buffers(&self) -> u32 {
        self.read_buffers
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
    pub fn kernel(
        &self,
        label: &str,
        wgsl: &str,
        entry: &str,
        read_buffers: u32,
    ) -> Result<Kernel, GpuError> {
        let allowed = self.device.limits().max_storage_buffers_per_shader_stage;
        if read_buffers >= allowed {
            return Err(GpuError::TooLarge {
                what: format!("the kernel `{label}`"),
                needed: u64::from(read_buffers) + 1,
                allowed: u64::from(allowed),
                unit: "buffers",
            });
        }
        let start = Instant::now();
        let refused = |error: &wgpu::Error| GpuError::from_shader(label, error);
        // The module has scopes of its own: a bad one would only be called "invalid" by the pipeline.
        let module = self.guarded(refused, || {
            self.device.create_shader_module(wgpu::ShaderModuleDescriptor {
                label: Some(label),
                source: wgpu::ShaderSource::Wgsl(wgsl.into()),
            })
        })?;
        let (layout, pipeline) =
            self.guarded(refused, || self.create_pipeline(label, &module, entry, read_buffers))?;
        Ok(Kernel { pipeline, layout, label: label.to_owned(), read_buffers, compile_time: start.elapsed() })
    }

    fn create_pipeline(
        &self,
        label: &str,
        module: &wgpu::ShaderModule,
        entry: &str,
        read_buffers: u32,
    ) -> (wgpu::BindGroupLayout, wgpu::ComputePipeline) {
        let entries: Vec<_> =
            (0..=read_buffers).map(|binding| storage_entry(binding, binding < read_buffers)).collect();
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

fn storage_entry(binding: u32, read_only: bool) -> wgpu::BindGroupLayoutEntry {
    wgpu::BindGroupLayoutEntry {
        binding,
        visibility: wgpu::ShaderStages::COMPUTE,
        ty: wgpu::BindingType::Buffer {
            ty: wgpu::BufferBindingType::Storage { read_only },
            has_dynamic_offset: false,
            min_binding_size: None,
        },
        count: None,
    }
}
