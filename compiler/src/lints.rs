//! What is suspicious about a scene at one moment, found by interval evaluation over its media.
//!
//! In: a program and a frame of it. Out: warnings. Each is sure to be true of that frame: intervals
//! only ever overestimate what a medium holds, and the place named for a large coordinate is one that
//! is reached.

use crate::frame::{Aabb, Frame};
use crate::ir::{Function, Inst};
use crate::ops::Op;
use crate::ops::interval::Interval;
use crate::program::{Medium, Program};
use crate::reference;
use std::ops::Range;
use vol_language::diag::Diagnostic;

/// Codes of this module with what each is about.
pub const CODES: &[(&str, &str)] = &[
    ("W0402", "a medium is empty everywhere"),
    ("W0403", "noise is asked for at coordinates that f32 resolves too coarsely"),
];

/// Cells along each side of a medium's bounds in which its contents are bounded.
const CELLS: usize = 8;

/// Noise coordinates from here on have at most seven bits left for the place within a cell.
const LARGE: f64 = 131_072.0;

/// Largest half extent of bounds that are looked at; larger ones stand for all of space.
const UNBOUNDED: f32 = 1e6;

/// The warnings about a frame of a program.
#[must_use]
pub fn warnings(program: &Program, frame: &Frame) -> Vec<Diagnostic> {
    let media = frame.media.iter().flat_map(|medium| {
        let block = &program.media[medium.index];
        let (interior, bounds) = (program.module.function(medium.interior), medium.bounds);
        [empty(block, interior, bounds, frame), coarse(block, interior, bounds, frame)]
    });
    media.flatten().collect()
}

fn empty(medium: &Medium, interior: &Function, bounds: Aabb, frame: &Frame) -> Option<Diagnostic> {
    let is_bounded = (0..3).all(|i| bounds.lo[i] > -UNBOUNDED && bounds.hi[i] < UNBOUNDED);
    let is_nowhere = (0..3).any(|i| bounds.lo[i] > bounds.hi[i]);
    if !is_bounded || is_nowhere {
        return None;
    }
    let holds_something = (0..CELLS.pow(3)).any(|cell| {
        let results = reference::interval(interior, &cell_of(bounds, cell), &frame.uniforms, &frame.curves);
        // A bound that is no number says nothing.
        let some = |result: &Interval| result.hi > 0.0 || result.hi.is_nan();
        some(&results[0]) && results[1..].iter().any(some)
    });
    if holds_something {
        return None;
    }
    let message = format!("the medium `{}` is empty everywhere", medium.name);
    let label = "it neither scatters, absorbs nor emits at any point";
    Some(
        Diagnostic::warning("W0402", message, medium.span, label)
            .with_help("raise `density`, or lower the `cutoff` of a cloud; below 0 a density counts as 0, and noise is negative half of the time"),
    )
}

fn coarse(medium: &Medium, interior: &Function, bounds: Aabb, frame: &Frame) -> Option<Diagnostic> {
    let middle =
        (0..3).map(|i| 0.5 * (f64::from(bounds.lo[i]) + f64::from(bounds.hi[i]))).collect::<Vec<_>>();
    if middle.iter().any(|x| x.abs() > f64::from(UNBOUNDED)) {
        return None;
    }
    let coordinate = largest_coordinate(interior, &middle, frame)?;
    if coordinate < LARGE {
        return None;
    }
    let message =
        format!("noise in the medium `{}` is asked for at coordinates up to {coordinate:.0}", medium.name);
    let label = "numbers this large leave under 1/100 of a cell";
    Some(
        Diagnostic::warning("W0403", message, medium.span, label)
            .with_help("keep coordinates of noise below 100000: subtract a whole offset, or lower frequency, octaves or speed"),
    )
}

/// Largest coordinate at which noise is evaluated for a point, finest octaves included.
fn largest_coordinate(function: &Function, point: &[f64], frame: &Frame) -> Option<f64> {
    let mut probe = function.clone();
    let mut calls: Vec<(Op, Range<usize>)> = Vec::new();
    probe.outputs.clear();
    for inst in &function.insts {
        let Inst::Apply { op, args, .. } = inst else { continue };
        if NOISES.contains(op) {
            let start = probe.outputs.len();
            calls.push((*op, start..start + args.len()));
            probe.outputs.extend_from_slice(args);
        }
    }
    let values = reference::evaluate(&probe, point, &frame.uniforms, &frame.curves);
    calls.into_iter().map(|(op, operands)| coordinate(op, &values[operands])).reduce(f64::max)
}

/// Operations that place their operands in cells.
const NOISES: [Op; 6] = [Op::Perlin, Op::Perlin4, Op::Value, Op::Simplex, Op::Worley, Op::Fbm];

/// Largest coordinate of one evaluation.
fn coordinate(op: Op, operands: &[f64]) -> f64 {
    let largest = |place: &[f64]| place.iter().fold(0.0f64, |most, x| most.max(x.abs()));
    match (op, operands) {
        (Op::Fbm, [x, y, z, octaves, lacunarity, _]) => {
            let finest = lacunarity.abs().max(1.0).powf((octaves.floor() - 1.0).clamp(0.0, 31.0));
            largest(&[*x, *y, *z]) * finest
        }
        (_, place) => largest(place),
    }
}

fn cell_of(bounds: Aabb, cell: usize) -> [Interval; 3] {
    let index = [cell % CELLS, cell / CELLS % CELLS, cell / CELLS / CELLS];
    std::array::from_fn(|i| {
        let (lo, hi) = (f64::from(bounds.lo[i]), f64::from(bounds.hi[i]));
        let at = |step: usize| lo + (hi - lo) * step as f64 / CELLS as f64;
        Interval::new(at(index[i]), at(index[i] + 1))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use vol_language::source::SourceFile;

    /// Codes of the warnings about a medium with these entries.
    fn codes(entries: &str) -> Vec<&'static str> {
        codes_of(&format!("medium m {{ region: sphere(1), {entries} }}"))
    }

    /// Codes of the warnings about a scene.
    fn codes_of(text: &str) -> Vec<&'static str> {
        let library = crate::library::library();
        let (scene, found) = vol_language::analyse(&SourceFile::new("test.vol", text), &library);
        assert_eq!(found, []);
        let (program, found) = crate::lower::compile(&scene.expect("no errors"));
        assert_eq!(found, []);
        let program = program.expect("no errors");
        let frame = program.frame(&program.default_params(), 0.0, 0.0, [8, 8]).expect("a frame");
        warnings(&program, &frame).iter().map(|warning| warning.code).collect()
    }

    #[test]
    fn empty_media_are_named() {
        assert_eq!(codes("density: 0"), ["W0402"]);
        assert_eq!(codes("density: q => min(0, fbm(q.local, 4))"), ["W0402"]);
        assert_eq!(codes("density: q => 0.5 * perlin(q.local) - 0.6"), ["W0402"]);
        assert_eq!(codes("density: q => fbm(q.local, 4)"), [""; 0]);
        assert_eq!(codes("density: q => perlin(3 * q.local) - 0.3"), [""; 0]);
        assert_eq!(codes("scatter: 0"), ["W0402"]);
        assert_eq!(codes("scatter: 0, emit: 1"), [""; 0]);
    }

    #[test]
    fn empty_clouds_are_named() {
        let cloud =
            |more: &str| codes_of(&format!("object m {{ shape: sphere(1), material: cloud_3d(1{more}) }}"));
        assert_eq!(cloud(", cutoff: 1"), ["W0402"]);
        assert_eq!(cloud(", density: 0"), ["W0402"]);
        assert_eq!(cloud(", noise: gardner, cutoff: 1.2"), ["W0402"]);
        assert_eq!(cloud(""), [""; 0]);
        assert_eq!(cloud(", noise: gardner"), [""; 0]);
        assert_eq!(cloud(", offset: (1e6, 0, 0)"), ["W0403"]);
    }

    #[test]
    fn coarse_noise_is_named() {
        assert_eq!(codes("density: q => perlin(q.local + 200000)"), ["W0403"]);
        assert_eq!(codes("density: q => perlin(q.local + 1000)"), [""; 0]);
        assert_eq!(codes("density: q => worley(vec3(0, 150000, 0) + q.local)"), ["W0403"]);
        assert_eq!(codes("density: q => fbm(q.local + 1000, 12)"), ["W0403"]);
        assert_eq!(codes("density: q => fbm(q.local + 1000, 6)"), [""; 0]);
    }
}
