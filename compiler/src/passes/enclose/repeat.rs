//! Bounds of loops: a loop over the ends of ranges.
//!
//! ```text
//! while c(x): x ← f(x)       ──►       while c may hold on [lo, hi]:
//!                                          unless it surely does, [lo, hi] joins what has ended
//!                                          [lo, hi] ← the range of f over [lo, hi]
//! ```
//!
//! The result is what has ended together with what is left: every place of the box stops somewhere.

use super::{Ranges, enclose_all, range};
use crate::ir::graph::{Graph, Repeated};
use crate::ir::{Function, ValueId};
use crate::ops::range::{LARGEST, Range};

/// Ranges of the last state, one for each number.
pub(super) fn ranges(
    graph: &mut Graph,
    known: &mut Ranges,
    most: u32,
    body: &Function,
    args: &[ValueId],
) -> Option<Vec<Range>> {
    let count = body.state();
    let (first, captured) = args.split_at(count);
    let mut placeholders = || -> Vec<ValueId> { (0..count).map(|_| graph.placeholder()).collect() };
    let [state, lo, hi, ended_lo, ended_hi] = [(); 5].map(|()| placeholders());
    for i in 0..count {
        known.insert(state[i], vec![Range { lo: lo[i], hi: hi[i] }]);
    }
    let mut next = graph.instantiate(body, &[&state, captured].concat());
    enclose_all(graph, &next, known)?;
    let goes_on = range(known, next.pop()?);
    // What has ended: the hull of the states at which it may have.
    let mut joined = [Vec::with_capacity(count), Vec::with_capacity(count)];
    for i in 0..count {
        let (low, high) = (graph.min(lo[i], ended_lo[i]), graph.max(hi[i], ended_hi[i]));
        joined[0].push(graph.select(goes_on.lo, ended_lo[i], low));
        joined[1].push(graph.select(goes_on.lo, ended_hi[i], high));
    }
    let (least, largest) = (graph.number(-LARGEST), graph.number(LARGEST));
    let next: Vec<Range> = next.iter().map(|&value| range(known, value)).collect();
    let next_lo: Vec<ValueId> = next.iter().map(|range| graph.max(range.lo, least)).collect();
    let next_hi: Vec<ValueId> = next.iter().map(|range| graph.min(range.hi, largest)).collect();
    let first: Vec<Range> = first.iter().map(|&value| range(known, value)).collect();
    let first_lo: Vec<ValueId> = first.iter().map(|range| range.lo).collect();
    let first_hi: Vec<ValueId> = first.iter().map(|range| range.hi).collect();
    let repeated = Repeated {
        state: &[&*lo, &hi, &ended_lo, &ended_hi].concat(),
        first: &[first_lo, first_hi, vec![largest; count], vec![least; count]].concat(),
        next: &[&*next_lo, &next_hi, &joined[0], &joined[1]].concat(),
        goes_on: goes_on.hi,
    };
    let last = graph.repeat(most, repeated);
    let end = |i: usize| Range {
        lo: graph.min(last[i], last[2 * count + i]),
        hi: graph.max(last[count + i], last[3 * count + i]),
    };
    Some((0..count).map(end).collect())
}
