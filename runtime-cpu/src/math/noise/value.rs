//! Value noise in f32, the same text as `compiler/src/wgsl/noise/value.wgsl`.

use super::{Cell, cell_of, fade, fade_slope, lerp};
use vol_compiler::noise_table::{hash_word, unit_number};

/// Random number of the corner `(i, j, k)` of a cell, -1 to below 1, exact.
#[inline(always)]
fn corner_number(c: &Cell, i: i32, j: i32, k: i32, seed: u32) -> f32 {
    let word = hash_word(c.corner[0] + i, c.corner[1] + j, c.corner[2] + k, 0, seed);
    (unit_number(word) * 2.0) - 1.0
}

/// Value noise: random numbers at the corners of the cells, blended.
///
/// * `p`: lattice units; each coordinate is held within ±4194303
/// * `seed`: any; the cells are hashed and do not repeat
/// * returns: within ±1; flat at lattice points
/// * error: 4e-7 against f64 at the same f32 point (test `values_and_gradients_match_f64`)
#[inline(always)]
pub fn value(p: [f32; 3], seed: u32) -> f32 {
    value_gradient(p, seed)[0]
}

/// Value noise with its exact gradient: `[value, d/dx, d/dy, d/dz]`.
///
/// * `p`, `seed` and value: as [`value`]
/// * returns: gradient per lattice unit, length at most 3.75, continuous
/// * error: 1e-6 per component against f64 at the same f32 point (test `values_and_gradients_match_f64`)
#[inline(always)]
pub fn value_gradient(p: [f32; 3], seed: u32) -> [f32; 4] {
    let c = cell_of(p);
    let [u, v, w] = c.place.map(fade);
    let at = |i: i32, j: i32, k: i32| corner_number(&c, i, j, k, seed);
    let [c000, c010, c001, c011] = [at(0, 0, 0), at(0, 1, 0), at(0, 0, 1), at(0, 1, 1)];
    // Rise of the four edges along x, and their blends.
    let r00 = at(1, 0, 0) - c000;
    let r10 = at(1, 1, 0) - c010;
    let r01 = at(1, 0, 1) - c001;
    let r11 = at(1, 1, 1) - c011;
    let e00 = c000 + (u * r00);
    let e10 = c010 + (u * r10);
    let e01 = c001 + (u * r01);
    let e11 = c011 + (u * r11);
    // Blend along y, then along z.
    let f0 = lerp(v, e00, e10);
    let f1 = lerp(v, e01, e11);
    let rise_x = lerp(w, lerp(v, r00, r10), lerp(v, r01, r11));
    let rise_y = lerp(w, e10 - e00, e11 - e01);
    let rise_z = f1 - f0;
    let dx = fade_slope(c.place[0]) * rise_x;
    let dy = fade_slope(c.place[1]) * rise_y;
    let dz = fade_slope(c.place[2]) * rise_z;
    [f0 + (w * rise_z), dx, dy, dz]
}

#[cfg(test)]
mod tests {
    use super::super::tests::{SEEDS, cases};
    use super::*;
    use vol_compiler::reference::noise as reference;

    #[test]
    fn values_and_gradients_match_f64() {
        for reach in [1.0, 1000.0] {
            let (mut value, mut slope): (f64, f64) = (0.0, 0.0);
            for (p, seed) in cases(reach) {
                let truth = reference::value_gradient(p.map(f64::from), seed);
                let found = value_gradient(p, seed);
                let off = |i: usize| (f64::from(found[i]) - truth[i]).abs();
                value = value.max(off(0));
                slope = (1..4).map(off).fold(slope, f64::max);
            }
            assert!(value <= 4e-7 && slope <= 1e-6, "reach {reach}: {value} {slope}");
        }
    }

    #[test]
    fn odd_arguments_stay_finite() {
        for p in [[3e38, -3e38, 1e-40], [4_194_303.5, -4_194_304.0, 8e6], [0.0, -0.0, 1.0]] {
            for seed in SEEDS {
                assert!(value_gradient(p, seed).iter().all(|x| x.abs() <= 3.75), "{p:?}");
            }
        }
    }
}
