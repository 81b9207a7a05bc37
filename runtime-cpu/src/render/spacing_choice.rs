//! Chooses for how many steps a sample of each medium may stand where no finer one is ([`super::spacing`]).
//!
//! The step suits the finest medium. Of each is tried alone, by the pilot's rays, how many times as long a step changes
//! little; then all media are put together. That is another test: along a comb that is even from end to end errors cancel,
//! where spacings change they do not. The widest spacings are halved until all of them change as little as they may.

use super::pilot::{MOST_BUDGET, Picture, Pilot, cost};
use super::scene::Scene;
use super::step_choice::{CORRECTED_COST, StepChoice, StepChoices};
use vol_compiler::frame::{Frame, Job, MOST_SPACING, Sampling};
use vol_compiler::skip::Skip;

/// Part of the allowed error that spacings may add: beside what steps are meant to have there is room for it.
const PART: f32 = 0.4;

/// Part of the samples that have to be left out for the trouble of it.
const WORTH: f64 = 0.1;

/// What was chosen.
pub(super) struct SpacedChoice {
    pub(super) steps: StepChoice,
    /// For each medium of the frame.
    pub(super) spacings: Vec<u32>,
    /// Error that they add: rms over the pilot's rays over the rms of their colour.
    pub(super) error: f32,
}

/// The cheapest of some ways to sample a frame's media, or a cheaper one with spacings, where the error is to be at most
/// `max_error`.
pub(super) fn spaced(pilot: &Pilot<'_>, steps: StepChoices, max_error: f32) -> SpacedChoice {
    let frame = pilot.frame;
    let StepChoices { cheapest, midpoint } = steps;
    // Styles tell how much of a step is lit.
    let is_styled = frame.styled_lights.iter().any(Option::is_some);
    let may_be = frame.media.len() > 1 && frame.skips.has(Skip::Spacings) && !is_styled;
    let found = midpoint.filter(|_| may_be).and_then(|midpoint| {
        let (picture, mut samples) = exposed(pilot, frame, &job_of(pilot, &midpoint))?;
        if cheapest != midpoint {
            let (_, corrected) = exposed(pilot, frame, &job_of(pilot, &cheapest))?;
            samples = f64::from(CORRECTED_COST) * corrected;
        }
        let trial = Trial { pilot, job: job_of(pilot, &midpoint), picture, allowed: PART * max_error };
        let (spacings, error) = trial.choice((1.0 - WORTH) * samples)?;
        Some(SpacedChoice { steps: midpoint, spacings, error })
    });
    found.unwrap_or_else(|| SpacedChoice {
        steps: cheapest,
        spacings: vec![1; frame.media.len()],
        error: 0.0,
    })
}

fn job_of(pilot: &Pilot<'_>, steps: &StepChoice) -> Job {
    steps.job(pilot.size, Sampling::CENTRE)
}

/// The pilot's rays in a frame, and the samples that they take; nothing if those are too many.
fn exposed(pilot: &Pilot<'_>, frame: &Frame, job: &Job) -> Option<(Picture, f64)> {
    let (picture, stats) = pilot.expose_scene(&Scene::new(frame, job), pilot.all(), MOST_BUDGET)?;
    Some((picture, cost(&stats) as f64))
}

struct Trial<'a> {
    pilot: &'a Pilot<'a>,
    job: Job,
    /// With a sample for each step.
    picture: Picture,
    /// Error that spacings may add.
    allowed: f32,
}

impl Trial<'_> {
    /// The widest spacings that may be, and their error; nothing if they take more samples than `most`.
    fn choice(&self, most: f64) -> Option<(Vec<u32>, f32)> {
        let media = 0..self.pilot.frame.media.len();
        let mut spacings = media.map(|medium| self.alone(medium)).collect::<Option<Vec<_>>>()?;
        while let Some(widest) = spacings.iter().copied().max().filter(|&widest| widest > 1) {
            let mut frame = self.pilot.frame.clone();
            frame.media.iter_mut().zip(&spacings).for_each(|(medium, &spacing)| medium.spacing = spacing);
            let (picture, samples) = exposed(self.pilot, &frame, &self.job)?;
            let error = self.pilot.difference(&picture, &self.picture);
            if error <= self.allowed {
                return (samples <= most).then_some((spacings, error));
            }
            spacings.iter_mut().for_each(|spacing| *spacing = (*spacing).min(widest / 2));
        }
        None
    }

    /// The widest spacing of a medium that changes little if no other is there.
    fn alone(&self, medium: usize) -> Option<u32> {
        let whole = self.pilot.frame;
        let frame = Frame { media: vec![whole.media[medium].clone()], ..whole.clone() };
        let expose = |spacing: u32| {
            let job = Job { step: spacing as f32 * self.job.step, ..self.job };
            Some(exposed(self.pilot, &frame, &job)?.0)
        };
        let fine = expose(1)?;
        // The errors of several media add up like those of independent measurements; the finest one has none.
        let share = self.allowed / ((whole.media.len() - 1) as f32).sqrt();
        let mut widest = 1;
        while widest < MOST_SPACING {
            let error = self.pilot.difference_in(&expose(2 * widest)?, &fine, &self.picture);
            if error > share {
                break;
            }
            widest *= 2;
        }
        Some(widest)
    }
}
