// tornado.vol, translated by vol 0.1.0

// A vol scene as a compute shader. Entry point: render, workgroups of 8 x 8 over a rectangle.
//
// Bindings, all in group 0:
//   0 vol_uniforms     numbers of the frame
//   1 vol_curves       curves of the frame
//   2 vol_permutation  table of the noise
//   3 vol_frame        f32: the rectangle, the camera, what is there; see the constants AT_...
//   4 vol_input        f32: numbers of objects, depths of the grids of lights, tables of styles
//   5 vol_output       u32: 15 words per pixel of the whole picture, rows from the top, 0 before
//                      the first dispatch: bits of f32: radiance rgb, transmittance rgb, depth (1e30:
//                      none); whole numbers, how much was computed: rays, samples of media,
//                      evaluations, camera rays; where the pixel is: samples in the mean, bits of
//                      f32 of the spread of the radiance and of the transmittance; bits of f32 of
//                      how far the radiance is from the one by every other node of the media

@group(0) @binding(0) var<uniform> vol_uniforms: array<vec4<f32>, 8>;
fn vol_uniform_word(index: u32) -> f32 { return vol_uniforms[index >> 2u][index & 3u]; }
@group(0) @binding(1) var<uniform> vol_curves: array<vec4<f32>, 45>;
fn vol_curve_word(index: u32) -> f32 { return vol_curves[index >> 2u][index & 3u]; }
@group(0) @binding(2) var<uniform> vol_permutation: array<vec4<u32>, 64>;
fn vol_permutation_word(index: u32) -> u32 { return vol_permutation[index >> 2u][index & 3u]; }
@group(0) @binding(3) var<uniform> vol_frame: array<vec4<f32>, 115>;
fn vol_frame_word(index: u32) -> f32 { return vol_frame[index >> 2u][index & 3u]; }
@group(0) @binding(4) var<storage, read> vol_input: array<f32>;
fn vol_input_word(index: u32) -> f32 { return vol_input[index]; }

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
struct VolCell {
    corner: vec3i,
    place: vec3f,
    fade: vec3f,
}

// Find the cell of a point.
fn vol_cell_of(p: vec3f) -> VolCell {
    let held = vec3f(
        vol_hold(p.x, -VOL_FIELD, VOL_FIELD),
        vol_hold(p.y, -VOL_FIELD, VOL_FIELD),
        vol_hold(p.z, -VOL_FIELD, VOL_FIELD),
    );
    let whole = floor(held);
    let place = held - whole;
    let weights = vec3f(vol_fade(place.x), vol_fade(place.y), vol_fade(place.z));
    return VolCell(vec3i(whole), place, weights);
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
fn vol_corner_code(c: VolCell, i: i32, j: i32, k: i32, seed: u32) -> u32 {
    let x = c.corner.x + i;
    let y = c.corner.y + j;
    let z = c.corner.z + k;
    return select(vol_hash_cell(x, y, z, seed), vol_table_cell(x, y, z), seed == 0u);
}

// Value at one corner.
fn vol_corner(c: VolCell, i: i32, j: i32, k: i32, seed: u32) -> f32 {
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
struct VolBlend {
    value: f32,
    gradient: vec3f,
    slope: vec3f,
}

// Value and gradient at one corner.
fn vol_corner_blend(c: VolCell, i: i32, j: i32, k: i32, seed: u32) -> VolBlend {
    let code = vol_corner_code(c, i, j, k, seed);
    let value = vol_edge_value(code, c.place.x - f32(i), c.place.y - f32(j), c.place.z - f32(k));
    return VolBlend(value, vol_edge_vector(code), vec3f(0.0, 0.0, 0.0));
}

// Blend two neighbours along one axis and note the slope there.
fn vol_blend(axis: vec3<bool>, t: f32, a: VolBlend, b: VolBlend) -> VolBlend {
    let rise = b.value - a.value;
    let carried = vol_lerp3(t, a.slope, b.slope);
    let slope = select(carried, vec3f(rise, rise, rise), axis);
    return VolBlend(a.value + (t * rise), vol_lerp3(t, a.gradient, b.gradient), slope);
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
struct VolCurvePoint {
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
struct VolFoot {
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
struct VolInner {
    t: f32,
    dist_sq: f32,
    start_is_least: bool,
    start_sq: f32,
    dips: bool,
}

// Closest point of one canonical piece, given by its first word.
fn vol_foot(p: vec3f, word: u32) -> VolFoot {
    let inner = vol_inner(p, word);
    // Prefer the start where it is itself a minimum and nearer.
    let start_wins = inner.start_is_least & (inner.start_sq <= inner.dist_sq);
    return VolFoot(select(inner.t, 0.0, start_wins), select(inner.dist_sq, inner.start_sq, start_wins));
}

// The largest root of g.
fn vol_inner(p: vec3f, word: u32) -> VolInner {
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
    return VolInner(t2, vol_dot(end, end), start_is_least, vol_dot(w, w), dips);
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
struct VolSearch {
    dist_sq: f32,
    t: f32,
    piece: u32,
    left_at_last: bool,
}

// Visit the next piece along the curve; at a joint one of the two feet is redundant.
fn vol_visit(before: VolSearch, p: vec3f, word: u32, index: u32) -> VolSearch {
    let found = vol_foot(p, word);
    let leaves = vol_at_last(word, found.t);
    let defers = leaves & (vol_curve_word(word + 38u) == 1.0);
    let redundant = (vol_at_first(word, found.t) & (vol_curve_word(word + 37u) == 1.0)) & (!before.left_at_last);
    let wins = ((found.dist_sq < before.dist_sq) & (!defers)) & (!redundant);
    return VolSearch(
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
fn vol_describe(p: vec3f, word: u32, t: f32) -> VolCurvePoint {
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
    return VolCurvePoint(
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
struct VolCurveSlopes {
    direction: vec3f,
    tangent: vec3f,
    rate: f32,
    slide: f32,
}

// How the foot of `p` at the point `t` of a piece moves.
fn vol_slopes(p: vec3f, word: u32, t: f32) -> VolCurveSlopes {
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
    return VolCurveSlopes(
        r * per_distance,
        tangent,
        min(abs(t_span) / (2.0 * speed), VOL_LARGEST_RATE),
        select(1.0 / stretch, 0.0, held | (t_span == 0.0)),
    );
}

// Where a curve is: pieces `first .. first + count` of the buffer; `number` among all curves.
struct VolCurve {
    first: u32,
    count: u32,
    number: u32,
}

// The last search on a curve, from which the next one is most often near.
struct VolLastSearch {
    some: bool,
    point: vec3f,
    found: VolSearch,
    // Distance of the foot at most.
    reach: f32,
}

var<private> vol_last_search: array<VolLastSearch, VOL_CURVES>;

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
fn vol_search(p: vec3f, curve: VolCurve) -> VolSearch {
    let last = vol_last_search[curve.number];
    if (last.some & all(last.point == p)) {
        return last.found;
    }
    let way = p - last.point;
    let reach = last.reach + sqrt(vol_dot(way, way));
    let bound = select(VOL_LARGEST, (reach * reach) * VOL_LOOSE, last.some);
    // Visit the pieces along the curve.
    var search = VolSearch(VOL_LARGEST, 0.0, 0u, false);
    for (var index = 0u; index < curve.count; index = index + 1u) {
        let word = (curve.first + index) * VOL_PIECE_WORDS;
        if (vol_box_dist_sq(p, word) <= bound) {
            search = vol_visit(search, p, word, index);
        }
    }
    let slack = VOL_SLACK * vol_curve_word((curve.first * VOL_PIECE_WORDS) + 39u);
    vol_last_search[curve.number] = VolLastSearch(true, p, search, sqrt(search.dist_sq) + slack);
    return search;
}

// How the closest point of a whole curve moves.
fn vol_closest_gradient(point: vec3f, curve: VolCurve) -> VolCurveSlopes {
    let p = vol_held_point(point);
    let search = vol_search(p, curve);
    // Describe how the foot moves on the winner.
    if (curve.count == 0u) {
        return VolCurveSlopes(vec3f(1.0, 0.0, 0.0), vec3f(0.0, 0.0, 1.0), 0.0, 0.0);
    }
    return vol_slopes(p, (curve.first + search.piece) * VOL_PIECE_WORDS, search.t);
}

// Closest point of a whole curve.
fn vol_closest(point: vec3f, curve: VolCurve) -> VolCurvePoint {
    let p = vol_held_point(point);
    let search = vol_search(p, curve);
    // Describe the foot on the winner.
    if (curve.count == 0u) {
        return VolCurvePoint(0.0, 0.0, 0.0, VOL_FAR, 0.0, VOL_FAR, 0.0, 1.0);
    }
    return vol_describe(p, (curve.first + search.piece) * VOL_PIECE_WORDS, search.t);
}

struct VolOut10 {
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
  let v12 = vol_closest(vec3f(x0, x1, x2), VolCurve(bitcast<u32>(vol_uniforms[7].x), bitcast<u32>(vol_uniforms[7].y), 0u));
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
fn vol_f3_interior_cloud(x0: f32, x1: f32, x2: f32) -> VolOut10 {
  let v0: f32 = vol_uniforms[5].w;
  let v1: f32 = 0.0f;
  let v2: f32 = 1.0f;
  let v3: f32 = 0.08f;
  let v4: f32 = 0.52f;
  let v8: f32 = 25.0f;
  // tornado.vol:9: density: q => 25 * max(0, fbm(q.local * vec3(3, 6, 3) - (0, time, 0), octaves) + 0.15)
  let v9 = vol_closest(vec3f(x0, x1, x2), VolCurve(bitcast<u32>(vol_uniforms[7].x), bitcast<u32>(vol_uniforms[7].y), 0u));
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
  return VolOut10(v45, v46, v47, v2, v48, v49, v50, v1, v1, v1);
}

// extinction:cloud
fn vol_f4_extinction_cloud(x0: f32, x1: f32, x2: f32) -> vec4f {
  let v0: f32 = vol_uniforms[5].w;
  let v1: f32 = 0.08f;
  let v2: f32 = 0.52f;
  let v6: f32 = 25.0f;
  // tornado.vol:9: density: q => 25 * max(0, fbm(q.local * vec3(3, 6, 3) - (0, time, 0), octaves) + 0.15)
  let v7 = vol_closest(vec3f(x0, x1, x2), VolCurve(bitcast<u32>(vol_uniforms[7].x), bitcast<u32>(vol_uniforms[7].y), 0u));
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
  let v14 = vol_closest(vec3f(x0, x1, x2), VolCurve(bitcast<u32>(vol_uniforms[7].x), bitcast<u32>(vol_uniforms[7].y), 0u));
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
  let v5 = vol_closest(vec3f(x0, x1, x2), VolCurve(bitcast<u32>(vol_uniforms[7].x), bitcast<u32>(vol_uniforms[7].y), 0u));
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

const AT_TILE: u32 = 0u;
const AT_SIZE: u32 = 4u;
const AT_STEP: u32 = 6u;
const AT_SHADOW_STEP: u32 = 7u;
const AT_EYE: u32 = 8u;
const AT_FORWARD: u32 = 11u;
const AT_RIGHT: u32 = 14u;
const AT_UP: u32 = 17u;
const AT_BACKGROUND: u32 = 20u;
const AT_LIGHT_COUNT: u32 = 23u;
const AT_SAMPLES: u32 = 24u;
const AT_TOLERANCE: u32 = 25u;
const AT_BUDGET: u32 = 26u;
const OBJECT_COUNT: u32 = 0u;
const MEDIUM_COUNT: u32 = 1u;
const OBJECT_SLOTS: u32 = 1u;
const MEDIUM_SLOTS: u32 = 1u;
const LIGHT_SLOTS: u32 = 1u;
const TRANSFER_SIZE: u32 = 256u;
const OBJECT_WORDS: u32 = 8u;
const MEDIUM_WORDS: u32 = 9u;
const CELL_WORDS: u32 = 6u;
const CELLS_WORDS: u32 = 384u;
const LIGHT_WORDS: u32 = 12u;
const PIXEL_WORDS: u32 = 15u;
const AT_OBJECTS: u32 = 27u;
const AT_MEDIA: u32 = 27u;
const AT_LIGHTS: u32 = 36u;
const AT_CELLS: u32 = 76u;
const ROW_WORDS: u32 = 0u;
const CORRECTED: bool = true;
const SPACED: bool = false;
const SOFT_LIGHTS: bool = false;
const OCCLUDING_LIGHTS: bool = false;
const LIGHT_GRIDS: bool = true;
const LIT_MEDIA: bool = true;
const STYLES: bool = false;
const MARCHED_SHAFTS: bool = false;

fn joins_the_one_before(object: u32) -> bool {
    return false;
}

fn object_distance(index: u32, p: vec3f) -> f32 {
    counted_evaluations += 1u;
    switch index {
        default: {
            return FAR;
        }
    }
}

fn object_gradient(index: u32, p: vec3f) -> vec3f {
    counted_evaluations += 1u;
    switch index {
        default: {
            return vec3f(0.0);
        }
    }
}

fn object_steepness(index: u32, lo: vec3f, hi: vec3f) -> f32 {
    counted_evaluations += 1u;
    switch index {
        default: {
            return 1.0;
        }
    }
}

fn object_surface(index: u32, p: vec3f) -> Response {
    switch index {
        default: {
            return Response(vec3f(0.0), vec3f(0.0), vec3f(0.0), 0.0);
        }
    }
}

fn medium_region(index: u32, p: vec3f) -> f32 {
    counted_evaluations += 1u;
    switch index {
        case 0u: {
            let v = vol_f2_region_cloud(p.x, p.y, p.z);
            return v;
        }
        default: {
            return FAR;
        }
    }
}

fn medium_interior(index: u32, p: vec3f) -> Interior {
    counted_evaluations += 1u;
    counted_samples += 1u;
    switch index {
        case 0u: {
            let v = vol_f3_interior_cloud(p.x, p.y, p.z);
            return Interior(v.v0, vec3f(v.v1, v.v2, v.v3), vec3f(v.v4, v.v5, v.v6), vec3f(v.v7, v.v8, v.v9));
        }
        default: {
            return Interior(0.0, vec3f(0.0), vec3f(0.0), vec3f(0.0));
        }
    }
}

fn medium_extinction(index: u32, p: vec3f) -> vec4f {
    counted_evaluations += 1u;
    counted_samples += 1u;
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

fn medium_phase(index: u32, less: f32, more: f32) -> f32 {
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

const FAR: f32 = 4.0e6;
const PARALLEL: f32 = 1e-12;
const EPSILON: f32 = 0x1p-23f;
const FLAT: f32 = 1e-15;
const OPAQUE: f32 = 24.0;
const STOP: f32 = 0x1p-16f;
const NO_DEPTH: f32 = 1e30;
const MAX_SPREAD_TANGENT: f32 = 1.7320508;
const MAX_STEPS: u32 = 2000u;
const REFINEMENTS: u32 = 4u;
const EAGERNESS: f32 = 1.95;
const ROOM: f32 = 0.98;
const MAX_NODES: i32 = 16384;
const LAST_NODE: f32 = 4194304.0;
const SHOWS_NORMALS: f32 = 2.0;
const BY_STEEPNESS: f32 = 0.0;
const NO_BOUND: f32 = 1e30;
const TRIES: u32 = 8u;
const UNLIT: f32 = 1.0;
const UNSHADOWED: f32 = 2.0;
const SHADOWED: f32 = 3.0;
// Pixels have fewer corners.
const NO_CORNER: u32 = 4u;
const ROOT_THIRD: f32 = 0.5773503;

fn word3(at: u32) -> vec3f {
    return vec3f(vol_frame_word(at), vol_frame_word(at + 1u), vol_frame_word(at + 2u));
}

fn input3(at: u32) -> vec3f {
    return vec3f(vol_input_word(at), vol_input_word(at + 1u), vol_input_word(at + 2u));
}

fn dot3(a: vec3f, b: vec3f) -> f32 {
    return ((a.x * b.x) + (a.y * b.y)) + (a.z * b.z);
}

fn length3(v: vec3f) -> f32 {
    return sqrt(dot3(v, v));
}

fn largest(v: vec3f) -> f32 {
    return max(max(v.x, v.y), v.z);
}

fn smallest(v: vec3f) -> f32 {
    return min(min(v.x, v.y), v.z);
}

fn decay(x: f32) -> f32 {
    return vol_exp2(x * -1.44269504);
}

fn decay3(x: vec3f) -> vec3f {
    return vec3f(decay(x.x), decay(x.y), decay(x.z));
}

// (1 - exp(-x)) / x, 1 at 0.
fn mean_decay(x: f32) -> f32 {
    let tail = x * ((1.0f / 120.0f) - (x * (1.0f / 720.0f)));
    let series = 1.0 - (x * (0.5 - (x * ((1.0f / 6.0f) - (x * ((1.0f / 24.0f) - tail))))));
    let quotient = (1.0 - decay(x)) / max(x, 0.35);
    return select(quotient, series, x < 0.35);
}

fn mean_decay3(x: vec3f) -> vec3f {
    return vec3f(mean_decay(x.x), mean_decay(x.y), mean_decay(x.z));
}

// (1 - (1 + x) exp(-x)) / x^2, 1/2 at 0.
fn decay_moment(x: f32) -> f32 {
    let tail = x * ((1.0f / 144.0f) - (x * ((1.0f / 840.0f) - (x * (1.0f / 5760.0f)))));
    let series = 0.5 - (x * ((1.0f / 3.0f) - (x * ((1.0f / 8.0f) - (x * ((1.0f / 30.0f) - tail))))));
    let quotient = (mean_decay(x) - decay(x)) / max(x, 0.5);
    return select(quotient, series, x < 0.5);
}

fn decay_moment3(x: vec3f) -> vec3f {
    return vec3f(decay_moment(x.x), decay_moment(x.y), decay_moment(x.z));
}

// x^y for x >= 0; 0 at 0.
fn power(x: f32, y: f32) -> f32 {
    let some = x > 0.0;
    let value = vol_exp2(y * vol_log2(select(1.0, x, some)));
    return select(0.0, value, some);
}

// How much this invocation has computed, for statistics.
var<private> counted_camera_rays: u32;
var<private> counted_rays: u32;
var<private> counted_samples: u32;
var<private> counted_evaluations: u32;

// Takes samples of a pixel until there are `last` of them, or enough.
fn sample_pixel(pixel: vec2u, before: Mean, last: u32) -> Mean {
    var mean = before;
    // Rays are followed at one place of the text, since drivers write it out at each: for samples, and
    // for the corners after the first round.
    var corner = NO_CORNER;
    while ((corner < NO_CORNER) || ((mean.count < last) && !is_done(mean))) {
        let is_probe = corner < NO_CORNER;
        let found = radiance(pixel_ray(pixel, mean.count, corner));
        if (is_probe) {
            mean = add_probe(mean, found);
            corner += 1u;
        } else {
            mean = add_sample(mean, found);
            corner = select(NO_CORNER, 0u, is_probed() && (mean.count == FIRST_ROUND));
        }
    }
    return mean;
}

// The ray of a sample, or through a corner of the pixel.
fn pixel_ray(pixel: vec2u, index: u32, corner: u32) -> Ray {
    let is_probe = corner < NO_CORNER;
    let aside = select(place_in_pixel(index), vec2f(vec2u(corner % 2u, corner / 2u)), is_probe);
    var ray = camera_ray(vec2f(pixel) + aside);
    ray.shift = select(comb_shift(pixel, index), 0.0, is_probe);
    return ray;
}

// Follows a camera ray.
fn radiance(ray: Ray) -> Radiance {
    counted_camera_rays += 1u;
    counted_rays += 1u;
    // Find what is behind the media: surfaces, else the background.
    let contact = trace(ray);
    var behind = word3(AT_BACKGROUND);
    var end = FAR;
    var depth = NO_DEPTH;
    if (contact.hit) {
        behind = shade(ray, contact);
        end = contact.t;
        depth = contact.t * dot3(ray.direction, word3(AT_FORWARD));
    }
    // Look at it through the media.
    let glow = march(ray, end);
    let coarse = glow.coarse_light + (glow.coarse_transmittance * behind);
    let color = glow.light + (glow.transmittance * behind);
    let doubt = length3(coarse - color) * ROOT_THIRD;
    return Radiance(color, select(glow.transmittance, vec3f(0.0), contact.hit), depth, doubt);
}

// The samples of a pixel: where they are, their mean, and when there are enough of them.
// Twin: runtime-cpu/src/render/sampling.rs, which says why.

const STRIDE: vec2u = vec2u(3242174889u, 2447445414u);
// 2^32 over the golden ratio.
const GOLDEN_STRIDE: u32 = 2654435769u;
const FIRST_ROUND: u32 = 9u;
const ROUND: u32 = 8u;
const LEAST_BRIGHTNESS: f32 = 0.0625;

// What a camera ray brings back; depth NO_DEPTH without a surface.
struct Radiance {
    color: vec3f,
    transmittance: vec3f,
    depth: f32,
    // How far the colour is from the one by every other node of the media.
    doubt: f32,
}

struct Mean {
    count: u32,
    color: vec3f,
    transmittance: vec3f,
    depth: f32,
    color_spread: f32,
    transmittance_spread: f32,
    doubt: f32,
}

fn place_in_pixel(index: u32) -> vec2f {
    let step = (index + 1u) / 2u;
    let signed = select(0u - step, step, (index % 2u) == 1u);
    let place = ((vec2u(signed) * STRIDE) + vec2u(0x80000000u)) >> vec2u(16u);
    return vec2f(place) * (1.0f / 65536.0f);
}

// How far the comb of a sample is moved, in steps.
fn comb_shift(pixel: vec2u, index: u32) -> f32 {
    let place = ((pixel.x * STRIDE.x) + (pixel.y * STRIDE.y)) + (index * GOLDEN_STRIDE);
    return (f32((place + 0x80000000u) >> 16u) * (1.0f / 65536.0f)) - 0.5;
}

// Takes one more sample into the mean.
fn add_sample(old: Mean, sample: Radiance) -> Mean {
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
    mean.color_spread = mean.color_spread + dot3(color, sample.color - mean.color);
    let transmittance = sample.transmittance - mean.transmittance;
    mean.transmittance = mean.transmittance + (transmittance * share);
    let from_new = sample.transmittance - mean.transmittance;
    mean.transmittance_spread = mean.transmittance_spread + dot3(transmittance, from_new);
    return mean;
}

// Lets the radiance at a corner count for the spread, but not for the mean.
fn add_probe(old: Mean, probe: Radiance) -> Mean {
    var mean = old;
    let color = probe.color - mean.color;
    mean.color_spread = mean.color_spread + dot3(color, color);
    let transmittance = probe.transmittance - mean.transmittance;
    mean.transmittance_spread = mean.transmittance_spread + dot3(transmittance, transmittance);
    return mean;
}

// Whether corners are probed: where there is a test before the last sample.
fn is_probed() -> bool {
    return (vol_frame_word(AT_TOLERANCE) > 0.0) && (u32(vol_frame_word(AT_SAMPLES)) > FIRST_ROUND);
}

// Whether the pixel takes no more samples.
fn is_done(mean: Mean) -> bool {
    if (mean.count >= u32(vol_frame_word(AT_SAMPLES))) {
        return true;
    }
    let tested = (mean.count >= FIRST_ROUND) && (((mean.count - FIRST_ROUND) % ROUND) == 0u);
    let tolerance = vol_frame_word(AT_TOLERANCE);
    return tested && (tolerance > 0.0) && is_within(mean, tolerance);
}

// Whether the standard errors, rms over the channels, are within a tolerance.
fn is_within(mean: Mean, tolerance: f32) -> bool {
    // Three channels; spread / (n (n - 1)) is the squared error of the mean.
    let count = f32(mean.count);
    let least = (3.0 * LEAST_BRIGHTNESS) * LEAST_BRIGHTNESS;
    let scaled = (tolerance * tolerance) * (count * (count - 1.0));
    let color = scaled * max(dot3(mean.color, mean.color), least);
    let transmittance = scaled * 3.0;
    return (mean.color_spread <= color) && (mean.transmittance_spread <= transmittance);
}

// Rays: through the picture, and against boxes.
// Twin: runtime-cpu/src/render/camera.rs, which says why.

struct Ray {
    origin: vec3f,
    direction: vec3f,
    // How far its comb is moved along it: -1/2..1/2, in steps.
    shift: f32,
}

// With its comb where it is usually.
fn new_ray(origin: vec3f, direction: vec3f) -> Ray {
    return Ray(origin, direction, 0.0);
}

struct Span {
    entry: f32,
    leave: f32,
}

fn ray_at(ray: Ray, t: f32) -> vec3f {
    return ray.origin + (ray.direction * t);
}

fn camera_ray(place: vec2f) -> Ray {
    let u = ((2.0 * place.x) / vol_frame_word(AT_SIZE)) - 1.0;
    let v = 1.0 - ((2.0 * place.y) / vol_frame_word(AT_SIZE + 1u));
    let sideways = word3(AT_FORWARD) + (word3(AT_RIGHT) * u);
    let toward = sideways + (word3(AT_UP) * v);
    return new_ray(word3(AT_EYE), toward / length3(toward));
}

// Part of a ray inside a box.
fn slab(ray: Ray, lo: vec3f, hi: vec3f) -> Span {
    var span = Span(0.0, FAR);
    for (var axis = 0u; axis < 3u; axis++) {
        // Where the ray crosses the two planes; along them it is between them always or never.
        let o = ray.origin[axis];
        let d = ray.direction[axis];
        let parallel = abs(d) < PARALLEL;
        let divisor = select(d, 1.0, parallel);
        let a = (lo[axis] - o) / divisor;
        let b = (hi[axis] - o) / divisor;
        let beside = (o < lo[axis]) | (o > hi[axis]);
        let near = select(min(a, b), select(0.0, FAR, beside), parallel);
        let end = select(max(a, b), select(FAR, -FAR, beside), parallel);
        span.entry = max(span.entry, near);
        span.leave = min(span.leave, end);
    }
    return span;
}

// A little longer than rounding can make it.
fn loosened(span: Span) -> Span {
    let slack = 16.0 * EPSILON;
    return Span(span.entry - (slack * span.entry), span.leave + (slack * span.leave));
}

fn contains(lo: vec3f, hi: vec3f, point: vec3f) -> bool {
    return all(lo <= point) & all(point <= hi);
}

// How far a value of a solid's field can be walked: segment tracing.
// Twin: runtime-cpu/src/render/stride.rs, which says why.

// Makes the value of a solid's field safe to walk; what is inside stays as it is.
fn shorten(solid: u32, ray: Ray, t: f32, last: f32, value: f32) -> f32 {
    let scale = vol_frame_word(object_word(solid) + 7u);
    if (scale != BY_STEEPNESS) {
        return scale * value;
    }
    if (!(value > 0.0)) {
        return value;
    }
    var ahead = reach(last, value);
    for (var count = 0u; count < TRIES; count++) {
        let steepest = way_steepness(solid, ray, t, ahead);
        if (steepest < NO_BOUND) {
            return min(value / steepest, ahead);
        }
        // Look less far where nothing is known: there may be a jump on the way.
        ahead = 0.25 * ahead;
    }
    return 0.0;
}

// Bound on the slope over the box of the next step, a little larger than rounding can make it.
fn way_steepness(solid: u32, ray: Ray, t: f32, ahead: f32) -> f32 {
    let here = ray_at(ray, t);
    let there = ray_at(ray, t + ahead);
    let slack = (4.0 * EPSILON) * (remoteness() + (t + ahead));
    return object_steepness(solid, min(here, there) - slack, max(here, there) + slack);
}

// How far the next step may go: to where a distance proper would, and at most twice as far as the last,
// if there was one.
fn reach(last: f32, value: f32) -> f32 {
    let outside = max(value, 0.0);
    return select(outside, min(outside, 2.0 * last), last > 0.0);
}

// Where rays meet solids: sphere tracing.
// Twin: runtime-cpu/src/render/surface.rs, which says why.

struct Near {
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
struct Walker {
    t: f32,
    before: f32,
    free: f32,
    guessed: bool,
}

struct Contact {
    hit: bool,
    solid: u32,
    t: f32,
    position: vec3f,
    normal: vec3f,
    residual: f32,
}

fn footprint() -> f32 {
    return (2.0 * length3(word3(AT_UP))) / vol_frame_word(AT_SIZE + 1u);
}

fn remoteness() -> f32 {
    return length3(word3(AT_EYE));
}

// How near a ray may pass a surface unseen: half a pixel, or what rounding makes of positions.
fn tolerance(t: f32) -> f32 {
    let pixel = (0.5 * footprint()) * t;
    return max(pixel, (4.0 * EPSILON) * (remoteness() + t));
}

// Shortest step of a ray: nothing thinner than a fortieth of a pixel is sure to be seen.
fn stride(t: f32) -> f32 {
    let pixel = (0.025 * footprint()) * t;
    return max(pixel, (4.0 * EPSILON) * (remoteness() + t));
}

fn shadow_bias(t: f32) -> f32 {
    let pixel = (0.1 * footprint()) * t;
    return pixel + rounding(t);
}

// How far rounding may move a surface along a ray, with room to spare.
fn rounding(t: f32) -> f32 {
    return (64.0 * EPSILON) * (remoteness() + t);
}

fn object_word(solid: u32) -> u32 {
    return AT_OBJECTS + (OBJECT_WORDS * solid);
}

// A caller hands over the arrays that it wants filled: to return one copies each of its elements.

// Sign of each solid's distance as the camera sees it: -1 for those that hold the eye, with all that they
// are parts of.
fn find_sides(sides: ptr<function, array<f32, OBJECT_SLOTS>>) {
    for (var solid = 0u; solid < OBJECT_COUNT; solid++) {
        let at = object_word(solid);
        let eye = word3(AT_EYE);
        (*sides)[solid] = 1.0;
        if (contains(word3(at + 1u), word3(at + 4u), eye) & (vol_frame_word(at) != 0.0)) {
            (*sides)[solid] = select(1.0, -1.0, object_distance(solid, eye) < 0.0);
        }
        if (joins_the_one_before(solid)) {
            (*sides)[solid] = min((*sides)[solid], (*sides)[solid - 1u]);
        }
    }
    for (var solid = OBJECT_COUNT; solid > 1u; solid--) {
        if (joins_the_one_before(solid - 1u)) {
            (*sides)[solid - 2u] = min((*sides)[solid - 2u], (*sides)[solid - 1u]);
        }
    }
}

fn no_sides(sides: ptr<function, array<f32, OBJECT_SLOTS>>) {
    for (var solid = 0u; solid < OBJECT_COUNT; solid++) {
        (*sides)[solid] = 1.0;
    }
}

// Parts of the ray in the box of each solid, a little longer than rounding can make them; all of the
// ray for a solid that is seen from within, since it ends where the box may end.
fn object_spans(
    ray: Ray,
    sides: ptr<function, array<f32, OBJECT_SLOTS>>,
    spans: ptr<function, array<Span, OBJECT_SLOTS>>,
) {
    for (var solid = 0u; solid < OBJECT_COUNT; solid++) {
        let at = object_word(solid);
        let span = loosened(slab(ray, word3(at + 1u), word3(at + 4u)));
        let there = vol_frame_word(at) != 0.0;
        (*spans)[solid].entry = select(FAR, span.entry, there);
        let is_within = ((*sides)[solid] < 0.0) & (span.entry <= span.leave);
        let leave = select(span.leave, FAR, is_within);
        (*spans)[solid].leave = select(-FAR, leave, there);
    }
}

// What is around a place on the ray, `before` that of the last step.
fn nearest(
    ray: Ray,
    spans: ptr<function, array<Span, OBJECT_SLOTS>>,
    sides: ptr<function, array<f32, OBJECT_SLOTS>>,
    t: f32,
    before: f32,
) -> Near {
    var near = Near(FAR, FAR, 0u, FAR, 0.0, FAR, FAR);
    // What was near without the parts of a union that holds the eye, and the farthest wall of those: a ray is
    // inside as long as it is in one of them.
    var others = near;
    var farthest = -FAR;
    for (var solid = 0u; solid < OBJECT_COUNT; solid++) {
        let joined = joins_the_one_before(solid) & ((*sides)[solid] < 0.0);
        if (!joined) {
            others = near;
            farthest = -FAR;
        }
        let span = (*spans)[solid];
        let some = span.entry <= span.leave;
        let ahead = some & (t < span.entry);
        near.gap = select(near.gap, min(near.gap, span.entry - t), ahead);
        near.entry = select(near.entry, min(near.entry, span.entry), ahead);
        if (some & (t >= span.entry) & (t <= span.leave)) {
            near.rest = max(near.rest, span.leave - t);
            // A solid with a bound along rays alone tells nothing of what is beside the way.
            let is_ball = vol_frame_word(object_word(solid) + 7u) != BY_STEEPNESS;
            near.leave = min(near.leave, select(0.0, span.leave, is_ball));
            // Keep the smallest distance; the earlier solid on a tie.
            let seen = (*sides)[solid] * object_distance(solid, ray_at(ray, t));
            let safe = shorten(solid, ray, t, t - before, seen);
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
fn advance(near: Near, step: u32, least: f32) -> f32 {
    let free = min(near.distance, near.gap);
    let left = f32((MAX_STEPS - step) + 1u);
    let even = select(0.0, min(near.rest / left, near.gap), is_stuck(step));
    return max(max(free, least), even);
}

fn is_stuck(step: u32) -> bool {
    return step > (MAX_STEPS / 2u);
}

// Goes on, if possible farther than is sure: runtime-cpu/src/render/near.rs says why.
fn onward(near: Near, walker: Walker, step: u32, least: f32) -> Walker {
    let sure = advance(near, step, least);
    let last = walker.t - walker.before;
    let is_first = last <= 0.0;
    let fall = max((walker.free - near.distance) / select(last, 1.0, is_first), 0.0);
    let touching = (EAGERNESS * near.distance) / (1.0 + fall);
    let guess = min(min(touching, ROOM * near.gap), ROOM * (near.leave - walker.t));
    let place = walker.t + guess;
    let is_inside = (place < near.entry) & (place <= near.leave);
    let guessed = (guess > sure) & is_inside & !is_first & !is_stuck(step);
    return Walker(select(walker.t + sure, place, guessed), walker.t, sure, guessed);
}

// Whether a walker has gone too far: the balls that are empty around this place and the last do not touch.
fn is_past(near: Near, walker: Walker) -> bool {
    return walker.guessed & ((walker.free + near.distance) < (walker.t - walker.before));
}

// Goes back to where it was sure to come.
fn back(walker: Walker) -> Walker {
    return Walker(walker.before + walker.free, walker.before, walker.free, false);
}

// First surface on the ray.
fn trace(ray: Ray) -> Contact {
    var sides: array<f32, OBJECT_SLOTS>;
    var spans: array<Span, OBJECT_SLOTS>;
    find_sides(&sides);
    object_spans(ray, &sides, &spans);
    var walker = Walker(0.0, 0.0, 0.0, false);
    var hit = false;
    var solid = 0u;
    for (var count = 1u; count <= MAX_STEPS; count++) {
        let near = nearest(ray, &spans, &sides, walker.t, walker.before);
        if (is_past(near, walker)) {
            walker = back(walker);
            continue;
        }
        // Stop inside a solid; on the last step also where it would have been near enough.
        hit = near.value < select(0.0, tolerance(walker.t), count == MAX_STEPS);
        solid = near.solid;
        // Walk as far as nothing can be, at least a fortieth of a pixel.
        let next = onward(near, walker, count, stride(walker.t));
        if (hit | (next.t >= FAR)) {
            break;
        }
        walker = next;
    }
    if (hit) {
        return refine(ray, solid, walker.before, walker.t, sides[solid]);
    }
    return Contact(false, 0u, FAR, vec3f(0.0), vec3f(0.0), 0.0);
}

// Two places on a ray, the field 0 between them: (t, value) each.
struct Bracket {
    outside: vec2f,
    inside: vec2f,
}

// False position between the last two places.
fn refine(ray: Ray, solid: u32, before: f32, t: f32, side: f32) -> Contact {
    var bracket = Bracket(vec2f(before, 0.0), vec2f(t, 0.0));
    // The values at both ends come first: the field is asked at one place of the text, since drivers
    // write it out at each.
    for (var round = 0u; round < (2u + REFINEMENTS); round++) {
        let place = select(select(probe(bracket), t, round == 1u), before, round == 0u);
        let found = vec2f(place, side * object_distance(solid, ray_at(ray, place)));
        if (round == 0u) {
            bracket.outside = found;
        } else if (round == 1u) {
            bracket.inside = found;
        } else {
            bracket = narrow(bracket, found);
        }
    }
    let nearer = abs(bracket.outside.y) < abs(bracket.inside.y);
    let best = select(bracket.inside, bracket.outside, nearer);
    let gradient = facing_gradient(ray, solid, best.x, side);
    return contact(ray, solid, best.x, abs(best.y), gradient);
}

// Gradient where a ray enters a solid: taken a little inside, or outside if it points along the ray.
fn facing_gradient(ray: Ray, solid: u32, t: f32, side: f32) -> vec3f {
    var gradient = vec3f(0.0);
    var aside = rounding(t);
    for (var round = 0u; round < 2u; round++) {
        gradient = object_gradient(solid, ray_at(ray, t + aside)) * side;
        if (!(dot3(gradient, ray.direction) > 0.0)) {
            break;
        }
        aside = -aside;
    }
    return gradient;
}

// Where the field would be 0 if it were linear between the two; the inner place where it does not
// change sign.
fn probe(bracket: Bracket) -> f32 {
    let is_proper = (bracket.outside.y >= 0.0) & (bracket.inside.y < 0.0);
    let fall = select(1.0, bracket.outside.y - bracket.inside.y, is_proper);
    let part = bracket.outside.y / fall;
    let between = bracket.outside.x + ((bracket.inside.x - bracket.outside.x) * part);
    return select(bracket.inside.x, between, is_proper);
}

// Takes the value at the probe into account.
fn narrow(bracket: Bracket, found: vec2f) -> Bracket {
    let within = found.y < 0.0;
    return Bracket(select(found, bracket.outside, within), select(bracket.inside, found, within));
}

// The place of a hit, its normal and how exact it is.
fn contact(ray: Ray, solid: u32, t: f32, value: f32, gradient: vec3f) -> Contact {
    let steepness = length3(gradient);
    let is_flat = steepness < FLAT;
    let divisor = select(steepness, 1.0, is_flat);
    let normal = select(gradient / divisor, -ray.direction, is_flat);
    let most = 4.0 * tolerance(t);
    return Contact(true, solid, t, ray_at(ray, t), normal, min(value / divisor, most));
}

// What surfaces look like: their own light, and the lights that reach them.
// Twin: runtime-cpu/src/render/shade.rs, which says why.

struct Response {
    emitted: vec3f,
    diffuse: vec3f,
    specular: vec3f,
    shininess: f32,
}

struct Arriving {
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

fn light_count() -> u32 {
    return u32(vol_frame_word(AT_LIGHT_COUNT));
}

// What a light sends to a point.
fn arriving(light: u32, point: vec3f) -> Arriving {
    let at = AT_LIGHTS + (LIGHT_WORDS * light);
    let distant = vol_frame_word(at) != 0.0;
    let toward = word3(at + 1u) - point;
    // At the very place of the light the irradiance stays finite.
    let squared = max(dot3(toward, toward), 1e-12);
    let distance = sqrt(squared);
    let direction = select(toward / distance, word3(at + 1u), distant);
    let irradiance = select(word3(at + 4u) / squared, word3(at + 4u), distant);
    let shadows = vol_frame_word(at + 7u) != 0.0;
    let size = vol_frame_word(at + 8u);
    let slope = select(min(size / distance, MAX_SPREAD_TANGENT), size, distant);
    let grid = u32(vol_frame_word(at + 10u));
    let style = u32(vol_frame_word(at + 11u));
    return Arriving(direction, select(distance, FAR, distant), irradiance, shadows, slope, grid, style);
}

// Radiance that leaves a contact towards the eye.
fn shade(ray: Ray, contact: Contact) -> vec3f {
    if (vol_frame_word(object_word(contact.solid)) == SHOWS_NORMALS) {
        return (contact.normal + vec3f(1.0)) * 0.5;
    }
    let response = object_surface(contact.solid, contact.position);
    let answers = any(response.diffuse != vec3f(0.0)) | any(response.specular != vec3f(0.0));
    var color = response.emitted;
    let count = select(0u, light_count(), answers);
    for (var light = 0u; light < count; light++) {
        let lamp = arriving(light, contact.position);
        let cosine = dot3(contact.normal, lamp.direction);
        if (cosine > 0.0) {
            var seen = surface_visibility(lamp, contact);
            if (OCCLUDING_LIGHTS) {
                let reach = vol_frame_word(AT_LIGHTS + (LIGHT_WORDS * light) + 9u);
                if (reach > 0.0) {
                    seen = seen * openness(contact, reach);
                }
            }
            color += (lamp.irradiance * seen) * answer(response, contact, lamp, cosine, ray.direction);
        }
    }
    return color;
}

// Fraction of the light that arrives at a contact.
fn surface_visibility(lamp: Arriving, contact: Contact) -> vec3f {
    if (!lamp.shadows) {
        return vec3f(1.0);
    }
    // Start off the surface, by at least twice what the hit may be off.
    let bias = shadow_bias(contact.t);
    let offset = max(bias, 2.0 * contact.residual);
    let origin = contact.position + (contact.normal * offset);
    return soft_visibility(new_ray(origin, lamp.direction), lamp.distance, bias, lamp.slope, lamp.grid);
}

// Radiance towards the eye per irradiance on a facing plane.
fn answer(response: Response, contact: Contact, lamp: Arriving, cosine: f32, direction: vec3f) -> vec3f {
    let mirrored = (contact.normal * (2.0 * cosine)) - lamp.direction;
    let shine = power(dot3(mirrored, -direction), response.shininess);
    return (response.diffuse * cosine) + (response.specular * shine);
}

// How much of a light arrives at a point: solids between hide it, media between weaken it.
// Twin: runtime-cpu/src/render/shadow.rs, which says why.

// Fraction of a light with a slope that arrives, per channel.
fn soft_visibility(ray: Ray, distance: f32, bias: f32, slope: f32, grid: u32) -> vec3f {
    var part = 0.0;
    if (SOFT_LIGHTS && (slope > 0.0)) {
        part = lit_part_of(ray, distance, 0.25 * bias, slope);
    } else {
        part = unblocked(ray, distance, bias);
    }
    return through_media(ray, distance, part, grid);
}

// The part of a light without size that solids let through.
fn unblocked(ray: Ray, distance: f32, bias: f32) -> f32 {
    counted_rays += 1u;
    return select(1.0, 0.0, blocked(ray, distance, 0.25 * bias));
}

// The part of a light that solids let through, weakened by the media.
fn through_media(ray: Ray, distance: f32, part: f32, grid: u32) -> vec3f {
    // Only what solids do not hide goes through the media.
    if (part <= 0.0) {
        return vec3f(0.0);
    }
    let depth = depth_towards(ray, distance, grid);
    return select(decay3(depth) * part, vec3f(0.0), smallest(depth) > OPAQUE);
}

// Optical depth between a point and a light: of its grid where it has one.
fn depth_towards(ray: Ray, distance: f32, grid: u32) -> vec3f {
    if (LIGHT_GRIDS) {
        if (grid != 0u) {
            return grid_depth(grid, ray.origin);
        }
    }
    return optical_depth(ray, distance);
}

// Whether a place on a ray with a shortest step is inside a solid: at first twice the bias does not count.
fn enters(distance: f32, t: f32, least: f32) -> bool {
    let start = (8.0 * least) - t;
    return distance < -max(start, 0.0);
}

// Whether the ray enters a solid before it reaches the light.
fn blocked(ray: Ray, distance: f32, least: f32) -> bool {
    var sides: array<f32, OBJECT_SLOTS>;
    var spans: array<Span, OBJECT_SLOTS>;
    no_sides(&sides);
    object_spans(ray, &sides, &spans);
    let end = min(distance, FAR);
    var walker = Walker(0.0, 0.0, 0.0, false);
    var inside = false;
    for (var count = 1u; count <= MAX_STEPS; count++) {
        let near = nearest(ray, &spans, &sides, walker.t, walker.before);
        if (is_past(near, walker)) {
            walker = back(walker);
            continue;
        }
        // Only the inside of a solid hides: a ray may leave a surface at a grazing angle.
        inside = enters(near.distance, walker.t, least);
        walker = onward(near, walker, count, least);
        if (inside | (walker.t >= end)) {
            break;
        }
    }
    return inside;
}

// Optical depth between a light and a point, looked up in the light's grid.
// Twin: runtime-cpu/src/render/light_grid.rs, which says why.

// Depth at a point; `grid` is the word of the grid's record.
fn grid_depth(grid: u32, point: vec3f) -> vec3f {
    // Find the point as the light sees it.
    let origin = word3(grid + 1u);
    let lo = word3(grid + 13u);
    let scale = word3(grid + 16u);
    let counts = word3(grid + 19u);
    let distant = vol_frame_word(grid) != 0.0;
    let off = point - origin;
    let u = dot3(off, word3(grid + 4u));
    let v = dot3(off, word3(grid + 7u));
    let w = dot3(off, word3(grid + 10u));
    let ahead = distant | (w > (0.5 * lo.z));
    let divisor = select(1.0, w, ahead & !distant);
    let seen = vec3f(u / divisor, v / divisor, select(length3(off), w, distant));
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
    let x = stencil(place.x, last.x, spline);
    let y = stencil(place.y, last.y, spline);
    let z = stencil(min(place.z, last.z), last.z, spline);
    let first = u32(vol_frame_word(grid + 26u));
    let tint = word3(grid + 22u);
    var depth = vec3f(0.0);
    for (var channel = 0u; channel < channels; channel++) {
        depth[channel] = grid_channel(first, x, y, z, i32(counts.y), channel, channels);
    }
    return tint * select(depth, vec3f(depth.x), channels == 1u);
}

// One channel between the points around; what the cubic overshoots below 0 is cut off.
fn grid_channel(
    first: u32,
    x: Stencil,
    y: Stencil,
    z: Stencil,
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
struct Stencil {
    // Their numbers; where there is none the last one counts twice.
    at: vec4i,
    weights: vec4f,
}

// `place` in 0..`last`.
fn stencil(place: f32, last: f32, spline: bool) -> Stencil {
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
    return Stencil(clamp(around, vec4i(0), vec4i(i32(last))), weights);
}

// How much of a light with a size is seen past the solids: soft shadows.
// Twin: runtime-cpu/src/render/penumbra.rs, which says why.

const RIM_COUNT: u32 = 8u;
const RIM = array<vec2f, 8>(vec2f(1.0, 0.0), vec2f(0.70710677, 0.70710677), vec2f(0.0, 1.0), vec2f(-0.70710677, 0.70710677), vec2f(-1.0, 0.0), vec2f(-0.70710677, -0.70710677), vec2f(0.0, -1.0), vec2f(0.70710677, -0.70710677));
const PLACE_COUNT: u32 = 19u;
const PLACES = array<vec2f, 19>(vec2f(0.0, 0.0), vec2f(0.4, 0.0), vec2f(0.2, 0.3464102), vec2f(-0.2, 0.3464102), vec2f(-0.4, 0.0), vec2f(-0.2, -0.3464102), vec2f(0.2, -0.3464102), vec2f(0.7727407, 0.2070552), vec2f(0.5656854, 0.5656854), vec2f(0.2070552, 0.7727407), vec2f(-0.2070552, 0.7727407), vec2f(-0.5656854, 0.5656854), vec2f(-0.7727407, 0.2070552), vec2f(-0.7727407, -0.2070552), vec2f(-0.5656854, -0.5656854), vec2f(-0.2070552, -0.7727407), vec2f(0.2070552, -0.7727407), vec2f(0.5656854, -0.5656854), vec2f(0.7727407, -0.2070552));
const CLEAR: f32 = 2.0;
const BLUR: f32 = 0.3;
const LACK: f32 = 0.05;

struct Around {
    distance: f32,
    safe: f32,
    gap: f32,
}

// Fraction of a light that no solid hides.
fn lit_part_of(ray: Ray, distance: f32, least_step: f32, slope: f32) -> f32 {
    var ends = RIM;
    var clear: array<f32, RIM_COUNT>;
    var centre = 0.0;
    // The centre, then the rim: walked at one place of the text, since drivers write it out at each.
    for (var index = 0u; index <= RIM_COUNT; index++) {
        let end = max(index, 1u) - 1u;
        var toward = ray;
        if (index > 0u) {
            toward = rim(ray, slope, ends[end]);
        }
        let found = walk(toward, distance, least_step, slope);
        if (index > 0u) {
            clear[end] = found;
        } else if (found >= 1.0) {
            return 1.0;
        } else {
            centre = found;
        }
    }
    return lit_part(centre, &clear);
}

// Walks along the axis of a cone and keeps the smallest angle to a solid.
fn walk(ray: Ray, distance: f32, least_step: f32, slope: f32) -> f32 {
    counted_rays += 1u;
    var lowest = squared_sine(CLEAR * slope);
    var spans: array<Span, OBJECT_SLOTS>;
    cone_spans(ray, distance, slope, &spans);
    let end = min(distance, FAR);
    var t = 0.0;
    var older = vec2f(0.0);
    var newer = vec2f(0.0);
    for (var count = 0u; count < MAX_STEPS; count++) {
        let near = around(ray, &spans, t);
        // A ray that enters a solid is not clear at all.
        if (enters(near.distance, t, least_step)) {
            lowest = 0.0;
            break;
        }
        // Count what is surely not behind the light.
        let counts = (t > 0.0) & (near.distance >= 0.0) & (near.distance < (end - t));
        let divisor = select(1.0, t, counts);
        let sine = min(near.distance / divisor, 1.0);
        let sample = vec2f(1.0 / divisor, sine * sine);
        let found = min(sample.y, least(older, newer, sample));
        lowest = select(lowest, min(lowest, found), counts);
        older = select(vec2f(0.0), newer, counts);
        newer = select(vec2f(0.0), sample, counts);
        t += cone_step(near, least_step, slope, t);
        if (t >= end) {
            break;
        }
    }
    return clearance(lowest, slope);
}

// Parts of the ray where a solid's box is within the cone.
fn cone_spans(
    ray: Ray,
    distance: f32,
    slope: f32,
    spans: ptr<function, array<Span, OBJECT_SLOTS>>,
) {
    for (var solid = 0u; solid < OBJECT_COUNT; solid++) {
        let at = object_word(solid);
        let lo = word3(at + 1u);
        let hi = word3(at + 4u);
        let farthest = length3(max(abs(lo - ray.origin), abs(hi - ray.origin)));
        let width = (CLEAR * slope) * min(farthest, distance);
        let span = loosened(slab(ray, lo - vec3f(width), hi + vec3f(width)));
        let there = vol_frame_word(at) != 0.0;
        (*spans)[solid].entry = select(FAR, span.entry, there);
        (*spans)[solid].leave = select(-FAR, span.leave, there);
    }
}

// What is around a place on the ray.
fn around(ray: Ray, spans: ptr<function, array<Span, OBJECT_SLOTS>>, t: f32) -> Around {
    var near = Around(FAR, FAR, FAR);
    for (var solid = 0u; solid < OBJECT_COUNT; solid++) {
        let span = (*spans)[solid];
        let some = span.entry <= span.leave;
        let before = some & (t < span.entry);
        near.gap = select(near.gap, min(near.gap, span.entry - t), before);
        if (some & (t >= span.entry) & (t <= span.leave)) {
            let value = object_distance(solid, ray_at(ray, t));
            let safe = shorten(solid, ray, t, 0.0, value);
            // A field in units of its own is as far from 0 as its slope there says.
            let own_units = vol_frame_word(object_word(solid) + 7u) == BY_STEEPNESS;
            near.distance = min(near.distance, select(value, safe, own_units));
            near.safe = min(near.safe, safe);
        }
    }
    return near;
}

// Squared sine of an angle from its tangent.
fn squared_sine(tangent: f32) -> f32 {
    let squared = tangent * tangent;
    return squared / (1.0 + squared);
}

// A clearance in radii of the light from its squared sine.
fn clearance(lowest: f32, slope: f32) -> f32 {
    let cosine = max(1.0 - lowest, EPSILON);
    return min(sqrt(lowest / cosine) / slope, CLEAR);
}

// How far to walk.
fn cone_step(near: Around, least_step: f32, slope: f32, t: f32) -> f32 {
    let sine = sqrt(squared_sine(CLEAR * slope));
    let free = (near.safe - (sine * t)) / (1.0 + sine);
    let shortest = max(least_step, (0.002 * slope) * t);
    return max(min(max(free, 0.5 * near.safe), near.gap), shortest);
}

// Least value of the parabola through three samples if the middle one is the lowest, else that.
fn least(a: vec2f, b: vec2f, c: vec2f) -> f32 {
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
fn rim(ray: Ray, slope: f32, end: vec2f) -> Ray {
    let d = ray.direction;
    // Two unit vectors across the direction and each other.
    let turn = select(1.0, -1.0, d.z < 0.0);
    let a = -1.0 / (turn + d.z);
    let b = (d.x * d.y) * a;
    let right = vec3f(1.0 + (turn * ((d.x * d.x) * a)), turn * b, -(turn * d.x));
    let up = vec3f(b, turn + ((d.y * d.y) * a), -d.y);
    let toward = d + (((right * end.x) + (up * end.y)) * slope);
    return new_ray(ray.origin, toward / length3(toward));
}

// Area of the union of clear disks around the centre and the places on the rim, over that of the light.
fn lit_part(centre: f32, clear: ptr<function, array<f32, RIM_COUNT>>) -> f32 {
    var ends = RIM;
    var places = PLACES;
    var sum = 0.0;
    for (var index = 0u; index < PLACE_COUNT; index++) {
        // How far inside the lit part the place is, at least.
        var inside = clear_depth(centre, vec2f(0.0), places[index]);
        for (var end = 0u; end < RIM_COUNT; end++) {
            inside = max(inside, clear_depth((*clear)[end], ends[end], places[index]));
        }
        let edge = min(max((inside + LACK) / BLUR, -1.0), 1.0);
        let over = 1.0 + edge;
        sum += (0.25 * (over * over)) * (2.0 - edge);
    }
    let part = sum / f32(PLACE_COUNT);
    // Reach 1 where the centre is clear of the whole light, and 0 where nothing is clear.
    let whole = max((4.0 * centre) - 3.0, 0.0);
    var widest = centre;
    for (var end = 0u; end < RIM_COUNT; end++) {
        widest = max(widest, (*clear)[end]);
    }
    return (part + ((1.0 - part) * (whole * whole))) * min(10.0 * widest, 1.0);
}

// How deep a place lies in the clear disk around the end of a ray; far outside if the ray is blocked.
fn clear_depth(clear: f32, end: vec2f, place: vec2f) -> f32 {
    let aside = place - end;
    let distance = sqrt((aside.x * aside.x) + (aside.y * aside.y));
    return select(-CLEAR, clear - distance, clear > 0.0);
}

// How open a surface is: light that reaches it from all sides, as an option of a light.
// Twin: runtime-cpu/src/render/occlusion.rs, which says why.

const WEIGHT_COUNT: u32 = 5u;
const WEIGHTS = array<f32, 5>(16.0, 8.0, 4.0, 2.0, 1.0);
const WEIGHT_SUM: f32 = 31.0;

// How open a contact is, 0 to 1, to what is within a distance of it.
fn openness(contact: Contact, reach: f32) -> f32 {
    var weights = WEIGHTS;
    var sides: array<f32, OBJECT_SLOTS>;
    find_sides(&sides);
    var hidden = 0.0;
    for (var index = 0u; index < WEIGHT_COUNT; index++) {
        let share = f32(index + 1u) / f32(WEIGHT_COUNT);
        let height = share * reach;
        let distance = distance_above(contact, height, &sides);
        let lack = max((height - distance) / height, 0.0);
        hidden += weights[index] * min(0.5 * lack, 1.0);
    }
    return 1.0 - min(hidden / WEIGHT_SUM, 1.0);
}

// Distance of the nearest solid at a height above a contact; at most the height.
fn distance_above(
    contact: Contact,
    height: f32,
    sides: ptr<function, array<f32, OBJECT_SLOTS>>,
) -> f32 {
    let point = contact.position + (contact.normal * height);
    var distance = height;
    // That without the parts of a union that holds the eye, whose farthest wall counts.
    var others = height;
    var farthest = -FAR;
    for (var solid = 0u; solid < OBJECT_COUNT; solid++) {
        if (!(joins_the_one_before(solid) & ((*sides)[solid] < 0.0))) {
            others = distance;
            farthest = -FAR;
        }
        // A solid whose box is farther than the height hides nothing.
        let at = object_word(solid);
        let lo = word3(at + 1u) - vec3f(height);
        let hi = word3(at + 4u) + vec3f(height);
        if (contains(lo, hi, point) & (vol_frame_word(at) != 0.0)) {
            farthest = max(farthest, (*sides)[solid] * object_distance(solid, point));
            distance = min(others, farthest);
        }
    }
    return distance;
}

// How far apart the nodes of a ray are.
// Twin: runtime-cpu/src/render/spacing.rs, which says why.

// A node, and the steps that it stands for.
struct Node {
    first: i32,
    steps: i32,
    // Among all nodes of the ray.
    number: i32,
}

// The widest spacing of the media: steps of a block.
fn widest_spacing() -> i32 {
    var widest = 1;
    if (SPACED) {
        {
            let medium = 0u;
            widest = max(widest, i32(vol_frame_word(medium_word(medium) + 8u)));
        }
    }
    return widest;
}

fn spacing_of(comb: ptr<function, Comb>, medium: u32) -> i32 {
    if (SPACED && ((*comb).block > 1)) {
        return i32(vol_frame_word(medium_word(medium) + 8u));
    }
    return 1;
}

// Steps of a node in the block of a step: those of the finest medium that has a run there. Before the first block nodes are as
// in it.
fn spacing_at(comb: ptr<function, Comb>, step: i32) -> i32 {
    var spacing = (*comb).block;
    if (SPACED) {
        let first = max(step, 0) & -spacing;
        let last = f32(first + (spacing - 1));
        {
            let medium = 0u;
            let runs = (*comb).all[medium];
            let there = any((runs.first <= vec4f(last)) & (runs.last >= vec4f(f32(first))));
            spacing = select(spacing, min(spacing, spacing_of(comb, medium)), there);
        }
    }
    return spacing;
}

// Distance of a node from the origin of the ray: of the middle of its steps.
fn middle_of(comb: ptr<function, Comb>, node: Node) -> f32 {
    return node_distance(node.first, (*comb).step, (*comb).offset + (0.5 * f32(node.steps - 1)));
}

fn is_block_begun(comb: ptr<function, Comb>, step: i32) -> bool {
    return (step & ((*comb).block - 1)) == 0;
}

fn node_after(comb: ptr<function, Comb>, node: Node) -> Node {
    var after = Node(node.first + node.steps, node.steps, node.number + 1);
    if (SPACED && is_block_begun(comb, after.first)) {
        after.steps = spacing_at(comb, after.first);
    }
    return after;
}

fn node_before(comb: ptr<function, Comb>, node: Node) -> Node {
    var steps = node.steps;
    if (SPACED && is_block_begun(comb, node.first)) {
        steps = spacing_at(comb, node.first - 1);
    }
    return Node(node.first - steps, steps, node.number - 1);
}

// The node that stands for a step not before another node, with no run between the blocks of the two.
fn node_at(comb: ptr<function, Comb>, known: Node, step: i32) -> Node {
    if (!SPACED) {
        return Node(step, 1, step);
    }
    let block = (*comb).block;
    let own_end = (known.first | (block - 1)) + 1;
    if (step < own_end) {
        let more = (step - known.first) / known.steps;
        return Node(known.first + (more * known.steps), known.steps, known.number + more);
    }
    let begin = step & -block;
    let steps = spacing_at(comb, step);
    let whole = ((own_end - known.first) / known.steps) + ((begin - own_end) / block);
    let more = (step - begin) / steps;
    return Node(begin + (more * steps), steps, known.number + (whole + more));
}

// The node that is a number of nodes before the one that stands for a step, but none before another; as of node_at.
fn node_ahead(comb: ptr<function, Comb>, earliest: Node, step: i32, lead: i32) -> Node {
    if (!SPACED) {
        let first = max(earliest.first, step - lead);
        return Node(first, 1, first);
    }
    var node = earliest;
    if (step > earliest.first) {
        node = node_at(comb, earliest, step);
        for (var back = 0; back < lead; back++) {
            if (node.number > earliest.number) {
                node = node_before(comb, node);
            }
        }
    }
    return node;
}

// The samples of media along a ray, and the length of ray that each stands for.
// Twin: runtime-cpu/src/render/comb.rs, which says why.

// After the last node; f32 knows it.
const NO_NODE: i32 = 0x800000;
const NO_RUN: f32 = 8388608.0;

struct Comb {
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
    all: array<Runs, MEDIUM_SLOTS>,
    runs: array<vec2i, MEDIUM_SLOTS>,
    // Signed distances of each medium at the node before, how many steps that stands for, and at the next one.
    before: array<f32, MEDIUM_SLOTS>,
    steps_before: i32,
    own: array<f32, MEDIUM_SLOTS>,
}

// First and last nodes of up to four runs, in any order; NO_RUN is the first of none. Numbers of nodes, which f32 knows: GLSL ES
// 3.00 chooses among components of float vectors only.
struct Runs {
    first: vec4f,
    last: vec4f,
}

// Where the middle of step 0 is, in steps. Panels begin at the origin, so there node 0 is at or before it.
fn first_node(shift: f32, block: i32) -> f32 {
    let moved = floor(f32(block) * (0.5 + shift));
    let middle = (0.5 + shift) - (f32(block - 1) - moved);
    return select(middle, select(shift, shift - 1.0, shift > 0.0), CORRECTED);
}

fn node_distance(node: i32, step_size: f32, offset: f32) -> f32 {
    return (f32(node) + offset) * step_size;
}

fn medium_word(medium: u32) -> u32 {
    return AT_MEDIA + (MEDIUM_WORDS * medium);
}

// Steps that may be inside a box; none if the last is less than the first. The box is grown by what a node stands for, so that
// the neighbours of a node inside are in the range or next to it, and so are the panels on both sides.
fn node_range(ray: Ray, lo: vec3f, hi: vec3f, spacing: i32, comb: ptr<function, Comb>) -> vec2i {
    let step_size = (*comb).step;
    let reach = vec3f((1.01 * f32(spacing)) * step_size);
    let span = slab(ray, lo - reach, hi + reach);
    let leave = min(span.leave, (*comb).end);
    // Node numbers stay where f32 knows them and a half.
    let first = min(max(floor((span.entry / step_size) - (*comb).offset), 0.0), LAST_NODE);
    let last = min(floor((max(leave, 0.0) / step_size) - (*comb).offset), LAST_NODE);
    return select(vec2i(i32(first), i32(last)), vec2i(0, -1), span.entry > leave);
}

// Lays out the nodes of the ray up to its end.
fn new_comb(ray: Ray, end: f32, step_size: f32, block: i32) -> Comb {
    var comb: Comb;
    comb.step = step_size;
    comb.block = block;
    comb.offset = first_node(ray.shift, block);
    comb.end = end;
    comb.first = NO_NODE;
    comb.last = -1;
    {
        let medium = 0u;
        let runs = find_runs(ray, medium, &comb);
        comb.all[medium] = runs;
        comb.runs[medium] = run_from(runs, 0);
        comb.first = min(comb.first, comb.runs[medium].x);
        comb.last = max(comb.last, i32(max(max(runs.last.x, runs.last.y), max(runs.last.z, runs.last.w))));
        comb.before[medium] = FAR;
        comb.own[medium] = FAR;
    }
    comb.last = min(comb.last, comb.first + (MAX_NODES - 1));
    return comb;
}

// Finds the runs of nodes that may be inside a medium: where the ray passes through cells, or anywhere in the box of a
// medium without cells.
fn find_runs(ray: Ray, medium: u32, comb: ptr<function, Comb>) -> Runs {
    let at = medium_word(medium);
    let spacing = spacing_of(comb, medium);
    var runs = Runs(vec4f(NO_RUN), vec4f(-1.0));
    let whole = node_range(ray, word3(at + 1u), word3(at + 4u), spacing, comb);
    if ((whole.x > whole.y) | (vol_frame_word(at) == 0.0)) {
        return runs;
    }
    let count = u32(vol_frame_word(at + 7u));
    if (count == 0u) {
        return add_run(runs, whole);
    }
    var cell = AT_CELLS + (CELLS_WORDS * medium);
    for (var index = 0u; index < count; index++) {
        let range = node_range(ray, word3(cell), word3(cell + 3u), spacing, comb);
        if (range.x <= range.y) {
            runs = add_run(runs, range);
        }
        cell += CELL_WORDS;
    }
    return runs;
}

// Adds nodes to those that they continue, else as a run of their own; where there are four, to one of them.
fn add_run(before: Runs, nodes: vec2i) -> Runs {
    let range = vec2f(nodes);
    // A node beside each run is looked at as well.
    let continued = (before.first <= vec4f(range.y + 2.0)) & (before.last >= vec4f(range.x - 2.0));
    let own_first = select(vec4f(NO_RUN), before.first, continued);
    let own_last = select(vec4f(-1.0), before.last, continued);
    let first = min(range.x, min(min(own_first.x, own_first.y), min(own_first.z, own_first.w)));
    let last = max(range.y, max(max(own_last.x, own_last.y), max(own_last.z, own_last.w)));
    let kept_first = select(before.first, vec4f(NO_RUN), continued);
    let kept_last = select(before.last, vec4f(-1.0), continued);
    let free = kept_first == vec4f(NO_RUN);
    let place = vec4<bool>(
        free.x,
        free.y & !free.x,
        free.z & !(free.x | free.y),
        !(free.x | free.y | free.z),
    );
    return Runs(
        select(kept_first, min(kept_first, vec4f(first)), place),
        select(kept_last, max(kept_last, vec4f(last)), place),
    );
}

// The nodes of a run from one on: of the first that does not end before it.
fn run_from(runs: Runs, node: i32) -> vec2i {
    let earliest = f32(node);
    let first = select(vec4f(NO_RUN), max(runs.first, vec4f(earliest)), runs.last >= vec4f(earliest));
    let least = min(min(first.x, first.y), min(first.z, first.w));
    let last = select(vec4f(earliest), runs.last, first == vec4f(least));
    let end = i32(max(max(last.x, last.y), max(last.z, last.w)));
    return vec2i(i32(least), select(end, NO_NODE, least == NO_RUN));
}

// The first node to look at: `lead` before the first of a run. More than the last if there is none.
fn start_node(comb: ptr<function, Comb>, lead: i32) -> Node {
    let origin = Node(0, spacing_at(comb, 0), 0);
    var before = origin;
    for (var back = 0; back < lead; back++) {
        before = node_before(comb, before);
    }
    return node_ahead(comb, before, (*comb).first, lead);
}

// The next node to look at, given the one after this: those of runs, and `lead` before each. More than the last if there is none.
fn next_node(comb: ptr<function, Comb>, node: Node, after: Node, lead: i32) -> Node {
    var first = NO_NODE;
    {
        let medium = 0u;
        if ((*comb).runs[medium].y < after.first) {
            (*comb).runs[medium] = run_from((*comb).all[medium], after.first);
        }
        first = min(first, (*comb).runs[medium].x);
    }
    let next = node_ahead(comb, after, first, lead);
    // Distances say nothing about nodes farther on.
    let is_farther = next.first > after.first;
    (*comb).steps_before = node.steps;
    {
        let medium = 0u;
        (*comb).before[medium] = select((*comb).before[medium], FAR, is_farther);
        (*comb).own[medium] = select((*comb).own[medium], FAR, is_farther);
    }
    return next;
}

// Single scattering: light of the lamps that media send towards the eye, at a place where they are
// sampled.
// Twin: runtime-cpu/src/render/scatter.rs, which says why.

// Adds the light of all lamps to the sources of all media at a place.
fn light_place(
    ray: Ray,
    t: f32,
    styled: ptr<function, StyledRays>,
    scatter: ptr<function, array<vec3f, MEDIUM_SLOTS>>,
    source: ptr<function, array<vec3f, MEDIUM_SLOTS>>,
) {
    let point = ray_at(ray, t);
    let count = light_count();
    for (var light = 0u; light < count; light++) {
        let lamp = arriving(light, point);
        var seen = place_visibility(lamp, light, styled, ray, t, scatter);
        if (STYLES && (lamp.style != 0u)) {
            seen = seen * styled_tint(lamp, light, styled, point);
        }
        scatter_light(lamp, seen, ray.direction, scatter, source);
    }
}

// Fraction of a lamp's light that arrives at a place, if a medium needs to know.
fn place_visibility(
    lamp: Arriving,
    light: u32,
    styled: ptr<function, StyledRays>,
    ray: Ray,
    t: f32,
    scatter: ptr<function, array<vec3f, MEDIUM_SLOTS>>,
) -> vec3f {
    var asked = false;
    {
        let medium = 0u;
        let scatters = any((*scatter)[medium] > vec3f(0.0));
        asked = asked | (scatters & (vol_frame_word(medium_word(medium)) == SHADOWED));
    }
    if (asked & lamp.shadows) {
        let toward = new_ray(ray_at(ray, t), lamp.direction);
        var part = 1.0;
        if (STYLES && (lamp.style != 0u)) {
            counted_rays += 1u;
            part = styled_share(lamp, light, styled, ray, t);
        } else {
            part = unblocked(toward, lamp.distance, shadow_bias(t));
        }
        return through_media(toward, lamp.distance, part, lamp.grid);
    }
    return vec3f(1.0);
}

// Adds the light of one lamp, scattered towards the eye.
fn scatter_light(
    lamp: Arriving,
    seen: vec3f,
    direction: vec3f,
    scatter: ptr<function, array<vec3f, MEDIUM_SLOTS>>,
    source: ptr<function, array<vec3f, MEDIUM_SLOTS>>,
) {
    let angles = turn(lamp.direction, direction);
    {
        let medium = 0u;
        let lighting = vol_frame_word(medium_word(medium));
        let part = (*scatter)[medium];
        if (any(part > vec3f(0.0)) & (lighting > UNLIT)) {
            // Add what arrives and is turned towards the eye.
            let phase = medium_phase(medium, angles.x, angles.y);
            let arrives = select(seen, vec3f(1.0), lighting == UNSHADOWED);
            (*source)[medium] += (part * phase) * (lamp.irradiance * arrives);
        }
    }
}

// 1 - cos and 1 + cos of the angle by which light from a lamp turns towards the eye, without
// cancellation.
fn turn(toward: vec3f, direction: vec3f) -> vec2f {
    let apart = toward - direction;
    let together = toward + direction;
    return vec2f(0.5 * dot3(apart, apart), 0.5 * dot3(together, together));
}

// What media along a ray add and take away.
// Twin: runtime-cpu/src/render/medium.rs, which says why.

// A medium at a point: density, and per unit of it.
struct Interior {
    density: f32,
    scattering: vec3f,
    extinction: vec3f,
    emission: vec3f,
}

struct Glow {
    light: vec3f,
    transmittance: vec3f,
    // The same two by every other node.
    coarse_light: vec3f,
    coarse_transmittance: vec3f,
}

fn clear_glow() -> Glow {
    return Glow(vec3f(0.0), vec3f(1.0), vec3f(0.0), vec3f(1.0));
}

// Light that a node or panel sends, and its optical depth.
struct Chunk {
    sent: vec3f,
    depth: vec3f,
}

// Adds a node or panel to those before it.
fn gather(before: Glow, node: i32, chunk: Chunk) -> Glow {
    var glow = before;
    let decay = decay3(chunk.depth);
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

// Short ways of a ray through a medium, between two neighbouring nodes that are outside.
// Twin: runtime-cpu/src/render/chord.rs, which says why.

const CHORD_ROUNDS: u32 = 3u;
const LEAST_SHARE: f32 = 1e-6;

// Two places outside, between which there may be an inside: distance along the ray and signed distance of each.
struct Gap {
    start: vec2f,
    stop: vec2f,
}

// Length that may be inside.
fn gap_room(gap: Gap) -> f32 {
    return (gap.stop.x - gap.start.x) - (gap.start.y + gap.stop.y);
}

fn gap_probe(gap: Gap, round: u32) -> f32 {
    let length = gap.stop.x - gap.start.x;
    let least = LEAST_SHARE * length;
    let touching = (gap.start.y + least) / ((gap.start.y + gap.stop.y) + (least + least));
    return gap.start.x + (length * select(0.5, touching, round == 0u));
}

// What is left after a probe outside.
fn gap_narrowed(gap: Gap, found: vec2f) -> Gap {
    let first = Gap(gap.start, found);
    let second = Gap(found, gap.stop);
    if (gap_room(second) > gap_room(first)) {
        return second;
    }
    return first;
}

// The panels of the corrected form: stretches of a ray between two places at which a medium is
// sampled, and how much matter is in each.
// Twin: runtime-cpu/src/render/panel.rs, which says why.

const WALL_ROUNDS: u32 = 5u;

// Distance of a node from the origin of its ray: at least there, and at most at the end.
fn panel_node(comb: ptr<function, Comb>, node: i32) -> f32 {
    return min(max(node_distance(node, (*comb).step, (*comb).offset), 0.0), (*comb).end);
}

// Whether matter is cut off at each end of a panel after a node: at a wall, or at an end of the ray.
fn open_ends(comb: ptr<function, Comb>, node: i32, t: vec2f, own: f32, next: f32) -> vec2<bool> {
    let is_last = t.y < node_distance(node + 1, (*comb).step, (*comb).offset);
    return vec2<bool>((own >= 0.0) | (node == 0), (next >= 0.0) | is_last);
}

// Two places of which one is inside: distance along the ray and signed distance of each.
struct Crossing {
    inside: vec2f,
    outside: vec2f,
    // Which of them was found last: 0 none, 1 the one inside, 2 the other.
    moved: u32,
}

// Where the signed distance would be 0 if it were linear between the two.
fn crossing_probe(crossing: Crossing) -> f32 {
    let inside = crossing.inside;
    let outside = crossing.outside;
    return inside.x + ((outside.x - inside.x) * (inside.y / (inside.y - outside.y)));
}

// Takes the signed distance at the probe into account.
fn crossing_narrowed(crossing: Crossing, found: vec2f) -> Crossing {
    if (found.y < 0.0) {
        let kept = vec2f(crossing.outside.x, select(crossing.outside.y, 0.5 * crossing.outside.y, crossing.moved == 1u));
        return Crossing(found, kept, 1u);
    }
    let kept = vec2f(crossing.inside.x, select(crossing.inside.y, 0.5 * crossing.inside.y, crossing.moved == 2u));
    return Crossing(kept, found, 2u);
}

// What is probed.
const THE_NODE: u32 = 0u;
const A_GAP: u32 = 1u;
const A_WALL: u32 = 2u;
const NO_MORE: u32 = 3u;

// The region of a medium between two nodes.
struct Between {
    // Signed distance at the node after.
    next: f32,
    // The first and the last wall: there are none, one, or two around a chord.
    walls: vec2f,
    count: u32,
}

// Looks for the node after one at a distance t.x, and for walls between the two. The region is asked at one place of
// the text, since drivers write it out at each.
fn find_walls(ray: Ray, medium: u32, comb: ptr<function, Comb>, node: i32, t: vec2f) -> Between {
    let own = (*comb).own[medium];
    let run = (*comb).runs[medium];
    let known = ((node + 1) >= run.x) & (node <= run.y);
    var between = Between(FAR, vec2f(0.0), 0u);
    var gap: Gap;
    var crossing: Crossing;
    var other: Crossing;
    var wanted = 0u;
    var aim = THE_NODE;
    var round = 0u;
    while (aim != NO_MORE) {
        // Ask.
        var probe = t.y;
        if (aim == A_GAP) {
            probe = gap_probe(gap, round);
        } else if (aim == A_WALL) {
            probe = crossing_probe(crossing);
        }
        let point = ray_at(ray, probe);
        var value = FAR;
        if ((aim != THE_NODE) || known) {
            value = medium_region(medium, point);
        }
        let found = vec2f(probe, value);
        round += 1u;
        // Decide what to ask next.
        if (aim == THE_NODE) {
            between.next = value;
            let start = vec2f(t.x, own);
            round = 0u;
            aim = NO_MORE;
            if ((node >= (*comb).first) & (t.x < t.y)) {
                if ((own < 0.0) != (value < 0.0)) {
                    crossing = Crossing(select(found, start, own < 0.0), select(start, found, own < 0.0), 0u);
                    wanted = 1u;
                    aim = A_WALL;
                } else {
                    gap = Gap(start, found);
                    let may_enter = (own >= 0.0) & (gap_room(gap) > 0.0);
                    aim = select(NO_MORE, A_GAP, may_enter);
                }
            }
        } else if (aim == A_GAP) {
            if (value < 0.0) {
                crossing = Crossing(found, gap.start, 0u);
                other = Crossing(found, gap.stop, 0u);
                wanted = 2u;
                aim = A_WALL;
                round = 0u;
            } else {
                gap = gap_narrowed(gap, found);
                aim = select(NO_MORE, A_GAP, (round < CHORD_ROUNDS) & (gap_room(gap) > 0.0));
            }
        } else {
            crossing = crossing_narrowed(crossing, found);
            if (round == WALL_ROUNDS) {
                let wall = crossing_probe(crossing);
                between.walls = select(vec2f(between.walls.x, wall), vec2f(wall), between.count == 0u);
                between.count += 1u;
                crossing = other;
                aim = select(NO_MORE, A_WALL, between.count < wanted);
                round = 0u;
            }
        }
    }
    (*comb).own[medium] = between.next;
    return between;
}

// Whether a medium has a panel between two nodes.
fn has_panel(comb: ptr<function, Comb>, node: i32, t: vec2f, own: f32, between: Between) -> bool {
    let some = (own < 0.0) | (between.next < 0.0) | (between.count > 0u);
    return (node >= (*comb).first) & (t.x < t.y) & some;
}

// The two ends of a panel: where it begins, and where it stops.
const START_END: u32 = 0u;
const STOP_END: u32 = 1u;

// Distances of the ends of a panel between two nodes: those inside, else walls.
fn panel_stretch(own: f32, t: vec2f, between: Between) -> vec2f {
    return select(between.walls, t, vec2<bool>(own < 0.0, between.next < 0.0));
}

// From which of the ends on, and before which, the medium has yet to be sampled: at a node inside that a panel begins with
// it has been.
fn new_ends(own: f32, between: Between) -> vec2u {
    let has_walls = between.count > 0u;
    let first = select(STOP_END, START_END, (own >= 0.0) & has_walls);
    return vec2u(first, select(STOP_END, STOP_END + 1u, (between.next < 0.0) | has_walls));
}

// Integral of the positive part of a density over a stretch of a panel as long as a step, by its values at
// both ends: what each end stands for. An open end is one where matter is cut off.
fn panel_masses(step_size: f32, length: f32, ends: vec2f, open: vec2<bool>) -> vec2f {
    let half = 0.5 * length;
    let above = max(ends.x, ends.y);
    let below = min(ends.x, ends.y);
    let changes = (above > 0.0) & (below < 0.0);
    let densities = max(ends, vec2f(0.0));
    // What the panels up to the node miss: it is given to the node.
    let rise = select(densities.x - densities.y, densities.y - densities.x, open.x);
    let part = step_size / max(length, 0.25 * step_size);
    let most = 0.5 * (half * (densities.x + densities.y));
    let missed = max(min(((1.0f / 12.0f) * step_size) * (part * rise), most), -most);
    let given = select(vec2f(missed, 0.0), vec2f(0.0, missed), open.x);
    let plain = max((half * densities) + select(given, vec2f(0.0), open.x == open.y), vec2f(0.0));
    let fall = select(1.0, above - below, changes);
    let mass = (half * (above * (above / fall))) + (length * (fall * (1.0f / 12.0f)));
    let cut = select(vec2f(0.0, mass), vec2f(mass, 0.0), ends.x > 0.0);
    return select(plain, cut, changes);
}

// What media along a ray add and take away, by panel.wgsl.
// Twin: runtime-cpu/src/render/corrected.rs, which says why.

const THIN: f32 = 0.125;
const THICK: f32 = 0.5;

// Where a panel of a medium begins or stops.
struct PanelEnd {
    interior: Interior,
    // Light sent towards the eye, per unit of density.
    source: vec3f,
    distance: f32,
    // Whether it is a node; else it is a wall.
    is_node: bool,
}

// The panels between two nodes, one for each medium.
struct Panels {
    starts: array<PanelEnd, MEDIUM_SLOTS>,
    stops: array<PanelEnd, MEDIUM_SLOTS>,
    // Integral of the density that each end stands for.
    masses: array<vec2f, MEDIUM_SLOTS>,
    depth: vec3f,
    some: bool,
    // Whether the sources at the node before are known.
    lit: bool,
}

// Follows the ray through the media up to its end.
fn march(ray: Ray, end: f32) -> Glow {
    var glow = clear_glow();
    var styled = style_rays(ray, end);
    var comb = new_comb(ray, end, vol_frame_word(AT_STEP), 1);
    var panels: Panels;
    // The panel before a run is nothing: its end is the beginning of the first.
    for (var at = start_node(&comb, 1); at.first <= comb.last; at = next_node(&comb, at, node_after(&comb, at), 1)) {
        let node = at.first;
        let t = vec2f(panel_node(&comb, node), panel_node(&comb, node + 1));
        find_panels(ray, &comb, node, t, &panels);
        var lit_after = false;
        if (panels.some) {
            if (LIT_MEDIA) {
                lit_after = light_ends(ray, &styled, &panels);
            }
            glow = gather(glow, node, Chunk(panels_sent(&panels), panels.depth));
        }
        // Go on while the ray still lets light through.
        if (largest(glow.transmittance) < STOP) {
            break;
        }
        panels.lit = lit_after;
        {
            let medium = 0u;
            panels.starts[medium] = panels.stops[medium];
        }
    }
    return glow;
}

// Finds the panels after a node and their optical depths, all media together.
fn find_panels(ray: Ray, comb: ptr<function, Comb>, node: i32, t: vec2f, panels: ptr<function, Panels>) {
    (*panels).depth = vec3f(0.0);
    (*panels).some = false;
    {
        let medium = 0u;
        let own = (*comb).own[medium];
        let between = find_walls(ray, medium, comb, node, t);
        let stretch = panel_stretch(own, t, between);
        let nothing = Interior(0.0, vec3f(0.0), vec3f(0.0), vec3f(0.0));
        var start = (*panels).starts[medium];
        var stop = PanelEnd(nothing, vec3f(0.0), stretch.y, between.next < 0.0);
        // Media are asked at one place of the text, since drivers write it out at each.
        let ends = new_ends(own, between);
        for (var end = ends.x; end < ends.y; end++) {
            let distance = select(stretch.x, stretch.y, end == STOP_END);
            let interior = medium_interior(medium, ray_at(ray, distance));
            if (end == STOP_END) {
                stop.interior = interior;
                stop.source = interior.emission;
            } else {
                start = PanelEnd(interior, interior.emission, distance, false);
            }
        }
        var masses = vec2f(0.0);
        if (has_panel(comb, node, t, own, between)) {
            let densities = vec2f(start.interior.density, stop.interior.density);
            let open = open_ends(comb, node, t, own, between.next);
            masses = panel_masses((*comb).step, stretch.y - stretch.x, densities, open);
            (*panels).depth += (start.interior.extinction * masses.x) + (stop.interior.extinction * masses.y);
        }
        (*panels).starts[medium] = start;
        (*panels).stops[medium] = stop;
        (*panels).masses[medium] = masses;
        (*panels).some = (*panels).some | any(masses > vec2f(0.0));
    }
}

fn panel_end(panels: ptr<function, Panels>, medium: u32, at_stop: bool) -> PanelEnd {
    if (at_stop) {
        return (*panels).stops[medium];
    }
    return (*panels).starts[medium];
}

// Places at which ends of panels are: the node before and the node after, which media share, then the two walls of each.
const PLACES_OF_ENDS: u32 = 2u + (2u * MEDIUM_COUNT);
const NODE_BEFORE: u32 = 0u;
const NODE_AFTER: u32 = 1u;

// Whether the panel of a medium has an end at a place.
fn is_end_at(end: PanelEnd, medium: u32, place: u32) -> bool {
    return place == select(2u + (2u * medium) + (place % 2u), place % 2u, end.is_node);
}

// The first place from one on with matter and without light; PLACES_OF_ENDS if there is none.
fn next_dark_place(panels: ptr<function, Panels>, first: u32) -> u32 {
    var next = PLACES_OF_ENDS;
    for (var place = PLACES_OF_ENDS; place > 0u;) {
        place -= 1u;
        var dark = false;
        {
            let medium = 0u;
            let there = is_end_at(panel_end(panels, medium, (place % 2u) == STOP_END), medium, place);
            dark = dark | (there & any((*panels).masses[medium] > vec2f(0.0)));
        }
        let lit = (place == NODE_BEFORE) & (*panels).lit;
        next = select(next, place, (place >= first) & (dark & !lit));
    }
    return next;
}

// Lights the ends of panels with matter; whether those at the node after are among them. Rays that are looked at side by side
// each take their next place, so that all of them are done in a turn or two.
fn light_ends(ray: Ray, styled: ptr<function, StyledRays>, panels: ptr<function, Panels>) -> bool {
    var lit_after = false;
    var place = next_dark_place(panels, 0u);
    while (place < PLACES_OF_ENDS) {
        let at_stop = (place % 2u) == STOP_END;
        var distance = 0.0;
        var scatter: array<vec3f, MEDIUM_SLOTS>;
        var source: array<vec3f, MEDIUM_SLOTS>;
        {
            let medium = 0u;
            let end = panel_end(panels, medium, at_stop);
            let there = is_end_at(end, medium, place);
            scatter[medium] = select(vec3f(0.0), end.interior.scattering, there);
            source[medium] = end.source;
            distance = select(distance, end.distance, there);
        }
        light_place(ray, distance, styled, &scatter, &source);
        {
            let medium = 0u;
            if (at_stop) {
                (*panels).stops[medium].source = source[medium];
            } else {
                (*panels).starts[medium].source = source[medium];
            }
        }
        lit_after = lit_after | (place == NODE_AFTER);
        place = next_dark_place(panels, place + 1u);
    }
    return lit_after;
}

// Light that a panel sends towards the eye, in front of it.
fn panel_sent(masses: vec2f, start: vec3f, end: vec3f, depth: vec3f) -> vec3f {
    let steady = start * mean_decay3(depth);
    let change = (end - start) * decay_moment3(depth);
    let thick = (steady + change) * (masses.x + masses.y);
    let thin = (start * masses.x) + ((end * decay3(depth)) * masses.y);
    let rise = min(max((depth - vec3f(THIN)) * (1.0f / (THICK - THIN)), vec3f(0.0)), vec3f(1.0));
    return thin + ((thick - thin) * rise);
}

// Adds up what the panels send.
fn panels_sent(panels: ptr<function, Panels>) -> vec3f {
    let depth = (*panels).depth;
    var sent = vec3f(0.0);
    {
        let medium = 0u;
        let masses = (*panels).masses[medium];
        if (any(masses > vec2f(0.0))) {
            sent += panel_sent(masses, (*panels).starts[medium].source, (*panels).stops[medium].source, depth);
        }
    }
    return sent;
}

// Integral of the extinction along the ray.
fn optical_depth(ray: Ray, end: f32) -> vec3f {
    var comb = new_comb(ray, end, vol_frame_word(AT_SHADOW_STEP), 1);
    // Density and extinction of each medium at the node before.
    var before: array<vec4f, MEDIUM_SLOTS>;
    var depth = vec3f(0.0);
    // The panel before a run is nothing: its end is the beginning of the first.
    for (var node = start_node(&comb, 1); node.first <= comb.last; node = next_node(&comb, node, node_after(&comb, node), 1)) {
        // Optical depth of each panel, all media together.
        depth += panel_depth(ray, &comb, node.first, &before);
        // Go on while the ray is not dark yet.
        if (smallest(depth) > OPAQUE) {
            break;
        }
    }
    return depth;
}

fn panel_depth(ray: Ray, comb: ptr<function, Comb>, node: i32, before: ptr<function, array<vec4f, MEDIUM_SLOTS>>) -> vec3f {
    let step_size = (*comb).step;
    let t = vec2f(panel_node(comb, node), panel_node(comb, node + 1));
    var depth = vec3f(0.0);
    {
        let medium = 0u;
        let own = (*comb).own[medium];
        let between = find_walls(ray, medium, comb, node, t);
        let stretch = panel_stretch(own, t, between);
        var first = (*before)[medium];
        var last = vec4f(0.0);
        // Media are asked at one place of the text, since drivers write it out at each.
        let ends = new_ends(own, between);
        for (var end = ends.x; end < ends.y; end++) {
            let at_stop = end == STOP_END;
            let matter = medium_extinction(medium, ray_at(ray, select(stretch.x, stretch.y, at_stop)));
            first = select(matter, first, at_stop);
            last = select(last, matter, at_stop);
        }
        (*before)[medium] = select(vec4f(0.0), last, between.next < 0.0);
        if (has_panel(comb, node, t, own, between)) {
            let open = open_ends(comb, node, t, own, between.next);
            let masses = panel_masses(step_size, stretch.y - stretch.x, vec2f(first.x, last.x), open);
            depth += (first.yzw * masses.x) + (last.yzw * masses.y);
        }
    }
    return depth;
}

// A scene without styles; see styled.wgsl.

struct StyledRays {
    none: f32,
}

fn style_rays(ray: Ray, end: f32) -> StyledRays {
    return StyledRays(0.0);
}

fn styled_share(lamp: Arriving, light: u32, rays: ptr<function, StyledRays>, ray: Ray, t: f32) -> f32 {
    return 1.0;
}

fn styled_tint(lamp: Arriving, light: u32, rays: ptr<function, StyledRays>, point: vec3f) -> vec3f {
    return vec3f(1.0);
}

const GROUP_WIDTH: u32 = 8u;
const GROUP_HEIGHT: u32 = 8u;
// The pixels of a picture by a compute shader: one invocation takes samples of one pixel, and the next dispatch goes on
// where it stopped.

@group(0) @binding(5) var<storage, read_write> vol_output: array<u32>;

@compute @workgroup_size(GROUP_WIDTH, GROUP_HEIGHT)
fn render(@builtin(global_invocation_id) id: vec3u) {
    let tile = vec4u(
        u32(vol_frame_word(AT_TILE)),
        u32(vol_frame_word(AT_TILE + 1u)),
        u32(vol_frame_word(AT_TILE + 2u)),
        u32(vol_frame_word(AT_TILE + 3u)),
    );
    if ((id.x >= tile.z) | (id.y >= tile.w)) {
        return;
    }
    let column = tile.x + id.x;
    let row = tile.y + id.y;
    let index = (row * u32(vol_frame_word(AT_SIZE))) + column;
    let pixel = vec2u(column, row);
    // Go on with the pixel where the dispatch before stopped.
    let mean = read_pixel(index);
    let last = min(mean.count + u32(vol_frame_word(AT_BUDGET)), u32(vol_frame_word(AT_SAMPLES)));
    write_pixel(index, sample_pixel(pixel, mean, last));
}

fn read_pixel(index: u32) -> Mean {
    let at = PIXEL_WORDS * index;
    return Mean(
        vol_output[at + 11u],
        vec3f(output_float(at), output_float(at + 1u), output_float(at + 2u)),
        vec3f(output_float(at + 3u), output_float(at + 4u), output_float(at + 5u)),
        output_float(at + 6u),
        output_float(at + 12u),
        output_float(at + 13u),
        output_float(at + 14u),
    );
}

fn output_float(at: u32) -> f32 {
    return bitcast<f32>(vol_output[at]);
}

// Counts of dispatches are added up in whole numbers: with many samples they leave the 24 bits of a
// float.
fn write_pixel(index: u32, mean: Mean) {
    let at = PIXEL_WORDS * index;
    vol_output[at] = bitcast<u32>(mean.color.x);
    vol_output[at + 1u] = bitcast<u32>(mean.color.y);
    vol_output[at + 2u] = bitcast<u32>(mean.color.z);
    vol_output[at + 3u] = bitcast<u32>(mean.transmittance.x);
    vol_output[at + 4u] = bitcast<u32>(mean.transmittance.y);
    vol_output[at + 5u] = bitcast<u32>(mean.transmittance.z);
    vol_output[at + 6u] = bitcast<u32>(mean.depth);
    vol_output[at + 7u] += counted_rays;
    vol_output[at + 8u] += counted_samples;
    vol_output[at + 9u] += counted_evaluations;
    vol_output[at + 10u] += counted_camera_rays;
    vol_output[at + 11u] = mean.count;
    vol_output[at + 12u] = bitcast<u32>(mean.color_spread);
    vol_output[at + 13u] = bitcast<u32>(mean.transmittance_spread);
    vol_output[at + 14u] = bitcast<u32>(mean.doubt);
}

// The pixels of a picture by a fragment shader: all samples of a pixel at once, without an output buffer.

// A triangle that covers the picture: three vertices, no buffers.
@vertex
fn cover(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    let corner = vec2f(f32((index << 1u) & 2u), f32(index & 2u));
    return vec4f((corner * 2.0) - vec2f(1.0), 0.0, 1.0);
}

// Scene-linear radiance, rows from the top; alpha says how much of what is behind the picture is hidden.
@fragment
fn paint(@builtin(position) place: vec4f) -> @location(0) vec4f {
    let none = Mean(0u, vec3f(0.0), vec3f(0.0), 0.0, 0.0, 0.0, 0.0);
    let mean = sample_pixel(vec2u(place.xy), none, u32(vol_frame_word(AT_SAMPLES)));
    let clear = ((mean.transmittance.x + mean.transmittance.y) + mean.transmittance.z) * (1.0f / 3.0f);
    return vec4f(mean.color, 1.0 - clear);
}
