// What media along a ray add and take away.
// Twin: runtime-cpu/src/render/medium.rs, which says why.

struct Interior {
    scattering: vec3f,
    extinction: vec3f,
    emission: vec3f,
}

struct Glow {
    light: vec3f,
    transmittance: vec3f,
}

struct Filling {
    // Optical depth.
    depth: vec3f,
    // Light that starts at the node.
    source: vec3f,
    // Scattering of each medium times the length that the node stands for.
    scatter: array<vec3f, MEDIUM_SLOTS>,
}

// Follows the ray through the media up to its end.
fn march(ray: Ray, end: f32) -> Glow {
    var glow = Glow(vec3f(0.0), vec3f(1.0));
    var comb = new_comb(ray, end, vol_input[AT_STEP]);
    var weights: array<f32, MEDIUM_SLOTS>;
    for (var node = comb.first; node <= comb.last; node++) {
        if (weigh(ray, &comb, node, &weights)) {
            let sent = node_glow(ray, node_distance(node, comb.step), &weights);
            glow.light += glow.transmittance * sent.light;
            glow.transmittance = glow.transmittance * sent.transmittance;
        }
        // Go on while the ray still lets light through.
        if (largest(glow.transmittance) < STOP) {
            break;
        }
    }
    return glow;
}

// Light that one node sends, and what it lets through.
fn node_glow(ray: Ray, t: f32, weights: ptr<function, array<f32, MEDIUM_SLOTS>>) -> Glow {
    let point = ray_at(ray, t);
    var filling = fill(point, weights);
    let count = light_count();
    for (var light = 0u; light < count; light++) {
        let lamp = arriving(light, point);
        let seen = node_visibility(lamp, point, t, &filling);
        scatter_light(lamp, seen, ray.direction, &filling);
    }
    return Glow(filling.source * mean_decay3(filling.depth), decay3(filling.depth));
}

// Evaluates the media at a node; adds their own light.
fn fill(point: vec3f, weights: ptr<function, array<f32, MEDIUM_SLOTS>>) -> Filling {
    var filling: Filling;
    filling.depth = vec3f(0.0);
    filling.source = vec3f(0.0);
    for (var medium = 0u; medium < MEDIUM_COUNT; medium++) {
        let weight = (*weights)[medium];
        filling.scatter[medium] = vec3f(0.0);
        if (weight > 0.0) {
            let interior = medium_interior(medium, point);
            filling.depth += interior.extinction * weight;
            filling.scatter[medium] = interior.scattering * weight;
            filling.source += interior.emission * weight;
        }
    }
    return filling;
}

// Fraction of a lamp's light that arrives at a node, if a medium needs to know.
fn node_visibility(lamp: Arriving, point: vec3f, t: f32, filling: ptr<function, Filling>) -> vec3f {
    var asked = false;
    for (var medium = 0u; medium < MEDIUM_COUNT; medium++) {
        let scatters = any((*filling).scatter[medium] > vec3f(0.0));
        asked = asked | (scatters & (vol_input[medium_word(medium)] == SHADOWED));
    }
    if (asked & lamp.shadows) {
        return visibility(Ray(point, lamp.direction), lamp.distance, shadow_bias(t));
    }
    return vec3f(1.0);
}

// Adds the light of one lamp, scattered towards the eye.
fn scatter_light(lamp: Arriving, seen: vec3f, direction: vec3f, filling: ptr<function, Filling>) {
    let angles = turn(lamp.direction, direction);
    for (var medium = 0u; medium < MEDIUM_COUNT; medium++) {
        let lighting = vol_input[medium_word(medium)];
        let scatter = (*filling).scatter[medium];
        if (any(scatter > vec3f(0.0)) & (lighting > UNLIT)) {
            // Add what arrives and is turned towards the eye.
            let phase = medium_phase(medium, angles.x, angles.y);
            let arrives = select(seen, vec3f(1.0), lighting == UNSHADOWED);
            (*filling).source += (scatter * phase) * (lamp.irradiance * arrives);
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
