// Optical depth between a light and a point, looked up in the light's grid.
// Twin: runtime-cpu/src/render/light_grid.rs, which says why.

// Depth at a point; `grid` is the word of the grid's record.
fn grid_depth(grid: u32, point: vec3f) -> vec3f {
    // Find the point as the light sees it.
    let origin = word3(grid + 1u);
    let lo = word3(grid + 13u);
    let scale = word3(grid + 16u);
    let counts = word3(grid + 19u);
    let distant = vol_frame_word(grid) != 0.0;
    let off = point - origin;
    let u = dot3(off, word3(grid + 4u));
    let v = dot3(off, word3(grid + 7u));
    let w = dot3(off, word3(grid + 10u));
    let ahead = distant | (w > (0.5 * lo.z));
    let divisor = select(1.0, w, ahead & !distant);
    let seen = vec3f(u / divisor, v / divisor, select(length3(off), w, distant));
    let last = counts - vec3f(1.0);
    let place = (seen - lo) * scale;
    let beside = (place.x < 0.0) | (place.x > last.x) | (place.y < 0.0) | (place.y > last.y);
    // Nothing is before the grid or beside it.
    if (!ahead | beside | (place.z <= 0.0)) {
        return vec3f(0.0);
    }
    // Behind it nothing is added.
    let channels = u32(vol_frame_word(grid + 25u));
    let spline = vol_frame_word(grid + 27u) != 0.0;
    let x = stencil(place.x, last.x, spline);
    let y = stencil(place.y, last.y, spline);
    let z = stencil(min(place.z, last.z), last.z, spline);
    let first = u32(vol_frame_word(grid + 26u));
    let tint = word3(grid + 22u);
    var depth = vec3f(0.0);
    for (var channel = 0u; channel < channels; channel++) {
        depth[channel] = grid_channel(first, x, y, z, i32(counts.y), channel, channels);
    }
    return tint * select(depth, vec3f(depth.x), channels == 1u);
}

// One channel between the points around; what the cubic overshoots below 0 is cut off.
fn grid_channel(
    first: u32,
    x: Stencil,
    y: Stencil,
    z: Stencil,
    columns: i32,
    channel: u32,
    channels: u32,
) -> f32 {
    // Always 4, which no driver knows: unrolled wherever it is asked for, this compiles for minutes.
    let four = min(channels + 3u, 4u);
    // Four sums side by side, which are one vector.
    var sums = vec4f(0.0);
    for (var i = 0u; i < four; i++) {
        for (var j = 0u; j < four; j++) {
            // Before the points of a column and behind them its depths are the first and the last one.
            let column = first + 3u * u32((x.at[i] * columns) + y.at[j]);
            let begin = i32(vol_input_word(column));
            let more = i32(vol_input_word(column + 1u));
            let depths = (first + 4u * u32(vol_input_word(column + 2u))) + channel;
            let row = vec4u(clamp(z.at - vec4i(begin), vec4i(0), vec4i(more))) * channels + depths;
            let around = vec4f(vol_input_word(row.x), vol_input_word(row.y), vol_input_word(row.z), vol_input_word(row.w));
            sums += (x.weights[i] * y.weights[j]) * around;
        }
    }
    let weighted = z.weights * sums;
    return max(((weighted.x + weighted.y) + weighted.z) + weighted.w, 0.0);
}

// The four points around a place along one axis.
struct Stencil {
    // Their numbers; where there is none the last one counts twice.
    at: vec4i,
    weights: vec4f,
}

// `place` in 0..`last`.
fn stencil(place: f32, last: f32, spline: bool) -> Stencil {
    let index = min(floor(place), last - 1.0);
    let t = place - index;
    let local = vec4f(
        (((1.0 - (0.5 * t)) * t) - 0.5) * t,
        ((((1.5 * t) - 2.5) * t) * t) + 1.0,
        (((2.0 - (1.5 * t)) * t) + 0.5) * t,
        (((0.5 * t) - 0.5) * t) * t,
    );
    let back = 1.0 - t;
    let through = vec4f(
        0.16666667 * (back * (back * back)),
        0.6666667 - ((t * t) * (1.0 - (0.5 * t))),
        0.6666667 - ((back * back) * (1.0 - (0.5 * back))),
        0.16666667 * (t * (t * t)),
    );
    let weights = select(local, through, spline);
    let around = vec4i(i32(index)) + vec4i(-1, 0, 1, 2);
    return Stencil(clamp(around, vec4i(0), vec4i(i32(last))), weights);
}
