//! Value noise.

use super::{FIELD, fade, fade_slope};
use crate::noise_table::{hash_word, unit_number};

/// Value noise; see [`value_gradient`].
pub fn value(p: [f64; 3], seed: u32) -> f64 {
    value_gradient(p, seed)[0]
}

/// Value noise and its gradient, `[value, d/dx, d/dy, d/dz]`.
///
/// * `p`: lattice units, held within ±4194303; `seed`: any, hashed
/// * returns: value within ±1, gradient length at most 3.75
/// * method: sum over the corners of (product of weights) times (random number of -1..1)
pub fn value_gradient(p: [f64; 3], seed: u32) -> [f64; 4] {
    let held = p.map(|x| x.clamp(-FIELD, FIELD));
    let base = held.map(f64::floor);
    let mut sum = [0.0; 4];
    for index in 0..8 {
        let step: [i32; 3] = std::array::from_fn(|i| (index >> i) & 1);
        let corner: [i32; 3] = std::array::from_fn(|i| base[i] as i32 + step[i]);
        let number = f64::from(unit_number(hash_word(corner[0], corner[1], corner[2], 0, seed)));
        let value = 2.0 * number - 1.0;
        let place: [f64; 3] = std::array::from_fn(|i| held[i] - base[i]);
        let weight = |i: usize| if step[i] == 1 { fade(place[i]) } else { 1.0 - fade(place[i]) };
        let slope = |i: usize| if step[i] == 1 { fade_slope(place[i]) } else { -fade_slope(place[i]) };
        sum[0] += weight(0) * weight(1) * weight(2) * value;
        for i in 0..3 {
            sum[i + 1] += slope(i) * weight((i + 1) % 3) * weight((i + 2) % 3) * value;
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn corners_have_the_random_numbers() {
        for i in -5i32..5 {
            let at = value_gradient([f64::from(i), 2.0, f64::from(-i)], 6);
            let number = f64::from(unit_number(hash_word(i, 2, -i, 0, 6)));
            assert_eq!(at, [2.0 * number - 1.0, 0.0, 0.0, 0.0]);
        }
    }

    #[test]
    fn gradient_matches_differences() {
        super::super::tests::assert_slopes(|p, seed| value_gradient(p, seed).to_vec(), 1e-7);
    }
}
