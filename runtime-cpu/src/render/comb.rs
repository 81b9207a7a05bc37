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
//! The region of a medium is evaluated only at nodes within a step of one of its cells: all others
//! are outside, and so are their neighbours, so no weight asks for their distances.
//!
//! Twin: `compiler/src/wgsl/render/comb.wgsl`.

use super::camera::{FAR, Ray, slab};
use super::fields::{Fields, Points};
use super::scene::{Integrator, Medium};
use crate::real::{Real, Vec3, add, splat, sub};
use vol_compiler::frame::Quadrature;

/// Most nodes of one ray: a medium without bounds ends after so many.
pub(crate) const MAX_NODES: i32 = 16_384;

/// Nodes have no greater numbers: here f32 still knows them and a half.
pub(crate) const LAST_NODE: f32 = 4_194_304.0;

/// Points that are compared with a cell in one loop.
const BLOCK: usize = 64;

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
    pub(super) ranges: Vec<Vec<NodeRange>>,
    /// Nodes that may be inside some medium, per ray.
    pub(crate) whole: Vec<NodeRange>,
}

impl<R: Real> Combs<'_, R> {
    /// Distance of a node from the origin of its ray.
    pub(crate) fn distance(&self, ray: usize, node: i32) -> R {
        node_distance(node, self.step, self.offsets[ray])
    }

    /// The rays that have nodes, at their first one.
    pub(crate) fn active(&self) -> Vec<Cursor> {
        let rays = self.whole.iter().enumerate().filter(|(_, whole)| whole.first <= whole.last);
        rays.map(|(ray, whole)| Cursor { ray, node: whole.first }).collect()
    }
}

/// Nodes inside a medium. The slot of node `j` after the cursor of active ray `a` is
/// `a * batches.nodes + j`.
pub(crate) struct Inside<R> {
    /// Slot of each.
    pub(crate) slots: Vec<usize>,
    /// Length of ray that it stands for.
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

/// Nodes that may be inside a medium. The box is grown by a step, so that the neighbours of a node
/// inside are in the range or next to it, and so are the panels on both sides.
fn node_range<R: Real>(ray: &Ray<R>, medium: &Medium<R>, step: R, offset: R, end: R) -> NodeRange {
    let reach = splat(R::from_f32(1.01) * step);
    let span = slab(ray, sub(medium.lo, reach), add(medium.hi, reach));
    let exit = span.exit.min(end);
    if span.entry > exit {
        return NodeRange::NONE;
    }
    let most = R::from_f32(LAST_NODE);
    let first = (span.entry / step - offset).floor().max(R::ZERO).min(most);
    let last = (exit / step - offset).floor().min(most);
    NodeRange { first: first.to_index(), last: last.to_index() }
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
        let mut ranges = Vec::with_capacity(self.scene.media.len());
        for medium in &self.scene.media {
            let range = |((ray, &offset), &end)| node_range(ray, medium, step, offset, end);
            let own: Vec<NodeRange> = rays.iter().zip(&offsets).zip(ends).map(range).collect();
            whole.iter_mut().zip(&own).for_each(|(whole, &own)| *whole = whole.union(own));
            ranges.push(own);
        }
        for range in &mut whole {
            range.last = range.last.min(range.first + MAX_NODES - 1);
        }
        Combs { step, offsets, ends, ranges, whole }
    }

    /// Signed distances of one medium's region; [`FAR`] where neither the point nor one within a step
    /// of it is inside.
    pub(super) fn region(&mut self, medium: usize, points: &Points<F::Real>, step: F::Real) -> Vec<F::Real> {
        let medium = &self.scene.media[medium];
        if medium.cells.is_empty() {
            self.stats.region_evaluations += points.len() as u64;
            let [region] = self.fields.sample(medium.region, points);
            return region;
        }
        // Evaluate what is within a step of a cell.
        let reach = F::Real::from_f32(1.01) * step;
        let mut near = Vec::with_capacity(points.len());
        for start in (0..points.len()).step_by(BLOCK) {
            let found = near_cells(&medium.cells, reach, points, start);
            near.extend((start..points.len()).zip(found).filter(|(_, near)| *near).map(|(index, _)| index));
        }
        let chosen = near.iter().map(|&index| points.get(index)).collect();
        let [found] = self.fields.sample(medium.region, &chosen);
        self.stats.region_evaluations += near.len() as u64;
        let mut region = vec![F::Real::from_f32(FAR); points.len()];
        near.into_iter().zip(found).for_each(|(index, found)| region[index] = found);
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
        let mut points = Points::new();
        for (which, cursor) in active.iter().enumerate() {
            let (range, whole) = (combs.ranges[medium][cursor.ray], combs.whole[cursor.ray]);
            let first = range.first.max(cursor.node);
            let last = range.last.min(whole.last).min(cursor.node + self.batches.nodes - 1);
            if first <= last {
                runs.push((which, first, last, points.len()));
                let nodes = first - 1..=last + 1;
                nodes.for_each(|node| points.push(rays[cursor.ray].at(combs.distance(cursor.ray, node))));
            }
        }
        let region = self.region(medium, &points, combs.step);
        // Keep those inside, with the length that each stands for.
        let mut inside = Inside { slots: Vec::new(), weights: Vec::new(), points: Points::new() };
        for (which, first, last, offset) in runs {
            let cursor = active[which];
            let wall = |node: i32| {
                let t = combs.distance(cursor.ray, node);
                let index = offset + (node - (first - 1)) as usize;
                region[index].max((t - combs.ends[cursor.ray]).max(-t))
            };
            let mut before = wall(first - 1);
            let mut own = wall(first);
            for node in first..=last {
                let after = wall(node + 1);
                if own < F::Real::ZERO {
                    let weight = share(own, before, combs.step) + share(own, after, combs.step);
                    let slot = which * self.batches.nodes as usize + (node - cursor.node) as usize;
                    inside.slots.push(slot);
                    inside.weights.push(weight);
                    inside.points.push(points.get(offset + (node - (first - 1)) as usize));
                }
                before = own;
                own = after;
            }
        }
        inside
    }
}

/// Which of the points from `start` on are in a cell grown by `reach`.
#[inline(never)]
fn near_cells<R: Real>(cells: &[[Vec3<R>; 2]], reach: R, points: &Points<R>, start: usize) -> [bool; BLOCK] {
    let mut place = [[R::ZERO; BLOCK]; 3];
    let [x, y, z] = &mut place;
    let block = start..points.len().min(start + BLOCK);
    for (index, ((x, y), z)) in block.zip(x.iter_mut().zip(y.iter_mut()).zip(z.iter_mut())) {
        [*x, *y, *z] = points.get(index);
    }
    let mut near = [false; BLOCK];
    for &[lo, hi] in cells {
        let (lo, hi) = (sub(lo, splat(reach)), add(hi, splat(reach)));
        for (near, ((&x, &y), &z)) in near.iter_mut().zip(x.iter().zip(y.iter()).zip(z.iter())) {
            *near |= (lo[0] <= x) & (x <= hi[0]) & (lo[1] <= y) & (y <= hi[1]) & (lo[2] <= z) & (z <= hi[2]);
        }
    }
    near
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
