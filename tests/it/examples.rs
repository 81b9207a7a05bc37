//! Every example: compiles, renders the same bits for any number of threads, agrees with the f64
//! reference, and on the GPU with the CPU.

use crate::support::{compile_file, ensure, examples, frame, render};
use libtest_mimic::{Failed, Trial};
use std::path::Path;
use vol::compare;
use vol_compiler::frame::{Image, Job, Quadrature, Sampling};
use vol_compiler::program::Program;

/// A small picture.
const SIZE: [u32; 2] = [48, 27];

/// Smaller still: the reference is slow.
const REFERENCE_SIZE: [u32; 2] = [16, 9];

/// A coarse comb: agreement does not need accuracy.
const JOB: Job = Job {
    size: SIZE,
    step: 0.05,
    shadow_step: 0.1,
    quadrature: Quadrature::Midpoint,
    sampling: Sampling::CENTRE,
};

/// The trials of this file.
pub(crate) fn trials() -> Vec<Trial> {
    let mut trials = Vec::new();
    for (name, path) in examples() {
        let scene = path.clone();
        let trial =
            Trial::test(format!("examples::{name}_is_the_same_on_any_threads"), move || threads(&scene));
        trials.push(trial);
        let scene = path.clone();
        let trial = Trial::test(format!("examples::{name}_agrees_with_the_reference"), move || {
            reference(&compile_file(&scene)?)
        });
        trials.push(trial);
        #[cfg(feature = "gpu")]
        {
            let name = format!("examples::{name}_agrees_with_the_cpu");
            trials.push(crate::gpu_device::gpu_trial(&name, move |gpu| {
                let program = compile_file(&path)?;
                quadratures(&program).iter().try_for_each(|&quadrature| agrees(gpu, &program, quadrature))
            }));
        }
    }
    trials
}

fn threads(path: &Path) -> Result<(), Failed> {
    let program = compile_file(path)?;
    let frame = frame(&program, 0.4, SIZE)?;
    let one = render(&program, &frame, &JOB, 1)?;
    ensure(has_content(&one), || "the picture is empty".into())?;
    for threads in [2, 3] {
        let other = render(&program, &frame, &JOB, threads)?;
        ensure(compare::images(&one, &other, compare::EXACT).passes(), || {
            format!("{threads} threads differ from one")
        })?;
    }
    Ok(())
}

/// Whether a picture shows something, and numbers only.
pub(crate) fn has_content(image: &Image) -> bool {
    let background = image.pixels[0];
    let finite = image.pixels.iter().all(|pixel| pixel.color.iter().all(|c| c.is_finite()));
    finite && image.pixels.iter().any(|pixel| compare::difference(pixel, &background) > 0.05)
}

/// A small picture against that of the f64 reference.
pub(crate) fn reference(program: &Program) -> Result<(), Failed> {
    let frame = frame(program, 0.4, REFERENCE_SIZE)?;
    for &quadrature in quadratures(program) {
        let job = Job { size: REFERENCE_SIZE, quadrature, ..JOB };
        let actual = render(program, &frame, &job, 2)?;
        let expected = compare::reference_picture(program, &frame, &job);
        let report = compare::images(&actual, &expected, class(quadrature));
        ensure(report.passes(), || format!("{quadrature:?} {report:?}"))?;
    }
    Ok(())
}

/// What f32 may differ from f64. A sample within rounding of the place where density is cut off gives the
/// corrected form's end term to one node or to the next: at the coarse steps here that shows.
fn class(quadrature: Quadrature) -> compare::ImageClass {
    match quadrature {
        Quadrature::Midpoint => compare::PRECISION,
        Quadrature::Corrected => compare::ImageClass { threshold: 2e-3, ..compare::PRECISION },
    }
}

/// Those that differ.
fn quadratures(program: &Program) -> &'static [Quadrature] {
    let all = &[Quadrature::Midpoint, Quadrature::Corrected];
    if program.media.is_empty() { &all[..1] } else { all }
}

/// The picture of the GPU against that of the CPU.
#[cfg(feature = "gpu")]
pub(crate) fn agrees(
    gpu: &vol_runtime_gpu::Gpu,
    program: &Program,
    quadrature: Quadrature,
) -> Result<(), Failed> {
    let frame = frame(program, 0.4, SIZE)?;
    let renderer = vol_runtime_gpu::Renderer::new(gpu, program)?;
    let job = Job { quadrature, ..JOB };
    let cpu = render(program, &frame, &job, 2)?;
    let cancelled = std::sync::atomic::AtomicBool::new(false);
    let rendered = renderer.render(gpu, program, &frame, &job, &|_| {}, &cancelled)?;
    let (image, counts) = rendered.ok_or("cancelled by nobody")?;
    ensure(counts.rays >= u64::from(SIZE[0] * SIZE[1]), || format!("{counts:?}"))?;
    let report = compare::images(&cpu, &image, compare::GPU_IMAGE);
    ensure(report.passes(), || format!("{quadrature:?} {report:?}"))?;
    // A sample beside a wall may fall on either side of it, and every other sample counts twice.
    let doubts = cpu.pixels.iter().zip(&image.pixels);
    let apart = doubts.filter(|(a, b)| (a.error - b.error).abs() > 1e-3).count();
    ensure(apart <= cpu.pixels.len() / 200, || {
        format!("{quadrature:?}: estimated errors differ in {apart} pixels")
    })
}
