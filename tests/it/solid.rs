//! One solid, evaluated in f64 by the reference and in f32 by the CPU.

use crate::support::{Random, compile, frame};
use libtest_mimic::Failed;
use vol::backend::Device;
use vol_compiler::frame::{Frame, Stride};
use vol_compiler::ir::FunctionId;
use vol_compiler::program::Program;
use vol_compiler::reference;

/// A compiled shape, and its first frame.
pub(crate) struct Solid {
    program: Program,
    pub(crate) frame: Frame,
}

impl Solid {
    /// A shape from its text.
    pub(crate) fn new(shape: &str) -> Result<Self, Failed> {
        Self::with("", shape)
    }

    /// A shape in a scene with further declarations.
    pub(crate) fn with(declarations: &str, shape: &str) -> Result<Self, Failed> {
        let program = compile("shape.vol", &format!("{declarations}\nobject o {{ shape: {shape} }}"))?;
        let frame = frame(&program, 0.0, [8, 8])?;
        Ok(Self { program, frame })
    }

    /// The function of the distance as text.
    pub(crate) fn text(&self) -> String {
        format!("{:?}", self.program.module.function(self.program.objects[0].distance))
    }

    /// Distance in f64.
    pub(crate) fn exact(&self, p: [f64; 3]) -> f64 {
        self.reference(self.program.objects[0].distance, &p)[0]
    }

    /// By what values are multiplied where a ray walks from one place to another.
    pub(crate) fn safe_scale(&self, p: [f64; 3], q: [f64; 3]) -> f64 {
        match self.frame.objects[0].stride {
            Stride::Scale(scale) => f64::from(scale),
            Stride::Within(steepness) => {
                let corners = [[0, 1, 2].map(|i| p[i].min(q[i])), [0, 1, 2].map(|i| p[i].max(q[i]))].concat();
                1.0 / self.reference(steepness, &corners)[0]
            }
        }
    }

    /// Gradient in f64.
    pub(crate) fn slope(&self, p: [f64; 3]) -> [f64; 3] {
        let slope = self.reference(self.program.objects[0].gradient, &p);
        [slope[0], slope[1], slope[2]]
    }

    fn reference(&self, function: FunctionId, inputs: &[f64]) -> Vec<f64> {
        let function = self.program.module.function(function);
        reference::evaluate(function, inputs, &self.frame.uniforms, &self.frame.curves)
    }

    /// Distances in f32.
    pub(crate) fn distances(&self, points: &[[f32; 3]]) -> Result<Vec<f32>, Failed> {
        self.on_cpu(self.program.objects[0].distance, points)
    }

    /// Gradients in f32.
    pub(crate) fn slopes(&self, points: &[[f32; 3]]) -> Result<Vec<[f32; 3]>, Failed> {
        let numbers = self.on_cpu(self.program.objects[0].gradient, points)?;
        Ok(numbers.as_chunks::<3>().0.to_vec())
    }

    fn on_cpu(&self, function: FunctionId, points: &[[f32; 3]]) -> Result<Vec<f32>, Failed> {
        let values = Device::Cpu.evaluate(&self.program, &self.frame, function, points);
        values.map_err(|failure| format!("{failure:?}").into())
    }
}

/// `p + t v`
pub(crate) fn along(p: [f64; 3], v: [f64; 3], t: f64) -> [f64; 3] {
    [0, 1, 2].map(|i| p[i] + t * v[i])
}

/// Euclidean length.
pub(crate) fn length(v: [f64; 3]) -> f64 {
    v.iter().map(|c| c * c).sum::<f64>().sqrt()
}

/// A direction, all alike.
pub(crate) fn direction(random: &mut Random) -> [f64; 3] {
    loop {
        let v = [(); 3].map(|()| random.between(-1.0, 1.0));
        let size = length(v);
        if size > 0.1 && size < 1.0 {
            return v.map(|c| c / size);
        }
    }
}
