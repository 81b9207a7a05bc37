//! `--stats FILE.json`: what a render did and how long each phase took.

use std::time::{Duration, Instant};

use serde::ser::SerializeMap as _;
use serde::{Serialize, Serializer};
use vol_compiler::frame::{Counts, Quadrature};
use vol_runtime_cpu::style::FittedMap;
use vol_runtime_cpu::{GridChoice, Method};

use super::memory::Memory;
use super::method::Plan;

/// The file's content; of several frames, sums and the worst.
#[derive(Debug, Serialize)]
pub(super) struct Stats {
    /// Version of `vol`.
    pub(super) version: &'static str,
    pub(super) scene: String,
    /// `cpu` or `gpu`.
    pub(super) backend: &'static str,
    /// The device in words.
    pub(super) device: String,
    /// Width and height in pixels.
    pub(super) size: [u32; 2],
    pub(super) frames: u64,
    /// Of those, frames that equal the one before and were not rendered again.
    pub(super) same_frames: u64,
    /// Grids of lights that were there from earlier frames, also ones that were tried and not taken.
    pub(super) same_grids: u64,
    /// Of random paths and jitter; without those recorded only.
    pub(super) seed: u64,
    /// `comb`, `fixed-step` or `monte-carlo`.
    pub(super) integrator: &'static str,
    /// Whether fixed steps are sampled at random places.
    pub(super) jitter: Option<bool>,
    /// How fixed steps find tubes: `cells` or `sphere-march`.
    pub(super) tube_bounds: Option<&'static str>,
    /// Error allowed of the comb.
    pub(super) max_error: Option<f32>,
    /// What the chosen steps of the comb were multiplied by.
    pub(super) step_scale: Option<f32>,
    /// How samples of the comb become an integral, `midpoint` or `corrected`; of the last frame.
    pub(super) quadrature: Option<&'static str>,
    /// Distance between samples of media along camera rays; the smallest of all frames. Random paths have none.
    pub(super) step: Option<f32>,
    /// The same along shadow rays.
    pub(super) shadow_step: Option<f32>,
    /// Estimated error, the largest of all frames: of the comb by its pilot, before its steps were scaled, of random paths their relative
    /// standard error.
    pub(super) estimate: Option<f32>,
    /// Relative root mean square difference to the picture of --reference.
    pub(super) error: Option<f64>,
    /// What was chosen for each light of the last frame.
    pub(super) light_grids: Vec<LightGrid>,
    /// For how many steps a sample of each medium of the last frame stands where no finer one is.
    pub(super) spacings: Vec<u32>,
    /// Light maps of the last frame.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub(super) light_maps: Vec<LightMap>,
    /// Samples of a pixel asked for, or the most; the largest of all frames.
    pub(super) samples_per_pixel: u32,
    /// Error of a pixel at which it takes no more samples, 0 for none; the smallest of all frames.
    pub(super) adaptive: Option<f32>,
    /// Camera rays per pixel: samples taken, and the probes of adaptive sampling.
    pub(super) mean_samples_per_pixel: f64,
    /// Operations of the dearest pixel of all frames, in additions; only with `--aov cost`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) most_operations_per_pixel: Option<u64>,
    /// Sums over all frames.
    #[serde(flatten, serialize_with = "counts")]
    pub(super) counts: Counts,
    pub(super) milliseconds: Phases,
    pub(super) memory: Memory,
    /// What the compiler left out, a sentence each.
    pub(super) dropped: Vec<String>,
}

impl Stats {
    /// Adds one picture, given what was planned and the estimated error.
    pub(super) fn add(&mut self, plan: &Plan, estimate: Option<f32>, counts: Counts) {
        let smaller = |least: Option<f32>, other: f32| Some(least.map_or(other, |least| least.min(other)));
        let sampling = plan.job.sampling;
        if plan.has_steps {
            self.step = smaller(self.step, plan.job.step);
            self.shadow_step = smaller(self.shadow_step, plan.job.shadow_step);
        }
        self.quadrature = (plan.method == Method::Comb).then_some(match plan.job.quadrature {
            Quadrature::Midpoint => "midpoint",
            Quadrature::Corrected => "corrected",
        });
        self.estimate = self.estimate.into_iter().chain(estimate).reduce(f32::max);
        self.light_grids = plan.grids.iter().map(LightGrid::new).collect();
        self.samples_per_pixel = self.samples_per_pixel.max(sampling.most);
        self.adaptive = smaller(self.adaptive, sampling.tolerance);
        self.counts = self.counts.plus(counts);
        self.frames += 1;
        let rendered = (self.frames - self.same_frames) as f64;
        let pixels = f64::from(self.size[0]) * f64::from(self.size[1]) * rendered;
        self.mean_samples_per_pixel = self.counts.camera_rays as f64 / pixels;
    }

    /// Adds a picture that is the last one again: nothing was computed for it.
    pub(super) fn add_same(&mut self) {
        self.frames += 1;
        self.same_frames += 1;
    }
}

/// How a light finds its way through media.
#[derive(Clone, Debug, Serialize)]
pub(super) struct LightGrid {
    pub(super) depths: Depths,
    /// Error of the grid, also of one that was tried and not taken.
    pub(super) error: Option<f32>,
}

/// Where the optical depths towards a light come from.
#[derive(Clone, Copy, Debug, Serialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum Depths {
    /// Marching along each shadow ray.
    Direct,
    /// A grid of this many points across, across and along the light.
    Grid([u32; 3]),
}

impl LightGrid {
    fn new(choice: &GridChoice) -> Self {
        let depths = choice.grid.as_ref().map_or(Depths::Direct, |grid| Depths::Grid(grid.counts));
        Self { depths, error: choice.error }
    }
}

/// How a light map met its strokes.
#[derive(Clone, Debug, Serialize)]
pub(super) struct LightMap {
    pub(super) style: String,
    pub(super) size: u32,
    /// Of the fit; nothing for a map that was kept from an earlier run.
    pub(super) pixels: Option<usize>,
    pub(super) iterations: Option<usize>,
    pub(super) converged: Option<bool>,
    /// Difference to the colours asked for, over these.
    pub(super) residual: Option<f64>,
    /// The same of the white map and after each iteration.
    pub(super) residuals: Vec<f64>,
}

impl LightMap {
    pub(super) fn new(map: &FittedMap) -> Self {
        let fit = map.fit.as_ref();
        Self {
            style: map.style.clone(),
            size: map.table.size,
            pixels: fit.map(|fit| fit.pixels),
            iterations: fit.map(|fit| fit.iterations),
            converged: fit.map(|fit| fit.converged),
            residual: fit.map(|fit| fit.residual),
            residuals: fit.map_or_else(Vec::new, |fit| fit.history.clone()),
        }
    }
}

/// Time per phase.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub(super) struct Phases {
    /// Parsing and checking the scene.
    #[serde(serialize_with = "milliseconds")]
    pub(super) check: Duration,
    /// Compiling it.
    #[serde(serialize_with = "milliseconds")]
    pub(super) compile: Duration,
    /// Compiling the shader for the device.
    #[serde(serialize_with = "milliseconds")]
    pub(super) prepare: Duration,
    /// Preparing styles.
    #[serde(serialize_with = "milliseconds")]
    pub(super) styles: Duration,
    /// Choosing the step size.
    #[serde(serialize_with = "milliseconds")]
    pub(super) pilot: Duration,
    /// Choosing and filling the grids of lights.
    #[serde(serialize_with = "milliseconds")]
    pub(super) grids: Duration,
    /// Computing the pictures.
    #[serde(serialize_with = "milliseconds")]
    pub(super) render: Duration,
    /// Encoding and writing them.
    #[serde(serialize_with = "milliseconds")]
    pub(super) write: Duration,
}

fn counts<S: Serializer>(counts: &Counts, serializer: S) -> Result<S::Ok, S::Error> {
    let mut map = serializer.serialize_map(Some(4))?;
    map.serialize_entry("camera_rays", &counts.camera_rays)?;
    map.serialize_entry("rays", &counts.rays)?;
    map.serialize_entry("samples", &counts.samples)?;
    map.serialize_entry("evaluations", &counts.evaluations)?;
    map.end()
}

fn milliseconds<S: Serializer>(time: &Duration, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_f64(time.as_secs_f64() * 1e3)
}

/// Runs `work` and adds the time it took.
pub(super) fn timed<T>(total: &mut Duration, work: impl FnOnce() -> T) -> T {
    let started = Instant::now();
    let value = work();
    *total += started.elapsed();
    value
}
