//! Distance to the nearest of strewn points in f32, the same text as `compiler/src/wgsl/noise/worley.wgsl`.
//!
//! Batch callers take the 27 cells outside and the points inside, with [`Nearest`] in the order of
//! [`worley_gradient`].

use super::super::fun::{floor, greater, hold, whole_to_int};
use super::FIELD;
use vol_compiler::noise_table::{hash_word, unit_point};

/// Squared distances are held at this.
const FARTHEST: f32 = 1.0;
/// Divisors are at least this.
const SMALLEST: f32 = 1.175_494_4e-38;

/// The search for the nearest point: where it starts and what it has found.
#[derive(Clone, Copy, Debug, Default)]
pub struct Nearest {
    cell: [i32; 3],
    place: [f32; 3],
    squared: f32,
    offset: [f32; 3],
}

impl Nearest {
    /// The cells to be searched, as steps from the own cell. A point of any other cell is at least 1 away,
    /// where distances are held.
    pub const STEPS: core::ops::Range<i32> = 0..27;

    /// Nothing found yet at a position: each coordinate is held within ±4194303.
    #[inline(always)]
    #[must_use]
    pub fn new(p: [f32; 3]) -> Self {
        let held = p.map(|x| hold(x, -FIELD, FIELD));
        let whole = held.map(floor);
        let place = [held[0] - whole[0], held[1] - whole[1], held[2] - whole[2]];
        Self { cell: whole.map(whole_to_int), place, squared: FARTHEST, offset: [0.0; 3] }
    }

    /// Takes the point of one more cell, if that is nearer.
    ///
    /// * `step`: of [`Nearest::STEPS`]
    #[inline(always)]
    #[must_use]
    pub fn with(self, step: i32, seed: u32) -> Self {
        let way = [(step % 3) - 1, ((step / 3) % 3) - 1, (step / 9) - 1];
        let [i, j, k] = [0, 1, 2].map(|axis| self.cell[axis] + way[axis]);
        let point = unit_point(hash_word(i, j, k, 0, seed));
        // The sum of step and point is exact.
        let [x, y, z] = [0, 1, 2].map(|axis| self.place[axis] - (way[axis] as f32 + point[axis]));
        let squared = (x * x + y * y) + z * z;
        let nearer = squared < self.squared;
        let choose = |new: f32, old: f32| if nearer { new } else { old };
        let offset = [choose(x, self.offset[0]), choose(y, self.offset[1]), choose(z, self.offset[2])];
        Self { squared: choose(squared, self.squared), offset, ..self }
    }

    /// Distance and direction: `[value, d/dx, d/dy, d/dz]`.
    #[inline(always)]
    #[must_use]
    pub fn gradient(self) -> [f32; 4] {
        let distance = self.squared.sqrt();
        // On a point, and where none was found, the offset is 0.
        let divisor = greater(distance, SMALLEST);
        [distance, self.offset[0] / divisor, self.offset[1] / divisor, self.offset[2] / divisor]
    }
}

/// Distance to the nearest of points that are strewn one to a cell, at most 1.
///
/// * `p`: cells of size 1; each coordinate is held within ±4194303
/// * `seed`: any; the cells are hashed and do not repeat
/// * returns: 0 to 1, about 1/2 on average; one place in 700 is farther than 1 from all points
/// * error: 3e-7 against f64 at the same f32 point (test `distances_and_directions_match_f64`)
/// * source: S. Worley, "A cellular texture basis function", SIGGRAPH 1996, with one point to a cell
#[inline(always)]
#[must_use]
pub fn worley(p: [f32; 3], seed: u32) -> f32 {
    worley_gradient(p, seed)[0]
}

/// [`worley`] with its gradient: `[value, d/dx, d/dy, d/dz]`.
///
/// * returns: gradient of length 1, and 0 on a point and where the distance is held; jumps where the
///   nearest point changes
/// * error: `3e-7 / distance` per component, away from such jumps
#[inline(always)]
#[must_use]
pub fn worley_gradient(p: [f32; 3], seed: u32) -> [f32; 4] {
    Nearest::STEPS.fold(Nearest::new(p), |found, step| found.with(step, seed)).gradient()
}

#[cfg(test)]
mod tests {
    use super::super::tests::{SEEDS, cases};
    use super::*;
    use vol_compiler::reference::noise as reference;

    #[test]
    fn distances_and_directions_match_f64() {
        for reach in [1.0, 1000.0] {
            let (mut worst, mut turned): (f64, f64) = (0.0, 0.0);
            for (p, seed) in cases(reach).take(30_000) {
                let near = reference::nearest(p.map(f64::from), seed);
                let truth = reference::worley_gradient(p.map(f64::from), seed);
                let found = worley_gradient(p, seed);
                worst = worst.max((f64::from(found[0]) - truth[0]).abs());
                if near.second.min(1.0) - near.distance > 1e-5 {
                    for i in 1..4 {
                        turned = turned.max((f64::from(found[i]) - truth[i]).abs() * near.distance);
                    }
                }
            }
            assert!(worst <= 3e-7 && turned <= 3e-7, "reach {reach}: {worst} {turned}");
        }
    }

    #[test]
    fn points_and_far_places() {
        let point = unit_point(hash_word(4, -2, 9, 0, 1));
        assert_eq!(worley_gradient([4.0 + point[0], -2.0 + point[1], 9.0 + point[2]], 1), [0.0; 4]);
        for p in [[3e38, -3e38, 1e-40], [4_194_303.5, -4_194_304.0, 8e6], [-0.0; 3]] {
            for seed in SEEDS {
                let found = worley_gradient(p, seed);
                assert!(found.iter().all(|x| x.abs() <= 1.000_001), "{p:?} {found:?}");
            }
        }
        let held = cases(30.0).map(|(p, seed)| worley_gradient(p, seed)).find(|n| n[0] == 1.0);
        assert_eq!(held, Some([1.0, 0.0, 0.0, 0.0]));
    }
}
