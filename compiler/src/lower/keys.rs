//! Key-framed values: piecewise between the keys, constant before the first and after the last.

use super::value::Value;
use super::{Lowered, Lowerer};
use crate::ir::ValueId;
use crate::ir::graph::Graph;
use crate::ops::Op;
use vol_language::hir::{Ease, Keys};

impl Lowerer<'_> {
    /// The value at a place along the keys.
    pub(crate) fn keys(&mut self, keys: &Keys) -> Lowered<Value> {
        let at = self.expr(keys.at)?.scalar();
        let mut frames: Vec<(f64, Value)> = Vec::with_capacity(keys.keys.len());
        for &(place, value) in &keys.keys {
            frames.push((place, self.expr(value)?));
        }
        let Some((_, first)) = frames.first() else { unreachable!("the checker asks for a key") };
        if matches!(first, Value::List(_)) {
            return self.keyed_lists(at, frames, keys.ease);
        }
        let mut result = first.numbers().to_vec();
        for pair in frames.windows(2) {
            let [(start, before), (end, after)] = pair else { unreachable!("windows of two") };
            let share = self.share(at, *start, *end, keys.ease)?;
            let graph = &mut self.graph;
            let place = graph.number(*start);
            // From its key on a segment replaces what came before.
            let reached = graph.apply(Op::LessEqual, &[place, at]);
            for (i, slot) in result.iter_mut().enumerate() {
                let value = mixed(graph, before.numbers()[i], after.numbers()[i], share);
                *slot = graph.select(reached, value, *slot);
            }
        }
        Ok(Value::Numbers(result))
    }

    /// Lists are kept whole, with the share of each: what they make is mixed, not they.
    fn keyed_lists(&mut self, at: ValueId, frames: Vec<(f64, Value)>, ease: Ease) -> Lowered<Value> {
        let shares = frames.windows(2).map(|pair| self.share(at, pair[0].0, pair[1].0, ease));
        let shares = shares.collect::<Lowered<_>>()?;
        Ok(Value::Keyed(frames.into_iter().map(|(_, list)| list).collect(), shares))
    }

    /// The share of the next key, eased: 0 at `start`, 1 from `end` on.
    fn share(&mut self, at: ValueId, start: f64, end: f64, ease: Ease) -> Lowered<ValueId> {
        let graph = &mut self.graph;
        let (zero, one) = (graph.number(0.0), graph.number(1.0));
        let (from, length) = (graph.number(start), graph.number(end - start));
        let passed = graph.sub(at, from);
        let share = graph.div(passed, length);
        let share = graph.max(share, zero);
        let share = graph.min(share, one);
        match ease {
            Ease::Linear => Ok(share),
            Ease::Smooth => {
                let (two, three) = (graph.number(2.0), graph.number(3.0));
                let doubled = graph.mul(two, share);
                let bend = graph.sub(three, doubled);
                let squared = graph.mul(share, share);
                Ok(graph.mul(squared, bend))
            }
            Ease::Hold => {
                let done = graph.apply(Op::LessEqual, &[one, share]);
                Ok(graph.select(done, one, zero))
            }
            Ease::Curve(function) => {
                let closure = self.expr(function)?.function();
                Ok(self.call_numbers(&closure, &[share])?.scalar())
            }
        }
    }
}

/// `a + (b - a) share`, written as a sum of products, which is exact at 0 and 1.
fn mixed(graph: &mut Graph, a: ValueId, b: ValueId, share: ValueId) -> ValueId {
    let one = graph.number(1.0);
    let rest = graph.sub(one, share);
    let (a, b) = (graph.mul(a, rest), graph.mul(b, share));
    graph.add(a, b)
}

#[cfg(test)]
mod tests {
    use crate::reference;
    use vol_language::source::SourceFile;

    /// The value of `keys(p.x, …)` at a place.
    fn value(keys: &str, x: f64) -> Vec<f64> {
        let text = format!(
            "fn f(p: vec3) -> vec3 {{ (1, 0, 0) * keys(p.x, {keys}) }}\nobject b {{ shape: sphere(1) }}"
        );
        let (scene, found) =
            vol_language::analyse(&SourceFile::new("keys.vol", text), &crate::library::library());
        assert_eq!(found, []);
        let (program, found) = crate::lower::compile(&scene.expect("no errors"));
        assert_eq!(found, []);
        let program = program.expect("no errors");
        let field = program.fields.iter().find(|field| field.name == "f").expect("a field");
        let frame = program.frame(&[], 0.0, 0.0, [8, 8]).expect("a frame");
        reference::evaluate(program.module.function(field.function), &[x, 0.0, 0.0], &frame.uniforms, &[])
    }

    #[track_caller]
    fn check(keys: &str, expected: &[(f64, f64)]) {
        for &(x, wanted) in expected {
            let found = value(keys, x)[0];
            assert!((found - wanted).abs() < 1e-12, "keys({keys}) at {x}: {found}, expected {wanted}");
        }
    }

    #[test]
    fn values_at_and_between_keys() {
        let ends = [(-9.0, 1.0), (0.0, 1.0), (2.0, 5.0), (3.0, 2.0), (99.0, 2.0)];
        for ease in ["", ", ease: linear", ", ease: smooth", ", ease: hold", ", ease: u => u * u"] {
            check(&format!("0: 1, 2: 5, 3: 2{ease}"), &ends);
        }
        check("0: 1, 2: 5, 3: 2", &[(1.0, 3.0), (0.5, 2.0), (2.5, 3.5)]);
        check("0: 1, 2: 5, 3: 2, ease: smooth", &[(1.0, 3.0), (0.5, 1.0 + 4.0 * 0.15625)]);
        check("0: 1, 2: 5, 3: 2, ease: hold", &[(1.999, 1.0), (2.999, 5.0)]);
        check("0: 1, 2: 5, 3: 2, ease: u => u * u", &[(1.0, 2.0)]);
    }

    #[test]
    fn one_key_is_a_constant() {
        check("7: 3", &[(-1.0, 3.0), (7.0, 3.0), (8.0, 3.0)]);
    }

    #[test]
    fn negative_and_close_places() {
        check("-1: 0, -0.999: 8", &[(-1.0, 0.0), (-0.9995, 4.0), (0.0, 8.0)]);
    }

    #[test]
    fn far_values_do_not_disturb_near_ones() {
        check("0: 1, 1: 1e30, 2: 1", &[(0.0, 1.0), (2.0, 1.0), (3.0, 1.0)]);
    }
}
