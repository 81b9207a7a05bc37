//! Sixteen numbers at a time: a register of AVX-512, with operators.
//!
//! Everything is inlined by force into a function that `pulp` compiles for these instructions.

use pulp::x86::V4;
use pulp::{cast, f32x16, u32x16};
use std::f32::consts::{LN_2, LOG2_E};
use std::ops::{Add, Div, Mul, Sub};

/// Numbers in a register.
pub(crate) const LANES: usize = 16;

/// A yes or no for each lane, the first in the lowest bit.
pub(crate) type Mask = u16;

/// Arguments of [`Lanes::decay`] are held at this: the result is then below 2^-115.
const DARKEST: f32 = 80.0;

/// Coefficients of 2^f, `ln(2)^k / k!` for k = 6 to 0: within 1.3e-7 for f in ±1/2.
const POWER: [f32; 7] =
    [0.000_154_035_3, 0.001_333_355_8, 0.009_618_129, 0.055_504_11, 0.240_226_5, LN_2, 1.0];

/// Sixteen numbers.
#[derive(Clone, Copy)]
pub(crate) struct Lanes {
    simd: V4,
    numbers: f32x16,
}

/// Sixteen whole numbers.
#[derive(Clone, Copy)]
pub(crate) struct Words {
    simd: V4,
    words: u32x16,
}

impl Lanes {
    /// The same number in all.
    #[inline(always)]
    pub(crate) fn splat(simd: V4, number: f32) -> Self {
        Self { simd, numbers: simd.splat_f32x16(number) }
    }

    #[inline(always)]
    pub(crate) fn of(simd: V4, numbers: [f32; LANES]) -> Self {
        Self { simd, numbers: cast(numbers) }
    }

    #[inline(always)]
    pub(crate) fn array(self) -> [f32; LANES] {
        cast(self.numbers)
    }

    /// The same number in all, for the same instructions.
    #[inline(always)]
    pub(crate) fn same(self, number: f32) -> Self {
        Self::splat(self.simd, number)
    }

    /// A number, and those that follow when one counts on.
    #[inline(always)]
    pub(crate) fn counted(self, first: f32) -> Self {
        let counted = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0, 11.0, 12.0, 13.0, 14.0, 15.0];
        Self::of(self.simd, counted).scaled(1.0, first)
    }

    /// `self * factor + term`, rounded once.
    #[inline(always)]
    pub(crate) fn mul_add(self, factor: Self, term: Self) -> Self {
        Self { numbers: self.simd.mul_add_f32x16(self.numbers, factor.numbers, term.numbers), ..self }
    }

    /// `self * factor + term` with the same factor and term in all lanes.
    #[inline(always)]
    pub(crate) fn scaled(self, factor: f32, term: f32) -> Self {
        self.mul_add(self.same(factor), self.same(term))
    }

    #[inline(always)]
    pub(crate) fn floor(self) -> Self {
        Self { numbers: self.simd.floor_f32x16(self.numbers), ..self }
    }

    #[inline(always)]
    pub(crate) fn sqrt(self) -> Self {
        Self { numbers: self.simd.sqrt_f32x16(self.numbers), ..self }
    }

    #[inline(always)]
    pub(crate) fn hold(self, low: f32, high: f32) -> Self {
        let above = self.simd.max_f32x16(self.numbers, self.simd.splat_f32x16(low));
        Self { numbers: self.simd.min_f32x16(above, self.simd.splat_f32x16(high)), ..self }
    }

    /// In which lanes it is more than a number.
    #[inline(always)]
    pub(crate) fn above(self, number: f32) -> Mask {
        self.simd.cmp_gt_f32x16(self.numbers, self.simd.splat_f32x16(number)).0
    }

    #[inline(always)]
    pub(crate) fn largest(self) -> f32 {
        self.simd.avx512f._mm512_reduce_max_ps(cast(self.numbers))
    }

    /// `exp(-self)`, for numbers of at least 0.
    ///
    /// * error: 2e-7 of the result, and a unit in the last place of `self`
    /// * method: powers of two, whole and fractional part apart
    #[inline(always)]
    pub(crate) fn decay(self) -> Self {
        let power = self.hold(0.0, DARKEST) * self.same(-LOG2_E);
        let whole = power.scaled(1.0, 0.5).floor();
        let part = power - whole;
        let [first, others @ ..] = POWER.map(|number| self.same(number));
        let of_part = others.into_iter().fold(first, |sum, term| sum.mul_add(part, term));
        Self {
            numbers: cast(self.simd.avx512f._mm512_scalef_ps(cast(of_part.numbers), cast(whole.numbers))),
            ..self
        }
    }

    /// The lanes of a mask, side by side from the first one on; 0 in the others.
    #[inline(always)]
    pub(crate) fn compressed(self, mask: Mask) -> [f32; LANES] {
        cast(self.simd.avx512f._mm512_maskz_compress_ps(mask, cast(self.numbers)))
    }

    /// Whole numbers of at least 0 as such.
    #[inline(always)]
    pub(crate) fn words(self) -> Words {
        Words { simd: self.simd, words: cast(self.simd.convert_f32x16_to_i32x16(self.numbers)) }
    }
}

impl Words {
    #[inline(always)]
    pub(crate) fn of(simd: V4, words: [u32; LANES]) -> Self {
        Self { simd, words: cast(words) }
    }

    #[inline(always)]
    pub(crate) fn array(self) -> [u32; LANES] {
        cast(self.words)
    }

    /// Without the lowest four bits.
    #[inline(always)]
    pub(crate) fn next_code(self) -> Self {
        Self { words: cast(self.simd.avx512f._mm512_srli_epi32::<4>(cast(self.words))), ..self }
    }
}

/// Entries of a table, by the lowest four bits of words.
#[inline(always)]
pub(crate) fn look_up(table: &[f32; LANES], Words { simd, words }: Words) -> Lanes {
    Lanes { simd, numbers: cast(simd.avx512f._mm512_permutexvar_ps(cast(words), cast(*table))) }
}

/// From `a` at 0 to `b` at 1.
#[inline(always)]
pub(crate) fn blend(t: Lanes, a: Lanes, b: Lanes) -> Lanes {
    t.mul_add(b - a, a)
}

impl Add for Lanes {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self { numbers: self.simd.add_f32x16(self.numbers, other.numbers), ..self }
    }
}

impl Sub for Lanes {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self { numbers: self.simd.sub_f32x16(self.numbers, other.numbers), ..self }
    }
}

impl Mul for Lanes {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self { numbers: self.simd.mul_f32x16(self.numbers, other.numbers), ..self }
    }
}

impl Div for Lanes {
    type Output = Self;

    #[inline(always)]
    fn div(self, other: Self) -> Self {
        Self { numbers: self.simd.div_f32x16(self.numbers, other.numbers), ..self }
    }
}
