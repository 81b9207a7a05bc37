//! The untyped tree that the parser builds; spans everywhere.

pub(crate) mod spans;

use crate::source::Span;

/// A name with its place.
#[derive(Clone, Debug, PartialEq)]
pub struct Name {
    /// The identifier.
    pub text: String,
    /// Where it stands.
    pub span: Span,
}

/// One parsed file: the items that could be read, in order.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct File {
    /// Items in source order; items with syntax errors are missing.
    pub items: Vec<Item>,
}

/// A top-level item.
#[derive(Clone, Debug, PartialEq)]
pub struct Item {
    /// What it is.
    pub kind: ItemKind,
    /// The whole item.
    pub span: Span,
    /// Text of the `///` lines before it, without the slashes.
    pub doc: String,
}

/// The kinds of items.
#[derive(Clone, Debug, PartialEq)]
pub enum ItemKind {
    /// `import "lib/clouds.vol" as clouds`
    Import(Import),
    /// `param name: type = value in lo..hi`
    Param(Param),
    /// `let name = value`
    Let(Let),
    /// `fn name(a: T, b: T = default) -> R { let …  expr }`
    Function(Function),
    /// `camera { … }`, `light sun { … }` and so on.
    Block(Block),
}

/// Another file's functions, values and params under a name.
#[derive(Clone, Debug, PartialEq)]
pub struct Import {
    /// The path as written, relative to this file.
    pub path: String,
    /// The path in its quotes.
    pub path_span: Span,
    /// The name before the dot in `clouds.puff(…)`.
    pub alias: Name,
}

/// A value set from outside.
#[derive(Clone, Debug, PartialEq)]
pub struct Param {
    /// Its name.
    pub name: Name,
    /// Its declared type.
    pub ty: TypeExpr,
    /// The value it has when nobody sets it.
    pub default: Expr,
    /// Allowed values, both ends included.
    pub range: Option<(Expr, Expr)>,
}

/// A named value.
#[derive(Clone, Debug, PartialEq)]
pub struct Let {
    /// Its name.
    pub name: Name,
    /// Its value.
    pub value: Expr,
}

/// A user's function.
#[derive(Clone, Debug, PartialEq)]
pub struct Function {
    /// Its name.
    pub name: Name,
    /// Parameters in order.
    pub params: Vec<FunctionParam>,
    /// Declared result type.
    pub result: TypeExpr,
    /// The body, usually an [`ExprKind::Block`].
    pub body: Expr,
}

/// One parameter of a user's function.
#[derive(Clone, Debug, PartialEq)]
pub struct FunctionParam {
    /// Its name.
    pub name: Name,
    /// Its declared type.
    pub ty: TypeExpr,
    /// The value it has when a call leaves it out.
    pub default: Option<Expr>,
}

/// A scene block.
#[derive(Clone, Debug, PartialEq)]
pub struct Block {
    /// The keyword: `camera`, `light`, `object`, `medium`, `render`, `style`.
    pub keyword: Name,
    /// The block's own name where it has one.
    pub name: Option<Name>,
    /// `key: value` pairs in order.
    pub entries: Vec<Entry>,
}

/// One `key: value` pair of a block.
#[derive(Clone, Debug, PartialEq)]
pub struct Entry {
    /// The key.
    pub key: Name,
    /// The value.
    pub value: Expr,
}

/// A type as written.
#[derive(Clone, Debug, PartialEq)]
pub struct TypeExpr {
    /// Its form.
    pub kind: TypeExprKind,
    /// Where it stands.
    pub span: Span,
}

/// The forms of a written type.
#[derive(Clone, Debug, PartialEq)]
pub enum TypeExprKind {
    /// `float`, `vec3`, `shape` …
    Named(String),
    /// `[T]`
    List(Box<TypeExpr>),
    /// `(A, B) -> R`
    Function(Vec<TypeExpr>, Box<TypeExpr>),
}

/// An expression.
#[derive(Clone, Debug, PartialEq)]
pub struct Expr {
    /// What it is.
    pub kind: ExprKind,
    /// Where it stands.
    pub span: Span,
}

/// The kinds of expressions.
#[derive(Clone, Debug, PartialEq)]
pub enum ExprKind {
    /// `true`, `false`
    Bool(bool),
    /// `12`; the checker limits the magnitude.
    Int(i64),
    /// `1.5`, `2e-3`, and times: `2s`, `500ms` (seconds).
    Float(f64),
    /// `45deg`, `0.5rad`, `0.25turn`, in radians.
    Angle(f64),
    /// `#rrggbb`, still sRGB encoded, 0..=255 each.
    Color([u8; 3]),
    /// `"text"`, escapes resolved.
    String(String),
    /// A name.
    Name(String),
    /// `(x, y)`, `(x, y, z)`, `(x, y, z, w)`
    Tuple(Vec<Expr>),
    /// `(at: (1, 2, 0), #ffffff)`; legal only where settings of a style ask for it.
    NamedTuple(Vec<Argument>),
    /// `[a, b]`
    List(Vec<Expr>),
    /// `[for i in range: body]`
    Comprehension {
        /// The name bound to each element.
        variable: Name,
        /// What is walked: a [`ExprKind::Range`] or a list.
        range: Box<Expr>,
        /// The element built.
        body: Box<Expr>,
    },
    /// `a..b`; legal only where a range is asked for.
    Range(Box<Expr>, Box<Expr>),
    /// `-a`, `!a`
    Unary(UnaryOp, Box<Expr>),
    /// `a + b` and so on.
    Binary(BinaryOp, Box<Expr>, Box<Expr>),
    /// `if c then a else b`
    If(Box<Expr>, Box<Expr>, Box<Expr>),
    /// `{ let a = 1  expr }`
    Block(Vec<Let>, Box<Expr>),
    /// `t => body`, `(t, l) => body`
    Lambda(Vec<Name>, Box<Expr>),
    /// `f(a, name: b)`; the callee is an expression, mostly a name.
    Call(Box<Expr>, Vec<Argument>),
    /// `x.f(a)`, the same as `f(x, a)`.
    MethodCall(Box<Expr>, Name, Vec<Argument>),
    /// `x.field`
    Field(Box<Expr>, Name),
    /// `{ key: value, … }` as a value (nested settings of a style).
    Record(Vec<Entry>),
    /// `iterate n from (z = p) while condition: (z = z * z)`
    Iterate(Box<Iterate>),
    /// `keys(time, 0s: a, 2s: b, ease: smooth)`
    Keys(Box<Keys>),
}

/// The bounded loop.
#[derive(Clone, Debug, PartialEq)]
pub struct Iterate {
    /// Most steps.
    pub count: Expr,
    /// Names and first values of the state.
    pub state: Vec<Let>,
    /// Asked before each step; the loop ends where it is false.
    pub condition: Option<Expr>,
    /// The next values, from the old ones.
    pub next: Vec<Let>,
}

/// A key-framed value.
#[derive(Clone, Debug, PartialEq)]
pub struct Keys {
    /// What runs along the keys, mostly `time`.
    pub at: Expr,
    /// Places and the values there, in order.
    pub keys: Vec<(Expr, Expr)>,
    /// How the value goes from key to key: a word or a function.
    pub ease: Option<Expr>,
}

/// An argument of a call.
#[derive(Clone, Debug, PartialEq)]
pub struct Argument {
    /// `name:` before the value, if given.
    pub name: Option<Name>,
    /// The value.
    pub value: Expr,
}

/// Prefix operators.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum UnaryOp {
    /// `-a`
    Negate,
    /// `!a`
    Not,
}

/// Infix operators, loosest first: `||`, `&&`, comparisons, `|`, `&`, `+ -`, `* / %`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BinaryOp {
    /// `a || b`
    Or,
    /// `a && b`
    And,
    /// `a == b`
    Equal,
    /// `a != b`
    NotEqual,
    /// `a < b`
    Less,
    /// `a <= b`
    LessEqual,
    /// `a > b`
    Greater,
    /// `a >= b`
    GreaterEqual,
    /// `a | b`: union of shapes
    Union,
    /// `a & b`: intersection of shapes
    Intersection,
    /// `a + b`
    Add,
    /// `a - b`; on shapes the difference
    Subtract,
    /// `a * b`
    Multiply,
    /// `a / b`; whole numbers divide to a float
    Divide,
    /// `a % b`: `a - b * floor(a / b)`
    Modulo,
}

impl BinaryOp {
    /// The operator as written.
    #[must_use]
    pub fn symbol(self) -> &'static str {
        match self {
            Self::Or => "||",
            Self::And => "&&",
            Self::Equal => "==",
            Self::NotEqual => "!=",
            Self::Less => "<",
            Self::LessEqual => "<=",
            Self::Greater => ">",
            Self::GreaterEqual => ">=",
            Self::Union => "|",
            Self::Intersection => "&",
            Self::Add => "+",
            Self::Subtract => "-",
            Self::Multiply => "*",
            Self::Divide => "/",
            Self::Modulo => "%",
        }
    }
}
