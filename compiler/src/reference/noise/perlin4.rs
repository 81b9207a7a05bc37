//! Gradient noise of four coordinates.

use super::{FIELD, fade, fade_slope};
use crate::noise_table::hash_word;

/// The gradient of a code below 32: the upper two bits name the coordinate that is left out (3 is
/// x, 0 is w), the lower three the signs of the others.
fn direction(code: u32) -> [f64; 4] {
    let left_out = 3 - (code >> 3) as usize;
    let mut gradient = [0.0; 4];
    for sign in 0..3 {
        // The last coordinate stands in for the one left out.
        let axis = if sign == left_out { 3 } else { sign };
        gradient[axis] = if code >> sign & 1 == 1 { -1.0 } else { 1.0 };
    }
    gradient
}

/// Improved Perlin noise of space and time; see [`perlin4_gradient`].
pub fn perlin4(p: [f64; 4], seed: u32) -> f64 {
    perlin4_gradient(p, seed)[0]
}

/// Improved Perlin noise of space and time and its gradient, `[value, d/dx, d/dy, d/dz, d/dw]`.
///
/// * `p`: lattice units, held within ±4194303; `seed`: any, hashed
/// * returns: value within ±1.5365823341, gradient length at most 5.625
/// * method: sum over the sixteen corners of (product of weights) times (gradient . offset)
/// * source: K. Perlin, "Noise hardware", SIGGRAPH 2001 course notes, and "Improving Noise", SIGGRAPH
///   2002: 32 gradients, (±1, ±1, ±1, 0) and its permutations, each of length sqrt 3
pub fn perlin4_gradient(p: [f64; 4], seed: u32) -> [f64; 5] {
    let held = p.map(|x| x.clamp(-FIELD, FIELD));
    let base = held.map(f64::floor);
    let mut sum = [0.0; 5];
    for index in 0..16 {
        let step: [i32; 4] = std::array::from_fn(|i| (index >> i) & 1);
        let corner: [i32; 4] = std::array::from_fn(|i| base[i] as i32 + step[i]);
        let gradient = direction(hash_word(corner[0], corner[1], corner[2], corner[3], seed) >> 27);
        let offset: [f64; 4] = std::array::from_fn(|i| held[i] - f64::from(corner[i]));
        let value: f64 = (0..4).map(|i| gradient[i] * offset[i]).sum();
        let place: [f64; 4] = std::array::from_fn(|i| held[i] - base[i]);
        let weight = |i: usize| if step[i] == 1 { fade(place[i]) } else { 1.0 - fade(place[i]) };
        let slope = |i: usize| if step[i] == 1 { fade_slope(place[i]) } else { -fade_slope(place[i]) };
        let all: f64 = (0..4).map(weight).product();
        sum[0] += all * value;
        for i in 0..4 {
            let others: f64 = (0..4).filter(|&k| k != i).map(weight).product();
            sum[i + 1] += all * gradient[i] + slope(i) * others * value;
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thirty_two_directions_of_one_length() {
        let mut all: Vec<[i32; 4]> = (0..32).map(|code| direction(code).map(|x| x as i32)).collect();
        assert!(all.iter().all(|g| g.iter().map(|x| x * x).sum::<i32>() == 3), "{all:?}");
        all.sort_unstable();
        all.dedup();
        assert_eq!(all.len(), 32);
    }

    #[test]
    fn gradient_matches_differences() {
        super::super::tests::assert_slopes(|p, seed| perlin4_gradient(p, seed).to_vec(), 1e-7);
    }

    /// At a whole w only the eight corners there count, by the parts of their gradients in space.
    #[test]
    fn a_whole_w_is_a_noise_of_space() {
        for i in 0..500i32 {
            let p = [0.37, 0.71, 0.13].map(|s: f64| (f64::from(i) * s) % 9.0 - 4.5);
            let w = i % 7 - 3;
            let base = p.map(f64::floor);
            let mut sum = 0.0;
            for corner in 0..8 {
                let at: [i32; 3] = std::array::from_fn(|k| base[k] as i32 + (corner >> k & 1));
                let gradient = direction(hash_word(at[0], at[1], at[2], w, 4) >> 27);
                let part = |k: usize| (p[k] - f64::from(at[k])) * gradient[k];
                let weight: f64 = (0..3).map(|k| fade(1.0 - (p[k] - f64::from(at[k])).abs())).product();
                sum += weight * (part(0) + part(1) + part(2));
            }
            let found = perlin4([p[0], p[1], p[2], f64::from(w)], 4);
            assert!((found - sum).abs() < 1e-14, "{p:?} {w}: {found} {sum}");
        }
        assert_eq!(perlin4([3.0, -2.0, 7.0, 5.0], 0), 0.0);
    }
}
