//! Noise functions.

use super::{Builtin, call, optional, required};
use crate::ir::ValueId;
use crate::lower::value::Value;
use crate::lower::{Lowered, Lowerer};
use crate::ops::Op;
use vol_language::source::Span;
use vol_language::ty::Type;

pub(super) fn builtins() -> Vec<Builtin> {
    let perlin = vec![required("p", Type::Vec3), optional("seed", Type::Int, 0.0)];
    let octaves = vec![
        required("p", Type::Vec3),
        required("octaves", Type::Int),
        optional("lacunarity", Type::Float, 2.0),
        optional("gain", Type::Float, 0.5),
        optional("seed", Type::Int, 0.0),
    ];
    vec![
        call(
            "perlin",
            perlin,
            Type::Float,
            "improved gradient noise (Perlin 2002), cells of size 1, -1.0364 to 1.0364; seed 0 is the author's permutation",
            |lowerer, span, args| {
                let seed = seed(lowerer, &args[1], span)?;
                Ok(Value::Numbers(vec![lowerer.graph.apply_data(Op::Perlin, seed, args[0].numbers())]))
            },
        ),
        call(
            "fbm",
            octaves,
            Type::Float,
            "sum of octaves of perlin: gain^k perlin(p lacunarity^k), k = 0 to octaves - 1",
            fbm,
        ),
    ]
}

fn fbm(lowerer: &mut Lowerer<'_>, span: Span, args: &[Value]) -> Lowered<Value> {
    let seed = seed(lowerer, &args[4], span)?;
    let operands: Vec<ValueId> = args[..4].iter().flat_map(|arg| arg.numbers().iter().copied()).collect();
    Ok(Value::Numbers(vec![lowerer.graph.apply_data(Op::Fbm, seed, &operands)]))
}

fn seed(lowerer: &Lowerer<'_>, value: &Value, span: Span) -> Lowered<u32> {
    let number = lowerer.compile_time(value.scalar(), "a seed", span)?;
    // Negative seeds are as good as others: whole numbers to their two's complement.
    Ok(number as i64 as u32)
}
