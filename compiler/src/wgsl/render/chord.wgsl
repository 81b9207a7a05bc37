// Short ways of a ray through a medium, between two neighbouring nodes that are outside.
// Twin: runtime-cpu/src/render/chord.rs, which says why.

const CHORD_ROUNDS: u32 = 3u;
const LEAST_SHARE: f32 = 1e-6;

// Two places outside, between which there may be an inside: distance along the ray and signed distance of each.
struct Gap {
    start: vec2f,
    stop: vec2f,
}

// Length that may be inside.
fn gap_room(gap: Gap) -> f32 {
    return (gap.stop.x - gap.start.x) - (gap.start.y + gap.stop.y);
}

fn gap_probe(gap: Gap, round: u32) -> f32 {
    let length = gap.stop.x - gap.start.x;
    let least = LEAST_SHARE * length;
    let touching = (gap.start.y + least) / ((gap.start.y + gap.stop.y) + (least + least));
    return gap.start.x + (length * select(0.5, touching, round == 0u));
}

// What is left after a probe outside.
fn gap_narrowed(gap: Gap, found: vec2f) -> Gap {
    let first = Gap(gap.start, found);
    let second = Gap(found, gap.stop);
    if (gap_room(second) > gap_room(first)) {
        return second;
    }
    return first;
}
