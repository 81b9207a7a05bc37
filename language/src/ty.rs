//! The types of the language.

use crate::blocks::BlockKind;
use crate::settings::{ChoiceKind, SettingsKind};
use std::fmt;

/// The type of an expression.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Type {
    /// `true` or `false`.
    Bool,
    /// A whole number of magnitude at most 2^24, so that every backend holds it exactly.
    Int,
    /// A real number.
    Float,
    /// A plane angle; radians inside, never a bare number in the source.
    Angle,
    /// Two components.
    Vec2,
    /// Three components: a position, direction or size.
    Vec3,
    /// Four components.
    Vec4,
    /// Scene-linear Rec. 709 red, green, blue.
    Color,
    /// Text.
    String,
    /// A list of values of one type, known at compile time.
    List(Box<Type>),
    /// A function value.
    Function(Box<FunctionType>),
    /// A solid: signed distance bound, bounds and local coordinates.
    Shape,
    /// A space curve.
    Curve,
    /// How a surface answers light.
    Material,
    /// How a medium scatters light.
    Phase,
    /// The point that a medium's or material's function is asked about (`q`).
    Local,
    /// The state of a finished loop: values with names.
    Record(Box<RecordType>),
    /// A picture file, given as a text.
    Image,
    /// A block of the scene by its name.
    Block(BlockKind),
    /// One of a few words, some with arguments; see [`crate::settings`].
    Choice(ChoiceKind),
    /// `{ key: value, … }`; see [`crate::settings`].
    Settings(SettingsKind),
    /// Stands for an expression already reported as wrong; silences follow-up errors.
    Error,
}

/// The fields of a record in order.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct RecordType {
    /// Names and types; the names differ.
    pub fields: Vec<(String, Type)>,
}

/// Parameters and result of a function value.
///
/// A function with fewer parameters serves where one with more is wanted, if the types of those
/// it has agree (`t => …` for `(t, l) => …`); so does a plain value of the result type.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct FunctionType {
    /// Types of the parameters, in order.
    pub params: Vec<Type>,
    /// Type of the result.
    pub result: Type,
}

impl Type {
    /// The type of a function from `params` to `result`.
    #[must_use]
    pub fn function(params: Vec<Type>, result: Type) -> Self {
        Self::Function(Box::new(FunctionType { params, result }))
    }

    /// The type of a list of `element`.
    #[must_use]
    pub fn list(element: Type) -> Self {
        Self::List(Box::new(element))
    }

    /// The types that can be written by name, in the order in which messages list them.
    #[must_use]
    pub fn all_named() -> [Self; 23] {
        [
            Self::Bool,
            Self::Int,
            Self::Float,
            Self::Angle,
            Self::Vec2,
            Self::Vec3,
            Self::Vec4,
            Self::Color,
            Self::String,
            Self::Shape,
            Self::Curve,
            Self::Material,
            Self::Phase,
            Self::Local,
            Self::Image,
            Self::Block(BlockKind::Camera),
            Self::Block(BlockKind::Light),
            Self::Block(BlockKind::Object),
            Self::Block(BlockKind::Medium),
            Self::Block(BlockKind::Style),
            Self::Choice(ChoiceKind::Layer),
            Self::Choice(ChoiceKind::Brush),
            Self::Choice(ChoiceKind::Stroke),
        ]
    }

    /// The type with this name.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Self::all_named().into_iter().find(|ty| ty.to_string() == name)
    }

    /// Number of scalar components of a number, vector or colour; `None` for all else.
    #[must_use]
    pub fn components(&self) -> Option<usize> {
        match self {
            Self::Bool | Self::Int | Self::Float | Self::Angle => Some(1),
            Self::Vec2 => Some(2),
            Self::Vec3 | Self::Color => Some(3),
            Self::Vec4 => Some(4),
            Self::String
            | Self::List(_)
            | Self::Function(_)
            | Self::Shape
            | Self::Curve
            | Self::Material
            | Self::Phase
            | Self::Local
            | Self::Record(_)
            | Self::Image
            | Self::Block(_)
            | Self::Choice(_)
            | Self::Settings(_)
            | Self::Error => None,
        }
    }

    /// Whether values are vectors or colours.
    #[must_use]
    pub fn is_vector(&self) -> bool {
        matches!(self, Self::Vec2 | Self::Vec3 | Self::Vec4 | Self::Color)
    }
}

impl fmt::Display for Type {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = match self {
            Self::Bool => "bool",
            Self::Int => "int",
            Self::Float => "float",
            Self::Angle => "angle",
            Self::Vec2 => "vec2",
            Self::Vec3 => "vec3",
            Self::Vec4 => "vec4",
            Self::Color => "color",
            Self::String => "string",
            Self::List(element) => return write!(f, "[{element}]"),
            Self::Function(function) => {
                let params: Vec<String> = function.params.iter().map(Type::to_string).collect();
                return write!(f, "({}) -> {}", params.join(", "), function.result);
            }
            Self::Shape => "shape",
            Self::Curve => "curve",
            Self::Material => "material",
            Self::Phase => "phase",
            Self::Local => "local",
            Self::Record(record) => {
                let fields: Vec<String> =
                    record.fields.iter().map(|(name, ty)| format!("{name}: {ty}")).collect();
                return write!(f, "({})", fields.join(", "));
            }
            Self::Image => "image",
            Self::Block(kind) => kind.keyword(),
            Self::Choice(kind) => kind.name(),
            Self::Settings(kind) => kind.name(),
            Self::Error => "unknown",
        };
        f.write_str(name)
    }
}
