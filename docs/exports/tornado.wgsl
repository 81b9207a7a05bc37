// tornado.vol, translated by vol 0.1.0
// The scene at 0 s with the params it was translated with.
// To be called:
//   distance(p: vec3f) -> f32: Bound on the distance to the nearest object, negative inside, scene units.
//   density(p: vec3f) -> f32: Sum of the densities of all media.
//   radiance(origin: vec3f, direction: vec3f) -> vec4f: Scene-linear radiance along a ray from the camera or another place outside the objects, and what it hides of what is behind.
//   pixel(place: vec2f) -> vec4f: The same through a place of the picture, in pixels from its upper left corner.
//   distance_cloud(p: vec3f) -> f32: The field `distance:cloud` of the scene.
//   density_cloud(p: vec3f) -> f32: The field `density:cloud` of the scene.
//   colour_cloud(p: vec3f) -> vec3f: The field `colour:cloud` of the scene.
//   local_cloud(p: vec3f) -> vec3f: The field `local:cloud` of the scene.

var<private> vol_uniforms: array<vec4<f32>, 7> = array<vec4<f32>, 7>(
  vec4<f32>(0.0f, 0.0033465358f, 0.0051815165f, 0.014443844f),
  vec4<f32>(10.0f, 30.0f, 1.0f, 1.1f),
  vec4<f32>(4.5f, 0.6981317f, 0.0f, 0.4f),
  vec4<f32>(0.2f, 2.2f, 1.5609045f, 0.69090724f),
  vec4<f32>(1000000000000000.0f, 0.6f, 0.5264106f, 0.79870445f),
  vec4<f32>(1.1264106f, 5.0f, 0.0f, 0.0f),
  vec4<f32>((-0.4f), 0.8f, 0.3f, 12.0f),
);
fn vol_uniform_word(index: u32) -> f32 { return vol_uniforms[index >> 2u][index & 3u]; }
var<private> vol_curves: array<vec4<f32>, 45> = array<vec4<f32>, 45>(
  vec4<f32>(0.2f, 1.1f, 0.1f, (-2.9802323e-9f)),
  vec4<f32>((-2.3841858e-8f), (-1.4901161e-9f), 0.0f, (-0.55f)),
  vec4<f32>(0.0f, (-0.2f), 0.0f, (-0.1f)),
  vec4<f32>(0.0f, 1.0f, 0.0f, (-0.029880034f)),
  vec4<f32>(0.0f, 0.9995535f, 0.9995535f, 0.0f),
  vec4<f32>(0.029880034f, 0.055f, 0.0f, (-0.11f)),
  vec4<f32>(0.05f, 0.0f, 0.3025f, 0.0f),
  vec4<f32>(20.0f, 0.5f, (-0.5f), 1.1295928f),
  vec4<f32>((-1.0f), 0.2236068f, 1.3528211f, 0.12298374f),
  vec4<f32>(0.0f, 0.0f, 1.0f, 2.2591856f),
  vec4<f32>(0.0f, 0.0f, 0.0f, 0.0f),
  vec4<f32>(0.0f, 0.0f, 0.33686078f, 0.9263671f),
  vec4<f32>(0.16843039f, (-0.33686078f), 0.9263671f, (-0.16843039f)),
  vec4<f32>((-4.5778493e-6f), (-4.598711e-6f), (-4.576359e-6f), 0.20000459f),
  vec4<f32>(1.1000047f, 0.10000458f, 0.0f, 0.0f),
  vec4<f32>(0.2f, 1.1f, 0.1f, (-2.9802323e-9f)),
  vec4<f32>((-2.3841858e-8f), (-1.4901161e-9f), 0.0f, 0.55f),
  vec4<f32>(0.0f, (-0.2f), 0.0f, (-0.1f)),
  vec4<f32>(0.0f, 1.0f, 0.0f, (-0.029880034f)),
  vec4<f32>(0.0f, 0.9995535f, 0.9995535f, 0.0f),
  vec4<f32>(0.029880034f, (-0.055f), 0.0f, 0.11f),
  vec4<f32>(0.05f, 0.0f, 0.3025f, 0.0f),
  vec4<f32>(20.0f, 0.5f, 0.5f, 1.1295928f),
  vec4<f32>(1.0f, 0.2236068f, 1.3528211f, 0.12298374f),
  vec4<f32>(0.0f, 1.0f, 0.0f, 2.2591856f),
  vec4<f32>(0.0f, 2.2f, 0.0f, 0.0f),
  vec4<f32>((-4.7683717e-8f), 0.0f, (-0.33686078f), 0.9263671f),
  vec4<f32>((-0.16843039f), 0.0f, 1.0f, 0.0f),
  vec4<f32>((-4.5778493e-6f), 1.0999953f, (-4.576359e-6f), 0.20000459f),
  vec4<f32>(2.2000048f, 0.10000458f, 0.0f, 0.0f),
  vec4<f32>(0.0f, 0.0f, 0.0f, 0.0f),
  vec4<f32>(0.0f, 0.0f, 0.0f, 0.0f),
  vec4<f32>(0.0f, 0.0f, 0.0f, 0.0f),
  vec4<f32>(0.0f, 0.0f, 0.0f, 0.0f),
  vec4<f32>(0.0f, 0.0f, 0.0f, 0.0f),
  vec4<f32>(0.0f, 0.0f, 0.0f, 0.0f),
  vec4<f32>(0.0f, 0.0f, 0.0f, 0.0f),
  vec4<f32>(0.0f, 0.0f, 0.0f, 0.0f),
  vec4<f32>(0.0f, 0.0f, 0.0f, 0.0f),
  vec4<f32>(0.0f, 0.0f, 0.0f, 0.0f),
  vec4<f32>(0.0f, 0.0f, 0.0f, 0.0f),
  vec4<f32>(0.0f, 0.0f, 0.0f, 0.0f),
  vec4<f32>(0.0f, 0.0f, 0.0f, 0.0f),
  vec4<f32>(0.0f, 0.0f, 0.0f, 0.0f),
  vec4<f32>(0.0f, 0.0f, 0.0f, 0.0f),
);
fn vol_curve_word(index: u32) -> f32 { return vol_curves[index >> 2u][index & 3u]; }
var<private> vol_permutation: array<vec4<u32>, 64> = array<vec4<u32>, 64>(
  vec4<u32>(151u, 160u, 137u, 91u),
  vec4<u32>(90u, 15u, 131u, 13u),
  vec4<u32>(201u, 95u, 96u, 53u),
  vec4<u32>(194u, 233u, 7u, 225u),
  vec4<u32>(140u, 36u, 103u, 30u),
  vec4<u32>(69u, 142u, 8u, 99u),
  vec4<u32>(37u, 240u, 21u, 10u),
  vec4<u32>(23u, 190u, 6u, 148u),
  vec4<u32>(247u, 120u, 234u, 75u),
  vec4<u32>(0u, 26u, 197u, 62u),
  vec4<u32>(94u, 252u, 219u, 203u),
  vec4<u32>(117u, 35u, 11u, 32u),
  vec4<u32>(57u, 177u, 33u, 88u),
  vec4<u32>(237u, 149u, 56u, 87u),
  vec4<u32>(174u, 20u, 125u, 136u),
  vec4<u32>(171u, 168u, 68u, 175u),
  vec4<u32>(74u, 165u, 71u, 134u),
  vec4<u32>(139u, 48u, 27u, 166u),
  vec4<u32>(77u, 146u, 158u, 231u),
  vec4<u32>(83u, 111u, 229u, 122u),
  vec4<u32>(60u, 211u, 133u, 230u),
  vec4<u32>(220u, 105u, 92u, 41u),
  vec4<u32>(55u, 46u, 245u, 40u),
  vec4<u32>(244u, 102u, 143u, 54u),
  vec4<u32>(65u, 25u, 63u, 161u),
  vec4<u32>(1u, 216u, 80u, 73u),
  vec4<u32>(209u, 76u, 132u, 187u),
  vec4<u32>(208u, 89u, 18u, 169u),
  vec4<u32>(200u, 196u, 135u, 130u),
  vec4<u32>(116u, 188u, 159u, 86u),
  vec4<u32>(164u, 100u, 109u, 198u),
  vec4<u32>(173u, 186u, 3u, 64u),
  vec4<u32>(52u, 217u, 226u, 250u),
  vec4<u32>(124u, 123u, 5u, 202u),
  vec4<u32>(38u, 147u, 118u, 126u),
  vec4<u32>(255u, 82u, 85u, 212u),
  vec4<u32>(207u, 206u, 59u, 227u),
  vec4<u32>(47u, 16u, 58u, 17u),
  vec4<u32>(182u, 189u, 28u, 42u),
  vec4<u32>(223u, 183u, 170u, 213u),
  vec4<u32>(119u, 248u, 152u, 2u),
  vec4<u32>(44u, 154u, 163u, 70u),
  vec4<u32>(221u, 153u, 101u, 155u),
  vec4<u32>(167u, 43u, 172u, 9u),
  vec4<u32>(129u, 22u, 39u, 253u),
  vec4<u32>(19u, 98u, 108u, 110u),
  vec4<u32>(79u, 113u, 224u, 232u),
  vec4<u32>(178u, 185u, 112u, 104u),
  vec4<u32>(218u, 246u, 97u, 228u),
  vec4<u32>(251u, 34u, 242u, 193u),
  vec4<u32>(238u, 210u, 144u, 12u),
  vec4<u32>(191u, 179u, 162u, 241u),
  vec4<u32>(81u, 51u, 145u, 235u),
  vec4<u32>(249u, 14u, 239u, 107u),
  vec4<u32>(49u, 192u, 214u, 31u),
  vec4<u32>(181u, 199u, 106u, 157u),
  vec4<u32>(184u, 84u, 204u, 176u),
  vec4<u32>(115u, 121u, 50u, 45u),
  vec4<u32>(127u, 4u, 150u, 254u),
  vec4<u32>(138u, 236u, 205u, 93u),
  vec4<u32>(222u, 114u, 67u, 29u),
  vec4<u32>(24u, 72u, 243u, 141u),
  vec4<u32>(128u, 195u, 78u, 66u),
  vec4<u32>(215u, 61u, 156u, 180u),
);
fn vol_permutation_word(index: u32) -> u32 { return vol_permutation[index >> 2u][index & 3u]; }
var<private> vol_frame: array<vec4<f32>, 43> = array<vec4<f32>, 43>(
  vec4<f32>(0.0f, 0.0f, 960.0f, 540.0f),
  vec4<f32>(960.0f, 540.0f, 0.004680485f, 0.00936097f),
  vec4<f32>(0.0f, 1.1f, 4.5f, 0.0f),
  vec4<f32>(0.0f, (-1.0f), 0.6470582f, 0.0f),
  vec4<f32>(0.0f, 0.0f, 0.36397022f, 0.0f),
  vec4<f32>(0.0033465358f, 0.0051815165f, 0.014443844f, 1.0f),
  vec4<f32>(1.0f, 0.0f, 1.0f, 3.0f),
  vec4<f32>((-0.60002863f), (-0.60002863f), (-0.60002863f), 1.000029f),
  vec4<f32>(2.8000307f, 0.8000288f, 16.0f, 1.0f),
  vec4<f32>(1.0f, (-0.42399916f), 0.8479983f, 0.31799936f),
  vec4<f32>(12.0f, 12.0f, 12.0f, 1.0f),
  vec4<f32>(0.0f, 0.0f, 0.0f, 0.0f),
  vec4<f32>(0.0f, 0.0f, 0.0f, 0.0f),
  vec4<f32>(0.0f, 0.0f, 0.0f, 0.0f),
  vec4<f32>(0.0f, 0.0f, 0.0f, 0.0f),
  vec4<f32>(0.0f, 0.0f, 0.0f, 0.0f),
  vec4<f32>(0.0f, 0.0f, 0.0f, 0.0f),
  vec4<f32>(0.0f, 0.0f, 0.0f, 0.0f),
  vec4<f32>(0.0f, 0.0f, 0.0f, 0.0f),
  vec4<f32>((-0.07849332f), (-0.03100111f), (-0.08124195f), 0.12536836f),
  vec4<f32>(0.16850124f, 0.10467947f, (-0.038403668f), 0.107851274f),
  vec4<f32>((-0.064069755f), 0.1727788f, 0.3046489f, 0.13125731f),
  vec4<f32>((-0.008553555f), 0.24621235f, (-0.05407174f), 0.21792875f),
  vec4<f32>(0.44128785f, 0.15875934f, 0.010998466f, 0.3846571f),
  vec4<f32>((-0.051262047f), 0.26087677f, 0.57784307f, 0.18719967f),
  vec4<f32>(0.020236308f, 0.52379215f, (-0.05564443f), 0.30163896f),
  vec4<f32>(0.71370804f, 0.21658209f, 0.019191828f, 0.6642433f),
  vec4<f32>((-0.067210674f), 0.3401835f, 0.84825695f, 0.24689835f),
  vec4<f32>(0.007948153f, 0.8066414f, (-0.08580606f), 0.3764272f),
  vec4<f32>(0.98085874f, 0.27799374f, (-0.0131498f), 0.9516064f),
  vec4<f32>((-0.1115874f), 0.41002518f, 1.1108938f, 0.3100251f),
  vec4<f32>((-0.04768115f), 1.087319f, (-0.14611875f), 0.44455653f),
  vec4<f32>(1.2501811f, 0.34455645f, (-0.0956435f), 1.2085621f),
  vec4<f32>((-0.1894001f), 0.48001888f, 1.403938f, 0.3815878f),
  vec4<f32>((-0.15293887f), 1.3255475f, (-0.23986568f), 0.5123142f),
  vec4<f32>(1.5619527f, 0.41955334f, (-0.21955688f), 1.4378978f),
  vec4<f32>((-0.29706544f), 0.5414322f, 1.7246025f, 0.4580031f),
  vec4<f32>((-0.29523104f), 1.5453081f, (-0.36114627f), 0.5671063f),
  vec4<f32>(1.8921922f, 0.4970839f, (-0.37969407f), 1.6475452f),
  vec4<f32>((-0.43204588f), 0.5890693f, 2.0649552f, 0.53673345f),
  vec4<f32>((-0.47268757f), 1.7444439f, (-0.5097059f), 0.6070627f),
  vec4<f32>(2.2430565f, 0.57689345f, (-0.5739689f), 1.8359008f),
  vec4<f32>((-0.5940731f), 0.62084395f, 2.4265997f, 0.6175107f),
);
fn vol_frame_word(index: u32) -> f32 { return vol_frame[index >> 2u][index & 3u]; }
var<private> vol_input: array<vec4<f32>, 1> = array<vec4<f32>, 1>(
  vec4<f32>(0.0f, 0.0f, 0.0f, 0.0f),
);
fn vol_input_word(index: u32) -> f32 { return vol_input[index >> 2u][index & 3u]; }

const VOL_CURVES: u32 = 1u;

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

// Noises in f32, the same text as `runtime-cpu/src/math/noise.rs`, where ranges, errors and
// sources stand. Needs `fun.wgsl` and `vol_permutation_word(index: u32) -> u32` (256 words,
// `noise_table::permutation_words`).

// Coordinates are held within +- this, where f32 has a fraction left and the cell is an exact i32.
const VOL_FIELD: f32 = 4194303.0;
// Coordinates of a hash are held within +- this.
const VOL_WHOLES: f32 = 16777216.0;
// Running products of an octave sum are held within +- this, so that no octave overflows.
const VOL_PRODUCT: f32 = 1.0995116e12;
// Most octaves a sum may have.
const VOL_OCTAVES: f32 = 32.0;

// One lattice cell: its whole coordinates, the place inside it, and the fade weights there.
struct Vol_Cell {
    corner: vec3i,
    place: vec3f,
    fade: vec3f,
}

// Find the cell of a point.
fn vol_cell_of(p: vec3f) -> Vol_Cell {
    let held = vec3f(
        vol_hold(p.x, -VOL_FIELD, VOL_FIELD),
        vol_hold(p.y, -VOL_FIELD, VOL_FIELD),
        vol_hold(p.z, -VOL_FIELD, VOL_FIELD),
    );
    let whole = floor(held);
    let place = held - whole;
    let weights = vec3f(vol_fade(place.x), vol_fade(place.y), vol_fade(place.z));
    return Vol_Cell(vec3i(whole), place, weights);
}

// Weight `6 t^5 - 15 t^4 + 10 t^3`, t in [0, 1], written about the middle of the cell.
fn vol_fade(t: f32) -> f32 {
    let s = t - 0.5;
    let ss = s * s;
    return 0.5 + (s * (1.875 - (ss * (5.0 - (6.0 * ss)))));
}

// Derivative of the weight, `30 (t (1 - t))^2`, about the middle of the cell as well.
fn vol_fade_slope(t: f32) -> f32 {
    let s = t - 0.5;
    let ss = s * s;
    return 1.875 - (ss * (15.0 - (30.0 * ss)));
}

fn vol_lerp(t: f32, a: f32, b: f32) -> f32 {
    return a + (t * (b - a));
}

fn vol_lerp3(t: f32, a: vec3f, b: vec3f) -> vec3f {
    return a + (t * (b - a));
}

// Dot product of the edge gradient `code & 15` with an offset: the author's rule.
fn vol_edge_value(code: u32, x: f32, y: f32, z: f32) -> f32 {
    let u = select(y, x, code < 8u);
    let v = select(select(z, x, (code & 13u) == 12u), y, code < 4u);
    let signed_u = select(u, -u, (code & 1u) != 0u);
    let signed_v = select(v, -v, (code & 2u) != 0u);
    return signed_u + signed_v;
}

// The edge gradient itself, two of three components +-1.
fn vol_edge_vector(code: u32) -> vec3f {
    let signed_u = select(1.0, -1.0, (code & 1u) != 0u);
    let signed_v = select(1.0, -1.0, (code & 2u) != 0u);
    let wraps = (code & 13u) == 12u;
    let x = select(select(0.0, signed_v, wraps), signed_u, code < 8u);
    let y = select(select(signed_u, 0.0, code < 8u), signed_v, code < 4u);
    let z = select(signed_v, 0.0, (code < 4u) | wraps);
    return vec3f(x, y, z);
}

// One entry of the published permutation.
fn vol_permuted(i: i32) -> i32 {
    return i32(vol_permutation_word(u32(i & 255i)));
}

// Gradient code of a cell from the permutation: `P[P[P[x] + y] + z] & 15`.
fn vol_table_cell(x: i32, y: i32, z: i32) -> u32 {
    let by_x = vol_permuted(x);
    let by_y = vol_permuted(by_x + y);
    let by_z = vol_permuted(by_y + z);
    return u32(by_z) & 15u;
}

// Gradient code of a cell from an integer hash.
fn vol_hash_cell(x: i32, y: i32, z: i32, seed: u32) -> u32 {
    return vol_mixed(vol_spread(x, y, z, seed)) >> 28u;
}

// 32 random bits of a cell of four-dimensional space.
fn vol_hash_word(x: i32, y: i32, z: i32, w: i32, seed: u32) -> u32 {
    let fourth = (bitcast<u32>(w) * 0xc2b2ae35u) ^ 0x27d4eb2fu;
    let word = vol_mixed(vol_spread(x, y, z, seed) ^ fourth);
    return word ^ (word >> 16u);
}

// Spread three coordinates and a seed and join them.
fn vol_spread(x: i32, y: i32, z: i32, seed: u32) -> u32 {
    let spread_xy = (bitcast<u32>(x) * 0x8da6b343u) ^ (bitcast<u32>(y) * 0xd8163841u);
    let spread_zs = (bitcast<u32>(z) * 0xcb1ab31fu) ^ (seed * 0x9e3779b1u);
    return spread_xy ^ spread_zs;
}

// Two multiply-xorshift rounds.
fn vol_mixed(joined: u32) -> u32 {
    let first = (joined ^ (joined >> 16u)) * 0x7feb352du;
    return (first ^ (first >> 15u)) * 0x846ca68bu;
}

// The number `k / 2^24` of the top 24 bits of a word: exact, 0 to below 1.
fn vol_unit_number(word: u32) -> f32 {
    return f32(word >> 8u) * 0x1p-24f;
}

// A point of the unit cube from ten bits of a word each: `(k + 1/2) / 1024`, exact.
fn vol_unit_point(word: u32) -> vec3f {
    let bits = vec3u(word, word >> 10u, word >> 20u) & vec3u(1023u);
    return (vec3f(bits) + 0.5) * 0x1p-10f;
}

// A random number of the cell that a point lies in.
fn vol_hash(p: vec4f, seed: u32) -> f32 {
    let x = i32(floor(vol_hold(p.x, -VOL_WHOLES, VOL_WHOLES)));
    let y = i32(floor(vol_hold(p.y, -VOL_WHOLES, VOL_WHOLES)));
    let z = i32(floor(vol_hold(p.z, -VOL_WHOLES, VOL_WHOLES)));
    let w = i32(floor(vol_hold(p.w, -VOL_WHOLES, VOL_WHOLES)));
    return vol_unit_number(vol_hash_word(x, y, z, w, seed));
}

// Gradient code of the corner (i, j, k) of a cell; seed 0 is the published permutation. Chosen by
// select, not by a branch: a branch here would stand eight times in every loop body.
fn vol_corner_code(c: Vol_Cell, i: i32, j: i32, k: i32, seed: u32) -> u32 {
    let x = c.corner.x + i;
    let y = c.corner.y + j;
    let z = c.corner.z + k;
    return select(vol_hash_cell(x, y, z, seed), vol_table_cell(x, y, z), seed == 0u);
}

// Value at one corner.
fn vol_corner(c: Vol_Cell, i: i32, j: i32, k: i32, seed: u32) -> f32 {
    let code = vol_corner_code(c, i, j, k, seed);
    return vol_edge_value(code, c.place.x - f32(i), c.place.y - f32(j), c.place.z - f32(k));
}

// Improved Perlin noise.
fn vol_perlin(p: vec3f, seed: u32) -> f32 {
    let c = vol_cell_of(p);
    let u = c.fade.x;
    let v = c.fade.y;
    let w = c.fade.z;
    // Blend the four edges along x.
    let e00 = vol_lerp(u, vol_corner(c, 0i, 0i, 0i, seed), vol_corner(c, 1i, 0i, 0i, seed));
    let e10 = vol_lerp(u, vol_corner(c, 0i, 1i, 0i, seed), vol_corner(c, 1i, 1i, 0i, seed));
    let e01 = vol_lerp(u, vol_corner(c, 0i, 0i, 1i, seed), vol_corner(c, 1i, 0i, 1i, seed));
    let e11 = vol_lerp(u, vol_corner(c, 0i, 1i, 1i, seed), vol_corner(c, 1i, 1i, 1i, seed));
    // Blend along y, then along z.
    return vol_lerp(w, vol_lerp(v, e00, e10), vol_lerp(v, e01, e11));
}

// A value with what its gradient is made of: blended corner gradients, and the slopes by which
// the blending weights enter.
struct Vol_Blend {
    value: f32,
    gradient: vec3f,
    slope: vec3f,
}

// Value and gradient at one corner.
fn vol_corner_blend(c: Vol_Cell, i: i32, j: i32, k: i32, seed: u32) -> Vol_Blend {
    let code = vol_corner_code(c, i, j, k, seed);
    let value = vol_edge_value(code, c.place.x - f32(i), c.place.y - f32(j), c.place.z - f32(k));
    return Vol_Blend(value, vol_edge_vector(code), vec3f(0.0, 0.0, 0.0));
}

// Blend two neighbours along one axis and note the slope there.
fn vol_blend(axis: vec3<bool>, t: f32, a: Vol_Blend, b: Vol_Blend) -> Vol_Blend {
    let rise = b.value - a.value;
    let carried = vol_lerp3(t, a.slope, b.slope);
    let slope = select(carried, vec3f(rise, rise, rise), axis);
    return Vol_Blend(a.value + (t * rise), vol_lerp3(t, a.gradient, b.gradient), slope);
}

// Improved Perlin noise with its exact gradient: (value, d/dx, d/dy, d/dz).
fn vol_perlin_gradient(p: vec3f, seed: u32) -> vec4f {
    let c = vol_cell_of(p);
    let u = c.fade.x;
    let v = c.fade.y;
    let w = c.fade.z;
    let along_x = vec3<bool>(true, false, false);
    let along_y = vec3<bool>(false, true, false);
    let along_z = vec3<bool>(false, false, true);
    // Blend the four edges along x.
    let c000 = vol_corner_blend(c, 0i, 0i, 0i, seed);
    let c100 = vol_corner_blend(c, 1i, 0i, 0i, seed);
    let c010 = vol_corner_blend(c, 0i, 1i, 0i, seed);
    let c110 = vol_corner_blend(c, 1i, 1i, 0i, seed);
    let c001 = vol_corner_blend(c, 0i, 0i, 1i, seed);
    let c101 = vol_corner_blend(c, 1i, 0i, 1i, seed);
    let c011 = vol_corner_blend(c, 0i, 1i, 1i, seed);
    let c111 = vol_corner_blend(c, 1i, 1i, 1i, seed);
    let e00 = vol_blend(along_x, u, c000, c100);
    let e10 = vol_blend(along_x, u, c010, c110);
    let e01 = vol_blend(along_x, u, c001, c101);
    let e11 = vol_blend(along_x, u, c011, c111);
    // Blend along y, then along z.
    let f0 = vol_blend(along_y, v, e00, e10);
    let f1 = vol_blend(along_y, v, e01, e11);
    let whole = vol_blend(along_z, w, f0, f1);
    // Add the slopes of the weights to the blended gradients.
    let dx = whole.gradient.x + (vol_fade_slope(c.place.x) * whole.slope.x);
    let dy = whole.gradient.y + (vol_fade_slope(c.place.y) * whole.slope.y);
    let dz = whole.gradient.z + (vol_fade_slope(c.place.z) * whole.slope.z);
    return vec4f(whole.value, dx, dy, dz);
}

// Number of octaves as an integer: whole part held within 0..=32.
fn vol_octave_count(octaves: f32) -> i32 {
    return i32(floor(vol_hold(octaves, 0.0, VOL_OCTAVES)));
}

// Amplitude or frequency of the next octave, held within +-2^40.
fn vol_next_octave(product: f32, factor: f32) -> f32 {
    return vol_hold(product * factor, -VOL_PRODUCT, VOL_PRODUCT);
}

// Sum of octaves, `sum gain^k perlin(p lacunarity^k)`, coarse to fine.
fn vol_fbm(p: vec3f, octaves: f32, lacunarity: f32, gain: f32, seed: u32) -> f32 {
    var sum = 0.0;
    var amplitude = 1.0;
    var frequency = 1.0;
    let count = vol_octave_count(octaves);
    for (var k = 0i; k < count; k = k + 1i) {
        // Add one octave.
        let q = vec3f(p.x * frequency, p.y * frequency, p.z * frequency);
        sum = sum + (amplitude * vol_perlin(q, seed));
        // Step to the next.
        amplitude = vol_next_octave(amplitude, gain);
        frequency = vol_next_octave(frequency, lacunarity);
    }
    return sum;
}

// Sum of octaves with its exact gradient: (value, d/dx, d/dy, d/dz).
fn vol_fbm_gradient(p: vec3f, octaves: f32, lacunarity: f32, gain: f32, seed: u32) -> vec4f {
    var sum = vec4f(0.0, 0.0, 0.0, 0.0);
    var amplitude = 1.0;
    var frequency = 1.0;
    let count = vol_octave_count(octaves);
    for (var k = 0i; k < count; k = k + 1i) {
        // Add one octave; the chain rule brings the frequency down.
        let q = vec3f(p.x * frequency, p.y * frequency, p.z * frequency);
        let n = vol_perlin_gradient(q, seed);
        let steepness = amplitude * frequency;
        let weights = vec4f(amplitude, steepness, steepness, steepness);
        sum = sum + (weights * n);
        // Step to the next.
        amplitude = vol_next_octave(amplitude, gain);
        frequency = vol_next_octave(frequency, lacunarity);
    }
    return sum;
}

// Closest point on a curve of canonical pieces in f32, the same text as
// `runtime-cpu/src/math/curve.rs`, where ranges, errors and sources stand. Needs `fun.wgsl`, the number of curves
// VOL_CURVES and `vol_curve_word(index: u32) -> f32`; the words of a piece are those of `vol_compiler::curve::Piece`.

const VOL_PIECE_WORDS: u32 = 60u;
// Below this a divisor counts as it: quotients stay finite.
const VOL_TINY: f32 = 1e-30;
// Distance to a curve without pieces, scene units.
const VOL_FAR: f32 = 1e18;
// Points farther out are held here, scene units.
const VOL_REACH: f32 = 1e8;
// Largest stretch reported.
const VOL_STRETCH: f32 = 1e6;

// By how much a squared distance is taken larger before boxes are compared with it: more than the kernels are off far from
// the curve.
const VOL_LOOSE: f32 = 1.00001;
// What they are off near it, over the length of the curve, several times.
const VOL_SLACK: f32 = 4e-6;

// A foot at an end is held there if its offset leans along the tangent by more than this share.
const VOL_LEAN: f32 = 1e-3;
// Where the stretch is smaller, a foot is taken to slide as if it were this.
const VOL_LEAST_STRETCH: f32 = 0.05;
// Largest change of t per length reported.
const VOL_LARGEST_RATE: f32 = 1e15;

// A point seen from its closest point on a curve.
struct Vol_CurvePoint {
    t: f32,
    arc_length: f32,
    curve_length: f32,
    x: f32,
    y: f32,
    distance: f32,
    overshoot: f32,
    stretch: f32,
}

// Closest point of one piece.
struct Vol_Foot {
    t: f32,
    dist_sq: f32,
}

fn vol_dot(a: vec3f, b: vec3f) -> f32 {
    return ((a.x * b.x) + (a.y * b.y)) + (a.z * b.z);
}

fn vol_cross(a: vec3f, b: vec3f) -> vec3f {
    return vec3f((a.y * b.z) - (a.z * b.y), (a.z * b.x) - (a.x * b.z), (a.x * b.y) - (a.y * b.x));
}

// Three words of the curve buffer.
fn vol_curve_vector(word: u32) -> vec3f {
    return vec3f(vol_curve_word(word), vol_curve_word(word + 1u), vol_curve_word(word + 2u));
}

// A point held within +-1e8 units, where no product below overflows.
fn vol_held_point(p: vec3f) -> vec3f {
    return vec3f(
        vol_hold(p.x, -VOL_REACH, VOL_REACH),
        vol_hold(p.y, -VOL_REACH, VOL_REACH),
        vol_hold(p.z, -VOL_REACH, VOL_REACH),
    );
}

// Start of the piece seen from `p`; the low part keeps it exact far from the scene origin.
fn vol_from_point(p: vec3f, word: u32) -> vec3f {
    return (vol_curve_vector(word) - p) + vol_curve_vector(word + 3u);
}

// `Q(t) - p`.
fn vol_reach(w: vec3f, b1: vec3f, b2: vec3f, t: f32) -> vec3f {
    return w + (t * ((2.0 * b1) + (t * b2)));
}

// The end of a piece at t = 1 seen from `p`.
fn vol_end_from_point(p: vec3f, word: u32) -> vec3f {
    return (vol_curve_vector(word + 40u) - p) + vol_curve_vector(word + 43u);
}

// `Q(t) - p` from the nearer end of the piece, which halves what rounding takes.
fn vol_offset_at(p: vec3f, word: u32, b1: vec3f, b2: vec3f, t: f32) -> vec3f {
    let start = vol_reach(vol_from_point(p, word), b1, b2, t);
    let back = 1.0 - t;
    let before = vol_end_from_point(p, word) - (back * ((2.0 * (b1 + b2)) - (back * b2)));
    return select(start, before, t > 0.5);
}

// Start for the cube root of `x >= 0`, a few per cent off.
fn vol_rough_cube_root(x: f32) -> f32 {
    return bitcast<f32>((bitcast<u32>(x) / 3u) + 709921077u);
}

// The foot inside a canonical piece, if it has one, and what decides between it and the start.
struct Vol_Inner {
    t: f32,
    dist_sq: f32,
    start_is_least: bool,
    start_sq: f32,
    dips: bool,
}

// Closest point of one canonical piece, given by its first word.
fn vol_foot(p: vec3f, word: u32) -> Vol_Foot {
    let inner = vol_inner(p, word);
    // Prefer the start where it is itself a minimum and nearer.
    let start_wins = inner.start_is_least & (inner.start_sq <= inner.dist_sq);
    return Vol_Foot(select(inner.t, 0.0, start_wins), select(inner.dist_sq, inner.start_sq, start_wins));
}

// The largest root of g.
fn vol_inner(p: vec3f, word: u32) -> Vol_Inner {
    let b1 = vol_curve_vector(word + 6u);
    let b2 = vol_curve_vector(word + 9u);
    let vertex = vol_curve_word(word + 27u);
    let inv_a3 = vol_curve_word(word + 28u);
    // Coefficients of g = a3 t^3 + 3 a2 t^2 + a1 t + a0.
    let w = vol_from_point(p, word);
    let a3 = vol_curve_word(word + 24u);
    let a2x3 = 3.0 * vol_curve_word(word + 25u);
    let a1 = (2.0 * vol_curve_word(word + 26u)) + vol_dot(w, b2);
    let a0 = vol_dot(w, b1);
    // Move to the larger extremum e, or to the vertex where g has none.
    let slope = (a1 + (a2x3 * vertex)) * inv_a3;
    let half_gap = sqrt(max((-slope) * 0.33333334, 0.0));
    let m = max(slope, 0.0);
    let e = vertex + half_gap;
    let at_e = ((((((a3 * e) + a2x3) * e) + a1) * e) + a0) * inv_a3;
    let k = max(-at_e, 0.0);
    let gap3 = 3.0 * half_gap;
    // Guess the root of u^3 + gap3 u^2 + m u = k by its largest term.
    let tiny = (1e-12 * k) + VOL_TINY;
    let by_square = sqrt(k / max(gap3, tiny));
    let by_line = k / max(m, tiny);
    let u0 = min(min(vol_rough_cube_root(k), by_square), by_line);
    // Two Newton steps.
    let u1 = vol_depressed_step(u0, gap3, m, k);
    let u2 = vol_depressed_step(u1, gap3, m, k);
    // Return to t; a flat piece starts in the middle.
    let is_flat = inv_a3 == 0.0;
    let low = select(vol_hold(e, 0.0, 1.0), 0.0, is_flat);
    let t0 = select(vol_hold(e + u2, low, 1.0), 0.5, is_flat);
    // Two polishing steps on g.
    let t1 = vol_polish_step(t0, a3, a2x3, a1, a0, low);
    let t2 = vol_polish_step(t1, a3, a2x3, a1, a0, low);
    let end = vol_reach(w, b1, b2, t2);
    let dips = ((!is_flat) & (k > 0.0)) & ((e > 0.0) & (e < 1.0));
    let start_is_least = (a0 > 0.0) | ((a0 == 0.0) & (a1 >= 0.0));
    return Vol_Inner(t2, vol_dot(end, end), start_is_least, vol_dot(w, w), dips);
}

// One Newton step on `u^3 + gap3 u^2 + m u = k`, u >= 0.
fn vol_depressed_step(u: f32, gap3: f32, m: f32, k: f32) -> f32 {
    let value = ((((u + gap3) * u) + m) * u) - k;
    let slope = (((3.0 * u) + (2.0 * gap3)) * u) + m;
    return max(u - (value / max(slope, VOL_TINY)), 0.0);
}

// One Newton step on g, held within `low..=1`.
fn vol_polish_step(t: f32, a3: f32, a2x3: f32, a1: f32, a0: f32, low: f32) -> f32 {
    let value = (((((a3 * t) + a2x3) * t) + a1) * t) + a0;
    let slope = ((((3.0 * a3) * t) + (2.0 * a2x3)) * t) + a1;
    return vol_hold(t - (value / max(slope, VOL_TINY)), low, 1.0);
}

// Whether `t` is where the curve enters the piece, within 3e-8.
fn vol_at_first(word: u32, t: f32) -> bool {
    return (vol_curve_word(word + 32u) * (t - 0.5)) <= -0.5;
}

// Whether `t` is where the curve leaves the piece, within 3e-8.
fn vol_at_last(word: u32, t: f32) -> bool {
    return (vol_curve_word(word + 32u) * (t - 0.5)) >= 0.5;
}

// Closest point of the pieces visited so far.
struct Vol_Search {
    dist_sq: f32,
    t: f32,
    piece: u32,
    left_at_last: bool,
}

// Visit the next piece along the curve; at a joint one of the two feet is redundant.
fn vol_visit(before: Vol_Search, p: vec3f, word: u32, index: u32) -> Vol_Search {
    let found = vol_foot(p, word);
    let leaves = vol_at_last(word, found.t);
    let defers = leaves & (vol_curve_word(word + 38u) == 1.0);
    let redundant = (vol_at_first(word, found.t) & (vol_curve_word(word + 37u) == 1.0)) & (!before.left_at_last);
    let wins = ((found.dist_sq < before.dist_sq) & (!defers)) & (!redundant);
    return Vol_Search(
        select(before.dist_sq, found.dist_sq, wins),
        select(before.t, found.t, wins),
        select(before.piece, index, wins),
        leaves,
    );
}

// Length of a piece from t = 0 to `t`, scene units; every term is positive.
fn vol_length_to(word: u32, t: f32) -> f32 {
    let a3 = vol_curve_word(word + 24u);
    let b11 = vol_curve_word(word + 26u);
    let q = vol_curve_word(word + 33u);
    // Half speed at both ends and its rise.
    let rate = (a3 * t) + (2.0 * vol_curve_word(word + 25u));
    let speed0 = sqrt(b11);
    let speed = sqrt((rate * t) + b11);
    let rise = (t * rate) / max(speed + speed0, VOL_TINY);
    // The logarithm: a series for small z, else log2.
    let z = (q * ((q * t) + rise)) / vol_curve_word(word + 35u);
    let y = z / (2.0 + z);
    let yy = y * y;
    let s3 = 0.14285715 + (yy * 0.11111111);
    let s2 = 0.2 + (yy * s3);
    let s1 = 0.33333334 + (yy * s2);
    let series = (2.0 * y) * (1.0 + (yy * s1));
    let logarithm = vol_log2(1.0 + z) * VOL_LN_2;
    let log_term = select(logarithm, series, z < 0.414);
    // Add the terms.
    let bent = (t * speed) + (((-vol_curve_word(word + 27u)) * rise) + (vol_curve_word(word + 34u) * log_term));
    return select(bent, (2.0 * speed0) * t, vol_curve_word(word + 28u) == 0.0);
}

// Coordinates of `p` about the point `t` of a piece.
fn vol_describe(p: vec3f, word: u32, t: f32) -> Vol_CurvePoint {
    let b1 = vol_curve_vector(word + 6u);
    let b2 = vol_curve_vector(word + 9u);
    let t0 = vol_curve_vector(word + 12u);
    let normal = vol_curve_vector(word + 15u);
    let binormal = vol_curve_vector(word + 18u);
    let bend = vol_curve_vector(word + 21u);
    let t_span = vol_curve_word(word + 30u);
    let sense = vol_curve_word(word + 32u);
    let curve_length = vol_curve_word(word + 39u);
    // Offset and half velocity at the foot.
    let r = vol_offset_at(p, word, b1, b2, t);
    let v = b1 + (t * b2);
    let vv = max(vol_dot(v, v), VOL_TINY);
    // Unit tangent along the curve.
    let is_straight = vol_curve_word(word + 36u) != 0.0;
    let per_speed = sense / sqrt(vv);
    let tangent = select(v * per_speed, t0, is_straight);
    // Coordinates in the carried frame.
    let sum = t0 + tangent;
    let turn = vol_dot(r, sum) / vol_dot(t0, sum);
    let x = (vol_dot(normal, tangent) * turn) - vol_dot(r, normal);
    let y = (vol_dot(binormal, tangent) * turn) - vol_dot(r, binormal);
    // How far beyond an end of the whole curve; a point has both ends in one place.
    let ahead = -vol_dot(r, tangent);
    let starts = vol_at_first(word, t) & (vol_curve_word(word + 37u) == 0.0);
    let ends = (vol_at_last(word, t) | (t_span == 0.0)) & (vol_curve_word(word + 38u) == 0.0);
    let behind_first = select(0.0, -ahead, starts);
    let beyond_last = select(0.0, ahead, ends);
    // Stretch of volume by the bend.
    let bent = vol_dot(r, vol_cross(bend, v)) / vv;
    let stretch = 1.0 + (bent / (2.0 * vv));
    let s = vol_curve_word(word + 31u) + (sense * vol_length_to(word, t));
    return Vol_CurvePoint(
        vol_hold(vol_curve_word(word + 29u) + (t_span * t), 0.0, 1.0),
        vol_hold(s, 0.0, curve_length),
        curve_length,
        x,
        y,
        sqrt(vol_dot(r, r)),
        max(max(behind_first, beyond_last), 0.0),
        vol_hold(stretch, 0.0, VOL_STRETCH),
    );
}

// How the closest point moves with the position.
struct Vol_CurveSlopes {
    direction: vec3f,
    tangent: vec3f,
    rate: f32,
    slide: f32,
}

// How the foot of `p` at the point `t` of a piece moves.
fn vol_slopes(p: vec3f, word: u32, t: f32) -> Vol_CurveSlopes {
    let b1 = vol_curve_vector(word + 6u);
    let b2 = vol_curve_vector(word + 9u);
    let t0 = vol_curve_vector(word + 12u);
    let bend = vol_curve_vector(word + 21u);
    let t_span = vol_curve_word(word + 30u);
    // Offset and half velocity at the foot.
    let w = vol_from_point(p, word);
    let r = vol_reach(w, b1, b2, t);
    let v = b1 + (t * b2);
    let vv = max(vol_dot(v, v), VOL_TINY);
    // Unit tangent along the curve.
    let is_straight = vol_curve_word(word + 36u) != 0.0;
    let speed = sqrt(vv);
    let per_speed = vol_curve_word(word + 32u) / speed;
    let tangent = select(v * per_speed, t0, is_straight);
    // Unit offset.
    let distance = sqrt(vol_dot(r, r));
    let per_distance = select(0.0, -1.0 / max(distance, VOL_TINY), distance > 0.0);
    // How far the foot slides: not at all where it is held.
    let at_end = (t == 0.0) | (t == 1.0);
    let held = at_end & (abs(vol_dot(r, tangent)) > (VOL_LEAN * distance));
    let bent = vol_dot(r, vol_cross(bend, v)) / vv;
    let stretch = max(1.0 + (bent / (2.0 * vv)), VOL_LEAST_STRETCH);
    return Vol_CurveSlopes(
        r * per_distance,
        tangent,
        min(abs(t_span) / (2.0 * speed), VOL_LARGEST_RATE),
        select(1.0 / stretch, 0.0, held | (t_span == 0.0)),
    );
}

// Where a curve is: pieces `first .. first + count` of the buffer; `number` among all curves.
struct Vol_Curve {
    first: u32,
    count: u32,
    number: u32,
}

// The last search on a curve, from which the next one is most often near.
struct Vol_LastSearch {
    some: bool,
    point: vec3f,
    found: Vol_Search,
    // Distance of the foot at most.
    reach: f32,
}

var<private> vol_last_search: array<Vol_LastSearch, VOL_CURVES>;

// Squared distance from a point to the box around a piece; 0 inside.
fn vol_box_dist_sq(p: vec3f, word: u32) -> f32 {
    let below = vol_curve_vector(word + 52u) - p;
    let above = p - vol_curve_vector(word + 55u);
    let x = max(max(below.x, above.x), 0.0);
    let y = max(max(below.y, above.y), 0.0);
    let z = max(max(below.z, above.z), 0.0);
    return ((x * x) + (y * y)) + (z * z);
}

// The closest point of a curve, from `vol_held_point`, as if every piece were visited: one that is passed over is in a box
// farther away than the winner can be. That is at most as far away as the last foot, which the point has moved away from.
fn vol_search(p: vec3f, curve: Vol_Curve) -> Vol_Search {
    let last = vol_last_search[curve.number];
    if (last.some & all(last.point == p)) {
        return last.found;
    }
    let way = p - last.point;
    let reach = last.reach + sqrt(vol_dot(way, way));
    let bound = select(VOL_LARGEST, (reach * reach) * VOL_LOOSE, last.some);
    // Visit the pieces along the curve.
    var search = Vol_Search(VOL_LARGEST, 0.0, 0u, false);
    for (var index = 0u; index < curve.count; index = index + 1u) {
        let word = (curve.first + index) * VOL_PIECE_WORDS;
        if (vol_box_dist_sq(p, word) <= bound) {
            search = vol_visit(search, p, word, index);
        }
    }
    let slack = VOL_SLACK * vol_curve_word((curve.first * VOL_PIECE_WORDS) + 39u);
    vol_last_search[curve.number] = Vol_LastSearch(true, p, search, sqrt(search.dist_sq) + slack);
    return search;
}

// How the closest point of a whole curve moves.
fn vol_closest_gradient(point: vec3f, curve: Vol_Curve) -> Vol_CurveSlopes {
    let p = vol_held_point(point);
    let search = vol_search(p, curve);
    // Describe how the foot moves on the winner.
    if (curve.count == 0u) {
        return Vol_CurveSlopes(vec3f(1.0, 0.0, 0.0), vec3f(0.0, 0.0, 1.0), 0.0, 0.0);
    }
    return vol_slopes(p, (curve.first + search.piece) * VOL_PIECE_WORDS, search.t);
}

// Closest point of a whole curve.
fn vol_closest(point: vec3f, curve: Vol_Curve) -> Vol_CurvePoint {
    let p = vol_held_point(point);
    let search = vol_search(p, curve);
    // Describe the foot on the winner.
    if (curve.count == 0u) {
        return Vol_CurvePoint(0.0, 0.0, 0.0, VOL_FAR, 0.0, VOL_FAR, 0.0, 1.0);
    }
    return vol_describe(p, (curve.first + search.piece) * VOL_PIECE_WORDS, search.t);
}

struct Vol_Out10 {
  v0: f32,
  v1: f32,
  v2: f32,
  v3: f32,
  v4: f32,
  v5: f32,
  v6: f32,
  v7: f32,
  v8: f32,
  v9: f32,
}

// region:cloud
fn vol_f2_region_cloud(x0: f32, x1: f32, x2: f32) -> f32 {
  let v0: f32 = 0.0f;
  let v1: f32 = 0.08f;
  let v2: f32 = 0.52f;
  let v5: f32 = vol_uniforms[4].y;
  let v6: f32 = vol_uniforms[5].x;
  let v7: f32 = vol_uniforms[4].w;
  let v8: f32 = vol_uniforms[4].x;
  let v9: f32 = vol_uniforms[3].w;
  let v10: f32 = vol_uniforms[3].z;
  // tornado.vol:9: density: q => 25 * max(0, fbm(q.local * vec3(3, 6, 3) - (0, time, 0), octaves) + 0.15)
  let v12 = vol_closest(vec3f(x0, x1, x2), Vol_Curve(0u, 2u, 0u));
  let v13: f32 = v12.t;
  let v14: f32 = v12.arc_length;
  let v15: f32 = v12.curve_length;
  let v16: f32 = v12.distance;
  let v17: f32 = v12.overshoot;
  // tornado.vol:8: region:  tube(spine, radius: t => mix(0.08, 0.6, t * t), twist: t => 0.8turn * t - spin * time)
  let v18: f32 = (v13 * v13);
  let v19: f32 = (v18 * v2);
  let v20: f32 = (v1 + v19);
  let v21: f32 = 1e-6f;
  // tornado.vol:9: density: q => 25 * max(0, fbm(q.local * vec3(3, 6, 3) - (0, time, 0), octaves) + 0.15)
  let v22: f32 = select(v21, v20, (v20 > v21));
  // tornado.vol:8: region:  tube(spine, radius: t => mix(0.08, 0.6, t * t), twist: t => 0.8turn * t - spin * time)
  let v23: f32 = (v16 - v22);
  let v24: f32 = (v16 - v5);
  let v25: f32 = (v23 * v7);
  let v26: f32 = vol_uniforms[4].z;
  let v27: f32 = select(v26, v25, (v25 < v26));
  let v28: f32 = select(v27, v24, (v24 > v27));
  let v29: bool = (v16 < v6);
  let v30: f32 = select(v24, v28, v29);
  let v31: f32 = (v8 - v16);
  let v32: f32 = select(v31, v17, (v17 < v31));
  let v33: f32 = (v15 - v14);
  let v34: f32 = select(v33, v14, (v14 < v33));
  let v35: f32 = (v34 * v9);
  let v36: f32 = select(v10, v35, (v35 < v10));
  let v37: f32 = (-(v36));
  let v38: bool = (v0 < v17);
  let v39: f32 = select(v37, v32, v38);
  let v40: f32 = select(v39, v30, (v30 > v39));
  return v40;
}

// interior:cloud
fn vol_f3_interior_cloud(x0: f32, x1: f32, x2: f32) -> Vol_Out10 {
  let v0: f32 = vol_uniforms[5].w;
  let v1: f32 = 0.0f;
  let v2: f32 = 1.0f;
  let v3: f32 = 0.08f;
  let v4: f32 = 0.52f;
  let v8: f32 = 25.0f;
  // tornado.vol:9: density: q => 25 * max(0, fbm(q.local * vec3(3, 6, 3) - (0, time, 0), octaves) + 0.15)
  let v9 = vol_closest(vec3f(x0, x1, x2), Vol_Curve(0u, 2u, 0u));
  let v10: f32 = v9.t;
  let v11: f32 = v9.arc_length;
  let v12: f32 = v9.x;
  let v13: f32 = v9.y;
  // tornado.vol:8: region:  tube(spine, radius: t => mix(0.08, 0.6, t * t), twist: t => 0.8turn * t - spin * time)
  let v14: f32 = (v10 * v10);
  let v15: f32 = (v14 * v4);
  let v16: f32 = (v3 + v15);
  let v17: f32 = 1e-6f;
  // tornado.vol:9: density: q => 25 * max(0, fbm(q.local * vec3(3, 6, 3) - (0, time, 0), octaves) + 0.15)
  let v18: f32 = select(v17, v16, (v16 > v17));
  let v19: f32 = 5.0265484f;
  // tornado.vol:8: region:  tube(spine, radius: t => mix(0.08, 0.6, t * t), twist: t => 0.8turn * t - spin * time)
  let v20: f32 = (v19 * v10);
  let v21: f32 = vol_uniforms[5].z;
  let v22: f32 = (v20 - v21);
  // tornado.vol:9: density: q => 25 * max(0, fbm(q.local * vec3(3, 6, 3) - (0, time, 0), octaves) + 0.15)
  let v23: f32 = vol_sin(v22);
  let v24: f32 = vol_cos(v22);
  let v25: f32 = (v24 * v12);
  let v26: f32 = (v23 * v13);
  let v27: f32 = (v23 * v12);
  let v28: f32 = (v24 * v13);
  let v29: f32 = (v25 - v26);
  let v30: f32 = (v27 + v28);
  let v31: f32 = (v29 / v18);
  let v32: f32 = (v30 / v18);
  let v33: f32 = 3.0f;
  let v34: f32 = 6.0f;
  let v35: f32 = (v31 * v33);
  let v36: f32 = (v11 * v34);
  let v37: f32 = (v32 * v33);
  let v38: f32 = (v36 - v0);
  let v39: f32 = vol_uniforms[5].y;
  let v40: f32 = 2.0f;
  let v41: f32 = 0.5f;
  let v42: f32 = vol_fbm(vec3f(v35, v38, v37), v39, v40, v41, 0u);
  let v43: f32 = 0.15f;
  let v44: f32 = (v42 + v43);
  // tornado.vol:7: medium cloud {
  let v45: f32 = (v8 * v44);
  let v46: f32 = 0.7912979f;
  let v47: f32 = 0.8307699f;
  let v48: f32 = 0.94129795f;
  let v49: f32 = 0.9807699f;
  let v50: f32 = 1.15f;
  return Vol_Out10(v45, v46, v47, v2, v48, v49, v50, v1, v1, v1);
}

// extinction:cloud
fn vol_f4_extinction_cloud(x0: f32, x1: f32, x2: f32) -> vec4f {
  let v0: f32 = vol_uniforms[5].w;
  let v1: f32 = 0.08f;
  let v2: f32 = 0.52f;
  let v6: f32 = 25.0f;
  // tornado.vol:9: density: q => 25 * max(0, fbm(q.local * vec3(3, 6, 3) - (0, time, 0), octaves) + 0.15)
  let v7 = vol_closest(vec3f(x0, x1, x2), Vol_Curve(0u, 2u, 0u));
  let v8: f32 = v7.t;
  let v9: f32 = v7.arc_length;
  let v10: f32 = v7.x;
  let v11: f32 = v7.y;
  // tornado.vol:8: region:  tube(spine, radius: t => mix(0.08, 0.6, t * t), twist: t => 0.8turn * t - spin * time)
  let v12: f32 = (v8 * v8);
  let v13: f32 = (v12 * v2);
  let v14: f32 = (v1 + v13);
  let v15: f32 = 1e-6f;
  // tornado.vol:9: density: q => 25 * max(0, fbm(q.local * vec3(3, 6, 3) - (0, time, 0), octaves) + 0.15)
  let v16: f32 = select(v15, v14, (v14 > v15));
  let v17: f32 = 5.0265484f;
  // tornado.vol:8: region:  tube(spine, radius: t => mix(0.08, 0.6, t * t), twist: t => 0.8turn * t - spin * time)
  let v18: f32 = (v17 * v8);
  let v19: f32 = vol_uniforms[5].z;
  let v20: f32 = (v18 - v19);
  // tornado.vol:9: density: q => 25 * max(0, fbm(q.local * vec3(3, 6, 3) - (0, time, 0), octaves) + 0.15)
  let v21: f32 = vol_sin(v20);
  let v22: f32 = vol_cos(v20);
  let v23: f32 = (v22 * v10);
  let v24: f32 = (v21 * v11);
  let v25: f32 = (v21 * v10);
  let v26: f32 = (v22 * v11);
  let v27: f32 = (v23 - v24);
  let v28: f32 = (v25 + v26);
  let v29: f32 = (v27 / v16);
  let v30: f32 = (v28 / v16);
  let v31: f32 = 3.0f;
  let v32: f32 = 6.0f;
  let v33: f32 = (v29 * v31);
  let v34: f32 = (v9 * v32);
  let v35: f32 = (v30 * v31);
  let v36: f32 = (v34 - v0);
  let v37: f32 = vol_uniforms[5].y;
  let v38: f32 = 2.0f;
  let v39: f32 = 0.5f;
  let v40: f32 = vol_fbm(vec3f(v33, v36, v35), v37, v38, v39, 0u);
  let v41: f32 = 0.15f;
  let v42: f32 = (v40 + v41);
  // tornado.vol:7: medium cloud {
  let v43: f32 = (v6 * v42);
  let v44: f32 = 0.94129795f;
  let v45: f32 = 0.9807699f;
  let v46: f32 = 1.15f;
  return vec4f(v43, v44, v45, v46);
}

// phase:cloud
fn vol_f5_phase_cloud(x0: f32, x1: f32) -> f32 {
  let v0: f32 = 0.6f;
  let v2: f32 = 0.49f;
  // tornado.vol:7: medium cloud {
  let v3: f32 = (v0 * x0);
  let v4: f32 = (v2 + v3);
  let v5: f32 = sqrt(select(0.0, v4, (v4 > 0.0)));
  let v6: f32 = (v4 * v5);
  let v7: f32 = 12.566371f;
  let v8: f32 = (v7 * v6);
  let v9: f32 = 0.91f;
  let v10: f32 = (v9 / v8);
  return v10;
}

// density:cloud
fn vol_f7_density_cloud(x0: f32, x1: f32, x2: f32) -> f32 {
  let v0: f32 = vol_uniforms[5].w;
  let v1: f32 = 0.0f;
  let v2: f32 = 0.08f;
  let v3: f32 = 0.52f;
  let v6: f32 = vol_uniforms[4].y;
  let v7: f32 = vol_uniforms[5].x;
  let v8: f32 = vol_uniforms[4].w;
  let v9: f32 = vol_uniforms[4].x;
  let v10: f32 = vol_uniforms[3].w;
  let v11: f32 = vol_uniforms[3].z;
  let v13: f32 = 25.0f;
  // tornado.vol:9: density: q => 25 * max(0, fbm(q.local * vec3(3, 6, 3) - (0, time, 0), octaves) + 0.15)
  let v14 = vol_closest(vec3f(x0, x1, x2), Vol_Curve(0u, 2u, 0u));
  let v15: f32 = v14.t;
  let v16: f32 = v14.arc_length;
  let v17: f32 = v14.curve_length;
  let v18: f32 = v14.x;
  let v19: f32 = v14.y;
  let v20: f32 = v14.distance;
  let v21: f32 = v14.overshoot;
  // tornado.vol:8: region:  tube(spine, radius: t => mix(0.08, 0.6, t * t), twist: t => 0.8turn * t - spin * time)
  let v22: f32 = (v15 * v15);
  let v23: f32 = (v22 * v3);
  let v24: f32 = (v2 + v23);
  let v25: f32 = 1e-6f;
  // tornado.vol:9: density: q => 25 * max(0, fbm(q.local * vec3(3, 6, 3) - (0, time, 0), octaves) + 0.15)
  let v26: f32 = select(v25, v24, (v24 > v25));
  let v27: f32 = 5.0265484f;
  // tornado.vol:8: region:  tube(spine, radius: t => mix(0.08, 0.6, t * t), twist: t => 0.8turn * t - spin * time)
  let v28: f32 = (v27 * v15);
  let v29: f32 = vol_uniforms[5].z;
  let v30: f32 = (v28 - v29);
  // tornado.vol:9: density: q => 25 * max(0, fbm(q.local * vec3(3, 6, 3) - (0, time, 0), octaves) + 0.15)
  let v31: f32 = vol_sin(v30);
  let v32: f32 = vol_cos(v30);
  let v33: f32 = (v32 * v18);
  let v34: f32 = (v31 * v19);
  let v35: f32 = (v31 * v18);
  let v36: f32 = (v32 * v19);
  let v37: f32 = (v33 - v34);
  let v38: f32 = (v35 + v36);
  let v39: f32 = (v37 / v26);
  let v40: f32 = (v38 / v26);
  let v41: f32 = 3.0f;
  let v42: f32 = 6.0f;
  let v43: f32 = (v39 * v41);
  let v44: f32 = (v16 * v42);
  let v45: f32 = (v40 * v41);
  let v46: f32 = (v44 - v0);
  let v47: f32 = vol_uniforms[5].y;
  let v48: f32 = 2.0f;
  let v49: f32 = 0.5f;
  let v50: f32 = vol_fbm(vec3f(v43, v46, v45), v47, v48, v49, 0u);
  let v51: f32 = 0.15f;
  let v52: f32 = (v50 + v51);
  // tornado.vol:7: medium cloud {
  let v53: f32 = (v13 * v52);
  // tornado.vol:8: region:  tube(spine, radius: t => mix(0.08, 0.6, t * t), twist: t => 0.8turn * t - spin * time)
  let v54: f32 = (v20 - v26);
  let v55: f32 = (v20 - v6);
  let v56: f32 = (v54 * v8);
  let v57: f32 = vol_uniforms[4].z;
  let v58: f32 = select(v57, v56, (v56 < v57));
  let v59: f32 = select(v58, v55, (v55 > v58));
  let v60: bool = (v20 < v7);
  let v61: f32 = select(v55, v59, v60);
  let v62: f32 = (v9 - v20);
  let v63: f32 = select(v62, v21, (v21 < v62));
  let v64: f32 = (v17 - v16);
  let v65: f32 = select(v64, v16, (v16 < v64));
  let v66: f32 = (v65 * v10);
  let v67: f32 = select(v11, v66, (v66 < v11));
  let v68: f32 = (-(v67));
  let v69: bool = (v1 < v21);
  let v70: f32 = select(v68, v63, v69);
  let v71: f32 = select(v70, v61, (v61 > v70));
  // tornado.vol:7: medium cloud {
  let v72: bool = (v1 < v71);
  let v73: f32 = select(v1, v53, (v53 > v1));
  let v74: f32 = select(v73, v1, v72);
  return v74;
}

// colour:cloud
fn vol_f8_colour_cloud(x0: f32, x1: f32, x2: f32) -> vec3f {
  let v0: f32 = 1.0f;
  let v1: f32 = 0.7912979f;
  let v2: f32 = 0.8307699f;
  return vec3f(v1, v2, v0);
}

// local:cloud
fn vol_f9_local_cloud(x0: f32, x1: f32, x2: f32) -> vec3f {
  let v0: f32 = 0.08f;
  let v1: f32 = 0.52f;
  // tornado.vol:9: density: q => 25 * max(0, fbm(q.local * vec3(3, 6, 3) - (0, time, 0), octaves) + 0.15)
  let v5 = vol_closest(vec3f(x0, x1, x2), Vol_Curve(0u, 2u, 0u));
  let v6: f32 = v5.t;
  let v7: f32 = v5.arc_length;
  let v8: f32 = v5.x;
  let v9: f32 = v5.y;
  // tornado.vol:8: region:  tube(spine, radius: t => mix(0.08, 0.6, t * t), twist: t => 0.8turn * t - spin * time)
  let v10: f32 = (v6 * v6);
  let v11: f32 = (v10 * v1);
  let v12: f32 = (v0 + v11);
  let v13: f32 = 1e-6f;
  // tornado.vol:9: density: q => 25 * max(0, fbm(q.local * vec3(3, 6, 3) - (0, time, 0), octaves) + 0.15)
  let v14: f32 = select(v13, v12, (v12 > v13));
  let v15: f32 = 5.0265484f;
  // tornado.vol:8: region:  tube(spine, radius: t => mix(0.08, 0.6, t * t), twist: t => 0.8turn * t - spin * time)
  let v16: f32 = (v15 * v6);
  let v17: f32 = vol_uniforms[5].z;
  let v18: f32 = (v16 - v17);
  // tornado.vol:9: density: q => 25 * max(0, fbm(q.local * vec3(3, 6, 3) - (0, time, 0), octaves) + 0.15)
  let v19: f32 = vol_sin(v18);
  let v20: f32 = vol_cos(v18);
  let v21: f32 = (v20 * v8);
  let v22: f32 = (v19 * v9);
  let v23: f32 = (v19 * v8);
  let v24: f32 = (v20 * v9);
  let v25: f32 = (v21 - v22);
  let v26: f32 = (v23 + v24);
  let v27: f32 = (v25 / v14);
  let v28: f32 = (v26 / v14);
  return vec3f(v27, v7, v28);
}


// ---- this program ------------------------------------------------------------

const VOL_IN_AT_TILE: u32 = 0u;
const VOL_IN_AT_SIZE: u32 = 4u;
const VOL_IN_AT_STEP: u32 = 6u;
const VOL_IN_AT_SHADOW_STEP: u32 = 7u;
const VOL_IN_AT_EYE: u32 = 8u;
const VOL_IN_AT_FORWARD: u32 = 11u;
const VOL_IN_AT_RIGHT: u32 = 14u;
const VOL_IN_AT_UP: u32 = 17u;
const VOL_IN_AT_BACKGROUND: u32 = 20u;
const VOL_IN_AT_LIGHT_COUNT: u32 = 23u;
const VOL_IN_AT_SAMPLES: u32 = 24u;
const VOL_IN_AT_TOLERANCE: u32 = 25u;
const VOL_IN_AT_BUDGET: u32 = 26u;
const VOL_IN_OBJECT_COUNT: u32 = 0u;
const VOL_IN_MEDIUM_COUNT: u32 = 1u;
const VOL_IN_OBJECT_SLOTS: u32 = 1u;
const VOL_IN_MEDIUM_SLOTS: u32 = 1u;
const VOL_IN_LIGHT_SLOTS: u32 = 1u;
const VOL_IN_TRANSFER_SIZE: u32 = 256u;
const VOL_IN_OBJECT_WORDS: u32 = 8u;
const VOL_IN_MEDIUM_WORDS: u32 = 9u;
const VOL_IN_CELL_WORDS: u32 = 6u;
const VOL_IN_CELLS_WORDS: u32 = 384u;
const VOL_IN_LIGHT_WORDS: u32 = 12u;
const VOL_IN_PIXEL_WORDS: u32 = 15u;
const VOL_IN_AT_OBJECTS: u32 = 27u;
const VOL_IN_AT_MEDIA: u32 = 27u;
const VOL_IN_AT_LIGHTS: u32 = 36u;
const VOL_IN_AT_CELLS: u32 = 76u;
const VOL_IN_ROW_WORDS: u32 = 0u;
const VOL_IN_CORRECTED: bool = false;
const VOL_IN_SPACED: bool = false;
const VOL_IN_SOFT_LIGHTS: bool = false;
const VOL_IN_OCCLUDING_LIGHTS: bool = false;
const VOL_IN_LIGHT_GRIDS: bool = true;
const VOL_IN_LIT_MEDIA: bool = true;
const VOL_IN_STYLES: bool = false;
const VOL_IN_MARCHED_SHAFTS: bool = false;

fn vol_in_joins_the_one_before(object: u32) -> bool {
    return false;
}

fn vol_in_object_distance(index: u32, p: vec3f) -> f32 {
    switch index {
        default: {
            return VOL_IN_FAR;
        }
    }
}

fn vol_in_object_gradient(index: u32, p: vec3f) -> vec3f {
    switch index {
        default: {
            return vec3f(0.0);
        }
    }
}

fn vol_in_object_steepness(index: u32, lo: vec3f, hi: vec3f) -> f32 {
    switch index {
        default: {
            return 1.0;
        }
    }
}

fn vol_in_object_surface(index: u32, p: vec3f) -> Vol_in_Response {
    switch index {
        default: {
            return Vol_in_Response(vec3f(0.0), vec3f(0.0), vec3f(0.0), 0.0);
        }
    }
}

fn vol_in_medium_region(index: u32, p: vec3f) -> f32 {
    switch index {
        case 0u: {
            let v = vol_f2_region_cloud(p.x, p.y, p.z);
            return v;
        }
        default: {
            return VOL_IN_FAR;
        }
    }
}

fn vol_in_medium_interior(index: u32, p: vec3f) -> Vol_in_Interior {
    switch index {
        case 0u: {
            let v = vol_f3_interior_cloud(p.x, p.y, p.z);
            return Vol_in_Interior(v.v0, vec3f(v.v1, v.v2, v.v3), vec3f(v.v4, v.v5, v.v6), vec3f(v.v7, v.v8, v.v9));
        }
        default: {
            return Vol_in_Interior(0.0, vec3f(0.0), vec3f(0.0), vec3f(0.0));
        }
    }
}

fn vol_in_medium_extinction(index: u32, p: vec3f) -> vec4f {
    switch index {
        case 0u: {
            let v = vol_f4_extinction_cloud(p.x, p.y, p.z);
            return v;
        }
        default: {
            return vec4f(0.0);
        }
    }
}

fn vol_in_medium_phase(index: u32, less: f32, more: f32) -> f32 {
    switch index {
        case 0u: {
            let v = vol_f5_phase_cloud(less, more);
            return v;
        }
        default: {
            return 0.0;
        }
    }
}

// The integrator: what a picture means. Twin of runtime-cpu/src/render, with the same file names,
// function names and step comments.
//
// Written before this text, per program: how many objects and media there are, the places AT_… of
// the words of vol_frame, vol_frame_word for one of them, and the functions object_… and medium_… that
// pick the function of one of them. Every value stays finite; skipped parts add exactly 0.

const VOL_IN_FAR: f32 = 4.0e6;
const VOL_IN_PARALLEL: f32 = 1e-12;
const VOL_IN_EPSILON: f32 = 0x1p-23f;
const VOL_IN_FLAT: f32 = 1e-15;
const VOL_IN_OPAQUE: f32 = 24.0;
const VOL_IN_STOP: f32 = 0x1p-16f;
const VOL_IN_NO_DEPTH: f32 = 1e30;
const VOL_IN_MAX_SPREAD_TANGENT: f32 = 1.7320508;
const VOL_IN_MAX_STEPS: u32 = 2000u;
const VOL_IN_REFINEMENTS: u32 = 4u;
const VOL_IN_EAGERNESS: f32 = 1.95;
const VOL_IN_ROOM: f32 = 0.98;
const VOL_IN_MAX_NODES: i32 = 16384;
const VOL_IN_LAST_NODE: f32 = 4194304.0;
const VOL_IN_SHOWS_NORMALS: f32 = 2.0;
const VOL_IN_BY_STEEPNESS: f32 = 0.0;
const VOL_IN_NO_BOUND: f32 = 1e30;
const VOL_IN_TRIES: u32 = 8u;
const VOL_IN_UNLIT: f32 = 1.0;
const VOL_IN_UNSHADOWED: f32 = 2.0;
const VOL_IN_SHADOWED: f32 = 3.0;
// Pixels have fewer corners.
const VOL_IN_NO_CORNER: u32 = 4u;
const VOL_IN_ROOT_THIRD: f32 = 0.5773503;

fn vol_in_word3(at: u32) -> vec3f {
    return vec3f(vol_frame_word(at), vol_frame_word(at + 1u), vol_frame_word(at + 2u));
}

fn vol_in_input3(at: u32) -> vec3f {
    return vec3f(vol_input_word(at), vol_input_word(at + 1u), vol_input_word(at + 2u));
}

fn vol_in_dot3(a: vec3f, b: vec3f) -> f32 {
    return ((a.x * b.x) + (a.y * b.y)) + (a.z * b.z);
}

fn vol_in_length3(v: vec3f) -> f32 {
    return sqrt(vol_in_dot3(v, v));
}

fn vol_in_largest(v: vec3f) -> f32 {
    return max(max(v.x, v.y), v.z);
}

fn vol_in_smallest(v: vec3f) -> f32 {
    return min(min(v.x, v.y), v.z);
}

fn vol_in_decay(x: f32) -> f32 {
    return vol_exp2(x * -1.44269504);
}

fn vol_in_decay3(x: vec3f) -> vec3f {
    return vec3f(vol_in_decay(x.x), vol_in_decay(x.y), vol_in_decay(x.z));
}

// (1 - exp(-x)) / x, 1 at 0.
fn vol_in_mean_decay(x: f32) -> f32 {
    let tail = x * ((1.0f / 120.0f) - (x * (1.0f / 720.0f)));
    let series = 1.0 - (x * (0.5 - (x * ((1.0f / 6.0f) - (x * ((1.0f / 24.0f) - tail))))));
    let quotient = (1.0 - vol_in_decay(x)) / max(x, 0.35);
    return select(quotient, series, x < 0.35);
}

fn vol_in_mean_decay3(x: vec3f) -> vec3f {
    return vec3f(vol_in_mean_decay(x.x), vol_in_mean_decay(x.y), vol_in_mean_decay(x.z));
}

// (1 - (1 + x) exp(-x)) / x^2, 1/2 at 0.
fn vol_in_decay_moment(x: f32) -> f32 {
    let tail = x * ((1.0f / 144.0f) - (x * ((1.0f / 840.0f) - (x * (1.0f / 5760.0f)))));
    let series = 0.5 - (x * ((1.0f / 3.0f) - (x * ((1.0f / 8.0f) - (x * ((1.0f / 30.0f) - tail))))));
    let quotient = (vol_in_mean_decay(x) - vol_in_decay(x)) / max(x, 0.5);
    return select(quotient, series, x < 0.5);
}

fn vol_in_decay_moment3(x: vec3f) -> vec3f {
    return vec3f(vol_in_decay_moment(x.x), vol_in_decay_moment(x.y), vol_in_decay_moment(x.z));
}

// x^y for x >= 0; 0 at 0.
fn vol_in_power(x: f32, y: f32) -> f32 {
    let some = x > 0.0;
    let value = vol_exp2(y * vol_log2(select(1.0, x, some)));
    return select(0.0, value, some);
}

// How much this invocation has computed, for statistics.

// Takes samples of a pixel until there are `last` of them, or enough.
fn vol_in_sample_pixel(pixel: vec2u, before: Vol_in_Mean, last: u32) -> Vol_in_Mean {
    var mean = before;
    // Rays are followed at one place of the text, since drivers write it out at each: for samples, and
    // for the corners after the first round.
    var corner = VOL_IN_NO_CORNER;
    while ((corner < VOL_IN_NO_CORNER) || ((mean.count < last) && !vol_in_is_done(mean))) {
        let is_probe = corner < VOL_IN_NO_CORNER;
        let found = vol_in_radiance(vol_in_pixel_ray(pixel, mean.count, corner));
        if (is_probe) {
            mean = vol_in_add_probe(mean, found);
            corner += 1u;
        } else {
            mean = vol_in_add_sample(mean, found);
            corner = select(VOL_IN_NO_CORNER, 0u, vol_in_is_probed() && (mean.count == VOL_IN_FIRST_ROUND));
        }
    }
    return mean;
}

// The ray of a sample, or through a corner of the pixel.
fn vol_in_pixel_ray(pixel: vec2u, index: u32, corner: u32) -> Vol_in_Ray {
    let is_probe = corner < VOL_IN_NO_CORNER;
    let aside = select(vol_in_place_in_pixel(index), vec2f(vec2u(corner % 2u, corner / 2u)), is_probe);
    var ray = vol_in_camera_ray(vec2f(pixel) + aside);
    ray.shift = select(vol_in_comb_shift(pixel, index), 0.0, is_probe);
    return ray;
}

// Follows a camera ray.
fn vol_in_radiance(ray: Vol_in_Ray) -> Vol_in_Radiance {
    // Find what is behind the media: surfaces, else the background.
    let contact = vol_in_trace(ray);
    var behind = vol_in_word3(VOL_IN_AT_BACKGROUND);
    var end = VOL_IN_FAR;
    var depth = VOL_IN_NO_DEPTH;
    if (contact.hit) {
        behind = vol_in_shade(ray, contact);
        end = contact.t;
        depth = contact.t * vol_in_dot3(ray.direction, vol_in_word3(VOL_IN_AT_FORWARD));
    }
    // Look at it through the media.
    let glow = vol_in_march(ray, end);
    let coarse = glow.coarse_light + (glow.coarse_transmittance * behind);
    let color = glow.light + (glow.transmittance * behind);
    let doubt = vol_in_length3(coarse - color) * VOL_IN_ROOT_THIRD;
    return Vol_in_Radiance(color, select(glow.transmittance, vec3f(0.0), contact.hit), depth, doubt);
}

// The samples of a pixel: where they are, their mean, and when there are enough of them.
// Twin: runtime-cpu/src/render/sampling.rs, which says why.

const VOL_IN_STRIDE: vec2u = vec2u(3242174889u, 2447445414u);
// 2^32 over the golden ratio.
const VOL_IN_GOLDEN_STRIDE: u32 = 2654435769u;
const VOL_IN_FIRST_ROUND: u32 = 9u;
const VOL_IN_ROUND: u32 = 8u;
const VOL_IN_LEAST_BRIGHTNESS: f32 = 0.0625;

// What a camera ray brings back; depth NO_DEPTH without a surface.
struct Vol_in_Radiance {
    color: vec3f,
    transmittance: vec3f,
    depth: f32,
    // How far the colour is from the one by every other node of the media.
    doubt: f32,
}

struct Vol_in_Mean {
    count: u32,
    color: vec3f,
    transmittance: vec3f,
    depth: f32,
    color_spread: f32,
    transmittance_spread: f32,
    doubt: f32,
}

fn vol_in_place_in_pixel(index: u32) -> vec2f {
    let step = (index + 1u) / 2u;
    let signed = select(0u - step, step, (index % 2u) == 1u);
    let place = ((vec2u(signed) * VOL_IN_STRIDE) + vec2u(0x80000000u)) >> vec2u(16u);
    return vec2f(place) * (1.0f / 65536.0f);
}

// How far the comb of a sample is moved, in steps.
fn vol_in_comb_shift(pixel: vec2u, index: u32) -> f32 {
    let place = ((pixel.x * VOL_IN_STRIDE.x) + (pixel.y * VOL_IN_STRIDE.y)) + (index * VOL_IN_GOLDEN_STRIDE);
    return (f32((place + 0x80000000u) >> 16u) * (1.0f / 65536.0f)) - 0.5;
}

// Takes one more sample into the mean.
fn vol_in_add_sample(old: Vol_in_Mean, sample: Vol_in_Radiance) -> Vol_in_Mean {
    var mean = old;
    mean.count += 1u;
    // The first is the mean, bit for bit.
    if (mean.count == 1u) {
        mean.color = sample.color;
        mean.transmittance = sample.transmittance;
        mean.depth = sample.depth;
        mean.doubt = sample.doubt;
        return mean;
    }
    let share = 1.0 / f32(mean.count);
    mean.doubt = mean.doubt + ((sample.doubt - mean.doubt) * share);
    let color = sample.color - mean.color;
    mean.color = mean.color + (color * share);
    mean.color_spread = mean.color_spread + vol_in_dot3(color, sample.color - mean.color);
    let transmittance = sample.transmittance - mean.transmittance;
    mean.transmittance = mean.transmittance + (transmittance * share);
    let from_new = sample.transmittance - mean.transmittance;
    mean.transmittance_spread = mean.transmittance_spread + vol_in_dot3(transmittance, from_new);
    return mean;
}

// Lets the radiance at a corner count for the spread, but not for the mean.
fn vol_in_add_probe(old: Vol_in_Mean, probe: Vol_in_Radiance) -> Vol_in_Mean {
    var mean = old;
    let color = probe.color - mean.color;
    mean.color_spread = mean.color_spread + vol_in_dot3(color, color);
    let transmittance = probe.transmittance - mean.transmittance;
    mean.transmittance_spread = mean.transmittance_spread + vol_in_dot3(transmittance, transmittance);
    return mean;
}

// Whether corners are probed: where there is a test before the last sample.
fn vol_in_is_probed() -> bool {
    return (vol_frame_word(VOL_IN_AT_TOLERANCE) > 0.0) && (u32(vol_frame_word(VOL_IN_AT_SAMPLES)) > VOL_IN_FIRST_ROUND);
}

// Whether the pixel takes no more samples.
fn vol_in_is_done(mean: Vol_in_Mean) -> bool {
    if (mean.count >= u32(vol_frame_word(VOL_IN_AT_SAMPLES))) {
        return true;
    }
    let tested = (mean.count >= VOL_IN_FIRST_ROUND) && (((mean.count - VOL_IN_FIRST_ROUND) % VOL_IN_ROUND) == 0u);
    let tolerance = vol_frame_word(VOL_IN_AT_TOLERANCE);
    return tested && (tolerance > 0.0) && vol_in_is_within(mean, tolerance);
}

// Whether the standard errors, rms over the channels, are within a tolerance.
fn vol_in_is_within(mean: Vol_in_Mean, tolerance: f32) -> bool {
    // Three channels; spread / (n (n - 1)) is the squared error of the mean.
    let count = f32(mean.count);
    let least = (3.0 * VOL_IN_LEAST_BRIGHTNESS) * VOL_IN_LEAST_BRIGHTNESS;
    let scaled = (tolerance * tolerance) * (count * (count - 1.0));
    let color = scaled * max(vol_in_dot3(mean.color, mean.color), least);
    let transmittance = scaled * 3.0;
    return (mean.color_spread <= color) && (mean.transmittance_spread <= transmittance);
}

// Rays: through the picture, and against boxes.
// Twin: runtime-cpu/src/render/camera.rs, which says why.

struct Vol_in_Ray {
    origin: vec3f,
    direction: vec3f,
    // How far its comb is moved along it: -1/2..1/2, in steps.
    shift: f32,
}

// With its comb where it is usually.
fn vol_in_new_ray(origin: vec3f, direction: vec3f) -> Vol_in_Ray {
    return Vol_in_Ray(origin, direction, 0.0);
}

struct Vol_in_Span {
    entry: f32,
    leave: f32,
}

fn vol_in_ray_at(ray: Vol_in_Ray, t: f32) -> vec3f {
    return ray.origin + (ray.direction * t);
}

fn vol_in_camera_ray(place: vec2f) -> Vol_in_Ray {
    let u = ((2.0 * place.x) / vol_frame_word(VOL_IN_AT_SIZE)) - 1.0;
    let v = 1.0 - ((2.0 * place.y) / vol_frame_word(VOL_IN_AT_SIZE + 1u));
    let sideways = vol_in_word3(VOL_IN_AT_FORWARD) + (vol_in_word3(VOL_IN_AT_RIGHT) * u);
    let toward = sideways + (vol_in_word3(VOL_IN_AT_UP) * v);
    return vol_in_new_ray(vol_in_word3(VOL_IN_AT_EYE), toward / vol_in_length3(toward));
}

// Part of a ray inside a box.
fn vol_in_slab(ray: Vol_in_Ray, lo: vec3f, hi: vec3f) -> Vol_in_Span {
    var span = Vol_in_Span(0.0, VOL_IN_FAR);
    for (var axis = 0u; axis < 3u; axis++) {
        // Where the ray crosses the two planes; along them it is between them always or never.
        let o = ray.origin[axis];
        let d = ray.direction[axis];
        let parallel = abs(d) < VOL_IN_PARALLEL;
        let divisor = select(d, 1.0, parallel);
        let a = (lo[axis] - o) / divisor;
        let b = (hi[axis] - o) / divisor;
        let beside = (o < lo[axis]) | (o > hi[axis]);
        let near = select(min(a, b), select(0.0, VOL_IN_FAR, beside), parallel);
        let end = select(max(a, b), select(VOL_IN_FAR, -VOL_IN_FAR, beside), parallel);
        span.entry = max(span.entry, near);
        span.leave = min(span.leave, end);
    }
    return span;
}

// A little longer than rounding can make it.
fn vol_in_loosened(span: Vol_in_Span) -> Vol_in_Span {
    let slack = 16.0 * VOL_IN_EPSILON;
    return Vol_in_Span(span.entry - (slack * span.entry), span.leave + (slack * span.leave));
}

fn vol_in_contains(lo: vec3f, hi: vec3f, point: vec3f) -> bool {
    return all(lo <= point) & all(point <= hi);
}

// How far a value of a solid's field can be walked: segment tracing.
// Twin: runtime-cpu/src/render/stride.rs, which says why.

// Makes the value of a solid's field safe to walk; what is inside stays as it is.
fn vol_in_shorten(solid: u32, ray: Vol_in_Ray, t: f32, last: f32, value: f32) -> f32 {
    let scale = vol_frame_word(vol_in_object_word(solid) + 7u);
    if (scale != VOL_IN_BY_STEEPNESS) {
        return scale * value;
    }
    if (!(value > 0.0)) {
        return value;
    }
    var ahead = vol_in_reach(last, value);
    for (var count = 0u; count < VOL_IN_TRIES; count++) {
        let steepest = vol_in_way_steepness(solid, ray, t, ahead);
        if (steepest < VOL_IN_NO_BOUND) {
            return min(value / steepest, ahead);
        }
        // Look less far where nothing is known: there may be a jump on the way.
        ahead = 0.25 * ahead;
    }
    return 0.0;
}

// Bound on the slope over the box of the next step, a little larger than rounding can make it.
fn vol_in_way_steepness(solid: u32, ray: Vol_in_Ray, t: f32, ahead: f32) -> f32 {
    let here = vol_in_ray_at(ray, t);
    let there = vol_in_ray_at(ray, t + ahead);
    let slack = (4.0 * VOL_IN_EPSILON) * (vol_in_remoteness() + (t + ahead));
    return vol_in_object_steepness(solid, min(here, there) - slack, max(here, there) + slack);
}

// How far the next step may go: to where a distance proper would, and at most twice as far as the last,
// if there was one.
fn vol_in_reach(last: f32, value: f32) -> f32 {
    let outside = max(value, 0.0);
    return select(outside, min(outside, 2.0 * last), last > 0.0);
}

// Where rays meet solids: sphere tracing.
// Twin: runtime-cpu/src/render/surface.rs, which says why.

struct Vol_in_Near {
    distance: f32,
    value: f32,
    solid: u32,
    gap: f32,
    rest: f32,
    entry: f32,
    leave: f32,
}

// A ray on its way: how far it is, where it was one step earlier, how far nothing could be from there, and whether it
// went farther than that.
struct Vol_in_Walker {
    t: f32,
    before: f32,
    free: f32,
    guessed: bool,
}

struct Vol_in_Contact {
    hit: bool,
    solid: u32,
    t: f32,
    position: vec3f,
    normal: vec3f,
    residual: f32,
}

fn vol_in_footprint() -> f32 {
    return (2.0 * vol_in_length3(vol_in_word3(VOL_IN_AT_UP))) / vol_frame_word(VOL_IN_AT_SIZE + 1u);
}

fn vol_in_remoteness() -> f32 {
    return vol_in_length3(vol_in_word3(VOL_IN_AT_EYE));
}

// How near a ray may pass a surface unseen: half a pixel, or what rounding makes of positions.
fn vol_in_tolerance(t: f32) -> f32 {
    let pixel = (0.5 * vol_in_footprint()) * t;
    return max(pixel, (4.0 * VOL_IN_EPSILON) * (vol_in_remoteness() + t));
}

// Shortest step of a ray: nothing thinner than a fortieth of a pixel is sure to be seen.
fn vol_in_stride(t: f32) -> f32 {
    let pixel = (0.025 * vol_in_footprint()) * t;
    return max(pixel, (4.0 * VOL_IN_EPSILON) * (vol_in_remoteness() + t));
}

fn vol_in_shadow_bias(t: f32) -> f32 {
    let pixel = (0.1 * vol_in_footprint()) * t;
    return pixel + vol_in_rounding(t);
}

// How far rounding may move a surface along a ray, with room to spare.
fn vol_in_rounding(t: f32) -> f32 {
    return (64.0 * VOL_IN_EPSILON) * (vol_in_remoteness() + t);
}

fn vol_in_object_word(solid: u32) -> u32 {
    return VOL_IN_AT_OBJECTS + (VOL_IN_OBJECT_WORDS * solid);
}

// A caller hands over the arrays that it wants filled: to return one copies each of its elements.

// Sign of each solid's distance as the camera sees it: -1 for those that hold the eye, with all that they
// are parts of.
fn vol_in_find_sides(sides: ptr<function, array<f32, VOL_IN_OBJECT_SLOTS>>) {
    for (var solid = 0u; solid < VOL_IN_OBJECT_COUNT; solid++) {
        let at = vol_in_object_word(solid);
        let eye = vol_in_word3(VOL_IN_AT_EYE);
        (*sides)[solid] = 1.0;
        if (vol_in_contains(vol_in_word3(at + 1u), vol_in_word3(at + 4u), eye) & (vol_frame_word(at) != 0.0)) {
            (*sides)[solid] = select(1.0, -1.0, vol_in_object_distance(solid, eye) < 0.0);
        }
        if (vol_in_joins_the_one_before(solid)) {
            (*sides)[solid] = min((*sides)[solid], (*sides)[solid - 1u]);
        }
    }
    for (var solid = VOL_IN_OBJECT_COUNT; solid > 1u; solid--) {
        if (vol_in_joins_the_one_before(solid - 1u)) {
            (*sides)[solid - 2u] = min((*sides)[solid - 2u], (*sides)[solid - 1u]);
        }
    }
}

fn vol_in_no_sides(sides: ptr<function, array<f32, VOL_IN_OBJECT_SLOTS>>) {
    for (var solid = 0u; solid < VOL_IN_OBJECT_COUNT; solid++) {
        (*sides)[solid] = 1.0;
    }
}

// Parts of the ray in the box of each solid, a little longer than rounding can make them; all of the
// ray for a solid that is seen from within, since it ends where the box may end.
fn vol_in_object_spans(
    ray: Vol_in_Ray,
    sides: ptr<function, array<f32, VOL_IN_OBJECT_SLOTS>>,
    spans: ptr<function, array<Vol_in_Span, VOL_IN_OBJECT_SLOTS>>,
) {
    for (var solid = 0u; solid < VOL_IN_OBJECT_COUNT; solid++) {
        let at = vol_in_object_word(solid);
        let span = vol_in_loosened(vol_in_slab(ray, vol_in_word3(at + 1u), vol_in_word3(at + 4u)));
        let there = vol_frame_word(at) != 0.0;
        (*spans)[solid].entry = select(VOL_IN_FAR, span.entry, there);
        let is_within = ((*sides)[solid] < 0.0) & (span.entry <= span.leave);
        let leave = select(span.leave, VOL_IN_FAR, is_within);
        (*spans)[solid].leave = select(-VOL_IN_FAR, leave, there);
    }
}

// What is around a place on the ray, `before` that of the last step.
fn vol_in_nearest(
    ray: Vol_in_Ray,
    spans: ptr<function, array<Vol_in_Span, VOL_IN_OBJECT_SLOTS>>,
    sides: ptr<function, array<f32, VOL_IN_OBJECT_SLOTS>>,
    t: f32,
    before: f32,
) -> Vol_in_Near {
    var near = Vol_in_Near(VOL_IN_FAR, VOL_IN_FAR, 0u, VOL_IN_FAR, 0.0, VOL_IN_FAR, VOL_IN_FAR);
    // What was near without the parts of a union that holds the eye, and the farthest wall of those: a ray is
    // inside as long as it is in one of them.
    var others = near;
    var farthest = -VOL_IN_FAR;
    for (var solid = 0u; solid < VOL_IN_OBJECT_COUNT; solid++) {
        let joined = vol_in_joins_the_one_before(solid) & ((*sides)[solid] < 0.0);
        if (!joined) {
            others = near;
            farthest = -VOL_IN_FAR;
        }
        let span = (*spans)[solid];
        let some = span.entry <= span.leave;
        let ahead = some & (t < span.entry);
        near.gap = select(near.gap, min(near.gap, span.entry - t), ahead);
        near.entry = select(near.entry, min(near.entry, span.entry), ahead);
        if (some & (t >= span.entry) & (t <= span.leave)) {
            near.rest = max(near.rest, span.leave - t);
            // A solid with a bound along rays alone tells nothing of what is beside the way.
            let is_ball = vol_frame_word(vol_in_object_word(solid) + 7u) != VOL_IN_BY_STEEPNESS;
            near.leave = min(near.leave, select(0.0, span.leave, is_ball));
            // Keep the smallest distance; the earlier solid on a tie.
            let seen = (*sides)[solid] * vol_in_object_distance(solid, vol_in_ray_at(ray, t));
            let safe = vol_in_shorten(solid, ray, t, t - before, seen);
            if (!joined | (seen > farthest)) {
                farthest = seen;
                near.value = min(others.value, seen);
                let closer = safe < others.distance;
                near.distance = select(others.distance, safe, closer);
                near.solid = select(others.solid, solid, closer);
            }
        }
    }
    return near;
}

// How far to walk: as far as nothing can be, at least by `least`. A ray that has used up half of its steps
// goes through what is left of the boxes in even steps.
fn vol_in_advance(near: Vol_in_Near, step: u32, least: f32) -> f32 {
    let free = min(near.distance, near.gap);
    let left = f32((VOL_IN_MAX_STEPS - step) + 1u);
    let even = select(0.0, min(near.rest / left, near.gap), vol_in_is_stuck(step));
    return max(max(free, least), even);
}

fn vol_in_is_stuck(step: u32) -> bool {
    return step > (VOL_IN_MAX_STEPS / 2u);
}

// Goes on, if possible farther than is sure: runtime-cpu/src/render/near.rs says why.
fn vol_in_onward(near: Vol_in_Near, walker: Vol_in_Walker, step: u32, least: f32) -> Vol_in_Walker {
    let sure = vol_in_advance(near, step, least);
    let last = walker.t - walker.before;
    let is_first = last <= 0.0;
    let fall = max((walker.free - near.distance) / select(last, 1.0, is_first), 0.0);
    let touching = (VOL_IN_EAGERNESS * near.distance) / (1.0 + fall);
    let guess = min(min(touching, VOL_IN_ROOM * near.gap), VOL_IN_ROOM * (near.leave - walker.t));
    let place = walker.t + guess;
    let is_inside = (place < near.entry) & (place <= near.leave);
    let guessed = (guess > sure) & is_inside & !is_first & !vol_in_is_stuck(step);
    return Vol_in_Walker(select(walker.t + sure, place, guessed), walker.t, sure, guessed);
}

// Whether a walker has gone too far: the balls that are empty around this place and the last do not touch.
fn vol_in_is_past(near: Vol_in_Near, walker: Vol_in_Walker) -> bool {
    return walker.guessed & ((walker.free + near.distance) < (walker.t - walker.before));
}

// Goes back to where it was sure to come.
fn vol_in_back(walker: Vol_in_Walker) -> Vol_in_Walker {
    return Vol_in_Walker(walker.before + walker.free, walker.before, walker.free, false);
}

// First surface on the ray.
fn vol_in_trace(ray: Vol_in_Ray) -> Vol_in_Contact {
    var sides: array<f32, VOL_IN_OBJECT_SLOTS>;
    var spans: array<Vol_in_Span, VOL_IN_OBJECT_SLOTS>;
    vol_in_find_sides(&sides);
    vol_in_object_spans(ray, &sides, &spans);
    var walker = Vol_in_Walker(0.0, 0.0, 0.0, false);
    var hit = false;
    var solid = 0u;
    for (var count = 1u; count <= VOL_IN_MAX_STEPS; count++) {
        let near = vol_in_nearest(ray, &spans, &sides, walker.t, walker.before);
        if (vol_in_is_past(near, walker)) {
            walker = vol_in_back(walker);
            continue;
        }
        // Stop inside a solid; on the last step also where it would have been near enough.
        hit = near.value < select(0.0, vol_in_tolerance(walker.t), count == VOL_IN_MAX_STEPS);
        solid = near.solid;
        // Walk as far as nothing can be, at least a fortieth of a pixel.
        let next = vol_in_onward(near, walker, count, vol_in_stride(walker.t));
        if (hit | (next.t >= VOL_IN_FAR)) {
            break;
        }
        walker = next;
    }
    if (hit) {
        return vol_in_refine(ray, solid, walker.before, walker.t, sides[solid]);
    }
    return Vol_in_Contact(false, 0u, VOL_IN_FAR, vec3f(0.0), vec3f(0.0), 0.0);
}

// Two places on a ray, the field 0 between them: (t, value) each.
struct Vol_in_Bracket {
    outside: vec2f,
    inside: vec2f,
}

// False position between the last two places.
fn vol_in_refine(ray: Vol_in_Ray, solid: u32, before: f32, t: f32, side: f32) -> Vol_in_Contact {
    var bracket = Vol_in_Bracket(vec2f(before, 0.0), vec2f(t, 0.0));
    // The values at both ends come first: the field is asked at one place of the text, since drivers
    // write it out at each.
    for (var round = 0u; round < (2u + VOL_IN_REFINEMENTS); round++) {
        let place = select(select(vol_in_probe(bracket), t, round == 1u), before, round == 0u);
        let found = vec2f(place, side * vol_in_object_distance(solid, vol_in_ray_at(ray, place)));
        if (round == 0u) {
            bracket.outside = found;
        } else if (round == 1u) {
            bracket.inside = found;
        } else {
            bracket = vol_in_narrow(bracket, found);
        }
    }
    let nearer = abs(bracket.outside.y) < abs(bracket.inside.y);
    let best = select(bracket.inside, bracket.outside, nearer);
    let gradient = vol_in_facing_gradient(ray, solid, best.x, side);
    return vol_in_contact(ray, solid, best.x, abs(best.y), gradient);
}

// Gradient where a ray enters a solid: taken a little inside, or outside if it points along the ray.
fn vol_in_facing_gradient(ray: Vol_in_Ray, solid: u32, t: f32, side: f32) -> vec3f {
    var gradient = vec3f(0.0);
    var aside = vol_in_rounding(t);
    for (var round = 0u; round < 2u; round++) {
        gradient = vol_in_object_gradient(solid, vol_in_ray_at(ray, t + aside)) * side;
        if (!(vol_in_dot3(gradient, ray.direction) > 0.0)) {
            break;
        }
        aside = -aside;
    }
    return gradient;
}

// Where the field would be 0 if it were linear between the two; the inner place where it does not
// change sign.
fn vol_in_probe(bracket: Vol_in_Bracket) -> f32 {
    let is_proper = (bracket.outside.y >= 0.0) & (bracket.inside.y < 0.0);
    let fall = select(1.0, bracket.outside.y - bracket.inside.y, is_proper);
    let part = bracket.outside.y / fall;
    let between = bracket.outside.x + ((bracket.inside.x - bracket.outside.x) * part);
    return select(bracket.inside.x, between, is_proper);
}

// Takes the value at the probe into account.
fn vol_in_narrow(bracket: Vol_in_Bracket, found: vec2f) -> Vol_in_Bracket {
    let within = found.y < 0.0;
    return Vol_in_Bracket(select(found, bracket.outside, within), select(bracket.inside, found, within));
}

// The place of a hit, its normal and how exact it is.
fn vol_in_contact(ray: Vol_in_Ray, solid: u32, t: f32, value: f32, gradient: vec3f) -> Vol_in_Contact {
    let steepness = vol_in_length3(gradient);
    let is_flat = steepness < VOL_IN_FLAT;
    let divisor = select(steepness, 1.0, is_flat);
    let normal = select(gradient / divisor, -ray.direction, is_flat);
    let most = 4.0 * vol_in_tolerance(t);
    return Vol_in_Contact(true, solid, t, vol_in_ray_at(ray, t), normal, min(value / divisor, most));
}

// What surfaces look like: their own light, and the lights that reach them.
// Twin: runtime-cpu/src/render/shade.rs, which says why.

struct Vol_in_Response {
    emitted: vec3f,
    diffuse: vec3f,
    specular: vec3f,
    shininess: f32,
}

struct Vol_in_Arriving {
    direction: vec3f,
    distance: f32,
    irradiance: vec3f,
    shadows: bool,
    slope: f32,
    // Word of the light's grid, 0 for none.
    grid: u32,
    // Word of its style's record, 0 for none.
    style: u32,
}

fn vol_in_light_count() -> u32 {
    return u32(vol_frame_word(VOL_IN_AT_LIGHT_COUNT));
}

// What a light sends to a point.
fn vol_in_arriving(light: u32, point: vec3f) -> Vol_in_Arriving {
    let at = VOL_IN_AT_LIGHTS + (VOL_IN_LIGHT_WORDS * light);
    let distant = vol_frame_word(at) != 0.0;
    let toward = vol_in_word3(at + 1u) - point;
    // At the very place of the light the irradiance stays finite.
    let squared = max(vol_in_dot3(toward, toward), 1e-12);
    let distance = sqrt(squared);
    let direction = select(toward / distance, vol_in_word3(at + 1u), distant);
    let irradiance = select(vol_in_word3(at + 4u) / squared, vol_in_word3(at + 4u), distant);
    let shadows = vol_frame_word(at + 7u) != 0.0;
    let size = vol_frame_word(at + 8u);
    let slope = select(min(size / distance, VOL_IN_MAX_SPREAD_TANGENT), size, distant);
    let grid = u32(vol_frame_word(at + 10u));
    let style = u32(vol_frame_word(at + 11u));
    return Vol_in_Arriving(direction, select(distance, VOL_IN_FAR, distant), irradiance, shadows, slope, grid, style);
}

// Radiance that leaves a contact towards the eye.
fn vol_in_shade(ray: Vol_in_Ray, contact: Vol_in_Contact) -> vec3f {
    if (vol_frame_word(vol_in_object_word(contact.solid)) == VOL_IN_SHOWS_NORMALS) {
        return (contact.normal + vec3f(1.0)) * 0.5;
    }
    let response = vol_in_object_surface(contact.solid, contact.position);
    let answers = any(response.diffuse != vec3f(0.0)) | any(response.specular != vec3f(0.0));
    var color = response.emitted;
    let count = select(0u, vol_in_light_count(), answers);
    for (var light = 0u; light < count; light++) {
        let lamp = vol_in_arriving(light, contact.position);
        let cosine = vol_in_dot3(contact.normal, lamp.direction);
        if (cosine > 0.0) {
            var seen = vol_in_surface_visibility(lamp, contact);
            if (VOL_IN_OCCLUDING_LIGHTS) {
                let reach = vol_frame_word(VOL_IN_AT_LIGHTS + (VOL_IN_LIGHT_WORDS * light) + 9u);
                if (reach > 0.0) {
                    seen = seen * vol_in_openness(contact, reach);
                }
            }
            color += (lamp.irradiance * seen) * vol_in_answer(response, contact, lamp, cosine, ray.direction);
        }
    }
    return color;
}

// Fraction of the light that arrives at a contact.
fn vol_in_surface_visibility(lamp: Vol_in_Arriving, contact: Vol_in_Contact) -> vec3f {
    if (!lamp.shadows) {
        return vec3f(1.0);
    }
    // Start off the surface, by at least twice what the hit may be off.
    let bias = vol_in_shadow_bias(contact.t);
    let offset = max(bias, 2.0 * contact.residual);
    let origin = contact.position + (contact.normal * offset);
    return vol_in_soft_visibility(vol_in_new_ray(origin, lamp.direction), lamp.distance, bias, lamp.slope, lamp.grid);
}

// Radiance towards the eye per irradiance on a facing plane.
fn vol_in_answer(response: Vol_in_Response, contact: Vol_in_Contact, lamp: Vol_in_Arriving, cosine: f32, direction: vec3f) -> vec3f {
    let mirrored = (contact.normal * (2.0 * cosine)) - lamp.direction;
    let shine = vol_in_power(vol_in_dot3(mirrored, -direction), response.shininess);
    return (response.diffuse * cosine) + (response.specular * shine);
}

// How much of a light arrives at a point: solids between hide it, media between weaken it.
// Twin: runtime-cpu/src/render/shadow.rs, which says why.

// Fraction of a light with a slope that arrives, per channel.
fn vol_in_soft_visibility(ray: Vol_in_Ray, distance: f32, bias: f32, slope: f32, grid: u32) -> vec3f {
    var part = 0.0;
    if (VOL_IN_SOFT_LIGHTS && (slope > 0.0)) {
        part = vol_in_lit_part_of(ray, distance, 0.25 * bias, slope);
    } else {
        part = vol_in_unblocked(ray, distance, bias);
    }
    return vol_in_through_media(ray, distance, part, grid);
}

// The part of a light without size that solids let through.
fn vol_in_unblocked(ray: Vol_in_Ray, distance: f32, bias: f32) -> f32 {
    return select(1.0, 0.0, vol_in_blocked(ray, distance, 0.25 * bias));
}

// The part of a light that solids let through, weakened by the media.
fn vol_in_through_media(ray: Vol_in_Ray, distance: f32, part: f32, grid: u32) -> vec3f {
    // Only what solids do not hide goes through the media.
    if (part <= 0.0) {
        return vec3f(0.0);
    }
    let depth = vol_in_depth_towards(ray, distance, grid);
    return select(vol_in_decay3(depth) * part, vec3f(0.0), vol_in_smallest(depth) > VOL_IN_OPAQUE);
}

// Optical depth between a point and a light: of its grid where it has one.
fn vol_in_depth_towards(ray: Vol_in_Ray, distance: f32, grid: u32) -> vec3f {
    if (VOL_IN_LIGHT_GRIDS) {
        if (grid != 0u) {
            return vol_in_grid_depth(grid, ray.origin);
        }
    }
    return vol_in_optical_depth(ray, distance);
}

// Whether a place on a ray with a shortest step is inside a solid: at first twice the bias does not count.
fn vol_in_enters(distance: f32, t: f32, least: f32) -> bool {
    let start = (8.0 * least) - t;
    return distance < -max(start, 0.0);
}

// Whether the ray enters a solid before it reaches the light.
fn vol_in_blocked(ray: Vol_in_Ray, distance: f32, least: f32) -> bool {
    var sides: array<f32, VOL_IN_OBJECT_SLOTS>;
    var spans: array<Vol_in_Span, VOL_IN_OBJECT_SLOTS>;
    vol_in_no_sides(&sides);
    vol_in_object_spans(ray, &sides, &spans);
    let end = min(distance, VOL_IN_FAR);
    var walker = Vol_in_Walker(0.0, 0.0, 0.0, false);
    var inside = false;
    for (var count = 1u; count <= VOL_IN_MAX_STEPS; count++) {
        let near = vol_in_nearest(ray, &spans, &sides, walker.t, walker.before);
        if (vol_in_is_past(near, walker)) {
            walker = vol_in_back(walker);
            continue;
        }
        // Only the inside of a solid hides: a ray may leave a surface at a grazing angle.
        inside = vol_in_enters(near.distance, walker.t, least);
        walker = vol_in_onward(near, walker, count, least);
        if (inside | (walker.t >= end)) {
            break;
        }
    }
    return inside;
}

// Optical depth between a light and a point, looked up in the light's grid.
// Twin: runtime-cpu/src/render/light_grid.rs, which says why.

// Depth at a point; `grid` is the word of the grid's record.
fn vol_in_grid_depth(grid: u32, point: vec3f) -> vec3f {
    // Find the point as the light sees it.
    let origin = vol_in_word3(grid + 1u);
    let lo = vol_in_word3(grid + 13u);
    let scale = vol_in_word3(grid + 16u);
    let counts = vol_in_word3(grid + 19u);
    let distant = vol_frame_word(grid) != 0.0;
    let off = point - origin;
    let u = vol_in_dot3(off, vol_in_word3(grid + 4u));
    let v = vol_in_dot3(off, vol_in_word3(grid + 7u));
    let w = vol_in_dot3(off, vol_in_word3(grid + 10u));
    let ahead = distant | (w > (0.5 * lo.z));
    let divisor = select(1.0, w, ahead & !distant);
    let seen = vec3f(u / divisor, v / divisor, select(vol_in_length3(off), w, distant));
    let last = counts - vec3f(1.0);
    let place = (seen - lo) * scale;
    let beside = (place.x < 0.0) | (place.x > last.x) | (place.y < 0.0) | (place.y > last.y);
    // Nothing is before the grid or beside it.
    if (!ahead | beside | (place.z <= 0.0)) {
        return vec3f(0.0);
    }
    // Behind it nothing is added.
    let channels = u32(vol_frame_word(grid + 25u));
    let spline = vol_frame_word(grid + 27u) != 0.0;
    let x = vol_in_stencil(place.x, last.x, spline);
    let y = vol_in_stencil(place.y, last.y, spline);
    let z = vol_in_stencil(min(place.z, last.z), last.z, spline);
    let first = u32(vol_frame_word(grid + 26u));
    let tint = vol_in_word3(grid + 22u);
    var depth = vec3f(0.0);
    for (var channel = 0u; channel < channels; channel++) {
        depth[channel] = vol_in_grid_channel(first, x, y, z, i32(counts.y), channel, channels);
    }
    return tint * select(depth, vec3f(depth.x), channels == 1u);
}

// One channel between the points around; what the cubic overshoots below 0 is cut off.
fn vol_in_grid_channel(
    first: u32,
    x: Vol_in_Stencil,
    y: Vol_in_Stencil,
    z: Vol_in_Stencil,
    columns: i32,
    channel: u32,
    channels: u32,
) -> f32 {
    // Always 4, which no driver knows: unrolled wherever it is asked for, this compiles for minutes.
    let four = min(channels + 3u, 4u);
    // Four sums side by side, which are one vector.
    var sums = vec4f(0.0);
    for (var i = 0u; i < four; i++) {
        for (var j = 0u; j < four; j++) {
            // Before the points of a column and behind them its depths are the first and the last one.
            let column = first + 3u * u32((x.at[i] * columns) + y.at[j]);
            let begin = i32(vol_input_word(column));
            let more = i32(vol_input_word(column + 1u));
            let depths = (first + 4u * u32(vol_input_word(column + 2u))) + channel;
            let row = vec4u(clamp(z.at - vec4i(begin), vec4i(0), vec4i(more))) * channels + depths;
            let around = vec4f(vol_input_word(row.x), vol_input_word(row.y), vol_input_word(row.z), vol_input_word(row.w));
            sums += (x.weights[i] * y.weights[j]) * around;
        }
    }
    let weighted = z.weights * sums;
    return max(((weighted.x + weighted.y) + weighted.z) + weighted.w, 0.0);
}

// The four points around a place along one axis.
struct Vol_in_Stencil {
    // Their numbers; where there is none the last one counts twice.
    at: vec4i,
    weights: vec4f,
}

// `place` in 0..`last`.
fn vol_in_stencil(place: f32, last: f32, spline: bool) -> Vol_in_Stencil {
    let index = min(floor(place), last - 1.0);
    let t = place - index;
    let local = vec4f(
        (((1.0 - (0.5 * t)) * t) - 0.5) * t,
        ((((1.5 * t) - 2.5) * t) * t) + 1.0,
        (((2.0 - (1.5 * t)) * t) + 0.5) * t,
        (((0.5 * t) - 0.5) * t) * t,
    );
    let back = 1.0 - t;
    let through = vec4f(
        0.16666667 * (back * (back * back)),
        0.6666667 - ((t * t) * (1.0 - (0.5 * t))),
        0.6666667 - ((back * back) * (1.0 - (0.5 * back))),
        0.16666667 * (t * (t * t)),
    );
    let weights = select(local, through, spline);
    let around = vec4i(i32(index)) + vec4i(-1, 0, 1, 2);
    return Vol_in_Stencil(clamp(around, vec4i(0), vec4i(i32(last))), weights);
}

// How much of a light with a size is seen past the solids: soft shadows.
// Twin: runtime-cpu/src/render/penumbra.rs, which says why.

const VOL_IN_RIM_COUNT: u32 = 8u;
const VOL_IN_RIM = array<vec2f, 8>(vec2f(1.0, 0.0), vec2f(0.70710677, 0.70710677), vec2f(0.0, 1.0), vec2f(-0.70710677, 0.70710677), vec2f(-1.0, 0.0), vec2f(-0.70710677, -0.70710677), vec2f(0.0, -1.0), vec2f(0.70710677, -0.70710677));
const VOL_IN_PLACE_COUNT: u32 = 19u;
const VOL_IN_PLACES = array<vec2f, 19>(vec2f(0.0, 0.0), vec2f(0.4, 0.0), vec2f(0.2, 0.3464102), vec2f(-0.2, 0.3464102), vec2f(-0.4, 0.0), vec2f(-0.2, -0.3464102), vec2f(0.2, -0.3464102), vec2f(0.7727407, 0.2070552), vec2f(0.5656854, 0.5656854), vec2f(0.2070552, 0.7727407), vec2f(-0.2070552, 0.7727407), vec2f(-0.5656854, 0.5656854), vec2f(-0.7727407, 0.2070552), vec2f(-0.7727407, -0.2070552), vec2f(-0.5656854, -0.5656854), vec2f(-0.2070552, -0.7727407), vec2f(0.2070552, -0.7727407), vec2f(0.5656854, -0.5656854), vec2f(0.7727407, -0.2070552));
const VOL_IN_CLEAR: f32 = 2.0;
const VOL_IN_BLUR: f32 = 0.3;
const VOL_IN_LACK: f32 = 0.05;

struct Vol_in_Around {
    distance: f32,
    safe: f32,
    gap: f32,
}

// Fraction of a light that no solid hides.
fn vol_in_lit_part_of(ray: Vol_in_Ray, distance: f32, least_step: f32, slope: f32) -> f32 {
    var ends = VOL_IN_RIM;
    var clear: array<f32, VOL_IN_RIM_COUNT>;
    var centre = 0.0;
    // The centre, then the rim: walked at one place of the text, since drivers write it out at each.
    for (var index = 0u; index <= VOL_IN_RIM_COUNT; index++) {
        let end = max(index, 1u) - 1u;
        var toward = ray;
        if (index > 0u) {
            toward = vol_in_rim(ray, slope, ends[end]);
        }
        let found = vol_in_walk(toward, distance, least_step, slope);
        if (index > 0u) {
            clear[end] = found;
        } else if (found >= 1.0) {
            return 1.0;
        } else {
            centre = found;
        }
    }
    return vol_in_lit_part(centre, &clear);
}

// Walks along the axis of a cone and keeps the smallest angle to a solid.
fn vol_in_walk(ray: Vol_in_Ray, distance: f32, least_step: f32, slope: f32) -> f32 {
    var lowest = vol_in_squared_sine(VOL_IN_CLEAR * slope);
    var spans: array<Vol_in_Span, VOL_IN_OBJECT_SLOTS>;
    vol_in_cone_spans(ray, distance, slope, &spans);
    let end = min(distance, VOL_IN_FAR);
    var t = 0.0;
    var older = vec2f(0.0);
    var newer = vec2f(0.0);
    for (var count = 0u; count < VOL_IN_MAX_STEPS; count++) {
        let near = vol_in_around(ray, &spans, t);
        // A ray that enters a solid is not clear at all.
        if (vol_in_enters(near.distance, t, least_step)) {
            lowest = 0.0;
            break;
        }
        // Count what is surely not behind the light.
        let counts = (t > 0.0) & (near.distance >= 0.0) & (near.distance < (end - t));
        let divisor = select(1.0, t, counts);
        let sine = min(near.distance / divisor, 1.0);
        let sample = vec2f(1.0 / divisor, sine * sine);
        let found = min(sample.y, vol_in_least(older, newer, sample));
        lowest = select(lowest, min(lowest, found), counts);
        older = select(vec2f(0.0), newer, counts);
        newer = select(vec2f(0.0), sample, counts);
        t += vol_in_cone_step(near, least_step, slope, t);
        if (t >= end) {
            break;
        }
    }
    return vol_in_clearance(lowest, slope);
}

// Parts of the ray where a solid's box is within the cone.
fn vol_in_cone_spans(
    ray: Vol_in_Ray,
    distance: f32,
    slope: f32,
    spans: ptr<function, array<Vol_in_Span, VOL_IN_OBJECT_SLOTS>>,
) {
    for (var solid = 0u; solid < VOL_IN_OBJECT_COUNT; solid++) {
        let at = vol_in_object_word(solid);
        let lo = vol_in_word3(at + 1u);
        let hi = vol_in_word3(at + 4u);
        let farthest = vol_in_length3(max(abs(lo - ray.origin), abs(hi - ray.origin)));
        let width = (VOL_IN_CLEAR * slope) * min(farthest, distance);
        let span = vol_in_loosened(vol_in_slab(ray, lo - vec3f(width), hi + vec3f(width)));
        let there = vol_frame_word(at) != 0.0;
        (*spans)[solid].entry = select(VOL_IN_FAR, span.entry, there);
        (*spans)[solid].leave = select(-VOL_IN_FAR, span.leave, there);
    }
}

// What is around a place on the ray.
fn vol_in_around(ray: Vol_in_Ray, spans: ptr<function, array<Vol_in_Span, VOL_IN_OBJECT_SLOTS>>, t: f32) -> Vol_in_Around {
    var near = Vol_in_Around(VOL_IN_FAR, VOL_IN_FAR, VOL_IN_FAR);
    for (var solid = 0u; solid < VOL_IN_OBJECT_COUNT; solid++) {
        let span = (*spans)[solid];
        let some = span.entry <= span.leave;
        let before = some & (t < span.entry);
        near.gap = select(near.gap, min(near.gap, span.entry - t), before);
        if (some & (t >= span.entry) & (t <= span.leave)) {
            let value = vol_in_object_distance(solid, vol_in_ray_at(ray, t));
            let safe = vol_in_shorten(solid, ray, t, 0.0, value);
            // A field in units of its own is as far from 0 as its slope there says.
            let own_units = vol_frame_word(vol_in_object_word(solid) + 7u) == VOL_IN_BY_STEEPNESS;
            near.distance = min(near.distance, select(value, safe, own_units));
            near.safe = min(near.safe, safe);
        }
    }
    return near;
}

// Squared sine of an angle from its tangent.
fn vol_in_squared_sine(tangent: f32) -> f32 {
    let squared = tangent * tangent;
    return squared / (1.0 + squared);
}

// A clearance in radii of the light from its squared sine.
fn vol_in_clearance(lowest: f32, slope: f32) -> f32 {
    let cosine = max(1.0 - lowest, VOL_IN_EPSILON);
    return min(sqrt(lowest / cosine) / slope, VOL_IN_CLEAR);
}

// How far to walk.
fn vol_in_cone_step(near: Vol_in_Around, least_step: f32, slope: f32, t: f32) -> f32 {
    let sine = sqrt(vol_in_squared_sine(VOL_IN_CLEAR * slope));
    let free = (near.safe - (sine * t)) / (1.0 + sine);
    let shortest = max(least_step, (0.002 * slope) * t);
    return max(min(max(free, 0.5 * near.safe), near.gap), shortest);
}

// Least value of the parabola through three samples if the middle one is the lowest, else that.
fn vol_in_least(a: vec2f, b: vec2f, c: vec2f) -> f32 {
    let in_order = (a.x > b.x) & (b.x > c.x);
    let lowest = (b.y <= a.y) & (b.y <= c.y);
    if (!(in_order & lowest)) {
        return c.y;
    }
    let fall = (b.y - a.y) / (b.x - a.x);
    let rise = (c.y - b.y) / (c.x - b.x);
    let bend = (rise - fall) / (c.x - a.x);
    if (bend <= 0.0) {
        return b.y;
    }
    let place = (0.5 * (a.x + b.x)) - (0.5 * (fall / bend));
    let value = a.y + ((place - a.x) * (fall + (bend * (place - b.x))));
    return min(max(value, 0.75 * b.y), b.y);
}

// A ray to the rim of a light.
fn vol_in_rim(ray: Vol_in_Ray, slope: f32, end: vec2f) -> Vol_in_Ray {
    let d = ray.direction;
    // Two unit vectors across the direction and each other.
    let turn = select(1.0, -1.0, d.z < 0.0);
    let a = -1.0 / (turn + d.z);
    let b = (d.x * d.y) * a;
    let right = vec3f(1.0 + (turn * ((d.x * d.x) * a)), turn * b, -(turn * d.x));
    let up = vec3f(b, turn + ((d.y * d.y) * a), -d.y);
    let toward = d + (((right * end.x) + (up * end.y)) * slope);
    return vol_in_new_ray(ray.origin, toward / vol_in_length3(toward));
}

// Area of the union of clear disks around the centre and the places on the rim, over that of the light.
fn vol_in_lit_part(centre: f32, clear: ptr<function, array<f32, VOL_IN_RIM_COUNT>>) -> f32 {
    var ends = VOL_IN_RIM;
    var places = VOL_IN_PLACES;
    var sum = 0.0;
    for (var index = 0u; index < VOL_IN_PLACE_COUNT; index++) {
        // How far inside the lit part the place is, at least.
        var inside = vol_in_clear_depth(centre, vec2f(0.0), places[index]);
        for (var end = 0u; end < VOL_IN_RIM_COUNT; end++) {
            inside = max(inside, vol_in_clear_depth((*clear)[end], ends[end], places[index]));
        }
        let edge = min(max((inside + VOL_IN_LACK) / VOL_IN_BLUR, -1.0), 1.0);
        let over = 1.0 + edge;
        sum += (0.25 * (over * over)) * (2.0 - edge);
    }
    let part = sum / f32(VOL_IN_PLACE_COUNT);
    // Reach 1 where the centre is clear of the whole light, and 0 where nothing is clear.
    let whole = max((4.0 * centre) - 3.0, 0.0);
    var widest = centre;
    for (var end = 0u; end < VOL_IN_RIM_COUNT; end++) {
        widest = max(widest, (*clear)[end]);
    }
    return (part + ((1.0 - part) * (whole * whole))) * min(10.0 * widest, 1.0);
}

// How deep a place lies in the clear disk around the end of a ray; far outside if the ray is blocked.
fn vol_in_clear_depth(clear: f32, end: vec2f, place: vec2f) -> f32 {
    let aside = place - end;
    let distance = sqrt((aside.x * aside.x) + (aside.y * aside.y));
    return select(-VOL_IN_CLEAR, clear - distance, clear > 0.0);
}

// How open a surface is: light that reaches it from all sides, as an option of a light.
// Twin: runtime-cpu/src/render/occlusion.rs, which says why.

const VOL_IN_WEIGHT_COUNT: u32 = 5u;
const VOL_IN_WEIGHTS = array<f32, 5>(16.0, 8.0, 4.0, 2.0, 1.0);
const VOL_IN_WEIGHT_SUM: f32 = 31.0;

// How open a contact is, 0 to 1, to what is within a distance of it.
fn vol_in_openness(contact: Vol_in_Contact, reach: f32) -> f32 {
    var weights = VOL_IN_WEIGHTS;
    var sides: array<f32, VOL_IN_OBJECT_SLOTS>;
    vol_in_find_sides(&sides);
    var hidden = 0.0;
    for (var index = 0u; index < VOL_IN_WEIGHT_COUNT; index++) {
        let share = f32(index + 1u) / f32(VOL_IN_WEIGHT_COUNT);
        let height = share * reach;
        let distance = vol_in_distance_above(contact, height, &sides);
        let lack = max((height - distance) / height, 0.0);
        hidden += weights[index] * min(0.5 * lack, 1.0);
    }
    return 1.0 - min(hidden / VOL_IN_WEIGHT_SUM, 1.0);
}

// Distance of the nearest solid at a height above a contact; at most the height.
fn vol_in_distance_above(
    contact: Vol_in_Contact,
    height: f32,
    sides: ptr<function, array<f32, VOL_IN_OBJECT_SLOTS>>,
) -> f32 {
    let point = contact.position + (contact.normal * height);
    var distance = height;
    // That without the parts of a union that holds the eye, whose farthest wall counts.
    var others = height;
    var farthest = -VOL_IN_FAR;
    for (var solid = 0u; solid < VOL_IN_OBJECT_COUNT; solid++) {
        if (!(vol_in_joins_the_one_before(solid) & ((*sides)[solid] < 0.0))) {
            others = distance;
            farthest = -VOL_IN_FAR;
        }
        // A solid whose box is farther than the height hides nothing.
        let at = vol_in_object_word(solid);
        let lo = vol_in_word3(at + 1u) - vec3f(height);
        let hi = vol_in_word3(at + 4u) + vec3f(height);
        if (vol_in_contains(lo, hi, point) & (vol_frame_word(at) != 0.0)) {
            farthest = max(farthest, (*sides)[solid] * vol_in_object_distance(solid, point));
            distance = min(others, farthest);
        }
    }
    return distance;
}

// How far apart the nodes of a ray are.
// Twin: runtime-cpu/src/render/spacing.rs, which says why.

// A node, and the steps that it stands for.
struct Vol_in_Node {
    first: i32,
    steps: i32,
    // Among all nodes of the ray.
    number: i32,
}

// The widest spacing of the media: steps of a block.
fn vol_in_widest_spacing() -> i32 {
    var widest = 1;
    if (VOL_IN_SPACED) {
        {
            let medium = 0u;
            widest = max(widest, i32(vol_frame_word(vol_in_medium_word(medium) + 8u)));
        }
    }
    return widest;
}

fn vol_in_spacing_of(comb: ptr<function, Vol_in_Comb>, medium: u32) -> i32 {
    if (VOL_IN_SPACED && ((*comb).block > 1)) {
        return i32(vol_frame_word(vol_in_medium_word(medium) + 8u));
    }
    return 1;
}

// Steps of a node in the block of a step: those of the finest medium that has a run there. Before the first block nodes are as
// in it.
fn vol_in_spacing_at(comb: ptr<function, Vol_in_Comb>, step: i32) -> i32 {
    var spacing = (*comb).block;
    if (VOL_IN_SPACED) {
        let first = max(step, 0) & -spacing;
        let last = f32(first + (spacing - 1));
        {
            let medium = 0u;
            let runs = (*comb).all[medium];
            let there = any((runs.first <= vec4f(last)) & (runs.last >= vec4f(f32(first))));
            spacing = select(spacing, min(spacing, vol_in_spacing_of(comb, medium)), there);
        }
    }
    return spacing;
}

// Distance of a node from the origin of the ray: of the middle of its steps.
fn vol_in_middle_of(comb: ptr<function, Vol_in_Comb>, node: Vol_in_Node) -> f32 {
    return vol_in_node_distance(node.first, (*comb).step, (*comb).offset + (0.5 * f32(node.steps - 1)));
}

fn vol_in_is_block_begun(comb: ptr<function, Vol_in_Comb>, step: i32) -> bool {
    return (step & ((*comb).block - 1)) == 0;
}

fn vol_in_node_after(comb: ptr<function, Vol_in_Comb>, node: Vol_in_Node) -> Vol_in_Node {
    var after = Vol_in_Node(node.first + node.steps, node.steps, node.number + 1);
    if (VOL_IN_SPACED && vol_in_is_block_begun(comb, after.first)) {
        after.steps = vol_in_spacing_at(comb, after.first);
    }
    return after;
}

fn vol_in_node_before(comb: ptr<function, Vol_in_Comb>, node: Vol_in_Node) -> Vol_in_Node {
    var steps = node.steps;
    if (VOL_IN_SPACED && vol_in_is_block_begun(comb, node.first)) {
        steps = vol_in_spacing_at(comb, node.first - 1);
    }
    return Vol_in_Node(node.first - steps, steps, node.number - 1);
}

// The node that stands for a step not before another node, with no run between the blocks of the two.
fn vol_in_node_at(comb: ptr<function, Vol_in_Comb>, known: Vol_in_Node, step: i32) -> Vol_in_Node {
    if (!VOL_IN_SPACED) {
        return Vol_in_Node(step, 1, step);
    }
    let block = (*comb).block;
    let own_end = (known.first | (block - 1)) + 1;
    if (step < own_end) {
        let more = (step - known.first) / known.steps;
        return Vol_in_Node(known.first + (more * known.steps), known.steps, known.number + more);
    }
    let begin = step & -block;
    let steps = vol_in_spacing_at(comb, step);
    let whole = ((own_end - known.first) / known.steps) + ((begin - own_end) / block);
    let more = (step - begin) / steps;
    return Vol_in_Node(begin + (more * steps), steps, known.number + (whole + more));
}

// The node that is a number of nodes before the one that stands for a step, but none before another; as of node_at.
fn vol_in_node_ahead(comb: ptr<function, Vol_in_Comb>, earliest: Vol_in_Node, step: i32, lead: i32) -> Vol_in_Node {
    if (!VOL_IN_SPACED) {
        let first = max(earliest.first, step - lead);
        return Vol_in_Node(first, 1, first);
    }
    var node = earliest;
    if (step > earliest.first) {
        node = vol_in_node_at(comb, earliest, step);
        for (var back = 0; back < lead; back++) {
            if (node.number > earliest.number) {
                node = vol_in_node_before(comb, node);
            }
        }
    }
    return node;
}

// The samples of media along a ray, and the length of ray that each stands for.
// Twin: runtime-cpu/src/render/comb.rs, which says why.

// After the last node; f32 knows it.
const VOL_IN_NO_NODE: i32 = 0x800000;
const VOL_IN_NO_RUN: f32 = 8388608.0;

struct Vol_in_Comb {
    step: f32,
    // Where the middle of step 0 is, in steps.
    offset: f32,
    // Steps that are divided alike; see spacing.wgsl.
    block: i32,
    end: f32,
    // Steps that may be inside some medium.
    first: i32,
    last: i32,
    // The same for each medium, and of those this run or the next one.
    all: array<Vol_in_Runs, VOL_IN_MEDIUM_SLOTS>,
    runs: array<vec2i, VOL_IN_MEDIUM_SLOTS>,
    // Signed distances of each medium at the node before, how many steps that stands for, and at the next one.
    before: array<f32, VOL_IN_MEDIUM_SLOTS>,
    steps_before: i32,
    own: array<f32, VOL_IN_MEDIUM_SLOTS>,
}

// First and last nodes of up to four runs, in any order; NO_RUN is the first of none. Numbers of nodes, which f32 knows: GLSL ES
// 3.00 chooses among components of float vectors only.
struct Vol_in_Runs {
    first: vec4f,
    last: vec4f,
}

// Where the middle of step 0 is, in steps. Panels begin at the origin, so there node 0 is at or before it.
fn vol_in_first_node(shift: f32, block: i32) -> f32 {
    let moved = floor(f32(block) * (0.5 + shift));
    let middle = (0.5 + shift) - (f32(block - 1) - moved);
    return select(middle, select(shift, shift - 1.0, shift > 0.0), VOL_IN_CORRECTED);
}

fn vol_in_node_distance(node: i32, step_size: f32, offset: f32) -> f32 {
    return (f32(node) + offset) * step_size;
}

fn vol_in_medium_word(medium: u32) -> u32 {
    return VOL_IN_AT_MEDIA + (VOL_IN_MEDIUM_WORDS * medium);
}

// Steps that may be inside a box; none if the last is less than the first. The box is grown by what a node stands for, so that
// the neighbours of a node inside are in the range or next to it, and so are the panels on both sides.
fn vol_in_node_range(ray: Vol_in_Ray, lo: vec3f, hi: vec3f, spacing: i32, comb: ptr<function, Vol_in_Comb>) -> vec2i {
    let step_size = (*comb).step;
    let reach = vec3f((1.01 * f32(spacing)) * step_size);
    let span = vol_in_slab(ray, lo - reach, hi + reach);
    let leave = min(span.leave, (*comb).end);
    // Node numbers stay where f32 knows them and a half.
    let first = min(max(floor((span.entry / step_size) - (*comb).offset), 0.0), VOL_IN_LAST_NODE);
    let last = min(floor((max(leave, 0.0) / step_size) - (*comb).offset), VOL_IN_LAST_NODE);
    return select(vec2i(i32(first), i32(last)), vec2i(0, -1), span.entry > leave);
}

// Lays out the nodes of the ray up to its end.
fn vol_in_new_comb(ray: Vol_in_Ray, end: f32, step_size: f32, block: i32) -> Vol_in_Comb {
    var comb: Vol_in_Comb;
    comb.step = step_size;
    comb.block = block;
    comb.offset = vol_in_first_node(ray.shift, block);
    comb.end = end;
    comb.first = VOL_IN_NO_NODE;
    comb.last = -1;
    {
        let medium = 0u;
        let runs = vol_in_find_runs(ray, medium, &comb);
        comb.all[medium] = runs;
        comb.runs[medium] = vol_in_run_from(runs, 0);
        comb.first = min(comb.first, comb.runs[medium].x);
        comb.last = max(comb.last, i32(max(max(runs.last.x, runs.last.y), max(runs.last.z, runs.last.w))));
        comb.before[medium] = VOL_IN_FAR;
        comb.own[medium] = VOL_IN_FAR;
    }
    comb.last = min(comb.last, comb.first + (VOL_IN_MAX_NODES - 1));
    return comb;
}

// Finds the runs of nodes that may be inside a medium: where the ray passes through cells, or anywhere in the box of a
// medium without cells.
fn vol_in_find_runs(ray: Vol_in_Ray, medium: u32, comb: ptr<function, Vol_in_Comb>) -> Vol_in_Runs {
    let at = vol_in_medium_word(medium);
    let spacing = vol_in_spacing_of(comb, medium);
    var runs = Vol_in_Runs(vec4f(VOL_IN_NO_RUN), vec4f(-1.0));
    let whole = vol_in_node_range(ray, vol_in_word3(at + 1u), vol_in_word3(at + 4u), spacing, comb);
    if ((whole.x > whole.y) | (vol_frame_word(at) == 0.0)) {
        return runs;
    }
    let count = u32(vol_frame_word(at + 7u));
    if (count == 0u) {
        return vol_in_add_run(runs, whole);
    }
    var cell = VOL_IN_AT_CELLS + (VOL_IN_CELLS_WORDS * medium);
    for (var index = 0u; index < count; index++) {
        let range = vol_in_node_range(ray, vol_in_word3(cell), vol_in_word3(cell + 3u), spacing, comb);
        if (range.x <= range.y) {
            runs = vol_in_add_run(runs, range);
        }
        cell += VOL_IN_CELL_WORDS;
    }
    return runs;
}

// Adds nodes to those that they continue, else as a run of their own; where there are four, to one of them.
fn vol_in_add_run(before: Vol_in_Runs, nodes: vec2i) -> Vol_in_Runs {
    let range = vec2f(nodes);
    // A node beside each run is looked at as well.
    let continued = (before.first <= vec4f(range.y + 2.0)) & (before.last >= vec4f(range.x - 2.0));
    let own_first = select(vec4f(VOL_IN_NO_RUN), before.first, continued);
    let own_last = select(vec4f(-1.0), before.last, continued);
    let first = min(range.x, min(min(own_first.x, own_first.y), min(own_first.z, own_first.w)));
    let last = max(range.y, max(max(own_last.x, own_last.y), max(own_last.z, own_last.w)));
    let kept_first = select(before.first, vec4f(VOL_IN_NO_RUN), continued);
    let kept_last = select(before.last, vec4f(-1.0), continued);
    let free = kept_first == vec4f(VOL_IN_NO_RUN);
    let place = vec4<bool>(
        free.x,
        free.y & !free.x,
        free.z & !(free.x | free.y),
        !(free.x | free.y | free.z),
    );
    return Vol_in_Runs(
        select(kept_first, min(kept_first, vec4f(first)), place),
        select(kept_last, max(kept_last, vec4f(last)), place),
    );
}

// The nodes of a run from one on: of the first that does not end before it.
fn vol_in_run_from(runs: Vol_in_Runs, node: i32) -> vec2i {
    let earliest = f32(node);
    let first = select(vec4f(VOL_IN_NO_RUN), max(runs.first, vec4f(earliest)), runs.last >= vec4f(earliest));
    let least = min(min(first.x, first.y), min(first.z, first.w));
    let last = select(vec4f(earliest), runs.last, first == vec4f(least));
    let end = i32(max(max(last.x, last.y), max(last.z, last.w)));
    return vec2i(i32(least), select(end, VOL_IN_NO_NODE, least == VOL_IN_NO_RUN));
}

// The first node to look at: `lead` before the first of a run. More than the last if there is none.
fn vol_in_start_node(comb: ptr<function, Vol_in_Comb>, lead: i32) -> Vol_in_Node {
    let origin = Vol_in_Node(0, vol_in_spacing_at(comb, 0), 0);
    var before = origin;
    for (var back = 0; back < lead; back++) {
        before = vol_in_node_before(comb, before);
    }
    return vol_in_node_ahead(comb, before, (*comb).first, lead);
}

// The next node to look at, given the one after this: those of runs, and `lead` before each. More than the last if there is none.
fn vol_in_next_node(comb: ptr<function, Vol_in_Comb>, node: Vol_in_Node, after: Vol_in_Node, lead: i32) -> Vol_in_Node {
    var first = VOL_IN_NO_NODE;
    {
        let medium = 0u;
        if ((*comb).runs[medium].y < after.first) {
            (*comb).runs[medium] = vol_in_run_from((*comb).all[medium], after.first);
        }
        first = min(first, (*comb).runs[medium].x);
    }
    let next = vol_in_node_ahead(comb, after, first, lead);
    // Distances say nothing about nodes farther on.
    let is_farther = next.first > after.first;
    (*comb).steps_before = node.steps;
    {
        let medium = 0u;
        (*comb).before[medium] = select((*comb).before[medium], VOL_IN_FAR, is_farther);
        (*comb).own[medium] = select((*comb).own[medium], VOL_IN_FAR, is_farther);
    }
    return next;
}

// Single scattering: light of the lamps that media send towards the eye, at a place where they are
// sampled.
// Twin: runtime-cpu/src/render/scatter.rs, which says why.

// Adds the light of all lamps to the sources of all media at a place.
fn vol_in_light_place(
    ray: Vol_in_Ray,
    t: f32,
    styled: ptr<function, Vol_in_StyledRays>,
    scatter: ptr<function, array<vec3f, VOL_IN_MEDIUM_SLOTS>>,
    source: ptr<function, array<vec3f, VOL_IN_MEDIUM_SLOTS>>,
) {
    let point = vol_in_ray_at(ray, t);
    let count = vol_in_light_count();
    for (var light = 0u; light < count; light++) {
        let lamp = vol_in_arriving(light, point);
        var seen = vol_in_place_visibility(lamp, light, styled, ray, t, scatter);
        if (VOL_IN_STYLES && (lamp.style != 0u)) {
            seen = seen * vol_in_styled_tint(lamp, light, styled, point);
        }
        vol_in_scatter_light(lamp, seen, ray.direction, scatter, source);
    }
}

// Fraction of a lamp's light that arrives at a place, if a medium needs to know.
fn vol_in_place_visibility(
    lamp: Vol_in_Arriving,
    light: u32,
    styled: ptr<function, Vol_in_StyledRays>,
    ray: Vol_in_Ray,
    t: f32,
    scatter: ptr<function, array<vec3f, VOL_IN_MEDIUM_SLOTS>>,
) -> vec3f {
    var asked = false;
    {
        let medium = 0u;
        let scatters = any((*scatter)[medium] > vec3f(0.0));
        asked = asked | (scatters & (vol_frame_word(vol_in_medium_word(medium)) == VOL_IN_SHADOWED));
    }
    if (asked & lamp.shadows) {
        let toward = vol_in_new_ray(vol_in_ray_at(ray, t), lamp.direction);
        var part = 1.0;
        if (VOL_IN_STYLES && (lamp.style != 0u)) {
            part = vol_in_styled_share(lamp, light, styled, ray, t);
        } else {
            part = vol_in_unblocked(toward, lamp.distance, vol_in_shadow_bias(t));
        }
        return vol_in_through_media(toward, lamp.distance, part, lamp.grid);
    }
    return vec3f(1.0);
}

// Adds the light of one lamp, scattered towards the eye.
fn vol_in_scatter_light(
    lamp: Vol_in_Arriving,
    seen: vec3f,
    direction: vec3f,
    scatter: ptr<function, array<vec3f, VOL_IN_MEDIUM_SLOTS>>,
    source: ptr<function, array<vec3f, VOL_IN_MEDIUM_SLOTS>>,
) {
    let angles = vol_in_turn(lamp.direction, direction);
    {
        let medium = 0u;
        let lighting = vol_frame_word(vol_in_medium_word(medium));
        let part = (*scatter)[medium];
        if (any(part > vec3f(0.0)) & (lighting > VOL_IN_UNLIT)) {
            // Add what arrives and is turned towards the eye.
            let phase = vol_in_medium_phase(medium, angles.x, angles.y);
            let arrives = select(seen, vec3f(1.0), lighting == VOL_IN_UNSHADOWED);
            (*source)[medium] += (part * phase) * (lamp.irradiance * arrives);
        }
    }
}

// 1 - cos and 1 + cos of the angle by which light from a lamp turns towards the eye, without
// cancellation.
fn vol_in_turn(toward: vec3f, direction: vec3f) -> vec2f {
    let apart = toward - direction;
    let together = toward + direction;
    return vec2f(0.5 * vol_in_dot3(apart, apart), 0.5 * vol_in_dot3(together, together));
}

// What media along a ray add and take away.
// Twin: runtime-cpu/src/render/medium.rs, which says why.

// A medium at a point: density, and per unit of it.
struct Vol_in_Interior {
    density: f32,
    scattering: vec3f,
    extinction: vec3f,
    emission: vec3f,
}

struct Vol_in_Glow {
    light: vec3f,
    transmittance: vec3f,
    // The same two by every other node.
    coarse_light: vec3f,
    coarse_transmittance: vec3f,
}

fn vol_in_clear_glow() -> Vol_in_Glow {
    return Vol_in_Glow(vec3f(0.0), vec3f(1.0), vec3f(0.0), vec3f(1.0));
}

// Light that a node or panel sends, and its optical depth.
struct Vol_in_Chunk {
    sent: vec3f,
    depth: vec3f,
}

// Adds a node or panel to those before it.
fn vol_in_gather(before: Vol_in_Glow, node: i32, chunk: Vol_in_Chunk) -> Vol_in_Glow {
    var glow = before;
    let decay = vol_in_decay3(chunk.depth);
    glow.light += glow.transmittance * chunk.sent;
    glow.transmittance = glow.transmittance * decay;
    // Of twice the matter: (1 - exp(-2x)) / x is (1 - exp(-x)) / x times 1 + exp(-x).
    if ((node % 2) == 0) {
        let twice = chunk.sent * (vec3f(1.0) + decay);
        glow.coarse_light += glow.coarse_transmittance * twice;
        glow.coarse_transmittance = glow.coarse_transmittance * (decay * decay);
    }
    return glow;
}

// Media by the midpoint rule: how much of a ray each node stands for, what is there, and how deep that is.
// Twin: runtime-cpu/src/render/comb.rs, medium.rs and shadow.rs, which say why.

// Signed distance of a node at a distance t from the nearest of: the medium's wall, the ray's two ends. The run is that of the node
// before, or the next one, and the nodes beside it are asked as well.
fn vol_in_wall(ray: Vol_in_Ray, medium: u32, run: vec2i, t: f32, node: Vol_in_Node, steps_before: i32, end: f32) -> f32 {
    var region = VOL_IN_FAR;
    if (((node.first + (2 * node.steps)) > run.x) & (node.first <= (run.y + max(node.steps, steps_before)))) {
        region = vol_in_medium_region(medium, vol_in_ray_at(ray, t));
    }
    return max(region, max(t - end, -t));
}

// Part of the interval between two neighbouring nodes that the first stands for, given of both the signed distance and half of
// what it stands for beside other nodes inside.
fn vol_in_share(own: vec2f, other: vec2f) -> f32 {
    let divisor = select(-1.0, own.x - other.x, own.x < other.x);
    let part = (own.y + other.y) * (own.x / divisor);
    return select(part, own.y, other.x < 0.0);
}

// The length of ray that a node stands for in a medium, given the node after it; afterwards the comb's own distance is that of the
// node after. Nodes must come in order, from two before each run: so that regions are asked at one place of the text,
// since drivers write them out at each.
fn vol_in_weigh(ray: Vol_in_Ray, medium: u32, comb: ptr<function, Vol_in_Comb>, node: Vol_in_Node, next: Vol_in_Node) -> f32 {
    let halves = 0.5 * (vec3f(vec3i((*comb).steps_before, node.steps, next.steps)) * (*comb).step);
    let before = (*comb).before[medium];
    let own = (*comb).own[medium];
    let after = vol_in_wall(ray, medium, (*comb).runs[medium], vol_in_middle_of(comb, next), next, node.steps, (*comb).end);
    let here = vec2f(own, halves.y);
    let weight = vol_in_share(here, vec2f(before, halves.x)) + vol_in_share(here, vec2f(after, halves.z));
    (*comb).before[medium] = own;
    (*comb).own[medium] = after;
    return select(0.0, weight, (own < 0.0) & (next.first > (*comb).first));
}

// Follows the ray through the media up to its end.
fn vol_in_march(ray: Vol_in_Ray, end: f32) -> Vol_in_Glow {
    var glow = vol_in_clear_glow();
    var styled = vol_in_style_rays(ray, end);
    var comb = vol_in_new_comb(ray, end, vol_frame_word(VOL_IN_AT_STEP), vol_in_widest_spacing());
    var weights: array<f32, VOL_IN_MEDIUM_SLOTS>;
    // What is at the node and at the next one, of media that these are inside.
    var here: array<Vol_in_Interior, VOL_IN_MEDIUM_SLOTS>;
    var ahead: array<Vol_in_Interior, VOL_IN_MEDIUM_SLOTS>;
    var next: Vol_in_Node;
    for (var node = vol_in_start_node(&comb, 2); node.first <= comb.last; node = vol_in_next_node(&comb, node, next, 2)) {
        next = vol_in_node_after(&comb, node);
        var some = false;
        {
            let medium = 0u;
            weights[medium] = vol_in_weigh(ray, medium, &comb, node, next);
            here[medium] = ahead[medium];
            // Right after its region: the closest point of a curve is kept for who asks next.
            if (comb.own[medium] < 0.0) {
                ahead[medium] = vol_in_medium_interior(medium, vol_in_ray_at(ray, vol_in_middle_of(&comb, next)));
            }
            some = some | (weights[medium] > 0.0);
        }
        if (some) {
            glow = vol_in_gather(glow, node.number, vol_in_node_chunk(ray, vol_in_middle_of(&comb, node), &styled, &weights, &here));
        }
        // Go on while the ray still lets light through.
        if (vol_in_largest(glow.transmittance) < VOL_IN_STOP) {
            break;
        }
    }
    return glow;
}

// Light and optical depth of one node.
fn vol_in_node_chunk(
    ray: Vol_in_Ray,
    t: f32,
    styled: ptr<function, Vol_in_StyledRays>,
    weights: ptr<function, array<f32, VOL_IN_MEDIUM_SLOTS>>,
    interiors: ptr<function, array<Vol_in_Interior, VOL_IN_MEDIUM_SLOTS>>,
) -> Vol_in_Chunk {
    var depth = vec3f(0.0);
    var scatter: array<vec3f, VOL_IN_MEDIUM_SLOTS>;
    var source: array<vec3f, VOL_IN_MEDIUM_SLOTS>;
    {
        let medium = 0u;
        let weight = (*weights)[medium];
        scatter[medium] = vec3f(0.0);
        source[medium] = vec3f(0.0);
        if (weight > 0.0) {
            let interior = (*interiors)[medium];
            let mass = max(interior.density, 0.0) * weight;
            depth += interior.extinction * mass;
            scatter[medium] = interior.scattering * mass;
            source[medium] = interior.emission * mass;
        }
    }
    if (VOL_IN_LIT_MEDIA) {
        vol_in_light_place(ray, t, styled, &scatter, &source);
    }
    // Add up what they send.
    var sent = vec3f(0.0);
    {
        let medium = 0u;
        sent += source[medium] * vol_in_mean_decay3(depth);
    }
    return Vol_in_Chunk(sent, depth);
}

// Integral of the extinction along the ray.
fn vol_in_optical_depth(ray: Vol_in_Ray, end: f32) -> vec3f {
    var comb = vol_in_new_comb(ray, end, vol_frame_word(VOL_IN_AT_SHADOW_STEP), 1);
    // Density and extinction of each medium at the next node, where that is inside.
    var ahead: array<vec4f, VOL_IN_MEDIUM_SLOTS>;
    var depth = vec3f(0.0);
    var next: Vol_in_Node;
    for (var node = vol_in_start_node(&comb, 2); node.first <= comb.last; node = vol_in_next_node(&comb, node, next, 2)) {
        next = vol_in_node_after(&comb, node);
        // Optical depth of each node, all media together.
        var node_depth = vec3f(0.0);
        {
            let medium = 0u;
            let weight = vol_in_weigh(ray, medium, &comb, node, next);
            let matter = ahead[medium];
            if (comb.own[medium] < 0.0) {
                ahead[medium] = vol_in_medium_extinction(medium, vol_in_ray_at(ray, vol_in_middle_of(&comb, next)));
            }
            node_depth += matter.yzw * (max(matter.x, 0.0) * weight);
        }
        depth += node_depth;
        // Go on while the ray is not dark yet.
        if (vol_in_smallest(depth) > VOL_IN_OPAQUE) {
            break;
        }
    }
    return depth;
}

// A scene without styles; see styled.wgsl.

struct Vol_in_StyledRays {
    none: f32,
}

fn vol_in_style_rays(ray: Vol_in_Ray, end: f32) -> Vol_in_StyledRays {
    return Vol_in_StyledRays(0.0);
}

fn vol_in_styled_share(lamp: Vol_in_Arriving, light: u32, rays: ptr<function, Vol_in_StyledRays>, ray: Vol_in_Ray, t: f32) -> f32 {
    return 1.0;
}

fn vol_in_styled_tint(lamp: Vol_in_Arriving, light: u32, rays: ptr<function, Vol_in_StyledRays>, point: vec3f) -> vec3f {
    return vec3f(1.0);
}

// ---- to be called -------------------------------------------------------------

// Bound on the distance to the nearest object, negative inside, scene units.
fn vol_distance(p: vec3f) -> f32 {
    var nearest: f32 = VOL_IN_FAR;
    return nearest;
}

// Sum of the densities of all media.
fn vol_density(p: vec3f) -> f32 {
    var sum: f32 = 0.0;
    sum += max(vol_f7_density_cloud(p.x, p.y, p.z), 0.0);
    return sum;
}

// Scene-linear radiance along a ray from the camera or another place outside the objects, and what it hides of what is behind.
fn vol_radiance(origin: vec3f, direction: vec3f) -> vec4f {
    let found = vol_in_radiance(vol_in_new_ray(origin, direction / vol_in_length3(direction)));
    let t = found.transmittance;
    let clear = ((t.x + t.y) + t.z) * (1.0f / 3.0f);
    return vec4f(found.color, 1.0 - clear);
}

// The same through a place of the picture, in pixels from its upper left corner.
fn vol_pixel(place: vec2f) -> vec4f {
    let found = vol_in_radiance(vol_in_camera_ray(place));
    let t = found.transmittance;
    let clear = ((t.x + t.y) + t.z) * (1.0f / 3.0f);
    return vec4f(found.color, 1.0 - clear);
}

// The field `distance:cloud` of the scene.
fn vol_distance_cloud(p: vec3f) -> f32 {
    return vol_f2_region_cloud(p.x, p.y, p.z);
}

// The field `density:cloud` of the scene.
fn vol_density_cloud(p: vec3f) -> f32 {
    return vol_f7_density_cloud(p.x, p.y, p.z);
}

// The field `colour:cloud` of the scene.
fn vol_colour_cloud(p: vec3f) -> vec3f {
    return vol_f8_colour_cloud(p.x, p.y, p.z);
}

// The field `local:cloud` of the scene.
fn vol_local_cloud(p: vec3f) -> vec3f {
    return vol_f9_local_cloud(p.x, p.y, p.z);
}
