//! No surface is missed: what the renderer hits first against a search of the same rays in small steps.
//!
//! Pictures are taken from all around the scene; along each ray, up to the depth that the picture has,
//! every distance is sampled. Where two neighbouring samples are inside a solid that the ray went on
//! through, it was missed. Samples are several of the shortest steps of a ray apart, below which nothing
//! is promised to be seen.

use crate::support::{Random, compile, compile_file, ensure, examples, frame, render};
use libtest_mimic::{Failed, Trial};
use std::path::Path;
use vol::backend::Device;
use vol_compiler::frame::{CameraFrame, Frame, Job, Quadrature, Sampling, Stride};
use vol_compiler::program::Program;

/// Width and height of a picture.
const SIZE: u32 = 48;

/// Samples of a ray, over the ball around the scene.
const SAMPLES: usize = 256;

/// Scenes of the generator.
const GENERATED: u64 = 200;

/// Solids so steep that steps as of distances go through them.
const STEEPEST: [&str; 3] = [
    "sphere(1).displace(p => 0.15 * fbm(3 * p, 5))",
    "box((1, 0.5, 0.7)).displace(p => 0.1 * sin(9 * p.x) * sin(9 * p.y) * sin(9 * p.z)).rotate_y(30deg)",
    "implicit(p => p.x * p.x * p.x * p.x + p.y * p.y * p.y * p.y - p.x * p.x + p.z * p.z - 0.2, bounds: (1.5, 1.5, 1.5))",
];

/// Solids with every other way of being steeper than a distance.
const STEEP: &[&str] = &[
    "sphere(1).displace(p => 0.2 * perlin(4 * p))",
    "sphere(0.8).displace(p => 0.04 * p.x * p.y * p.z + 0.1 * p.x * p.x).scale((1, 2, 0.7))",
    // Steep far from its own box, and evaluated there.
    "union(sphere(0.5).displace(p => 0.05 * p.x * p.x * p.x), box((0.2, 0.1, 0.1)).translate((3, 0, 0)))",
    "union([sphere(0.6).displace(p => 0.02 * exp(2 * p.y)), torus(1.2, 0.2)], smooth: 0.3)",
    "box((0.5, 0.9, 0.2)).twist(150deg)",
    "box((0.5, 0.9, 0.2)).displace(p => 0.05 * worley(5 * p)).twist(90deg).translate((0.2, 0, 0))",
    "box((1.5, 0.2, 0.2)).displace(p => 0.04 * sin(14 * p.x)).bend(40deg)",
    "sphere(0.3).displace(p => 0.04 * p.x * p.x * p.x).repeat((4, 0, 0), count: (3, 1, 1))",
    "sphere(0.3).displace(p => 0.03 * exp(2 * p.x) * p.z).translate((1.2, 0, 0)).repeat_polar(5)",
    "sphere(0.2).displace(p => 0.05 * simplex(6 * p)).repeat((0.7, 0.7, 0.7), count: (3, 2, 3))",
    "box((0.7, 0.7, 0.7)).displace(p => 0.05 * abs(p.x * 2 - floor(p.x * 2) - 0.5))",
    "sphere(0.8).displace(p => 0.1 * hash(floor(p.x * 6)))",
    "sphere(0.8).displace(p => if p.y > 0 then 0 else 0.15)",
    "sphere(0.8).displace(p => if p.x * p.z > 0.1 then 0.1 * p.y else 0)",
    "box((0.7, 0.7, 0.7)) - sphere(0.9).displace(p => 0.1 * sin(12 * p.y))",
    "implicit(p => sin(5 * p.x) * cos(5 * p.y) + sin(5 * p.y) * cos(5 * p.z) + sin(5 * p.z) * cos(5 * p.x), bounds: (1, 1, 1))",
    "implicit(p => (iterate 5 from (z = p) : (z = z * dot(z, z) + 0.3 * p)).z.x - 0.2, bounds: (0.7, 0.7, 0.7))",
];

/// The trials of this file.
pub(crate) fn trials() -> Vec<Trial> {
    let mut trials = vec![
        Trial::test("surfaces::steep_solids_are_not_missed", || {
            STEEPEST.iter().chain(STEEP).try_for_each(|shape| {
                let scene = format!("object o {{ shape: {shape} }}");
                none_missed(&compile("steep.vol", &scene)?, 4)
                    .map_err(|error| format!("{shape}: {error:?}").into())
            })
        }),
        Trial::test("surfaces::generated_scenes_are_not_missed", generated),
        Trial::test("surfaces::a_wrong_bound_is_found_out", wrong_bounds_are_found),
    ];
    for (name, path) in examples() {
        let test = move || none_missed(&compile_file(Path::new(&path))?, 4);
        trials.push(Trial::test(format!("surfaces::{name}_misses_none"), test));
    }
    trials
}

/// How many times the usual number of rays is asked for by the environment variable `VOL_RAYS`.
fn effort() -> Result<usize, Failed> {
    match std::env::var("VOL_RAYS") {
        Ok(text) => Ok(text.parse().map_err(|_| format!("VOL_RAYS is a whole number, not `{text}`"))?),
        Err(_) => Ok(1),
    }
}

fn generated() -> Result<(), Failed> {
    let (mut seed, mut searched) = (0, 0);
    while searched < GENERATED {
        let text = vol_generator::scene(&vol_generator::bytes(seed, 400));
        seed += 1;
        // Some solids cannot be marched safely, which is an error; some scenes have none.
        let Ok(program) = compile("generated.vol", &text) else { continue };
        if !program.objects.is_empty() {
            none_missed(&program, 1).map_err(|error| format!("seed {seed}: {error:?}\n{text}"))?;
            searched += 1;
        }
    }
    Ok(())
}

/// The same search, with steps as if the solids were less steep than they are.
fn wrong_bounds_are_found() -> Result<(), Failed> {
    for shape in STEEPEST {
        let program = compile("steep.vol", &format!("object o {{ shape: {shape} }}"))?;
        let mut frame = frame(&program, 0.0, [SIZE; 2])?;
        let right = match frame.objects[0].stride {
            Stride::Scale(scale) => scale,
            Stride::Within(_) => 0.25,
        };
        frame.objects[0].stride = Stride::Scale((4.0 * right).max(1.0));
        let missed = missed(&program, &mut frame, 4)?;
        ensure(missed.is_some(), || format!("{shape}: four times too long steps miss nothing"))?;
    }
    Ok(())
}

fn none_missed(program: &Program, pictures: usize) -> Result<(), Failed> {
    let mut frame = frame(program, 0.0, [SIZE; 2])?;
    let missed = missed(program, &mut frame, pictures * effort()?)?;
    ensure(missed.is_none(), || missed.unwrap_or_default())
}

/// The first ray found that goes through a solid.
fn missed(program: &Program, frame: &mut Frame, pictures: usize) -> Result<Option<String>, Failed> {
    // Only surfaces matter.
    frame.lights.clear();
    frame.media.clear();
    let bounds = frame.bounds;
    let centre = [0, 1, 2].map(|i| 0.5 * (bounds.lo[i] + bounds.hi[i]));
    let radius = 0.5 * (0..3).map(|i| (bounds.hi[i] - bounds.lo[i]).powi(2)).sum::<f32>().sqrt();
    if frame.objects.is_empty() || !radius.is_finite() || radius > 1e5 {
        return Ok(None);
    }
    let mut random = Random::new(7);
    for _ in 0..pictures {
        frame.camera = around(&mut random, centre, radius);
        if eye_is_inside(program, frame)? {
            continue;
        }
        if let Some(message) = missed_in_picture(program, frame, radius)? {
            return Ok(Some(message));
        }
    }
    Ok(None)
}

/// Whether the eye is in a solid, which is then seen from within.
fn eye_is_inside(program: &Program, frame: &Frame) -> Result<bool, Failed> {
    for object in &frame.objects {
        let distance = Device::Cpu.evaluate(program, frame, object.distance, &[frame.camera.origin]);
        if distance.map_err(|failure| format!("{failure:?}"))?[0] < 0.0 {
            return Ok(true);
        }
    }
    Ok(false)
}

/// A camera that sees a ball from outside.
fn around(random: &mut Random, centre: [f32; 3], radius: f32) -> CameraFrame {
    let mut draw = || [(); 3].map(|()| random.between(-1.0, 1.0) as f32);
    let away = unit(draw());
    let forward = away.map(|c| -c);
    let right = unit(cross(forward, draw()));
    let up = cross(right, forward);
    let distance = 2.5 * radius.max(1e-3);
    let origin = [0, 1, 2].map(|i| centre[i] + distance * away[i]);
    // The ball fills the picture.
    let half = 0.43;
    CameraFrame { origin, forward, right: right.map(|c| c * half), up: up.map(|c| c * half) }
}

fn missed_in_picture(program: &Program, frame: &Frame, radius: f32) -> Result<Option<String>, Failed> {
    let job = Job {
        size: [SIZE; 2],
        step: 1.0,
        shadow_step: 1.0,
        quadrature: Quadrature::Midpoint,
        sampling: Sampling::CENTRE,
    };
    let picture = render(program, frame, &job, 2)?;
    let camera = &frame.camera;
    let (near, far) = (1.5 * radius, 3.5 * radius);
    let step = (far - near) / SAMPLES as f32;
    let mut points = Vec::new();
    let mut places = Vec::new();
    for (index, pixel) in picture.pixels.iter().enumerate() {
        let place = [index as u32 % SIZE, index as u32 / SIZE].map(|c| (c as f32 + 0.5) / SIZE as f32);
        let (u, v) = (2.0 * place[0] - 1.0, 1.0 - 2.0 * place[1]);
        let toward = [0, 1, 2].map(|i| camera.forward[i] + u * camera.right[i] + v * camera.up[i]);
        let direction = unit(toward);
        let end = pixel.depth / dot(direction, camera.forward) - 2.0 * step;
        for sample in 0..SAMPLES {
            let t = near + step * sample as f32;
            if t < end {
                points.push([0, 1, 2].map(|i| camera.origin[i] + t * direction[i]));
                places.push((index, t));
            }
        }
    }
    for object in &frame.objects {
        let distances = Device::Cpu.evaluate(program, frame, object.distance, &points);
        let distances = distances.map_err(|failure| format!("{failure:?}"))?;
        for at in 1..points.len() {
            let on_one_ray = places[at].0 == places[at - 1].0;
            if on_one_ray && distances[at] < 0.0 && distances[at - 1] < 0.0 && held(frame, points[at]) {
                let (index, t) = places[at];
                let hit = picture.pixels[index].depth;
                let name = &program.objects[object.index].name;
                return Ok(Some(format!(
                    "pixel {index} goes through `{name}` at {t}, {:?}, where it is {} deep, and ends at depth {hit}",
                    points[at], -distances[at]
                )));
            }
        }
    }
    Ok(None)
}

/// Whether a point is in the bounds, outside of which nothing is rendered.
fn held(frame: &Frame, point: [f32; 3]) -> bool {
    frame.objects.iter().any(|o| (0..3).all(|i| o.bounds.lo[i] <= point[i] && point[i] <= o.bounds.hi[i]))
}

fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    (0..3).map(|i| a[i] * b[i]).sum()
}

fn cross(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn unit(v: [f32; 3]) -> [f32; 3] {
    let length = dot(v, v).sqrt().max(1e-6);
    v.map(|c| c / length)
}
