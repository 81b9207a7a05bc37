//! Operators of every type.

use crate::Generator;
use crate::literal::{MOST, float};
use crate::piece::{Piece, level};
use crate::scope::{Place, Stage};
use vol_language::ty::Type;

/// Operators with their levels; those after the third need a divisor.
const ARITHMETIC: [(&str, u8); 5] = [
    ("+", level::SUM),
    ("-", level::SUM),
    ("*", level::PRODUCT),
    ("/", level::PRODUCT),
    ("%", level::PRODUCT),
];

const COMPARISONS: [&str; 6] = ["<", "<=", ">", ">=", "==", "!="];

impl Generator<'_> {
    /// `a op b`, or a prefix operator, of a type; `None` where the type has no operators.
    pub(crate) fn operator(&mut self, ty: &Type, place: Place) -> Option<Piece> {
        Some(match ty {
            Type::Bool => self.truth_operator(place),
            Type::Int => self.whole_operator(place),
            Type::Float => self.float_operator(place),
            Type::Angle => self.angle_operator(place),
            Type::Vec2 | Type::Vec3 | Type::Vec4 | Type::Color => self.vector_operator(ty, place),
            Type::Shape => {
                let (symbol, level) =
                    self.source.pick(&[("|", level::UNION), ("&", level::INTERSECTION), ("-", level::SUM)]);
                let (left, right) = (self.value(ty, place), self.value(ty, place));
                self.infix(&left, symbol, level, &right)
            }
            Type::String
            | Type::List(_)
            | Type::Function(_)
            | Type::Curve
            | Type::Material
            | Type::Phase
            | Type::Local
            | Type::Record(_)
            | Type::Image
            | Type::Block(_)
            | Type::Choice(_)
            | Type::Settings(_)
            | Type::Error => return None,
        })
    }

    /// `left symbol right`, at times with the line broken or with parentheses that are not needed.
    fn infix(&mut self, left: &Piece, symbol: &str, level: u8, right: &Piece) -> Piece {
        let gap = if self.source.once_in(12) { "\n      " } else { " " };
        let text = format!("{} {symbol}{gap}{}", left.at(level), right.at(level + 1));
        if self.source.once_in(8) { Piece::atom(format!("({text})")) } else { Piece::new(text, level) }
    }

    fn prefix(&mut self, symbol: &str, ty: &Type, place: Place) -> Piece {
        let value = self.value(ty, place);
        let operand = value.at(level::PREFIX);
        // A run of signs is legal, but unreadable.
        let operand = if operand.starts_with(['-', '!']) { format!("({operand})") } else { operand };
        Piece::new(format!("{symbol}{operand}"), level::PREFIX).bounded(value.bound)
    }

    fn truth_operator(&mut self, place: Place) -> Piece {
        match self.source.below(6) {
            0 => self.prefix("!", &Type::Bool, place),
            1 | 2 => {
                let (symbol, level) = self.source.pick(&[("&&", level::AND), ("||", level::OR)]);
                let (left, right) = (self.value(&Type::Bool, place), self.value(&Type::Bool, place));
                self.infix(&left, symbol, level, &right)
            }
            3 => {
                let symbol = self.source.pick(&["==", "!="]);
                let (left, right) = (self.value(&Type::Bool, place), self.value(&Type::Bool, place));
                // Comparisons do not chain.
                let (left, right) = (left.at(level::UNION), right.at(level::UNION));
                Piece::new(format!("{left} {symbol} {right}"), level::COMPARISON)
            }
            _ => {
                let ty = self.source.pick(&[0, 0, 1, 2]);
                let ty = [Type::Float, Type::Int, Type::Angle][ty].clone();
                self.comparison(&ty, place)
            }
        }
    }

    fn comparison(&mut self, ty: &Type, place: Place) -> Piece {
        let symbol = self.source.pick(&COMPARISONS);
        let (left, right) = (self.value(ty, place), self.value(ty, place));
        Piece::new(
            format!("{} {symbol} {}", left.at(level::UNION), right.at(level::UNION)),
            level::COMPARISON,
        )
    }

    /// A truth value that the compiler knows.
    pub(crate) fn known_truth(&mut self, place: Place) -> Piece {
        let place = place.at(Stage::Constant);
        match self.source.below(4) {
            0 => Piece::atom(self.source.pick(&["true", "false"])),
            1 => {
                let (left, right) = (self.known_truth(place.deeper()), self.known_truth(place.deeper()));
                let (symbol, level) = self.source.pick(&[("&&", level::AND), ("||", level::OR)]);
                self.infix(&left, symbol, level, &right)
            }
            _ => self.comparison(&Type::Int, place),
        }
    }

    fn whole_operator(&mut self, place: Place) -> Piece {
        let kind = self.source.below(5);
        if kind == 4 {
            return self.prefix("-", &Type::Int, place);
        }
        let left = self.value(&Type::Int, place);
        if kind == 3 {
            let divisor = 2 + self.source.below(6) as i64;
            let right = crate::literal::int(divisor);
            return self.infix(&left, "%", level::PRODUCT, &right).bounded(divisor);
        }
        let right = self.value(&Type::Int, place);
        let bound = if kind == 2 { left.bound * right.bound } else { left.bound + right.bound };
        if bound > MOST {
            return left;
        }
        let (symbol, level) = ARITHMETIC[kind];
        self.infix(&left, symbol, level, &right).bounded(bound)
    }

    fn float_operator(&mut self, place: Place) -> Piece {
        match self.source.below(9) {
            0 => self.prefix("-", &Type::Float, place),
            1 => {
                let (left, right) = (self.value(&Type::Angle, place), self.angle_but_zero());
                self.infix(&left, "/", level::PRODUCT, &right)
            }
            2 => {
                let left = self.value(&Type::Int, place);
                let right = crate::literal::int(1 + self.source.below(9) as i64);
                self.infix(&left, "/", level::PRODUCT, &right)
            }
            _ => self.arithmetic(&Type::Float, place),
        }
    }

    fn angle_operator(&mut self, place: Place) -> Piece {
        let angle = self.value(&Type::Angle, place);
        match self.source.below(6) {
            0 => self.prefix("-", &Type::Angle, place),
            1 => {
                let other = self.value(&Type::Angle, place);
                let symbol = self.source.pick(&["+", "-"]);
                self.infix(&angle, symbol, level::SUM, &other)
            }
            2 => {
                let factor = self.narrow(&Type::Float, place);
                self.infix(&angle, "*", level::PRODUCT, &factor)
            }
            3 => {
                let factor = self.narrow(&Type::Float, place);
                self.infix(&factor, "*", level::PRODUCT, &angle)
            }
            4 => {
                let divisor = self.divisor(&Type::Float, place);
                self.infix(&angle, "/", level::PRODUCT, &divisor)
            }
            _ => {
                let divisor = self.angle_but_zero();
                self.infix(&angle, "%", level::PRODUCT, &divisor)
            }
        }
    }

    fn vector_operator(&mut self, ty: &Type, place: Place) -> Piece {
        if self.source.once_in(8) { self.prefix("-", ty, place) } else { self.arithmetic(ty, place) }
    }

    /// Arithmetic of two operands, one of which may be narrower.
    fn arithmetic(&mut self, ty: &Type, place: Place) -> Piece {
        let (symbol, level) = self.source.pick(&ARITHMETIC);
        let exact = self.value(ty, place);
        if matches!(symbol, "/" | "%") {
            let divisor = self.divisor(ty, place);
            return self.infix(&exact, symbol, level, &divisor);
        }
        let other = self.narrow(ty, place);
        if self.source.once_in(2) {
            self.infix(&exact, symbol, level, &other)
        } else {
            self.infix(&other, symbol, level, &exact)
        }
    }

    /// A value of the type, or of one that widens to it beside a value of the type.
    fn narrow(&mut self, ty: &Type, place: Place) -> Piece {
        let choice = self.source.below(6);
        match ty {
            Type::Float if choice == 5 => self.value(&Type::Int, place),
            Type::Color if choice == 4 => self.value(&Type::Vec3, place),
            Type::Vec2 | Type::Vec3 | Type::Vec4 | Type::Color if choice == 5 => {
                self.value(&Type::Int, place)
            }
            Type::Vec2 | Type::Vec3 | Type::Vec4 | Type::Color if choice >= 2 => {
                self.value(&Type::Float, place)
            }
            _ => self.value(ty, place),
        }
    }

    /// A divisor that is not known to be 0: mostly safe, at times of unknown value.
    fn divisor(&mut self, ty: &Type, place: Place) -> Piece {
        match self.source.below(5) {
            0 | 1 => float(self.real_but_zero()),
            2 if ty.is_vector() => {
                let count = ty.components().unwrap_or(1);
                let parts: Vec<String> = (0..count).map(|_| float(self.real_but_zero()).text).collect();
                Piece::atom(format!("({})", parts.join(", ")))
            }
            3 => {
                let opaque = self.scope.visible(place, |v| v.opaque && v.ty == *ty);
                if opaque.is_empty() {
                    return float(self.real_but_zero());
                }
                let chosen = self.source.below(opaque.len());
                Piece::atom(opaque[chosen].name.clone())
            }
            _ => {
                let value = self.value(&Type::Float, place);
                let offset = float(0.5);
                let magnitude = Piece::atom(format!("abs({})", value.text));
                self.infix(&offset, "+", level::SUM, &magnitude)
            }
        }
    }
}
