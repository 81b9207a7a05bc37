//! One walk over a function for everything that computes with it value by value.
//!
//! In: a verified function, its arguments and a [`Domain`], which says what a value is: a number, an
//! interval, a number with its error. Out: the values of the outputs. Example: over f64, `%2 = mul %0
//! %1` reads two numbers and keeps their product for whoever reads `%2`.

use super::{Function, Inst, ValueId};
use crate::ops::{self, Op, Results};

/// What a function is computed with.
pub(crate) trait Domain {
    /// A number or truth value.
    type Value: Copy;

    /// A constant.
    fn constant(&mut self, number: f64) -> Self::Value;

    /// A truth value.
    fn truth(&mut self, truth: bool) -> Self::Value;

    /// An output of the frame function.
    fn uniform(&mut self, index: usize) -> Self::Value;

    /// An operation of the table; `args` says which operands are the same value.
    fn apply(
        &mut self,
        op: Op,
        data: u32,
        args: &[ValueId],
        operands: &[Self::Value],
    ) -> Results<Self::Value>;

    /// The last state of a loop.
    fn repeat(&mut self, most: u32, body: &Function, operands: &[Self::Value]) -> Vec<Self::Value>;
}

/// Values of the outputs.
///
/// # Panics
/// If there are fewer inputs or uniforms than the function reads.
pub(crate) fn walk<D: Domain>(domain: &mut D, function: &Function, inputs: &[D::Value]) -> Vec<D::Value> {
    let mut values = Values { starts: Vec::with_capacity(function.insts.len()), cells: Vec::new() };
    for inst in &function.insts {
        match inst {
            Inst::Constant(number) => values.push(&[domain.constant(number.0)]),
            Inst::Boolean(truth) => values.push(&[domain.truth(*truth)]),
            Inst::Input(index) => values.push(&[inputs[*index as usize]]),
            Inst::Uniform(index) => values.push(&[domain.uniform(*index as usize)]),
            Inst::Extract(tuple, index) => values.push(&[values.part(*tuple, *index as usize)]),
            Inst::Apply { op, data, args } => {
                let results = domain.apply(*op, *data, args, &values.all(args));
                values.push(&results[..ops::operation(*op).results.len()]);
            }
            Inst::Loop { most, body, args } => {
                let results = domain.repeat(*most, body, &values.all(args));
                values.push(&results);
            }
        }
    }
    values.all(&function.outputs)
}

/// The last state of a loop in a domain whose truth values are certain: `holds` reads them.
pub(crate) fn repeat<D: Domain>(
    domain: &mut D,
    most: u32,
    body: &Function,
    operands: &[D::Value],
    holds: impl Fn(D::Value) -> bool,
) -> Vec<D::Value> {
    let mut inputs = operands.to_vec();
    for _ in 0..most {
        let (next, goes_on) = step(domain, body, &inputs);
        if !holds(goes_on) {
            break;
        }
        inputs[..next.len()].copy_from_slice(&next);
    }
    inputs.truncate(body.state());
    inputs
}

/// One pass through the body of a loop: the next state, and whether it is gone to.
pub(crate) fn step<D: Domain>(
    domain: &mut D,
    body: &Function,
    inputs: &[D::Value],
) -> (Vec<D::Value>, D::Value) {
    let mut next = walk(domain, body, inputs);
    let goes_on = next.pop().expect("a verified body has a condition");
    (next, goes_on)
}

/// The results of the instructions so far.
struct Values<T> {
    /// First cell of each instruction.
    starts: Vec<usize>,
    cells: Vec<T>,
}

impl<T: Copy> Values<T> {
    fn push(&mut self, results: &[T]) {
        self.starts.push(self.cells.len());
        self.cells.extend_from_slice(results);
    }

    fn part(&self, value: ValueId, index: usize) -> T {
        self.cells[self.starts[value.index()] + index]
    }

    fn all(&self, values: &[ValueId]) -> Vec<T> {
        values.iter().map(|&value| self.part(value, 0)).collect()
    }
}
