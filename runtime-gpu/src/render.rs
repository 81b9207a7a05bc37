//! Pictures and point-wise evaluation on the device.
//!
//! In: a [`Program`], compiled to a kernel once, and a [`Frame`] of it. Out: an [`Image`] and how
//! much was computed for it, or a function's values at points. Params, time and size are data: a new
//! frame compiles nothing.

use crate::{Buffer, Gpu, GpuError, Kernel, groups_for};
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};
use vol_compiler::frame::{Counts, Frame, Image, Job, Quadrature};
use vol_compiler::ir::FunctionId;
use vol_compiler::program::Program;
use vol_compiler::wgsl;

/// Sides of the square tiles in pixels, at first and at most. One dispatch is some samples of one tile, short enough for the
/// watchdogs of desktop drivers and for a prompt answer to cancelling; tiles grow on devices that are quick.
const SMALLEST_TILE: u32 = 64;
const LARGEST_TILE: u32 = 256;

/// How long a dispatch of several samples should take: much longer than it takes to start one, much
/// shorter than the seconds after which a driver resets the device.
const DISPATCH_TIME: Duration = Duration::from_millis(60);

/// Invocations of a workgroup of the evaluation kernel.
const EVALUATION_GROUP: u32 = 64;

/// A program ready to be rendered on one device.
#[derive(Debug)]
pub struct Renderer {
    /// For the midpoint rule, or for anything where there are no media.
    midpoint: OnceLock<Kernel>,
    /// For the corrected form.
    corrected: OnceLock<Kernel>,
    workgroup: [u32; 2],
}

impl Renderer {
    /// [`Renderer::with_workgroup`] with the usual shape.
    ///
    /// # Errors
    /// [`GpuError`] if the device refuses the shader.
    pub fn new(gpu: &Gpu, program: &Program) -> Result<Self, GpuError> {
        Self::with_workgroup(gpu, program, wgsl::render::WORKGROUP)
    }

    /// Prepares a program for a device; `workgroup` is the shape of its workgroups, on which no picture depends. With media it is compiled with the first picture, since each
    /// quadrature has a kernel of its own; else at once.
    ///
    /// # Errors
    /// [`GpuError`] if the device refuses the shader.
    pub fn with_workgroup(gpu: &Gpu, program: &Program, workgroup: [u32; 2]) -> Result<Self, GpuError> {
        let new = Self { midpoint: OnceLock::new(), corrected: OnceLock::new(), workgroup };
        if program.media.is_empty() {
            new.kernel(gpu, program, Quadrature::Midpoint)?;
        }
        Ok(new)
    }

    /// The kernel for a quadrature, compiled when it is first asked for.
    fn kernel(&self, gpu: &Gpu, program: &Program, quadrature: Quadrature) -> Result<&Kernel, GpuError> {
        let (kernel, quadrature) = match quadrature {
            Quadrature::Corrected if !program.media.is_empty() => (&self.corrected, quadrature),
            Quadrature::Corrected | Quadrature::Midpoint => (&self.midpoint, Quadrature::Midpoint),
        };
        if let Some(kernel) = kernel.get() {
            return Ok(kernel);
        }
        let shader = wgsl::render::render_module(program, quadrature, self.workgroup).map_err(refused)?;
        let compiled = gpu.kernel("render", &shader.text, "render", &shader.inputs)?;
        Ok(kernel.get_or_init(|| compiled))
    }

    /// Compiles what a job needs, if it is not compiled yet: the driver's part included, which some drivers, Mesa's software
    /// one among them, leave to the first dispatch.
    ///
    /// # Errors
    /// [`GpuError`] if the device refuses the shader or fails.
    pub fn compile(&self, gpu: &Gpu, program: &Program, frame: &Frame, job: &Job) -> Result<(), GpuError> {
        let picture = Picture::new(self, gpu, program, frame, job)?;
        picture.dispatch([0; 4], 0)?;
        gpu.wait()
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
        let picture = Picture::new(self, gpu, program, frame, job)?;
        let mut side = SMALLEST_TILE;
        let mut done = 0;
        for block in tiles([0, 0, width, height], LARGEST_TILE) {
            let mut quickest = true;
            for tile in tiles(block, side) {
                let Some(was_quick) = picture.tile(tile, |part| progress(done + part), cancelled)? else {
                    return Ok(None);
                };
                quickest &= was_quick;
                done += pixels(tile);
            }
            // The next block is cut as coarsely as this one allowed for.
            side = if quickest { (2 * side).min(LARGEST_TILE) } else { (side / 2).max(SMALLEST_TILE) };
        }
        let words = gpu.read(&picture.output)?;
        Ok(Some((wgsl::render::unpack(width, height, &words), wgsl::render::counts(&words))))
    }
}

/// A picture in the making: its kernel and its buffers.
struct Picture<'a> {
    gpu: &'a Gpu,
    program: &'a Program,
    frame: &'a Frame,
    job: &'a Job,
    kernel: &'a Kernel,
    workgroup: [u32; 2],
    scene: Vec<Buffer>,
    header: Buffer,
    input: Buffer,
    output: Buffer,
}

impl<'a> Picture<'a> {
    fn new(
        renderer: &'a Renderer,
        gpu: &'a Gpu,
        program: &'a Program,
        frame: &'a Frame,
        job: &'a Job,
    ) -> Result<Self, GpuError> {
        let kernel = renderer.kernel(gpu, program, job.quadrature)?;
        let scene = upload(gpu, program, frame)?;
        let header = gpu.upload(&wgsl::render::frame_words(program, frame, job, [0; 4], 0))?;
        let input = gpu.upload(&wgsl::render::input_words(program, frame))?;
        let [width, height] = job.size;
        let output = gpu.zeroed(width as usize * height as usize * wgsl::render::PIXEL_WORDS)?;
        let workgroup = renderer.workgroup;
        Ok(Self { gpu, program, frame, job, kernel, workgroup, scene, header, input, output })
    }

    /// Hands in at most `budget` more samples for each pixel of a tile.
    fn dispatch(&self, tile: [u32; 4], budget: u32) -> Result<(), GpuError> {
        let words = wgsl::render::frame_words(self.program, self.frame, self.job, tile, budget);
        self.gpu.write(&self.header, &words)?;
        let [_, _, width, height] = tile;
        let [columns, rows] = self.workgroup;
        let groups = [width.div_ceil(columns).max(1), height.div_ceil(rows).max(1), 1];
        let inputs: Vec<&Buffer> = self.scene.iter().chain([&self.header, &self.input]).collect();
        self.gpu.dispatch(self.kernel, &inputs, &self.output, groups)
    }

    /// Takes all samples of a tile; `None` means cancelled. Says whether four times as many pixels would not have taken too
    /// long at a time.
    fn tile(
        &self,
        tile: [u32; 4],
        progress: impl Fn(u64),
        cancelled: &AtomicBool,
    ) -> Result<Option<bool>, GpuError> {
        let most = self.job.sampling.most;
        let (mut taken, mut budget, mut quick) = (0, 1, true);
        // Nobody knows what a sample costs here before the first; later ones cost no more, since
        // pixels only leave, but one of adaptive sampling that comes with four probes.
        while taken < most {
            if cancelled.load(Ordering::Relaxed) {
                return Ok(None);
            }
            let started = Instant::now();
            budget = budget.min(most - taken);
            self.dispatch(tile, budget)?;
            self.gpu.wait()?;
            let elapsed = started.elapsed();
            quick &= elapsed / budget < DISPATCH_TIME / 4;
            taken += budget;
            budget = next_budget(budget, elapsed);
            progress(pixels(tile) * u64::from(taken) / u64::from(most));
        }
        Ok(Some(quick))
    }
}

fn pixels([_, _, width, height]: [u32; 4]) -> u64 {
    u64::from(width) * u64::from(height)
}

/// Cuts a rectangle `[x, y, width, height]` into tiles with sides of at most `side`, rows from the top.
fn tiles([x, y, width, height]: [u32; 4], side: u32) -> impl Iterator<Item = [u32; 4]> {
    let edges = move |start: u32, size: u32| {
        (0..size).step_by(side as usize).map(move |offset| [start + offset, side.min(size - offset)])
    };
    edges(y, height).flat_map(move |[y, h]| edges(x, width).map(move |[x, w]| [x, y, w, h]))
}

/// Samples for the next dispatch after one that took some time. No picture depends on it.
fn next_budget(budget: u32, elapsed: Duration) -> u32 {
    if elapsed < DISPATCH_TIME / 2 {
        budget.saturating_mul(2)
    } else if elapsed > DISPATCH_TIME {
        (budget / 2).max(1)
    } else {
        budget
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
    let shader = wgsl::evaluation_module(program, function).map_err(refused)?;
    let kernel = gpu.kernel("evaluate", &shader.text, "evaluate", &shader.inputs)?;
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
    let scene = upload(gpu, program, frame)?;
    let input = gpu.upload(&words)?;
    let inputs: Vec<&Buffer> = scene.iter().chain([&input]).collect();
    let output = gpu.zeroed(points * signature.outputs.len())?;
    gpu.dispatch(&kernel, &inputs, &output, groups_for(count, EVALUATION_GROUP)?)?;
    gpu.read_f32(&output)
}

fn refused(error: wgsl::WgslError) -> GpuError {
    GpuError::untranslatable("scene", &error)
}

/// The buffers of a frame that do not change from tile to tile.
fn upload(gpu: &Gpu, program: &Program, frame: &Frame) -> Result<Vec<Buffer>, GpuError> {
    wgsl::scene_words(program, frame).iter().map(|words| gpu.upload(words)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_cover_every_pixel_once() {
        let [width, height] = [150_u32, 65];
        let mut count = vec![0; (width * height) as usize];
        for [x, y, w, h] in tiles([0, 0, width, height], 100).flat_map(|block| tiles(block, 64)) {
            let pixels = (y..y + h).flat_map(|row| (x..x + w).map(move |column| row * width + column));
            pixels.for_each(|index| count[index as usize] += 1);
        }
        assert!(count.iter().all(|&count| count == 1));
    }

    #[test]
    fn dispatches_stay_short() {
        // A device that takes 1 ms, 40 ms or 5 s for a sample of a tile.
        for (cost, least, most) in [(1, 16, 64), (40, 1, 1), (5000, 1, 1)] {
            let mut budget = 1;
            for _ in 0..20 {
                budget = next_budget(budget, Duration::from_millis(cost) * budget);
            }
            assert!((least..=most).contains(&budget), "{cost} ms: {budget}");
        }
        assert_eq!(next_budget(u32::MAX, Duration::ZERO), u32::MAX);
    }
}
