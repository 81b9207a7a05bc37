//! Curves joined to a path.

use super::{CurveValue, MOST_PIECES, Point, Run, combination, known_points, length, minus, within_limit};
use crate::ir::graph::Graph;
use crate::lower::{Lowered, Lowerer};
use std::rc::Rc;
use vol_language::diag::Diagnostic;
use vol_language::source::Span;

/// Tangents that differ by more than this are a corner, degrees.
const CORNER: f64 = 1.0;

/// Runs of t that may cost every sample some operations each.
const FEW_RUNS: usize = 16;

/// Ends farther apart than this share of the pieces that meet there are a gap.
const GAP: f64 = 1e-6;

/// Joined curves; each takes an equal share of t. Where the control points are known, the first gap or
/// corner is reported.
///
/// A gap is a warning, not an error: the curve is well defined across it, and a tube with branches is a
/// path that goes back.
pub(crate) fn path(lowerer: &mut Lowerer<'_>, curves: &[Rc<CurveValue>], span: Span) -> Lowered<CurveValue> {
    let (Some(first), Some(last)) = (curves.first(), curves.last()) else {
        let diagnostic =
            Diagnostic::error("E0407", "a path needs at least one curve", span, "this list is empty");
        return Err(Box::new(diagnostic.with_help("write `path([line((0, 0, 0), (0, 1, 0))])`")));
    };
    within_limit(curves.iter().map(|curve| curve.segments.len()).sum(), span)?;
    let jumps: Vec<(usize, Jump)> = curves
        .windows(2)
        .enumerate()
        .filter_map(|(i, pair)| Some((i, jump(&lowerer.graph, &pair[0], &pair[1])?)))
        .collect();
    if let Some((place, jump)) = jumps.first() {
        let diagnostic = discontinuous(*place, jump, jumps.len() - 1, span);
        lowerer.report(diagnostic);
    }
    let share = 1.0 / curves.len() as f64;
    let closed = match jump(&lowerer.graph, last, first) {
        Some(Jump::Gap(_)) => false,
        Some(Jump::Corner(_)) => true,
        // No jump, or not known: then only the very same point will do.
        None => end(last)[2] == start(first)[0] || known_points(&lowerer.graph, end(last)).is_some(),
    };
    let curves = evened(&mut lowerer.graph, curves);
    let runs = curves.iter().flat_map(|curve| &curve.runs);
    Ok(CurveValue {
        segments: curves.iter().flat_map(|curve| curve.segments.iter().copied()).collect(),
        runs: runs.map(|run| Run { share: run.share * share, ..*run }).collect(),
        closed,
    })
}

/// Curves with the same number of pieces each, if they are many and their numbers differ: then t runs evenly
/// from piece to piece, and need not be put together from a run for each curve at every point.
fn evened(graph: &mut Graph, curves: &[Rc<CurveValue>]) -> Vec<Rc<CurveValue>> {
    let common = curves.iter().map(|curve| curve.segments.len()).fold(1, least_common_multiple);
    let even = curves.iter().all(|curve| curve.runs.len() == 1);
    if curves.len() <= FEW_RUNS || !even || common > MOST_PIECES / curves.len() {
        return curves.to_vec();
    }
    let divided = curves.iter().map(|curve| {
        let parts = common / curve.segments.len();
        let segments = curve.segments.iter().flat_map(|segment| divided(graph, segment, parts)).collect();
        Rc::new(CurveValue::even(segments, curve.closed))
    });
    divided.collect()
}

fn least_common_multiple(a: usize, b: usize) -> usize {
    let (mut divisor, mut rest) = (a, b);
    while rest > 0 {
        (divisor, rest) = (rest, divisor % rest);
    }
    (a / divisor.max(1)).saturating_mul(b)
}

/// A quadratic cut at even parameters, by its polar form.
fn divided(graph: &mut Graph, segment: &[Point; 3], parts: usize) -> Vec<[Point; 3]> {
    if parts == 1 {
        return vec![*segment];
    }
    let [a, b, c] = *segment;
    let mut polar = |u: f64, v: f64| {
        let (iu, iv) = (1.0 - u, 1.0 - v);
        combination(graph, &[(iu * iv, a), (u * iv + iu * v, b), (u * v, c)])
    };
    let mut part = |i: usize| {
        let [from, to] = [i, i + 1].map(|end| end as f64 / parts as f64);
        [polar(from, from), polar(from, to), polar(to, to)]
    };
    (0..parts).map(&mut part).collect()
}

/// How two curves fail to join.
enum Jump {
    /// Scene units.
    Gap(f64),
    /// Degrees.
    Corner(f64),
}

fn start(curve: &CurveValue) -> &[Point; 3] {
    curve.segments.first().expect("a curve has pieces")
}

fn end(curve: &CurveValue) -> &[Point; 3] {
    curve.segments.last().expect("a curve has pieces")
}

/// How the second curve fails to go on from the first, if both are known.
fn jump(graph: &Graph, before: &CurveValue, after: &CurveValue) -> Option<Jump> {
    let from = known_points(graph, end(before))?;
    let to = known_points(graph, start(after))?;
    let size = |p: &[[f64; 3]; 3]| length(minus(p[1], p[0])) + length(minus(p[2], p[1]));
    let gap = length(minus(to[0], from[2]));
    if gap > GAP * size(&from).max(size(&to)) {
        return Some(Jump::Gap(gap));
    }
    // A control point on the end says nothing about the tangent there.
    let direction = |near: [f64; 3], far: [f64; 3]| if length(near) > 0.0 { near } else { far };
    let leave = direction(minus(from[2], from[1]), minus(from[2], from[0]));
    let enter = direction(minus(to[1], to[0]), minus(to[2], to[0]));
    let product: f64 = leave.iter().zip(enter).map(|(a, b)| a * b).sum();
    let cosine = product / (length(leave) * length(enter));
    let corner = cosine.clamp(-1.0, 1.0).acos().to_degrees();
    (corner > CORNER).then_some(Jump::Corner(corner))
}

fn discontinuous(place: usize, jump: &Jump, others: usize, span: Span) -> Diagnostic {
    let (before, after) = (place + 1, place + 2);
    let (message, help) = match jump {
        Jump::Gap(gap) => (
            format!("discontinuous path: curve {after} starts {gap:.3} away from the end of curve {before}"),
            "start each curve where the one before ends; a gap is meant where a tube branches",
        ),
        Jump::Corner(angle) => (
            format!(
                "discontinuous path: its direction turns by {angle:.0} degrees from curve {before} to curve {after}"
            ),
            "put the control points next to the joint on one line with it, or use `catmull_rom`",
        ),
    };
    let label = match others {
        0 => "this path has a jump".to_owned(),
        others => format!("this path has a jump here and {others} more"),
    };
    Diagnostic::warning("W0201", message, span, label).with_help(help)
}
