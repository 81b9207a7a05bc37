//! Texts of functions whose searches are put together.

use super::*;
use crate::ir::text;
use crate::ir::verify::random;

fn function(body: &str) -> Function {
    text::parse_function(body).expect("well-formed text")
}

/// A tube for each curve, smallest distance of all; radii are the uniforms that count down from 9, or from a list.
fn tubes(curves: &[u32], radii: &[u32]) -> Function {
    let mut body = "fn f(3) {\n%0 = input 0\n%1 = input 1\n%2 = input 2\n".to_owned();
    let mut next = 3;
    let mut least = None;
    for (curve, radius) in curves.iter().zip(radii) {
        let [search, distance, radius_value, field] = [next, next + 1, next + 2, next + 3];
        body += &format!(
            "%{search} = closest[{curve}] %0 %1 %2\n%{distance} = extract %{search} 5\n\
             %{radius_value} = uniform {radius}\n%{field} = sub %{distance} %{radius_value}\n"
        );
        next += 4;
        least = Some(match least {
            Some(before) => {
                body += &format!("%{next} = min %{before} %{field}\n");
                next += 1;
                next - 1
            }
            None => field,
        });
    }
    function(&format!("{body}return %{}\n}}", least.unwrap_or(0)))
}

#[test]
fn tubes_alike_are_one_loop() {
    let function = tubes(&[0, 1, 2], &[9, 7, 5]);
    let schedule = Schedule::of(&function);
    let [batch] = schedule.batches.as_slice() else { panic!("{schedule:?}") };
    assert_eq!((batch.turns(), batch.rows.len(), batch.inputs.len()), (3, 3, 1));
    // The field alone is read after the loop.
    assert_eq!(batch.results, BTreeSet::from([(2, None)]));
    // Inputs, the loop and two minima: uniforms that follow a rule are not read by name.
    let names: Vec<Step> = [0, 1, 2].map(|i| Step::One(ValueId(i))).to_vec();
    assert_eq!(schedule.steps[..3], names);
    assert_eq!(schedule.steps[3], Step::Batch(0));
    assert_eq!(schedule.steps.len(), 6);
}

#[test]
fn uniforms_without_a_rule_come_before_the_loop() {
    let function = tubes(&[0, 1, 2], &[9, 7, 1]);
    let schedule = Schedule::of(&function);
    let place = |step| schedule.steps.iter().position(|other| *other == step);
    let uniforms = function.insts.iter().enumerate().filter(|(_, inst)| matches!(inst, Inst::Uniform(_)));
    for (value, _) in uniforms {
        assert!(place(Step::One(ValueId(value as u32))) < place(Step::Batch(0)), "{schedule:?}");
    }
}

#[test]
fn one_search_stays_as_it_is() {
    for curves in [&[0][..], &[1]] {
        assert!(Schedule::of(&tubes(curves, &[3])).batches.is_empty());
    }
    // Twice the same place is one place.
    let twice = "fn f(3) {\n%0 = input 0\n%1 = input 1\n%2 = input 2\n%3 = closest[0] %0 %1 %2\n\
        %4 = closest_gradient[0] %0 %1 %2\n%5 = extract %3 5\n%6 = extract %4 0\nreturn %5 %6\n}";
    assert!(Schedule::of(&function(twice)).batches.is_empty());
}

#[test]
fn a_search_that_needs_another_comes_after_it() {
    let chain = "fn f(3) {\n%0 = input 0\n%1 = input 1\n%2 = input 2\n%3 = closest[0] %0 %1 %2\n%4 = extract %3 5\n\
        %5 = closest[1] %4 %1 %2\n%6 = extract %5 5\n%7 = closest[1] %0 %1 %2\n%8 = extract %7 0\n\
        %9 = mul %8 %6\nreturn %9\n}";
    let schedule = Schedule::of(&function(chain));
    let [batch] = schedule.batches.as_slice() else { panic!("{schedule:?}") };
    // The first and the last one; what the first is followed by has no pair.
    assert_eq!(batch.rows, [[ValueId(3), ValueId(7)]]);
    assert_eq!(batch.results, BTreeSet::from([(0, Some(0)), (0, Some(5))]));
}

#[test]
fn values_are_written_once_and_after_what_they_need() {
    for seed in 0..400 {
        let shape = random::Shape { operations: 60, curves: 4, ..random::Shape::default() };
        let function = random::function(seed, &shape);
        let schedule = Schedule::of(&function);
        let mut written = BTreeSet::new();
        for step in &schedule.steps {
            let values = match *step {
                Step::One(value) => vec![value],
                Step::Batch(batch) => schedule.batches[batch].rows.iter().flatten().copied().collect(),
            };
            for value in values {
                // A loop finds uniforms by itself.
                let is_written = |operand: &ValueId| {
                    matches!(function.insts[operand.index()], Inst::Uniform(_)) || written.contains(operand)
                };
                assert!(
                    function.insts[value.index()].operands().iter().all(is_written),
                    "seed {seed}: {value}"
                );
                assert!(written.insert(value), "seed {seed}: {value} twice");
            }
        }
        let are_uniforms = function.insts.iter().filter(|inst| matches!(inst, Inst::Uniform(_))).count();
        assert!(written.len() + are_uniforms >= function.insts.len(), "seed {seed}: something is missing");
    }
}
