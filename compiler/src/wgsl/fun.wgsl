// Elementary functions in f32, the same text as `runtime-cpu/src/math/fun.rs`, where ranges,
// errors and sources stand. Needs nothing else from the module.
//
// Any finite argument gives a finite result: exp2 is 0 below -126 and holds at 127; log2 takes
// everything below 2^-126 as 2^-126; acos holds its argument within [-1, 1]; atan2(0, 0) is 0.

const VOL_SMALLEST: f32 = 1.1754944e-38;
const VOL_LARGEST: f32 = 0x1.fffffep+127f;
const VOL_TURNS_PER_RADIAN: f32 = 0.15915494;
const VOL_PI: f32 = 3.1415927;
const VOL_HALF_PI: f32 = 1.5707964;
const VOL_LOG2_E: f32 = 1.442695;
const VOL_LN_2: f32 = 0.6931472;

// `x` held within `low..=high`; `low <= high`.
fn vol_hold(x: f32, low: f32, high: f32) -> f32 {
    return min(max(x, low), high);
}

// Whole number nearest to `x`, halves upward.
fn vol_round(x: f32) -> f32 {
    return floor(x + 0.5);
}

// Two to the power `x`.
fn vol_exp2(x: f32) -> f32 {
    // Hold the argument where the result is a normal number.
    let held = vol_hold(x, -126.0, 127.0);
    // Split into a whole number and a fraction in [-1/2, 1/2].
    let n = vol_round(held);
    let f = held - n;
    // Evaluate 2^f.
    let p5 = 0.0013398875 + (f * 0.0001535336);
    let p4 = 0.009618437 + (f * p5);
    let p3 = 0.055503324 + (f * p4);
    let p2 = 0.24022648 + (f * p3);
    let p1 = 0.6931472 + (f * p2);
    let power = 1.0 + (f * p1);
    // Add n to the exponent.
    let exponent = bitcast<u32>(i32(n) << 23u);
    let scaled = bitcast<f32>(bitcast<u32>(power) + exponent);
    return select(scaled, 0.0, x < -126.0);
}

// Logarithm to base two.
fn vol_log2(x: f32) -> f32 {
    // Hold the argument among the positive normal numbers.
    let held = vol_hold(x, VOL_SMALLEST, VOL_LARGEST);
    // Split into an exponent and a mantissa in [sqrt 1/2, sqrt 2).
    let bits = bitcast<i32>(held);
    let e = (bits - 0x3f3504f3i) >> 23u;
    let m = bitcast<f32>(bits - (e << 23u));
    let f = m - 1.0;
    // Evaluate ln(1 + f).
    let p7 = -0.11675641 + (f * 0.06746601);
    let p6 = 0.11888175 + (f * p7);
    let p5 = -0.124055915 + (f * p6);
    let p4 = 0.14219551 + (f * p5);
    let p3 = -0.16667996 + (f * p4);
    let p2 = 0.20002119 + (f * p3);
    let p1 = -0.2500001 + (f * p2);
    let p0 = 0.33333314 + (f * p1);
    let ff = f * f;
    let ln = f + (ff * ((f * p0) - 0.5));
    // Change the base and add the exponent.
    return f32(e) + (ln * VOL_LOG2_E);
}

// Sine (x) and cosine (y) of the angle left after taking off quarter turns, and their number (z).
fn vol_quarter_turn(x: f32) -> vec3f {
    // Count turns and take off the whole ones: exact.
    let u = x * VOL_TURNS_PER_RADIAN;
    let t = u - vol_round(u);
    // Take off quarters: |r| <= 1/8.
    let k = vol_round(t * 4.0);
    let r = t - (k * 0.25);
    let s = r * r;
    // Evaluate both polynomials.
    let a3 = -76.69787 + (s * 41.472946);
    let a2 = 81.6052 + (s * a3);
    let a1 = -41.3417 + (s * a2);
    let a0 = 6.2831855 + (s * a1);
    let b3 = -85.442856 + (s * 59.220406);
    let b2 = 64.939316 + (s * b3);
    let b1 = -19.73921 + (s * b2);
    let b0 = 1.0 + (s * b1);
    return vec3f(r * a0, b0, k);
}

// Sine of an angle in radians.
fn vol_sin(x: f32) -> f32 {
    let q = vol_quarter_turn(x);
    let k = i32(q.z);
    // Choose by the quarter.
    let size = select(q.x, q.y, (k & 1i) != 0i);
    return select(size, -size, (k & 2i) != 0i);
}

// Cosine of an angle in radians.
fn vol_cos(x: f32) -> f32 {
    let q = vol_quarter_turn(x);
    let k = i32(q.z);
    // Choose by the quarter.
    let size = select(q.y, q.x, (k & 1i) != 0i);
    return select(size, -size, ((k + 1i) & 2i) != 0i);
}

// Angle of the point (x, y), radians in [-pi, pi].
fn vol_atan2(y: f32, x: f32) -> f32 {
    // Reduce to the first eighth of the plane.
    let ax = abs(x);
    let ay = abs(y);
    let q = min(ax, ay) / max(max(ax, ay), VOL_SMALLEST);
    let s = q * q;
    // Evaluate the arc tangent of q.
    let p7 = -0.01606848 + (s * 0.002849852);
    let p6 = 0.042691275 + (s * p7);
    let p5 = -0.07504274 + (s * p6);
    let p4 = 0.106409244 + (s * p5);
    let p3 = -0.14203642 + (s * p4);
    let p2 = 0.1999262 + (s * p3);
    let p1 = -0.33333072 + (s * p2);
    let p0 = 1.0 + (s * p1);
    let base = q * p0;
    // Undo the reduction.
    let half = select(base, VOL_HALF_PI - base, ay > ax);
    let full = select(half, VOL_PI - half, x < 0.0);
    return select(full, -full, y < 0.0);
}

// Angle whose cosine is `x`, radians in [0, pi].
fn vol_acos(x: f32) -> f32 {
    let a = min(abs(x), 1.0);
    // Evaluate for the positive half.
    let p6 = 0.006671244 + (a * -0.0012628166);
    let p5 = -0.017089743 + (a * p6);
    let p4 = 0.030893007 + (a * p5);
    let p3 = -0.0501747 + (a * p4);
    let p2 = 0.08897905 + (a * p3);
    let p1 = -0.2145988 + (a * p2);
    let p0 = 1.5707963 + (a * p1);
    let angle = sqrt(1.0 - a) * p0;
    // Mirror the negative half.
    return select(angle, VOL_PI - angle, x < 0.0);
}
