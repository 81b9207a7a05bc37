//! Tubes: a curve as axis, radius and twist as functions along it (Moinet 2022, section 3).

use super::shape::Kind;
use super::value::Closure;
use super::{Lowered, Lowerer};
use crate::ir::ValueId;
use crate::ops::Op;
use crate::program::{Curve, Extent, LEAST_RADIUS};
use std::rc::Rc;
use vol_language::hir::LocalField;
use vol_language::source::Span;

/// A curve as the scene builds it: quadratic Bezier segments, each starting where the last ended.
#[derive(Clone, Debug)]
pub(crate) struct CurveValue {
    /// Control points.
    pub(crate) segments: Vec<[[ValueId; 3]; 3]>,
}

/// A tube: all points whose closest point on the curve is nearer than the radius there.
///
/// Its "distance" is `max(|P - Q(t)| - radius(t), overshoot)`: zero at the wall and the flat ends
/// and smooth near them, but not a bound to march by (`algorithms.md` §3.2).
#[derive(Clone, Debug)]
pub(crate) struct Tube {
    /// Index in [`crate::program::Program::curves`].
    curve: u32,
    radius: Rc<Closure>,
    twist: Rc<Closure>,
    /// Whether local y runs over 0..1 (the noise stretches with the curve) or over the arc length.
    stretch: bool,
}

/// The closest point of the axis and the tube's own numbers there.
struct Foot {
    t: ValueId,
    arc_length: ValueId,
    curve_length: ValueId,
    x: ValueId,
    y: ValueId,
    distance: ValueId,
    overshoot: ValueId,
    curvature_factor: ValueId,
    radius: ValueId,
}

/// A tube around a curve. `radius` and `twist` are functions of (t, arc length).
pub(crate) fn tube(
    lowerer: &mut Lowerer<'_>,
    curve: &CurveValue,
    radius: Rc<Closure>,
    twist: Rc<Closure>,
    stretch: bool,
    span: Span,
) -> Lowered<Kind> {
    let mut segments = Vec::with_capacity(curve.segments.len());
    for [a, b, c] in &curve.segments {
        let what = "a control point";
        let point = |lowerer: &mut Lowerer<'_>, p: &[ValueId; 3]| lowerer.slots(*p, what, span);
        segments.push([point(lowerer, a)?, point(lowerer, b)?, point(lowerer, c)?]);
    }
    let curve = lowerer.curve(Curve { segments });
    Ok(Kind::Tube(Tube { curve, radius, twist, stretch }))
}

impl Tube {
    fn foot(&self, lowerer: &mut Lowerer<'_>, p: [ValueId; 3]) -> Lowered<Foot> {
        let results = lowerer.graph.apply_all(Op::Closest, self.curve, &p);
        let [t, arc_length, curve_length, x, y, distance, overshoot, curvature_factor] = results[..] else {
            unreachable!("the operation table gives the closest point eight results")
        };
        let radius = lowerer.call_numbers(&self.radius, &[t, arc_length])?.scalar();
        let least = lowerer.graph.number(LEAST_RADIUS);
        let radius = lowerer.graph.max(radius, least);
        Ok(Foot { t, arc_length, curve_length, x, y, distance, overshoot, curvature_factor, radius })
    }

    pub(crate) fn distance(&self, lowerer: &mut Lowerer<'_>, p: [ValueId; 3]) -> Lowered<ValueId> {
        let foot = self.foot(lowerer, p)?;
        let graph = &mut lowerer.graph;
        let wall = graph.sub(foot.distance, foot.radius);
        // Flat ends: inside, the nearer end is -l or l - L away; outside, the foot stays at the end
        // and the overshoot grows from 0. Together they are continuous with slope 1 along the axis.
        let before = graph.apply(Op::Neg, &[foot.arc_length]);
        let after = graph.sub(foot.arc_length, foot.curve_length);
        let ends = graph.max(before, after);
        let zero = graph.number(0.0);
        let beyond = graph.apply(Op::Less, &[zero, foot.overshoot]);
        let ends = graph.select(beyond, foot.overshoot, ends);
        Ok(graph.max(wall, ends))
    }

    pub(crate) fn extent(&self, lowerer: &mut Lowerer<'_>) -> Lowered<Extent> {
        let (t, l) = (lowerer.graph.input(0), lowerer.graph.input(1));
        let radius = lowerer.call_numbers(&self.radius, &[t, l])?.scalar();
        let radius = lowerer.function("radius", 2, &[radius]);
        Ok(Extent::Tube { curve: self.curve, radius })
    }

    pub(crate) fn local_field(
        &self,
        lowerer: &mut Lowerer<'_>,
        p: [ValueId; 3],
        field: LocalField,
    ) -> Lowered<Vec<ValueId>> {
        let foot = self.foot(lowerer, p)?;
        Ok(match field {
            LocalField::Local => {
                let (x, y) = self.twisted(lowerer, &foot)?;
                let graph = &mut lowerer.graph;
                let x = graph.div(x, foot.radius);
                let y = graph.div(y, foot.radius);
                let along = if self.stretch {
                    graph.div(foot.arc_length, foot.curve_length)
                } else {
                    foot.arc_length
                };
                vec![x, along, y]
            }
            LocalField::World => p.to_vec(),
            LocalField::T => vec![foot.t],
            LocalField::L => vec![foot.arc_length],
            LocalField::Angle => {
                let (x, y) = self.twisted(lowerer, &foot)?;
                vec![lowerer.graph.apply(Op::Atan2, &[y, x])]
            }
            LocalField::Radius => vec![lowerer.graph.div(foot.distance, foot.radius)],
            LocalField::Depth => {
                let distance = self.distance(lowerer, p)?;
                vec![lowerer.graph.apply(Op::Neg, &[distance])]
            }
            LocalField::Stretch => vec![stretch(lowerer, &foot)],
        })
    }

    /// Offset from the axis, turned by the twist.
    fn twisted(&self, lowerer: &mut Lowerer<'_>, foot: &Foot) -> Lowered<(ValueId, ValueId)> {
        let angle = lowerer.call_numbers(&self.twist, &[foot.t, foot.arc_length])?.scalar();
        let graph = &mut lowerer.graph;
        if graph.constant(angle) == Some(0.0) {
            return Ok((foot.x, foot.y));
        }
        let (sine, cosine) = (graph.apply(Op::Sin, &[angle]), graph.apply(Op::Cos, &[angle]));
        let (cx, sy) = (graph.mul(cosine, foot.x), graph.mul(sine, foot.y));
        let (sx, cy) = (graph.mul(sine, foot.x), graph.mul(cosine, foot.y));
        Ok((graph.sub(cx, sy), graph.add(sx, cy)))
    }
}

/// Volume of the tube's map against the unit cylinder: `r^2 L (1 - kappa o.N)`, kept from 0 on the
/// focal line.
fn stretch(lowerer: &mut Lowerer<'_>, foot: &Foot) -> ValueId {
    let graph = &mut lowerer.graph;
    let least = graph.number(0.05);
    let factor = graph.max(foot.curvature_factor, least);
    let area = graph.mul(foot.radius, foot.radius);
    let volume = graph.mul(area, foot.curve_length);
    graph.mul(volume, factor)
}
