//! Simplex noise in f32, the same text as `compiler/src/wgsl/noise/simplex.wgsl`.

use super::super::fun::{floor, greater, hold, whole_to_int};
use super::{FIELD, HASH_CODES, edge_value, edge_vector};
use vol_compiler::noise_table::hash_word;

/// Factor that makes the largest value 0.99993.
const SCALE: f32 = 76.875;
const THIRD: f32 = 1.0 / 3.0;
const SIXTH: f32 = 1.0 / 6.0;

/// The simplex of a point: its first corner on the skewed lattice, the offset of the point from that,
/// and the ways from there to the second and the third corner. The fourth is (1, 1, 1) away.
struct Simplex {
    corner: [i32; 3],
    offset: [f32; 3],
    second: [i32; 3],
    third: [i32; 3],
}

/// Find the simplex of a point.
///
/// Whole parts of coordinates are skewed as integers and fractions by themselves, so that offsets are as
/// exact far from the origin as near it.
#[inline(always)]
fn simplex_of(p: [f32; 3]) -> Simplex {
    let held = p.map(|x| hold(x, -FIELD, FIELD));
    let whole = held.map(floor);
    let place = [held[0] - whole[0], held[1] - whole[1], held[2] - whole[2]];
    let base = whole.map(whole_to_int);
    // A third of the sum of the whole parts: 3 * 4194304 keeps the dividend positive.
    let sum = base[0] + base[1] + base[2];
    let quotient = ((sum + 12_582_912) / 3) - 4_194_304;
    let rest = (sum - (3 * quotient)) as f32;
    // Skew what is left and find its cell.
    let skew = (rest + ((place[0] + place[1]) + place[2])) * THIRD;
    let cell = place.map(|x| floor(x + skew));
    let shift = (rest + ((cell[0] + cell[1]) + cell[2])) * SIXTH;
    let offset = [(place[0] - cell[0]) + shift, (place[1] - cell[1]) + shift, (place[2] - cell[2]) + shift];
    // Walk along the largest coordinate first, along the smallest last.
    let [x, y, z] = offset;
    let (xy, yz, xz) = (x >= y, y >= z, x >= z);
    let second = [i32::from(xy & xz), i32::from(!xy & yz), i32::from(!xz & !yz)];
    let third = [i32::from(xy | xz), i32::from(!xy | yz), i32::from(!xz | !yz)];
    let corner = [0, 1, 2].map(|i| (base[i] + quotient) + whole_to_int(cell[i]));
    Simplex { corner, offset, second, third }
}

/// What one corner adds: value and gradient, before scaling.
#[inline(always)]
fn simplex_corner(s: &Simplex, way: [i32; 3], unskew: f32, seed: u32) -> [f32; 4] {
    let [x, y, z] = [0, 1, 2].map(|i| (s.offset[i] - way[i] as f32) + unskew);
    let word = hash_word(s.corner[0] + way[0], s.corner[1] + way[1], s.corner[2] + way[2], 0, seed);
    let code = word >> 28;
    // The weight falls to 0 before the point leaves the simplices around the corner.
    let inside = greater(0.5 - ((x * x + y * y) + z * z), 0.0);
    let squared = inside * inside;
    let weight = squared * squared;
    let edge = edge_vector::<HASH_CODES>(code);
    let value = edge_value::<HASH_CODES>(code, x, y, z);
    let pull = (8.0 * (squared * inside)) * value;
    [
        weight * value,
        (weight * edge[0]) - (pull * x),
        (weight * edge[1]) - (pull * y),
        (weight * edge[2]) - (pull * z),
    ]
}

/// Simplex noise.
///
/// * `p`: edges of the simplices are 0.87 long; each coordinate is held within ±4194303
/// * `seed`: any; the corners are hashed and do not repeat
/// * returns: within ±1, zero at the corners
/// * error: 1e-6 against f64 at the same f32 point (test `values_and_gradients_match_f64`)
/// * source: K. Perlin 2001 and S. Gustavson 2005, with the radius sqrt 1/2 that leaves no jumps
#[inline(always)]
pub fn simplex(p: [f32; 3], seed: u32) -> f32 {
    simplex_gradient(p, seed)[0]
}

/// Simplex noise with its exact gradient: `[value, d/dx, d/dy, d/dz]`.
///
/// * `p`, `seed` and value: as [`simplex`]
/// * returns: gradient length at most 6.967, continuous
/// * error: 7e-6 per component against f64 at the same f32 point (test `values_and_gradients_match_f64`)
#[inline(always)]
pub fn simplex_gradient(p: [f32; 3], seed: u32) -> [f32; 4] {
    let s = simplex_of(p);
    let n0 = simplex_corner(&s, [0, 0, 0], 0.0, seed);
    let n1 = simplex_corner(&s, s.second, SIXTH, seed);
    let n2 = simplex_corner(&s, s.third, THIRD, seed);
    let n3 = simplex_corner(&s, [1, 1, 1], 0.5, seed);
    core::array::from_fn(|i| SCALE * ((n0[i] + n1[i]) + (n2[i] + n3[i])))
}

#[cfg(test)]
mod tests {
    use super::super::tests::{SEEDS, cases};
    use super::*;
    use vol_compiler::reference::noise as reference;

    #[test]
    fn values_and_gradients_match_f64() {
        for reach in [1.0, 30.0, 10_000.0] {
            let (mut value, mut slope): (f64, f64) = (0.0, 0.0);
            for (p, seed) in cases(reach) {
                let truth = reference::simplex_gradient(p.map(f64::from), seed);
                let found = simplex_gradient(p, seed);
                let off = |i: usize| (f64::from(found[i]) - truth[i]).abs();
                value = value.max(off(0));
                slope = (1..4).map(off).fold(slope, f64::max);
            }
            assert!(value <= 1e-6 && slope <= 7e-6, "reach {reach}: {value} {slope}");
        }
    }

    /// On planes between simplices and on the lattice, where rounding may choose either side.
    #[test]
    fn nothing_jumps_between_simplices() {
        for i in -400..400 {
            let t = i as f32 * 0.1;
            for p in [[t, t, 0.3], [0.7, t, t], [t, 0.1, t], [t, t, t], [t, 1.0 - t, 0.0], [t, 0.5 - t, 1.0]]
            {
                let truth = reference::simplex_gradient(p.map(f64::from), 3);
                let found = simplex_gradient(p, 3);
                for k in 0..4 {
                    assert!((f64::from(found[k]) - truth[k]).abs() < 7e-6, "{p:?} {found:?} {truth:?}");
                }
            }
        }
    }

    #[test]
    fn odd_arguments_stay_finite() {
        for p in [[3e38, -3e38, 1e-40], [4_194_303.5, -4_194_304.0, 8e6], [3e38; 3], [-3e38; 3], [-0.0; 3]] {
            for seed in SEEDS {
                let found = simplex_gradient(p, seed);
                assert!(found.iter().all(|x| x.abs() <= 6.967), "{p:?} {found:?}");
                let truth = reference::simplex_gradient(p.map(f64::from), seed);
                assert!((f64::from(found[0]) - truth[0]).abs() < 1e-6, "{p:?} {found:?} {truth:?}");
            }
        }
    }
}
