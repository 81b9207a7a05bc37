//! How a grid is filled.
//!
//! One column of points is one ray of the light, whose nodes are those of any other comb, walls of media included;
//! the depth of a point is the sum of all nodes before it. Only the part of a column from where it meets media
//! to where it leaves them is walked and kept.

use super::packed::Packed;
use crate::real::{Real, Vec3, add, length, scale, splat};
use crate::render::camera::Ray;
use crate::render::comb::MAX_NODES;
use crate::render::fields::Fields;
use crate::render::scene::{Batches, Integrator, Scene};
use rayon::prelude::*;
use std::ops::{Range, RangeInclusive};
use vol_compiler::frame::{LightGrid, Quadrature};

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
pub(crate) fn recipe(table: &LightGrid, step: f32, quadrature: Quadrature) -> Option<Vec<u32>> {
    let column = Column::new(table, step)?;
    let LightGrid {
        distant,
        origin,
        axes,
        lo,
        scale,
        counts,
        tint: _,
        colored: _,
        spline: _,
        columns: _,
        depths: _,
    } = table;
    let numbers = [origin, &axes[0], &axes[1], &axes[2], lo, scale].into_iter().flatten();
    let mut words: Vec<u32> = numbers.map(|number| number.to_bits()).collect();
    words.extend(counts);
    words.extend([u32::from(*distant), column.nodes as u32, quadrature as u32]);
    Some(words)
}

/// Nodes that filling a grid takes, inside media or not, with nodes at most `step` apart; none if they are
/// too many for one ray.
pub(crate) fn nodes(table: &LightGrid, step: f32) -> Option<u64> {
    let column = Column::new(table, step)?;
    let columns = u64::from(table.counts[0]) * u64::from(table.counts[1]);
    Some(columns * column.intervals as u64 * column.nodes as u64)
}

/// Bytes of a word of a grid while it is filled: as the threads found it, and put together.
const PER_WORD: usize = 2 * size_of::<f32>();

/// Bytes of a point of a column that a thread is at: a depth per channel, and what is made of it.
const PER_POINT: usize = 8 * size_of::<f32>();

/// Bytes of a column meanwhile: its ray.
const PER_COLUMN: usize = 32;

/// Most bytes of a grid of so many words while it is filled.
pub(crate) fn filling_bytes(layout: &LightGrid, words: usize) -> usize {
    let at_work = rayon::current_num_threads() * Batches::DEFAULT.rays * layout.counts[2] as usize;
    PER_WORD * words + PER_COLUMN * layout.column_count() + PER_POINT * at_work
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
    let rays: Vec<_> = (0..table.column_count() as u32).map(|index| ray(&table, index)).collect();
    // What `keep` makes of each depth, their tone, and what was spent.
    let store = |channels: usize, keep: fn(&Vec3<f32>, &mut [f32])| {
        let parts = rays.par_chunks(batches.rays).map(|rays| {
            let mut integrator = Integrator::new(scene, fields(), batches);
            let runs = integrator.columns(rays, column);
            let mut words = vec![0.0; channels * runs.depths.len()];
            words.chunks_mut(channels).zip(&runs.depths).for_each(|(words, depth)| keep(depth, words));
            let mut packed = Packed::new();
            let mut words = words.as_slice();
            for points in &runs.points {
                let (own, others) = words.split_at(channels * points.len());
                packed.push(points.start, own, channels);
                words = others;
            }
            let stats = &integrator.stats;
            (packed, Tone::new(&runs.depths), stats.shadow_samples + stats.region_evaluations)
        });
        let parts: Vec<_> = parts.collect();
        let tone = parts.iter().fold(Tone::NONE, |tone, part| tone.with(part.1));
        let spent = parts.iter().map(|part| part.2).sum();
        (parts.into_iter().map(|part| part.0).collect::<Packed>(), tone, spent)
    };
    // Nearly all media have extinction of one colour.
    let (packed, tone, spent) = store(1, |depth, words| words[0] = total(depth));
    if tone.is_one {
        return Some((packed.into_grid(LightGrid { tint: tone.tint(), colored: false, ..table }), spent));
    }
    drop(packed);
    let (packed, _, spent) = store(3, |depth, words| words.copy_from_slice(depth));
    Some((packed.into_grid(LightGrid { tint: [1.0; 3], colored: true, ..table }), spent))
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

/// Optical depths from the start of some rays.
struct Runs<R> {
    /// The points of each ray whose depths are known, in numbers of intervals: from the last one that has none on to the first
    /// that has all.
    points: Vec<Range<usize>>,
    /// Those depths, one ray after the other.
    depths: Vec<Vec3<R>>,
}

impl<F: Fields> Integrator<'_, F> {
    /// Optical depths at the ends of the intervals of a column, for each of its rays.
    fn columns(&mut self, rays: &[Ray<F::Real>], column: Column) -> Runs<F::Real> {
        let step = F::Real::from_f32(column.step);
        let length = F::Real::from_index(column.intervals as i32 * column.nodes) * step;
        let ends = vec![length; rays.len()];
        let combs = self.combs(rays, &ends, step);
        let interval = |node: i32| ((node / column.nodes) as usize).min(column.intervals - 1);
        let points = |nodes: RangeInclusive<i32>| match nodes.is_empty() {
            true => 0..0,
            false => interval(*nodes.start())..interval(*nodes.end()) + 2,
        };
        let points: Vec<_> = (0..rays.len()).map(|ray| points(combs.nodes(ray))).collect();
        let mut starts = Vec::with_capacity(rays.len() + 1);
        let mut count = 0;
        for points in &points {
            starts.push(count);
            count += points.len();
        }
        let mut depths = vec![splat(F::Real::ZERO); count];
        let nodes = self.batches.nodes;
        let mut active = combs.active();
        while !active.is_empty() {
            // Give each node's or panel's depth to the point behind it.
            let found = self.step_depths(rays, &combs, &active);
            for (node, found) in (0..).zip(found.chunks(active.len())) {
                for (cursor, &found) in active.iter().zip(found) {
                    let points = &points[cursor.ray];
                    let before = ((cursor.node + node) / column.nodes) as usize - points.start;
                    if before + 1 < points.len() {
                        let depth = &mut depths[starts[cursor.ray] + before + 1];
                        *depth = add(*depth, found);
                    }
                }
            }
            active.retain_mut(|cursor| combs.advance(cursor, nodes));
        }
        // Add up along the light.
        for (points, &start) in points.iter().zip(&starts) {
            for point in start + 1..start + points.len() {
                let depth = add(depths[point], depths[point - 1]);
                depths[point] = depth.map(|depth| depth.min(F::Real::from_f32(DEEPEST)));
            }
        }
        Runs { points, depths }
    }
}
