//! Media against closed forms, on both backends: several that overlap, several lights, each way of
//! lighting, and the phase functions at their peaks.
//!
//! The slabs of [`SLABS`] lie across the view, so that all along a ray is a sum over the pieces between their walls.

mod phases;

use crate::support::{Body, Draw, compile, ensure, frame, on_both, render};
use libtest_mimic::{Failed, Trial};
use std::f64::consts::PI;
use vol_compiler::frame::{Image, Job, Quadrature, Sampling};

/// The trials of this file.
pub(crate) fn trials() -> Vec<Trial> {
    let bodies: [(&str, Body); 10] = [
        ("overlapping_slabs_keep_their_phases", overlapping_slabs_keep_their_phases),
        ("overlapping_slabs_shade_each_other", overlapping_slabs_shade_each_other),
        ("an_object_ends_all_slabs", an_object_ends_all_slabs),
        ("each_medium_has_its_lighting", each_medium_has_its_lighting),
        ("lights_add_up", lights_add_up),
        ("chords_of_a_ball", chords_of_a_ball),
        ("a_furnace_is_invisible", a_furnace_is_invisible),
        ("a_scattering_furnace_is_dark", a_scattering_furnace_is_dark),
        ("light_around_a_lamp", light_around_a_lamp),
        ("light_through_a_lamp_is_finite", light_through_a_lamp_is_finite),
    ];
    let mut trials: Vec<Trial> =
        bodies.into_iter().flat_map(|(name, body)| on_both(&format!("media::{name}"), body)).collect();
    trials.push(Trial::test("media::lights_add_up_on_surfaces", lights_add_up_on_surfaces));
    trials.extend(phases::trials());
    trials
}

/// A camera far away that looks along -z through a narrow angle: rays are nearly parallel.
const FAR_CAMERA: &str = "camera { from: (0, 0, 50), at: (0, 0, 0), fov: 0.2deg }\n";

/// Draws a scene text.
fn draw(draw: &Draw<'_>, text: &str, size: [u32; 2], step: f32) -> Result<Image, Failed> {
    let program = compile("media.vol", text)?;
    let frame = frame(&program, 0.0, size)?;
    draw(
        &program,
        &frame,
        &Job { size, step, shadow_step: step, quadrature: Quadrature::Midpoint, sampling: Sampling::CENTRE },
    )
}

/// Colour and transmittance of the middle pixel.
fn centre(backend: &Draw<'_>, text: &str, step: f32) -> Result<([f64; 3], [f64; 3]), Failed> {
    let pixel = draw(backend, text, [3, 3], step)?.pixels[4];
    Ok((pixel.color.map(f64::from), pixel.transmittance.map(f64::from)))
}

/// Fails unless a number is within a relative error of what it should be.
fn near(name: &str, found: f64, expected: f64, relative: f64) -> Result<(), Failed> {
    ensure((found - expected).abs() <= relative * expected.abs(), || {
        format!("{name}: found {found}, expected {expected} within {relative:e}")
    })
}

/// A slab across the z axis.
struct Slab {
    /// From the wall far from the eye to the near one.
    z: [f64; 2],
    scatter: [f64; 3],
    absorb: [f64; 3],
    emit: [f64; 3],
    /// The phase function in the language, and at a cosine.
    phase: &'static str,
    value: fn(f64) -> f64,
}

/// Half the width of a slab along x; along y it is as wide.
const HALF: f64 = 2.0;

fn henyey_greenstein(g: f64, cosine: f64) -> f64 {
    (1.0 - g * g) / (4.0 * PI * (1.0 + g * g - 2.0 * g * cosine).powf(1.5))
}

/// Two that overlap and one in the dark behind them.
const SLABS: [Slab; 3] = [
    Slab {
        z: [-1.0, 0.2],
        scatter: [0.6, 0.3, 0.1],
        absorb: [0.1, 0.2, 0.9],
        emit: [0.0; 3],
        phase: "henyey_greenstein(0.5)",
        value: |cosine| henyey_greenstein(0.5, cosine),
    },
    Slab {
        z: [-0.4, 0.8],
        scatter: [0.2, 0.5, 0.4],
        absorb: [0.3, 0.0, 0.1],
        emit: [0.01, 0.02, 0.03],
        phase: "rayleigh()",
        value: |cosine| 3.0 / (16.0 * PI) * (1.0 + cosine * cosine),
    },
    Slab {
        z: [-2.0, -1.5],
        scatter: [0.4, 0.4, 0.4],
        absorb: [0.2, 0.1, 0.0],
        emit: [0.05, 0.0, 0.02],
        phase: "double_hg(0.7, -0.3, 0.4)",
        value: |cosine| 0.4 * henyey_greenstein(0.7, cosine) + 0.6 * henyey_greenstein(-0.3, cosine),
    },
];

impl Slab {
    fn text(&self, name: usize, lighting: &str) -> String {
        let Self { z, scatter, absorb, emit, phase, .. } = self;
        let (middle, half) = (0.5 * (z[0] + z[1]), 0.5 * (z[1] - z[0]));
        format!(
            "medium m{name} {{ region: box(({HALF}, {HALF}, {half})).translate((0, 0, {middle})), scatter: {}, \
             absorb: {}, emit: {}, phase: {phase}, lighting: {lighting} }}\n",
            list(*scatter),
            list(*absorb),
            list(*emit),
        )
    }

    fn holds(&self, z: f64) -> bool {
        self.z[0] < z && z < self.z[1]
    }
}

fn list([r, g, b]: [f64; 3]) -> String {
    format!("({r}, {g}, {b})")
}

/// The slabs, all with the same way of lighting.
fn slabs(lighting: &str) -> String {
    SLABS.iter().enumerate().map(|(name, slab)| slab.text(name, lighting)).collect()
}

/// Extinction at a depth.
fn extinction(z: f64, channel: usize) -> f64 {
    SLABS.iter().filter(|slab| slab.holds(z)).map(|slab| slab.scatter[channel] + slab.absorb[channel]).sum()
}

/// Optical depth from the eye down to a depth.
fn optical_depth(z: f64, channel: usize) -> f64 {
    let part = |slab: &Slab| {
        (slab.scatter[channel] + slab.absorb[channel]) * (slab.z[1] - z.max(slab.z[0])).max(0.0)
    };
    SLABS.iter().map(part).sum()
}

/// Radiance and transmittance along -z down to a depth; `source` is what all media at a depth send towards the eye, per
/// length. The midpoint rule over 100 000 parts, which have the walls between them.
fn along(end: f64, channel: usize, source: impl Fn(f64) -> f64) -> (f64, f64) {
    let (parts, top) = (100_000, 1.0);
    let step = (top - end) / f64::from(parts);
    let depth = |part| top - (f64::from(part) + 0.5) * step;
    let sent = (0..parts).map(depth).map(|z| source(z) * (-optical_depth(z, channel)).exp() * step);
    (sent.sum(), (-optical_depth(end, channel)).exp())
}

/// What the slabs at a depth send: their own light, and that of a lamp of irradiance `arriving` which is scattered by an
/// angle of the given cosine.
fn source(z: f64, channel: usize, cosine: f64, arriving: f64) -> f64 {
    let sent = |slab: &Slab| slab.emit[channel] + slab.scatter[channel] * (slab.value)(cosine) * arriving;
    SLABS.iter().filter(|slab| slab.holds(z)).map(sent).sum()
}

/// Light from the side that is weakened by nothing: it turns by the angle whose cosine is -0.8.
fn overlapping_slabs_keep_their_phases(backend: &Draw<'_>) -> Result<(), Failed> {
    let scene = format!("{FAR_CAMERA}light l {{ from: (0.6, 0, 0.8), color: 5 }}\n{}", slabs("unshadowed"));
    let (color, transmittance) = centre(backend, &scene, 0.02)?;
    for channel in 0..3 {
        let (radiance, clear) = along(-3.0, channel, |z| source(z, channel, -0.8, 5.0));
        near("radiance", color[channel], radiance, 1e-3)?;
        near("transmittance", transmittance[channel], clear, 1e-4)?;
    }
    Ok(())
}

/// Light from the eye's side: it comes as far as one sees, and turns around.
fn overlapping_slabs_shade_each_other(backend: &Draw<'_>) -> Result<(), Failed> {
    let scene = format!("{FAR_CAMERA}light l {{ from: (0, 0, 1), color: 5 }}\n{}", slabs("shadowed"));
    let (color, _) = centre(backend, &scene, 0.02)?;
    for (channel, &found) in color.iter().enumerate() {
        // The light's own way is as long as the eye's.
        let arriving = |z: f64| 5.0 * (-optical_depth(z, channel)).exp();
        let (radiance, _) = along(-3.0, channel, |z| source(z, channel, -1.0, arriving(z)));
        near("radiance", found, radiance, 2e-3)?;
    }
    Ok(())
}

/// A surface inside two of the slabs: the part before it counts, and its own colour through that.
fn an_object_ends_all_slabs(backend: &Draw<'_>) -> Result<(), Failed> {
    let scene = format!(
        "{FAR_CAMERA}light l {{ from: (0.6, 0, 0.8), color: 5 }}\n{}\
         object o {{ shape: box((1, 1, 0.1)).translate((0, 0, -0.3)), material: flat((0.3, 0.6, 0.9)) }}",
        slabs("unshadowed")
    );
    let (color, transmittance) = centre(backend, &scene, 0.02)?;
    for channel in 0..3 {
        let (radiance, clear) = along(-0.2, channel, |z| source(z, channel, -0.8, 5.0));
        let surface = 0.3 * (channel as f64 + 1.0);
        near("radiance", color[channel], radiance + clear * surface, 2e-3)?;
        near("transmittance", transmittance[channel], 0.0, 0.0)?;
    }
    Ok(())
}

/// `none` only glows, `unshadowed` sees the lamp in full, `shadowed` through everything on the way: here sideways out
/// of the slabs at its own depth, whatever their own lighting.
fn each_medium_has_its_lighting(backend: &Draw<'_>) -> Result<(), Failed> {
    let lightings = ["shadowed", "none", "unshadowed"];
    let media: String = SLABS
        .iter()
        .zip(lightings)
        .enumerate()
        .map(|(name, (slab, lighting))| slab.text(name, lighting))
        .collect();
    let scene = format!("{FAR_CAMERA}light l {{ from: (1, 0, 0), color: 5 }}\n{media}");
    let (color, _) = centre(backend, &scene, 0.02)?;
    for (channel, &found) in color.iter().enumerate() {
        let sent = |z: f64| {
            let arriving = [5.0 * (-HALF * extinction(z, channel)).exp(), 0.0, 5.0];
            let here = SLABS.iter().zip(arriving).filter(|(slab, _)| slab.holds(z));
            here.map(|(slab, arriving)| {
                slab.emit[channel] + slab.scatter[channel] * (slab.value)(0.0) * arriving
            })
            .sum()
        };
        let (radiance, _) = along(-3.0, channel, sent);
        near("radiance", found, radiance, 2e-3)?;
    }
    Ok(())
}

/// The picture under a distant light and a lamp is the sum of the two.
fn lights_add_up(backend: &Draw<'_>) -> Result<(), Failed> {
    adds_up(backend, "")
}

/// The same with soft shadows on a surface. The shader is a large one: on the CPU only.
fn lights_add_up_on_surfaces() -> Result<(), Failed> {
    let floor =
        "object floor { shape: plane((0, 1, 0), -0.6), material: phong(0, (0.5, 0.4, 0.3), 0.3, 20) }\n";
    adds_up(&|program, frame, job| render(program, frame, job, 2), floor)
}

fn adds_up(backend: &Draw<'_>, surface: &str) -> Result<(), Failed> {
    let shared = format!(
        "camera {{ from: (0, 1, 4), at: (0, 0, 0), fov: 45deg }}\n{surface}\
         medium fog {{ region: sphere(1), density: q => 2 + q.local.y, scatter: (0.5, 0.8, 1), phase: schlick(0.4) }}\n\
         medium haze {{ region: box((2, 0.3, 1)), scatter: 0.4, absorb: (0.3, 0.1, 0), lighting: unshadowed }}\n"
    );
    let sun = "light sun { from: (-0.4, 0.8, 0.3), color: (3, 2.5, 2), spread: 4deg }\n";
    let lamp = "light lamp { at: (0.4, 0.3, 0.5), color: (0.5, 0.7, 1), radius: 0.05 }\n";
    let size = [24, 16];
    let both = draw(backend, &format!("{shared}{sun}{lamp}"), size, 0.05)?;
    let one = draw(backend, &format!("{shared}{sun}"), size, 0.05)?;
    let other = draw(backend, &format!("{shared}{lamp}"), size, 0.05)?;
    for (index, pixel) in both.pixels.iter().enumerate() {
        for channel in 0..3 {
            let sum =
                f64::from(one.pixels[index].color[channel]) + f64::from(other.pixels[index].color[channel]);
            near(&format!("pixel {index}"), f64::from(pixel.color[channel]), sum, 2e-6)?;
        }
    }
    Ok(())
}

/// A homogeneous ball seen from afar: transmittance `exp(-sigma chord)`, radiance `albedo E / (4 pi)` times the rest.
fn chords_of_a_ball(backend: &Draw<'_>) -> Result<(), Failed> {
    let (distance, count) = (50.0, 41_u32);
    let scene = "camera { from: (0, 0, 50), at: (0, 0, 0), fov: 2.4deg }\n\
        light l { from: (1, 2, 3), color: 4 }\n\
        medium ball { region: sphere(1), scatter: 0.9, absorb: 0.6, lighting: unshadowed }\n\
        render { background: 0 }";
    let image = draw(backend, scene, [count, count], 0.02)?;
    let half = 1.2_f64.to_radians().tan();
    for (index, pixel) in image.pixels.iter().enumerate() {
        let place = |i: u32| (2.0 * (f64::from(i) + 0.5) / f64::from(count) - 1.0) * half;
        let (x, y) = (place(index as u32 % count), place(index as u32 / count));
        // Squared distance of the ray from the ball's centre.
        let off = distance * distance * (x * x + y * y) / (1.0 + x * x + y * y);
        let chord = 2.0 * (1.0 - off).max(0.0).sqrt();
        let clear = (-1.5 * chord).exp();
        let lit = 0.9 / 1.5 * 4.0 / (4.0 * PI) * (1.0 - clear);
        let (found, radiance) = (f64::from(pixel.transmittance[0]), f64::from(pixel.color[0]));
        ensure((found - clear).abs() < 2e-3, || format!("pixel {index}: {found} gets through, not {clear}"))?;
        ensure((radiance - lit).abs() < 1e-3, || format!("pixel {index}: {radiance} is seen, not {lit}"))?;
    }
    Ok(())
}

/// A medium as bright as what is behind it cannot be seen, however dense and uneven it is and whatever the step: what
/// it takes away from the background it gives itself.
fn a_furnace_is_invisible(backend: &Draw<'_>) -> Result<(), Failed> {
    let background = [0.7, 0.3, 1.9];
    let absorb = [0.5, 4.0, 30.0];
    let emit: [f64; 3] = std::array::from_fn(|i| background[i] * absorb[i]);
    let scene = format!(
        "camera {{ from: (0, 0, 4), at: (0, 0, 0), fov: 45deg }}\n\
         medium gas {{ region: sphere(1.2), density: q => 3 * max(0, fbm(2 * q.local, 4) + 0.1), scatter: 0, \
         absorb: {}, emit: {} }}\n\
         medium rod {{ region: tube(bezier((-1, -1, 0), (0, 1, 0.5), (1, -1, 0)), radius: 0.3), scatter: 0, \
         absorb: {}, emit: {} }}\nrender {{ background: {} }}",
        list(absorb),
        list(emit),
        list(absorb),
        list(emit),
        list(background),
    );
    for step in [0.02, 0.3] {
        let image = draw(backend, &scene, [32, 24], step)?;
        let dimmed = image.pixels.iter().filter(|pixel| pixel.transmittance[1] < 0.5).count();
        ensure(dimmed > 100, || format!("only {dimmed} pixels look through the media"))?;
        for (index, pixel) in image.pixels.iter().enumerate() {
            for (&found, expected) in pixel.color.iter().zip(background) {
                near(&format!("pixel {index} at step {step}"), f64::from(found), expected, 3e-5)?;
            }
        }
    }
    Ok(())
}

/// A medium that scatters light comes once: with no lamp it only takes away, whatever its albedo.
fn a_scattering_furnace_is_dark(backend: &Draw<'_>) -> Result<(), Failed> {
    let scene = format!(
        "{FAR_CAMERA}light l {{ from: (0, 0, 1), color: 0 }}\n\
         medium m {{ region: box((2, 2, 0.5)), scatter: 2, absorb: 0 }}\nrender {{ background: 0.8 }}"
    );
    near("radiance", centre(backend, &scene, 0.05)?.0[0], 0.8 * (-2.0_f64).exp(), 1e-4)
}

/// Thin gas around a lamp: the integral of `1 / (d^2 + t^2)` along the ray is an angle over the distance `d`.
fn light_around_a_lamp(backend: &Draw<'_>) -> Result<(), Failed> {
    for d in [0.1_f64, 0.4, 0.9] {
        let scene = format!(
            "camera {{ from: (0, 0, 50), at: (0, 0, 0), fov: 0.02deg }}\n\
             light l {{ at: (0, {d}, 0), color: 7 }}\n\
             medium m {{ region: box((2, 2, 1.5)), scatter: 1e-3, lighting: unshadowed }}"
        );
        let angle = 2.0 * (1.5 / d).atan() / d;
        near(&format!("at {d}"), centre(backend, &scene, 0.01)?.0[0], 1e-3 * 7.0 / (4.0 * PI) * angle, 2e-3)?;
    }
    Ok(())
}

/// The ray through the lamp itself, and all around it: finite with every kind of peak, also where a node is the lamp's place.
fn light_through_a_lamp_is_finite(backend: &Draw<'_>) -> Result<(), Failed> {
    let phases = ["isotropic()", "henyey_greenstein(1)", "schlick(-1)", "double_hg(0.9999, -0.9999, 0.5)"];
    for lighting in ["unshadowed", "shadowed"] {
        let medium = |(name, phase): (usize, &&str)| {
            format!("medium m{name} {{ region: sphere(1), phase: {phase}, lighting: {lighting} }}\n")
        };
        let media: String = phases.iter().enumerate().map(medium).collect();
        // Nodes are at 0.025, 0.075 and so on from the eye: one is the very place of the lamp.
        let scene = format!(
            "camera {{ from: (0, 0, 4), at: (0, 0, 0), fov: 30deg }}\n\
             light l {{ at: (0, 0, 0.025), color: 1 }}\n{media}"
        );
        let image = draw(backend, &scene, [9, 9], 0.05)?;
        let finite = |c: &f32| c.is_finite() && *c >= 0.0;
        let wrong = image.pixels.iter().find(|pixel| !pixel.color.iter().all(finite));
        ensure(wrong.is_none(), || format!("{lighting}: {wrong:?}"))?;
        ensure(image.pixels[40].color[0] > image.pixels[0].color[0], || "the lamp is not seen".into())?;
    }
    Ok(())
}
