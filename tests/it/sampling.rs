//! Several samples per pixel: edges against their exact area, and both backends against each other.

use crate::support::{compile, compile_file, ensure, frame, render};
use libtest_mimic::{Failed, Trial};
use std::path::Path;
use vol::compare;
use vol_compiler::frame::{Frame, Image, Job, Quadrature, Sampling};
use vol_compiler::program::Program;

/// The trials of this file.
pub(crate) fn trials() -> Vec<Trial> {
    vec![
        Trial::test("sampling::edges_cover_their_area", || {
            edges(&|program, frame, job| render(program, frame, job, 2))
        }),
        #[cfg(feature = "gpu")]
        crate::gpu_device::gpu_trial("sampling::edges_cover_their_area", |gpu| {
            edges(&|program, frame, job| Ok(on_gpu(gpu, program, frame, job)?.0))
        }),
        #[cfg(feature = "gpu")]
        crate::gpu_device::gpu_trial("sampling::adaptive_solids_agree_with_the_cpu", |gpu| {
            agrees(gpu, "examples/csg.vol", Sampling { most: 60, tolerance: 0.03 })
        }),
        #[cfg(feature = "gpu")]
        crate::gpu_device::gpu_trial("sampling::adaptive_media_agree_with_the_cpu", |gpu| {
            agrees(gpu, "examples/tornado.vol", Sampling { most: 40, tolerance: 0.05 })
        }),
        #[cfg(feature = "gpu")]
        crate::gpu_device::gpu_trial("sampling::many_dispatches_are_one_mean", |gpu| {
            agrees(gpu, "examples/displaced.vol", Sampling::uniform(77))
        }),
    ]
}

/// Sides of the edges' pictures in pixels, and of the plate from the axis to its edge.
const SIDE: u32 = 24;
const REACH: f64 = 0.31;

type Renderer<'a> = dyn Fn(&Program, &Frame, &Job) -> Result<Image, Failed> + 'a;

/// The edge of a glowing plate in front of the camera: where it is in the picture is known exactly.
///
/// Rms error of the coverage over the pixels that it crosses, for 4, 16, 64 and 256 samples.
fn edges(render: &Renderer<'_>) -> Result<(), Failed> {
    for (samples, allowed) in [(4, 0.16), (16, 0.056), (64, 0.018), (256, 0.0075)] {
        let (mut squares, mut crossed) = (0.0, 0);
        for degrees in [3.0_f64, 17.0, 31.0, 45.0, 78.0] {
            let scene = format!(
                "object plate {{ shape: box((9, {REACH}, 0.5)).translate((0, 0, -0.5)).rotate_z({degrees}deg), \
                 material: flat(1) }}\ncamera {{ from: (0, 0, 2), at: (0, 0, 0), fov: 40deg }}\n"
            );
            let program = compile("edge.vol", &scene)?;
            let size = [SIDE; 2];
            let sampling = Sampling::uniform(samples);
            let job = Job { size, step: 1.0, shadow_step: 1.0, quadrature: Quadrature::Midpoint, sampling };
            let image = render(&program, &frame(&program, 0.0, size)?, &job)?;
            for (index, pixel) in (0..).zip(&image.pixels) {
                let exact = coverage(degrees.to_radians(), [index % SIDE, index / SIDE]);
                let off = f64::from(pixel.color[0]) - exact;
                if exact > 0.0 && exact < 1.0 {
                    squares += off * off;
                    crossed += 1;
                } else {
                    ensure(off.abs() < 1e-6, || format!("pixel {index}: {} for {exact}", pixel.color[0]))?;
                }
                let covered = 1.0 - pixel.transmittance[0];
                ensure((covered - pixel.color[0]).abs() < 1e-6, || format!("{pixel:?}"))?;
            }
        }
        let rms = (squares / f64::from(crossed)).sqrt();
        ensure(crossed > 200 && rms < allowed, || format!("{samples} samples: {rms} over {crossed} pixels"))?;
    }
    Ok(())
}

/// The share of a pixel that the plate covers, in the limit of many strips across the pixel.
fn coverage(turn: f64, [column, row]: [u32; 2]) -> f64 {
    // Half the picture's height on the plate's face is 2 tan 20deg; v in pixels from the middle.
    let reach = REACH * f64::from(SIDE) / (4.0 * 20_f64.to_radians().tan());
    let middle = 0.5 * f64::from(SIDE);
    let (sin, cos) = turn.sin_cos();
    let strips = 2000;
    let across = |strip: u32| {
        let x = f64::from(column) + (f64::from(strip) + 0.5) / f64::from(strips) - middle;
        // |y cos - x sin| < reach, y up.
        let [top, bottom] = [middle - f64::from(row), middle - f64::from(row + 1)];
        let [low, high] = [-reach, reach].map(|side| (side + x * sin) / cos);
        (top.min(high) - bottom.max(low)).max(0.0)
    };
    let covered = (0..strips).map(across).sum::<f64>() / f64::from(strips);
    // Nearly nothing and nearly all are rounding.
    if covered < 1e-9 {
        0.0
    } else if covered > 1.0 - 1e-9 {
        1.0
    } else {
        covered
    }
}

#[cfg(feature = "gpu")]
fn on_gpu(
    gpu: &vol_runtime_gpu::Gpu,
    program: &Program,
    frame: &Frame,
    job: &Job,
) -> Result<(Image, vol_compiler::frame::Counts), Failed> {
    let renderer = vol_runtime_gpu::Renderer::new(gpu, program)?;
    let cancelled = std::sync::atomic::AtomicBool::new(false);
    let rendered = renderer.render(gpu, program, frame, job, &|_| {}, &cancelled)?;
    rendered.ok_or_else(|| "cancelled by nobody".into())
}

/// The pictures of both backends, and how many rays they took.
#[cfg(feature = "gpu")]
fn agrees(gpu: &vol_runtime_gpu::Gpu, scene: &str, sampling: Sampling) -> Result<(), Failed> {
    let program = compile_file(&Path::new(env!("CARGO_MANIFEST_DIR")).join(scene))?;
    let size = [33, 20];
    let frame = frame(&program, 0.4, size)?;
    let job = Job { size, step: 0.1, shadow_step: 0.2, quadrature: Quadrature::Midpoint, sampling };
    let idle = std::sync::atomic::AtomicBool::new(false);
    let rendered = vol_runtime_cpu::render(&program, &frame, &job, Some(2), &|_| {}, &idle);
    let (cpu, stats) = rendered.ok_or("cancelled by nobody")?;
    let (gpu, counts) = on_gpu(gpu, &program, &frame, &job)?;
    let report = compare::images(&cpu, &gpu, compare::GPU_IMAGE);
    ensure(report.passes(), || format!("{report:?}"))?;
    // A pixel that nearly has enough may take another round of eight.
    let apart = counts.camera_rays.abs_diff(stats.rays);
    let pixels = u64::from(size[0] * size[1]);
    ensure(100 * apart <= 8 * pixels, || {
        format!("{} rays on the CPU, {} on the GPU", stats.rays, counts.camera_rays)
    })?;
    let all = u64::from(sampling.most) * pixels;
    let (least, most) = if sampling.tolerance > 0.0 { (13 * pixels, all) } else { (all, all) };
    ensure((least..=most).contains(&counts.camera_rays) && counts.rays >= counts.camera_rays, || {
        format!("{counts:?}")
    })
}
