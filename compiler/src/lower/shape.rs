//! Solids: signed distance, local coordinates, extent.
//!
//! What is *exact* and what a *lower bound* is said at each variant.
//!
//! | room | holds |
//! |---|---|
//! | `primitives` | solids that are not made of others |
//! | `mandelbulb` | one of them, a fractal |
//! | `blend` | how two surfaces meet |
//! | `transform` | maps of space |
//! | `copies` | repetition |
//! | `parts` | large unions in parts |
//! | `steepness` | how fast the distance changes over a piece of a ray |
//! | `steady` | what may be grown and blended |

pub(crate) mod blend;
pub(crate) mod copies;
pub(crate) mod mandelbulb;
mod parts;
pub(crate) mod primitives;
mod steady;
mod steepness;
pub(crate) mod transform;

use super::tube::Tube;
use super::value::{Closure, Value};
use super::{Lowered, Lowerer};
use crate::ir::{FunctionId, ValueId};
use crate::ops::Op;
use crate::program::Extent;
use blend::Blend;
use copies::Copies;
use primitives::Primitive;
use std::rc::Rc;
use transform::Transform;
use vol_language::ast::BinaryOp;
use vol_language::diag::Diagnostic;
use vol_language::hir::LocalField;
use vol_language::source::Span;

/// Most parts of one solid, those used several times counted each time: `let b = a | a` doubles.
const MAX_PARTS: u32 = 100_000;

/// Deepest nesting of operators and transforms: what walks over a solid recurses so deep.
const MAX_LEVELS: u32 = 500;

/// A solid as the scene builds it.
#[derive(Debug)]
pub(crate) struct Shape {
    kind: Kind,
    /// Primitives and operators, shared ones counted each time.
    parts: u32,
    /// Nesting.
    levels: u32,
    /// Whether the distance changes no faster than the extent says.
    steady: bool,
    /// The call or operator that made it.
    span: Span,
}

/// The kinds of solids. Lengths are in scene units, negative distance is inside.
#[derive(Debug)]
pub(crate) enum Kind {
    /// Not made of others.
    Primitive(Primitive),
    /// Exact with round caps and one radius, else a lower bound; see [`Tube::distance`].
    Tube(Tube),
    /// The points of a box at the origin, given by its half extents, where a field is negative. Its
    /// distance is the field (as it is at the nearest point of the box) or that of the box if larger;
    /// divided by the steepness of the field in the box when it is marched.
    Implicit { field: Rc<Closure>, half: [ValueId; 3], span: Span },
    /// Lower bound outside.
    Union { shapes: Vec<Rc<Shape>>, blend: Blend },
    /// Lower bound.
    Intersection { shapes: Vec<Rc<Shape>>, blend: Blend },
    /// Lower bound.
    Difference { from: Rc<Shape>, what: Rc<Shape>, blend: Blend },
    /// Seen through a map of space.
    Transformed { child: Rc<Shape>, transform: Transform },
    /// Many times.
    Repeated { child: Rc<Shape>, copies: Copies },
    /// The child grown by a distance on all sides; exact outside if the child is.
    Rounded { child: Rc<Shape>, radius: ValueId },
    /// All points within a distance of the child's surface; exact if the child is.
    Shell { child: Rc<Shape>, half: ValueId },
    /// The child's distance plus an amount; divided by its steepness when it is marched.
    Displaced { child: Rc<Shape>, amount: Rc<Closure>, span: Span },
}

/// `a | b`, `a & b`, `a - b`
pub(crate) fn operator(
    lowerer: &Lowerer<'_>,
    op: BinaryOp,
    a: Rc<Shape>,
    b: Rc<Shape>,
    span: Span,
) -> Lowered<Value> {
    let kind = match op {
        BinaryOp::Union => Kind::Union { shapes: vec![a, b], blend: Blend::Sharp },
        BinaryOp::Intersection => Kind::Intersection { shapes: vec![a, b], blend: Blend::Sharp },
        BinaryOp::Subtract => Kind::Difference { from: a, what: b, blend: Blend::Sharp },
        other => unreachable!("shapes have no operator {}", other.symbol()),
    };
    Shape::value(kind, lowerer, span)
}

impl Shape {
    /// A value of a kind, within the limits; sizes known to make no solid are refused.
    pub(crate) fn value(kind: Kind, lowerer: &Lowerer<'_>, span: Span) -> Lowered<Value> {
        kind.check_sizes(lowerer, span)?;
        kind.check_steady(span)?;
        let children = kind.children();
        let parts = children.iter().fold(1u32, |sum, child| sum.saturating_add(child.parts));
        let parts = parts.saturating_mul(kind.copies());
        let levels = 1 + children.iter().map(|child| child.levels).max().unwrap_or(0);
        if parts > MAX_PARTS || levels > MAX_LEVELS {
            return Err(too_large(parts, span));
        }
        let steady = kind.is_steady();
        Ok(Value::Shape(Rc::new(Self { kind, parts, levels, steady, span })))
    }

    /// Whether the distance changes no faster than the extent says.
    pub(crate) fn is_steady(&self) -> bool {
        self.steady
    }

    /// Signed distance (or the bound that the variant states) at a point.
    pub(crate) fn distance(&self, lowerer: &mut Lowerer<'_>, p: [ValueId; 3]) -> Lowered<ValueId> {
        let outer = lowerer.graph.set_place(Some(self.span));
        let distance = self.distance_here(lowerer, p);
        lowerer.graph.set_place(outer);
        distance
    }

    fn distance_here(&self, lowerer: &mut Lowerer<'_>, p: [ValueId; 3]) -> Lowered<ValueId> {
        Ok(match &self.kind {
            Kind::Primitive(primitive) => primitive.distance(&mut lowerer.graph, p),
            Kind::Tube(tube) => tube.distance(lowerer, p)?,
            Kind::Implicit { field, half, .. } => {
                let graph = &mut lowerer.graph;
                let around = primitives::box_distance(graph, p, *half);
                let held = [0, 1, 2].map(|i| {
                    let low = graph.apply(Op::Neg, &[half[i]]);
                    primitives::clamped(graph, p[i], low, half[i])
                });
                let field = lowerer.call(field, &[Value::Numbers(held.to_vec())])?.scalar();
                lowerer.graph.max(around, field)
            }
            Kind::Union { shapes, blend } => {
                blend::fold(lowerer, shapes, p, |graph, a, b| blend.union(graph, a, b))?
            }
            Kind::Intersection { shapes, blend } => {
                blend::fold(lowerer, shapes, p, |graph, a, b| blend.intersection(graph, a, b))?
            }
            Kind::Difference { from, what, blend } => {
                let from = from.distance(lowerer, p)?;
                let what = what.distance(lowerer, p)?;
                let outside = lowerer.graph.apply(Op::Neg, &[what]);
                blend.intersection(&mut lowerer.graph, from, outside)
            }
            Kind::Transformed { child, transform } => transform.distance(lowerer, child, p)?,
            Kind::Repeated { child, copies } => copies.nearest(lowerer, child, p)?.1,
            Kind::Rounded { child, radius } => {
                let distance = child.distance(lowerer, p)?;
                lowerer.graph.sub(distance, *radius)
            }
            Kind::Shell { child, half } => {
                let distance = child.distance(lowerer, p)?;
                let off = lowerer.graph.apply(Op::Abs, &[distance]);
                lowerer.graph.sub(off, *half)
            }
            Kind::Displaced { child, amount, .. } => {
                let distance = child.distance(lowerer, p)?;
                let amount = lowerer.call(amount, &[Value::Numbers(p.to_vec())])?.scalar();
                lowerer.graph.add(distance, amount)
            }
        })
    }

    /// Where the shape is and how steep its distance.
    pub(crate) fn extent(&self, lowerer: &mut Lowerer<'_>, span: Span) -> Lowered<Extent> {
        match &self.kind {
            Kind::Primitive(primitive) => primitive.extent(lowerer, span),
            Kind::Tube(tube) => tube.extent(lowerer),
            Kind::Implicit { field, half, span } => {
                let (_, slope) = value_and_slope(lowerer, field, *span)?;
                let half = lowerer.slots(*half, "the bounds of a field", *span)?;
                Ok(Extent::Field { half, slope, span: *span })
            }
            Kind::Union { shapes, blend } => {
                let union = Extent::Union(extents(lowerer, shapes, span)?);
                let Some(width) = blend.width() else { return Ok(union) };
                let reach = lowerer.graph.number(blend.reach(shapes.len()));
                let reach = lowerer.graph.mul(width, reach);
                let reach = lowerer.slot(reach, "the width of a blend", span)?;
                Ok(Extent::Grown(Box::new(union), reach))
            }
            Kind::Intersection { shapes, .. } => Ok(Extent::Intersection(extents(lowerer, shapes, span)?)),
            Kind::Difference { from, what, .. } => {
                let from = from.extent(lowerer, span)?;
                // What is cut away adds its steepness, not its bounds.
                let what = Extent::Complement(Box::new(what.extent(lowerer, span)?));
                Ok(Extent::Intersection(vec![from, what]))
            }
            Kind::Transformed { child, transform } => transform.extent(lowerer, child, span),
            Kind::Repeated { child, copies } => copies.extent(lowerer, child, span),
            Kind::Rounded { child, radius } | Kind::Shell { child, half: radius } => {
                let child = child.extent(lowerer, span)?;
                let radius = lowerer.slot(*radius, "a radius", span)?;
                Ok(Extent::Grown(Box::new(child), radius))
            }
            Kind::Displaced { child, amount, span } => {
                let child = Box::new(child.extent(lowerer, *span)?);
                let (amount, slope) = value_and_slope(lowerer, amount, *span)?;
                Ok(Extent::Displaced { child, amount, slope, span: *span })
            }
        }
    }

    /// Whether the solid and its distance are known to be their own mirror images in the plane across
    /// an axis.
    pub(crate) fn is_symmetric(&self, axis: usize) -> bool {
        match &self.kind {
            Kind::Primitive(primitive) => primitive.is_symmetric(axis),
            Kind::Union { shapes, .. } | Kind::Intersection { shapes, .. } => {
                shapes.iter().all(|shape| shape.is_symmetric(axis))
            }
            Kind::Difference { from, what, .. } => from.is_symmetric(axis) && what.is_symmetric(axis),
            Kind::Rounded { child, .. } | Kind::Shell { child, .. } => child.is_symmetric(axis),
            Kind::Tube(_)
            | Kind::Implicit { .. }
            | Kind::Transformed { .. }
            | Kind::Repeated { .. }
            | Kind::Displaced { .. } => false,
        }
    }

    /// Whether media in the shape keep their mass: a tube that asks for it, under transforms too.
    pub(crate) fn conserves_mass(&self) -> bool {
        match &self.kind {
            Kind::Tube(tube) => tube.conserves_mass(),
            Kind::Transformed { child, .. }
            | Kind::Repeated { child, .. }
            | Kind::Rounded { child, .. }
            | Kind::Shell { child, .. }
            | Kind::Displaced { child, .. } => child.conserves_mass(),
            Kind::Primitive(_)
            | Kind::Implicit { .. }
            | Kind::Union { .. }
            | Kind::Intersection { .. }
            | Kind::Difference { .. } => false,
        }
    }

    /// The tube that the shape is, moved or not, if media add up over its feet; with the point in its
    /// coordinates.
    pub(crate) fn adding_up(
        &self,
        graph: &mut crate::ir::graph::Graph,
        p: [ValueId; 3],
    ) -> Option<(&Tube, [ValueId; 3])> {
        match &self.kind {
            Kind::Tube(tube) => tube.adds_up().then_some((tube, p)),
            Kind::Transformed { child, transform } => {
                let inner = transform.to_child(graph, p);
                child.adding_up(graph, inner)
            }
            Kind::Primitive(_)
            | Kind::Implicit { .. }
            | Kind::Union { .. }
            | Kind::Intersection { .. }
            | Kind::Difference { .. }
            | Kind::Repeated { .. }
            | Kind::Rounded { .. }
            | Kind::Shell { .. }
            | Kind::Displaced { .. } => None,
        }
    }

    /// Whether some tube in the shape is as asked.
    pub(crate) fn has_tube(&self, asked: &dyn Fn(&Tube) -> bool) -> bool {
        matches!(&self.kind, Kind::Tube(tube) if asked(tube))
            || self.kind.children().iter().any(|child| child.has_tube(asked))
    }

    /// A coordinate of the region's own map at a world position.
    pub(crate) fn local_field(
        &self,
        lowerer: &mut Lowerer<'_>,
        p: [ValueId; 3],
        field: LocalField,
        span: Span,
    ) -> Lowered<Vec<ValueId>> {
        if let Kind::Tube(tube) = &self.kind {
            return tube.local_field(lowerer, p, field);
        }
        if field == LocalField::Depth {
            let distance = self.distance(lowerer, p)?;
            return Ok(vec![lowerer.graph.apply(Op::Neg, &[distance])]);
        }
        match &self.kind {
            Kind::Transformed { child, transform } => {
                let inner = transform.to_child(&mut lowerer.graph, p);
                let local = child.local_field(lowerer, inner, field, span)?;
                if field != LocalField::Stretch {
                    return Ok(local);
                }
                let volume = transform.volume(&mut lowerer.graph);
                return Ok(vec![lowerer.graph.mul(local[0], volume)]);
            }
            Kind::Repeated { child, copies } => {
                let (inner, _) = copies.nearest(lowerer, child, p)?;
                return child.local_field(lowerer, inner, field, span);
            }
            Kind::Rounded { child, .. } | Kind::Shell { child, .. } | Kind::Displaced { child, .. } => {
                return child.local_field(lowerer, p, field, span);
            }
            Kind::Primitive(_)
            | Kind::Tube(_)
            | Kind::Implicit { .. }
            | Kind::Union { .. }
            | Kind::Intersection { .. }
            | Kind::Difference { .. } => {}
        }
        let graph = &mut lowerer.graph;
        match (field, &self.kind) {
            (LocalField::Local, _) => Ok(p.to_vec()),
            (LocalField::Stretch, _) => Ok(vec![graph.number(1.0)]),
            (LocalField::Angle, _) => Ok(vec![graph.apply(Op::Atan2, &[p[2], p[0]])]),
            (LocalField::Radius, Kind::Primitive(Primitive::Sphere { radius })) => {
                let length = graph.length(&p);
                Ok(vec![graph.div(length, *radius)])
            }
            (
                LocalField::Radius,
                Kind::Primitive(Primitive::Cylinder { radius, .. } | Primitive::InfiniteCylinder { radius }),
            ) => {
                let radial = graph.length(&[p[0], p[2]]);
                Ok(vec![graph.div(radial, *radius)])
            }
            (LocalField::L, Kind::Primitive(Primitive::Cylinder { half_height, .. })) => {
                Ok(vec![graph.add(p[1], *half_height)])
            }
            (LocalField::T, Kind::Primitive(Primitive::Cylinder { half_height, .. })) => {
                let along = graph.add(p[1], *half_height);
                let height = graph.add(*half_height, *half_height);
                Ok(vec![graph.div(along, height)])
            }
            (field, _) => Err(no_such_coordinate(field, span)),
        }
    }
}

impl Kind {
    /// Refuses sizes that are known to make no solid.
    fn check_sizes(&self, lowerer: &Lowerer<'_>, span: Span) -> Lowered<()> {
        match self {
            Self::Primitive(primitive) => primitive.check_sizes(lowerer, span),
            Self::Implicit { half, .. } => {
                let place = lowerer.argument_span(1, span);
                lowerer.refuse(half, |x| x <= 0.0, "the bounds of a field must be more than 0", place)
            }
            Self::Transformed { transform, .. } => transform.check_sizes(lowerer, span),
            Self::Tube(_)
            | Self::Union { .. }
            | Self::Intersection { .. }
            | Self::Difference { .. }
            | Self::Repeated { .. }
            | Self::Rounded { .. }
            | Self::Shell { .. }
            | Self::Displaced { .. } => Ok(()),
        }
    }

    /// The shapes that this one is made of.
    fn children(&self) -> Vec<&Shape> {
        match self {
            Self::Primitive(_) | Self::Tube(_) | Self::Implicit { .. } => Vec::new(),
            Self::Union { shapes, .. } | Self::Intersection { shapes, .. } => {
                shapes.iter().map(|shape| &**shape).collect()
            }
            Self::Difference { from, what, .. } => vec![from, what],
            Self::Transformed { child, .. }
            | Self::Repeated { child, .. }
            | Self::Rounded { child, .. }
            | Self::Shell { child, .. }
            | Self::Displaced { child, .. } => vec![child],
        }
    }

    /// How often the children are computed at each point.
    fn copies(&self) -> u32 {
        match self {
            Self::Repeated { copies, .. } => copies.asked(),
            Self::Primitive(_)
            | Self::Tube(_)
            | Self::Implicit { .. }
            | Self::Union { .. }
            | Self::Intersection { .. }
            | Self::Difference { .. }
            | Self::Transformed { .. }
            | Self::Rounded { .. }
            | Self::Shell { .. }
            | Self::Displaced { .. } => 1,
        }
    }
}

fn too_large(parts: u32, span: Span) -> Box<Diagnostic> {
    let (code, message) = if parts > MAX_PARTS {
        ("E0401", format!("this shape has more than {MAX_PARTS} parts"))
    } else {
        ("E0402", format!("the operators of this shape nest more than {MAX_LEVELS} deep"))
    };
    Box::new(
        Diagnostic::error(code, message, span, "the limit is reached here")
            .with_help("use fewer copies, or join many shapes by one `union([…])`"),
    )
}

fn no_such_coordinate(field: LocalField, span: Span) -> Box<Diagnostic> {
    let (_, name, _) = LocalField::ALL.iter().find(|(f, ..)| *f == field).expect("ALL lists every field");
    let message = format!("this region has no coordinate q.{name}");
    Box::new(
        Diagnostic::error(
            "E0406",
            message,
            span,
            "only tubes, spheres and cylinders have a radius, only tubes and cylinders a length",
        )
        .with_help("use q.local, q.depth or q.world"),
    )
}

fn extents(lowerer: &mut Lowerer<'_>, shapes: &[Rc<Shape>], span: Span) -> Lowered<Vec<Extent>> {
    shapes.iter().map(|shape| shape.extent(lowerer, span)).collect()
}

/// A function of the position and its gradient, as functions of their own.
fn value_and_slope(
    lowerer: &mut Lowerer<'_>,
    of: &Rc<Closure>,
    span: Span,
) -> Lowered<(FunctionId, FunctionId)> {
    let p = lowerer.position();
    let value = lowerer.call(of, &[Value::Numbers(p.to_vec())])?.scalar();
    let slope = gradient(lowerer, value, span)?;
    let value = lowerer.function("displacement", 3, &[value]);
    let slope = lowerer.function("displacement slope", 3, &slope);
    Ok((value, slope))
}

/// Derivatives of a value with respect to the position.
pub(crate) fn gradient(lowerer: &mut Lowerer<'_>, value: ValueId, span: Span) -> Lowered<Vec<ValueId>> {
    crate::passes::gradient::gradient(&mut lowerer.graph, value, &[0, 1, 2]).ok_or_else(|| {
        let message = "this surface has no slope by which it could be lit and marched";
        let label = "it contains an `fbm` whose lacunarity or gain changes with the position";
        let help = "make lacunarity and gain constant";
        Box::new(Diagnostic::error("E0408", message, span, label).with_help(help))
    })
}
