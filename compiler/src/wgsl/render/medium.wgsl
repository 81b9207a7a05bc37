// What media along a ray add and take away.
// Twin: runtime-cpu/src/render/medium.rs, which says why.

// A medium at a point: density, and per unit of it.
struct Interior {
    density: f32,
    scattering: vec3f,
    extinction: vec3f,
    emission: vec3f,
}

struct Glow {
    light: vec3f,
    transmittance: vec3f,
    // The same two by every other node.
    coarse_light: vec3f,
    coarse_transmittance: vec3f,
}

fn clear_glow() -> Glow {
    return Glow(vec3f(0.0), vec3f(1.0), vec3f(0.0), vec3f(1.0));
}

// Light that a node or panel sends, and its optical depth.
struct Chunk {
    sent: vec3f,
    depth: vec3f,
}

// Adds a node or panel to those before it.
fn gather(before: Glow, node: i32, chunk: Chunk) -> Glow {
    var glow = before;
    let decay = decay3(chunk.depth);
    glow.light += glow.transmittance * chunk.sent;
    glow.transmittance = glow.transmittance * decay;
    // Of twice the matter: (1 - exp(-2x)) / x is (1 - exp(-x)) / x times 1 + exp(-x).
    if ((node % 2) == 0) {
        let twice = chunk.sent * (vec3f(1.0) + decay);
        glow.coarse_light += glow.coarse_transmittance * twice;
        glow.coarse_transmittance = glow.coarse_transmittance * (decay * decay);
    }
    return glow;
}
