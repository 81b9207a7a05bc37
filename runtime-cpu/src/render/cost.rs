//! What each pixel costs: the picture with counts beside it.
//!
//! Each pixel's rays are a batch of their own, whose counts are read before and after. A pixel sees only its own
//! samples, so the picture is the same bit for bit, and the counts depend on neither threads nor tiles. They say what
//! is asked of the functions of the scene; what boxes and curves pass over inside an operation does not show.

use super::fields::Fields;
use super::film::{Watch, assemble, over_tiles};
use super::method::{Method, NoMajorant, Way};
use super::scene::{Batches, Integrator, Scene};
use super::{Stats, pixel};
use crate::interp::work::Known;
use crate::interp::{Evaluator, Tapes};
use std::sync::atomic::AtomicBool;
use std::time::Instant;
use vol_compiler::frame::{Frame, Image, Job, Pixel};
use vol_compiler::ir::FunctionId;
use vol_compiler::program::Program;

/// What the rays of a pixel ask of the scene, probes of adaptive sampling and shadow rays included. Looking up grids of
/// lights asks nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PixelCost {
    /// Points at which functions were evaluated, each function by itself.
    pub evaluations: u64,
    /// Operations of those functions, in additions: a dearer one counts as about as many as take as long.
    pub operations: u64,
}

/// The batch evaluator, counting.
struct Counting<'a> {
    evaluator: Evaluator<'a>,
    works: &'a [u64],
    cost: PixelCost,
}

impl Fields for Counting<'_> {
    type Real = f32;

    fn evaluate(&mut self, function: FunctionId, inputs: &[&[f32]], outputs: &mut [&mut [f32]]) {
        self.cost.evaluations += inputs[0].len() as u64;
        self.cost.operations += self.evaluator.evaluate_counted(function, inputs, outputs, self.works);
    }
}

/// [`render_by`](super::render_by()), and what each pixel costs, rows from the top; slower, for the small batches.
///
/// # Errors
/// [`NoMajorant`], of [`Method::MonteCarlo`] only.
pub fn render_costs(
    method: Method,
    program: &Program,
    frame: &Frame,
    job: &Job,
    progress: &(dyn Fn(u64) + Sync),
    cancelled: &AtomicBool,
) -> Result<Option<(Image, Stats, Vec<PixelCost>)>, NoMajorant> {
    let started = Instant::now();
    let watch = Watch { progress, cancelled };
    let scene = Scene { way: Way::new(method, program, frame)?, ..Scene::new(frame, job) };
    let tapes = Tapes::new(program);
    let works = Known::new(frame).works(&tapes);
    let tiles = over_tiles(job.size, &watch, |tile| {
        let evaluator = Evaluator::new(&tapes, frame);
        let fields = Counting { evaluator, works: &works, cost: PixelCost::default() };
        let mut integrator = Integrator::new(&scene, fields, Batches::DEFAULT);
        let alone = |place| {
            let means = integrator.sample_pixels(&[place], &job.sampling, cancelled)?;
            let mean = means.first()?;
            integrator.stats.variance += mean.variance();
            Some((pixel(mean.radiance()), std::mem::take(&mut integrator.fields.cost)))
        };
        let pixels: Option<Vec<_>> = tile.pixels().map(alone).collect();
        Some((tile, pixels?, integrator.stats))
    });
    let Some(tiles) = tiles else { return Ok(None) };
    let blank = Pixel { color: [0.0; 3], transmittance: [0.0; 3], depth: f32::INFINITY, error: 0.0 };
    let (picture, mut stats) = assemble(job.size, (blank, PixelCost::default()), tiles);
    stats.milliseconds = started.elapsed().as_secs_f64() * 1e3;
    let (pixels, costs) = picture.into_iter().unzip();
    Ok(Some((Image { width: job.size[0], height: job.size[1], pixels }, stats, costs)))
}
