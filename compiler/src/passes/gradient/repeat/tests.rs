use crate::ir::graph::{Graph, Repeated, Slots};
use crate::ops::Op;
use crate::passes::gradient::gradient;
use crate::reference;

/// x <- x * y + x, y <- y, k <- k + 1 while k < 3, by hand: x (1 + y)^3.
#[test]
fn powers_by_hand() {
    let mut graph = Graph::default();
    let [x, y] = [0, 1].map(|i| graph.input(i));
    let (zero, one, three) = (graph.number(0.0), graph.number(1.0), graph.number(3.0));
    let [a, k] = [(); 2].map(|()| graph.placeholder());
    let product = graph.mul(a, y);
    let next = graph.add(product, a);
    let later = graph.add(k, one);
    let goes_on = graph.apply(Op::Less, &[k, three]);
    let repeated = Repeated { state: &[a, k], first: &[x, zero], next: &[next, later], goes_on };
    let last = graph.repeat(10, repeated);
    let slopes = gradient(&mut graph, last[0], &[0, 1]).expect("smooth");
    let outputs = [&last[..1], &slopes].concat();
    let function = Slots::default().point_function(&mut graph, "f", 2, &outputs);
    assert_eq!(reference::evaluate(&function, &[2.0, 1.0], &[], &[]), [16.0, 8.0, 24.0]);
    // The counter has no derivative.
    assert_eq!(gradient(&mut graph, last[1], &[0, 1]), Some(vec![zero; 2]));
}

#[test]
fn curves_in_a_body_have_no_derivative() {
    let mut graph = Graph::default();
    let x = graph.input(0);
    let state = graph.placeholder();
    let stretch = graph.apply_all(Op::Closest, 0, &[state, x, x])[7];
    let goes_on = graph.boolean(true);
    let repeated = Repeated { state: &[state], first: &[x], next: &[stretch], goes_on };
    let last = graph.repeat(2, repeated)[0];
    assert_eq!(gradient(&mut graph, last, &[0]), None);
}
