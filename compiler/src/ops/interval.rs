//! Bounds of numbers: intervals whose every operation is rounded outward.
//!
//! In: intervals that contain the operands. Out: an interval that contains the result, even though
//! the ends are computed in plain f64: each computed end moves outward by a relative 2^-40, far more
//! than any rounding of f64. Example: `[1, 2] + [3, 4]` is `[4, 6]` and a trillionth.

use std::ops::{Add, Div, Mul, Neg, Sub};

/// By what share of itself an end moves outward.
const SHARE: f64 = 1.0 / (1u64 << 40) as f64;
/// By how much an end moves outward at least, unless it is 0, which f64 arithmetic does not make
/// from anything else.
const LEAST: f64 = 1e-300;

/// All numbers from `lo` to `hi`; either may be infinite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// The smallest.
    pub lo: f64,
    /// The largest.
    pub hi: f64,
}

impl Interval {
    /// All numbers.
    pub const EVERYTHING: Self = Self { lo: f64::NEG_INFINITY, hi: f64::INFINITY };
    /// What a truth value is if nothing is known.
    pub(super) const EITHER: Self = Self { lo: 0.0, hi: 1.0 };

    /// One number.
    #[must_use]
    pub fn point(value: f64) -> Self {
        Self::new(value, value)
    }

    /// From `lo` to `hi`; everything if they are not in order.
    #[must_use]
    pub fn new(lo: f64, hi: f64) -> Self {
        if lo <= hi { Self { lo, hi } } else { Self::EVERYTHING }
    }

    /// From `lo` to `hi`, both of which were computed and may be off by rounding.
    #[must_use]
    pub fn outward(lo: f64, hi: f64) -> Self {
        Self::new(below(lo), above(hi))
    }

    /// `middle` and what is at most `reach` from it.
    pub(super) fn around(middle: f64, reach: f64) -> Self {
        Self::outward(middle - reach, middle + reach)
    }

    /// The smallest interval that contains both.
    #[must_use]
    pub fn hull(self, other: Self) -> Self {
        Self::new(self.lo.min(other.lo), self.hi.max(other.hi))
    }

    /// What is in both; `self` if nothing is.
    pub(super) fn within(self, other: Self) -> Self {
        let (lo, hi) = (self.lo.max(other.lo), self.hi.min(other.hi));
        if lo <= hi { Self { lo, hi } } else { self }
    }

    /// Whether a number is in it.
    #[must_use]
    pub fn contains(self, value: f64) -> bool {
        self.lo <= value && value <= self.hi
    }

    /// Whether it is one number.
    pub(super) fn is_point(self) -> bool {
        self.lo == self.hi
    }

    /// Distance from one end to the other, possibly infinite.
    #[must_use]
    pub fn width(self) -> f64 {
        if self.is_point() { 0.0 } else { self.hi - self.lo }
    }

    /// Some number near the middle; finite unless the interval is one infinity.
    pub(super) fn middle(self) -> f64 {
        let (lo, hi) = (self.lo.max(-f64::MAX), self.hi.min(f64::MAX));
        lo * 0.5 + hi * 0.5
    }

    /// Largest distance of its numbers from [`Interval::middle`].
    pub(super) fn radius(self) -> f64 {
        let middle = self.middle();
        if self.is_point() { 0.0 } else { above((middle - self.lo).max(self.hi - middle)) }
    }

    /// The largest absolute value.
    #[must_use]
    pub fn magnitude(self) -> f64 {
        self.lo.abs().max(self.hi.abs())
    }

    /// Its numbers' products with themselves.
    #[must_use]
    pub fn square(self) -> Self {
        let size = self.abs();
        Self::new(below(product(size.lo, size.lo)), above(product(size.hi, size.hi)))
    }

    /// Absolute values, exact.
    #[must_use]
    pub fn abs(self) -> Self {
        let lo = if self.contains(0.0) { 0.0 } else { self.lo.abs().min(self.hi.abs()) };
        Self::new(lo, self.magnitude())
    }

    /// Image under a function that never falls and is computed with an error below 2^-40.
    #[must_use]
    pub fn increasing(self, function: impl Fn(f64) -> f64) -> Self {
        Self::outward(function(self.lo), function(self.hi))
    }

    /// Image under a function that never falls and is computed exactly.
    pub(super) fn increasing_exact(self, function: impl Fn(f64) -> f64) -> Self {
        Self::new(function(self.lo), function(self.hi))
    }
}

/// A lower bound for a number of which `value` is the rounded form.
fn below(value: f64) -> f64 {
    if value == 0.0 || value == f64::NEG_INFINITY {
        value
    } else if value.is_nan() {
        f64::NEG_INFINITY
    } else if value == f64::INFINITY {
        // What was rounded to infinity was at least this.
        f64::MAX
    } else {
        value - value.abs() * SHARE - LEAST
    }
}

/// An upper bound for a number of which `value` is the rounded form.
fn above(value: f64) -> f64 {
    -below(-value)
}

/// Product of two ends: 0 times infinity is 0, and what f64 rounds to 0 keeps its sign.
fn product(a: f64, b: f64) -> f64 {
    if a == 0.0 || b == 0.0 {
        return 0.0;
    }
    let product = a * b;
    if product == 0.0 { LEAST.copysign(product) } else { product }
}

impl Add for Interval {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self::outward(self.lo + other.lo, self.hi + other.hi)
    }
}

impl Sub for Interval {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Neg for Interval {
    type Output = Self;

    fn neg(self) -> Self {
        Self::new(-self.hi, -self.lo)
    }
}

impl Mul for Interval {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        let corners = [(self.lo, other.lo), (self.lo, other.hi), (self.hi, other.lo), (self.hi, other.hi)];
        let corners = corners.map(|(a, b)| product(a, b));
        Self::outward(
            corners.into_iter().fold(f64::INFINITY, f64::min),
            corners.into_iter().fold(f64::NEG_INFINITY, f64::max),
        )
    }
}

impl Div for Interval {
    type Output = Self;

    fn div(self, other: Self) -> Self {
        if other.contains(0.0) {
            return Self::EVERYTHING;
        }
        // An infinite end has the reciprocal 0, so this is also right for intervals without end.
        self * Self::outward(1.0 / other.hi, 1.0 / other.lo)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arithmetic_by_hand() {
        let near = |found: Interval, lo: f64, hi: f64| {
            assert!(found.contains(lo) && found.contains(hi), "{found:?} has {lo} and {hi}");
            assert!(found.lo >= lo - 1e-10 && found.hi <= hi + 1e-10, "{found:?} is near {lo} and {hi}");
        };
        let (a, b) = (Interval::new(-1.0, 2.0), Interval::new(3.0, 4.0));
        near(a + b, 2.0, 6.0);
        near(a - b, -5.0, -1.0);
        near(a * b, -4.0, 8.0);
        near(a / b, -1.0 / 3.0, 2.0 / 3.0);
        near(a.square(), 0.0, 4.0);
        near(a.abs(), 0.0, 2.0);
        near(a.hull(b), -1.0, 4.0);
        assert_eq!([a.width(), a.magnitude(), a.middle(), a.radius()], [3.0, 2.0, 0.5, above(1.5)]);
        assert_eq!(b / a, Interval::EVERYTHING);
    }

    #[test]
    fn infinite_ends() {
        let all = Interval::EVERYTHING;
        let zero = Interval::point(0.0);
        let far = Interval::new(2.0, f64::INFINITY);
        assert_eq!([all + all, all - all, all * all, far - far, all / far], [all; 5]);
        assert_eq!([all * zero, zero * all, zero + zero, zero / far], [zero; 4]);
        assert!((Interval::point(1.0) / far).contains(0.0));
        assert!((far + Interval::point(f64::MAX)).contains(f64::MAX));
        assert_eq!([all.width(), all.magnitude()], [f64::INFINITY; 2]);
        assert_eq!(all.middle(), 0.0);
        assert_eq!(Interval::new(2.0, 1.0), all);
        assert_eq!(Interval::point(f64::NAN), all);
    }

    #[test]
    fn products_that_vanish_keep_their_sign() {
        let tiny = Interval::point(1e-200) * Interval::point(-1e-200);
        assert!(tiny.lo < 0.0);
    }
}
