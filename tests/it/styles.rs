//! Styles: shafts against sums that know where the light is, operators against solids that are as they make them, and
//! colours by their formulas; on both backends.

use crate::support::{Body, Draw, compile, ensure, on_both};
use libtest_mimic::{Failed, Trial};
use std::f64::consts::PI;
use vol::compare::color_error;
use vol_compiler::frame::styled::Occluders;
use vol_compiler::frame::{CameraFrame, Frame, Image, Job, Quadrature, Sampling};
use vol_compiler::program::Program;
use vol_compiler::skip::Skips;
use vol_runtime_cpu::style::{self, FittedMap, Picture};

/// The trials of this file.
pub(crate) fn trials() -> Vec<Trial> {
    let bodies: [(&str, Body); 15] = [
        ("shafts_below_a_roof", shafts_below_a_roof),
        ("shafts_around_the_light", shafts_around_the_light),
        ("exact_and_mapped_shafts_agree", exact_and_mapped_shafts_agree),
        ("transfer_replaces_visibility", transfer_replaces_visibility),
        ("transfer_reads_depth", transfer_reads_depth),
        ("closing_fills_a_hole", closing_fills_a_hole),
        ("silhouettes_grow_away_from_the_eye", silhouettes_grow_away_from_the_eye),
        ("operators_are_for_the_objects_named", operators_are_for_the_objects_named),
        ("surfaces_keep_their_shadows", surfaces_keep_their_shadows),
        ("heterogeneity_is_painted", heterogeneity_is_painted),
        ("known_means_are_near_those_of_rays", known_means_are_near_those_of_rays),
        ("light_maps_meet_their_strokes", light_maps_meet_their_strokes),
        ("white_strokes_leave_a_white_map", white_strokes_leave_a_white_map),
        ("all_parts_together", all_parts_together),
        ("all_looks_of_the_scenes", all_looks_of_the_scenes),
    ];
    let both = bodies.into_iter().flat_map(|(name, body)| on_both(&format!("styles::{name}"), body));
    let own = [
        Trial::test("styles::holes_are_as_many_as_asked_for", holes_are_as_many_as_asked_for),
        Trial::test("styles::holes_move", holes_move),
        Trial::test("styles::operators_apply_in_their_order", operators_apply_in_their_order),
        Trial::test("styles::nothing_styled_changes_nothing", nothing_styled_changes_nothing),
        Trial::test("styles::awkward_numbers_stay_finite", awkward_numbers_stay_finite),
    ];
    both.chain(own).collect()
}

/// A scene with its styles prepared, and how it is drawn.
struct Scene {
    program: Program,
    frame: Frame,
    job: Job,
    maps: Vec<FittedMap>,
}

impl Scene {
    fn new(text: &str, size: [u32; 2]) -> Result<Self, Failed> {
        Self::at(text, size, 0.0, &[])
    }

    fn at(text: &str, size: [u32; 2], time: f64, images: &[Picture]) -> Result<Self, Failed> {
        let program = compile("test.vol", text)?;
        let frame = program.frame(&program.default_params(), time, 0.0, size);
        let mut frame = frame.map_err(|diagnostic| diagnostic.message)?;
        let prepared = style::prepare(&program, &frame, size, images, &|_| None);
        let prepared = prepared.map_err(|diagnostic| diagnostic.message)?;
        frame.styled_lights = prepared.lights;
        let quadrature = Quadrature::Midpoint;
        let job = Job { size, step: 0.02, shadow_step: 0.02, quadrature, sampling: Sampling::CENTRE };
        Ok(Self { program, frame, job, maps: prepared.light_maps })
    }

    fn draw(&self, draw: &Draw<'_>) -> Result<Image, Failed> {
        draw(&self.program, &self.frame, &self.job)
    }
}

fn drawn(draw: &Draw<'_>, text: &str, size: [u32; 2]) -> Result<Image, Failed> {
    Scene::new(text, size)?.draw(draw)
}

#[track_caller]
fn near(what: &str, found: f64, wanted: f64, most: f64) -> Result<(), Failed> {
    ensure((found - wanted).abs() <= most, || format!("{what}: {found}, expected {wanted} within {most}"))
}

/// Relative rms of the difference of two pictures at most.
fn alike(what: &str, a: &Image, b: &Image, most: f64) -> Result<(), Failed> {
    let error = color_error(a, b);
    ensure(error <= most, || format!("{what}: relative rms {error:e} instead of {most:e}"))
}

/// Air up to y = 1 with a roof above it for x > 0, the light straight above.
const ROOF: &str = "object roof { shape: box((5, 0.1, 10)).translate((5, 2, 0)) }\n\
     light sun { from: (0, 1, 0), color: 5 }\n\
     medium air { region: box((4, 1, 4)), scatter: 0.2, absorb: 0.1 }\n";

/// Direction of the ray through the middle of a pixel.
fn direction(camera: &CameraFrame, size: [u32; 2], pixel: [u32; 2]) -> [f64; 3] {
    let at = [0, 1].map(|axis| 2.0 * (f64::from(pixel[axis]) + 0.5) / f64::from(size[axis]) - 1.0);
    let along = |i: usize| {
        f64::from(camera.forward[i]) + at[0] * f64::from(camera.right[i]) - at[1] * f64::from(camera.up[i])
    };
    let toward = [along(0), along(1), along(2)];
    let length = toward.iter().map(|x| x * x).sum::<f64>().sqrt();
    toward.map(|x| x / length)
}

/// Light that the air of [`ROOF`] sends along a ray, and the part of the ray in it that is lit: sums of so many terms that
/// nothing is left to doubt.
fn under_the_roof(origin: [f32; 3], direction: [f64; 3], is_lit: impl Fn([f64; 3]) -> bool) -> (f64, f64) {
    const STEPS: usize = 200_000;
    const LENGTH: f64 = 16.0;
    let step = LENGTH / STEPS as f64;
    let (mut light, mut depth, mut inside, mut lit) = (0.0, 0.0, 0.0, 0.0);
    for i in 0..STEPS {
        let t = (i as f64 + 0.5) * step;
        let p: [f64; 3] = std::array::from_fn(|axis| f64::from(origin[axis]) + t * direction[axis]);
        if p[0].abs() < 4.0 && p[1].abs() < 1.0 && p[2].abs() < 4.0 {
            inside += step;
            if is_lit(p) {
                lit += step;
                let arrives = 5.0 * (-0.3 * (1.0 - p[1])).exp();
                light += 0.2 / (4.0 * PI) * arrives * (-depth - 0.15 * step).exp() * step;
            }
            depth += 0.3 * step;
        }
    }
    (light, if inside > 0.0 { lit / inside } else { 1.0 })
}

/// Eq. 1 of the paper, with the light's way through the air.
fn shafts_below_a_roof(draw: &Draw<'_>) -> Result<(), Failed> {
    let size = [9, 6];
    let cameras = [
        "camera { from: (-3, 0, 0), at: (1, 0, 0), fov: 50deg }",
        "camera { from: (0.5, -0.3, 9), at: (0, 0, 0), fov: 40deg }",
        "camera { from: (-2, 8, 3), at: (0, 0, 0), fov: 40deg }",
    ];
    for camera in cameras {
        for shafts in ["mapped", "exact"] {
            let style = format!("style plain {{ light: sun, shafts: {shafts} }}\n{camera}");
            let scene = Scene::new(&format!("{ROOF}{style}"), size)?;
            let picture = scene.draw(draw)?;
            for (index, pixel) in picture.pixels.iter().enumerate() {
                let place = [index as u32 % size[0], index as u32 / size[0]];
                let toward = direction(&scene.frame.camera, size, place);
                if pixel.depth.is_finite() {
                    continue;
                }
                let (wanted, _) = under_the_roof(scene.frame.camera.origin, toward, |p| p[0] < 0.0);
                let found = f64::from(pixel.color[0]);
                // The edge lies within a texel each of the map and of its slices; a ray crosses it at a slant.
                let off = if shafts == "mapped" { 2.0 * 8.0 / 1022.0 / toward[0].abs() } else { 0.0 };
                let most = 1e-3 * wanted + 2e-4 + 0.08 * off;
                near(&format!("{camera} {shafts} {place:?}"), found, wanted, most)?;
            }
        }
    }
    Ok(())
}

/// The light in the picture: slices meet at its place, and rays along it stay in one texel.
fn shafts_around_the_light(draw: &Draw<'_>) -> Result<(), Failed> {
    let size = [11, 11];
    for camera in [
        "camera { from: (0.3, -0.9, 0.2), at: (0.3, 3, 0.2), up: (0, 0, 1), fov: 60deg }",
        "camera { from: (-0.3, 0.9, 0.2), at: (-0.3, -3, 0.2), up: (0, 0, 1), fov: 60deg }",
    ] {
        let style = format!("style plain {{ light: sun, shadow_map: 2048 }}\n{camera}");
        let scene = Scene::new(&format!("{ROOF}{style}"), size)?;
        let picture = scene.draw(draw)?;
        for (index, pixel) in picture.pixels.iter().enumerate() {
            let place = [index as u32 % size[0], index as u32 / size[0]];
            let toward = direction(&scene.frame.camera, size, place);
            let (wanted, _) = under_the_roof(scene.frame.camera.origin, toward, |p| p[0] < 0.0);
            if pixel.depth.is_infinite() {
                let found = f64::from(pixel.color[0]);
                near(&format!("{camera} {place:?}"), found, wanted, 1e-3)?;
            }
        }
    }
    Ok(())
}

/// Something with gaps, edges and round sides.
const GATE: &str = "object gate { shape: box((1.2, 0.9, 0.1)) - cylinder(0.3, 1).rotate_x(90deg) - box((0.2, 2, 1)).translate((0.8, 0, 0)) }\n\
     object ball { shape: sphere(0.3).translate((-1, 0.9, 0.6)) }\n\
     light sun { from: (0.3, 0.7, -0.8), color: 5 }\n\
     medium air { region: box((2, 1.5, 2)), scatter: 0.2, absorb: 0.02, phase: henyey_greenstein(0.4) }\n\
     camera { from: (0.5, 0.2, 5), at: (0, 0, 0), fov: 40deg }\n";

fn exact_and_mapped_shafts_agree(draw: &Draw<'_>) -> Result<(), Failed> {
    let size = [32, 24];
    let picture = |shafts: &str| drawn(draw, &format!("{GATE}style plain {{ light: sun, {shafts} }}"), size);
    let exact = picture("shafts: exact")?;
    alike("coarse map", &exact, &picture("shadow_map: 256")?, 1e-2)?;
    alike("fine map", &exact, &picture("shadow_map: 2048")?, 2e-3)?;
    // Without a style every sample asks for itself, so that the step is seen.
    alike("no style", &exact, &drawn(draw, GATE, size)?, 1e-2)
}

/// Eq. 2: a transfer function that is the visibility itself gives the light without shadows times its average.
fn transfer_replaces_visibility(draw: &Draw<'_>) -> Result<(), Failed> {
    let size = [9, 6];
    let camera = "camera { from: (-3, 0, 0), at: (1, 0, 0), fov: 50deg }";
    let transfer = "transfer: [gradient((0, 0), rgb(0.1, 0, 1), (1, 0), rgb(1, 1, 0))]";
    let scene = Scene::new(&format!("{ROOF}style tinted {{ light: sun, {transfer} }}\n{camera}"), size)?;
    for (index, pixel) in scene.draw(draw)?.pixels.iter().enumerate() {
        let toward = direction(&scene.frame.camera, size, [index as u32 % size[0], index as u32 / size[0]]);
        let origin = scene.frame.camera.origin;
        let (free, _) = under_the_roof(origin, toward, |_| true);
        let (_, visible) = under_the_roof(origin, toward, |p| p[0] < 0.0);
        let wanted = [0.1 + 0.9 * visible, visible, 1.0 - visible].map(|c| c * free);
        for (found, wanted) in pixel.color.iter().zip(wanted) {
            near(&format!("pixel {index}"), f64::from(*found), wanted, 2e-3 * free)?;
        }
    }
    Ok(())
}

fn transfer_reads_depth(draw: &Draw<'_>) -> Result<(), Failed> {
    let steps = "transfer: [gradient((0, 0), #000000, (0, 1), #ffffff)], depth_range: (1, 9)";
    let text = |style: &str| {
        format!(
            "object wall {{ shape: box((9, 9, 0.5)), material: diffuse(0) }}\n\
             light sun {{ from: (1, 0, 1), color: 1, shadows: false }}\n\
             medium air {{ region: box((1, 1, 1)).translate((0, 0, 3)), scatter: 0.1 }}\n\
             camera {{ from: (0, 0, 5), at: (0, 0, 0), fov: 1deg }}\n{style}"
        )
    };
    let [styled, free] = [format!("style deep {{ light: sun, {steps} }}"), String::new()];
    let [styled, free] = [drawn(draw, &text(&styled), [1, 1])?, drawn(draw, &text(&free), [1, 1])?];
    // The wall is at depth 4.5.
    let share = f64::from(styled.pixels[0].color[0] / free.pixels[0].color[0]);
    near("colour at the depth of the wall", share, (4.5 - 1.0) / 8.0, 1e-3)
}

/// A roof over all of the air, with a hole.
fn pierced(hole: &str, style: &str) -> String {
    format!(
        "object roof {{ shape: box((5, 0.1, 5)).translate((0, 2, 0)){hole} }}\n\
         light sun {{ from: (0.1, 1, 0.2), color: 5 }}\n\
         medium air {{ region: box((2, 1, 2)), scatter: 0.2 }}\n\
         camera {{ from: (0, -0.5, 6), at: (0, 0, 0), fov: 40deg }}\n{style}"
    )
}

const HOLE: &str = " - cylinder(0.2, 1).translate((0, 2, 0))";

/// A hole is 0.4 wide, which is about 50 texels of 512 over 4 units.
fn closing_fills_a_hole(draw: &Draw<'_>) -> Result<(), Failed> {
    let size = [24, 16];
    let picture = |style: &str| {
        let style = format!("style plain {{ light: sun, shadow_map: 512, {style} }}");
        drawn(draw, &pierced(HOLE, &style), size)
    };
    let brightest = |image: &Image| image.pixels.iter().map(|pixel| pixel.color[0]).fold(0.0, f32::max);
    ensure(brightest(&picture("shafts: mapped")?) > 1e-3, || "there is no shaft".into())?;
    for closing in ["disk(70)", "epipolar(70)"] {
        let found = brightest(&picture(&format!("fill_holes: {closing}"))?);
        ensure(found < 1e-6, || format!("{closing} leaves {found}"))?;
    }
    // A kernel that is smaller than the hole opens it again.
    alike("a small disk", &picture("fill_holes: disk(5)")?, &picture("shafts: mapped")?, 2e-2)
}

/// Eq. 3 against a fan of copies of the solid, each further from the eye.
fn silhouettes_grow_away_from_the_eye(draw: &Draw<'_>) -> Result<(), Failed> {
    let size = [40, 30];
    let text = |copies: usize, style: &str| {
        format!(
            "object plate {{ shape: union([for i in 0..{copies}: box((0.25, 0.2, 0.02)).translate((0.1, 0.5, -2)).scale(1 + 0.004 * i)]) }}\n\
             light sun {{ from: (0, 1, 0), color: 5 }}\n\
             medium air {{ region: box((2, 1, 2)).translate((0, 0, -2)), scatter: 0.2 }}\n\
             camera {{ from: (0, 0, 0), at: (0, 0, -1), fov: 60deg }}\n\
             style grown {{ light: sun, shadow_map: 1024, {style} }}"
        )
    };
    // 125 steps of 0.4 %: up to half as far again, which from a distance of 2.05 is 1.03.
    let solid = drawn(draw, &text(126, "shafts: exact"), size)?;
    // A map on which solids may grow has other texels than one on which they do not.
    let map = Scene::new(&text(1, "enhance_silhouettes: 0"), size)?;
    let texels = match map.frame.styled_lights[0].as_ref().map(|light| &light.occluders) {
        Some(Occluders::Slices(slices)) => 1.03 * slices.per_unit,
        other => return Err(format!("no slices, but {other:?}").into()),
    };
    let grown = drawn(draw, &text(1, &format!("enhance_silhouettes: {texels}")), size)?;
    // Of the pixels that see no solid, the share that is not alike.
    let before = map.draw(draw)?;
    let share = |image: &Image| {
        let pairs = image.pixels.iter().zip(&solid.pixels);
        let open = pairs.filter(|(a, b)| a.depth.is_infinite() && b.depth.is_infinite());
        let (mut others, mut all) = (0, 0);
        for (a, b) in open {
            all += 1;
            others += usize::from((a.color[0] - b.color[0]).abs() > 0.03 * b.color[0]);
        }
        others as f64 / f64::from(all)
    };
    // Edges of copies are a texel or two off.
    let shares = [share(&grown), share(&before)];
    ensure(shares[0] < 0.02 && shares[1] > 0.06, || format!("{shares:?} off the copies, grown and before"))
}

fn operators_are_for_the_objects_named(draw: &Draw<'_>) -> Result<(), Failed> {
    let size = [24, 16];
    let picture = |name: &str, style: &str| {
        let more = "object far { shape: sphere(0.01).translate((0, 2, 0)) }\n";
        let style = format!("{more}style plain {{ light: sun, shadow_map: 512, {style} }}");
        let hole = if name == "whole" { "" } else { HOLE };
        drawn(draw, &pierced(hole, &style), size)
    };
    let plain = picture("pierced", "shafts: mapped")?;
    let other = picture("pierced", "fill_holes: disk(70, only: [far])")?;
    alike("closing of another object", &plain, &other, 1e-6)?;
    let own = picture("pierced", "fill_holes: disk(70, only: [roof])")?;
    alike("closing of the roof", &picture("whole", "shafts: mapped")?, &own, 1e-6)?;
    // All of the roof is cut away, and what is below it stays.
    let cut = picture("whole", "make_holes: { threshold: 100, only: [roof] }")?;
    let free = pierced("", "style plain { light: sun }").replace("(5, 0.1, 5)", "(0.001, 0.001, 0.001)");
    alike("a roof that is all hole", &cut, &drawn(draw, &free, size)?, 2e-2)
}

fn surfaces_keep_their_shadows(draw: &Draw<'_>) -> Result<(), Failed> {
    let size = [24, 16];
    let text = |style: &str| {
        pierced(HOLE, style).replace("scatter: 0.2", "scatter: 1e-12")
            + "\nobject floor { shape: box((30, 0.1, 30)).translate((0, -0.9, 0)) }"
    };
    let plain = drawn(draw, &text(""), size)?;
    let cut = drawn(draw, &text("style s { light: sun, make_holes: { threshold: 100 } }"), size)?;
    let lit = plain.pixels.iter().filter(|pixel| pixel.color[0] > 0.1).count();
    ensure(lit > 10 && lit < plain.pixels.len(), || format!("{lit} pixels are lit"))?;
    alike("surfaces", &plain, &cut, 1e-6)
}

fn heterogeneity_is_painted(draw: &Draw<'_>) -> Result<(), Failed> {
    let size = [8, 6];
    let text = |style: &str| {
        let style =
            if style.is_empty() { String::new() } else { format!("style v {{ light: sun, {style} }}") };
        format!("{ROOF}camera {{ from: (-3, 0, 0), at: (1, 0, 0), fov: 50deg }}\n{style}")
    };
    let picture = |settings: &str| drawn(draw, &text(&format!("heterogeneity: {{ {settings} }}")), size);
    let plain = drawn(draw, &text("shafts: mapped"), size)?;
    alike("no amount", &plain, &picture("amount: 0")?, 1e-6)?;
    let times = |factor: f32| {
        let mut image = plain.clone();
        image.pixels.iter_mut().for_each(|pixel| pixel.color = pixel.color.map(|c| factor * c));
        image
    };
    let everywhere = "(0, 0, 0), 1e4, hardness: 1";
    let brushed = picture(&format!("brushes: [brush({everywhere}, intensity: 3)]"))?;
    alike("three times as intense", &times(3.0), &brushed, 1e-5)?;
    let half = picture(&format!("brushes: [brush({everywhere}, intensity: 3, opacity: 0.5)]"))?;
    alike("half of that", &times(2.0), &half, 1e-5)?;
    let erased = picture(&format!("brushes: [brush({everywhere}, intensity: 3), eraser({everywhere})]"))?;
    alike("erased", &plain, &erased, 1e-5)?;
    // A brush of full amount is what an amount of 1 without brushes is.
    let noise = picture("frequency: 2")?;
    alike("noise", &noise, &picture(&format!("frequency: 2, brushes: [brush({everywhere})]"))?, 1e-5)?;
    ensure(color_error(&plain, &noise) > 0.1, || "the noise does nothing".into())?;
    let finer = format!("frequency: 2, octaves: 3, amount: 1, brushes: [brush({everywhere}, frequency: 2)]");
    let four = picture("frequency: 2, octaves: 4")?;
    ensure(color_error(&four, &picture(&finer)?) < 0.05, || "twice the frequency is an octave more".into())
}

fn known_means_are_near_those_of_rays(draw: &Draw<'_>) -> Result<(), Failed> {
    let picture = |upsample: u32, size: [u32; 2]| {
        let style = format!(
            "style v {{ light: sun, heterogeneity: {{ frequency: 0.7, octaves: 2, upsample: {upsample} }} }}"
        );
        drawn(draw, &format!("{GATE}{style}"), size)
    };
    let (small, large) = ([48, 36], [96, 72]);
    let (all_small, all_large) = (picture(1, small)?, picture(1, large)?);
    alike("every fourth", &all_large, &picture(4, large)?, 1.5e-2)?;
    alike("every sixteenth", &all_large, &picture(16, large)?, 9e-2)?;
    let errors = [color_error(&all_small, &picture(4, small)?), color_error(&all_large, &picture(4, large)?)];
    ensure(errors[1] < 0.6 * errors[0], || format!("{errors:?} do not fall"))
}

/// A stroke across a lit part and one across another.
const STROKES: &str = "light_map: paint(size: 128, strokes: [\n\
     stroke(camera, (8, 10), (8, 50), 6, rgb(1, 0.1, 0.1)),\n\
     stroke(view(from: (0.5, 0.2, 5), at: (0, 0, 0)), (56, 10), (56, 50), 6, rgb(0.1, 0.1, 1)),\n\
     ])";

fn light_maps_meet_their_strokes(draw: &Draw<'_>) -> Result<(), Failed> {
    let size = [64, 64];
    let text = |style: &str| format!("{GATE}render {{ size: (64, 64) }}\nstyle m {{ light: sun, {style} }}");
    let scene = Scene::new(&text(STROKES), size)?;
    let fit = scene.maps.first().and_then(|map| map.fit.as_ref()).ok_or("there is no fit")?;
    ensure(fit.residual < 0.1, || format!("residual {}", fit.residual))?;
    let (painted, white) = (scene.draw(draw)?, drawn(draw, &text("shafts: mapped"), size)?);
    let ratio = |[x, y]: [usize; 2]| {
        let at = y * 64 + x;
        [0, 1, 2].map(|i| f64::from(painted.pixels[at].color[i] / white.pixels[at].color[i]))
    };
    for (pixel, wanted) in [([8, 30], [1.0, 0.1, 0.1]), ([56, 30], [0.1, 0.1, 1.0])] {
        for (found, wanted) in ratio(pixel).into_iter().zip(wanted) {
            near(&format!("colour at {pixel:?}"), found, wanted, 0.12)?;
        }
    }
    // Half as large a picture has its strokes at half the pixels.
    let small = Scene::new(&text(STROKES), [32, 32])?;
    let apart = |a: &FittedMap, b: &FittedMap| {
        let pairs = a.table.texels.iter().flatten().zip(b.table.texels.iter().flatten());
        (pairs.map(|(a, b)| f64::from(a - b).powi(2)).sum::<f64>() / (3.0 * 128.0 * 128.0)).sqrt()
    };
    let apart = apart(&scene.maps[0], &small.maps[0]);
    ensure(apart < 0.1, || format!("maps of two sizes are {apart} apart"))
}

fn white_strokes_leave_a_white_map(_: &Draw<'_>) -> Result<(), Failed> {
    let stroke = "light_map: paint(size: 64, strokes: [stroke(camera, (8, 10), (8, 50), 6, #ffffff)])";
    let text = format!("{GATE}render {{ size: (64, 64) }}\nstyle m {{ light: sun, {stroke} }}");
    let scene = Scene::new(&text, [64, 64])?;
    let texels = &scene.maps[0].table.texels;
    ensure(texels.iter().flatten().all(|c| (c - 1.0).abs() < 1e-4), || "the map is not white".into())
}

fn all_parts_together(draw: &Draw<'_>) -> Result<(), Failed> {
    let style = format!(
        "style all {{\n light: sun\n shadow_map: 300\n fill_holes: disk(5, only: [gate])\n enhance_silhouettes: 20\n\
         make_holes: {{ frequency: 0.2, only: [gate], phase: 0.1 }}\n\
         transfer: [solid(#ffffff), diffusion([((0.2, 0.5), rgb(1, 0.2, 0)), (at: (-1, 0.9, 0.6), rgb(0, 0.3, 1))])]\n\
         {STROKES}\n heterogeneity: {{ frequency: 2, upsample: 4 }} }}"
    );
    let scene = Scene::new(&format!("{GATE}render {{ size: (64, 64) }}\n{style}"), [32, 24])?;
    let on_cpu = crate::support::render(&scene.program, &scene.frame, &scene.job, 1)?;
    alike("both backends", &on_cpu, &scene.draw(draw)?, 1e-5)?;
    let job = Job { quadrature: Quadrature::Corrected, ..scene.job };
    alike("both quadratures", &on_cpu, &draw(&scene.program, &scene.frame, &job)?, 1e-2)
}

/// Every look of every scene of examples/styles, alike on both backends and different from its neighbour.
fn all_looks_of_the_scenes(draw: &Draw<'_>) -> Result<(), Failed> {
    let size = [32, 18];
    let looks = [("tree", 8), ("palm", 4), ("scarecrow", 3), ("flowerbed", 3), ("turtle", 6), ("citadel", 7)];
    for (name, last) in looks {
        let path = format!("{}/examples/styles/{name}.vol", env!("CARGO_MANIFEST_DIR"));
        let session =
            vol::session::load(path.as_ref(), Skips::ALL).map_err(|failure| format!("{failure:?}"))?;
        let mut before: Option<Image> = None;
        for look in 0..=last {
            let set = [("look".to_owned(), look.to_string())];
            let params = session.params(&set).map_err(|failure| format!("{failure:?}"))?;
            let frame = session.program.frame(&params, 1.0, 0.0, size);
            let mut frame = frame.map_err(|diagnostic| diagnostic.message)?;
            let prepared = style::prepare(&session.program, &frame, size, &session.pictures, &|_| None);
            frame.styled_lights = prepared.map_err(|diagnostic| diagnostic.message)?.lights;
            let (quadrature, sampling) = (Quadrature::Midpoint, Sampling::CENTRE);
            let job = Job { size, step: 0.25, shadow_step: 0.5, quadrature, sampling };
            let on_cpu = crate::support::render(&session.program, &frame, &job, 2)?;
            alike(&format!("{name} {look}"), &on_cpu, &draw(&session.program, &frame, &job)?, 1e-4)?;
            if let Some(before) = before.replace(on_cpu.clone()) {
                let error = color_error(&on_cpu, &before);
                ensure(error > 1e-3, || format!("looks {look} and the one before of {name} are the same"))?;
            }
        }
    }
    Ok(())
}

/// Share of the slices' texels within the map that are open.
fn open_share(style: &str) -> Result<f64, Failed> {
    let text = pierced("", &format!("style s {{ light: sun, shadow_map: 256, {style} }}"));
    let scene = Scene::new(
        &text.replace("(0.1, 1, 0.2)", "(0, 1, 0)").replace("(0, -0.5, 6)", "(0.01, -0.5, 0)"),
        [8, 8],
    )?;
    let Some(Occluders::Slices(slices)) =
        scene.frame.styled_lights[0].as_ref().map(|light| light.occluders.clone())
    else {
        return Err("there are no slices".into());
    };
    // Each texel counts by its distance from the eye, as its area does; a map's corners are further away than its sides.
    let reach = (2.0 * slices.per_unit) as usize;
    let (mut open, mut all) = (0.0, 0.0);
    for slice in slices.slopes.chunks(slices.columns as usize) {
        for (column, &slope) in slice.iter().enumerate().take(reach - 4) {
            let area = column as f64 + 0.5;
            all += area;
            open += if slope < -1e29 { area } else { 0.0 };
        }
    }
    Ok(open / all)
}

fn holes_are_as_many_as_asked_for() -> Result<(), Failed> {
    for probability in [0.0, 0.1, 0.35, 0.5, 0.8, 1.0] {
        for noise in ["octaves", "printed"] {
            let holes =
                format!("make_holes: {{ frequency: 0.2, probability: {probability}, noise: {noise} }}");
            near(&holes, open_share(&holes)?, probability, 0.03)?;
        }
    }
    Ok(())
}

fn holes_move() -> Result<(), Failed> {
    let slopes = |time: f64| -> Result<Vec<f32>, Failed> {
        let holes = "make_holes: { frequency: 0.1, phase: 0.1 * time }";
        let text = pierced("", &format!("style s {{ light: sun, shadow_map: 128, {holes} }}"));
        let scene = Scene::at(&text, [8, 8], time, &[])?;
        match scene.frame.styled_lights[0].as_ref().map(|light| light.occluders.clone()) {
            Some(Occluders::Slices(slices)) => Ok(slices.slopes),
            other => Err(format!("no slices, but {other:?}").into()),
        }
    };
    let differ = |a: &[f32], b: &[f32]| {
        let others = a.iter().zip(b).filter(|(a, b)| a != b).count();
        others as f64 / a.len() as f64
    };
    let (start, soon, later, turned) = (slopes(0.0)?, slopes(0.01)?, slopes(3.0)?, slopes(10.0)?);
    let small = differ(&start, &soon);
    ensure(small > 0.0 && small < 0.1, || format!("{small} of the texels change in a moment"))?;
    ensure(differ(&start, &later) > 0.15, || "the pattern stands still".into())?;
    ensure(differ(&start, &turned) < 1e-3, || "a whole turn is no return".into())
}

/// Holes made first are filled; made afterwards they stay.
fn operators_apply_in_their_order() -> Result<(), Failed> {
    let (make, fill) = ("make_holes: { frequency: 1, probability: 0.2 }", "fill_holes: disk(41)");
    let filled = open_share(&format!("{make}, {fill}"))?;
    let open = open_share(&format!("{fill}, {make}"))?;
    ensure(filled < 0.02 && open > 0.15, || format!("open are {filled} and {open}"))?;
    // And between slices and the map.
    let back = open_share(&format!("{make}, enhance_silhouettes: 0, {fill}"))?;
    ensure(back < 0.02, || format!("open is {back} by way of slices"))
}

/// A style that is off, of a light that is off, or without any media in its light.
fn nothing_styled_changes_nothing() -> Result<(), Failed> {
    let size = [12, 8];
    let picture = |text: &str| {
        let scene = Scene::new(text, size)?;
        scene.draw(&|program, frame, job| crate::support::render(program, frame, job, 1))
    };
    let holes = "make_holes: { threshold: 100 }";
    let off = picture(&pierced("", &format!("style s {{ light: sun, {holes}, when: time > 1 }}")))?;
    ensure(off == picture(&pierced("", ""))?, || "a style that is off".into())?;
    let unshadowed =
        |style: &str| pierced("", style).replace("scatter: 0.2", "scatter: 0.2, lighting: unshadowed");
    let style = format!("style s {{ light: sun, {holes} }}");
    ensure(picture(&unshadowed(&style))? == picture(&unshadowed(""))?, || "a medium without shadows".into())
}

/// Numbers that only a param or the time can set.
fn awkward_numbers_stay_finite() -> Result<(), Failed> {
    for number in ["0 / (time - time)", "1e30 * (1 + time)", "-5 * time", "time - 1"] {
        let styles = [
            format!("fill_holes: disk({number})"),
            format!("fill_holes: epipolar({number})"),
            format!("enhance_silhouettes: {number}"),
            format!(
                "make_holes: {{ frequency: {number}, persistence: {number}, probability: {number}, phase: {number} }}"
            ),
            format!("make_holes: {{ threshold: {number} }}"),
            format!(
                "transfer: [gradient(({number}, 0), #000000, (1, {number}), #ffffff, blend: alpha({number}))]"
            ),
            format!(
                "transfer: [diffusion([(({number}, 0), #ff0000), ((1, 1), #00ff00)])], depth_range: ({number}, 1)"
            ),
            format!("heterogeneity: {{ frequency: {number}, amount: {number} }}"),
            format!(
                "heterogeneity: {{ brushes: [brush((0, {number}, 0), 1 + {number}, intensity: {number}, frequency: {number})] }}"
            ),
        ];
        for style in styles {
            let text = pierced(HOLE, &format!("style s {{ light: sun, shadow_map: 64, {style} }}"));
            let scene = Scene::at(&text, [6, 4], 1.0, &[])?;
            let image = scene.draw(&|program, frame, job| crate::support::render(program, frame, job, 1))?;
            let finite = image.pixels.iter().flat_map(|pixel| pixel.color).all(f32::is_finite);
            ensure(finite, || format!("{style} is not finite"))?;
        }
    }
    Ok(())
}
