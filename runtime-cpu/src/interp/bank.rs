//! The registers of an evaluator: one row of numbers each, as wide as the batch at hand.
//!
//! A row is 1, 2, 4 or 8 chunks of [`CHUNK`] numbers, one number for each point and some to spare at its end. Rows lie
//! next to each other, so that a few points take no more of the cache than they need.

use bytemuck::{Pod, Zeroable, cast_slice, cast_slice_mut};
use pulp::Simd;
use std::cell::Cell;
use vol_compiler::ops::Op;
use vol_compiler::tape::{Carried, MAX_OPERANDS};

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

/// One number for each point of a part of a batch, in registers of the machine: with eight vectors half of those that
/// AVX2 has and a quarter of those of AVX-512.
pub(super) type Held<S, const VECTORS: usize> = [<S as Simd>::f32s; VECTORS];

/// The same part of all rows as vectors of a set of instructions. How many vectors it has is known when the steps are
/// compiled: a step is a few vector instructions in a row, whose place is checked once.
pub(super) struct Rows<'a, S: Simd, const VECTORS: usize> {
    simd: S,
    /// The parts of all rows, one row after the other. A step may write a row that it reads.
    vectors: &'a [Cell<Held<S, VECTORS>>],
    part: usize,
    /// Parts of a row.
    parts: usize,
}

#[expect(
    clippy::needless_range_loop,
    reason = "zipped iterators leave vectors in memory: steps take a quarter longer"
)]
impl<'a, S: Simd, const VECTORS: usize> Rows<'a, S, VECTORS> {
    /// One of so many parts of all rows of a bank.
    #[inline(always)]
    pub(super) fn new(simd: S, chunks: &'a mut [Chunk], part: usize, parts: usize) -> Self {
        let vectors: &mut [S::f32s] = cast_slice_mut(chunks);
        let vectors = Cell::from_mut(vectors.as_chunks_mut().0).as_slice_of_cells();
        Self { simd, vectors, part, parts }
    }

    /// One number at all points.
    #[inline(always)]
    pub(super) fn same(&self, value: f32) -> Held<S, VECTORS> {
        [self.simd.splat_f32s(value); VECTORS]
    }

    #[inline(always)]
    fn row(&self, row: usize) -> &'a [Cell<S::f32s>; VECTORS] {
        self.vectors[row * self.parts + self.part].as_array_of_cells()
    }

    /// Sets a row.
    #[inline(always)]
    pub(super) fn store(&self, to: usize, held: &Held<S, VECTORS>) {
        let to = self.row(to);
        for i in 0..VECTORS {
            to[i].set(held[i]);
        }
    }

    /// Takes a row.
    #[inline(always)]
    pub(super) fn load(&self, held: &mut Held<S, VECTORS>, from: usize) {
        let from = self.row(from);
        for i in 0..VECTORS {
            held[i] = from[i].get();
        }
    }

    /// Takes the values of a batch that belong to the part, at most as many as a row holds.
    #[inline(always)]
    pub(super) fn load_values(&self, held: &mut Held<S, VECTORS>, values: &[f32]) {
        let (vectors, rest) =
            S::as_simd_f32s(&values[values.len().min(self.part * VECTORS * S::F32_LANES)..]);
        // By places that are known when this is compiled: others would keep all that is held in memory.
        for i in 0..VECTORS {
            if let Some(&vector) = vectors.get(i) {
                held[i] = vector;
            } else if i == vectors.len() {
                held[i] = self.simd.partial_load_f32s(rest);
            }
        }
    }

    #[inline(always)]
    fn one(&self, held: &mut Held<S, VECTORS>, f: impl Fn(S::f32s) -> S::f32s) {
        // No method of arrays: those may be called instead of inlined, with the instructions of the baseline.
        for i in 0..VECTORS {
            held[i] = f(held[i]);
        }
    }

    #[inline(always)]
    fn two(
        &self,
        held: &mut Held<S, VECTORS>,
        carried: Carried,
        [a, b]: [usize; 2],
        f: impl Fn(S::f32s, S::f32s) -> S::f32s,
    ) {
        match carried {
            Carried::Nothing | Carried::First => {
                let b = self.row(b);
                for i in 0..VECTORS {
                    held[i] = f(held[i], b[i].get());
                }
            }
            Carried::Second => {
                let a = self.row(a);
                for i in 0..VECTORS {
                    held[i] = f(a[i].get(), held[i]);
                }
            }
            Carried::Both => {
                for i in 0..VECTORS {
                    held[i] = f(held[i], held[i]);
                }
            }
        }
    }

    /// The second operand where the first is not 0, else the third.
    #[inline(always)]
    fn select(&self, held: &mut Held<S, VECTORS>, carried: Carried, [condition, a, b]: [usize; 3]) {
        let (simd, zero) = (self.simd, self.simd.splat_f32s(0.0));
        let mut chosen = *held;
        if matches!(carried, Carried::Nothing | Carried::First) {
            self.load(&mut chosen, a);
        }
        if carried == Carried::Second {
            self.load(held, condition);
        }
        let b = self.row(b);
        for i in 0..VECTORS {
            held[i] = simd.select_f32s(simd.equal_f32s(held[i], zero), b[i].get(), chosen[i]);
        }
    }

    /// Applies a simple operation, see [`vol_compiler::tape::is_simple`]; whether it is one. The same bits as the
    /// scalar functions of [`crate::math::fun`]. What is not carried comes from the rows of the operands.
    #[inline(always)]
    pub(super) fn apply(
        &self,
        held: &mut Held<S, VECTORS>,
        op: Op,
        carried: Carried,
        args: [usize; MAX_OPERANDS],
    ) -> bool {
        let ([a, b, c, ..], simd) = (args, self.simd);
        let (zero, one) = (simd.splat_f32s(0.0), simd.splat_f32s(1.0));
        if carried == Carried::Nothing {
            self.load(held, a);
        }
        match op {
            Op::Add => self.two(held, carried, [a, b], |a, b| simd.add_f32s(a, b)),
            Op::Sub => self.two(held, carried, [a, b], |a, b| simd.sub_f32s(a, b)),
            Op::Mul => self.two(held, carried, [a, b], |a, b| simd.mul_f32s(a, b)),
            Op::Div => self.two(held, carried, [a, b], |a, b| simd.div_f32s(a, b)),
            Op::Min => self.two(held, carried, [a, b], |a, b| lesser(simd, a, b)),
            Op::Max => self.two(held, carried, [a, b], |a, b| greater(simd, a, b)),
            Op::Neg => self.one(held, |a| simd.neg_f32s(a)),
            Op::Abs => self.one(held, |a| simd.abs_f32s(a)),
            Op::Floor => self.one(held, |a| floor(simd, a)),
            Op::Sqrt => self.one(held, |a| simd.sqrt_f32s(greater(simd, a, zero))),
            Op::Less => self.two(held, carried, [a, b], |a, b| truth(simd, simd.less_than_f32s(a, b))),
            Op::LessEqual => {
                self.two(held, carried, [a, b], |a, b| truth(simd, simd.less_than_or_equal_f32s(a, b)));
            }
            Op::Equal => self.two(held, carried, [a, b], |a, b| truth(simd, simd.equal_f32s(a, b))),
            // On the bits of 0 and 1.
            Op::And => self.two(held, carried, [a, b], |a, b| simd.and_f32s(a, b)),
            Op::Or => self.two(held, carried, [a, b], |a, b| simd.or_f32s(a, b)),
            Op::Not => self.one(held, |a| simd.xor_f32s(a, one)),
            Op::Select => self.select(held, carried, [a, b, c]),
            _ => return false,
        }
        true
    }

    /// Applies an operation to what is held and a number that is the same in all lanes. Does nothing if it is none of
    /// those with [`vol_compiler::tape::takes_scalar`].
    #[inline(always)]
    pub(super) fn apply_scalar(&self, held: &mut Held<S, VECTORS>, op: Op, scalar: f32, scalar_first: bool) {
        let simd = self.simd;
        let s = simd.splat_f32s(scalar);
        match (op, scalar_first) {
            (Op::Add, _) => self.one(held, |a| simd.add_f32s(a, s)),
            (Op::Mul, _) => self.one(held, |a| simd.mul_f32s(a, s)),
            (Op::Sub, false) => self.one(held, |a| simd.sub_f32s(a, s)),
            (Op::Sub, true) => self.one(held, |a| simd.sub_f32s(s, a)),
            (Op::Div, false) => self.one(held, |a| simd.div_f32s(a, s)),
            (Op::Div, true) => self.one(held, |a| simd.div_f32s(s, a)),
            (Op::Min, false) => self.one(held, |a| lesser(simd, a, s)),
            (Op::Min, true) => self.one(held, |a| lesser(simd, s, a)),
            (Op::Max, false) => self.one(held, |a| greater(simd, a, s)),
            (Op::Max, true) => self.one(held, |a| greater(simd, s, a)),
            (Op::Less, false) => self.one(held, |a| truth(simd, simd.less_than_f32s(a, s))),
            (Op::Less, true) => self.one(held, |a| truth(simd, simd.less_than_f32s(s, a))),
            (Op::LessEqual, false) => self.one(held, |a| truth(simd, simd.less_than_or_equal_f32s(a, s))),
            (Op::LessEqual, true) => self.one(held, |a| truth(simd, simd.less_than_or_equal_f32s(s, a))),
            _ => {}
        }
    }
}

/// Whether the least and the greatest of two numbers are one instruction which gives the second where neither is less,
/// be they equal or not numbers, as a comparison and a choice do: AVX2 and AVX-512, which alone have such wide vectors.
const fn has_extremes<S: Simd>() -> bool {
    S::F32_LANES >= 8
}

/// [`crate::math::fun::lesser`] in each lane.
#[inline(always)]
fn lesser<S: Simd>(simd: S, a: S::f32s, b: S::f32s) -> S::f32s {
    if has_extremes::<S>() { simd.min_f32s(a, b) } else { simd.select_f32s(simd.less_than_f32s(a, b), a, b) }
}

/// [`crate::math::fun::greater`] in each lane.
#[inline(always)]
fn greater<S: Simd>(simd: S, a: S::f32s, b: S::f32s) -> S::f32s {
    if has_extremes::<S>() {
        simd.max_f32s(a, b)
    } else {
        simd.select_f32s(simd.greater_than_f32s(a, b), a, b)
    }
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
