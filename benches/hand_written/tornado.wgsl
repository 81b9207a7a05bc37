// The scene of examples/tornado.vol at 0 s; follows shared.wgsl.

// The radius changes by at most 1.04 from end to end of an axis of length 2.26.
const RADIUS_SLOPE: f32 = 0.6;

const SUN: vec3f = vec3f(-0.4, 0.8, 0.3);
const SUN_IRRADIANCE: f32 = 12.0;
// #e6ebff and #0b1020, linear.
const SCATTER: vec3f = vec3f(0.7912979, 0.8307699, 1.0);
const BACKGROUND: vec3f = vec3f(0.0033465358, 0.0051815165, 0.014443844);
const ABSORB: f32 = 0.15;
const ASYMMETRY: f32 = 0.3;

fn radius_at(t: f32) -> f32 {
    return mix(0.08, 0.6, t * t);
}

fn twist_at(t: f32) -> f32 {
    return 0.8 * 2.0 * PI * t;
}

fn gas_at(q: Mapped, t: f32) -> Gas {
    let local = vec3f(q.across.x, q.length, q.across.y);
    let density = 25.0 * max(0.0, fbm(local * vec3f(3.0, 6.0, 3.0), 5) + 0.15);
    return Gas(density * (SCATTER + ABSORB), density * SCATTER, vec3f(0.0));
}

fn henyey_greenstein(cosine: f32) -> f32 {
    let g = ASYMMETRY;
    return (1.0 - g * g) / (4.0 * PI * pow(1.0 + g * g - 2.0 * g * cosine, 1.5));
}

fn incoming_light(p: vec3f, direction: vec3f) -> vec3f {
    let toward = normalize(SUN);
    return SUN_IRRADIANCE * henyey_greenstein(dot(toward, direction)) * shadow(p, toward);
}

fn radiance(ray: Ray) -> vec3f {
    let seen = march(ray, 1e30);
    return seen.light + seen.transmittance * BACKGROUND;
}
