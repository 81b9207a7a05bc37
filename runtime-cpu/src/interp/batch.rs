//! One operation on a batch: a kernel per row of the operation table.
//!
//! In: operands, one slice of up to [`LANES`] values each. Out: the results in the same lanes. Every
//! lane is computed by itself with the scalar kernels of [`crate::math`], in loops that the compiler
//! vectorises: vector instructions round like scalar ones, so the values do not depend on it.

mod curve;
mod noise;
#[cfg(target_arch = "x86_64")]
mod permutation;

use super::LANES;
use crate::isa::{Isa, kernel};
use crate::math::fun;
use vol_compiler::curve::{CurveTable, Node, Piece};
use vol_compiler::ops::{MAX_RESULTS, Op};
use vol_compiler::tape::MAX_OPERANDS;

/// One result for each point of a batch; aligned to a cache line.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub(crate) struct Lanes(pub(crate) [f32; LANES]);

impl Default for Lanes {
    fn default() -> Self {
        Self([0.0; LANES])
    }
}

type Operands<'a> = [&'a [f32]; MAX_OPERANDS];
type Out = [Lanes; MAX_RESULTS];

/// What the operations that are functions of their own need to know.
#[derive(Clone, Copy)]
pub(crate) struct Context<'a> {
    pub(crate) isa: Isa,
    pub(crate) curves: &'a [CurveTable],
    /// Results that are read, one bit each.
    pub(crate) wanted: u8,
}

/// Applies an operation that is a function of its own to all lanes of its operands; returns how many results were
/// written.
pub(crate) fn apply(
    op: Op,
    data: u32,
    x: &Operands<'_>,
    out: &mut Out,
    Context { isa, curves, wanted }: Context<'_>,
) -> usize {
    match op {
        Op::Sin => isa.run::<Sin>((x[0], out)),
        Op::Cos => isa.run::<Cos>((x[0], out)),
        Op::Exp2 => isa.run::<Exp2>((x[0], out)),
        Op::Log2 => isa.run::<Log2>((x[0], out)),
        Op::Acos => isa.run::<Acos>((x[0], out)),
        Op::Atan2 => isa.run::<Atan2>((x[0], x[1], out)),
        Op::Perlin => noise::perlin(isa, x, out, data),
        Op::PerlinGradient => noise::perlin_gradient(isa, x, out, data),
        Op::Fbm => noise::fbm(isa, x, out, data),
        Op::FbmGradient => noise::fbm_gradient(isa, x, out, data),
        Op::Perlin4 => isa.run::<noise::Perlin4>((x, out, data)),
        Op::Perlin4Gradient => isa.run::<noise::Perlin4Gradient>((x, out, data)),
        Op::Value => isa.run::<noise::Value>((x, out, data)),
        Op::ValueGradient => isa.run::<noise::ValueGradient>((x, out, data)),
        Op::Simplex => isa.run::<noise::Simplex>((x, out, data)),
        Op::SimplexGradient => isa.run::<noise::SimplexGradient>((x, out, data)),
        Op::Worley => isa.run::<noise::Worley<1>>((x, out, data)),
        Op::WorleyGradient => isa.run::<noise::Worley<4>>((x, out, data)),
        Op::Hash => isa.run::<noise::Hash>((x, out, data)),
        Op::Closest => curve::closest(isa, x, out, curve_parts(curves, data), wanted),
        Op::ClosestGradient => curve::closest_gradient(isa, x, out, curve_parts(curves, data)),
        Op::Foot => curve::next_foot(x, out, curve_parts(curves, data)),
        // All others are of a few instructions.
        _ => 0,
    }
}

fn curve_parts(curves: &[CurveTable], data: u32) -> (&[Piece], &[Node]) {
    curves.get(data as usize).map_or((&[], &[]), |table| (&table.pieces, &table.nodes))
}

/// Functions of one number in each lane.
macro_rules! functions {
    ($($name:ident: $function:ident;)*) => { $(
        kernel! {
            fn $name<'a>((x, out): (&'a [f32], &'a mut Out)) -> usize {
                for (out, &x) in out[0].0.iter_mut().zip(x) {
                    *out = fun::$function(x);
                }
                1
            }
        }
    )* };
}

functions! { Sin: sin; Cos: cos; Exp2: exp2; Log2: log2; Acos: acos; }

kernel! {
    fn Atan2<'a>((y, x, out): (&'a [f32], &'a [f32], &'a mut Out)) -> usize {
        for ((out, &y), &x) in out[0].0.iter_mut().zip(y).zip(x) {
            *out = fun::atan2(y, x);
        }
        1
    }
}
