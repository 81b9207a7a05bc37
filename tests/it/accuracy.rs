//! experiments
use crate::support::{compile, compile_file, frame};
use libtest_mimic::{Failed, Trial};
use std::sync::atomic::AtomicBool;
use vol_compiler::frame::{Frame, Job, Quadrature, Sampling};
use vol_compiler::program::Program;

pub(crate) fn trials() -> Vec<Trial> {
    vec![Trial::test("accuracy::table", table)]
}

fn colors(program: &Program, frame: &Frame, job: &Job) -> (Vec<f64>, u64) {
    let (image, stats) =
        vol_runtime_cpu::render(program, frame, job, None, &|_| {}, &AtomicBool::new(false)).unwrap();
    (
        image.pixels.iter().flat_map(|p| p.color).map(f64::from).collect(),
        stats.medium_samples + stats.shadow_samples,
    )
}

fn error(a: &[f64], b: &[f64]) -> f64 {
    let d: f64 = a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum();
    let w: f64 = b.iter().map(|b| b * b).sum();
    (d / w).sqrt()
}

fn table() -> Result<(), Failed> {
    let size = [48, 36];
    let list = std::env::var("SCENES").unwrap_or_default();
    let fine: f32 = std::env::var("FINE").ok().and_then(|v| v.parse().ok()).unwrap_or(0.004);
    for path in list.split_whitespace() {
        let program = compile_file(std::path::Path::new(path))?;
        let frame = frame(&program, 0.0, size)?;
        let job = |step: f32, ratio: f32, quadrature| Job {
            size,
            step,
            shadow_step: ratio * step,
            quadrature,
            sampling: Sampling::CENTRE,
        };
        let started = std::time::Instant::now();
        let (reference, _) = colors(&program, &frame, &job(fine, 1.0, Quadrature::Corrected));
        println!("{path}: reference in {:?}", started.elapsed());
        for max_error in [1e-2, 1e-3, 1e-4] {
            let started = std::time::Instant::now();
            let choice = vol_runtime_cpu::choose_step(&program, &frame, size, max_error);
            let pilot = started.elapsed();
            let started = std::time::Instant::now();
            let (picture, cost) = colors(&program, &frame, &choice.job(size, Sampling::CENTRE));
            println!(
                "  {max_error:.0e}: {choice:?} pilot {pilot:?} render {:?} cost {cost} ERROR {:.2e}",
                started.elapsed(),
                error(&picture, &reference)
            );
        }
        if std::env::var_os("LADDER").is_none() {
            continue;
        }
        for (quadrature, ratio) in [
            (Quadrature::Midpoint, 1.0),
            (Quadrature::Midpoint, 2.0),
            (Quadrature::Corrected, 1.0),
            (Quadrature::Corrected, 2.0),
        ] {
            let mut step = 0.128;
            while step > 2.5 * fine {
                let started = std::time::Instant::now();
                let (picture, cost) = colors(&program, &frame, &job(step, ratio, quadrature));
                println!(
                    "  {quadrature:?} ratio {ratio} step {step:.4} cost {cost:9} time {:?} error {:.2e}",
                    started.elapsed(),
                    error(&picture, &reference)
                );
                step *= 0.5;
            }
        }
    }
    let _ = compile;
    Ok(())
}
