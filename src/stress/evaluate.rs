//! The functions of a frame in f32, in f64, and in f64 with error bounds.

use rayon::prelude::*;
use vol_compiler::error_bound::{self, Bounded};
use vol_compiler::frame::Frame;
use vol_compiler::ir::FunctionId;
use vol_compiler::program::Program;
use vol_compiler::reference;
use vol_runtime_cpu::interp::{self, Tapes};

use crate::backend::Device;
use crate::failure::Failure;

/// Rows that one thread takes at a time.
const CHUNK: usize = 256;

/// What evaluates functions in one frame.
pub(super) struct Evaluator<'a> {
    pub(super) program: &'a Program,
    pub(super) frame: &'a Frame,
    pub(super) devices: &'a [&'a Device],
    tapes: Tapes,
}

impl<'a> Evaluator<'a> {
    pub(super) fn new(program: &'a Program, frame: &'a Frame, devices: &'a [&'a Device]) -> Self {
        Self { program, frame, devices, tapes: Tapes::new(program) }
    }

    /// How many numbers go in and come out.
    pub(super) fn shape(&self, function: FunctionId) -> (usize, usize) {
        let function = self.program.module.function(function);
        (function.inputs as usize, function.outputs.len())
    }

    /// Results in f64.
    pub(super) fn exact(&self, function: FunctionId, inputs: &[f64]) -> Vec<f64> {
        let function = self.program.module.function(function);
        reference::evaluate(function, inputs, &self.frame.uniforms, &self.frame.curves)
    }

    /// The first result in f64.
    pub(super) fn number(&self, function: FunctionId, inputs: &[f64]) -> f64 {
        self.exact(function, inputs)[0]
    }

    /// Results in f64 with error bounds, rows one after the other.
    pub(super) fn bounded(&self, function: FunctionId, rows: &[f32]) -> Vec<Bounded> {
        let (width, _) = self.shape(function);
        let function = self.program.module.function(function);
        let at = |row: &[f32]| error_bound::evaluate(function, row, &self.frame.uniforms, &self.frame.curves);
        rows.par_chunks(width).flat_map_iter(at).collect()
    }

    /// Results in f32 on the CPU, rows one after the other.
    pub(super) fn single(&self, function: FunctionId, rows: &[f32]) -> Vec<f32> {
        let (width, outputs) = self.shape(function);
        let chunk = |rows: &[f32]| {
            let count = rows.len() / width;
            let columns: Vec<Vec<f32>> =
                (0..width).map(|i| rows.iter().skip(i).step_by(width).copied().collect()).collect();
            let columns: Vec<&[f32]> = columns.iter().map(Vec::as_slice).collect();
            let mut results = vec![vec![0.0; count]; outputs];
            let mut slices: Vec<&mut [f32]> = results.iter_mut().map(Vec::as_mut_slice).collect();
            interp::Evaluator::new(&self.tapes, self.frame).evaluate(function, &columns, &mut slices);
            let row = |i: usize| results.iter().map(move |column| column[i]);
            (0..count).flat_map(row).collect::<Vec<f32>>()
        };
        rows.par_chunks(width * CHUNK).flat_map_iter(chunk).collect()
    }

    /// Results in f32 on a device, rows one after the other.
    pub(super) fn on(
        &self,
        device: &Device,
        function: FunctionId,
        rows: &[f32],
    ) -> Result<Vec<f32>, Failure> {
        match device {
            Device::Cpu => Ok(self.single(function, rows)),
            #[cfg(feature = "gpu")]
            Device::Gpu(gpu) => vol_runtime_gpu::evaluate(gpu, self.program, self.frame, function, rows)
                .map_err(|error| Failure::device(error.to_string())),
        }
    }
}
