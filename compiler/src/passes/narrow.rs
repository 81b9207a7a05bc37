//! Decisions that always fall the same way are taken out.
//!
//! ```text
//! %0 = input 0            %0 = input 0
//! %1 = mul %0 %0    ──►   %1 = mul %0 %0
//! %2 = constant 0.0
//! %3 = max %1 %2
//! %4 = sqrt %3            %2 = sqrt %1
//! return %4               return %2
//! ```
//!
//! Every value gets bounds on what it may be when it is computed ([`crate::ops::computed`]), from those of the
//! inputs and uniforms. Extremes take the side that always wins, comparisons and what follows from them become
//! truth values, selections take a side, and what is always one number becomes that number.
//!
//! Precondition: a verified function. Exact: every value that is left has the same bits as before, signs of
//! zeros included, for all inputs and uniforms within the bounds; what may be no number decides nothing.
//! The bodies of loops stay as they are.

use super::dce;
use crate::ir::{Function, Inst, Number, ValueId};
use crate::ops::computed::{self, Computed};
use crate::ops::interval::Interval;
use crate::ops::range::LARGEST;
use crate::ops::{Op, Ty, operation};

/// What the pass makes of a function.
pub(crate) struct Narrowed {
    /// The function, without what is no longer needed.
    pub(crate) function: Function,
    /// Of each of its instructions the one of the function before that computes the same.
    pub(crate) from: Vec<usize>,
    /// Which decisions were taken out, in the order of the function.
    pub(crate) decided: Vec<Op>,
}

/// A function without what is decided where its inputs and uniforms are within intervals.
#[must_use]
pub fn within(function: &Function, inputs: &[Interval], uniforms: &[Interval]) -> Function {
    let computed = |all: &[Interval]| -> Vec<Computed> { all.iter().map(|&x| Computed::within(x)).collect() };
    narrow(function, &computed(inputs), &computed(uniforms)).function
}

/// What positions and other inputs may be: beyond this f32 soon overflows.
pub(crate) fn any_input() -> Computed {
    Computed::within(Interval::new(-LARGEST, LARGEST))
}

/// What the outputs of the frame function may be, from what its inputs may be.
pub(crate) fn uniforms(frame: &Function, inputs: &[Computed]) -> Vec<Computed> {
    let values = bounds(frame, inputs, &[]);
    frame.outputs.iter().map(|output| values[output.index()][0].in_single()).collect()
}

/// The pass.
///
/// * `inputs`, `uniforms`: what each may be, as many as the function reads
pub(crate) fn narrow(function: &Function, inputs: &[Computed], uniforms: &[Computed]) -> Narrowed {
    let known = bounds(function, inputs, uniforms);
    let mut renamed: Vec<ValueId> = Vec::with_capacity(function.insts.len());
    let mut insts: Vec<Inst> = Vec::with_capacity(function.insts.len());
    let mut decided = Vec::new();
    for (i, inst) in function.insts.iter().enumerate() {
        let new = match simplified(function, i, &known) {
            Simplified::Value(value) => {
                decided.extend(operator(inst));
                // The instruction stays as a number that nothing reads: places are counted by instructions.
                insts.push(Inst::Constant(Number(0.0)));
                renamed.push(renamed[value.index()]);
                continue;
            }
            Simplified::Inst(leaf) => {
                decided.extend(operator(inst));
                leaf
            }
            Simplified::Same => inst.map_operands(|v| renamed[v.index()]),
        };
        renamed.push(ValueId(i as u32));
        insts.push(new);
    }
    let outputs = function.outputs.iter().map(|output| renamed[output.index()]).collect();
    let mut function = Function { insts, outputs, ..function.clone() };
    let from = dce::kept(&function);
    dce::dce(&mut function);
    Narrowed { function, from, decided }
}

/// What an instruction is replaced by.
enum Simplified {
    Same,
    Value(ValueId),
    Inst(Inst),
}

fn operator(inst: &Inst) -> Option<Op> {
    match inst {
        Inst::Apply { op, .. } => Some(*op),
        Inst::Constant(_)
        | Inst::Boolean(_)
        | Inst::Input(_)
        | Inst::Uniform(_)
        | Inst::Extract(..)
        | Inst::Loop { .. } => None,
    }
}

/// What each result of each instruction may be.
fn bounds(function: &Function, inputs: &[Computed], uniforms: &[Computed]) -> Vec<Vec<Computed>> {
    let mut known: Vec<Vec<Computed>> = Vec::with_capacity(function.insts.len());
    for inst in &function.insts {
        let results = match inst {
            Inst::Constant(number) => vec![Computed::constant(number.0)],
            Inst::Boolean(truth) => vec![Computed::truth(*truth)],
            Inst::Input(index) => vec![inputs[*index as usize]],
            Inst::Uniform(index) => vec![uniforms[*index as usize]],
            Inst::Extract(tuple, index) => vec![known[tuple.index()][*index as usize]],
            Inst::Apply { op, data, args } => {
                let operands: Vec<Computed> = args.iter().map(|arg| known[arg.index()][0]).collect();
                let squared = args.len() == 2 && args[0] == args[1];
                computed::apply(*op, *data, squared, &operands)[..operation(*op).results.len()].to_vec()
            }
            Inst::Loop { body, .. } => vec![Computed::UNKNOWN; body.state()],
        };
        known.push(results);
    }
    known
}

fn simplified(function: &Function, index: usize, known: &[Vec<Computed>]) -> Simplified {
    let Inst::Apply { op, args, .. } = &function.insts[index] else { return Simplified::Same };
    let row = operation(*op);
    // A number, or a truth value, whatever the operands.
    if let ([ty], Some(number)) = (row.results, known[index][0].only()) {
        return Simplified::Inst(match ty {
            Ty::Bool => Inst::Boolean(number != 0.0),
            Ty::Number => Inst::Constant(Number(number)),
        });
    }
    let x: Vec<Computed> = args.iter().map(|arg| known[arg.index()][0]).collect();
    match same_as(*op, &x) {
        Some(operand) => Simplified::Value(args[operand]),
        None => Simplified::Same,
    }
}

/// The operand that an operation always gives, bit for bit.
fn same_as(op: Op, x: &[Computed]) -> Option<usize> {
    let is = |i: usize, number: f64| x[i].only() == Some(number);
    match op {
        // Of a tie, and where the first is no number, the second is taken.
        Op::Max if x[0].never_above(x[1]) => Some(1),
        Op::Max if x[0].surely_above(x[1]) => Some(0),
        Op::Min if x[1].never_above(x[0]) => Some(1),
        Op::Min if x[1].surely_above(x[0]) => Some(0),
        Op::Abs if x[0].is_absolute() => Some(0),
        Op::Select if is(0, 1.0) => Some(1),
        Op::Select if is(0, 0.0) => Some(2),
        Op::And if is(0, 1.0) => Some(1),
        Op::And if is(1, 1.0) => Some(0),
        Op::Or if is(0, 0.0) => Some(1),
        Op::Or if is(1, 0.0) => Some(0),
        Op::Add if is(1, 0.0) && !x[0].minus_zero => Some(0),
        Op::Add if is(0, 0.0) && !x[1].minus_zero => Some(1),
        Op::Sub if is(1, 0.0) => Some(0),
        Op::Mul | Op::Div if is(1, 1.0) => Some(0),
        Op::Mul if is(0, 1.0) => Some(1),
        _ => None,
    }
}

#[cfg(test)]
mod tests;
