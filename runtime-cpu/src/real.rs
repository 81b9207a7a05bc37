//! The numbers that a picture is made of: f32 for pictures, f64 for the reference.
//!
//! The integrator is written once over [`Real`]. In f32 every operation is the one that the WGSL
//! twin does, each rounded by itself; in f64 the elementary functions are those of the standard
//! library, so the reference shares the integrator's rules but none of its approximations.

use crate::isa::{Isa, Loop};
use crate::math::fun;
use std::fmt::Debug;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// A number type of the integrator.
pub(crate) trait Real:
    Copy
    + Debug
    + PartialOrd
    + Send
    + Sync
    + 'static
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// 0
    const ZERO: Self;
    /// 1
    const ONE: Self;
    /// An f32 as it is.
    fn from_f32(value: f32) -> Self;
    /// An f64, rounded.
    fn from_f64(value: f64) -> Self;
    /// The number as an f64, as it is.
    fn to_f64(self) -> f64;
    /// A whole number below 2^24.
    fn from_index(index: i32) -> Self;
    /// A whole number below 2^24 as an integer.
    fn to_index(self) -> i32;
    /// Square root; not of negative numbers.
    fn sqrt(self) -> Self;
    /// The largest whole number not above.
    fn floor(self) -> Self;
    /// Angle of the point (x, y), `self` being y, in -pi..pi.
    fn atan2(self, x: Self) -> Self;
    /// 2^x
    fn exp2(self) -> Self;
    /// Base-2 logarithm of a positive number.
    fn log2(self) -> Self;
    /// exp(-x), x >= 0.
    fn decay(self) -> Self;
    /// Runs a loop over many numbers, for f32 with the widest instructions of the machine.
    fn vectorized<L: Loop>(numbers: L) -> L::Out;
    /// (1 - exp(-x)) / x for x >= 0, 1 at 0: the mean transmittance over an optical depth x, of which exp(-x) is
    /// known.
    fn mean_decay(self, decay: Self) -> Self;
    /// (1 - (1 + x) exp(-x)) / x^2 for x >= 0, 1/2 at 0: the mean of u exp(-x u) over u in 0..1, by which
    /// what changes linearly with the optical depth is weighted; exp(-x) is known.
    fn decay_moment(self, decay: Self) -> Self;

    /// The smaller, the second on a tie.
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        if self < other { self } else { other }
    }

    /// The larger, the second on a tie.
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        if self > other { self } else { other }
    }

    /// Without its sign.
    fn abs(self) -> Self {
        if self < Self::ZERO { -self } else { self }
    }
}

impl Real for f32 {
    const ZERO: Self = 0.0;
    const ONE: Self = 1.0;

    #[inline(always)]
    fn from_f32(value: f32) -> Self {
        value
    }

    fn from_f64(value: f64) -> Self {
        value as Self
    }

    fn to_f64(self) -> f64 {
        f64::from(self)
    }

    #[inline(always)]
    fn from_index(index: i32) -> Self {
        index as Self
    }

    #[inline(always)]
    fn to_index(self) -> i32 {
        self as i32
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        self.sqrt()
    }

    fn atan2(self, x: Self) -> Self {
        fun::atan2(self, x)
    }

    #[inline(always)]
    fn floor(self) -> Self {
        self.floor()
    }

    fn exp2(self) -> Self {
        fun::exp2(self)
    }

    fn log2(self) -> Self {
        fun::log2(self)
    }

    #[inline(always)]
    fn decay(self) -> Self {
        fun::exp2(self * -std::f32::consts::LOG2_E)
    }

    fn vectorized<L: Loop>(numbers: L) -> L::Out {
        Isa::best().run_loop(numbers)
    }

    #[inline(always)]
    fn mean_decay(self, decay: Self) -> Self {
        let x = self;
        if x < 0.35 {
            // The series of algorithms.md §7.3, where 1 - exp(-x) would cancel.
            let tail = x * (1.0 / 120.0 - x * (1.0 / 720.0));
            1.0 - x * (0.5 - x * (1.0 / 6.0 - x * (1.0 / 24.0 - tail)))
        } else {
            (1.0 - decay) / x
        }
    }

    #[inline(always)]
    fn decay_moment(self, decay: Self) -> Self {
        let x = self;
        if x < 0.5 {
            // Sum of (-x)^k / (k! (k + 2)), where the quotient would cancel; off by less than 5e-7.
            let tail = x * (1.0 / 144.0 - x * (1.0 / 840.0 - x * (1.0 / 5760.0)));
            0.5 - x * (1.0 / 3.0 - x * (1.0 / 8.0 - x * (1.0 / 30.0 - tail)))
        } else {
            (x.mean_decay(decay) - decay) / x
        }
    }
}

impl Real for f64 {
    const ZERO: Self = 0.0;
    const ONE: Self = 1.0;

    fn from_f32(value: f32) -> Self {
        Self::from(value)
    }

    fn from_f64(value: f64) -> Self {
        value
    }

    fn to_f64(self) -> f64 {
        self
    }

    fn from_index(index: i32) -> Self {
        Self::from(index)
    }

    fn to_index(self) -> i32 {
        self as i32
    }

    fn sqrt(self) -> Self {
        self.sqrt()
    }

    fn atan2(self, x: Self) -> Self {
        f64::atan2(self, x)
    }

    fn floor(self) -> Self {
        self.floor()
    }

    fn exp2(self) -> Self {
        self.exp2()
    }

    fn log2(self) -> Self {
        self.log2()
    }

    fn decay(self) -> Self {
        (-self).exp()
    }

    fn vectorized<L: Loop>(numbers: L) -> L::Out {
        numbers.run()
    }

    fn mean_decay(self, _: Self) -> Self {
        if self > 0.0 { -(-self).exp_m1() / self } else { 1.0 }
    }

    fn decay_moment(self, decay: Self) -> Self {
        if self >= 1.0 {
            return (self.mean_decay(decay) - decay) / self;
        }
        // The same sum to the last bit: the term with x^20 / 20! is below 1e-19.
        let (mut sum, mut term) = (0.0, 1.0);
        for k in 0..20 {
            sum += term / Self::from(k + 2);
            term *= -self / Self::from(k + 1);
        }
        sum
    }
}

/// exp(-x) of many numbers x >= 0.
pub(crate) struct Decays<'a, R> {
    pub(crate) x: &'a [R],
    pub(crate) decays: &'a mut [R],
}

impl<R: Real> Loop for Decays<'_, R> {
    type Out = ();

    #[inline(always)]
    fn run(self) {
        for (decay, x) in self.decays.iter_mut().zip(self.x) {
            *decay = x.decay();
        }
    }
}

/// How many of many numbers are larger than one.
pub(crate) struct Larger<'a, R> {
    pub(crate) than: R,
    pub(crate) numbers: &'a [f32],
}

impl<R: Real> Loop for Larger<'_, R> {
    type Out = u32;

    #[inline(always)]
    fn run(self) -> u32 {
        let mut count = 0;
        for &number in self.numbers {
            count += u32::from(R::from_f32(number) > self.than);
        }
        count
    }
}

/// A point, direction or colour.
pub(crate) type Vec3<R> = [R; 3];

/// All three components alike.
#[inline(always)]
pub(crate) fn splat<R: Real>(value: R) -> Vec3<R> {
    [value; 3]
}

/// Each component as it is.
pub(crate) fn vector<R: Real>(v: [f32; 3]) -> Vec3<R> {
    v.map(R::from_f32)
}

/// a + b
#[inline(always)]
pub(crate) fn add<R: Real>(a: Vec3<R>, b: Vec3<R>) -> Vec3<R> {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

/// a - b
#[inline(always)]
pub(crate) fn sub<R: Real>(a: Vec3<R>, b: Vec3<R>) -> Vec3<R> {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// a * b, component by component.
#[inline(always)]
pub(crate) fn mul<R: Real>(a: Vec3<R>, b: Vec3<R>) -> Vec3<R> {
    [a[0] * b[0], a[1] * b[1], a[2] * b[2]]
}

/// v * k
#[inline(always)]
pub(crate) fn scale<R: Real>(v: Vec3<R>, k: R) -> Vec3<R> {
    [v[0] * k, v[1] * k, v[2] * k]
}

/// Sum of products, left to right.
#[inline(always)]
pub(crate) fn dot<R: Real>(a: Vec3<R>, b: Vec3<R>) -> R {
    (a[0] * b[0] + a[1] * b[1]) + a[2] * b[2]
}

/// Euclidean length.
#[inline(always)]
pub(crate) fn length<R: Real>(v: Vec3<R>) -> R {
    dot(v, v).sqrt()
}

/// The largest component.
#[inline(always)]
pub(crate) fn largest<R: Real>(v: Vec3<R>) -> R {
    v[0].max(v[1]).max(v[2])
}

/// The smallest component.
#[inline(always)]
pub(crate) fn smallest<R: Real>(v: Vec3<R>) -> R {
    v[0].min(v[1]).min(v[2])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mean_decay_matches_f64() {
        let mut worst: f64 = 0.0;
        for i in 0..200_000_u32 {
            let x = f64::from(i).powi(3) * 1.5e-14 + 1e-9;
            let got = (x as f32).mean_decay((x as f32).decay());
            let want = f64::from(x as f32).mean_decay(0.0);
            worst = worst.max((f64::from(got) - want).abs() / want);
        }
        // algorithms.md §7.3 measured 4.7e-7 for 1 - exp(-x).
        assert!(worst < 6e-7, "{worst:e}");
        assert_eq!(0.0_f32.mean_decay(1.0), 1.0);
    }

    #[test]
    fn decay_ends_at_zero() {
        assert_eq!(200.0_f32.decay(), 0.0);
        assert_eq!(0.0_f32.decay(), 1.0);
    }
}
