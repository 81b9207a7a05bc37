//! What functions mean: f64, one instruction after the other, slow and obvious.
//!
//! In: a function of the IR and its arguments. Out: its results, as numbers or as bounds over whole
//! boxes of arguments. The frame function always runs here; point functions do so in tests, queries and
//! bounds of displacements. Example: `fn f(1) { %0 = input 0, %1 = sqrt %0, return %1 }` at 4 is 2, and
//! over `[4, 9]` is `[2, 3]`.

pub mod curve;
pub mod noise;

use crate::curve::Quadratic;
use crate::ir::walk::{self, Domain};
use crate::ir::{Function, ValueId};
use crate::ops::interval::Interval;
use crate::ops::{self, Context, Op, Results};

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
    walk::walk(&mut Numbers { uniforms, curves }, function, inputs)
}

/// Exact but for rounding in f64.
struct Numbers<'a> {
    uniforms: &'a [f64],
    curves: &'a [Vec<Quadratic>],
}

impl Domain for Numbers<'_> {
    type Value = f64;

    fn constant(&mut self, number: f64) -> f64 {
        number
    }

    fn truth(&mut self, truth: bool) -> f64 {
        f64::from(u8::from(truth))
    }

    fn uniform(&mut self, index: usize) -> f64 {
        self.uniforms[index]
    }

    fn apply(&mut self, op: Op, data: u32, _: &[ValueId], operands: &[f64]) -> Results<f64> {
        (ops::operation(op).meaning)(operands, Context { data, curves: self.curves })
    }

    fn repeat(&mut self, most: u32, body: &Function, operands: &[f64]) -> Vec<f64> {
        walk::repeat(self, most, body, operands, |goes_on| goes_on != 0.0)
    }
}

/// Bounds on the results of a function over all inputs in the given intervals.
///
/// * returns: contains [`evaluate`] for every point of the box; seldom the tightest bounds, since each
///   instruction forgets which operands vary together (but a product of a value with itself is a square),
///   and a loop that may stop at several steps gives the hull of the states at all of them
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
    walk::walk(&mut Bounds { uniforms, curves }, function, inputs)
}

/// Intervals that contain the numbers.
struct Bounds<'a> {
    uniforms: &'a [f64],
    curves: &'a [Vec<Quadratic>],
}

impl Domain for Bounds<'_> {
    type Value = Interval;

    fn constant(&mut self, number: f64) -> Interval {
        Interval::point(number)
    }

    fn truth(&mut self, truth: bool) -> Interval {
        Interval::point(f64::from(u8::from(truth)))
    }

    fn uniform(&mut self, index: usize) -> Interval {
        Interval::point(self.uniforms[index])
    }

    fn apply(&mut self, op: Op, data: u32, args: &[ValueId], operands: &[Interval]) -> Results<Interval> {
        if op == Op::Mul && args[0] == args[1] {
            return [operands[0].square(); ops::MAX_RESULTS];
        }
        (ops::operation(op).interval)(operands, Context { data, curves: self.curves })
    }

    fn repeat(&mut self, most: u32, body: &Function, operands: &[Interval]) -> Vec<Interval> {
        let state = body.state();
        let mut inputs = operands.to_vec();
        // Hull of the states at which some point may have stopped.
        let mut stopped: Option<Vec<Interval>> = None;
        for _ in 0..most {
            let (next, goes_on) = walk::step(self, body, &inputs);
            if goes_on.contains(0.0) {
                stopped = Some(hulls(stopped, &inputs[..state]));
            }
            if goes_on == Interval::point(0.0) {
                return stopped.unwrap_or_default();
            }
            // What maps to itself stays for all further steps.
            if next == inputs[..state] {
                break;
            }
            inputs[..state].copy_from_slice(&next);
        }
        hulls(stopped, &inputs[..state])
    }
}

fn hulls(known: Option<Vec<Interval>>, state: &[Interval]) -> Vec<Interval> {
    match known {
        None => state.to_vec(),
        Some(known) => known.iter().zip(state).map(|(a, &b)| a.hull(b)).collect(),
    }
}

#[cfg(test)]
mod tests;
