//! Key-framed values: places in order, values of one type, and the way from key to key.

use super::Checker;
use super::convert::{Role, join};
use super::words::a;
use crate::ast::{Expr, ExprKind, Keys};
use crate::diag::Diagnostic;
use crate::hir::{self, Ease, ExprId};
use crate::settings::ChoiceKind;
use crate::source::Span;
use crate::ty::Type;

impl<'a> Checker<'a> {
    /// `keys(at, place: value, …, ease: …)`; the values' type comes from themselves or from outside.
    pub(super) fn keys(&mut self, keys: &'a Keys, ty: Option<(&Type, Role<'a>)>, span: Span) -> ExprId {
        let at = self.expect(&keys.at, &Type::Float, Role::Place);
        let places: Vec<Option<f64>> = keys.keys.iter().map(|(place, _)| self.place(place)).collect();
        self.check_order(keys, &places);
        let values: Vec<ExprId> = match ty {
            Some((ty, role)) => keys.keys.iter().map(|(_, value)| self.expect(value, ty, role)).collect(),
            None => keys.keys.iter().map(|(_, value)| self.infer(value)).collect(),
        };
        let ease = self.ease(keys.ease.as_ref());
        let Some(&first) = values.first() else {
            let error = Diagnostic::error("E0233", "`keys` has no key", span, "no key");
            self.report(error.with_help("write keys as `keys(time, 0s: a, 2s: b)`"));
            return self.wrong(span);
        };
        let mut common = self.ty(first).clone();
        for &value in &values {
            let found = self.ty(value).clone();
            let Some(joined) = join(&common, &found) else {
                let message = format!("the values of keys must have one type, not {common} and {found}");
                let error =
                    Diagnostic::error("E0219", message, self.span(value), format!("this is {}", a(&found)));
                let error = error.with_label(self.span(first), format!("this is {}", a(&common)));
                self.report(error.with_help(self.example(&common)));
                return self.wrong(span);
            };
            common = joined;
        }
        if common == Type::Error || places.contains(&None) {
            return self.wrong(span);
        }
        if !self.can_be_keyed(&common, first) {
            return self.wrong(span);
        }
        let values = values.iter().map(|&value| self.convert(value, &common, Role::KeyValue));
        let keys = places.into_iter().flatten().zip(values.collect::<Vec<_>>()).collect();
        self.push(hir::ExprKind::Keys(Box::new(hir::Keys { at, keys, ease })), common, span)
    }

    /// Numbers move from key to key; the layers of a style do as well.
    fn can_be_keyed(&mut self, ty: &Type, first: ExprId) -> bool {
        let is_number = ty.components().is_some() && *ty != Type::Bool;
        let is_layers = *ty == Type::list(Type::Choice(ChoiceKind::Layer));
        if !is_number && !is_layers {
            let message = format!("keys hold numbers, angles, vectors and colors, not {}", a(ty));
            let error = Diagnostic::error("E0233", message, self.span(first), format!("this is {}", a(ty)));
            self.report(error.with_help("key the numbers that it is built from"));
        }
        is_number || is_layers
    }

    /// The place of a key, which is known at compile time.
    fn place(&mut self, place: &'a Expr) -> Option<f64> {
        let value = self.expect(place, &Type::Float, Role::Place);
        if self.is_wrong(value) {
            return None;
        }
        let constant = self.constant(value);
        if constant.is_none() {
            let message = "the place of a key must be known at compile time";
            let error = Diagnostic::error("E0228", message, place.span, "not a constant");
            self.report(error.with_help("write numbers and arithmetic of them, such as `2s`"));
        }
        constant.map(|[value, ..]| value)
    }

    fn check_order(&mut self, keys: &'a Keys, places: &[Option<f64>]) {
        for (i, pair) in places.windows(2).enumerate() {
            if let [Some(before), Some(after)] = pair
                && before >= after
            {
                let (before, after) = (keys.keys[i].0.span, keys.keys[i + 1].0.span);
                let message = "the places of keys must rise from one to the next";
                let error = Diagnostic::error("E0233", message, after, "not above the one before");
                let error = error.with_label(before, "the one before");
                self.report(error.with_help("put the keys in order, each place once"));
            }
        }
    }

    fn ease(&mut self, ease: Option<&'a Expr>) -> Ease {
        let Some(expr) = ease else { return Ease::Linear };
        let word = match &expr.kind {
            ExprKind::Name(word) => ChoiceKind::Ease.words().into_iter().find(|known| known.name == word),
            _ => None,
        };
        match word.map(|word| word.name) {
            Some("smooth") => Ease::Smooth,
            Some("hold") => Ease::Hold,
            Some(_) => Ease::Linear,
            None => {
                let function = Type::function(vec![Type::Float], Type::Float);
                if let ExprKind::Name(name) = &expr.kind
                    && !self.is_known(name)
                {
                    self.choice(expr, ChoiceKind::Ease);
                    return Ease::Linear;
                }
                Ease::Curve(self.expect(expr, &function, Role::Key("ease")))
            }
        }
    }

    /// Whether a name stands for anything.
    fn is_known(&self, name: &str) -> bool {
        self.scope.find(name).is_some() || self.item_named(name).is_some() || self.builtins.contains_key(name)
    }
}
