//! Params, `let`s and functions.

use crate::Generator;
use crate::expr::is_numeric;
use crate::literal::{float, int};
use crate::piece::{Coordinates, Piece};
use crate::scope::{Function, Parameter, Place, Stage, Variable};
use vol_language::ty::Type;

/// Levels of expressions in a definition.
const DEPTH: u32 = 4;

/// Types of params.
const PARAMS: [Type; 8] =
    [Type::Float, Type::Int, Type::Angle, Type::Vec3, Type::Color, Type::Bool, Type::Vec2, Type::Vec4];

impl Generator<'_> {
    /// One param, `let` or function with a name of its own.
    pub(crate) fn definition(&mut self, index: usize) {
        self.region = Coordinates::default();
        match self.source.below(7) {
            0 | 1 => self.param(index),
            2..=4 => self.binding(index),
            _ => self.function(index),
        }
    }

    fn param(&mut self, index: usize) {
        let name = format!("param{index}");
        let ty = PARAMS[self.source.below(PARAMS.len())].clone();
        let value = self.param_value(&ty);
        self.items.push(format!("param {name}: {ty} = {value}"));
        let variable = Variable { opaque: true, ..Variable::new(&name, ty, Stage::Frame) };
        self.scope.bind(variable);
    }

    /// `default`, or `default in lo..hi`
    fn param_value(&mut self, ty: &Type) -> String {
        let ranged = self.source.once_in(2);
        let (below, above) = (self.source.below(4), self.source.below(9));
        match ty {
            Type::Float if ranged => {
                // Eighths, so that sums are exact.
                let default = self.source.below(33) as f64 / 8.0 - 1.0;
                let (lo, hi) = (default - below as f64 / 8.0, default + above as f64 / 8.0);
                format!("{} in {}..{}", float(default).text, float(lo).at(9), float(hi).at(9))
            }
            Type::Int if ranged => {
                let default = self.source.below(9) as i64;
                format!("{default} in {}..{}", int(default - below as i64).at(9), default + above as i64)
            }
            Type::Angle if ranged => {
                let default = 15 * self.source.below(13);
                format!("{default}deg in {}deg..{}deg", default.saturating_sub(below), default + above)
            }
            Type::Bool => self.source.pick(&["true", "false"]).to_owned(),
            _ => self.constant_literal(ty).text,
        }
    }

    fn constant_literal(&mut self, ty: &Type) -> Piece {
        match ty {
            Type::Int => self.int_literal(),
            Type::Angle => self.angle_literal(),
            Type::Color => self.color_literal(),
            Type::Vec2 | Type::Vec3 | Type::Vec4 => {
                let count = ty.components().unwrap_or(1);
                let parts: Vec<String> = (0..count).map(|_| self.float_literal().text).collect();
                Piece::atom(format!("({})", parts.join(", ")))
            }
            _ => self.float_literal(),
        }
    }

    fn binding(&mut self, index: usize) {
        let name = format!("let{index}");
        let ty = match self.source.below(14) {
            0 | 1 => Type::Shape,
            2 => Type::Float,
            3 => Type::Int,
            4 => Type::Vec3,
            5 => Type::Curve,
            6 => Type::Material,
            7 => Type::Phase,
            8 => Type::Color,
            9 => Type::list(Type::Shape),
            10 => Type::list(Type::Float),
            11 => Type::Vec4,
            12 => Type::String,
            _ => Type::Bool,
        };
        let stage = self.source.pick(&[Stage::Constant, Stage::Frame, Stage::Frame]);
        let place = Place { solid: self.source.below(4) > 0, ..Place::new(stage, DEPTH) };
        let before = self.work;
        let value = match &ty {
            Type::List(element) => self.list(element, place),
            _ => self.value(&ty, place),
        };
        self.items.push(format!("let {name} = {}", value.text));
        let mut variable = Variable::new(&name, ty, stage);
        variable.tube = !place.solid;
        variable.work = if is_numeric(&variable.ty) { 1 } else { (self.work - before).max(1) };
        (variable.bound, variable.coordinates) = (value.bound, value.coordinates);
        self.scope.bind(variable);
    }

    fn function(&mut self, index: usize) {
        let name = format!("fun{index}");
        let result = match self.source.below(12) {
            0..=2 => Type::Float,
            3 | 4 => Type::Vec3,
            5 | 6 => Type::Shape,
            7 => Type::Color,
            8 => Type::Angle,
            9 => Type::Bool,
            10 => Type::Material,
            _ => Type::Int,
        };
        let stage = self.source.pick(&[Stage::Frame, Stage::Constant]);
        let mut params = Vec::new();
        for number in 0..self.source.below(4) {
            let parameter = self.parameter(&result, number);
            params.push(parameter);
        }
        let mut written = Vec::new();
        for parameter in &params {
            let default = if parameter.optional {
                let place = Place::new(Stage::Constant, 1);
                let value = match parameter.ty {
                    Type::Int => int(2),
                    _ => self.coerced(&parameter.ty, place),
                };
                format!(" = {}", value.text)
            } else {
                String::new()
            };
            written.push(format!("{}: {}{default}", parameter.name, parameter.ty));
        }
        let mark = self.scope.mark();
        for parameter in &params {
            let mut variable = Variable::new(&parameter.name, parameter.ty.clone(), parameter.stage);
            variable.opaque = true;
            variable.work = if is_numeric(&parameter.ty) { 1 } else { 30 };
            variable.bound = if parameter.stage == Stage::Constant { 5 } else { variable.bound };
            self.scope.bind(variable);
        }
        let before = self.work;
        let body_stage = if is_numeric(&result) { Stage::Point } else { Stage::Frame };
        let place = Place::new(stage, DEPTH).body(body_stage, mark);
        let body = self.coerced(&result, place);
        self.scope.leave(mark);
        let gap = self.source.pick(&[" ", "\n  "]);
        let parameters = written.join(", ");
        self.items.push(format!("fn {name}({parameters}) -> {result} {{{gap}{}{gap}}}", body.text));
        let work = self.work - before;
        self.functions.push(Function { name, params, result, stage, work });
    }

    /// A parameter of a function with this result. Those that make shapes change with the frame at most.
    fn parameter(&mut self, result: &Type, number: usize) -> Parameter {
        let stage = if is_numeric(result) { Stage::Point } else { Stage::Frame };
        let name = format!("{}{number}", self.source.pick(&["a", "b", "size", "amount"]));
        let plain = |ty: Type, optional: bool| (ty, stage, optional);
        let optional = number > 0 && self.source.once_in(3);
        let (ty, stage, optional) = match self.source.below(10) {
            0..=2 => plain(Type::Float, optional),
            3 | 4 => plain(Type::Vec3, optional),
            5 => plain(Type::Angle, optional),
            6 if is_numeric(result) => plain(Type::Local, false),
            6 => plain(Type::Shape, false),
            7 => (Type::Int, Stage::Constant, optional),
            8 => plain(Type::function(vec![Type::Float], Type::Float), false),
            _ if is_numeric(result) => plain(Type::Color, optional),
            _ => plain(Type::list(Type::Float), false),
        };
        Parameter { name, ty, stage, optional }
    }
}
