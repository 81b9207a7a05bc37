//! Optical depths towards the light at the points of a grid, computed before the picture is.
//!
//! One axis of the grid is the direction to the light, so that all depths along a line of points are sums of
//! one march.

use crate::lanes::{LANES, Lanes, Mask, blend};
use crate::noise::Noise;
use crate::points::Points;
use crate::scene::{extinction, toward_light};
use pulp::NullaryFnOnce;
use pulp::x86::V4;
use rayon::prelude::*;

/// Depths around the ball, linear between the points.
pub(crate) struct LightGrid {
    simd: V4,
    /// Across the light twice, and towards it; unit vectors.
    axes: [[f32; 3]; 3],
    /// Points along each axis: the first at -1, the last at 1.
    points: usize,
    /// Places from one layer across the light to the next; a whole number of registers.
    row: usize,
    /// Layers towards the light lie one after the other, sheets of them too: number `(sheet * points + layer) * row + place`.
    depths: Vec<f32>,
}

impl LightGrid {
    pub(crate) fn new(simd: V4, noise: &Noise, points: usize) -> Self {
        let row = points.next_multiple_of(LANES);
        let mut depths = vec![0.0; points * points * row];
        let axes = axes();
        depths.par_chunks_mut(points * row).enumerate().for_each(|(sheet, depths)| {
            simd.vectorize(Sheet { simd, noise, axes, points, row, sheet, depths });
        });
        Self { simd, axes, points, row, depths }
    }

    /// Between the eight points around each place in the ball.
    #[inline(always)]
    pub(crate) fn depth(&self, places: Points) -> Lanes {
        let half = 0.5 * (self.points - 1) as f32;
        let [across, other, toward] = self.axes;
        let along = |axis: [f32; 3]| places.dot(Points::splat(self.simd, axis)).scaled(half, half);
        let place = Points { x: along(across), y: along(other), z: along(toward) };
        let last = (self.points - 2) as f32;
        let cell = place.floor();
        let cell = Points { x: cell.x.hold(0.0, last), y: cell.y.hold(0.0, last), z: cell.z.hold(0.0, last) };
        let part = place.minus(cell);
        let corners = self.corners(cell);
        let edge = |number: usize| {
            let [a, b] = [corners[2 * number], corners[2 * number + 1]];
            blend(part.x, Lanes::of(self.simd, a), Lanes::of(self.simd, b))
        };
        let near = blend(part.z, edge(0), edge(1));
        let far = blend(part.z, edge(2), edge(3));
        blend(part.y, near, far)
    }

    /// Depths at the corners of cells: those that differ along the first axis, then the last, then the second.
    #[inline(always)]
    fn corners(&self, cell: Points) -> [[f32; LANES]; 8] {
        let [i, j, k] = [cell.x.words().array(), cell.y.words().array(), cell.z.words().array()];
        let sheet = self.points * self.row;
        let mut corners = [[0.0; LANES]; 8];
        for lane in 0..LANES {
            let first = j[lane] as usize * sheet + k[lane] as usize * self.row + i[lane] as usize;
            for (edge, start) in
                [first, first + self.row, first + sheet, first + sheet + self.row].into_iter().enumerate()
            {
                corners[2 * edge][lane] = self.depths[start];
                corners[2 * edge + 1][lane] = self.depths[start + 1];
            }
        }
        corners
    }
}

/// Unit vectors across the light, and towards it.
fn axes() -> [[f32; 3]; 3] {
    let [x, y, z] = toward_light();
    let size = x.hypot(z);
    let across = [z / size, 0.0, -x / size];
    let other = [y * across[2], z * across[0] - x * across[2], -y * across[0]];
    [across, other, [x, y, z]]
}

/// Work for a thread: all points of one place along the second axis.
struct Sheet<'a> {
    simd: V4,
    noise: &'a Noise,
    axes: [[f32; 3]; 3],
    points: usize,
    row: usize,
    sheet: usize,
    depths: &'a mut [f32],
}

impl NullaryFnOnce for Sheet<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { simd, noise, axes, points, row, sheet, depths } = self;
        let spacing = 2.0 / (points - 1) as f32;
        let at = |index: f32| index * spacing - 1.0;
        let v = Lanes::splat(simd, at(sheet as f32));
        let origin = Points::splat(simd, [0.0; 3]);
        let [across, other, toward] =
            [Points::splat(simd, axes[0]), Points::splat(simd, axes[1]), Points::splat(simd, axes[2])];
        for first in (0..row).step_by(LANES) {
            let u = v.counted(0.0).scaled(spacing, at(first as f32));
            let mut depth = v.same(0.0);
            for layer in (0..points - 1).rev() {
                // One step from a layer to the next, in its middle.
                let w = v.same(at(layer as f32 + 0.5));
                let place = Points { x: u, y: v, z: w };
                if place.dot(place).above(1.0) != Mask::MAX {
                    let place = origin.ahead(across, u).ahead(other, v).ahead(toward, w);
                    depth = extinction(simd, noise, place).scaled(spacing, 0.0) + depth;
                }
                let start = layer * row + first;
                depths[start..start + LANES].copy_from_slice(&depth.array());
            }
        }
    }
}
