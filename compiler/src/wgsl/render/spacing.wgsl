// How far apart the nodes of a ray are.
// Twin: runtime-cpu/src/render/spacing.rs, which says why.

// A node, and the steps that it stands for.
struct Node {
    first: i32,
    steps: i32,
    // Among all nodes of the ray.
    number: i32,
}

// The widest spacing of the media: steps of a block.
fn widest_spacing() -> i32 {
    var widest = 1;
    if (SPACED) {
        for (var medium = 0u; medium < MEDIUM_COUNT; medium++) {
            widest = max(widest, i32(vol_frame_word(medium_word(medium) + 8u)));
        }
    }
    return widest;
}

fn spacing_of(comb: ptr<function, Comb>, medium: u32) -> i32 {
    if (SPACED && ((*comb).block > 1)) {
        return i32(vol_frame_word(medium_word(medium) + 8u));
    }
    return 1;
}

// Steps of a node in the block of a step: those of the finest medium that has a run there. Before the first block nodes are as
// in it.
fn spacing_at(comb: ptr<function, Comb>, step: i32) -> i32 {
    var spacing = (*comb).block;
    if (SPACED) {
        let first = max(step, 0) & -spacing;
        let last = f32(first + (spacing - 1));
        for (var medium = 0u; medium < MEDIUM_COUNT; medium++) {
            let runs = (*comb).all[medium];
            let there = any((runs.first <= vec4f(last)) & (runs.last >= vec4f(f32(first))));
            spacing = select(spacing, min(spacing, spacing_of(comb, medium)), there);
        }
    }
    return spacing;
}

// Distance of a node from the origin of the ray: of the middle of its steps.
fn middle_of(comb: ptr<function, Comb>, node: Node) -> f32 {
    return node_distance(node.first, (*comb).step, (*comb).offset + (0.5 * f32(node.steps - 1)));
}

fn is_block_begun(comb: ptr<function, Comb>, step: i32) -> bool {
    return (step & ((*comb).block - 1)) == 0;
}

fn node_after(comb: ptr<function, Comb>, node: Node) -> Node {
    var after = Node(node.first + node.steps, node.steps, node.number + 1);
    if (SPACED && is_block_begun(comb, after.first)) {
        after.steps = spacing_at(comb, after.first);
    }
    return after;
}

fn node_before(comb: ptr<function, Comb>, node: Node) -> Node {
    var steps = node.steps;
    if (SPACED && is_block_begun(comb, node.first)) {
        steps = spacing_at(comb, node.first - 1);
    }
    return Node(node.first - steps, steps, node.number - 1);
}

// The node that stands for a step not before another node, with no run between the blocks of the two.
fn node_at(comb: ptr<function, Comb>, known: Node, step: i32) -> Node {
    if (!SPACED) {
        return Node(step, 1, step);
    }
    let block = (*comb).block;
    let own_end = (known.first | (block - 1)) + 1;
    if (step < own_end) {
        let more = (step - known.first) / known.steps;
        return Node(known.first + (more * known.steps), known.steps, known.number + more);
    }
    let begin = step & -block;
    let steps = spacing_at(comb, step);
    let whole = ((own_end - known.first) / known.steps) + ((begin - own_end) / block);
    let more = (step - begin) / steps;
    return Node(begin + (more * steps), steps, known.number + (whole + more));
}

// The node that is a number of nodes before the one that stands for a step, but none before another; as of node_at.
fn node_ahead(comb: ptr<function, Comb>, earliest: Node, step: i32, lead: i32) -> Node {
    if (!SPACED) {
        let first = max(earliest.first, step - lead);
        return Node(first, 1, first);
    }
    var node = earliest;
    if (step > earliest.first) {
        node = node_at(comb, earliest, step);
        for (var back = 0; back < lead; back++) {
            if (node.number > earliest.number) {
                node = node_before(comb, node);
            }
        }
    }
    return node;
}
