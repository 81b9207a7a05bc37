//! Numbers and vectors.

use super::{Builtin, Meaning, call, required};
use crate::ir::ValueId;
use crate::ir::graph::Graph;
use crate::lower::value::Value;
use crate::ops::Op;
use std::f64::consts::{LN_2, LOG2_E};
use vol_language::library::{Parameter, Signature};
use vol_language::ty::Type;

type Scalar = fn(&mut Graph, &[ValueId]) -> ValueId;

/// Types that elementwise functions are overloaded on, most common first.
const NUMERIC: [Type; 5] = [Type::Float, Type::Vec3, Type::Vec2, Type::Vec4, Type::Color];

pub(super) fn builtins() -> Vec<Builtin> {
    let mut all = Vec::new();
    for &(name, params, doc, function) in ELEMENTWISE {
        for ty in NUMERIC {
            let params = params.iter().map(|&param| required(param, ty.clone())).collect();
            all.push(elementwise(name, params, ty, doc, function));
        }
    }
    for &(name, params, doc, function) in ON_ANGLES {
        let params = params.iter().map(|&param| required(param, Type::Angle)).collect();
        all.push(elementwise(name, params, Type::Angle, doc, function));
    }
    all.extend(trigonometry());
    all.extend(mixing());
    all.extend(vectors());
    all
}

fn elementwise(
    name: &'static str,
    params: Vec<Parameter>,
    result: Type,
    doc: &'static str,
    f: Scalar,
) -> Builtin {
    Builtin { signature: Signature { name, params, result, doc }, meaning: Meaning::Elementwise(f) }
}

type Row = (&'static str, &'static [&'static str], &'static str, Scalar);

/// Functions of numbers, vectors and colours, component by component.
const ELEMENTWISE: &[Row] = &[
    ("abs", &["x"], "absolute value", |g, a| g.apply(Op::Abs, a)),
    ("sign", &["x"], "-1, 0 or 1", sign),
    ("floor", &["x"], "largest whole number not above x", |g, a| g.apply(Op::Floor, a)),
    ("ceil", &["x"], "smallest whole number not below x", ceil),
    ("round", &["x"], "floor(x + 0.5)", round),
    ("fract", &["x"], "x - floor(x), 0 to 1", fract),
    ("sqrt", &["x"], "square root; 0 for negative x", |g, a| g.apply(Op::Sqrt, a)),
    ("exp", &["x"], "e to the power x", exp),
    ("exp2", &["x"], "2 to the power x", |g, a| g.apply(Op::Exp2, a)),
    ("log", &["x"], "natural logarithm of x > 0", log),
    ("log2", &["x"], "base-2 logarithm of x > 0", |g, a| g.apply(Op::Log2, a)),
    ("pow", &["x", "y"], "x to the power y; 0 for x <= 0 unless y is a constant whole number", pow),
    ("min", &["a", "b"], "the smaller", |g, a| g.apply(Op::Min, a)),
    ("max", &["a", "b"], "the larger", |g, a| g.apply(Op::Max, a)),
    ("mod", &["a", "b"], "a - b * floor(a / b)", modulo),
    ("clamp", &["x", "lo", "hi"], "x kept between lo and hi", clamp),
    ("saturate", &["x"], "x kept between 0 and 1", saturate),
    ("step", &["edge", "x"], "0 below the edge, else 1", step),
    ("smoothstep", &["lo", "hi", "x"], "smooth rise from 0 at lo to 1 at hi", smoothstep),
    ("falloff", &["lo", "hi", "x"], "smooth fall from 1 at lo to 0 at hi", falloff),
];

/// The same for angles.
const ON_ANGLES: &[Row] = &[
    ("abs", &["x"], "absolute value", |g, a| g.apply(Op::Abs, a)),
    ("min", &["a", "b"], "the smaller", |g, a| g.apply(Op::Min, a)),
    ("max", &["a", "b"], "the larger", |g, a| g.apply(Op::Max, a)),
    ("clamp", &["x", "lo", "hi"], "x kept between lo and hi", clamp),
    ("mod", &["a", "b"], "a - b * floor(a / b)", modulo),
];

fn trigonometry() -> Vec<Builtin> {
    let mut all = Vec::new();
    let rows: [Row; 3] = [
        ("sin", &["x"], "sine; a plain number means radians", |g, a| g.apply(Op::Sin, a)),
        ("cos", &["x"], "cosine; a plain number means radians", |g, a| g.apply(Op::Cos, a)),
        ("tan", &["x"], "tangent; a plain number means radians", tan),
    ];
    for (name, _, doc, function) in rows {
        for ty in [Type::Angle, Type::Float] {
            all.push(elementwise(name, vec![required("x", ty)], Type::Float, doc, function));
        }
        for ty in [Type::Vec3, Type::Vec2, Type::Vec4] {
            all.push(elementwise(name, vec![required("x", ty.clone())], ty, doc, function));
        }
    }
    let number = |name| required(name, Type::Float);
    all.push(elementwise("asin", vec![number("x")], Type::Angle, "arc sine of -1..1", asin));
    all.push(elementwise("acos", vec![number("x")], Type::Angle, "arc cosine of -1..1", |g, a| {
        g.apply(Op::Acos, a)
    }));
    all.push(elementwise("atan", vec![number("x")], Type::Angle, "arc tangent", atan));
    let pair = vec![number("y"), number("x")];
    all.push(elementwise(
        "atan2",
        pair,
        Type::Angle,
        "angle of the point (x, y); 0 at the origin",
        |g, a| g.apply(Op::Atan2, a),
    ));
    all
}

fn mixing() -> Vec<Builtin> {
    let mut all = Vec::new();
    for ty in NUMERIC.into_iter().chain([Type::Angle]) {
        let ends = vec![required("a", ty.clone()), required("b", ty.clone())];
        let by_number = [ends.clone(), vec![required("t", Type::Float)]].concat();
        all.push(elementwise("mix", by_number, ty.clone(), "a + t * (b - a)", mix));
        if ty.is_vector() {
            let by_vector = [ends, vec![required("t", ty.clone())]].concat();
            all.push(elementwise("mix", by_vector, ty, "a + t * (b - a), component by component", mix));
        }
    }
    for ty in NUMERIC {
        let names = ["x", "from_lo", "from_hi", "to_lo", "to_hi"];
        let params = names.map(|name| required(name, ty.clone())).to_vec();
        all.push(elementwise("remap", params, ty, "x moved linearly from one range to another", remap));
    }
    all
}

fn vectors() -> Vec<Builtin> {
    let mut all = Vec::new();
    for ty in [Type::Vec3, Type::Vec2, Type::Vec4] {
        let one = || vec![required("v", ty.clone())];
        let two = || vec![required("a", ty.clone()), required("b", ty.clone())];
        all.push(call("length", one(), Type::Float, "Euclidean length", |l, _, args| {
            Ok(Value::Numbers(vec![l.graph.length(args[0].numbers())]))
        }));
        all.push(call("distance", two(), Type::Float, "Euclidean distance of two points", |l, _, args| {
            let (a, b) = (args[0].numbers(), args[1].numbers());
            let apart: Vec<ValueId> = a.iter().zip(b).map(|(&a, &b)| l.graph.sub(a, b)).collect();
            Ok(Value::Numbers(vec![l.graph.length(&apart)]))
        }));
        all.push(call("dot", two(), Type::Float, "scalar product", |l, _, args| {
            Ok(Value::Numbers(vec![l.graph.dot(args[0].numbers(), args[1].numbers())]))
        }));
        all.push(call(
            "normalize",
            one(),
            ty.clone(),
            "the same direction with length 1; 0 stays 0",
            |l, _, args| Ok(Value::Numbers(normalize(&mut l.graph, args[0].numbers()))),
        ));
    }
    let two = vec![required("a", Type::Vec3), required("b", Type::Vec3)];
    all.push(call("cross", two, Type::Vec3, "vector product", |l, _, args| {
        let (a, b) = (args[0].vec3(), args[1].vec3());
        let mut minor = |i: usize, j: usize| {
            let (ij, ji) = (l.graph.mul(a[i], b[j]), l.graph.mul(a[j], b[i]));
            l.graph.sub(ij, ji)
        };
        Ok(Value::Numbers(vec![minor(1, 2), minor(2, 0), minor(0, 1)]))
    }));
    all
}

/// `v / sqrt(max(v.v, 1e-30))`: 0 for the zero vector.
pub(crate) fn normalize(graph: &mut Graph, v: &[ValueId]) -> Vec<ValueId> {
    let squared = graph.dot(v, v);
    let least = graph.number(1e-30);
    let squared = graph.max(squared, least);
    let length = graph.apply(Op::Sqrt, &[squared]);
    v.iter().map(|&c| graph.div(c, length)).collect()
}

/// `a - b * floor(a / b)`
pub(crate) fn modulo(graph: &mut Graph, args: &[ValueId]) -> ValueId {
    let ratio = graph.div(args[0], args[1]);
    let whole = graph.apply(Op::Floor, &[ratio]);
    let part = graph.mul(args[1], whole);
    graph.sub(args[0], part)
}

fn sign(graph: &mut Graph, args: &[ValueId]) -> ValueId {
    let (zero, one, minus) = (graph.number(0.0), graph.number(1.0), graph.number(-1.0));
    let positive = graph.apply(Op::Less, &[zero, args[0]]);
    let negative = graph.apply(Op::Less, &[args[0], zero]);
    let rest = graph.select(negative, minus, zero);
    graph.select(positive, one, rest)
}

fn ceil(graph: &mut Graph, args: &[ValueId]) -> ValueId {
    let mirrored = graph.apply(Op::Neg, args);
    let floor = graph.apply(Op::Floor, &[mirrored]);
    graph.apply(Op::Neg, &[floor])
}

fn round(graph: &mut Graph, args: &[ValueId]) -> ValueId {
    let half = graph.number(0.5);
    let shifted = graph.add(args[0], half);
    graph.apply(Op::Floor, &[shifted])
}

fn fract(graph: &mut Graph, args: &[ValueId]) -> ValueId {
    let whole = graph.apply(Op::Floor, args);
    graph.sub(args[0], whole)
}

fn exp(graph: &mut Graph, args: &[ValueId]) -> ValueId {
    let scale = graph.number(LOG2_E);
    let exponent = graph.mul(args[0], scale);
    graph.apply(Op::Exp2, &[exponent])
}

fn log(graph: &mut Graph, args: &[ValueId]) -> ValueId {
    let scale = graph.number(LN_2);
    let binary = graph.apply(Op::Log2, args);
    graph.mul(binary, scale)
}

/// Largest constant exponent that is multiplied out.
const MAX_POWER: f64 = 32.0;

/// Constant whole exponents are products, exact in sign; all others are `exp2(y log2 x)`, 0 for
/// x <= 0.
fn pow(graph: &mut Graph, args: &[ValueId]) -> ValueId {
    let (x, y) = (args[0], args[1]);
    if let Some(power) = graph.constant(y).filter(|y| y.fract() == 0.0 && y.abs() <= MAX_POWER) {
        let product = whole_power(graph, x, power.abs() as u32);
        let one = graph.number(1.0);
        return if power < 0.0 { graph.div(one, product) } else { product };
    }
    let zero = graph.number(0.0);
    let binary = graph.apply(Op::Log2, &[x]);
    let exponent = graph.mul(y, binary);
    let power = graph.apply(Op::Exp2, &[exponent]);
    let positive = graph.apply(Op::Less, &[zero, x]);
    graph.select(positive, power, zero)
}

/// By repeated squaring.
pub(crate) fn whole_power(graph: &mut Graph, base: ValueId, mut power: u32) -> ValueId {
    let mut product = graph.number(1.0);
    let mut square = base;
    while power > 0 {
        if power & 1 == 1 {
            product = graph.mul(product, square);
        }
        power >>= 1;
        if power > 0 {
            square = graph.mul(square, square);
        }
    }
    product
}

fn clamp(graph: &mut Graph, args: &[ValueId]) -> ValueId {
    let above = graph.max(args[0], args[1]);
    graph.min(above, args[2])
}

fn saturate(graph: &mut Graph, args: &[ValueId]) -> ValueId {
    let (zero, one) = (graph.number(0.0), graph.number(1.0));
    clamp(graph, &[args[0], zero, one])
}

fn step(graph: &mut Graph, args: &[ValueId]) -> ValueId {
    let (zero, one) = (graph.number(0.0), graph.number(1.0));
    let below = graph.apply(Op::Less, &[args[1], args[0]]);
    graph.select(below, zero, one)
}

/// `3 t^2 - 2 t^3` of the clamped ramp; a step where lo equals hi, falling where lo > hi.
fn smoothstep(graph: &mut Graph, args: &[ValueId]) -> ValueId {
    let (lo, hi, x) = (args[0], args[1], args[2]);
    let (zero, one) = (graph.number(0.0), graph.number(1.0));
    let width = graph.sub(hi, lo);
    let empty = graph.apply(Op::Equal, &[lo, hi]);
    let divisor = graph.select(empty, one, width);
    let offset = graph.sub(x, lo);
    let ramp = graph.div(offset, divisor);
    let t = clamp(graph, &[ramp, zero, one]);
    let (two, three) = (graph.number(2.0), graph.number(3.0));
    let squared = graph.mul(t, t);
    let double = graph.mul(two, t);
    let slope = graph.sub(three, double);
    let smooth = graph.mul(squared, slope);
    let sharp = step(graph, &[lo, x]);
    graph.select(empty, sharp, smooth)
}

fn falloff(graph: &mut Graph, args: &[ValueId]) -> ValueId {
    let one = graph.number(1.0);
    let rise = smoothstep(graph, args);
    graph.sub(one, rise)
}

fn tan(graph: &mut Graph, args: &[ValueId]) -> ValueId {
    let (sine, cosine) = (graph.apply(Op::Sin, args), graph.apply(Op::Cos, args));
    graph.div(sine, cosine)
}

/// `atan2(x, sqrt((1 - x)(1 + x)))`
fn asin(graph: &mut Graph, args: &[ValueId]) -> ValueId {
    let one = graph.number(1.0);
    let (below, above) = (graph.sub(one, args[0]), graph.add(one, args[0]));
    let product = graph.mul(below, above);
    let other = graph.apply(Op::Sqrt, &[product]);
    graph.apply(Op::Atan2, &[args[0], other])
}

fn atan(graph: &mut Graph, args: &[ValueId]) -> ValueId {
    let one = graph.number(1.0);
    graph.apply(Op::Atan2, &[args[0], one])
}

/// `a + t (b - a)`
fn mix(graph: &mut Graph, args: &[ValueId]) -> ValueId {
    let gap = graph.sub(args[1], args[0]);
    let part = graph.mul(args[2], gap);
    graph.add(args[0], part)
}

fn remap(graph: &mut Graph, args: &[ValueId]) -> ValueId {
    let offset = graph.sub(args[0], args[1]);
    let width = graph.sub(args[2], args[1]);
    let t = graph.div(offset, width);
    mix(graph, &[args[3], args[4], t])
}
