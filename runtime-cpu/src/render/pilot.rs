//! Chooses the distance between samples of media: renders a few rays, halves the step until the
//! picture stops changing, then takes a step between the last two.
//!
//! The change that half a step makes goes like a power of the step. Two estimates tell which, and so
//! at which step the change would be [`AIM`] of what is allowed. The power is held between [`LEAST_POWER`]
//! and [`GREATEST_POWER`] and the step between the last one that failed and its half: what is
//! noise in the estimates cannot lead far away.
//!
//! One step for the whole picture (algorithms.md §5.1): the difference between two steps on one
//! ray says little about that ray's error, but its rms over many rays is a safe estimate.

use super::Stats;
use super::camera::camera_ray;
use super::fields::{Batch, Fields};
use super::film::Radiance;
use super::scene::{Batches, Integrator, Scene};
use crate::interp::Tapes;
use crate::math::fun::{exp2, log2};
use rayon::prelude::*;
use vol_compiler::frame::{Aabb, Frame, Job, Sampling};
use vol_compiler::program::Program;

/// Rays of the pilot.
const RAYS: usize = 256;

/// Rays that one thread takes at a time.
const RAYS_PER_TASK: usize = 16;

/// The first step is this fraction of the diagonal of the media's box.
const FIRST_FRACTION: f32 = 1.0 / 24.0;

/// Most halvings of the first step.
const MAX_HALVINGS: u32 = 7;

/// Most samples that the pilot may take, so that it ends within seconds. Counted, not timed: the
/// step must not depend on how busy the machine is.
const BUDGET: u64 = 16_000_000;

/// Samples of a round over those of the one before: twice as many nodes, and from each of them
/// twice as many along the shadow rays.
const GROWTH: u64 = 4;

/// A shadow ray's step over a camera ray's: half the samples for 1.1 to 1.4 times the error
/// (algorithms.md §5.2).
const SHADOW_RATIO: f32 = 2.0;

/// Part of the allowed error that an interpolated step is meant to have.
const AIM: f32 = 0.8;

/// Least power of the step that the error may go with: that of density with jumps.
const LEAST_POWER: f32 = 1.0;

/// Greatest power: 2 for smooth density, and somewhat more where the noise begins to be resolved.
const GREATEST_POWER: f32 = 3.0;

/// What the pilot found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepChoice {
    /// For [`Job::step`].
    pub step: f32,
    /// For [`Job::shadow_step`].
    pub shadow_step: f32,
    /// Root mean square over the pilot's rays of the difference that half this step makes to the
    /// colour, over the root mean square of the colour: measured at steps about this one.
    pub estimate: f32,
}

/// A large step of which half would change the picture by at most `max_error` (relative, rms), as
/// far as a limited number of samples can tell; see [`StepChoice::estimate`].
///
/// Without media: step 1, nothing done. The result depends on the arguments alone.
#[must_use]
pub fn choose_step(program: &Program, frame: &Frame, size: [u32; 2], max_error: f32) -> StepChoice {
    if frame.media.is_empty() {
        return StepChoice { step: 1.0, shadow_step: 1.0, estimate: 0.0 };
    }
    let tapes = Tapes::new(program);
    let expose = |step: f32| {
        let job = Job { size, step, shadow_step: SHADOW_RATIO * step, sampling: Sampling::CENTRE };
        let scene = Scene::<f32>::new(frame, &job);
        expose(&scene, || Batch::new(&tapes, frame))
    };
    let mut step = first_step(frame);
    let (mut coarse, _) = expose(step);
    let mut before = None;
    let mut halvings = 0;
    loop {
        let (fine, stats) = expose(0.5 * step);
        let estimate = difference(&coarse, &fine);
        halvings += 1;
        let spent = stats.medium_samples + stats.shadow_samples + stats.region_evaluations;
        if estimate <= max_error || halvings == MAX_HALVINGS || GROWTH * spent > BUDGET {
            let (step, estimate) = between(step, estimate, before, max_error);
            return StepChoice { step, shadow_step: SHADOW_RATIO * step, estimate };
        }
        before = Some(estimate);
        step *= 0.5;
        coarse = fine;
    }
}

/// The step to take, and the estimate there, given the last step with its estimate and the estimate
/// of twice that step, which failed.
fn between(step: f32, estimate: f32, before: Option<f32>, max_error: f32) -> (f32, f32) {
    let passed = estimate <= max_error;
    let growth = before.filter(|_| estimate > 0.0).map(|before| log2(before / estimate));
    let Some(growth) = growth.filter(|growth| growth.is_finite()) else {
        return (if passed { step } else { 0.5 * step }, estimate);
    };
    let power = growth.clamp(LEAST_POWER, GREATEST_POWER);
    // From a step that passed up to its double, else down to its half.
    let (least, most) = if passed { (1.0, 2.0) } else { (0.5, 1.0) };
    let ratio = exp2(log2(AIM * max_error / estimate) / power).clamp(least, most);
    (ratio * step, exp2(power * log2(ratio)) * estimate)
}

/// A fraction of the diagonal of the box around the media, or around all if that is infinite.
pub(super) fn first_step(frame: &Frame) -> f32 {
    let mut around = Aabb { lo: [f32::INFINITY; 3], hi: [f32::NEG_INFINITY; 3] };
    for medium in &frame.media {
        for axis in 0..3 {
            around.lo[axis] = around.lo[axis].min(medium.bounds.lo[axis]);
            around.hi[axis] = around.hi[axis].max(medium.bounds.hi[axis]);
        }
    }
    let diagonal = |bounds: &Aabb| {
        let squares = (0..3).map(|axis| (bounds.hi[axis] - bounds.lo[axis]).powi(2));
        squares.sum::<f32>().sqrt()
    };
    let sizes = [diagonal(&around), diagonal(&frame.bounds)];
    let size = sizes.into_iter().find(|&size| size > 0.0 && size < 1e5).unwrap_or(1.0);
    FIRST_FRACTION * size
}

/// The pilot's rays, in the same places for every step.
fn expose<F: Fields<Real = f32>>(
    scene: &Scene<f32>,
    fields: impl Fn() -> F + Sync,
) -> (Vec<Radiance<f32>>, Stats) {
    let rays: Vec<_> = (0..RAYS).map(|index| camera_ray(scene, place(scene, index))).collect();
    let render = |rays: &[_]| {
        let mut integrator = Integrator::new(scene, fields(), Batches::DEFAULT);
        (integrator.radiance(rays), integrator.stats)
    };
    let parts: Vec<_> = rays.par_chunks(RAYS_PER_TASK).map(render).collect();
    let mut stats = Stats::default();
    parts.iter().for_each(|part| stats.add(&part.1));
    (parts.into_iter().flat_map(|part| part.0).collect(), stats)
}

/// Places of low discrepancy over the picture: multiples of the powers of the plastic number.
fn place(scene: &Scene<f32>, index: usize) -> [f32; 2] {
    let along = |ratio: f64| (0.5 + (index + 1) as f64 * ratio).fract() as f32;
    [along(0.754_877_666_246_692_8) * scene.size[0], along(0.569_840_290_998_053_2) * scene.size[1]]
}

/// Rms of the difference over rms of the picture.
fn difference(coarse: &[Radiance<f32>], fine: &[Radiance<f32>]) -> f32 {
    let (mut changed, mut whole) = (0.0_f64, 0.0_f64);
    for (a, b) in coarse.iter().zip(fine) {
        for (&a, &b) in a.color.iter().zip(&b.color) {
            changed += (f64::from(a) - f64::from(b)).powi(2);
            whole += f64::from(b).powi(2);
        }
    }
    if changed > 0.0 { (changed / whole.max(f64::MIN_POSITIVE)).sqrt() as f32 } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_power_law_is_met() {
        for power in [1.0_f32, 1.7, 2.0, 3.0] {
            let law = |step: f32| 0.01 * step.powf(power);
            for max_error in [0.011, 0.015, 0.019] {
                // 1 passes, 2 fails.
                let (step, estimate) = between(1.0, law(1.0), Some(law(2.0)), max_error);
                let aim = (AIM * max_error).max(0.01);
                assert!((law(step) / aim - 1.0).abs() < 1e-4, "{power} {max_error} {step}");
                assert!((estimate / law(step) - 1.0).abs() < 1e-4 && estimate <= max_error);
            }
        }
    }

    #[test]
    fn steps_stay_between_the_last_two() {
        // Passed by far, or with estimates that say nothing.
        assert!(between(1.0, 1e-4, Some(1.1e-2), 1e-2).0 <= 2.0);
        assert_eq!(between(1.0, 9.9e-3, Some(1.1e-2), 1e-2), (1.0, 9.9e-3));
        assert_eq!(between(1.0, 0.0, Some(1.1e-2), 1e-2), (1.0, 0.0));
        assert_eq!(between(1.0, 1e-3, None, 1e-2), (1.0, 1e-3));
        // Failed: at most as far as the half.
        assert_eq!(between(1.0, 1.0, Some(1.0), 1e-2), (0.5, 0.5));
        assert_eq!(between(1.0, 1.0, None, 1e-2), (0.5, 1.0));
        let (step, estimate) = between(1.0, 1.1e-2, Some(4.4e-2), 1e-2);
        assert!(step > 0.8 && step < 0.9 && (estimate - 8e-3).abs() < 1e-5, "{step} {estimate}");
    }
}
