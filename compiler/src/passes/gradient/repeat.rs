//! Derivatives of loops: a loop over the state and its derivatives.
//!
//! ```text
//! x ← x * x + c        ──►        x  ← x * x + c
//!                                 dx ← 2 x dx + dc
//! ```
//!
//! In: a loop, the derivatives of its operands. Out: those of its results. The condition only jumps and
//! has none; derivatives that stay 0 are left out. Exact between the places where the number of steps
//! changes.

use super::{Slopes, differentiate, slope};
use crate::ir::graph::{Graph, Repeated};
use crate::ir::{Function, Inst, ValueId};
use crate::ops::{self, Op, Ty};
use rustc_hash::FxHashMap;

/// A loop on the way.
pub(super) struct Repeat<'a> {
    pub(super) most: u32,
    pub(super) body: &'a Function,
    pub(super) args: &'a [ValueId],
    pub(super) zero: ValueId,
}

impl Repeat<'_> {
    /// Derivatives of the results, by direction.
    pub(super) fn slopes(
        &self,
        graph: &mut Graph,
        known: &mut FxHashMap<ValueId, Slopes>,
        directions: usize,
    ) -> Slopes {
        let count = self.body.state();
        let (first, captured) = self.args.split_at(count);
        let depends = smooth_dependence(self.body);
        let matters = |i: usize| i < count || depends.iter().any(|inputs| inputs[i]);
        if (0..self.args.len()).any(|i| matters(i) && matches!(known.get(&self.args[i]), Some(None))) {
            return None;
        }
        let moves: Vec<Vec<bool>> = (0..directions).map(|d| self.moves(known, &depends, d)).collect();
        // Placeholders for the state and for each derivative that moves.
        let mut state: Vec<ValueId> = (0..count).map(|_| graph.placeholder()).collect();
        let slots: Vec<Vec<Option<ValueId>>> = moves
            .iter()
            .map(|moves| moves.iter().map(|&moves| moves.then(|| graph.placeholder())).collect())
            .collect();
        for i in 0..count {
            let seed = slots.iter().map(|slots| vec![slots[i].unwrap_or(self.zero)]);
            known.insert(state[i], Some(seed.collect()));
        }
        let mut next = graph.instantiate(self.body, &[&state, captured].concat());
        let goes_on = next.pop().expect("a verified body has a condition");
        differentiate(graph, &next, known, directions);
        let mut first = first.to_vec();
        let mut places = vec![vec![None; count]; directions];
        for (direction, slots) in slots.iter().enumerate() {
            for (i, slot) in slots.iter().enumerate() {
                let Some(slot) = slot else { continue };
                places[direction][i] = Some(state.len());
                state.push(*slot);
                first.push(slope(known, self.args[i], direction, self.zero)?);
                next.push(slope(known, next[i], direction, self.zero)?);
            }
        }
        if state.len() == count {
            return Some(vec![vec![self.zero; count]; directions]);
        }
        let repeated = Repeated { state: &state, first: &first, next: &next, goes_on };
        let last = graph.repeat(self.most, repeated);
        let read = |place: &Option<usize>| place.map_or(self.zero, |place| last[place]);
        Some(places.iter().map(|places| places.iter().map(read).collect()).collect())
    }

    /// Which numbers of the state have a derivative in a direction, at first or later.
    fn moves(
        &self,
        known: &FxHashMap<ValueId, Slopes>,
        depends: &[Vec<bool>],
        direction: usize,
    ) -> Vec<bool> {
        let sloped = |&arg: &ValueId| slope(known, arg, direction, self.zero) != Some(self.zero);
        let mut moves: Vec<bool> = self.args.iter().map(sloped).collect();
        loop {
            let reached = |i: usize| depends[i].iter().zip(&moves).any(|(&depends, &moves)| depends && moves);
            let found = (0..depends.len()).find(|&i| !moves[i] && reached(i));
            match found {
                Some(i) => moves[i] = true,
                None => break,
            }
        }
        moves.truncate(depends.len());
        moves
    }
}

/// For each number of the next state, on which inputs of the body its derivative depends.
fn smooth_dependence(body: &Function) -> Vec<Vec<bool>> {
    let inputs = body.inputs as usize;
    // By instruction and result.
    let mut known: Vec<Vec<Vec<bool>>> = Vec::with_capacity(body.insts.len());
    for inst in &body.insts {
        let union = |args: &[ValueId]| {
            let mut union = vec![false; inputs];
            for arg in args {
                union.iter_mut().zip(&known[arg.index()][0]).for_each(|(a, &b)| *a |= b);
            }
            union
        };
        known.push(match inst {
            Inst::Constant(_) | Inst::Boolean(_) | Inst::Uniform(_) => vec![vec![false; inputs]],
            Inst::Input(index) => vec![(0..inputs).map(|i| i == *index as usize).collect()],
            Inst::Extract(tuple, index) => {
                let results = &known[tuple.index()];
                vec![results[*index as usize].clone()]
            }
            Inst::Apply { op, args, .. } => {
                let results = ops::operation(*op).results;
                let jumps = *op == Op::Floor || results == [Ty::Bool];
                vec![if jumps { vec![false; inputs] } else { union(args) }; results.len()]
            }
            // Close enough: any result on any operand.
            Inst::Loop { body, args, .. } => vec![union(args); body.state()],
        });
    }
    body.outputs[..body.state()].iter().map(|output| known[output.index()][0].clone()).collect()
}

#[cfg(test)]
mod tests;
