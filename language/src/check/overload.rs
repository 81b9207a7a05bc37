//! Calls of library functions: every form is tried, the cheapest wins.

use super::Checker;
use super::arguments::{Given, Misfit, Slot, bind};
use super::call::{Arg, Value};
use super::convert::{Role, cost};
use super::words;
use crate::ast::{ExprKind as Written, Name};
use crate::diag::Diagnostic;
use crate::hir::{Conversion, ExprId, ExprKind};
use crate::library::{BuiltinId, DefaultValue, Parameter, Signature};
use crate::source::Span;
use crate::ty::Type;

/// Most forms that a help line lists.
const MAX_FORMS: usize = 6;

/// The forms of a function, tried on arguments.
struct Trial {
    /// The cheapest form that fits.
    best: Option<(u32, BuiltinId, Vec<Given>)>,
    /// Forms whose parameters match the arguments by number and name.
    bound: Vec<(BuiltinId, Vec<Given>)>,
    misfits: Vec<(BuiltinId, Misfit)>,
}

impl<'a> Checker<'a> {
    /// A call of a library function.
    pub(super) fn call_library(
        &mut self,
        name: &'a str,
        name_span: Span,
        mut args: Vec<Arg<'a>>,
        span: Span,
    ) -> ExprId {
        // Type what can stand by itself; the rest waits for its parameter's type.
        for (i, arg) in args.iter_mut().enumerate() {
            if let Value::Written(expr) = arg.value
                && !self.is_deferred(expr)
                && !self.may_be_word(name, i, arg.name)
            {
                arg.value = Value::Typed(self.infer(expr));
            }
        }
        let Trial { best, mut bound, misfits } = self.try_forms(name, &args);
        let has_wrong = args.iter().any(|arg| matches!(arg.value, Value::Typed(id) if self.is_wrong(id)));
        if let Some((_, id, given)) = best {
            let result = &self.library.signature(id).result;
            // A wrong argument fits every form; do not guess which was meant.
            if has_wrong && bound.iter().any(|(other, _)| self.library.signature(*other).result != *result) {
                return self.wrong(span);
            }
            return self.write_call(id, &given, &args, span);
        }
        if bound.len() == 1
            && let Some((id, given)) = bound.pop()
        {
            return self.write_call(id, &given, &args, span);
        }
        let same = misfits.windows(2).all(|pair| pair[0].1 == pair[1].1);
        match misfits.into_iter().next() {
            Some((id, misfit)) if bound.is_empty() && same => {
                let signature = self.library.signature(id);
                let form = words::signature(signature);
                self.report_misfit(misfit, &args, &slots(signature), name, name_span, &form);
            }
            _ if has_wrong => {}
            _ => self.report_forms(name, name_span, &args),
        }
        self.wrong(span)
    }

    /// Whether a form of the function takes a word for this argument.
    fn may_be_word(&self, name: &str, index: usize, arg: Option<&Name>) -> bool {
        let mut forms = self.builtins.get(name).into_iter().flatten();
        forms.any(|&id| {
            let params = &self.library.signature(id).params;
            let param = match arg {
                Some(arg) => params.iter().find(|param| param.name == arg.text),
                None => params.get(index),
            };
            param.is_some_and(|param| matches!(param.ty, Type::Choice(_)))
        })
    }

    fn try_forms(&self, name: &str, args: &[Arg<'a>]) -> Trial {
        let mut trial = Trial { best: None, bound: Vec::new(), misfits: Vec::new() };
        for &id in self.builtins.get(name).into_iter().flatten() {
            let signature = self.library.signature(id);
            match bind(&slots(signature), args) {
                Err(misfit) => trial.misfits.push((id, misfit)),
                Ok(given) => {
                    let cost = self.call_cost(signature, &given, args);
                    if let Some(cost) = cost
                        && trial.best.as_ref().is_none_or(|(least, ..)| cost < *least)
                    {
                        trial.best = Some((cost, id, given.clone()));
                    }
                    trial.bound.push((id, given));
                }
            }
        }
        trial
    }

    fn call_cost(&self, signature: &Signature, given: &[Given], args: &[Arg<'a>]) -> Option<u32> {
        let mut total = 0;
        for (param, given) in signature.params.iter().zip(given) {
            total += match given {
                Given::Default => 0,
                Given::One(index) => self.arg_cost(&args[*index], &param.ty)?,
                Given::Rest(indices) => self.rest_cost(indices, args, &param.ty)?,
            };
        }
        Some(total)
    }

    fn arg_cost(&self, arg: &Arg<'a>, to: &Type) -> Option<u32> {
        match arg.value {
            Value::Typed(id) => cost(self.ty(id), to),
            Value::Written(expr) => self.deferred_cost(expr, to),
        }
    }

    fn rest_cost(&self, indices: &[usize], args: &[Arg<'a>], element: &Type) -> Option<u32> {
        if let Some(list) = self.single_list(indices, args) {
            return self.arg_cost(list, &Type::list(element.clone()));
        }
        indices.iter().map(|&index| self.arg_cost(&args[index], element)).sum()
    }

    /// The argument that is the whole list of a `rest` parameter.
    fn single_list<'s>(&self, indices: &[usize], args: &'s [Arg<'a>]) -> Option<&'s Arg<'a>> {
        let [index] = indices else { return None };
        let arg = &args[*index];
        let is_list = match arg.value {
            Value::Typed(id) => matches!(self.ty(id), Type::List(_)),
            Value::Written(expr) => matches!(expr.kind, Written::List(_) | Written::Comprehension { .. }),
        };
        is_list.then_some(arg)
    }

    /// The call with one argument per parameter; reports arguments that do not fit.
    fn write_call(&mut self, id: BuiltinId, given: &[Given], args: &[Arg<'a>], span: Span) -> ExprId {
        let signature = self.library.signature(id);
        let mut values = Vec::with_capacity(signature.params.len());
        for (param, given) in signature.params.iter().zip(given) {
            let role = Role::Argument { name: param.name, of: signature.name };
            values.push(match given {
                Given::One(index) => self.give(&args[*index], &param.ty, role),
                Given::Rest(indices) => self.rest(indices, args, &param.ty, role, span),
                Given::Default => self.default_value(param, span),
            });
        }
        let call = self.library_call(id, values);
        self.push(call, signature.result.clone(), span)
    }

    fn rest(
        &mut self,
        indices: &[usize],
        args: &[Arg<'a>],
        element: &Type,
        role: Role<'a>,
        span: Span,
    ) -> ExprId {
        let ty = Type::list(element.clone());
        if let Some(list) = self.single_list(indices, args) {
            return self.give(list, &ty, role);
        }
        let items = indices.iter().map(|&index| self.give(&args[index], element, role)).collect();
        self.push(ExprKind::List(items), ty, span)
    }

    /// What a parameter gets when the call leaves it out.
    pub(super) fn default_value(&mut self, param: &Parameter, span: Span) -> ExprId {
        if param.rest {
            return self.push(ExprKind::List(Vec::new()), Type::list(param.ty.clone()), span);
        }
        self.literal(&param.default, &param.ty, span)
    }

    fn literal(&mut self, value: &DefaultValue, ty: &Type, span: Span) -> ExprId {
        if let Type::Function(function) = ty {
            let inner = self.literal(value, &function.result, span);
            return self.push(ExprKind::Convert(Conversion::Constant, inner), ty.clone(), span);
        }
        match value {
            DefaultValue::Number(value) if ty.is_vector() => {
                let number = self.push(ExprKind::Number(*value), Type::Float, span);
                self.push(ExprKind::Convert(Conversion::Broadcast, number), ty.clone(), span)
            }
            DefaultValue::Number(value) => self.push(ExprKind::Number(*value), ty.clone(), span),
            DefaultValue::Bool(value) => self.push(ExprKind::Bool(*value), ty.clone(), span),
            DefaultValue::Word(word) => self.push(ExprKind::Choice(word, Vec::new()), ty.clone(), span),
            DefaultValue::Required => self.wrong(span),
        }
    }

    fn report_forms(&mut self, name: &str, name_span: Span, args: &[Arg<'a>]) {
        let types = args.iter().map(|arg| {
            let ty = match arg.value {
                Value::Typed(id) => self.ty(id).to_string(),
                Value::Written(expr) if matches!(expr.kind, Written::List(_)) => "[…]".to_owned(),
                Value::Written(_) => "function".to_owned(),
            };
            arg.name.map_or(ty.clone(), |name| format!("{}: {ty}", name.text))
        });
        let types = types.collect::<Vec<_>>().join(", ");
        let ids = self.builtins.get(name).map_or(&[][..], |ids| ids);
        let forms = ids
            .iter()
            .take(MAX_FORMS)
            .map(|&id| format!("`{}`", words::signature(self.library.signature(id))));
        let mut help = format!("the forms are {}", forms.collect::<Vec<_>>().join(", "));
        if ids.len() > MAX_FORMS {
            help.push_str(&format!(" and {} more", ids.len() - MAX_FORMS));
        }
        let message = format!("no form of `{name}` takes ({types})");
        let error = Diagnostic::error("E0216", message, name_span, format!("called with ({types})"));
        self.report(error.with_help(help));
    }
}

fn slots(signature: &Signature) -> Vec<Slot<'_>> {
    let slot = |param: &'_ Parameter| Slot {
        name: param.name,
        optional: param.default != DefaultValue::Required,
        rest: param.rest,
    };
    signature.params.iter().map(slot).collect()
}
