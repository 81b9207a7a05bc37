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
//! Twin: `compiler/src/wgsl/render/comb.wgsl`.

use super::camera::{Ray, Span, slab};
use super::fields::{Fields, Points};
use super::scatter::Place;
use super::scene::{Integrator, Medium};
use crate::real::{Real, add, splat, sub};
use std::ops::RangeInclusive;
use vol_compiler::frame::Quadrature;

/// Most nodes of one ray: a medium without bounds ends after so many.
pub(crate) const MAX_NODES: i32 = 16_384;

/// Nodes have no greater numbers: here f32 still knows them and a half.
pub(crate) const LAST_NODE: f32 = 4_194_304.0;

/// Nodes `first..=last` of a comb; none if `first > last`.
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

    /// Smallest range that holds both.
    fn union(self, other: Self) -> Self {
        if self.first > self.last {
            other
        } else if other.first > other.last {
            self
        } else {
            Self { first: self.first.min(other.first), last: self.last.max(other.last) }
        }
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
        ranges.retain(|range| range.first <= range.last);
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
    /// Where node 0 of each ray is, in steps.
    offsets: Vec<R>,
    pub(super) ends: &'a [R],
    /// Nodes that may be inside, per medium and ray; of panels the first node of each.
    runs: Vec<Runs>,
    /// From the first to the last node that may be inside some medium, per ray.
    whole: Vec<NodeRange>,
}

impl<R: Real> Combs<'_, R> {
    /// Distance of a node from the origin of its ray.
    pub(crate) fn distance(&self, ray: usize, node: i32) -> R {
        node_distance(node, self.step, self.offsets[ray])
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

    /// Those of the next `nodes` that may be inside a medium.
    pub(super) fn runs(
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

/// Nodes inside a medium.
pub(crate) struct Inside<R> {
    /// Which they are.
    pub(crate) places: Vec<Place<R>>,
    /// Length of ray that each stands for.
    pub(crate) weights: Vec<R>,
    /// Where it is.
    pub(crate) points: Points<R>,
}

/// Where node 0 is, in steps. Panels begin at the origin, so there it is at or before it.
fn first_node<R: Real>(quadrature: Quadrature, shift: R) -> R {
    match quadrature {
        Quadrature::Midpoint => R::from_f32(0.5) + shift,
        Quadrature::Corrected if shift > R::ZERO => shift - R::ONE,
        Quadrature::Corrected => shift,
    }
}

/// Distance of a node from the origin of the ray.
fn node_distance<R: Real>(node: i32, step: R, offset: R) -> R {
    (R::from_index(node) + offset) * step
}

/// Nodes that may be inside a medium. Boxes are grown by a step, so that the neighbours of a node
/// inside are in a range or next to it, and so are the panels on both sides.
fn node_ranges<R: Real>(ray: &Ray<R>, medium: &Medium<R>, step: R, offset: R, end: R) -> Vec<NodeRange> {
    let reach = R::from_f32(1.01) * step;
    let most = R::from_f32(LAST_NODE);
    let node = |t: R| (t / step - offset).floor().min(most);
    let range = |span: Span<R>| NodeRange {
        first: node(span.entry).max(R::ZERO).to_index(),
        last: node(span.exit.min(end)).to_index(),
    };
    let whole = slab(ray, sub(medium.lo, splat(reach)), add(medium.hi, splat(reach)));
    if whole.entry > whole.exit.min(end) {
        return Vec::new();
    }
    if medium.cells.is_empty() {
        return vec![range(whole)];
    }
    let within = |span: Span<R>| Span { entry: span.entry.max(whole.entry), exit: span.exit.min(whole.exit) };
    medium.cells.spans(ray, reach, end).into_iter().map(within).map(range).collect()
}

/// Part of the interval between two neighbouring nodes that the first stands for, given the signed
/// distances of both.
fn share<R: Real>(own: R, other: R, step: R) -> R {
    if other < R::ZERO { R::from_f32(0.5) * step } else { step * (own / (own - other)) }
}

impl<F: Fields> Integrator<'_, F> {
    /// Lays out the nodes of each ray up to its end.
    pub(crate) fn combs<'a>(
        &self,
        rays: &[Ray<F::Real>],
        ends: &'a [F::Real],
        step: F::Real,
    ) -> Combs<'a, F::Real> {
        let offset = |ray: &Ray<F::Real>| first_node(self.scene.quadrature, ray.shift);
        let offsets: Vec<F::Real> = rays.iter().map(offset).collect();
        let mut whole = vec![NodeRange::NONE; rays.len()];
        let mut runs = Vec::with_capacity(self.scene.media.len());
        for medium in &self.scene.media {
            let mut own = Runs::default();
            for (ray, ((path, &offset), &end)) in rays.iter().zip(&offsets).zip(ends).enumerate() {
                own.push(node_ranges(path, medium, step, offset, end));
                if let [first, .., last] | [first @ last] = own.of(ray) {
                    whole[ray] = whole[ray].union(NodeRange { first: first.first, last: last.last });
                }
            }
            runs.push(own);
        }
        for range in &mut whole {
            range.last = range.last.min(range.first + MAX_NODES - 1);
        }
        Combs { step, offsets, ends, runs, whole }
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
        let mut runs = Vec::with_capacity(active.len());
        let (mut distances, mut points) = (Vec::new(), Points::new());
        for (which, cursor) in active.iter().enumerate() {
            for NodeRange { first, last } in combs.runs(medium, cursor, self.batches.nodes) {
                let start = distances.len();
                distances.extend((first - 1..last + 2).map(|node| combs.distance(cursor.ray, node)));
                points.extend_along(&rays[cursor.ray], &distances[start..]);
                runs.push((which, first, start..distances.len()));
            }
        }
        let region = self.region(medium, &points);
        // Keep those inside, with the length that each stands for.
        let mut kept = Vec::with_capacity(points.len());
        let mut walls = Vec::new();
        for (which, first, run) in runs {
            let Cursor { ray, node } = active[which];
            let (before, end) = ((first - node) as usize, combs.ends[ray]);
            let own = &distances[run.clone()];
            walls.clear();
            walls.extend(
                region[run.clone()].iter().zip(own).map(|(region, &t)| region.max((t - end).max(-t))),
            );
            for (index, &[left, wall, right]) in walls.array_windows::<3>().enumerate() {
                if wall < F::Real::ZERO {
                    let place = Place { which, node: Some(before + index), t: own[index + 1] };
                    let weight = share(wall, left, combs.step) + share(wall, right, combs.step);
                    kept.push((place, weight, run.start + index + 1));
                }
            }
        }
        Inside {
            places: kept.iter().map(|&(place, ..)| place).collect(),
            weights: kept.iter().map(|&(_, weight, _)| weight).collect(),
            points: kept.iter().map(|&(.., index)| points.get(index)).collect(),
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
        let weight = |node| share(wall(node), wall(node - 1), step) + share(wall(node), wall(node + 1), step);
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
