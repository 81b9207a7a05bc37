//! What each value of a tape may be in each of eight boxes.
//!
//! Ends are computed in f32 by the very operations that compute the values. Sums, products, quotients, roots, extremes
//! and floors are rounded to the nearest number and so never fall where the exact result rises: the
//! computed ends enclose the computed values, no matter how they are rounded. Other operations have bounds that
//! cover their errors ([`vol_compiler::ops::computed`]).
//!
//! Where an end would be infinite nothing is known, not even that the value is a number.

use super::outline::{Outline, Part};
use super::{Op, Place, Tape, TapeOp};
use crate::isa::{Isa, kernel};
use crate::math::fun::{self, greater, lesser};
use std::array;
use std::ops::Range;
use vol_compiler::ops::computed::bounds_of_first_result;
use vol_compiler::ops::interval::Interval;
use vol_compiler::ops::operation;
use vol_compiler::tape::{Register, Scalar};

/// One end in each of the boxes.
type Ends = [f32; 8];

/// Bounds in all boxes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Eight {
    lo: Ends,
    hi: Ends,
    /// In which boxes, one bit each, the value is surely `+0`.
    zero: u8,
}

impl Eight {
    pub(super) const UNKNOWN: Self = Self { lo: [f32::NEG_INFINITY; 8], hi: [f32::INFINITY; 8], zero: 0 };

    fn point(value: f32) -> Self {
        let zero = if value.to_bits() == 0 { u8::MAX } else { 0 };
        if value.is_finite() { Self { lo: [value; 8], hi: [value; 8], zero } } else { Self::UNKNOWN }
    }
}

/// A step that takes one of two of its operands in some of the boxes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Choice {
    /// Index of the step.
    pub(super) step: u32,
    /// The operands, and in which boxes, one bit each, it surely takes them, bit for bit; never both.
    pub(super) sides: [(Side, u8); 2],
}

/// An operand.
#[derive(Clone, Copy, Debug)]
pub(super) enum Side {
    Register(Register),
    Scalar(Scalar),
}

/// The steps of an outline that are decided in some of the boxes, in order. `known` has room for the bounds of each
/// register of the tape.
pub(super) fn choices(
    isa: Isa,
    tape: &Tape,
    outline: &Outline,
    (places, uniforms): (&[Place; 8], &[f32]),
    known: &mut [Eight],
) -> Vec<Choice> {
    let mut choices = Vec::new();
    for part in &outline.parts {
        match part {
            Part::Steps(steps) => {
                isa.run::<Enclose>((tape, steps.clone(), places, uniforms, known, &mut choices));
            }
            Part::Same { to, from } => known[to.index()] = known[from.index()],
            Part::Scalar { to, scalar } => known[to.index()] = Eight::point(scalar.value(uniforms)),
        }
    }
    choices
}

kernel! {
    fn Enclose<'a>(
        (tape, steps, places, uniforms, known, choices): (
            &'a Tape, Range<u32>, &'a [Place; 8], &'a [f32], &'a mut [Eight], &'a mut Vec<Choice>,
        )
    ) {
        for index in steps {
            match tape.ops[index as usize] {
                TapeOp::Constant { to, value } => known[to.index()] = Eight::point(value),
                TapeOp::Uniform { to, index } => known[to.index()] = Eight::point(uniforms[index as usize]),
                TapeOp::Input { to, index: axis } => {
                    let axis = axis as usize;
                    let (lo, hi) = (places.map(|place| place.lo[axis]), places.map(|place| place.hi[axis]));
                    known[to.index()] = Eight { lo, hi, zero: 0 };
                }
                TapeOp::Apply { op, data, to, args, .. } => {
                    let x = [0, 1, 2].map(|i| known[args[i].index()]);
                    let sides = sides(op, &x);
                    let found = match simple(op, args[0] == args[1], &x, sides) {
                        Some(found) => found,
                        None => other(op, data, &args.map(|arg| known[arg.index()])),
                    };
                    known[to.index()] = found;
                    if sides[0] | sides[1] != 0 {
                        // A selection's sides are its second and third operand.
                        let first = usize::from(op == Op::Select);
                        let [a, b] = [args[first], args[first + 1]].map(Side::Register);
                        choices.push(Choice { step: index, sides: [(a, sides[0]), (b, sides[1] & !sides[0])] });
                    }
                }
                TapeOp::ApplyScalar { op, scalar_first, scalar, to, arg } => {
                    let value = Eight::point(scalar.value(uniforms));
                    let arg_value = known[arg.index()];
                    let (mut x, mut operands) = ([arg_value, value, value], [Side::Register(arg), Side::Scalar(scalar)]);
                    if scalar_first {
                        x.swap(0, 1);
                        operands.swap(0, 1);
                    }
                    let sides = sides(op, &x);
                    known[to.index()] = simple(op, false, &x, sides).unwrap_or(Eight::UNKNOWN);
                    if sides[0] | sides[1] != 0 {
                        let sides = [(operands[0], sides[0]), (operands[1], sides[1] & !sides[0])];
                        choices.push(Choice { step: index, sides });
                    }
                }
                // Nothing is known of loops: their results stay unknown, as the room has them at first.
                TapeOp::Loop { .. } => {}
            }
        }
    }
}

/// The boxes of which something holds.
#[inline(always)]
fn boxes(holds: impl Fn(usize) -> bool) -> u8 {
    (0..8).fold(0, |boxes, i| boxes | u8::from(holds(i)) << i)
}

/// In which boxes an operation's result is surely the first, or the second, of the operands among which it chooses.
#[inline(always)]
fn sides(op: Op, [a, b, _]: &[Eight; 3]) -> [u8; 2] {
    match op {
        // Of a tie, and where one is no number, the second is taken.
        Op::Min => [boxes(|i| a.hi[i] < b.lo[i]), boxes(|i| b.hi[i] <= a.lo[i])],
        Op::Max => [boxes(|i| a.lo[i] > b.hi[i]), boxes(|i| a.hi[i] <= b.lo[i])],
        Op::Select => [boxes(|i| a.lo[i] == 1.0), boxes(|i| a.hi[i] == 0.0)],
        // `x - (+0)` is `x`.
        Op::Sub => [b.zero, 0],
        _ => [0, 0],
    }
}

/// The bounds of an operation of a few instructions.
#[inline(always)]
fn simple(op: Op, squared: bool, [a, b, c]: &[Eight; 3], [first, second]: [u8; 2]) -> Option<Eight> {
    // Where the choice between two operands is +0.
    let zero_of = |a: &Eight, b: &Eight| a.zero & (first | b.zero) | b.zero & second;
    Some(match op {
        Op::Add => {
            let zero = a.zero & b.zero;
            settled([a, b], each(zero, |i| [a.lo[i] + b.lo[i], a.hi[i] + b.hi[i]]))
        }
        Op::Sub => {
            let zero = a.zero & b.zero;
            settled([a, b], each(zero, |i| [a.lo[i] - b.hi[i], a.hi[i] - b.lo[i]]))
        }
        Op::Mul if squared => {
            let ends = |i: usize| {
                let size = magnitudes(a, i);
                [size[0] * size[0], size[1] * size[1]]
            };
            settled([a, a], each(a.zero, ends))
        }
        Op::Mul => {
            let zero = a.zero & (b.zero | positive(b)) | b.zero & positive(a);
            settled([a, b], each(zero, |i| corners(a, b, i, |x, y| x * y)))
        }
        Op::Div => {
            let ends = |i: usize| {
                let around_zero = b.lo[i] <= 0.0 && b.hi[i] >= 0.0;
                if around_zero { [f32::NEG_INFINITY, f32::INFINITY] } else { corners(a, b, i, |x, y| x / y) }
            };
            settled([a, b], each(a.zero & positive(b), ends))
        }
        Op::Min => {
            settled([a, b], each(zero_of(a, b), |i| [lesser(a.lo[i], b.lo[i]), lesser(a.hi[i], b.hi[i])]))
        }
        Op::Max => {
            settled([a, b], each(zero_of(a, b), |i| [greater(a.lo[i], b.lo[i]), greater(a.hi[i], b.hi[i])]))
        }
        Op::Neg => each(0, |i| [-a.hi[i], -a.lo[i]]),
        Op::Abs => settled([a, a], each(a.zero, |i| magnitudes(a, i))),
        Op::Floor => settled([a, a], each(a.zero, |i| [fun::floor(a.lo[i]), fun::floor(a.hi[i])])),
        Op::Sqrt => {
            let root = |x: f32| greater(x, 0.0).sqrt();
            settled([a, a], each(a.zero, |i| [root(a.lo[i]), root(a.hi[i])]))
        }
        Op::Less => truths(|i| a.hi[i] < b.lo[i], |i| b.hi[i] > a.lo[i]),
        Op::LessEqual => truths(|i| a.hi[i] <= b.lo[i], |i| b.hi[i] >= a.lo[i]),
        Op::Equal => truths(
            |i| a.lo[i] == a.hi[i] && b.lo[i] == b.hi[i] && a.lo[i] == b.lo[i],
            |i| !(a.hi[i] < b.lo[i] || b.hi[i] < a.lo[i]),
        ),
        Op::And => each(0, |i| [lesser(a.lo[i], b.lo[i]), lesser(a.hi[i], b.hi[i])]),
        Op::Or => each(0, |i| [greater(a.lo[i], b.lo[i]), greater(a.hi[i], b.hi[i])]),
        Op::Not => each(0, |i| [1.0 - a.hi[i], 1.0 - a.lo[i]]),
        Op::Select => {
            let ends = |i: usize| {
                if first >> i & 1 == 1 {
                    [b.lo[i], b.hi[i]]
                } else if second >> i & 1 == 1 {
                    [c.lo[i], c.hi[i]]
                } else {
                    [lesser(b.lo[i], c.lo[i]), greater(b.hi[i], c.hi[i])]
                }
            };
            each(zero_of(b, c), ends)
        }
        _ => return None,
    })
}

#[inline(always)]
fn each(zero: u8, ends: impl Fn(usize) -> [f32; 2]) -> Eight {
    let ends: [[f32; 2]; 8] = array::from_fn(ends);
    Eight { lo: ends.map(|[lo, _]| lo), hi: ends.map(|[_, hi]| hi), zero }
}

/// Bounds of a truth value.
#[inline(always)]
fn truths(surely: impl Fn(usize) -> bool, maybe: impl Fn(usize) -> bool) -> Eight {
    each(0, |i| [truth(surely(i)), truth(maybe(i))])
}

#[inline(always)]
fn truth(holds: bool) -> f32 {
    if holds { 1.0 } else { 0.0 }
}

/// The boxes in which a value is surely above 0.
#[inline(always)]
fn positive(x: &Eight) -> u8 {
    boxes(|i| x.lo[i] > 0.0)
}

/// Bounds of an absolute value.
#[inline(always)]
fn magnitudes(x: &Eight, i: usize) -> [f32; 2] {
    let (lo, hi) = (x.lo[i], x.hi[i]);
    let (below, above) = (lesser(lo.abs(), hi.abs()), greater(lo.abs(), hi.abs()));
    [if lo <= 0.0 && hi >= 0.0 { 0.0 } else { below }, above]
}

/// Bounds of a function that rises or falls steadily with each operand.
#[inline(always)]
fn corners(a: &Eight, b: &Eight, i: usize, f: impl Fn(f32, f32) -> f32) -> [f32; 2] {
    let corners = [f(a.lo[i], b.lo[i]), f(a.lo[i], b.hi[i]), f(a.hi[i], b.lo[i]), f(a.hi[i], b.hi[i])];
    let least = lesser(lesser(corners[0], corners[1]), lesser(corners[2], corners[3]));
    [least, greater(greater(corners[0], corners[1]), greater(corners[2], corners[3]))]
}

/// Nothing is known where something infinite came in or out.
#[inline(always)]
fn settled(operands: [&Eight; 2], found: Eight) -> Eight {
    let is_finite = |x: &Eight, i: usize| x.lo[i] > f32::NEG_INFINITY && x.hi[i] < f32::INFINITY;
    let ok: [bool; 8] =
        array::from_fn(|i| is_finite(operands[0], i) && is_finite(operands[1], i) && is_finite(&found, i));
    Eight {
        lo: array::from_fn(|i| if ok[i] { found.lo[i] } else { f32::NEG_INFINITY }),
        hi: array::from_fn(|i| if ok[i] { found.hi[i] } else { f32::INFINITY }),
        zero: found.zero & boxes(|i| ok[i]),
    }
}

/// The bounds of the first result of any other operation, box by box.
fn other(op: Op, data: u32, x: &[Eight]) -> Eight {
    let count = operation(op).args.len();
    let mut found = Eight::UNKNOWN;
    for i in 0..8 {
        let operand = |x: &Eight| Interval::new(f64::from(x.lo[i]), f64::from(x.hi[i]));
        let operands: Vec<Interval> = x[..count].iter().map(operand).collect();
        if let Some(bounds) = bounds_of_first_result(op, data, &operands) {
            // To the numbers of f32 next outside.
            found.lo[i] = (bounds.lo as f32).next_down();
            found.hi[i] = (bounds.hi as f32).next_up();
        }
    }
    found
}
