//! The integers behind the noises: one published table, one lattice hash, and the exact numbers made of it.
//!
//! Integers, and fractions with few bits, are exact on every device, so the reference evaluator and the
//! CPU kernels share these definitions; `wgsl/noise.wgsl` spells the same ones out again.
//!
//! In: a lattice cell and a seed. Out: which of the 16 gradient codes it carries (improved Perlin noise),
//! for example `gradient_code(3, 42, 7, 0)` is 2; or a word of 32 random bits (the other noises), and
//! from it a number of 0..1 or a point of the unit cube.

/// Ken Perlin's published permutation of 0..=255.
///
/// * meaning: entry `i` is the image of `i`; used as `P[P[P[x] + y] + z]`, indices taken modulo 256
/// * source: K. Perlin, "Improving Noise" (SIGGRAPH 2002) and its reference implementation
/// * test: `is_a_permutation`, `matches_published_gradient_codes`
#[rustfmt::skip]
pub const PERMUTATION: [u8; 256] = [
    151, 160, 137,  91,  90,  15, 131,  13, 201,  95,  96,  53, 194, 233,   7, 225,
    140,  36, 103,  30,  69, 142,   8,  99,  37, 240,  21,  10,  23, 190,   6, 148,
    247, 120, 234,  75,   0,  26, 197,  62,  94, 252, 219, 203, 117,  35,  11,  32,
     57, 177,  33,  88, 237, 149,  56,  87, 174,  20, 125, 136, 171, 168,  68, 175,
     74, 165,  71, 134, 139,  48,  27, 166,  77, 146, 158, 231,  83, 111, 229, 122,
     60, 211, 133, 230, 220, 105,  92,  41,  55,  46, 245,  40, 244, 102, 143,  54,
     65,  25,  63, 161,   1, 216,  80,  73, 209,  76, 132, 187, 208,  89,  18, 169,
    200, 196, 135, 130, 116, 188, 159,  86, 164, 100, 109, 198, 173, 186,   3,  64,
     52, 217, 226, 250, 124, 123,   5, 202,  38, 147, 118, 126, 255,  82,  85, 212,
    207, 206,  59, 227,  47,  16,  58,  17, 182, 189,  28,  42, 223, 183, 170, 213,
    119, 248, 152,   2,  44, 154, 163,  70, 221, 153, 101, 155, 167,  43, 172,   9,
    129,  22,  39, 253,  19,  98, 108, 110,  79, 113, 224, 232, 178, 185, 112, 104,
    218, 246,  97, 228, 251,  34, 242, 193, 238, 210, 144,  12, 191, 179, 162, 241,
     81,  51, 145, 235, 249,  14, 239, 107,  49, 192, 214,  31, 181, 199, 106, 157,
    184,  84, 204, 176, 115, 121,  50,  45, 127,   4, 150, 254, 138, 236, 205,  93,
    222, 114,  67,  29,  24,  72, 243, 141, 128, 195,  78,  66, 215,  61, 156, 180,
];

/// Words of [`permutation_words`].
pub const WORDS: usize = PERMUTATION.len();

/// The permutation as the words of the buffer `vol_permutation` that the shaders read.
pub fn permutation_words() -> [u32; WORDS] {
    PERMUTATION.map(u32::from)
}

/// Gradient code 0..=15 of a lattice cell.
///
/// * `x`, `y`, `z`: lattice coordinates, any `i32`
/// * `seed`: 0 is the published table (the pattern then repeats every 256 cells); any other
///   seed is [`hash_cell`], which does not repeat
#[inline(always)]
pub fn gradient_code(x: i32, y: i32, z: i32, seed: u32) -> u32 {
    if seed == 0 { table_cell(x, y, z) } else { hash_cell(x, y, z, seed) }
}

/// Gradient code of a cell from [`PERMUTATION`]: `P[P[P[x] + y] + z] & 15`.
#[inline(always)]
pub fn table_cell(x: i32, y: i32, z: i32) -> u32 {
    let look = |i: i32| i32::from(PERMUTATION[(i & 255) as usize]);
    (look(look(look(x).wrapping_add(y)).wrapping_add(z)) & 15) as u32
}

/// Gradient code of a cell from an integer hash, all arithmetic modulo 2^32.
///
/// * method: the coordinates and the seed are spread by odd multipliers and joined with xor, then
///   two multiply-xorshift rounds; the top four bits are the code, since the top bits of a product
///   depend on every bit below them
/// * source: round constants of the `lowbias32` search, C. Wellons, "Prospecting for Hash
///   Functions" (2018); the spreading multipliers are large odd constants
/// * test: `hash_codes_are_even` (frequencies, neighbours, seeds)
#[inline(always)]
pub fn hash_cell(x: i32, y: i32, z: i32, seed: u32) -> u32 {
    mixed(spread(x, y, z, seed)) >> 28
}

/// 32 random bits of a cell of four-dimensional space, the same hash with its last xorshift.
///
/// * `w`: 0 where there are but three coordinates; unlike [`hash_cell`], the cell 0 with seed 0 is as
///   random as any other
/// * test: `words_are_even`
#[inline(always)]
pub fn hash_word(x: i32, y: i32, z: i32, w: i32, seed: u32) -> u32 {
    let fourth = (w as u32).wrapping_mul(0xc2b2_ae35) ^ 0x27d4_eb2f;
    let word = mixed(spread(x, y, z, seed) ^ fourth);
    word ^ (word >> 16)
}

/// Spread three coordinates and a seed and join them.
#[inline(always)]
fn spread(x: i32, y: i32, z: i32, seed: u32) -> u32 {
    let spread_xy = (x as u32).wrapping_mul(0x8da6_b343) ^ (y as u32).wrapping_mul(0xd816_3841);
    let spread_zs = (z as u32).wrapping_mul(0xcb1a_b31f) ^ seed.wrapping_mul(0x9e37_79b1);
    spread_xy ^ spread_zs
}

/// Two multiply-xorshift rounds.
#[inline(always)]
fn mixed(joined: u32) -> u32 {
    let first = (joined ^ (joined >> 16)).wrapping_mul(0x7feb_352d);
    (first ^ (first >> 15)).wrapping_mul(0x846c_a68b)
}

/// The number `k / 2^24` of the top 24 bits of a word: exact, 0 to below 1.
#[inline(always)]
pub fn unit_number(word: u32) -> f32 {
    // The cast goes through i32, which vector instructions convert.
    (word >> 8) as i32 as f32 * (1.0 / 16_777_216.0)
}

/// A point of the unit cube from ten bits of a word each: `(k + 1/2) / 1024`, exact.
#[inline(always)]
pub fn unit_point(word: u32) -> [f32; 3] {
    let coordinate = |bits: u32| ((bits & 1023) as i32 as f32 + 0.5) * (1.0 / 1024.0);
    [coordinate(word), coordinate(word >> 10), coordinate(word >> 20)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn is_a_permutation() {
        let mut seen = [false; 256];
        for value in PERMUTATION {
            seen[usize::from(value)] = true;
        }
        assert!(seen.iter().all(|&s| s));
        assert_eq!(permutation_words()[255], 180);
    }

    #[test]
    fn matches_published_gradient_codes() {
        // P[0] = 151, P[151] = 17, P[17] = 36: the published nesting by hand.
        assert_eq!(PERMUTATION[151], 17);
        assert_eq!(gradient_code(3, 42, 7, 0), 2);
        assert_eq!(gradient_code(0, 0, 0, 0), 36 & 15);
        assert_eq!(gradient_code(256, -256, 512, 0), 36 & 15);
        assert_eq!(gradient_code(i32::MAX, i32::MIN, -1, 0), gradient_code(255, 0, 255, 0));
    }

    /// Largest deviation of a 16-bin or 256-bin histogram, in standard deviations.
    fn worst_deviation(counts: &[u32]) -> f64 {
        let total: u32 = counts.iter().sum();
        let expected = f64::from(total) / counts.len() as f64;
        counts.iter().map(|&c| (f64::from(c) - expected).abs() / expected.sqrt()).fold(0.0, f64::max)
    }

    #[test]
    fn hash_codes_are_even() {
        // Code pairs of a cell and of its neighbours in space and in seed.
        for (dx, dy, dz, ds) in [
            (1, 0, 0, 0),
            (0, 1, 0, 0),
            (0, 0, 1, 0),
            (1, 1, 1, 0),
            (2, -1, 3, 0),
            (0, 0, 0, 1),
            (0, 0, 0, 7),
        ] {
            let mut pairs = [0u32; 256];
            for i in 0..64 * 64 * 64 {
                let (x, y, z) = ((i & 63) - 32, ((i >> 6) & 63) - 32, (i >> 12) - 32);
                let a = hash_cell(x, y, z, 5);
                let b = hash_cell(x + dx, y + dy, z + dz, 5 + ds);
                pairs[(a * 16 + b) as usize] += 1;
            }
            let worst = worst_deviation(&pairs);
            assert!(worst < 5.0, "offset {dx} {dy} {dz} seed +{ds}: {worst} standard deviations");
        }
    }

    /// Pairs of four bits of two words, over a cube of cells.
    fn pairs_of(bits: u32, other: impl Fn(i32, i32, i32) -> u32) -> f64 {
        let mut pairs = [0u32; 256];
        for i in 0..64 * 64 * 64 {
            let (x, y, z) = ((i & 63) - 32, ((i >> 6) & 63) - 32, (i >> 12) - 32);
            let (a, b) = (hash_word(x, y, z, 0, 0), other(x, y, z));
            pairs[(((a >> bits) & 15) * 16 + ((b >> bits) & 15)) as usize] += 1;
        }
        worst_deviation(&pairs)
    }

    /// Of twenty thousand even counts one in forty million is as far off as 5.5 standard deviations.
    #[test]
    fn words_are_even() {
        for bits in [0, 6, 10, 16, 20, 26, 28] {
            for [dx, dy, dz, dw] in [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1], [1, -1, 2, -1]] {
                for seed in [0, 1] {
                    let worst = pairs_of(bits, |x, y, z| hash_word(x + dx, y + dy, z + dz, dw, seed));
                    assert!(worst < 5.5, "bit {bits} offset {dx} {dy} {dz} {dw} seed {seed}: {worst}");
                }
            }
            // Within one word.
            let worst = pairs_of(bits, |x, y, z| hash_word(x, y, z, 0, 0).rotate_left(10));
            assert!(worst < 5.5, "bit {bits}: {worst}");
        }
    }

    #[test]
    fn numbers_of_words() {
        assert_eq!([unit_number(0), unit_number(u32::MAX)], [0.0, 1.0 - 2f32.powi(-24)]);
        assert_eq!(unit_point(0), [0.5 / 1024.0; 3]);
        assert_eq!(unit_point(u32::MAX), [1023.5 / 1024.0; 3]);
        assert_eq!(unit_point(0x0000_0400), [0.5 / 1024.0, 1.5 / 1024.0, 0.5 / 1024.0]);
        let cells = [-1, 0, 1].map(|i| hash_word(i, 0, 0, 0, 0));
        assert!(cells.iter().all(|&word| unit_number(word) > 0.01), "{cells:?}");
    }
}
