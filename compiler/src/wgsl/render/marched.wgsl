// How much of a stretch of a ray solids leave in the light of a distant lamp, without a map.
// Twin: runtime-cpu/src/render/marched.rs, which says why.

const HALVINGS: u32 = 12u;
const MAX_PROBES: u32 = 4096u;
const LEAST_STEP: f32 = 10.0;
const DEPTHS: u32 = 4u;
const SMALLEST: f32 = 0x1p-126f;

// A walk along a stretch.
struct Walk {
    end: f32,
    // Up to where it is known.
    known: f32,
    lit: bool,
    // Length that is lit so far.
    length: f32,
    // Where to ask next.
    probe: f32,
    started: bool,
    // The two ends of a step in which the light changes, and how often it has yet to be halved: 0 in none.
    before: f32,
    after: f32,
    halvings: u32,
    // Where the step ended, and what was found there.
    far: f32,
    found: f32,
}

// Takes what was found at the probe; whether there is more to ask.
fn take(walk: ptr<function, Walk>, found: f32, least: f32) -> bool {
    let lit = found > 0.0;
    if (!(*walk).started) {
        (*walk).started = true;
        (*walk).lit = lit;
        return go_on(walk, (*walk).known, found, least);
    }
    if ((*walk).halvings > 0u) {
        let same = lit == (*walk).lit;
        (*walk).before = select((*walk).before, (*walk).probe, same);
        (*walk).after = select((*walk).probe, (*walk).after, same);
        (*walk).halvings -= 1u;
        let middle = 0.5 * ((*walk).before + (*walk).after);
        if ((*walk).halvings > 0u) {
            (*walk).probe = middle;
            return true;
        }
        // Change sides at the edge.
        (*walk).length += select((*walk).far - middle, middle - (*walk).known, (*walk).lit);
        (*walk).lit = !(*walk).lit;
        return go_on(walk, (*walk).far, (*walk).found, least);
    }
    if (lit == (*walk).lit) {
        (*walk).length += select(0.0, (*walk).probe - (*walk).known, lit);
        return go_on(walk, (*walk).probe, found, least);
    }
    (*walk).before = (*walk).known;
    (*walk).after = (*walk).probe;
    (*walk).far = (*walk).probe;
    (*walk).found = found;
    (*walk).halvings = HALVINGS;
    (*walk).probe = 0.5 * ((*walk).known + (*walk).probe);
    return true;
}

// Goes on from a place as far as nothing changes; whether that is not to the end.
fn go_on(walk: ptr<function, Walk>, start: f32, found: f32, least: f32) -> bool {
    (*walk).known = start;
    (*walk).probe = min(start + max(abs(found), least), (*walk).end);
    return abs(found) < ((*walk).end - start);
}

// Part of a stretch that is lit by a lamp in a direction.
fn marched_share(toward: vec3f, ray: Ray, cell: Cell) -> f32 {
    if (cell.start >= cell.end) {
        return 1.0;
    }
    let width = cell.end - cell.start;
    var walk = Walk(cell.end, cell.start, true, 0.0, cell.start, false, 0.0, 0.0, 0u, 0.0, 0.0);
    for (var count = 0u; count < MAX_PROBES; count++) {
        let least = stride(walk.probe);
        let found = margin(new_ray(ray_at(ray, walk.probe), toward), width, least);
        if (!take(&walk, found, LEAST_STEP * least)) {
            break;
        }
    }
    // Up to the end nothing changes, or nobody had the patience to ask.
    let rest = select(0.0, walk.end - walk.known, walk.lit);
    return min((walk.length + rest) / width, 1.0);
}

// How far from the origin of a ray towards the light nothing changes: positive where it is lit, negative in a shadow;
// at most `reach`.
fn margin(ray: Ray, reach: f32, least: f32) -> f32 {
    var margin = reach;
    var sides: array<f32, OBJECT_SLOTS>;
    no_sides(&sides);
    var spans = spans_nearby(ray, reach);
    var t = 0.0;
    var before = 0.0;
    var deep = 0u;
    for (var count = 1u; count <= MAX_STEPS; count++) {
        let near = nearest(ray, &spans, &sides, t, before);
        let bounded = (near.distance >= FAR) | (vol_frame_word(object_word(near.solid) + 7u) != BY_STEEPNESS);
        let sure = select(0.0, near.distance, bounded);
        let inside = near.distance < 0.0;
        var next = t + advance(near, count, least);
        if (inside | (deep > 0u)) {
            // Ask on a little, since deeper inside the shadow is surer.
            let depth = max(-sure, 0.0);
            margin = select(min(margin, -depth), -depth, deep == 0u);
            deep += 1u;
            if (!inside | (deep > DEPTHS)) {
                margin = min(margin, -SMALLEST);
                break;
            }
            next = t + max(depth, least);
        } else {
            margin = min(margin, max(0.5 * sure, SMALLEST));
        }
        if (next >= FAR) {
            break;
        }
        before = t;
        t = next;
    }
    return margin;
}

// Parts of the ray in the box of each solid, larger by a reach.
fn spans_nearby(ray: Ray, reach: f32) -> array<Span, OBJECT_SLOTS> {
    var spans: array<Span, OBJECT_SLOTS>;
    for (var solid = 0u; solid < OBJECT_COUNT; solid++) {
        let at = object_word(solid);
        let span = loosened(slab(ray, word3(at + 1u) - vec3f(reach), word3(at + 4u) + vec3f(reach)));
        let there = vol_frame_word(at) != 0.0;
        spans[solid] = Span(select(FAR, span.entry, there), select(-FAR, span.leave, there));
    }
    return spans;
}
