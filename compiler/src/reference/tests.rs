use super::*;
use crate::error_bound;
use crate::ir::text;
use crate::ir::verify::random::{self, Random};

/// A loop that doubles a number while it is below the second input, at most 10 times.
fn doubling() -> Function {
    let text = "fn f(2) {\n%0 = input 0\n%1 = input 1\n%2 = loop 10 %0 %1 {\n%0 = input 0\n%1 = input 1\n\
        %2 = add %0 %0\n%3 = less %0 %1\nreturn %2 %3\n}\n%3 = extract %2 0\nreturn %3\n}";
    text::parse_function(text).expect("well-formed text")
}

#[test]
fn the_condition_is_asked_before_each_step() {
    let at = |x: f64, end: f64| evaluate(&doubling(), &[x, end], &[], &[])[0];
    assert_eq!([at(1.0, 1.0), at(1.0, 1.5), at(1.0, 8.0), at(1.0, 1e9)], [1.0, 2.0, 8.0, 1024.0]);
}

#[test]
fn bounds_of_loops_by_hand() {
    let over = |lo: f64, hi: f64, end: f64| {
        interval(&doubling(), &[Interval::new(lo, hi), Interval::point(end)], &[], &[])[0]
    };
    let near = |found: Interval, lo: f64, hi: f64| {
        assert!(found.contains(lo) && found.contains(hi) && found.width() < hi - lo + 1e-6, "{found:?}");
    };
    near(over(1.0, 1.2, 1.5), 2.0, 2.4);
    // Some stop at once, some after a step.
    near(over(1.0, 2.0, 1.5), 1.0, 4.0);
    near(over(1.0, 1.0, 1e9), 1024.0, 1024.0);
    assert_eq!(over(f64::NEG_INFINITY, f64::INFINITY, 2.0), Interval::EVERYTHING);
}

#[test]
fn bounds_contain_generated_functions() {
    let shape = random::Shape { curves: 0, tame: true, ..random::Shape::default() };
    let uniforms = [0.5, -2.0, 3.25, 1.0];
    let mut random = Random::new(2);
    for seed in 0..400 {
        let function = random::function(seed, &shape);
        let lo: Vec<f64> = (0..3).map(|_| random.between(-3.0, 3.0)).collect();
        let sides: Vec<f64> = (0..3).map(|_| random.between(0.0, 0.5)).collect();
        let boxes: Vec<Interval> = lo.iter().zip(&sides).map(|(&a, &b)| Interval::new(a, a + b)).collect();
        let bounds = interval(&function, &boxes, &uniforms, &[]);
        for _ in 0..20 {
            let point: Vec<f64> =
                lo.iter().zip(&sides).map(|(a, b)| a + b * random.between(0.0, 1.0)).collect();
            for (value, bound) in evaluate(&function, &point, &uniforms, &[]).iter().zip(&bounds) {
                assert!(bound.contains(*value) || value.is_nan(), "{value} {bound:?} seed {seed}");
            }
        }
    }
}

#[test]
fn errors_of_undecided_loops_are_the_distance_of_their_ends() {
    let bound = |x: f32, end: f32| error_bound::evaluate(&doubling(), &[x, end], &[], &[])[0];
    // Doubling is exact.
    assert_eq!(bound(1.1, 4.0).error, 0.0);
    // 0.1 doubled three times may be computed as just below or just above 0.8 where it carries errors.
    let text = text::print_function(&doubling());
    let text = text.replace(
        "%1 = input 1\n  %2 = loop 10 %0 %1",
        "%1 = constant 0.1\n  %2 = constant 0.8\n  %3 = loop 10 %1 %2",
    );
    let text = text.replace("  %3 = extract %2 0\n  return %3", "  %4 = extract %3 0\n  return %4");
    let found =
        error_bound::evaluate(&text::parse_function(&text).expect("well-formed text"), &[0.0; 2], &[], &[])
            [0];
    assert!(found.error > 0.75 && found.error < 0.85, "{found:?}");
}
