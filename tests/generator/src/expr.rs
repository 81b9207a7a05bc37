//! Expressions of a wanted type.

use crate::Generator;
use crate::literal::MOST;
use crate::piece::{Piece, level};
use crate::scope::{Place, Stage, Variable};
use vol_language::hir::LocalField;
use vol_language::ty::{FunctionType, Type};

/// Names of local bindings; few, so that they hide each other, and one that the library has, too.
const NAMES: [&str; 9] = ["x", "y", "p", "t", "v", "q", "k", "n", "scale"];

/// Most elements of a list.
const MAX_LENGTH: i64 = 5;

/// Whether values are made of numbers, so that they may be chosen while the scene runs.
pub(crate) fn is_numeric(ty: &Type) -> bool {
    ty.components().is_some()
}

impl Generator<'_> {
    /// An expression of exactly this type.
    pub(crate) fn value(&mut self, ty: &Type, place: Place) -> Piece {
        self.spend(1);
        let place = if is_numeric(ty) || matches!(ty, Type::Local | Type::Function(_) | Type::List(_)) {
            place
        } else {
            place.at(Stage::Frame)
        };
        if let Type::Function(function) = ty {
            return self.function_value(function, place);
        }
        if place.depth == 0 || self.is_spent() || *ty == Type::Local {
            return self.leaf(ty, place);
        }
        let inner = place.deeper();
        // What the compiler must know is made of whole numbers and their operators.
        let known = *ty == Type::Int && place.stage == Stage::Constant;
        let made = match self.source.below(18) {
            0..=3 => None,
            16 if is_numeric(ty) && !known => self.iterate(ty, inner),
            17 if is_numeric(ty) && *ty != Type::Bool && *ty != Type::Int => Some(self.keys(ty, inner)),
            4 => Some(self.choice(ty, inner)),
            5 => Some(self.block(ty, inner)),
            6 => self.part(ty, inner),
            _ if known => self.operator(ty, inner),
            7 | 8 => self.user_call(ty, inner),
            9..=11 => self.operator(ty, inner),
            _ => self.library_call(ty, inner),
        };
        made.unwrap_or_else(|| self.leaf(ty, place))
    }

    /// A value of this type, or of one that turns into it where a type is asked for.
    pub(crate) fn coerced(&mut self, ty: &Type, place: Place) -> Piece {
        let choice = self.source.below(8);
        match ty {
            Type::Float if choice == 7 => self.value(&Type::Int, place),
            Type::Vec2 | Type::Vec3 | Type::Vec4 | Type::Color if choice == 7 => {
                self.value(&Type::Float, place)
            }
            Type::Vec2 | Type::Vec3 | Type::Vec4 | Type::Color if choice == 6 => {
                self.value(&Type::Int, place)
            }
            Type::Vec3 if choice == 5 => self.value(&Type::Color, place),
            Type::Color if choice == 5 => self.value(&Type::Vec3, place),
            Type::Function(function) if choice == 7 => self.value(&function.result, place),
            _ => self.value(ty, place),
        }
    }

    /// A variable or a literal.
    pub(crate) fn leaf(&mut self, ty: &Type, place: Place) -> Piece {
        if *ty == Type::Local || self.source.below(3) > 0 {
            let fitting = self.scope.visible(place, |v| v.ty == *ty);
            if !fitting.is_empty() {
                let newest = fitting.len() - 1 - self.source.below(fitting.len());
                return self.named(&fitting[newest]);
            }
        }
        if place.sees_time() && self.source.once_in(4) {
            match ty {
                Type::Float => return Piece::atom("time"),
                Type::Int => return Piece::atom("frame"),
                _ => {}
            }
        }
        self.literal(ty, place)
    }

    fn named(&mut self, variable: &Variable) -> Piece {
        self.spend(variable.work);
        Piece { coordinates: variable.coordinates, ..Piece::atom(&variable.name).bounded(variable.bound) }
    }

    fn literal(&mut self, ty: &Type, place: Place) -> Piece {
        match ty {
            Type::Bool => Piece::atom(self.source.pick(&["true", "false"])),
            Type::Int => self.int_literal(),
            Type::Float if self.source.once_in(16) => Piece::atom(self.source.pick(&["pi", "tau"])),
            Type::Float if self.source.once_in(24) => self.seconds_literal(),
            Type::Float => self.float_literal(),
            Type::Angle => self.angle_literal(),
            Type::Vec2 | Type::Vec3 | Type::Vec4 => {
                let count = ty.components().unwrap_or(1);
                let parts: Vec<String> = (0..count).map(|_| self.float_literal().text).collect();
                Piece::atom(format!("({})", parts.join(", ")))
            }
            Type::Color => self.color_literal(),
            Type::String | Type::Image => Piece::atom(self.source.pick(&["\"a\"", "\"a \\\"b\\\"\""])),
            Type::Choice(kind) => {
                let words = kind.words();
                let bare: Vec<&str> =
                    words.iter().filter(|word| word.params.is_empty()).map(|word| word.name).collect();
                Piece::atom(self.source.pick(&bare))
            }
            Type::List(element) => {
                let item = self.leaf(element, place);
                Piece::atom(format!("[{}]", item.text))
            }
            Type::Function(function) => {
                let body = self.literal(&function.result, place);
                Piece::new(format!("_x => {}", body.text), level::OPEN)
            }
            Type::Shape => self.plain_shape(),
            Type::Curve => Piece::atom("line((0.0, 0.0, 0.0), (0.0, 1.0, 0.0))"),
            Type::Material => {
                let clouds = ["cloud_2d(0.9, noise: gardner, cutoff: time)", "cloud_3d((0.9, 0.8, 1))"];
                Piece::atom(self.source.pick(&["diffuse(0.8)", "normals()", clouds[0], clouds[1]]))
            }
            Type::Phase => Piece::atom(self.source.pick(&["isotropic()", "rayleigh()"])),
            Type::Local | Type::Record(_) | Type::Block(_) | Type::Settings(_) | Type::Error => {
                unreachable!("no expression of these is asked for")
            }
        }
    }

    /// `if … then … else …`
    fn choice(&mut self, ty: &Type, place: Place) -> Piece {
        let known = !is_numeric(ty) || place.stage == Stage::Constant;
        let condition = if known { self.known_truth(place) } else { self.value(&Type::Bool, place) };
        let (yes, no) = (self.value(ty, place), self.value(ty, place));
        let text = format!("if {} then {} else {}", condition.text, yes.text, no.text);
        Piece::new(text, level::OPEN).bounded(yes.bound.max(no.bound))
    }

    /// `{ let … value }`
    fn block(&mut self, ty: &Type, place: Place) -> Piece {
        let mark = self.scope.mark();
        let mut text = "{".to_owned();
        let mut names: Vec<&str> = Vec::new();
        for _ in 0..=self.source.below(2) {
            let name = self.local_name();
            if names.contains(&name) {
                continue;
            }
            names.push(name);
            let bound_ty = self.bindable(place.stage);
            let before = self.work;
            let value = self.value(&bound_ty, place);
            let mut variable = Variable::new(name, bound_ty.clone(), place.stage);
            if !is_numeric(&bound_ty) {
                variable.stage = place.stage.min(Stage::Frame);
                (variable.work, variable.tube) = (self.work - before, !place.solid);
            }
            (variable.bound, variable.coordinates) = (value.bound, value.coordinates);
            self.scope.bind(variable);
            text.push_str(&format!(" let {name} = {}\n   ", value.text));
        }
        let value = self.value(ty, place);
        self.scope.leave(mark);
        text.push_str(&format!(" {} }}", value.text));
        Piece { text, level: level::ATOM, ..value }
    }

    pub(crate) fn local_name(&mut self) -> &'static str {
        self.source.pick(&NAMES)
    }

    /// A type to bind by `let`.
    fn bindable(&mut self, stage: Stage) -> Type {
        let count = if stage == Stage::Point { 7 } else { 9 };
        match self.source.below(count) {
            0 | 1 => Type::Float,
            2 => Type::Vec3,
            3 => Type::Int,
            4 => Type::Angle,
            5 => Type::Bool,
            6 => Type::Vec2,
            7 => Type::Shape,
            _ => Type::Curve,
        }
    }

    /// Made of other types' parts: components, fields, constructors, lists.
    fn part(&mut self, ty: &Type, place: Place) -> Option<Piece> {
        match ty {
            Type::Float if self.source.once_in(5) => {
                let whole = self.value(&Type::Int, place);
                Some(Piece::atom(format!("float({})", whole.text)))
            }
            Type::Float | Type::Vec3 | Type::Angle if self.source.once_in(2) => {
                self.local_field(ty, place).or_else(|| self.swizzle(ty, place))
            }
            Type::Float => self.swizzle(ty, place),
            Type::Vec2 | Type::Vec3 | Type::Vec4 | Type::Color => match self.source.below(3) {
                0 => self.swizzle(ty, place),
                1 => Some(self.tuple(ty, place)),
                _ => Some(self.constructor(ty, place)),
            },
            Type::List(element) => Some(self.list(element, place)),
            Type::Bool
            | Type::Int
            | Type::Angle
            | Type::String
            | Type::Function(_)
            | Type::Shape
            | Type::Curve
            | Type::Material
            | Type::Phase
            | Type::Local
            | Type::Record(_)
            | Type::Image
            | Type::Block(_)
            | Type::Choice(_)
            | Type::Settings(_)
            | Type::Error => None,
        }
    }

    fn swizzle(&mut self, ty: &Type, place: Place) -> Option<Piece> {
        let sources: &[(Type, &[u8])] = match ty {
            Type::Color => &[(Type::Color, b"rgb")],
            Type::Float | Type::Vec2 | Type::Vec4 => {
                &[(Type::Vec3, b"xyz"), (Type::Vec2, b"xy"), (Type::Vec4, b"xyzw"), (Type::Color, b"rgb")]
            }
            Type::Vec3 => &[(Type::Vec3, b"xyz"), (Type::Vec2, b"xy"), (Type::Vec4, b"xyzw")],
            _ => return None,
        };
        let (source, letters) = &sources[self.source.below(sources.len())];
        let count = ty.components().unwrap_or(1);
        let picked: String = (0..count).map(|_| char::from(self.source.pick(letters))).collect();
        Some(Piece::atom(format!("{}.{picked}", self.value(source, place).receiver())))
    }

    fn local_field(&mut self, ty: &Type, place: Place) -> Option<Piece> {
        let points = self.scope.visible(place, |v| v.ty == Type::Local);
        let point = points.last()?;
        let fits = |field: LocalField| match field {
            LocalField::T | LocalField::L => point.coordinates.along,
            LocalField::Radius => point.coordinates.radius,
            LocalField::Local
            | LocalField::World
            | LocalField::Angle
            | LocalField::Depth
            | LocalField::Stretch => true,
        };
        let fields: Vec<&str> = LocalField::ALL
            .iter()
            .filter(|(field, _, of)| of == ty && fits(*field))
            .map(|(_, name, _)| *name)
            .collect();
        (!fields.is_empty()).then(|| {
            self.spend(20);
            Piece::atom(format!("{}.{}", point.name, self.source.pick(&fields)))
        })
    }

    /// `(x, y, z)`; for colours `rgb(r, g, b)`.
    fn tuple(&mut self, ty: &Type, place: Place) -> Piece {
        let count = ty.components().unwrap_or(1);
        let parts: Vec<String> = (0..count).map(|_| self.coerced(&Type::Float, place).text).collect();
        let name = if *ty == Type::Color { "rgb" } else { "" };
        Piece::atom(format!("{name}({})", parts.join(", ")))
    }

    /// `vec3(…)` of parts that add up, or of one number.
    fn constructor(&mut self, ty: &Type, place: Place) -> Piece {
        let name = if *ty == Type::Color { "rgb" } else { &ty.to_string() };
        let parts: Vec<Type> = match (ty, self.source.below(3)) {
            (_, 0) => vec![Type::Float],
            (Type::Vec4, 1) => vec![Type::Vec2, Type::Vec2],
            (Type::Vec4, _) => vec![Type::Vec3, Type::Float],
            (Type::Vec3 | Type::Color, _) => vec![Type::Float, Type::Vec2],
            (_, 1) => vec![Type::Int],
            (_, _) => vec![ty.clone()],
        };
        let parts: Vec<String> = parts.iter().map(|part| self.value(part, place).text).collect();
        Piece::atom(format!("{name}({})", parts.join(", ")))
    }

    /// `[a, b]`, `[for x in 0..n: a]`, `[for x in list: a]`
    pub(crate) fn list(&mut self, element: &Type, place: Place) -> Piece {
        if self.source.once_in(2) {
            return self.comprehension(element, place);
        }
        let count = 1 + self.source.below(MAX_LENGTH as usize);
        let items: Vec<String> = (0..count).map(|_| self.value(element, place).text).collect();
        let gap = if self.source.once_in(3) { ",\n    " } else { ", " };
        let trailing = if self.source.once_in(4) { "," } else { "" };
        Piece::atom(format!("[{}{trailing}]", items.join(gap)))
    }

    fn comprehension(&mut self, element: &Type, place: Place) -> Piece {
        let (range, ty, length, stage, bound) = match self.source.below(3) {
            2 => {
                let ty = [Type::Float, Type::Vec3, Type::Int][self.source.below(3)].clone();
                let list = self.list(&ty, place.deeper());
                (list.text, ty, MAX_LENGTH, place.stage, MOST)
            }
            1 => {
                let end = self.value(&Type::Int, place.at(Stage::Constant));
                let length = end.bound.min(MAX_LENGTH);
                let end = if end.bound > MAX_LENGTH { length.to_string() } else { end.at(level::SUM) };
                (format!("0..{end}"), Type::Int, length, Stage::Constant, MAX_LENGTH)
            }
            _ => {
                let (from, length) = (self.source.below(3) as i64 - 1, self.source.below(6) as i64);
                (format!("{from}..{}", from + length), Type::Int, length, Stage::Constant, MAX_LENGTH + 1)
            }
        };
        let mark = self.scope.mark();
        let name = self.local_name();
        let mut variable = Variable::new(name, ty, stage);
        variable.bound = bound;
        self.scope.bind(variable);
        let before = self.multiplier;
        self.multiplier = before.saturating_mul(length.max(1) as u64);
        let body = self.value(element, place);
        self.multiplier = before;
        self.scope.leave(mark);
        Piece::atom(format!("[for {name} in {range}: {}]", body.text))
    }

    /// A function value: a lambda, the name of a function, a constant, or a choice between them.
    pub(crate) fn function_value(&mut self, function: &FunctionType, place: Place) -> Piece {
        self.spend(1);
        let ty = Type::Function(Box::new(function.clone()));
        if place.depth > 0 && !self.is_spent() {
            match self.source.below(10) {
                6 => {
                    let condition = self.known_truth(place.deeper());
                    let (yes, no) =
                        (self.lambda(function, place.deeper()), self.lambda(function, place.deeper()));
                    let text = format!("if {} then {} else {}", condition.text, yes.at(1), no.text);
                    return Piece::new(text, level::OPEN);
                }
                7 => {
                    if let Some(name) = self.function_name(function, place) {
                        return name;
                    }
                }
                8 => return self.coerced_constant(&function.result, place),
                9 => {
                    let passed = self.scope.visible(place, |v| v.ty == ty);
                    if let Some(variable) = passed.last() {
                        return self.named(&variable.clone());
                    }
                }
                _ => {}
            }
        }
        self.lambda(function, place)
    }

    /// A plain value where a function is asked for.
    fn coerced_constant(&mut self, result: &Type, place: Place) -> Piece {
        let stage = if place.stage == Stage::Point { Stage::Point } else { Stage::Frame };
        self.coerced(result, place.at(stage).deeper())
    }

    /// `x => value`, `(t, l) => value`, with as many parameters as it likes.
    fn lambda(&mut self, function: &FunctionType, place: Place) -> Piece {
        let mark = self.scope.mark();
        let stage = if is_numeric(&function.result) { Stage::Point } else { place.stage.min(Stage::Frame) };
        let count = if self.source.once_in(4) { 1 } else { function.params.len() };
        let mut names: Vec<&str> = Vec::new();
        for ty in function.params.iter().take(count) {
            let mut name = self.local_name();
            while names.contains(&name) {
                let next = NAMES.iter().position(|n| *n == name).unwrap_or(0) + 1;
                name = NAMES[next % NAMES.len()];
            }
            names.push(name);
            let mut variable = Variable::new(name, ty.clone(), stage);
            variable.opaque = true;
            if *ty == Type::Local {
                variable.coordinates = self.region;
            }
            self.scope.bind(variable);
        }
        let body = self.coerced(&function.result, place.body(stage, mark).deeper());
        self.scope.leave(mark);
        let names = match names[..] {
            [name] => name.to_owned(),
            _ => format!("({})", names.join(", ")),
        };
        Piece::new(format!("{names} => {}", body.text), level::OPEN)
    }
}
