// Media by the midpoint rule: how much of a ray each node stands for, what is there, and how deep that is.
// Twin: runtime-cpu/src/render/comb.rs, medium.rs and shadow.rs, which say why.

// Signed distance of a node at a distance t from the nearest of: the medium's wall, the ray's two ends. The run is that of the node
// before, or the next one, and the nodes beside it are asked as well.
fn wall(ray: Ray, medium: u32, run: vec2i, t: f32, node: Node, steps_before: i32, end: f32) -> f32 {
    var region = FAR;
    if (((node.first + (2 * node.steps)) > run.x) & (node.first <= (run.y + max(node.steps, steps_before)))) {
        region = medium_region(medium, ray_at(ray, t));
    }
    return max(region, max(t - end, -t));
}

// Part of the interval between two neighbouring nodes that the first stands for, given of both the signed distance and half of
// what it stands for beside other nodes inside.
fn share(own: vec2f, other: vec2f) -> f32 {
    let divisor = select(-1.0, own.x - other.x, own.x < other.x);
    let part = (own.y + other.y) * (own.x / divisor);
    return select(part, own.y, other.x < 0.0);
}

// The length of ray that a node stands for in a medium, given the node after it; afterwards the comb's own distance is that of the
// node after. Nodes must come in order, from two before each run: so that regions are asked at one place of the text,
// since drivers write them out at each.
fn weigh(ray: Ray, medium: u32, comb: ptr<function, Comb>, node: Node, next: Node) -> f32 {
    let halves = 0.5 * (vec3f(vec3i((*comb).steps_before, node.steps, next.steps)) * (*comb).step);
    let before = (*comb).before[medium];
    let own = (*comb).own[medium];
    let after = wall(ray, medium, (*comb).runs[medium], middle_of(comb, next), next, node.steps, (*comb).end);
    let here = vec2f(own, halves.y);
    let weight = share(here, vec2f(before, halves.x)) + share(here, vec2f(after, halves.z));
    (*comb).before[medium] = own;
    (*comb).own[medium] = after;
    return select(0.0, weight, (own < 0.0) & (next.first > (*comb).first));
}

// Follows the ray through the media up to its end.
fn march(ray: Ray, end: f32) -> Glow {
    var glow = clear_glow();
    var styled = style_rays(ray, end);
    var comb = new_comb(ray, end, vol_frame_word(AT_STEP), widest_spacing());
    var weights: array<f32, MEDIUM_SLOTS>;
    // What is at the node and at the next one, of media that these are inside.
    var here: array<Interior, MEDIUM_SLOTS>;
    var ahead: array<Interior, MEDIUM_SLOTS>;
    var next: Node;
    for (var node = start_node(&comb, 2); node.first <= comb.last; node = next_node(&comb, node, next, 2)) {
        next = node_after(&comb, node);
        var some = false;
        for (var medium = 0u; medium < MEDIUM_COUNT; medium++) {
            weights[medium] = weigh(ray, medium, &comb, node, next);
            here[medium] = ahead[medium];
            // Right after its region: the closest point of a curve is kept for who asks next.
            if (comb.own[medium] < 0.0) {
                ahead[medium] = medium_interior(medium, ray_at(ray, middle_of(&comb, next)));
            }
            some = some | (weights[medium] > 0.0);
        }
        if (some) {
            glow = gather(glow, node.number, node_chunk(ray, middle_of(&comb, node), &styled, &weights, &here));
        }
        // Go on while the ray still lets light through.
        if (largest(glow.transmittance) < STOP) {
            break;
        }
    }
    return glow;
}

// Light and optical depth of one node.
fn node_chunk(
    ray: Ray,
    t: f32,
    styled: ptr<function, StyledRays>,
    weights: ptr<function, array<f32, MEDIUM_SLOTS>>,
    interiors: ptr<function, array<Interior, MEDIUM_SLOTS>>,
) -> Chunk {
    var depth = vec3f(0.0);
    var scatter: array<vec3f, MEDIUM_SLOTS>;
    var source: array<vec3f, MEDIUM_SLOTS>;
    for (var medium = 0u; medium < MEDIUM_COUNT; medium++) {
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
    if (LIT_MEDIA) {
        light_place(ray, t, styled, &scatter, &source);
    }
    // Add up what they send.
    var sent = vec3f(0.0);
    for (var medium = 0u; medium < MEDIUM_COUNT; medium++) {
        sent += source[medium] * mean_decay3(depth);
    }
    return Chunk(sent, depth);
}

// Integral of the extinction along the ray.
fn optical_depth(ray: Ray, end: f32) -> vec3f {
    var comb = new_comb(ray, end, vol_frame_word(AT_SHADOW_STEP), 1);
    // Density and extinction of each medium at the next node, where that is inside.
    var ahead: array<vec4f, MEDIUM_SLOTS>;
    var depth = vec3f(0.0);
    var next: Node;
    for (var node = start_node(&comb, 2); node.first <= comb.last; node = next_node(&comb, node, next, 2)) {
        next = node_after(&comb, node);
        // Optical depth of each node, all media together.
        var node_depth = vec3f(0.0);
        for (var medium = 0u; medium < MEDIUM_COUNT; medium++) {
            let weight = weigh(ray, medium, &comb, node, next);
            let matter = ahead[medium];
            if (comb.own[medium] < 0.0) {
                ahead[medium] = medium_extinction(medium, ray_at(ray, middle_of(&comb, next)));
            }
            node_depth += matter.yzw * (max(matter.x, 0.0) * weight);
        }
        depth += node_depth;
        // Go on while the ray is not dark yet.
        if (smallest(depth) > OPAQUE) {
            break;
        }
    }
    return depth;
}
