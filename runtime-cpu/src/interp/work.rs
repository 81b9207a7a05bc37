//! How much a tape has to do at a point, as a number that depends on no machine.
//!
//! Unit: additions. The weights are times of kernels on full batches over that of an addition, rounded; they are there
//! to compare places of a picture, not to foretell seconds. What boxes pass over on a curve, and what octaves skip,
//! is not looked at.

use super::{Evaluator, Tapes};
use vol_compiler::curve::CurveTable;
use vol_compiler::frame::Frame;
use vol_compiler::ir::FunctionId;
use vol_compiler::ops::{Op, operation};
use vol_compiler::tape::{Register, Tape, TapeOp};

/// Octaves of a sum where their number changes from point to point, or enters a loop.
const OCTAVES: u64 = 4;

/// A sum has no more, whatever is asked for.
const MOST_OCTAVES: f32 = 32.0;

/// Pieces of a curve that count: boxes pass over most of those beyond.
const PIECES: usize = 8;

/// What is the same at all points of a frame.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Known<'a> {
    pub(crate) uniforms: &'a [f32],
    pub(crate) curves: &'a [CurveTable],
}

impl<'a> Known<'a> {
    /// What a frame says.
    pub(crate) fn new(frame: &'a Frame) -> Self {
        Self { uniforms: &frame.uniforms_f32, curves: &frame.curve_tables }
    }

    /// Operations of one walk through a tape, in additions; without the bodies of its loops, which count whenever they
    /// run.
    pub(crate) fn work(&self, tape: &Tape) -> u64 {
        (0..tape.ops.len()).map(|step| self.work_of_step(tape, step)).sum()
    }

    /// [`Known::work`] of all tapes.
    pub(crate) fn works(&self, tapes: &Tapes) -> Vec<u64> {
        tapes.tapes.iter().map(|tape| self.work(tape)).collect()
    }

    /// Operations of one step of a tape, in additions; of a loop none.
    pub(crate) fn work_of_step(&self, tape: &Tape, step: usize) -> u64 {
        let (op, data, args) = match &tape.ops[step] {
            TapeOp::Apply { op, data, args, .. } => (op, data, args),
            TapeOp::ApplyScalar { op, .. } => return weight(*op),
            TapeOp::Constant { .. } | TapeOp::Input { .. } | TapeOp::Uniform { .. } | TapeOp::Loop { .. } => {
                return 0;
            }
        };
        let times = if matches!(op, Op::Fbm | Op::FbmGradient) {
            self.octaves(tape, step, args[3])
        } else if op.reads_curve() {
            self.curves.get(*data as usize).map_or(0, |curve| curve.pieces.len()).clamp(1, PIECES) as u64
        } else {
            1
        };
        times * weight(*op)
    }

    /// Octaves that a register holds before a step.
    fn octaves(&self, tape: &Tape, step: usize, register: Register) -> u64 {
        let writes =
            |to: Register, count: usize| (to.index()..to.index() + count).contains(&register.index());
        let written = |step: &TapeOp| match *step {
            TapeOp::Constant { to, value } => (to == register).then_some(Some(value)),
            TapeOp::Uniform { to, index } => {
                (to == register).then(|| self.uniforms.get(index as usize).copied())
            }
            TapeOp::Input { to, .. } | TapeOp::ApplyScalar { to, .. } => (to == register).then_some(None),
            TapeOp::Apply { op, to, .. } => writes(to, operation(op).results.len()).then_some(None),
            TapeOp::Loop { index, to } => writes(to, tape.loops[index as usize].state()).then_some(None),
        };
        let held = tape.ops[..step].iter().rev().find_map(written).flatten();
        held.map_or(OCTAVES, |value| value.min(MOST_OCTAVES).floor().max(0.0) as u64)
    }
}

/// Additions that take as long as an operation; of a sum for each octave, of a curve for each piece.
fn weight(op: Op) -> u64 {
    match op {
        Op::Add | Op::Sub | Op::Mul | Op::Div | Op::Sqrt => 1,
        Op::Min | Op::Max | Op::Neg | Op::Abs | Op::Floor => 1,
        Op::Less | Op::LessEqual | Op::Equal | Op::And | Op::Or | Op::Not | Op::Select => 1,
        Op::Acos => 2,
        Op::Exp2 | Op::Log2 | Op::Atan2 => 3,
        Op::Sin | Op::Cos => 4,
        Op::Perlin | Op::Fbm => 12,
        Op::Hash => 14,
        Op::Value => 16,
        Op::ValueGradient => 18,
        Op::PerlinGradient | Op::FbmGradient => 20,
        Op::Simplex => 26,
        Op::SimplexGradient => 35,
        Op::Closest | Op::ClosestGradient | Op::Foot => 100,
        Op::Worley | Op::WorleyGradient => 190,
        Op::Perlin4 => 250,
        Op::Perlin4Gradient => 450,
    }
}

impl<'a> Evaluator<'a> {
    /// What it knows of the frame.
    pub(super) fn known(&self) -> Known<'a> {
        Known { uniforms: self.uniforms, curves: self.curves }
    }

    /// [`Evaluator::evaluate`]; returns the operations of all points, in additions. Depends on nothing but the points.
    /// `works` is that of one walk through each tape.
    ///
    /// # Panics
    ///
    /// If slices are missing or differ in length.
    pub(crate) fn evaluate_counted(
        &mut self,
        function: FunctionId,
        inputs: &[&[f32]],
        outputs: &mut [&mut [f32]],
        works: &[u64],
    ) -> u64 {
        let points = outputs.first().map_or(0, |output| output.len() as u64);
        self.loop_work = Some(0);
        self.evaluate(function, inputs, outputs);
        points * works[function.index()] + self.loop_work.take().unwrap_or(0)
    }
}

#[cfg(test)]
mod tests {
    use super::Known;
    use vol_compiler::ir::text;
    use vol_compiler::tape::Tape;

    fn work(body: &str) -> u64 {
        let text = format!("fn f(3) {{\n%0 = input 0\n%1 = input 1\n%2 = input 2\n{body}\n}}");
        let known = Known { uniforms: &[3.0], curves: &[] };
        known.work(&Tape::new(&text::parse_function(&text).expect("well-formed text")))
    }

    #[test]
    fn octaves_count() {
        let sum = |octaves: &str| work(&format!("{octaves}\n%4 = fbm[7] %0 %1 %2 %3 %3 %3\nreturn %4"));
        let one = work("%3 = perlin[7] %0 %1 %2\nreturn %3");
        assert_eq!(sum("%3 = constant 1.0"), one);
        assert_eq!(sum("%3 = constant 8.0"), 8 * one);
        assert_eq!(sum("%3 = uniform 0"), 3 * one);
        assert_eq!(sum("%3 = floor %0"), super::OCTAVES * one + 1);
    }

    #[test]
    fn leaves_and_bodies_cost_nothing_themselves() {
        assert_eq!(work("%3 = add %0 %1\n%4 = mul %3 %2\nreturn %4"), 2);
        assert_eq!(work("return %0"), 0);
        let repeated = "%3 = loop 8 %0 {\n%0 = input 0\n%1 = add %0 %0\n%2 = less %0 %1\nreturn %1 %2\n}\n%4 = extract %3 0\nreturn %4";
        assert_eq!(work(repeated), 0);
    }
}
