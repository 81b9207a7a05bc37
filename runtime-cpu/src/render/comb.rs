//! The samples of media along a ray, and the length of ray that each stands for.
//!
//! One comb per ray: node `i` is at `(i + 1/2 + shift) step` from the ray's origin, whatever the ray
//! enters or leaves, so that skipping empty parts changes no sum; for [`super::panel`] at `(i + shift) step`, the
//! first one at the origin. The shift is the ray's own: with one for all pixels what is left of
//! the error would be rings and bands. What follows is of the midpoint form. Between two neighbouring nodes
//! of which both are inside a medium, each gets half of the interval; if only one is inside, the
//! wall is where the signed distances say, and that node gets all up to the wall. This is second
//! order at hard walls, at the ray's origin and at its end. Parts between two outside nodes are
//! lost: what is thinner than a step may be missed.
//!
//! The region of a medium is evaluated only at nodes within a step of one of its cells, and beside those: all
//! others are outside, and so are their neighbours, so no weight asks for their distances.
//!
//! Along camera rays a node may stand for several steps where only smooth media are: [`super::spacing`].
//!
//! Twin: `compiler/src/wgsl/render/comb.wgsl`, of the weights `midpoint.wgsl` beside it.

use super::camera::{Ray, Span, slab};
use super::fields::{Fields, Points};
use super::scatter::Place;
use super::scene::{Integrator, Medium};
use super::spacing::{Near, Parts};
use crate::isa::Loop;
use crate::real::{Real, add, splat, sub};
use std::ops::{Range, RangeInclusive};
use vol_compiler::frame::Quadrature;

/// Most nodes of one ray: a medium without bounds ends after so many.
pub(crate) const MAX_NODES: i32 = 16_384;

/// Nodes have no greater numbers: here f32 still knows them and a half.
pub(crate) const LAST_NODE: f32 = 4_194_304.0;

/// Nodes `first..=last` of a ray, or steps of its comb; none if `first > last`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct NodeRange {
    /// The first one, at least 0.
    pub(crate) first: i32,
    /// The last one.
    pub(crate) last: i32,
}

impl NodeRange {
    /// No nodes.
    const NONE: Self = Self { first: 0, last: -1 };

    /// Whether it has none.
    pub(super) fn is_empty(&self) -> bool {
        self.first > self.last
    }

    /// Smallest range that holds both.
    pub(super) fn union(self, other: Self) -> Self {
        if self.is_empty() {
            other
        } else if other.is_empty() {
            self
        } else {
            Self { first: self.first.min(other.first), last: self.last.max(other.last) }
        }
    }

    /// What both hold.
    fn within(self, other: Self) -> Self {
        Self { first: self.first.max(other.first), last: self.last.min(other.last) }
    }
}

/// Ranges of nodes of many rays, in order along each, apart from one another.
#[derive(Default)]
struct Runs {
    all: Vec<NodeRange>,
    /// Where those of each ray end.
    ends: Vec<usize>,
}

impl Runs {
    /// Adds a ray with its ranges in any order.
    fn push(&mut self, mut ranges: Vec<NodeRange>) {
        ranges.retain(|range| !range.is_empty());
        ranges.sort_unstable_by_key(|range| range.first);
        let start = self.all.len();
        for range in ranges {
            match self.all[start..].last_mut() {
                // A node beside each range is looked at as well.
                Some(last) if range.first <= last.last + 2 => last.last = last.last.max(range.last),
                _ => self.all.push(range),
            }
        }
        self.ends.push(self.all.len());
    }

    fn of(&self, ray: usize) -> &[NodeRange] {
        let start = ray.checked_sub(1).map_or(0, |before| self.ends[before]);
        &self.all[start..self.ends[ray]]
    }
}

/// How far a ray has been sampled.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cursor {
    /// Index of the ray.
    pub(crate) ray: usize,
    /// The next node.
    pub(crate) node: i32,
}

/// The combs of a batch of rays.
pub(crate) struct Combs<'a, R> {
    pub(super) step: R,
    /// Where the middle of step 0 of each ray is, in steps.
    offsets: Vec<R>,
    /// For how many steps each node stands.
    parts: Parts,
    pub(super) ends: &'a [R],
    /// Nodes that may be inside, per medium and ray; of panels the first node of each.
    runs: Vec<Runs>,
    /// From the first to the last node that may be inside some medium, per ray.
    whole: Vec<NodeRange>,
}

impl<R: Real> Combs<'_, R> {
    /// Distance of a node from the origin of its ray.
    pub(crate) fn distance(&self, ray: usize, node: i32) -> R {
        let (part, _) = self.parts.around(ray, node);
        node_distance(part.step_of(node), self.step, self.offsets[ray] + part.middle())
    }

    /// From the first to the last node of a ray that may be inside some medium.
    pub(super) fn nodes(&self, ray: usize) -> RangeInclusive<i32> {
        let NodeRange { first, last } = self.whole[ray];
        first..=last
    }

    /// The rays that have nodes, at their first one.
    pub(crate) fn active(&self) -> Vec<Cursor> {
        let rays = self.whole.iter().enumerate().filter(|(_, whole)| whole.first <= whole.last);
        rays.map(|(ray, whole)| Cursor { ray, node: whole.first }).collect()
    }

    /// Goes on by a number of nodes and to the next one that may be inside a medium; whether there is one.
    pub(super) fn advance(&self, cursor: &mut Cursor, nodes: i32) -> bool {
        let node = cursor.node + nodes;
        let next = |runs: &Runs| {
            let runs = runs.of(cursor.ray);
            let next = runs.get(runs.partition_point(|run| run.last < node))?;
            Some(next.first.max(node))
        };
        cursor.node = self.runs.iter().filter_map(next).min().unwrap_or(i32::MAX);
        cursor.node <= self.whole[cursor.ray].last
    }

    /// Those of the next `nodes` of each active ray that may be inside a medium, with some more before and behind.
    pub(super) fn runs_of(
        &self,
        medium: usize,
        active: &[Cursor],
        nodes: i32,
        [before, behind]: [i32; 2],
    ) -> Vec<Run> {
        let mut runs = Vec::with_capacity(active.len());
        let mut start = 0;
        for (which, cursor) in active.iter().enumerate() {
            for NodeRange { first, last } in self.runs(medium, cursor, nodes) {
                let end = start + (last - first + 1 + before + behind) as usize;
                runs.push(Run { which, first: first - before, places: start..end });
                start = end;
            }
        }
        runs
    }

    /// Where the nodes of runs are; `held` between the ends of their rays or not.
    pub(super) fn laid_out(
        &self,
        runs: &[Run],
        rays: &[Ray<R>],
        active: &[Cursor],
        held: bool,
    ) -> LaidOut<R> {
        let count = runs.last().map_or(0, |run| run.places.end);
        let [distances, halves] = [(); 2].map(|()| vec![R::ZERO; count]);
        let mut nodes = LaidOut { distances, halves, points: Points::origins(count) };
        R::vectorized(LayOut { combs: self, runs, rays, active, held, nodes: &mut nodes });
        nodes
    }

    /// Those of the next `nodes` that may be inside a medium.
    fn runs(
        &self,
        medium: usize,
        cursor: &Cursor,
        nodes: i32,
    ) -> impl Iterator<Item = NodeRange> + use<'_, R> {
        let (first, last) = (cursor.node, self.whole[cursor.ray].last.min(cursor.node + nodes - 1));
        let runs = self.runs[medium].of(cursor.ray);
        let near = &runs[runs.partition_point(|run| run.last < first)..];
        let near = near.iter().take_while(move |run| run.first <= last);
        near.map(move |run| NodeRange { first: run.first.max(first), last: run.last.min(last) })
    }
}

/// Nodes of runs.
pub(super) struct LaidOut<R> {
    /// Along their rays.
    pub(super) distances: Vec<R>,
    /// Half of the length that each stands for.
    halves: Vec<R>,
    /// In space.
    pub(super) points: Points<R>,
}

/// Nodes of an active ray in a row.
pub(super) struct Run {
    /// Index of the ray.
    pub(super) which: usize,
    /// The first node.
    pub(super) first: i32,
    /// Where they are among the nodes of all runs.
    pub(super) places: Range<usize>,
}

/// Nodes inside a medium.
pub(crate) struct Inside<R> {
    /// Which they are.
    pub(crate) places: Vec<Place<R>>,
    /// Length of ray that each stands for.
    pub(crate) weights: Vec<R>,
    /// Where it is.
    pub(crate) points: Points<R>,
}

impl<R: Real> Inside<R> {
    /// None yet, with room for some.
    fn with_capacity(count: usize) -> Self {
        let (places, weights) = (Vec::with_capacity(count), Vec::with_capacity(count));
        Self { places, weights, points: Points::with_capacity(count) }
    }
}

/// Where the middle of step 0 is, in steps. Blocks are moved by the same part of their length as steps, down to whole steps: so
/// they leave the nodes of the finest medium where those are without. Panels begin at the origin, so there node 0 is at or
/// before it.
fn first_node<R: Real>(quadrature: Quadrature, shift: R, block: i32) -> R {
    let half = R::from_f32(0.5);
    match quadrature {
        Quadrature::Midpoint => {
            let moved = (R::from_index(block) * (half + shift)).floor();
            (half + shift) - (R::from_index(block - 1) - moved)
        }
        Quadrature::Corrected if shift > R::ZERO => shift - R::ONE,
        Quadrature::Corrected => shift,
    }
}

/// Distance of a node from the origin of the ray, given its step and where the middle of step 0 would be for it.
#[inline(always)]
fn node_distance<R: Real>(node: i32, step: R, offset: R) -> R {
    (R::from_index(node) + offset) * step
}

/// The steps in which a medium may be.
struct Reached {
    /// In its box.
    whole: NodeRange,
    /// In each of its cells that the ray passes, with the number of the cell; without cells in its box.
    cells: Vec<(usize, NodeRange)>,
}

impl Reached {
    fn new<R: Real>(ray: &Ray<R>, medium: &Medium<R>, spacing: i32, step: R, offset: R, end: R) -> Self {
        // Boxes are grown by what a node stands for, so that the neighbours of a node inside are in a range or next to it,
        // and so are the panels on both sides.
        let reach = (R::from_f32(1.01) * R::from_index(spacing)) * step;
        let most = R::from_f32(LAST_NODE);
        let node = |t: R| (t / step - offset).floor().min(most);
        let range = |span: Span<R>| NodeRange {
            first: node(span.entry).max(R::ZERO).to_index(),
            last: node(span.exit.min(end)).to_index(),
        };
        let whole = slab(ray, sub(medium.lo, splat(reach)), add(medium.hi, splat(reach)));
        if whole.entry > whole.exit.min(end) {
            return Self { whole: NodeRange::NONE, cells: Vec::new() };
        }
        let whole = range(whole);
        if whole.is_empty() || medium.cells.is_empty() {
            return Self { whole, cells: vec![(0, whole)] };
        }
        let spans = medium.cells.spans(ray, reach, end).into_iter();
        Self { whole, cells: spans.map(|(cell, span)| (cell, range(span))).collect() }
    }
}

/// Part of the interval between two neighbouring nodes that the first stands for, given the signed
/// distances of both and half of what each stands for beside other nodes inside.
#[inline(always)]
fn share<R: Real>([own, half]: [R; 2], [other, other_half]: [R; 2]) -> R {
    if other < R::ZERO { half } else { (half + other_half) * (own / (own - other)) }
}

impl<F: Fields> Integrator<'_, F> {
    /// Lays out the nodes of each ray up to its end, one for each step.
    pub(crate) fn combs<'a>(
        &self,
        rays: &[Ray<F::Real>],
        ends: &'a [F::Real],
        step: F::Real,
    ) -> Combs<'a, F::Real> {
        self.spaced_combs(rays, ends, step, |_| 1)
    }

    /// The same for camera rays, which have fewer where only smooth media are.
    pub(super) fn camera_combs<'a>(&self, rays: &[Ray<F::Real>], ends: &'a [F::Real]) -> Combs<'a, F::Real> {
        match self.scene.quadrature {
            Quadrature::Midpoint => {
                self.spaced_combs(rays, ends, self.scene.step, |medium: &Medium<F::Real>| medium.spacing)
            }
            Quadrature::Corrected => self.combs(rays, ends, self.scene.step),
        }
    }

    fn spaced_combs<'a>(
        &self,
        rays: &[Ray<F::Real>],
        ends: &'a [F::Real],
        step: F::Real,
        spacing: impl Fn(&Medium<F::Real>) -> i32,
    ) -> Combs<'a, F::Real> {
        let media = &self.scene.media;
        let block = media.iter().map(&spacing).max().unwrap_or(1);
        let offset = |ray: &Ray<F::Real>| first_node(self.scene.quadrature, ray.shift, block);
        let offsets: Vec<F::Real> = rays.iter().map(offset).collect();
        // Find the steps in which each medium may be.
        let reached = media.iter().map(|medium| {
            let rays = rays.iter().zip(&offsets).zip(ends);
            let reached = rays.map(|((path, &offset), &end)| {
                Reached::new(path, medium, spacing(medium), step, offset, end)
            });
            reached.collect::<Vec<_>>()
        });
        let reached: Vec<_> = reached.collect();
        let mut parts = Parts::default();
        if block > 1 {
            for ray in 0..rays.len() {
                let finer = media.iter().zip(&reached).map(|(medium, of)| (spacing(medium), &of[ray].cells));
                let finer = finer.filter(|&(spacing, _)| spacing < block);
                parts.push(block, finer.map(|(spacing, cells)| (Near::of(cells), spacing)));
            }
        }
        // Number the nodes.
        let nodes = |ray: usize, steps: NodeRange| {
            let [first, last] = [steps.first, steps.last].map(|step| parts.node_at(ray, step));
            if steps.is_empty() { NodeRange::NONE } else { NodeRange { first, last } }
        };
        let mut whole = vec![NodeRange::NONE; rays.len()];
        let mut runs = Vec::with_capacity(media.len());
        for reached in reached {
            let mut own = Runs::default();
            for (ray, Reached { whole: around, cells }) in reached.into_iter().enumerate() {
                let steps = cells.into_iter().map(|(_, steps)| steps.within(around));
                let own_nodes = steps.map(|steps| {
                    whole[ray] = whole[ray].union(steps);
                    nodes(ray, steps)
                });
                own.push(own_nodes.collect());
            }
            runs.push(own);
        }
        for (ray, range) in whole.iter_mut().enumerate() {
            range.last = range.last.min(range.first + MAX_NODES - 1);
            *range = nodes(ray, *range);
        }
        Combs { step, offsets, parts, ends, runs, whole }
    }

    /// Signed distances of one medium's region.
    pub(super) fn region(&mut self, medium: usize, points: &Points<F::Real>) -> Vec<F::Real> {
        let [region] = self.fields.sample(self.scene.media[medium].region, points);
        self.stats.region_evaluations += points.len() as u64;
        region
    }

    /// The nodes inside one medium among the next `batches.nodes` of each active ray.
    pub(crate) fn inside(
        &mut self,
        medium: usize,
        rays: &[Ray<F::Real>],
        combs: &Combs<'_, F::Real>,
        active: &[Cursor],
    ) -> Inside<F::Real> {
        // Take the nodes in the medium's range and one more at either side.
        let runs = combs.runs_of(medium, active, self.batches.nodes, [1, 1]);
        let nodes = combs.laid_out(&runs, rays, active, false);
        let mut walls = self.region(medium, &nodes.points);
        let mut weights = vec![F::Real::ZERO; walls.len()];
        let (runs, walls_of, weights_of) = (&runs, &mut walls, &mut weights);
        F::Real::vectorized(Weigh {
            combs,
            runs,
            active,
            nodes: &nodes,
            walls: walls_of,
            weights: weights_of,
        });
        let LaidOut { distances, points, .. } = nodes;
        // Keep those inside, with the length that each stands for.
        let mut inside = Inside::with_capacity(walls.len());
        for Run { which, first, places } in runs {
            let (which, node) = (*which, active[*which].node);
            let walls = &walls[places.clone()];
            let last = walls.len() - 1;
            let mut next = 1;
            let is_inside = |&index: &usize| walls[index] < F::Real::ZERO;
            while let Some(begin) = (next..last).find(is_inside) {
                next = (begin..last).find(|index| !is_inside(index)).unwrap_or(last);
                let kept = places.start + begin..places.start + next;
                inside.weights.extend_from_slice(&weights[kept.clone()]);
                inside.points.extend_from(&points, kept.clone());
                let nodes = (first - node + begin as i32) as usize..;
                let places = nodes.zip(&distances[kept]);
                inside.places.extend(places.map(|(node, &t)| Place { which, node: Some(node), t }));
            }
        }
        inside
    }
}

/// Makes of signed distances of a region those of the part of it that is between the ends of the ray, and finds what length of
/// ray each node inside stands for.
struct Weigh<'a, 'c, R> {
    combs: &'a Combs<'c, R>,
    runs: &'a [Run],
    active: &'a [Cursor],
    nodes: &'a LaidOut<R>,
    walls: &'a mut [R],
    weights: &'a mut [R],
}

impl<R: Real> Loop for Weigh<'_, '_, R> {
    type Out = ();

    #[inline(always)]
    fn run(self) {
        for Run { which, first: _, places } in self.runs {
            let end = self.combs.ends[self.active[*which].ray];
            let walls = &mut self.walls[places.clone()];
            let halves = &self.nodes.halves[places.clone()];
            for (wall, &t) in walls.iter_mut().zip(&self.nodes.distances[places.clone()]) {
                *wall = wall.max((t - end).max(-t));
            }
            // Of the first and the last node nobody asks.
            let weights = &mut self.weights[places.start + 1..places.end - 1];
            for (index, weight) in weights.iter_mut().enumerate() {
                let left = [walls[index], halves[index]];
                let own = [walls[index + 1], halves[index + 1]];
                let right = [walls[index + 2], halves[index + 2]];
                *weight = share(own, left) + share(own, right);
            }
        }
    }
}

/// Fills in where nodes are.
struct LayOut<'a, 'c, R> {
    combs: &'a Combs<'c, R>,
    runs: &'a [Run],
    rays: &'a [Ray<R>],
    active: &'a [Cursor],
    held: bool,
    nodes: &'a mut LaidOut<R>,
}

impl<R: Real> Loop for LayOut<'_, '_, R> {
    type Out = ();

    #[inline(always)]
    fn run(self) {
        for Run { which, first, places } in self.runs {
            let index = self.active[*which].ray;
            let Combs { step, offsets, parts, ends, .. } = self.combs;
            let (ray, offset, end) = (&self.rays[index], offsets[index], ends[index]);
            let distances = &mut self.nodes.distances[places.clone()];
            let halves = &mut self.nodes.halves[places.clone()];
            let mut at = 0;
            while at < distances.len() {
                let node = *first + at as i32;
                let (part, next) = parts.around(index, node);
                let count = (distances.len() - at).min(next.saturating_sub(node) as usize);
                let offset = offset + part.middle();
                let half = R::from_f32(0.5) * (R::from_index(part.spacing) * *step);
                for (distance, node) in distances[at..at + count].iter_mut().zip(node..) {
                    *distance = node_distance(part.step_of(node), *step, offset);
                }
                halves[at..at + count].fill(half);
                at += count;
            }
            if self.held {
                for distance in &mut *distances {
                    *distance = distance.max(R::ZERO).min(end);
                }
            }
            for (axis, row) in self.nodes.points.rows().into_iter().enumerate() {
                let (origin, direction) = (ray.origin[axis], ray.direction[axis]);
                for (value, &t) in row[places.clone()].iter_mut().zip(&*distances) {
                    *value = origin + direction * t;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sum of the weights of a slab between two walls.
    fn covered(entry: f64, exit: f64, step: f64) -> f64 {
        let wall = |node: i32| {
            let t = node_distance(node, step, 0.5);
            (entry - t).max(t - exit).max(-t)
        };
        let node = |node| [wall(node), 0.5 * step];
        let weight = |index| share(node(index), node(index - 1)) + share(node(index), node(index + 1));
        (0..1000).filter(|&node| wall(node) < 0.0).map(weight).sum()
    }

    #[test]
    fn weights_add_up_to_the_length() {
        for step in [0.013, 0.1, 0.37] {
            for entry in [0.0, 0.05, 0.1, 0.77, 1.0] {
                assert!((covered(entry, 2.5, step) - (2.5 - entry)).abs() < 1e-12, "{entry} {step}");
            }
            assert!((covered(-3.0, 2.5, step) - 2.5).abs() < 1e-12, "the eye is inside, step {step}");
        }
    }

    #[test]
    fn a_wall_on_a_node_counts_as_outside() {
        // Nodes at 0.5, 1.5, 2.5, 3.5: the walls are on two of them.
        assert_eq!(covered(0.5, 3.5, 1.0), 3.0);
    }
}
