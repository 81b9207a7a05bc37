//! The operation table: every operation of the IR, defined once.
//!
//! A row says what an operation is called, what it takes and gives, what it means (f64), how it
//! acts on intervals (on the host, and as further operations), how it is differentiated, how far a conforming f32 evaluation may be from
//! its meaning, and how it is written in WGSL. The folder, the reference, the interval and error
//! evaluators, the gradient pass, the WGSL writer, the verifier and the tests read this table;
//! the CPU runtime has one kernel per row.

pub mod computed;
mod curve;
mod elementary;
mod error;
pub mod interval;
mod logic;
mod math;
mod noise;
pub(crate) mod range;
mod slope;
#[cfg(test)]
mod tests;

use crate::curve::Quadratic;
use crate::ir::ValueId;
use crate::ir::graph::Graph;
use interval::Interval;

pub(crate) use error::{from_f32, settle};
pub(crate) use noise::OCTAVES as MAX_OCTAVES;

/// Most results that an operation has.
pub const MAX_RESULTS: usize = 8;

/// Type of an operand or result.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Ty {
    /// An f32 at run time, an f64 in the reference.
    Number,
    /// A truth value.
    Bool,
}

/// The operations.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Op {
    /// a + b
    Add,
    /// a - b
    Sub,
    /// a * b
    Mul,
    /// a / b
    Div,
    /// The smaller; the second operand if they are equal.
    Min,
    /// The larger; the second operand if they are equal.
    Max,
    /// -a
    Neg,
    /// |a|
    Abs,
    /// The largest whole number not above a.
    Floor,
    /// Square root; operand not negative.
    Sqrt,
    /// Sine of radians.
    Sin,
    /// Cosine of radians.
    Cos,
    /// 2^a; 0 below -126, 2^127 above 127.
    Exp2,
    /// Base-2 logarithm; a documented finite value at and below 0.
    Log2,
    /// Arc cosine in radians; the operand is clamped to [-1, 1].
    Acos,
    /// Angle of (x, y) in radians, operands y, x; 0 at the origin.
    Atan2,
    /// a < b
    Less,
    /// a <= b
    LessEqual,
    /// a == b
    Equal,
    /// Both.
    And,
    /// Either.
    Or,
    /// The opposite.
    Not,
    /// The second operand where the first is true, else the third.
    Select,
    /// Improved Perlin noise of (x, y, z); data is the seed.
    Perlin,
    /// Perlin noise and its three partial derivatives.
    PerlinGradient,
    /// Sum of octaves: x, y, z, octaves, lacunarity, gain; data is the seed.
    Fbm,
    /// The sum and its three partial derivatives.
    FbmGradient,
    /// Improved Perlin noise of (x, y, z, w); data is the seed.
    Perlin4,
    /// Perlin noise of four coordinates and its four partial derivatives.
    Perlin4Gradient,
    /// Value noise of (x, y, z); data is the seed.
    Value,
    /// Value noise and its three partial derivatives.
    ValueGradient,
    /// Simplex noise of (x, y, z); data is the seed.
    Simplex,
    /// Simplex noise and its three partial derivatives.
    SimplexGradient,
    /// Distance from (x, y, z) to the nearest of points strewn one to a cell, at most 1; data is the seed.
    Worley,
    /// The distance and its three partial derivatives.
    WorleyGradient,
    /// Random number of the cell (floor x, floor y, floor z, floor w), 0 to below 1; data is the seed.
    Hash,
    /// Closest point of a curve to (x, y, z); data is the curve. Results: t, arc length, length of
    /// the curve, x and y in the frame, distance, overshoot, stretch.
    Closest,
    /// How the closest point of a curve moves with (x, y, z); data is the curve. Results: the unit
    /// vector from the foot to the position (0 on the curve), the unit tangent there, change of t per
    /// arc length, and of arc length per length along the tangent: 1 / stretch, at most 20, or 0 where
    /// the foot stays at an end or a corner.
    ClosestGradient,
    /// Next foot of (x, y, z) on a curve, a local minimum of the distance along it: x, y, z, the number
    /// from which on to look, the largest distance, whether the curve is closed; data is the curve.
    /// Results: number after that of the foot (the operand if there is none), t, arc length, x and y in
    /// the frame, distance (1e18 if there is none), overshoot, stretch.
    Foot,
}

impl Op {
    /// Whether the data is a curve.
    #[must_use]
    pub fn reads_curve(self) -> bool {
        matches!(self, Self::Closest | Self::ClosestGradient | Self::Foot)
    }
}

/// What rules of operations may look at beside their operands.
#[derive(Clone, Copy, Debug, Default)]
pub struct Context<'a> {
    /// The instruction's data: seed or curve.
    pub data: u32,
    /// Control points of this frame's curves, by curve index.
    pub curves: &'a [Vec<Quadratic>],
}

/// Results of an operation; entries past its result count are 0.
pub type Results<T> = [T; MAX_RESULTS];

/// Meaning in f64; truth values are 0 and 1.
pub type Meaning = fn(&[f64], Context<'_>) -> Results<f64>;

/// Bounds of the results over all operands in the given intervals.
pub type IntervalRule = fn(&[Interval], Context<'_>) -> Results<Interval>;

/// Largest distance between a conforming f32 result and the meaning at the exact operands, given
/// operands, their own errors, and the exact results. Infinite where a decision (comparison, whole
/// number, nearest foot) can fall either way; truth values have 0 or infinity.
pub type ErrorRule = fn(&[f64], &[f64], &Results<f64>, Context<'_>) -> Results<f64>;

/// Derivative of each result along one direction, from the operands, the results (one value, or
/// the tuple) and the operands' derivatives. `None` where the operation has no derivative rule; where
/// the list is short the last results have none.
pub type DerivativeRule = fn(&mut Graph, u32, &[ValueId], ValueId, &[ValueId]) -> Option<Vec<ValueId>>;

/// One row of the table.
#[derive(Clone, Copy)]
pub struct Operation {
    /// The operation.
    pub op: Op,
    /// Name in the text form.
    pub name: &'static str,
    /// Types of the operands.
    pub args: &'static [Ty],
    /// Types of the results.
    pub results: &'static [Ty],
    /// Whether the instruction's data means something.
    pub has_data: bool,
    /// Meaning.
    pub meaning: Meaning,
    /// Interval rule.
    pub interval: IntervalRule,
    /// Error rule.
    pub error: ErrorRule,
    /// Derivative rule.
    pub derivative: DerivativeRule,
    /// Range rule.
    pub(crate) range: range::RangeRule,
    /// WGSL text with `{0}`, `{1}` … for operands, `{d}` for the data, `{curve}` for
    /// where the curve is.
    pub wgsl: &'static str,
    /// What follows the WGSL value to read each result: nothing for operations with one.
    pub wgsl_extract: &'static [&'static str],
    /// Operand ranges from which tests draw, one pair per operand.
    pub domain: &'static [(f64, f64)],
}

/// All operations, in the order of [`Op`].
pub static TABLE: &[Operation] = &[
    math::ADD,
    math::SUB,
    math::MUL,
    math::DIV,
    math::MIN,
    math::MAX,
    math::NEG,
    math::ABS,
    math::FLOOR,
    elementary::SQRT,
    elementary::SIN,
    elementary::COS,
    elementary::EXP2,
    elementary::LOG2,
    elementary::ACOS,
    elementary::ATAN2,
    logic::LESS,
    logic::LESS_EQUAL,
    logic::EQUAL,
    logic::AND,
    logic::OR,
    logic::NOT,
    logic::SELECT,
    noise::PERLIN,
    noise::PERLIN_GRADIENT,
    noise::FBM,
    noise::FBM_GRADIENT,
    noise::PERLIN4,
    noise::PERLIN4_GRADIENT,
    noise::VALUE,
    noise::VALUE_GRADIENT,
    noise::SIMPLEX,
    noise::SIMPLEX_GRADIENT,
    noise::WORLEY,
    noise::WORLEY_GRADIENT,
    noise::HASH,
    curve::CLOSEST,
    curve::CLOSEST_GRADIENT,
    curve::FOOT,
];

/// The row of an operation.
#[must_use]
pub fn operation(op: Op) -> &'static Operation {
    &TABLE[op as usize]
}

/// The row with a name of the text form.
#[must_use]
pub fn by_name(name: &str) -> Option<&'static Operation> {
    TABLE.iter().find(|row| row.name == name)
}

/// Results of an operation that has one.
fn one(result: f64) -> Results<f64> {
    several(&[result])
}

/// The first results; the rest is 0.
fn several(results: &[f64]) -> Results<f64> {
    std::array::from_fn(|i| results.get(i).copied().unwrap_or(0.0))
}

/// Bounds on the result of an operation that has one.
fn one_within(result: Interval) -> Results<Interval> {
    several_within(&[result])
}

/// Bounds on the first results; the rest is 0.
fn several_within(results: &[Interval]) -> Results<Interval> {
    std::array::from_fn(|i| results.get(i).copied().unwrap_or(Interval::point(0.0)))
}
