//! Curves as scenes build them: everything becomes a chain of quadratic Bezier pieces.
//!
//! In: points, nodes of the graph. Out: a [`CurveValue`] whose control points are nodes too, so that a
//! curve moves with params and time; how many pieces there are is known at compile time.
//!
//! | curve | pieces | largest deviation from its definition, tests below |
//! |---|---|---|
//! | line, quadratic Bezier, quadratic B-spline | 1 per segment | none |
//! | cubic Bezier, Catmull-Rom | 2 to 8 per segment | 6e-4 of the segment's control polygon |
//! | circle | [`ARCS`] | 1.9e-4 of the radius |
//! | helix | [`ARCS`] a turn | 1.9e-4 of the radius across, none in height at equal t |
//!
//! Tangents agree at all joints inside one of these curves. Source: `algorithms.md` §1.1.

use super::{Lowered, Lowerer};
use crate::ir::ValueId;
use crate::ir::graph::Graph;
use crate::ops::Op;
use std::f64::consts::TAU;
use vol_language::diag::Diagnostic;
use vol_language::source::Span;

mod path;

pub(crate) use path::path;

/// A point in the graph.
pub(crate) type Point = [ValueId; 3];

/// Pieces of a circle, and of a turn of a helix: an arc of angle 2 h deviates by h^4 / 8 radii.
const ARCS: usize = 16;

/// Most pieces of a curve: enough for 10 000 cubics.
const MOST_PIECES: usize = 100_000;

/// Most parts into which a cubic is cut; each becomes two quadratics. Enough for every cubic:
/// |a - 3b + 3c - d| is at most twice the length of its control polygon, so the deviation is at most
/// 2 / (54 * 4^3) = 5.8e-4 of it.
const MOST_CUTS: usize = 4;

/// Allowed deviation of a cubic whose control points are known, as a share of its control polygon.
const DEVIATION: f64 = 5.8e-4;

/// Knot intervals of Catmull-Rom curves are at least this: points may coincide.
const LEAST_INTERVAL: f64 = 1e-9;

/// A curve as the scene builds it.
#[derive(Clone, Debug)]
pub(crate) struct CurveValue {
    /// Control points of the quadratic pieces; at least one.
    pub(crate) segments: Vec<[Point; 3]>,
    /// How t runs: consecutive runs of pieces with their shares of 0..1, even within a run.
    pub(crate) runs: Vec<Run>,
    /// Whether it ends where it begins: then it has no ends at all.
    pub(crate) closed: bool,
}

/// Consecutive pieces that take a share of t together.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Run {
    pub(crate) pieces: usize,
    pub(crate) share: f64,
}

impl CurveValue {
    /// A curve along which t runs evenly from piece to piece.
    fn even(segments: Vec<[Point; 3]>, closed: bool) -> Self {
        let runs = vec![Run { pieces: segments.len(), share: 1.0 }];
        Self { segments, runs, closed }
    }

    /// Turns the kernels' t, even per piece, into the one that [`Self::runs`] describes.
    pub(crate) fn parameter(&self, graph: &mut Graph, even: ValueId) -> ValueId {
        let count = self.segments.len() as f64;
        let is_even = |run: &Run| (run.share * count - run.pieces as f64).abs() < 1e-9 * count;
        if self.runs.iter().all(is_even) {
            return even;
        }
        let (zero, one, scale) = (graph.number(0.0), graph.number(1.0), graph.number(count));
        let place = graph.mul(even, scale);
        let (mut before, mut sum) = (0.0, zero);
        for run in &self.runs {
            let (start, per_piece) = (graph.number(before), graph.number(1.0 / run.pieces as f64));
            let along = graph.sub(place, start);
            let along = graph.mul(along, per_piece);
            let along = graph.max(along, zero);
            let along = graph.min(along, one);
            let share = graph.number(run.share);
            let term = graph.mul(along, share);
            sum = graph.add(sum, term);
            before += run.pieces as f64;
        }
        sum
    }
}

/// Straight line.
pub(crate) fn line(graph: &mut Graph, a: Point, b: Point) -> CurveValue {
    CurveValue::even(vec![straight(graph, a, b)], false)
}

/// Quadratic Bezier curve.
pub(crate) fn quadratic(a: Point, b: Point, c: Point) -> CurveValue {
    CurveValue::even(vec![[a, b, c]], false)
}

/// Cubic Bezier curve.
pub(crate) fn cubic(graph: &mut Graph, control: [Point; 4]) -> CurveValue {
    CurveValue::even(quadratics(graph, &[control]), false)
}

/// Centripetal Catmull-Rom curve through the points; t runs evenly from point to point. Unlike the
/// uniform one it never loops or turns back within a segment (Yuksel, Schaefer, Keyser 2011). An open
/// one leaves its first point straight towards the second, and so at the other end.
pub(crate) fn catmull_rom(
    lowerer: &mut Lowerer<'_>,
    points: &[Point],
    closed: bool,
    span: Span,
) -> Lowered<CurveValue> {
    enough_points("catmull_rom", points.len(), closed, span)?;
    let graph = &mut lowerer.graph;
    let ring = if closed {
        let n = points.len();
        (0..n + 3).map(|i| points[(i + n - 1) % n]).collect()
    } else {
        let n = points.len();
        let first = combination(graph, &[(2.0, points[0]), (-1.0, points[1])]);
        let last = combination(graph, &[(2.0, points[n - 1]), (-1.0, points[n - 2])]);
        [&[first], points, &[last]].concat()
    };
    let chords: Vec<Point> =
        ring.windows(2).map(|pair| combination(graph, &[(1.0, pair[1]), (-1.0, pair[0])])).collect();
    let knots: Vec<ValueId> = chords.iter().map(|chord| knot_interval(graph, chord)).collect();
    // Velocities at ring points 1..: chords weighted by the intervals on the other side.
    let velocities: Vec<Point> = (1..chords.len())
        .map(|i| velocity(graph, [chords[i - 1], chords[i]], [knots[i - 1], knots[i]]))
        .collect();
    let third = graph.number(1.0 / 3.0);
    let cubics: Vec<[Point; 4]> = (1..chords.len() - 1)
        .map(|i| {
            let reach = graph.mul(knots[i], third);
            let (from, to) = (ring[i], ring[i + 1]);
            let out = [0, 1, 2].map(|k| {
                let step = graph.mul(velocities[i - 1][k], reach);
                graph.add(from[k], step)
            });
            let back = [0, 1, 2].map(|k| {
                let step = graph.mul(velocities[i][k], reach);
                graph.sub(to[k], step)
            });
            [from, out, back, to]
        })
        .collect();
    let segments = quadratics(graph, &cubics);
    within_limit(segments.len(), span)?;
    Ok(CurveValue::even(segments, closed))
}

/// Square root of a chord's length.
fn knot_interval(graph: &mut Graph, chord: &Point) -> ValueId {
    let length = graph.length(chord);
    let root = graph.apply(Op::Sqrt, &[length]);
    let least = graph.number(LEAST_INTERVAL);
    graph.max(root, least)
}

/// `(b / a * before + a / b * after) / (a + b)` for knot intervals a and b.
fn velocity(graph: &mut Graph, [before, after]: [Point; 2], [a, b]: [ValueId; 2]) -> Point {
    let sum = graph.add(a, b);
    let (first, second) = (graph.div(b, a), graph.div(a, b));
    let (first, second) = (graph.div(first, sum), graph.div(second, sum));
    [0, 1, 2].map(|k| {
        let (x, y) = (graph.mul(first, before[k]), graph.mul(second, after[k]));
        graph.add(x, y)
    })
}

/// Uniform quadratic B-spline. An open one starts at the first point and ends at the last, as if they
/// were doubled; t runs evenly from piece to piece.
pub(crate) fn b_spline(
    lowerer: &mut Lowerer<'_>,
    points: &[Point],
    closed: bool,
    span: Span,
) -> Lowered<CurveValue> {
    enough_points("bspline", points.len(), closed, span)?;
    let (graph, n) = (&mut lowerer.graph, points.len());
    if let [a, b] = points {
        return Ok(line(graph, *a, *b));
    }
    let mut middle = |i: usize| combination(graph, &[(0.5, points[i % n]), (0.5, points[(i + 1) % n])]);
    let segments: Vec<[Point; 3]> = if closed {
        (0..n).map(|i| [middle(i), points[(i + 1) % n], middle(i + 1)]).collect()
    } else {
        let ends = |i: usize, middle: &mut dyn FnMut(usize) -> Point| {
            let from = if i == 1 { points[0] } else { middle(i - 1) };
            let to = if i == n - 2 { points[n - 1] } else { middle(i) };
            [from, points[i], to]
        };
        (1..n - 1).map(|i| ends(i, &mut middle)).collect()
    };
    within_limit(segments.len(), span)?;
    Ok(CurveValue::even(segments, closed))
}

/// Circle around the y axis from (radius, 0, 0), counter-clockwise seen from above.
pub(crate) fn circle(graph: &mut Graph, radius: ValueId) -> CurveValue {
    let flat = graph.number(0.0);
    CurveValue::even(arcs(graph, radius, flat, 1.0, ARCS), true)
}

/// Helix around the y axis from (radius, 0, 0), rising by `height` in all; right-handed for positive
/// `turns`.
pub(crate) fn helix(
    lowerer: &mut Lowerer<'_>,
    radius: ValueId,
    height: ValueId,
    turns: ValueId,
    span: Span,
) -> Lowered<CurveValue> {
    let turns = lowerer.compile_time(turns, "the number of turns", span)?;
    let count = (turns.abs() * ARCS as f64).ceil().max(1.0);
    // Compared before it becomes an integer, which would saturate.
    within_limit(if count < 1e9 { count as usize } else { usize::MAX }, span)?;
    Ok(CurveValue::even(arcs(&mut lowerer.graph, radius, height, turns, count as usize), false))
}

/// Arcs as parabolas between the tangents at their ends, which meet at `radius / cos(half the arc)`.
fn arcs(graph: &mut Graph, radius: ValueId, height: ValueId, turns: f64, count: usize) -> Vec<[Point; 3]> {
    let half = TAU * turns / count as f64 / 2.0;
    let mut point = |place: f64, stretch: f64| {
        // A whole turn comes back to the very same numbers.
        let angle = TAU * (turns * place / count as f64).fract();
        let (x, z) = (graph.number(stretch * angle.cos()), graph.number(-stretch * angle.sin()));
        let y = graph.number(place / count as f64);
        [graph.mul(radius, x), graph.mul(height, y), graph.mul(radius, z)]
    };
    let arc = |i: usize| {
        let place = i as f64;
        [point(place, 1.0), point(place + 0.5, 1.0 / half.cos()), point(place + 1.0, 1.0)]
    };
    (0..count).map(arc).collect()
}

/// Cubics as pairs of quadratics `(a, (a + 3b)/4, m), (m, (3c + d)/4, d)`, `m` the mean of the two
/// control points, after cutting each into parts. Deviation at equal parameter is
/// `|a - 3b + 3c - d| / (54 cuts^3)`; ends and tangents are kept.
fn quadratics(graph: &mut Graph, cubics: &[[Point; 4]]) -> Vec<[Point; 3]> {
    let cuts = cubics.iter().map(|cubic| cuts(graph, cubic)).max().unwrap_or(1);
    let mut segments = Vec::with_capacity(2 * cuts * cubics.len());
    for cubic in cubics {
        for part in 0..cuts {
            let ends = [part, part + 1].map(|end| end as f64 / cuts as f64);
            let [a, b, c, d] = part_weights(ends);
            let weighted = |from: [f64; 4], to: [f64; 4], share: f64| {
                std::array::from_fn(|i| from[i] + share * (to[i] - from[i]))
            };
            let (first, second) = (weighted(a, b, 0.75), weighted(d, c, 0.75));
            let middle = weighted(first, second, 0.5);
            let mut point = |weights: [f64; 4]| {
                let terms: Vec<(f64, Point)> = weights.into_iter().zip(*cubic).collect();
                combination(graph, &terms)
            };
            let [a, first, middle, second, d] = [a, first, middle, second, d].map(&mut point);
            segments.push([a, first, middle]);
            segments.push([middle, second, d]);
        }
    }
    segments
}

/// Weights of a cubic's control points in those of its part between two parameters: its polar form.
fn part_weights([from, to]: [f64; 2]) -> [[f64; 4]; 4] {
    let polar = |[u, v, w]: [f64; 3]| {
        let (iu, iv, iw) = (1.0 - u, 1.0 - v, 1.0 - w);
        let one = u * iv * iw + iu * v * iw + iu * iv * w;
        let two = u * v * iw + u * iv * w + iu * v * w;
        [iu * iv * iw, one, two, u * v * w]
    };
    [[from; 3], [from, from, to], [from, to, to], [to; 3]].map(polar)
}

/// Parts into which a cubic is cut.
fn cuts(graph: &Graph, cubic: &[Point; 4]) -> usize {
    let Some([a, b, c, d]) = known_points(graph, cubic) else { return MOST_CUTS };
    let legs = length(minus(b, a)) + length(minus(c, b)) + length(minus(d, c));
    let third = length([0, 1, 2].map(|k| a[k] - 3.0 * b[k] + 3.0 * c[k] - d[k]));
    let fine = |cuts: &usize| third / (54.0 * (*cuts as f64).powi(3)) <= DEVIATION * legs;
    (1..MOST_CUTS).find(fine).unwrap_or(MOST_CUTS)
}

fn straight(graph: &mut Graph, a: Point, b: Point) -> [Point; 3] {
    [a, combination(graph, &[(0.5, a), (0.5, b)]), b]
}

/// Sum of weighted points.
fn combination(graph: &mut Graph, terms: &[(f64, Point)]) -> Point {
    [0, 1, 2].map(|k| {
        let mut sum = graph.number(0.0);
        for &(weight, point) in terms.iter().filter(|(weight, _)| *weight != 0.0) {
            let weight = graph.number(weight);
            let term = graph.mul(weight, point[k]);
            sum = graph.add(sum, term);
        }
        sum
    })
}

/// Points that are known at compile time.
fn known_points<const N: usize>(graph: &Graph, points: &[Point; N]) -> Option<[[f64; 3]; N]> {
    let mut known = [[0.0; 3]; N];
    for (known, point) in known.iter_mut().zip(points) {
        for (known, &value) in known.iter_mut().zip(point) {
            *known = graph.constant(value)?;
        }
    }
    Some(known)
}

fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|k| a[k] - b[k])
}

fn length(v: [f64; 3]) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}

fn enough_points(name: &str, count: usize, closed: bool, span: Span) -> Lowered<()> {
    let least = if closed { 3 } else { 2 };
    if count >= least {
        return Ok(());
    }
    let kind = if closed { "a closed" } else { "an open" };
    let message = format!("{kind} `{name}` needs at least {least} points");
    let diagnostic = Diagnostic::error("E0407", message, span, format!("this list has {count}"));
    Err(Box::new(
        diagnostic.with_help(format!("give it {least} points or more, `{name}([(0, 0, 0), (0, 1, 0), …])`")),
    ))
}

fn within_limit(pieces: usize, span: Span) -> Lowered<()> {
    if pieces <= MOST_PIECES {
        return Ok(());
    }
    let message = format!("this curve has more than {MOST_PIECES} pieces");
    let diagnostic = Diagnostic::error("E0401", message, span, "the limit is reached here");
    Err(Box::new(diagnostic.with_help("use fewer points or turns, or several tubes")))
}

#[cfg(test)]
mod tests;
