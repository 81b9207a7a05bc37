//! The integrator: what a picture means.
//!
//! One text for two precisions: f32 with the batch evaluator for pictures, f64 with the reference
//! evaluator to check them. The WGSL twin is `compiler/src/wgsl/render.wgsl` with its folder.
//!
//! 1. `sampling`: places in each pixel; `camera`: a ray through each of them.
//! 2. `surface`: steps to the first surface as long as `stride` allows, false position onto it, its normal.
//! 3. `shade`: the surface's own light and the lights that reach it, each through `shadow`, those with a
//!    size through `penumbra`; `occlusion` by surfaces around.
//! 4. `medium`: absorption, emission and single scattering at the nodes of one `comb` per ray, or between
//!    them: `corrected`, by `panel`; `scatter` lights the nodes.
//! 5. `film`: `color = L + T * (surface or background)`, tiles, threads; `sampling` takes the mean.
//!
//! `step_choice` chooses the comb's step and which of the two by the rays of a `pilot`, after a `survey`; `spacing_choice` which media are
//! sampled farther apart; `grid_choice` where `shadow` looks depths up in a `light_grid`.
//!
//! Two further ways through the media, for comparison and on the CPU only, are behind `method`: `fixed_step`
//! is the plain marcher of the literature, `monte_carlo` an unbiased oracle that shares nothing with the comb.
//! Both read the media through `matter`.
//!
//! `cost` counts what each pixel asks of the scene, `profile` what each function and each of its parts takes.
//!
//! In f32 each operation is rounded by itself, in an order that neither threads nor batches change;
//! everything is finite, and what is skipped (boxes, zero scattering) adds exactly 0.

mod beam;
mod box_tree;
mod camera;
mod chord;
mod chunk;
mod comb;
mod corrected;
mod cost;
mod fields;
mod filled_grids;
mod film;
mod fixed_step;
mod grid_choice;
mod light_grid;
mod majorant;
mod marched;
mod matter;
mod medium;
mod memory;
mod method;
mod monte_carlo;
mod near;
mod occlusion;
mod panel;
mod penumbra;
mod pilot;
mod profile;
mod random;
mod sampling;
mod scatter;
mod scene;
mod shade;
mod shadow;
mod spacing;
mod spacing_choice;
mod spread;
mod step_choice;
mod stride;
mod styled;
mod surface;
mod survey;
#[cfg(test)]
pub(crate) mod tests;
mod tube_axis;

pub use crate::interp::meter::{FunctionCost, PartCost};
pub use cost::{PixelCost, render_costs};
pub use filled_grids::FilledGrids;
pub use grid_choice::{Choice, GridChoice, choose, choose_light_grids, choose_with};
pub use memory::memory_bound;
pub use method::{Method, NoMajorant, TubeBounds, fixed_step_default, render_by};

pub use profile::{Profile, profile};
pub use spread::spread_pixels;
pub use step_choice::{StepChoice, choose_step, least_step};

pub(crate) use camera::{FAR, Ray, camera_ray};
pub(crate) use fields::Batch;
#[cfg(test)]
pub(crate) use light_grid::Grid as LightDepths;
pub(crate) use light_grid::{fill as fill_light_grid, filling_bytes};
pub(crate) use scene::{Batches, Integrator, Scene};
pub(crate) use shadow::ShadowRay;
pub(crate) use styled::{NO_DEPTH, transfer_color};

use crate::interp::Tapes;
use fields::Reference;
use film::{Radiance, Watch, expose};
use rayon::prelude::*;
use sampling::Mean;
use std::sync::atomic::AtomicBool;
use std::time::Instant;
use vol_compiler::frame::{Frame, Image, Job, Pixel};
use vol_compiler::program::Program;

/// Pixels of a reference that one thread takes at a time: they are slow, and few.
const REFERENCE_PIXELS: usize = 4;

/// What a render did.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Stats {
    /// Camera rays: samples of pixels, and the probes of adaptive sampling.
    pub rays: u64,
    /// Rays towards lights.
    pub shadow_rays: u64,
    /// Distances and gradients of solids evaluated.
    pub surface_evaluations: u64,
    /// Regions of media evaluated, to find which nodes are inside.
    pub region_evaluations: u64,
    /// Nodes of camera rays inside media.
    pub medium_samples: u64,
    /// Nodes of shadow rays inside media.
    pub shadow_samples: u64,
    /// Sum over pixels and channels of the squared standard error, as the spread of each pixel's samples has
    /// it; 0 with one sample per pixel.
    pub variance: f64,
    /// From the call to the picture.
    pub milliseconds: f64,
}

impl Stats {
    /// Adds the counts of a part.
    fn add(&mut self, part: &Self) {
        self.rays += part.rays;
        self.shadow_rays += part.shadow_rays;
        self.surface_evaluations += part.surface_evaluations;
        self.region_evaluations += part.region_evaluations;
        self.medium_samples += part.medium_samples;
        self.shadow_samples += part.shadow_samples;
        self.variance += part.variance;
    }
}

/// Renders a picture, with as many threads as are asked for, else with those of the surrounding
/// pool. `progress` hears the number of pixels done, in any order of the tiles. `None` if
/// `cancelled` was set before the last tile.
pub fn render(
    program: &Program,
    frame: &Frame,
    job: &Job,
    threads: Option<usize>,
    progress: &(dyn Fn(u64) + Sync),
    cancelled: &AtomicBool,
) -> Option<(Image, Stats)> {
    let watch = Watch { progress, cancelled };
    let batches = Batches::for_media(frame.media.len());
    let render = || render_batches(program, frame, job, batches, &watch);
    let pool = threads.map(|count| rayon::ThreadPoolBuilder::new().num_threads(count).build());
    match pool {
        Some(Ok(pool)) => pool.install(render),
        // A machine that starts no more threads still has the surrounding pool.
        Some(Err(_)) | None => render(),
    }
}

/// [`render`] with batches of other sizes, for the test that they change nothing.
fn render_batches(
    program: &Program,
    frame: &Frame,
    job: &Job,
    batches: Batches,
    watch: &Watch<'_>,
) -> Option<(Image, Stats)> {
    render_scene(program, frame, job, &Scene::new(frame, job), batches, watch)
}

/// [`render`] of a scene that may say how its media are integrated.
fn render_scene(
    program: &Program,
    frame: &Frame,
    job: &Job,
    scene: &Scene<f32>,
    batches: Batches,
    watch: &Watch<'_>,
) -> Option<(Image, Stats)> {
    let started = Instant::now();
    let tapes = Tapes::of_frame(program, frame);
    let (pixels, mut stats) = expose(scene, job, batches, &|| Batch::new(&tapes, frame), watch)?;
    stats.milliseconds = started.elapsed().as_secs_f64() * 1e3;
    let pixels = pixels.into_iter().map(pixel).collect();
    Some((Image { width: job.size[0], height: job.size[1], pixels }, stats))
}

fn pixel(radiance: Radiance<f32>) -> Pixel {
    Pixel {
        color: radiance.color,
        transmittance: radiance.transmittance,
        depth: radiance.depth.unwrap_or(f32::INFINITY),
        error: radiance.doubt,
    }
}

/// The same picture in f64 with the reference evaluator: rgb, transmittance rgb and depth of each
/// pixel, rows from the top. Marches towards the lights whatever grids the frame holds. Slow; for small
/// pictures.
#[must_use]
pub fn render_reference(program: &Program, frame: &Frame, job: &Job) -> Vec<[f64; 7]> {
    let watch = Watch { progress: &|_| {}, cancelled: &AtomicBool::new(false) };
    let mut scene = Scene::<f64>::new(frame, job);
    scene.grids.clear();
    let picture = expose(&scene, job, Batches::DEFAULT, &|| Reference::new(program, frame), &watch);
    let pixels = picture.map_or_else(Vec::new, |(pixels, _)| pixels);
    let flat = |pixel: Radiance<f64>| {
        let ([r, g, b], [tr, tg, tb]) = (pixel.color, pixel.transmittance);
        [r, g, b, tr, tg, tb, pixel.depth.unwrap_or(f64::INFINITY)]
    };
    pixels.into_iter().map(flat).collect()
}

/// [`render_reference`] for some pixels only, given as column and row. Nothing if `cancelled` was set
/// before the last of them.
#[must_use]
pub fn reference_pixels(
    program: &Program,
    frame: &Frame,
    job: &Job,
    pixels: &[[u32; 2]],
    cancelled: &AtomicBool,
) -> Option<Vec<[f64; 3]>> {
    let scene = Scene::<f64>::new(frame, job);
    let render = |pixels: &[[u32; 2]]| {
        let mut integrator = Integrator::new(&scene, Reference::new(program, frame), Batches::DEFAULT);
        let means = integrator.sample_pixels(pixels, &job.sampling, cancelled)?;
        Some(means.iter().map(Mean::radiance).map(|pixel| pixel.color).collect::<Vec<_>>())
    };
    let parts: Option<Vec<_>> = pixels.par_chunks(REFERENCE_PIXELS).map(render).collect();
    Some(parts?.into_iter().flatten().collect())
}
