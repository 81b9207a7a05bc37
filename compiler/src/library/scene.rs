//! Shapes, curves, materials and phase functions.

use super::{Builtin, call, math, optional, required};
use crate::ir::ValueId;
use crate::ir::graph::Rate;
use crate::lower::optics::{Material, Phase};
use crate::lower::shape::{Kind, Shape};
use crate::lower::tube::{self, CurveValue};
use crate::lower::value::Value;
use crate::lower::{Lowered, Lowerer, depends_on_position};
use crate::ops::Op;
use std::rc::Rc;
use vol_language::library::{DefaultValue, Parameter};
use vol_language::source::Span;
use vol_language::ty::Type;

pub(super) fn builtins() -> Vec<Builtin> {
    [primitives(), combinations(), transforms(), curves(), materials(), phases()]
        .into_iter()
        .flatten()
        .collect()
}

fn primitives() -> Vec<Builtin> {
    let float = |name| required(name, Type::Float);
    let vec3 = |name| required(name, Type::Vec3);
    vec![
        call(
            "sphere",
            vec![float("radius")],
            Type::Shape,
            "ball at the origin; exact",
            |lowerer, span, a| Shape::value(Kind::Sphere { radius: a[0].scalar() }, lowerer, span),
        ),
        call(
            "box",
            vec![vec3("half")],
            Type::Shape,
            "box at the origin from its half extents; exact",
            |lowerer, span, a| Shape::value(Kind::Box { half: a[0].vec3() }, lowerer, span),
        ),
        call(
            "cylinder",
            vec![float("radius"), float("half_height")],
            Type::Shape,
            "capped cylinder around the y axis, from -half_height to half_height; exact",
            |lowerer, span, a| {
                Shape::value(
                    Kind::Cylinder { radius: a[0].scalar(), half_height: a[1].scalar() },
                    lowerer,
                    span,
                )
            },
        ),
        call(
            "infinite_cylinder",
            vec![float("radius")],
            Type::Shape,
            "cylinder around the y axis; exact",
            |lowerer, span, a| Shape::value(Kind::InfiniteCylinder { radius: a[0].scalar() }, lowerer, span),
        ),
        call(
            "torus",
            vec![float("major"), float("minor")],
            Type::Shape,
            "ring around the y axis: a circle of radius major, thickened by minor; exact",
            |lowerer, span, a| {
                Shape::value(Kind::Torus { major: a[0].scalar(), minor: a[1].scalar() }, lowerer, span)
            },
        ),
        call(
            "capsule",
            vec![vec3("a"), vec3("b"), float("radius")],
            Type::Shape,
            "all points within radius of the segment from a to b; exact",
            |lowerer, span, a| {
                Shape::value(
                    Kind::Capsule { a: a[0].vec3(), b: a[1].vec3(), radius: a[2].scalar() },
                    lowerer,
                    span,
                )
            },
        ),
        call(
            "plane",
            vec![vec3("normal"), optional("offset", Type::Float, 0.0)],
            Type::Shape,
            "half space below the plane normal . p = offset, the normal made unit length; exact",
            |lowerer, span, a| {
                let normal = math::normalize(&mut lowerer.graph, a[0].numbers());
                Shape::value(
                    Kind::Plane { normal: Value::Numbers(normal).vec3(), offset: a[1].scalar() },
                    lowerer,
                    span,
                )
            },
        ),
        tube_builtin(),
    ]
}

fn tube_builtin() -> Builtin {
    let along = |result| Type::function(vec![Type::Float, Type::Float], result);
    let stretch =
        Parameter { name: "stretch", ty: Type::Bool, default: DefaultValue::Bool(false), rest: false };
    let params = vec![
        required("curve", Type::Curve),
        required("radius", along(Type::Float)),
        optional("twist", along(Type::Angle), 0.0),
        stretch,
    ];
    let doc = "tube around a curve with flat ends; radius and twist are numbers or functions of t (0 to 1) or (t, l); \
               local coordinates are (x / radius, l, y / radius), with stretch l / length in the middle";
    call("tube", params, Type::Shape, doc, |lowerer, span, a| {
        let stretch =
            lowerer.compile_time(a[3].scalar(), "`stretch`", lowerer.argument_span(3, span))? != 0.0;
        let (radius, twist) = (a[1].function(), a[2].function());
        Shape::value(tube::tube(lowerer, &a[0].curve(), radius, twist, stretch, span)?, lowerer, span)
    })
}

/// All positional arguments, or one list of them.
fn shapes() -> Parameter {
    Parameter { name: "shapes", ty: Type::Shape, default: DefaultValue::Required, rest: true }
}

fn smooth() -> Parameter {
    optional("smooth", Type::Float, 0.0)
}

fn combinations() -> Vec<Builtin> {
    let pair = vec![required("from", Type::Shape), required("what", Type::Shape), smooth()];
    vec![
        call(
            "union",
            vec![shapes(), smooth()],
            Type::Shape,
            "all points of any shape; smooth is the width of the blend",
            |lowerer, span, a| {
                let smooth = blend_width(lowerer, &a[1]);
                Shape::value(Kind::Union { shapes: shape_list(&a[0]), smooth }, lowerer, span)
            },
        ),
        call(
            "intersect",
            vec![shapes(), smooth()],
            Type::Shape,
            "the points common to all shapes; smooth is the width of the blend",
            |lowerer, span, a| {
                let smooth = blend_width(lowerer, &a[1]);
                Shape::value(Kind::Intersection { shapes: shape_list(&a[0]), smooth }, lowerer, span)
            },
        ),
        call(
            "subtract",
            pair,
            Type::Shape,
            "the points of the first shape that are not in the second; smooth is the width of the blend",
            |lowerer, span, a| {
                let smooth = blend_width(lowerer, &a[2]);
                Shape::value(
                    Kind::Difference { from: a[0].shape(), what: a[1].shape(), smooth },
                    lowerer,
                    span,
                )
            },
        ),
    ]
}

fn shape_list(value: &Value) -> Vec<Rc<Shape>> {
    value.list().iter().map(Value::shape).collect()
}

/// No blend where the width is a constant 0 or less.
fn blend_width(lowerer: &Lowerer<'_>, value: &Value) -> Option<ValueId> {
    let width = value.scalar();
    let sharp = lowerer.graph.constant(width).is_some_and(|k| k <= 0.0);
    (!sharp).then_some(width)
}

fn transforms() -> Vec<Builtin> {
    let child = || required("shape", Type::Shape);
    let turn = |name, doc, function| {
        call(name, vec![child(), required("angle", Type::Angle)], Type::Shape, doc, function)
    };
    let of_position = Type::function(vec![Type::Vec3], Type::Float);
    vec![
        call(
            "translate",
            vec![child(), required("offset", Type::Vec3)],
            Type::Shape,
            "moved by offset",
            |lowerer, span, a| {
                Shape::value(Kind::Translated { child: a[0].shape(), offset: a[1].vec3() }, lowerer, span)
            },
        ),
        turn("rotate_x", "turned about the x axis, y towards z", |l, span, a| rotated(l, a, 0, span)),
        turn("rotate_y", "turned about the y axis, z towards x", |l, span, a| rotated(l, a, 1, span)),
        turn("rotate_z", "turned about the z axis, x towards y", |l, span, a| rotated(l, a, 2, span)),
        call(
            "scale",
            vec![child(), required("factor", Type::Float)],
            Type::Shape,
            "scaled about the origin",
            |lowerer, span, a| {
                Shape::value(Kind::Scaled { child: a[0].shape(), factor: a[1].scalar() }, lowerer, span)
            },
        ),
        call(
            "round",
            vec![child(), required("radius", Type::Float)],
            Type::Shape,
            "grown by radius on all sides, which rounds the edges",
            |lowerer, span, a| {
                Shape::value(Kind::Rounded { child: a[0].shape(), radius: a[1].scalar() }, lowerer, span)
            },
        ),
        call(
            "displace",
            vec![child(), required("amount", of_position)],
            Type::Shape,
            "the surface moved inwards by an amount that depends on the position; marched safely by the amount's own slope",
            |lowerer, span, a| {
                let (child, amount) = (a[0].shape(), a[1].function());
                let amount_span = lowerer.argument_span(1, span);
                Shape::value(Kind::Displaced { child, amount, span: amount_span }, lowerer, span)
            },
        ),
    ]
}

fn rotated(lowerer: &mut Lowerer<'_>, args: &[Value], axis: usize, span: Span) -> Lowered<Value> {
    let graph = &mut lowerer.graph;
    let angle = args[1].scalar();
    let (sine, cosine) = (graph.apply(Op::Sin, &[angle]), graph.apply(Op::Cos, &[angle]));
    let minus = graph.apply(Op::Neg, &[sine]);
    let (zero, one) = (graph.number(0.0), graph.number(1.0));
    // Columns are the images of the axes; the turn takes the axis after `axis` to the one after that.
    let (next, last) = ((axis + 1) % 3, (axis + 2) % 3);
    let mut columns = [[zero; 3]; 3];
    columns[axis][axis] = one;
    columns[next][next] = cosine;
    columns[next][last] = sine;
    columns[last][next] = minus;
    columns[last][last] = cosine;
    Shape::value(Kind::Rotated { child: args[0].shape(), columns }, lowerer, span)
}

fn curves() -> Vec<Builtin> {
    let point = |name| required(name, Type::Vec3);
    vec![
        call(
            "line",
            vec![point("a"), point("b")],
            Type::Curve,
            "straight line from a to b",
            |lowerer, _, a| {
                let (from, to) = (a[0].vec3(), a[1].vec3());
                let half = lowerer.graph.number(0.5);
                let middle = [0, 1, 2].map(|i| {
                    let sum = lowerer.graph.add(from[i], to[i]);
                    lowerer.graph.mul(sum, half)
                });
                curve(vec![[from, middle, to]])
            },
        ),
        call(
            "bezier",
            vec![point("a"), point("b"), point("c")],
            Type::Curve,
            "quadratic Bezier curve from a to c with control point b",
            |_, _, a| curve(vec![[a[0].vec3(), a[1].vec3(), a[2].vec3()]]),
        ),
    ]
}

fn curve(segments: Vec<[[ValueId; 3]; 3]>) -> Lowered<Value> {
    Ok(Value::Curve(Rc::new(CurveValue { segments })))
}

fn materials() -> Vec<Builtin> {
    let color = |name| required(name, Type::function(vec![Type::Local], Type::Color));
    let phong = vec![color("ka"), color("kd"), color("ks"), required("shininess", Type::Float)];
    vec![
        call(
            "diffuse",
            vec![color("albedo")],
            Type::Material,
            "reflects albedo / pi in all directions",
            |_, _, a| Ok(Value::Material(Rc::new(Material::Diffuse { albedo: a[0].function() }))),
        ),
        call(
            "phong",
            phong,
            Type::Material,
            "ambient * ka + sum over lights of E * (kd * max(0, N.L) + ks * max(0, R.E)^shininess)",
            |_, _, a| {
                let (ambient, diffuse, specular) = (a[0].function(), a[1].function(), a[2].function());
                let material = Material::Phong { ambient, diffuse, specular, shininess: a[3].scalar() };
                Ok(Value::Material(Rc::new(material)))
            },
        ),
        call("normals", vec![], Type::Material, "colour (N + 1) / 2", |_, _, _| {
            Ok(Value::Material(Rc::new(Material::Normals)))
        }),
        call("flat", vec![color("color")], Type::Material, "one colour, whatever the light", |_, _, a| {
            Ok(Value::Material(Rc::new(Material::Flat { color: a[0].function() })))
        }),
    ]
}

fn phases() -> Vec<Builtin> {
    let float = |name| required(name, Type::Float);
    vec![
        call("isotropic", vec![], Type::Phase, "1 / (4 pi) in all directions", |l, s, _| {
            phase(l, Phase::Isotropic, &[], s)
        }),
        call(
            "henyey_greenstein",
            vec![float("g")],
            Type::Phase,
            "mean cosine g in -1..1: forward for positive g",
            |l, s, a| phase(l, Phase::HenyeyGreenstein(a[0].scalar()), a, s),
        ),
        call("rayleigh", vec![], Type::Phase, "3 / (16 pi) (1 + cos^2)", |l, s, _| {
            phase(l, Phase::Rayleigh, &[], s)
        }),
        call(
            "schlick",
            vec![float("k")],
            Type::Phase,
            "(1 - k^2) / (4 pi (1 - k cos)^2), k in -1..1: forward for positive k",
            |l, s, a| phase(l, Phase::Schlick(a[0].scalar()), a, s),
        ),
        call(
            "double_hg",
            vec![float("g1"), float("g2"), float("w")],
            Type::Phase,
            "w times henyey_greenstein(g1) plus 1 - w times henyey_greenstein(g2)",
            |l, s, a| {
                let lobes = Phase::DoubleHenyeyGreenstein(a[0].scalar(), a[1].scalar(), a[2].scalar());
                phase(l, lobes, a, s)
            },
        ),
    ]
}

/// A phase function whose parameters do not depend on the position.
fn phase(lowerer: &Lowerer<'_>, phase: Phase, parameters: &[Value], span: Span) -> Lowered<Value> {
    if parameters.iter().any(|p| lowerer.graph.rate(p.scalar()) == Rate::Point) {
        return Err(depends_on_position("a phase function", span));
    }
    Ok(Value::Phase(Rc::new(phase)))
}
