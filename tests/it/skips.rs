//! What is left out of the work changes no picture: each way of it is switched off and the pictures are compared.

use crate::support::{compile_without, ensure, examples, frame, render};
use libtest_mimic::{Failed, Trial};
use std::path::Path;
use vol_compiler::frame::{Image, Job, Quadrature, Sampling};
use vol_compiler::skip::{self, Skip, Skips};

/// The trials of this file.
pub(crate) fn trials() -> Vec<Trial> {
    let mut trials = Vec::new();
    for row in skip::TABLE.iter().filter(|row| in_one_picture(row.skip)) {
        for (name, path) in examples() {
            trials
                .push(Trial::test(format!("skips::{}::{name}", row.name), move || neutral(row.skip, &path)));
        }
    }
    trials
}

/// Whether it matters to a picture by itself; what is kept from frame to frame is tried in `cli/animations.rs`.
fn in_one_picture(skip: Skip) -> bool {
    match skip {
        Skip::Cells | Skip::CurveBoxes | Skip::Opaque | Skip::Ranges => true,
        Skip::SameFrames | Skip::SameGrids => false,
    }
}

/// Largest difference of a pixel that a skip may make, relative to the brightest one: 0 is the same bits.
fn bound(skip: Skip) -> f32 {
    match skip {
        Skip::Opaque => 2.0_f32.powi(-16),
        Skip::Cells | Skip::CurveBoxes | Skip::SameFrames | Skip::SameGrids | Skip::Ranges => 0.0,
    }
}

fn neutral(skip: Skip, path: &Path) -> Result<(), Failed> {
    let text = std::fs::read_to_string(path)?;
    for quadrature in [Quadrature::Midpoint, Quadrature::Corrected] {
        let without = picture(&text, Skips::ALL.without(skip), quadrature)?;
        let with = picture(&text, Skips::ALL, quadrature)?;
        let colors = |image: &Image| image.pixels.iter().flat_map(|pixel| pixel.color).collect::<Vec<f32>>();
        let (without, with) = (colors(&without), colors(&with));
        let brightest = without.iter().copied().fold(0.0, f32::max);
        let apart = without.iter().zip(&with).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        ensure(apart <= bound(skip) * brightest, || format!("{apart:e} apart, brightest {brightest}"))?;
    }
    Ok(())
}

fn picture(text: &str, skips: Skips, quadrature: Quadrature) -> Result<Image, Failed> {
    let program = compile_without(text, skips)?;
    let size = [20, 12];
    let frame = frame(&program, 1.0, size)?;
    let step = vol_runtime_cpu::fixed_step_default(&frame);
    let job = Job { size, step, shadow_step: 2.0 * step, quadrature, sampling: Sampling::CENTRE };
    render(&program, &frame, &job, 2)
}
