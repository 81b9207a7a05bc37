//! Moves the spans of a tree: files that are imported lie behind the scene's own file.

use super::{Argument, Entry, Expr, ExprKind, File, Item, ItemKind, Let, Name, TypeExpr, TypeExprKind};
use crate::source::Span;

/// Moves all spans of a file towards the end by `bytes`. Recurses as deep as the tree is high, which
/// the parser limits.
pub(crate) fn shift(file: &mut File, bytes: u32) {
    file.items.iter_mut().for_each(|item| Shift(bytes).item(item));
}

#[derive(Clone, Copy)]
struct Shift(u32);

impl Shift {
    fn span(self, span: &mut Span) {
        *span = span.shifted(self.0);
    }

    fn name(self, name: &mut Name) {
        self.span(&mut name.span);
    }

    fn item(self, item: &mut Item) {
        self.span(&mut item.span);
        match &mut item.kind {
            ItemKind::Import(import) => {
                self.span(&mut import.path_span);
                self.name(&mut import.alias);
            }
            ItemKind::Param(param) => {
                self.name(&mut param.name);
                self.ty(&mut param.ty);
                self.expr(&mut param.default);
                if let Some((low, high)) = &mut param.range {
                    self.expr(low);
                    self.expr(high);
                }
            }
            ItemKind::Let(binding) => self.binding(binding),
            ItemKind::Function(function) => {
                self.name(&mut function.name);
                for param in &mut function.params {
                    self.name(&mut param.name);
                    self.ty(&mut param.ty);
                    param.default.iter_mut().for_each(|value| self.expr(value));
                }
                self.ty(&mut function.result);
                self.expr(&mut function.body);
            }
            ItemKind::Block(block) => {
                self.name(&mut block.keyword);
                block.name.iter_mut().for_each(|name| self.name(name));
                block.entries.iter_mut().for_each(|entry| self.entry(entry));
            }
        }
    }

    fn binding(self, binding: &mut Let) {
        self.name(&mut binding.name);
        self.expr(&mut binding.value);
    }

    fn entry(self, entry: &mut Entry) {
        self.name(&mut entry.key);
        self.expr(&mut entry.value);
    }

    fn arguments(self, arguments: &mut [Argument]) {
        for argument in arguments {
            argument.name.iter_mut().for_each(|name| self.name(name));
            self.expr(&mut argument.value);
        }
    }

    fn ty(self, ty: &mut TypeExpr) {
        self.span(&mut ty.span);
        match &mut ty.kind {
            TypeExprKind::Named(_) => {}
            TypeExprKind::List(element) => self.ty(element),
            TypeExprKind::Function(params, result) => {
                params.iter_mut().for_each(|param| self.ty(param));
                self.ty(result);
            }
        }
    }

    fn expr(self, expr: &mut Expr) {
        self.span(&mut expr.span);
        match &mut expr.kind {
            ExprKind::Bool(_)
            | ExprKind::Int(_)
            | ExprKind::Float(_)
            | ExprKind::Angle(_)
            | ExprKind::Color(_)
            | ExprKind::String(_)
            | ExprKind::Name(_) => {}
            ExprKind::Tuple(parts) | ExprKind::List(parts) => {
                parts.iter_mut().for_each(|part| self.expr(part));
            }
            ExprKind::NamedTuple(arguments) => self.arguments(arguments),
            ExprKind::Comprehension { variable, range, body } => {
                self.name(variable);
                self.expr(range);
                self.expr(body);
            }
            ExprKind::Range(a, b) | ExprKind::Binary(_, a, b) => {
                self.expr(a);
                self.expr(b);
            }
            ExprKind::Unary(_, inner) => self.expr(inner),
            ExprKind::If(condition, yes, no) => {
                [condition, yes, no].into_iter().for_each(|part| self.expr(part));
            }
            ExprKind::Block(lets, value) => {
                lets.iter_mut().for_each(|binding| self.binding(binding));
                self.expr(value);
            }
            ExprKind::Lambda(params, body) => {
                params.iter_mut().for_each(|param| self.name(param));
                self.expr(body);
            }
            ExprKind::Call(callee, arguments) => {
                self.expr(callee);
                self.arguments(arguments);
            }
            ExprKind::MethodCall(receiver, name, arguments) => {
                self.expr(receiver);
                self.name(name);
                self.arguments(arguments);
            }
            ExprKind::Field(of, name) => {
                self.expr(of);
                self.name(name);
            }
            ExprKind::Record(entries) => entries.iter_mut().for_each(|entry| self.entry(entry)),
            ExprKind::Iterate(iterate) => {
                self.expr(&mut iterate.count);
                iterate.state.iter_mut().chain(&mut iterate.next).for_each(|state| self.binding(state));
                iterate.condition.iter_mut().for_each(|condition| self.expr(condition));
            }
            ExprKind::Keys(keys) => {
                self.expr(&mut keys.at);
                for (place, value) in &mut keys.keys {
                    self.expr(place);
                    self.expr(value);
                }
                keys.ease.iter_mut().for_each(|ease| self.expr(ease));
            }
        }
    }
}
