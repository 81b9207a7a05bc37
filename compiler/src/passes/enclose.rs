//! Bounds over a box of positions, as values of the graph: what a ray may meet on its next step.
//!
//! ```text
//! %0 = input 0
//! %1 = neg %0        ──►   over %0 in [%2, %3]:   %4 = neg %3,  %5 = neg %2   (%1 is in [%4, %5])
//! ```
//!
//! Every value that the result needs gets a range by the range rules of the operation table, in the
//! order of the graph. Values that do not vary with the position are their own range and cost nothing.
//! Bounds hold but for the rounding of f32.

mod repeat;

use super::gradient::varying;
use crate::ir::graph::Graph;
use crate::ir::{Function, Inst, ValueId};
use crate::ops::range::{Range, square};
use crate::ops::{self, Op, Ty};
use rustc_hash::FxHashMap;
use std::collections::HashSet;

/// Ranges of what has been enclosed, by node; several of an operation with several results.
type Ranges = FxHashMap<ValueId, Vec<Range>>;

/// Ranges of some values where inputs 0, 1 and 2 are in a box.
///
/// * returns: `None` if a value depends on the box through a curve, or through a sum of octaves whose
///   settings vary
pub(crate) fn enclose(graph: &mut Graph, values: &[ValueId], place: [Range; 3]) -> Option<Vec<Range>> {
    let mut known = Ranges::default();
    for node in varying(graph, values, &known) {
        if let Inst::Input(index) = graph.inst(node)
            && let Some(&range) = place.get(*index as usize)
        {
            known.insert(node, vec![range]);
        }
    }
    enclose_all(graph, values, &mut known)?;
    Some(values.iter().map(|&value| range(&known, value)).collect())
}

/// Adds the ranges of all that `values` need; those of inputs are known.
fn enclose_all(graph: &mut Graph, values: &[ValueId], known: &mut Ranges) -> Option<()> {
    for node in varying(graph, values, known) {
        let ranges = match graph.inst(node).clone() {
            // The state of a loop around this one.
            Inst::Constant(_) | Inst::Boolean(_) | Inst::Uniform(_) | Inst::Input(_) => continue,
            Inst::Extract(tuple, index) => vec![*known.get(&tuple)?.get(index as usize)?],
            Inst::Apply { op, data, args } => {
                let ranges: Vec<Range> = args.iter().map(|&arg| range(known, arg)).collect();
                // One number with itself; two may have the same range.
                let squared = op == Op::Mul && args[0] == args[1];
                if squared { vec![square(graph, ranges[0])] } else { apply(graph, op, data, &ranges)? }
            }
            Inst::Loop { most, body, args } => repeat::ranges(graph, known, most, &body, &args)?,
        };
        known.insert(node, ranges);
    }
    Some(())
}

/// The range of a single value; its own for what does not vary.
fn range(known: &Ranges, value: ValueId) -> Range {
    known.get(&value).map_or(Range::point(value), |ranges| ranges[0])
}

fn apply(graph: &mut Graph, op: Op, data: u32, args: &[Range]) -> Option<Vec<Range>> {
    let row = ops::operation(op);
    if !args.iter().all(|arg| arg.is_point()) {
        return (row.range)(graph, data, args);
    }
    let points: Vec<ValueId> = args.iter().map(|arg| arg.lo).collect();
    let results = match row.results.len() {
        1 => vec![graph.apply_data(op, data, &points)],
        _ => graph.apply_all(op, data, &points),
    };
    Some(results.into_iter().map(Range::point).collect())
}

/// What makes `value` jump: numbers that do, and the conditions of choices that an author wrote. Where
/// one of them may take two values ([`varies`]), slopes bound nothing. Other selections, and the ends
/// of loops, are taken to be steady.
///
/// * returns: `None` if something jumps inside a loop
pub(crate) fn jumps(graph: &mut Graph, value: ValueId, choices: &HashSet<ValueId>) -> Option<Vec<ValueId>> {
    let mut found = Vec::new();
    let mut seen = HashSet::new();
    let mut pending = vec![value];
    while let Some(node) = pending.pop() {
        if !seen.insert(node) {
            continue;
        }
        let inst = graph.inst(node).clone();
        let numbers = inst.operands().iter().copied().filter(|&operand| graph.ty(operand) == Ty::Number);
        match &inst {
            Inst::Apply { op: Op::Floor, .. } => found.push(node),
            // The number of another cell.
            Inst::Apply { op: Op::Hash, args, .. } => {
                found.extend(args.iter().map(|&arg| graph.apply(Op::Floor, &[arg])));
            }
            Inst::Loop { body, .. } if has_jumps(body) => return None,
            Inst::Apply { args, .. } if choices.contains(&node) => {
                found.extend(args.first());
                pending.extend(numbers);
            }
            Inst::Constant(_)
            | Inst::Boolean(_)
            | Inst::Input(_)
            | Inst::Uniform(_)
            | Inst::Apply { .. }
            | Inst::Extract(..)
            | Inst::Loop { .. } => pending.extend(numbers),
        }
    }
    Some(found)
}

/// Whether a range, of numbers or of truth values, holds more than one.
pub(crate) fn varies(graph: &mut Graph, range: Range) -> ValueId {
    match graph.ty(range.lo) {
        Ty::Number => graph.apply(Op::Less, &[range.lo, range.hi]),
        Ty::Bool => {
            let not_sure = graph.apply(Op::Not, &[range.lo]);
            graph.apply(Op::And, &[not_sure, range.hi])
        }
    }
}

fn jumps_itself(inst: &Inst) -> bool {
    matches!(inst, Inst::Apply { op: Op::Floor | Op::Hash, .. })
}

fn has_jumps(body: &Function) -> bool {
    let jumps =
        |inst: &Inst| jumps_itself(inst) || matches!(inst, Inst::Loop { body, .. } if has_jumps(body));
    body.insts.iter().any(jumps)
}

#[cfg(test)]
mod tests;
