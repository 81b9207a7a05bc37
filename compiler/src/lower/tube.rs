//! Tubes: a curve as axis, radius and twist as functions along it (Moinet 2022, section 3).
//!
//! A point belongs to the tube by its closest point on the axis, its foot, and has the coordinates there;
//! where the tube overlaps itself other rules may be asked for ([`overlap`]).

mod overlap;

pub(crate) use overlap::Overlap;

use super::curve::CurveValue;
use super::shape::Kind;
use super::value::Closure;
use super::{Lowered, Lowerer, depends_on_position};
use crate::ir::ValueId;
use crate::ir::graph::{Graph, Rate};
use crate::ops::Op;
use crate::program::{Caps, Curve, Extent, LEAST_RADIUS, TubeSizes, TubeSlope};
use std::rc::Rc;
use vol_language::diag::Diagnostic;
use vol_language::hir::LocalField;
use vol_language::source::Span;

/// What a tube is asked for beside its curve.
#[derive(Clone, Debug)]
pub(crate) struct Outline {
    /// Of (t, arc length).
    pub(crate) radius: Rc<Closure>,
    /// Of (t, arc length).
    pub(crate) twist: Rc<Closure>,
    /// Whether local y runs over 0..1 (the noise stretches with the curve) or over the arc length.
    pub(crate) stretch: bool,
    /// Of a curve that is not closed.
    pub(crate) caps: Caps,
    /// Whether local x points towards the centre of curvature.
    pub(crate) frenet: bool,
    /// Whether media thin out where the tube is wide or long.
    pub(crate) conserve_mass: bool,
    /// What decides where it overlaps itself.
    pub(crate) overlap: Overlap,
}

/// A tube: all points whose closest point on the curve is nearer than the radius there.
#[derive(Clone, Debug)]
pub(crate) struct Tube {
    /// Index in [`crate::program::Program::curves`].
    index: u32,
    curve: Rc<CurveValue>,
    outline: Outline,
    /// Whether the radius changes along the curve.
    varies: bool,
    sizes: Option<Sizes>,
}

/// Numbers about the tube that each frame finds out: see [`TubeSizes`].
#[derive(Clone, Debug)]
struct Sizes {
    /// Index in [`crate::program::Program::tubes`].
    index: u32,
    largest: ValueId,
    shell: ValueId,
    wall_scale: ValueId,
    end_limit: ValueId,
    end_scale: ValueId,
    end_depth: ValueId,
    /// Of the curve.
    length: ValueId,
    twist: ValueId,
    twist_rate: ValueId,
}

/// A point of the axis, mostly the closest one, and the tube's own numbers there.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Foot {
    /// The kernels' t, even per segment.
    even_t: ValueId,
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

/// A tube around a curve.
pub(crate) fn tube(
    lowerer: &mut Lowerer<'_>,
    curve: Rc<CurveValue>,
    outline: Outline,
    span: Span,
) -> Lowered<Kind> {
    if outline.frenet && curve.segments.len() > 1 && !curve.closed {
        let message = "only a single bend has a Frenet frame that goes round smoothly";
        let label = "this curve has several pieces";
        let help = "leave `frame` out, or use `bezier` with three points or `circle`";
        return Err(Box::new(Diagnostic::error("E0407", message, span, label).with_help(help)));
    }
    let mut segments = Vec::with_capacity(curve.segments.len());
    for [a, b, c] in &curve.segments {
        let what = "a control point";
        let point = |lowerer: &mut Lowerer<'_>, p: &[ValueId; 3]| lowerer.slots(*p, what, span);
        segments.push([point(lowerer, a)?, point(lowerer, b)?, point(lowerer, c)?]);
    }
    // With arguments of frame rate only what the function brings from outside can vary with the point.
    let still = lowerer.graph.frame_input(0);
    let outside = lowerer.call_numbers(&outline.radius, &[still, still])?.scalar();
    if lowerer.graph.rate(outside) == Rate::Point {
        return Err(depends_on_position("the radius of a tube", lowerer.argument_span(1, span)));
    }
    let index = lowerer.curve(Curve { segments });
    let mut tube = Tube { index, curve, outline, varies: false, sizes: None };
    tube.measure(lowerer)?;
    Ok(Kind::Tube(tube))
}

impl Tube {
    /// Finds out whether the radius varies and what the frames have to find out.
    fn measure(&mut self, lowerer: &mut Lowerer<'_>) -> Lowered<()> {
        let radius = self.radius_along(lowerer)?;
        self.varies = lowerer.graph.rate(radius) == Rate::Point;
        let exact = !self.varies && matches!(self.caps(), Caps::Round | Caps::Open);
        if exact && !self.outline.frenet && !self.by_feet() {
            return Ok(());
        }
        let slope = if self.varies {
            let slopes = crate::passes::gradient::gradient(&mut lowerer.graph, radius, &[0, 1]);
            slopes.map_or(TubeSlope::Unknown, |slopes| {
                TubeSlope::Known(lowerer.function("radius slope", 2, &slopes))
            })
        } else {
            TubeSlope::Flat
        };
        let radius = lowerer.function("radius", 2, &[radius]);
        let sizes = TubeSizes { curve: self.index, radius, slope, caps: self.caps(), first_input: 0 };
        let (index, numbers) = lowerer.tube_sizes(sizes);
        let [largest, shell, wall_scale, end_limit, end_scale, end_depth, end_twist, frenet, length] =
            numbers;
        let zero = lowerer.graph.number(0.0);
        let twist = if self.outline.frenet { frenet } else { zero };
        let twist_rate = if self.curve.closed && !self.outline.frenet { end_twist } else { zero };
        self.sizes = Some(Sizes {
            index,
            largest,
            shell,
            wall_scale,
            end_limit,
            end_scale,
            end_depth,
            length,
            twist,
            twist_rate,
        });
        Ok(())
    }

    /// The radius as a function of inputs 0 and 1, the kernels' t and the arc length.
    fn radius_along(&self, lowerer: &mut Lowerer<'_>) -> Lowered<ValueId> {
        let (t, l) = (lowerer.graph.input(0), lowerer.graph.input(1));
        let t = self.curve.parameter(&mut lowerer.graph, t);
        Ok(lowerer.call_numbers(&self.outline.radius, &[t, l])?.scalar())
    }

    /// The foot that decides about a point; inside a loop over feet the one at hand.
    fn foot(&self, lowerer: &mut Lowerer<'_>, p: [ValueId; 3]) -> Lowered<Foot> {
        if let Some((_, foot)) = lowerer.feet.iter().rev().find(|(index, _)| *index == self.index) {
            return Ok(*foot);
        }
        if self.by_feet() {
            let known = (self.index, p);
            if let Some(foot) = lowerer.deciding_feet.get(&known) {
                return Ok(*foot);
            }
            let foot = self.foot_by_ratio(lowerer, p)?;
            lowerer.deciding_feet.insert(known, foot);
            return Ok(foot);
        }
        let results = lowerer.graph.apply_all(Op::Closest, self.index, &p);
        let [t, arc_length, curve_length, x, y, distance, overshoot, stretch] = results[..] else {
            unreachable!("the operation table gives the closest point eight results")
        };
        let foot = self.foot_of(lowerer, [t, arc_length, x, y, distance, overshoot, stretch])?;
        Ok(Foot { curve_length, ..foot })
    }

    /// A foot with what the tube makes of it, from t, arc length, x, y, distance, overshoot and stretch.
    fn foot_of(&self, lowerer: &mut Lowerer<'_>, at: [ValueId; 7]) -> Lowered<Foot> {
        let [even_t, arc_length, x, y, distance, overshoot, curvature_factor] = at;
        let t = self.curve.parameter(&mut lowerer.graph, even_t);
        let radius = lowerer.call_numbers(&self.outline.radius, &[t, arc_length])?.scalar();
        let least = lowerer.graph.number(LEAST_RADIUS);
        let radius = lowerer.graph.max(radius, least);
        let zero = lowerer.graph.number(0.0);
        let curve_length = self.sizes.as_ref().map_or(zero, |sizes| sizes.length);
        Ok(Foot { even_t, t, arc_length, curve_length, x, y, distance, overshoot, curvature_factor, radius })
    }

    /// Signed distance bound: its size never exceeds the distance to the surface of the tube, given
    /// the numbers of [`crate::frame`]'s `tube` module, where the proof is.
    pub(crate) fn distance(&self, lowerer: &mut Lowerer<'_>, p: [ValueId; 3]) -> Lowered<ValueId> {
        if self.by_feet() {
            return self.distance_by_feet(lowerer, p);
        }
        let foot = self.foot(lowerer, p)?;
        let graph = &mut lowerer.graph;
        let wall = self.wall(graph, &foot);
        Ok(match &self.sizes {
            Some(sizes) if self.caps() == Caps::Flat => {
                let ends = flat_ends(graph, &foot, sizes);
                graph.max(wall, ends)
            }
            Some(_) | None => wall,
        })
    }

    fn caps(&self) -> Caps {
        if self.curve.closed { Caps::Joined } else { self.outline.caps }
    }

    /// Beyond the radius, as the caps have it: `|P - Q| - r`.
    fn beyond_radius(&self, graph: &mut Graph, foot: &Foot) -> ValueId {
        let off = self.off(graph, foot);
        graph.sub(off, foot.radius)
    }

    /// Distance from the axis, as the caps have it.
    fn off(&self, graph: &mut Graph, foot: &Foot) -> ValueId {
        if self.caps() == Caps::Open { graph.length(&[foot.x, foot.y]) } else { foot.distance }
    }

    /// Bound on the distance to the wall.
    fn wall(&self, graph: &mut Graph, foot: &Foot) -> ValueId {
        let beyond = self.beyond_radius(graph, foot);
        let marched = self.varies && self.caps() != Caps::Open;
        let Some(sizes) = self.sizes.as_ref().filter(|_| marched) else { return beyond };
        // Far from the axis only the largest radius counts; near it the slope of the radius.
        let far = graph.sub(foot.distance, sizes.largest);
        let scaled = graph.mul(beyond, sizes.wall_scale);
        let most = graph.sub(sizes.shell, sizes.largest);
        let near = graph.min(scaled, most);
        let near = graph.max(far, near);
        let within = graph.apply(Op::Less, &[foot.distance, sizes.shell]);
        graph.select(within, near, far)
    }

    pub(crate) fn extent(&self, lowerer: &mut Lowerer<'_>) -> Lowered<Extent> {
        let radius = self.radius_along(lowerer)?;
        let radius = lowerer.function("radius", 2, &[radius]);
        let sizes = self.sizes.as_ref().map(|sizes| sizes.index);
        Ok(Extent::Tube { curve: self.index, radius, caps: self.caps(), sizes })
    }

    /// Whether media in the tube keep their mass, whatever its shape.
    pub(crate) fn conserves_mass(&self) -> bool {
        self.outline.conserve_mass
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
                let along = if self.outline.stretch {
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
            LocalField::Depth => vec![self.depth(&mut lowerer.graph, &foot)],
            LocalField::Stretch => vec![stretch(lowerer, &foot)],
        })
    }

    /// Distance to the wall along the radius or to the nearer flat end along the axis: smooth where
    /// the bound by which surfaces are marched is not.
    fn depth(&self, graph: &mut Graph, foot: &Foot) -> ValueId {
        let beyond = self.beyond(graph, foot);
        graph.apply(Op::Neg, &[beyond])
    }

    /// How far a point is outside by a foot: negative inside.
    fn beyond(&self, graph: &mut Graph, foot: &Foot) -> ValueId {
        let mut beyond = self.beyond_radius(graph, foot);
        if self.caps() == Caps::Flat {
            let inside = from_nearer_end(graph, foot);
            let inside = graph.apply(Op::Neg, &[inside]);
            let ends = beyond_end(graph, foot, foot.overshoot, inside);
            beyond = graph.max(beyond, ends);
        }
        beyond
    }

    /// Offset from the axis, turned by the twist.
    fn twisted(&self, lowerer: &mut Lowerer<'_>, foot: &Foot) -> Lowered<(ValueId, ValueId)> {
        let mut angle = lowerer.call_numbers(&self.outline.twist, &[foot.t, foot.arc_length])?.scalar();
        let graph = &mut lowerer.graph;
        if let Some(sizes) = &self.sizes {
            // A closed curve comes back with its frame turned: spread over the length it fits.
            let turn = graph.mul(sizes.twist_rate, foot.arc_length);
            let turn = graph.add(turn, sizes.twist);
            angle = graph.add(angle, turn);
        }
        if graph.constant(angle) == Some(0.0) {
            return Ok((foot.x, foot.y));
        }
        let (sine, cosine) = (graph.apply(Op::Sin, &[angle]), graph.apply(Op::Cos, &[angle]));
        let (cx, sy) = (graph.mul(cosine, foot.x), graph.mul(sine, foot.y));
        let (sx, cy) = (graph.mul(sine, foot.x), graph.mul(cosine, foot.y));
        Ok((graph.sub(cx, sy), graph.add(sx, cy)))
    }
}

/// Length along the axis from the foot to the nearer end.
fn from_nearer_end(graph: &mut Graph, foot: &Foot) -> ValueId {
    let rest = graph.sub(foot.curve_length, foot.arc_length);
    graph.min(foot.arc_length, rest)
}

/// `outside` beyond an end of the axis, where the foot stays at the end, else `inside`.
fn beyond_end(graph: &mut Graph, foot: &Foot, outside: ValueId, inside: ValueId) -> ValueId {
    let zero = graph.number(0.0);
    let beyond = graph.apply(Op::Less, &[zero, foot.overshoot]);
    graph.select(beyond, outside, inside)
}

/// Bound on the distance to the flat ends, positive beyond them.
fn flat_ends(graph: &mut Graph, foot: &Foot, sizes: &Sizes) -> ValueId {
    let limit = graph.sub(sizes.end_limit, foot.distance);
    let outside = graph.min(foot.overshoot, limit);
    let inside = from_nearer_end(graph, foot);
    let inside = graph.mul(inside, sizes.end_scale);
    let inside = graph.min(inside, sizes.end_depth);
    let inside = graph.apply(Op::Neg, &[inside]);
    beyond_end(graph, foot, outside, inside)
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
