// A scene without styles; see styled.wgsl.

struct StyledRays {
    none: f32,
}

fn style_rays(ray: Ray, end: f32) -> StyledRays {
    return StyledRays(0.0);
}

fn styled_share(lamp: Arriving, light: u32, rays: ptr<function, StyledRays>, ray: Ray, t: f32) -> f32 {
    return 1.0;
}

fn styled_tint(lamp: Arriving, light: u32, rays: ptr<function, StyledRays>, point: vec3f) -> vec3f {
    return vec3f(1.0);
}
