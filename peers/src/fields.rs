//! The same fields for all evaluators: as a function of the IR, as native code, as a tree of `fidget`.

use fidget::context::Tree;
use std::fmt::Write as _;

/// How often `(a, b) <- (min(a x + b, y), a)` is done: three operations each.
const STEPS: usize = 20;

/// Centres and radii of balls.
const BALLS: [[f32; 4]; 6] = [
    [0.0, 0.0, 0.0, 1.0],
    [1.5, 0.5, -1.0, 0.8],
    [-2.0, 1.0, 0.5, 0.6],
    [0.3, -1.7, 1.1, 0.9],
    [2.2, -0.4, 2.0, 0.5],
    [-1.1, 2.3, -2.1, 0.7],
];

pub(crate) fn arithmetic() -> String {
    let mut body = String::from("%0 = input 0\n%1 = input 1\n%2 = input 2\n");
    let (mut a, mut b, mut next) = (2, 1, 3);
    for _ in 0..STEPS {
        let _ = writeln!(
            body,
            "%{next} = mul %{a} %0\n%{} = add %{next} %{b}\n%{} = min %{} %1",
            next + 1,
            next + 2,
            next + 1
        );
        (b, a) = (a, next + 2);
        next += 3;
    }
    body + &format!("return %{a}")
}

#[inline(always)]
pub(crate) fn arithmetic_native([x, y, z]: [f32; 3]) -> f32 {
    let (mut a, mut b) = (z, y);
    for _ in 0..STEPS {
        let sum = a * x + b;
        (a, b) = (if sum < y { sum } else { y }, a);
    }
    a
}

pub(crate) fn arithmetic_tree() -> Tree {
    let (x, y, z) = Tree::axes();
    let (mut a, mut b) = (z, y.clone());
    for _ in 0..STEPS {
        let next = (a.clone() * x.clone() + b).min(y.clone());
        (b, a) = (a, next);
    }
    a
}

pub(crate) fn balls() -> String {
    let mut body = String::from("%0 = input 0\n%1 = input 1\n%2 = input 2\n");
    let mut next = 3;
    let mut add = |line: String| {
        let _ = writeln!(body, "%{next} = {line}");
        next += 1;
        next - 1
    };
    let mut union = None;
    for ball in BALLS {
        let mut squares = Vec::new();
        for (axis, centre) in ball[..3].iter().enumerate() {
            let centre = add(format!("constant {centre:?}"));
            let offset = add(format!("sub %{axis} %{centre}"));
            squares.push(add(format!("mul %{offset} %{offset}")));
        }
        let sum = add(format!("add %{} %{}", squares[0], squares[1]));
        let sum = add(format!("add %{sum} %{}", squares[2]));
        let length = add(format!("sqrt %{sum}"));
        let radius = add(format!("constant {:?}", ball[3]));
        let distance = add(format!("sub %{length} %{radius}"));
        union = Some(union.map_or(distance, |union| add(format!("min %{union} %{distance}"))));
    }
    body + &format!("return %{}", union.unwrap_or(0))
}

#[inline(always)]
pub(crate) fn balls_native([x, y, z]: [f32; 3]) -> f32 {
    let mut union = f32::MAX;
    for [cx, cy, cz, radius] in BALLS {
        let (dx, dy, dz) = (x - cx, y - cy, z - cz);
        let distance = ((dx * dx + dy * dy) + dz * dz).sqrt() - radius;
        union = if union < distance { union } else { distance };
    }
    union
}

pub(crate) fn balls_tree() -> Tree {
    let (x, y, z) = Tree::axes();
    let ball = |[cx, cy, cz, radius]: [f32; 4]| {
        let square = |axis: &Tree, centre: f32| (axis.clone() - centre).square();
        ((square(&x, cx) + square(&y, cy)) + square(&z, cz)).sqrt() - radius
    };
    let mut balls = BALLS.into_iter().map(ball);
    let first = balls.next().unwrap_or_else(|| Tree::constant(0.0));
    balls.fold(first, |union, ball| union.min(ball))
}
