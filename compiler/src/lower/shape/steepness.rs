//! How fast a distance changes over a box of positions: by this a ray knows how far it may step.
//!
//! A distance divided by its largest slope along the way cannot overshoot (Galin et al. 2020, "Segment
//! Tracing"). In: the box of a piece of a ray. Out: a bound on the slope in it, as a value of the graph,
//! by the derivatives of displacements and fields and their ranges over the box. Example: `x * x - 1` is at
//! most 2 steep over a box from 0 to 1.
//!
//! Distances proper are 1 steep and cost nothing; noises and waves are as steep everywhere as anywhere.
//! What has no local bound (bends, curves inside fields) is as steep as each frame finds it
//! to be over the whole solid.

use super::transform::Transform;
use super::{Kind, Shape, gradient};
use crate::ir::{FunctionId, ValueId};
use crate::lower::value::{Closure, Value};
use crate::lower::{Lowered, Lowerer};
use crate::ops::Op;
use crate::ops::range::{LARGEST, Range};
use crate::passes::enclose;
use crate::program::{Measure, NO_BOUND};
use std::rc::Rc;
use vol_language::source::Span;

/// Ranges are computed without rounding outward: by so much more, ends that are off by some units in the
/// last place bound what they should.
const ROOM: f64 = 1.0 + 1.0 / 1024.0;

impl Shape {
    /// The function that bounds the slope of the distance over a box, see
    /// [`crate::program::Object::steepness`].
    pub(crate) fn steepness(
        &self,
        lowerer: &mut Lowerer<'_>,
        name: &str,
        span: Span,
    ) -> Lowered<Option<FunctionId>> {
        let corner = [0, 1, 2].map(|axis| [axis, axis + 3].map(|input| lowerer.graph.input(input)));
        let place = corner.map(|[lo, hi]| Range { lo, hi });
        let Some(bound) = self.bound(lowerer, place, span)? else { return Ok(None) };
        let graph = &mut lowerer.graph;
        // A range that was held may be too narrow: nothing is known then.
        let (room, held) = (graph.number(ROOM), graph.number(0.5 * LARGEST));
        let roomy = graph.mul(bound, room);
        let (known, unknown) = (graph.apply(Op::Less, &[bound, held]), graph.number(f64::from(NO_BOUND)));
        let bound = graph.select(known, roomy, unknown);
        Ok(Some(lowerer.function(&format!("steepness:{name}"), 6, &[bound])))
    }

    /// A bound, at least 1, on the slope of the distance over a box; `None` if it is 1 everywhere.
    fn bound(&self, lowerer: &mut Lowerer<'_>, place: [Range; 3], span: Span) -> Lowered<Option<ValueId>> {
        match &self.kind {
            Kind::Primitive(_) | Kind::Tube(_) => Ok(None),
            Kind::Implicit { field, half, span } => {
                // The field is asked at the nearest point of its box.
                let graph = &mut lowerer.graph;
                let held = [0, 1, 2].map(|i| {
                    let low = graph.apply(Op::Neg, &[half[i]]);
                    let mut hold = |end| super::primitives::clamped(graph, end, low, half[i]);
                    Range { lo: hold(place[i].lo), hi: hold(place[i].hi) }
                });
                let Some(slope) = slope(lowerer, field, held, *span)? else {
                    return self.measured(lowerer, *span);
                };
                let one = lowerer.graph.number(1.0);
                Ok(Some(lowerer.graph.max(slope, one)))
            }
            Kind::Union { shapes, .. } | Kind::Intersection { shapes, .. } => {
                steepest(lowerer, shapes.iter().map(|shape| &**shape), place, span)
            }
            Kind::Difference { from, what, .. } => steepest(lowerer, [&**from, &**what], place, span),
            Kind::Transformed { child, transform } => {
                self.transformed(lowerer, child, transform, place, span)
            }
            Kind::Repeated { child, copies } => {
                if !child.is_steep() {
                    return Ok(None);
                }
                let place = copies.reach(&mut lowerer.graph, place);
                child.bound(lowerer, place, span)
            }
            Kind::Rounded { child, .. } | Kind::Shell { child, .. } => child.bound(lowerer, place, span),
            Kind::Displaced { child, amount, span } => {
                let Some(slope) = slope(lowerer, amount, place, *span)? else {
                    return self.measured(lowerer, *span);
                };
                let one = lowerer.graph.number(1.0);
                let before = child.bound(lowerer, place, *span)?.unwrap_or(one);
                Ok(Some(lowerer.graph.add(before, slope)))
            }
        }
    }

    fn transformed(
        &self,
        lowerer: &mut Lowerer<'_>,
        child: &Shape,
        transform: &Transform,
        place: [Range; 3],
        span: Span,
    ) -> Lowered<Option<ValueId>> {
        match transform {
            Transform::Bend(_) => self.measured(lowerer, span),
            Transform::Twist { rate, radius } => {
                let graph = &mut lowerer.graph;
                let reach = [place[0], place[2]].map(|range| range.magnitude(graph));
                let reach = graph.length(&reach);
                // Beyond the radius the child is asked nearer to the axis.
                let zero = graph.number(0.0);
                let within = graph.apply(Op::LessEqual, &[reach, *radius]);
                let toward = [0, 2].map(|i| {
                    let (low, high) = (graph.min(place[i].lo, zero), graph.max(place[i].hi, zero));
                    Range {
                        lo: graph.select(within, place[i].lo, low),
                        hi: graph.select(within, place[i].hi, high),
                    }
                });
                let held = [toward[0], place[1], toward[1]];
                let stretch = twist_stretch(lowerer, *rate, *radius);
                let before = inner(lowerer, child, transform, held, span)?;
                Ok(Some(before.map_or(stretch, |before| lowerer.graph.mul(before, stretch))))
            }
            Transform::Translate { .. }
            | Transform::Rotate { .. }
            | Transform::Scale { .. }
            | Transform::Stretch { .. }
            | Transform::Mirror { .. }
            | Transform::Elongate { .. } => inner(lowerer, child, transform, place, span),
        }
    }

    /// The largest slope over all of the solid, found once per frame; `None` if it is 1.
    fn measured(&self, lowerer: &mut Lowerer<'_>, span: Span) -> Lowered<Option<ValueId>> {
        if !self.is_steep() {
            return Ok(None);
        }
        let extent = self.extent(lowerer, span)?;
        Ok(lowerer.measure(Measure::Steepness(extent)).pop())
    }

    /// Whether the slope may be more than 1 anywhere.
    fn is_steep(&self) -> bool {
        let own = match &self.kind {
            Kind::Implicit { .. } | Kind::Displaced { .. } => true,
            Kind::Transformed { transform, .. } => {
                matches!(transform, Transform::Twist { .. } | Transform::Bend(_))
            }
            Kind::Primitive(_)
            | Kind::Tube(_)
            | Kind::Union { .. }
            | Kind::Intersection { .. }
            | Kind::Difference { .. }
            | Kind::Repeated { .. }
            | Kind::Rounded { .. }
            | Kind::Shell { .. } => false,
        };
        own || self.kind.children().into_iter().any(Self::is_steep)
    }
}

/// The steepness of what is behind a map, over the image of a box.
fn inner(
    lowerer: &mut Lowerer<'_>,
    child: &Shape,
    transform: &Transform,
    place: [Range; 3],
    span: Span,
) -> Lowered<Option<ValueId>> {
    if !child.is_steep() {
        return Ok(None);
    }
    let p = lowerer.position();
    let image = transform.to_child(&mut lowerer.graph, p);
    match enclose::enclose(&mut lowerer.graph, &image, place).as_deref() {
        Some(&[x, y, z]) => child.bound(lowerer, [x, y, z], span),
        _ => child.measured(lowerer, span),
    }
}

/// The steepest of some solids.
fn steepest<'a>(
    lowerer: &mut Lowerer<'_>,
    shapes: impl IntoIterator<Item = &'a Shape>,
    place: [Range; 3],
    span: Span,
) -> Lowered<Option<ValueId>> {
    let mut most = None;
    for shape in shapes {
        let bound = shape.bound(lowerer, place, span)?;
        most = match (most, bound) {
            (Some(a), Some(b)) => Some(lowerer.graph.max(a, b)),
            (a, b) => a.or(b),
        };
    }
    Ok(most)
}

/// `(k r + sqrt(k^2 r^2 + 4)) / 2`: the largest singular value of a twist by k per length at a distance r
/// from its axis.
fn twist_stretch(lowerer: &mut Lowerer<'_>, rate: ValueId, reach: ValueId) -> ValueId {
    let graph = &mut lowerer.graph;
    let size = graph.apply(Op::Abs, &[rate]);
    let turn = graph.mul(size, reach);
    let (two, half) = (graph.number(2.0), graph.number(0.5));
    let root = graph.length(&[turn, two]);
    let sum = graph.add(turn, root);
    graph.mul(half, sum)
}

/// A bound on the slope of a function of the position over a box; where it may jump, anything.
fn slope(
    lowerer: &mut Lowerer<'_>,
    of: &Rc<Closure>,
    place: [Range; 3],
    span: Span,
) -> Lowered<Option<ValueId>> {
    let p = lowerer.position();
    let value = lowerer.call(of, &[Value::Numbers(p.to_vec())])?.scalar();
    let slopes = gradient(lowerer, value, span)?;
    let graph = &mut lowerer.graph;
    let Some(jumps) = enclose::jumps(graph, value, &lowerer.choices) else { return Ok(None) };
    let Some(ranges) = enclose::enclose(graph, &[slopes, jumps].concat(), place) else { return Ok(None) };
    let (slopes, jumps) = ranges.split_at(3);
    let components: Vec<ValueId> = slopes.iter().map(|range| range.magnitude(graph)).collect();
    let mut steepest = graph.length(&components);
    let anything = graph.number(LARGEST);
    for &jump in jumps {
        let may = enclose::varies(graph, jump);
        steepest = graph.select(may, anything, steepest);
    }
    Ok(Some(steepest))
}
