// The scene of examples/solar_flare.vol at 0 s; follows shared.wgsl.

// The radius changes by at most 0.94 from end to end of an axis of length 3.6; where the axis bends, on the inner side of
// the ring, the foot moves up to three times as fast as the point.
const RADIUS_SLOPE: f32 = 0.85;

const SUN_CENTRE: vec3f = vec3f(0.0, -4.25, 0.0);
const SUN_RADIUS: f32 = 4.0;
// Front of the backdrop.
const BACKDROP: f32 = -7.9;
const GLOW_CENTRE: vec3f = vec3f(-2.0, -10.5, -8.0);

fn radius_at(t: f32) -> f32 {
    return mix(0.06, 0.38, pow(max(sin(PI * t), 0.0), 1.5));
}

fn twist_at(t: f32) -> f32 {
    return 1.5 * 2.0 * PI * t;
}

fn gas_at(q: Mapped, t: f32) -> Gas {
    let local = vec3f(q.across.x, q.length / view.axis_length, q.across.y);
    let strands = fbm(local * vec3f(4.0, 8.0, 4.0), 5);
    let density = 12.0 * pow(max(0.0, strands + 0.1), 1.6) * falloff(0.1, 1.0, q.radius) / q.stretch;
    let glow = mix(vec3f(3.0, 0.32, 0.03), vec3f(5.0, 2.4, 0.7), falloff(0.0, 0.6, q.radius));
    return Gas(vec3f(0.25 * density), vec3f(0.0), density * glow);
}

fn incoming_light(p: vec3f, direction: vec3f) -> vec3f {
    return vec3f(0.0);
}

fn sun_color(p: vec3f) -> vec3f {
    let local = p - SUN_CENTRE;
    let facing = dot(normalize(local), normalize(view.eye - p));
    let boil = 0.5 + 0.5 * fbm(7.0 * local, 3);
    return vec3f(2.0, 0.5, 0.06) * mix(0.3, 1.0, facing) * mix(0.5, 1.3, boil);
}

fn corona_color(p: vec3f) -> vec3f {
    return vec3f(0.3, 0.055, 0.008) * exp(-0.7 * max(0.0, distance(p, GLOW_CENTRE) - 9.4));
}

// Distance at which a ray meets the sun, negative if it does not.
fn sun_hit(ray: Ray) -> f32 {
    let away = ray.origin - SUN_CENTRE;
    let b = dot(away, ray.direction);
    // From the closest point, which keeps the digits of a small radius far away.
    let nearest = away - b * ray.direction;
    let inside = SUN_RADIUS * SUN_RADIUS - dot(nearest, nearest);
    if inside < 0.0 {
        return -1.0;
    }
    return -b - sqrt(inside);
}

fn radiance(ray: Ray) -> vec3f {
    // All rays of the picture that miss the sun meet the backdrop.
    var end = (BACKDROP - ray.origin.z) / ray.direction.z;
    let sun = sun_hit(ray);
    if sun > 0.0 {
        end = sun;
    }
    let seen = march(ray, end);
    if is_opaque(seen.transmittance) {
        return seen.light;
    }
    let p = ray_at(ray, end);
    if sun > 0.0 {
        return seen.light + seen.transmittance * sun_color(p);
    }
    return seen.light + seen.transmittance * corona_color(p);
}
