//! Noises in f32, the same text as `compiler/src/wgsl/noise.wgsl`; each room is the twin of a file there, but for `table`: shaders look
//! corners up one by one.
//!
//! In: a point in lattice units (one cell is one unit) and a seed. Out: improved Perlin noise, its
//! exact gradient, and sums of octaves; the other noises are in rooms of their own. Example: `perlin([3.14, 42.0, 7.0], 0)` is 0.136919…,
//! the value its author publishes.
//!
//! Everything is inlined by force: only then does a loop over points vectorise (5 ns instead of 43 a
//! point with AVX-512). For the same reason batch callers sum octaves themselves, octaves outside and
//! points inside, with [`octave_count`] and [`next_octave`] in the order of [`fbm`].
//!
//! Bounds for every hash (`algorithms.md` §4.1): value at most 1.0363538113, gradient length at
//! most 3.75. Source: K. Perlin, "Improving Noise", SIGGRAPH 2002.

mod perlin4;
mod simplex;
mod table;
mod value;
mod worley;

pub use perlin4::{perlin4, perlin4_gradient};
pub use simplex::{simplex, simplex_gradient};
use table::TABLE_CODES;
pub use table::table_codes;
#[cfg(target_arch = "x86_64")]
pub(crate) use table::{CODE_PAIRS, PAIRS};
pub use value::{value, value_gradient};
pub use worley::{Nearest, worley, worley_gradient};

use vol_compiler::noise_table::{hash_cell, hash_word, unit_number};

use super::fun::{floor, hold, whole_to_int};

/// Coordinates are held within ± this, where f32 has a fraction left and the cell is an exact i32.
const FIELD: f32 = 4_194_303.0;
/// Coordinates of [`hash`] are held within ± this, the whole numbers of the language.
const WHOLES: f32 = 16_777_216.0;
/// Running products of [`fbm`] are held within ± this, so that no octave overflows.
const PRODUCT: f32 = 1.099_511_6e12;
/// Most octaves a sum may have.
const OCTAVES: f32 = 32.0;

/// One lattice cell: its whole coordinates and the place inside it.
struct Cell {
    corner: [i32; 3],
    place: [f32; 3],
}

/// Find the cell of a point.
#[inline(always)]
fn cell_of(p: [f32; 3]) -> Cell {
    let held = p.map(|x| hold(x, -FIELD, FIELD));
    let whole = held.map(floor);
    let place = [held[0] - whole[0], held[1] - whole[1], held[2] - whole[2]];
    Cell { corner: whole.map(whole_to_int), place }
}

/// Weight `6 t^5 - 15 t^4 + 10 t^3`, t in [0, 1].
///
/// Written about the middle of the cell, `1/2 + s (15/8 - s^2 (5 - 6 s^2))`: the usual Horner form
/// subtracts numbers near 10 and loses a digit (1e-6 instead of 1.2e-7). Exact at 0, 1/2 and 1.
#[inline(always)]
fn fade(t: f32) -> f32 {
    let s = t - 0.5;
    let ss = s * s;
    0.5 + (s * (1.875 - (ss * (5.0 - (6.0 * ss)))))
}

/// Derivative of [`fade`], `30 (t (1 - t))^2`, about the middle of the cell as well:
/// `15/8 - s^2 (15 - 30 s^2)`.
#[inline(always)]
fn fade_slope(t: f32) -> f32 {
    let s = t - 0.5;
    let ss = s * s;
    1.875 - (ss * (15.0 - (30.0 * ss)))
}

#[inline(always)]
fn lerp(t: f32, a: f32, b: f32) -> f32 {
    a + (t * (b - a))
}

/// How many codes hashes have.
const HASH_CODES: u32 = 16;

/// Dot product of the edge gradient `code & 15` with an offset: the author's rule, 12 directions
/// of which 4 count twice, where there are 16 `CODES`.
#[inline(always)]
fn edge_value<const CODES: u32>(code: u32, x: f32, y: f32, z: f32) -> f32 {
    let u = if (code & 8) == 0 { x } else { y };
    let v = if (code & 12) == 0 { y } else { other_axis::<CODES>(code, x, z) };
    flipped(u, code << 31) + flipped(v, code << 30)
}

/// `x`, negated where the highest of `bits` is set: fewer vector instructions than a choice.
#[inline(always)]
fn flipped(x: f32, bits: u32) -> f32 {
    f32::from_bits(x.to_bits() ^ (bits & 0x8000_0000))
}

/// Codes 12 and 14 take x, the others z.
#[inline(always)]
fn other_axis<const CODES: u32>(code: u32, x: f32, z: f32) -> f32 {
    if wraps::<CODES>(code) { x } else { z }
}

#[inline(always)]
fn wraps<const CODES: u32>(code: u32) -> bool {
    CODES > 12 && (code & 13) == 12
}

/// The edge gradient itself, two of three components ±1.
#[inline(always)]
fn edge_vector<const CODES: u32>(code: u32) -> [f32; 3] {
    let (signed_u, signed_v) = (flipped(1.0, code << 31), flipped(1.0, code << 30));
    let wraps = wraps::<CODES>(code);
    let x = if (code & 8) == 0 {
        signed_u
    } else if wraps {
        signed_v
    } else {
        0.0
    };
    let y = if (code & 12) == 0 {
        signed_v
    } else if (code & 8) == 0 {
        0.0
    } else {
        signed_u
    };
    let z = if ((code & 12) == 0) | wraps { 0.0 } else { signed_v };
    [x, y, z]
}

/// Gradient code of the corner `(i, j, k)` of a cell by its hash; seed not 0.
#[inline(always)]
fn hashed_code(corner: [i32; 3], [i, j, k]: [i32; 3], seed: u32) -> u32 {
    hash_cell(corner[0] + i, corner[1] + j, corner[2] + k, seed)
}

/// Whole coordinates of the cell of a point, and the place inside it.
#[inline(always)]
pub fn cell_and_place(p: [f32; 3]) -> ([i32; 3], [f32; 3]) {
    let c = cell_of(p);
    (c.corner, c.place)
}

/// The code of a corner among [`table_codes`] in the lowest four bits. Codes of other corners are left above it: of
/// numbers below 16 the compiler makes comparisons, which need the bits shifted to their places, where a test does not.
#[inline(always)]
fn packed_code(codes: u32, [i, j, k]: [i32; 3]) -> u32 {
    codes >> (4 * (i + 2 * j + 4 * k))
}

/// Value of the noise in a cell, given the codes of its corners.
#[inline(always)]
fn lattice<const CODES: u32>(place: [f32; 3], code: impl Fn([i32; 3]) -> u32) -> f32 {
    let [u, v, w] = place.map(fade);
    let corner = |i: i32, j: i32, k: i32| {
        edge_value::<CODES>(code([i, j, k]), place[0] - i as f32, place[1] - j as f32, place[2] - k as f32)
    };
    // Blend the four edges along x.
    let e00 = lerp(u, corner(0, 0, 0), corner(1, 0, 0));
    let e10 = lerp(u, corner(0, 1, 0), corner(1, 1, 0));
    let e01 = lerp(u, corner(0, 0, 1), corner(1, 0, 1));
    let e11 = lerp(u, corner(0, 1, 1), corner(1, 1, 1));
    // Blend along y, then along z.
    lerp(w, lerp(v, e00, e10), lerp(v, e01, e11))
}

/// Improved Perlin noise.
///
/// * `p`: lattice units; each coordinate is held within ±4194303
/// * `seed`: 0 is the author's published permutation, which repeats every 256 units; any other
///   seed hashes the cell and does not repeat
/// * returns: within ±1.0363538113, zero at lattice points
/// * error: 4e-7 against f64 at the same f32 point (test `values_match_f64`)
/// * source: K. Perlin 2002; published fact `noise(3.14, 42, 7) = 0.13691995878400012`
#[inline(always)]
pub fn perlin(p: [f32; 3], seed: u32) -> f32 {
    if seed == 0 {
        let c = cell_of(p);
        perlin_of_codes(c.place, table_codes(c.corner))
    } else {
        perlin_hashed(p, seed)
    }
}

/// [`perlin`] with a seed that is not 0.
#[inline(always)]
pub fn perlin_hashed(p: [f32; 3], seed: u32) -> f32 {
    let c = cell_of(p);
    lattice::<HASH_CODES>(c.place, |ijk| hashed_code(c.corner, ijk, seed))
}

/// [`perlin`] with seed 0, given the place inside a cell and the cell's [`table_codes`].
#[inline(always)]
pub fn perlin_of_codes(place: [f32; 3], codes: u32) -> f32 {
    lattice::<TABLE_CODES>(place, |ijk| packed_code(codes, ijk))
}

/// A value with what its gradient is made of: blended corner gradients, and the slopes by which
/// the blending weights enter.
#[derive(Clone, Copy)]
struct Blend<const N: usize> {
    value: f32,
    gradient: [f32; N],
    slope: [f32; N],
}

/// Blend two neighbours along one axis and note the slope there.
#[inline(always)]
fn blend<const N: usize>(axis: usize, t: f32, a: Blend<N>, b: Blend<N>) -> Blend<N> {
    let mix = |p: [f32; N], q: [f32; N]| core::array::from_fn(|i| lerp(t, p[i], q[i]));
    let rise = b.value - a.value;
    let mut slope: [f32; N] = mix(a.slope, b.slope);
    slope[axis] = rise;
    Blend { value: a.value + (t * rise), gradient: mix(a.gradient, b.gradient), slope }
}

/// Value and gradient of the noise in a cell, given the codes of its corners.
#[inline(always)]
fn lattice_gradient<const CODES: u32>(place: [f32; 3], code: impl Fn([i32; 3]) -> u32) -> [f32; 4] {
    let [u, v, w] = place.map(fade);
    let at = |i: i32, j: i32, k: i32| {
        let code = code([i, j, k]);
        let value = edge_value::<CODES>(code, place[0] - i as f32, place[1] - j as f32, place[2] - k as f32);
        Blend { value, gradient: edge_vector::<CODES>(code), slope: [0.0; 3] }
    };
    // Blend the four edges along x.
    let e00 = blend(0, u, at(0, 0, 0), at(1, 0, 0));
    let e10 = blend(0, u, at(0, 1, 0), at(1, 1, 0));
    let e01 = blend(0, u, at(0, 0, 1), at(1, 0, 1));
    let e11 = blend(0, u, at(0, 1, 1), at(1, 1, 1));
    // Blend along y, then along z.
    let whole = blend(2, w, blend(1, v, e00, e10), blend(1, v, e01, e11));
    // Add the slopes of the weights to the blended gradients.
    let dx = whole.gradient[0] + (fade_slope(place[0]) * whole.slope[0]);
    let dy = whole.gradient[1] + (fade_slope(place[1]) * whole.slope[1]);
    let dz = whole.gradient[2] + (fade_slope(place[2]) * whole.slope[2]);
    [whole.value, dx, dy, dz]
}

/// Improved Perlin noise with its exact gradient: `[value, d/dx, d/dy, d/dz]`.
///
/// * `p`, `seed`: as [`perlin`]; the value equals [`perlin`] bit for bit
/// * returns: gradient per lattice unit, length at most 3.75, continuous
/// * error: 1.5e-6 per component against f64 at the same f32 point (test `gradients_match_f64`)
#[inline(always)]
pub fn perlin_gradient(p: [f32; 3], seed: u32) -> [f32; 4] {
    if seed == 0 {
        let c = cell_of(p);
        perlin_gradient_of_codes(c.place, table_codes(c.corner))
    } else {
        perlin_gradient_hashed(p, seed)
    }
}

/// [`perlin_gradient`] with a seed that is not 0.
#[inline(always)]
pub fn perlin_gradient_hashed(p: [f32; 3], seed: u32) -> [f32; 4] {
    let c = cell_of(p);
    lattice_gradient::<HASH_CODES>(c.place, |ijk| hashed_code(c.corner, ijk, seed))
}

/// [`perlin_gradient`] with seed 0, given the place inside a cell and the cell's [`table_codes`].
#[inline(always)]
pub fn perlin_gradient_of_codes(place: [f32; 3], codes: u32) -> [f32; 4] {
    lattice_gradient::<TABLE_CODES>(place, |ijk| packed_code(codes, ijk))
}

/// Number of octaves as an integer: whole part held within 0..=32.
#[inline(always)]
pub fn octave_count(octaves: f32) -> i32 {
    whole_to_int(floor(hold(octaves, 0.0, OCTAVES)))
}

/// Amplitude or frequency of the next octave, held within ±2^40.
#[inline(always)]
pub fn next_octave(product: f32, factor: f32) -> f32 {
    hold(product * factor, -PRODUCT, PRODUCT)
}

/// Sum of octaves of [`perlin`]: `sum gain^k perlin(p lacunarity^k)`, coarse to fine.
///
/// * `octaves`: whole number, held within 0..=32; 0 gives 0
/// * `lacunarity`, `gain`: factors of frequency and amplitude from octave to octave, any finite
///   number; the running products are held within ±2^40
/// * returns: at most `1.0363538113 sum |gain|^k`
/// * error: octave k adds `|gain|^k (4e-7 + 3.75 sum_i |p_i lacunarity^k| (k + 1) 2^-24)`: the
///   products are rounded, except that powers of two are exact (test `sums_match_f64`)
#[inline]
pub fn fbm(p: [f32; 3], octaves: f32, lacunarity: f32, gain: f32, seed: u32) -> f32 {
    let mut sum = 0.0;
    let mut amplitude = 1.0;
    let mut frequency = 1.0;
    for _ in 0..octave_count(octaves) {
        // Add one octave.
        let q = [p[0] * frequency, p[1] * frequency, p[2] * frequency];
        sum += amplitude * perlin(q, seed);
        // Step to the next.
        amplitude = next_octave(amplitude, gain);
        frequency = next_octave(frequency, lacunarity);
    }
    sum
}

/// Sum of octaves with its exact gradient: `[value, d/dx, d/dy, d/dz]`.
///
/// * arguments and value: as [`fbm`], bit for bit
/// * returns: gradient length at most `3.75 sum |gain lacunarity|^k`
#[inline]
pub fn fbm_gradient(p: [f32; 3], octaves: f32, lacunarity: f32, gain: f32, seed: u32) -> [f32; 4] {
    let mut sum = [0.0; 4];
    let mut amplitude = 1.0;
    let mut frequency = 1.0;
    for _ in 0..octave_count(octaves) {
        // Add one octave; the chain rule brings the frequency down.
        let q = [p[0] * frequency, p[1] * frequency, p[2] * frequency];
        let n = perlin_gradient(q, seed);
        let steepness = amplitude * frequency;
        sum[0] += amplitude * n[0];
        sum[1] += steepness * n[1];
        sum[2] += steepness * n[2];
        sum[3] += steepness * n[3];
        // Step to the next.
        amplitude = next_octave(amplitude, gain);
        frequency = next_octave(frequency, lacunarity);
    }
    sum
}

/// A random number of the cell that a point lies in, 0 to below 1, a multiple of 2^-24.
///
/// * `p`: each coordinate is held within ±2^24; its whole part counts
/// * error: none
/// * source: [`hash_word`]
#[inline(always)]
pub fn hash(p: [f32; 4], seed: u32) -> f32 {
    let [x, y, z, w] = p.map(|x| floor(hold(x, -WHOLES, WHOLES)) as i32);
    unit_number(hash_word(x, y, z, w, seed))
}

#[cfg(test)]
mod tests {
    use super::*;
    use vol_compiler::reference::noise as reference;

    /// Xorshift numbers in [0, 1).
    pub(super) struct Dice(pub(super) u64);

    impl Dice {
        pub(super) fn roll(&mut self) -> f32 {
            self.0 ^= self.0 << 13;
            self.0 ^= self.0 >> 7;
            self.0 ^= self.0 << 17;
            (self.0 >> 40) as f32 / 16_777_216.0
        }

        fn point(&mut self, reach: f32) -> [f32; 3] {
            [(); 3].map(|()| (self.roll() * 2.0 - 1.0) * reach)
        }
    }

    pub(super) const SEEDS: [u32; 4] = [0, 1, 77, 0xffff_ffff];

    pub(super) fn cases(reach: f32) -> impl Iterator<Item = ([f32; 3], u32)> {
        let mut dice = Dice(88_172_645_463_325_252);
        (0..120_000usize).map(move |i| (dice.point(reach), SEEDS[i & 3]))
    }

    #[test]
    #[expect(clippy::approx_constant, reason = "the published argument is 3.14")]
    fn published_fact() {
        let value = perlin([3.14, 42.0, 7.0], 0);
        assert!((f64::from(value) - 0.136_919_958_784_000_12).abs() < 4e-7, "{value}");
        assert_eq!(perlin([5.0, -3.0, 250.0], 0), 0.0);
        assert_eq!(perlin([-7.0, 11.0, 0.0], 9), 0.0);
    }

    #[test]
    fn values_match_f64() {
        for reach in [1.0, 30.0, 1000.0] {
            let mut worst: f64 = 0.0;
            for (p, seed) in cases(reach) {
                let truth = reference::perlin(p.map(f64::from), seed);
                worst = worst.max((f64::from(perlin(p, seed)) - truth).abs());
            }
            assert!(worst <= 4e-7, "reach {reach}: {worst}");
        }
    }

    #[test]
    fn gradients_match_f64() {
        for reach in [1.0, 1000.0] {
            let mut worst: f64 = 0.0;
            for (p, seed) in cases(reach) {
                let truth = reference::perlin_gradient(p.map(f64::from), seed);
                let found = perlin_gradient(p, seed);
                assert_eq!(found[0].to_bits(), perlin(p, seed).to_bits());
                for i in 0..4 {
                    worst = worst.max((f64::from(found[i]) - truth[i]).abs());
                }
            }
            assert!(worst <= 1.5e-6, "reach {reach}: {worst}");
        }
    }

    #[test]
    fn bounds_hold() {
        // Random search, half of it near the places where the suprema are attained.
        let mut dice = Dice(7);
        let (mut value, mut slope): (f32, f32) = (0.0, 0.0);
        for i in 0..400_000u32 {
            let cell = dice.point(200.0).map(floor);
            let spot = match i & 3 {
                0 => [0.5, 0.355_26, 0.481_49],
                1 => [0.5; 3],
                _ => [dice.roll(), dice.roll(), dice.roll()],
            };
            let n = perlin_gradient([cell[0] + spot[0], cell[1] + spot[1], cell[2] + spot[2]], i % 5);
            value = value.max(n[0].abs());
            slope = slope.max(((n[1] * n[1] + n[2] * n[2]) + n[3] * n[3]).sqrt());
        }
        assert!(value <= 1.036_354 && value > 0.9, "{value}");
        assert!(slope <= 3.750_002 && slope > 3.0, "{slope}");
    }

    #[test]
    fn sums_match_f64() {
        for (octaves, lacunarity, gain) in
            [(5.0, 2.0, 0.5), (8.0, 2.0, 0.75), (5.0, 1.99, 0.6), (3.0, -2.5, -0.5)]
        {
            for (p, seed) in cases(10.0).take(20_000) {
                let wide = (p.map(f64::from), f64::from(lacunarity), f64::from(gain));
                let truth = reference::fbm_gradient(wide.0, octaves as u32, wide.1, wide.2, seed);
                let found = fbm_gradient(p, octaves, lacunarity, gain, seed);
                assert_eq!(found[0].to_bits(), fbm(p, octaves, lacunarity, gain, seed).to_bits());
                let exact = lacunarity.abs().to_bits() & 0x007f_ffff == 0;
                let size: f64 = wide.0.iter().map(|x| x.abs()).sum();
                let (mut bound, mut steep) = (0.0, 0.0);
                for k in 0..octaves as i32 {
                    let (a, f) = (wide.2.abs().powi(k), wide.1.abs().powi(k));
                    let moved = if exact { 0.0 } else { size * f * f64::from(k + 1) * 2f64.powi(-24) };
                    bound += a * (4.6e-7 + 3.75 * moved);
                    steep += a * f * (1.7e-6 + 14.466 * moved);
                }
                assert!((f64::from(found[0]) - truth[0]).abs() <= bound, "{p:?} {found:?} {truth:?}");
                for i in 1..4 {
                    assert!((f64::from(found[i]) - truth[i]).abs() <= steep, "{p:?} {found:?} {truth:?}");
                }
            }
        }
    }

    #[test]
    fn hashes_are_those_of_f64() {
        for (p, seed) in cases(50.0) {
            let p = [p[0], p[1], p[2], p[0] - p[1]];
            assert_eq!(f64::from(hash(p, seed)), reference::hash(p.map(f64::from), seed), "{p:?}");
        }
        for p in
            [[3e38, -3e38, 1e30, -1e30], [4_194_303.5, -4_194_304.0, 8e6, -0.0], [-1e-40, 1e-40, -0.5, 0.5]]
        {
            assert_eq!(f64::from(hash(p, 7)), reference::hash(p.map(f64::from), 7), "{p:?}");
        }
    }

    #[test]
    fn odd_arguments_stay_finite() {
        let points = [[0.0; 3], [-0.0; 3], [3e38, -3e38, 1e30], [4_194_303.5, -4_194_304.0, 8e6], [1e-40; 3]];
        for p in points {
            for (octaves, lacunarity, gain) in
                [(32.0, 1e30, 1e30), (99.0, -1e20, -3.0), (-4.0, 2.0, 0.5), (7.9, 0.0, 0.0)]
            {
                for seed in SEEDS {
                    let n = fbm_gradient(p, octaves, lacunarity, gain, seed);
                    assert!(n.iter().all(|x| x.is_finite()), "{p:?} {octaves} {lacunarity} {gain}: {n:?}");
                }
            }
        }
        assert_eq!(fbm([0.3; 3], 0.0, 2.0, 0.5, 1), 0.0);
        assert_eq!(fbm([0.3; 3], 1.9, 2.0, 0.5, 1), perlin([0.3; 3], 1));
    }
}
