// The scene of examples/galaxy.vol at 0 s; follows shared.wgsl.

// The radius changes by at most 0.76 from end to end of an axis of length 4.7.
const RADIUS_SLOPE: f32 = 0.3;

const STARS_RADII: vec3f = vec3f(1.8, 1.4, 1.4);
const STARS: vec3f = vec3f(2.3, 1.75, 1.2);
// Front of the sky, and its middle.
const SKY: f32 = -29.0;
const SKY_MIDDLE: f32 = -30.0;

fn radius_at(t: f32) -> f32 {
    return mix(0.1, 0.34, sin(PI * t));
}

fn twist_at(t: f32) -> f32 {
    return 0.4 * 2.0 * PI * t;
}

fn gas_at(q: Mapped, t: f32) -> Gas {
    let local = vec3f(q.across.x, q.length / view.axis_length, q.across.y);
    let lanes = fbm(local * vec3f(4.0, 7.0, 4.0) + vec3f(4.0, 0.0, 2.0), 7);
    let density = 90.0 * pow(max(0.0, lanes + 0.12), 1.5) * falloff(0.2, 1.0, q.radius) / q.stretch;
    let glow = vec3f(0.6, 0.17, 0.03) * falloff(0.02, 0.3, abs(t - 0.5)) * falloff(0.0, 0.8, q.radius);
    return Gas(density * vec3f(0.4, 0.75, 1.2), vec3f(0.0), density * glow);
}

fn incoming_light(p: vec3f, direction: vec3f) -> vec3f {
    return vec3f(0.0);
}

// Emission of the stars per length.
fn stars_at(p: vec3f) -> vec3f {
    return pow(max(0.0, 1.0 - length(p / STARS_RADII)), 3.0) * STARS;
}

// Distances at which a ray enters and leaves the ball of stars; the second is the smaller one if it does not.
fn stars_span(ray: Ray) -> vec2f {
    let away = ray.origin / STARS_RADII;
    let way = ray.direction / STARS_RADII;
    let a = dot(way, way);
    let b = dot(away, way);
    let root = b * b - a * (dot(away, away) - 1.0);
    if root <= 0.0 {
        return vec2f(1e30, -1e30);
    }
    return vec2f(-b - sqrt(root), -b + sqrt(root)) / a;
}

// Marches through dust and stars together: outside the dust to the tube, by no more than a step.
fn march_both(ray: Ray, end: f32) -> Seen {
    let span = tube_span(ray, end);
    let stars = stars_span(ray);
    let near = min(span.near, max(stars.x, 0.0));
    let far = max(span.far, stars.y);
    var seen = Seen(vec3f(0.0), vec3f(1.0));
    var t = near;
    var is_inside = false;
    for (var count = 0; count < MOST_STEPS && t < far; count++) {
        var length = min(view.step, far - t);
        var middle = t + select(0.0, 0.5 * length, is_inside);
        let p = ray_at(ray, middle);
        var outside = 1e30;
        var inside: Inside;
        if span.segments != 0u {
            inside = tube(p, span.segments);
            outside = inside.distance;
        }
        if outside >= 0.0 {
            length = min(min(advance(outside), view.step), far - middle) + (middle - t);
            seen.light += seen.transmittance * stars_at(ray_at(ray, t + 0.5 * length)) * length;
            t += length;
            is_inside = false;
        } else if !is_inside {
            t = wall_before(t, outside);
            is_inside = true;
        } else {
            let gas = gas_at(mapped(inside), inside.t);
            seen = seen_through(seen, gas.extinction, gas.emission + stars_at(p), length);
            if is_opaque(seen.transmittance) {
                break;
            }
            t += length;
        }
    }
    return seen;
}

// 32 random bits of a lattice cell, the hash of vol's cellular noise with seed 0.
fn hash(cell: vec3i) -> u32 {
    let c = bitcast<vec3u>(cell);
    var h = (c.x * 0x8da6b343u) ^ (c.y * 0xd8163841u) ^ (c.z * 0xcb1ab31fu) ^ 0x27d4eb2fu;
    h = (h ^ (h >> 16u)) * 0x7feb352du;
    h = (h ^ (h >> 15u)) * 0x846ca68bu;
    return h ^ (h >> 16u);
}

// Distance to the nearest of points strewn one to a cell, at most 1 (S. Worley 1996).
fn worley(p: vec3f) -> f32 {
    let whole = floor(p);
    var nearest = 1.0;
    for (var i = 0; i < 27; i++) {
        let step = vec3i(i % 3, (i / 3) % 3, i / 9) - 1;
        let bits = hash(vec3i(whole) + step);
        let point = (vec3f(vec3u(bits, bits >> 10u, bits >> 20u) & vec3u(1023u)) + 0.5) / 1024.0;
        let offset = p - whole - vec3f(step) - point;
        nearest = min(nearest, dot(offset, offset));
    }
    return sqrt(nearest);
}

fn sky_color(p: vec3f) -> vec3f {
    let local = p - vec3f(0.0, 0.0, SKY_MIDDLE);
    return vec3f(0.8 * falloff(0.02, 0.06, worley(1.4 * local)));
}

fn radiance(ray: Ray) -> vec3f {
    let end = (SKY - ray.origin.z) / ray.direction.z;
    let seen = march_both(ray, end);
    if is_opaque(seen.transmittance) {
        return seen.light;
    }
    return seen.light + seen.transmittance * sky_color(ray_at(ray, end));
}
