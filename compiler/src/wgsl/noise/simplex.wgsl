// Simplex noise in f32, the same text as `runtime-cpu/src/math/noise/simplex.rs`, where ranges, errors and
// sources stand. Needs `fun.wgsl` and `noise.wgsl`.

// Factor that makes the largest value 0.99993.
const VOL_SIMPLEX_SCALE: f32 = 76.875;
const VOL_THIRD: f32 = 0.33333334;
const VOL_SIXTH: f32 = 0.16666667;

// The simplex of a point: its first corner on the skewed lattice, the offset of the point from that,
// and the ways from there to the second and the third corner. The fourth is (1, 1, 1) away.
struct VolSimplex {
    corner: vec3i,
    offset: vec3f,
    second: vec3i,
    third: vec3i,
}

// Find the simplex of a point: whole parts are skewed as integers, fractions by themselves.
fn vol_simplex_of(p: vec3f) -> VolSimplex {
    let held = vec3f(
        vol_hold(p.x, -VOL_FIELD, VOL_FIELD),
        vol_hold(p.y, -VOL_FIELD, VOL_FIELD),
        vol_hold(p.z, -VOL_FIELD, VOL_FIELD),
    );
    let whole = floor(held);
    let place = held - whole;
    let base = vec3i(whole);
    // A third of the sum of the whole parts: 3 * 4194304 keeps the dividend positive.
    let sum = base.x + base.y + base.z;
    let quotient = ((sum + 12582912i) / 3i) - 4194304i;
    let rest = f32(sum - (3i * quotient));
    // Skew what is left and find its cell.
    let skew = (rest + ((place.x + place.y) + place.z)) * VOL_THIRD;
    let cell = floor(place + skew);
    let shift = (rest + ((cell.x + cell.y) + cell.z)) * VOL_SIXTH;
    let offset = (place - cell) + shift;
    // Walk along the largest coordinate first, along the smallest last.
    let xy = offset.x >= offset.y;
    let yz = offset.y >= offset.z;
    let xz = offset.x >= offset.z;
    let second = select(vec3i(0i), vec3i(1i), vec3<bool>(xy & xz, !xy & yz, !xz & !yz));
    let third = select(vec3i(0i), vec3i(1i), vec3<bool>(xy | xz, !xy | yz, !xz | !yz));
    let corner = (base + quotient) + vec3i(cell);
    return VolSimplex(corner, offset, second, third);
}

// What one corner adds: value and gradient, before scaling.
fn vol_simplex_corner(s: VolSimplex, way: vec3i, unskew: f32, seed: u32) -> vec4f {
    let d = (s.offset - vec3f(way)) + unskew;
    let at = s.corner + way;
    let code = vol_hash_word(at.x, at.y, at.z, 0i, seed) >> 28u;
    // The weight falls to 0 before the point leaves the simplices around the corner.
    let inside = max(0.5 - (((d.x * d.x) + (d.y * d.y)) + (d.z * d.z)), 0.0);
    let squared = inside * inside;
    let weight = squared * squared;
    let edge = vol_edge_vector(code);
    let value = vol_edge_value(code, d.x, d.y, d.z);
    let pull = (8.0 * (squared * inside)) * value;
    let gradient = (weight * edge) - (pull * d);
    return vec4f(weight * value, gradient);
}

// Simplex noise.
fn vol_simplex(p: vec3f, seed: u32) -> f32 {
    return vol_simplex_gradient(p, seed).x;
}

// Simplex noise with its exact gradient: (value, d/dx, d/dy, d/dz).
fn vol_simplex_gradient(p: vec3f, seed: u32) -> vec4f {
    let s = vol_simplex_of(p);
    let n0 = vol_simplex_corner(s, vec3i(0i), 0.0, seed);
    let n1 = vol_simplex_corner(s, s.second, VOL_SIXTH, seed);
    let n2 = vol_simplex_corner(s, s.third, VOL_THIRD, seed);
    let n3 = vol_simplex_corner(s, vec3i(1i), 0.5, seed);
    return VOL_SIMPLEX_SCALE * ((n0 + n1) + (n2 + n3));
}
