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
