//! Arguments of shapes: sizes that make a solid, displacements that can be marched.

use crate::Generator;
use crate::literal::float;
use crate::piece::{Coordinates, Piece, level};
use crate::scope::{Place, Stage, Variable};
use vol_language::library::Parameter;
use vol_language::ty::Type;

/// Parameters of shapes that are no sizes: places, directions, and what may have either sign.
const SIGNED: [&str; 13] =
    ["a", "b", "c", "d", "offset", "normal", "from", "at", "axis", "center", "direction", "point", "target"];

/// Sizes that may be 0.
const MAY_BE_ZERO: [&str; 8] =
    ["radius", "half", "half_height", "major", "minor", "smooth", "chamfer", "stairs"];

/// Directions, which are never 0.
const DIRECTIONS: [&str; 3] = ["normal", "axis", "direction"];

impl Generator<'_> {
    /// The shape when nothing else may be written.
    pub(crate) fn plain_shape(&mut self) -> Piece {
        let radius = float(self.size_number(true));
        let coordinates = Coordinates { radius: true, along: false };
        Piece { coordinates, ..Piece::atom(format!("sphere({})", radius.text)) }
    }

    /// An argument of a function that makes a shape.
    pub(crate) fn shape_argument(&mut self, param: &Parameter, place: Place) -> Piece {
        let size = !SIGNED.contains(&param.name);
        let zero = MAY_BE_ZERO.contains(&param.name);
        match &param.ty {
            Type::Float if size => self.size(zero, place),
            Type::Vec2 | Type::Vec3 if size => {
                let count = param.ty.components().unwrap_or(1);
                let parts: Vec<String> = (0..count).map(|_| self.size(zero, place).text).collect();
                Piece::atom(format!("({})", parts.join(", ")))
            }
            Type::Vec2 | Type::Vec3 if DIRECTIONS.contains(&param.name) || self.source.below(3) > 0 => {
                let count = param.ty.components().unwrap_or(1);
                let parts: Vec<String> = (0..count).map(|_| float(self.real_but_zero()).text).collect();
                Piece::atom(format!("({})", parts.join(", ")))
            }
            Type::Function(function)
                if function.params == [Type::Vec3]
                    && function.result == Type::Float
                    && !self.source.once_in(10) =>
            {
                self.displacement(place)
            }
            Type::Int => self.int_literal_in(1, 6),
            ty => self.value(ty, place),
        }
    }

    fn int_literal_in(&mut self, lo: i64, hi: i64) -> Piece {
        crate::literal::int(lo + self.source.below((hi - lo + 1) as usize) as i64)
    }

    /// A number that is positive whatever its parts are, or at least not known to be anything else.
    fn size(&mut self, zero: bool, place: Place) -> Piece {
        if place.depth > 0 && !self.is_spent() && self.source.once_in(4) {
            let value = self.value(&Type::Float, place.at(Stage::Frame).deeper());
            return Piece::atom(format!("clamp({}, 0.05, 2.0)", value.text));
        }
        float(self.size_number(zero))
    }

    /// `p => …`: a sum of products of functions with bounds on their values and slopes.
    fn displacement(&mut self, place: Place) -> Piece {
        let mark = self.scope.mark();
        let name = self.local_name();
        self.scope.bind(Variable { opaque: true, ..Variable::new(name, Type::Vec3, Stage::Point) });
        let frame = place.at(Stage::Frame).body(Stage::Frame, mark);
        let mut terms = Vec::new();
        for _ in 0..=self.source.below(2) {
            let amount = self.source.pick(&["0.05", "0.1", "0.02", "0.2"]);
            let factors: Vec<String> = (0..=self.source.below(2)).map(|_| self.wave(name, frame)).collect();
            terms.push(format!("{amount} * {}", factors.join(" * ")));
        }
        self.scope.leave(mark);
        Piece::new(format!("{name} => {}", terms.join(" + ")), level::OPEN)
    }

    /// A bounded function of the point `p` with a bounded slope.
    fn wave(&mut self, p: &str, frame: Place) -> String {
        let frequency = self.source.pick(&["3", "1.0", "7.5", "0.5"]);
        let axis = self.source.pick(&["x", "y", "z"]);
        let octaves = 1 + self.source.below(4);
        let shift = self.leaf(&Type::Float, frame).at(level::PRODUCT);
        match self.source.below(6) {
            0 => format!("sin({frequency} * {p}.{axis} + {shift})"),
            1 => format!("cos({frequency} * {p}.{axis})"),
            2 => format!("perlin({frequency} * {p} + {shift})"),
            3 => format!("fbm({frequency} * {p}, {octaves})"),
            4 => format!("clamp({p}.{axis}, -0.5, 0.5)"),
            _ => format!("smoothstep(0.0, 1.0, {p}.{axis})"),
        }
    }
}
