//! Solids that are not made of others: distance, box, sizes.
//!
//! Convex ones with faces are the largest distance to a face inside and the distance to the nearest
//! face, edge or corner outside; the two are chosen by the sign of the former, so that a slope taken a
//! little inside is that of a face, free of cancellation.

mod sizes;

use super::Lowered;
use super::mandelbulb::Mandelbulb;
use crate::ir::ValueId;
use crate::ir::graph::Graph;
use crate::lower::Lowerer;
use crate::ops::Op;
use crate::program::Extent;
use vol_language::source::Span;

/// Solids at the origin; lengths in scene units, negative distance is inside. All are exact but the
/// ellipsoid and the Mandelbulb.
///
/// In f32 the distance is within 1.5e-6 of (size + distance from the centre) of that in f64, at any scale and
/// with any sizes of 0; moved by an offset, within 1.1e-7 of the offset more (tests `primitives::*`).
#[derive(Debug)]
pub(crate) enum Primitive {
    /// A ball.
    Sphere { radius: ValueId },
    /// Half extents along the axes.
    Box { half: [ValueId; 3] },
    /// Axis y.
    Cylinder { radius: ValueId, half_height: ValueId },
    /// Axis y, without ends.
    InfiniteCylinder { radius: ValueId },
    /// Axis y, the circle of radius `major` thickened by `minor`.
    Torus { major: ValueId, minor: ValueId },
    /// The segment from `a` to `b` thickened by `radius`.
    Capsule { a: [ValueId; 3], b: [ValueId; 3], radius: ValueId },
    /// All points with `normal . p <= offset`, the normal of unit length.
    Plane { normal: [ValueId; 3], offset: ValueId },
    /// Axis y; `radius` at the lower end, `top` at the upper one.
    Cone { radius: ValueId, half_height: ValueId, top: ValueId },
    /// Axis y; a regular polygon with a corner on the x axis, `radius` to the corners.
    Prism { sides: u32, radius: ValueId, half_height: ValueId },
    /// Axis y; a square of half side `half` at the lower end, the tip at the upper one.
    Pyramid { half: ValueId, half_height: ValueId },
    /// Lower bound inside and outside: `max((|p / radii| - 1) min(radii), distance of its box)`.
    Ellipsoid { radii: [ValueId; 3] },
    /// `radius` from the centre to the corners, which are on the axes.
    Octahedron { radius: ValueId },
    /// Axis y; the flat disk of a radius thickened by `rim`.
    Disk { radius: ValueId, rim: ValueId },
    /// Axis z; a bound.
    Mandelbulb(Mandelbulb),
}

impl Primitive {
    /// Signed distance at a point.
    pub(super) fn distance(&self, graph: &mut Graph, p: [ValueId; 3]) -> ValueId {
        match self {
            Self::Sphere { radius } => {
                let length = graph.length(&p);
                graph.sub(length, *radius)
            }
            Self::Box { half } => box_distance(graph, p, *half),
            Self::Cylinder { radius, half_height } => {
                let radial = radial_distance(graph, p, *radius);
                let axial = axial_distance(graph, p, *half_height);
                corner_distance(graph, &[radial, axial])
            }
            Self::InfiniteCylinder { radius } => radial_distance(graph, p, *radius),
            Self::Torus { major, minor } => {
                let radial = radial_distance(graph, p, *major);
                let tube = graph.length(&[radial, p[1]]);
                graph.sub(tube, *minor)
            }
            Self::Capsule { a, b, radius } => capsule_distance(graph, p, *a, *b, *radius),
            Self::Plane { normal, offset } => {
                let height = graph.dot(normal, &p);
                graph.sub(height, *offset)
            }
            Self::Cone { radius, half_height, top } => cone_distance(graph, p, [*radius, *top], *half_height),
            Self::Prism { sides, radius, half_height } => {
                let polygon = polygon_distance(graph, p, *sides, *radius);
                let axial = axial_distance(graph, p, *half_height);
                corner_distance(graph, &[polygon, axial])
            }
            Self::Pyramid { half, half_height } => pyramid_distance(graph, p, *half, *half_height),
            Self::Ellipsoid { radii } => ellipsoid_bound(graph, p, *radii),
            Self::Octahedron { radius } => octahedron_distance(graph, p, *radius),
            Self::Disk { radius, rim } => {
                let zero = graph.number(0.0);
                let radial = radial_distance(graph, p, *radius);
                let radial = graph.max(radial, zero);
                let flat = graph.length(&[radial, p[1]]);
                graph.sub(flat, *rim)
            }
            Self::Mandelbulb(bulb) => bulb.distance(graph, p),
        }
    }

    /// Where it is. The distance of a Mandelbulb counts as proper: it is safe to march, and what asks for more
    /// is refused (`steady`).
    pub(super) fn extent(&self, lowerer: &mut Lowerer<'_>, span: Span) -> Lowered<Extent> {
        let graph = &mut lowerer.graph;
        let half = match self {
            Self::Sphere { radius } | Self::Octahedron { radius } => [*radius; 3],
            Self::Box { half } => *half,
            Self::Cylinder { radius, half_height } | Self::Prism { radius, half_height, .. } => {
                [*radius, *half_height, *radius]
            }
            Self::Torus { major, minor } => {
                let wide = graph.add(*major, *minor);
                [wide, *minor, wide]
            }
            Self::Cone { radius, half_height, top } => {
                let wide = graph.max(*radius, *top);
                [wide, *half_height, wide]
            }
            Self::Pyramid { half, half_height } => [*half, *half_height, *half],
            Self::Ellipsoid { radii } => *radii,
            Self::Disk { radius, rim } => {
                let wide = graph.add(*radius, *rim);
                [wide, *rim, wide]
            }
            Self::Mandelbulb(bulb) => bulb.half(graph),
            Self::Capsule { a, b, radius } => {
                let lo = [0, 1, 2].map(|i| graph.min(a[i], b[i]));
                let hi = [0, 1, 2].map(|i| graph.max(a[i], b[i]));
                let lo = lowerer.slots(lo, "a shape", span)?;
                let hi = lowerer.slots(hi, "a shape", span)?;
                let radius = lowerer.slot(*radius, "a radius", span)?;
                return Ok(Extent::Grown(Box::new(Extent::Box { lo, hi }), radius));
            }
            Self::InfiniteCylinder { .. } | Self::Plane { .. } => return Ok(Extent::Unbounded),
        };
        centred_box(lowerer, half, span)
    }

    /// Whether the solid and its distance are their own mirror images in the plane across an axis.
    pub(super) fn is_symmetric(&self, axis: usize) -> bool {
        match self {
            Self::Sphere { .. }
            | Self::Box { .. }
            | Self::Cylinder { .. }
            | Self::InfiniteCylinder { .. }
            | Self::Torus { .. }
            | Self::Ellipsoid { .. }
            | Self::Octahedron { .. }
            | Self::Disk { .. } => true,
            Self::Cone { .. } | Self::Pyramid { .. } => axis != 1,
            Self::Prism { sides, .. } => axis != 0 || sides % 2 == 0,
            Self::Mandelbulb(_) => axis == 1,
            Self::Capsule { .. } | Self::Plane { .. } => false,
        }
    }
}

/// Distance to a box at the origin; exact.
pub(super) fn box_distance(graph: &mut Graph, p: [ValueId; 3], half: [ValueId; 3]) -> ValueId {
    let outside = [0, 1, 2].map(|i| {
        let away = graph.apply(Op::Abs, &[p[i]]);
        graph.sub(away, half[i])
    });
    corner_distance(graph, &outside)
}

/// Distance of a product of slabs from the signed distances of the slabs:
/// `length(max(d, 0)) + min(max(d), 0)`.
pub(super) fn corner_distance(graph: &mut Graph, slabs: &[ValueId]) -> ValueId {
    let zero = graph.number(0.0);
    let positive: Vec<ValueId> = slabs.iter().map(|&d| graph.max(d, zero)).collect();
    let outside = graph.length(&positive);
    let largest = slabs.iter().copied().reduce(|a, b| graph.max(a, b)).unwrap_or(zero);
    // On the surface itself both parts are 0; in this order the slope there is that of the inside,
    // where the other order has none.
    let inside = graph.min(zero, largest);
    graph.add(outside, inside)
}

/// Distance from the y axis minus a radius.
fn radial_distance(graph: &mut Graph, p: [ValueId; 3], radius: ValueId) -> ValueId {
    let radial = graph.length(&[p[0], p[2]]);
    graph.sub(radial, radius)
}

/// `|y| - half`
fn axial_distance(graph: &mut Graph, p: [ValueId; 3], half: ValueId) -> ValueId {
    let axial = graph.apply(Op::Abs, &[p[1]]);
    graph.sub(axial, half)
}

/// `x` held between two numbers.
pub(super) fn clamped(graph: &mut Graph, x: ValueId, lo: ValueId, hi: ValueId) -> ValueId {
    let x = graph.max(x, lo);
    graph.min(x, hi)
}

/// A divisor that is 1 where it would be 0.
fn divisor(graph: &mut Graph, x: ValueId) -> ValueId {
    let (zero, one) = (graph.number(0.0), graph.number(1.0));
    let vanishes = graph.apply(Op::LessEqual, &[x, zero]);
    graph.select(vanishes, one, x)
}

/// From the nearest point of the segment between `a` and `b` to `p`, in any number of dimensions.
fn from_segment(graph: &mut Graph, p: &[ValueId], a: &[ValueId], b: &[ValueId]) -> Vec<ValueId> {
    let (zero, one) = (graph.number(0.0), graph.number(1.0));
    let from_a: Vec<ValueId> = p.iter().zip(a).map(|(&p, &a)| graph.sub(p, a)).collect();
    let axis: Vec<ValueId> = b.iter().zip(a).map(|(&b, &a)| graph.sub(b, a)).collect();
    // t = clamp(pa . ba / ba . ba, 0, 1); a point-like axis has t = 0.
    let squared = graph.dot(&axis, &axis);
    let squared = divisor(graph, squared);
    let along = graph.dot(&from_a, &axis);
    let t = graph.div(along, squared);
    let t = clamped(graph, t, zero, one);
    let offset = from_a.iter().zip(&axis).map(|(&from, &axis)| {
        let foot = graph.mul(axis, t);
        graph.sub(from, foot)
    });
    offset.collect()
}

fn capsule_distance(
    graph: &mut Graph,
    p: [ValueId; 3],
    a: [ValueId; 3],
    b: [ValueId; 3],
    radius: ValueId,
) -> ValueId {
    let offset = from_segment(graph, &p, &a, &b);
    let distance = graph.length(&offset);
    graph.sub(distance, radius)
}

/// `inside` where that is negative, else the root of the smallest square.
fn faces_or_nearest(graph: &mut Graph, inside: ValueId, squares: &[ValueId]) -> ValueId {
    let zero = graph.number(0.0);
    let least = squares.iter().copied().reduce(|a, b| graph.min(a, b)).unwrap_or(zero);
    let outside = graph.apply(Op::Sqrt, &[least]);
    let is_inside = graph.apply(Op::Less, &[inside, zero]);
    graph.select(is_inside, inside, outside)
}

/// In the half plane of (distance from the axis, y) a cone is a trapezoid.
fn cone_distance(graph: &mut Graph, p: [ValueId; 3], radii: [ValueId; 2], half: ValueId) -> ValueId {
    let zero = graph.number(0.0);
    let [bottom, top] = radii;
    let (radial, y) = (graph.length(&[p[0], p[2]]), p[1]);
    let axial = axial_distance(graph, p, half);
    let low = graph.apply(Op::Neg, &[half]);
    // Find the side of the line through the slanted edge; its normal is (2 h, bottom - top).
    let height = graph.add(half, half);
    let shrink = graph.sub(bottom, top);
    let length = graph.length(&[height, shrink]);
    let length = divisor(graph, length);
    let normal = [graph.div(height, length), graph.div(shrink, length)];
    let away = [graph.sub(radial, bottom), graph.sub(y, low)];
    let slanted = graph.dot(&normal, &away);
    // The nearest point outside is on a cap or on the slanted edge.
    let inside = graph.max(axial, slanted);
    let upper = graph.apply(Op::Less, &[zero, y]);
    let cap_radius = graph.select(upper, top, bottom);
    let beside = graph.sub(radial, cap_radius);
    let beside = graph.max(beside, zero);
    let cap = graph.dot(&[beside, axial], &[beside, axial]);
    let edge = from_segment(graph, &[radial, y], &[bottom, low], &[top, half]);
    let edge = graph.dot(&edge, &edge);
    faces_or_nearest(graph, inside, &[cap, edge])
}

/// Distance in the plane of x and z to a regular polygon with a corner on the x axis.
fn polygon_distance(graph: &mut Graph, p: [ValueId; 3], sides: u32, radius: ValueId) -> ValueId {
    let zero = graph.number(0.0);
    let sector = std::f64::consts::TAU / f64::from(sides);
    let z = graph.apply(Op::Abs, &[p[2]]);
    // Of the edges with a normal on this side of the x axis the nearest is the one that p is
    // furthest beyond; turn it across the first axis.
    let (mut across, mut along) = (zero, zero);
    for edge in 0..sides.div_ceil(2) {
        let (sine, cosine) = ((f64::from(edge) + 0.5) * sector).sin_cos();
        let (sine, cosine, minus) = (graph.number(sine), graph.number(cosine), graph.number(-sine));
        let u = graph.dot(&[cosine, sine], &[p[0], z]);
        let v = graph.dot(&[minus, cosine], &[p[0], z]);
        let further = graph.apply(Op::Less, &[across, u]);
        let first = edge == 0;
        across = if first { u } else { graph.select(further, u, across) };
        along = if first { v } else { graph.select(further, v, along) };
    }
    let (half_edge, apothem) = (sector / 2.0).sin_cos();
    let (half_edge, apothem) = (graph.number(half_edge), graph.number(apothem));
    let (half_edge, apothem) = (graph.mul(half_edge, radius), graph.mul(apothem, radius));
    let across = graph.sub(across, apothem);
    let along = graph.apply(Op::Abs, &[along]);
    let beside = graph.sub(along, half_edge);
    let positive = [graph.max(across, zero), graph.max(beside, zero)];
    let outside = graph.length(&positive);
    let inside = graph.min(zero, across);
    graph.add(outside, inside)
}

/// Folded into the eighth where the face across x is the nearest of the four.
fn pyramid_distance(graph: &mut Graph, p: [ValueId; 3], half: ValueId, half_height: ValueId) -> ValueId {
    let zero = graph.number(0.0);
    let (x, z) = (graph.apply(Op::Abs, &[p[0]]), graph.apply(Op::Abs, &[p[2]]));
    // Of two equal ones each is taken once, so that the slope has both.
    let (x, z) = (graph.max(x, z), graph.min(z, x));
    let y = graph.add(p[1], half_height);
    let height = graph.add(half_height, half_height);
    // Coordinates of the face: s up the slope from the middle of its base, z along the base, n across.
    let slope = graph.length(&[half, height]);
    let safe = divisor(graph, slope);
    let (sine, cosine) = (graph.div(height, safe), graph.div(half, safe));
    // A pyramid without size is a point: any axes will do.
    let one = graph.number(1.0);
    let vanishes = graph.apply(Op::LessEqual, &[slope, zero]);
    let sine = graph.select(vanishes, one, sine);
    let minus = graph.apply(Op::Neg, &[cosine]);
    let from_base = [graph.sub(x, half), y];
    let s = graph.dot(&[minus, sine], &from_base);
    let n = graph.dot(&[sine, cosine], &from_base);
    // Beside the triangle the nearest point is on the base or on the slanted edge.
    let base = from_segment(graph, &[s, z], &[zero, zero], &[zero, half]);
    let edge = from_segment(graph, &[s, z], &[zero, half], &[slope, zero]);
    let (base, edge) = (graph.dot(&base, &base), graph.dot(&edge, &edge));
    let beside = graph.min(base, edge);
    let (left, right) = (graph.mul(z, slope), graph.sub(slope, s));
    let right = graph.mul(half, right);
    let below_edge = graph.apply(Op::Less, &[left, right]);
    let above_base = graph.apply(Op::LessEqual, &[zero, s]);
    let within = graph.apply(Op::And, &[below_edge, above_base]);
    let beside = graph.select(within, zero, beside);
    let off = graph.mul(n, n);
    let face = graph.add(off, beside);
    // The square below.
    let (over_x, over_z) = (graph.sub(x, half), graph.sub(z, half));
    let below = [graph.max(over_x, zero), y, graph.max(over_z, zero)];
    let square = graph.dot(&below, &below);
    let down = graph.apply(Op::Neg, &[y]);
    let inside = graph.max(n, down);
    faces_or_nearest(graph, inside, &[face, square])
}

/// Where |p / radii| is k, the gradient of k is at most 1 / min(radii) long; the box makes what is
/// within a distance of the solid stay near it.
fn ellipsoid_bound(graph: &mut Graph, p: [ValueId; 3], radii: [ValueId; 3]) -> ValueId {
    let one = graph.number(1.0);
    // A radius that a param turns to 0 must not be divided by.
    let least = graph.number(1e-6);
    let radii = radii.map(|radius| graph.max(radius, least));
    let scaled = [0, 1, 2].map(|i| graph.div(p[i], radii[i]));
    let level = graph.length(&scaled);
    let level = graph.sub(level, one);
    let smallest = graph.min(radii[0], radii[1]);
    let smallest = graph.min(smallest, radii[2]);
    let near = graph.mul(level, smallest);
    let around = box_distance(graph, p, radii);
    graph.max(around, near)
}

/// Beyond the middle of an edge the nearest point is on that edge: three like cases.
fn octahedron_distance(graph: &mut Graph, p: [ValueId; 3], radius: ValueId) -> ValueId {
    let (zero, half, third) = (graph.number(0.0), graph.number(0.5), graph.number(1.0 / 3.0f64.sqrt()));
    let p = p.map(|c| graph.apply(Op::Abs, &[c]));
    let sum = graph.add(p[0], p[1]);
    let sum = graph.add(sum, p[2]);
    let over = graph.sub(sum, radius);
    let mut distance = graph.mul(over, third);
    let three = graph.number(3.0);
    for axis in [2, 1, 0] {
        let (small, first, second) = (p[axis], p[(axis + 1) % 3], p[(axis + 2) % 3]);
        let along = graph.sub(second, first);
        let along = graph.add(along, radius);
        let along = graph.mul(along, half);
        let along = clamped(graph, along, zero, radius);
        let rest = graph.sub(radius, along);
        let offset = [small, graph.sub(first, rest), graph.sub(second, along)];
        let edge = graph.length(&offset);
        let tripled = graph.mul(small, three);
        let beyond = graph.apply(Op::Less, &[tripled, over]);
        distance = graph.select(beyond, edge, distance);
    }
    distance
}

fn centred_box(lowerer: &mut Lowerer<'_>, half: [ValueId; 3], span: Span) -> Lowered<Extent> {
    let lo = half.map(|v| lowerer.graph.apply(Op::Neg, &[v]));
    let lo = lowerer.slots(lo, "a shape", span)?;
    let hi = lowerer.slots(half, "a shape", span)?;
    Ok(Extent::Box { lo, hi })
}
