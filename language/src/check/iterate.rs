//! The bounded loop: its state is typed by the first values, and its value is a record.

use super::Checker;
use super::convert::Role;
use super::words::a;
use crate::ast::{Iterate, Let};
use crate::diag::Diagnostic;
use crate::hir::{self, ExprId};
use crate::source::Span;
use crate::ty::{RecordType, Type};

/// Most names in the state of a loop.
const MAX_STATE: usize = 16;

impl<'a> Checker<'a> {
    /// `iterate count from (state) while condition: (next)`
    pub(super) fn iterate(&mut self, iterate: &'a Iterate, span: Span) -> ExprId {
        let count = self.expect(&iterate.count, &Type::Int, Role::Steps);
        self.report_repeats(iterate.state.iter().map(|state| &state.name));
        self.report_repeats(iterate.next.iter().map(|next| &next.name));
        if let Some(extra) = iterate.state.get(MAX_STATE) {
            let message = format!("the state of a loop has at most {MAX_STATE} names");
            let error = Diagnostic::error("E0236", message, extra.name.span, "one too many");
            self.report(error.with_help("join numbers to vectors"));
            return self.wrong(span);
        }
        let first: Vec<ExprId> = iterate.state.iter().map(|state| self.first_value(state, iterate)).collect();
        let types: Vec<Type> = first.iter().map(|&id| self.ty(id).clone()).collect();
        let mark = self.scope.mark();
        let mut state = Vec::with_capacity(first.len());
        for ((written, &value), ty) in iterate.state.iter().zip(&first).zip(&types) {
            state.push((self.bind(&written.name, ty.clone(), None), value));
        }
        let condition =
            iterate.condition.as_ref().map(|condition| self.expect(condition, &Type::Bool, Role::Condition));
        let next = self.next_values(iterate, &types);
        self.scope.leave(mark);
        let Some(next) = next.filter(|_| !types.contains(&Type::Error)) else { return self.wrong(span) };
        let names = iterate.state.iter().map(|state| state.name.text.clone());
        let record = RecordType { fields: names.zip(types).collect() };
        let iterate = hir::Iterate { count, state, condition, next };
        self.push(hir::ExprKind::Iterate(Box::new(iterate)), Type::Record(Box::new(record)), span)
    }

    /// The first value of a part of the state. A whole number widens to a float where the next value
    /// is not plainly whole, so that `sum = 0` can grow by `0.5`.
    fn first_value(&mut self, state: &'a Let, iterate: &'a Iterate) -> ExprId {
        let value = self.infer(&state.value);
        let ty = self.ty(value).clone();
        if ty == Type::Int && !iterate.next.iter().any(|next| is_counter(next, state)) {
            return self.convert(value, &Type::Float, Role::Internal);
        }
        if ty != Type::Error && ty.components().is_none() {
            let name = &state.name.text;
            let message = format!("the state of a loop holds numbers, vectors and colors, not {}", a(&ty));
            let label = format!("`{name}` is {}", a(&ty));
            let error = Diagnostic::error("E0236", message, state.value.span, label);
            self.report(
                error.with_help("compute it outside of the loop, or build a list with `[for i in 0..n: …]`"),
            );
            return self.wrong(state.value.span);
        }
        value
    }

    /// The next values in the order of the state; `None` if they do not match it (reported).
    fn next_values(&mut self, iterate: &'a Iterate, types: &[Type]) -> Option<Vec<ExprId>> {
        let mut values = vec![None; iterate.state.len()];
        for next in &iterate.next {
            let name = next.name.text.as_str();
            match iterate.state.iter().position(|state| state.name.text == name) {
                Some(index) => {
                    values[index] = Some(self.expect(&next.value, &types[index], Role::State(name)));
                }
                None => {
                    self.infer(&next.value);
                    self.report_unknown_state(next, iterate);
                }
            }
        }
        // A misspelt name is not missing as well.
        let all_known = iterate
            .next
            .iter()
            .all(|next| iterate.state.iter().any(|state| state.name.text == next.name.text));
        for (state, value) in iterate.state.iter().zip(&values) {
            if value.is_none() && all_known {
                let name = &state.name.text;
                let message = format!("the loop gives `{name}` no next value");
                let error =
                    Diagnostic::error("E0234", message, state.name.span, "only the first value is given");
                self.report(error.with_help(format!("add `{name} = …` behind the `:`")));
            }
        }
        values.into_iter().collect()
    }

    fn report_unknown_state(&mut self, next: &'a Let, iterate: &'a Iterate) {
        let name = &next.name.text;
        let message = format!("`{name}` is no part of the loop's state");
        let error = Diagnostic::error("E0235", message, next.name.span, "has no first value");
        let names: Vec<&str> = iterate.state.iter().map(|state| state.name.text.as_str()).collect();
        let help = match self.suggest(name, |_| names.clone()) {
            Some(near) => format!("did you mean `{near}`"),
            None => format!("add `{name} = …` behind `from`"),
        };
        self.report(error.with_help(help));
    }
}

/// Whether a part of the state only counts: `i = i + 1`.
fn is_counter(next: &Let, state: &Let) -> bool {
    use crate::ast::{BinaryOp, ExprKind};
    let is_own = |kind: &ExprKind| matches!(kind, ExprKind::Name(name) if *name == state.name.text);
    let is_whole = |kind: &ExprKind| matches!(kind, ExprKind::Int(_)) || is_own(kind);
    next.name.text == state.name.text
        && match &next.value.kind {
            ExprKind::Binary(BinaryOp::Add | BinaryOp::Subtract | BinaryOp::Multiply, a, b) => {
                is_whole(&a.kind) && is_whole(&b.kind)
            }
            kind => is_whole(kind),
        }
}
