//! Chooses how media are sampled: renders a few rays with both quadratures, halves the step until the
//! error of one is small enough, then takes the cheaper one and a step between the last two.
//!
//! **Error.** At step h it goes like a power p of h, so that half a step takes away all but 2^-p of it: what
//! half a step changes, over 1 - 2^-p, is the error. p comes from two halvings and is held between [`LEAST_POWER`]
//! and [`GREATEST_POWER`]. The corrected form at the finest step is a second witness of the midpoint form: the
//! larger of both counts, and neither is believed before the third step.
//!
//! **Rays.** One step for the whole picture (algorithms.md §5.1): one ray's difference says little about
//! its error, but its rms over many rays is safe. Rays that meet a box of a medium are one stratum,
//! all others, which may see shadows of media, another; each counts as its share of the picture, so that a
//! medium in a corner gets as many rays as one that fills the picture. The mean square of the differences is
//! taken [`SAFETY`] standard errors above what the rays say.
//!
//! **Work** is counted in samples, not in time: the choice must not depend on how busy the machine is. A
//! round that would cost more than the picture deserves is stopped and not used.

use super::Stats;
use super::camera::{Ray, slab};
use super::fields::Batch;
use super::film::Radiance;
use super::sampling::sample_ray;
use super::scene::{Batches, Integrator, Purse, Scene};
use super::survey;
use crate::interp::Tapes;
use crate::math::fun::{exp2, log2};
use rayon::prelude::*;
use vol_compiler::frame::{Frame, Job, Quadrature, Sampling};
use vol_compiler::program::Program;

/// Most rays that meet media.
const RAYS: usize = 256;

/// Most other rays.
const OTHER_RAYS: usize = 128;

/// Rays that one thread takes at a time.
const RAYS_PER_TASK: usize = 16;

/// Pixels that are tried to find them.
const CANDIDATES: u32 = 16_384;

/// Most halvings of the first step.
const MAX_HALVINGS: u32 = 9;

/// Samples that a round may always take: a second or two.
const FREE_BUDGET: u64 = 16_000_000;

/// Samples that no round may exceed.
pub(super) const MOST_BUDGET: u64 = 1_000_000_000;

/// Between the two, a round may cost this part of the picture at its step.
const BUDGET_SHARE: f64 = 1.0;

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

/// Greatest power: 3 for the corrected form, and for smooth density where the noise begins to be resolved.
const GREATEST_POWER: f32 = 3.0;

/// A lower power comes from parts that are missed now and then: between two steps nothing is sure.
const STEADY_POWER: f32 = 1.5;

/// Standard errors of the mean square that are added to it.
const SAFETY: f64 = 1.0;

/// Both quadratures.
const FORMS: [Quadrature; 2] = [Quadrature::Midpoint, Quadrature::Corrected];

/// What the pilot found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepChoice {
    /// For [`Job::step`].
    pub step: f32,
    /// For [`Job::shadow_step`].
    pub shadow_step: f32,
    /// For [`Job::quadrature`].
    pub quadrature: Quadrature,
    /// Estimated root mean square error of the picture's colours, over the root mean square of the colours;
    /// above what was asked for if that could not be met.
    pub estimate: f32,
}

impl StepChoice {
    fn new(step: f32, quadrature: Quadrature, estimate: f32) -> Self {
        Self { step, shadow_step: SHADOW_RATIO * step, quadrature, estimate }
    }

    /// The job that follows from it.
    #[must_use]
    pub fn job(&self, size: [u32; 2], sampling: Sampling) -> Job {
        let Self { step, shadow_step, quadrature, .. } = *self;
        Job { size, step, shadow_step, quadrature, sampling }
    }
}

/// The cheapest way to sample media with which the picture's error from that is at most `max_error` (relative,
/// rms), as far as a limited number of samples can tell; see [`StepChoice::estimate`].
///
/// Without media: step 1, nothing done. The result depends on the arguments alone.
#[must_use]
pub fn choose_step(program: &Program, frame: &Frame, size: [u32; 2], max_error: f32) -> StepChoice {
    if frame.media.is_empty() {
        return StepChoice::new(1.0, Quadrature::Midpoint, 0.0);
    }
    let tapes = Tapes::new(program);
    let pilot = Pilot::new(frame, &tapes, size);
    let mut rounds: Vec<Round> = Vec::new();
    let mut step = survey::first_step(frame, &pilot.rays[..pilot.meeting], Batch::new(&tapes, frame));
    let mut limit = FREE_BUDGET;
    loop {
        match pilot.round(step, limit) {
            Some(round) => rounds.push(round),
            // Even the first step is too short.
            None if rounds.is_empty() && step < 1e6 => {
                step *= 4.0;
                continue;
            }
            None => break,
        }
        let last = &rounds[rounds.len() - 1];
        let spent = last.costs[0] + last.costs[1];
        limit = FREE_BUDGET.max(MOST_BUDGET.min((BUDGET_SHARE * pilot.scale * spent as f64) as u64));
        let met = rounds.len() > 2 && pilot.candidates(&rounds).iter().any(|form| form.error <= max_error);
        if met || rounds.len() as u32 > MAX_HALVINGS || GROWTH * spent > limit {
            break;
        }
        step *= 0.5;
    }
    pilot.decide(&rounds, step, max_error)
}

/// The pilot's rays, in the same places for every step.
pub(super) struct Pilot<'a> {
    frame: &'a Frame,
    tapes: &'a Tapes,
    size: [u32; 2],
    /// Those that meet media first.
    rays: Vec<Ray<f32>>,
    /// How many of them meet media.
    meeting: usize,
    /// Part of the picture that a ray of each stratum stands for.
    shares: [f64; 2],
    /// Work of the whole picture, one sample per pixel, over that of the rays.
    pub(super) scale: f64,
}

/// Both pictures at one step.
struct Round {
    step: f32,
    pictures: [Vec<Radiance<f32>>; 2],
    /// Samples taken.
    costs: [u64; 2],
}

/// What is known of a quadrature at the last step but one.
#[derive(Clone, Copy, Debug)]
struct Candidate {
    quadrature: Quadrature,
    step: f32,
    error: f32,
    /// Error at twice the step.
    before: Option<f32>,
    /// Samples at this step.
    cost: u64,
}

impl<'a> Pilot<'a> {
    pub(super) fn new(frame: &'a Frame, tapes: &'a Tapes, size: [u32; 2]) -> Self {
        let scene = Scene::<f32>::new(
            frame,
            &StepChoice::new(1.0, Quadrature::Midpoint, 0.0).job(size, Sampling::CENTRE),
        );
        let places = pixels(size);
        let count = places.len();
        let rays = places.map(|pixel| sample_ray(&scene, pixel, 0));
        let (mut meeting, mut others): (Vec<_>, Vec<_>) = rays.partition(|ray| meets_media(&scene, ray));
        let portions = [meeting.len(), others.len()].map(|part| part as f64 / count as f64);
        meeting.truncate(RAYS);
        others.truncate(OTHER_RAYS);
        let share = |portion: f64, taken: usize| portion / taken.max(1) as f64;
        let shares = [share(portions[0], meeting.len()), share(portions[1], others.len())];
        let pixels = f64::from(size[0]) * f64::from(size[1]);
        let scale = pixels * portions[0].max(shares[1]) / meeting.len().max(1) as f64;
        let meets = meeting.len();
        meeting.append(&mut others);
        Self { frame, tapes, size, rays: meeting, meeting: meets, shares, scale }
    }

    /// Renders the rays at one step; nothing if that takes more samples than `limit`.
    fn round(&self, step: f32, limit: u64) -> Option<Round> {
        let midpoint = self.expose(StepChoice::new(step, FORMS[0], 0.0), limit)?;
        let corrected = self.expose(StepChoice::new(step, FORMS[1], 0.0), limit)?;
        Some(Round {
            step,
            costs: [cost(&midpoint.1), cost(&corrected.1)],
            pictures: [midpoint.0, corrected.0],
        })
    }

    fn expose(&self, choice: StepChoice, limit: u64) -> Option<(Vec<Radiance<f32>>, Stats)> {
        let scene = Scene::<f32>::new(self.frame, &choice.job(self.size, Sampling::CENTRE));
        self.expose_scene(&scene, limit)
    }

    /// Renders the rays in a scene of the frame; nothing if that takes more samples than `limit`.
    pub(super) fn expose_scene(&self, scene: &Scene<f32>, limit: u64) -> Option<(Vec<Radiance<f32>>, Stats)> {
        let purse = Purse::new(limit);
        let render = |rays: &[_]| {
            let fields = Batch::new(self.tapes, self.frame);
            let mut integrator = Integrator::new(scene, fields, Batches::DEFAULT).paid_from(&purse);
            (integrator.radiance(rays), integrator.stats)
        };
        let parts: Vec<_> = self.rays.par_chunks(RAYS_PER_TASK).map(render).collect();
        let mut stats = Stats::default();
        parts.iter().for_each(|part| stats.add(&part.1));
        let radiances = parts.into_iter().flat_map(|part| part.0).collect();
        (!purse.is_overdrawn()).then_some((radiances, stats))
    }

    /// What the rounds say about each quadrature, two of them at least.
    fn candidates(&self, rounds: &[Round]) -> Vec<Candidate> {
        let [.., coarse, fine] = rounds else { return Vec::new() };
        let before = rounds.len().checked_sub(3).map(|index| &rounds[index]);
        let candidate = |(form, &quadrature): (usize, &Quadrature)| {
            let change = self.difference(&coarse.pictures[form], &fine.pictures[form]);
            let earlier = before.map(|round| self.difference(&round.pictures[form], &coarse.pictures[form]));
            let power = power_of(change, earlier).unwrap_or(LEAST_POWER);
            let all = 1.0 / (1.0 - exp2(-power));
            let witness = self.difference(&coarse.pictures[form], &fine.pictures[1]);
            let error = (all * change).max(witness);
            let before = earlier.map(|earlier| all * earlier);
            Candidate { quadrature, step: coarse.step, error, before, cost: coarse.costs[form] }
        };
        FORMS.iter().enumerate().map(candidate).collect()
    }

    /// The cheapest quadrature that meets the error, else the best one.
    fn decide(&self, rounds: &[Round], step: f32, max_error: f32) -> StepChoice {
        let best = self.candidates(rounds).into_iter().map(|form| {
            let (step, estimate) = between(form.step, form.error, form.before, max_error);
            let work = form.cost as f32 * (form.step / step).powi(2);
            (
                estimate > max_error,
                if estimate > max_error { estimate } else { work },
                StepChoice::new(step, form.quadrature, estimate),
            )
        });
        let best =
            best.min_by(|a, b| (a.0, a.1).partial_cmp(&(b.0, b.1)).unwrap_or(std::cmp::Ordering::Equal));
        match (best, rounds) {
            (Some((_, _, choice)), _) => choice,
            // One step only: that both forms agree is all there is to say.
            (None, [only]) => {
                let estimate = self.difference(&only.pictures[0], &only.pictures[1]);
                StepChoice::new(only.step, Quadrature::Midpoint, estimate)
            }
            // Not even that: all of the picture may be wrong.
            (None, _) => StepChoice::new(step, Quadrature::Midpoint, 1.0),
        }
    }

    /// Rms of the difference over rms of the finer picture.
    pub(super) fn difference(&self, coarse: &[Radiance<f32>], fine: &[Radiance<f32>]) -> f32 {
        let square = |a: f32| f64::from(a).powi(2);
        let apart = |(a, b): (&Radiance<f32>, &Radiance<f32>)| -> f64 {
            a.color.iter().zip(&b.color).map(|(&a, &b)| (f64::from(a) - f64::from(b)).powi(2)).sum()
        };
        let changes: Vec<f64> = coarse.iter().zip(fine).map(apart).collect();
        let (mut changed, mut variance, mut whole) = (0.0, 0.0, 0.0);
        let strata = [0..self.meeting, self.meeting..changes.len()];
        for (stratum, share) in strata.into_iter().zip(self.shares) {
            let count = stratum.len() as f64;
            let sum: f64 = changes[stratum.clone()].iter().sum();
            let mean = sum / count.max(1.0);
            let spread: f64 = changes[stratum.clone()].iter().map(|change| (change - mean).powi(2)).sum();
            changed += share * sum;
            variance += share * share * spread * (count / (count - 1.0).max(1.0));
            whole += share * fine[stratum].iter().flat_map(|ray| ray.color).map(square).sum::<f64>();
        }
        let bound = changed + SAFETY * variance.sqrt();
        if bound > 0.0 { (bound / whole.max(f64::MIN_POSITIVE)).sqrt() as f32 } else { 0.0 }
    }
}

/// Samples of a part.
pub(super) fn cost(stats: &Stats) -> u64 {
    stats.medium_samples + stats.shadow_samples + stats.region_evaluations
}

/// The power of the step with which the change by half a step goes, from two changes in a row.
fn power_of(change: f32, earlier: Option<f32>) -> Option<f32> {
    let growth = earlier.filter(|_| change > 0.0).map(|earlier| log2(earlier / change))?;
    let power = growth.clamp(LEAST_POWER, GREATEST_POWER);
    // An error that falls faster than any power should was met by luck.
    let power = if growth > GREATEST_POWER + 0.5 { LEAST_POWER } else { power };
    growth.is_finite().then_some(power)
}

/// The step to take, and the error there, given the last step with its error and the error at twice that step,
/// which failed.
fn between(step: f32, error: f32, before: Option<f32>, max_error: f32) -> (f32, f32) {
    let passed = error <= max_error;
    let Some(power) = power_of(error, before) else {
        return (if passed { step } else { 0.5 * step }, error);
    };
    // From a step that passed up to its double if errors fall steadily, else down to its half.
    let (least, most) = match passed {
        true => (1.0, if power >= STEADY_POWER { 2.0 } else { 1.0 }),
        false => (0.5, 1.0),
    };
    let ratio = exp2(log2(AIM * max_error / error) / power).clamp(least, most);
    (ratio * step, exp2(power * log2(ratio)) * error)
}

/// Pixels all over the picture, in an order of which every beginning is spread evenly: of a
/// large picture multiples of the powers of the plastic number, of a small one all pixels, shuffled.
fn pixels([width, height]: [u32; 2]) -> impl ExactSizeIterator<Item = [u32; 2]> {
    let count = width.saturating_mul(height);
    let mut order: Vec<u32> = (0..count.min(CANDIDATES)).collect();
    if count <= CANDIDATES {
        order.sort_by_key(|&index| mixed(index));
    }
    order.into_iter().map(move |index| {
        if count <= CANDIDATES {
            return [index % width, index / width];
        }
        let along = |ratio: f64, length: u32| {
            let place = (0.5 + f64::from(index + 1) * ratio).fract() * f64::from(length);
            place as u32
        };
        [along(0.754_877_666_246_692_8, width), along(0.569_840_290_998_053_2, height)]
    })
}

/// A number that says nothing about `index`, another for each (finalizer of MurmurHash3).
fn mixed(index: u32) -> u32 {
    let a = (index ^ (index >> 16)).wrapping_mul(0x85eb_ca6b);
    let b = (a ^ (a >> 13)).wrapping_mul(0xc2b2_ae35);
    b ^ (b >> 16)
}

/// Whether a ray meets a box in which a medium may be.
fn meets_media(scene: &Scene<f32>, ray: &Ray<f32>) -> bool {
    scene.media.iter().any(|medium| {
        let cells = &medium.cells;
        slab(ray, medium.lo, medium.hi).is_some()
            && (cells.is_empty() || cells.iter().any(|&[lo, hi]| slab(ray, lo, hi).is_some()))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_power_law_is_met() {
        for power in [1.6_f32, 2.0, 3.0] {
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
        assert_eq!(between(1.0, 1e-4, Some(1.1e-2), 1e-2), (1.0, 1e-4));
        assert_eq!(between(1.0, 0.0, Some(1.1e-2), 1e-2), (1.0, 0.0));
        assert_eq!(between(1.0, 1e-3, None, 1e-2), (1.0, 1e-3));
        // Failed: at most as far as the half.
        assert_eq!(between(1.0, 1.0, Some(1.0), 1e-2), (0.5, 0.5));
        assert_eq!(between(1.0, 1.0, None, 1e-2), (0.5, 1.0));
        let (step, estimate) = between(1.0, 1.1e-2, Some(4.4e-2), 1e-2);
        assert!(step > 0.8 && step < 0.9 && (estimate - 8e-3).abs() < 1e-5, "{step} {estimate}");
    }
}
