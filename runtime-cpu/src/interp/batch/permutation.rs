//! The published permutation in registers of AVX-512, where 32 points look it up at once without reading memory.
//!
//! In: the cells of a batch. Out: [`table_codes`](crate::math::noise::table_codes) of each.

use super::noise::Cells;
use crate::math::noise::{CODE_PAIRS, PAIRS};
use pulp::x86::V4;
use pulp::{NullaryFnOnce, cast};
use std::arch::x86_64::__m512i;

/// Words in a register.
const WORDS: usize = 32;

/// Words of a register.
type Words = [u16; WORDS];

/// Sets the codes of cells, as `pulp` wants it.
pub(super) struct LookUp<'a> {
    pub(super) simd: V4,
    pub(super) cells: &'a mut Cells,
}

impl NullaryFnOnce for LookUp<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Cells { points, corner: [x, y, z], codes, .. } = self.cells;
        let [x, y, z] = [x.as_chunks().0, y.as_chunks().0, z.as_chunks().0];
        let codes = codes.as_chunks_mut::<WORDS>().0;
        let table = Table::new(self.simd);
        for part in 0..points.div_ceil(WORDS).min(codes.len()) {
            let [low, high] = table.codes([x[part], y[part], z[part]]);
            for i in 0..WORDS {
                codes[part][i] = u32::from(low[i]) | (u32::from(high[i]) << 16);
            }
        }
    }
}

/// A table of pairs, 32 of them in each register.
type Registers = [__m512i; 8];

/// What is looked up, and what that takes.
#[derive(Clone, Copy)]
struct Table {
    simd: V4,
    pairs: Registers,
    codes: Registers,
    bit_6: __m512i,
    bit_7: __m512i,
}

impl Table {
    #[inline(always)]
    fn new(simd: V4) -> Self {
        let [pairs, codes] = [registers(PAIRS), registers(CODE_PAIRS)];
        Self { simd, pairs, codes, bit_6: same(simd, 1 << 6), bit_7: same(simd, 1 << 7) }
    }

    /// The words at indices of which the lowest 8 bits count.
    #[inline(always)]
    fn look(&self, table: &Registers, index: __m512i) -> __m512i {
        let avx512bw = self.simd.avx512bw;
        // Two registers take the lowest six bits; the upper two decide between the four pairs of registers.
        let a = avx512bw._mm512_permutex2var_epi16(table[0], index, table[1]);
        let b = avx512bw._mm512_permutex2var_epi16(table[2], index, table[3]);
        let c = avx512bw._mm512_permutex2var_epi16(table[4], index, table[5]);
        let d = avx512bw._mm512_permutex2var_epi16(table[6], index, table[7]);
        let bit_6 = avx512bw._mm512_test_epi16_mask(index, self.bit_6);
        let bit_7 = avx512bw._mm512_test_epi16_mask(index, self.bit_7);
        let lower = avx512bw._mm512_mask_blend_epi16(bit_6, a, b);
        let upper = avx512bw._mm512_mask_blend_epi16(bit_6, c, d);
        avx512bw._mm512_mask_blend_epi16(bit_7, lower, upper)
    }

    /// The words at the sums of a coordinate with the lower and with the upper entries of pairs.
    #[inline(always)]
    fn look_twice(&self, table: &Registers, pair: __m512i, coordinate: __m512i) -> [__m512i; 2] {
        let avx512bw = self.simd.avx512bw;
        let upper = avx512bw._mm512_srli_epi16::<8>(pair);
        [
            self.look(table, avx512bw._mm512_add_epi16(pair, coordinate)),
            self.look(table, avx512bw._mm512_add_epi16(upper, coordinate)),
        ]
    }

    /// The lower and the upper halves of the codes of cells.
    #[inline(always)]
    fn codes(&self, [x, y, z]: [Words; 3]) -> [Words; 2] {
        let (simd, avx512bw) = (self.simd, self.simd.avx512bw);
        let [x, y, z] = [cast(x), cast(y), cast(z)];
        let [at_0, at_1] = self.look_twice(&self.pairs, self.look(&self.pairs, x), y);
        let [at_00, at_01] = self.look_twice(&self.codes, at_0, z);
        let [at_10, at_11] = self.look_twice(&self.codes, at_1, z);
        // Two codes to a byte, those with k = 0 in the lower one.
        let j_0 = simd.avx512f._mm512_or_si512(at_00, avx512bw._mm512_slli_epi16::<4>(at_10));
        let j_1 = simd.avx512f._mm512_or_si512(at_01, avx512bw._mm512_slli_epi16::<4>(at_11));
        // Lower bytes together, upper bytes together.
        let low_byte = same(simd, 0x00ff);
        [
            cast(select(simd, low_byte, j_0, avx512bw._mm512_slli_epi16::<8>(j_1))),
            cast(select(simd, low_byte, avx512bw._mm512_srli_epi16::<8>(j_0), j_1)),
        ]
    }
}

#[inline(always)]
fn registers(table: [u16; 256]) -> Registers {
    let words: [Words; 8] = cast(table);
    cast(words)
}

/// The same word at all points.
#[inline(always)]
fn same(simd: V4, word: i16) -> __m512i {
    simd.avx512f._mm512_set1_epi16(word)
}

/// The bits of `a` where `mask` has them set, elsewhere those of `b`.
#[inline(always)]
fn select(simd: V4, mask: __m512i, a: __m512i, b: __m512i) -> __m512i {
    simd.avx512f._mm512_ternarylogic_epi32::<0b1100_1010>(mask, a, b)
}
