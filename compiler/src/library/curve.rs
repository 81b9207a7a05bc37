//! Curves and tubes.

use super::{Builtin, call, optional, required};
use crate::lower::curve::{self, CurveValue, Point};
use crate::lower::shape::Shape;
use crate::lower::tube::{self, Outline, Overlap};
use crate::lower::value::Value;
use crate::lower::{Lowered, Lowerer};
use crate::program::Caps;
use std::rc::Rc;
use vol_language::library::{DefaultValue, Parameter};
use vol_language::settings::ChoiceKind;
use vol_language::source::Span;
use vol_language::ty::Type;

pub(super) fn builtins() -> Vec<Builtin> {
    [segments(), splines(), round(), vec![tube()]].into_iter().flatten().collect()
}

fn point(name: &'static str) -> Parameter {
    required(name, Type::Vec3)
}

fn flag(name: &'static str) -> Parameter {
    Parameter { name, ty: Type::Bool, default: DefaultValue::Bool(false), rest: false }
}

fn choice(name: &'static str, kind: ChoiceKind, default: &'static str) -> Parameter {
    Parameter { name, ty: Type::Choice(kind), default: DefaultValue::Word(default), rest: false }
}

fn value(curve: CurveValue) -> Value {
    Value::Curve(Rc::new(curve))
}

fn segments() -> Vec<Builtin> {
    vec![
        call(
            "line",
            vec![point("a"), point("b")],
            Type::Curve,
            "straight line from a to b",
            |lowerer, _, a| Ok(value(curve::line(&mut lowerer.graph, a[0].vec3(), a[1].vec3()))),
        ),
        call(
            "bezier",
            vec![point("a"), point("b"), point("c")],
            Type::Curve,
            "quadratic Bezier curve from a to c with control point b",
            |_, _, a| Ok(value(curve::quadratic(a[0].vec3(), a[1].vec3(), a[2].vec3()))),
        ),
        call(
            "bezier",
            vec![point("a"), point("b"), point("c"), point("d")],
            Type::Curve,
            "cubic Bezier curve from a to d with control points b and c; within 6e-4 of the length of a-b-c-d",
            |lowerer, _, a| {
                let control = [a[0].vec3(), a[1].vec3(), a[2].vec3(), a[3].vec3()];
                Ok(value(curve::cubic(&mut lowerer.graph, control)))
            },
        ),
        call(
            "path",
            vec![required("curves", Type::list(Type::Curve))],
            Type::Curve,
            "curves one after the other, each with an equal share of t; gaps and corners are reported",
            |lowerer, span, a| {
                let curves: Vec<Rc<CurveValue>> = a[0].list().iter().map(Value::curve).collect();
                Ok(value(curve::path(lowerer, &curves, span)?))
            },
        ),
    ]
}

fn splines() -> Vec<Builtin> {
    let params = || vec![required("points", Type::list(Type::Vec3)), flag("closed")];
    vec![
        call(
            "catmull_rom",
            params(),
            Type::Curve,
            "smooth curve through the points (centripetal), t even from point to point; within 6e-4 of a segment's length",
            |lowerer, span, a| {
                let closed = is_set(lowerer, a, 1, "`closed`", span)?;
                Ok(value(curve::catmull_rom(lowerer, &points(&a[0]), closed, span)?))
            },
        ),
        call(
            "bspline",
            params(),
            Type::Curve,
            "smooth curve drawn towards the points (uniform, quadratic), from the first to the last unless closed; exact",
            |lowerer, span, a| {
                let closed = is_set(lowerer, a, 1, "`closed`", span)?;
                Ok(value(curve::b_spline(lowerer, &points(&a[0]), closed, span)?))
            },
        ),
    ]
}

fn round() -> Vec<Builtin> {
    let float = |name| required(name, Type::Float);
    vec![
        call(
            "circle",
            vec![float("radius")],
            Type::Curve,
            "circle around the y axis from (radius, 0, 0), counter-clockwise seen from above; within 2e-4 of the radius",
            |lowerer, _, a| Ok(value(curve::circle(&mut lowerer.graph, a[0].scalar()))),
        ),
        call(
            "helix",
            vec![float("radius"), float("height"), float("turns")],
            Type::Curve,
            "helix around the y axis from (radius, 0, 0) up to height, right-handed for positive turns; within 2e-4 of the radius",
            |lowerer, span, a| {
                let curve = curve::helix(lowerer, a[0].scalar(), a[1].scalar(), a[2].scalar(), span)?;
                Ok(value(curve))
            },
        ),
    ]
}

fn points(list: &Value) -> Vec<Point> {
    list.list().iter().map(Value::vec3).collect()
}

/// Whether an argument, known at compile time, is true.
fn is_set(lowerer: &Lowerer<'_>, args: &[Value], index: usize, what: &str, span: Span) -> Lowered<bool> {
    Ok(lowerer.compile_time(args[index].scalar(), what, lowerer.argument_span(index, span))? != 0.0)
}

fn tube() -> Builtin {
    let along = |result| Type::function(vec![Type::Float, Type::Float], result);
    let params = vec![
        required("curve", Type::Curve),
        required("radius", along(Type::Float)),
        optional("twist", along(Type::Angle), 0.0),
        flag("stretch"),
        choice("caps", ChoiceKind::Caps, "flat"),
        choice("frame", ChoiceKind::Frame, "minimal"),
        flag("conserve_mass"),
        choice("overlap", ChoiceKind::Overlap, "nearest"),
    ];
    let doc = "tube around a curve; radius and twist are numbers or functions of t (0 to 1) or (t, l); caps: flat, round or \
               open (goes on straight without end); frame: minimal or frenet; conserve_mass divides densities by q.stretch; \
               local coordinates are (x / radius, l, y / radius), with stretch l / length in the middle; overlap, where the tube \
               meets itself: nearest (the closest point of the curve decides), min_ratio (the least distance over the radius: the \
               union of all its parts) or sum (densities of a medium add up over its parts)";
    call("tube", params, Type::Shape, doc, |lowerer, span, a| {
        let caps = match &*word(&a[4]) {
            "flat" => Caps::Flat,
            "round" => Caps::Round,
            "open" => Caps::Open,
            other => unreachable!("the checker knows no caps {other}"),
        };
        let outline = Outline {
            radius: a[1].function(),
            twist: a[2].function(),
            stretch: is_set(lowerer, a, 3, "`stretch`", span)?,
            caps,
            frenet: &*word(&a[5]) == "frenet",
            conserve_mass: is_set(lowerer, a, 6, "`conserve_mass`", span)?,
            overlap: match &*word(&a[7]) {
                "nearest" => Overlap::Nearest,
                "min_ratio" => Overlap::MinRatio,
                "sum" => Overlap::Sum,
                other => unreachable!("the checker knows no overlap {other}"),
            },
        };
        Shape::value(tube::tube(lowerer, a[0].curve(), outline, span)?, lowerer, span)
    })
}

fn word(value: &Value) -> Rc<str> {
    match value {
        Value::String(word) => Rc::clone(word),
        other => unreachable!("the checker gives a word where one is asked for, not {other:?}"),
    }
}
