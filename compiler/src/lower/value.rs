//! What an expression can be while a scene is compiled.

use super::curve::CurveValue;
use super::optics::{Material, Phase};
use super::shape::Shape;
use crate::ir::ValueId;
use std::rc::Rc;
use vol_language::hir::{ExprId, LocalId};
use vol_language::source::Span;

/// A value at compile time. Numbers that are not constant are nodes of the graph.
#[derive(Clone, Debug)]
pub(crate) enum Value {
    /// A bool, int, float, angle (one component), vector or colour.
    Numbers(Vec<ValueId>),
    /// Text.
    String(Rc<str>),
    /// A list.
    List(Rc<[Value]>),
    /// A function.
    Function(Rc<Closure>),
    /// A solid.
    Shape(Rc<Shape>),
    /// A curve.
    Curve(Rc<CurveValue>),
    /// How a surface answers light.
    Material(Rc<Material>),
    /// A phase function.
    Phase(Rc<Phase>),
    /// The local point `q`.
    Local(Rc<LocalPoint>),
    /// The last state of a loop, by field.
    Record(Rc<[Value]>),
    /// A word with arguments.
    Word(Rc<Word>),
    /// Given settings by key, with their places.
    Settings(Rc<[(&'static str, Value, Span)]>),
    /// Lists at keys, and the share of each key after the first against the one before.
    Keyed(Rc<[Value]>, Rc<[ValueId]>),
}

/// A word with arguments, each with its place; none where it is left out.
#[derive(Debug)]
pub(crate) struct Word {
    pub(crate) name: &'static str,
    pub(crate) arguments: Vec<Option<(Value, Span)>>,
    pub(crate) span: Span,
}

impl Value {
    /// The components of a number, vector or colour. The checker has seen to the type.
    pub(crate) fn numbers(&self) -> &[ValueId] {
        match self {
            Self::Numbers(components) => components,
            Self::String(_)
            | Self::List(_)
            | Self::Function(_)
            | Self::Shape(_)
            | Self::Curve(_)
            | Self::Material(_)
            | Self::Phase(_)
            | Self::Local(_)
            | Self::Record(_)
            | Self::Word(_)
            | Self::Settings(_)
            | Self::Keyed(..) => &[],
        }
    }

    /// The single component of a scalar.
    pub(crate) fn scalar(&self) -> ValueId {
        *self.numbers().first().expect("the checker gives a number where one is asked for")
    }

    /// The components of a vec3 or colour.
    pub(crate) fn vec3(&self) -> [ValueId; 3] {
        self.numbers().try_into().expect("the checker gives three components where they are asked for")
    }

    pub(crate) fn shape(&self) -> Rc<Shape> {
        match self {
            Self::Shape(shape) => Rc::clone(shape),
            other => unreachable_type(other, "shape"),
        }
    }

    pub(crate) fn curve(&self) -> Rc<CurveValue> {
        match self {
            Self::Curve(curve) => Rc::clone(curve),
            other => unreachable_type(other, "curve"),
        }
    }

    pub(crate) fn function(&self) -> Rc<Closure> {
        match self {
            Self::Function(function) => Rc::clone(function),
            other => Rc::new(Closure::Constant(other.clone())),
        }
    }

    pub(crate) fn list(&self) -> Rc<[Self]> {
        match self {
            Self::List(list) => Rc::clone(list),
            other => Rc::new([other.clone()]),
        }
    }
}

fn unreachable_type(found: &Value, wanted: &str) -> ! {
    unreachable!("the checker gives a {wanted} where one is asked for, not {found:?}")
}

/// A function value.
#[derive(Clone, Debug)]
pub(crate) enum Closure {
    /// A lambda with the bindings that it saw.
    Lambda {
        /// Bindings of the parameters.
        params: Vec<LocalId>,
        /// The body.
        body: ExprId,
        /// What was in scope.
        captured: Environment,
    },
    /// The same value whatever the arguments.
    Constant(Value),
}

/// Values of the bindings in scope, by [`LocalId`].
#[derive(Clone, Debug)]
pub(crate) struct Environment(Vec<Option<Value>>);

impl Environment {
    pub(crate) fn new(count: u32) -> Self {
        Self(vec![None; count as usize])
    }

    pub(crate) fn bind(&mut self, local: LocalId, value: Value) {
        self.0[local.index()] = Some(value);
    }

    pub(crate) fn get(&self, local: LocalId) -> Option<&Value> {
        self.0[local.index()].as_ref()
    }
}

/// The point that a medium or material function is asked about: a world position seen from a
/// region. Its coordinates are computed when a scene uses them.
#[derive(Clone, Debug)]
pub(crate) struct LocalPoint {
    /// World position.
    pub(crate) world: [ValueId; 3],
    /// The region.
    pub(crate) region: Rc<Shape>,
}
