//! One walk over all places of a tree.

use super::{
    Argument, Entry, Expr, ExprKind, File, FunctionParam, ItemKind, Let, Name, TypeExpr, TypeExprKind,
};
use crate::source::Span;

/// What a span is the place of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Role {
    /// The key of an entry, or the value of a block after its `let`s: a part of what braces hold
    /// begins here.
    Part,
    /// Anything else.
    Other,
}

/// Moves all spans of a file towards the end by `bytes`: files that are imported lie behind the
/// scene's own file.
pub(crate) fn shift(file: &mut File, bytes: u32) {
    each_span(file, &mut |_, span| *span = span.shifted(bytes));
}

/// Shows the spans of a tree to `visit`, which may change them. Recurses as deep as the tree is high,
/// which the parser limits.
pub(crate) fn each_span(file: &mut File, visit: &mut dyn FnMut(Role, &mut Span)) {
    let mut walk = Walk { visit };
    for item in &mut file.items {
        walk.other(&mut item.span);
        match &mut item.kind {
            ItemKind::Import(import) => {
                walk.other(&mut import.path_span);
                walk.name(&mut import.alias);
            }
            ItemKind::Param(param) => {
                walk.name(&mut param.name);
                walk.ty(&mut param.ty);
                walk.expr(&mut param.default);
                if let Some((low, high)) = &mut param.range {
                    walk.expr(low);
                    walk.expr(high);
                }
            }
            ItemKind::Let(binding) => walk.binding(binding),
            ItemKind::Function(function) => {
                walk.name(&mut function.name);
                function.params.iter_mut().for_each(|param| walk.param(param));
                walk.ty(&mut function.result);
                walk.expr(&mut function.body);
            }
            ItemKind::Block(block) => {
                walk.name(&mut block.keyword);
                block.name.iter_mut().for_each(|name| walk.name(name));
                block.entries.iter_mut().for_each(|entry| walk.entry(entry));
            }
        }
    }
}

struct Walk<'a> {
    visit: &'a mut dyn FnMut(Role, &mut Span),
}

impl Walk<'_> {
    fn other(&mut self, span: &mut Span) {
        (self.visit)(Role::Other, span);
    }

    fn name(&mut self, name: &mut Name) {
        self.other(&mut name.span);
    }

    fn names<'n>(&mut self, names: impl IntoIterator<Item = &'n mut Name>) {
        names.into_iter().for_each(|name| self.name(name));
    }

    fn ty(&mut self, ty: &mut TypeExpr) {
        self.other(&mut ty.span);
        match &mut ty.kind {
            TypeExprKind::Named(_) => {}
            TypeExprKind::List(element) => self.ty(element),
            TypeExprKind::Function(params, result) => {
                params.iter_mut().for_each(|param| self.ty(param));
                self.ty(result);
            }
        }
    }

    fn param(&mut self, param: &mut FunctionParam) {
        self.name(&mut param.name);
        self.ty(&mut param.ty);
        self.exprs(&mut param.default);
    }

    fn binding(&mut self, binding: &mut Let) {
        self.name(&mut binding.name);
        self.expr(&mut binding.value);
    }

    fn entry(&mut self, entry: &mut Entry) {
        (self.visit)(Role::Part, &mut entry.key.span);
        self.expr(&mut entry.value);
    }

    fn exprs<'e>(&mut self, exprs: impl IntoIterator<Item = &'e mut Expr>) {
        exprs.into_iter().for_each(|expr| self.expr(expr));
    }

    fn arguments(&mut self, arguments: &mut [Argument]) {
        for argument in arguments {
            self.names(&mut argument.name);
            self.expr(&mut argument.value);
        }
    }

    fn expr(&mut self, expr: &mut Expr) {
        self.other(&mut expr.span);
        match &mut expr.kind {
            ExprKind::Bool(_)
            | ExprKind::Int(_)
            | ExprKind::Float(_)
            | ExprKind::Angle(_)
            | ExprKind::Color(_)
            | ExprKind::String(_)
            | ExprKind::Name(_) => {}
            ExprKind::Tuple(parts) | ExprKind::List(parts) => self.exprs(parts),
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
            ExprKind::Unary(_, operand) => self.expr(operand),
            ExprKind::If(condition, yes, no) => {
                self.expr(condition);
                self.expr(yes);
                self.expr(no);
            }
            ExprKind::Block(bindings, value) => {
                bindings.iter_mut().for_each(|binding| self.binding(binding));
                // A copy: the value itself comes next.
                (self.visit)(Role::Part, &mut value.span.clone());
                self.expr(value);
            }
            ExprKind::Lambda(params, body) => {
                self.names(params);
                self.expr(body);
            }
            ExprKind::Call(callee, arguments) => {
                self.expr(callee);
                self.arguments(arguments);
            }
            ExprKind::MethodCall(object, name, arguments) => {
                self.expr(object);
                self.name(name);
                self.arguments(arguments);
            }
            ExprKind::Field(object, name) => {
                self.expr(object);
                self.name(name);
            }
            ExprKind::Record(entries) => entries.iter_mut().for_each(|entry| self.entry(entry)),
            ExprKind::Iterate(iterate) => {
                self.expr(&mut iterate.count);
                iterate.state.iter_mut().chain(&mut iterate.next).for_each(|state| self.binding(state));
                self.exprs(&mut iterate.condition);
            }
            ExprKind::Keys(keys) => {
                self.expr(&mut keys.at);
                for (place, value) in &mut keys.keys {
                    self.expr(place);
                    self.expr(value);
                }
                self.exprs(&mut keys.ease);
            }
        }
    }
}
