//! A few rays of a picture by which is judged how it should be sampled.
//!
//! **Rays.** One ray's difference says little about its error, but its rms over many rays is safe. Rays that meet a box of a medium are one stratum,
//! all others, which may see shadows of media, another; each counts as its share of the picture, so that a
//! medium in a corner gets as many rays as one that fills the picture. The mean square of the differences is
//! taken [`SAFETY`] standard errors above what the rays say.

use super::Stats;
use super::camera::{Ray, slab};
use super::fields::Batch;
use super::film::Radiance;
use super::sampling::sample_ray;
use super::scene::{Batches, Integrator, Purse, Scene};
use super::spread::spread_pixels;
use super::step_choice::StepChoice;
use crate::interp::Tapes;
use crate::real::{Vec3, sub};
use rayon::prelude::*;
use vol_compiler::frame::{Frame, MediumFrame, Sampling};
use vol_compiler::tape::Tape;

/// Most rays of each stratum: of those that meet media, and of the others.
const RAYS: [usize; 2] = [256, 128];

/// Rays that one thread takes at a time.
const RAYS_PER_TASK: usize = 16;

/// Pixels that are tried to find them.
const CANDIDATES: usize = 16_384;

/// Samples that no round may exceed: a minute.
pub(super) const MOST_BUDGET: u64 = 1_000_000_000;

/// Standard errors of the mean square that are added to it.
const SAFETY: f64 = 2.0;

/// Operations of the functions of media that make a usual sample. Where they are longer, a sample counts as several:
/// a union of thousands of tubes must end, too.
const USUAL_OPERATIONS: u64 = 512;

/// Steps that a loop is taken to go through: most end early.
const USUAL_STEPS: u64 = 4;

/// The pilot's rays, in the same places for every step.
pub(super) struct Pilot<'a> {
    pub(super) frame: &'a Frame,
    pub(super) tapes: &'a Tapes,
    pub(super) size: [u32; 2],
    /// Those that meet media, and others.
    pub(super) rays: [Vec<Ray<f32>>; 2],
    /// Part of the picture that each stratum is.
    portions: [f64; 2],
    /// Work of the whole picture, one sample per pixel, over that of the rays.
    pub(super) scale: f64,
    /// How many usual samples one of this scene is worth: see [`weight`].
    pub(super) weight: u64,
}

/// What rays of each stratum see: a beginning of all.
pub(super) type Picture = [Vec<Radiance<f32>>; 2];

impl<'a> Pilot<'a> {
    pub(super) fn new(frame: &'a Frame, tapes: &'a Tapes, size: [u32; 2]) -> Self {
        let scene = Scene::<f32>::new(frame, &StepChoice::ANY.job(size, Sampling::CENTRE));
        let places = spread_pixels(size, CANDIDATES);
        let count = places.len();
        let rays = places.into_iter().map(|pixel| sample_ray(&scene, pixel, 0));
        let (meeting, others): (Vec<_>, Vec<_>) = rays.partition(|ray| meets_media(&scene, ray));
        let mut rays = [meeting, others];
        let portions = [0, 1].map(|stratum| rays[stratum].len() as f64 / count as f64);
        rays.iter_mut().zip(RAYS).for_each(|(rays, most)| rays.truncate(most));
        let [meets, passes] = [0, 1].map(|stratum| rays[stratum].len().max(1) as f64);
        let pixels = f64::from(size[0]) * f64::from(size[1]);
        let scale = pixels * portions[0].max(portions[1] / passes) / meets;
        Self { frame, tapes, size, rays, portions, scale, weight: weight(frame, tapes) }
    }

    /// How many rays there are in each stratum.
    pub(super) fn all(&self) -> [usize; 2] {
        [self.rays[0].len(), self.rays[1].len()]
    }

    /// Renders the first rays of each stratum in a scene of the frame; nothing if that takes more usual samples
    /// than `limit`.
    pub(super) fn expose_scene(
        &self,
        scene: &Scene<f32>,
        counts: [usize; 2],
        limit: u64,
    ) -> Option<(Picture, Stats)> {
        let purse = Purse::new(limit / self.weight);
        let render = |rays: &[_]| {
            let fields = Batch::new(self.tapes, self.frame);
            let mut integrator =
                Integrator::new(scene, fields, Batches::for_media(scene.media.len())).paid_from(&purse);
            (integrator.radiance(rays), integrator.stats)
        };
        let mut stats = Stats::default();
        let picture = [0, 1].map(|stratum| {
            let rays = &self.rays[stratum][..counts[stratum]];
            let parts: Vec<_> = rays.par_chunks(RAYS_PER_TASK).map(render).collect();
            parts.iter().for_each(|part| stats.add(&part.1));
            parts.into_iter().flat_map(|part| part.0).collect()
        });
        (!purse.is_overdrawn()).then_some((picture, stats))
    }

    /// Rms of the difference over rms of the finer picture, from the rays that both have.
    pub(super) fn difference(&self, coarse: &Picture, fine: &Picture) -> f32 {
        self.difference_in(coarse, fine, fine)
    }

    /// Rms of the difference over rms of the picture in which it counts, from the rays that all have.
    pub(super) fn difference_in(&self, coarse: &Picture, fine: &Picture, whole_picture: &Picture) -> f32 {
        let (mut changed, mut variance, mut whole) = (0.0, 0.0, 0.0);
        for stratum in 0..2 {
            let pairs = coarse[stratum].iter().zip(&fine[stratum]);
            let changes: Vec<f64> = pairs.map(|(a, b)| squared(sub(a.color, b.color))).collect();
            let count = changes.len().max(1) as f64;
            let share = self.portions[stratum] / count;
            let sum: f64 = changes.iter().sum();
            let mean = sum / count;
            let spread: f64 = changes.iter().map(|change| (change - mean).powi(2)).sum();
            changed += share * sum;
            variance += share * share * spread * (count / (count - 1.0).max(1.0));
            let counting = whole_picture[stratum].iter().take(changes.len());
            whole += share * counting.map(|ray| squared(ray.color)).sum::<f64>();
        }
        let bound = changed + SAFETY * variance.sqrt();
        if bound > 0.0 { (bound / whole.max(f64::MIN_POSITIVE)).sqrt() as f32 } else { 0.0 }
    }
}

/// How many usual samples one in the dearest medium is worth, at least 1.
fn weight(frame: &Frame, tapes: &Tapes) -> u64 {
    let operations = |medium: &MediumFrame| {
        [medium.region, medium.interior].map(|function| operations(tapes.tape(function))).iter().sum::<u64>()
    };
    (frame.media.iter().map(operations).max().unwrap_or(0) / USUAL_OPERATIONS).max(1)
}

/// Operations of a tape, as many as are usually run.
fn operations(tape: &Tape) -> u64 {
    let loops = tape.loops.iter().map(|inner| USUAL_STEPS.min(inner.most.into()) * operations(&inner.body));
    tape.ops.len() as u64 + loops.sum::<u64>()
}

fn squared(color: Vec3<f32>) -> f64 {
    color.map(f64::from).map(|channel| channel * channel).iter().sum()
}

/// Samples of a part.
pub(super) fn cost(stats: &Stats) -> u64 {
    stats.medium_samples + stats.shadow_samples + stats.region_evaluations
}

/// Whether a ray meets a box in which a medium may be.
fn meets_media(scene: &Scene<f32>, ray: &Ray<f32>) -> bool {
    scene.media.iter().any(|medium| {
        let cells = &medium.cells;
        slab(ray, medium.lo, medium.hi).is_some() && (cells.is_empty() || cells.is_met_by(ray))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use vol_compiler::ir::text::parse_function;

    #[test]
    fn long_functions_count_more() {
        let text = |count: usize| {
            let steps: String = (1..=count).map(|i| format!("%{i} = mul %{} %0\n", i - 1)).collect();
            format!("fn f(1) {{\n%0 = input 0\n{steps}return %{count}\n}}")
        };
        let tape = |count| Tape::new(&parse_function(&text(count)).expect("well-formed text"));
        assert_eq!([operations(&tape(10)), operations(&tape(5000))], [11, 5001]);
    }
}
