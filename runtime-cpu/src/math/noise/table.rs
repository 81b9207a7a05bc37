//! Gradient codes of cells by the published permutation.
//!
//! In: the whole coordinates of a cell. Out: the codes of its eight corners in one word.

use vol_compiler::noise_table::PERMUTATION;

/// How many codes there are here.
pub(super) const TABLE_CODES: u32 = 12;
/// Codes 12 to 15 of the author's rule name directions, and sums, that others name, too.
const FOLDED: [u8; 16] = [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 0, 9, 1, 11];

/// The permutation in pairs.
pub(crate) static PAIRS: [u16; 256] = in_pairs(PERMUTATION);
/// Gradient codes of its entries in pairs.
pub(crate) static CODE_PAIRS: [u16; 256] = in_pairs(codes_of_entries());

/// Each entry in the low byte with the one after it in the high byte: what finds a corner finds its neighbour, so that a
/// cell takes 7 look-ups instead of 14.
const fn in_pairs(entries: [u8; 256]) -> [u16; 256] {
    let mut pairs = [0; 256];
    let mut i = 0;
    while i < 256 {
        pairs[i] = u16::from_le_bytes([entries[i], entries[(i + 1) % 256]]);
        i += 1;
    }
    pairs
}

const fn codes_of_entries() -> [u8; 256] {
    let mut codes = PERMUTATION;
    let mut i = 0;
    while i < 256 {
        codes[i] = FOLDED[(codes[i] & 15) as usize];
        i += 1;
    }
    codes
}

/// Gradient codes of all corners of a cell by the published permutation, four bits each, below 12: that of `(i, j, k)`
/// starts at bit `4 (i + 2 j + 4 k)`. Of each coordinate the lowest 8 bits count.
#[inline(always)]
pub fn table_codes([x, y, z]: [i32; 3]) -> u32 {
    let look = |pairs: &[u16; 256], i: i32| i32::from(pairs[(i & 255) as usize]);
    let by_x = look(&PAIRS, x);
    let mut codes = 0;
    for i in 0..2 {
        let by_y = look(&PAIRS, (by_x >> (8 * i)) + y);
        for j in 0..2 {
            let pair = look(&CODE_PAIRS, (by_y >> (8 * j)) + z);
            codes |= ((pair & 15) | ((pair & 0xf00) << 8)) << (4 * (i + 2 * j));
        }
    }
    codes as u32
}

#[cfg(test)]
mod tests {
    use super::super::{HASH_CODES, edge_value, edge_vector, packed_code};
    use super::*;
    use vol_compiler::noise_table::table_cell;

    #[test]
    fn codes_of_cells_are_the_published_ones() {
        let coordinates = [-4_194_303, -65_537, -257, -256, -1, 0, 1, 127, 254, 255, 256, 32_768, 4_194_302];
        for x in coordinates {
            for y in coordinates {
                for z in coordinates.into_iter().chain(-300..300) {
                    let codes = table_codes([x, y, z]);
                    for [i, j, k] in (0..8).map(|corner| [corner & 1, (corner >> 1) & 1, corner >> 2]) {
                        let published = table_cell(x + i, y + j, z + k);
                        let found = packed_code(codes, [i, j, k]) & 15;
                        assert_eq!(found, u32::from(FOLDED[published as usize]), "{x} {y} {z}, {i} {j} {k}");
                    }
                }
            }
        }
    }

    #[test]
    fn folded_codes_have_the_same_edges() {
        let offsets = [-1.0, -0.7, -0.0, 0.0, 0.3, 1.0];
        for code in 0..16 {
            let folded = FOLDED[code as usize].into();
            assert!(folded < TABLE_CODES);
            let vectors = [edge_vector::<HASH_CODES>(code), edge_vector::<TABLE_CODES>(folded)];
            assert_eq!(vectors[0].map(f32::to_bits), vectors[1].map(f32::to_bits), "{code}");
            for [x, y, z] in offsets.iter().flat_map(|x| offsets.iter().map(move |y| [*x, *y, x * y + 0.1])) {
                let values = [
                    edge_value::<HASH_CODES>(code, x, y, z),
                    edge_value::<TABLE_CODES>(folded, x, y, z),
                    edge_value::<HASH_CODES>(code, z, x, y),
                    edge_value::<TABLE_CODES>(folded, z, x, y),
                ];
                let [a, b, c, d] = values.map(f32::to_bits);
                assert_eq!([a, c], [b, d], "{code}");
            }
        }
    }
}
