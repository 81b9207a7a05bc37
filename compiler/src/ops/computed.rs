//! Bounds of what is computed: the interval rules, grown by what the f32 kernels may round.
//!
//! In: what each operand may be when it is computed. Out: the same of the results, true of the CPU's kernels,
//! of a conforming GPU and of the reference in f64. Example: the square of anything that is a number is
//! never below 0, and never `-0`; ten times the sine of it is at most 10.00001.
//!
//! Where nothing is known of an operation ([`Computed::UNKNOWN`]) the result may be anything, a NaN
//! included. How far kernels are off is taken twice as large as the error rules say, and a sum or product as
//! rounded either way. Rounding never passes 0, so signs are certain.

use super::elementary::{ACOS_ERROR, CIRCLE_ERROR, LOG_ERROR};
use super::error::{SMALLEST, UNIT};
use super::interval::Interval;
use super::noise::OCTAVES;
use super::{Context, MAX_RESULTS, Op, Results, operation};

/// What a value may be when it is computed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Computed {
    /// All numbers that it may be; closed under flushing to 0.
    pub(crate) interval: Interval,
    /// Whether it may be no number at all.
    pub(crate) nan: bool,
    /// Whether it may be `-0`.
    pub(crate) minus_zero: bool,
}

/// Most that a sum of octaves is larger than its terms by their rounding, with room to spare.
const SUM_SLACK: f64 = 1e-4;
/// Largest absolute value of a noise whose rounding is covered: see [`OCTAVE_ERROR`].
const OCTAVE_LARGEST: f64 = 1.036_353_811_3;
/// Twice the own error of the value of any of the noises.
const OCTAVE_ERROR: f64 = 5e-6;

impl Computed {
    /// Anything.
    pub(crate) const UNKNOWN: Self = Self { interval: Interval::EVERYTHING, nan: true, minus_zero: true };
    /// A truth value.
    const EITHER: Self = Self { interval: Interval::EITHER, nan: false, minus_zero: false };

    /// A number within an interval, as the host gives it in f64: the runtimes have it in f32.
    pub(crate) fn within(interval: Interval) -> Self {
        Self::rounded(interval, false, interval.contains(0.0))
    }

    /// A constant.
    pub(crate) fn constant(number: f64) -> Self {
        let single = crate::tape::rounded(number);
        let both = Interval::point(number).hull(Interval::point(f64::from(single)));
        let minus_zero = single == 0.0 && single.is_sign_negative();
        Self { interval: grown(both, 0.0, 0.0), nan: false, minus_zero }
    }

    /// A truth value that is known.
    pub(crate) fn truth(truth: bool) -> Self {
        Self { interval: Interval::point(f64::from(u8::from(truth))), ..Self::EITHER }
    }

    /// As a runtime has it that knows the value only in f32.
    pub(crate) fn in_single(self) -> Self {
        Self::rounded(self.interval, self.nan, self.minus_zero)
    }

    fn rounded(interval: Interval, nan: bool, minus_zero: bool) -> Self {
        Self { interval: grown(interval, 2.0 * UNIT, 0.0), nan, minus_zero }
    }

    /// The one number, bit for bit, that it always is.
    pub(crate) fn only(self) -> Option<f64> {
        let Interval { lo, hi } = self.interval;
        let sure = lo == hi && f64::from(lo as f32) == lo && !self.nan && !(lo == 0.0 && self.minus_zero);
        // Of a zero the sign is `+`: `-0` is never certain.
        sure.then_some(lo + 0.0)
    }

    /// Whether it may have its sign bit set, and whether it may be without.
    fn signs(self) -> [bool; 2] {
        [self.interval.lo < 0.0 || self.minus_zero, self.interval.hi >= 0.0]
    }

    fn is_finite(self) -> bool {
        !self.nan && self.interval.magnitude() <= f64::from(f32::MAX)
    }

    fn is_never_negative(self) -> bool {
        self.interval.lo >= 0.0 && !self.minus_zero
    }

    fn has_zero(self) -> bool {
        self.interval.contains(0.0)
    }

    /// Whether it surely is a number and without sign: then its absolute value is itself.
    pub(crate) fn is_absolute(self) -> bool {
        self.is_never_negative() && !self.nan
    }

    /// Whether this is above `other` or both are one and the same number, bit for bit, whatever they are.
    pub(crate) fn surely_above(self, other: Self) -> bool {
        let (a, b) = (self.interval, other.interval);
        let one_zero = !self.minus_zero && !other.minus_zero;
        let ordered = a.lo > b.hi || a.lo == b.hi && (a.lo != 0.0 || one_zero);
        ordered && !self.nan && !other.nan
    }

    /// Whether this is never above `other`; a NaN is not.
    pub(crate) fn never_above(self, other: Self) -> bool {
        self.interval.hi <= other.interval.lo
    }
}

/// Bounds of the first result of an operation as runtimes compute it from numbers within intervals; nothing if it
/// may be anything, or no number.
#[must_use]
pub fn bounds_of_first_result(op: Op, data: u32, operands: &[Interval]) -> Option<Interval> {
    let operand = |&interval: &Interval| {
        let nan = interval.magnitude() == f64::INFINITY;
        Computed { interval, nan, minus_zero: true }
    };
    let operands: Vec<Computed> = operands.iter().map(operand).collect();
    let found = apply(value_of(op), data, false, &operands)[0];
    (!found.nan && found.is_finite()).then_some(found.interval)
}

/// The operation that gives the first result alone.
fn value_of(op: Op) -> Op {
    match op {
        Op::PerlinGradient => Op::Perlin,
        Op::FbmGradient => Op::Fbm,
        Op::Perlin4Gradient => Op::Perlin4,
        Op::ValueGradient => Op::Value,
        Op::SimplexGradient => Op::Simplex,
        Op::WorleyGradient => Op::Worley,
        _ => op,
    }
}

/// What the results of an operation may be. `squared`: whether its two operands are one value.
pub(crate) fn apply(op: Op, data: u32, squared: bool, x: &[Computed]) -> Results<Computed> {
    let intervals: Vec<Interval> = x.iter().map(|operand| operand.interval).collect();
    let row = operation(op);
    let mut results = [Computed::UNKNOWN; MAX_RESULTS];
    // Nothing is known of control points; gradients jump, and are seldom asked about.
    if op.reads_curve() || row.results.len() > 1 {
        return results;
    }
    let exact = match op {
        Op::Fbm => octaves(&intervals),
        Op::Mul if squared => intervals[0].square(),
        _ => (row.interval)(&intervals, Context { data, curves: &[] })[0],
    };
    results[0] = one(op, squared, x, exact);
    results
}

/// The result of an operation whose exact result is within an interval.
fn one(op: Op, squared: bool, x: &[Computed], exact: Interval) -> Computed {
    let nan = x.iter().any(|operand| operand.nan);
    let keep = |interval: Interval, minus_zero: bool| Computed { interval, nan, minus_zero };
    let rounded = |relative: f64, absolute: f64| grown(exact, relative, absolute);
    match op {
        Op::Add | Op::Sub => sum(op, x, rounded(2.0 * UNIT, 0.0)),
        Op::Mul | Op::Div => product(op, squared, x, rounded(5.0 * UNIT, 0.0)),
        Op::Min | Op::Max => {
            // Of a first operand that is no number the second is left.
            let interval = if x[0].nan { exact.hull(x[1].interval) } else { exact };
            Computed { interval, nan: x[1].nan, minus_zero: x[0].minus_zero || x[1].minus_zero }
        }
        Op::Neg => keep(exact, x[0].has_zero()),
        Op::Abs => keep(exact, false),
        Op::Floor => keep(exact, x[0].minus_zero),
        // These may make a number of what is none.
        Op::Sqrt
        | Op::Exp2
        | Op::Log2
        | Op::Acos
        | Op::Atan2
        | Op::Perlin
        | Op::Perlin4
        | Op::Value
        | Op::Simplex
        | Op::Fbm
        | Op::Worley
        | Op::Hash
            if nan =>
        {
            Computed::UNKNOWN
        }
        Op::Sqrt => keep(rounded(9.0 * UNIT, 0.0), false),
        Op::Sin | Op::Cos => {
            let own = 2.0 * (CIRCLE_ERROR.0 + CIRCLE_ERROR.1 * x[0].interval.magnitude().min(1e9));
            let all = Interval::new(-1.0 - 2.0 * CIRCLE_ERROR.0, 1.0 + 2.0 * CIRCLE_ERROR.0);
            let found = Interval::new(exact.lo - own, exact.hi + own).within(all);
            Computed { interval: found, nan: !x[0].is_finite(), minus_zero: true }
        }
        Op::Exp2 => keep(rounded(8.0 * UNIT, 0.0), false),
        Op::Log2 => keep(rounded(12.0 * UNIT, 2.0 * LOG_ERROR), true),
        Op::Acos => keep(rounded(0.0, 2.0 * ACOS_ERROR), true),
        Op::Atan2 => {
            let nan = !(x[0].is_finite() && x[1].is_finite());
            Computed { interval: rounded(30.0 * UNIT, 1e-37), nan, minus_zero: true }
        }
        Op::Less | Op::LessEqual | Op::Equal if nan && exact.lo == 1.0 => Computed::EITHER,
        Op::Less | Op::LessEqual | Op::Equal | Op::And | Op::Or | Op::Not => {
            Computed { interval: exact, ..Computed::EITHER }
        }
        Op::Select => {
            let chosen = |i: usize, truth: f64| x[0].interval.contains(truth).then_some(x[i]);
            let mut sides = [chosen(1, 1.0), chosen(2, 0.0)].into_iter().flatten();
            let joined = |a: Computed, b: Computed| Computed {
                interval: a.interval.hull(b.interval),
                nan: a.nan || b.nan,
                minus_zero: a.minus_zero || b.minus_zero,
            };
            sides.next().map_or(Computed::UNKNOWN, |first| sides.fold(first, joined))
        }
        Op::Perlin | Op::Perlin4 | Op::Value | Op::Simplex | Op::Fbm | Op::Worley => {
            keep(rounded(0.0, OCTAVE_ERROR), true)
        }
        Op::Hash => keep(exact, true),
        Op::PerlinGradient
        | Op::FbmGradient
        | Op::Perlin4Gradient
        | Op::ValueGradient
        | Op::SimplexGradient
        | Op::WorleyGradient
        | Op::Closest
        | Op::ClosestGradient
        | Op::Foot => Computed::UNKNOWN,
    }
}

/// A sum or difference: no number where infinities cancel, `-0` only where both parts are.
fn sum(op: Op, x: &[Computed], interval: Interval) -> Computed {
    let second = if op == Op::Add { x[1].interval } else { -x[1].interval };
    let endless = |end: f64, other: f64| end == f64::INFINITY && other == f64::NEG_INFINITY;
    let first = x[0].interval;
    let cancels = endless(first.hi, second.lo) || endless(second.hi, first.lo);
    let minus = if op == Op::Add { x[1].minus_zero } else { x[1].has_zero() };
    Computed { interval, nan: x[0].nan || x[1].nan || cancels, minus_zero: x[0].minus_zero && minus }
}

/// A product or quotient: no number where 0 meets infinity, or its like; `-0` only of different signs.
fn product(op: Op, squared: bool, x: &[Computed], interval: Interval) -> Computed {
    let endless = |operand: Computed| operand.interval.magnitude() == f64::INFINITY;
    let unclear = match (op, squared) {
        (Op::Mul, true) => false,
        (Op::Mul, false) => x[0].has_zero() && endless(x[1]) || endless(x[0]) && x[1].has_zero(),
        // A GPU may give anything where the divisor is 0.
        _ => x[1].has_zero() || endless(x[0]) && endless(x[1]),
    };
    let ([negative, positive], [other_negative, other_positive]) = (x[0].signs(), x[1].signs());
    let differ = negative && other_positive || positive && other_negative;
    let minus_zero = !squared && differ && interval.contains(0.0);
    Computed { interval, nan: x[0].nan || x[1].nan || unclear, minus_zero }
}

/// What may come of numbers in an interval by an error relative to them and an absolute one; where that is
/// 0 the sign stays. Small ones may become 0, and large ones infinite.
fn grown(exact: Interval, relative: f64, absolute: f64) -> Interval {
    let out = |end: f64| if end.is_finite() { end.abs() * relative + absolute + SMALLEST } else { 0.0 };
    let (mut lo, mut hi) = (exact.lo - out(exact.lo), exact.hi + out(exact.hi));
    if absolute == 0.0 {
        lo = if exact.lo >= 0.0 { lo.max(0.0) } else { lo };
        hi = if exact.hi <= 0.0 { hi.min(0.0) } else { hi };
    }
    let largest = f64::from(f32::MAX);
    Interval::new(
        if lo < -largest { f64::NEG_INFINITY } else { lo },
        if hi > largest { f64::INFINITY } else { hi },
    )
}

/// Bounds of a sum of octaves by the largest amplitudes, whatever the position.
fn octaves(x: &[Interval]) -> Interval {
    // The cast holds what is no number at 0.
    let (most, gain) = (x[3].hi.min(OCTAVES).floor() as u32, x[5].magnitude());
    let (mut amplitude, mut sum) = (1.0, 0.0);
    for _ in 0..most {
        sum += amplitude * (OCTAVE_LARGEST + OCTAVE_ERROR);
        amplitude *= gain;
    }
    let reach = sum * (1.0 + SUM_SLACK);
    Interval::new(-reach, reach)
}
