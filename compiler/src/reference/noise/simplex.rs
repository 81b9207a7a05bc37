//! Simplex noise.

use super::{EDGES, FIELD};
use crate::noise_table::hash_word;

/// Factor that makes the largest value 0.99993.
const SCALE: f64 = 76.875;

/// Simplex noise; see [`simplex_gradient`].
pub fn simplex(p: [f64; 3], seed: u32) -> f64 {
    simplex_gradient(p, seed)[0]
}

/// Simplex noise and its gradient, `[value, d/dx, d/dy, d/dz]`.
///
/// * `p`: edges of the simplices are 0.87 long; held within ±4194303; `seed`: any, hashed
/// * returns: value within ±1, gradient length at most 6.967
/// * method: sum over all lattice points nearer than sqrt 1/2, found among the 64 around the cell, of
///   `76.875 (1/2 - d^2)^4` times (gradient . offset); these are corners of one simplex
/// * source: K. Perlin, "Noise hardware", SIGGRAPH 2001 course notes; S. Gustavson, "Simplex noise
///   demystified" (2005), with the smaller radius that leaves no jumps
pub fn simplex_gradient(p: [f64; 3], seed: u32) -> [f64; 4] {
    let held = p.map(|x| x.clamp(-FIELD, FIELD));
    let skew = (held[0] + held[1] + held[2]) / 3.0;
    let base = held.map(|x| (x + skew).floor() as i32);
    let mut sum = [0.0; 4];
    for index in 0..64 {
        let point: [i32; 3] = std::array::from_fn(|i| base[i] + ((index >> (2 * i)) & 3) - 1);
        let shift = f64::from(point[0] + point[1] + point[2]) / 6.0;
        let offset: [f64; 3] = std::array::from_fn(|i| held[i] - (f64::from(point[i]) - shift));
        let inside = 0.5 - offset.iter().map(|x| x * x).sum::<f64>();
        if inside <= 0.0 {
            continue;
        }
        let edge = EDGES[(hash_word(point[0], point[1], point[2], 0, seed) >> 28) as usize];
        let value: f64 = (0..3).map(|i| edge[i] * offset[i]).sum();
        sum[0] += SCALE * inside.powi(4) * value;
        for i in 0..3 {
            sum[i + 1] += SCALE * (inside.powi(4) * edge[i] - 8.0 * inside.powi(3) * offset[i] * value);
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gradient_matches_differences() {
        super::super::tests::assert_slopes(|p, seed| simplex_gradient(p, seed).to_vec(), 1e-6);
    }

    #[test]
    fn zero_on_the_lattice() {
        for [i, j, k] in [[0, 0, 0], [1, 0, 0], [3, -5, 8], [-20, 7, 7]] {
            let shift = f64::from(i + j + k) / 6.0;
            let n = simplex([i, j, k].map(|x| f64::from(x) - shift), 2);
            assert!(n.abs() < 1e-12, "{n}");
        }
    }
}
