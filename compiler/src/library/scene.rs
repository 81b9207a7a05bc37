//! Shapes, materials and phase functions.
//!
//! | room | holds |
//! |---|---|
//! | `clouds` | materials of clouds, on a surface and in a solid |
//! | `primitives` | shapes that are not made of others |
//! | `combinations` | unions, intersections, differences |
//! | `transforms` | shapes moved, bent, repeated, thickened |

mod clouds;
mod combinations;
mod primitives;
mod transforms;

use super::{Builtin, call, required};
use crate::ir::ValueId;
use crate::ir::graph::Rate;
use crate::lower::optics::{Material, Phase};
use crate::lower::value::Value;
use crate::lower::{Lowered, Lowerer, depends_on_position};
use std::rc::Rc;
use vol_language::diag::Diagnostic;
use vol_language::source::Span;
use vol_language::ty::Type;

pub(super) fn builtins() -> Vec<Builtin> {
    let shapes = [primitives::builtins(), combinations::builtins(), transforms::builtins()];
    let optics = [materials(), clouds::builtins(), phases()];
    shapes.into_iter().chain(optics).flatten().collect()
}

/// A whole number within bounds that is known at compile time; `what` is how messages call it.
fn whole(
    lowerer: &Lowerer<'_>,
    value: ValueId,
    [least, most]: [u32; 2],
    what: &str,
    span: Span,
) -> Lowered<u32> {
    let number = lowerer.compile_time(value, what, span)?;
    if number.fract() == 0.0 && number >= f64::from(least) && number <= f64::from(most) {
        return Ok(number as u32);
    }
    let message = format!("{what} must be a whole number from {least} to {most}");
    let diagnostic = Diagnostic::error("E0407", message, span, format!("here it is {number}"));
    Err(Box::new(diagnostic.with_help(format!("write a number such as {}", least.max(3).min(most)))))
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
