//! How far any conforming f32 evaluation of a function can be from its exact value.
//!
//! In: a function and one point. Out: its results in f64, each with a bound on the distance of what a
//! CPU or GPU may compute, from the error rules of the operation table (`algorithms.md` §8.3, layer 2).
//! Infinite means undecided: a comparison, a whole number or the nearest foot could fall either way, or
//! a number may leave the range of f32.
//!
//! Covered: every rounding direction, fused multiply-add, flushed denormals. Not covered: reassociation,
//! for which WGSL gives no bound at all. Not proofs: the own errors of elementary functions and noise,
//! which were measured on random roundings, and the results of `closest`.
//!
//! Example: `sqrt(x x + y y)` at (3, 4) is 5 with an error of at most 4e-6.

#[cfg(test)]
pub(crate) mod nasty;

use crate::curve::Quadratic;
use crate::ir::walk::{self, Domain};
use crate::ir::{Function, ValueId};
use crate::ops::{self, Context, MAX_RESULTS, Op, Results};

/// A number and how far its f32 form can be from it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounded {
    /// Exact but for rounding in f64.
    pub value: f64,
    /// Largest distance of a conforming f32 result; infinite if undecided.
    pub error: f64,
}

const NOTHING: Bounded = Bounded { value: 0.0, error: 0.0 };

/// Results of a function at a point, with bounds.
///
/// * `inputs`: one per input of the function
/// * `uniforms`, `curves`: of the frame, in f64; uniforms and constants are off by their rounding to f32
/// * test: `nasty_device_stays_within`
///
/// # Panics
/// If there are fewer inputs or uniforms than the function reads.
#[must_use]
pub fn evaluate(
    function: &Function,
    inputs: &[f32],
    uniforms: &[f64],
    curves: &[Vec<Quadratic>],
) -> Vec<Bounded> {
    let inputs: Vec<Bounded> = inputs.iter().map(|&input| ops::from_f32(f64::from(input))).collect();
    walk::walk(&mut Errors { uniforms, curves }, function, &inputs)
}

/// Numbers with their errors.
struct Errors<'a> {
    uniforms: &'a [f64],
    curves: &'a [Vec<Quadratic>],
}

impl Domain for Errors<'_> {
    type Value = Bounded;

    fn constant(&mut self, number: f64) -> Bounded {
        ops::from_f32(number)
    }

    fn truth(&mut self, truth: bool) -> Bounded {
        Bounded { value: f64::from(u8::from(truth)), error: 0.0 }
    }

    fn uniform(&mut self, index: usize) -> Bounded {
        ops::from_f32(self.uniforms[index])
    }

    fn apply(&mut self, op: Op, data: u32, _: &[ValueId], operands: &[Bounded]) -> Results<Bounded> {
        apply(ops::operation(op), operands, Context { data, curves: self.curves })
    }

    /// A device goes through the same sequence of states within their errors, but where a condition can
    /// fall either way it may stop at another one: then the error is the distance to that as well.
    fn repeat(&mut self, most: u32, body: &Function, operands: &[Bounded]) -> Vec<Bounded> {
        let state = body.state();
        let mut inputs = operands.to_vec();
        // The state at which exact arithmetic stops, and those at which a device may stop.
        let (mut exact, mut possible): (Option<Vec<Bounded>>, Vec<Vec<Bounded>>) = (None, Vec::new());
        let mut left = most;
        while left > 0 {
            let (next, goes_on) = walk::step(self, body, &inputs);
            let (stops, undecided) = (goes_on.value == 0.0, goes_on.error != 0.0);
            if stops && exact.is_none() {
                exact = Some(inputs[..state].to_vec());
            }
            if stops || undecided {
                possible.push(inputs[..state].to_vec());
            }
            // If a device may be anywhere, further states change nothing.
            let lost = exact.is_some() && inputs[..state].iter().all(|number| !number.error.is_finite());
            if !undecided && stops || undecided && lost {
                break;
            }
            inputs[..state].copy_from_slice(&next);
            left -= 1;
        }
        inputs.truncate(state);
        if left == 0 {
            possible.push(inputs.clone());
        }
        let exact = exact.unwrap_or(inputs);
        let farthest = |i: usize| {
            let distances =
                possible.iter().map(|state| (state[i].value - exact[i].value).abs() + state[i].error);
            distances.fold(0.0, farther)
        };
        (0..state).map(|i| Bounded { value: exact[i].value, error: farthest(i) }).collect()
    }
}

/// The larger of two distances; one that is no number counts as infinite.
fn farther(a: f64, b: f64) -> f64 {
    if b.is_nan() { f64::INFINITY } else { a.max(b) }
}

/// One operation: its meaning and its error rule.
fn apply(row: &ops::Operation, operands: &[Bounded], context: Context<'_>) -> Results<Bounded> {
    let x: Vec<f64> = operands.iter().map(|operand| operand.value).collect();
    let e: Vec<f64> = operands.iter().map(|operand| operand.error).collect();
    let values = (row.meaning)(&x, context);
    let errors = (row.error)(&x, &e, &values, context);
    let mut results = [NOTHING; MAX_RESULTS];
    for (i, result) in results.iter_mut().enumerate().take(row.results.len()) {
        *result = Bounded { value: values[i], error: ops::settle(values[i], errors[i]) };
    }
    results
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ir::text;
    use crate::ir::verify::random::{self, Random};

    fn read(body: &str) -> Function {
        text::parse_function(&format!("fn f(3) {{\n{body}\n}}")).expect("well-formed text")
    }

    const SPHERE: &str = "%0 = input 0\n%1 = input 1\n%2 = input 2\n%3 = mul %0 %0\n%4 = mul %1 %1\n\
        %5 = add %3 %4\n%6 = mul %2 %2\n%7 = add %5 %6\n%8 = sqrt %7\n%9 = uniform 0\n%10 = sub %8 %9\nreturn %10";

    #[test]
    fn length_by_hand() {
        let length = read(
            "%0 = input 0\n%1 = input 1\n%2 = mul %0 %0\n%3 = mul %1 %1\n%4 = add %2 %3\n%5 = sqrt %4\nreturn %5",
        );
        let found = evaluate(&length, &[3.0, 4.0, 0.0], &[], &[])[0];
        assert_eq!(found.value, 5.0);
        assert!(found.error > 1e-7 && found.error < 4e-6, "{found:?}");
    }

    #[test]
    fn leaves_enter_with_their_rounding() {
        let leaves = read(
            "%0 = constant 0.1\n%1 = constant 0.5\n%2 = uniform 0\n%3 = input 0\n%4 = uniform 1\nreturn %0 %1 %2 %3 %4",
        );
        let found = evaluate(&leaves, &[0.7, 0.0, 0.0], &[1.0 / 3.0, 1e60], &[]);
        assert!(found[0].error > 1e-10 && found[0].error < 1e-8);
        assert_eq!([found[1].error, found[3].error, found[4].error], [0.0, 0.0, f64::INFINITY]);
        assert!(found[2].error > 0.0 && found[2].error < 2e-8);
    }

    /// Largest share of the bound of a function's results that a nasty device uses up at random points.
    fn worst_share(function: &Function, points: usize, seed: u64) -> (f64, usize) {
        let mut random = Random::new(seed);
        let (mut worst, mut decided) = (0f64, 0);
        let uniforms = [0.7, -1.3, 1.0 / 3.0, 2.0];
        for _ in 0..points {
            let point = [(); 3].map(|()| random.between(-3.0, 3.0) as f32);
            let bounds = evaluate(function, &point, &uniforms, &[]);
            let found = nasty::evaluate(function, &point, &uniforms, &[], &mut random);
            for (bound, found) in bounds.iter().zip(found).filter(|(bound, _)| bound.error.is_finite()) {
                let off = (f64::from(found) - bound.value).abs();
                assert!(off <= bound.error, "{}: {off} > {bound:?} at {point:?}", function.name);
                worst = worst.max(if off > 0.0 { off / bound.error } else { 0.0 });
                decided += 1;
            }
        }
        (worst, decided)
    }

    #[test]
    fn nasty_device_stays_within() {
        let (worst, decided) = worst_share(&read(SPHERE), 20_000, 1);
        assert!(worst > 0.2 && decided == 20_000, "{worst} of {decided}");
        let shape = random::Shape { curves: 0, tame: true, operations: 25, ..random::Shape::default() };
        let mut total = 0;
        for seed in 0..2000 {
            total += worst_share(&random::function(seed, &shape), 20, seed).1;
        }
        assert!(total > 40_000, "{total} decided");
    }
}
