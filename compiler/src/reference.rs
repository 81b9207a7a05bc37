//! What functions mean: f64, one instruction after the other, slow and obvious.
//!
//! In: a function of the IR and its arguments. Out: its results, as numbers or as bounds over whole
//! boxes of arguments. The frame function always runs here; point functions do so in tests, queries and
//! bounds of displacements. Example: `fn f(1) { %0 = input 0, %1 = sqrt %0, return %1 }` at 4 is 2, and
//! over `[4, 9]` is `[2, 3]`.

pub mod curve;
pub mod noise;

use crate::curve::Quadratic;
use crate::ir::{Function, Inst};
use crate::ops::interval::Interval;
use crate::ops::{self, Context, MAX_RESULTS, Op, Results};

/// Results of a function at one point.
///
/// * `inputs`: one per input; `uniforms`: outputs of the frame function, none for the frame function
///   itself; `curves`: control points of the frame
///
/// # Panics
/// If there are fewer inputs or uniforms than the function reads.
#[must_use]
pub fn evaluate(
    function: &Function,
    inputs: &[f64],
    uniforms: &[f64],
    curves: &[Vec<Quadratic>],
) -> Vec<f64> {
    let mut values: Vec<Results<f64>> = Vec::with_capacity(function.insts.len());
    for inst in &function.insts {
        let results = match inst {
            Inst::Constant(number) => [number.0; MAX_RESULTS],
            Inst::Boolean(truth) => [f64::from(u8::from(*truth)); MAX_RESULTS],
            Inst::Input(index) => [inputs[*index as usize]; MAX_RESULTS],
            Inst::Uniform(index) => [uniforms[*index as usize]; MAX_RESULTS],
            Inst::Extract(tuple, index) => [values[tuple.index()][*index as usize]; MAX_RESULTS],
            Inst::Apply { op, data, args } => {
                let operands: Vec<f64> = args.iter().map(|a| values[a.index()][0]).collect();
                (ops::operation(*op).meaning)(&operands, Context { data: *data, curves })
            }
        };
        values.push(results);
    }
    function.outputs.iter().map(|output| values[output.index()][0]).collect()
}

/// Bounds on the results of a function over all inputs in the given intervals.
///
/// * returns: contains [`evaluate`] for every point of the box; seldom the tightest bounds, since each
///   instruction forgets which operands vary together (but a product of a value with itself is a square)
///
/// # Panics
/// If there are fewer inputs or uniforms than the function reads.
#[must_use]
pub fn interval(
    function: &Function,
    inputs: &[Interval],
    uniforms: &[f64],
    curves: &[Vec<Quadratic>],
) -> Vec<Interval> {
    let mut values: Vec<Results<Interval>> = Vec::with_capacity(function.insts.len());
    for inst in &function.insts {
        let results = match inst {
            Inst::Constant(number) => [Interval::point(number.0); MAX_RESULTS],
            Inst::Boolean(truth) => [Interval::point(f64::from(u8::from(*truth))); MAX_RESULTS],
            Inst::Input(index) => [inputs[*index as usize]; MAX_RESULTS],
            Inst::Uniform(index) => [Interval::point(uniforms[*index as usize]); MAX_RESULTS],
            Inst::Extract(tuple, index) => [values[tuple.index()][*index as usize]; MAX_RESULTS],
            Inst::Apply { op: Op::Mul, args, .. } if args[0] == args[1] => {
                [values[args[0].index()][0].square(); MAX_RESULTS]
            }
            Inst::Apply { op, data, args } => {
                let operands: Vec<Interval> = args.iter().map(|a| values[a.index()][0]).collect();
                (ops::operation(*op).interval)(&operands, Context { data: *data, curves })
            }
        };
        values.push(results);
    }
    function.outputs.iter().map(|output| values[output.index()][0]).collect()
}
