//! Interval rules as values of a graph: bounds that the runtimes compute, for the piece of a ray at hand.
//!
//! In: ranges that contain the operands. Out: a range that contains the result, as values of the same
//! graph, so that both backends compute it like anything else. Example: over `x` in `[lo, hi]` the range
//! of `-x` is two new values, `-hi` and `-lo`.
//!
//! [`super::interval`] proves things on the host, in f64 and rounded outward. Here nothing is rounded
//! outward: ends are off by as much as f32 arithmetic is, and users leave that much room. Ends are held
//! within ± [`LARGEST`], so that nothing overflows.

use super::Op;
use crate::ir::ValueId;
use crate::ir::graph::Graph;
use std::f64::consts::PI;

/// "Anything": the product of two is finite in f32.
pub(crate) const LARGEST: f64 = 1e18;

/// All numbers from `lo` to `hi`. Of truth values, whether it is surely true and whether it may be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Range {
    pub(crate) lo: ValueId,
    pub(crate) hi: ValueId,
}

/// Ranges of the results from those of the operands and the data; `None` where there is no rule.
pub(crate) type RangeRule = fn(&mut Graph, u32, &[Range]) -> Option<Vec<Range>>;

/// The range of an operation with one result.
fn one(lo: ValueId, hi: ValueId) -> Option<Vec<Range>> {
    Some(vec![Range { lo, hi }])
}

impl Range {
    /// One number.
    pub(crate) fn point(value: ValueId) -> Self {
        Self { lo: value, hi: value }
    }

    /// As far to either side of 0.
    pub(crate) fn symmetric(graph: &mut Graph, reach: ValueId) -> Self {
        Self { lo: graph.apply(Op::Neg, &[reach]), hi: reach }
    }

    /// Whether it is one number.
    pub(crate) fn is_point(self) -> bool {
        self.lo == self.hi
    }

    /// From one constant to another.
    pub(super) fn constant(graph: &mut Graph, lo: f64, hi: f64) -> Self {
        Self { lo: graph.number(lo), hi: graph.number(hi) }
    }

    /// The largest absolute value.
    pub(crate) fn magnitude(self, graph: &mut Graph) -> ValueId {
        let [lo, hi] = [self.lo, self.hi].map(|end| graph.apply(Op::Abs, &[end]));
        graph.max(lo, hi)
    }

    /// The smallest range with all of some values, held within ± [`LARGEST`].
    fn hull(graph: &mut Graph, values: &[ValueId]) -> Self {
        let mut lo = graph.number(LARGEST);
        let mut hi = graph.number(-LARGEST);
        for &value in values {
            (lo, hi) = (graph.min(value, lo), graph.max(value, hi));
        }
        let (least, most) = (graph.number(-LARGEST), graph.number(LARGEST));
        Self { lo: graph.max(lo, least), hi: graph.min(hi, most) }
    }
}

/// No rule.
pub(super) fn unknown(_: &mut Graph, _: u32, _: &[Range]) -> Option<Vec<Range>> {
    None
}

/// a + b
pub(super) fn add(graph: &mut Graph, _: u32, x: &[Range]) -> Option<Vec<Range>> {
    one(graph.add(x[0].lo, x[1].lo), graph.add(x[0].hi, x[1].hi))
}

/// a - b
pub(super) fn sub(graph: &mut Graph, _: u32, x: &[Range]) -> Option<Vec<Range>> {
    one(graph.sub(x[0].lo, x[1].hi), graph.sub(x[0].hi, x[1].lo))
}

/// a * b
pub(super) fn mul(graph: &mut Graph, _: u32, x: &[Range]) -> Option<Vec<Range>> {
    Some(vec![product(graph, x[0], x[1])])
}

/// The products of two ranges.
pub(super) fn product(graph: &mut Graph, a: Range, b: Range) -> Range {
    for (point, other) in [(a, b), (b, a)] {
        if let Some(factor) = graph.constant(point.lo).filter(|_| point.is_point()) {
            let ends = [other.lo, other.hi].map(|end| graph.mul(point.lo, end));
            return if factor < 0.0 {
                Range { lo: ends[1], hi: ends[0] }
            } else {
                Range { lo: ends[0], hi: ends[1] }
            };
        }
    }
    let mut corners = Vec::with_capacity(4);
    for end in ends(a) {
        corners.extend(ends(b).into_iter().map(|other| graph.mul(end, other)));
    }
    Range::hull(graph, &corners)
}

/// The ends of a range, once each.
fn ends(range: Range) -> Vec<ValueId> {
    if range.is_point() { vec![range.lo] } else { vec![range.lo, range.hi] }
}

/// The products of numbers with themselves, which are not negative.
pub(crate) fn square(graph: &mut Graph, a: Range) -> Range {
    let size = absolute(graph, a);
    let most = graph.number(LARGEST);
    let (lo, hi) = (graph.mul(size.lo, size.lo), graph.mul(size.hi, size.hi));
    Range { lo: graph.min(lo, most), hi: graph.min(hi, most) }
}

fn absolute(graph: &mut Graph, a: Range) -> Range {
    let zero = graph.number(0.0);
    let (below, above) = (graph.apply(Op::Neg, &[a.hi]), a.lo);
    let nearest = graph.max(above, below);
    Range { lo: graph.max(nearest, zero), hi: a.magnitude(graph) }
}

/// a / b: anything where a divisor may be 0.
pub(super) fn div(graph: &mut Graph, _: u32, x: &[Range]) -> Option<Vec<Range>> {
    let (a, b) = (x[0], x[1]);
    let divides = |graph: &Graph| graph.constant(b.lo).is_some_and(|b| b.abs() > 1.0 / LARGEST);
    if b.is_point() && divides(graph) {
        let quotients: Vec<ValueId> = ends(a).into_iter().map(|end| graph.div(end, b.lo)).collect();
        return Some(vec![Range::hull(graph, &quotients)]);
    }
    let (least, one_) = (graph.number(1.0 / LARGEST), graph.number(1.0));
    let minus = graph.number(-1.0 / LARGEST);
    let positive = graph.apply(Op::Less, &[least, b.lo]);
    let negative = graph.apply(Op::Less, &[b.hi, minus]);
    let sure = graph.apply(Op::Or, &[positive, negative]);
    let safe = Range { lo: graph.select(sure, b.lo, one_), hi: graph.select(sure, b.hi, one_) };
    let mut quotients = Vec::with_capacity(4);
    for end in ends(a) {
        quotients.extend(ends(safe).into_iter().map(|divisor| graph.div(end, divisor)));
    }
    let found = Range::hull(graph, &quotients);
    let all = Range::constant(graph, -LARGEST, LARGEST);
    one(graph.select(sure, found.lo, all.lo), graph.select(sure, found.hi, all.hi))
}

/// The smaller.
pub(super) fn min(graph: &mut Graph, _: u32, x: &[Range]) -> Option<Vec<Range>> {
    one(graph.min(x[0].lo, x[1].lo), graph.min(x[0].hi, x[1].hi))
}

/// The larger.
pub(super) fn max(graph: &mut Graph, _: u32, x: &[Range]) -> Option<Vec<Range>> {
    one(graph.max(x[0].lo, x[1].lo), graph.max(x[0].hi, x[1].hi))
}

/// -a
pub(super) fn neg(graph: &mut Graph, _: u32, x: &[Range]) -> Option<Vec<Range>> {
    one(graph.apply(Op::Neg, &[x[0].hi]), graph.apply(Op::Neg, &[x[0].lo]))
}

/// |a|
pub(super) fn abs(graph: &mut Graph, _: u32, x: &[Range]) -> Option<Vec<Range>> {
    Some(vec![absolute(graph, x[0])])
}

/// Of a function that never falls and is nowhere above [`LARGEST`].
fn increasing(graph: &mut Graph, op: Op, x: Range) -> Option<Vec<Range>> {
    one(graph.apply(op, &[x.lo]), graph.apply(op, &[x.hi]))
}

/// The largest whole numbers not above.
pub(super) fn floor(graph: &mut Graph, _: u32, x: &[Range]) -> Option<Vec<Range>> {
    increasing(graph, Op::Floor, x[0])
}

/// Square roots.
pub(super) fn sqrt(graph: &mut Graph, _: u32, x: &[Range]) -> Option<Vec<Range>> {
    increasing(graph, Op::Sqrt, x[0])
}

/// Logarithms.
pub(super) fn log2(graph: &mut Graph, _: u32, x: &[Range]) -> Option<Vec<Range>> {
    increasing(graph, Op::Log2, x[0])
}

/// Powers of 2.
pub(super) fn exp2(graph: &mut Graph, _: u32, x: &[Range]) -> Option<Vec<Range>> {
    let most = graph.number(LARGEST.log2());
    let [lo, hi] = [x[0].lo, x[0].hi].map(|end| graph.min(end, most));
    increasing(graph, Op::Exp2, Range { lo, hi })
}

/// Arc cosines.
pub(super) fn acos(graph: &mut Graph, _: u32, x: &[Range]) -> Option<Vec<Range>> {
    increasing(graph, Op::Acos, Range { lo: x[0].hi, hi: x[0].lo })
}

/// Sines and cosines: anything from -1 to 1, like noise.
pub(super) fn wave(graph: &mut Graph, _: u32, _: &[Range]) -> Option<Vec<Range>> {
    Some(vec![Range::constant(graph, -1.0, 1.0)])
}

/// Angles: anything for a box that touches the cut along the negative x axis.
pub(super) fn atan2(graph: &mut Graph, _: u32, x: &[Range]) -> Option<Vec<Range>> {
    let zero = graph.number(0.0);
    let (y, x) = (x[0], x[1]);
    let right = graph.apply(Op::Less, &[zero, x.lo]);
    let above = graph.apply(Op::Less, &[zero, y.lo]);
    let below = graph.apply(Op::Less, &[y.hi, zero]);
    let beside = graph.apply(Op::Or, &[above, below]);
    let sure = graph.apply(Op::Or, &[right, beside]);
    let mut corners = Vec::with_capacity(4);
    for y in ends(y) {
        corners.extend(ends(x).into_iter().map(|x| graph.apply(Op::Atan2, &[y, x])));
    }
    let found = Range::hull(graph, &corners);
    let all = Range::constant(graph, -PI, PI);
    one(graph.select(sure, found.lo, all.lo), graph.select(sure, found.hi, all.hi))
}

/// a < b
pub(super) fn less(graph: &mut Graph, _: u32, x: &[Range]) -> Option<Vec<Range>> {
    one(graph.apply(Op::Less, &[x[0].hi, x[1].lo]), graph.apply(Op::Less, &[x[0].lo, x[1].hi]))
}

/// a <= b
pub(super) fn less_equal(graph: &mut Graph, _: u32, x: &[Range]) -> Option<Vec<Range>> {
    one(graph.apply(Op::LessEqual, &[x[0].hi, x[1].lo]), graph.apply(Op::LessEqual, &[x[0].lo, x[1].hi]))
}

/// a == b
pub(super) fn equal(graph: &mut Graph, _: u32, x: &[Range]) -> Option<Vec<Range>> {
    let (a, b) = (x[0], x[1]);
    let below = graph.apply(Op::LessEqual, &[a.lo, b.hi]);
    let above = graph.apply(Op::LessEqual, &[b.lo, a.hi]);
    let may = graph.apply(Op::And, &[below, above]);
    // Surely if all four ends are one number.
    let first = graph.apply(Op::LessEqual, &[a.hi, b.lo]);
    let second = graph.apply(Op::LessEqual, &[b.hi, a.lo]);
    one(graph.apply(Op::And, &[first, second]), may)
}

/// Both.
pub(super) fn and(graph: &mut Graph, _: u32, x: &[Range]) -> Option<Vec<Range>> {
    one(graph.apply(Op::And, &[x[0].lo, x[1].lo]), graph.apply(Op::And, &[x[0].hi, x[1].hi]))
}

/// Either.
pub(super) fn or(graph: &mut Graph, _: u32, x: &[Range]) -> Option<Vec<Range>> {
    one(graph.apply(Op::Or, &[x[0].lo, x[1].lo]), graph.apply(Op::Or, &[x[0].hi, x[1].hi]))
}

/// The opposite.
pub(super) fn not(graph: &mut Graph, _: u32, x: &[Range]) -> Option<Vec<Range>> {
    one(graph.apply(Op::Not, &[x[0].hi]), graph.apply(Op::Not, &[x[0].lo]))
}

/// One of two, or both where the condition is not sure.
pub(super) fn select(graph: &mut Graph, _: u32, x: &[Range]) -> Option<Vec<Range>> {
    let (condition, a, b) = (x[0], x[1], x[2]);
    let (low, high) = (graph.min(a.lo, b.lo), graph.max(a.hi, b.hi));
    let mut pick = |first: ValueId, both: ValueId, second: ValueId| {
        let unsure = graph.select(condition.hi, both, second);
        graph.select(condition.lo, first, unsure)
    };
    one(pick(a.lo, low, b.lo), pick(a.hi, high, b.hi))
}
