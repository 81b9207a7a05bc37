//! Tests of the piece table: layout, invariants, lengths, degenerate input.

use super::*;
use crate::reference;

fn curve(points: &[[f64; 3]]) -> Vec<Quadratic> {
    points.windows(3).step_by(2).map(|p| Quadratic { a: p[0], b: p[1], c: p[2] }).collect()
}

/// A field as a slice, one number or three.
trait Words {
    fn words(&mut self) -> &mut [f32];
}

impl Words for f32 {
    fn words(&mut self) -> &mut [f32] {
        std::slice::from_mut(self)
    }
}

impl Words for [f32; 3] {
    fn words(&mut self) -> &mut [f32] {
        self
    }
}

#[test]
fn layout() {
    // Two words fill the last row.
    assert_eq!((size_of::<Piece>(), Piece::WORDS % 4), (4 * (Piece::WORDS - 2), 0));
    let mut piece = prepare(&curve(&[[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0]])).pieces[0];
    // Every field gets its own word numbers through the field's offset.
    macro_rules! number {
        ($($field:ident),*) => {
            $(for (i, word) in Words::words(&mut piece.$field).iter_mut().enumerate() {
                *word = (std::mem::offset_of!(Piece, $field) / 4 + i) as f32;
            })*
        };
    }
    number!(origin, origin_low, b1, b2, tangent, normal, binormal, bend);
    number!(a3, a2, b11, vertex, inv_a3, t_start, t_span, s_start, sense, q);
    number!(log_scale, log_base, straight, before, after, curve_length);
    number!(end, end_low, end_tangent, tangent_before, lo, hi);
    let expected: [f32; Piece::WORDS] =
        std::array::from_fn(|i| if i < Piece::WORDS - 2 { i as f32 } else { 0.0 });
    assert_eq!(piece.words(), expected);
}

#[test]
fn straight_line_is_one_piece() {
    let table = prepare(&curve(&[[0.0; 3], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]]));
    assert_eq!(table.pieces.len(), 1);
    assert_eq!(table.length, 2.0);
    let piece = table.pieces[0];
    assert_eq!((piece.inv_a3, piece.straight, piece.before, piece.after), (0.0, 1.0, 0.0, 0.0));
    assert_eq!(
        [piece.tangent, piece.normal, piece.binormal],
        [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
    );
    assert_eq!(table.words().len(), Piece::WORDS);
}

#[test]
fn pieces_follow_the_segments() {
    let points = [[0.0, 0.0, 1.0], [1.0, 0.3, 0.0], [0.2, 1.0, 0.4], [2.0, -1.0, 0.0], [0.0, 0.0, 3.0]];
    let table = prepare(&curve(&points));
    assert_eq!(table.pieces.len(), 4);
    let mut end: f64 = 0.0;
    for piece in &table.pieces {
        let (t0, t1) = (f64::from(piece.t_start), f64::from(piece.t_start + piece.t_span));
        assert!((t0.min(t1) - end).abs() < 1e-7);
        end = t0.max(t1);
        assert!(piece.a2 >= 0.0 && piece.vertex <= 0.0);
        for i in 0..=8 {
            let u = f64::from(i) / 8.0;
            let global = ((t0 + u * (t1 - t0)) * 2.0).clamp(0.0, 2.0);
            let segment = table.segments[(global as usize).min(1)];
            let v = global - global.floor().min(1.0);
            for k in 0..3 {
                let w = 1.0 - v;
                let truth = w * w * segment.a[k] + 2.0 * v * w * segment.b[k] + v * v * segment.c[k];
                let found = f64::from(piece.origin[k])
                    + u * (2.0 * f64::from(piece.b1[k]) + u * f64::from(piece.b2[k]));
                assert!((found - truth).abs() < 5e-7, "{found} {truth}");
            }
        }
    }
    assert!((end - 1.0).abs() < 1e-7);
}

#[test]
fn lengths_match_quadrature() {
    let mut state = 1u64;
    let mut roll = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 40) as f64 / 16_777_216.0 - 0.5
    };
    for i in 0..2000 {
        let small = 10f64.powi(-(i % 9));
        let a: [f64; 3] = std::array::from_fn(|_| roll());
        let c: [f64; 3] = std::array::from_fn(|_| roll());
        let share = roll() * 6.0;
        let b = std::array::from_fn(|k| a[k] + share * (c[k] - a[k]) + small * roll());
        let segments = [Quadratic { a, b, c }];
        let table = prepare(&segments);
        let truth = reference::curve::closest([0.0; 3], &segments).map_or(0.0, |r| r.curve_length);
        assert!((table.length - truth).abs() <= 2e-8 * truth, "{i}: {} {truth}", table.length);
    }
}

#[test]
fn frames_are_perpendicular_and_carried() {
    // A corner, a cusp and a gap in one curve.
    let mut segments = curve(&[[0.0; 3], [1.0, 0.0, 0.2], [1.0, 1.0, 0.0], [1.0, 1.0, 2.0], [0.0, 1.0, 2.0]]);
    segments.extend(curve(&[[5.0; 3], [9.0, 5.0, 5.0], [6.0, 5.0, 5.0]]));
    for piece in prepare(&segments).pieces {
        let wide = |v: [f32; 3]| v.map(f64::from);
        let (t, u, v) = (wide(piece.tangent), wide(piece.normal), wide(piece.binormal));
        for (a, b, truth) in [(t, t, 1.0), (u, u, 1.0), (v, v, 1.0), (t, u, 0.0), (u, v, 0.0), (t, v, 0.0)] {
            assert!((dot(a, b) - truth).abs() < 2e-7);
        }
    }
}

#[test]
fn degenerate_input_never_panics() {
    assert!(prepare(&[]).pieces.is_empty());
    let odd = [0.0, 1.0, -1.0, 1e-13, 1e-300, 1e30, f64::NAN, f64::INFINITY];
    for i in 0..4096usize {
        let pick = |k: usize| [odd[(i >> k) & 7], odd[(i >> (k + 2)) & 7], odd[(i >> (k + 3)) & 7]];
        let table = prepare(&[Quadratic { a: pick(0), b: pick(3), c: pick(6) }]);
        assert!(!table.pieces.is_empty() && table.length >= 0.0);
        assert!(table.words().iter().all(|w| w.is_finite()), "{:?}", table.segments);
    }
    let point = prepare(&curve(&[[2.0; 3], [2.0; 3], [2.0; 3]])).pieces[0];
    assert_eq!((point.tangent, point.t_span, point.b1), ([0.0, 0.0, 1.0], 0.0, [0.0; 3]));
}
