use super::*;
use crate::curve;
use crate::ir::text;

/// A function of (t, arc length).
const RADIUS: &str = "fn radius(2) {
%0 = input 0
%1 = mul %0 %0
%2 = constant 0.5
%3 = mul %1 %2
%4 = constant 0.05
%5 = add %3 %4
return %5
}";

fn radius(t: f64) -> f64 {
    0.5 * t * t + 0.05
}

/// Numbers in [-1, 1].
fn random(seed: &mut u64) -> f64 {
    *seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*seed >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
}

fn axes(seed: &mut u64) -> Vec<Vec<Quadratic>> {
    let mut point = || [random(seed), random(seed), random(seed)];
    let mut all: Vec<Vec<Quadratic>> = Vec::new();
    for count in [1, 2, 5, 70] {
        // With kinks.
        let mut a = point();
        let segment = |_| {
            let (b, c) = (point(), point());
            let segment = Quadratic { a, b, c };
            a = c;
            segment
        };
        all.push((0..count).map(segment).collect());
    }
    // There and back on a line, nothing, gaps.
    all.push(vec![Quadratic { a: [0.0; 3], b: [1.0, 0.0, 0.0], c: [0.2, 0.0, 0.0] }]);
    all.push(vec![Quadratic { a: [0.3; 3], b: [0.3; 3], c: [0.3; 3] }; 2]);
    all.push((0..3).map(|_| Quadratic { a: point(), b: point(), c: point() }).collect());
    all.push(vec![Quadratic { a: [-0.4, -1.0, 0.0], b: [0.1, 0.0, 0.1], c: [0.0, 1.0, 0.0] }]);
    all
}

#[test]
fn cells_cover_tubes() {
    let mut module = text::parse_module("frame(1) {\n%0 = input 0\nreturn %0\n}").expect("well-formed text");
    module.functions = vec![text::parse_function(RADIUS).expect("well-formed text")];
    let mut seed = 1;
    let curves = axes(&mut seed);
    let tables: Vec<CurveTable> = curves.iter().map(|segments| curve::prepare(segments)).collect();
    let space = Space { module: &module, uniforms: &[], curves: &curves, tables: &tables, tubes: &[] };
    let inside = |solid: &Solid, p: [f64; 3]| {
        let within = |b: &Box3| (0..3).all(|i| b.lo[i] <= p[i] && p[i] <= b.hi[i]);
        solid.cells.iter().any(within)
    };
    let mut slices = (0, 0);
    for (index, segments) in curves.iter().enumerate() {
        let tube = |caps| Extent::Tube { curve: index as u32, radius: FunctionId(0), caps, sizes: None };
        let solid = space.solid(&tube(Caps::Flat)).expect("bounded");
        let round = space.solid(&tube(Caps::Round)).expect("bounded");
        assert!(solid.cells.len() <= MOST_CELLS && !solid.cells.is_empty());
        let wider = solid.clone().grown(0.3);
        for _ in 0..4000 {
            let p = [0; 3].map(|_| 1.5 * random(&mut seed));
            let foot = reference::curve::closest(p, segments).expect("not empty");
            let wall = foot.distance - radius(foot.t);
            let ends = (-foot.arc_length).max(foot.arc_length - foot.curve_length);
            assert!(wall >= 0.0 || inside(&round, p), "curve {index}, round: {p:?} {foot:?}");
            let region = wall.max(if foot.overshoot > 0.0 { foot.overshoot } else { ends });
            assert!(region >= 0.0 || inside(&solid, p), "curve {index}: {p:?} {foot:?}");
            assert!(region >= 0.3 || inside(&wider, p), "curve {index}, grown: {p:?} {foot:?}");
            slices.0 += u32::from(inside(&solid, p));
            slices.1 += 1;
        }
    }
    assert!(slices.0 < slices.1 / 2, "{slices:?}");
}
