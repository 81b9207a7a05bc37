//! One operation on a batch: a kernel per row of the operation table.
//!
//! In: operands, one slice of up to [`LANES`] values each. Out: the results in the same lanes. Every
//! lane is computed by itself with the scalar kernels of [`crate::math`], in loops that the compiler
//! vectorises: vector instructions round like scalar ones, so the values do not depend on it.

mod curve;
mod noise;

use super::LANES;
use crate::math::{fun, noise as kernel};
use vol_compiler::curve::{CurveTable, Node, Piece};
use vol_compiler::ops::{MAX_RESULTS, Op};
use vol_compiler::tape::MAX_OPERANDS;

/// One value for each point of a batch; aligned to a cache line.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub(crate) struct Lanes(pub(crate) [f32; LANES]);

impl Default for Lanes {
    fn default() -> Self {
        Self([0.0; LANES])
    }
}

type Operands<'a> = [&'a [f32]; MAX_OPERANDS];
type Out = [Box<Lanes>; MAX_RESULTS];

/// Applies an operation to all lanes of its operands; returns how many results were written.
pub(crate) fn apply(op: Op, data: u32, x: &Operands<'_>, out: &mut Out, curves: &[CurveTable]) -> usize {
    match op {
        Op::Add => two(x, out, |a, b| a + b),
        Op::Sub => two(x, out, |a, b| a - b),
        Op::Mul => two(x, out, |a, b| a * b),
        Op::Div => two(x, out, |a, b| a / b),
        Op::Min => two(x, out, fun::lesser),
        Op::Max => two(x, out, fun::greater),
        Op::Neg => one(x, out, |a| -a),
        Op::Abs => one(x, out, f32::abs),
        Op::Floor => one(x, out, fun::floor),
        Op::Sqrt => one(x, out, |a| fun::greater(a, 0.0).sqrt()),
        Op::Sin => one(x, out, fun::sin),
        Op::Cos => one(x, out, fun::cos),
        Op::Exp2 => one(x, out, fun::exp2),
        Op::Log2 => one(x, out, fun::log2),
        Op::Acos => one(x, out, fun::acos),
        Op::Atan2 => two(x, out, fun::atan2),
        Op::Less => two(x, out, |a, b| truth(a < b)),
        Op::LessEqual => two(x, out, |a, b| truth(a <= b)),
        Op::Equal => two(x, out, |a, b| truth(a == b)),
        // On the bits of 0 and 1.
        Op::And => two(x, out, |a, b| f32::from_bits(a.to_bits() & b.to_bits())),
        Op::Or => two(x, out, |a, b| f32::from_bits(a.to_bits() | b.to_bits())),
        Op::Not => one(x, out, |a| f32::from_bits(a.to_bits() ^ 1.0_f32.to_bits())),
        Op::Select => three(x, out, |condition, a, b| if condition != 0.0 { a } else { b }),
        Op::Perlin => noise::perlin(x, out, data),
        Op::PerlinGradient => noise::perlin_gradient(x, out, data),
        Op::Fbm => noise::fbm(x, out, data),
        Op::FbmGradient => noise::fbm_gradient(x, out, data),
        Op::Perlin4 => noise::each(x, out, |p| [kernel::perlin4(p, data)]),
        Op::Perlin4Gradient => noise::each(x, out, |p| kernel::perlin4_gradient(p, data)),
        Op::Value => noise::each(x, out, |p| [kernel::value(p, data)]),
        Op::ValueGradient => noise::each(x, out, |p| kernel::value_gradient(p, data)),
        Op::Simplex => noise::each(x, out, |p| [kernel::simplex(p, data)]),
        Op::SimplexGradient => noise::each(x, out, |p| kernel::simplex_gradient(p, data)),
        Op::Worley => noise::worley::<1>(x, out, data),
        Op::WorleyGradient => noise::worley::<4>(x, out, data),
        Op::Hash => noise::each(x, out, |p| [kernel::hash(p, data)]),
        Op::Closest => curve::closest(x, out, curve_parts(curves, data)),
        Op::ClosestGradient => curve::closest_gradient(x, out, curve_parts(curves, data)),
        Op::Foot => curve::next_foot(x, out, curve_parts(curves, data)),
    }
}

fn curve_parts(curves: &[CurveTable], data: u32) -> (&[Piece], &[Node]) {
    curves.get(data as usize).map_or((&[], &[]), |table| (&table.pieces, &table.nodes))
}

fn truth(holds: bool) -> f32 {
    if holds { 1.0 } else { 0.0 }
}

#[inline(always)]
fn one(x: &Operands<'_>, out: &mut Out, f: impl Fn(f32) -> f32) -> usize {
    for (out, &a) in out[0].0.iter_mut().zip(x[0]) {
        *out = f(a);
    }
    1
}

#[inline(always)]
fn two(x: &Operands<'_>, out: &mut Out, f: impl Fn(f32, f32) -> f32) -> usize {
    for ((out, &a), &b) in out[0].0.iter_mut().zip(x[0]).zip(x[1]) {
        *out = f(a, b);
    }
    1
}

#[inline(always)]
fn three(x: &Operands<'_>, out: &mut Out, f: impl Fn(f32, f32, f32) -> f32) -> usize {
    for (((out, &a), &b), &c) in out[0].0.iter_mut().zip(x[0]).zip(x[1]).zip(x[2]) {
        *out = f(a, b, c);
    }
    1
}
