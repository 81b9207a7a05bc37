//! Tubes that overlap themselves: loops over all feet of a point.
//!
//! By the rule `nearest` the closest point of the axis decides alone ([`super::Tube::foot`]). By the others
//! every foot does, each local minimum of the distance along the axis, with its own radius:
//!
//! * a point belongs to the tube if it is inside by one of them;
//! * `min_ratio`: its coordinates are those at the foot whose distance over the radius is least;
//! * `sum`: what a medium holds is added up over the feet by which it is inside, each with its own
//!   coordinates: the mass of crossing parts adds up (`algorithms.md` §3.1).
//!
//! A foot that flat ends cut off counts for nothing.

use super::{Foot, Tube};
use crate::ir::ValueId;
use crate::ir::graph::Repeated;
use crate::lower::{Lowered, Lowerer, iterate};
use crate::ops::Op;
use crate::program::{Caps, LEAST_RADIUS};
use vol_language::source::Span;

/// What decides where a tube overlaps itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Overlap {
    /// The closest point of the axis.
    Nearest,
    /// The least distance over the radius.
    MinRatio,
    /// All of them.
    Sum,
}

/// Most feet of a point that count; nearly all points have one or two.
const MOST_FEET: u32 = 64;

/// Feet are looked for within so many times the largest radius: farther ones are outside.
const REACH: f64 = 2.0;

/// Stands for no limit: the coordinates of open ends go on for ever.
const FAR: f64 = 1e15;

/// Added to the ratio of a foot that does not count.
const CUT_OFF: f64 = 1e6;

impl Tube {
    /// Whether media in it add up over its feet.
    pub(crate) fn adds_up(&self) -> bool {
        self.by_feet() && self.outline.overlap == Overlap::Sum
    }

    /// Whether more than the closest point decides. With one radius and ends that follow the axis the least
    /// distance is also the least ratio.
    pub(crate) fn by_feet(&self) -> bool {
        match self.outline.overlap {
            Overlap::Nearest => false,
            Overlap::MinRatio => self.varies || matches!(self.caps(), Caps::Flat | Caps::Open),
            Overlap::Sum => true,
        }
    }

    /// Runs a loop over all feet of a point: from a state and a foot to the next state.
    fn fold_feet(
        &self,
        lowerer: &mut Lowerer<'_>,
        p: [ValueId; 3],
        first: &[ValueId],
        span: Span,
        step: impl FnOnce(&mut Lowerer<'_>, &Foot, &[ValueId]) -> Lowered<Vec<ValueId>>,
    ) -> Lowered<Vec<ValueId>> {
        // Every piece has a foot or none inside and one at its start; a segment is two pieces at most.
        let most = (4 * self.curve.segments.len() + 1).min(MOST_FEET as usize) as u32;
        let outer_steps = iterate::enter(lowerer, most, span)?;
        let state: Vec<ValueId> = (0..=first.len()).map(|_| lowerer.graph.placeholder()).collect();
        let reach = self.reach(lowerer);
        let graph = &mut lowerer.graph;
        let (zero, closed) = (graph.number(0.0), graph.number(f64::from(u8::from(self.curve.closed))));
        let [x, y, z] = p;
        let found = graph.apply_all(Op::Foot, self.index, &[x, y, z, state[0], reach, closed]);
        let exists = graph.apply(Op::LessEqual, &[found[5], reach]);
        let (number, at) = (found[0], [found[1], found[2], found[3], found[4], found[5], found[6], found[7]]);
        let foot = self.foot_of(lowerer, at)?;
        let next = step(lowerer, &foot, &state[1..]);
        iterate::leave(lowerer, outer_steps);
        let next = [&[number], &next?[..]].concat();
        let first = [&[zero], first].concat();
        let last = lowerer
            .graph
            .repeat(most, Repeated { state: &state, first: &first, next: &next, goes_on: exists });
        Ok(last[1..].to_vec())
    }

    /// How far from the axis feet count.
    fn reach(&self, lowerer: &mut Lowerer<'_>) -> ValueId {
        let graph = &mut lowerer.graph;
        match &self.sizes {
            Some(sizes) if self.caps() != Caps::Open => {
                let times = graph.number(REACH);
                let least = graph.number(REACH * LEAST_RADIUS);
                let reach = graph.mul(times, sizes.largest);
                graph.max(reach, least)
            }
            Some(_) | None => graph.number(FAR),
        }
    }

    /// Signed distance to the nearest wall of the parts at all feet: its sign is right, and outside it is
    /// at most the largest radius.
    pub(super) fn distance_by_feet(&self, lowerer: &mut Lowerer<'_>, p: [ValueId; 3]) -> Lowered<ValueId> {
        let reach = self.reach(lowerer);
        let half = lowerer.graph.number(1.0 / REACH);
        let far = lowerer.graph.mul(half, reach);
        let nearest = self.fold_feet(lowerer, p, &[far], Span::default(), |lowerer, foot, state| {
            let beyond = self.beyond(&mut lowerer.graph, foot);
            Ok(vec![lowerer.graph.min(state[0], beyond)])
        })?;
        Ok(nearest[0])
    }

    /// The foot whose distance over the radius is least, for points that have one within reach.
    pub(super) fn foot_by_ratio(&self, lowerer: &mut Lowerer<'_>, p: [ValueId; 3]) -> Lowered<Foot> {
        let reach = self.reach(lowerer);
        let graph = &mut lowerer.graph;
        let (zero, one, most) = (graph.number(0.0), graph.number(1.0), graph.number(1e30));
        let first = [most, zero, zero, zero, zero, reach, zero, one];
        let last = self.fold_feet(lowerer, p, &first, Span::default(), |lowerer, foot, state| {
            let graph = &mut lowerer.graph;
            let off = self.off(graph, foot);
            let mut ratio = graph.div(off, foot.radius);
            if self.caps() == Caps::Flat {
                let (zero, cut_off) = (graph.number(0.0), graph.number(CUT_OFF));
                let beyond = graph.apply(Op::Less, &[zero, foot.overshoot]);
                let farther = graph.add(ratio, cut_off);
                ratio = graph.select(beyond, farther, ratio);
            }
            let wins = graph.apply(Op::Less, &[ratio, state[0]]);
            let found = [
                ratio,
                foot.even_t,
                foot.arc_length,
                foot.x,
                foot.y,
                foot.distance,
                foot.overshoot,
                foot.curvature_factor,
            ];
            Ok(found.iter().zip(state).map(|(&new, &old)| graph.select(wins, new, old)).collect())
        })?;
        let [_, t, arc_length, x, y, distance, overshoot, stretch] = last[..] else {
            unreachable!("the state has eight numbers")
        };
        self.foot_of(lowerer, [t, arc_length, x, y, distance, overshoot, stretch])
    }

    /// Numbers added up over all feet by which a point is inside; while they are lowered, the coordinates
    /// of the tube are those at the foot.
    pub(crate) fn sum_by_feet(
        &self,
        lowerer: &mut Lowerer<'_>,
        p: [ValueId; 3],
        count: usize,
        span: Span,
        numbers: impl FnOnce(&mut Lowerer<'_>) -> Lowered<Vec<ValueId>>,
    ) -> Lowered<Vec<ValueId>> {
        let zero = lowerer.graph.number(0.0);
        self.fold_feet(lowerer, p, &vec![zero; count], span, |lowerer, foot, state| {
            let beyond = self.beyond(&mut lowerer.graph, foot);
            lowerer.feet.push((self.index, *foot));
            let numbers = numbers(lowerer);
            lowerer.feet.pop();
            let graph = &mut lowerer.graph;
            let inside = graph.apply(Op::Less, &[beyond, zero]);
            let added = numbers?.into_iter().zip(state).map(|(number, &sum)| {
                let part = graph.select(inside, number, zero);
                graph.add(sum, part)
            });
            Ok(added.collect())
        })
    }
}
