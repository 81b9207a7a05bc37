//! Solids seen through a map of space: where the child is asked, and what its answer means.
//!
//! A map that nowhere stretches lengths leaves the answer a bound. Others state in their extent how
//! steep they make it (`algorithms.md` §7.2).

use super::primitives::{box_distance, clamped};
use super::{Lowered, Shape};
use crate::ir::ValueId;
use crate::ir::graph::Graph;
use crate::lower::Lowerer;
use crate::ops::Op;
use crate::program::{Extent, Measure};
use std::rc::Rc;
use vol_language::source::Span;

/// Maps of space.
#[derive(Clone, Debug)]
pub(crate) enum Transform {
    /// As exact as the child.
    Translate { offset: [ValueId; 3] },
    /// As exact as the child; columns of the rotation matrix.
    Rotate { columns: [[ValueId; 3]; 3] },
    /// As exact as the child.
    Scale { factor: ValueId },
    /// Lower bound: the child's distance times the least factor, or the distance of the box around
    /// the solid (`centre`, `half`) if that is larger.
    Stretch { factors: [ValueId; 3], centre: [ValueId; 3], half: [ValueId; 3] },
    /// What is on the side of a unit normal, and its mirror image; as exact as the child if nothing of
    /// it is on the other side, else a lower bound.
    Mirror { normal: [ValueId; 3] },
    /// Cut at the origin across each axis and pulled apart by twice these lengths; exact outside if
    /// the child is.
    Elongate { by: [ValueId; 3] },
    /// Turned about the y axis in proportion to y, in radians per length. The child is within `radius`
    /// of the axis; further out it is asked at the nearest point within, or the distance to there is
    /// taken if that is larger.
    Twist { rate: ValueId, radius: ValueId },
    /// The x axis bent in the plane of x and y, see [`Bend`].
    Bend(Bend),
}

/// The x axis becomes a circle about (0, 1 / rate): towards +y for a positive rate. The map back
/// stretches without bound at the centre and is cut opposite the origin, so the distance is held at a
/// margin in which neither is reached, or is that of the box around the bent solid if that is larger.
#[derive(Clone, Debug)]
pub(crate) struct Bend {
    /// Radians per length.
    rate: ValueId,
    /// Centre and half extents of the box of the child.
    child: [[ValueId; 3]; 2],
    /// Centre and half extents of the box of the bent child.
    bent: [[ValueId; 3]; 2],
}

impl Bend {
    /// |rate|, large enough to divide by: a smaller one bends by less than rounding.
    fn safe_rate(&self, graph: &mut Graph) -> ValueId {
        let least = graph.number(1e-9);
        let size = graph.apply(Op::Abs, &[self.rate]);
        graph.max(size, least)
    }

    /// Straightened. With s = |(rate x, 1 - rate y)| the height over the circle is (1 - s) / rate, here
    /// without its cancellation at small rates.
    fn to_child(&self, graph: &mut Graph, p: [ValueId; 3]) -> [ValueId; 3] {
        let (one, two) = (graph.number(1.0), graph.number(2.0));
        let size = self.safe_rate(graph);
        let across = graph.mul(size, p[0]);
        let drop = graph.mul(self.rate, p[1]);
        let towards = graph.sub(one, drop);
        let angle = graph.apply(Op::Atan2, &[across, towards]);
        let x = graph.div(angle, size);
        let s = graph.length(&[across, towards]);
        let squared = graph.dot(&[p[0], p[1]], &[p[0], p[1]]);
        let curved = graph.mul(self.rate, squared);
        let twice = graph.mul(two, p[1]);
        let above = graph.sub(twice, curved);
        let below = graph.add(one, s);
        [x, graph.div(above, below), p[2]]
    }

    /// How far off the child's box the map is still good: to the cut along x, half way to the centre.
    fn margin(&self, graph: &mut Graph) -> ValueId {
        let size = self.safe_rate(graph);
        let [centre, half] = self.child;
        let mut room = |axis: usize, angle: f64| {
            let off = graph.apply(Op::Abs, &[centre[axis]]);
            let reach = graph.add(off, half[axis]);
            let angle = graph.number(angle);
            let end = graph.div(angle, size);
            graph.sub(end, reach)
        };
        let (along, inwards) = (room(0, std::f64::consts::PI), room(1, 1.0));
        let part = graph.number(0.5);
        let inwards = graph.mul(part, inwards);
        graph.min(along, inwards)
    }

    fn distance(&self, lowerer: &mut Lowerer<'_>, child: &Shape, p: [ValueId; 3]) -> Lowered<ValueId> {
        let inner = self.to_child(&mut lowerer.graph, p);
        let distance = child.distance(lowerer, inner)?;
        let graph = &mut lowerer.graph;
        let mut off = |p: [ValueId; 3], [centre, half]: [[ValueId; 3]; 2]| {
            let from_centre = [0, 1, 2].map(|i| graph.sub(p[i], centre[i]));
            box_distance(graph, from_centre, half)
        };
        let (straight, around) = (off(inner, self.child), off(p, self.bent));
        let margin = self.margin(graph);
        let near = graph.max(distance, straight);
        let held = graph.min(near, margin);
        Ok(graph.max(held, around))
    }
}

/// The axis along which a unit normal is known to point, and its number there, 1 or -1. The absolute value is exact, as
/// `x - 2 min(x, 0)` is; but drivers may add what is subtracted next to `x` first, which rounds.
fn axis_of(graph: &Graph, normal: [ValueId; 3]) -> Option<(usize, f64)> {
    let normal = normal.map(|component| graph.constant(component));
    let (axis, sign) =
        normal.iter().enumerate().find_map(|(axis, &n)| Some((axis, n.filter(|n| n.abs() == 1.0)?)))?;
    let is_along = (0..3).all(|other| other == axis || normal[other] == Some(0.0));
    is_along.then_some((axis, sign))
}

impl Transform {
    /// Whether solids keep their shape, up to their size: then the union of two is moved as each of them is.
    pub(super) fn keeps_shape(&self) -> bool {
        matches!(self, Self::Translate { .. } | Self::Rotate { .. } | Self::Scale { .. })
    }

    /// How volumes of the child change; 1 for transforms that move and turn.
    pub(super) fn volume(&self, graph: &mut Graph) -> ValueId {
        let factors = match self {
            Self::Scale { factor } => [*factor; 3],
            Self::Stretch { factors, .. } => *factors,
            Self::Translate { .. }
            | Self::Rotate { .. }
            | Self::Mirror { .. }
            | Self::Elongate { .. }
            | Self::Twist { .. }
            | Self::Bend(_) => return graph.number(1.0),
        };
        let area = graph.mul(factors[0], factors[1]);
        graph.mul(area, factors[2])
    }

    /// A point in the coordinates of the child.
    pub(super) fn to_child(&self, graph: &mut Graph, p: [ValueId; 3]) -> [ValueId; 3] {
        match self {
            Self::Translate { offset } => [0, 1, 2].map(|i| graph.sub(p[i], offset[i])),
            Self::Rotate { columns } => columns.map(|column| graph.dot(&column, &p)),
            Self::Scale { factor } => p.map(|v| graph.div(v, *factor)),
            Self::Stretch { factors, .. } => [0, 1, 2].map(|i| graph.div(p[i], factors[i])),
            Self::Mirror { normal } if let Some((axis, sign)) = axis_of(graph, *normal) => {
                let mut mirrored = p;
                mirrored[axis] = graph.apply(Op::Abs, &[p[axis]]);
                if sign < 0.0 {
                    mirrored[axis] = graph.apply(Op::Neg, &[mirrored[axis]]);
                }
                mirrored
            }
            Self::Mirror { normal } => {
                let (zero, two) = (graph.number(0.0), graph.number(2.0));
                let height = graph.dot(normal, &p);
                let below = graph.min(height, zero);
                let back = graph.mul(two, below);
                [0, 1, 2].map(|i| {
                    let step = graph.mul(back, normal[i]);
                    graph.sub(p[i], step)
                })
            }
            Self::Elongate { by } => [0, 1, 2].map(|i| {
                let low = graph.apply(Op::Neg, &[by[i]]);
                let middle = clamped(graph, p[i], low, by[i]);
                graph.sub(p[i], middle)
            }),
            Self::Twist { rate, .. } => {
                // Back by the turn that is right at this height: against z towards x.
                let angle = graph.mul(*rate, p[1]);
                let (sine, cosine) = (graph.apply(Op::Sin, &[angle]), graph.apply(Op::Cos, &[angle]));
                turned_back(graph, p, sine, cosine)
            }
            Self::Bend(bend) => bend.to_child(graph, p),
        }
    }

    /// Distance of the transformed child.
    pub(super) fn distance(
        &self,
        lowerer: &mut Lowerer<'_>,
        child: &Shape,
        p: [ValueId; 3],
    ) -> Lowered<ValueId> {
        let graph = &mut lowerer.graph;
        match self {
            Self::Translate { .. } | Self::Rotate { .. } | Self::Mirror { .. } | Self::Elongate { .. } => {
                let inner = self.to_child(graph, p);
                child.distance(lowerer, inner)
            }
            Self::Scale { factor } => {
                let inner = self.to_child(graph, p);
                let distance = child.distance(lowerer, inner)?;
                Ok(lowerer.graph.mul(distance, *factor))
            }
            Self::Stretch { factors, centre, half } => {
                let inner = self.to_child(graph, p);
                let distance = child.distance(lowerer, inner)?;
                let graph = &mut lowerer.graph;
                let least = graph.min(factors[0], factors[1]);
                let least = graph.min(least, factors[2]);
                let near = graph.mul(distance, least);
                let from_centre = [0, 1, 2].map(|i| graph.sub(p[i], centre[i]));
                let around = box_distance(graph, from_centre, *half);
                Ok(graph.max(around, near))
            }
            Self::Twist { radius, .. } => {
                let (tiny, one) = (graph.number(1e-30), graph.number(1.0));
                let radial = graph.length(&[p[0], p[2]]);
                let beyond = graph.sub(radial, *radius);
                let safe = graph.max(radial, tiny);
                let shrink = graph.div(*radius, safe);
                let shrink = graph.min(shrink, one);
                let held = [graph.mul(p[0], shrink), p[1], graph.mul(p[2], shrink)];
                let inner = self.to_child(graph, held);
                let distance = child.distance(lowerer, inner)?;
                Ok(lowerer.graph.max(beyond, distance))
            }
            Self::Bend(bend) => bend.distance(lowerer, child, p),
        }
    }

    /// Refuses numbers that are known to leave no solid.
    pub(super) fn check_sizes(&self, lowerer: &Lowerer<'_>, span: Span) -> Lowered<()> {
        let span = lowerer.argument_span(1, span);
        match self {
            Self::Scale { factor } => {
                lowerer.refuse(&[*factor], |x| x <= 0.0, "a scale must be more than 0", span)
            }
            Self::Stretch { factors, .. } => {
                lowerer.refuse(factors, |x| x <= 0.0, "a scale must be more than 0", span)
            }
            Self::Elongate { by } => {
                lowerer.refuse(by, |x| x < 0.0, "a length to pull apart by must be at least 0", span)
            }
            Self::Translate { .. }
            | Self::Rotate { .. }
            | Self::Mirror { .. }
            | Self::Twist { .. }
            | Self::Bend(_) => Ok(()),
        }
    }

    /// Where the transformed child is and how steep its distance.
    pub(super) fn extent(&self, lowerer: &mut Lowerer<'_>, child: &Shape, span: Span) -> Lowered<Extent> {
        let (zero, one) = (lowerer.graph.number(0.0), lowerer.graph.number(1.0));
        let within = Box::new(child.extent(lowerer, span)?);
        match self {
            Self::Translate { offset } => place(lowerer, within, diagonal([one; 3], zero), *offset, span),
            Self::Rotate { columns } => place(lowerer, within, *columns, [zero; 3], span),
            Self::Scale { factor } => place(lowerer, within, diagonal([*factor; 3], zero), [zero; 3], span),
            Self::Stretch { factors, .. } => {
                place(lowerer, within, diagonal(*factors, zero), [zero; 3], span)
            }
            Self::Mirror { normal } => {
                // Columns of the reflection: e_i - 2 n_i n.
                let graph = &mut lowerer.graph;
                let two = graph.number(2.0);
                let unit = diagonal([one; 3], zero);
                let columns = [0, 1, 2].map(|i| {
                    [0, 1, 2].map(|j| {
                        let product = graph.mul(normal[i], normal[j]);
                        let product = graph.mul(two, product);
                        graph.sub(unit[i][j], product)
                    })
                });
                let image = place(lowerer, within.clone(), columns, [zero; 3], span)?;
                Ok(Extent::Union(vec![*within, image]))
            }
            Self::Elongate { by } => {
                let by = lowerer.slots(*by, "a length", span)?;
                Ok(Extent::Elongated { child: within, by })
            }
            Self::Twist { rate, .. } => {
                let rate = lowerer.slot(*rate, "a twist", span)?;
                Ok(Extent::Twisted { child: within, rate, span })
            }
            Self::Bend(bend) => {
                let rate = lowerer.slot(bend.rate, "a bend", span)?;
                Ok(Extent::Bent { child: within, rate, span })
            }
        }
    }
}

/// A child twisted by an angle per length; not at all by a constant 0.
pub(crate) fn twist(
    lowerer: &mut Lowerer<'_>,
    child: &Rc<Shape>,
    rate: ValueId,
    span: Span,
) -> Lowered<Transform> {
    let extent = child.extent(lowerer, span)?;
    let radius = lowerer.measure(Measure::Radius(extent))[0];
    Ok(Transform::Twist { rate, radius })
}

/// A child bent by an angle per length.
pub(crate) fn bend(
    lowerer: &mut Lowerer<'_>,
    child: &Rc<Shape>,
    rate: ValueId,
    span: Span,
) -> Lowered<Transform> {
    let extent = child.extent(lowerer, span)?;
    let slot = lowerer.slot(rate, "a bend", span)?;
    let bent = Extent::Bent { child: Box::new(extent.clone()), rate: slot, span };
    let (child, bent) = (measured_box(lowerer, extent), measured_box(lowerer, bent));
    Ok(Transform::Bend(Bend { rate, child, bent }))
}

/// A child scaled by a factor per axis.
pub(crate) fn stretch(
    lowerer: &mut Lowerer<'_>,
    child: &Rc<Shape>,
    factors: [ValueId; 3],
    span: Span,
) -> Lowered<Transform> {
    let extent = Box::new(child.extent(lowerer, span)?);
    let zero = lowerer.graph.number(0.0);
    let extent = place(lowerer, extent, diagonal(factors, zero), [zero; 3], span)?;
    let [centre, half] = measured_box(lowerer, extent);
    Ok(Transform::Stretch { factors, centre, half })
}

/// Centre and half extents of the box of a solid.
fn measured_box(lowerer: &mut Lowerer<'_>, extent: Extent) -> [[ValueId; 3]; 2] {
    let corners = lowerer.measure(Measure::Box(extent));
    let [x, y, z, half_x, half_y, half_z] = corners[..] else {
        unreachable!("a box is measured by six numbers")
    };
    [[x, y, z], [half_x, half_y, half_z]]
}

/// Turned about the y axis from x towards z, given sine and cosine of the angle.
pub(super) fn turned_back(
    graph: &mut Graph,
    p: [ValueId; 3],
    sine: ValueId,
    cosine: ValueId,
) -> [ValueId; 3] {
    let minus = graph.apply(Op::Neg, &[sine]);
    [graph.dot(&[cosine, minus], &[p[0], p[2]]), p[1], graph.dot(&[sine, cosine], &[p[0], p[2]])]
}

fn diagonal(scale: [ValueId; 3], zero: ValueId) -> [[ValueId; 3]; 3] {
    [[scale[0], zero, zero], [zero, scale[1], zero], [zero, zero, scale[2]]]
}

fn place(
    lowerer: &mut Lowerer<'_>,
    child: Box<Extent>,
    columns: [[ValueId; 3]; 3],
    offset: [ValueId; 3],
    span: Span,
) -> Lowered<Extent> {
    let mut column = |i: usize| lowerer.slots(columns[i], "a transform", span);
    let columns = [column(0)?, column(1)?, column(2)?];
    let offset = lowerer.slots(offset, "a transform", span)?;
    Ok(Extent::Placed { child, columns, offset })
}
