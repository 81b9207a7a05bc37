//! The built-in functions: signature, documentation and meaning in one table.
//!
//! The checker sees the signatures ([`library`]), the lowerer calls [`lower`], the reference
//! documentation is generated from both.

mod curve;
pub(crate) mod math;
pub(crate) mod noise;
mod scene;

use crate::ir::ValueId;
use crate::ir::graph::Graph;
use crate::lower::value::Value;
use crate::lower::{Lowered, Lowerer};
use std::sync::LazyLock;
use vol_language::library::{BuiltinId, DefaultValue, Library, Parameter, Signature};
use vol_language::source::Span;
use vol_language::ty::Type;

/// How a call becomes a value.
#[derive(Clone, Copy)]
pub(crate) enum Meaning {
    /// The same scalar function on every component; scalars among vectors are repeated.
    Elementwise(fn(&mut Graph, &[ValueId]) -> ValueId),
    /// Anything else.
    Call(fn(&mut Lowerer<'_>, Span, &[Value]) -> Lowered<Value>),
}

/// One overload.
pub(crate) struct Builtin {
    pub(crate) signature: Signature,
    pub(crate) meaning: Meaning,
}

static BUILTINS: LazyLock<Vec<Builtin>> = LazyLock::new(|| {
    let mut all = math::builtins();
    all.extend(noise::builtins());
    all.extend(curve::builtins());
    all.extend(scene::builtins());
    all
});

/// The signatures of all built-in functions.
#[must_use]
pub fn library() -> Library {
    Library { signatures: BUILTINS.iter().map(|builtin| builtin.signature.clone()).collect() }
}

/// The value of a call.
pub(crate) fn lower(lowerer: &mut Lowerer<'_>, id: BuiltinId, span: Span, args: &[Value]) -> Lowered<Value> {
    match BUILTINS[id.0 as usize].meaning {
        Meaning::Call(call) => call(lowerer, span, args),
        Meaning::Elementwise(function) => {
            let width = args.iter().map(|arg| arg.numbers().len()).max().unwrap_or(0);
            let component = |arg: &Value, i: usize| arg.numbers()[i.min(arg.numbers().len() - 1)];
            let apply = |i| {
                let scalars: Vec<ValueId> = args.iter().map(|arg| component(arg, i)).collect();
                function(&mut lowerer.graph, &scalars)
            };
            Ok(Value::Numbers((0..width).map(apply).collect()))
        }
    }
}

pub(crate) fn required(name: &'static str, ty: Type) -> Parameter {
    Parameter { name, ty, default: DefaultValue::Required, rest: false }
}

pub(crate) fn optional(name: &'static str, ty: Type, default: f64) -> Parameter {
    Parameter { name, ty, default: DefaultValue::Number(default), rest: false }
}

pub(crate) fn call(
    name: &'static str,
    params: Vec<Parameter>,
    result: Type,
    doc: &'static str,
    function: fn(&mut Lowerer<'_>, Span, &[Value]) -> Lowered<Value>,
) -> Builtin {
    Builtin { signature: Signature { name, params, result, doc }, meaning: Meaning::Call(function) }
}
