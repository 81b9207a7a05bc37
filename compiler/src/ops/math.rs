//! Rows of the arithmetic that every device has: sums, products, extremes, absolute value, floor.
//!
//! Example: `mul` means `a * b`, is written `({0} * {1})` and differs from the exact product by at
//! most one ulp and what the errors of its operands make of it.

use super::error::{self, decision, operand};
use super::interval::Interval;
use super::{Op, Operation, Ty, one, one_within, range, slope};
use crate::ir::ValueId;
use crate::ir::graph::Graph;

/// Operand and result types of the rows.
pub(super) const NUMBER: &[Ty] = &[Ty::Number];
pub(super) const NUMBERS: &[Ty] = &[Ty::Number; 2];
/// How the one result is read from its WGSL value.
pub(super) const WHOLE: &[&str] = &[""];

pub(super) const ADD: Operation = Operation {
    op: Op::Add,
    name: "add",
    args: NUMBERS,
    results: NUMBER,
    has_data: false,
    meaning: |x, _| one(x[0] + x[1]),
    interval: |x, _| one_within(x[0] + x[1]),
    error: |x, e, _, _| one(error::add(operand(x, e, 0), operand(x, e, 1)).error),
    derivative: |graph, _, _, _, d| Some(vec![slope::plus(graph, d[0], d[1])]),
    range: range::add,
    wgsl: "({0} + {1})",
    wgsl_extract: WHOLE,
    domain: &[(-8.0, 8.0), (-8.0, 8.0)],
};

pub(super) const SUB: Operation = Operation {
    op: Op::Sub,
    name: "sub",
    args: NUMBERS,
    results: NUMBER,
    has_data: false,
    meaning: |x, _| one(x[0] - x[1]),
    interval: |x, _| one_within(x[0] - x[1]),
    error: |x, e, _, _| one(error::sub(operand(x, e, 0), operand(x, e, 1)).error),
    derivative: |graph, _, _, _, d| Some(vec![slope::minus(graph, d[0], d[1])]),
    range: range::sub,
    wgsl: "({0} - {1})",
    wgsl_extract: WHOLE,
    domain: &[(-8.0, 8.0), (-8.0, 8.0)],
};

pub(super) const MUL: Operation = Operation {
    op: Op::Mul,
    name: "mul",
    args: NUMBERS,
    results: NUMBER,
    has_data: false,
    meaning: |x, _| one(x[0] * x[1]),
    interval: |x, _| one_within(x[0] * x[1]),
    error: |x, e, _, _| one(error::mul(operand(x, e, 0), operand(x, e, 1)).error),
    derivative: |graph, _, x, _, d| {
        let (left, right) = (slope::times(graph, x[1], d[0]), slope::times(graph, x[0], d[1]));
        Some(vec![slope::plus(graph, left, right)])
    },
    range: range::mul,
    wgsl: "({0} * {1})",
    wgsl_extract: WHOLE,
    domain: &[(-8.0, 8.0), (-8.0, 8.0)],
};

pub(super) const DIV: Operation = Operation {
    op: Op::Div,
    name: "div",
    args: NUMBERS,
    results: NUMBER,
    has_data: false,
    meaning: |x, _| one(x[0] / x[1]),
    interval: |x, _| one_within(x[0] / x[1]),
    error: |x, e, _, _| one(error::div(operand(x, e, 0), operand(x, e, 1)).error),
    derivative: |graph, _, x, result, d| {
        // (da - q db) / b
        let by_divisor = slope::times(graph, result, d[1]);
        let rise = slope::minus(graph, d[0], by_divisor);
        Some(vec![if slope::is_zero(graph, rise) { rise } else { graph.div(rise, x[1]) }])
    },
    range: range::div,
    wgsl: "({0} / {1})",
    wgsl_extract: WHOLE,
    domain: &[(-8.0, 8.0), (0.25, 8.0)],
};

pub(super) const MIN: Operation = Operation {
    op: Op::Min,
    name: "min",
    args: NUMBERS,
    results: NUMBER,
    has_data: false,
    meaning: |x, _| one(if x[0] < x[1] { x[0] } else { x[1] }),
    interval: |x, _| one_within(Interval::new(x[0].lo.min(x[1].lo), x[0].hi.min(x[1].hi))),
    error: |x, e, _, _| one(extreme_error(x[1] - x[0], e)),
    derivative: |graph, _, x, _, d| Some(vec![extreme_derivative(graph, x[0], x[1], d[0], d[1])]),
    range: range::min,
    wgsl: "select({1}, {0}, ({0} < {1}))",
    wgsl_extract: WHOLE,
    domain: &[(-8.0, 8.0), (-8.0, 8.0)],
};

pub(super) const MAX: Operation = Operation {
    op: Op::Max,
    name: "max",
    args: NUMBERS,
    results: NUMBER,
    has_data: false,
    meaning: |x, _| one(if x[0] > x[1] { x[0] } else { x[1] }),
    interval: |x, _| one_within(Interval::new(x[0].lo.max(x[1].lo), x[0].hi.max(x[1].hi))),
    error: |x, e, _, _| one(extreme_error(x[0] - x[1], e)),
    derivative: |graph, _, x, _, d| Some(vec![extreme_derivative(graph, x[1], x[0], d[0], d[1])]),
    range: range::max,
    wgsl: "select({1}, {0}, ({0} > {1}))",
    wgsl_extract: WHOLE,
    domain: &[(-8.0, 8.0), (-8.0, 8.0)],
};

pub(super) const NEG: Operation = Operation {
    op: Op::Neg,
    name: "neg",
    args: NUMBER,
    results: NUMBER,
    has_data: false,
    meaning: |x, _| one(-x[0]),
    interval: |x, _| one_within(-x[0]),
    error: |_, e, _, _| one(e[0]),
    derivative: |graph, _, _, _, d| Some(vec![slope::negative(graph, d[0])]),
    range: range::neg,
    wgsl: "(-({0}))",
    wgsl_extract: WHOLE,
    domain: &[(-8.0, 8.0)],
};

pub(super) const ABS: Operation = Operation {
    op: Op::Abs,
    name: "abs",
    args: NUMBER,
    results: NUMBER,
    has_data: false,
    meaning: |x, _| one(x[0].abs()),
    interval: |x, _| one_within(x[0].abs()),
    error: |_, e, _, _| one(e[0]),
    derivative: |graph, _, x, _, d| {
        if slope::is_zero(graph, d[0]) {
            return Some(vec![d[0]]);
        }
        let zero = graph.number(0.0);
        let negative = graph.apply(Op::Less, &[x[0], zero]);
        let mirrored = slope::negative(graph, d[0]);
        Some(vec![slope::either(graph, negative, mirrored, d[0])])
    },
    range: range::abs,
    wgsl: "abs({0})",
    wgsl_extract: WHOLE,
    domain: &[(-8.0, 8.0)],
};

pub(super) const FLOOR: Operation = Operation {
    op: Op::Floor,
    name: "floor",
    args: NUMBER,
    results: NUMBER,
    has_data: false,
    meaning: |x, _| one(x[0].floor()),
    interval: |x, _| one_within(x[0].increasing_exact(f64::floor)),
    error: |x, e, _, _| one(decision((x[0] - e[0]).floor() == (x[0] + e[0]).floor())),
    derivative: |graph, _, _, _, _| Some(vec![graph.number(0.0)]),
    range: range::floor,
    wgsl: "floor({0})",
    wgsl_extract: WHOLE,
    domain: &[(-8.0, 8.0)],
};

/// Error of an extreme: of the first operand if that wins by `lead`, of the second if it loses by
/// it, and at most the larger of both.
fn extreme_error(lead: f64, errors: &[f64]) -> f64 {
    let doubt = errors[0] + errors[1];
    if lead > doubt {
        errors[0]
    } else if -lead > doubt {
        errors[1]
    } else {
        errors[0].max(errors[1])
    }
}

/// Derivative `first` where `a < b`, else `second`.
fn extreme_derivative(graph: &mut Graph, a: ValueId, b: ValueId, first: ValueId, second: ValueId) -> ValueId {
    if first == second {
        return first;
    }
    let less = graph.apply(Op::Less, &[a, b]);
    slope::either(graph, less, first, second)
}
