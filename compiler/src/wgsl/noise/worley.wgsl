// Distance to the nearest of strewn points in f32, the same text as `runtime-cpu/src/math/noise/worley.rs`,
// where ranges, errors and sources stand. Needs `fun.wgsl` and `noise.wgsl`.

// Squared distances are held at this.
const VOL_FARTHEST: f32 = 1.0;
// The cells to be searched, as steps from the own cell.
const VOL_WORLEY_STEPS: i32 = 27;

// The search for the nearest point: where it starts and what it has found.
struct VolNearest {
    cell: vec3i,
    place: vec3f,
    squared: f32,
    offset: vec3f,
}

// Nothing found yet at a position.
fn vol_nearest_new(p: vec3f) -> VolNearest {
    let held = vec3f(
        vol_hold(p.x, -VOL_FIELD, VOL_FIELD),
        vol_hold(p.y, -VOL_FIELD, VOL_FIELD),
        vol_hold(p.z, -VOL_FIELD, VOL_FIELD),
    );
    let whole = floor(held);
    return VolNearest(vec3i(whole), held - whole, VOL_FARTHEST, vec3f(0.0, 0.0, 0.0));
}

// Takes the point of one more cell, if that is nearer.
fn vol_nearest_with(found: VolNearest, step: i32, seed: u32) -> VolNearest {
    let way = vec3i((step % 3i) - 1i, ((step / 3i) % 3i) - 1i, (step / 9i) - 1i);
    let at = found.cell + way;
    let point = vol_unit_point(vol_hash_word(at.x, at.y, at.z, 0i, seed));
    // The sum of step and point is exact.
    let d = found.place - (vec3f(way) + point);
    let squared = ((d.x * d.x) + (d.y * d.y)) + (d.z * d.z);
    let nearer = squared < found.squared;
    let offset = select(found.offset, d, nearer);
    return VolNearest(found.cell, found.place, select(found.squared, squared, nearer), offset);
}

// Distance and direction: (value, d/dx, d/dy, d/dz).
fn vol_nearest_gradient(found: VolNearest) -> vec4f {
    let distance = sqrt(found.squared);
    // On a point, and where none was found, the offset is 0.
    let divisor = max(distance, VOL_SMALLEST);
    return vec4f(distance, found.offset / divisor);
}

// Distance to the nearest of points that are strewn one to a cell, at most 1.
fn vol_worley(p: vec3f, seed: u32) -> f32 {
    return vol_worley_gradient(p, seed).x;
}

// The distance with its gradient: (value, d/dx, d/dy, d/dz).
fn vol_worley_gradient(p: vec3f, seed: u32) -> vec4f {
    var found = vol_nearest_new(p);
    for (var step = 0i; step < VOL_WORLEY_STEPS; step = step + 1i) {
        found = vol_nearest_with(found, step, seed);
    }
    return vol_nearest_gradient(found);
}
