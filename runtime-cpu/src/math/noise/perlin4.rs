//! Perlin noise of space and time in f32, the same text as `compiler/src/wgsl/noise/perlin4.wgsl`.

use super::super::fun::{floor, hold, whole_to_int};
use super::{Blend, FIELD, blend, fade, fade_slope, lerp};
use vol_compiler::noise_table::hash_word;

/// One lattice cell: its whole coordinates, the place inside it, and the fade weights there.
struct Cell4 {
    corner: [i32; 4],
    place: [f32; 4],
    fade: [f32; 4],
}

/// Find the cell of a point.
#[inline(always)]
fn cell4_of(p: [f32; 4]) -> Cell4 {
    let held = p.map(|x| hold(x, -FIELD, FIELD));
    let whole = held.map(floor);
    let place = core::array::from_fn(|i| held[i] - whole[i]);
    Cell4 { corner: whole.map(whole_to_int), place, fade: place.map(fade) }
}

/// Which of 32 directions a corner has: the upper two bits of the code name the coordinate that is
/// left out (3 is x, 0 is w), the lower three the signs of the others; w stands in for the one left out.
#[inline(always)]
fn corner4_code(c: &Cell4, corner: [i32; 4], seed: u32) -> u32 {
    let [i, j, k, l] = corner;
    hash_word(c.corner[0] + i, c.corner[1] + j, c.corner[2] + k, c.corner[3] + l, seed) >> 27
}

/// Dot product of the direction `code` with an offset.
#[inline(always)]
fn direction4_value(code: u32, x: f32, y: f32, z: f32, w: f32) -> f32 {
    let left_out = code >> 3;
    let a = if left_out == 3 { w } else { x };
    let b = if left_out == 2 { w } else { y };
    let c = if left_out == 1 { w } else { z };
    let signed_a = if (code & 1) != 0 { -a } else { a };
    let signed_b = if (code & 2) != 0 { -b } else { b };
    let signed_c = if (code & 4) != 0 { -c } else { c };
    (signed_a + signed_b) + signed_c
}

/// The direction itself, three of four components ±1.
#[inline(always)]
fn direction4_vector(code: u32) -> [f32; 4] {
    let left_out = code >> 3;
    let a = if (code & 1) != 0 { -1.0 } else { 1.0 };
    let b = if (code & 2) != 0 { -1.0 } else { 1.0 };
    let c = if (code & 4) != 0 { -1.0 } else { 1.0 };
    let x = if left_out == 3 { 0.0 } else { a };
    let y = if left_out == 2 { 0.0 } else { b };
    let z = if left_out == 1 { 0.0 } else { c };
    // What w stands in for: a, b, c or nothing.
    let late = if left_out == 3 { a } else { b };
    let early = if left_out == 1 { c } else { 0.0 };
    let w = if left_out >= 2 { late } else { early };
    [x, y, z, w]
}

/// Value at one corner.
#[inline(always)]
fn corner4(c: &Cell4, corner: [i32; 4], seed: u32) -> f32 {
    let [x, y, z, w] = core::array::from_fn(|i| c.place[i] - corner[i] as f32);
    direction4_value(corner4_code(c, corner, seed), x, y, z, w)
}

/// Blend of the eight corners with one w.
#[inline(always)]
fn slice4(c: &Cell4, l: i32, seed: u32) -> f32 {
    let [u, v, w, _] = c.fade;
    // Blend the four edges along x.
    let e00 = lerp(u, corner4(c, [0, 0, 0, l], seed), corner4(c, [1, 0, 0, l], seed));
    let e10 = lerp(u, corner4(c, [0, 1, 0, l], seed), corner4(c, [1, 1, 0, l], seed));
    let e01 = lerp(u, corner4(c, [0, 0, 1, l], seed), corner4(c, [1, 0, 1, l], seed));
    let e11 = lerp(u, corner4(c, [0, 1, 1, l], seed), corner4(c, [1, 1, 1, l], seed));
    // Blend along y, then along z.
    lerp(w, lerp(v, e00, e10), lerp(v, e01, e11))
}

/// Improved Perlin noise of space and time.
///
/// * `p`: lattice units; each coordinate is held within ±4194303
/// * `seed`: any; the cells are hashed and do not repeat
/// * returns: within ±1.5365823341, zero at lattice points
/// * error: 7e-7 against f64 at the same f32 point (test `values_and_gradients_match_f64`)
/// * source: K. Perlin 2002, the same construction over 32 directions (±1, ±1, ±1, 0)
#[inline(always)]
pub fn perlin4(p: [f32; 4], seed: u32) -> f32 {
    let c = cell4_of(p);
    lerp(c.fade[3], slice4(&c, 0, seed), slice4(&c, 1, seed))
}

/// Value and gradient at one corner.
#[inline(always)]
fn corner4_blend(c: &Cell4, corner: [i32; 4], seed: u32) -> Blend<4> {
    let code = corner4_code(c, corner, seed);
    let [x, y, z, w] = core::array::from_fn(|i| c.place[i] - corner[i] as f32);
    let value = direction4_value(code, x, y, z, w);
    Blend { value, gradient: direction4_vector(code), slope: [0.0; 4] }
}

/// Blend of the eight corners with one w, and their gradients.
#[inline(always)]
fn slice4_blend(c: &Cell4, l: i32, seed: u32) -> Blend<4> {
    let [u, v, w, _] = c.fade;
    let at = |i: i32, j: i32, k: i32| corner4_blend(c, [i, j, k, l], seed);
    // Blend the four edges along x.
    let e00 = blend(0, u, at(0, 0, 0), at(1, 0, 0));
    let e10 = blend(0, u, at(0, 1, 0), at(1, 1, 0));
    let e01 = blend(0, u, at(0, 0, 1), at(1, 0, 1));
    let e11 = blend(0, u, at(0, 1, 1), at(1, 1, 1));
    // Blend along y, then along z.
    blend(2, w, blend(1, v, e00, e10), blend(1, v, e01, e11))
}

/// Improved Perlin noise of space and time with its exact gradient: `[value, d/dx, d/dy, d/dz, d/dw]`.
///
/// * `p`, `seed`: as [`perlin4`]; the value equals [`perlin4`] bit for bit
/// * returns: gradient per lattice unit, length at most 5.625, continuous
/// * error: 3e-6 per component against f64 at the same f32 point (test `values_and_gradients_match_f64`)
#[inline(always)]
pub fn perlin4_gradient(p: [f32; 4], seed: u32) -> [f32; 5] {
    let c = cell4_of(p);
    let whole = blend(3, c.fade[3], slice4_blend(&c, 0, seed), slice4_blend(&c, 1, seed));
    // Add the slopes of the weights to the blended gradients.
    let [x, y, z, w] =
        core::array::from_fn(|i| whole.gradient[i] + (fade_slope(c.place[i]) * whole.slope[i]));
    [whole.value, x, y, z, w]
}

#[cfg(test)]
mod tests {
    use super::super::tests::{Dice, SEEDS, cases};
    use super::*;
    use vol_compiler::reference::noise as reference;

    #[test]
    fn values_and_gradients_match_f64() {
        for reach in [1.0, 1000.0] {
            let (mut value, mut slope): (f64, f64) = (0.0, 0.0);
            let mut dice = Dice(5);
            for (p, seed) in cases(reach) {
                let p = [p[0], p[1], p[2], (dice.roll() * 2.0 - 1.0) * reach];
                let truth = reference::perlin4_gradient(p.map(f64::from), seed);
                let found = perlin4_gradient(p, seed);
                assert_eq!(found[0].to_bits(), perlin4(p, seed).to_bits());
                let off = |i: usize| (f64::from(found[i]) - truth[i]).abs();
                value = value.max(off(0));
                slope = (1..5).map(off).fold(slope, f64::max);
            }
            assert!(value <= 7e-7 && slope <= 3e-6, "reach {reach}: {value} {slope}");
        }
    }

    #[test]
    fn odd_arguments_stay_finite() {
        for p in [[3e38, -3e38, 1e30, -1e-40], [4_194_303.5, -4_194_304.0, 8e6, 0.5], [0.0, -0.0, 1.0, -1.0]]
        {
            for seed in SEEDS {
                assert!(perlin4_gradient(p, seed).iter().all(|x| x.is_finite()), "{p:?}");
            }
        }
        assert_eq!(perlin4([5.0, -3.0, 250.0, 7.0], 0), 0.0);
    }
}
