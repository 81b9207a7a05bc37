use crate::support::{compile, compile_file, frame};
use libtest_mimic::{Failed, Trial};
use std::sync::atomic::AtomicBool;
use vol_compiler::frame::{Frame, Job, Quadrature, Sampling};
use vol_compiler::program::Program;
pub(crate) fn trials() -> Vec<Trial> {
    vec![Trial::test("ladder::table", table)]
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
    let number =
        |name: &str, default: f32| std::env::var(name).ok().and_then(|v| v.parse().ok()).unwrap_or(default);
    let width = number("WIDTH", 24.0) as u32;
    let size = [width, width * 3 / 4];
    let (fine, first, last) = (number("FINE", 0.002), number("FIRST", 0.064), number("LAST", 0.004));
    for path in std::env::var("SCENES").unwrap_or_default().split_whitespace() {
        let program = if path == "walls" {
            compile(
                "walls",
                "medium m { region: box((0.7, 0.5, 0.6)).rotate_y(25deg), density: q => 2 + q.world.x, absorb: 0.3 }\nlight l { from: (1, 2, 1), color: 6 }\ncamera { from: (0.4, 0.8, 4), at: (0, 0, 0), fov: 30deg }",
            )?
        } else {
            compile_file(std::path::Path::new(path))?
        };
        let frame = frame(&program, 0.0, size)?;
        let job = |step: f32, ratio: f32, quadrature| Job {
            size,
            step,
            shadow_step: ratio * step,
            quadrature,
            sampling: Sampling::CENTRE,
        };
        let (reference, _) = colors(&program, &frame, &job(fine, 1.0, Quadrature::Corrected));
        let (witness, _) = colors(&program, &frame, &job(fine, 1.0, Quadrature::Midpoint));
        println!("{path}: reference and witness {:.1e}", error(&witness, &reference));
        for (quadrature, ratio) in [
            (Quadrature::Midpoint, 2.0),
            (Quadrature::Corrected, 2.0),
            (Quadrature::Midpoint, 1.0),
            (Quadrature::Corrected, 1.0),
        ] {
            let mut step = first;
            while step >= last {
                let (picture, cost) = colors(&program, &frame, &job(step, ratio, quadrature));
                println!(
                    "  {quadrature:?} ratio {ratio} step {step:.4} cost {cost:9} error {:.2e}",
                    error(&picture, &reference)
                );
                step *= 0.5;
            }
        }
    }
    Ok(())
}
