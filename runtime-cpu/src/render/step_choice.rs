//! Chooses how media are sampled: renders a few rays with both quadratures, halves the step until the
//! error of one is small enough, then takes the cheaper one and a step between the last two.
//!
//! One step for the whole picture (algorithms.md §5.1).
//!
//! **Error.** At step h it goes like a power p of h, so that half a step takes away all but 2^-p of it: what
//! half a step changes, over 1 - 2^-p, is the error. p comes from two halvings and is held between [`LEAST_POWER`]
//! and [`GREATEST_POWER`]. The corrected form at the finest step is a second witness of the midpoint form: the
//! larger of both counts, and neither is believed before the third step.
//!
//! **Work** is counted in samples, not in time: the choice must not depend on how busy the machine is. What was asked
//! for counts, not how large the picture is; samples of long functions count more. Where rounds grow dear fewer rays are taken, a beginning of those
//! before; and only while the errors so far say that what is left is within [`MOST_BUDGET`].

use super::comb::{LAST_NODE, MAX_NODES};
use super::fields::Batch;
use super::pilot::{MOST_BUDGET, Picture, Pilot, cost};
use super::scene::Scene;
use super::survey;
use crate::interp::Tapes;
use crate::math::fun::{exp2, log2};
use vol_compiler::frame::{Aabb, Frame, Job, Quadrature, Sampling};
use vol_compiler::program::Program;

/// As many are always taken.
const LEAST_RAYS: [usize; 2] = [128, 48];

/// Most halvings of the first step.
const MAX_HALVINGS: u32 = 12;

/// Samples that a round may always take: a second or two.
const FREE_BUDGET: u64 = 32_000_000;

/// Samples of a round over those of the one before: twice as many nodes, and from each of them
/// twice as many along the shadow rays.
const GROWTH: u64 = 4;

/// A shadow ray's step over a camera ray's: half the samples for 1.1 to 1.4 times the error
/// (algorithms.md §5.2).
const SHADOW_RATIO: f32 = 2.0;

/// Time for a sample of the corrected form over that of the midpoint form: measured, 1.2 to 1.3 with grids of lights.
pub(super) const CORRECTED_COST: f32 = 1.25;

/// An error that exceeds what is allowed by no more needs no further round: the step for it lies between the last two.
const NEARLY: f32 = 1.5;

/// Part of the allowed error that an interpolated step is meant to have.
const AIM: f32 = 0.8;

/// Least power of the step that the error may go with: that of density with jumps.
const LEAST_POWER: f32 = 1.0;

/// Greatest power: 3 for the corrected form, and for smooth density where the noise begins to be resolved.
const GREATEST_POWER: f32 = 3.0;

/// A lower power comes from parts that are missed now and then: between two steps nothing is sure.
const STEADY_POWER: f32 = 1.5;

/// Errors are hoped to fall with this power at least: at long steps they tell too little to give up.
const HOPED_POWER: f32 = 2.0;

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
    /// Of scenes without media.
    pub(super) const ANY: Self =
        Self { step: 1.0, shadow_step: SHADOW_RATIO, quadrature: Quadrature::Midpoint, estimate: 0.0 };

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
        return StepChoice::ANY;
    }
    let tapes = Tapes::of_frame(program, frame);
    Search::new(&Pilot::new(frame, &tapes, size), max_error).choice(max_error)
}

/// The shortest step with which no ray runs out of nodes on its way to the media and through them, in scene units; 0
/// where they have no bounds, as a ray ends somewhere in any case.
#[must_use]
pub fn least_step(frame: &Frame) -> f32 {
    let Some(bounds) = frame.media_bounds().filter(|bounds| bounds.diagonal() < survey::LONGEST) else {
        return 0.0;
    };
    let eye = Aabb { lo: frame.camera.origin, hi: frame.camera.origin };
    // Boxes are grown by a step to each side.
    let through = bounds.diagonal() / (MAX_NODES - 8) as f32;
    through.max(bounds.union(&eye).diagonal() / LAST_NODE)
}

/// Ways to meet an error.
#[derive(Clone, Copy, Debug)]
pub(super) struct StepChoices {
    /// With a sample for each step.
    pub(super) cheapest: StepChoice,
    /// By the midpoint rule, if it meets the error: samples of it can be farther apart in places.
    pub(super) midpoint: Option<StepChoice>,
}

/// Both pictures at one step.
struct Round {
    step: f32,
    /// Rays of each stratum.
    counts: [usize; 2],
    pictures: [Picture; 2],
    /// Samples taken.
    costs: [u64; 2],
}

impl Round {
    /// Samples of the next round with as many rays.
    fn next_cost(&self) -> u64 {
        GROWTH * (self.costs[0] + self.costs[1])
    }

    /// Rays of the next round: fewer if as many would be dear.
    fn next_counts(&self) -> [usize; 2] {
        let part = (FREE_BUDGET as f64 / self.next_cost().max(1) as f64).min(1.0);
        [0, 1].map(|stratum| {
            let count = self.counts[stratum];
            count.min(LEAST_RAYS[stratum].max((part * count as f64) as usize))
        })
    }

    /// Whether the next round costs little, or the round that is likely to end the search is still allowed, given
    /// what is known at the step before this one.
    fn may_go_on(&self, candidates: &[Candidate], max_error: f32) -> bool {
        if self.next_cost() <= FREE_BUDGET {
            return true;
        }
        let halved = |form: &Candidate| {
            let power = power_of(form.error, form.before).unwrap_or(LEAST_POWER);
            log2(form.error / max_error) / power.max(HOPED_POWER)
        };
        let halvings = candidates.iter().map(halved).fold(f32::INFINITY, f32::min);
        let thinned = LEAST_RAYS[0] as f32 / self.counts[0].max(LEAST_RAYS[0]) as f32;
        let last = thinned * exp2(2.0 * halvings.max(1.0)) * (self.costs[0] + self.costs[1]) as f32;
        last <= MOST_BUDGET as f32
    }
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
    /// Of how much more half a step takes, the logarithm to base 2: 1 if only camera rays are sampled, 2 where each of their
    /// samples marches to a light.
    growth: f32,
}

impl Candidate {
    /// Time at another step, about, in samples of the midpoint form at this one.
    fn work(&self, step: f32) -> f32 {
        let dear = if self.quadrature == Quadrature::Corrected { CORRECTED_COST } else { 1.0 };
        dear * self.cost as f32 * exp2(self.growth * log2(self.step / step))
    }
}

/// Pictures of the pilot's rays with finer and finer steps.
pub(super) struct Search<'a> {
    pilot: &'a Pilot<'a>,
    rounds: Vec<Round>,
    /// The last step that was tried.
    step: f32,
}

impl<'a> Search<'a> {
    /// Goes on until the error is nearly met.
    pub(super) fn new(pilot: &'a Pilot<'a>, max_error: f32) -> Self {
        let fields = Batch::new(pilot.tapes, pilot.frame);
        let least = least_step(pilot.frame);
        let first = survey::first_step(pilot.frame, &pilot.rays[0], fields);
        let mut search = Self { pilot, rounds: Vec::new(), step: first.max(least) };
        loop {
            let (counts, limit) = match search.rounds.last() {
                None => search.first_counts(),
                Some(last) => (last.next_counts(), MOST_BUDGET),
            };
            match search.round(counts, limit) {
                Some(round) => search.rounds.push(round),
                // Even the first step is too short.
                None if search.rounds.is_empty() && search.step < 1e6 => {
                    search.step *= 4.0;
                    continue;
                }
                None => break,
            }
            let (candidates, rounds) = (search.candidates(), &search.rounds);
            let met = rounds.len() > 2 && candidates.iter().any(|form| form.error <= NEARLY * max_error);
            let last = &rounds[rounds.len() - 1];
            let many = rounds.len() as u32 > MAX_HALVINGS || 0.5 * search.step < least;
            if met || many || !last.may_go_on(&candidates, max_error) {
                break;
            }
            search.step *= 0.5;
        }
        search
    }

    /// Rays of the first round, and the samples that it may take: with dear samples as few as can be judged by.
    fn first_counts(&self) -> ([usize; 2], u64) {
        let all = self.pilot.all();
        if self.pilot.weight == 1 {
            (all, FREE_BUDGET)
        } else {
            ([0, 1].map(|i| all[i].min(LEAST_RAYS[i])), MOST_BUDGET)
        }
    }

    /// Renders the first rays at the step; nothing if that takes more usual samples than `limit`.
    fn round(&self, counts: [usize; 2], limit: u64) -> Option<Round> {
        let expose = |quadrature| {
            let choice = StepChoice::new(self.step, quadrature, 0.0);
            let scene = Scene::<f32>::new(self.pilot.frame, &choice.job(self.pilot.size, Sampling::CENTRE));
            self.pilot.expose_scene(&scene, counts, limit)
        };
        let [midpoint, corrected] = [expose(FORMS[0])?, expose(FORMS[1])?];
        let costs = [&midpoint, &corrected].map(|(_, stats)| self.pilot.weight * cost(stats));
        Some(Round { step: self.step, counts, costs, pictures: [midpoint.0, corrected.0] })
    }

    /// What the rounds say about each quadrature, two of them at least.
    fn candidates(&self) -> Vec<Candidate> {
        let [.., coarse, fine] = self.rounds.as_slice() else { return Vec::new() };
        let before = self.rounds.len().checked_sub(3).map(|index| &self.rounds[index]);
        let candidate = |(form, &quadrature): (usize, &Quadrature)| {
            let change = self.pilot.difference(&coarse.pictures[form], &fine.pictures[form]);
            let earlier =
                before.map(|round| self.pilot.difference(&round.pictures[form], &coarse.pictures[form]));
            let power = power_of(change, earlier).unwrap_or(LEAST_POWER);
            let all = 1.0 / (1.0 - exp2(-power));
            let witness = self.pilot.difference(&coarse.pictures[form], &fine.pictures[1]);
            let error = (all * change).max(witness);
            let before = earlier.map(|earlier| all * earlier);
            let per_ray = |round: &Round| round.costs[form] as f32 / round.counts[0].max(1) as f32;
            let growth = log2(per_ray(fine) / per_ray(coarse).max(1.0)).clamp(1.0, 2.0);
            Candidate { quadrature, step: coarse.step, error, before, cost: coarse.costs[form], growth }
        };
        FORMS.iter().enumerate().map(candidate).collect()
    }

    /// The cheapest quadrature that meets the error, else the best one.
    pub(super) fn choice(&self, max_error: f32) -> StepChoice {
        self.choices(max_error).cheapest
    }

    /// The same, and the midpoint rule beside it.
    pub(super) fn choices(&self, max_error: f32) -> StepChoices {
        let found = self.candidates().into_iter().map(|form| {
            let (step, estimate) = between(form.step, form.error, form.before, max_error);
            let work = form.work(step);
            (
                estimate > max_error,
                if estimate > max_error { estimate } else { work },
                StepChoice::new(step, form.quadrature, estimate),
            )
        });
        let found: Vec<_> = found.collect();
        let midpoint = found.iter().find(|(fails, _, choice)| !fails && choice.quadrature == FORMS[0]);
        let midpoint = midpoint.map(|(_, _, choice)| *choice);
        let order = |a: &(bool, f32, _), b: &(bool, f32, _)| (a.0, a.1).partial_cmp(&(b.0, b.1));
        let best = found.into_iter().min_by(|a, b| order(a, b).unwrap_or(std::cmp::Ordering::Equal));
        let cheapest = match (best, self.rounds.as_slice()) {
            (Some((_, _, choice)), _) => choice,
            // One step only: that both forms agree is all there is to say.
            (None, [only]) => {
                let estimate = self.pilot.difference(&only.pictures[0], &only.pictures[1]);
                StepChoice::new(only.step, Quadrature::Midpoint, estimate)
            }
            // Not even that: all of the picture may be wrong.
            (None, _) => StepChoice::new(self.step, Quadrature::Midpoint, 1.0),
        };
        StepChoices { cheapest, midpoint }
    }
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

    /// A round of which each form took `cost` samples.
    fn round(cost: u64) -> Round {
        Round { step: 1.0, counts: [256, 40], pictures: Default::default(), costs: [cost; 2] }
    }

    #[test]
    fn dear_rounds_take_fewer_rays() {
        assert_eq!(round(FREE_BUDGET / 8).next_counts(), [256, 40]);
        assert_eq!(round(FREE_BUDGET / 6).next_counts(), [192, 40]);
        assert_eq!(round(MOST_BUDGET).next_counts(), [LEAST_RAYS[0], LEAST_RAYS[1].min(40)]);
    }

    #[test]
    fn a_search_ends_where_it_is_hopeless() {
        let form = |error: f32| Candidate {
            quadrature: Quadrature::Midpoint,
            step: 1.0,
            error,
            before: Some(4.0 * error),
            cost: 1,
            growth: 1.0,
        };
        // Cheap rounds go on in any case, dear ones if two powers of the step lead there.
        assert!(round(1000).may_go_on(&[form(1.0)], 1e-4));
        assert!(round(FREE_BUDGET).may_go_on(&[form(1e-2), form(1e-3)], 1e-4));
        assert!(!round(FREE_BUDGET).may_go_on(&[form(1e-1), form(1e-2)], 1e-4));
    }
}
