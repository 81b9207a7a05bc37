// The samples of media along a ray, and the length of ray that each stands for.
// Twin: runtime-cpu/src/render/comb.rs, which says why.

// After the last node; f32 knows it.
const NO_NODE: i32 = 0x800000;
const NO_RUN: f32 = 8388608.0;

struct Comb {
    step: f32,
    // Where the middle of step 0 is, in steps.
    offset: f32,
    // Steps that are divided alike; see spacing.wgsl.
    block: i32,
    end: f32,
    // Steps that may be inside some medium.
    first: i32,
    last: i32,
    // The same for each medium, and of those this run or the next one.
    all: array<Runs, MEDIUM_SLOTS>,
    runs: array<vec2i, MEDIUM_SLOTS>,
    // Signed distances of each medium at the node before, how many steps that stands for, and at the next one.
    before: array<f32, MEDIUM_SLOTS>,
    steps_before: i32,
    own: array<f32, MEDIUM_SLOTS>,
}

// First and last nodes of up to four runs, in any order; NO_RUN is the first of none. Numbers of nodes, which f32 knows: GLSL ES
// 3.00 chooses among components of float vectors only.
struct Runs {
    first: vec4f,
    last: vec4f,
}

// Where the middle of step 0 is, in steps. Panels begin at the origin, so there node 0 is at or before it.
fn first_node(shift: f32, block: i32) -> f32 {
    let moved = floor(f32(block) * (0.5 + shift));
    let middle = (0.5 + shift) - (f32(block - 1) - moved);
    return select(middle, select(shift, shift - 1.0, shift > 0.0), CORRECTED);
}

fn node_distance(node: i32, step_size: f32, offset: f32) -> f32 {
    return (f32(node) + offset) * step_size;
}

fn medium_word(medium: u32) -> u32 {
    return AT_MEDIA + (MEDIUM_WORDS * medium);
}

// Steps that may be inside a box; none if the last is less than the first. The box is grown by what a node stands for, so that
// the neighbours of a node inside are in the range or next to it, and so are the panels on both sides.
fn node_range(ray: Ray, lo: vec3f, hi: vec3f, spacing: i32, comb: ptr<function, Comb>) -> vec2i {
    let step_size = (*comb).step;
    let reach = vec3f((1.01 * f32(spacing)) * step_size);
    let span = slab(ray, lo - reach, hi + reach);
    let leave = min(span.leave, (*comb).end);
    // Node numbers stay where f32 knows them and a half.
    let first = min(max(floor((span.entry / step_size) - (*comb).offset), 0.0), LAST_NODE);
    let last = min(floor((max(leave, 0.0) / step_size) - (*comb).offset), LAST_NODE);
    return select(vec2i(i32(first), i32(last)), vec2i(0, -1), span.entry > leave);
}

// Lays out the nodes of the ray up to its end.
fn new_comb(ray: Ray, end: f32, step_size: f32, block: i32) -> Comb {
    var comb: Comb;
    comb.step = step_size;
    comb.block = block;
    comb.offset = first_node(ray.shift, block);
    comb.end = end;
    comb.first = NO_NODE;
    comb.last = -1;
    for (var medium = 0u; medium < MEDIUM_COUNT; medium++) {
        let runs = find_runs(ray, medium, &comb);
        comb.all[medium] = runs;
        comb.runs[medium] = run_from(runs, 0);
        comb.first = min(comb.first, comb.runs[medium].x);
        comb.last = max(comb.last, i32(max(max(runs.last.x, runs.last.y), max(runs.last.z, runs.last.w))));
        comb.before[medium] = FAR;
        comb.own[medium] = FAR;
    }
    comb.last = min(comb.last, comb.first + (MAX_NODES - 1));
    return comb;
}

// Finds the runs of nodes that may be inside a medium: where the ray passes through cells, or anywhere in the box of a
// medium without cells.
fn find_runs(ray: Ray, medium: u32, comb: ptr<function, Comb>) -> Runs {
    let at = medium_word(medium);
    let spacing = spacing_of(comb, medium);
    var runs = Runs(vec4f(NO_RUN), vec4f(-1.0));
    let whole = node_range(ray, word3(at + 1u), word3(at + 4u), spacing, comb);
    if ((whole.x > whole.y) | (vol_frame_word(at) == 0.0)) {
        return runs;
    }
    let count = u32(vol_frame_word(at + 7u));
    if (count == 0u) {
        return add_run(runs, whole);
    }
    var cell = AT_CELLS + (CELLS_WORDS * medium);
    for (var index = 0u; index < count; index++) {
        let range = node_range(ray, word3(cell), word3(cell + 3u), spacing, comb);
        if (range.x <= range.y) {
            runs = add_run(runs, range);
        }
        cell += CELL_WORDS;
    }
    return runs;
}

// Adds nodes to those that they continue, else as a run of their own; where there are four, to one of them.
fn add_run(before: Runs, nodes: vec2i) -> Runs {
    let range = vec2f(nodes);
    // A node beside each run is looked at as well.
    let continued = (before.first <= vec4f(range.y + 2.0)) & (before.last >= vec4f(range.x - 2.0));
    let own_first = select(vec4f(NO_RUN), before.first, continued);
    let own_last = select(vec4f(-1.0), before.last, continued);
    let first = min(range.x, min(min(own_first.x, own_first.y), min(own_first.z, own_first.w)));
    let last = max(range.y, max(max(own_last.x, own_last.y), max(own_last.z, own_last.w)));
    let kept_first = select(before.first, vec4f(NO_RUN), continued);
    let kept_last = select(before.last, vec4f(-1.0), continued);
    let free = kept_first == vec4f(NO_RUN);
    let place = vec4<bool>(
        free.x,
        free.y & !free.x,
        free.z & !(free.x | free.y),
        !(free.x | free.y | free.z),
    );
    return Runs(
        select(kept_first, min(kept_first, vec4f(first)), place),
        select(kept_last, max(kept_last, vec4f(last)), place),
    );
}

// The nodes of a run from one on: of the first that does not end before it.
fn run_from(runs: Runs, node: i32) -> vec2i {
    let earliest = f32(node);
    let first = select(vec4f(NO_RUN), max(runs.first, vec4f(earliest)), runs.last >= vec4f(earliest));
    let least = min(min(first.x, first.y), min(first.z, first.w));
    let last = select(vec4f(earliest), runs.last, first == vec4f(least));
    let end = i32(max(max(last.x, last.y), max(last.z, last.w)));
    return vec2i(i32(least), select(end, NO_NODE, least == NO_RUN));
}

// The first node to look at: `lead` before the first of a run. More than the last if there is none.
fn start_node(comb: ptr<function, Comb>, lead: i32) -> Node {
    let origin = Node(0, spacing_at(comb, 0), 0);
    var before = origin;
    for (var back = 0; back < lead; back++) {
        before = node_before(comb, before);
    }
    return node_ahead(comb, before, (*comb).first, lead);
}

// The next node to look at, given the one after this: those of runs, and `lead` before each. More than the last if there is none.
fn next_node(comb: ptr<function, Comb>, node: Node, after: Node, lead: i32) -> Node {
    var first = NO_NODE;
    for (var medium = 0u; medium < MEDIUM_COUNT; medium++) {
        if ((*comb).runs[medium].y < after.first) {
            (*comb).runs[medium] = run_from((*comb).all[medium], after.first);
        }
        first = min(first, (*comb).runs[medium].x);
    }
    let next = node_ahead(comb, after, first, lead);
    // Distances say nothing about nodes farther on.
    let is_farther = next.first > after.first;
    (*comb).steps_before = node.steps;
    for (var medium = 0u; medium < MEDIUM_COUNT; medium++) {
        (*comb).before[medium] = select((*comb).before[medium], FAR, is_farther);
        (*comb).own[medium] = select((*comb).own[medium], FAR, is_farther);
    }
    return next;
}
