//! Materials of clouds: a texture on a surface, and matter that fills a solid.

use super::super::{Builtin, call, optional, required};
use super::whole;
use crate::library::noise::TERMS;
use crate::lower::cloud::{Cloud, Pattern};
use crate::lower::optics::Material;
use crate::lower::value::Value;
use crate::lower::{Lowered, Lowerer};
use crate::ops::MAX_OCTAVES;
use std::rc::Rc;
use vol_language::library::{DefaultValue, Parameter};
use vol_language::settings::ChoiceKind;
use vol_language::source::Span;
use vol_language::ty::Type;

/// Density of a cloud at its densest, per scene unit, unless the scene says otherwise.
const DENSITY: f64 = 8.0;

pub(super) fn builtins() -> Vec<Builtin> {
    vec![
        call(
            "cloud_2d",
            params(vec![optional("behind", color(), 0.0)]),
            Type::Material,
            "clouds on a surface, whatever the light: colour mixed over behind by (T - cutoff) / (1 - cutoff), T the noise at q.local, 0 to 1, with features of size 1 / frequency; octaves are sines for gardner, at most 7; offset moves the pattern",
            |lowerer, span, args| {
                let cloud = cloud(lowerer, span, args)?;
                Ok(Value::Material(Rc::new(Material::Cloud2d { cloud, behind: args[7].function() })))
            },
        ),
        call(
            "cloud_3d",
            params(vec![optional("depth", Type::Float, 1.0), optional("density", Type::Float, DENSITY)]),
            Type::Material,
            "clouds that fill the solid from its surface down to a depth, whatever the light: a medium of absorption density * (T - cutoff) / (1 - cutoff) that glows in the colour, both less by 1 - q.depth / depth; the noise as of cloud_2d",
            |lowerer, span, args| {
                let cloud = cloud(lowerer, span, args)?;
                let (depth, density) = (args[7].scalar(), args[8].scalar());
                let place = lowerer.argument_span(7, span);
                let message = "the depth of a cloud must be more than 0";
                let help = "write the thickness of the layer that holds clouds, such as `depth: 0.5`";
                lowerer.refuse_with_help(&[depth], |depth| depth <= 0.0, message, place, help)?;
                Ok(Value::Material(Rc::new(Material::Cloud3d { cloud, depth, density })))
            },
        ),
    ]
}

fn color() -> Type {
    Type::function(vec![Type::Local], Type::Color)
}

/// The parameters of both, then more.
fn params(more: Vec<Parameter>) -> Vec<Parameter> {
    let noise = Type::Choice(ChoiceKind::CloudNoise);
    let noise = Parameter { name: "noise", ty: noise, default: DefaultValue::Word("perlin"), rest: false };
    let mut all = vec![
        required("color", color()),
        noise,
        optional("frequency", Type::Float, 1.0),
        optional("octaves", Type::Int, 5.0),
        optional("cutoff", Type::Float, 0.3),
        optional("offset", Type::Vec3, 0.0),
        optional("seed", Type::Int, 0.0),
    ];
    all.extend(more);
    all
}

/// The cloud of a call's first arguments.
fn cloud(lowerer: &Lowerer<'_>, span: Span, args: &[Value]) -> Lowered<Cloud> {
    let Value::String(word) = &args[1] else {
        unreachable!("the checker gives a word where one is asked for")
    };
    let (pattern, most) = match &**word {
        "gardner" => (Pattern::Gardner, TERMS as u32),
        _ => (Pattern::Perlin, MAX_OCTAVES as u32),
    };
    let place = lowerer.argument_span(3, span);
    let octaves = whole(lowerer, args[3].scalar(), [1, most], "a number of octaves", place)?;
    // The value itself goes on; it must only be known.
    lowerer.compile_time(args[6].scalar(), "a seed", lowerer.argument_span(6, span))?;
    Ok(Cloud {
        color: args[0].function(),
        pattern,
        frequency: args[2].scalar(),
        octaves,
        cutoff: args[4].scalar(),
        offset: args[5].vec3(),
        seed: args[6].scalar(),
    })
}
