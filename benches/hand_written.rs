//! vol's GPU backend against the method of M. Moinet, "Sculpting procedural noise" (2022), written by hand for this purpose: its
//! three scenes in WGSL (`hand_written/*.wgsl`: a sphere-marched tube, a fixed step, no grid), on the same device. Markdown
//! on standard output, for docs/backends.md.
//!
//! ```text
//! cargo bench --bench hand_written -- [tornado] [solar_flare] [galaxy] [160x90]
//! ```
//!
//! Errors are those of `vol bench`: against vol's f64 reference at some pixels, rms of the difference over rms of the
//! reference. Times run from the numbers of the frame to the picture in memory, everything compiled before.

use std::path::Path;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

use vol::bench::reference::{Reference, spread};
use vol::session::{Moment, Session, load};
use vol_compiler::curve::{Quadratic, initial_normal};
use vol_compiler::frame::{Frame, Image, Job, Pixel, Sampling};
use vol_compiler::noise_table::permutation_words;
use vol_compiler::skip::Skips;
use vol_compiler::wgsl::Space;
use vol_runtime_gpu::{Buffer, Gpu, Kernel, Renderer};

/// Pixels of the pictures where no size is asked for.
const SIZE: [u32; 2] = [160, 90];

/// Errors that vol is asked for, falling.
const MAX_ERRORS: [f32; 3] = [3e-2, 1e-2, 3e-3];

/// Places of the reference, its most levels beyond the first, and what part of the smallest error the last may change
/// it by.
const PLACES: usize = 1024;
const LEVELS: u32 = 4;
const MARGIN: f32 = 0.25;

/// Steps of the hand-written march, scene units: the first, and how many halvings follow at most.
const FIRST_STEP: f32 = 0.32;
const HALVINGS: i32 = 11;

/// A slower picture is the last with its kind of step.
const SLOWEST: Duration = Duration::from_secs(5);

/// Steps towards the lights over those along the camera rays.
const SHADOW_STEPS: [f32; 3] = [2.0, 4.0, 8.0];

/// Rounds of which the least time counts, and the time after which no more begin.
const ROUNDS: usize = 5;
const PATIENCE: Duration = Duration::from_secs(3);

/// Sides of a workgroup of the hand-written shaders.
const WORKGROUP: u32 = 8;

/// Places of `step`, `shadow_step` and `size` in `View` of shared.wgsl.
const STEP_WORD: usize = 3;
const SHADOW_STEP_WORD: usize = 7;
const SIZE_WORD: usize = 16;

/// Words of `View` before its segments, of a segment, and the number of segments.
const VIEW_WORDS: usize = 20;
const SEGMENT_WORDS: usize = 28;
const SEGMENTS: usize = 4;

/// Points at which the length of a segment is measured.
const LENGTH_POINTS: u32 = 4096;

/// A scene and its hand-written port.
struct Port {
    name: &'static str,
    shader: &'static str,
    /// Largest radius of its tube.
    radius: f32,
    /// Whether lights shine into it.
    is_lit: bool,
}

const PORTS: [Port; 3] = [
    Port { name: "tornado", shader: include_str!("hand_written/tornado.wgsl"), radius: 0.6, is_lit: true },
    Port {
        name: "solar_flare",
        shader: include_str!("hand_written/solar_flare.wgsl"),
        radius: 0.38,
        is_lit: false,
    },
    Port { name: "galaxy", shader: include_str!("hand_written/galaxy.wgsl"), radius: 0.34, is_lit: false },
];

/// A picture that was measured.
#[derive(Clone, Copy)]
struct Run {
    error: f64,
    milliseconds: f64,
}

/// A picture of vol's.
struct Ours {
    max_error: f32,
    run: Run,
    /// With the choice of steps and grids.
    in_all: f64,
}

/// The hand-written pictures with one ratio of the steps, steps falling.
struct Ladder {
    shadow_steps: f32,
    runs: Vec<(f32, Run)>,
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let size = arguments.iter().find_map(|argument| size_of(argument)).unwrap_or(SIZE);
    let named = |port: &&Port| arguments.iter().any(|argument| argument == port.name);
    let any_named = PORTS.iter().any(|port| named(&port));
    let gpu = vol_runtime_gpu::open(Default::default()).expect("a Vulkan device");
    println!("Device: {}. {} x {} pixels.", gpu.description(), size[0], size[1]);
    let mut summary = Vec::new();
    for port in PORTS.iter().filter(|port| !any_named || named(port)) {
        summary.extend(measure(&gpu, port, size));
    }
    println!(
        "\n| scene | asked of vol | error | vol, ms | with choosing, ms | by hand, ms | vol is faster by | with choosing |"
    );
    println!("|---|---|---|---|---|---|---|---|");
    summary.iter().for_each(|row| println!("{row}"));
}

/// `160x90`
fn size_of(argument: &str) -> Option<[u32; 2]> {
    let (width, height) = argument.split_once('x')?;
    Some([width.parse().ok()?, height.parse().ok()?])
}

/// Measures a scene, prints all that was found and returns the rows of the summary.
fn measure(gpu: &Gpu, port: &Port, size: [u32; 2]) -> Vec<String> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples").join(format!("{}.vol", port.name));
    let session = load(&path, Skips::ALL).unwrap_or_else(|failure| panic!("{failure:?}"));
    let params = session.params(&[]).expect("defaults");
    let frame = session.frame(&params, Moment { time: 0.0, frame: 0.0 }, size).expect("a frame");
    let reference = reference(&session, &frame, size);
    let pixels = reference.places.len();
    println!(
        "\n**{}**: reference in f64 at {pixels} pixels, changed by {:.0e} by its last halving of the step.\n",
        port.name, reference.change
    );
    println!("| picture | error | ms | with choosing, ms |");
    println!("|---|---|---|---|");
    let ours = MAX_ERRORS.map(|max_error| ours(gpu, &session, &frame, size, max_error, &reference));
    for Ours { max_error, run, in_all } in &ours {
        println!(
            "| vol, --max-error {max_error:e} | {:.1e} | {:.1} | {in_all:.1} |",
            run.error, run.milliseconds
        );
    }
    let finest = ours.iter().map(|ours| ours.run.error).fold(f64::INFINITY, f64::min);
    let hand = HandWritten::new(gpu, port, &frame, size);
    let ratios = if port.is_lit { &SHADOW_STEPS[..] } else { &SHADOW_STEPS[..1] };
    let ladders: Vec<Ladder> = ratios.iter().map(|&ratio| hand.ladder(ratio, finest, &reference)).collect();
    for Ladder { shadow_steps, runs } in &ladders {
        for (step, run) in runs {
            let shadows = if port.is_lit {
                format!("; {shadow_steps} times as long to the light")
            } else {
                String::new()
            };
            println!("| by hand, step {step}{shadows} | {:.1e} | {:.1} | |", run.error, run.milliseconds);
        }
    }
    ours.iter().map(|ours| summary(port.name, ours, &ladders)).collect()
}

/// A row: the time by hand at the error of a picture of vol's, with the ratio of steps that is best there.
fn summary(name: &str, ours: &Ours, ladders: &[Ladder]) -> String {
    let Ours { max_error, run, in_all } = ours;
    let times = ladders.iter().filter_map(|ladder| time_at(&ladder.runs, run.error));
    let (more, by_hand) = match times.reduce(f64::min) {
        Some(time) => ("", time),
        // Every ladder ends above the error: each would take longer than its last picture.
        None => {
            let last = ladders.iter().filter_map(|ladder| Some(ladder.runs.last()?.1.milliseconds));
            ("> ", last.fold(f64::INFINITY, f64::min))
        }
    };
    let (alone, with) = (by_hand / run.milliseconds, by_hand / in_all);
    format!(
        "| {name} | --max-error {max_error:e} | {:.1e} | {:.1} | {in_all:.1} | {more}{by_hand:.1} | {more}{alone:.2} | {more}{with:.2} |",
        run.error, run.milliseconds
    )
}

/// The time at an error, in proportion between the logarithms of the two pictures around it; none if no picture is as
/// good.
fn time_at(runs: &[(f32, Run)], error: f64) -> Option<f64> {
    let reached = runs.iter().position(|(_, run)| run.error <= error)?;
    let (_, fine) = runs[reached];
    let Some((_, coarse)) = reached.checked_sub(1).map(|before| runs[before]) else {
        return Some(fine.milliseconds);
    };
    let part = (coarse.error / error).ln() / (coarse.error / fine.error).ln();
    Some(coarse.milliseconds * (fine.milliseconds / coarse.milliseconds).powf(part))
}

/// The reference of `vol bench`.
fn reference(session: &Session, frame: &Frame, size: [u32; 2]) -> Reference {
    let finest = MAX_ERRORS[MAX_ERRORS.len() - 1];
    let program = &session.program;
    let first = vol_runtime_cpu::choose_step(program, frame, size, finest).job(size, Sampling::CENTRE);
    let expose = |places: &[[u32; 2]], level: u32| {
        let finer = 0.5f32.powi(level as i32);
        let job = Job { step: finer * first.step, shadow_step: finer * first.shadow_step, ..first };
        let pixels = vol_runtime_cpu::reference_pixels(program, frame, &job, places, &AtomicBool::new(false));
        Ok(pixels.expect("not cancelled"))
    };
    Reference::converge(spread(size, PLACES), LEVELS, f64::from(MARGIN * finest), expose).expect("computed")
}

/// Measures vol's GPU backend.
fn ours(
    gpu: &Gpu,
    session: &Session,
    frame: &Frame,
    size: [u32; 2],
    max_error: f32,
    reference: &Reference,
) -> Ours {
    let program = &session.program;
    let renderer = Renderer::new(gpu, program).expect("the scene compiles");
    let choose = || {
        let mut frame = frame.clone();
        let choice = vol_runtime_cpu::choose(program, &mut frame, size, Sampling::CENTRE, max_error);
        (frame, choice.job)
    };
    let (choosing, (frame, job)) = least(choose);
    renderer.compile(gpu, program, &frame, &job).expect("the scene compiles");
    let render = || renderer.render(gpu, program, &frame, &job, &|_| {}, &AtomicBool::new(false));
    let (milliseconds, rendered) = least(render);
    let (image, _) = rendered.expect("rendered").expect("not cancelled");
    let run = Run { error: reference.error(&image), milliseconds };
    Ours { max_error, run, in_all: choosing + milliseconds }
}

/// The least time of some rounds in milliseconds, and what the last gave.
fn least<T>(mut work: impl FnMut() -> T) -> (f64, T) {
    let started = Instant::now();
    let mut round = || {
        let started = Instant::now();
        let result = work();
        (started.elapsed().as_secs_f64() * 1e3, result)
    };
    let (mut shortest, mut last) = round();
    for _ in 1..ROUNDS {
        if started.elapsed() > PATIENCE {
            break;
        }
        let (milliseconds, result) = round();
        shortest = shortest.min(milliseconds);
        last = result;
    }
    (shortest, last)
}

/// A hand-written shader on the device.
struct HandWritten<'a> {
    gpu: &'a Gpu,
    kernel: Kernel,
    size: [u32; 2],
    /// The words of `View`, without the steps.
    view: Vec<u32>,
    view_buffer: Buffer,
    permutation: Buffer,
    picture: Buffer,
}

impl<'a> HandWritten<'a> {
    fn new(gpu: &'a Gpu, port: &Port, frame: &Frame, size: [u32; 2]) -> Self {
        let text = format!("{}{}", include_str!("hand_written/shared.wgsl"), port.shader);
        let inputs = [Space::Uniform, Space::Storage];
        let kernel = gpu.kernel(port.name, &text, "main", &inputs).unwrap_or_else(|error| panic!("{error}"));
        let view = view_words(frame, size, port.radius);
        let upload = |words: &[u32]| gpu.upload(words).expect("memory");
        let picture = gpu.zeroed(4 * size[0] as usize * size[1] as usize).expect("memory");
        let (view_buffer, permutation) = (upload(&view), upload(&permutation_words()));
        Self { gpu, kernel, size, view, view_buffer, permutation, picture }
    }

    /// Pictures with smaller and smaller steps until one is better than `finest`.
    fn ladder(&self, shadow_steps: f32, finest: f64, reference: &Reference) -> Ladder {
        // Drivers compile shaders when they are first used.
        self.render(FIRST_STEP, FIRST_STEP);
        let mut runs = Vec::new();
        for halving in 0..=HALVINGS {
            let step = FIRST_STEP * 0.5f32.powi(halving);
            let (milliseconds, image) = least(|| self.render(step, shadow_steps * step));
            let error = reference.error(&image);
            runs.push((step, Run { error, milliseconds }));
            if error < finest || milliseconds > SLOWEST.as_secs_f64() * 1e3 {
                break;
            }
        }
        Ladder { shadow_steps, runs }
    }

    fn render(&self, step: f32, shadow_step: f32) -> Image {
        let mut view = self.view.clone();
        view[STEP_WORD] = step.to_bits();
        view[SHADOW_STEP_WORD] = shadow_step.to_bits();
        self.gpu.write(&self.view_buffer, &view).expect("written");
        let [width, height] = self.size;
        let groups = [width.div_ceil(WORKGROUP), height.div_ceil(WORKGROUP), 1];
        let inputs = [&self.view_buffer, &self.permutation];
        self.gpu.dispatch(&self.kernel, &inputs, &self.picture, groups).expect("dispatched");
        let numbers = self.gpu.read_f32(&self.picture).expect("rendered");
        let pixel = |rgba: &[f32]| Pixel { color: [rgba[0], rgba[1], rgba[2]], ..Pixel::default() };
        Image { width, height, pixels: numbers.chunks_exact(4).map(pixel).collect() }
    }
}

/// The words of `View` of shared.wgsl, steps left 0: vec3f at every fourth word, scalars after them.
fn view_words(frame: &Frame, size: [u32; 2], radius: f32) -> Vec<u32> {
    let [curve] = &frame.curves[..] else { panic!("one curve a scene") };
    let camera = &frame.camera;
    let lengths: Vec<f64> = curve.iter().map(length).collect();
    let mut words = Vec::with_capacity(VIEW_WORDS + SEGMENTS * SEGMENT_WORDS);
    let mut put =
        |vector: [f32; 3], scalar: u32| words.extend(vector.map(f32::to_bits).into_iter().chain([scalar]));
    put(camera.origin, 0);
    put(camera.forward, 0);
    put(camera.right, (lengths.iter().sum::<f64>() as f32).to_bits());
    put(camera.up, curve.len() as u32);
    put([0.0; 3], 0);
    let mut before = 0.0;
    let mut normal = initial_normal(direction(&curve[0], 0.0));
    for (segment, length) in curve.iter().zip(lengths) {
        let (along, bend) = coefficients(segment);
        let [low, high] = bounds(segment, radius);
        let rows = [segment.a, along, bend, direction(segment, 0.0), normal];
        let [start, others @ ..] = rows.map(|row| row.map(|x| x as f32));
        put(start, (before as f32).to_bits());
        others.into_iter().chain([low, high]).for_each(|row| put(row, 0));
        normal = carried(normal, direction(segment, 0.0), direction(segment, 1.0));
        before += length;
    }
    words[SIZE_WORD..SIZE_WORD + 2].copy_from_slice(&size);
    words.resize(VIEW_WORDS + SEGMENTS * SEGMENT_WORDS, 0);
    words
}

/// Half the velocity at the start, and half its change: `a + 2 t along + t^2 bend`.
fn coefficients(segment: &Quadratic) -> ([f64; 3], [f64; 3]) {
    let Quadratic { a, b, c } = segment;
    (std::array::from_fn(|i| b[i] - a[i]), std::array::from_fn(|i| a[i] - 2.0 * b[i] + c[i]))
}

/// Half the velocity.
fn velocity(segment: &Quadratic, t: f64) -> [f64; 3] {
    let (along, bend) = coefficients(segment);
    std::array::from_fn(|i| along[i] + t * bend[i])
}

/// Unit tangent.
fn direction(segment: &Quadratic, t: f64) -> [f64; 3] {
    let v = velocity(segment, t);
    v.map(|x| x / dot(v, v).sqrt())
}

fn length(segment: &Quadratic) -> f64 {
    let speed = |i: u32| {
        let v = velocity(segment, (f64::from(i) + 0.5) / f64::from(LENGTH_POINTS));
        2.0 * dot(v, v).sqrt()
    };
    (0..LENGTH_POINTS).map(speed).sum::<f64>() / f64::from(LENGTH_POINTS)
}

/// A normal turned the shortest way from one tangent to another.
fn carried(normal: [f64; 3], before: [f64; 3], after: [f64; 3]) -> [f64; 3] {
    let turn = dot(normal, after) / (1.0 + dot(before, after));
    std::array::from_fn(|i| normal[i] - turn * (before[i] + after[i]))
}

/// Box around a segment of a tube; a coordinate is extreme at an end or where its velocity is 0.
fn bounds(segment: &Quadratic, radius: f32) -> [[f32; 3]; 2] {
    let (along, bend) = coefficients(segment);
    let at = |i: usize, t: f64| segment.a[i] + t * (2.0 * along[i] + t * bend[i]);
    let extremes = |i: usize| {
        let turn = if bend[i] == 0.0 { 0.0 } else { (-along[i] / bend[i]).clamp(0.0, 1.0) };
        [0.0, turn, 1.0].map(|t| at(i, t) as f32)
    };
    let low = std::array::from_fn(|i| extremes(i).into_iter().fold(f32::INFINITY, f32::min) - radius);
    let high = std::array::from_fn(|i| extremes(i).into_iter().fold(f32::NEG_INFINITY, f32::max) + radius);
    [low, high]
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
