// How much of a light with a size is seen past the solids: soft shadows.
// Twin: runtime-cpu/src/render/penumbra.rs, which says why.

const RIM_COUNT: u32 = 8u;
const RIM = array<vec2f, 8>(vec2f(1.0, 0.0), vec2f(0.70710677, 0.70710677), vec2f(0.0, 1.0), vec2f(-0.70710677, 0.70710677), vec2f(-1.0, 0.0), vec2f(-0.70710677, -0.70710677), vec2f(0.0, -1.0), vec2f(0.70710677, -0.70710677));
const PLACE_COUNT: u32 = 19u;
const PLACES = array<vec2f, 19>(vec2f(0.0, 0.0), vec2f(0.4, 0.0), vec2f(0.2, 0.3464102), vec2f(-0.2, 0.3464102), vec2f(-0.4, 0.0), vec2f(-0.2, -0.3464102), vec2f(0.2, -0.3464102), vec2f(0.7727407, 0.2070552), vec2f(0.5656854, 0.5656854), vec2f(0.2070552, 0.7727407), vec2f(-0.2070552, 0.7727407), vec2f(-0.5656854, 0.5656854), vec2f(-0.7727407, 0.2070552), vec2f(-0.7727407, -0.2070552), vec2f(-0.5656854, -0.5656854), vec2f(-0.2070552, -0.7727407), vec2f(0.2070552, -0.7727407), vec2f(0.5656854, -0.5656854), vec2f(0.7727407, -0.2070552));
const CLEAR: f32 = 2.0;
const BLUR: f32 = 0.3;
const LACK: f32 = 0.05;

struct Around {
    distance: f32,
    safe: f32,
    gap: f32,
}

// Fraction of a light that no solid hides.
fn lit_part_of(ray: Ray, distance: f32, least_step: f32, slope: f32) -> f32 {
    var ends = RIM;
    var clear: array<f32, RIM_COUNT>;
    var centre = 0.0;
    // The centre, then the rim: walked at one place of the text, since drivers write it out at each.
    for (var index = 0u; index <= RIM_COUNT; index++) {
        let end = max(index, 1u) - 1u;
        var toward = ray;
        if (index > 0u) {
            toward = rim(ray, slope, ends[end]);
        }
        let found = walk(toward, distance, least_step, slope);
        if (index > 0u) {
            clear[end] = found;
        } else if (found >= 1.0) {
            return 1.0;
        } else {
            centre = found;
        }
    }
    return lit_part(centre, &clear);
}

// Walks along the axis of a cone and keeps the smallest angle to a solid.
fn walk(ray: Ray, distance: f32, least_step: f32, slope: f32) -> f32 {
    counted_rays += 1u;
    var lowest = squared_sine(CLEAR * slope);
    var spans: array<Span, OBJECT_SLOTS>;
    cone_spans(ray, distance, slope, &spans);
    let end = min(distance, FAR);
    var t = 0.0;
    var older = vec2f(0.0);
    var newer = vec2f(0.0);
    for (var count = 0u; count < MAX_STEPS; count++) {
        let near = around(ray, &spans, t);
        // A ray that enters a solid is not clear at all.
        if (enters(near.distance, t, least_step)) {
            lowest = 0.0;
            break;
        }
        // Count what is surely not behind the light.
        let counts = (t > 0.0) & (near.distance >= 0.0) & (near.distance < (end - t));
        let divisor = select(1.0, t, counts);
        let sine = min(near.distance / divisor, 1.0);
        let sample = vec2f(1.0 / divisor, sine * sine);
        let found = min(sample.y, least(older, newer, sample));
        lowest = select(lowest, min(lowest, found), counts);
        older = select(vec2f(0.0), newer, counts);
        newer = select(vec2f(0.0), sample, counts);
        t += cone_step(near, least_step, slope, t);
        if (t >= end) {
            break;
        }
    }
    return clearance(lowest, slope);
}

// Parts of the ray where a solid's box is within the cone.
fn cone_spans(
    ray: Ray,
    distance: f32,
    slope: f32,
    spans: ptr<function, array<Span, OBJECT_SLOTS>>,
) {
    for (var solid = 0u; solid < OBJECT_COUNT; solid++) {
        let at = object_word(solid);
        let lo = word3(at + 1u);
        let hi = word3(at + 4u);
        let farthest = length3(max(abs(lo - ray.origin), abs(hi - ray.origin)));
        let width = (CLEAR * slope) * min(farthest, distance);
        let span = loosened(slab(ray, lo - vec3f(width), hi + vec3f(width)));
        let there = vol_frame_word(at) != 0.0;
        (*spans)[solid].entry = select(FAR, span.entry, there);
        (*spans)[solid].leave = select(-FAR, span.leave, there);
    }
}

// What is around a place on the ray.
fn around(ray: Ray, spans: ptr<function, array<Span, OBJECT_SLOTS>>, t: f32) -> Around {
    var near = Around(FAR, FAR, FAR);
    for (var solid = 0u; solid < OBJECT_COUNT; solid++) {
        let span = (*spans)[solid];
        let some = span.entry <= span.leave;
        let before = some & (t < span.entry);
        near.gap = select(near.gap, min(near.gap, span.entry - t), before);
        if (some & (t >= span.entry) & (t <= span.leave)) {
            let value = object_distance(solid, ray_at(ray, t));
            let safe = shorten(solid, ray, t, 0.0, value);
            // A field in units of its own is as far from 0 as its slope there says.
            let own_units = vol_frame_word(object_word(solid) + 7u) == BY_STEEPNESS;
            near.distance = min(near.distance, select(value, safe, own_units));
            near.safe = min(near.safe, safe);
        }
    }
    return near;
}

// Squared sine of an angle from its tangent.
fn squared_sine(tangent: f32) -> f32 {
    let squared = tangent * tangent;
    return squared / (1.0 + squared);
}

// A clearance in radii of the light from its squared sine.
fn clearance(lowest: f32, slope: f32) -> f32 {
    let cosine = max(1.0 - lowest, EPSILON);
    return min(sqrt(lowest / cosine) / slope, CLEAR);
}

// How far to walk.
fn cone_step(near: Around, least_step: f32, slope: f32, t: f32) -> f32 {
    let sine = sqrt(squared_sine(CLEAR * slope));
    let free = (near.safe - (sine * t)) / (1.0 + sine);
    let shortest = max(least_step, (0.002 * slope) * t);
    return max(min(max(free, 0.5 * near.safe), near.gap), shortest);
}

// Least value of the parabola through three samples if the middle one is the lowest, else that.
fn least(a: vec2f, b: vec2f, c: vec2f) -> f32 {
    let in_order = (a.x > b.x) & (b.x > c.x);
    let lowest = (b.y <= a.y) & (b.y <= c.y);
    if (!(in_order & lowest)) {
        return c.y;
    }
    let fall = (b.y - a.y) / (b.x - a.x);
    let rise = (c.y - b.y) / (c.x - b.x);
    let bend = (rise - fall) / (c.x - a.x);
    if (bend <= 0.0) {
        return b.y;
    }
    let place = (0.5 * (a.x + b.x)) - (0.5 * (fall / bend));
    let value = a.y + ((place - a.x) * (fall + (bend * (place - b.x))));
    return min(max(value, 0.75 * b.y), b.y);
}

// A ray to the rim of a light.
fn rim(ray: Ray, slope: f32, end: vec2f) -> Ray {
    let d = ray.direction;
    // Two unit vectors across the direction and each other.
    let turn = select(1.0, -1.0, d.z < 0.0);
    let a = -1.0 / (turn + d.z);
    let b = (d.x * d.y) * a;
    let right = vec3f(1.0 + (turn * ((d.x * d.x) * a)), turn * b, -(turn * d.x));
    let up = vec3f(b, turn + ((d.y * d.y) * a), -d.y);
    let toward = d + (((right * end.x) + (up * end.y)) * slope);
    return new_ray(ray.origin, toward / length3(toward));
}

// Area of the union of clear disks around the centre and the places on the rim, over that of the light.
fn lit_part(centre: f32, clear: ptr<function, array<f32, RIM_COUNT>>) -> f32 {
    var ends = RIM;
    var places = PLACES;
    var sum = 0.0;
    for (var index = 0u; index < PLACE_COUNT; index++) {
        // How far inside the lit part the place is, at least.
        var inside = clear_depth(centre, vec2f(0.0), places[index]);
        for (var end = 0u; end < RIM_COUNT; end++) {
            inside = max(inside, clear_depth((*clear)[end], ends[end], places[index]));
        }
        let edge = min(max((inside + LACK) / BLUR, -1.0), 1.0);
        let over = 1.0 + edge;
        sum += (0.25 * (over * over)) * (2.0 - edge);
    }
    let part = sum / f32(PLACE_COUNT);
    // Reach 1 where the centre is clear of the whole light, and 0 where nothing is clear.
    let whole = max((4.0 * centre) - 3.0, 0.0);
    var widest = centre;
    for (var end = 0u; end < RIM_COUNT; end++) {
        widest = max(widest, (*clear)[end]);
    }
    return (part + ((1.0 - part) * (whole * whole))) * min(10.0 * widest, 1.0);
}

// How deep a place lies in the clear disk around the end of a ray; far outside if the ray is blocked.
fn clear_depth(clear: f32, end: vec2f, place: vec2f) -> f32 {
    let aside = place - end;
    let distance = sqrt((aside.x * aside.x) + (aside.y * aside.y));
    return select(-CLEAR, clear - distance, clear > 0.0);
}
