// Single scattering: light of the lamps that media send towards the eye, at a place where they are
// sampled.
// Twin: runtime-cpu/src/render/scatter.rs, which says why.

// Adds the light of all lamps to the sources of all media at a place.
fn light_place(
    ray: Ray,
    t: f32,
    styled: ptr<function, StyledRays>,
    scatter: ptr<function, array<vec3f, MEDIUM_SLOTS>>,
    source: ptr<function, array<vec3f, MEDIUM_SLOTS>>,
) {
    let point = ray_at(ray, t);
    let count = light_count();
    for (var light = 0u; light < count; light++) {
        let lamp = arriving(light, point);
        var seen = place_visibility(lamp, light, styled, ray, t, scatter);
        if (STYLES && (lamp.style != 0u)) {
            seen = seen * styled_tint(lamp, light, styled, point);
        }
        scatter_light(lamp, seen, ray.direction, scatter, source);
    }
}

// Fraction of a lamp's light that arrives at a place, if a medium needs to know.
fn place_visibility(
    lamp: Arriving,
    light: u32,
    styled: ptr<function, StyledRays>,
    ray: Ray,
    t: f32,
    scatter: ptr<function, array<vec3f, MEDIUM_SLOTS>>,
) -> vec3f {
    var asked = false;
    for (var medium = 0u; medium < MEDIUM_COUNT; medium++) {
        let scatters = any((*scatter)[medium] > vec3f(0.0));
        asked = asked | (scatters & (vol_frame_word(medium_word(medium)) == SHADOWED));
    }
    if (asked & lamp.shadows) {
        let toward = new_ray(ray_at(ray, t), lamp.direction);
        var part = 1.0;
        if (STYLES && (lamp.style != 0u)) {
            counted_rays += 1u;
            part = styled_share(lamp, light, styled, ray, t);
        } else {
            part = unblocked(toward, lamp.distance, shadow_bias(t));
        }
        return through_media(toward, lamp.distance, part, lamp.grid);
    }
    return vec3f(1.0);
}

// Adds the light of one lamp, scattered towards the eye.
fn scatter_light(
    lamp: Arriving,
    seen: vec3f,
    direction: vec3f,
    scatter: ptr<function, array<vec3f, MEDIUM_SLOTS>>,
    source: ptr<function, array<vec3f, MEDIUM_SLOTS>>,
) {
    let angles = turn(lamp.direction, direction);
    for (var medium = 0u; medium < MEDIUM_COUNT; medium++) {
        let lighting = vol_frame_word(medium_word(medium));
        let part = (*scatter)[medium];
        if (any(part > vec3f(0.0)) & (lighting > UNLIT)) {
            // Add what arrives and is turned towards the eye.
            let phase = medium_phase(medium, angles.x, angles.y);
            let arrives = select(seen, vec3f(1.0), lighting == UNSHADOWED);
            (*source)[medium] += (part * phase) * (lamp.irradiance * arrives);
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
