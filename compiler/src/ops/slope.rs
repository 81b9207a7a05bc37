//! Sums and products of derivatives that make nothing of zeros.
//!
//! In: values of a graph, one of them a derivative. Out: new values. Most derivatives along one
//! axis are 0, and a graph of a hundred thousand values should not grow by operations on those.

use super::Op;
use crate::ir::ValueId;
use crate::ir::graph::Graph;

/// Whether a value is the constant 0.
pub(crate) fn is_zero(graph: &Graph, value: ValueId) -> bool {
    graph.constant(value) == Some(0.0)
}

/// a + b
pub(super) fn plus(graph: &mut Graph, a: ValueId, b: ValueId) -> ValueId {
    match (is_zero(graph, a), is_zero(graph, b)) {
        (true, _) => b,
        (false, true) => a,
        (false, false) => graph.add(a, b),
    }
}

/// a - b
pub(super) fn minus(graph: &mut Graph, a: ValueId, b: ValueId) -> ValueId {
    match (is_zero(graph, a), is_zero(graph, b)) {
        (true, true) | (false, true) => a,
        (true, false) => graph.apply(Op::Neg, &[b]),
        (false, false) => graph.sub(a, b),
    }
}

/// factor * d
pub(super) fn times(graph: &mut Graph, factor: ValueId, d: ValueId) -> ValueId {
    if is_zero(graph, d) { d } else { graph.mul(factor, d) }
}

/// -d
pub(super) fn negative(graph: &mut Graph, d: ValueId) -> ValueId {
    if is_zero(graph, d) { d } else { graph.apply(Op::Neg, &[d]) }
}

/// `a` if `condition` else `b`
pub(super) fn either(graph: &mut Graph, condition: ValueId, a: ValueId, b: ValueId) -> ValueId {
    if a == b { a } else { graph.select(condition, a, b) }
}

/// Divisors up to this count as not positive: quotients stay finite in f32.
const TINY: f64 = 1e-30;

/// `scale / divisor` where the divisor is positive, else 0.
pub(super) fn over_positive(graph: &mut Graph, scale: f64, divisor: ValueId) -> ValueId {
    let (zero, one, scale) = (graph.number(0.0), graph.number(1.0), graph.number(scale));
    let tiny = graph.number(TINY);
    let positive = graph.apply(Op::Less, &[tiny, divisor]);
    let safe = graph.select(positive, divisor, one);
    let quotient = graph.div(scale, safe);
    graph.select(positive, quotient, zero)
}

/// Sum of products of a gradient with the derivatives of the coordinates.
pub(super) fn along(graph: &mut Graph, gradient: &[ValueId], derivatives: &[ValueId]) -> ValueId {
    let mut sum = graph.number(0.0);
    for (&slope, &d) in gradient.iter().zip(derivatives) {
        let product = times(graph, slope, d);
        sum = plus(graph, sum, product);
    }
    sum
}
