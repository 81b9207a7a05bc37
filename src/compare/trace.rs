//! Where two backends begin to differ: the first number of a function, in the order in which it is computed, that is
//! farther apart than it may be.

use vol_compiler::error_bound;
use vol_compiler::frame::Frame;
use vol_compiler::ir::{FunctionId, Inst, ValueId};
use vol_compiler::ops;
use vol_compiler::program::Program;
use vol_language::source::Span;

use crate::backend::Device;
use crate::failure::Failure;
use crate::probe::Probe;

/// A number that is computed differently.
#[derive(Clone, Debug)]
pub struct Difference {
    /// What computes it, `fbm` or `mul`.
    pub operation: &'static str,
    /// What in the scene it stands for, as far as that is known.
    pub place: Option<Span>,
    /// Its value on each device.
    pub values: [f32; 2],
    /// How far apart the two may be.
    pub allowed: f64,
}

/// The first number of a function at a point that two devices compute differently; none if there is none.
///
/// Two devices that round as they may are at most twice the running error bound apart; two of strict arithmetic have
/// the same bits. Where the reference decides nothing, nothing is allowed for and nothing is found.
///
/// # Errors
/// A device failure.
pub fn first_difference(
    program: &Program,
    frame: &Frame,
    function: FunctionId,
    point: [f32; 3],
    devices: [&Device; 2],
    strict: bool,
) -> Result<Option<Difference>, Failure> {
    let plain = program.module.function(function);
    let probe = Probe::new(plain);
    let expected = error_bound::evaluate(&probe.function, &point, &frame.uniforms, &frame.curves);
    let mut probed = program.clone();
    probed.module.functions[function.index()] = probe.function.clone();
    let [a, b] = devices.map(|device| device.evaluate(&probed, frame, function, &[point]));
    let (a, b) = (a?, b?);
    let allowed: Vec<f64> =
        expected.iter().map(|bounded| if strict { 0.0 } else { 2.0 * bounded.error }).collect();
    let places =
        program.origins.get(function.index()).map(|origins| origins.places(plain)).unwrap_or_default();
    Ok(parting(&probe, &allowed, [&a, &b]).map(|(value, output)| {
        let whole = whole(&plain.insts, value);
        Difference {
            operation: operation(&plain.insts[whole.index()]),
            place: [whole, value].iter().find_map(|value| *places.get(value.index())?),
            values: [a[output], b[output]],
            allowed: allowed[output],
        }
    }))
}

/// The first value whose two numbers have other bits and are farther apart than allowed, and which output it is.
fn parting(probe: &Probe, allowed: &[f64], [a, b]: [&[f32]; 2]) -> Option<(ValueId, usize)> {
    let differs = |output: usize| {
        let (a, b) = (a[output], b[output]);
        a.to_bits() != b.to_bits() && f64::from(a - b).abs() > allowed[output]
    };
    let outputs = (0..).map(ValueId).zip(&probe.outputs);
    outputs.filter_map(|(value, output)| Some((value, (*output)?))).find(|&(_, output)| differs(output))
}

/// What a value is a part of, if it is one.
fn whole(insts: &[Inst], value: ValueId) -> ValueId {
    if let Inst::Extract(tuple, _) = insts[value.index()] { tuple } else { value }
}

fn operation(inst: &Inst) -> &'static str {
    match inst {
        Inst::Apply { op, .. } => ops::operation(*op).name,
        Inst::Loop { .. } => "iterate",
        Inst::Uniform(_) => "a number of this moment",
        Inst::Constant(_) | Inst::Boolean(_) | Inst::Input(_) | Inst::Extract(..) => "a number",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use vol_compiler::ir::text;

    #[test]
    fn the_first_number_that_is_too_far_apart_is_found() {
        let body = "fn f(2) {\n%0 = input 0\n%1 = input 1\n%2 = less %0 %1\n%3 = mul %0 %1\n%4 = add %3 %0\nreturn %4\n}";
        let probe = Probe::new(&text::parse_function(body).expect("well-formed text"));
        // A truth is no output.
        assert_eq!(probe.outputs, [Some(0), Some(1), None, Some(2), Some(3)]);
        let (right, wrong) = ([2.0, 3.0, 6.0, 8.0], [2.0, 3.0, 6.000_001, 8.1]);
        let first = |allowed: [f64; 4]| parting(&probe, &allowed, [&right, &wrong]);
        assert_eq!(first([0.0; 4]), Some((ValueId(3), 2)));
        assert_eq!(first([0.0, 0.0, 1e-5, 1e-5]), Some((ValueId(4), 3)));
        assert_eq!(first([0.0, 0.0, 1e-5, 0.5]), None);
    }
}
