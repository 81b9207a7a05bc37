//! Pictures and point-wise evaluation on the device.
//!
//! In: a [`Program`], compiled to a kernel once, and a [`Frame`] of it. Out: an [`Image`] and how
//! much was computed for it, or a function's values at points. Params, time and size are data: a new
//! frame compiles nothing.

use crate::{Buffer, Gpu, GpuError, Kernel, groups_for};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;
use vol_compiler::frame::{Counts, Frame, Image, Job};
use vol_compiler::ir::FunctionId;
use vol_compiler::program::Program;
use vol_compiler::wgsl;

/// Side of the square tiles in pixels. One dispatch is one tile, short enough for the watchdogs of
/// desktop drivers and for a prompt answer to cancelling.
const TILE: u32 = 64;

/// Side of a workgroup of the render kernel, see `render.wgsl`.
const GROUP_SIDE: u32 = 8;

/// Invocations of a workgroup of the evaluation kernel.
const EVALUATION_GROUP: u32 = 64;

/// Buffers that every kernel reads: uniforms, curves, permutation, input.
const READ_BUFFERS: u32 = 4;

/// A program ready to be rendered on one device.
#[derive(Debug)]
pub struct Renderer {
    kernel: Kernel,
}

impl Renderer {
    /// Compiles a program for a device.
    ///
    /// # Errors
    /// [`GpuError`] if the device refuses the shader.
    pub fn new(gpu: &Gpu, program: &Program) -> Result<Self, GpuError> {
        let text = wgsl::render::render_module(program).map_err(refused)?;
        Ok(Self { kernel: gpu.kernel("render", &text, "render", READ_BUFFERS)? })
    }

    /// How long the device took to compile the program.
    #[must_use]
    pub fn compile_time(&self) -> Duration {
        self.kernel.compile_time()
    }

    /// Renders one frame. `progress` is told the number of pixels done; `None` means cancelled.
    ///
    /// # Errors
    /// [`GpuError`] if the device fails or the picture does not fit its memory.
    pub fn render(
        &self,
        gpu: &Gpu,
        program: &Program,
        frame: &Frame,
        job: &Job,
        progress: &dyn Fn(u64),
        cancelled: &AtomicBool,
    ) -> Result<Option<(Image, Counts)>, GpuError> {
        let [width, height] = job.size;
        let words = |tile: [u32; 4]| wgsl::render::frame_words(program, frame, job, tile);
        let scene = Shared::upload(gpu, frame)?;
        let input = gpu.upload(&words([0; 4]))?;
        let output = gpu.zeroed(width as usize * height as usize * wgsl::render::PIXEL_WORDS)?;
        let mut done = 0;
        for y in (0..height).step_by(TILE as usize) {
            for x in (0..width).step_by(TILE as usize) {
                if cancelled.load(Ordering::Relaxed) {
                    return Ok(None);
                }
                let (w, h) = (TILE.min(width - x), TILE.min(height - y));
                gpu.write(&input, &words([x, y, w, h]))?;
                let groups = [w.div_ceil(GROUP_SIDE), h.div_ceil(GROUP_SIDE), 1];
                gpu.dispatch(&self.kernel, &scene.with(&input), &output, groups)?;
                gpu.wait()?;
                done += u64::from(w) * u64::from(h);
                progress(done);
            }
        }
        let words = gpu.read(&output)?;
        Ok(Some((wgsl::render::unpack(width, height, &words), wgsl::render::counts(&words))))
    }
}

/// Values of a function at points: `inputs` row by row, as many per point as the function takes;
/// the outputs come back in the same order.
///
/// # Errors
/// [`GpuError`] if the device fails or the points do not fit its memory.
pub fn evaluate(
    gpu: &Gpu,
    program: &Program,
    frame: &Frame,
    function: FunctionId,
    inputs: &[f32],
) -> Result<Vec<f32>, GpuError> {
    let text = wgsl::evaluation_module(&program.module, function).map_err(refused)?;
    let kernel = gpu.kernel("evaluate", &text, "evaluate", READ_BUFFERS)?;
    let signature = program.module.function(function);
    let points = inputs.len() / (signature.inputs as usize).max(1);
    let count = u32::try_from(points).map_err(|_| GpuError::TooLarge {
        what: "the list of points".to_owned(),
        needed: points as u64,
        allowed: u64::from(u32::MAX),
        unit: "points",
    })?;
    let mut words = vec![count];
    words.extend(inputs.iter().map(|value| value.to_bits()));
    let scene = Shared::upload(gpu, frame)?;
    let input = gpu.upload(&words)?;
    let output = gpu.zeroed(points * signature.outputs.len())?;
    gpu.dispatch(&kernel, &scene.with(&input), &output, groups_for(count, EVALUATION_GROUP)?)?;
    gpu.read_f32(&output)
}

fn refused(error: wgsl::WgslError) -> GpuError {
    GpuError::Shader { label: "scene".to_owned(), message: error.to_string() }
}

/// The buffers of a frame that do not change from tile to tile.
struct Shared {
    uniforms: Buffer,
    curves: Buffer,
    permutation: Buffer,
}

impl Shared {
    fn upload(gpu: &Gpu, frame: &Frame) -> Result<Self, GpuError> {
        Ok(Self {
            uniforms: gpu.upload(&wgsl::uniform_words(frame))?,
            curves: gpu.upload(&wgsl::curve_words(frame))?,
            permutation: gpu.upload(&wgsl::permutation_words())?,
        })
    }

    fn with<'a>(&'a self, input: &'a Buffer) -> [&'a Buffer; READ_BUFFERS as usize] {
        [&self.uniforms, &self.curves, &self.permutation, input]
    }
}
