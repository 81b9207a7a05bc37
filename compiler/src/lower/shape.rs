//! Solids: signed distance, local coordinates, extent.
//!
//! Primitives, operators and transforms follow the formulas that the design gives with their
//! proofs; what is *exact* and what a *lower bound* is said at each variant.

use super::tube::Tube;
use super::value::{Closure, Value};
use super::{Lowered, Lowerer};
use crate::ir::ValueId;
use crate::ir::graph::Graph;
use crate::ops::Op;
use crate::program::Extent;
use std::rc::Rc;
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
}

/// The kinds of solids. Lengths are in scene units, negative distance is inside.
#[derive(Debug)]
pub(crate) enum Kind {
    /// Exact.
    Sphere { radius: ValueId },
    /// Exact; half extents along the axes.
    Box { half: [ValueId; 3] },
    /// Exact; axis y.
    Cylinder { radius: ValueId, half_height: ValueId },
    /// Exact; axis y, without ends.
    InfiniteCylinder { radius: ValueId },
    /// Exact; axis y, the circle of radius `major` thickened by `minor`.
    Torus { major: ValueId, minor: ValueId },
    /// Exact; the segment from `a` to `b` thickened by `radius`.
    Capsule { a: [ValueId; 3], b: [ValueId; 3], radius: ValueId },
    /// Exact; all points with `normal . p <= offset`, the normal of unit length.
    Plane { normal: [ValueId; 3], offset: ValueId },
    /// See [`Tube`]; not a distance bound, so a region only.
    Tube(Tube),
    /// Lower bound outside.
    Union { shapes: Vec<Rc<Shape>>, smooth: Option<ValueId> },
    /// Lower bound.
    Intersection { shapes: Vec<Rc<Shape>>, smooth: Option<ValueId> },
    /// Lower bound.
    Difference { from: Rc<Shape>, what: Rc<Shape>, smooth: Option<ValueId> },
    /// As exact as the child.
    Translated { child: Rc<Shape>, offset: [ValueId; 3] },
    /// As exact as the child; columns of the rotation matrix.
    Rotated { child: Rc<Shape>, columns: [[ValueId; 3]; 3] },
    /// As exact as the child.
    Scaled { child: Rc<Shape>, factor: ValueId },
    /// The child grown by a distance on all sides; exact outside if the child is.
    Rounded { child: Rc<Shape>, radius: ValueId },
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
        BinaryOp::Union => Kind::Union { shapes: vec![a, b], smooth: None },
        BinaryOp::Intersection => Kind::Intersection { shapes: vec![a, b], smooth: None },
        BinaryOp::Subtract => Kind::Difference { from: a, what: b, smooth: None },
        other => unreachable!("shapes have no operator {}", other.symbol()),
    };
    Shape::value(kind, lowerer, span)
}

impl Shape {
    /// A value of a kind, within the limits; sizes known to make no solid are refused.
    pub(crate) fn value(kind: Kind, lowerer: &Lowerer<'_>, span: Span) -> Lowered<Value> {
        kind.check_sizes(lowerer, span)?;
        let children = kind.children();
        let parts = children.iter().fold(1u32, |sum, child| sum.saturating_add(child.parts));
        let levels = 1 + children.iter().map(|child| child.levels).max().unwrap_or(0);
        if parts > MAX_PARTS || levels > MAX_LEVELS {
            return Err(too_large(parts, span));
        }
        Ok(Value::Shape(Rc::new(Self { kind, parts, levels })))
    }

    /// Signed distance (or the bound that the variant states) at a point.
    pub(crate) fn distance(&self, lowerer: &mut Lowerer<'_>, p: [ValueId; 3]) -> Lowered<ValueId> {
        let graph = &mut lowerer.graph;
        Ok(match &self.kind {
            Kind::Sphere { radius } => {
                let length = graph.length(&p);
                graph.sub(length, *radius)
            }
            Kind::Box { half } => box_distance(graph, p, *half),
            Kind::Cylinder { radius, half_height } => {
                let radial = graph.length(&[p[0], p[2]]);
                let radial = graph.sub(radial, *radius);
                let axial = graph.apply(Op::Abs, &[p[1]]);
                let axial = graph.sub(axial, *half_height);
                corner_distance(graph, &[radial, axial])
            }
            Kind::InfiniteCylinder { radius } => {
                let radial = graph.length(&[p[0], p[2]]);
                graph.sub(radial, *radius)
            }
            Kind::Torus { major, minor } => {
                let radial = graph.length(&[p[0], p[2]]);
                let radial = graph.sub(radial, *major);
                let tube = graph.length(&[radial, p[1]]);
                graph.sub(tube, *minor)
            }
            Kind::Capsule { a, b, radius } => capsule_distance(graph, p, *a, *b, *radius),
            Kind::Plane { normal, offset } => {
                let height = graph.dot(normal, &p);
                graph.sub(height, *offset)
            }
            Kind::Tube(tube) => tube.distance(lowerer, p)?,
            Kind::Union { shapes, smooth } => fold_shapes(lowerer, shapes, p, *smooth, smooth_min)?,
            Kind::Intersection { shapes, smooth } => fold_shapes(lowerer, shapes, p, *smooth, smooth_max)?,
            Kind::Difference { from, what, smooth } => {
                let from = from.distance(lowerer, p)?;
                let what = what.distance(lowerer, p)?;
                let outside = lowerer.graph.apply(Op::Neg, &[what]);
                smooth_max(&mut lowerer.graph, from, outside, *smooth)
            }
            Kind::Translated { child, .. } | Kind::Rotated { child, .. } => {
                let inner = self.child_position(graph, p);
                child.distance(lowerer, inner)?
            }
            Kind::Scaled { child, factor } => {
                let inner = self.child_position(graph, p);
                let distance = child.distance(lowerer, inner)?;
                lowerer.graph.mul(distance, *factor)
            }
            Kind::Rounded { child, radius } => {
                let distance = child.distance(lowerer, p)?;
                lowerer.graph.sub(distance, *radius)
            }
            Kind::Displaced { child, amount, .. } => {
                let distance = child.distance(lowerer, p)?;
                let amount = lowerer.call(amount, &[Value::Numbers(p.to_vec())])?.scalar();
                lowerer.graph.add(distance, amount)
            }
        })
    }

    /// A point in the coordinates of the child of a transform.
    fn child_position(&self, graph: &mut Graph, p: [ValueId; 3]) -> [ValueId; 3] {
        match &self.kind {
            Kind::Translated { offset, .. } => [0, 1, 2].map(|i| graph.sub(p[i], offset[i])),
            Kind::Rotated { columns, .. } => columns.map(|column| graph.dot(&column, &p)),
            Kind::Scaled { factor, .. } => p.map(|v| graph.div(v, *factor)),
            Kind::Sphere { .. }
            | Kind::Box { .. }
            | Kind::Cylinder { .. }
            | Kind::InfiniteCylinder { .. }
            | Kind::Torus { .. }
            | Kind::Capsule { .. }
            | Kind::Plane { .. }
            | Kind::Tube(_)
            | Kind::Union { .. }
            | Kind::Intersection { .. }
            | Kind::Difference { .. }
            | Kind::Rounded { .. }
            | Kind::Displaced { .. } => p,
        }
    }

    /// Where the shape is and how steep its distance.
    pub(crate) fn extent(&self, lowerer: &mut Lowerer<'_>, span: Span) -> Lowered<Extent> {
        let zero = lowerer.graph.number(0.0);
        match &self.kind {
            Kind::Sphere { radius } => centred_box(lowerer, [*radius; 3], span),
            Kind::Box { half } => centred_box(lowerer, *half, span),
            Kind::Cylinder { radius, half_height } => {
                centred_box(lowerer, [*radius, *half_height, *radius], span)
            }
            Kind::Torus { major, minor } => {
                let wide = lowerer.graph.add(*major, *minor);
                centred_box(lowerer, [wide, *minor, wide], span)
            }
            Kind::Capsule { a, b, radius } => {
                let graph = &mut lowerer.graph;
                let lo = [0, 1, 2].map(|i| graph.min(a[i], b[i]));
                let hi = [0, 1, 2].map(|i| graph.max(a[i], b[i]));
                let lo = lowerer.slots(lo, "a shape", span)?;
                let hi = lowerer.slots(hi, "a shape", span)?;
                let radius = lowerer.slot(*radius, "a radius", span)?;
                Ok(Extent::Grown(Box::new(Extent::Box { lo, hi }), radius))
            }
            Kind::InfiniteCylinder { .. } | Kind::Plane { .. } => Ok(Extent::Unbounded),
            Kind::Tube(tube) => tube.extent(lowerer),
            Kind::Union { shapes, smooth } => {
                let union = Extent::Union(extents(lowerer, shapes, span)?);
                // The blend bulges out by at most a quarter of its width.
                let quarter = lowerer.graph.number(0.25);
                let bulge = smooth.map_or(zero, |k| lowerer.graph.mul(k, quarter));
                let bulge = lowerer.slot(bulge, "the width of a blend", span)?;
                Ok(if smooth.is_some() { Extent::Grown(Box::new(union), bulge) } else { union })
            }
            Kind::Intersection { shapes, .. } => Ok(Extent::Intersection(extents(lowerer, shapes, span)?)),
            Kind::Difference { from, what, .. } => {
                let from = from.extent(lowerer, span)?;
                // What is cut away adds its steepness, not its bounds.
                let what = Extent::Complement(Box::new(what.extent(lowerer, span)?));
                Ok(Extent::Intersection(vec![from, what]))
            }
            Kind::Translated { child, offset } => {
                let one = lowerer.graph.number(1.0);
                place(lowerer, child, identity(one, zero), *offset, span)
            }
            Kind::Rotated { child, columns } => place(lowerer, child, *columns, [zero; 3], span),
            Kind::Scaled { child, factor } => place(lowerer, child, identity(*factor, zero), [zero; 3], span),
            Kind::Rounded { child, radius } => {
                let child = child.extent(lowerer, span)?;
                let radius = lowerer.slot(*radius, "a radius", span)?;
                Ok(Extent::Grown(Box::new(child), radius))
            }
            Kind::Displaced { child, amount, span } => displaced_extent(lowerer, child, amount, *span),
        }
    }

    /// A coordinate of the region's own map at a world position.
    pub(crate) fn local_field(
        &self,
        lowerer: &mut Lowerer<'_>,
        p: [ValueId; 3],
        field: LocalField,
        span: Span,
    ) -> Lowered<Vec<ValueId>> {
        if field == LocalField::Depth {
            let distance = self.distance(lowerer, p)?;
            return Ok(vec![lowerer.graph.apply(Op::Neg, &[distance])]);
        }
        if let Kind::Tube(tube) = &self.kind {
            return tube.local_field(lowerer, p, field);
        }
        if let Kind::Translated { child, .. }
        | Kind::Rotated { child, .. }
        | Kind::Scaled { child, .. }
        | Kind::Rounded { child, .. }
        | Kind::Displaced { child, .. } = &self.kind
        {
            let inner = self.child_position(&mut lowerer.graph, p);
            return child.local_field(lowerer, inner, field, span);
        }
        let graph = &mut lowerer.graph;
        match (field, &self.kind) {
            (LocalField::Local, _) => Ok(p.to_vec()),
            (LocalField::Stretch, _) => Ok(vec![graph.number(1.0)]),
            (LocalField::Angle, _) => Ok(vec![graph.apply(Op::Atan2, &[p[2], p[0]])]),
            (LocalField::Radius, Kind::Sphere { radius }) => {
                let length = graph.length(&p);
                Ok(vec![graph.div(length, *radius)])
            }
            (LocalField::Radius, Kind::Cylinder { radius, .. } | Kind::InfiniteCylinder { radius }) => {
                let radial = graph.length(&[p[0], p[2]]);
                Ok(vec![graph.div(radial, *radius)])
            }
            (LocalField::L, Kind::Cylinder { half_height, .. }) => Ok(vec![graph.add(p[1], *half_height)]),
            (LocalField::T, Kind::Cylinder { half_height, .. }) => {
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
        let (sizes, what): (&[ValueId], &str) = match self {
            Self::Sphere { radius } | Self::InfiniteCylinder { radius } | Self::Capsule { radius, .. } => {
                (&[*radius], "a radius")
            }
            Self::Box { half } => (half, "a half extent"),
            Self::Cylinder { radius, half_height } => (&[*radius, *half_height], "a radius or half height"),
            Self::Torus { major, minor } => (&[*major, *minor], "a radius"),
            Self::Scaled { factor, .. } => {
                return lowerer.refuse(&[*factor], |x| x <= 0.0, "a scale must be more than 0", span);
            }
            Self::Plane { .. }
            | Self::Tube(_)
            | Self::Union { .. }
            | Self::Intersection { .. }
            | Self::Difference { .. }
            | Self::Translated { .. }
            | Self::Rotated { .. }
            | Self::Rounded { .. }
            | Self::Displaced { .. } => return Ok(()),
        };
        lowerer.refuse(sizes, |x| x < 0.0, &format!("{what} must be at least 0"), span)
    }

    /// The shapes that this one is made of.
    fn children(&self) -> Vec<&Shape> {
        match self {
            Self::Sphere { .. }
            | Self::Box { .. }
            | Self::Cylinder { .. }
            | Self::InfiniteCylinder { .. }
            | Self::Torus { .. }
            | Self::Capsule { .. }
            | Self::Plane { .. }
            | Self::Tube(_) => Vec::new(),
            Self::Union { shapes, .. } | Self::Intersection { shapes, .. } => {
                shapes.iter().map(|shape| &**shape).collect()
            }
            Self::Difference { from, what, .. } => vec![from, what],
            Self::Translated { child, .. }
            | Self::Rotated { child, .. }
            | Self::Scaled { child, .. }
            | Self::Rounded { child, .. }
            | Self::Displaced { child, .. } => vec![child],
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

fn box_distance(graph: &mut Graph, p: [ValueId; 3], half: [ValueId; 3]) -> ValueId {
    let outside = [0, 1, 2].map(|i| {
        let away = graph.apply(Op::Abs, &[p[i]]);
        graph.sub(away, half[i])
    });
    corner_distance(graph, &outside)
}

/// Distance of a product of slabs from the signed distances of the slabs:
/// `length(max(d, 0)) + min(max(d), 0)`.
fn corner_distance(graph: &mut Graph, slabs: &[ValueId]) -> ValueId {
    let zero = graph.number(0.0);
    let positive: Vec<ValueId> = slabs.iter().map(|&d| graph.max(d, zero)).collect();
    let outside = graph.length(&positive);
    let largest = slabs.iter().copied().reduce(|a, b| graph.max(a, b)).unwrap_or(zero);
    // On the surface itself both parts are 0; in this order the slope there is that of the inside,
    // where the other order has none.
    let inside = graph.min(zero, largest);
    graph.add(outside, inside)
}

fn capsule_distance(
    graph: &mut Graph,
    p: [ValueId; 3],
    a: [ValueId; 3],
    b: [ValueId; 3],
    radius: ValueId,
) -> ValueId {
    let (zero, one) = (graph.number(0.0), graph.number(1.0));
    let from_a = [0, 1, 2].map(|i| graph.sub(p[i], a[i]));
    let axis = [0, 1, 2].map(|i| graph.sub(b[i], a[i]));
    // t = clamp(pa . ba / ba . ba, 0, 1); a point-like axis has t = 0.
    let squared = graph.dot(&axis, &axis);
    let degenerate = graph.apply(Op::LessEqual, &[squared, zero]);
    let divisor = graph.select(degenerate, one, squared);
    let along = graph.dot(&from_a, &axis);
    let t = graph.div(along, divisor);
    let t = graph.max(t, zero);
    let t = graph.min(t, one);
    let off = [0, 1, 2].map(|i| {
        let foot = graph.mul(axis[i], t);
        graph.sub(from_a[i], foot)
    });
    let distance = graph.length(&off);
    graph.sub(distance, radius)
}

type Blend = fn(&mut Graph, ValueId, ValueId, Option<ValueId>) -> ValueId;

fn fold_shapes(
    lowerer: &mut Lowerer<'_>,
    shapes: &[Rc<Shape>],
    p: [ValueId; 3],
    smooth: Option<ValueId>,
    blend: Blend,
) -> Lowered<ValueId> {
    let mut result = None;
    for shape in shapes {
        let distance = shape.distance(lowerer, p)?;
        result = Some(match result {
            None => distance,
            Some(before) => blend(&mut lowerer.graph, before, distance, smooth),
        });
    }
    // The union of nothing is nowhere.
    Ok(result.unwrap_or_else(|| lowerer.graph.number(1e6)))
}

/// `min(a, b) - h^2 / (4 k)`, `h = max(k - |a - b|, 0)`: 1-Lipschitz if both are.
fn smooth_min(graph: &mut Graph, a: ValueId, b: ValueId, smooth: Option<ValueId>) -> ValueId {
    let sharp = graph.min(a, b);
    let Some(width) = smooth else { return sharp };
    let bulge = blend_bulge(graph, a, b, width);
    graph.sub(sharp, bulge)
}

fn smooth_max(graph: &mut Graph, a: ValueId, b: ValueId, smooth: Option<ValueId>) -> ValueId {
    let sharp = graph.max(a, b);
    let Some(width) = smooth else { return sharp };
    let bulge = blend_bulge(graph, a, b, width);
    graph.add(sharp, bulge)
}

fn blend_bulge(graph: &mut Graph, a: ValueId, b: ValueId, width: ValueId) -> ValueId {
    let zero = graph.number(0.0);
    // A width that a param turns to 0 must not divide by it.
    let least = graph.number(1e-6);
    let width = graph.max(width, least);
    let apart = graph.sub(a, b);
    let apart = graph.apply(Op::Abs, &[apart]);
    let overlap = graph.sub(width, apart);
    let overlap = graph.max(overlap, zero);
    let squared = graph.mul(overlap, overlap);
    let quarter = graph.number(0.25);
    let divisor = graph.div(quarter, width);
    graph.mul(squared, divisor)
}

fn extents(lowerer: &mut Lowerer<'_>, shapes: &[Rc<Shape>], span: Span) -> Lowered<Vec<Extent>> {
    shapes.iter().map(|shape| shape.extent(lowerer, span)).collect()
}

fn centred_box(lowerer: &mut Lowerer<'_>, half: [ValueId; 3], span: Span) -> Lowered<Extent> {
    let lo = half.map(|v| lowerer.graph.apply(Op::Neg, &[v]));
    let lo = lowerer.slots(lo, "a shape", span)?;
    let hi = lowerer.slots(half, "a shape", span)?;
    Ok(Extent::Box { lo, hi })
}

fn identity(scale: ValueId, zero: ValueId) -> [[ValueId; 3]; 3] {
    [[scale, zero, zero], [zero, scale, zero], [zero, zero, scale]]
}

fn place(
    lowerer: &mut Lowerer<'_>,
    child: &Rc<Shape>,
    columns: [[ValueId; 3]; 3],
    offset: [ValueId; 3],
    span: Span,
) -> Lowered<Extent> {
    let child = Box::new(child.extent(lowerer, span)?);
    let mut column = |i: usize| lowerer.slots(columns[i], "a transform", span);
    let columns = [column(0)?, column(1)?, column(2)?];
    let offset = lowerer.slots(offset, "a transform", span)?;
    Ok(Extent::Placed { child, columns, offset })
}

fn displaced_extent(
    lowerer: &mut Lowerer<'_>,
    child: &Rc<Shape>,
    amount: &Rc<Closure>,
    span: Span,
) -> Lowered<Extent> {
    let child = Box::new(child.extent(lowerer, span)?);
    let p = lowerer.position();
    let value = lowerer.call(amount, &[Value::Numbers(p.to_vec())])?.scalar();
    let slope = gradient(lowerer, value, span)?;
    let amount = lowerer.function("displacement", 3, &[value]);
    let slope = lowerer.function("displacement slope", 3, &slope);
    Ok(Extent::Displaced { child, amount, slope, span })
}

/// Derivatives of a value with respect to the position.
pub(crate) fn gradient(lowerer: &mut Lowerer<'_>, value: ValueId, span: Span) -> Lowered<Vec<ValueId>> {
    crate::passes::gradient::gradient(&mut lowerer.graph, value, &[0, 1, 2]).ok_or_else(|| {
        let message = "this surface has no slope by which it could be lit and marched";
        let label = "it contains a tube, or an `fbm` whose lacunarity or gain changes with the position";
        let help = "fill a tube with a medium, `medium name { region: … }`, or use `capsule`; make lacunarity and gain constant";
        Box::new(Diagnostic::error("E0408", message, span, label).with_help(help))
    })
}
