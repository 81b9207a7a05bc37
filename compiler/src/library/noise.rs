//! Noise functions and random numbers.

use super::{Builtin, call, optional, required};
use crate::ir::ValueId;
use crate::ir::graph::Graph;
use crate::lower::value::Value;
use crate::lower::{Lowered, Lowerer};
use crate::ops::{MAX_OCTAVES, Op};
use crate::reference::noise;
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use vol_language::diag::Diagnostic;
use vol_language::library::Parameter;
use vol_language::source::Span;
use vol_language::ty::Type;

pub(super) fn builtins() -> Vec<Builtin> {
    let mut all = single();
    all.push(call(
        "fbm",
        vec![
            required("p", Type::Vec3),
            required("octaves", Type::Int),
            optional("lacunarity", Type::Float, 2.0),
            optional("gain", Type::Float, 0.5),
            optional("seed", Type::Int, 0.0),
        ],
        Type::Float,
        "sum of octaves of perlin: gain^k perlin(p lacunarity^k), k = 0 to octaves - 1",
        fbm,
    ));
    all.push(call(
        "gardner",
        vec![
            required("p", Type::Vec3),
            optional("terms", Type::Int, 5.0),
            optional("contrast", Type::Float, 1.0),
            optional("seed", Type::Int, 0.0),
        ],
        Type::Float,
        "product of two sums of 1 to 7 sines whose phases are shifted by sines (Gardner 1985), waves of length 2 pi and shorter, 0 to 1 for a contrast of 0 to 1, slope at most 7.7 with 5 terms",
        gardner,
    ));
    all.push(call(
        "curl",
        position(Type::Vec3),
        Type::Vec3,
        "curl of three perlin potentials: a flow without sources, each component -7.5 to 7.5; has no slope of its own, so that it cannot displace a surface",
        curl,
    ));
    all.extend(random_numbers());
    all
}

/// A position and a seed.
fn position(ty: Type) -> Vec<Parameter> {
    vec![required("p", ty), optional("seed", Type::Int, 0.0)]
}

/// Functions that are one operation.
fn single() -> Vec<Builtin> {
    vec![
        call(
            "perlin",
            position(Type::Vec3),
            Type::Float,
            "improved gradient noise (Perlin 2002), cells of size 1, -1.0364 to 1.0364, slope at most 3.75; seed 0 is the author's permutation",
            |lowerer, span, args| one(lowerer, span, Op::Perlin, args),
        ),
        call(
            "perlin",
            position(Type::Vec4),
            Type::Float,
            "improved gradient noise of space and time (Perlin 2002), cells of size 1, -1.5366 to 1.5366, slope at most 5.625",
            |lowerer, span, args| one(lowerer, span, Op::Perlin4, args),
        ),
        call(
            "value",
            position(Type::Vec3),
            Type::Float,
            "random numbers at the corners of cells of size 1, smoothly blended, -1 to 1, slope at most 3.75",
            |lowerer, span, args| one(lowerer, span, Op::Value, args),
        ),
        call(
            "simplex",
            position(Type::Vec3),
            Type::Float,
            "gradient noise on tetrahedra with edges of length 0.87 (Perlin 2001), -1 to 1, slope at most 6.967",
            |lowerer, span, args| one(lowerer, span, Op::Simplex, args),
        ),
        call(
            "worley",
            position(Type::Vec3),
            Type::Float,
            "distance to the nearest of points strewn one to a cell of size 1 (Worley 1996), at most 1, so 0 to 1, slope at most 1",
            |lowerer, span, args| one(lowerer, span, Op::Worley, args),
        ),
    ]
}

/// A noise of a position with a seed.
fn one(lowerer: &mut Lowerer<'_>, span: Span, op: Op, args: &[Value]) -> Lowered<Value> {
    let seed = seed(lowerer, args, 1, span)?;
    Ok(Value::Numbers(vec![lowerer.graph.apply_data(op, seed, args[0].numbers())]))
}

pub(crate) fn fbm(lowerer: &mut Lowerer<'_>, span: Span, args: &[Value]) -> Lowered<Value> {
    let seed = seed(lowerer, args, 4, span)?;
    let too_many = |octaves| octaves > MAX_OCTAVES;
    let (message, help) =
        ("`fbm` adds at most 32 octaves", "write 32 or fewer: further octaves are too fine to see");
    let place = lowerer.argument_span(1, span);
    lowerer.refuse_with_help(args[1].numbers(), too_many, message, place, help)?;
    let operands: Vec<ValueId> = args[..4].iter().flat_map(|arg| arg.numbers().iter().copied()).collect();
    Ok(Value::Numbers(vec![lowerer.graph.apply_data(Op::Fbm, seed, &operands)]))
}

/// `hash` and `random`, of a number or of the components of a vector.
fn random_numbers() -> Vec<Builtin> {
    let mut all = Vec::new();
    for ty in [Type::Float, Type::Vec2, Type::Vec3, Type::Vec4] {
        all.push(call(
            "hash",
            vec![required("i", ty.clone())],
            Type::Float,
            "random number that belongs to the whole part of i, 0 to below 1; the same as random with seed 0",
            |lowerer, _, args| Ok(hash(&mut lowerer.graph, args[0].numbers(), 0)),
        ));
        all.push(call(
            "random",
            vec![required("i", ty), optional("seed", Type::Int, 0.0)],
            Type::Float,
            "random number that belongs to the whole part of i and to the seed, 0 to below 1",
            |lowerer, span, args| {
                let seed = seed(lowerer, args, 1, span)?;
                Ok(hash(&mut lowerer.graph, args[0].numbers(), seed))
            },
        ));
    }
    all
}

/// Missing components are 0.
fn hash(graph: &mut Graph, components: &[ValueId], seed: u32) -> Value {
    let mut cell = components.to_vec();
    cell.resize_with(4, || graph.number(0.0));
    Value::Numbers(vec![graph.apply_data(Op::Hash, seed, &cell)])
}

/// Curl of a vector potential of three Perlin noises, from their exact gradients.
fn curl(lowerer: &mut Lowerer<'_>, span: Span, args: &[Value]) -> Lowered<Value> {
    let seed = seed(lowerer, args, 1, span)?;
    let graph = &mut lowerer.graph;
    // Three seeds that no other seed of this function has.
    let gradients = [1, 2, 3].map(|component| {
        let own = seed.wrapping_mul(3).wrapping_add(component);
        graph.apply_all(Op::PerlinGradient, own, args[0].numbers())
    });
    // Along x, y and z: 1, 2, 3 after the value.
    let mut turn = |i: usize, j: usize| graph.sub(gradients[i][j + 1], gradients[j][i + 1]);
    Ok(Value::Numbers(vec![turn(2, 1), turn(0, 2), turn(1, 0)]))
}

/// Most sines of [`gardner`].
pub(crate) const TERMS: f64 = 7.0;
/// Amplitude of a sine over that of the one before it.
const FALL: f64 = 0.707;

/// Gardner's texture function of three coordinates.
///
/// * method: `k sum_i [C_i sin(F_i x + PX_i) + T0] sum_i [C_i sin(F_i y + PY_i) + T0]`, `F_1 = 1`,
///   `F_i = 2 F_(i-1)`, `C_i = 0.707 C_(i-1)`; for i > 1 `PX_i = pi/2 sin(F_(i-1) y / 2) + pi sin(F_i z / 2)`
///   and `PY_i` likewise with x. A contrast c stands for `n T0 = sum C / c`, and `k` makes the largest
///   value 1. Seeds other than 0 add a phase to every sine.
/// * source: G. Gardner, "Visual Simulation of Clouds", SIGGRAPH 1985; as in C. Robles et al., "Procedural
///   Rendering with Ray Marching" (2022), §4.1, where the index of the frequency in `PY_i` is misprinted
pub(crate) fn gardner(lowerer: &mut Lowerer<'_>, span: Span, args: &[Value]) -> Lowered<Value> {
    let place = lowerer.argument_span(1, span);
    let terms = lowerer.compile_time(args[1].scalar(), "a number of terms", place)?;
    if !(1.0..=TERMS).contains(&terms) {
        let label = format!("here it is {terms}");
        let message = "the number of terms must be from 1 to 7";
        return Err(Box::new(
            Diagnostic::error("E0407", message, place, label).with_help("write `terms: 5`"),
        ));
    }
    let seed = seed(lowerer, args, 3, span)?;
    let graph = &mut lowerer.graph;
    let [x, y, z] = args[0].vec3();
    let contrast = args[2].scalar();
    let one = graph.number(1.0);
    let brightest = graph.add(one, contrast);
    let mut factor = |along: ValueId, across: ValueId, axis: f64| {
        let waves = waves(graph, [along, across, z], terms as i32, axis, seed);
        let scaled = graph.mul(contrast, waves);
        let raised = graph.add(one, scaled);
        graph.div(raised, brightest)
    };
    let (by_x, by_y) = (factor(x, y, 0.0), factor(y, x, 1.0));
    Ok(Value::Numbers(vec![graph.mul(by_x, by_y)]))
}

/// One sum of sines of [`gardner`], scaled to -1..1.
fn waves(graph: &mut Graph, [along, across, z]: [ValueId; 3], terms: i32, axis: f64, seed: u32) -> ValueId {
    let all: f64 = (0..terms).map(|i| FALL.powi(i)).sum();
    let mut sum = graph.number(0.0);
    for i in 0..terms {
        let frequency = 2f64.powi(i);
        let mut sine = |of: ValueId, frequency: f64, amplitude: f64| {
            let (frequency, amplitude) = (graph.number(frequency), graph.number(amplitude));
            let angle = graph.mul(frequency, of);
            let sine = graph.apply(Op::Sin, &[angle]);
            graph.mul(amplitude, sine)
        };
        // The first sine has no shift by others.
        let shifts =
            (i > 0).then(|| [sine(across, frequency / 4.0, FRAC_PI_2), sine(z, frequency / 2.0, PI)]);
        let start = if seed == 0 { 0.0 } else { TAU * noise::hash([f64::from(i), axis, 0.0, 0.0], seed) };
        let (frequency, amplitude) = (graph.number(frequency), graph.number(FALL.powi(i) / all));
        let mut phase = graph.number(start);
        for shift in shifts.into_iter().flatten() {
            phase = graph.add(phase, shift);
        }
        let angle = graph.mul(frequency, along);
        let angle = graph.add(angle, phase);
        let sine = graph.apply(Op::Sin, &[angle]);
        let sine = graph.mul(amplitude, sine);
        sum = graph.add(sum, sine);
    }
    sum
}

/// The seed at `index` of the arguments of a call.
fn seed(lowerer: &Lowerer<'_>, args: &[Value], index: usize, call: Span) -> Lowered<u32> {
    let place = lowerer.argument_span(index, call);
    let number = lowerer.compile_time(args[index].scalar(), "a seed", place)?;
    // Negative seeds are as good as others: whole numbers to their two's complement.
    Ok(number as i64 as u32)
}
