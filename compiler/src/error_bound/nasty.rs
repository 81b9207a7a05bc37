//! An f32 device that does whatever WGSL permits, for tests of error bounds.
//!
//! In: f32 operands. Out: what the unkindest conforming device might give: sums and products rounded up
//! or down by a coin, quotients and roots a few ulp away, elementary functions and noise anywhere within
//! their own errors, small numbers flushed to 0.

use crate::curve::Quadratic;
use crate::ir::verify::random::Random;
use crate::ir::walk::{self, Domain};
use crate::ir::{Function, ValueId};
use crate::ops::{self, Context, MAX_RESULTS, Op, Results};

/// Results of a function on such a device.
pub(crate) fn evaluate(
    function: &Function,
    inputs: &[f32],
    uniforms: &[f64],
    curves: &[Vec<Quadratic>],
    coin: &mut Random,
) -> Vec<f32> {
    let inputs: Vec<f32> = inputs.iter().map(|&input| flushed(input, coin)).collect();
    walk::walk(&mut Nasty { uniforms, curves, coin }, function, &inputs)
}

struct Nasty<'a> {
    uniforms: &'a [f64],
    curves: &'a [Vec<Quadratic>],
    coin: &'a mut Random,
}

impl Domain for Nasty<'_> {
    type Value = f32;

    fn constant(&mut self, number: f64) -> f32 {
        flushed(number as f32, self.coin)
    }

    fn truth(&mut self, truth: bool) -> f32 {
        f32::from(u8::from(truth))
    }

    fn uniform(&mut self, index: usize) -> f32 {
        flushed(self.uniforms[index] as f32, self.coin)
    }

    fn apply(&mut self, op: Op, data: u32, _: &[ValueId], operands: &[f32]) -> Results<f32> {
        apply(op, operands, Context { data, curves: self.curves }, self.coin)
    }

    fn repeat(&mut self, most: u32, body: &Function, operands: &[f32]) -> Vec<f32> {
        walk::repeat(self, most, body, operands, |goes_on| goes_on != 0.0)
    }
}

/// One operation.
pub(crate) fn apply(op: Op, operands: &[f32], context: Context<'_>, coin: &mut Random) -> Results<f32> {
    let x: Vec<f64> = operands.iter().map(|&operand| f64::from(operand)).collect();
    let row = ops::operation(op);
    let exact = (row.meaning)(&x, context);
    let own = (row.error)(&x, &vec![0.0; x.len()], &exact, context);
    let mut results = [0.0; MAX_RESULTS];
    for i in 0..row.results.len() {
        let computed = match op {
            Op::Add | Op::Sub | Op::Mul => either_way(exact[i], coin),
            // 2.5 and 4.5 ulp.
            Op::Div => moved(either_way(exact[i], coin), 1, coin),
            Op::Sqrt => moved(either_way(exact[i], coin), 3, coin),
            _ if own[i] == 0.0 || !own[i].is_finite() => exact[i] as f32,
            _ => off(exact[i], own[i], coin),
        };
        results[i] = flushed(computed, coin);
    }
    results
}

/// One of the two f32 around a number, or the number itself.
fn either_way(exact: f64, coin: &mut Random) -> f32 {
    let nearest = exact as f32;
    let (up, down) = match f64::from(nearest).partial_cmp(&exact) {
        Some(std::cmp::Ordering::Less) => (nearest.next_up(), nearest),
        Some(std::cmp::Ordering::Greater) => (nearest, nearest.next_down()),
        Some(std::cmp::Ordering::Equal) | None => (nearest, nearest),
    };
    if coin.below(2) == 0 { up } else { down }
}

/// A number at most `own` away, most often nearly that.
fn off(exact: f64, own: f64, coin: &mut Random) -> f32 {
    let share = [-1.0, 1.0, 0.5][coin.below(3)];
    let moved = (exact + share * own) as f32;
    if (f64::from(moved) - exact).abs() <= own { moved } else { exact as f32 }
}

/// A number up to `ulps` away, but 0 stays 0.
fn moved(x: f32, ulps: usize, coin: &mut Random) -> f32 {
    let mut x = x;
    let up = coin.below(2) == 0;
    if x != 0.0 {
        for _ in 0..coin.below(ulps + 1) {
            x = if up { x.next_up() } else { x.next_down() };
        }
    }
    x
}

fn flushed(x: f32, coin: &mut Random) -> f32 {
    if x.is_subnormal() && coin.below(2) == 0 { 0.0 } else { x }
}
