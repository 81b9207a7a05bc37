//! `vol stress`: what can go wrong with the numbers of a scene, looked for at awkward places.
//!
//! ```text
//! Program ──moments──► Frames (params at their ends, other times)
//!    └──targets──► the functions on the way to a picture, each with the places that it is asked at
//!            │  precision   f32 against f64 and its error bound; infinity and NaN
//!            │  jumps       values that differ however near two places are
//!            │  march       distances that overstep the surface; rays that hardly get on
//!            ▼
//!         Report: a row per function, a diagnostic per kind of trouble and place in the scene
//! ```
//!
//! A finding points at the expression whose operation went wrong, as far as `narrow` can tell, else at the
//! block. Everything is drawn from a seed: equal arguments give equal reports, on any number of threads.
//! How to read a report, and what it does not show: `docs/numerics.md`.

mod evaluate;
mod findings;
mod jumps;
mod march;
mod moments;
mod narrow;
mod points;
mod precision;
mod targets;

pub use findings::Kind;
pub use moments::{Moment, moments};

use evaluate::Evaluator;
use findings::Findings;
use vol_compiler::ir::verify::random::Random;
use vol_compiler::program::Program;
use vol_language::diag::Diagnostic;

use crate::backend::Device;
use crate::failure::Failure;

/// Codes of this stage with what each is about.
pub const CODES: &[(&str, &str)] = &[
    ("E0701", "a value is infinite or no number"),
    ("E0702", "a value in f32 is farther from that in f64 than the error bound"),
    ("E0703", "a distance oversteps the surface"),
    ("E0704", "a distance jumps"),
    ("W0701", "a value has lost its digits"),
    ("W0702", "a value jumps"),
    ("W0703", "rays hardly get on"),
    ("W0704", "a named field is infinite or no number"),
];

/// How much is tried.
#[derive(Clone, Copy, Debug)]
pub struct Config {
    /// Places per function and moment; a quarter of them at moments other than the first.
    pub points: u32,
    /// Where they are.
    pub seed: u64,
}

impl Default for Config {
    fn default() -> Self {
        Self { points: 1000, seed: 0 }
    }
}

/// What was found about one function, over all moments.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// `distance:ball`, `interior:cloud`.
    pub name: String,
    /// Places tried.
    pub points: usize,
    /// Places for which there is no error bound, because a decision can fall either way.
    pub undecided: usize,
    /// Largest |f32 - f64| where it is decided, relative to the size of the function's values.
    pub apart: f64,
    /// Largest |f32 - f64| / bound where it is decided.
    pub share: f64,
    /// Messages about it.
    pub findings: usize,
}

/// What was found about a scene.
#[derive(Clone, Debug)]
pub struct Report {
    /// In the order of the program's blocks.
    pub rows: Vec<Row>,
    /// One for each kind of trouble and place in the scene, errors first.
    pub diagnostics: Vec<Diagnostic>,
}

impl Report {
    /// Whether there is an error among the messages.
    #[must_use]
    pub fn has_errors(&self) -> bool {
        self.diagnostics.iter().any(Diagnostic::is_error)
    }
}

/// Looks for trouble in a program at some moments, of which the first is looked at most closely.
///
/// * `devices`: what computes in f32; with several each is held against f64
///
/// # Errors
/// A device failure.
pub fn run(
    program: &Program,
    moments: &[Moment],
    config: &Config,
    devices: &[&Device],
) -> Result<Report, Failure> {
    let mut findings = Findings::default();
    let mut rows: Vec<Row> = Vec::new();
    for (index, moment) in moments.iter().enumerate() {
        let evaluator = Evaluator::new(program, &moment.frame, devices);
        let share = if index == 0 { 1 } else { 4 };
        for target in targets::targets(program, &moment.frame) {
            let places = target.affordable(program, config.points / share) as usize;
            let mut random = Random::new(config.seed ^ targets::hash(&target.name));
            let mut scope = findings.about(program, &target, moment);
            let row = precision::check(&evaluator, &target, places, &mut random, &mut scope)?;
            jumps::check(&evaluator, &target, places, &mut random, &mut scope);
            march::check_steps(&evaluator, &target, places, &mut random, &mut scope);
            if index == 0 {
                march::check_progress(&evaluator, &target, &mut random, &mut scope);
            }
            merge(&mut rows, row);
        }
    }
    let diagnostics = findings.diagnostics(&mut rows);
    Ok(Report { rows, diagnostics })
}

/// Adds what was found at one moment.
fn merge(rows: &mut Vec<Row>, new: Row) {
    let Some(row) = rows.iter_mut().find(|row| row.name == new.name) else {
        rows.push(new);
        return;
    };
    row.points += new.points;
    row.undecided += new.undecided;
    row.apart = row.apart.max(new.apart);
    row.share = row.share.max(new.share);
}
