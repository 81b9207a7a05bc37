// Clouds in tubes around quadratic Bezier curves, rendered as in M. Moinet, "Sculpting procedural noise" (2022): a ray is
// cast on the bounding boxes of the curve's segments (section 4.3), sphere-marched to the tube (section 2.1) and marched
// through it with a fixed step, the noise evaluated at each step and its colour and transparency accumulated by
// Beer-Lambert's law (section 2.2). Points are mapped to the straight cylinder of section 4.2, with the varying radius, the
// stretching and the rotation of section 4.4.
//
// A scene adds RADIUS_SLOPE, `radius_at`, `twist_at`, `gas_at`, `incoming_light` and `radiance`.

const PI: f32 = 3.14159265;

// Most iterations of any march: a guard against a step of zero, never reached.
const MOST_STEPS: i32 = 1000000;
// Least advance towards a wall, scene units: how far behind it a ray may find itself at most.
const LEAST_ADVANCE: f32 = 3e-4;
// What is seen through less than this is not looked at.
const OPAQUE: f32 = 1e-3;
// Optical depth through which no light comes.
const DARK: f32 = 8.0;
// The largest factor of volume that mass conservation divides by a bend.
const LEAST_BEND: f32 = 0.05;

// One segment `start + 2 t along + t^2 bend` of the axis.
struct Segment {
    start: vec3f,
    // Length of the axis before it.
    length_before: f32,
    along: vec3f,
    bend: vec3f,
    // Unit tangent at the start and the normal carried there from the start of the curve.
    tangent: vec3f,
    normal: vec3f,
    // Box around the segment, larger by the largest radius.
    low: vec3f,
    high: vec3f,
}

struct View {
    eye: vec3f,
    step: f32,
    forward: vec3f,
    shadow_step: f32,
    right: vec3f,
    axis_length: f32,
    up: vec3f,
    segment_count: u32,
    size: vec2u,
    segments: array<Segment, 4>,
}

@group(0) @binding(0) var<uniform> view: View;
// Perlin's permutation of 0 to 255.
@group(0) @binding(1) var<storage, read> permutation: array<u32, 256>;
@group(0) @binding(2) var<storage, read_write> picture: array<vec4f>;

struct Ray {
    origin: vec3f,
    direction: vec3f,
}

fn ray_at(ray: Ray, t: f32) -> vec3f {
    return ray.origin + t * ray.direction;
}

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if any(id.xy >= view.size) {
        return;
    }
    let place = (vec2f(id.xy) + 0.5) / vec2f(view.size);
    let toward = view.forward + (2.0 * place.x - 1.0) * view.right + (1.0 - 2.0 * place.y) * view.up;
    let color = radiance(Ray(view.eye, normalize(toward)));
    picture[id.y * view.size.x + id.x] = vec4f(color, 1.0);
}

// ---- Noise ----

fn permuted(i: i32) -> i32 {
    return i32(permutation[i & 255]);
}

// Perlin's gradients: the dot product of one of twelve edge directions with an offset.
fn gradient_value(code: i32, offset: vec3f) -> f32 {
    let h = code & 15;
    let u = select(offset.y, offset.x, h < 8);
    let v = select(select(offset.z, offset.x, h == 12 || h == 14), offset.y, h < 4);
    return select(u, -u, (h & 1) != 0) + select(v, -v, (h & 2) != 0);
}

// K. Perlin, "Improving noise" (2002), each entry of the permutation looked up once.
fn perlin(p: vec3f) -> f32 {
    let whole = floor(p);
    let cell = vec3i(whole);
    let f = p - whole;
    let fade = f * f * f * (f * (f * 6.0 - 15.0) + 10.0);
    let a = permuted(cell.x) + cell.y;
    let b = permuted(cell.x + 1) + cell.y;
    let aa = permuted(a) + cell.z;
    let ab = permuted(a + 1) + cell.z;
    let ba = permuted(b) + cell.z;
    let bb = permuted(b + 1) + cell.z;
    let near = mix(
        mix(gradient_value(permuted(aa), f), gradient_value(permuted(ba), f - vec3f(1.0, 0.0, 0.0)), fade.x),
        mix(
            gradient_value(permuted(ab), f - vec3f(0.0, 1.0, 0.0)),
            gradient_value(permuted(bb), f - vec3f(1.0, 1.0, 0.0)),
            fade.x,
        ),
        fade.y,
    );
    let far = mix(
        mix(
            gradient_value(permuted(aa + 1), f - vec3f(0.0, 0.0, 1.0)),
            gradient_value(permuted(ba + 1), f - vec3f(1.0, 0.0, 1.0)),
            fade.x,
        ),
        mix(
            gradient_value(permuted(ab + 1), f - vec3f(0.0, 1.0, 1.0)),
            gradient_value(permuted(bb + 1), f - vec3f(1.0, 1.0, 1.0)),
            fade.x,
        ),
        fade.y,
    );
    return mix(near, far, fade.z);
}

fn fbm(p: vec3f, octaves: i32) -> f32 {
    var sum = 0.0;
    var amplitude = 1.0;
    var q = p;
    for (var octave = 0; octave < octaves; octave++) {
        sum += amplitude * perlin(q);
        amplitude *= 0.5;
        q *= 2.0;
    }
    return sum;
}

fn falloff(low: f32, high: f32, x: f32) -> f32 {
    return 1.0 - smoothstep(low, high, x);
}

// ---- Curve ----

// The closest point of a curve.
struct Foot {
    segment: u32,
    // Within the segment.
    t: f32,
    // From the curve to the point.
    offset: vec3f,
    squared: f32,
}

fn foot_at(segment: u32, p: vec3f, t: f32) -> Foot {
    let s = view.segments[segment];
    let offset = p - (s.start + t * (2.0 * s.along + t * s.bend));
    return Foot(segment, t, offset, dot(offset, offset));
}

// Closest point of a segment by the closed form of I. Quilez, "Quadratic Bezier - distance" (2013), which the paper uses:
// the real roots of a cubic by Cardano's formula or by trigonometry. In f32 the roots have but three or four digits, so a
// Newton step follows.
fn foot_of_segment(segment: u32, p: vec3f) -> Foot {
    let s = view.segments[segment];
    let away = s.start - p;
    let scale = 1.0 / dot(s.bend, s.bend);
    // t^3 + 3 kx t^2 + 3 ky t + kz = 0
    let kx = scale * dot(s.along, s.bend);
    let ky = scale * (2.0 * dot(s.along, s.along) + dot(away, s.bend)) / 3.0;
    let kz = scale * dot(away, s.along);
    let cubic = vec3f(kx, ky, kz);
    let r = ky - kx * kx;
    let q = kx * (2.0 * kx * kx - 3.0 * ky) + kz;
    let h = q * q + 4.0 * r * r * r;
    if h >= 0.0 {
        let x = 0.5 * (vec2f(sqrt(h), -sqrt(h)) - q);
        let roots = sign(x) * pow(abs(x), vec2f(1.0 / 3.0));
        return foot_at(segment, p, polished(roots.x + roots.y - kx, cubic));
    }
    let z = sqrt(-r);
    let angle = acos(clamp(q / (2.0 * r * z), -1.0, 1.0)) / 3.0;
    let m = cos(angle);
    let n = sqrt(3.0) * sin(angle);
    // The third root is a maximum of the distance.
    let one = foot_at(segment, p, polished(2.0 * m * z - kx, cubic));
    let other = foot_at(segment, p, polished(-(n + m) * z - kx, cubic));
    if other.squared < one.squared {
        return other;
    }
    return one;
}

// A Newton step from a root, held within the segment.
fn polished(root: f32, cubic: vec3f) -> f32 {
    let t = clamp(root, 0.0, 1.0);
    let value = ((t + 3.0 * cubic.x) * t + 3.0 * cubic.y) * t + cubic.z;
    let slope = 3.0 * ((t + 2.0 * cubic.x) * t + cubic.y);
    return clamp(t - value / max(slope, 1e-6), 0.0, 1.0);
}

// Antiderivative of the speed of a segment, up to a constant: closed form of the integral of 2 sqrt(a u^2 + a k).
fn length_at(u: f32, a: f32, k: f32) -> f32 {
    let root = sqrt(u * u + k);
    return sqrt(a) * (u * root + k * sign(u) * log((abs(u) + root) / sqrt(k)));
}

// Length of a segment from its start to t.
fn length_to(s: Segment, t: f32) -> f32 {
    let a = dot(s.bend, s.bend);
    let vertex = dot(s.along, s.bend) / a;
    let k = dot(s.along, s.along) / a - vertex * vertex;
    return length_at(t + vertex, a, k) - length_at(vertex, a, k);
}

// ---- Tube ----

// A point as the tube sees it.
struct Inside {
    // Bound on the distance to the wall, negative inside.
    distance: f32,
    foot: Foot,
    // 0 to 1 along the curve.
    t: f32,
    radius: f32,
}

// A point mapped to the straight cylinder.
struct Mapped {
    // Across the axis in radii, and length along it.
    across: vec2f,
    length: f32,
    // Distance from the axis in radii.
    radius: f32,
    // Volume here over volume in the straight cylinder of radius and length 1.
    stretch: f32,
}

// Where the point is in the tube. `segments` has a bit for each segment that the ray can meet.
fn tube(p: vec3f, segments: u32) -> Inside {
    var foot: Foot;
    foot.squared = 1e30;
    for (var i = 0u; i < view.segment_count; i++) {
        if (segments & (1u << i)) != 0u {
            let found = foot_of_segment(i, p);
            if found.squared < foot.squared {
                foot = found;
            }
        }
    }
    let t = (f32(foot.segment) + foot.t) / f32(view.segment_count);
    let radius = radius_at(t);
    let wall = sqrt(foot.squared) - radius;
    return Inside(max(wall, beyond_end(foot, t)), foot, t, radius);
}

// How far a point is beyond the flat ends.
fn beyond_end(foot: Foot, t: f32) -> f32 {
    if t > 0.0 && t < 1.0 {
        return -1e30;
    }
    let s = view.segments[foot.segment];
    let along = dot(foot.offset, normalize(s.along + foot.t * s.bend));
    return select(along, -along, t == 0.0);
}

fn mapped(inside: Inside) -> Mapped {
    let foot = inside.foot;
    let s = view.segments[foot.segment];
    let velocity = s.along + foot.t * s.bend;
    let tangent = normalize(velocity);
    // The frame of the segment's start, turned the shortest way to the tangent here: it does not rotate about the axis.
    let sum = s.tangent + tangent;
    let turn = dot(foot.offset, sum) / dot(s.tangent, sum);
    let binormal = cross(s.tangent, s.normal);
    let x = dot(foot.offset, s.normal) - dot(s.normal, tangent) * turn;
    let y = dot(foot.offset, binormal) - dot(binormal, tangent) * turn;
    // Twist.
    let twist = twist_at(inside.t);
    let c = cos(twist);
    let n = sin(twist);
    // A bend squeezes volume on its inner side.
    let squeeze = 1.0 - 0.5 * dot(foot.offset, s.bend) / dot(velocity, velocity);
    return Mapped(
        vec2f(c * x - n * y, n * x + c * y) / inside.radius,
        s.length_before + length_to(s, foot.t),
        sqrt(foot.squared) / inside.radius,
        inside.radius * inside.radius * view.axis_length * max(squeeze, LEAST_BEND),
    );
}

// ---- March ----

// The part of a ray in which something may be, and the segments that it may meet there.
struct Span {
    near: f32,
    far: f32,
    segments: u32,
}

// Distances at which a ray enters and leaves a box.
fn box_span(ray: Ray, low: vec3f, high: vec3f) -> vec2f {
    let a = (low - ray.origin) / ray.direction;
    let b = (high - ray.origin) / ray.direction;
    let enter = min(a, b);
    let leave = max(a, b);
    return vec2f(max(max(enter.x, enter.y), enter.z), min(min(leave.x, leave.y), leave.z));
}

fn tube_span(ray: Ray, end: f32) -> Span {
    var span = Span(end, 0.0, 0u);
    for (var i = 0u; i < view.segment_count; i++) {
        let s = view.segments[i];
        let found = box_span(ray, s.low, s.high);
        let near = max(found.x, 0.0);
        let far = min(found.y, end);
        if near < far {
            span = Span(min(span.near, near), max(span.far, far), span.segments | (1u << i));
        }
    }
    return span;
}

// How far a ray may advance outside: the radius changes along the axis, so the distance to the wall is less than `distance`.
fn advance(distance: f32) -> f32 {
    return max(distance / sqrt(1.0 + RADIUS_SLOPE * RADIUS_SLOPE), LEAST_ADVANCE);
}

// The wall that a ray has just passed: without this, the brightest part of dense gas is left out.
fn wall_before(t: f32, distance: f32) -> f32 {
    return t + max(distance, -LEAST_ADVANCE);
}

// Extinction, scattering and emission of the gas, per length.
struct Gas {
    extinction: vec3f,
    scattering: vec3f,
    emission: vec3f,
}

// What has been seen along a ray.
struct Seen {
    light: vec3f,
    transmittance: vec3f,
}

// Adds a length of gas that is the same all along it.
fn seen_through(seen: Seen, extinction: vec3f, source: vec3f, length: f32) -> Seen {
    let depth = length * extinction;
    let passed = exp(-depth);
    // The integral of the transmittance, by its series where the difference has no digits.
    let thick = (1.0 - passed) / max(extinction, vec3f(1e-10));
    let sent = select(thick, length * (1.0 - 0.5 * depth), depth < vec3f(1e-2));
    return Seen(seen.light + seen.transmittance * source * sent, seen.transmittance * passed);
}

fn is_opaque(transmittance: vec3f) -> bool {
    return all(transmittance < vec3f(OPAQUE));
}

// Marches a ray through the tube.
fn march(ray: Ray, end: f32) -> Seen {
    let span = tube_span(ray, end);
    var seen = Seen(vec3f(0.0), vec3f(1.0));
    var t = span.near;
    // Whether the place is inside, so that the next is a step.
    var is_inside = false;
    for (var count = 0; count < MOST_STEPS && t < span.far; count++) {
        let length = min(view.step, span.far - t);
        let middle = t + select(0.0, 0.5 * length, is_inside);
        let p = ray_at(ray, middle);
        let inside = tube(p, span.segments);
        if inside.distance >= 0.0 {
            // Half a step behind the last one, or on the way to the wall.
            t = middle + advance(inside.distance);
            is_inside = false;
        } else if !is_inside {
            t = wall_before(t, inside.distance);
            is_inside = true;
        } else {
            let gas = gas_at(mapped(inside), inside.t);
            if any(gas.extinction > vec3f(0.0)) {
                let source = gas.emission + gas.scattering * incoming_light(p, ray.direction);
                seen = seen_through(seen, gas.extinction, source, length);
                if is_opaque(seen.transmittance) {
                    break;
                }
            }
            t += length;
        }
    }
    return seen;
}

// Marches from a place towards a light: the part of it that arrives.
fn shadow(p: vec3f, toward: vec3f) -> vec3f {
    let ray = Ray(p, toward);
    let span = tube_span(ray, 1e30);
    var depth = vec3f(0.0);
    var t = span.near;
    var is_inside = true;
    for (var count = 0; count < MOST_STEPS && t < span.far; count++) {
        let length = min(view.shadow_step, span.far - t);
        let middle = t + select(0.0, 0.5 * length, is_inside);
        let inside = tube(ray_at(ray, middle), span.segments);
        if inside.distance >= 0.0 {
            t = middle + advance(inside.distance);
            is_inside = false;
        } else if !is_inside {
            t = wall_before(t, inside.distance);
            is_inside = true;
        } else {
            depth += length * gas_at(mapped(inside), inside.t).extinction;
            if all(depth > vec3f(DARK)) {
                break;
            }
            t += length;
        }
    }
    return exp(-depth);
}
