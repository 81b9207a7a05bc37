// Rays: through the picture, and against boxes.
// Twin: runtime-cpu/src/render/camera.rs, which says why.

struct Ray {
    origin: vec3f,
    direction: vec3f,
    // How far its comb is moved along it: -1/2..1/2, in steps.
    shift: f32,
}

// With its comb where it is usually.
fn new_ray(origin: vec3f, direction: vec3f) -> Ray {
    return Ray(origin, direction, 0.0);
}

struct Span {
    entry: f32,
    leave: f32,
}

fn ray_at(ray: Ray, t: f32) -> vec3f {
    return ray.origin + (ray.direction * t);
}

fn camera_ray(place: vec2f) -> Ray {
    let u = ((2.0 * place.x) / vol_frame_word(AT_SIZE)) - 1.0;
    let v = 1.0 - ((2.0 * place.y) / vol_frame_word(AT_SIZE + 1u));
    let sideways = word3(AT_FORWARD) + (word3(AT_RIGHT) * u);
    let toward = sideways + (word3(AT_UP) * v);
    return new_ray(word3(AT_EYE), toward / length3(toward));
}

// Part of a ray inside a box.
fn slab(ray: Ray, lo: vec3f, hi: vec3f) -> Span {
    var span = Span(0.0, FAR);
    for (var axis = 0u; axis < 3u; axis++) {
        // Where the ray crosses the two planes; along them it is between them always or never.
        let o = ray.origin[axis];
        let d = ray.direction[axis];
        let parallel = abs(d) < PARALLEL;
        let divisor = select(d, 1.0, parallel);
        let a = (lo[axis] - o) / divisor;
        let b = (hi[axis] - o) / divisor;
        let beside = (o < lo[axis]) | (o > hi[axis]);
        let near = select(min(a, b), select(0.0, FAR, beside), parallel);
        let end = select(max(a, b), select(FAR, -FAR, beside), parallel);
        span.entry = max(span.entry, near);
        span.leave = min(span.leave, end);
    }
    return span;
}

// A little longer than rounding can make it.
fn loosened(span: Span) -> Span {
    let slack = 16.0 * EPSILON;
    return Span(span.entry - (slack * span.entry), span.leave + (slack * span.leave));
}

fn contains(lo: vec3f, hi: vec3f, point: vec3f) -> bool {
    return all(lo <= point) & all(point <= hi);
}
