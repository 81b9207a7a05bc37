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

pub(crate) mod batch;
pub(crate) mod meter;
pub(crate) mod work;

use crate::isa::{Isa, kernel};
use batch::{Bank, Context, Lanes};
use std::array;
use std::ops::Range;
use vol_compiler::curve::CurveTable;
use vol_compiler::frame::Frame;
use vol_compiler::ir::{FunctionId, Module};
use vol_compiler::ops::MAX_RESULTS;
use vol_compiler::program::Program;
use vol_compiler::tape::{Register, Tape, TapeLoop, TapeOp};

/// Points that go through a tape together.
pub const LANES: usize = 128;

/// The tapes of all functions of a program.
#[derive(Clone, Debug)]
pub struct Tapes {
    tapes: Vec<Tape>,
    isa: Isa,
}

impl Tapes {
    /// Prepares a program.
    #[must_use]
    pub fn new(program: &Program) -> Self {
        Self::of_module(&program.module)
    }

    /// Prepares a verified module.
    #[must_use]
    pub fn of_module(module: &Module) -> Self {
        Self { tapes: module.functions.iter().map(Tape::new).collect(), isa: Isa::best() }
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

/// Evaluates functions in one frame; one thread's own.
#[derive(Debug)]
pub struct Evaluator<'a> {
    tapes: &'a Tapes,
    uniforms: &'a [f32],
    curves: &'a [CurveTable],
    registers: Vec<Lanes>,
    results: Box<[Lanes; MAX_RESULTS]>,
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
        let most = tapes.tapes.iter().map(Tape::all_registers).max().unwrap_or(0);
        let registers = vec![Lanes::default(); most];
        let results = Box::new(array::from_fn(|_| Lanes::default()));
        Self { tapes, uniforms, curves, registers, results, going: [true; LANES], loop_work: None }
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
        for points in batches(tape, inputs, outputs) {
            self.run(tape, 0..tape.ops.len(), Registers::of(tape), inputs, &points);
            self.hand_out(tape, outputs, &points);
        }
    }

    /// Copies the results of a batch from their registers.
    fn hand_out(&self, tape: &Tape, outputs: &mut [&mut [f32]], points: &Range<usize>) {
        for (output, register) in outputs.iter_mut().zip(&tape.outputs) {
            let values = &self.registers[register.index()].0;
            output[points.clone()].copy_from_slice(&values[..points.len()]);
        }
    }

    /// Walks through some steps of a tape whose registers start at `own.first`.
    fn run(
        &mut self,
        tape: &'a Tape,
        steps: Range<usize>,
        own: Registers,
        inputs: &[&[f32]],
        points: &Range<usize>,
    ) {
        let n = points.len();
        let at = |register: Register| own.first + register.index();
        let mut rest = &tape.ops[steps];
        loop {
            // As many operations of a few instructions as there are, then one that is a function of its own.
            let bank = Bank { rows: &mut self.registers, points: n };
            let done = self.tapes.isa.run::<Simple>((bank, self.uniforms, rest, own.first, inputs, points));
            let Some((step, after)) = rest[done..].split_first() else { return };
            rest = after;
            match *step {
                TapeOp::Apply { op, data, to, args, wanted } => {
                    let args = args.map(|register| &self.registers[at(register)].0[..n]);
                    let context = Context { isa: self.tapes.isa, curves: self.curves, wanted };
                    let written = batch::apply(op, data, &args, &mut self.results, context);
                    for result in (0..written).filter(|result| wanted >> result & 1 == 1) {
                        self.registers[at(to) + result].0[..n].copy_from_slice(&self.results[result].0[..n]);
                    }
                }
                TapeOp::Loop { index, to } => {
                    let repeated = &tape.loops[index as usize];
                    self.repeat(repeated, own, n);
                    for i in 0..repeated.state() {
                        self.registers.swap(at(to) + i, own.above + i);
                    }
                }
                TapeOp::Constant { .. } | TapeOp::Uniform { .. } | TapeOp::Input { .. } => {}
            }
        }
    }

    /// Runs a loop for `n` points; its last state is in the first registers above those of `outer`.
    fn repeat(&mut self, repeated: &'a TapeLoop, outer: Registers, n: usize) {
        let (body, state, first) = (&repeated.body, repeated.state(), outer.above);
        // Above the registers of the body the next state is put together.
        let next = first + body.registers as usize;
        let own = Registers { first, above: next + state };
        for (i, arg) in repeated.args.iter().enumerate() {
            let (below, inside) = self.registers.split_at_mut(first);
            inside[i].0[..n].copy_from_slice(&below[outer.first + arg.index()].0[..n]);
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
            self.run(body, 0..body.ops.len(), own, &[], &(0..n));
            let condition = &self.registers[first + body.outputs[state].index()].0;
            for (goes_on, &holds) in goes_on.iter_mut().zip(condition) {
                *goes_on &= holds != 0.0;
            }
            if !goes_on[..n].contains(&true) {
                break;
            }
            let (below, above) = self.registers.split_at_mut(next);
            for (i, merged) in above[..state].iter_mut().enumerate() {
                let (new, old) = (&below[first + body.outputs[i].index()].0, &below[first + i].0);
                for lane in 0..n {
                    merged.0[lane] = if goes_on[lane] { new[lane] } else { old[lane] };
                }
            }
            for i in 0..state {
                self.registers.swap(first + i, next + i);
            }
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

kernel! {
    /// Takes steps of a few instructions; how many there were.
    fn Simple<'a>(
        (mut bank, uniforms, steps, first, inputs, points): (
            Bank<'a>, &'a [f32], &'a [TapeOp], usize, &'a [&'a [f32]], &'a Range<usize>,
        )
    ) -> usize {
        let at = |register: Register| first + register.index();
        for (done, step) in steps.iter().enumerate() {
            match *step {
                TapeOp::Constant { to, value } => bank.fill(at(to), value),
                TapeOp::Uniform { to, index } => bank.fill(at(to), uniforms[index as usize]),
                TapeOp::Input { to, index } => {
                    bank.rows[at(to)].0[..points.len()].copy_from_slice(&inputs[index as usize][points.clone()]);
                }
                TapeOp::Apply { op, to, args, .. } => {
                    if !bank.apply(op, at(to), args.map(at)) {
                        return done;
                    }
                }
                TapeOp::Loop { .. } => return done,
            }
        }
        steps.len()
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
