//! Rows of comparisons, truth values and selection.
//!
//! Truth values are 0 and 1 in the rules. A comparison whose operands are within their errors of a
//! tie can fall either way and has an infinite error; `select` turns such doubt back into a number:
//! the distance between its two sides.

use super::error::decision;
use super::interval::Interval;
use super::math::{NUMBER, NUMBERS, WHOLE};
use super::{Op, Operation, Results, Ty, one, one_within, range, slope};
use crate::ir::ValueId;
use crate::ir::graph::Graph;

const TRUTH: &[Ty] = &[Ty::Bool];
const TRUTHS: &[Ty] = &[Ty::Bool; 2];

pub(super) const LESS: Operation = Operation {
    op: Op::Less,
    name: "less",
    args: NUMBERS,
    results: TRUTH,
    has_data: false,
    meaning: |x, _| truth(x[0] < x[1]),
    interval: |x, _| known(x[0].hi < x[1].lo, x[0].lo >= x[1].hi),
    error: comparison_error,
    derivative: flat,
    range: range::less,
    wgsl: "({0} < {1})",
    wgsl_extract: WHOLE,
    domain: &[(-8.0, 8.0), (-8.0, 8.0)],
};

pub(super) const LESS_EQUAL: Operation = Operation {
    op: Op::LessEqual,
    name: "less_equal",
    args: NUMBERS,
    results: TRUTH,
    has_data: false,
    meaning: |x, _| truth(x[0] <= x[1]),
    interval: |x, _| known(x[0].hi <= x[1].lo, x[0].lo > x[1].hi),
    error: comparison_error,
    derivative: flat,
    range: range::less_equal,
    wgsl: "({0} <= {1})",
    wgsl_extract: WHOLE,
    domain: &[(-8.0, 8.0), (-8.0, 8.0)],
};

pub(super) const EQUAL: Operation = Operation {
    op: Op::Equal,
    name: "equal",
    args: NUMBERS,
    results: TRUTH,
    has_data: false,
    meaning: |x, _| truth(x[0] == x[1]),
    interval: |x, _| {
        let apart = x[0].hi < x[1].lo || x[1].hi < x[0].lo;
        known(x[0].is_point() && x[0] == x[1], apart)
    },
    error: comparison_error,
    derivative: flat,
    range: range::equal,
    wgsl: "({0} == {1})",
    wgsl_extract: WHOLE,
    domain: &[(-8.0, 8.0), (-8.0, 8.0)],
};

pub(super) const AND: Operation = Operation {
    op: Op::And,
    name: "and",
    args: TRUTHS,
    results: TRUTH,
    has_data: false,
    meaning: |x, _| truth(x[0] != 0.0 && x[1] != 0.0),
    interval: |x, _| one_within(Interval::new(x[0].lo.min(x[1].lo), x[0].hi.min(x[1].hi))),
    error: |x, e, _, _| one(joint_error(x, e, 0.0)),
    derivative: flat,
    range: range::and,
    wgsl: "({0} & {1})",
    wgsl_extract: WHOLE,
    domain: &[(0.0, 1.0), (0.0, 1.0)],
};

pub(super) const OR: Operation = Operation {
    op: Op::Or,
    name: "or",
    args: TRUTHS,
    results: TRUTH,
    has_data: false,
    meaning: |x, _| truth(x[0] != 0.0 || x[1] != 0.0),
    interval: |x, _| one_within(Interval::new(x[0].lo.max(x[1].lo), x[0].hi.max(x[1].hi))),
    error: |x, e, _, _| one(joint_error(x, e, 1.0)),
    derivative: flat,
    range: range::or,
    wgsl: "({0} | {1})",
    wgsl_extract: WHOLE,
    domain: &[(0.0, 1.0), (0.0, 1.0)],
};

pub(super) const NOT: Operation = Operation {
    op: Op::Not,
    name: "not",
    args: TRUTH,
    results: TRUTH,
    has_data: false,
    meaning: |x, _| truth(x[0] == 0.0),
    interval: |x, _| one_within(Interval::new(1.0 - x[0].hi, 1.0 - x[0].lo)),
    error: |_, e, _, _| one(e[0]),
    derivative: flat,
    range: range::not,
    wgsl: "(!{0})",
    wgsl_extract: WHOLE,
    domain: &[(0.0, 1.0)],
};

pub(super) const SELECT: Operation = Operation {
    op: Op::Select,
    name: "select",
    args: &[Ty::Bool, Ty::Number, Ty::Number],
    results: NUMBER,
    has_data: false,
    meaning: |x, _| one(if x[0] != 0.0 { x[1] } else { x[2] }),
    interval: |x, _| {
        one_within(match (x[0].contains(1.0), x[0].contains(0.0)) {
            (true, false) => x[1],
            (false, true) => x[2],
            (true, true) | (false, false) => x[1].hull(x[2]),
        })
    },
    error: |x, e, _, _| {
        let (chosen, other) = if x[0] != 0.0 { (1, 2) } else { (2, 1) };
        let swapped = (x[chosen] - x[other]).abs() + e[other];
        one(if e[0] == 0.0 { e[chosen] } else { e[chosen].max(swapped) })
    },
    derivative: |graph, _, x, _, d| Some(vec![slope::either(graph, x[0], d[1], d[2])]),
    range: range::select,
    wgsl: "select({2}, {1}, {0})",
    wgsl_extract: WHOLE,
    domain: &[(0.0, 1.0), (-8.0, 8.0), (-8.0, 8.0)],
};

fn truth(value: bool) -> Results<f64> {
    one(f64::from(u8::from(value)))
}

/// Bounds of a truth value that is surely true, surely false, or neither.
fn known(surely: bool, never: bool) -> Results<Interval> {
    one_within(match (surely, never) {
        (true, _) => Interval::point(1.0),
        (false, true) => Interval::point(0.0),
        (false, false) => Interval::EITHER,
    })
}

fn comparison_error(x: &[f64], e: &[f64], _: &Results<f64>, _: super::Context<'_>) -> Results<f64> {
    let doubt = e[0] + e[1];
    one(decision(doubt == 0.0 || (x[0] - x[1]).abs() > doubt))
}

/// Doubt about `and` (`or`), unless an operand is surely 0 (1), which settles it.
fn joint_error(x: &[f64], e: &[f64], settles: f64) -> f64 {
    let settled = (0..2).any(|i| e[i] == 0.0 && x[i] == settles);
    if settled { 0.0 } else { e[0].max(e[1]) }
}

/// The derivative of what only ever jumps.
fn flat(graph: &mut Graph, _: u32, _: &[ValueId], _: ValueId, _: &[ValueId]) -> Option<Vec<ValueId>> {
    Some(vec![graph.number(0.0)])
}
