use super::*;
use crate::ir::graph::Slots;
use crate::ir::text;
use crate::ir::verify;
use crate::ops::Op;
use crate::reference;

/// `x <- x * x + y` while `x < 2`, from input 0, with `y = sin(time)`.
fn squares(graph: &mut Graph, most: u32) -> ValueId {
    let (x, time) = (graph.input(0), graph.frame_input(0));
    let wave = graph.apply(Op::Sin, &[time]);
    let state = graph.placeholder();
    let square = graph.mul(state, state);
    let next = graph.add(square, wave);
    let two = graph.number(2.0);
    let goes_on = graph.apply(Op::Less, &[state, two]);
    graph.repeat(most, Repeated { state: &[state], first: &[x], next: &[next], goes_on })[0]
}

#[test]
fn what_does_not_change_is_computed_outside() {
    let mut graph = Graph::default();
    let last = squares(&mut graph, 8);
    let mut slots = Slots::default();
    let function = slots.point_function(&mut graph, "f", 1, &[last]);
    let expected = "fn f(1) {\n  %0 = input 0\n  %1 = uniform 0\n  %2 = loop 8 %0 %1 {\n    %0 = input 1\n    \
        %1 = input 0\n    %2 = mul %1 %1\n    %3 = add %2 %0\n    %4 = constant 2.0\n    %5 = less %1 %4\n    \
        return %3 %5\n  }\n  %3 = extract %2 0\n  return %3\n}\n";
    assert_eq!(text::print_function(&function), expected);
    assert_eq!(verify::function(&function, 1, 0), Ok(()));
    let frame = slots.frame_function(&mut graph, 2);
    assert_eq!(reference::evaluate(&frame, &[0.5, 0.0], &[], &[]), [0.5f64.sin()]);
}

#[test]
fn equal_loops_are_one_and_no_step_is_none() {
    let mut graph = Graph::default();
    let x = graph.input(0);
    assert_eq!(squares(&mut graph, 0), x);
    let (first, second) = (squares(&mut graph, 5), squares(&mut graph, 5));
    assert_eq!(first, second);
}

#[test]
fn loops_of_frame_rate_leave_the_point_function() {
    let mut graph = Graph::default();
    let time = graph.frame_input(0);
    let state = graph.placeholder();
    let next = graph.add(state, time);
    let goes_on = graph.boolean(true);
    let last = graph.repeat(4, Repeated { state: &[state], first: &[time], next: &[next], goes_on })[0];
    assert_eq!(graph.rate(last), Rate::Frame);
    let mut slots = Slots::default();
    let function = slots.point_function(&mut graph, "f", 1, &[last]);
    assert_eq!(function.insts, [Inst::Uniform(0)]);
    let frame = slots.frame_function(&mut graph, 1);
    assert_eq!(reference::evaluate(&frame, &[0.25], &[], &[]), [1.25]);
}

#[test]
fn inner_loops_read_the_state_of_outer_ones() {
    // Three times: y <- 2 y + 1 twice with the outer x added, then x <- y.
    let mut graph = Graph::default();
    let (x, two, goes_on) = (graph.input(0), graph.number(2.0), graph.boolean(true));
    let outer = graph.placeholder();
    let inner = graph.placeholder();
    let double = graph.mul(inner, two);
    let next = graph.add(double, outer);
    let last = graph.repeat(2, Repeated { state: &[inner], first: &[outer], next: &[next], goes_on })[0];
    let last = graph.repeat(3, Repeated { state: &[outer], first: &[x], next: &[last], goes_on })[0];
    let function = Slots::default().point_function(&mut graph, "f", 1, &[last]);
    assert_eq!(verify::function(&function, 0, 0), Ok(()));
    // The inner loop makes 3 x and then 7 x of x.
    assert_eq!(reference::evaluate(&function, &[1.0], &[], &[]), [343.0]);
}
