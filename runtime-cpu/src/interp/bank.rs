//! The registers of an evaluator: one row of numbers each, as wide as the batch at hand.
//!
//! A row is 1, 2, 4 or 8 chunks of [`CHUNK`] numbers, one number for each point and some to spare at its end. Rows lie
//! next to each other, so that a few points take no more of the cache than they need.

use bytemuck::{Pod, Zeroable, cast_slice, cast_slice_mut};
use pulp::Simd;
use std::cell::Cell;
use vol_compiler::ops::Op;
use vol_compiler::tape::MAX_OPERANDS;

/// Numbers that one vector operation takes: as many as the widest vectors hold.
pub(super) const CHUNK: usize = 16;

/// Aligned to a cache line.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C, align(64))]
pub(super) struct Chunk([f32; CHUNK]);

/// All rows.
#[derive(Debug, Default)]
pub(super) struct Bank {
    chunks: Vec<Chunk>,
    /// Chunks of a row.
    width: usize,
    /// Numbers of a row that mean something.
    points: usize,
}

impl Bank {
    /// Makes room for `rows` rows of `points` numbers, which are not set.
    pub(super) fn lay_out(&mut self, rows: usize, points: usize) {
        self.width = points.div_ceil(CHUNK).next_power_of_two();
        self.points = points;
        if self.chunks.len() < rows * self.width {
            self.chunks.resize(rows * self.width, Chunk::zeroed());
        }
    }

    /// The numbers of a row.
    pub(super) fn row(&self, row: usize) -> &[f32] {
        &cast_slice(&self.chunks[row * self.width..][..self.width])[..self.points]
    }

    /// The numbers of a row, to be set.
    pub(super) fn row_mut(&mut self, row: usize) -> &mut [f32] {
        &mut cast_slice_mut(&mut self.chunks[row * self.width..][..self.width])[..self.points]
    }

    /// Copies `count` rows to others, which do not overlap them.
    pub(super) fn copy_rows(&mut self, from: usize, to: usize, count: usize) {
        let width = self.width;
        self.chunks.copy_within(from * width..(from + count) * width, to * width);
    }

    /// Chunks of a row.
    pub(super) fn width(&self) -> usize {
        self.width
    }

    /// The chunks of all rows.
    pub(super) fn chunks(&mut self) -> &mut [Chunk] {
        &mut self.chunks
    }
}

/// All rows as vectors of a set of instructions. Their width is known when the steps are compiled: a step is a few
/// vector instructions in a row, whose places are checked once.
pub(super) struct Rows<'a, S: Simd, const WIDTH: usize> {
    simd: S,
    /// A step may write a row that it reads.
    vectors: &'a [Cell<S::f32s>],
}

impl<'a, S: Simd, const WIDTH: usize> Rows<'a, S, WIDTH> {
    /// Vectors of a row.
    const VECTORS: usize = WIDTH * CHUNK / S::F32_LANES;

    /// All rows of a bank of that width.
    #[inline(always)]
    pub(super) fn new(simd: S, chunks: &'a mut [Chunk]) -> Self {
        let vectors: &mut [S::f32s] = cast_slice_mut(chunks);
        Self { simd, vectors: Cell::from_mut(vectors).as_slice_of_cells() }
    }

    #[inline(always)]
    fn row(&self, row: usize) -> &'a [Cell<S::f32s>] {
        &self.vectors[row * Self::VECTORS..][..Self::VECTORS]
    }

    /// Sets a row to one number.
    #[inline(always)]
    pub(super) fn fill(&self, to: usize, value: f32) {
        let (to, value) = (self.row(to), self.simd.splat_f32s(value));
        for to in to {
            to.set(value);
        }
    }

    /// Sets the numbers of a row as far as there are values, at most as many as a row holds.
    #[inline(always)]
    pub(super) fn load(&self, to: usize, values: &[f32]) {
        let (to, (vectors, rest)) = (self.row(to), S::as_simd_f32s(values));
        for (to, &vector) in to.iter().zip(vectors) {
            to.set(vector);
        }
        if !rest.is_empty() {
            to[vectors.len()].set(self.simd.partial_load_f32s(rest));
        }
    }

    #[inline(always)]
    fn one(&self, to: usize, a: usize, f: impl Fn(S::f32s) -> S::f32s) {
        // No method of arrays: those may be called instead of inlined, with the instructions of the baseline.
        let (to, a) = (self.row(to), self.row(a));
        for i in 0..Self::VECTORS {
            to[i].set(f(a[i].get()));
        }
    }

    #[inline(always)]
    fn two(&self, to: usize, [a, b]: [usize; 2], f: impl Fn(S::f32s, S::f32s) -> S::f32s) {
        let (to, a, b) = (self.row(to), self.row(a), self.row(b));
        for i in 0..Self::VECTORS {
            to[i].set(f(a[i].get(), b[i].get()));
        }
    }

    #[inline(always)]
    fn three(&self, to: usize, [a, b, c]: [usize; 3], f: impl Fn([S::f32s; 3]) -> S::f32s) {
        let (to, a, b, c) = (self.row(to), self.row(a), self.row(b), self.row(c));
        for i in 0..Self::VECTORS {
            to[i].set(f([a[i].get(), b[i].get(), c[i].get()]));
        }
    }

    /// Applies an operation of a few instructions; whether it is one. The same bits as the scalar functions
    /// of [`crate::math::fun`].
    #[inline(always)]
    pub(super) fn apply(&self, op: Op, to: usize, args: [usize; MAX_OPERANDS]) -> bool {
        let ([a, b, c, ..], simd) = (args, self.simd);
        let (zero, one) = (simd.splat_f32s(0.0), simd.splat_f32s(1.0));
        match op {
            Op::Add => self.two(to, [a, b], |a, b| simd.add_f32s(a, b)),
            Op::Sub => self.two(to, [a, b], |a, b| simd.sub_f32s(a, b)),
            Op::Mul => self.two(to, [a, b], |a, b| simd.mul_f32s(a, b)),
            Op::Div => self.two(to, [a, b], |a, b| simd.div_f32s(a, b)),
            Op::Min => self.two(to, [a, b], |a, b| lesser(simd, a, b)),
            Op::Max => self.two(to, [a, b], |a, b| greater(simd, a, b)),
            Op::Neg => self.one(to, a, |a| simd.neg_f32s(a)),
            Op::Abs => self.one(to, a, |a| simd.abs_f32s(a)),
            Op::Floor => self.one(to, a, |a| floor(simd, a)),
            Op::Sqrt => self.one(to, a, |a| simd.sqrt_f32s(greater(simd, a, zero))),
            Op::Less => self.two(to, [a, b], |a, b| truth(simd, simd.less_than_f32s(a, b))),
            Op::LessEqual => self.two(to, [a, b], |a, b| truth(simd, simd.less_than_or_equal_f32s(a, b))),
            Op::Equal => self.two(to, [a, b], |a, b| truth(simd, simd.equal_f32s(a, b))),
            // On the bits of 0 and 1.
            Op::And => self.two(to, [a, b], |a, b| simd.and_f32s(a, b)),
            Op::Or => self.two(to, [a, b], |a, b| simd.or_f32s(a, b)),
            Op::Not => self.one(to, a, |a| simd.xor_f32s(a, one)),
            Op::Select => self.three(to, [a, b, c], |[condition, a, b]| {
                simd.select_f32s(simd.equal_f32s(condition, zero), b, a)
            }),
            _ => return false,
        }
        true
    }

    /// Applies an operation of two operands, one of them the same in all lanes. Does nothing if it is none of those
    /// with [`vol_compiler::tape::takes_scalar`].
    #[inline(always)]
    pub(super) fn apply_scalar(&self, op: Op, to: usize, a: usize, scalar: f32, scalar_first: bool) {
        let simd = self.simd;
        let s = simd.splat_f32s(scalar);
        match (op, scalar_first) {
            (Op::Add, _) => self.one(to, a, |a| simd.add_f32s(a, s)),
            (Op::Mul, _) => self.one(to, a, |a| simd.mul_f32s(a, s)),
            (Op::Sub, false) => self.one(to, a, |a| simd.sub_f32s(a, s)),
            (Op::Sub, true) => self.one(to, a, |a| simd.sub_f32s(s, a)),
            (Op::Div, false) => self.one(to, a, |a| simd.div_f32s(a, s)),
            (Op::Div, true) => self.one(to, a, |a| simd.div_f32s(s, a)),
            (Op::Min, false) => self.one(to, a, |a| lesser(simd, a, s)),
            (Op::Min, true) => self.one(to, a, |a| lesser(simd, s, a)),
            (Op::Max, false) => self.one(to, a, |a| greater(simd, a, s)),
            (Op::Max, true) => self.one(to, a, |a| greater(simd, s, a)),
            (Op::Less, false) => self.one(to, a, |a| truth(simd, simd.less_than_f32s(a, s))),
            (Op::Less, true) => self.one(to, a, |a| truth(simd, simd.less_than_f32s(s, a))),
            (Op::LessEqual, false) => self.one(to, a, |a| truth(simd, simd.less_than_or_equal_f32s(a, s))),
            (Op::LessEqual, true) => self.one(to, a, |a| truth(simd, simd.less_than_or_equal_f32s(s, a))),
            _ => {}
        }
    }
}

/// [`crate::math::fun::lesser`] in each lane.
#[inline(always)]
fn lesser<S: Simd>(simd: S, a: S::f32s, b: S::f32s) -> S::f32s {
    simd.select_f32s(simd.less_than_f32s(a, b), a, b)
}

/// [`crate::math::fun::greater`] in each lane.
#[inline(always)]
fn greater<S: Simd>(simd: S, a: S::f32s, b: S::f32s) -> S::f32s {
    simd.select_f32s(simd.greater_than_f32s(a, b), a, b)
}

/// 1 in each lane where something holds, else 0.
#[inline(always)]
fn truth<S: Simd>(simd: S, holds: S::m32s) -> S::f32s {
    simd.select_f32s(holds, simd.splat_f32s(1.0), simd.splat_f32s(0.0))
}

/// [`crate::math::fun::floor`] in each lane.
#[inline(always)]
fn floor<S: Simd>(simd: S, x: S::f32s) -> S::f32s {
    let whole = simd.splat_f32s(8_388_608.0);
    let sign = simd.splat_f32s(-0.0);
    let size = simd.abs_f32s(x);
    let nearest = simd.sub_f32s(simd.add_f32s(size, whole), whole);
    let nearest = simd.or_f32s(simd.abs_f32s(nearest), simd.and_f32s(x, sign));
    let above = simd.greater_than_f32s(nearest, x);
    let down = simd.select_f32s(above, simd.sub_f32s(nearest, simd.splat_f32s(1.0)), nearest);
    simd.select_f32s(simd.less_than_f32s(size, whole), down, x)
}
