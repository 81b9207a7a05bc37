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

// Follows the ray through the media up to its end.
fn march(ray: Ray, end: f32) -> Glow {
    if (CORRECTED) {
        return march_panels(ray, end);
    }
    return march_nodes(ray, end);
}

fn clear_glow() -> Glow {
    return Glow(vec3f(0.0), vec3f(1.0), vec3f(0.0), vec3f(1.0));
}

fn march_nodes(ray: Ray, end: f32) -> Glow {
    var glow = clear_glow();
    var styled = style_rays(ray, end);
    var comb = new_comb(ray, end, vol_frame_word(AT_STEP));
    var weights: array<f32, MEDIUM_SLOTS>;
    for (var node = comb.first - 2; node <= comb.last; node = next_node(&comb, node, 2)) {
        if (weigh(ray, &comb, node, &weights)) {
            glow = gather(glow, node, node_chunk(ray, node_distance(node, comb.step, comb.offset), &styled, &weights));
        }
        // Go on while the ray still lets light through.
        if (largest(glow.transmittance) < STOP) {
            break;
        }
    }
    return glow;
}

// Light that a node or panel sends, and its optical depth.
struct Chunk {
    sent: vec3f,
    depth: vec3f,
}

// Light and optical depth of one node.
fn node_chunk(
    ray: Ray,
    t: f32,
    styled: ptr<function, StyledRays>,
    weights: ptr<function, array<f32, MEDIUM_SLOTS>>,
) -> Chunk {
    let point = ray_at(ray, t);
    var depth = vec3f(0.0);
    var scatter: array<vec3f, MEDIUM_SLOTS>;
    var source: array<vec3f, MEDIUM_SLOTS>;
    for (var medium = 0u; medium < MEDIUM_COUNT; medium++) {
        let weight = (*weights)[medium];
        scatter[medium] = vec3f(0.0);
        source[medium] = vec3f(0.0);
        if (weight > 0.0) {
            let interior = medium_interior(medium, point);
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
