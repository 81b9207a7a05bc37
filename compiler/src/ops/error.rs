//! How far a conforming f32 evaluation can be from the exact value: the arithmetic of error rules.
//!
//! In: exact operands and bounds on their errors. Out: the exact result and a bound on its error.
//! WGSL rounds sums and products up or down as it likes (1 ulp), divides within 2.5 ulp, takes roots
//! within 4.5 ulp, and may flush numbers below 2^-126 to 0 (`algorithms.md` §8.1). An ulp of `r` is at
//! most `2 u |r|` with `u` = 2^-24. Example: `1 + 2^-30`, both exact, is off by at most 2^-23.

use crate::error_bound::Bounded;

/// Half the distance from 1 to the next f32, and a millionth of it more for the rounding of f64.
pub(super) const UNIT: f64 = (1.0 + 1.0 / 1_048_576.0) / 16_777_216.0;
/// Smallest normal f32; smaller results may become 0.
pub(super) const SMALLEST: f64 = 1.175_494_350_822_287_5e-38;
/// Largest divisor for which WGSL promises an error.
const LARGEST_DIVISOR: f64 = 8.507_059_173_023_462e37;

/// A number of the host as f32: off by its rounding, possibly flushed.
pub(crate) fn from_f32(value: f64) -> Bounded {
    let error = (f64::from(value as f32) - value).abs();
    Bounded { value, error: settle(value, error) }
}

/// The bound on a finished result: flushed to 0 if small, unbounded if it may overflow.
pub(crate) fn settle(value: f64, error: f64) -> f64 {
    let largest = value.abs() + error;
    if largest.is_nan() || largest > f64::from(f32::MAX) {
        f64::INFINITY
    } else if largest != 0.0 && value.abs() - error < SMALLEST {
        error + SMALLEST
    } else {
        error
    }
}

/// a + b
pub(super) fn add(a: Bounded, b: Bounded) -> Bounded {
    let value = a.value + b.value;
    // What f64 left of the sum; 0 if it is exact.
    let part = value - a.value;
    let left = (a.value - (value - part)) + (b.value - part);
    rounded(value, a.error + b.error, left == 0.0)
}

/// a - b
pub(super) fn sub(a: Bounded, b: Bounded) -> Bounded {
    add(a, Bounded { value: -b.value, error: b.error })
}

/// a * b
pub(super) fn mul(a: Bounded, b: Bounded) -> Bounded {
    let error = a.value.abs() * b.error + b.value.abs() * a.error + a.error * b.error;
    // Two f32 have an exact product in f64.
    rounded(a.value * b.value, error, true)
}

/// a / b
pub(super) fn div(a: Bounded, b: Bounded) -> Bounded {
    let value = a.value / b.value;
    let least = b.value.abs() - b.error;
    if !(least >= SMALLEST && b.value.abs() + b.error <= LARGEST_DIVISOR) {
        return Bounded { value, error: f64::INFINITY };
    }
    let error = (a.error + value.abs() * b.error) / least;
    let error = error + 5.0 * UNIT * (value.abs() + error);
    Bounded { value, error: settle(value, error) }
}

/// A result whose exact form is rounded up or down, unless it is an f32 already.
fn rounded(value: f64, error: f64, exact: bool) -> Bounded {
    let fits = exact && f64::from(value as f32) == value;
    let own = if error == 0.0 && fits { 0.0 } else { 2.0 * UNIT * (value.abs() + error) };
    Bounded { value, error: settle(value, error + own) }
}

/// Operand `i` with its error.
pub(super) fn operand(operands: &[f64], errors: &[f64], i: usize) -> Bounded {
    Bounded { value: operands[i], error: errors[i] }
}

/// Largest change of a function that never falls (or never rises) over `x ± error`, and the largest
/// absolute value there. Infinite if the argument may be no number at all.
pub(super) fn monotone(x: f64, error: f64, function: impl Fn(f64) -> f64) -> (f64, f64) {
    if !error.is_finite() {
        return (f64::INFINITY, f64::INFINITY);
    }
    let (here, low, high) = (function(x), function(x - error), function(x + error));
    ((high - here).abs().max((here - low).abs()), here.abs().max(low.abs()).max(high.abs()))
}

/// 0 for a decision that cannot fall the other way, else infinity.
pub(super) fn decision(sure: bool) -> f64 {
    if sure { 0.0 } else { f64::INFINITY }
}
