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
