// The pixels of a picture by a compute shader: one invocation takes samples of one pixel, and the next dispatch goes on
// where it stopped.

@group(0) @binding(5) var<storage, read_write> vol_output: array<u32>;

@compute @workgroup_size(GROUP_WIDTH, GROUP_HEIGHT)
fn render(@builtin(global_invocation_id) id: vec3u) {
    let tile = vec4u(
        u32(vol_frame_word(AT_TILE)),
        u32(vol_frame_word(AT_TILE + 1u)),
        u32(vol_frame_word(AT_TILE + 2u)),
        u32(vol_frame_word(AT_TILE + 3u)),
    );
    if ((id.x >= tile.z) | (id.y >= tile.w)) {
        return;
    }
    let column = tile.x + id.x;
    let row = tile.y + id.y;
    let index = (row * u32(vol_frame_word(AT_SIZE))) + column;
    let pixel = vec2u(column, row);
    // Go on with the pixel where the dispatch before stopped.
    let mean = read_pixel(index);
    let last = min(mean.count + u32(vol_frame_word(AT_BUDGET)), u32(vol_frame_word(AT_SAMPLES)));
    write_pixel(index, sample_pixel(pixel, mean, last));
}

fn read_pixel(index: u32) -> Mean {
    let at = PIXEL_WORDS * index;
    return Mean(
        vol_output[at + 11u],
        vec3f(output_float(at), output_float(at + 1u), output_float(at + 2u)),
        vec3f(output_float(at + 3u), output_float(at + 4u), output_float(at + 5u)),
        output_float(at + 6u),
        output_float(at + 12u),
        output_float(at + 13u),
        output_float(at + 14u),
    );
}

fn output_float(at: u32) -> f32 {
    return bitcast<f32>(vol_output[at]);
}

// Counts of dispatches are added up in whole numbers: with many samples they leave the 24 bits of a
// float.
fn write_pixel(index: u32, mean: Mean) {
    let at = PIXEL_WORDS * index;
    vol_output[at] = bitcast<u32>(mean.color.x);
    vol_output[at + 1u] = bitcast<u32>(mean.color.y);
    vol_output[at + 2u] = bitcast<u32>(mean.color.z);
    vol_output[at + 3u] = bitcast<u32>(mean.transmittance.x);
    vol_output[at + 4u] = bitcast<u32>(mean.transmittance.y);
    vol_output[at + 5u] = bitcast<u32>(mean.transmittance.z);
    vol_output[at + 6u] = bitcast<u32>(mean.depth);
    vol_output[at + 7u] += counted_rays;
    vol_output[at + 8u] += counted_samples;
    vol_output[at + 9u] += counted_evaluations;
    vol_output[at + 10u] += counted_camera_rays;
    vol_output[at + 11u] = mean.count;
    vol_output[at + 12u] = bitcast<u32>(mean.color_spread);
    vol_output[at + 13u] = bitcast<u32>(mean.transmittance_spread);
    vol_output[at + 14u] = bitcast<u32>(mean.doubt);
}
