// Value noise in f32, the same text as `runtime-cpu/src/math/noise/value.rs`, where ranges, errors and
// sources stand. Needs `fun.wgsl` and `noise.wgsl`.

// Random number of the corner (i, j, k) of a cell, -1 to below 1, exact.
fn vol_corner_number(c: VolCell, i: i32, j: i32, k: i32, seed: u32) -> f32 {
    let word = vol_hash_word(c.corner.x + i, c.corner.y + j, c.corner.z + k, 0i, seed);
    return (vol_unit_number(word) * 2.0) - 1.0;
}

// Value noise: random numbers at the corners of the cells, blended.
fn vol_value(p: vec3f, seed: u32) -> f32 {
    return vol_value_gradient(p, seed).x;
}

// Value noise with its exact gradient: (value, d/dx, d/dy, d/dz).
fn vol_value_gradient(p: vec3f, seed: u32) -> vec4f {
    let c = vol_cell_of(p);
    let u = c.fade.x;
    let v = c.fade.y;
    let w = c.fade.z;
    let c000 = vol_corner_number(c, 0i, 0i, 0i, seed);
    let c010 = vol_corner_number(c, 0i, 1i, 0i, seed);
    let c001 = vol_corner_number(c, 0i, 0i, 1i, seed);
    let c011 = vol_corner_number(c, 0i, 1i, 1i, seed);
    // Rise of the four edges along x, and their blends.
    let r00 = vol_corner_number(c, 1i, 0i, 0i, seed) - c000;
    let r10 = vol_corner_number(c, 1i, 1i, 0i, seed) - c010;
    let r01 = vol_corner_number(c, 1i, 0i, 1i, seed) - c001;
    let r11 = vol_corner_number(c, 1i, 1i, 1i, seed) - c011;
    let e00 = c000 + (u * r00);
    let e10 = c010 + (u * r10);
    let e01 = c001 + (u * r01);
    let e11 = c011 + (u * r11);
    // Blend along y, then along z.
    let f0 = vol_lerp(v, e00, e10);
    let f1 = vol_lerp(v, e01, e11);
    let rise_x = vol_lerp(w, vol_lerp(v, r00, r10), vol_lerp(v, r01, r11));
    let rise_y = vol_lerp(w, e10 - e00, e11 - e01);
    let rise_z = f1 - f0;
    let dx = vol_fade_slope(c.place.x) * rise_x;
    let dy = vol_fade_slope(c.place.y) * rise_y;
    let dz = vol_fade_slope(c.place.z) * rise_z;
    return vec4f(f0 + (w * rise_z), dx, dy, dz);
}
