//! What computes: the CPU, or a graphics device behind the feature `gpu`.
//!
//! [`Device::open`] turns what was asked for (`cpu`, `gpu`, `auto`) into a device that works or a
//! reason why there is none; [`Device::prepare`] compiles a program for it. The commands then do
//! not care which one they have. CPU work runs on the surrounding rayon pool.

use std::marker::PhantomData;
use std::sync::atomic::AtomicBool;

use rayon::prelude::*;
use vol_compiler::frame::{Counts, Frame, Image, Job};
use vol_compiler::ir::FunctionId;
use vol_compiler::program::Program;
use vol_compiler::wgsl::{Arithmetic, render};
use vol_runtime_cpu::interp::{Evaluator, Tapes};
use vol_runtime_cpu::{Method, NoMajorant, PixelCost};

use crate::failure::Failure;

/// What was asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Choice {
    /// The CPU.
    Cpu,
    /// Any graphics device, also one in software.
    Gpu,
    /// A hardware graphics device if there is one, else the CPU.
    Auto,
}

/// What computes.
#[derive(Debug)]
pub enum Device {
    /// The CPU.
    Cpu,
    /// A graphics device.
    #[cfg(feature = "gpu")]
    Gpu(Box<vol_runtime_gpu::Gpu>),
}

/// A program ready to be rendered on a device.
#[derive(Debug)]
pub struct Renderer<'a> {
    program: &'a Program,
    target: Target<'a>,
}

#[derive(Debug)]
enum Target<'a> {
    Cpu(PhantomData<&'a Device>),
    #[cfg(feature = "gpu")]
    Gpu(&'a vol_runtime_gpu::Gpu, vol_runtime_gpu::Renderer),
}

/// A finished picture and the work it took.
#[derive(Debug)]
pub struct Rendered {
    /// The picture.
    pub image: Image,
    /// What was done for it.
    pub counts: Counts,
    /// Standard error of the colour, root mean square over the picture relative to that of the colour;
    /// known of random paths only.
    pub standard_error: Option<f32>,
    /// What each pixel cost, rows from the top; only of [`Renderer::render_costs`].
    pub costs: Option<Vec<PixelCost>>,
}

fn counts_of_cpu(stats: &vol_runtime_cpu::Stats) -> Counts {
    let samples = stats.medium_samples + stats.shadow_samples;
    Counts {
        camera_rays: stats.rays,
        rays: stats.rays + stats.shadow_rays,
        samples,
        evaluations: samples + stats.surface_evaluations + stats.region_evaluations,
    }
}

impl Device {
    /// Opens what was asked for. The CPU's arithmetic is always strict; that of a graphics device costs speed.
    ///
    /// # Errors
    /// A device failure if the GPU was asked for by name and there is none.
    pub fn open(choice: Choice, arithmetic: Arithmetic) -> Result<Self, Failure> {
        match choice {
            Choice::Cpu => Ok(Self::Cpu),
            Choice::Gpu => Self::open_gpu(arithmetic),
            Choice::Auto => Ok(Self::open_any(arithmetic).0),
        }
    }

    /// Opens a hardware graphics device, else the CPU, with the reason.
    #[must_use]
    pub fn open_any(arithmetic: Arithmetic) -> (Self, Option<String>) {
        match Self::open_gpu(arithmetic) {
            Ok(device) if device.is_hardware() => (device, None),
            // Software Vulkan is slower than the CPU path.
            Ok(device) => {
                let description = device.description();
                let name = description.trim_start_matches("GPU, ");
                (Self::Cpu, Some(format!("no hardware GPU, only {name}")))
            }
            // What to do about it comes after a semicolon, and is being done.
            Err(Failure::Device(message)) => {
                let reason = message.text.split(';').next().unwrap_or_default();
                (Self::Cpu, Some(reason.to_owned()))
            }
            Err(_) => (Self::Cpu, None),
        }
    }

    #[cfg(feature = "gpu")]
    fn open_gpu(arithmetic: Arithmetic) -> Result<Self, Failure> {
        vol_runtime_gpu::open(arithmetic)
            .map(|gpu| Self::Gpu(Box::new(gpu)))
            .map_err(|error| gpu_failure(&error))
    }

    #[cfg(not(feature = "gpu"))]
    fn open_gpu(_: Arithmetic) -> Result<Self, Failure> {
        let failure = Failure::device("this `vol` was built without the GPU backend");
        Err(failure.with_help("use the CPU, or build with `--features gpu`"))
    }

    /// Whether it is a graphics device proper, not one in software.
    #[must_use]
    pub fn is_hardware(&self) -> bool {
        match self {
            Self::Cpu => false,
            #[cfg(feature = "gpu")]
            Self::Gpu(gpu) => !gpu.is_software(),
        }
    }

    /// `cpu` or `gpu`.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self {
            Self::Cpu => "cpu",
            #[cfg(feature = "gpu")]
            Self::Gpu(_) => "gpu",
        }
    }

    /// One line for people, for example `CPU, 16 threads`.
    #[must_use]
    pub fn description(&self) -> String {
        match self {
            Self::Cpu => match rayon::current_num_threads() {
                1 => "CPU, 1 thread".to_owned(),
                threads => format!("CPU, {threads} threads"),
            },
            #[cfg(feature = "gpu")]
            Self::Gpu(gpu) => format!("GPU, {}", gpu.description()),
        }
    }

    /// [`Device::prepare_with`] the usual workgroups.
    ///
    /// # Errors
    /// A device failure.
    pub fn prepare<'a>(&'a self, program: &'a Program) -> Result<Renderer<'a>, Failure> {
        self.prepare_with(program, render::WORKGROUP)
    }

    /// Compiles a program for this device; of use for all its frames. `workgroup` is the shape of a graphics device's
    /// workgroups.
    ///
    /// # Errors
    /// A device failure.
    #[cfg_attr(not(feature = "gpu"), expect(unused_variables, reason = "the CPU has no workgroups"))]
    pub fn prepare_with<'a>(
        &'a self,
        program: &'a Program,
        workgroup: [u32; 2],
    ) -> Result<Renderer<'a>, Failure> {
        let target = match self {
            Self::Cpu => Target::Cpu(PhantomData),
            #[cfg(feature = "gpu")]
            Self::Gpu(gpu) => {
                let renderer = vol_runtime_gpu::Renderer::with_workgroup(gpu, program, workgroup);
                Target::Gpu(gpu, renderer.map_err(|error| gpu_failure(&error))?)
            }
        };
        Ok(Renderer { program, target })
    }

    /// Values of a function of a position at points, as many in a row as it has outputs.
    ///
    /// # Errors
    /// A device failure.
    pub fn evaluate(
        &self,
        program: &Program,
        frame: &Frame,
        function: FunctionId,
        points: &[[f32; 3]],
    ) -> Result<Vec<f32>, Failure> {
        match self {
            Self::Cpu => Ok(evaluate_on_cpu(program, frame, function, points)),
            #[cfg(feature = "gpu")]
            Self::Gpu(gpu) => {
                let inputs = points.as_flattened();
                vol_runtime_gpu::evaluate(gpu, program, frame, function, inputs)
                    .map_err(|error| gpu_failure(&error))
            }
        }
    }
}

impl Renderer<'_> {
    /// Whether a graphics device computes.
    #[must_use]
    pub fn is_on_device(&self) -> bool {
        match &self.target {
            Target::Cpu(_) => false,
            #[cfg(feature = "gpu")]
            Target::Gpu(..) => true,
        }
    }

    /// Compiles what a job needs, if it is not compiled yet.
    ///
    /// # Errors
    /// A device failure.
    #[cfg_attr(not(feature = "gpu"), expect(unused_variables, reason = "the CPU needs nothing compiled"))]
    pub fn compile(&self, frame: &Frame, job: &Job) -> Result<(), Failure> {
        match &self.target {
            Target::Cpu(_) => Ok(()),
            #[cfg(feature = "gpu")]
            Target::Gpu(gpu, renderer) => {
                renderer.compile(gpu, self.program, frame, job).map_err(|error| gpu_failure(&error))
            }
        }
    }

    /// Renders one frame; `progress` hears the number of pixels done so far.
    ///
    /// # Errors
    /// [`Failure::Interrupted`] once `cancelled` is set, or a device failure.
    pub fn render(
        &self,
        frame: &Frame,
        job: &Job,
        progress: &(dyn Fn(u64) + Sync),
        cancelled: &AtomicBool,
    ) -> Result<Rendered, Failure> {
        match &self.target {
            Target::Cpu(_) => {
                let rendered = vol_runtime_cpu::render(self.program, frame, job, None, progress, cancelled);
                let (image, stats) = rendered.ok_or(Failure::Interrupted)?;
                Ok(Rendered { image, counts: counts_of_cpu(&stats), standard_error: None, costs: None })
            }
            #[cfg(feature = "gpu")]
            Target::Gpu(gpu, renderer) => {
                let rendered = renderer.render(gpu, self.program, frame, job, progress, cancelled);
                let rendered = rendered.map_err(|error| gpu_failure(&error))?;
                let (image, counts) = rendered.ok_or(Failure::Interrupted)?;
                Ok(Rendered { image, counts, standard_error: None, costs: None })
            }
        }
    }
}

impl Renderer<'_> {
    /// [`Renderer::render`] by one of the methods; all but the comb run on the CPU only.
    ///
    /// # Errors
    /// A usage failure on another device, a content failure if the method cannot render the scene, and
    /// those of [`Renderer::render`].
    pub fn render_by(
        &self,
        method: Method,
        frame: &Frame,
        job: &Job,
        progress: &(dyn Fn(u64) + Sync),
        cancelled: &AtomicBool,
    ) -> Result<Rendered, Failure> {
        match &self.target {
            _ if method == Method::Comb => self.render(frame, job, progress, cancelled),
            Target::Cpu(_) => {
                let rendered =
                    vol_runtime_cpu::render_by(method, self.program, frame, job, progress, cancelled);
                let (image, stats) =
                    rendered.map_err(|error| self.no_majorant(error))?.ok_or(Failure::Interrupted)?;
                Ok(rendered_on_cpu(method, image, &stats, None))
            }
            #[cfg(feature = "gpu")]
            Target::Gpu(..) => Err(Failure::usage("only the comb runs on the GPU")),
        }
    }

    /// [`Renderer::render_by`] with what each pixel costs; on the CPU only.
    ///
    /// # Errors
    /// Those of [`Renderer::render_by`].
    pub fn render_costs(
        &self,
        method: Method,
        frame: &Frame,
        job: &Job,
        progress: &(dyn Fn(u64) + Sync),
        cancelled: &AtomicBool,
    ) -> Result<Rendered, Failure> {
        match &self.target {
            Target::Cpu(_) => {
                let rendered =
                    vol_runtime_cpu::render_costs(method, self.program, frame, job, progress, cancelled);
                let (image, stats, costs) =
                    rendered.map_err(|error| self.no_majorant(error))?.ok_or(Failure::Interrupted)?;
                Ok(rendered_on_cpu(method, image, &stats, Some(costs)))
            }
            #[cfg(feature = "gpu")]
            Target::Gpu(..) => Err(Failure::usage("costs are counted on the CPU only")),
        }
    }

    fn no_majorant(&self, error: NoMajorant) -> Failure {
        let name = &self.program.media[error.medium].name;
        let text = format!("no bound is known for the extinction of the medium `{name}`");
        let help = "random paths need one: write the density so that it has a largest value, as in `min(100, …)`, \
                    or take another integrator";
        Failure::content(text).with_help(help)
    }
}

fn rendered_on_cpu(
    method: Method,
    image: Image,
    stats: &vol_runtime_cpu::Stats,
    costs: Option<Vec<PixelCost>>,
) -> Rendered {
    let standard_error = match method {
        Method::MonteCarlo { .. } => Some(relative(stats.variance, &image)),
        Method::Comb | Method::FixedStep { .. } => None,
    };
    Rendered { image, counts: counts_of_cpu(stats), standard_error, costs }
}

/// The root of a sum of squares over the pixels and channels of a picture, relative to the picture's own.
fn relative(sum: f64, image: &Image) -> f32 {
    let squares = image.pixels.iter().flat_map(|pixel| pixel.color).map(|c| f64::from(c).powi(2));
    let whole: f64 = squares.sum();
    if sum > 0.0 { (sum / whole.max(f64::MIN_POSITIVE)).sqrt() as f32 } else { 0.0 }
}

#[cfg(feature = "gpu")]
fn gpu_failure(error: &vol_runtime_gpu::GpuError) -> Failure {
    Failure::device(error.to_string())
}

/// Points that one thread evaluates at a time.
const BATCH: usize = 4096;

fn evaluate_on_cpu(program: &Program, frame: &Frame, function: FunctionId, points: &[[f32; 3]]) -> Vec<f32> {
    let outputs = program.module.function(function).outputs.len();
    let tapes = Tapes::new(program);
    let batch = |points: &[[f32; 3]]| {
        // One row per coordinate in, one row per output out.
        let inputs: [Vec<f32>; 3] =
            std::array::from_fn(|axis| points.iter().map(|point| point[axis]).collect());
        let mut results = vec![vec![0.0; points.len()]; outputs];
        let mut rows: Vec<&mut [f32]> = results.iter_mut().map(Vec::as_mut_slice).collect();
        let mut evaluator = Evaluator::new(&tapes, frame);
        evaluator.evaluate(function, &inputs.each_ref().map(Vec::as_slice), &mut rows);
        let at = |point: usize| results.iter().map(move |row| row[point]);
        (0..points.len()).flat_map(at).collect::<Vec<f32>>()
    };
    points.par_chunks(BATCH).flat_map_iter(batch).collect()
}
