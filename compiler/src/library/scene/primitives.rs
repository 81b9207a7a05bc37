//! Shapes that are not made of others.

use super::whole;
use crate::library::{Builtin, call, math, optional, required};
use crate::lower::shape::mandelbulb::Mandelbulb;
use crate::lower::shape::primitives::Primitive;
use crate::lower::shape::{Kind, Shape};
use crate::lower::value::Value;
use crate::lower::{Lowered, Lowerer};
use vol_language::source::Span;
use vol_language::ty::Type;

fn solid(lowerer: &Lowerer<'_>, span: Span, primitive: Primitive) -> Lowered<Value> {
    Shape::value(Kind::Primitive(primitive), lowerer, span)
}

pub(super) fn builtins() -> Vec<Builtin> {
    let float = |name| required(name, Type::Float);
    let vec3 = |name| required(name, Type::Vec3);
    vec![
        call(
            "sphere",
            vec![float("radius")],
            Type::Shape,
            "ball at the origin; exact inside and outside",
            |lowerer, span, a| solid(lowerer, span, Primitive::Sphere { radius: a[0].scalar() }),
        ),
        call(
            "box",
            vec![vec3("half")],
            Type::Shape,
            "box at the origin from its half extents; exact inside and outside",
            |lowerer, span, a| solid(lowerer, span, Primitive::Box { half: a[0].vec3() }),
        ),
        call(
            "cylinder",
            vec![float("radius"), float("half_height")],
            Type::Shape,
            "capped cylinder around the y axis, from -half_height to half_height; exact inside and outside",
            |lowerer, span, a| {
                solid(
                    lowerer,
                    span,
                    Primitive::Cylinder { radius: a[0].scalar(), half_height: a[1].scalar() },
                )
            },
        ),
        call(
            "infinite_cylinder",
            vec![float("radius")],
            Type::Shape,
            "cylinder around the y axis; exact inside and outside",
            |lowerer, span, a| solid(lowerer, span, Primitive::InfiniteCylinder { radius: a[0].scalar() }),
        ),
        call(
            "torus",
            vec![float("major"), float("minor")],
            Type::Shape,
            "ring around the y axis: a circle of radius major, thickened by minor; exact inside and outside, inside a bound if minor is more than major",
            |lowerer, span, a| {
                solid(lowerer, span, Primitive::Torus { major: a[0].scalar(), minor: a[1].scalar() })
            },
        ),
        call(
            "capsule",
            vec![vec3("a"), vec3("b"), float("radius")],
            Type::Shape,
            "all points within radius of the segment from a to b; exact inside and outside",
            |lowerer, span, a| {
                solid(
                    lowerer,
                    span,
                    Primitive::Capsule { a: a[0].vec3(), b: a[1].vec3(), radius: a[2].scalar() },
                )
            },
        ),
        call(
            "plane",
            vec![vec3("normal"), optional("offset", Type::Float, 0.0)],
            Type::Shape,
            "half space below the plane normal . p = offset, the normal made unit length; exact inside and outside",
            |lowerer, span, a| {
                let normal = math::normalize(&mut lowerer.graph, a[0].numbers());
                solid(
                    lowerer,
                    span,
                    Primitive::Plane { normal: Value::Numbers(normal).vec3(), offset: a[1].scalar() },
                )
            },
        ),
        implicit_builtin(),
        mandelbulb(),
    ]
    .into_iter()
    .chain(pointed())
    .collect()
}

/// Shapes with slanted faces, and flat ones.
fn pointed() -> Vec<Builtin> {
    let float = |name| required(name, Type::Float);
    vec![
        call(
            "cone",
            vec![float("radius"), float("half_height"), optional("top", Type::Float, 0.0)],
            Type::Shape,
            "cone around the y axis, from radius at -half_height to radius top at half_height; exact inside and outside",
            |lowerer, span, a| {
                let (radius, half_height, top) = (a[0].scalar(), a[1].scalar(), a[2].scalar());
                solid(lowerer, span, Primitive::Cone { radius, half_height, top })
            },
        ),
        call(
            "prism",
            vec![required("sides", Type::Int), float("radius"), float("half_height")],
            Type::Shape,
            "upright regular prism with 3 to 64 sides around the y axis, one corner above the x axis, radius to the corners; exact inside and outside",
            |lowerer, span, a| {
                let place = lowerer.argument_span(0, span);
                let sides = whole(lowerer, a[0].scalar(), [3, 64], "the number of sides", place)?;
                let (radius, half_height) = (a[1].scalar(), a[2].scalar());
                solid(lowerer, span, Primitive::Prism { sides, radius, half_height })
            },
        ),
        call(
            "pyramid",
            vec![float("half"), float("half_height")],
            Type::Shape,
            "pyramid with a square of half side `half` at y = -half_height and the tip at half_height; exact inside and outside",
            |lowerer, span, a| {
                let (half, half_height) = (a[0].scalar(), a[1].scalar());
                solid(lowerer, span, Primitive::Pyramid { half, half_height })
            },
        ),
        call(
            "ellipsoid",
            vec![required("radii", Type::Vec3)],
            Type::Shape,
            "ellipsoid at the origin from its radii along the axes; a lower bound inside and outside, slow to march where flat",
            |lowerer, span, a| solid(lowerer, span, Primitive::Ellipsoid { radii: a[0].vec3() }),
        ),
        call(
            "octahedron",
            vec![float("radius")],
            Type::Shape,
            "regular octahedron with its corners on the axes, radius away; exact inside and outside",
            |lowerer, span, a| solid(lowerer, span, Primitive::Octahedron { radius: a[0].scalar() }),
        ),
        call(
            "disk",
            vec![float("radius"), optional("thickness", Type::Float, 0.01)],
            Type::Shape,
            "round plate across the y axis: all points within half the thickness of the flat disk; exact inside and outside",
            |lowerer, span, a| {
                let place = lowerer.argument_span(1, span);
                let message = "a thickness must be at least 0";
                lowerer.refuse(&[a[1].scalar()], |x| x < 0.0, message, place)?;
                let half = lowerer.graph.number(0.5);
                let rim = lowerer.graph.mul(a[1].scalar(), half);
                solid(lowerer, span, Primitive::Disk { radius: a[0].scalar(), rim })
            },
        ),
    ]
}

fn mandelbulb() -> Builtin {
    let params = vec![
        optional("power", Type::Float, 8.0),
        optional("iterations", Type::Int, 12.0),
        optional("detail", Type::Float, 0.001),
    ];
    let doc = "the points that z^power + p keeps near, its axis z, radius about 1.2: the surface is detail in front of the set, \
               power 2 to 32, without trigonometry if it is a constant whole number; a lower bound inside and outside, \
               but too unsteady to be rounded, displaced, blended or made a shell";
    call("mandelbulb", params, Type::Shape, doc, |lowerer, span, a| {
        let bulb = Mandelbulb::new(lowerer, [a[0].scalar(), a[1].scalar(), a[2].scalar()], span)?;
        solid(lowerer, span, Primitive::Mandelbulb(bulb))
    })
}

fn implicit_builtin() -> Builtin {
    let field = Type::function(vec![Type::Vec3], Type::Float);
    let params = vec![required("field", field), required("bounds", Type::Vec3)];
    let doc = "the points of a box at the origin, of half extents bounds, where a function of the position is negative; \
               a distance in the field's own units, marched safely by its slope in the box";
    call("implicit", params, Type::Shape, doc, |lowerer, span, a| {
        let field_span = lowerer.argument_span(0, span);
        let kind = Kind::Implicit { field: a[0].function(), half: a[1].vec3(), span: field_span };
        Shape::value(kind, lowerer, span)
    })
}
