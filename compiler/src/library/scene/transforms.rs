//! Shapes moved, turned, scaled, bent, repeated, thickened.

use super::whole;
use crate::ir::ValueId;
use crate::ir::graph::Graph;
use crate::library::{Builtin, call, math, optional, required};
use crate::lower::shape::copies::{Copies, Row};
use crate::lower::shape::transform::{self, Transform};
use crate::lower::shape::{Kind, Shape};
use crate::lower::value::Value;
use crate::lower::{Lowered, Lowerer};
use crate::ops::Op;
use vol_language::library::Parameter;
use vol_language::source::Span;
use vol_language::ty::Type;

pub(super) fn builtins() -> Vec<Builtin> {
    [moves(), turns(), scales(), folds(), surfaces()].into_iter().flatten().collect()
}

fn child() -> Parameter {
    required("shape", Type::Shape)
}

fn transformed(lowerer: &Lowerer<'_>, span: Span, args: &[Value], transform: Transform) -> Lowered<Value> {
    Shape::value(Kind::Transformed { child: args[0].shape(), transform }, lowerer, span)
}

fn moves() -> Vec<Builtin> {
    vec![
        call(
            "translate",
            vec![child(), required("offset", Type::Vec3)],
            Type::Shape,
            "moved by offset; as exact as the shape",
            |lowerer, span, a| transformed(lowerer, span, a, Transform::Translate { offset: a[1].vec3() }),
        ),
        call(
            "mirror",
            vec![child(), required("normal", Type::Vec3)],
            Type::Shape,
            "what is on the side of the plane through the origin to which normal points, and its mirror image; exact if nothing is on the other side, else a lower bound",
            |lowerer, span, a| {
                let normal = direction(lowerer, a[1].vec3(), "a normal", span)?;
                transformed(lowerer, span, a, Transform::Mirror { normal })
            },
        ),
    ]
}

fn turns() -> Vec<Builtin> {
    let turn = |name, doc, function| {
        call(name, vec![child(), required("angle", Type::Angle)], Type::Shape, doc, function)
    };
    vec![
        turn("rotate_x", "turned about the x axis, y towards z; as exact as the shape", |l, span, a| {
            about(l, a, 0, span)
        }),
        turn("rotate_y", "turned about the y axis, z towards x; as exact as the shape", |l, span, a| {
            about(l, a, 1, span)
        }),
        turn("rotate_z", "turned about the z axis, x towards y; as exact as the shape", |l, span, a| {
            about(l, a, 2, span)
        }),
        call(
            "rotate",
            vec![child(), required("axis", Type::Vec3), required("angle", Type::Angle)],
            Type::Shape,
            "turned about an axis through the origin, counterclockwise as seen with the axis towards the eye; as exact as the shape",
            |lowerer, span, a| {
                let axis = direction(lowerer, a[1].vec3(), "an axis", span)?;
                let columns = turn_about(&mut lowerer.graph, axis, a[2].scalar());
                transformed(lowerer, span, a, Transform::Rotate { columns })
            },
        ),
        call(
            "look_along",
            vec![child(), required("direction", Type::Vec3)],
            Type::Shape,
            "turned by the shortest way so that what pointed along y points along direction; as exact as the shape",
            |lowerer, span, a| {
                let direction = direction(lowerer, a[1].vec3(), "a direction", span)?;
                let columns = turn_to(&mut lowerer.graph, direction);
                transformed(lowerer, span, a, Transform::Rotate { columns })
            },
        ),
    ]
}

fn scales() -> Vec<Builtin> {
    vec![
        call(
            "scale",
            vec![child(), required("factor", Type::Float)],
            Type::Shape,
            "scaled about the origin; as exact as the shape",
            |lowerer, span, a| transformed(lowerer, span, a, Transform::Scale { factor: a[1].scalar() }),
        ),
        call(
            "scale",
            vec![child(), required("factor", Type::Vec3)],
            Type::Shape,
            "scaled about the origin by a factor per axis; a lower bound, slow to march where the factors differ much",
            |lowerer, span, a| {
                let transform = transform::stretch(lowerer, &a[0].shape(), a[1].vec3(), span)?;
                transformed(lowerer, span, a, transform)
            },
        ),
        call(
            "elongate",
            vec![child(), required("by", Type::Vec3)],
            Type::Shape,
            "cut across each axis at the origin and pulled apart to both sides by a length, the gap filled with the cut; as exact outside as the shape, a bound inside",
            |lowerer, span, a| transformed(lowerer, span, a, Transform::Elongate { by: a[1].vec3() }),
        ),
        call(
            "twist",
            vec![child(), required("rate", Type::Angle)],
            Type::Shape,
            "turned about the y axis by an angle per unit of y; a lower bound, marched safely by the stretch at the shape's rim",
            |lowerer, span, a| {
                let transform = transform::twist(lowerer, &a[0].shape(), a[1].scalar(), span)?;
                transformed(lowerer, span, a, transform)
            },
        ),
        call(
            "bend",
            vec![child(), required("rate", Type::Angle)],
            Type::Shape,
            "the x axis bent towards y, about z, by an angle per unit of x, lengths along the axis kept; a lower bound, marched safely by the stretch at the shape's inner side",
            |lowerer, span, a| {
                let transform = transform::bend(lowerer, &a[0].shape(), a[1].scalar(), span)?;
                transformed(lowerer, span, a, transform)
            },
        ),
    ]
}

/// Most copies along an axis or around one.
const MOST_COPIES: u32 = 1_000_000;

/// Most further cells that a copy may reach into.
const MOST_OVERLAP: u32 = 8;

fn folds() -> Vec<Builtin> {
    vec![
        call(
            "repeat",
            vec![
                child(),
                required("period", Type::Vec3),
                optional("count", Type::Vec3, 0.0),
                optional("overlap", Type::Int, 0.0),
            ],
            Type::Shape,
            "count copies along each axis, centred at the origin, a period apart; count 0 is without end, period 0 no copies along that axis; overlap is into how many further cells the shape reaches; as exact outside as the shape, a bound inside",
            repeat,
        ),
        call(
            "repeat_polar",
            vec![child(), required("count", Type::Int), optional("overlap", Type::Int, 0.0)],
            Type::Shape,
            "count copies around the y axis, the first where the shape is, near the x axis; overlap is into how many further sectors the shape reaches; as exact outside as the shape, a bound inside",
            |lowerer, span, a| {
                let [first, second] = [1, 2].map(|i| lowerer.argument_span(i, span));
                let count = whole(lowerer, a[1].scalar(), [1, MOST_COPIES], "the number of copies", first)?;
                let overlap = whole(lowerer, a[2].scalar(), [0, MOST_COPIES], "the overlap", second)?;
                let copies = Copies::Around { count, overlap };
                Shape::value(Kind::Repeated { child: a[0].shape(), copies }, lowerer, span)
            },
        ),
    ]
}

fn repeat(lowerer: &mut Lowerer<'_>, span: Span, a: &[Value]) -> Lowered<Value> {
    let (shape, period, counts) = (a[0].shape(), a[1].vec3(), a[2].vec3());
    let places = [1, 2, 3].map(|i| lowerer.argument_span(i, span));
    lowerer.refuse(&period, |x| x < 0.0, "a period must be at least 0", places[0])?;
    let overlap = whole(lowerer, a[3].scalar(), [0, MOST_OVERLAP], "the overlap", places[2])?;
    let mut axes = [None; 3];
    for (axis, row) in axes.iter_mut().enumerate() {
        let count = whole(lowerer, counts[axis], [0, MOST_COPIES], "the number of copies", places[1])?;
        let once = count == 1 || lowerer.graph.constant(period[axis]) == Some(0.0);
        if !once {
            *row = Some(Row { period: period[axis], count, symmetric: shape.is_symmetric(axis) });
        }
    }
    let copies = Copies::Along { axes, overlap };
    Shape::value(Kind::Repeated { child: shape, copies }, lowerer, span)
}

fn surfaces() -> Vec<Builtin> {
    let of_position = Type::function(vec![Type::Vec3], Type::Float);
    vec![
        call(
            "round",
            vec![child(), required("radius", Type::Float)],
            Type::Shape,
            "grown by radius on all sides, which rounds the edges; as exact outside as the shape, a bound inside",
            |lowerer, span, a| {
                Shape::value(Kind::Rounded { child: a[0].shape(), radius: a[1].scalar() }, lowerer, span)
            },
        ),
        call(
            "shell",
            vec![child(), required("thickness", Type::Float)],
            Type::Shape,
            "the surface as a wall of a thickness, half of it on each side; as exact off the wall as the shape, a bound within it",
            |lowerer, span, a| {
                let place = lowerer.argument_span(1, span);
                let message = "a thickness must be at least 0";
                lowerer.refuse(&[a[1].scalar()], |x| x < 0.0, message, place)?;
                let half = lowerer.graph.number(0.5);
                let half = lowerer.graph.mul(a[1].scalar(), half);
                Shape::value(Kind::Shell { child: a[0].shape(), half }, lowerer, span)
            },
        ),
        call(
            "displace",
            vec![child(), required("amount", of_position)],
            Type::Shape,
            "the surface moved inwards by an amount that depends on the position; a bound, marched safely by the amount's own slope",
            |lowerer, span, a| {
                let (child, amount) = (a[0].shape(), a[1].function());
                let amount_span = lowerer.argument_span(1, span);
                Shape::value(Kind::Displaced { child, amount, span: amount_span }, lowerer, span)
            },
        ),
    ]
}

/// A vector made unit length; a constant 0 is refused.
fn direction(lowerer: &mut Lowerer<'_>, v: [ValueId; 3], what: &str, span: Span) -> Lowered<[ValueId; 3]> {
    let squared = lowerer.graph.dot(&v, &v);
    let message = format!("{what} must not be the zero vector");
    lowerer.refuse(&[squared], |x| x <= 0.0, &message, lowerer.argument_span(1, span))?;
    Ok(Value::Numbers(math::normalize(&mut lowerer.graph, &v)).vec3())
}

fn about(lowerer: &mut Lowerer<'_>, args: &[Value], axis: usize, span: Span) -> Lowered<Value> {
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
    transformed(lowerer, span, args, Transform::Rotate { columns })
}

/// Columns of Rodrigues' rotation: `cos e_i + sin (axis x e_i) + (1 - cos) axis_i axis`.
fn turn_about(graph: &mut Graph, axis: [ValueId; 3], angle: ValueId) -> [[ValueId; 3]; 3] {
    let one = graph.number(1.0);
    let (sine, cosine) = (graph.apply(Op::Sin, &[angle]), graph.apply(Op::Cos, &[angle]));
    let versine = graph.sub(one, cosine);
    [0, 1, 2].map(|i| {
        let along = graph.mul(versine, axis[i]);
        [0, 1, 2].map(|j| {
            let rest = graph.mul(along, axis[j]);
            let turned = match (3 + j - i) % 3 {
                0 => cosine,
                // (axis x e_i) has axis[3 - i - j] after e_i and its opposite before.
                1 => graph.mul(sine, axis[3 - i - j]),
                _ => {
                    let product = graph.mul(sine, axis[3 - i - j]);
                    graph.apply(Op::Neg, &[product])
                }
            };
            graph.add(turned, rest)
        })
    })
}

/// Columns of the shortest rotation that takes y to a unit vector: `cos I + [v] + k v v^T` with
/// `v = y x d`, `k = 1 / (1 + cos)`; half a turn about x for the opposite of y.
fn turn_to(graph: &mut Graph, d: [ValueId; 3]) -> [[ValueId; 3]; 3] {
    let (zero, one, least) = (graph.number(0.0), graph.number(1.0), graph.number(1e-30));
    let [x, y, z] = d;
    // 1 / (1 + cos) without cancellation where cos is near -1.
    let squared = graph.dot(&[x, z], &[x, z]);
    let opposite = graph.apply(Op::LessEqual, &[squared, least]);
    let down = graph.apply(Op::Less, &[y, zero]);
    let opposite = graph.apply(Op::And, &[opposite, down]);
    let safe = graph.max(squared, least);
    let (less, more) = (graph.sub(one, y), graph.add(one, y));
    let behind = graph.div(less, safe);
    let more = graph.max(more, least);
    let ahead = graph.div(one, more);
    let k = graph.select(down, behind, ahead);
    let k = graph.select(opposite, zero, k);
    let entry = |graph: &mut Graph, a, b| {
        let product = graph.mul(a, b);
        graph.mul(product, k)
    };
    let (xx, xz, zz) = (entry(graph, x, x), entry(graph, x, z), entry(graph, z, z));
    let (first, last) = (graph.add(y, zz), graph.add(y, xx));
    let first = graph.select(opposite, one, first);
    let (minus_x, minus_z) = (graph.apply(Op::Neg, &[x]), graph.apply(Op::Neg, &[z]));
    let minus_xz = graph.apply(Op::Neg, &[xz]);
    [[first, minus_x, minus_xz], d, [minus_xz, minus_z, last]]
}
