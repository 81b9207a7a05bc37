//! Optical depth between a light and a point, looked up in the light's grid; and how a grid is filled.
//!
//! A grid holds depths, not the light that arrives: between its points a depth is nearly linear where
//! `exp(-depth)` is not. One column of points is one ray of the light, whose nodes are those of any other
//! comb, walls of media included; the depth of a point is the sum of all nodes before it. Between points
//! depths are cubic along each axis, in one of two ways:
//!
//! * a local cubic: third order in the distance between points where the density is smooth, first order at walls;
//! * a cubic spline ([`spline`]): fourth order, 4e-7 deep inside a homogeneous ball with 129 points where the other is 2e-4
//!   off; but it swings for some points beside a wall, which draws rings.
//!
//! What that means for a scene is measured, and the way chosen, in [`super::grid_choice`].
//!
//! * source: algorithms.md §5.1, "Light"; R. G. Keys, "Cubic Convolution Interpolation for Digital Image
//!   Processing", IEEE TASSP 1981; M. Unser, "Splines: A Perfect Fit for Signal and Image Processing", IEEE Signal
//!   Processing Magazine 1999
//!
//! Twin of the look-up: `compiler/src/wgsl/render/light_grid.wgsl`.

mod spline;

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
    spline: bool,
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
            spline: table.spline,
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
        let around =
            [0, 1, 2].map(|axis| Stencil::new(held[axis], last[axis], self.steps[axis], self.spline));
        if self.steps[2] == 1 {
            return scale(self.tint, self.channel(0, &around));
        }
        mul(self.tint, [0, 1, 2].map(|channel| self.channel(channel, &around)))
    }

    /// One channel between the points around; what the cubic overshoots below 0 is cut off.
    fn channel(&self, first: usize, [x, y, z]: &[Stencil<R>; 3]) -> R {
        // Four sums side by side, which are one vector.
        let mut sums = [R::ZERO; 4];
        for i in 0..4 {
            for j in 0..4 {
                let weight = x.weights[i] * y.weights[j];
                let row = self.row(first + x.at[i] + y.at[j], z.at);
                for (sum, depth) in sums.iter_mut().zip(row) {
                    *sum = *sum + weight * R::from_f32(depth);
                }
            }
        }
        let [a, b, c, d] = z.weights;
        let sum = ((a * sums[0] + b * sums[1]) + c * sums[2]) + d * sums[3];
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
    fn new(place: R, last: R, step: usize, spline: bool) -> Self {
        let index = place.floor().min(last - R::ONE);
        let t = place - index;
        let (f, half) = (R::from_f32, R::from_f32(0.5));
        let weights = if spline {
            let (back, sixth, two_thirds) = (R::ONE - t, f(1.0 / 6.0), f(2.0 / 3.0));
            [
                sixth * (back * (back * back)),
                two_thirds - (t * t) * (R::ONE - half * t),
                two_thirds - (back * back) * (R::ONE - half * back),
                sixth * (t * (t * t)),
            ]
        } else {
            [
                ((R::ONE - half * t) * t - half) * t,
                ((f(1.5) * t - f(2.5)) * t) * t + R::ONE,
                ((f(2.0) - f(1.5) * t) * t + half) * t,
                ((half * t - half) * t) * t,
            ]
        };
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
    let LightGrid { distant, origin, axes, lo, scale, counts, tint: _, colored: _, spline: _, depths: _ } =
        table;
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
pub(crate) fn fill<F: Fields<Real = f32>>(
    table: LightGrid,
    scene: &Scene<f32>,
    fields: impl Fn() -> F + Sync,
) -> Option<(LightGrid, u64)> {
    let column = Column::new(&table, scene.shadow_step)?;
    let batches = Batches::for_media(scene.media.len());
    let rays: Vec<_> = (0..table.counts[0] * table.counts[1]).map(|index| ray(&table, index)).collect();
    let points = table.points();
    // What `keep` makes of each depth, their tone, and what was spent.
    let store = |channels: usize, keep: fn(&Vec3<f32>, &mut [f32])| {
        let mut all = vec![0.0; channels * points];
        let words = batches.rays * (column.intervals + 1) * channels;
        let parts = all.par_chunks_mut(words).zip(rays.par_chunks(batches.rays));
        let parts = parts.map(|(words, rays)| {
            let mut integrator = Integrator::new(scene, fields(), batches);
            let depths = integrator.columns(rays, column);
            words.chunks_mut(channels).zip(&depths).for_each(|(words, depth)| keep(depth, words));
            let stats = &integrator.stats;
            (Tone::new(&depths), stats.shadow_samples + stats.region_evaluations)
        });
        let parts: Vec<_> = parts.collect();
        let tone = parts.iter().fold(Tone::NONE, |tone, part| tone.with(part.0));
        (all, tone, parts.iter().map(|part| part.1).sum())
    };
    // Nearly all media have extinction of one colour.
    let (depths, tone, spent) = store(1, |depth, words| words[0] = total(depth));
    if tone.is_one {
        return Some((LightGrid { tint: tone.tint(), colored: false, depths, ..table }, spent));
    }
    drop(depths);
    let (depths, _, spent) = store(3, |depth, words| words.copy_from_slice(depth));
    Some((LightGrid { tint: [1.0; 3], colored: true, depths, ..table }, spent))
}

/// The same grid with a spline through its depths.
pub(super) fn splined(grid: &LightGrid) -> LightGrid {
    let channels = if grid.colored { 3 } else { 1 };
    let depths = spline::coefficients(grid.depths.clone(), grid.counts, channels);
    let LightGrid { distant, origin, axes, lo, scale, counts, tint, colored, .. } = *grid;
    LightGrid { distant, origin, axes, lo, scale, counts, tint, colored, spline: true, depths }
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

/// Sum of the channels.
fn total(depth: &Vec3<f32>) -> f32 {
    (depth[0] + depth[1]) + depth[2]
}

/// Whether depths are of one colour, in proportion but for rounding, and of which.
#[derive(Clone, Copy)]
struct Tone {
    /// The largest of them.
    deepest: Vec3<f32>,
    is_one: bool,
}

impl Tone {
    /// Of no depths.
    const NONE: Self = Self { deepest: [0.0; 3], is_one: true };

    fn new(depths: &[Vec3<f32>]) -> Self {
        let deepest = depths.iter().fold([0.0; 3], |a, b| if total(b) > total(&a) { *b } else { a });
        let own = Self { deepest, is_one: true };
        Self { is_one: own.holds(depths), ..own }
    }

    /// What a depth is to be multiplied by per channel.
    fn tint(&self) -> Vec3<f32> {
        let whole = total(&self.deepest);
        if whole > 0.0 { self.deepest.map(|depth| depth / whole) } else { [1.0; 3] }
    }

    /// Whether depths are of its colour.
    fn holds(&self, depths: &[Vec3<f32>]) -> bool {
        let tint = self.tint();
        depths.iter().all(|depth| {
            let amount = total(depth);
            (0..3).all(|channel| (depth[channel] - tint[channel] * amount).abs() <= SAME * amount)
        })
    }

    /// Of both.
    fn with(self, other: Self) -> Self {
        let deeper = if total(&other.deepest) > total(&self.deepest) { other } else { self };
        let is_one = self.is_one && other.is_one && deeper.holds(&[self.deepest, other.deepest]);
        Self { is_one, ..deeper }
    }
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
                let depths = &mut depths[cursor.ray * points..][1..points];
                let before = (column.nodes - cursor.node % column.nodes) as usize;
                let (first, rest) = found.split_at(before.min(found.len()));
                let intervals = std::iter::once(first).chain(rest.chunks(column.nodes as usize));
                let first = (cursor.node / column.nodes) as usize;
                for (place, found) in depths.iter_mut().skip(first).zip(intervals) {
                    *place = found.iter().fold(*place, |sum, &depth| add(sum, depth));
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
