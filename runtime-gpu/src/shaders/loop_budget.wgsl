// Steps a linear congruential generator turns[0] times: the result is right only if no turn was left out.
@group(0) @binding(0) var<storage, read> turns: array<u32>;
@group(0) @binding(1) var<storage, read_write> last: array<u32>;

@compute @workgroup_size(1)
fn main() {
    var state = 0u;
    for (var turn = 0u; turn < turns[0]; turn += 1u) {
        state = (state * 1664525u) + 1013904223u;
    }
    last[0] = state;
}
