//! Calls: of the library's functions, chosen from its table by their results, and of the scene's own.

use crate::Generator;
use crate::expr::is_numeric;
use crate::piece::{Coordinates, Piece, level};
use crate::scope::{Function, Place, Stage, Variable};
use vol_language::library::{DefaultValue, Parameter, Signature};
use vol_language::ty::{FunctionType, Type};

/// Transforms that keep the local coordinates of their shape.
const KEEP_COORDINATES: [&str; 7] =
    ["translate", "rotate_x", "rotate_y", "rotate_z", "scale", "round", "displace"];

/// Ways to blend shapes.
const BLENDS: [&str; 3] = ["smooth", "chamfer", "stairs"];

/// Arguments on the way to a call.
struct Arguments {
    texts: Vec<String>,
    /// Parameters given so far.
    names: Vec<&'static str>,
    /// Whether one was left out or named, so that all that follow must be named.
    named: bool,
    /// The first as what stands before a dot, if it may.
    receiver: Option<String>,
    coordinates: Coordinates,
}

impl Arguments {
    fn new() -> Self {
        Self {
            texts: Vec::new(),
            names: Vec::new(),
            named: false,
            receiver: None,
            coordinates: Coordinates::default(),
        }
    }

    fn add(&mut self, name: &str, value: &Piece) {
        if self.named {
            self.texts.push(format!("{name}: {}", value.text));
        } else {
            if self.texts.is_empty() {
                self.receiver = Some(value.receiver());
                self.coordinates = value.coordinates;
            }
            self.texts.push(value.text.clone());
        }
    }
}

impl Generator<'_> {
    /// A call of a library function with this result.
    pub(crate) fn library_call(&mut self, ty: &Type, place: Place) -> Option<Piece> {
        let fitting: Vec<usize> = (0..self.library.signatures.len())
            .filter(|&i| {
                let signature = &self.library.signatures[i];
                signature.result == *ty && self.can_call(signature, place)
            })
            .collect();
        if fitting.is_empty() {
            return None;
        }
        let signature = self.library.signatures[fitting[self.source.below(fitting.len())]].clone();
        Some(self.call_of(&signature, place))
    }

    fn can_call(&self, signature: &Signature, place: Place) -> bool {
        // A tube is no solid.
        let tube = signature.result == Type::Shape && signature.params.iter().any(|p| p.ty == Type::Curve);
        // Curl has no slope. A Mandelbulb is neither blended nor grown: it stands alone in its block.
        let curl = signature.name == "curl" && place.smooth;
        !(tube && place.solid || curl || signature.name == "mandelbulb")
    }

    /// A Mandelbulb; nothing if the library has none.
    pub(crate) fn mandelbulb(&mut self, place: Place) -> Option<Piece> {
        let signature =
            self.library.signatures.iter().find(|signature| signature.name == "mandelbulb").cloned()?;
        Some(self.call_of(&signature, place))
    }

    fn call_of(&mut self, signature: &Signature, place: Place) -> Piece {
        let mut arguments = Arguments::new();
        let mut first = true;
        for param in &signature.params {
            // One blend is enough for a call.
            let second = BLENDS.contains(&param.name) && arguments.names.iter().any(|n| BLENDS.contains(n));
            if param.default != DefaultValue::Required && (second || self.source.below(2) == 0) {
                arguments.named = true;
                continue;
            }
            arguments.names.push(param.name);
            arguments.named |= !first && self.source.once_in(8);
            if param.rest {
                self.rest(param, place, &mut arguments);
                arguments.named = true;
            } else {
                let value = self.argument(signature, param, first, place);
                arguments.add(param.name, &value);
            }
            first = false;
        }
        let mut coordinates = coordinates_of(signature);
        if KEEP_COORDINATES.contains(&signature.name) {
            coordinates = arguments.coordinates;
        }
        let is_method = signature.params.first().is_some_and(|p| !matches!(p.ty, Type::Function(_)));
        Piece { coordinates, ..self.written(signature.name, arguments, is_method) }
    }

    /// All elements one by one, or as one list.
    fn rest(&mut self, param: &Parameter, place: Place, arguments: &mut Arguments) {
        if arguments.named || self.source.once_in(3) {
            let list = self.list(&param.ty, place);
            arguments.add(param.name, &list);
            return;
        }
        for _ in 0..=self.source.below(3) {
            let value = self.value(&param.ty, place);
            arguments.add(param.name, &value);
        }
    }

    fn argument(&mut self, signature: &Signature, param: &Parameter, first: bool, place: Place) -> Piece {
        if let Some(text) = self.ruled(signature, param) {
            return text;
        }
        if param.ty == Type::Bool {
            return self.known_truth(place.at(Stage::Constant));
        }
        if param.name == "seed" {
            return self.value(&param.ty, place.at(Stage::Constant));
        }
        if signature.result == Type::Shape {
            return self.shape_argument(param, place);
        }
        // A sum of octaves has no slope by these.
        let place = match param.name {
            "lacunarity" | "gain" if place.smooth => place.at(Stage::Frame),
            _ => place,
        };
        // Beside an exact first argument the others may be narrower.
        let exact = signature.params.first().is_some_and(|p| p.ty == param.ty);
        let alike = exact && (param.ty == signature.result || param.ty == Type::Float);
        if !first && alike && self.source.once_in(8) {
            return match param.ty {
                Type::Float => self.value(&Type::Int, place),
                Type::Vec2 | Type::Vec3 | Type::Vec4 => self.value(&Type::Float, place),
                _ => self.value(&param.ty, place),
            };
        }
        self.value(&param.ty, place)
    }

    /// An argument for which the language has a rule that its type does not tell.
    fn ruled(&mut self, signature: &Signature, param: &Parameter) -> Option<Piece> {
        let texts: &[&str] = match (signature.name, param.name) {
            ("cloud_2d" | "cloud_3d", "octaves") => &["4", "1", "7"],
            ("cloud_3d", "depth") => &["0.5", "2", "time", "1e9"],
            (_, "octaves") => &["4", "1", "0", "7", "frame % 5"],
            ("gardner", "terms") => &["5", "1", "7"],
            ("prism", "sides") => &["5", "3", "12"],
            ("mandelbulb", "power") => &["8", "2.5", "3.0", "4 + sin(time)"],
            ("mandelbulb", "iterations") => &["4", "9", "frame % 5"],
            ("mandelbulb", "detail") => &["0.01", "0.1"],
            ("union" | "intersect" | "subtract", "steps") => &["3", "1", "6"],
            ("repeat", "count") => &["(2, 1, 3)", "(1, 1, 1)", "(0, 0, 1)"],
            ("repeat", "period") => &["(1.5, 2.0, 1.0)", "(40.0, 30.0, 50.0)"],
            ("repeat_polar", "count") => &["5", "1", "8"],
            // Sums are for tubes that are a region by themselves.
            ("tube", "overlap") => &["nearest", "min_ratio"],
            (_, "overlap") => &["1", "0"],
            ("catmull_rom" | "bspline", "points") => &[
                "[(0.0, 0.0, 0.0), (0.5, 1.0, 0.0), (1.0, 0.0, 0.5)]",
                "[(0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (1.0, time, 0.5), (2.0, 0.0, 0.0)]",
                "[for i in 0..6: (0.5 * i, sin(i), cos(i + time))]",
            ],
            ("path", "curves") => &[
                "[line((0.0, 0.0, 0.0), (0.0, 1.0, 0.0)), line((0.0, 1.0, 0.0), (0.0, 2.0, 0.0))]",
                "[bezier((0.0, 0.0, 0.0), (0.0, 1.0, 0.0), (1.0, 1.0, time), (1.0, 2.0, 0.0))]",
            ],
            ("helix", "turns") => &["2", "0.5", "3.25"],
            ("tube", "frame") => &["minimal"],
            _ => return None,
        };
        Some(Piece::new(self.source.pick(texts), level::SUM))
    }

    /// `f(a, b)`, or `a.f(b)`.
    fn written(&mut self, name: &str, arguments: Arguments, is_method: bool) -> Piece {
        let Arguments { mut texts, receiver, .. } = arguments;
        let trailing = if !texts.is_empty() && self.source.once_in(16) { "," } else { "" };
        match receiver {
            Some(receiver) if is_method && self.source.once_in(3) => {
                texts.remove(0);
                let trailing = if texts.is_empty() { "" } else { trailing };
                Piece::atom(format!("{receiver}.{name}({}{trailing})", texts.join(", ")))
            }
            _ => {
                let gap = if texts.len() > 2 && self.source.once_in(6) { ",\n    " } else { ", " };
                Piece::atom(format!("{name}({}{trailing})", texts.join(gap)))
            }
        }
    }

    /// A call of one of the scene's own functions, or of a function value.
    pub(crate) fn user_call(&mut self, ty: &Type, place: Place) -> Option<Piece> {
        let values = self.scope.visible(place, |v| match &v.ty {
            Type::Function(function) => function.result == *ty,
            _ => false,
        });
        if let Some(value) = values.last()
            && self.source.once_in(2)
        {
            return self.value_call(&value.clone(), place);
        }
        let fitting: Vec<usize> = (0..self.functions.len())
            .filter(|&i| {
                let function = &self.functions[i];
                function.result == *ty && self.reaches(function, place)
            })
            .collect();
        if fitting.is_empty() {
            return None;
        }
        let function = self.functions[fitting[self.source.below(fitting.len())]].clone();
        self.spend(function.work);
        let mut arguments = Arguments::new();
        for param in &function.params {
            if param.optional && self.source.below(2) == 0 {
                arguments.named = true;
                continue;
            }
            arguments.named |= self.source.once_in(5);
            let place = place.at(param.stage);
            let value = match &param.ty {
                Type::Int if param.stage == Stage::Constant => self.small_whole(place),
                Type::Local => self.value(&param.ty, place),
                ty => self.coerced(ty, place),
            };
            arguments.add(&param.name, &value);
        }
        let is_method = function.params.first().is_some_and(|p| !matches!(p.ty, Type::Function(_)));
        Some(self.written(&function.name, arguments, is_method))
    }

    /// Whether a function can be called here: not hidden, no faster than the place, its arguments at hand.
    fn reaches(&self, function: &Function, place: Place) -> bool {
        let has_local = |p: Place| !self.scope.visible(p, |v| v.ty == Type::Local).is_empty();
        let at_hand = function.params.iter().all(|p| p.ty != Type::Local || has_local(place.at(p.stage)));
        let timely = function.stage == Stage::Constant || place.sees_time();
        timely && at_hand && !self.scope.has(&function.name)
    }

    fn value_call(&mut self, value: &Variable, place: Place) -> Option<Piece> {
        let Type::Function(function) = &value.ty else { return None };
        let has_local = !self.scope.visible(place, |v| v.ty == Type::Local).is_empty();
        if function.params.contains(&Type::Local) && !has_local {
            return None;
        }
        self.spend(value.work);
        // Like the parameters of lambdas: those that make shapes must not depend on the position.
        let place = if is_numeric(&function.result) { place } else { place.at(Stage::Frame) };
        let texts: Vec<String> = function.params.iter().map(|ty| self.coerced(ty, place).text).collect();
        Some(Piece::atom(format!("{}({})", value.name, texts.join(", "))))
    }

    /// A whole number known at compile time, small enough to be the length of a list.
    fn small_whole(&mut self, place: Place) -> Piece {
        let value = self.value(&Type::Int, place.at(Stage::Constant));
        if value.bound <= 5 { value } else { crate::literal::int(3) }
    }

    /// The name of a function that fits a function type.
    pub(crate) fn function_name(&mut self, wanted: &FunctionType, place: Place) -> Option<Piece> {
        let fits = |params: Vec<&Type>| {
            let passes = |(given, want): (&Type, &&Type)| {
                given == *want || (*given == Type::Local && **want == Type::Vec3)
            };
            params.len() <= wanted.params.len() && wanted.params.iter().zip(&params).all(passes)
        };
        let mut names: Vec<(String, u64)> = Vec::new();
        for function in &self.functions {
            let required = function.params.iter().filter(|p| !p.optional).map(|p| &p.ty).collect();
            let any = function.params.iter().filter(|p| !p.optional).all(|p| p.stage == Stage::Point);
            let fits = fits(required) && any && function.result == wanted.result;
            if fits && self.reaches(function, place) {
                names.push((function.name.clone(), function.work));
            }
        }
        if is_numeric(&wanted.result) {
            for signature in &self.library.signatures {
                let required: Vec<&Parameter> =
                    signature.params.iter().filter(|p| p.default == DefaultValue::Required).collect();
                let ruled = |p: &&Parameter| p.rest || ["seed", "octaves", "steps"].contains(&p.name);
                let plain = !required.iter().any(ruled) && signature.name != "curl";
                let fits = fits(required.iter().map(|p| &p.ty).collect()) && !required.is_empty();
                if fits && plain && signature.result == wanted.result && !self.scope.has(signature.name) {
                    names.push((signature.name.to_owned(), 1));
                }
            }
        }
        if names.is_empty() {
            return None;
        }
        let (name, work) = names[self.source.below(names.len())].clone();
        self.spend(work);
        Some(Piece::atom(name))
    }
}

/// The coordinates of a new shape.
fn coordinates_of(signature: &Signature) -> Coordinates {
    match signature.name {
        "sphere" | "infinite_cylinder" => Coordinates { radius: true, along: false },
        "cylinder" | "tube" => Coordinates { radius: true, along: true },
        _ => Coordinates::default(),
    }
}
