//! Distance to the nearest of points that are strewn one to a cell.

use super::FIELD;
use crate::noise_table::{hash_word, unit_point};

/// The nearest feature points about a position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nearest {
    /// From the nearest point to the position.
    pub offset: [f64; 3],
    /// Distance of the nearest, below sqrt 3.
    pub distance: f64,
    /// Distance of the second nearest.
    pub second: f64,
}

/// Searches all cells that may hold the nearest point.
///
/// * `p`: cells of size 1, held within ±4194303; `seed`: any, hashed
/// * method: the point of the own cell is nearer than sqrt 3, so none farther than two cells is
pub fn nearest(p: [f64; 3], seed: u32) -> Nearest {
    let held = p.map(|x| x.clamp(-FIELD, FIELD));
    let base = held.map(|x| x.floor() as i32);
    let mut found = Nearest { offset: [0.0; 3], distance: f64::INFINITY, second: f64::INFINITY };
    for index in 0..125 {
        let step = [index % 5 - 2, index / 5 % 5 - 2, index / 25 - 2];
        let cell: [i32; 3] = std::array::from_fn(|i| base[i] + step[i]);
        let point = unit_point(hash_word(cell[0], cell[1], cell[2], 0, seed));
        let offset: [f64; 3] = std::array::from_fn(|i| held[i] - (f64::from(cell[i]) + f64::from(point[i])));
        let distance = offset.iter().map(|x| x * x).sum::<f64>().sqrt();
        if distance < found.distance {
            found = Nearest { offset, distance, second: found.distance };
        } else {
            found.second = found.second.min(distance);
        }
    }
    found
}

/// Worley noise; see [`worley_gradient`].
pub fn worley(p: [f64; 3], seed: u32) -> f64 {
    nearest(p, seed).distance.min(1.0)
}

/// Distance to the nearest feature point, at most 1, and its gradient, `[value, d/dx, d/dy, d/dz]`.
///
/// * returns: value within 0..1; gradient of length 1, and 0 on a feature point and where the distance
///   is held at 1
/// * source: S. Worley, "A cellular texture basis function", SIGGRAPH 1996, with one point to a cell
pub fn worley_gradient(p: [f64; 3], seed: u32) -> [f64; 4] {
    let Nearest { offset, distance, .. } = nearest(p, seed);
    if distance >= 1.0 {
        return [1.0, 0.0, 0.0, 0.0];
    }
    let slope = |x: f64| if distance > 0.0 { x / distance } else { 0.0 };
    [distance, slope(offset[0]), slope(offset[1]), slope(offset[2])]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_are_lengths() {
        let (mut held, mut sum) = (0, 0.0);
        for i in 0..20_000u32 {
            let p = [0.37, 0.71, 0.13].map(|s: f64| (f64::from(i) * s) % 60.0 - 30.0);
            let near = nearest(p, 3);
            assert!(near.distance <= near.second && near.distance < 3f64.sqrt(), "{p:?} {near:?}");
            let [value, x, y, z] = worley_gradient(p, 3);
            assert_eq!(value, worley(p, 3));
            let length = x.hypot(y).hypot(z);
            assert!((length - if value < 1.0 { 1.0 } else { 0.0 }).abs() < 1e-12, "{p:?} {length}");
            held += u32::from(value == 1.0);
            sum += value;
        }
        // One place in 700 is farther than 1 from all points.
        assert!(held < 40, "{held}");
        assert!((sum / 20_000.0 - 0.5).abs() < 0.05, "{sum}");
    }

    #[test]
    fn zero_on_the_points() {
        let point = unit_point(hash_word(4, -2, 9, 0, 1));
        let at = [4.0, -2.0, 9.0];
        let p: [f64; 3] = std::array::from_fn(|i| at[i] + f64::from(point[i]));
        assert_eq!(worley_gradient(p, 1), [0.0; 4]);
    }
}
