//! Where in the scene the instructions of a function come from.
//!
//! In: a function as it is cut out of the graph, and the place of each instruction. Out: the places of the
//! instructions of the same function after the passes. Passes know nothing of places: an instruction is
//! found again by what it computes, a hash of itself and of all that it reads. What a pass made anew has
//! no place of its own.
//!
//! Example: of `density: q => 1 / q.local.x` the instruction `div %0 %1` comes from `1 / q.local.x`.

use super::{Function, ValueId};
use rustc_hash::FxHashMap;
use std::hash::{DefaultHasher, Hash as _, Hasher as _};
use vol_language::source::Span;

/// Places by what is computed there.
#[derive(Clone, Debug, Default)]
pub struct Origins {
    known: FxHashMap<u64, Span>,
}

impl Origins {
    /// The places of a function's instructions, one each.
    #[must_use]
    pub fn new(function: &Function, places: impl Iterator<Item = Option<Span>>) -> Self {
        let named = structures(function).into_iter().zip(places);
        Self { known: named.filter_map(|(structure, place)| Some((structure, place?))).collect() }
    }

    /// The place of each instruction, as far as it is known.
    #[must_use]
    pub fn places(&self, function: &Function) -> Vec<Option<Span>> {
        structures(function).iter().map(|structure| self.known.get(structure).copied()).collect()
    }
}

/// A hash of each instruction and of all that it reads. Two that compute different things share one with a
/// chance of 2^-64, and then a message points at the wrong place.
fn structures(function: &Function) -> Vec<u64> {
    let mut found: Vec<u64> = Vec::with_capacity(function.insts.len());
    for inst in &function.insts {
        let mut hasher = DefaultHasher::new();
        inst.map_operands(|_| ValueId(0)).hash(&mut hasher);
        inst.operands().iter().for_each(|operand| found[operand.index()].hash(&mut hasher));
        found.push(hasher.finish());
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ir::text;
    use crate::passes;

    #[test]
    fn places_survive_the_passes() {
        let body = "%0 = input 0\n%1 = constant 0.0\n%2 = add %0 %1\n%3 = sin %0\n%4 = div %3 %0\nreturn %4";
        let mut function =
            text::parse_function(&format!("fn f(1) {{\n{body}\n}}")).expect("well-formed text");
        let place = |i: usize| Span::new(i, i + 1);
        let origins = Origins::new(&function, (0..5).map(|i| (i != 0).then(|| place(i))));
        passes::dce::dce(&mut function);
        assert_eq!(function.insts.len(), 3);
        assert_eq!(origins.places(&function), [None, Some(place(3)), Some(place(4))]);
    }
}
