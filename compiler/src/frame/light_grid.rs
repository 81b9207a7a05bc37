//! The optical depth between a light and its surroundings, tabulated in the space that the light sees.
//!
//! In: a light and the box around all media. Out: where the points of the grid are. The depths are
//! computed by `runtime-cpu/src/render/light_grid.rs` and read by both backends, the same words.
//!
//! * A distant light sees places in its own axes: `(u, v)` across, `w` along the light's flight.
//! * A light at a place sees directions: `(u, v)` are tangents on both sides of its axis, `w` is the
//!   distance from it.
//!
//! Columns of the grid are rays of the light in both. Of a column only the depths from where it meets media to where it
//! leaves them are kept: a bent tube fills a tenth of its box. Everything is measured with the rounded axes, so
//! that the box is inside whatever rounding did.

use super::{Aabb, LightFrame, round3};
use glam::DVec3;

/// Optical depths at the points of a grid. A default grid has no points.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LightGrid {
    /// Whether the light is distant.
    pub distant: bool,
    /// The middle of the box, or the place of the light.
    pub origin: [f32; 3],
    /// Unit vectors `u`, `v` across and `w` along the light.
    pub axes: [[f32; 3]; 3],
    /// Smallest `(u, v, w)`.
    pub lo: [f32; 3],
    /// Intervals between points per unit of `(u, v, w)`.
    pub scale: [f32; 3],
    /// Points along `u`, `v` and `w`, at least 2 each.
    pub counts: [u32; 3],
    /// Factor per channel.
    pub tint: [f32; 3],
    /// Whether each point has a depth per channel; else it has one for all of them.
    pub colored: bool,
    /// Whether `depths` holds the coefficients of a cubic spline through the depths; else the depths themselves, between
    /// which a local cubic is put.
    pub spline: bool,
    /// Which depths there are of each column, one after the other along `v`, then along `u`.
    pub columns: Vec<GridColumn>,
    /// Optical depths from the light to points of columns, over `tint`: along `w`, channels together.
    pub depths: Vec<f32>,
}

/// The points along `w` whose depths are kept. Before the first of them all depths are its own, and behind the last one
/// that one's: outside of the media nothing is added.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GridColumn {
    /// Number of the first point along `w`.
    pub first: u32,
    /// How many there are, at least 1.
    pub count: u32,
    /// Where the first one is in [`LightGrid::depths`]: a multiple of [`GridColumn::ALIGNMENT`].
    pub at: u32,
}

impl GridColumn {
    /// Columns begin at multiples of so many depths: so their places are exact in f32 up to 2^26.
    pub const ALIGNMENT: usize = 4;

    /// Words of a column beside its depths, where a grid is told to a shader.
    pub const WORDS: usize = 3;
}

/// Tangent of the widest angle that a light at a place may see a box under, to either side.
const MAX_TANGENT: f64 = 1.0;

/// A box this large is no box.
const MAX_DIAGONAL: f64 = 1e5;

/// Part of its size by which a grid is larger than what it holds: more than rounding moves a point.
const MARGIN: f64 = 1e-4;

/// Least size of a grid across, over its longest side: flat boxes have a grid, too.
const LEAST_SIZE: f64 = 1e-3;

impl LightGrid {
    /// Where the points of a grid are, with about `intervals` along its longest side; no depths yet.
    ///
    /// None if the box is empty or without end, or if the light is in it or sees it under too wide an angle.
    #[must_use]
    pub fn layout(light: &LightFrame, bounds: &Aabb, intervals: u32) -> Option<Self> {
        let [lo, hi] = [bounds.lo, bounds.hi].map(|corner| DVec3::from(corner.map(f64::from)));
        let diagonal = (hi - lo).length();
        if !(diagonal > 0.0 && diagonal < MAX_DIAGONAL) || (hi - lo).min_element() < 0.0 {
            return None;
        }
        let centre = 0.5 * (lo + hi);
        let position = DVec3::from(light.position.map(f64::from));
        let along = if light.distant { -position } else { centre - position };
        let axes = axes(along.try_normalize()?, hi - lo).map(|axis| round3(axis.into()));
        let origin = if light.distant { round3(centre.into()) } else { light.position };
        let mut grid = Self { distant: light.distant, origin, axes, tint: [1.0; 3], ..Self::default() };
        let mut extent = grid.extent(lo, hi)?;
        if !light.distant {
            // The nearest point of the box is nearer than its corners.
            extent[2][0] = position.clamp(lo, hi).distance(position);
            let widest = extent[..2].iter().flatten().fold(0.0_f64, |widest, x| widest.max(x.abs()));
            // Far from the light its own place is rounded.
            if extent[2][0] <= 1e-5 * (diagonal + position.length()) || widest > MAX_TANGENT {
                return None;
            }
        }
        // Tangents become lengths at the middle of the box.
        let unit = if light.distant { 1.0 } else { along.length() };
        let units = [unit, unit, 1.0];
        let size = |axis: usize| units[axis] * (extent[axis][1] - extent[axis][0]);
        let longest = size(0).max(size(1)).max(size(2));
        for axis in 0..3 {
            let length = size(axis).max(LEAST_SIZE * longest) * (1.0 + 2.0 * MARGIN);
            let steps =
                (length / longest * f64::from(intervals)).ceil().clamp(1.0, f64::from(intervals.max(1)));
            let middle = 0.5 * (extent[axis][0] + extent[axis][1]);
            let half = 0.5 * length / units[axis];
            // The start is not before a light at a place.
            let start =
                if axis == 2 && !light.distant { extent[2][0] * (1.0 - MARGIN) } else { middle - half };
            grid.lo[axis] = start as f32;
            grid.scale[axis] = (steps / (middle + half - start)) as f32;
            grid.counts[axis] = steps as u32 + 1;
        }
        Some(grid)
    }

    /// Smallest and largest `u`, `v` and `w` of the corners of a box; none if a corner is not before a
    /// light at a place. Between the corners of a box `u` and `v` have no smaller or larger value, and the
    /// distance no larger one.
    fn extent(&self, lo: DVec3, hi: DVec3) -> Option<[[f64; 2]; 3]> {
        let mut extent = [[f64::INFINITY, f64::NEG_INFINITY]; 3];
        let [u, v, w] = self.axes.map(|axis| DVec3::from(axis.map(f64::from)));
        for corner in 0..8 {
            let side = |axis: usize| if corner >> axis & 1 == 0 { lo[axis] } else { hi[axis] };
            let from = DVec3::new(side(0), side(1), side(2)) - DVec3::from(self.origin.map(f64::from));
            let (across, ahead) = ([from.dot(u), from.dot(v)], from.dot(w));
            if !self.distant && ahead <= 0.0 {
                return None;
            }
            let place = if self.distant {
                [across[0], across[1], ahead]
            } else {
                [across[0] / ahead, across[1] / ahead, from.length()]
            };
            for (extent, x) in extent.iter_mut().zip(place) {
                *extent = [extent[0].min(x), extent[1].max(x)];
            }
        }
        Some(extent)
    }

    /// Number of points.
    #[must_use]
    pub fn points(&self) -> usize {
        self.counts.iter().map(|&count| count as usize).product()
    }

    /// Number of columns.
    #[must_use]
    pub fn column_count(&self) -> usize {
        self.counts[0] as usize * self.counts[1] as usize
    }

    /// Depths of a point: 3, or 1 for all channels.
    #[must_use]
    pub fn channels(&self) -> usize {
        if self.colored { 3 } else { 1 }
    }

    /// Words that columns and depths take: about the memory of a grid.
    #[must_use]
    pub fn words(&self) -> usize {
        GridColumn::WORDS * self.columns.len() + self.depths.len()
    }

    /// The most words that a grid with these points and channels has.
    #[must_use]
    pub fn most_words(&self) -> usize {
        let column = (self.counts[2] as usize * self.channels()).next_multiple_of(GridColumn::ALIGNMENT);
        (GridColumn::WORDS + column) * self.column_count() + GridColumn::ALIGNMENT
    }
}

/// Two axes across `along` and that one. The first is along the longest side of the box as far as it can,
/// so that slender boxes have slender grids.
fn axes(along: DVec3, size: DVec3) -> [DVec3; 3] {
    let sides = [DVec3::X * size.x, DVec3::Y * size.y, DVec3::Z * size.z];
    let across = sides.map(|side| side - along * side.dot(along));
    let longest = across.into_iter().fold(DVec3::ZERO, |a, b| if b.length() > a.length() { b } else { a });
    let u = longest.try_normalize().unwrap_or_else(|| along.any_orthonormal_vector());
    [u, along.cross(u), along]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn light(distant: bool, position: [f32; 3]) -> LightFrame {
        LightFrame { distant, position, color: [1.0; 3], shadows: true, size: 0.0, occlusion: 0.0 }
    }

    /// Indices of a point among those of a grid, unrounded.
    fn place(grid: &LightGrid, point: [f64; 3]) -> [f64; 3] {
        let from = DVec3::from(point) - DVec3::from(grid.origin.map(f64::from));
        let [u, v, w] = grid.axes.map(|axis| from.dot(DVec3::from(axis.map(f64::from))));
        let seen = if grid.distant { [u, v, w] } else { [u / w, v / w, from.length()] };
        [0, 1, 2].map(|axis| (seen[axis] - f64::from(grid.lo[axis])) * f64::from(grid.scale[axis]))
    }

    #[test]
    fn the_box_is_inside() {
        let sun = light(true, [0.48, 0.8, 0.36]);
        let lamps = [light(false, [0.0, 9.0, 0.0]), light(false, [4.0, 5.0, -6.0])];
        let boxes = [
            ([-1.0, -1.0, -1.0], [1.0; 3]),
            ([0.5, 0.0, 0.0], [0.5, 2.0, 1.0]),
            ([1.0, 1.0, 0.0], [1.0, 1.0, 1e-3]),
        ];
        for light in [sun].iter().chain(&lamps) {
            for (lo, hi) in boxes {
                let grid = LightGrid::layout(light, &Aabb { lo, hi }, 32).expect("a grid");
                assert!(grid.counts.iter().all(|&count| (2..=33).contains(&count)), "{grid:?}");
                assert_eq!(*grid.counts.iter().max().expect("three"), 33);
                let at = |t: [f64; 3]| {
                    [0, 1, 2].map(|i| f64::from(lo[i]) + t[i] * (f64::from(hi[i]) - f64::from(lo[i])))
                };
                for index in 0..1000 {
                    let t = [index % 10, index / 10 % 10, index / 100].map(|k| f64::from(k) / 9.0);
                    let place = place(&grid, at(t));
                    for (x, count) in place.into_iter().zip(grid.counts) {
                        assert!(x > 0.0 && x < f64::from(count - 1), "{place:?} in {grid:?}");
                    }
                }
            }
        }
    }

    #[test]
    fn where_there_is_no_grid() {
        let cube = Aabb { lo: [-1.0; 3], hi: [1.0; 3] };
        assert_eq!(LightGrid::layout(&light(false, [0.2, 0.9, 0.0]), &cube, 32), None, "inside");
        assert_eq!(LightGrid::layout(&light(false, [0.0, 1.5, 0.0]), &cube, 32), None, "too near");
        assert_eq!(LightGrid::layout(&light(false, [0.0; 3]), &cube, 32), None, "in the middle");
        let sun = light(true, [0.0, 1.0, 0.0]);
        for (lo, hi) in [([0.0; 3], [0.0; 3]), ([1.0; 3], [-1.0; 3]), ([-1e6; 3], [1e6; 3])] {
            assert_eq!(LightGrid::layout(&sun, &Aabb { lo, hi }, 32), None);
        }
        let endless = Aabb { lo: [f32::NEG_INFINITY; 3], hi: [f32::INFINITY; 3] };
        assert_eq!(LightGrid::layout(&sun, &endless, 32), None);
    }
}
