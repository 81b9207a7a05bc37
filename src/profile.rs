//! `vol profile`: what each line of a scene costs.
//!
//! In: a scene, a frame and how to sample it. Out: a [`Report`]. Each instruction is labelled with the line that it
//! comes from, as far as [`Origins`](vol_compiler::ir::origin::Origins) knows it; the runtime tells costs by label. How
//! to read a report, and how exact it is: `docs/profile.md`.

use std::collections::HashMap;
use std::sync::atomic::AtomicBool;

use vol_compiler::frame::{Frame, Job};
use vol_compiler::ir::{Function, Inst};
use vol_compiler::program::Program;
use vol_language::source::{Sources, Span};
use vol_runtime_cpu::Profile;

use crate::failure::Failure;

/// Label of what has no line.
const NO_LINE: u32 = 0;

/// What something cost.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Cost {
    /// Points at which it was evaluated.
    pub evaluations: u64,
    /// Operations, in additions: a dearer one counts as about as many as take as long.
    pub operations: u64,
    /// Time on all threads, added up.
    pub milliseconds: f64,
}

impl Cost {
    fn add(&mut self, evaluations: u64, operations: u64, milliseconds: f64) {
        self.evaluations += evaluations;
        self.operations += operations;
        self.milliseconds += milliseconds;
    }
}

/// A line of a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Line {
    /// The file as messages name it.
    pub file: String,
    /// From 1.
    pub number: usize,
    /// What stands there, without the space around it.
    pub text: String,
}

/// What a cost belongs to.
#[derive(Clone, Debug, PartialEq)]
pub enum Place {
    /// What is written there.
    Line(Line),
    /// Operations that stand for no line.
    Compiler,
    /// The renderer itself: rays, samples, light.
    Integrator,
}

/// What a render cost.
#[derive(Clone, Debug, PartialEq)]
pub struct Report {
    /// By place, the dearest first; their times and operations add up to `total`.
    pub places: Vec<(Place, Cost)>,
    /// By function as the program names it (`distance:ball`), the dearest first.
    pub functions: Vec<(String, Cost)>,
    /// Of the whole render; evaluations are those of functions.
    pub total: Cost,
}

/// Renders a frame by the comb on the CPU and tells what it cost.
///
/// # Errors
/// [`Failure::Interrupted`] once `cancelled` is set.
pub fn run(
    program: &Program,
    sources: &Sources,
    frame: &Frame,
    job: &Job,
    progress: &(dyn Fn(u64) + Sync),
    cancelled: &AtomicBool,
) -> Result<Report, Failure> {
    let mut lines = Lines { sources, known: HashMap::new(), lines: Vec::new() };
    let labels = lines.label(program);
    let profile = vol_runtime_cpu::profile(program, frame, job, &labels, progress, cancelled);
    Ok(report(program, lines.lines, &profile.ok_or(Failure::Interrupted)?))
}

/// The lines that instructions come from.
struct Lines<'a> {
    sources: &'a Sources,
    /// By file and number.
    known: HashMap<(&'a str, usize), u32>,
    /// By label, from 1.
    lines: Vec<Line>,
}

impl Lines<'_> {
    /// A label for each instruction of each function.
    fn label(&mut self, program: &Program) -> Vec<Vec<u32>> {
        let blocks = blocks(program);
        let mut of_function = |(index, function): (usize, &Function)| {
            let places = program.origins.get(index).map_or_else(Vec::new, |origins| origins.places(function));
            let block = blocks.get(&index).copied();
            let place = |(value, inst): (usize, &Inst)| match inst {
                // A number stands where it was first written, which may be anywhere.
                Inst::Constant(_) | Inst::Boolean(_) | Inst::Input(_) | Inst::Uniform(_) => block,
                Inst::Apply { .. } | Inst::Loop { .. } | Inst::Extract(..) => {
                    places.get(value).copied().flatten()
                }
            };
            let spans = function.insts.iter().enumerate().map(place);
            spans.map(|span| span.map_or(NO_LINE, |span| self.label_of(span))).collect()
        };
        program.module.functions.iter().enumerate().map(&mut of_function).collect()
    }

    fn label_of(&mut self, span: Span) -> u32 {
        let (file, number, text) = self.sources.line(span);
        *self.known.entry((&file.name, number)).or_insert_with(|| {
            self.lines.push(Line { file: file.name.clone(), number, text: text.to_owned() });
            self.lines.len() as u32
        })
    }
}

/// The block of each function that belongs to one, by index.
fn blocks(program: &Program) -> HashMap<usize, Span> {
    let objects = program.objects.iter().flat_map(|object| {
        let functions = [object.distance, object.gradient, object.surface];
        functions.into_iter().chain(object.steepness).map(|function| (function.index(), object.span))
    });
    let media = program.media.iter().flat_map(|medium| {
        let functions = [medium.region, medium.interior, medium.extinction, medium.phase];
        functions.map(|function| (function.index(), medium.span))
    });
    objects.chain(media).collect()
}

fn report(program: &Program, lines: Vec<Line>, profile: &Profile) -> Report {
    let mut by_label = vec![Cost::default(); lines.len() + 1];
    let mut functions = Vec::new();
    let mut total = Cost { milliseconds: profile.integrator_milliseconds, ..Cost::default() };
    for (function, cost) in program.module.functions.iter().zip(&profile.functions) {
        if cost.evaluations == 0 {
            continue;
        }
        let mut whole = Cost::default();
        whole.add(cost.evaluations, cost.operations, cost.milliseconds);
        total.add(cost.evaluations, cost.operations, cost.milliseconds);
        functions.push((function.name.clone(), whole));
        for part in &cost.parts {
            by_label[part.label as usize].add(part.evaluations, part.operations, part.milliseconds);
        }
    }
    let places = std::iter::once(Place::Compiler).chain(lines.into_iter().map(Place::Line));
    let mut places: Vec<_> = places.zip(by_label).filter(|(_, cost)| cost.milliseconds > 0.0).collect();
    let integrator = Cost { milliseconds: profile.integrator_milliseconds, ..Cost::default() };
    places.push((Place::Integrator, integrator));
    places.sort_by(|a, b| b.1.milliseconds.total_cmp(&a.1.milliseconds));
    functions.sort_by(|a, b| b.1.milliseconds.total_cmp(&a.1.milliseconds));
    Report { places, functions, total }
}
