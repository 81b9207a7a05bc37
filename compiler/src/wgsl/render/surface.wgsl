// Where rays meet solids: sphere tracing.
// Twin: runtime-cpu/src/render/surface.rs, which says why.

struct Near {
    distance: f32,
    value: f32,
    solid: u32,
    gap: f32,
    rest: f32,
    entry: f32,
    leave: f32,
}

// A ray on its way: how far it is, where it was one step earlier, how far nothing could be from there, and whether it
// went farther than that.
struct Walker {
    t: f32,
    before: f32,
    free: f32,
    guessed: bool,
}

struct Contact {
    hit: bool,
    solid: u32,
    t: f32,
    position: vec3f,
    normal: vec3f,
    residual: f32,
}

fn footprint() -> f32 {
    return (2.0 * length3(word3(AT_UP))) / vol_frame_word(AT_SIZE + 1u);
}

fn remoteness() -> f32 {
    return length3(word3(AT_EYE));
}

// How near a ray may pass a surface unseen: half a pixel, or what rounding makes of positions.
fn tolerance(t: f32) -> f32 {
    let pixel = (0.5 * footprint()) * t;
    return max(pixel, (4.0 * EPSILON) * (remoteness() + t));
}

// Shortest step of a ray: nothing thinner than a fortieth of a pixel is sure to be seen.
fn stride(t: f32) -> f32 {
    let pixel = (0.025 * footprint()) * t;
    return max(pixel, (4.0 * EPSILON) * (remoteness() + t));
}

fn shadow_bias(t: f32) -> f32 {
    let pixel = (0.1 * footprint()) * t;
    return pixel + rounding(t);
}

// How far rounding may move a surface along a ray, with room to spare.
fn rounding(t: f32) -> f32 {
    return (64.0 * EPSILON) * (remoteness() + t);
}

fn object_word(solid: u32) -> u32 {
    return AT_OBJECTS + (OBJECT_WORDS * solid);
}

// A caller hands over the arrays that it wants filled: to return one copies each of its elements.

// Sign of each solid's distance as the camera sees it: -1 for those that hold the eye, with all that they
// are parts of.
fn find_sides(sides: ptr<function, array<f32, OBJECT_SLOTS>>) {
    for (var solid = 0u; solid < OBJECT_COUNT; solid++) {
        let at = object_word(solid);
        let eye = word3(AT_EYE);
        (*sides)[solid] = 1.0;
        if (contains(word3(at + 1u), word3(at + 4u), eye) & (vol_frame_word(at) != 0.0)) {
            (*sides)[solid] = select(1.0, -1.0, object_distance(solid, eye) < 0.0);
        }
        if (joins_the_one_before(solid)) {
            (*sides)[solid] = min((*sides)[solid], (*sides)[solid - 1u]);
        }
    }
    for (var solid = OBJECT_COUNT; solid > 1u; solid--) {
        if (joins_the_one_before(solid - 1u)) {
            (*sides)[solid - 2u] = min((*sides)[solid - 2u], (*sides)[solid - 1u]);
        }
    }
}

fn no_sides(sides: ptr<function, array<f32, OBJECT_SLOTS>>) {
    for (var solid = 0u; solid < OBJECT_COUNT; solid++) {
        (*sides)[solid] = 1.0;
    }
}

// Parts of the ray in the box of each solid, a little longer than rounding can make them; all of the
// ray for a solid that is seen from within, since it ends where the box may end.
fn object_spans(
    ray: Ray,
    sides: ptr<function, array<f32, OBJECT_SLOTS>>,
    spans: ptr<function, array<Span, OBJECT_SLOTS>>,
) {
    for (var solid = 0u; solid < OBJECT_COUNT; solid++) {
        let at = object_word(solid);
        let span = loosened(slab(ray, word3(at + 1u), word3(at + 4u)));
        let there = vol_frame_word(at) != 0.0;
        (*spans)[solid].entry = select(FAR, span.entry, there);
        let is_within = ((*sides)[solid] < 0.0) & (span.entry <= span.leave);
        let leave = select(span.leave, FAR, is_within);
        (*spans)[solid].leave = select(-FAR, leave, there);
    }
}

// What is around a place on the ray, `before` that of the last step.
fn nearest(
    ray: Ray,
    spans: ptr<function, array<Span, OBJECT_SLOTS>>,
    sides: ptr<function, array<f32, OBJECT_SLOTS>>,
    t: f32,
    before: f32,
) -> Near {
    var near = Near(FAR, FAR, 0u, FAR, 0.0, FAR, FAR);
    // What was near without the parts of a union that holds the eye, and the farthest wall of those: a ray is
    // inside as long as it is in one of them.
    var others = near;
    var farthest = -FAR;
    for (var solid = 0u; solid < OBJECT_COUNT; solid++) {
        let joined = joins_the_one_before(solid) & ((*sides)[solid] < 0.0);
        if (!joined) {
            others = near;
            farthest = -FAR;
        }
        let span = (*spans)[solid];
        let some = span.entry <= span.leave;
        let ahead = some & (t < span.entry);
        near.gap = select(near.gap, min(near.gap, span.entry - t), ahead);
        near.entry = select(near.entry, min(near.entry, span.entry), ahead);
        if (some & (t >= span.entry) & (t <= span.leave)) {
            near.rest = max(near.rest, span.leave - t);
            // A solid with a bound along rays alone tells nothing of what is beside the way.
            let is_ball = vol_frame_word(object_word(solid) + 7u) != BY_STEEPNESS;
            near.leave = min(near.leave, select(0.0, span.leave, is_ball));
            // Keep the smallest distance; the earlier solid on a tie.
            let seen = (*sides)[solid] * object_distance(solid, ray_at(ray, t));
            let safe = shorten(solid, ray, t, t - before, seen);
            if (!joined | (seen > farthest)) {
                farthest = seen;
                near.value = min(others.value, seen);
                let closer = safe < others.distance;
                near.distance = select(others.distance, safe, closer);
                near.solid = select(others.solid, solid, closer);
            }
        }
    }
    return near;
}

// How far to walk: as far as nothing can be, at least by `least`. A ray that has used up half of its steps
// goes through what is left of the boxes in even steps.
fn advance(near: Near, step: u32, least: f32) -> f32 {
    let free = min(near.distance, near.gap);
    let left = f32((MAX_STEPS - step) + 1u);
    let even = select(0.0, min(near.rest / left, near.gap), is_stuck(step));
    return max(max(free, least), even);
}

fn is_stuck(step: u32) -> bool {
    return step > (MAX_STEPS / 2u);
}

// Goes on, if possible farther than is sure: runtime-cpu/src/render/near.rs says why.
fn onward(near: Near, walker: Walker, step: u32, least: f32) -> Walker {
    let sure = advance(near, step, least);
    let last = walker.t - walker.before;
    let is_first = last <= 0.0;
    let fall = max((walker.free - near.distance) / select(last, 1.0, is_first), 0.0);
    let touching = (EAGERNESS * near.distance) / (1.0 + fall);
    let guess = min(min(touching, ROOM * near.gap), ROOM * (near.leave - walker.t));
    let place = walker.t + guess;
    let is_inside = (place < near.entry) & (place <= near.leave);
    let guessed = (guess > sure) & is_inside & !is_first & !is_stuck(step);
    return Walker(select(walker.t + sure, place, guessed), walker.t, sure, guessed);
}

// Whether a walker has gone too far: the balls that are empty around this place and the last do not touch.
fn is_past(near: Near, walker: Walker) -> bool {
    return walker.guessed & ((walker.free + near.distance) < (walker.t - walker.before));
}

// Goes back to where it was sure to come.
fn back(walker: Walker) -> Walker {
    return Walker(walker.before + walker.free, walker.before, walker.free, false);
}

// First surface on the ray.
fn trace(ray: Ray) -> Contact {
    var sides: array<f32, OBJECT_SLOTS>;
    var spans: array<Span, OBJECT_SLOTS>;
    find_sides(&sides);
    object_spans(ray, &sides, &spans);
    var walker = Walker(0.0, 0.0, 0.0, false);
    var hit = false;
    var solid = 0u;
    for (var count = 1u; count <= MAX_STEPS; count++) {
        let near = nearest(ray, &spans, &sides, walker.t, walker.before);
        if (is_past(near, walker)) {
            walker = back(walker);
            continue;
        }
        // Stop inside a solid; on the last step also where it would have been near enough.
        hit = near.value < select(0.0, tolerance(walker.t), count == MAX_STEPS);
        solid = near.solid;
        // Walk as far as nothing can be, at least a fortieth of a pixel.
        let next = onward(near, walker, count, stride(walker.t));
        if (hit | (next.t >= FAR)) {
            break;
        }
        walker = next;
    }
    if (hit) {
        return refine(ray, solid, walker.before, walker.t, sides[solid]);
    }
    return Contact(false, 0u, FAR, vec3f(0.0), vec3f(0.0), 0.0);
}

// Two places on a ray, the field 0 between them: (t, value) each.
struct Bracket {
    outside: vec2f,
    inside: vec2f,
}

// False position between the last two places.
fn refine(ray: Ray, solid: u32, before: f32, t: f32, side: f32) -> Contact {
    var bracket = Bracket(vec2f(before, 0.0), vec2f(t, 0.0));
    // The values at both ends come first: the field is asked at one place of the text, since drivers
    // write it out at each.
    for (var round = 0u; round < (2u + REFINEMENTS); round++) {
        let place = select(select(probe(bracket), t, round == 1u), before, round == 0u);
        let found = vec2f(place, side * object_distance(solid, ray_at(ray, place)));
        if (round == 0u) {
            bracket.outside = found;
        } else if (round == 1u) {
            bracket.inside = found;
        } else {
            bracket = narrow(bracket, found);
        }
    }
    let nearer = abs(bracket.outside.y) < abs(bracket.inside.y);
    let best = select(bracket.inside, bracket.outside, nearer);
    let gradient = facing_gradient(ray, solid, best.x, side);
    return contact(ray, solid, best.x, abs(best.y), gradient);
}

// Gradient where a ray enters a solid: taken a little inside, or outside if it points along the ray.
fn facing_gradient(ray: Ray, solid: u32, t: f32, side: f32) -> vec3f {
    var gradient = vec3f(0.0);
    var aside = rounding(t);
    for (var round = 0u; round < 2u; round++) {
        gradient = object_gradient(solid, ray_at(ray, t + aside)) * side;
        if (!(dot3(gradient, ray.direction) > 0.0)) {
            break;
        }
        aside = -aside;
    }
    return gradient;
}

// Where the field would be 0 if it were linear between the two; the inner place where it does not
// change sign.
fn probe(bracket: Bracket) -> f32 {
    let is_proper = (bracket.outside.y >= 0.0) & (bracket.inside.y < 0.0);
    let fall = select(1.0, bracket.outside.y - bracket.inside.y, is_proper);
    let part = bracket.outside.y / fall;
    let between = bracket.outside.x + ((bracket.inside.x - bracket.outside.x) * part);
    return select(bracket.inside.x, between, is_proper);
}

// Takes the value at the probe into account.
fn narrow(bracket: Bracket, found: vec2f) -> Bracket {
    let within = found.y < 0.0;
    return Bracket(select(found, bracket.outside, within), select(bracket.inside, found, within));
}

// The place of a hit, its normal and how exact it is.
fn contact(ray: Ray, solid: u32, t: f32, value: f32, gradient: vec3f) -> Contact {
    let steepness = length3(gradient);
    let is_flat = steepness < FLAT;
    let divisor = select(steepness, 1.0, is_flat);
    let normal = select(gradient / divisor, -ray.direction, is_flat);
    let most = 4.0 * tolerance(t);
    return Contact(true, solid, t, ray_at(ray, t), normal, min(value / divisor, most));
}
