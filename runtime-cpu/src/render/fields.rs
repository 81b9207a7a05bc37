//! Where the integrator gets the values of a program's functions from.

use crate::interp::{Evaluator, Tapes};
use crate::real::{Real, Vec3, add};
use std::ops::Range;
use vol_compiler::frame::Frame;
use vol_compiler::ir::FunctionId;
use vol_compiler::program::Program;
use vol_compiler::reference;

/// Evaluates functions for many points at once. Each point's results depend on that point alone.
pub(crate) trait Fields {
    /// The numbers that go in and come out.
    type Real: Real;

    /// One slice per input and per output of the function, all of one length.
    fn evaluate(&mut self, function: FunctionId, inputs: &[&[Self::Real]], outputs: &mut [&mut [Self::Real]]);

    /// The first `N` outputs at many points.
    fn sample<const N: usize>(
        &mut self,
        function: FunctionId,
        points: &Points<Self::Real>,
    ) -> [Vec<Self::Real>; N] {
        self.apply(function, &[&points.x, &points.y, &points.z])
    }

    /// The first output at many points, in place of what `values` holds.
    fn sample_one(
        &mut self,
        function: FunctionId,
        points: &Points<Self::Real>,
        values: &mut Vec<Self::Real>,
    ) {
        values.resize(points.len(), Self::Real::ZERO);
        if points.len() > 0 {
            self.evaluate(function, &[&points.x, &points.y, &points.z], &mut [values]);
        }
    }

    /// The outputs for many arguments.
    fn apply<const N: usize>(
        &mut self,
        function: FunctionId,
        inputs: &[&[Self::Real]],
    ) -> [Vec<Self::Real>; N] {
        let count = inputs[0].len();
        let mut outputs: [Vec<Self::Real>; N] = std::array::from_fn(|_| vec![Self::Real::ZERO; count]);
        if count > 0 {
            self.evaluate(function, inputs, &mut outputs.each_mut().map(Vec::as_mut_slice));
        }
        outputs
    }
}

/// Many points, one vector per coordinate.
#[derive(Clone, Debug)]
pub(crate) struct Points<R> {
    x: Vec<R>,
    y: Vec<R>,
    z: Vec<R>,
}

impl<R: Real> Points<R> {
    /// None yet.
    pub(crate) fn new() -> Self {
        Self { x: Vec::new(), y: Vec::new(), z: Vec::new() }
    }

    /// Adds one.
    pub(crate) fn push(&mut self, point: Vec3<R>) {
        self.x.push(point[0]);
        self.y.push(point[1]);
        self.z.push(point[2]);
    }

    /// Takes others in their place, as many as the iterator is long.
    pub(crate) fn set(&mut self, points: impl ExactSizeIterator<Item = Vec3<R>>) {
        [&mut self.x, &mut self.y, &mut self.z]
            .into_iter()
            .for_each(|column| column.resize(points.len(), R::ZERO));
        for (((x, y), z), point) in self.x.iter_mut().zip(&mut self.y).zip(&mut self.z).zip(points) {
            [*x, *y, *z] = point;
        }
    }

    /// None yet, with room for some.
    pub(crate) fn with_capacity(count: usize) -> Self {
        let [x, y, z] = std::array::from_fn(|_| Vec::with_capacity(count));
        Self { x, y, z }
    }

    /// As many, all at the origin.
    pub(crate) fn origins(count: usize) -> Self {
        let [x, y, z] = std::array::from_fn(|_| vec![R::ZERO; count]);
        Self { x, y, z }
    }

    /// Adds some of others.
    pub(crate) fn extend_from(&mut self, others: &Self, range: Range<usize>) {
        self.x.extend_from_slice(&others.x[range.clone()]);
        self.y.extend_from_slice(&others.y[range.clone()]);
        self.z.extend_from_slice(&others.z[range]);
    }

    /// Coordinates along each axis.
    #[inline(always)]
    pub(crate) fn rows(&mut self) -> [&mut [R]; 3] {
        [&mut self.x, &mut self.y, &mut self.z]
    }

    /// How many there are.
    pub(crate) fn len(&self) -> usize {
        self.x.len()
    }

    /// One of them.
    pub(crate) fn get(&self, index: usize) -> Vec3<R> {
        [self.x[index], self.y[index], self.z[index]]
    }
}

impl<R: Real> FromIterator<Vec3<R>> for Points<R> {
    fn from_iter<I: IntoIterator<Item = Vec3<R>>>(points: I) -> Self {
        let mut points = points.into_iter();
        // Those that are sure to come need no room made one by one.
        let mut all = Self::origins(points.size_hint().0);
        let places = all.x.iter_mut().zip(&mut all.y).zip(&mut all.z);
        for (((x, y), z), point) in places.zip(&mut points) {
            [*x, *y, *z] = point;
        }
        points.for_each(|point| all.push(point));
        all
    }
}

/// Many colours, one row per channel.
#[derive(Clone, Debug)]
pub(crate) struct Colors<R>(pub(crate) [Vec<R>; 3]);

impl<R: Real> FromIterator<Vec3<R>> for Colors<R> {
    fn from_iter<I: IntoIterator<Item = Vec3<R>>>(colors: I) -> Self {
        let Points { x, y, z } = colors.into_iter().collect();
        Self([x, y, z])
    }
}

impl<R: Real> Colors<R> {
    /// As many that are all alike in all channels.
    pub(crate) fn splat(value: R, count: usize) -> Self {
        Self(std::array::from_fn(|_| vec![value; count]))
    }

    /// How many there are.
    pub(crate) fn len(&self) -> usize {
        self.0[0].len()
    }

    /// One of them.
    #[inline(always)]
    pub(crate) fn get(&self, index: usize) -> Vec3<R> {
        let [r, g, b] = &self.0;
        [r[index], g[index], b[index]]
    }

    /// Puts one in another's place.
    #[inline(always)]
    pub(crate) fn set(&mut self, index: usize, color: Vec3<R>) {
        let [r, g, b] = &mut self.0;
        [r[index], g[index], b[index]] = color;
    }

    /// Adds to one of them.
    #[inline(always)]
    pub(crate) fn add(&mut self, index: usize, color: Vec3<R>) {
        self.set(index, add(self.get(index), color));
    }
}

/// The batch evaluator, f32.
pub(crate) struct Batch<'a> {
    evaluator: Evaluator<'a>,
}

impl<'a> Batch<'a> {
    /// An evaluator of its own for one thread.
    pub(crate) fn new(tapes: &'a Tapes, frame: &'a Frame) -> Self {
        Self { evaluator: Evaluator::new(tapes, frame) }
    }
}

impl Fields for Batch<'_> {
    type Real = f32;

    fn evaluate(&mut self, function: FunctionId, inputs: &[&[f32]], outputs: &mut [&mut [f32]]) {
        self.evaluator.evaluate(function, inputs, outputs);
    }
}

/// The reference evaluator: f64, one point after the other.
pub(crate) struct Reference<'a> {
    program: &'a Program,
    frame: &'a Frame,
}

impl<'a> Reference<'a> {
    /// The functions of a program in one frame.
    pub(crate) fn new(program: &'a Program, frame: &'a Frame) -> Self {
        Self { program, frame }
    }
}

impl Fields for Reference<'_> {
    type Real = f64;

    fn evaluate(&mut self, function: FunctionId, inputs: &[&[f64]], outputs: &mut [&mut [f64]]) {
        let function = self.program.module.function(function);
        for point in 0..inputs[0].len() {
            let arguments: Vec<f64> = inputs.iter().map(|input| input[point]).collect();
            let values = reference::evaluate(function, &arguments, &self.frame.uniforms, &self.frame.curves);
            for (output, value) in outputs.iter_mut().zip(values) {
                output[point] = value;
            }
        }
    }
}
