//! Strict arithmetic: on software Vulkan the GPU gives the bits of the CPU, for every operation, field and picture of the examples and
//! for random scenes. Nothing here has a tolerance.

use crate::differential::{function_of, on_cpu, on_gpu, operands};
use crate::generated::{compiled, scenes};
use crate::gpu_device::strict_trial;
use crate::skips::union_of_many;
use crate::support::{
    FIRST, MANY_TUBES, Random, compile, compile_file, ensure, examples, frame, frame_at, point, program_of,
    render,
};
use libtest_mimic::{Failed, Trial};
use std::sync::atomic::AtomicBool;
use vol::backend::Device;
use vol::compare;
use vol_compiler::frame::{Frame, Image, Job, Quadrature, Sampling};
use vol_compiler::ir::Function;
use vol_compiler::ir::verify::random;
use vol_compiler::ops::{Operation, TABLE};
use vol_compiler::program::Program;
use vol_runtime_gpu::{Gpu, Renderer};

/// Random functions.
const FUNCTIONS: u64 = 60;

/// Points of each function and field.
const POINTS: usize = 400;

/// Random scenes, in so many trials.
const SCENES: u64 = 1000;
const PARTS: u64 = 8;

/// Of every so many scenes one is also drawn: software Vulkan compiles the shader of a picture for a second or two.
const DRAWN: u64 = 4;

/// The trials of this file.
pub(crate) fn trials() -> Vec<Trial> {
    let mut trials: Vec<Trial> = TABLE
        .iter()
        .map(|operation| {
            let name = format!("strict::operation_{}", operation.name);
            strict_trial(&name, move |gpu| check_operation(gpu, operation))
        })
        .collect();
    trials.push(strict_trial("strict::random_functions", random_functions));
    for (name, path) in examples() {
        let scene = path.clone();
        trials.push(strict_trial(&format!("strict::fields_of_{name}"), move |gpu| {
            let program = compile_file(&scene)?;
            ensure(!program.fields.is_empty(), || "the scene has no fields".into())?;
            same_fields(gpu, &program, &frame(&program, 1.7, [8, 8])?, POINTS)
        }));
        trials.push(strict_trial(&format!("strict::picture_of_{name}"), move |gpu| {
            let program = compile_file(&path)?;
            same_pictures(gpu, &program, &frame(&program, 0.4, [48, 27])?)
        }));
    }
    trials.push(strict_trial("strict::picture_of_a_coil", coil));
    for (place, eye) in [("outside", "(4, 4, 9)"), ("inside", "(1.5, 1.5, 1.5)")] {
        trials.push(strict_trial(&format!("strict::picture_of_a_union_from_{place}"), move |gpu| {
            union(gpu, eye)
        }));
    }
    trials.push(strict_trial("strict::picture_of_many_tubes", many_tubes));
    trials.extend((0..PARTS).map(|part| {
        strict_trial(&format!("strict::random_scenes_{part}"), move |gpu| random_scenes(gpu, part))
    }));
    trials
}

/// Operands at which arithmetic is special: zeros, halves, denormals, far and huge.
const AWKWARD: [f32; 16] = [
    0.0,
    -0.0,
    0.5,
    -0.5,
    1.0,
    -1.0,
    1e-40,
    -1e-40,
    1.5e-38,
    0.99999994,
    1e6,
    -16_777_217.0,
    3e9,
    -1e20,
    3e38,
    2.5,
];

fn check_operation(gpu: &Gpu, operation: &Operation) -> Result<(), Failed> {
    let mut random = Random::new(operation.op as u64);
    let mut inputs = operands(operation);
    let awkward = (0..500 * operation.args.len()).map(|_| AWKWARD[random.below(AWKWARD.len())]);
    inputs.extend(awkward);
    for data in if operation.has_data { 0..2 } else { 0..1 } {
        same_values(gpu, function_of(operation, data), &inputs)?;
    }
    Ok(())
}

fn random_functions(gpu: &Gpu) -> Result<(), Failed> {
    for seed in 0..FUNCTIONS {
        let shape = random::Shape { uniforms: 0, curves: 2, ..random::Shape::default() };
        let mut random = Random::new(seed);
        let inputs: Vec<f32> = (0..POINTS).flat_map(|_| point(&mut random, [-2.0; 3], [2.0; 3])).collect();
        same_values(gpu, random::function(seed, &shape), &inputs)?;
    }
    Ok(())
}

fn same_values(gpu: &Gpu, function: Function, inputs: &[f32]) -> Result<(), Failed> {
    let text = vol_compiler::ir::text::print_function(&function);
    let program = program_of(function)?;
    let frame = frame(&program, 0.0, [8, 8])?;
    let function = program.module.function(FIRST);
    let cpu = on_cpu(&program, &frame, inputs)?;
    let gpu = on_gpu(gpu)(&program, &frame, inputs)?;
    let outputs = function.outputs.len();
    first_difference(&cpu, &gpu).map_or(Ok(()), |place| {
        let row = place / outputs;
        let width = function.inputs as usize;
        let at = &inputs[row * width..][..width];
        Err(format!("at {at:?}: {:?} on the CPU, {:?} on the GPU\n{text}", cpu[place], gpu[place]).into())
    })
}

fn same_fields(gpu: &Gpu, program: &Program, frame: &Frame, count: usize) -> Result<(), Failed> {
    let points = compare::scatter(&frame.bounds, count as u32);
    for field in &program.fields {
        let cpu = Device::Cpu.evaluate(program, frame, field.function, &points);
        let cpu = cpu.map_err(|failure| format!("{failure:?}"))?;
        let gpu = vol_runtime_gpu::evaluate(gpu, program, frame, field.function, points.as_flattened())?;
        if let Some(place) = first_difference(&cpu, &gpu) {
            let point = points[place / program.module.function(field.function).outputs.len()];
            let (cpu, gpu) = (cpu[place], gpu[place]);
            return Err(format!("{} at {point:?}: {cpu:?} on the CPU, {gpu:?} on the GPU", field.name).into());
        }
    }
    Ok(())
}

/// The first place where two rows have other bits, but that what is no number has any.
fn first_difference(a: &[f32], b: &[f32]) -> Option<usize> {
    let same = |a: f32, b: f32| a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan());
    a.iter().zip(b).position(|(&a, &b)| !same(a, b))
}

/// A wide coil seen along its axis, so that rays leave it and enter it again more often than they remember runs, alone in the
/// light and as one of five media without.
fn coil(gpu: &Gpu) -> Result<(), Failed> {
    let hazes: String = (0..4)
        .map(|i| {
            format!("medium haze{i} {{ region: sphere(0.3).translate(({i} / 2 - 0.7, 0, -1)), emit: 1 }}\n")
        })
        .collect();
    for others in ["light sun { from: (0.02, 1, 0.04) }\n", &hazes] {
        let text = format!(
            "medium wire {{ region: tube(helix(0.8, 14, 7), radius: t => 0.12), \
             density: q => 3 + q.t, absorb: 0.1, scatter: 0.3, emit: 0.1 }}\n{others}\
             camera {{ from: (0.5, 24, 0.3), at: (0.5, 0, 0.35), fov: 5deg }}\n"
        );
        let program = compile("coil", &text)?;
        same_pictures(gpu, &program, &frame(&program, 0.0, [48, 27])?)?;
    }
    Ok(())
}

/// A union of many in parts, and a body that has none.
fn union(gpu: &Gpu, eye: &str) -> Result<(), Failed> {
    let program = compile("union", &union_of_many(eye))?;
    same_pictures(gpu, &program, &frame(&program, 0.0, [48, 27])?)
}

fn many_tubes(gpu: &Gpu) -> Result<(), Failed> {
    let program = compile("many tubes", MANY_TUBES)?;
    let frame = frame(&program, 0.0, [48, 27])?;
    same_fields(gpu, &program, &frame, POINTS)?;
    same_pictures(gpu, &program, &frame)
}

/// Pictures by both quadratures, with few samples and with many of which pixels take some.
fn same_pictures(gpu: &Gpu, program: &Program, frame: &Frame) -> Result<(), Failed> {
    let renderer = Renderer::new(gpu, program)?;
    for (quadrature, step, sampling) in [
        (Quadrature::Midpoint, 0.05, Sampling::CENTRE),
        (Quadrature::Corrected, 0.08, Sampling { most: 17, tolerance: 0.05 }),
    ] {
        let job = Job { size: [48, 27], step, shadow_step: 2.0 * step, quadrature, sampling };
        same_picture(gpu, &renderer, program, frame, &job)?;
        if quadrature == Quadrature::Midpoint && program.media.len() > 1 {
            same_picture(gpu, &renderer, program, &spaced(program, frame, 0), &job)?;
        }
    }
    Ok(())
}

/// A frame with media, of several, that are sampled as far apart as a number says.
fn spaced(program: &Program, frame: &Frame, number: usize) -> Frame {
    let mut frame = frame.clone();
    let media = frame.media.iter_mut().enumerate();
    for (index, medium) in media.filter(|_| program.media.len() > 1) {
        medium.spacing = [1, 4, 32, 2, 64, 8, 16][(index + number) % 7];
    }
    frame
}

fn same_picture(
    gpu: &Gpu,
    renderer: &Renderer,
    program: &Program,
    frame: &Frame,
    job: &Job,
) -> Result<(), Failed> {
    let cpu = render(program, frame, job, 2)?;
    let drawn = renderer.render(gpu, program, frame, job, &|_| {}, &AtomicBool::new(false))?;
    let (gpu, _) = drawn.ok_or("cancelled by nobody")?;
    let (cpu_bits, gpu_bits) = (numbers(&cpu), numbers(&gpu));
    first_difference(&cpu_bits, &gpu_bits).map_or(Ok(()), |place| {
        let pixel = place as u32 / NUMBERS as u32;
        let at = [pixel % job.size[0], pixel / job.size[0]];
        let pixels = [&cpu.pixels[pixel as usize], &gpu.pixels[pixel as usize]];
        Err(format!("{:?}: pixel {at:?} is {pixels:?}", job.quadrature).into())
    })
}

/// Numbers of a pixel.
const NUMBERS: usize = 8;

fn numbers(image: &Image) -> Vec<f32> {
    let of = |pixel: &vol_compiler::frame::Pixel| {
        let [r, g, b] = pixel.color;
        let [red, green, blue] = pixel.transmittance;
        [r, g, b, red, green, blue, pixel.depth, pixel.error] as [f32; NUMBERS]
    };
    image.pixels.iter().flat_map(of).collect()
}

fn random_scenes(gpu: &Gpu, part: u64) -> Result<(), Failed> {
    let mut refused = 0;
    let scenes = scenes(SCENES);
    for seed in (part..scenes).step_by(PARTS as usize) {
        let bytes = vol_generator::bytes(seed, [60, 150, 300, 600][(seed / PARTS) as usize % 4]);
        if let Err(failed) = same_scene(gpu, &bytes, seed) {
            let smallest = vol_generator::shrink(&bytes, |bytes| same_scene(gpu, bytes, seed).is_err());
            let error = same_scene(gpu, &smallest, seed).err().unwrap_or(failed);
            return Err(format!("seed {seed}: {error:?}\n{}", vol_generator::scene(&smallest)).into());
        }
        refused += u64::from(compiled(&bytes)?.is_none());
    }
    ensure(refused * 4 < scenes.div_ceil(PARTS), || format!("{refused} scenes have no first frame"))
}

/// All fields of a scene and, of some scenes, a picture.
fn same_scene(gpu: &Gpu, bytes: &[u8], seed: u64) -> Result<(), Failed> {
    let Some(program) = compiled(bytes)? else { return Ok(()) };
    let size = [12, 8];
    let frame = frame_at(&program, [0.7, 2.0], size)?;
    same_fields(gpu, &program, &frame, 24)?;
    if !(seed / PARTS).is_multiple_of(DRAWN) {
        return Ok(());
    }
    let quadrature =
        if (seed / PARTS / DRAWN).is_multiple_of(2) { Quadrature::Midpoint } else { Quadrature::Corrected };
    let sampling = if (seed / PARTS / DRAWN).is_multiple_of(3) {
        Sampling { most: 17, tolerance: 0.05 }
    } else {
        Sampling::CENTRE
    };
    // A few samples along each ray, also of scenes without bounds.
    let step = frame.bounds.diagonal().min(1e6) / 24.0;
    let job = Job { size, step, shadow_step: 2.0 * step, quadrature, sampling };
    let frame = spaced(&program, &frame, (seed / PARTS / DRAWN) as usize);
    same_picture(gpu, &Renderer::new(gpu, &program)?, &program, &frame, &job)
}
