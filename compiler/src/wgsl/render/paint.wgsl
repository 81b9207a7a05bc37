// The pixels of a picture by a fragment shader: all samples of a pixel at once, without an output buffer.

// A triangle that covers the picture: three vertices, no buffers.
@vertex
fn cover(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    let corner = vec2f(f32((index << 1u) & 2u), f32(index & 2u));
    return vec4f((corner * 2.0) - vec2f(1.0), 0.0, 1.0);
}

// Scene-linear radiance, rows from the top; alpha says how much of what is behind the picture is hidden.
@fragment
fn paint(@builtin(position) place: vec4f) -> @location(0) vec4f {
    let none = Mean(0u, vec3f(0.0), vec3f(0.0), 0.0, 0.0, 0.0, 0.0);
    let mean = sample_pixel(vec2u(place.xy), none, u32(vol_frame_word(AT_SAMPLES)));
    let clear = ((mean.transmittance.x + mean.transmittance.y) + mean.transmittance.z) * (1.0f / 3.0f);
    return vec4f(mean.color, 1.0 - clear);
}
