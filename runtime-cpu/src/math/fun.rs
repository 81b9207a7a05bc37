//! Elementary functions in f32, the same text as `compiler/src/wgsl/fun.wgsl`.
//!
//! In: any finite `f32`. Out: a finite `f32`, on every device the same bits as long as the device
//! rounds each operation by itself. Built from `+ - * /`, `sqrt`, `floor`, comparisons and integer
//! operations alone; nothing relies on denormals, infinities or NaN.
//!
//! Example: `exp2(-127.0)` is 0, `log2(0.0)` is -126, `atan2(0.0, 0.0)` is 0, `acos(2.0)` is 0.
//!
//! Everything is inlined by force, so that a loop over points vectorises.
//!
//! Coefficients and the bounds cited as "permitted" (any WGSL-conforming rounding):
//! `algorithms.md` §8.2, minimax fits by Lawson iteration.

/// Smallest normal f32, 2^-126: arguments below it count as it.
const SMALLEST: f32 = 1.175_494_4e-38;
/// 1 / (2 pi).
const TURNS_PER_RADIAN: f32 = 0.159_154_94;
const PI: f32 = core::f32::consts::PI;
const HALF_PI: f32 = core::f32::consts::FRAC_PI_2;

/// Smaller of two numbers, the second on a tie; compiles to one vector instruction.
#[inline(always)]
pub fn lesser(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// Larger of two numbers, the second on a tie; compiles to one vector instruction.
#[inline(always)]
pub fn greater(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// `x` held within `low..=high`; `low <= high`.
#[inline(always)]
pub fn hold(x: f32, low: f32, high: f32) -> f32 {
    lesser(greater(x, low), high)
}

/// Largest whole number not above `x`; exact, equal to `f32::floor` in every bit.
///
/// * range: any finite `x`; the sign of zero is kept
/// * method: adding 2^23 leaves no room for a fraction, then one step down where that rounded up.
///   Written out because the standard call stops a loop from vectorising on plain x86-64.
/// * test: `floor_is_exact`
#[inline(always)]
pub fn floor(x: f32) -> f32 {
    let size = x.abs();
    let nearest = ((size + 8_388_608.0) - 8_388_608.0).copysign(x);
    let down = if nearest > x { nearest - 1.0 } else { nearest };
    if size < 8_388_608.0 { down } else { x }
}

/// Whole number nearest to `x`, halves upward: `floor(x + 0.5)` on every device.
#[inline(always)]
pub fn round(x: f32) -> f32 {
    floor(x + 0.5)
}

/// The integer equal to `x`, for whole `x` with `|x| <= 2^22`.
///
/// In that range `i32(x)` of WGSL gives the same; the bits of `x + 1.5 * 2^23` hold the integer
/// and, unlike the saturating cast, cost one addition in a vector loop.
#[inline(always)]
pub fn whole_to_int(x: f32) -> i32 {
    ((x + 12_582_912.0).to_bits() as i32).wrapping_sub(0x4B40_0000)
}

/// Two to the power `x`.
///
/// * range: exactly 0 for `x < -126`; above 127 the value of 127 (1.7e38): never infinite
/// * error: 1.3 ulp for |x| <= 126 (test `exp2_error`); permitted 2 ulp
/// * method: whole and fractional part, polynomial of degree 6, exponent added to the bits
#[inline(always)]
pub fn exp2(x: f32) -> f32 {
    // Hold the argument where the result is a normal number.
    let held = hold(x, -126.0, 127.0);
    // Split into a whole number and a fraction in [-1/2, 1/2].
    let n = round(held);
    let f = held - n;
    // Evaluate 2^f.
    let p5 = 0.001_339_887_5 + f * 0.000_153_533_6;
    let p4 = 0.009_618_437 + f * p5;
    let p3 = 0.055_503_324 + f * p4;
    let p2 = 0.240_226_48 + f * p3;
    let p1 = core::f32::consts::LN_2 + f * p2;
    let power = 1.0 + f * p1;
    // Add n to the exponent.
    let scaled = f32::from_bits(power.to_bits().wrapping_add((whole_to_int(n) << 23) as u32));
    if x < -126.0 { 0.0 } else { scaled }
}

/// Logarithm to base two.
///
/// * range: arguments below 2^-126, zero and negative ones included, count as 2^-126: result -126;
///   arguments above the largest finite f32 count as it
/// * error: 1.7 ulp, and 1.2e-7 absolute within [1/2, 2] (test `log2_error`); permitted 3 ulp or
///   1.5e-7
/// * method: mantissa in [sqrt 1/2, sqrt 2), polynomial of degree 11
#[inline(always)]
pub fn log2(x: f32) -> f32 {
    // Hold the argument among the positive normal numbers.
    let held = hold(x, SMALLEST, f32::MAX);
    // Split into an exponent and a mantissa in [sqrt 1/2, sqrt 2).
    let bits = held.to_bits() as i32;
    let e = (bits - 0x3f35_04f3) >> 23;
    let m = f32::from_bits((bits - (e << 23)) as u32);
    let f = m - 1.0;
    // Evaluate ln(1 + f).
    let p7 = -0.116_756_41 + f * 0.067_466_01;
    let p6 = 0.118_881_75 + f * p7;
    let p5 = -0.124_055_915 + f * p6;
    let p4 = 0.142_195_51 + f * p5;
    let p3 = -0.166_679_96 + f * p4;
    let p2 = 0.200_021_19 + f * p3;
    let p1 = -0.250_000_1 + f * p2;
    let p0 = 0.333_333_14 + f * p1;
    let ff = f * f;
    let ln = f + (ff * ((f * p0) - 0.5));
    // Change the base and add the exponent.
    (e as f32) + (ln * core::f32::consts::LOG2_E)
}

/// Sine and cosine of the first eighth of a turn around a quarter, and the quarter's number.
#[inline(always)]
fn quarter_turn(x: f32) -> (f32, f32, i32) {
    // Count turns and take off the whole ones: exact.
    let u = x * TURNS_PER_RADIAN;
    let t = u - round(u);
    // Take off quarters: |r| <= 1/8.
    let k = round(t * 4.0);
    let r = t - (k * 0.25);
    let s = r * r;
    // Evaluate both polynomials.
    let a3 = -76.697_87 + s * 41.472_946;
    let a2 = 81.605_2 + s * a3;
    let a1 = -41.341_7 + s * a2;
    let a0 = 6.283_185_5 + s * a1;
    let b3 = -85.442_856 + s * 59.220_406;
    let b2 = 64.939_316 + s * b3;
    let b1 = -19.739_21 + s * b2;
    let b0 = 1.0 + s * b1;
    (r * a0, b0, whole_to_int(k))
}

/// Sine of an angle.
///
/// * `x`: radians, finite; beyond 5e7 the reduction has no fraction left and the result is 0
/// * range: within ±1.0000001
/// * error: 2^-22 + |x| 2^-23 absolute (test `sine_and_cosine_error`), mostly the reduction by one
///   rounded product
#[inline(always)]
pub fn sin(x: f32) -> f32 {
    let (sine, cosine, k) = quarter_turn(x);
    // Choose by the quarter.
    let size = if (k & 1) != 0 { cosine } else { sine };
    if (k & 2) != 0 { -size } else { size }
}

/// Cosine of an angle; rules and error as [`sin`], 1 where the reduction has no fraction left.
#[inline(always)]
pub fn cos(x: f32) -> f32 {
    let (sine, cosine, k) = quarter_turn(x);
    // Choose by the quarter.
    let size = if (k & 1) != 0 { sine } else { cosine };
    if ((k + 1) & 2) != 0 { -size } else { size }
}

/// Angle of the point `(x, y)`, radians in [-pi, pi].
///
/// * degenerate: `atan2(0, 0) = 0`; the sign of a zero is ignored, so `atan2(-0, -1) = +pi`
/// * error: 3 ulp (test `atan2_error`); permitted 5 ulp + 2.5 ulp of the division
/// * method: odd polynomial of degree 17 in min/max
#[inline(always)]
pub fn atan2(y: f32, x: f32) -> f32 {
    // Reduce to the first eighth of the plane.
    let ax = x.abs();
    let ay = y.abs();
    let q = lesser(ax, ay) / greater(greater(ax, ay), SMALLEST);
    let s = q * q;
    // Evaluate the arc tangent of q.
    let p7 = -0.016_068_48 + s * 0.002_849_852;
    let p6 = 0.042_691_275 + s * p7;
    let p5 = -0.075_042_74 + s * p6;
    let p4 = 0.106_409_244 + s * p5;
    let p3 = -0.142_036_42 + s * p4;
    let p2 = 0.199_926_2 + s * p3;
    let p1 = -0.333_330_72 + s * p2;
    let p0 = 1.0 + s * p1;
    let base = q * p0;
    // Undo the reduction.
    let half = if ay > ax { HALF_PI - base } else { base };
    let full = if x < 0.0 { PI - half } else { half };
    if y < 0.0 { -full } else { full }
}

/// Angle whose cosine is `x`, radians in [0, pi].
///
/// * range: the argument is held within [-1, 1]
/// * error: 4.5e-7 absolute (test `acos_error`); permitted 8e-7
/// * method: `sqrt(1 - |x|)` times a polynomial of degree 7
#[inline(always)]
#[expect(clippy::approx_constant, reason = "the fitted coefficient is one step below pi / 2")]
pub fn acos(x: f32) -> f32 {
    let a = lesser(x.abs(), 1.0);
    // Evaluate for the positive half.
    let p6 = 0.006_671_244 + a * -0.001_262_816_6;
    let p5 = -0.017_089_743 + a * p6;
    let p4 = 0.030_893_007 + a * p5;
    let p3 = -0.050_174_7 + a * p4;
    let p2 = 0.088_979_05 + a * p3;
    let p1 = -0.214_598_8 + a * p2;
    let p0 = 1.570_796_3 + a * p1;
    let angle = (1.0 - a).sqrt() * p0;
    // Mirror the negative half.
    if x < 0.0 { PI - angle } else { angle }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SAMPLES: usize = 300_000;

    /// `SAMPLES` numbers spread evenly over an interval, ends included, jittered by a hash.
    fn spread(low: f64, high: f64) -> impl Iterator<Item = f32> {
        (0..SAMPLES).map(move |i| {
            let jitter = f64::from((i as u32).wrapping_mul(0x9e37_79b1) >> 8) / 16_777_216.0;
            let share = (i as f64 + jitter) / SAMPLES as f64;
            (low + (high - low) * share) as f32
        })
    }

    /// Distance between two numbers in units of the f32 spacing at the true one.
    fn ulps(found: f32, truth: f64) -> f64 {
        let size = (truth.abs() as f32).max(SMALLEST);
        let spacing = f64::from(f32::from_bits(size.to_bits() + 1)) - f64::from(size);
        (f64::from(found) - truth).abs() / spacing
    }

    #[test]
    fn floor_is_exact() {
        let edges = [0.0, -0.0, 0.5, -0.5, 1.0, -1.0, 0.99999994, -1e-30, 8388607.5, -8388607.5];
        let big = [8388608.0, -8388609.0, 3e9, -3e38, 4194303.5, -4194304.5];
        for x in edges.into_iter().chain(big).chain(spread(-9e6, 9e6)).chain(spread(-3.0, 3.0)) {
            assert_eq!(floor(x).to_bits(), x.floor().to_bits(), "floor({x})");
        }
        for x in [0.0, -1.0, 4_194_304.0, -4_194_304.0, 123_456.0] {
            assert_eq!(whole_to_int(x), x as i32);
        }
    }

    #[test]
    fn exp2_error() {
        let error = |x: f32| ulps(exp2(x), f64::from(x).exp2());
        let near = spread(-20.0, 20.0).map(error).fold(0.0, f64::max);
        let all = spread(-126.0, 127.0).map(error).fold(0.0, f64::max);
        assert!(near <= 1.3 && all <= 1.3, "{near} {all} ulp");
        assert_eq!([exp2(0.0), exp2(-1.0), exp2(10.0), exp2(-126.0)], [1.0, 0.5, 1024.0, SMALLEST]);
        assert_eq!([exp2(-126.00001), exp2(-1e30), exp2(1e30)], [0.0, 0.0, exp2(127.0)]);
    }

    #[test]
    fn log2_error() {
        let of_power = |e: f32| f64::from(e).exp2() as f32;
        let wide = |x: f32| ulps(log2(x), f64::from(x).log2());
        let worst = spread(-126.0, 127.9).map(of_power).map(wide).fold(0.0, f64::max);
        let near = |x: f32| (f64::from(log2(x)) - f64::from(x).log2()).abs();
        let unit = spread(0.5, 2.0).map(near).fold(0.0, f64::max);
        assert!(worst <= 1.7 && unit <= 1.2e-7, "{worst} ulp, {unit}");
        assert_eq!([log2(1.0), log2(8.0), log2(0.0), log2(-3.0)], [0.0, 3.0, -126.0, -126.0]);
        assert_eq!([log2(1e-45), log2(f32::INFINITY)], [-126.0, log2(f32::MAX)]);
    }

    #[test]
    fn sine_and_cosine_error() {
        for reach in [3.2, 100.0, 1e4] {
            for x in spread(-reach, reach) {
                let bound = 2f64.powi(-22) + f64::from(x.abs()) * 2f64.powi(-23);
                let (s, c) = f64::from(x).sin_cos();
                assert!((f64::from(sin(x)) - s).abs() <= bound, "sin {x}");
                assert!((f64::from(cos(x)) - c).abs() <= bound, "cos {x}");
            }
        }
        let worst = |f: fn(f32) -> f32, g: fn(f64) -> f64| {
            spread(-3.1415925, 3.1415925)
                .map(|x| (f64::from(f(x)) - g(f64::from(x))).abs())
                .fold(0.0, f64::max)
        };
        let (s, c) = (worst(sin, f64::sin), worst(cos, f64::cos));
        assert!(s <= 2.6e-7 && c <= 2.6e-7, "{s} {c}");
        for x in [1e7, 5e7, 1e9, 3e38, -3e38] {
            assert!(sin(x).abs() <= 1.0000002 && cos(x).abs() <= 1.0000002);
        }
        assert_eq!([sin(0.0), cos(0.0), sin(1e30), cos(1e30)], [0.0, 1.0, 0.0, 1.0]);
    }

    #[test]
    fn atan2_error() {
        let mut worst: f64 = 0.0;
        for angle in spread(-std::f64::consts::PI, std::f64::consts::PI) {
            for radius in [1.0, 1e-20, 3e30] {
                let (x, y) = (angle.cos() * radius, angle.sin() * radius);
                worst = worst.max(ulps(atan2(y, x), f64::from(y).atan2(f64::from(x))));
            }
        }
        assert!(worst <= 3.0, "{worst} ulp");
        assert_eq!([atan2(0.0, 0.0), atan2(-0.0, 0.0), atan2(0.0, 1.0)], [0.0; 3]);
        assert_eq!([atan2(0.0, -1.0), atan2(-0.0, -1.0), atan2(2.0, 0.0)], [PI, PI, HALF_PI]);
    }

    #[test]
    fn acos_error() {
        let error = |x: f32| (f64::from(acos(x)) - f64::from(x).acos()).abs();
        let worst = spread(-1.0, 1.0).map(error).fold(0.0, f64::max);
        assert!(worst <= 4.5e-7, "{worst}");
        assert_eq!([acos(1.0), acos(2.0), acos(-1.0), acos(-7.0)], [0.0, 0.0, PI, PI]);
    }
}
