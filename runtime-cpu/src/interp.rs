//! Evaluates a program's functions for many points at once, in f32.
//!
//! ```text
//! Program ──► Tapes          registers allocated once, shared by all threads
//!                └─ + Frame ──► Evaluator   registers of its own, one per thread
//!                                  └─ evaluate(function, inputs, outputs)
//! ```
//!
//! In: one slice per argument, all of one length. Out: one slice per output. Points are taken
//! [`LANES`] at a time; a register holds one value for each of them, so that the cost of looking at
//! an operation is shared and its loop ([`batch`]) vectorises. The results of a point depend on that
//! point alone: bit for bit the same in any company and any batch size.
//!
//! Truth values are 0 and 1 in registers like all others. A loop goes on until no point of the batch
//! does; points that have stopped keep their state.

mod bank;
pub(crate) mod batch;
pub(crate) mod local;
pub(crate) mod meter;
pub(crate) mod work;

use crate::isa::{Isa, VectorKernel};
use bank::{Bank, Chunk, Rows};
use batch::{Context, Lanes};
use local::LocalTapes;
use pulp::Simd;
use rayon::prelude::*;
use std::array;
use std::ops::Range;
use std::sync::Arc;
use vol_compiler::curve::CurveTable;
use vol_compiler::frame::Frame;
use vol_compiler::ir::{FunctionId, Module};
use vol_compiler::ops::MAX_RESULTS;
use vol_compiler::program::Program;
use vol_compiler::skip::Skip;
use vol_compiler::tape::{Carried, Link, Register, Tape, TapeLoop, TapeOp};

/// Points that go through a tape together.
pub const LANES: usize = 128;

/// The tapes of all functions of a program.
#[derive(Debug)]
pub struct Tapes {
    tapes: Arc<[Tape]>,
    isa: Isa,
    /// What they become in parts of space, in the one frame that they are for.
    local: Option<LocalTapes>,
}

impl Tapes {
    /// Prepares a program. The tapes are kept with it: the next time this does nothing.
    #[must_use]
    pub fn new(program: &Program) -> Self {
        let tapes = program.tapes.get_or_make(|| tapes(&program.module));
        Self { tapes, isa: Isa::best(), local: None }
    }

    /// Prepares a program to be evaluated in one frame, and in no other: functions are shortened where the frame's
    /// numbers tell what cannot matter.
    #[must_use]
    pub fn of_frame(program: &Program, frame: &Frame) -> Self {
        let tapes = Self::new(program);
        let local = frame.skips.has(Skip::Tapes).then(|| LocalTapes::new(&program.module, frame, tapes.isa));
        Self { local, ..tapes }
    }

    /// Prepares a verified module.
    #[must_use]
    pub fn of_module(module: &Module) -> Self {
        Self { tapes: tapes(module), isa: Isa::best(), local: None }
    }

    /// The same for other vector instructions; results are the same bits.
    #[must_use]
    pub fn for_isa(self, isa: Isa) -> Self {
        Self { isa, ..self }
    }

    /// The tape of one function.
    #[must_use]
    pub fn tape(&self, function: FunctionId) -> &Tape {
        &self.tapes[function.index()]
    }
}

fn tapes(module: &Module) -> Arc<[Tape]> {
    module.functions.par_iter().map(Tape::new).collect()
}

/// Evaluates functions in one frame; one thread's own.
#[derive(Debug)]
pub struct Evaluator<'a> {
    tapes: &'a Tapes,
    uniforms: &'a [f32],
    curves: &'a [CurveTable],
    registers: Bank,
    results: Box<[Lanes; MAX_RESULTS]>,
    groups: Groups,
    /// Which points of the batch go on in the loops around the tape at hand.
    going: [bool; LANES],
    /// Operations in the bodies of loops, see [`work`]; only counted where someone asks.
    loop_work: Option<u64>,
}

impl<'a> Evaluator<'a> {
    /// An evaluator of the program's functions in one of its frames.
    #[must_use]
    pub fn new(tapes: &'a Tapes, frame: &'a Frame) -> Self {
        Self::of_parts(tapes, &frame.uniforms_f32, &frame.curve_tables)
    }

    /// An evaluator that knows only what functions can read of a frame.
    #[must_use]
    pub fn of_parts(tapes: &'a Tapes, uniforms: &'a [f32], curves: &'a [CurveTable]) -> Self {
        let registers = Bank::default();
        let results = Box::new(array::from_fn(|_| Lanes::default()));
        let groups = Groups::default();
        Self { tapes, uniforms, curves, registers, results, groups, going: [true; LANES], loop_work: None }
    }

    /// Evaluates a function at as many points as the slices are long.
    ///
    /// `inputs` has one slice per argument, `outputs` one per output (or fewer: the first ones).
    ///
    /// # Panics
    ///
    /// If slices are missing or differ in length.
    pub fn evaluate(&mut self, function: FunctionId, inputs: &[&[f32]], outputs: &mut [&mut [f32]]) {
        let tape = self.tapes.tape(function);
        let local = self.tapes.local.as_ref().filter(|local| local.has(function));
        for points in batches(tape, inputs, outputs) {
            if let Some(local) = local {
                self.evaluate_locally(local, function, inputs, outputs, points);
            } else {
                self.registers.lay_out(tape.all_registers(), points.len());
                self.run(tape, tape.steps(), Registers::of(tape), inputs, &points);
                self.hand_out(tape, outputs, &points);
            }
        }
    }

    /// Evaluates a function of a position for one batch: those points together that are in one cell of its octree.
    fn evaluate_locally(
        &mut self,
        local: &'a LocalTapes,
        function: FunctionId,
        inputs: &[&[f32]],
        outputs: &mut [&mut [f32]],
        points: Range<usize>,
    ) {
        let at = |point: usize| [0, 1, 2].map(|axis| inputs[axis][point]);
        let mut groups = std::mem::take(&mut self.groups);
        groups.left.extend(points.clone());
        while let Some(first) = groups.left.pop() {
            let found = local.find(function, at(first));
            let short = found.and_then(|found| found.tape());
            let tape = short.as_deref().unwrap_or(self.tapes.tape(function));
            groups.part(first, |point| found.is_some_and(|found| found.place.contains(at(point))));
            if let Some(found) = found {
                found.note(groups.here.len(), points.len());
            }
            self.registers.lay_out(tape.all_registers(), groups.here.len());
            if groups.here.len() == points.len() {
                self.run(tape, tape.steps(), Registers::of(tape), inputs, &points);
                self.hand_out(tape, outputs, &points);
                break;
            }
            let here = 0..groups.here.len();
            let slices = groups.gather(inputs);
            self.run(tape, tape.steps(), Registers::of(tape), &slices, &here);
            for (output, register) in outputs.iter_mut().zip(&tape.outputs) {
                let values = self.registers.row(register.index());
                groups.here.iter().zip(values).for_each(|(&point, &value)| output[point] = value);
            }
        }
        self.groups = groups;
    }

    /// Copies the results of a batch from their registers.
    fn hand_out(&self, tape: &Tape, outputs: &mut [&mut [f32]], points: &Range<usize>) {
        for (output, register) in outputs.iter_mut().zip(&tape.outputs) {
            output[points.clone()].copy_from_slice(self.registers.row(register.index()));
        }
    }

    /// Walks through some steps of a tape, given with their links, whose registers start at `own.first`.
    fn run(
        &mut self,
        tape: &Tape,
        (mut steps, mut links): (&[TapeOp], &[Link]),
        own: Registers,
        inputs: &[&[f32]],
        points: &Range<usize>,
    ) {
        let at = |register: Register| own.first + register.index();
        loop {
            // As many simple steps as there are, then one that is a function of its own.
            let simple = Steps { steps, links, first: own.first, uniforms: self.uniforms, inputs, points };
            let (isa, bank) = (self.tapes.isa, &mut self.registers);
            let done = match bank.width() {
                1 => isa.run_vectors::<Simple<1>>((bank.chunks(), simple)),
                2 => isa.run_vectors::<Simple<2>>((bank.chunks(), simple)),
                4 => isa.run_vectors::<Simple<4>>((bank.chunks(), simple)),
                _ => isa.run_vectors::<Simple<8>>((bank.chunks(), simple)),
            };
            let Some((step, after)) = steps[done..].split_first() else { return };
            (steps, links) = (after, &links[done + 1..]);
            match *step {
                TapeOp::Apply { op, data, to, args, wanted } => {
                    // Those past the operation's own mean nothing, but are registers of the tape.
                    let args = args.map(|register| self.registers.row(at(register)));
                    let context = Context { isa: self.tapes.isa, curves: self.curves, wanted };
                    let written = batch::apply(op, data, &args, &mut self.results, context);
                    for result in (0..written).filter(|result| wanted >> result & 1 == 1) {
                        let row = self.registers.row_mut(at(to) + result);
                        row.copy_from_slice(&self.results[result].0[..row.len()]);
                    }
                }
                TapeOp::Loop { index, to } => {
                    let repeated = &tape.loops[index as usize];
                    self.repeat(repeated, own, points.len());
                    self.registers.copy_rows(own.above, at(to), repeated.state());
                }
                // All of these are simple.
                TapeOp::Constant { .. }
                | TapeOp::Uniform { .. }
                | TapeOp::Input { .. }
                | TapeOp::ApplyScalar { .. } => {}
            }
        }
    }

    /// Runs a loop for `n` points; its last state is in the first registers above those of `outer`.
    fn repeat(&mut self, repeated: &TapeLoop, outer: Registers, n: usize) {
        let (body, state, first) = (&repeated.body, repeated.state(), outer.above);
        // Above the registers of the body the next state is put together.
        let next = first + body.registers as usize;
        let own = Registers { first, above: next + state };
        for (i, arg) in repeated.args.iter().enumerate() {
            self.registers.copy_rows(outer.first + arg.index(), first + i, 1);
        }
        // Points that have stopped in a loop around keep nothing of this one.
        let around = self.going;
        let mut goes_on = around;
        let work = if self.loop_work.is_some() { self.known().work(body) } else { 0 };
        for _ in 0..repeated.most {
            self.going = goes_on;
            if let Some(sum) = &mut self.loop_work {
                *sum += work * goes_on[..n].iter().filter(|&&goes_on| goes_on).count() as u64;
            }
            self.run(body, body.steps(), own, &[], &(0..n));
            let condition = self.registers.row(first + body.outputs[state].index());
            for (goes_on, &holds) in goes_on.iter_mut().zip(condition) {
                *goes_on &= holds != 0.0;
            }
            if !goes_on[..n].contains(&true) {
                break;
            }
            for (i, output) in body.outputs[..state].iter().enumerate() {
                // The next state is put together beside the one that is still read.
                self.registers.copy_rows(first + i, next + i, 1);
                for lane in (0..n).filter(|&lane| goes_on[lane]) {
                    self.registers.row_mut(next + i)[lane] = self.registers.row(first + output.index())[lane];
                }
            }
            self.registers.copy_rows(next, first, state);
        }
        self.going = around;
    }
}

/// The points of a call, [`LANES`] at a time.
///
/// # Panics
///
/// If slices are missing or differ in length.
fn batches(
    tape: &Tape,
    inputs: &[&[f32]],
    outputs: &[&mut [f32]],
) -> impl Iterator<Item = Range<usize>> + use<> {
    let count = outputs.first().map_or(0, |output| output.len());
    let mut lengths = inputs.iter().map(|input| input.len()).chain(outputs.iter().map(|output| output.len()));
    assert!(
        inputs.len() >= tape.inputs as usize && outputs.len() <= tape.outputs.len(),
        "wrong number of slices"
    );
    assert!(lengths.all(|length| length == count), "slices differ in length");
    (0..count).step_by(LANES).map(move |start| start..count.min(start + LANES))
}

/// Steps of a tape, and what they read beside registers.
struct Steps<'a> {
    steps: &'a [TapeOp],
    /// One for each step.
    links: &'a [Link],
    /// The first of the tape's registers.
    first: usize,
    uniforms: &'a [f32],
    inputs: &'a [&'a [f32]],
    points: &'a Range<usize>,
}

/// Takes simple steps on rows of so many chunks; how many there were.
struct Simple<const WIDTH: usize>;

impl<const WIDTH: usize> VectorKernel for Simple<WIDTH> {
    type Args<'a> = (&'a mut [Chunk], Steps<'a>);
    type Out = usize;

    #[inline(always)]
    fn run<S: Simd>(simd: S, (chunks, all): Self::Args<'_>) -> usize {
        let vectors = WIDTH * bank::CHUNK / S::F32_LANES;
        // More than the machine has registers for go one part after the other.
        match (vectors, S::F32_LANES) {
            (1, _) => walk_parts::<S, 1>(simd, chunks, &all, 1),
            (2, _) => walk_parts::<S, 2>(simd, chunks, &all, 1),
            (4, _) => walk_parts::<S, 4>(simd, chunks, &all, 1),
            (_, 4) => walk_parts::<S, 4>(simd, chunks, &all, vectors / 4),
            _ => walk_parts::<S, 8>(simd, chunks, &all, vectors / 8),
        }
    }
}

/// The same on all parts of the rows, so many.
#[inline(always)]
fn walk_parts<S: Simd, const VECTORS: usize>(
    simd: S,
    chunks: &mut [Chunk],
    all: &Steps<'_>,
    parts: usize,
) -> usize {
    let mut done = 0;
    for part in 0..parts {
        done = walk::<S, VECTORS>(simd, chunks, all, part, parts);
    }
    done
}

/// The same on one of so many parts of the rows. The result of the last step stays in the registers of the machine.
#[inline(always)]
fn walk<S: Simd, const VECTORS: usize>(
    simd: S,
    chunks: &mut [Chunk],
    all: &Steps<'_>,
    part: usize,
    parts: usize,
) -> usize {
    let rows = Rows::<S, VECTORS>::new(simd, chunks, part, parts);
    let at = |register: Register| all.first + register.index();
    let mut last = rows.same(0.0);
    for (done, (step, link)) in all.steps.iter().zip(all.links).enumerate() {
        let to = match *step {
            TapeOp::Constant { to, value } => {
                last = rows.same(value);
                to
            }
            TapeOp::Uniform { to, index } => {
                last = rows.same(all.uniforms[index as usize]);
                to
            }
            TapeOp::Input { to, index } => {
                rows.load_values(&mut last, &all.inputs[index as usize][all.points.clone()]);
                to
            }
            TapeOp::Apply { op, to, args, .. } => {
                if !rows.apply(&mut last, op, link.carried, args.map(at)) {
                    return done;
                }
                to
            }
            TapeOp::ApplyScalar { op, scalar_first, scalar, to, arg } => {
                if link.carried == Carried::Nothing {
                    rows.load(&mut last, at(arg));
                }
                rows.apply_scalar(&mut last, op, scalar.value(all.uniforms), scalar_first);
                to
            }
            TapeOp::Loop { .. } => return done,
        };
        if link.kept {
            rows.store(at(to), &last);
        }
    }
    all.steps.len()
}

/// Points of a batch by the cell that they are in.
#[derive(Debug, Default)]
struct Groups {
    /// Those that are still to be evaluated.
    left: Vec<usize>,
    /// Those that are evaluated together.
    here: Vec<usize>,
    gathered: [Vec<f32>; 3],
}

impl Groups {
    /// Takes a point and those that belong with it out of those that are left.
    fn part(&mut self, first: usize, belongs: impl Fn(usize) -> bool) {
        self.here.clear();
        self.here.push(first);
        let here = &mut self.here;
        self.left.retain(|&point| {
            let is_here = belongs(point);
            if is_here {
                here.push(point);
            }
            !is_here
        });
    }

    /// Their coordinates.
    fn gather(&mut self, inputs: &[&[f32]]) -> [&[f32]; 3] {
        for (gathered, input) in self.gathered.iter_mut().zip(inputs) {
            gathered.clear();
            gathered.extend(self.here.iter().map(|&point| input[point]));
        }
        self.gathered.each_ref().map(Vec::as_slice)
    }
}

/// Where a tape's registers are.
#[derive(Clone, Copy)]
struct Registers {
    /// The first of them.
    first: usize,
    /// The first that it does not use; those of its loops start here.
    above: usize,
}

impl Registers {
    /// Those of a function.
    fn of(tape: &Tape) -> Self {
        Self { first: 0, above: tape.registers as usize }
    }
}

#[cfg(test)]
mod tests;
