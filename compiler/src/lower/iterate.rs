//! `iterate`: the one loop that runs when the scene does.
//!
//! In: `iterate n from (z = p, k = 0) while length(z) < 2: (z = …, k = k + 1)`. Out: a record of the last
//! state. The state becomes placeholders of the graph while the condition and the next values are
//! lowered, then [`crate::ir::graph::Graph::repeat`] cuts them out. Steps that only a run counts are
//! counted by a hidden number of the state. Loops of constants are computed here.

use super::value::Value;
use super::{Lowered, Lowerer, MAX_UNROLLED};
use crate::ir::graph::{Rate, Repeated, Slots};
use crate::ir::{MAX_STEPS, ValueId};
use crate::ops::interval::Interval;
use crate::ops::{Op, Ty};
use crate::reference;
use vol_language::diag::Diagnostic;
use vol_language::hir::Iterate;
use vol_language::source::Span;

/// Most numbers in the state of a loop, components of vectors counted each.
const MAX_NUMBERS: usize = 16;

/// Most steps that loops inside each other may take together: some devices cut off beyond it.
const MAX_NESTED_STEPS: u32 = 65_535;

/// How many components a value of the state has, and of which type.
struct Field {
    components: usize,
    ty: Ty,
}

/// Goes into a loop of so many steps; returns what [`leave`] asks for.
pub(super) fn enter(lowerer: &mut Lowerer<'_>, most: u32, span: Span) -> Lowered<u32> {
    let outer_steps = lowerer.loop_steps;
    let steps = outer_steps.saturating_mul(most.max(1));
    if steps > MAX_NESTED_STEPS {
        return Err(too_often(steps, span));
    }
    lowerer.loop_steps = steps;
    Ok(outer_steps)
}

/// Comes out of a loop.
pub(super) fn leave(lowerer: &mut Lowerer<'_>, outer_steps: u32) {
    lowerer.loop_steps = outer_steps;
}

impl Lowerer<'_> {
    /// The record of the last state.
    pub(super) fn iterate(&mut self, iterate: &Iterate, span: Span) -> Lowered<Value> {
        let count_span = self.hir.expr(iterate.count).span;
        let count = self.expr(iterate.count)?.scalar();
        let most = self.most_steps(count, count_span)?;
        let (mut fields, mut first) = (Vec::new(), Vec::new());
        for &(_, value) in &iterate.state {
            let components = self.expr(value)?.numbers().to_vec();
            let ty = components.first().map_or(Ty::Number, |&component| self.graph.ty(component));
            fields.push(Field { components: components.len(), ty });
            first.extend(components.into_iter().map(|component| self.as_number(component)));
        }
        if first.len() > MAX_NUMBERS {
            return Err(too_large(first.len(), span));
        }
        let outer_steps = enter(self, most, count_span)?;
        let last = self.repeat(iterate, count, most, &fields, first);
        leave(self, outer_steps);
        Ok(Value::Record(self.record(&fields, &last?).into()))
    }

    /// Lowers the inside of a loop and closes it; gives the numbers of the last state.
    fn repeat(
        &mut self,
        iterate: &Iterate,
        count: ValueId,
        most: u32,
        fields: &[Field],
        mut first: Vec<ValueId>,
    ) -> Lowered<Vec<ValueId>> {
        let numbers = first.len();
        let mut state: Vec<ValueId> = (0..numbers).map(|_| self.graph.placeholder()).collect();
        let values = self.record(fields, &state);
        for (&(local, _), value) in iterate.state.iter().zip(values) {
            self.environment.bind(local, value);
        }
        let mut goes_on = match iterate.condition {
            None => self.graph.boolean(true),
            Some(condition) => self.expr(condition)?.scalar(),
        };
        let mut next = Vec::with_capacity(numbers);
        for &value in &iterate.next {
            let components = self.expr(value)?.numbers().to_vec();
            next.extend(components.into_iter().map(|component| self.as_number(component)));
        }
        if self.graph.constant(count).is_none() {
            let (zero, one, half) = (self.graph.number(0.0), self.graph.number(1.0), self.graph.number(0.5));
            let counter = self.graph.placeholder();
            // Half a step away from a tie, where a bound on the counter decides.
            let end = self.graph.sub(count, half);
            let counts = self.graph.apply(Op::Less, &[counter, end]);
            goes_on = self.graph.apply(Op::And, &[counts, goes_on]);
            state.push(counter);
            first.push(zero);
            next.push(self.graph.add(counter, one));
        }
        let repeated = Repeated { state: &state, first: &first, next: &next, goes_on };
        let mut last = self.graph.repeat(most, repeated);
        let budget = u64::from(MAX_UNROLLED.saturating_sub(self.unrolled));
        if let Some((constants, cost)) = self.graph.computed(&last, budget) {
            self.unrolled += cost as u32;
            last = constants.into_iter().map(|number| self.graph.number(number)).collect();
        }
        last.truncate(numbers);
        Ok(last)
    }

    /// Bound on the steps of a loop. What a run counts is held within the range of its params.
    pub(super) fn most_steps(&mut self, count: ValueId, span: Span) -> Lowered<u32> {
        if let Some(count) = self.graph.constant(count) {
            if count > f64::from(MAX_STEPS) {
                return Err(too_many(count, span));
            }
            return Ok(count.max(0.0) as u32);
        }
        if self.graph.rate(count) != Rate::Frame {
            return Ok(MAX_STEPS);
        }
        let mut slots = Slots::default();
        slots.slot(count);
        let function = slots.frame_function(&mut self.graph, self.frame_inputs);
        let mut inputs = vec![Interval::EVERYTHING; self.frame_inputs as usize];
        for (param, &input) in self.hir.params.iter().zip(&self.param_inputs) {
            if let (Some((lo, hi)), 1) = (param.range, param.default.len()) {
                inputs[input as usize] = Interval::new(lo, hi);
            }
        }
        let bound = reference::interval(&function, &inputs, &[], &[])[0].hi;
        // Counts are whole; computed bounds are a trillionth too wide.
        Ok((bound + 1e-6).floor().clamp(0.0, f64::from(MAX_STEPS)) as u32)
    }

    /// Numbers of a state as values of the scene.
    fn record(&mut self, fields: &[Field], numbers: &[ValueId]) -> Vec<Value> {
        let zero = self.graph.number(0.0);
        let mut rest = numbers.iter();
        let mut values = Vec::with_capacity(fields.len());
        for field in fields {
            let mut components: Vec<ValueId> = rest.by_ref().take(field.components).copied().collect();
            if field.ty == Ty::Bool {
                for component in &mut components {
                    let off = self.graph.apply(Op::Equal, &[*component, zero]);
                    *component = self.graph.apply(Op::Not, &[off]);
                }
            }
            values.push(Value::Numbers(components));
        }
        values
    }

    /// Truth values become 0 and 1.
    fn as_number(&mut self, value: ValueId) -> ValueId {
        match self.graph.ty(value) {
            Ty::Number => value,
            Ty::Bool => {
                let (one, zero) = (self.graph.number(1.0), self.graph.number(0.0));
                self.graph.select(value, one, zero)
            }
        }
    }
}

fn too_many(count: f64, span: Span) -> Box<Diagnostic> {
    let message = format!("a loop takes at most {MAX_STEPS} steps");
    let diagnostic = Diagnostic::error("E0407", message, span, format!("here it is {count}"));
    Box::new(diagnostic.with_help(format!("write {MAX_STEPS} or less, and end the loop early with `while`")))
}

fn too_often(steps: u32, span: Span) -> Box<Diagnostic> {
    let message = format!("loops inside each other take at most {MAX_NESTED_STEPS} steps together");
    let diagnostic = Diagnostic::error("E0407", message, span, format!("here they may take {steps}"));
    let help = "take fewer steps, or give the param that counts them a range like `in 1..8`";
    Box::new(diagnostic.with_help(help))
}

fn too_large(numbers: usize, span: Span) -> Box<Diagnostic> {
    let message = format!("the state of a loop has at most {MAX_NUMBERS} numbers");
    let label = format!("here it has {numbers}, components of vectors counted each");
    let help = "keep only what changes from step to step, and name the rest with `let` before the loop";
    Box::new(Diagnostic::error("E0407", message, span, label).with_help(help))
}

#[cfg(test)]
mod tests;
