//! Reach of a curve: up to what distance every point has one closest point on it only.

use super::{Arc, GAP};
use glam::DVec3;
use std::f64::consts::PI;

/// A curve in arcs.
pub(super) struct Axis<'a> {
    pub(super) arcs: &'a [Arc],
    /// Length of the whole, gaps not counted.
    pub(super) length: f64,
    pub(super) closed: bool,
}

/// A lower bound on the reach, at most `most`; see the header of `frame/tube.rs` for the method.
///
/// Pairs of arcs are searched by halves of the curve, nearest first; arcs hold where they are up to half
/// their length, so the bound is short by that much.
pub(super) fn reach(axis: &Axis<'_>, most: f64) -> f64 {
    let arcs = axis.arcs;
    let curvature = arcs.iter().map(|arc| arc.curvature).fold(0.0, f64::max);
    let (Some(last), true) = (arcs.last(), curvature < f64::INFINITY) else { return 0.0 };
    let around = if axis.closed { last.start + 2.0 * last.half } else { f64::INFINITY };
    // Never more than a gap counts.
    let apart = (PI / curvature).min(0.5 * GAP * axis.length);
    let mut search = Search { arcs, around, apart, nearest: 2.0 * most };
    let whole = search.ball(0, arcs.len());
    search.visit(whole, whole);
    (1.0 / curvature).min(0.5 * search.nearest).min(most).max(0.0)
}

struct Search<'a> {
    arcs: &'a [Arc],
    /// Length of a closed curve.
    around: f64,
    /// Points nearer than this along the curve are not compared.
    apart: f64,
    /// Smallest distance found.
    nearest: f64,
}

/// Consecutive arcs and a ball around them.
#[derive(Clone, Copy)]
struct Ball {
    from: usize,
    to: usize,
    middle: DVec3,
    radius: f64,
}

impl Search<'_> {
    fn ball(&self, from: usize, to: usize) -> Ball {
        let arcs = &self.arcs[from..to];
        let (lo, hi) = arcs.iter().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(lo, hi), arc| {
            (lo.min(arc.middle), hi.max(arc.middle))
        });
        let middle = 0.5 * (lo + hi);
        let radius = arcs.iter().map(|arc| arc.middle.distance(middle) + arc.half).fold(0.0, f64::max);
        Ball { from, to, middle, radius }
    }

    /// Largest length along the curve between a point of one and a point of the other, `a` not after `b`.
    fn separation(&self, a: &Ball, b: &Ball) -> f64 {
        let last = &self.arcs[b.to - 1];
        let forward = last.start + 2.0 * last.half - self.arcs[a.from].start;
        let (end, start) = (&self.arcs[a.to - 1], &self.arcs[b.from]);
        let backward = self.around - (start.start - end.start - 2.0 * end.half).max(0.0);
        forward.min(backward)
    }

    fn visit(&mut self, a: Ball, b: Ball) {
        let bound = a.middle.distance(b.middle) - a.radius - b.radius;
        if bound >= self.nearest || self.separation(&a, &b) < self.apart {
            return;
        }
        let single = |ball: &Ball| ball.to - ball.from == 1;
        if single(&a) && single(&b) {
            self.nearest = bound.max(0.0);
            return;
        }
        let mut pairs: Vec<(Ball, Ball)> = Vec::with_capacity(4);
        if a.from == b.from && a.to == b.to {
            let [first, second] = self.halves(&a);
            pairs.extend([(first, first), (first, second), (second, second)]);
        } else if !single(&a) && (single(&b) || a.radius >= b.radius) {
            pairs.extend(self.halves(&a).map(|half| (half, b)));
        } else {
            pairs.extend(self.halves(&b).map(|half| (a, half)));
        }
        pairs.sort_by(|x, y| gap(x).total_cmp(&gap(y)));
        pairs.into_iter().for_each(|(a, b)| self.visit(a, b));
    }

    fn halves(&self, ball: &Ball) -> [Ball; 2] {
        let middle = usize::midpoint(ball.from, ball.to);
        [self.ball(ball.from, middle), self.ball(middle, ball.to)]
    }
}

fn gap((a, b): &(Ball, Ball)) -> f64 {
    a.middle.distance(b.middle) - a.radius - b.radius
}
