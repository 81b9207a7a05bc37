// Doubles each word: the example of device.rs.
@group(0) @binding(0) var<storage, read> numbers: array<u32>;
@group(0) @binding(1) var<storage, read_write> doubled: array<u32>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    if (id.x < arrayLength(&doubled)) {
        doubled[id.x] = numbers[id.x] * 2u;
    }
}
