//! Optical depth between a light and a point, looked up in the light's grid; and how a grid is filled.
//!
//! A grid holds depths, not the light that arrives: between its points a depth is nearly linear where
//! `exp(-depth)` is not. One column of points is one ray of the light, whose nodes are those of any other
//! comb, walls of media included; the depth of a point is the sum of all nodes before it. Between points
//! depths are cubic along each axis: third order in the distance between points where the density is smooth,
//! first order at walls. What that means for a scene is measured, see [`super::grid_choice`].
//!
//! * source: algorithms.md §5.1, "Light"; R. G. Keys, "Cubic Convolution Interpolation for Digital Image
//!   Processing", IEEE TASSP 1981
//!
//! Twin of the look-up: `compiler/src/wgsl/render/light_grid.wgsl`.

use super::camera::Ray;
use super::comb::MAX_NODES;
use super::fields::Fields;
use super::scene::{Batches, Integrator, Scene};
use crate::real::{Real, Vec3, add, dot, length, mul, scale, splat, sub, vector};
use rayon::prelude::*;
use std::sync::Arc;
use vol_compiler::frame::{LightGrid, Quadrature};

/// A grid as the integrator reads it.
#[derive(Debug)]
pub(crate) struct Grid<R> {
    distant: bool,
    origin: Vec3<R>,
    axes: [Vec3<R>; 3],
    lo: Vec3<R>,
    scale: Vec3<R>,
    /// Index of the last point along each axis.
    last: Vec3<R>,
    tint: Vec3<R>,
    /// Words from a point to the next one along each axis.
    steps: [usize; 3],
    table: Arc<LightGrid>,
}

impl<R: Real> Grid<R> {
    /// Reads a grid.
    pub(crate) fn new(table: &Arc<LightGrid>) -> Self {
        let [_, rows, columns] = table.counts.map(|count| count as usize);
        let channels = if table.colored { 3 } else { 1 };
        Self {
            distant: table.distant,
            origin: vector(table.origin),
            axes: table.axes.map(vector),
            lo: vector(table.lo),
            scale: vector(table.scale),
            last: table.counts.map(|count| R::from_index(count as i32 - 1)),
            tint: vector(table.tint),
            steps: [channels * columns * rows, channels * columns, channels],
            table: Arc::clone(table),
        }
    }

    /// Depth at a point.
    pub(crate) fn depth(&self, point: Vec3<R>) -> Vec3<R> {
        // Find the point as the light sees it.
        let off = sub(point, self.origin);
        let [u, v, w] = self.axes.map(|axis| dot(off, axis));
        let ahead = self.distant | (w > R::from_f32(0.5) * self.lo[2]);
        let divisor = if ahead & !self.distant { w } else { R::ONE };
        let seen = [u / divisor, v / divisor, if self.distant { w } else { length(off) }];
        let last = self.last;
        let place = mul(sub(seen, self.lo), self.scale);
        let beside =
            (place[0] < R::ZERO) | (place[0] > last[0]) | (place[1] < R::ZERO) | (place[1] > last[1]);
        // Nothing is before the grid or beside it.
        if !ahead | beside | (place[2] <= R::ZERO) {
            return splat(R::ZERO);
        }
        // Behind it nothing is added.
        let held = [place[0], place[1], place[2].min(last[2])];
        let around = [0, 1, 2].map(|axis| Stencil::new(held[axis], last[axis], self.steps[axis]));
        if self.steps[2] == 1 {
            return scale(self.tint, self.channel(0, &around));
        }
        mul(self.tint, [0, 1, 2].map(|channel| self.channel(channel, &around)))
    }

    /// One channel between the points around; what the cubic overshoots below 0 is cut off.
    fn channel(&self, first: usize, [x, y, z]: &[Stencil<R>; 3]) -> R {
        let mut sum = R::ZERO;
        for i in 0..4 {
            for j in 0..4 {
                let [a, b, c, d] = self.row(first + x.at[i] + y.at[j], z.at).map(R::from_f32);
                let [wa, wb, wc, wd] = z.weights;
                let column = ((wa * a + wb * b) + wc * c) + wd * d;
                sum = sum + (x.weights[i] * y.weights[j]) * column;
            }
        }
        sum.max(R::ZERO)
    }

    /// Depths of four points along the light.
    fn row(&self, first: usize, at: [usize; 4]) -> [f32; 4] {
        let depths = &self.table.depths[first..];
        // With one channel they are neighbours, but at the ends.
        if at[3] == at[0] + 3
            && let Some(four) = depths[at[0]..].first_chunk()
        {
            return *four;
        }
        at.map(|at| depths[at])
    }
}

/// The four points around a place along one axis.
struct Stencil<R> {
    /// Words from the first point of the axis to each; where there is none the last one counts twice.
    at: [usize; 4],
    /// Their weights.
    weights: [R; 4],
}

impl<R: Real> Stencil<R> {
    /// `place` in 0..`last`, points `step` words apart.
    fn new(place: R, last: R, step: usize) -> Self {
        let index = place.floor().min(last - R::ONE);
        let t = place - index;
        let (half, f) = (R::from_f32(0.5), R::from_f32);
        let weights = [
            ((R::ONE - half * t) * t - half) * t,
            ((f(1.5) * t - f(2.5)) * t) * t + R::ONE,
            ((f(2.0) - f(1.5) * t) * t + half) * t,
            ((half * t - half) * t) * t,
        ];
        let (index, last) = (index.to_index(), last.to_index());
        Self { at: [-1, 0, 1, 2].map(|k| (index + k).clamp(0, last) as usize * step), weights }
    }
}

/// Larger depths are this: differences and sums of two stay finite.
const DEEPEST: f32 = 1e30;

/// Nodes of a column.
#[derive(Clone, Copy, Debug)]
struct Column {
    /// Intervals between points.
    intervals: usize,
    /// Nodes in each.
    nodes: i32,
    /// Distance between nodes.
    step: f32,
}

impl Column {
    /// The nodes are at most `step` apart; none if there were too many.
    fn new(table: &LightGrid, step: f32) -> Option<Self> {
        let interval = 1.0 / table.scale[2];
        let intervals = table.counts[2] as i32 - 1;
        let nodes = (interval / step).ceil().max(1.0);
        (intervals as f32 * nodes <= MAX_NODES as f32).then_some(Self {
            intervals: intervals as usize,
            nodes: nodes as i32,
            step: interval / nodes,
        })
    }
}

/// All that a grid depends on beside the media: equal words, equal grids. None if [`fill`] gives none.
pub(super) fn recipe(table: &LightGrid, step: f32, quadrature: Quadrature) -> Option<Vec<u32>> {
    let column = Column::new(table, step)?;
    let LightGrid { distant, origin, axes, lo, scale, counts, tint: _, colored: _, depths: _ } = table;
    let numbers = [origin, &axes[0], &axes[1], &axes[2], lo, scale].into_iter().flatten();
    let mut words: Vec<u32> = numbers.map(|number| number.to_bits()).collect();
    words.extend(counts);
    words.extend([u32::from(*distant), column.nodes as u32, quadrature as u32]);
    Some(words)
}

/// Nodes that filling a grid takes, inside media or not, with nodes at most `step` apart; none if they are
/// too many for one ray.
pub(super) fn nodes(table: &LightGrid, step: f32) -> Option<u64> {
    let column = Column::new(table, step)?;
    let columns = u64::from(table.counts[0]) * u64::from(table.counts[1]);
    Some(columns * column.intervals as u64 * column.nodes as u64)
}

/// Computes the depths of a grid, and how many functions were evaluated for it. Nothing if a column has too
/// many nodes.
pub(super) fn fill<F: Fields<Real = f32>>(
    mut table: LightGrid,
    scene: &Scene<f32>,
    fields: impl Fn() -> F + Sync,
) -> Option<(LightGrid, u64)> {
    let column = Column::new(&table, scene.shadow_step)?;
    let rays: Vec<_> = (0..table.counts[0] * table.counts[1]).map(|index| ray(&table, index)).collect();
    let batches = Batches::for_media(scene.media.len());
    let columns = |rays: &[Ray<f32>]| {
        let mut integrator = Integrator::new(scene, fields(), batches);
        let depths = integrator.columns(rays, column);
        (depths, integrator.stats.shadow_samples + integrator.stats.region_evaluations)
    };
    let parts: Vec<_> = rays.par_chunks(batches.rays).map(columns).collect();
    let spent = parts.iter().map(|part| part.1).sum();
    // Where they are: all of them in one piece would be as much memory again.
    let depths: Vec<_> = parts.into_iter().map(|part| part.0).collect();
    store(&mut table, &depths);
    Some((table, spent))
}

/// The ray of a column.
fn ray(table: &LightGrid, index: u32) -> Ray<f32> {
    let [u, v, w] = table.axes;
    let along = |axis: usize, index: u32| table.lo[axis] + index as f32 / table.scale[axis];
    let (x, y) = (along(0, index / table.counts[1]), along(1, index % table.counts[1]));
    let across = add(scale(u, x), scale(v, y));
    if table.distant {
        return Ray::new(add(table.origin, add(across, scale(w, table.lo[2]))), w);
    }
    let toward = add(w, across);
    let size = length(toward);
    let direction = toward.map(|component| component / size);
    Ray::new(add(table.origin, scale(direction, table.lo[2])), direction)
}

/// Largest difference of two channels, relative to their sum, that rounding of the sums may make.
const SAME: f32 = 1e-5;

/// Puts depths into a grid: one per point where the channels are in proportion, as in all media whose
/// extinction has one colour.
fn store(table: &mut LightGrid, depths: &[Vec<Vec3<f32>>]) {
    let all = || depths.iter().flatten();
    let total = |depth: &Vec3<f32>| (depth[0] + depth[1]) + depth[2];
    let deepest = all().fold([0.0; 3], |a, b| if total(b) > total(&a) { *b } else { a });
    let whole = total(&deepest);
    let tint = if whole > 0.0 { deepest.map(|depth| depth / whole) } else { [1.0; 3] };
    let alike = |depth: &Vec3<f32>| {
        let amount = total(depth);
        (0..3).all(|channel| (depth[channel] - tint[channel] * amount).abs() <= SAME * amount)
    };
    table.colored = !all().all(alike);
    table.tint = if table.colored { [1.0; 3] } else { tint };
    table.depths =
        if table.colored { all().flatten().copied().collect() } else { all().map(total).collect() };
}

impl<F: Fields> Integrator<'_, F> {
    /// Optical depth from the start of each ray to the ends of the intervals of a column, 0 first.
    fn columns(&mut self, rays: &[Ray<F::Real>], column: Column) -> Vec<Vec3<F::Real>> {
        let points = column.intervals + 1;
        let step = F::Real::from_f32(column.step);
        let length = F::Real::from_index(column.intervals as i32 * column.nodes) * step;
        let ends = vec![length; rays.len()];
        let mut depths = vec![splat(F::Real::ZERO); rays.len() * points];
        let combs = self.combs(rays, &ends, step);
        let nodes = self.batches.nodes;
        let mut active = combs.active();
        while !active.is_empty() {
            // Give each node's or panel's depth to the point behind it.
            let found = self.step_depths(rays, &combs, &active);
            for (cursor, found) in active.iter().zip(found.chunks(nodes as usize)) {
                for (node, &depth) in (cursor.node..).zip(found) {
                    let point = (node / column.nodes) as usize + 1;
                    if point < points {
                        let place = &mut depths[cursor.ray * points + point];
                        *place = add(*place, depth);
                    }
                }
            }
            active.retain_mut(|cursor| combs.advance(cursor, nodes));
        }
        // Add up along the light.
        for depths in depths.chunks_mut(points) {
            for point in 1..points {
                let depth = add(depths[point], depths[point - 1]);
                depths[point] = depth.map(|depth| depth.min(F::Real::from_f32(DEEPEST)));
            }
        }
        depths
    }
}
