//! Loops in a graph: built around placeholders, closed by cutting out the body.
//!
//! In: for each number of the state a placeholder, its first value and the next one, an expression of
//! the placeholders. Out: the values of the last state. What the next state needs and does not depend
//! on a placeholder is computed once, before the loop, at its own rate:
//!
//! ```text
//! let x = graph.placeholder();                 %4 = loop 8 %1 %3 {
//! let next = x * x + sin(time);        ──►       %0 = input 0        the state x
//! let goes_on = x < 2;                           %1 = input 1        sin(time)
//! graph.repeat(8, &[x], …)                       …
//! ```
//!
//! A placeholder varies from point to point, so nothing that depends on it is moved elsewhere. The
//! states of an outer loop are to an inner one like any other value.

use super::{Graph, Rate, cut};
use crate::ir::{Function, Inst, ValueId};
use crate::ops::Ty;
use std::collections::{HashMap, HashSet};
use std::sync::Arc;

/// Placeholders are inputs from here on.
const FIRST_PLACEHOLDER: u32 = 1 << 31;

/// The state of a loop that is being built.
#[derive(Clone, Copy, Debug)]
pub struct Repeated<'a> {
    /// A placeholder for each number, made for this loop.
    pub state: &'a [ValueId],
    /// What they are at first.
    pub first: &'a [ValueId],
    /// What they become.
    pub next: &'a [ValueId],
    /// Whether they do, a truth value.
    pub goes_on: ValueId,
}

impl Graph {
    /// A number that stands for one of the state of a loop, until [`Graph::repeat`] closes it.
    pub fn placeholder(&mut self) -> ValueId {
        self.placeholders += 1;
        self.push(Inst::Input(FIRST_PLACEHOLDER + self.placeholders))
    }

    /// The last state of a loop of at most `most` steps: before each, `goes_on` is asked of the state at
    /// hand.
    pub fn repeat(&mut self, most: u32, repeated: Repeated<'_>) -> Vec<ValueId> {
        if most == 0 || self.constant(repeated.goes_on) == Some(0.0) {
            return repeated.first.to_vec();
        }
        let (body, captured) = body(self, &repeated);
        let args = [repeated.first, &captured].concat();
        let state = repeated.state.len() as u32;
        let tuple = self.push(Inst::Loop { most, body: Arc::new(body), args });
        (0..state).map(|i| self.push(Inst::Extract(tuple, i))).collect()
    }

    /// The numbers behind the last state of a loop of constants, and what computing them cost in
    /// instructions; nothing if it would cost more than `budget` or a number is not finite.
    #[must_use]
    pub fn computed(&self, last: &[ValueId], budget: u64) -> Option<(Vec<f64>, u64)> {
        let Inst::Extract(tuple, _) = self.inst(*last.first()?) else { return None };
        let Inst::Loop { body, args, .. } = self.inst(*tuple) else { return None };
        let cost = cost(self.inst(*tuple));
        if self.rate(*tuple) != Rate::Constant || cost > budget {
            return None;
        }
        let first: Vec<f64> = args.iter().map(|&arg| self.constant(arg)).collect::<Option<_>>()?;
        let mut function = Function { inputs: args.len() as u32, ..Function::default() };
        function.insts.extend((0..function.inputs).map(Inst::Input));
        let mut inputs = (0..).map(ValueId);
        function.insts.push(self.inst(*tuple).map_operands(|_| inputs.next().unwrap_or(ValueId(0))));
        for index in 0..body.state() as u32 {
            function.outputs.push(ValueId(function.insts.len() as u32));
            function.insts.push(Inst::Extract(ValueId(function.inputs), index));
        }
        let numbers = crate::reference::evaluate(&function, &first, &[], &[]);
        numbers.iter().all(|number| number.is_finite()).then_some((numbers, cost))
    }

    /// The outputs of a loop's body for values in place of its inputs.
    pub(crate) fn instantiate(&mut self, body: &Function, inputs: &[ValueId]) -> Vec<ValueId> {
        let mut values: Vec<ValueId> = Vec::with_capacity(body.insts.len());
        for inst in &body.insts {
            let inst = inst.map_operands(|v| values[v.index()]);
            values.push(match inst {
                Inst::Input(index) => inputs[index as usize],
                Inst::Apply { op, data, args } if crate::ops::operation(op).results.len() == 1 => {
                    self.apply_data(op, data, &args)
                }
                Inst::Constant(_)
                | Inst::Boolean(_)
                | Inst::Uniform(_)
                | Inst::Apply { .. }
                | Inst::Extract(..)
                | Inst::Loop { .. } => self.push(inst),
            });
        }
        body.outputs.iter().map(|output| values[output.index()]).collect()
    }
}

/// Instructions that are computed, each step of a loop counted.
fn cost(inst: &Inst) -> u64 {
    match inst {
        Inst::Constant(_)
        | Inst::Boolean(_)
        | Inst::Input(_)
        | Inst::Uniform(_)
        | Inst::Apply { .. }
        | Inst::Extract(..) => 1,
        Inst::Loop { most, body, .. } => {
            let step = body.insts.iter().map(cost).fold(1, u64::saturating_add);
            u64::from(*most).saturating_mul(step)
        }
    }
}

/// The body, and the values that it reads beside the state, in the order of its inputs.
fn body(graph: &Graph, repeated: &Repeated<'_>) -> (Function, Vec<ValueId>) {
    let outputs = [repeated.next, &[repeated.goes_on]].concat();
    let changing = changing(graph, repeated.state, &outputs);
    let states: HashMap<ValueId, u32> = repeated.state.iter().copied().zip(0..).collect();
    let mut captured: Vec<ValueId> = Vec::new();
    let leaf = |value: ValueId| {
        if let Some(&index) = states.get(&value) {
            return Some(Inst::Input(index));
        }
        let copied = changing.contains(&value)
            || graph.constant(value).is_some()
            || graph.ty(value) == Ty::Bool
            || graph.inst(value).parts().is_some();
        (!copied).then(|| {
            captured.push(value);
            Inst::Input((states.len() + captured.len() - 1) as u32)
        })
    };
    let (mut body, _) = cut(graph, "", 0, &outputs, leaf);
    body.inputs = (states.len() + captured.len()) as u32;
    (body, captured)
}

/// What `outputs` need and depends on the state.
fn changing(graph: &Graph, state: &[ValueId], outputs: &[ValueId]) -> HashSet<ValueId> {
    // Operands are earlier: what stands before the placeholders does not depend on them.
    let Some(&first) = state.iter().min() else { return HashSet::new() };
    let mut needed = HashSet::new();
    let mut pending = outputs.to_vec();
    while let Some(value) = pending.pop() {
        if value >= first && needed.insert(value) {
            pending.extend_from_slice(graph.inst(value).operands());
        }
    }
    let mut order: Vec<ValueId> = needed.into_iter().collect();
    order.sort_unstable();
    let mut changing: HashSet<ValueId> = state.iter().copied().collect();
    for value in order {
        if graph.inst(value).operands().iter().any(|operand| changing.contains(operand)) {
            changing.insert(value);
        }
    }
    changing
}

#[cfg(test)]
mod tests;
