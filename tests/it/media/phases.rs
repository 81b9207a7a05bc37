//! Phase functions in f32 against formulas in f64.

use super::{PI, henyey_greenstein};
use crate::support::{compile, ensure, frame};
use libtest_mimic::{Failed, Trial};
use vol_compiler::frame::Frame;
use vol_compiler::ir::FunctionId;
use vol_compiler::program::Program;

/// Relative error allowed (algorithms.md §7.3).
const ALLOWED: f64 = 1e-6;

/// Values of a function at rows of inputs.
type Evaluate = dyn Fn(&Program, &Frame, FunctionId, &[[f32; 2]]) -> Result<Vec<f32>, Failed>;

pub(super) fn trials() -> Vec<Trial> {
    vec![
        Trial::test("media::phases_keep_their_peaks__cpu", || peaks(&on_cpu)),
        #[cfg(feature = "gpu")]
        crate::gpu_device::gpu_trial("media::phases_keep_their_peaks", |gpu| {
            peaks(&|program, frame, id, inputs| {
                Ok(vol_runtime_gpu::evaluate(gpu, program, frame, id, inputs.as_flattened())?)
            })
        }),
    ]
}

fn on_cpu(program: &Program, frame: &Frame, id: FunctionId, inputs: &[[f32; 2]]) -> Result<Vec<f32>, Failed> {
    let tapes = vol_runtime_cpu::interp::Tapes::new(program);
    let columns: [Vec<f32>; 2] = std::array::from_fn(|i| inputs.iter().map(|row| row[i]).collect());
    let mut values = vec![0.0; inputs.len()];
    vol_runtime_cpu::interp::Evaluator::new(&tapes, frame).evaluate(
        id,
        &columns.each_ref().map(Vec::as_slice),
        &mut [&mut values],
    );
    Ok(values)
}

/// By `1 - cos` and `1 + cos`, whichever is small: `1 + g^2 - 2 g cos` loses digits in f64, too.
fn lobe(g: f64, versine: f64, coversine: f64) -> f64 {
    let away = if g < 0.0 { coversine } else { versine };
    (1.0 - g * g) / (4.0 * PI * ((1.0 - g.abs()).powi(2) + 2.0 * g.abs() * away).powf(1.5))
}

fn schlick(k: f64, versine: f64, coversine: f64) -> f64 {
    let away = if k < 0.0 { coversine } else { versine };
    (1.0 - k * k) / (4.0 * PI * (1.0 - k.abs() + k.abs() * away).powi(2))
}

/// Angles from 1e-6 off the peak to right behind it, on both sides.
fn inputs() -> Vec<[f32; 2]> {
    let mut inputs = vec![[0.0, 2.0], [2.0, 0.0], [1.0, 1.0]];
    for step in 0..400 {
        let small = 10.0_f64.powf(-12.0 + 12.0 * f64::from(step) / 400.0);
        let [small, large] = [small as f32, (2.0 - small) as f32];
        inputs.extend([[small, large], [large, small]]);
    }
    inputs
}

fn peaks(evaluate: &Evaluate) -> Result<(), Failed> {
    let inputs = inputs();
    ensure((lobe(0.3, 0.8, 1.2) - henyey_greenstein(0.3, 0.2)).abs() < 1e-15, || {
        "the formula is wrong".into()
    })?;
    for size in [0.0, 0.1, 0.5, 0.9, 0.99, 0.999, 0.9999] {
        for g in [size, -size] {
            let check = |text: String, expected: &dyn Fn(f64, f64) -> f64| {
                let program =
                    compile("phase.vol", &format!("medium m {{ region: sphere(1), phase: {text} }}"))?;
                let frame = frame(&program, 0.0, [4, 4])?;
                let found = evaluate(&program, &frame, program.media[0].phase, &inputs)?;
                for (&[versine, coversine], &found) in inputs.iter().zip(&found) {
                    let expected = expected(versine.into(), coversine.into());
                    let error = (f64::from(found) - expected).abs() / expected;
                    ensure(error <= ALLOWED, || {
                        format!(
                            "{text} at {versine:e}, {coversine:e}: {found} instead of {expected}, {error:e} off"
                        )
                    })?;
                }
                Ok::<(), Failed>(())
            };
            check(format!("henyey_greenstein({g})"), &|less, more| lobe(g, less, more))?;
            check(format!("schlick({g})"), &|less, more| schlick(g, less, more))?;
            check(format!("double_hg({g}, {}, 0.3)", -0.5 * g), &|less, more| {
                0.3 * lobe(g, less, more) + 0.7 * lobe(-0.5 * g, less, more)
            })?;
        }
    }
    Ok(())
}
