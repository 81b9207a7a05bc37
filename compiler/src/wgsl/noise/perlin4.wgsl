// Perlin noise of space and time in f32, the same text as `runtime-cpu/src/math/noise/perlin4.rs`, where
// ranges, errors and sources stand. Needs `fun.wgsl` and `noise.wgsl`.

// One lattice cell: its whole coordinates, the place inside it, and the fade weights there.
struct VolCell4 {
    corner: vec4i,
    place: vec4f,
    fade: vec4f,
}

// Find the cell of a point.
fn vol_cell4_of(p: vec4f) -> VolCell4 {
    let held = vec4f(
        vol_hold(p.x, -VOL_FIELD, VOL_FIELD),
        vol_hold(p.y, -VOL_FIELD, VOL_FIELD),
        vol_hold(p.z, -VOL_FIELD, VOL_FIELD),
        vol_hold(p.w, -VOL_FIELD, VOL_FIELD),
    );
    let whole = floor(held);
    let place = held - whole;
    let weights = vec4f(vol_fade(place.x), vol_fade(place.y), vol_fade(place.z), vol_fade(place.w));
    return VolCell4(vec4i(whole), place, weights);
}

// Which of 32 directions a corner has: the upper two bits of the code name the coordinate that is left
// out (3 is x, 0 is w), the lower three the signs of the others; w stands in for the one left out.
fn vol_corner4_code(c: VolCell4, corner: vec4i, seed: u32) -> u32 {
    let cell = c.corner + corner;
    return vol_hash_word(cell.x, cell.y, cell.z, cell.w, seed) >> 27u;
}

// Dot product of the direction `code` with an offset.
fn vol_direction4_value(code: u32, x: f32, y: f32, z: f32, w: f32) -> f32 {
    let left_out = code >> 3u;
    let a = select(x, w, left_out == 3u);
    let b = select(y, w, left_out == 2u);
    let c = select(z, w, left_out == 1u);
    let signed_a = select(a, -a, (code & 1u) != 0u);
    let signed_b = select(b, -b, (code & 2u) != 0u);
    let signed_c = select(c, -c, (code & 4u) != 0u);
    return (signed_a + signed_b) + signed_c;
}

// The direction itself, three of four components +-1.
fn vol_direction4_vector(code: u32) -> vec4f {
    let left_out = code >> 3u;
    let a = select(1.0, -1.0, (code & 1u) != 0u);
    let b = select(1.0, -1.0, (code & 2u) != 0u);
    let c = select(1.0, -1.0, (code & 4u) != 0u);
    let x = select(a, 0.0, left_out == 3u);
    let y = select(b, 0.0, left_out == 2u);
    let z = select(c, 0.0, left_out == 1u);
    // What w stands in for: a, b, c or nothing.
    let late = select(b, a, left_out == 3u);
    let early = select(0.0, c, left_out == 1u);
    let w = select(early, late, left_out >= 2u);
    return vec4f(x, y, z, w);
}

// Value at one corner.
fn vol_corner4(c: VolCell4, corner: vec4i, seed: u32) -> f32 {
    let offset = c.place - vec4f(corner);
    return vol_direction4_value(vol_corner4_code(c, corner, seed), offset.x, offset.y, offset.z, offset.w);
}

// Blend of the eight corners with one w.
fn vol_slice4(c: VolCell4, l: i32, seed: u32) -> f32 {
    let u = c.fade.x;
    let v = c.fade.y;
    let w = c.fade.z;
    // Blend the four edges along x.
    let c000 = vol_corner4(c, vec4i(0i, 0i, 0i, l), seed);
    let c100 = vol_corner4(c, vec4i(1i, 0i, 0i, l), seed);
    let c010 = vol_corner4(c, vec4i(0i, 1i, 0i, l), seed);
    let c110 = vol_corner4(c, vec4i(1i, 1i, 0i, l), seed);
    let c001 = vol_corner4(c, vec4i(0i, 0i, 1i, l), seed);
    let c101 = vol_corner4(c, vec4i(1i, 0i, 1i, l), seed);
    let c011 = vol_corner4(c, vec4i(0i, 1i, 1i, l), seed);
    let c111 = vol_corner4(c, vec4i(1i, 1i, 1i, l), seed);
    let e00 = vol_lerp(u, c000, c100);
    let e10 = vol_lerp(u, c010, c110);
    let e01 = vol_lerp(u, c001, c101);
    let e11 = vol_lerp(u, c011, c111);
    // Blend along y, then along z.
    return vol_lerp(w, vol_lerp(v, e00, e10), vol_lerp(v, e01, e11));
}

// Improved Perlin noise of space and time.
fn vol_perlin4(p: vec4f, seed: u32) -> f32 {
    let c = vol_cell4_of(p);
    return vol_lerp(c.fade.w, vol_slice4(c, 0i, seed), vol_slice4(c, 1i, seed));
}

// As VolBlend, with four coordinates.
struct VolBlend4 {
    value: f32,
    gradient: vec4f,
    slope: vec4f,
}

// Value and gradient at one corner.
fn vol_corner4_blend(c: VolCell4, corner: vec4i, seed: u32) -> VolBlend4 {
    let code = vol_corner4_code(c, corner, seed);
    let offset = c.place - vec4f(corner);
    let value = vol_direction4_value(code, offset.x, offset.y, offset.z, offset.w);
    return VolBlend4(value, vol_direction4_vector(code), vec4f(0.0, 0.0, 0.0, 0.0));
}

// Blend two neighbours along one axis and note the slope there.
fn vol_blend4(axis: vec4<bool>, t: f32, a: VolBlend4, b: VolBlend4) -> VolBlend4 {
    let rise = b.value - a.value;
    let carried = a.slope + (t * (b.slope - a.slope));
    let slope = select(carried, vec4f(rise, rise, rise, rise), axis);
    let gradient = a.gradient + (t * (b.gradient - a.gradient));
    return VolBlend4(a.value + (t * rise), gradient, slope);
}

// Blend of the eight corners with one w, and their gradients.
fn vol_slice4_blend(c: VolCell4, l: i32, seed: u32) -> VolBlend4 {
    let u = c.fade.x;
    let v = c.fade.y;
    let w = c.fade.z;
    let along_x = vec4<bool>(true, false, false, false);
    let along_y = vec4<bool>(false, true, false, false);
    let along_z = vec4<bool>(false, false, true, false);
    // Blend the four edges along x.
    let c000 = vol_corner4_blend(c, vec4i(0i, 0i, 0i, l), seed);
    let c100 = vol_corner4_blend(c, vec4i(1i, 0i, 0i, l), seed);
    let c010 = vol_corner4_blend(c, vec4i(0i, 1i, 0i, l), seed);
    let c110 = vol_corner4_blend(c, vec4i(1i, 1i, 0i, l), seed);
    let c001 = vol_corner4_blend(c, vec4i(0i, 0i, 1i, l), seed);
    let c101 = vol_corner4_blend(c, vec4i(1i, 0i, 1i, l), seed);
    let c011 = vol_corner4_blend(c, vec4i(0i, 1i, 1i, l), seed);
    let c111 = vol_corner4_blend(c, vec4i(1i, 1i, 1i, l), seed);
    let e00 = vol_blend4(along_x, u, c000, c100);
    let e10 = vol_blend4(along_x, u, c010, c110);
    let e01 = vol_blend4(along_x, u, c001, c101);
    let e11 = vol_blend4(along_x, u, c011, c111);
    // Blend along y, then along z.
    let f0 = vol_blend4(along_y, v, e00, e10);
    let f1 = vol_blend4(along_y, v, e01, e11);
    return vol_blend4(along_z, w, f0, f1);
}

// A value with its gradient along four coordinates.
struct VolSlope4 {
    value: f32,
    gradient: vec4f,
}

// Improved Perlin noise of space and time with its exact gradient.
fn vol_perlin4_gradient(p: vec4f, seed: u32) -> VolSlope4 {
    let c = vol_cell4_of(p);
    let along_w = vec4<bool>(false, false, false, true);
    let s0 = vol_slice4_blend(c, 0i, seed);
    let s1 = vol_slice4_blend(c, 1i, seed);
    let whole = vol_blend4(along_w, c.fade.w, s0, s1);
    // Add the slopes of the weights to the blended gradients.
    let dx = whole.gradient.x + (vol_fade_slope(c.place.x) * whole.slope.x);
    let dy = whole.gradient.y + (vol_fade_slope(c.place.y) * whole.slope.y);
    let dz = whole.gradient.z + (vol_fade_slope(c.place.z) * whole.slope.z);
    let dw = whole.gradient.w + (vol_fade_slope(c.place.w) * whole.slope.w);
    return VolSlope4(whole.value, vec4f(dx, dy, dz, dw));
}
