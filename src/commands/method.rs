//! `--integrator` and its settings: which go together, and what they make of a frame.

use vol::failure::Failure;
use vol::session::{Moment, Session};
use vol_compiler::frame::{Frame, Job, Quadrature, Sampling};
use vol_compiler::program::Program;
use vol_runtime_cpu::{FilledGrids, GridChoice, Method, TubeBounds};

use crate::cli::{self, Integrator};

/// Paths per pixel where none are asked for.
const PATHS: u32 = 64;

/// Error allowed of the comb where none is asked for.
pub(super) const MAX_ERROR: f32 = 1e-2;

/// How one picture is to be computed.
#[derive(Debug)]
pub(super) struct Plan {
    pub(super) method: Method,
    pub(super) job: Job,
    /// Whether the steps of the job mean anything.
    pub(super) has_steps: bool,
    /// What the pilot and the tests of the grids say of the error.
    pub(super) estimate: Option<f32>,
    /// What was chosen for each light.
    pub(super) grids: Vec<GridChoice>,
}

/// Finds settings that mean nothing together.
pub(super) fn check(arguments: &cli::Render) -> Result<(), Failure> {
    let (integrator, fixed) = (arguments.integrator, &arguments.fixed);
    let [is_comb, is_fixed, is_random] =
        [Integrator::Comb, Integrator::FixedStep, Integrator::MonteCarlo].map(|other| integrator == other);
    for (option, given, means_something, of) in [
        ("--step", fixed.step.is_some(), is_fixed, "fixed-step"),
        ("--light-step", fixed.light_step.is_some(), is_fixed, "fixed-step"),
        ("--jitter", fixed.jitter, is_fixed, "fixed-step"),
        ("--tube-bounds", fixed.tube_bounds.is_some(), is_fixed, "fixed-step"),
        ("--step-scale", arguments.step_scale.is_some(), is_comb, "comb"),
        ("--max-error", arguments.max_error.is_some(), is_comb, "comb"),
        ("--adaptive", arguments.adaptive.is_some(), !is_random, "comb"),
    ] {
        if given && !means_something {
            let name = name(integrator);
            let text = format!("`{option}` means nothing with `--integrator {name}`");
            return Err(Failure::usage(text).with_help(format!("leave it out, or use `--integrator {of}`")));
        }
    }
    if !is_comb && matches!(arguments.backend, cli::Backend::Gpu) {
        let text = format!("the integrator `{}` runs on the CPU only", name(integrator));
        return Err(Failure::usage(text).with_help("leave `--backend gpu` out, or use `--integrator comb`"));
    }
    if arguments.aov.is_some() && matches!(arguments.backend, cli::Backend::Gpu) {
        let failure = Failure::usage("costs are counted on the CPU only");
        return Err(failure.with_help("leave `--backend gpu` out, or `--aov cost`"));
    }
    Ok(())
}

/// The integrator as it is typed.
pub(super) fn name(integrator: Integrator) -> &'static str {
    match integrator {
        Integrator::Comb => "comb",
        Integrator::FixedStep => "fixed-step",
        Integrator::MonteCarlo => "monte-carlo",
    }
}

/// Whether fixed steps are jittered; nothing of other integrators.
pub(super) fn jitter(arguments: &cli::Render) -> Option<bool> {
    (arguments.integrator == Integrator::FixedStep).then_some(arguments.fixed.jitter)
}

/// How fixed steps find tubes, as it is typed; nothing of other integrators.
pub(super) fn tube_bounds(arguments: &cli::Render) -> Option<&'static str> {
    let name = match arguments.fixed.tube_bounds {
        Some(cli::TubeBounds::SphereMarch) => "sphere-march",
        Some(cli::TubeBounds::Cells) | None => "cells",
    };
    (arguments.integrator == Integrator::FixedStep).then_some(name)
}

/// Error allowed; nothing of other integrators than the comb.
pub(super) fn max_error(arguments: &cli::Render) -> Option<f32> {
    (arguments.integrator == Integrator::Comb).then_some(arguments.max_error.unwrap_or(MAX_ERROR))
}

/// How many samples a pixel takes: those of the scene or the command line, but as many random paths as the
/// command line says, whatever the scene takes to smooth its edges.
pub(super) fn sampling(
    arguments: &cli::Render,
    session: &Session,
    params: &[Vec<f64>],
    moment: Moment,
) -> Result<Sampling, Failure> {
    if arguments.integrator == Integrator::MonteCarlo {
        return Ok(Sampling::uniform(arguments.samples.unwrap_or(PATHS)));
    }
    session.sampling(params, moment, arguments.samples, arguments.adaptive)
}

/// Chooses the method, its steps and the grids of the frame's lights; the pilot of the comb takes a while.
/// Grids that were `filled` for other frames need not be filled again.
pub(super) fn plan(
    arguments: &cli::Render,
    program: &Program,
    frame: &mut Frame,
    size: [u32; 2],
    sampling: Sampling,
    filled: &mut FilledGrids,
) -> Plan {
    let seed = arguments.seed;
    let job = |step, shadow_step| {
        let quadrature = Quadrature::Midpoint;
        Job { size, step, shadow_step, quadrature, sampling }
    };
    match arguments.integrator {
        Integrator::Comb => {
            let max_error = arguments.max_error.unwrap_or(MAX_ERROR);
            let scale = arguments.step_scale.unwrap_or(1.0);
            let chosen = vol_runtime_cpu::choose_with(program, frame, size, sampling, max_error, filled);
            // Not so short that rays would end before they are through.
            let scaled = |step: f32| (scale * step).max(vol_runtime_cpu::least_step(frame));
            let (step, shadow_step) = (scaled(chosen.job.step), scaled(chosen.job.shadow_step));
            Plan {
                method: Method::Comb,
                job: Job { step, shadow_step, ..chosen.job },
                has_steps: true,
                estimate: Some(chosen.estimate),
                grids: chosen.grids,
            }
        }
        Integrator::FixedStep => {
            let step = arguments.fixed.step.unwrap_or_else(|| vol_runtime_cpu::fixed_step_default(frame));
            let tube_bounds = match arguments.fixed.tube_bounds {
                Some(cli::TubeBounds::SphereMarch) => TubeBounds::SphereMarch,
                Some(cli::TubeBounds::Cells) | None => TubeBounds::Cells,
            };
            Plan {
                method: Method::FixedStep { jitter: arguments.fixed.jitter.then_some(seed), tube_bounds },
                job: job(step, arguments.fixed.light_step.unwrap_or(step)),
                has_steps: true,
                estimate: None,
                grids: Vec::new(),
            }
        }
        Integrator::MonteCarlo => Plan {
            method: Method::MonteCarlo { seed },
            job: job(1.0, 1.0),
            has_steps: false,
            estimate: None,
            grids: Vec::new(),
        },
    }
}
