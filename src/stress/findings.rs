//! What went wrong, put together to messages: one per kind of trouble and place in the scene.

use std::fmt::Write as _;

use vol_compiler::program::Program;
use vol_language::diag::Diagnostic;
use vol_language::source::Span;

use super::Row;
use super::moments::Moment;
use super::narrow::{Blame, Narrow};
use super::targets::{Role, Target};

/// The kinds of trouble, the worst first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    /// Infinite or no number.
    NotFinite,
    /// Off by more than the error bound.
    OutOfBound,
    /// A distance longer than the way to the surface.
    Oversteps,
    /// A distance that jumps.
    DistanceJumps,
    /// A named function that is infinite or no number somewhere.
    FieldNotFinite,
    /// An error bound of more than a hundredth of the values.
    LostDigits,
    /// A value that jumps.
    Jumps,
    /// Rays that need most of their steps.
    Slow,
}

impl Kind {
    fn code(self) -> &'static str {
        match self {
            Self::NotFinite => "E0701",
            Self::OutOfBound => "E0702",
            Self::Oversteps => "E0703",
            Self::DistanceJumps => "E0704",
            Self::LostDigits => "W0701",
            Self::Jumps => "W0702",
            Self::Slow => "W0703",
            Self::FieldNotFinite => "W0704",
        }
    }

    fn says(self) -> &'static str {
        match self {
            Self::NotFinite | Self::FieldNotFinite => "is infinite or no number",
            Self::OutOfBound => "is farther from its exact value than rounding can explain",
            Self::Oversteps => "is more than the way to the surface",
            Self::DistanceJumps | Self::Jumps => "jumps",
            Self::LostDigits => "has lost its digits",
            Self::Slow => "lets rays hardly get on",
        }
    }

    fn help(self) -> &'static str {
        match self {
            Self::NotFinite | Self::FieldNotFinite => {
                "keep what divides away from 0, as in `x / max(y, 1e-3)`, and powers of large numbers small"
            }
            Self::OutOfBound | Self::Oversteps | Self::DistanceJumps => {
                "the scene is not at fault: please report it with this message"
            }
            Self::LostDigits => {
                "numbers of 32 bits have seven digits: keep places near the origin, and do not subtract large numbers that are nearly equal"
            }
            Self::Jumps => {
                "media are sampled, so what jumps is only as exact as the distance between samples; `smoothstep` and `mix` do not jump"
            }
            Self::Slow => {
                "a field that grows about as fast as the position is marched in the longest steps; scale it, or make its bounds smaller"
            }
        }
    }
}

/// One thing that went wrong.
#[derive(Clone, Debug)]
struct Finding {
    kind: Kind,
    /// Name of the function.
    target: String,
    title: String,
    /// Where it is found in the scene.
    span: Span,
    /// Said of that place.
    label: String,
    /// Where and by how much.
    example: String,
    /// How bad, to choose the example.
    weight: f64,
    count: usize,
}

/// Everything that went wrong.
#[derive(Clone, Debug, Default)]
pub(super) struct Findings {
    all: Vec<Finding>,
}

impl Findings {
    /// What goes wrong from here on is about one function at one moment.
    pub(super) fn about<'a>(
        &'a mut self,
        program: &'a Program,
        target: &'a Target,
        moment: &'a Moment,
    ) -> Scope<'a> {
        Scope { findings: self, narrow: Narrow::new(program, &moment.frame, target), target, moment }
    }

    /// The messages, errors first; counts them in the rows.
    pub(super) fn diagnostics(mut self, rows: &mut [Row]) -> Vec<Diagnostic> {
        self.all.sort_by_key(|finding| finding.kind);
        // What goes to infinity also jumps, and so does what has lost its digits.
        let causes = |finding: &&Finding| matches!(finding.kind, Kind::NotFinite | Kind::LostDigits);
        let causes: Vec<Span> = self.all.iter().filter(causes).map(|finding| finding.span).collect();
        self.all.retain(|finding| finding.kind != Kind::Jumps || !causes.contains(&finding.span));
        for finding in &self.all {
            if let Some(row) = rows.iter_mut().find(|row| row.name == finding.target) {
                row.findings += 1;
            }
        }
        self.all.into_iter().map(diagnostic).collect()
    }
}

fn diagnostic(finding: Finding) -> Diagnostic {
    let Finding { kind, title, span, label, example, count, .. } = finding;
    let message = format!("{title} {}", kind.says());
    let new = if kind.code().starts_with('E') { Diagnostic::error } else { Diagnostic::warning };
    let times = match count {
        1 => String::new(),
        2 => " and at one more place".to_owned(),
        _ => format!(" and at {} more places", count - 1),
    };
    new(kind.code(), message, span, format!("{label}: {example}{times}")).with_help(kind.help())
}

/// The place of a finding: inputs of the function, and the output that is wrong.
#[derive(Clone, Copy, Debug)]
pub(super) struct At<'a> {
    pub(super) inputs: &'a [f32],
    pub(super) output: usize,
}

/// Findings about one function at one moment.
pub(super) struct Scope<'a> {
    findings: &'a mut Findings,
    narrow: Narrow<'a>,
    target: &'a Target,
    moment: &'a Moment,
}

impl Scope<'_> {
    /// A value that is not finite.
    pub(super) fn not_finite(&mut self, at: At<'_>) {
        let kind = match self.target.role {
            Role::Field => Kind::FieldNotFinite,
            _ => Kind::NotFinite,
        };
        let blame = self.narrow.not_finite(at);
        self.add(kind, blame, format!("at {}", place(at.inputs)), 1.0);
    }

    /// A value that is off by more than its bound.
    pub(super) fn out_of_bound(&mut self, at: At<'_>, off: f64, bound: f64) {
        let blame = Blame { span: None, label: "this block".to_owned() };
        let example = format!("off by {off:.1e} at {}, the bound is {bound:.1e}", place(at.inputs));
        self.add(Kind::OutOfBound, blame, example, off / bound);
    }

    /// A value whose error may be a large part of it.
    pub(super) fn lost_digits(&mut self, at: At<'_>, error: f64, scale: f64) {
        let blame = self.narrow.lost_digits(at);
        let example = format!("uncertain by {error:.1e} of {scale:.1e} at {}", place(at.inputs));
        self.add(Kind::LostDigits, blame, example, error / scale);
    }

    /// A value that differs by `jump` at two places that are next to each other.
    pub(super) fn jumps(&mut self, ends: [&[f64]; 2], output: usize, jump: f64, kind: Kind) {
        let blame = self.narrow.jumps(ends, output);
        let at: Vec<f32> = ends[0].iter().map(|&x| x as f32).collect();
        self.add(kind, blame, format!("by {jump:.1e} at {}", place(&at)), jump);
    }

    /// A step across the surface.
    pub(super) fn oversteps(&mut self, from: [f64; 3], step: f64, surface: f64) {
        let blame = Blame { span: None, label: "this block".to_owned() };
        let at = from.map(|x| x as f32);
        let example =
            format!("a step of {step:.2e} from {}, but the surface is {surface:.2e} away", place(&at));
        self.add(Kind::Oversteps, blame, example, step / surface.max(1e-30));
    }

    /// Rays of which a share is still under way after most of their steps.
    pub(super) fn slow(&mut self, origin: [f32; 3], direction: [f32; 3], steps: u32, share: f64) {
        let blame = Blame { span: None, label: "rays towards this are slow".to_owned() };
        let example = format!(
            "{:.0} % of the rays take more than {steps} steps, one of them from {} along {}",
            (100.0 * share).max(1.0),
            place(&origin),
            place(&direction)
        );
        self.add(Kind::Slow, blame, example, share);
    }

    fn add(&mut self, kind: Kind, blame: Blame, mut example: String, weight: f64) {
        let span = blame.span.unwrap_or(self.target.span);
        if !self.moment.label.is_empty() {
            let _ = write!(example, " with {}", self.moment.label);
        }
        // An expression that several functions share is said to be wrong once.
        let same = |known: &&mut Finding| known.kind == kind && known.span == span;
        if let Some(known) = self.findings.all.iter_mut().find(same) {
            known.count += 1;
            if weight > known.weight {
                (known.example, known.label, known.weight) = (example, blame.label, weight);
            }
            return;
        }
        self.findings.all.push(Finding {
            kind,
            target: self.target.name.clone(),
            title: self.target.title.clone(),
            span,
            label: blame.label,
            example,
            weight,
            count: 1,
        });
    }
}

/// `(0.5, 1, -2)`
fn place(inputs: &[f32]) -> String {
    let numbers: Vec<String> = inputs.iter().map(|&x| written(f64::from(x))).collect();
    format!("({})", numbers.join(", "))
}

/// A number with four digits.
pub(super) fn written(x: f64) -> String {
    if x == 0.0 || (1e-3..1e6).contains(&x.abs()) {
        let text = format!("{x:.4}");
        return text.trim_end_matches('0').trim_end_matches('.').to_owned();
    }
    format!("{x:.3e}")
}
