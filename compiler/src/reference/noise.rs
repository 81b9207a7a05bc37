//! Noises in f64, slow and obvious: what the f32 kernels are tested against.
//!
//! In: a point in lattice units and a seed. Out: improved Perlin noise as its author wrote it down
//! (a weighted sum over the eight corners of the cell), its gradient by the product rule, and sums
//! of octaves with true powers; the other noises in rooms of their own. Shares only the integers of
//! [`crate::noise_table`], and the exact fractions made of them, with the kernels.

mod perlin4;
mod simplex;
mod value;
mod worley;

pub use perlin4::{perlin4, perlin4_gradient};
pub use simplex::{simplex, simplex_gradient};
pub use value::{value, value_gradient};
pub use worley::{Nearest, nearest, worley, worley_gradient};

use crate::noise_table::{gradient_code, hash_word, unit_number};

/// Coordinates are held within ± this, as in the kernels.
const FIELD: f64 = 4_194_303.0;
/// Those of [`hash`] within ± this, the whole numbers of the language.
const WHOLES: f64 = 16_777_216.0;

/// The author's sixteen gradients: twelve edges of a cube, four of them again.
const EDGES: [[f64; 3]; 16] = [
    [1.0, 1.0, 0.0],
    [-1.0, 1.0, 0.0],
    [1.0, -1.0, 0.0],
    [-1.0, -1.0, 0.0],
    [1.0, 0.0, 1.0],
    [-1.0, 0.0, 1.0],
    [1.0, 0.0, -1.0],
    [-1.0, 0.0, -1.0],
    [0.0, 1.0, 1.0],
    [0.0, -1.0, 1.0],
    [0.0, 1.0, -1.0],
    [0.0, -1.0, -1.0],
    [1.0, 1.0, 0.0],
    [0.0, -1.0, 1.0],
    [-1.0, 1.0, 0.0],
    [0.0, -1.0, -1.0],
];

fn fade(t: f64) -> f64 {
    6.0 * t.powi(5) - 15.0 * t.powi(4) + 10.0 * t.powi(3)
}

fn fade_slope(t: f64) -> f64 {
    30.0 * t.powi(4) - 60.0 * t.powi(3) + 30.0 * t.powi(2)
}

/// Improved Perlin noise; see [`perlin_gradient`].
pub fn perlin(p: [f64; 3], seed: u32) -> f64 {
    perlin_gradient(p, seed)[0]
}

/// Improved Perlin noise and its gradient, `[value, d/dx, d/dy, d/dz]`.
///
/// * `p`: lattice units, held within ±4194303; `seed`: 0 is the published permutation
/// * returns: value within ±1.0363538113, gradient length at most 3.75
/// * method: sum over the corners of (product of weights) times (gradient . offset), product rule
/// * source: K. Perlin, "Improving Noise", SIGGRAPH 2002
pub fn perlin_gradient(p: [f64; 3], seed: u32) -> [f64; 4] {
    let held = p.map(|x| x.clamp(-FIELD, FIELD));
    let base = held.map(f64::floor);
    let mut sum = [0.0; 4];
    for index in 0..8 {
        let step = [index & 1, (index >> 1) & 1, index >> 2];
        let corner: [i32; 3] = std::array::from_fn(|i| base[i] as i32 + step[i]);
        let edge = EDGES[gradient_code(corner[0], corner[1], corner[2], seed) as usize];
        let offset: [f64; 3] = std::array::from_fn(|i| held[i] - f64::from(corner[i]));
        let value: f64 = (0..3).map(|i| edge[i] * offset[i]).sum();
        // Each corner's weight falls from 1 at the corner to 0 one cell away.
        let weight: [f64; 3] = std::array::from_fn(|i| {
            let t = held[i] - base[i];
            if step[i] == 1 { fade(t) } else { 1.0 - fade(t) }
        });
        let slope: [f64; 3] = std::array::from_fn(|i| {
            let t = held[i] - base[i];
            if step[i] == 1 { fade_slope(t) } else { -fade_slope(t) }
        });
        let all = weight[0] * weight[1] * weight[2];
        sum[0] += all * value;
        for i in 0..3 {
            let others = weight[(i + 1) % 3] * weight[(i + 2) % 3];
            sum[i + 1] += all * edge[i] + slope[i] * others * value;
        }
    }
    sum
}

/// Sum of octaves, `sum gain^k perlin(p lacunarity^k)`; see [`fbm_gradient`].
pub fn fbm(p: [f64; 3], octaves: u32, lacunarity: f64, gain: f64, seed: u32) -> f64 {
    fbm_gradient(p, octaves, lacunarity, gain, seed)[0]
}

/// Sum of octaves and its gradient, `[value, d/dx, d/dy, d/dz]`.
///
/// * `octaves`: at most 32 count; the same seed serves every octave
/// * returns: true powers, no running product; agrees with the kernels as long as no product leaves
///   ±2^40, where they hold it
pub fn fbm_gradient(p: [f64; 3], octaves: u32, lacunarity: f64, gain: f64, seed: u32) -> [f64; 4] {
    let mut sum = [0.0; 4];
    for k in 0..octaves.min(32) as i32 {
        let (amplitude, frequency) = (gain.powi(k), lacunarity.powi(k));
        let n = perlin_gradient(p.map(|x| x * frequency), seed);
        sum[0] += amplitude * n[0];
        for i in 1..4 {
            sum[i] += amplitude * frequency * n[i];
        }
    }
    sum
}

/// A random number of the cell that a point lies in, 0 to below 1, a multiple of 2^-24.
///
/// * `p`: coordinates held within ±2^24, of which the whole parts count
pub fn hash(p: [f64; 4], seed: u32) -> f64 {
    let [x, y, z, w] = p.map(|x| x.clamp(-WHOLES, WHOLES).floor() as i32);
    f64::from(unit_number(hash_word(x, y, z, w, seed)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    #[expect(clippy::approx_constant, reason = "the published argument is 3.14")]
    fn published_fact() {
        let value = perlin([3.14, 42.0, 7.0], 0);
        assert!((value - 0.136_919_958_784_000_12).abs() < 1e-15, "{value:.17}");
    }

    #[test]
    fn gradient_matches_differences() {
        let step = 1e-5;
        for i in 0..2000u32 {
            let p = [0.37, 0.71, 0.13].map(|s: f64| (f64::from(i) * s) % 60.0 - 30.0);
            for seed in [0, 3] {
                let exact = fbm_gradient(p, 3, 1.7, 0.6, seed);
                for axis in 0..3 {
                    let (mut low, mut high) = (p, p);
                    low[axis] -= step;
                    high[axis] += step;
                    let rise = fbm(high, 3, 1.7, 0.6, seed) - fbm(low, 3, 1.7, 0.6, seed);
                    assert!((rise / (2.0 * step) - exact[axis + 1]).abs() < 1e-7, "{p:?} axis {axis}");
                }
            }
        }
    }

    /// Compares `[value, slopes…]` with central differences of the value at 2000 points.
    pub(super) fn assert_slopes<const N: usize>(noise: impl Fn([f64; N], u32) -> Vec<f64>, within: f64) {
        let step = 1e-5;
        for i in 0..2000u32 {
            let p: [f64; N] = std::array::from_fn(|k| {
                (f64::from(i) * [0.37, 0.71, 0.13, 0.29][k]) % 60.0 - 30.0 + 1e-3 * (k + 1) as f64
            });
            for seed in [0, 3] {
                let exact = noise(p, seed);
                for axis in 0..N {
                    let (mut low, mut high) = (p, p);
                    low[axis] -= step;
                    high[axis] += step;
                    let slope = (noise(high, seed)[0] - noise(low, seed)[0]) / (2.0 * step);
                    assert!((slope - exact[axis + 1]).abs() < within, "{p:?} axis {axis}: {slope} {exact:?}");
                }
            }
        }
    }

    #[test]
    fn hashes_of_cells() {
        let at = |x: f64| hash([x, 0.0, 0.0, 0.0], 0);
        assert_eq!(at(3.0), at(3.999));
        assert_eq!([at(1e9), at(-1e9)], [at(WHOLES), at(-WHOLES)]);
        assert!(at(3.0) != at(4.0) && at(-0.5) != at(0.0));
        assert!(hash([3.0; 4], 0) != hash([3.0; 4], 1) && hash([3.0, 0.0, 0.0, 1.0], 0) != at(3.0));
        let mean = (0..1000).map(|i| at(f64::from(i))).sum::<f64>() / 1000.0;
        assert!((mean - 0.5).abs() < 0.03, "{mean}");
    }

    #[test]
    fn zero_on_the_lattice() {
        for i in -4i32..4 {
            assert_eq!(perlin([f64::from(i), f64::from(3 * i), 7.0], 0), 0.0);
            assert_eq!(perlin([f64::from(i), f64::from(3 * i), 7.0], 5), 0.0);
        }
        assert_eq!(fbm([0.5; 3], 0, 2.0, 0.5, 0), 0.0);
    }
}
