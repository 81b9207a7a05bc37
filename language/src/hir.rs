//! The typed scene: every name resolved, every conversion written out.
//!
//! Expressions live in one arena, [`Scene::exprs`], and refer to each other by [`ExprId`].
//! What the checker guarantees: operands of [`ExprKind::Binary`] have the types its operator asks
//! for (equal types, or a vector and a scalar made equal by [`Conversion::Broadcast`]); calls have
//! exactly one argument per parameter; user functions do not recurse.

use crate::ast::{BinaryOp, UnaryOp};
use crate::blocks::BlockKind;
use crate::library::BuiltinId;
use crate::module::ModuleId;
use crate::source::Span;
use crate::ty::Type;

macro_rules! id {
    ($(#[$doc:meta])* $name:ident) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub struct $name(pub u32);
        impl $name {
            /// As an index.
            #[must_use]
            pub fn index(self) -> usize {
                self.0 as usize
            }
        }
    };
}

id!(
    /// Index into [`Scene::exprs`].
    ExprId
);
id!(
    /// A binding of a block, a lambda or a function; unique in the scene.
    LocalId
);
id!(
    /// Index into [`Scene::lets`].
    LetId
);
id!(
    /// Index into [`Scene::params`].
    ParamId
);
id!(
    /// Index into [`Scene::functions`].
    FunctionId
);

/// A checked scene.
#[derive(Clone, Debug, Default)]
pub struct Scene {
    /// All expressions; operands stand before their users.
    pub exprs: Vec<Expr>,
    /// Number of [`LocalId`]s given out.
    pub local_count: u32,
    /// Values set from outside, in source order.
    pub params: Vec<Param>,
    /// Top-level `let`s; a `let` only uses earlier ones.
    pub lets: Vec<Let>,
    /// Users' functions; a function may only call earlier ones.
    pub functions: Vec<Function>,
    /// Blocks in source order.
    pub blocks: Vec<Block>,
}

impl Scene {
    /// The expression behind an id of this scene.
    #[must_use]
    pub fn expr(&self, id: ExprId) -> &Expr {
        &self.exprs[id.index()]
    }
}

/// A param: all numbers here are in the type's own unit (radians, seconds).
#[derive(Clone, Debug)]
pub struct Param {
    /// Its name.
    pub name: String,
    /// bool, int, float, angle, a vector or a colour.
    pub ty: Type,
    /// Default, one number per component (`true` is 1).
    pub default: Vec<f64>,
    /// Allowed range, both ends included, for scalars.
    pub range: Option<(f64, f64)>,
    /// Doc comment.
    pub doc: String,
    /// Where it is declared.
    pub span: Span,
}

/// A top-level `let`.
#[derive(Clone, Debug)]
pub struct Let {
    /// Its name.
    pub name: String,
    /// Its value.
    pub value: ExprId,
    /// Where it is declared.
    pub span: Span,
}

/// A user's function.
#[derive(Clone, Debug)]
pub struct Function {
    /// Its name.
    pub name: String,
    /// Bindings of the parameters, in order, with their types.
    pub params: Vec<(LocalId, Type)>,
    /// Type of the result; the body is converted to it.
    pub result: Type,
    /// The body.
    pub body: ExprId,
    /// Where it is declared.
    pub span: Span,
    /// The file that declares it.
    pub module: ModuleId,
}

/// A scene block with its values converted to the types of [`crate::blocks`].
#[derive(Clone, Debug)]
pub struct Block {
    /// Its kind.
    pub kind: BlockKind,
    /// Its name; empty for kinds without one.
    pub name: String,
    /// Given keys, in source order.
    pub entries: Vec<(&'static str, ExprId)>,
    /// Keyword and name.
    pub span: Span,
}

impl Block {
    /// The value of a key if the block gives it.
    #[must_use]
    pub fn entry(&self, key: &str) -> Option<ExprId> {
        self.entries.iter().find(|(name, _)| *name == key).map(|&(_, value)| value)
    }
}

/// A typed expression.
#[derive(Clone, Debug)]
pub struct Expr {
    /// What it is.
    pub kind: ExprKind,
    /// Its type.
    pub ty: Type,
    /// Where it stands.
    pub span: Span,
}

/// The kinds of typed expressions.
#[derive(Clone, Debug)]
pub enum ExprKind {
    /// A truth value.
    Bool(bool),
    /// A scalar: int, float, or angle in radians.
    Number(f64),
    /// A colour, scene-linear.
    Color([f64; 3]),
    /// Text.
    String(String),
    /// A binding.
    Local(LocalId),
    /// A top-level `let`.
    Let(LetId),
    /// A param.
    Param(ParamId),
    /// Seconds since the start of the animation.
    Time,
    /// Number of the frame.
    Frame,
    /// A vector or colour from parts, each a scalar or shorter vector, in order.
    Vector(Vec<ExprId>),
    /// Components of a vector or colour by index: `v.x`, `v.xz`.
    Swizzle(ExprId, Vec<u8>),
    /// A field of the local point `q`.
    LocalField(ExprId, LocalField),
    /// A prefix operator.
    Unary(UnaryOp, ExprId),
    /// An infix operator.
    Binary(BinaryOp, ExprId, ExprId),
    /// `if c then a else b`, both of one type.
    If(ExprId, ExprId, ExprId),
    /// Bindings, then the value.
    Block(Vec<(LocalId, ExprId)>, ExprId),
    /// A function value; fewer parameters than its type has means the last are ignored.
    Lambda(Vec<LocalId>, ExprId),
    /// A call of a user's function.
    CallFunction(FunctionId, Vec<ExprId>),
    /// A call of a built-in; a `rest` parameter gets one list.
    CallBuiltin(BuiltinId, Vec<ExprId>),
    /// A call of a function value (a parameter or `let` that holds a lambda).
    CallValue(ExprId, Vec<ExprId>),
    /// A list.
    List(Vec<ExprId>),
    /// A list of `body` for each value of the binding.
    Comprehension {
        /// The element.
        variable: LocalId,
        /// What is walked.
        over: Over,
        /// Built once per element.
        body: ExprId,
    },
    /// A bounded loop; its value is the record of the last state.
    Iterate(Box<Iterate>),
    /// A field of a record by index.
    RecordField(ExprId, u32),
    /// A key-framed value.
    Keys(Box<Keys>),
    /// One of the words of its type's choice, with one value per parameter where given.
    Choice(&'static str, Vec<Option<ExprId>>),
    /// A block by its name.
    BlockName(String),
    /// Given keys of the type's settings.
    Settings(Vec<(&'static str, ExprId)>),
    /// A conversion that the checker inserted.
    Convert(Conversion, ExprId),
    /// Already reported.
    Error,
}

/// The loop `iterate count from (state) while condition: (next)`.
#[derive(Clone, Debug)]
pub struct Iterate {
    /// Most steps, an int.
    pub count: ExprId,
    /// Bindings of the state, which `condition` and `next` see, with their first values: numbers,
    /// truth values, vectors or colours.
    pub state: Vec<(LocalId, ExprId)>,
    /// Asked before each step, a bool; the loop ends where it is false.
    pub condition: Option<ExprId>,
    /// Next values in the order of the state and of its types, from the old ones.
    pub next: Vec<ExprId>,
}

/// `keys(at, place: value, …, ease: …)`; before the first and after the last key the value stays.
#[derive(Clone, Debug)]
pub struct Keys {
    /// What runs along the keys, a float.
    pub at: ExprId,
    /// Places, each above the one before, and the values there, all of one type; at least one.
    pub keys: Vec<(f64, ExprId)>,
    /// From key to key.
    pub ease: Ease,
}

/// How a key-framed value goes from one key to the next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ease {
    /// In proportion.
    Linear,
    /// Slow at both keys: `3 u^2 - 2 u^3`.
    Smooth,
    /// The value of the key before.
    Hold,
    /// By a function from 0..1 to the share of the next key.
    Curve(ExprId),
}

/// What a comprehension walks.
#[derive(Clone, Debug)]
pub enum Over {
    /// Whole numbers from the first up to but not including the second.
    Range(ExprId, ExprId),
    /// A list.
    List(ExprId),
}

/// Conversions that need no call.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Conversion {
    /// The same number, seen as the target type: int as float, angle as float radians (only for
    /// functions that take either), vec3 as color and back.
    Retype,
    /// A scalar repeated over the components of the target vector or colour.
    Broadcast,
    /// A value as a function that ignores its arguments.
    Constant,
}

/// The fields of the local point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LocalField {
    /// The region's own coordinates, vec3.
    Local,
    /// World position, vec3.
    World,
    /// Curve parameter 0..1, float.
    T,
    /// Arc length from the start, float.
    L,
    /// Angle around the axis, angle.
    Angle,
    /// Distance from the axis over the radius: 0 at the axis, 1 at the wall, float.
    Radius,
    /// Distance to the wall, positive inside, float.
    Depth,
    /// Local volume change of the region's map, float.
    Stretch,
}

impl LocalField {
    /// All fields with their names and types.
    pub const ALL: [(Self, &'static str, Type); 8] = [
        (Self::Local, "local", Type::Vec3),
        (Self::World, "world", Type::Vec3),
        (Self::T, "t", Type::Float),
        (Self::L, "l", Type::Float),
        (Self::Angle, "angle", Type::Angle),
        (Self::Radius, "radius", Type::Float),
        (Self::Depth, "depth", Type::Float),
        (Self::Stretch, "stretch", Type::Float),
    ];

    /// What it is, with unit and range.
    #[must_use]
    pub fn doc(self) -> &'static str {
        match self {
            Self::Local => "the region's own coordinates; of a tube those of the straight cylinder",
            Self::World => "world position",
            Self::T => "curve parameter, 0 to 1 along a tube or cylinder",
            Self::L => "length from the start of a tube or cylinder, scene units",
            Self::Angle => "angle around the axis",
            Self::Radius => "0 at the axis or centre, 1 at the wall, of spheres, cylinders and tubes",
            Self::Depth => "distance to the wall, scene units, positive inside",
            Self::Stretch => "volume of a tube's map against the unit cylinder; 1 elsewhere",
        }
    }
}
