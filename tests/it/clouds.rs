//! Materials of clouds against what they stand for: textures and media written out, closed forms.

use crate::support::{Body, Draw, compile, ensure, frame, on_both};
use libtest_mimic::Failed;
use vol_compiler::frame::{Image, Job, Quadrature, Sampling};

/// The trials of this file.
pub(crate) fn trials() -> Vec<libtest_mimic::Trial> {
    let bodies: [(&str, Body); 6] = [
        ("texture_is_noise_between_colors", texture_is_noise_between_colors),
        ("depth_is_a_medium", depth_is_a_medium),
        ("depth_of_a_slab", depth_of_a_slab),
        ("color_is_a_field", color_is_a_field),
        ("cutoffs_at_the_ends", cutoffs_at_the_ends),
        ("leaves_with_its_object", leaves_with_its_object),
    ];
    bodies.into_iter().flat_map(|(name, body)| on_both(&format!("clouds::{name}"), body)).collect()
}

/// The camera and background of all scenes.
const VIEW: &str =
    "camera { from: (1, 2, 6), at: (0, 0, 0), fov: 30deg }\nrender { background: (0.1, 0.2, 0.3) }\n";

fn picture(draw: &Draw<'_>, text: &str, size: [u32; 2], step: f32) -> Result<Image, Failed> {
    let program = compile("test.vol", text)?;
    let frame = frame(&program, 0.0, size)?;
    draw(
        &program,
        &frame,
        &Job { size, step, shadow_step: 0.1, quadrature: Quadrature::Midpoint, sampling: Sampling::CENTRE },
    )
}

/// Two scenes look alike, and not everywhere the same.
fn same(draw: &Draw<'_>, cloud: &str, written: &str) -> Result<(), Failed> {
    let [cloud_image, written_image] = [
        picture(draw, &format!("{VIEW}{cloud}"), [24, 24], 0.02)?,
        picture(draw, &format!("{VIEW}{written}"), [24, 24], 0.02)?,
    ];
    let mut reds = Vec::new();
    for (a, b) in cloud_image.pixels.iter().zip(&written_image.pixels) {
        let close = |a: f32, b: f32| (a - b).abs() < 2e-5;
        let alike =
            (0..3).all(|i| close(a.color[i], b.color[i]) && close(a.transmittance[i], b.transmittance[i]));
        ensure(alike, || format!("{cloud}: {a:?} instead of {b:?}"))?;
        reds.push(a.color[0]);
    }
    let range = reds.iter().fold([f32::MAX, f32::MIN], |[lo, hi], &red| [lo.min(red), hi.max(red)]);
    ensure(range[1] - range[0] > 0.3, || format!("{cloud}: hardly anything is seen, {range:?}"))
}

/// The noises as a scene could write them, by the words of the cloud.
const TEXTURES: [(&str, &str); 2] = [
    (
        "noise: perlin, frequency: 2, octaves: 3, cutoff: 0.4, offset: (1, 2, 0.5), seed: 7",
        "max(0, min(1, 0.5 + 0.5 * fbm(2 * (q.local + (1, 2, 0.5)), 3, seed: 7)) - 0.4) / 0.6",
    ),
    (
        "noise: gardner, frequency: 0.7, octaves: 6, cutoff: 0.1, offset: (0, 0, 0.5)",
        "max(0, gardner(4.39822972 * (q.local + (0, 0, 0.5)), 6) - 0.1) / 0.9",
    ),
];

fn texture_is_noise_between_colors(draw: &Draw<'_>) -> Result<(), Failed> {
    for (words, amount) in TEXTURES {
        let object = |material: &str| {
            format!("object ball {{ shape: sphere(1).translate((0.2, 0, 0)), material: {material} }}")
        };
        let cloud = object(&format!("cloud_2d((1, 0.9, 0.8), {words}, behind: (0, 0.1, 0.5))"));
        let written = object(&format!(
            "flat(q => vec3(0, 0.1, 0.5) + {amount} * (vec3(1, 0.9, 0.8) - vec3(0, 0.1, 0.5)))"
        ));
        same(draw, &cloud, &written)?;
    }
    Ok(())
}

fn depth_is_a_medium(draw: &Draw<'_>) -> Result<(), Failed> {
    for (words, amount) in TEXTURES {
        let cloud = format!(
            "object ball {{ shape: sphere(1).translate((0.2, 0, 0)), material: cloud_3d((1, 0.9, 0.8), {words}, \
             depth: 0.6, density: 9) }}"
        );
        let left = "clamp(1 - q.depth / 0.6, 0, 1)";
        let written = format!(
            "medium ball {{ region: sphere(1).translate((0.2, 0, 0)), density: q => 9 * {amount} * {left}, \
             scatter: 0, absorb: 1, emit: q => {left} * vec3(1, 0.9, 0.8), lighting: none }}"
        );
        same(draw, &cloud, &written)?;
    }
    Ok(())
}

/// Straight through a slab of thickness 2 a, full of cloud: with `u = 1 - depth / D` the optical depth is
/// `2 s (a - a^2 / 2 D)`. The first half alone glows by `integral of s u^2 c T`.
fn depth_of_a_slab(draw: &Draw<'_>) -> Result<(), Failed> {
    let (density, half, depth) = (1.7, 0.75, 1.25);
    // A cutoff far below 0 leaves the texture out of it.
    let text = format!(
        "camera {{ from: (0, 0, 50), at: (0, 0, 0), fov: 0.2deg }}\nobject slab {{ shape: box((4, 4, {half})), \
         material: cloud_3d((1, 0.5, 0.25), cutoff: -1e7, depth: {depth}, density: {density}) }}\n\
         render {{ background: (0, 0, 1) }}"
    );
    let pixel = picture(draw, &text, [3, 3], 0.004)?.pixels[4];
    let transmittance = f64::exp(-2.0 * density * (half - half * half / (2.0 * depth)));
    // Emission by many small steps.
    const STEPS: usize = 200_000;
    let (mut through, mut glow) = (1.0f64, 0.0f64);
    for i in 0..STEPS {
        let place = 2.0 * half * (i as f64 + 0.5) / STEPS as f64;
        let left = 1.0 - place.min(2.0 * half - place) / depth;
        let step = density * left * 2.0 * half / STEPS as f64;
        glow += through * step * left;
        through *= (-step).exp();
    }
    let expected = [glow, 0.5 * glow, 0.25 * glow + transmittance];
    for (i, expected) in expected.into_iter().enumerate() {
        ensure((f64::from(pixel.color[i]) - expected).abs() < 1e-4, || {
            format!("channel {i} is {} instead of {expected}", pixel.color[i])
        })?;
    }
    ensure((f64::from(pixel.transmittance[0]) - transmittance).abs() < 1e-4, || {
        format!("{} comes through instead of {transmittance}", pixel.transmittance[0])
    })
}

/// Colours follow the place, in depth and on the surface.
fn color_is_a_field(draw: &Draw<'_>) -> Result<(), Failed> {
    let object = |material: &str| format!("object ball {{ shape: sphere(1), material: {material} }}");
    let cloud = object("cloud_2d(q => 0.5 + 0.5 * q.local, cutoff: -1e7)");
    same(draw, &cloud, &object("flat(q => 0.5 + 0.5 * q.local)"))?;
    let cloud = object("cloud_3d(q => 0.5 + 0.5 * q.local, cutoff: -1e7, depth: 1e7, density: 3)");
    let written = "medium ball { region: sphere(1), density: 3, scatter: 0, absorb: 1, \
                   emit: q => 0.5 + 0.5 * q.local, lighting: none }";
    same(draw, &cloud, written)
}

/// No cloud at a cutoff of 1 and above; finite numbers at all of them, and at a density below 0.
fn cutoffs_at_the_ends(draw: &Draw<'_>) -> Result<(), Failed> {
    for cutoff in ["1", "5", "0.99999999", "-1e30"] {
        for (noise, density) in [("perlin", "8"), ("gardner", "-3")] {
            let ball = |x: f32, material: &str| {
                format!(
                    "object o{material} {{ shape: sphere(1).translate(({x}, 0, 0)), material: cloud_{material}"
                )
            };
            let text = format!(
                "{VIEW}{}(1, noise: {noise}, cutoff: {cutoff}) }}\n{}(1, noise: {noise}, cutoff: {cutoff}, density: {density}) }}\n",
                ball(-1.1, "2d"),
                ball(1.1, "3d")
            );
            let image = picture(draw, &text, [24, 12], 0.1)?;
            ensure(image.pixels.iter().all(|pixel| pixel.color.iter().all(|c| c.is_finite())), || {
                text.clone()
            })?;
            let clear = image.pixels.iter().filter(|pixel| pixel.depth.is_infinite());
            let above = cutoff == "1" || cutoff == "5";
            let bright = if above { 0.301 } else { f32::INFINITY };
            ensure(clear.clone().all(|pixel| pixel.color[2] < bright), || {
                format!("a cloud at cutoff {cutoff}")
            })?;
        }
    }
    Ok(())
}

/// A cloud that is switched off is not there, and one that is on weakens the sun behind it.
fn leaves_with_its_object(draw: &Draw<'_>) -> Result<(), Failed> {
    let floor = |when: &str| -> Result<f32, Failed> {
        let text = format!(
            "camera {{ from: (0, 1, 6), at: (0, 0, 0), fov: 2deg }}\nlight sun {{ from: (0, 1, 0), color: 1 }}\n\
             object floor {{ shape: plane((0, 1, 0)), material: phong(0, 1, 0, 1) }}\n\
             object cloud {{ shape: sphere(1).translate((0, 4, 0)), when: {when}, \
             material: cloud_3d(1, cutoff: -1e7, depth: 1e7, density: 0.5) }}"
        );
        Ok(picture(draw, &text, [3, 3], 0.01)?.pixels[4].color[0])
    };
    let (off, on) = (floor("false")?, floor("true")?);
    // Two units of density 1/2.
    let expected = (-1f32).exp();
    ensure((off - 1.0).abs() < 1e-5 && (on - expected).abs() < 1e-3, || format!("{off} and {on}"))
}
