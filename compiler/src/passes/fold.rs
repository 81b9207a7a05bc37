//! Constant folding and identities.
//!
//! ```text
//! %0 = input 0            %0 = input 0
//! %1 = constant 1.0
//! %2 = constant 3.0
//! %3 = div %1 %2          %1 = constant 0.3333333333333333
//! %4 = mul %0 %1    ──►
//! %5 = mul %4 %3          %2 = mul %0 %1
//! return %5               return %2
//! ```
//!
//! Operations on constants are computed in f64 by the table's meaning, unless the result is not
//! finite. The identities are exact in f32 for finite operands: they give the same number, bit for
//! bit except for the sign of a zero (`x + 0`, `0 - x`, `x * 0`), which no operation of the table
//! but division by that zero can tell. Precondition: a verified function. [`simplify`] is also what
//! [`crate::ir::graph::Graph`] asks before it adds an operation.

use crate::ir::{Function, Inst, Number, ValueId};
use crate::ops::{self, Context, Op, Ty};

/// What an instruction may be replaced by.
#[derive(Clone, Debug, PartialEq)]
pub enum Simplified {
    /// Nothing simpler is known.
    Same,
    /// A value that exists already.
    Value(ValueId),
    /// A simpler instruction.
    Inst(Inst),
}

/// Simplifies one instruction whose operands `lookup` knows.
pub fn simplify(inst: &Inst, lookup: impl Fn(ValueId) -> Inst) -> Simplified {
    let mut simplest = Simplified::Same;
    loop {
        let current = if let Simplified::Inst(simpler) = &simplest { simpler } else { inst };
        match step(current, &lookup) {
            Simplified::Same => return simplest,
            Simplified::Value(value) => return Simplified::Value(value),
            // Every rule removes an operation below, so this comes to an end.
            Simplified::Inst(simpler) => simplest = Simplified::Inst(simpler),
        }
    }
}

/// The pass: [`simplify`] on every instruction, and division by a power of two as multiplication.
pub fn fold(function: &mut Function) -> bool {
    let mut renamed: Vec<ValueId> = Vec::with_capacity(function.insts.len());
    let mut insts: Vec<Inst> = Vec::with_capacity(function.insts.len());
    let mut changed = super::in_bodies(function, fold);
    for old in &function.insts {
        let inst = old.map_operands(|v| renamed[v.index()]);
        let inst = match simplify(&inst, |v| insts[v.index()].clone()) {
            Simplified::Same => inst,
            Simplified::Inst(simpler) => {
                changed = true;
                simpler
            }
            Simplified::Value(value) => {
                changed = true;
                renamed.push(value);
                continue;
            }
        };
        let inst = match reciprocal(&inst, &insts) {
            None => inst,
            Some((dividend, factor)) => {
                changed = true;
                insts.push(Inst::Constant(Number(factor)));
                let args = vec![dividend, ValueId(insts.len() as u32 - 1)];
                Inst::Apply { op: Op::Mul, data: 0, args }
            }
        };
        renamed.push(ValueId(insts.len() as u32));
        insts.push(inst);
    }
    for output in &mut function.outputs {
        *output = renamed[output.index()];
    }
    function.insts = insts;
    changed
}

/// `x / c` as `x` and `1 / c`, if `c` is a power of two: then both round the same exact quotient.
fn reciprocal(inst: &Inst, insts: &[Inst]) -> Option<(ValueId, f64)> {
    let Inst::Apply { op: Op::Div, args, .. } = inst else { return None };
    let Inst::Constant(Number(divisor)) = insts[args[1].index()] else { return None };
    let whole_exponent = divisor.to_bits() & ((1 << 52) - 1) == 0;
    // Both the divisor and its reciprocal are normal in f32.
    let in_range = (2f64.powi(-126)..=2f64.powi(126)).contains(&divisor.abs());
    (whole_exponent && in_range).then(|| (args[0], 1.0 / divisor))
}

/// One rule.
fn step(inst: &Inst, lookup: &impl Fn(ValueId) -> Inst) -> Simplified {
    match inst {
        Inst::Constant(_) | Inst::Boolean(_) | Inst::Input(_) | Inst::Uniform(_) | Inst::Loop { .. } => {
            Simplified::Same
        }
        Inst::Extract(tuple, index) => match computed(&lookup(*tuple), *index as usize, lookup) {
            Some(constant) => Simplified::Inst(constant),
            None => Simplified::Same,
        },
        Inst::Apply { op, args, .. } => {
            let single = ops::operation(*op).results.len() == 1;
            match single.then(|| computed(inst, 0, lookup)).flatten() {
                Some(constant) => Simplified::Inst(constant),
                None => identity(*op, &Operands { args, insts: args.iter().map(|&a| lookup(a)).collect() }),
            }
        }
    }
}

/// A result of an operation whose operands are all constants.
fn computed(inst: &Inst, result: usize, lookup: &impl Fn(ValueId) -> Inst) -> Option<Inst> {
    let Inst::Apply { op, data, args } = inst else { return None };
    // The closest point depends on control points that are not constants.
    if op.reads_curve() {
        return None;
    }
    let operands: Option<Vec<f64>> = args.iter().map(|&a| constant(&lookup(a))).collect();
    let row = ops::operation(*op);
    let value = (row.meaning)(&operands?, Context { data: *data, curves: &[] })[result];
    match row.results[result] {
        Ty::Bool => Some(Inst::Boolean(value != 0.0)),
        Ty::Number => value.is_finite().then_some(Inst::Constant(Number(value))),
    }
}

fn constant(inst: &Inst) -> Option<f64> {
    match inst {
        Inst::Constant(number) => Some(number.0),
        Inst::Boolean(truth) => Some(f64::from(u8::from(*truth))),
        Inst::Input(_) | Inst::Uniform(_) | Inst::Apply { .. } | Inst::Extract(..) | Inst::Loop { .. } => {
            None
        }
    }
}

/// Operands of the instruction at hand.
struct Operands<'a> {
    args: &'a [ValueId],
    insts: Vec<Inst>,
}

impl Operands<'_> {
    fn is(&self, i: usize, number: f64) -> bool {
        constant(&self.insts[i]) == Some(number)
    }

    /// Whether operands `i` and `j` are one value.
    fn same(&self, i: usize, j: usize) -> bool {
        self.args[i] == self.args[j]
    }

    /// The operand of operand `i`, if that is the operation `op` of one operand.
    fn inside(&self, i: usize, op: Op) -> Option<ValueId> {
        match &self.insts[i] {
            Inst::Apply { op: found, args, .. } if *found == op => args.first().copied(),
            Inst::Apply { .. }
            | Inst::Constant(_)
            | Inst::Boolean(_)
            | Inst::Input(_)
            | Inst::Uniform(_)
            | Inst::Extract(..)
            | Inst::Loop { .. } => None,
        }
    }

    fn value(&self, i: usize) -> Simplified {
        Simplified::Value(self.args[i])
    }
}

fn applied(op: Op, args: &[ValueId]) -> Simplified {
    Simplified::Inst(Inst::Apply { op, data: 0, args: args.to_vec() })
}

/// Identities that need no new constant, one family an arm.
fn identity(op: Op, x: &Operands<'_>) -> Simplified {
    match op {
        Op::Add | Op::Sub => sum(op, x),
        Op::Mul | Op::Div => product(op, x),
        Op::Min | Op::Max if x.same(0, 1) => x.value(0),
        Op::Neg => x.inside(0, Op::Neg).map_or(Simplified::Same, Simplified::Value),
        Op::Abs if x.inside(0, Op::Abs).is_some() => x.value(0),
        Op::Abs => x.inside(0, Op::Neg).map_or(Simplified::Same, |inner| applied(Op::Abs, &[inner])),
        Op::Floor if x.inside(0, Op::Floor).is_some() => x.value(0),
        Op::Less if x.same(0, 1) => Simplified::Inst(Inst::Boolean(false)),
        Op::LessEqual | Op::Equal if x.same(0, 1) => Simplified::Inst(Inst::Boolean(true)),
        Op::And | Op::Or | Op::Not | Op::Select => logic(op, x),
        Op::Min | Op::Max | Op::Floor | Op::Less | Op::LessEqual | Op::Equal => Simplified::Same,
        Op::Sqrt | Op::Sin | Op::Cos | Op::Exp2 | Op::Log2 | Op::Acos | Op::Atan2 => Simplified::Same,
        Op::Perlin | Op::PerlinGradient | Op::Fbm | Op::FbmGradient => Simplified::Same,
        Op::Perlin4 | Op::Perlin4Gradient | Op::Value | Op::ValueGradient => Simplified::Same,
        Op::Simplex | Op::SimplexGradient | Op::Worley | Op::WorleyGradient => Simplified::Same,
        Op::Hash | Op::Closest | Op::ClosestGradient | Op::Foot => Simplified::Same,
    }
}

fn sum(op: Op, x: &Operands<'_>) -> Simplified {
    let adds = op == Op::Add;
    if x.is(1, 0.0) {
        return x.value(0);
    }
    if x.is(0, 0.0) {
        return if adds { x.value(1) } else { applied(Op::Neg, &x.args[1..]) };
    }
    if !adds && x.same(0, 1) {
        return Simplified::Inst(Inst::Constant(Number(0.0)));
    }
    match (x.inside(0, Op::Neg), x.inside(1, Op::Neg)) {
        (_, Some(inner)) => applied(if adds { Op::Sub } else { Op::Add }, &[x.args[0], inner]),
        (Some(inner), None) if adds => applied(Op::Sub, &[x.args[1], inner]),
        (Some(_) | None, None) => Simplified::Same,
    }
}

fn product(op: Op, x: &Operands<'_>) -> Simplified {
    let multiplies = op == Op::Mul;
    if x.is(1, 1.0) {
        return x.value(0);
    }
    if x.is(1, -1.0) {
        return applied(Op::Neg, &x.args[..1]);
    }
    if multiplies && x.is(0, 1.0) {
        return x.value(1);
    }
    if multiplies && x.is(0, -1.0) {
        return applied(Op::Neg, &x.args[1..]);
    }
    if multiplies && (x.is(0, 0.0) || x.is(1, 0.0)) {
        return Simplified::Inst(Inst::Constant(Number(0.0)));
    }
    Simplified::Same
}

fn logic(op: Op, x: &Operands<'_>) -> Simplified {
    // The operand that decides alone, and the one that leaves it to the other.
    let (deciding, neutral) = if op == Op::And { (0.0, 1.0) } else { (1.0, 0.0) };
    match op {
        Op::Not => x.inside(0, Op::Not).map_or(Simplified::Same, Simplified::Value),
        Op::Select if x.is(0, 1.0) => x.value(1),
        Op::Select if x.is(0, 0.0) || x.same(1, 2) => x.value(2),
        Op::Select => match x.inside(0, Op::Not) {
            Some(opposite) => applied(Op::Select, &[opposite, x.args[2], x.args[1]]),
            None => Simplified::Same,
        },
        _ if x.same(0, 1) || x.is(1, neutral) || x.is(0, deciding) => x.value(0),
        _ if x.is(0, neutral) || x.is(1, deciding) => x.value(1),
        _ => Simplified::Same,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::passes::dce::dce;
    use crate::passes::testing::assert_pass;

    fn folded(function: &mut Function) -> bool {
        let changed = fold(function);
        dce(function) || changed
    }

    /// The last value before folding, with %0 = input 0, %1 = input 1, %2 = less %0 %1, and what
    /// the function returns afterwards, once dead values are gone.
    #[track_caller]
    fn assert_folds(lines: &str, after: &str) {
        let last = 2 + lines.lines().count();
        let before = format!("%0 = input 0\n%1 = input 1\n%2 = less %0 %1\n{lines}\nreturn %{last}");
        assert_pass(folded, &before, after);
    }

    /// As [`assert_folds`], for a result that is one of the inputs.
    #[track_caller]
    fn assert_is_input(lines: &str, input: u32) {
        assert_folds(lines, &format!("%0 = input {input}\nreturn %0"));
    }

    #[test]
    fn constants_are_computed_in_f64() {
        assert_folds(
            "%3 = constant 1.0\n%4 = constant 3.0\n%5 = div %3 %4",
            "%0 = constant 0.3333333333333333\nreturn %0",
        );
        assert_folds(
            "%3 = constant 2.0\n%4 = sqrt %3\n%5 = mul %4 %4",
            "%0 = constant 2.0000000000000004\nreturn %0",
        );
    }

    #[test]
    fn infinite_results_stay() {
        let kept = "%0 = constant 1.0\n%1 = constant 0.0\n%2 = div %0 %1\nreturn %2";
        assert_pass(folded, kept, kept);
    }

    #[test]
    fn results_of_tuples_are_computed() {
        let before = "%0 = constant 1.0\n%1 = perlin_gradient[0] %0 %0 %0\n%2 = extract %1 0\nreturn %2";
        assert_pass(folded, before, "%0 = constant 0.0\nreturn %0");
    }

    #[test]
    fn closest_points_are_not_computed() {
        let kept = "%0 = constant 1.0\n%1 = closest[0] %0 %0 %0\n%2 = extract %1 5\nreturn %2";
        assert_pass(folded, kept, kept);
    }

    #[test]
    fn sums() {
        for zero in ["0.0", "-0.0"] {
            assert_is_input(&format!("%3 = constant {zero}\n%4 = add %0 %3"), 0);
            assert_is_input(&format!("%3 = constant {zero}\n%4 = add %3 %1"), 1);
            assert_is_input(&format!("%3 = constant {zero}\n%4 = sub %0 %3"), 0);
        }
        assert_folds("%3 = constant 0.0\n%4 = sub %3 %0", "%0 = input 0\n%1 = neg %0\nreturn %1");
        assert_folds("%3 = sub %0 %0", "%0 = constant 0.0\nreturn %0");
        assert_folds("%3 = neg %1\n%4 = add %0 %3", "%0 = input 0\n%1 = input 1\n%2 = sub %0 %1\nreturn %2");
        assert_folds("%3 = neg %1\n%4 = add %3 %0", "%0 = input 0\n%1 = input 1\n%2 = sub %0 %1\nreturn %2");
        assert_folds("%3 = neg %1\n%4 = sub %0 %3", "%0 = input 0\n%1 = input 1\n%2 = add %0 %1\nreturn %2");
    }

    #[test]
    fn products() {
        assert_is_input("%3 = constant 1.0\n%4 = mul %0 %3", 0);
        assert_is_input("%3 = constant 1.0\n%4 = mul %3 %0", 0);
        assert_is_input("%3 = constant 1.0\n%4 = div %0 %3", 0);
        assert_folds("%3 = constant -1.0\n%4 = mul %3 %0", "%0 = input 0\n%1 = neg %0\nreturn %1");
        assert_folds("%3 = constant -1.0\n%4 = div %0 %3", "%0 = input 0\n%1 = neg %0\nreturn %1");
        assert_folds("%3 = constant -0.0\n%4 = mul %0 %3", "%0 = constant 0.0\nreturn %0");
        assert_is_input("%3 = neg %0\n%4 = constant -1.0\n%5 = mul %3 %4", 0);
    }

    #[test]
    fn division_by_a_power_of_two() {
        assert_folds(
            "%3 = constant -4.0\n%4 = div %0 %3",
            "%0 = input 0\n%1 = constant -0.25\n%2 = mul %0 %1\nreturn %2",
        );
        let kept = "%0 = input 0\n%1 = constant 3.0\n%2 = div %0 %1\nreturn %2";
        assert_pass(folded, kept, kept);
        // The reciprocal would not be a normal f32.
        let kept = "%0 = input 0\n%1 = constant 1.7014118346046923e38\n%2 = div %0 %1\nreturn %2";
        assert_pass(folded, kept, kept);
    }

    #[test]
    fn choices() {
        assert_is_input("%3 = min %0 %0", 0);
        assert_is_input("%3 = boolean false\n%4 = select %3 %0 %1", 1);
        assert_is_input("%3 = select %2 %0 %0", 0);
        let swapped = "%0 = input 0\n%1 = input 1\n%2 = less %0 %1\n%3 = select %2 %1 %0\nreturn %3";
        assert_folds("%3 = not %2\n%4 = select %3 %0 %1", swapped);
        assert_is_input("%3 = less %0 %0\n%4 = select %3 %0 %1", 1);
        assert_is_input("%3 = less_equal %0 %0\n%4 = select %3 %0 %1", 0);
        assert_is_input("%3 = equal %1 %1\n%4 = select %3 %0 %1", 0);
    }

    #[test]
    fn truth_values() {
        let kept = "%0 = input 0\n%1 = input 1\n%2 = less %0 %1\n%3 = select %2 %0 %1\nreturn %3";
        assert_folds("%3 = boolean true\n%4 = and %2 %3\n%5 = select %4 %0 %1", kept);
        assert_folds("%3 = boolean false\n%4 = or %3 %2\n%5 = select %4 %0 %1", kept);
        assert_folds("%3 = and %2 %2\n%4 = select %3 %0 %1", kept);
        assert_folds("%3 = not %2\n%4 = not %3\n%5 = select %4 %0 %1", kept);
        assert_is_input("%3 = boolean false\n%4 = and %2 %3\n%5 = select %4 %0 %1", 1);
        assert_is_input("%3 = boolean true\n%4 = or %3 %2\n%5 = select %4 %0 %1", 0);
    }

    #[test]
    fn sizes() {
        let size = "%0 = input 0\n%1 = abs %0\nreturn %1";
        assert_folds("%3 = abs %0\n%4 = abs %3", size);
        assert_folds("%3 = neg %0\n%4 = abs %3", size);
        assert_is_input("%3 = neg %0\n%4 = neg %3", 0);
    }
}
