//! Unions, intersections and differences, with the ways in which surfaces meet.

use super::whole;
use crate::library::{Builtin, call, optional, required};
use crate::lower::shape::blend::Blend;
use crate::lower::shape::{Kind, Shape};
use crate::lower::value::Value;
use crate::lower::{Lowered, Lowerer};
use std::rc::Rc;
use vol_language::diag::Diagnostic;
use vol_language::library::{DefaultValue, Parameter};
use vol_language::source::Span;
use vol_language::ty::Type;

pub(super) fn builtins() -> Vec<Builtin> {
    let pair = vec![required("from", Type::Shape), required("what", Type::Shape)];
    vec![
        call(
            "union",
            blended(vec![shapes()]),
            Type::Shape,
            "all points of any shape; sharp as exact outside as the shapes, else a bound; smooth, chamfer or stairs is how far a round, flat or stepped blend reaches from the edge",
            |lowerer, span, a| {
                let blend = blend(lowerer, a, 1, span)?;
                Shape::value(Kind::Union { shapes: shape_list(&a[0]), blend }, lowerer, span)
            },
        ),
        call(
            "intersect",
            blended(vec![shapes()]),
            Type::Shape,
            "the points common to all shapes; sharp as exact inside as the shapes, else a bound; smooth, chamfer or stairs is how far a round, flat or stepped blend reaches from the edge",
            |lowerer, span, a| {
                let blend = blend(lowerer, a, 1, span)?;
                Shape::value(Kind::Intersection { shapes: shape_list(&a[0]), blend }, lowerer, span)
            },
        ),
        call(
            "subtract",
            blended(pair),
            Type::Shape,
            "the points of the first shape that are not in the second; sharp as exact inside as the shapes, else a bound; smooth, chamfer or stairs is how far a round, flat or stepped blend reaches from the edge",
            |lowerer, span, a| {
                let blend = blend(lowerer, a, 2, span)?;
                Shape::value(
                    Kind::Difference { from: a[0].shape(), what: a[1].shape(), blend },
                    lowerer,
                    span,
                )
            },
        ),
    ]
}

/// All positional arguments, or one list of them.
fn shapes() -> Parameter {
    Parameter { name: "shapes", ty: Type::Shape, default: DefaultValue::Required, rest: true }
}

/// Adds the params that [`blend`] reads, in its order.
fn blended(mut params: Vec<Parameter>) -> Vec<Parameter> {
    params.extend(["smooth", "chamfer", "stairs"].map(|name| optional(name, Type::Float, 0.0)));
    params.push(optional("steps", Type::Int, 3.0));
    params
}

fn shape_list(value: &Value) -> Vec<Rc<Shape>> {
    value.list().iter().map(Value::shape).collect()
}

/// Most steps of a stepped blend.
const MOST_STEPS: u32 = 1000;

/// The blend that the arguments from the `first` on ask for; none where the widths are a constant 0.
fn blend(lowerer: &Lowerer<'_>, args: &[Value], first: usize, span: Span) -> Lowered<Blend> {
    let widths = [0, 1, 2].map(|i| args[first + i].scalar());
    for (i, width) in widths.iter().enumerate() {
        let place = lowerer.argument_span(first + i, span);
        lowerer.refuse(&[*width], |k| k < 0.0, "the width of a blend must be at least 0", place)?;
    }
    let place = lowerer.argument_span(first + 3, span);
    let steps = whole(lowerer, args[first + 3].scalar(), [1, MOST_STEPS], "the number of steps", place)?;
    let [smooth, chamfer, stairs] = widths.map(|width| lowerer.graph.constant(width) != Some(0.0));
    match (smooth, chamfer, stairs) {
        (false, false, false) => Ok(Blend::Sharp),
        (true, false, false) => Ok(Blend::Smooth(widths[0])),
        (false, true, false) => Ok(Blend::Chamfer(widths[1])),
        (false, false, true) => Ok(Blend::Steps(widths[2], steps)),
        (true, true, _) | (true, _, true) | (_, true, true) => {
            let message = "two surfaces are blended in one way only";
            let label = "more than one of `smooth`, `chamfer` and `stairs` is given";
            let diagnostic = Diagnostic::error("E0407", message, span, label);
            Err(Box::new(diagnostic.with_help("keep one of them, as in `union(a, b, chamfer: 0.1)`")))
        }
    }
}
