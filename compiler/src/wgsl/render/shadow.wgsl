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

// Integral of the extinction along the ray.
fn optical_depth(ray: Ray, end: f32) -> vec3f {
    if (CORRECTED) {
        return depth_by_panels(ray, end);
    }
    return depth_by_nodes(ray, end);
}

fn depth_by_nodes(ray: Ray, end: f32) -> vec3f {
    var comb = new_comb(ray, end, vol_frame_word(AT_SHADOW_STEP));
    var weights: array<f32, MEDIUM_SLOTS>;
    var depth = vec3f(0.0);
    for (var node = comb.first - 2; node <= comb.last; node = next_node(&comb, node, 2)) {
        // Optical depth of each node, all media together.
        if (weigh(ray, &comb, node, &weights)) {
            depth += node_depth(ray_at(ray, node_distance(node, comb.step, comb.offset)), &weights);
        }
        // Go on while the ray is not dark yet.
        if (smallest(depth) > OPAQUE) {
            break;
        }
    }
    return depth;
}

fn node_depth(point: vec3f, weights: ptr<function, array<f32, MEDIUM_SLOTS>>) -> vec3f {
    var depth = vec3f(0.0);
    for (var medium = 0u; medium < MEDIUM_COUNT; medium++) {
        let weight = (*weights)[medium];
        if (weight > 0.0) {
            let matter = medium_extinction(medium, point);
            depth += matter.yzw * (max(matter.x, 0.0) * weight);
        }
    }
    return depth;
}

fn depth_by_panels(ray: Ray, end: f32) -> vec3f {
    var comb = new_comb(ray, end, vol_frame_word(AT_SHADOW_STEP));
    // Density and extinction of each medium at the node before.
    var before: array<vec4f, MEDIUM_SLOTS>;
    var depth = vec3f(0.0);
    // The panel before a run is nothing: its end is the beginning of the first.
    for (var node = comb.first - 1; node <= comb.last; node = next_node(&comb, node, 1)) {
        // Optical depth of each panel, all media together.
        depth += panel_depth(ray, &comb, node, &before);
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
    for (var medium = 0u; medium < MEDIUM_COUNT; medium++) {
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
