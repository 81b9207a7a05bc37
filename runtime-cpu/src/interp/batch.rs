//! One operation on a batch: a kernel per row of the operation table.
//!
//! In: operands, one slice of up to [`LANES`] values each. Out: the results in the same lanes. Every
//! lane is computed by itself with the scalar kernels of [`crate::math`], in loops that the compiler
//! vectorises: vector instructions round like scalar ones, so the values do not depend on it.

mod curve;
mod noise;

use super::LANES;
use crate::isa::{Isa, kernel};
use crate::math::fun;
use std::array;
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

/// Numbers that one step of a simple loop takes: as many as the widest vectors hold.
const CHUNK: usize = 16;

impl Lanes {
    fn chunks(&self) -> &[[f32; CHUNK]] {
        self.0.as_chunks().0
    }

    fn chunks_mut(&mut self) -> &mut [[f32; CHUNK]] {
        self.0.as_chunks_mut().0
    }
}

/// The registers of a tape and the part of each that is in use.
pub(crate) struct Bank<'a> {
    /// One row each.
    pub(crate) rows: &'a mut [Lanes],
    /// Points; whole chunks of them are computed.
    pub(crate) points: usize,
}

impl Bank<'_> {
    fn steps(&self) -> usize {
        self.points.div_ceil(CHUNK).min(LANES / CHUNK)
    }

    /// Sets a register to one number.
    #[inline(always)]
    pub(crate) fn fill(&mut self, to: usize, value: f32) {
        let steps = self.steps();
        self.rows[to].chunks_mut()[..steps].fill([value; CHUNK]);
    }

    #[inline(always)]
    fn one(&mut self, to: usize, [a]: [usize; 1], f: impl Fn(f32) -> f32) {
        for step in 0..self.steps() {
            let a = self.rows[a].chunks()[step];
            self.rows[to].chunks_mut()[step] = array::from_fn(|lane| f(a[lane]));
        }
    }

    #[inline(always)]
    fn two(&mut self, to: usize, [a, b]: [usize; 2], f: impl Fn(f32, f32) -> f32) {
        for step in 0..self.steps() {
            let [a, b] = [a, b].map(|row| self.rows[row].chunks()[step]);
            self.rows[to].chunks_mut()[step] = array::from_fn(|lane| f(a[lane], b[lane]));
        }
    }

    #[inline(always)]
    fn three(&mut self, to: usize, [a, b, c]: [usize; 3], f: impl Fn(f32, f32, f32) -> f32) {
        for step in 0..self.steps() {
            let [a, b, c] = [a, b, c].map(|row| self.rows[row].chunks()[step]);
            self.rows[to].chunks_mut()[step] = array::from_fn(|lane| f(a[lane], b[lane], c[lane]));
        }
    }

    /// Applies an operation of a few instructions; whether it is one.
    #[inline(always)]
    pub(crate) fn apply(&mut self, op: Op, to: usize, args: [usize; MAX_OPERANDS]) -> bool {
        let [a, b, c, ..] = args;
        match op {
            Op::Add => self.two(to, [a, b], |a, b| a + b),
            Op::Sub => self.two(to, [a, b], |a, b| a - b),
            Op::Mul => self.two(to, [a, b], |a, b| a * b),
            Op::Div => self.two(to, [a, b], |a, b| a / b),
            Op::Min => self.two(to, [a, b], fun::lesser),
            Op::Max => self.two(to, [a, b], fun::greater),
            Op::Neg => self.one(to, [a], |a| -a),
            Op::Abs => self.one(to, [a], f32::abs),
            Op::Floor => self.one(to, [a], fun::floor),
            Op::Sqrt => self.one(to, [a], |a| fun::greater(a, 0.0).sqrt()),
            Op::Less => self.two(to, [a, b], |a, b| truth(a < b)),
            Op::LessEqual => self.two(to, [a, b], |a, b| truth(a <= b)),
            Op::Equal => self.two(to, [a, b], |a, b| truth(a == b)),
            // On the bits of 0 and 1.
            Op::And => self.two(to, [a, b], |a, b| f32::from_bits(a.to_bits() & b.to_bits())),
            Op::Or => self.two(to, [a, b], |a, b| f32::from_bits(a.to_bits() | b.to_bits())),
            Op::Not => self.one(to, [a], |a| f32::from_bits(a.to_bits() ^ 1.0_f32.to_bits())),
            Op::Select => self.three(to, [a, b, c], |condition, a, b| if condition != 0.0 { a } else { b }),
            _ => return false,
        }
        true
    }
}

type Operands<'a> = [&'a [f32]; MAX_OPERANDS];
type Out = [Lanes; MAX_RESULTS];

/// What the operations that are functions of their own need to know.
#[derive(Clone, Copy)]
pub(crate) struct Context<'a> {
    pub(crate) isa: Isa,
    pub(crate) curves: &'a [CurveTable],
}

/// Applies an operation that is a function of its own to all lanes of its operands; returns how many results were
/// written.
pub(crate) fn apply(
    op: Op,
    data: u32,
    x: &Operands<'_>,
    out: &mut Out,
    Context { isa, curves }: Context<'_>,
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
        Op::Closest => curve::closest(isa, x, out, curve_parts(curves, data)),
        Op::ClosestGradient => curve::closest_gradient(isa, x, out, curve_parts(curves, data)),
        Op::Foot => curve::next_foot(x, out, curve_parts(curves, data)),
        // All others are of a few instructions.
        _ => 0,
    }
}

fn curve_parts(curves: &[CurveTable], data: u32) -> (&[Piece], &[Node]) {
    curves.get(data as usize).map_or((&[], &[]), |table| (&table.pieces, &table.nodes))
}

#[inline(always)]
fn truth(holds: bool) -> f32 {
    if holds { 1.0 } else { 0.0 }
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
