//! What each function of a scene costs, and what each of its parts.
//!
//! The render is the usual one, with the usual batches; only the evaluator is another, see `interp/meter.rs`, and the
//! picture is thrown away. Time is that of all threads added up.

use super::fields::Fields;
use super::film::{Watch, over_tiles};
use super::scene::{Batches, Integrator, Scene};
use crate::interp::meter::{FunctionCost, Meter, Stretches};
use crate::interp::work::Known;
use crate::interp::{Evaluator, Tapes};
use std::sync::atomic::AtomicBool;
use std::time::Instant;
use vol_compiler::frame::{Frame, Job};
use vol_compiler::ir::FunctionId;
use vol_compiler::program::Program;

/// What a render cost.
#[derive(Clone, Debug, PartialEq)]
pub struct Profile {
    /// By index of the program's functions; of those that the picture does not need 0.
    pub functions: Vec<FunctionCost>,
    /// Time outside of functions: rays, nodes, light; on all threads, added up.
    pub integrator_milliseconds: f64,
}

/// The batch evaluator, metered.
struct Metered<'a> {
    evaluator: Evaluator<'a>,
    meter: Meter<'a>,
}

impl Fields for Metered<'_> {
    type Real = f32;

    fn evaluate(&mut self, function: FunctionId, inputs: &[&[f32]], outputs: &mut [&mut [f32]]) {
        self.evaluator.evaluate_metered(function, inputs, outputs, &mut self.meter);
    }
}

/// Renders a picture by the comb and tells what it cost; `labels` has one for each instruction of each function, and
/// costs are told by label. `None` if `cancelled` was set before the last tile.
///
/// Counts depend on the arguments alone. How exact times are: `docs/profile.md`.
#[must_use]
pub fn profile(
    program: &Program,
    frame: &Frame,
    job: &Job,
    labels: &[Vec<u32>],
    progress: &(dyn Fn(u64) + Sync),
    cancelled: &AtomicBool,
) -> Option<Profile> {
    let scene = Scene::<f32>::new(frame, job);
    let tapes = Tapes::new(program);
    let stretches = Stretches::new(&tapes, Known::new(frame), labels);
    let tiles = over_tiles(job.size, &Watch { progress, cancelled }, |tile| {
        let started = Instant::now();
        // Neighbouring tiles do alike: each looks at batches of its own.
        let meter = Meter::new(&stretches, u64::from(tile.x + tile.y));
        let fields = Metered { evaluator: Evaluator::new(&tapes, frame), meter };
        let mut integrator = Integrator::new(&scene, fields, Batches::DEFAULT);
        let pixels: Vec<_> = tile.pixels().collect();
        integrator.sample_pixels(&pixels, &job.sampling, cancelled)?;
        Some((integrator.fields.meter, started.elapsed().as_secs_f64() * 1e3))
    })?;
    let mut sum = Meter::new(&stretches, 0);
    let mut milliseconds = 0.0;
    for (meter, elapsed) in &tiles {
        sum.add(meter);
        milliseconds += elapsed;
    }
    let functions = sum.costs();
    let inside: f64 = functions.iter().map(|function| function.milliseconds).sum();
    let integrator_milliseconds = (milliseconds - sum.own_time() * 1e-6 - inside).max(0.0);
    Some(Profile { functions, integrator_milliseconds })
}
