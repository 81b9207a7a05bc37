// What surfaces look like: their own light, and the lights that reach them.
// Twin: runtime-cpu/src/render/shade.rs, which says why.

struct Response {
    emitted: vec3f,
    diffuse: vec3f,
    specular: vec3f,
    shininess: f32,
}

struct Arriving {
    direction: vec3f,
    distance: f32,
    irradiance: vec3f,
    shadows: bool,
    slope: f32,
    // Word of the light's grid, 0 for none.
    grid: u32,
    // Word of its style's record, 0 for none.
    style: u32,
}

fn light_count() -> u32 {
    return u32(vol_frame_word(AT_LIGHT_COUNT));
}

// What a light sends to a point.
fn arriving(light: u32, point: vec3f) -> Arriving {
    let at = AT_LIGHTS + (LIGHT_WORDS * light);
    let distant = vol_frame_word(at) != 0.0;
    let toward = word3(at + 1u) - point;
    // At the very place of the light the irradiance stays finite.
    let squared = max(dot3(toward, toward), 1e-12);
    let distance = sqrt(squared);
    let direction = select(toward / distance, word3(at + 1u), distant);
    let irradiance = select(word3(at + 4u) / squared, word3(at + 4u), distant);
    let shadows = vol_frame_word(at + 7u) != 0.0;
    let size = vol_frame_word(at + 8u);
    let slope = select(min(size / distance, MAX_SPREAD_TANGENT), size, distant);
    let grid = u32(vol_frame_word(at + 10u));
    let style = u32(vol_frame_word(at + 11u));
    return Arriving(direction, select(distance, FAR, distant), irradiance, shadows, slope, grid, style);
}

// Radiance that leaves a contact towards the eye.
fn shade(ray: Ray, contact: Contact) -> vec3f {
    if (vol_frame_word(object_word(contact.solid)) == SHOWS_NORMALS) {
        return (contact.normal + vec3f(1.0)) * 0.5;
    }
    let response = object_surface(contact.solid, contact.position);
    let answers = any(response.diffuse != vec3f(0.0)) | any(response.specular != vec3f(0.0));
    var color = response.emitted;
    let count = select(0u, light_count(), answers);
    for (var light = 0u; light < count; light++) {
        let lamp = arriving(light, contact.position);
        let cosine = dot3(contact.normal, lamp.direction);
        if (cosine > 0.0) {
            var seen = surface_visibility(lamp, contact);
            if (OCCLUDING_LIGHTS) {
                let reach = vol_frame_word(AT_LIGHTS + (LIGHT_WORDS * light) + 9u);
                if (reach > 0.0) {
                    seen = seen * openness(contact, reach);
                }
            }
            color += (lamp.irradiance * seen) * answer(response, contact, lamp, cosine, ray.direction);
        }
    }
    return color;
}

// Fraction of the light that arrives at a contact.
fn surface_visibility(lamp: Arriving, contact: Contact) -> vec3f {
    if (!lamp.shadows) {
        return vec3f(1.0);
    }
    // Start off the surface, by at least twice what the hit may be off.
    let bias = shadow_bias(contact.t);
    let offset = max(bias, 2.0 * contact.residual);
    let origin = contact.position + (contact.normal * offset);
    return soft_visibility(new_ray(origin, lamp.direction), lamp.distance, bias, lamp.slope, lamp.grid);
}

// Radiance towards the eye per irradiance on a facing plane.
fn answer(response: Response, contact: Contact, lamp: Arriving, cosine: f32, direction: vec3f) -> vec3f {
    let mirrored = (contact.normal * (2.0 * cosine)) - lamp.direction;
    let shine = power(dot3(mirrored, -direction), response.shininess);
    return (response.diffuse * cosine) + (response.specular * shine);
}
