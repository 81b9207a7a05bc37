//! All feet of a point on a curve, one after the other: the local minima of the distance along it.
//!
//! In: a point, the pieces, from which foot on and how far feet may be. Out: the next foot. Feet are
//! numbered along the curve, three to a piece: where the curve enters the piece, inside it, and where it
//! leaves it at an end of the curve or before a gap. A foot where two pieces touch is that of the piece
//! after.
//!
//! A joint is a foot if the point is not approached any more behind it and was approached before it; a
//! piece has a foot inside if the point is approached at its start and left at its end. Both ask the same
//! words about the same joint (`vol_compiler::curve::Piece`), so that a foot beside a joint is counted
//! once, however it is rounded. Source: `algorithms.md` §3.1.
//!
//! Twin: `compiler/src/wgsl/feet.wgsl`, where every point looks at all pieces.

use super::{CurvePoint, NOWHERE, describe, dot, end_from_point, from_point, held_point, inner, nodes};
use vol_compiler::curve::{Capsule, Node, Piece};

/// Feet that a piece may have.
const FEET: u32 = 3;

/// A foot and where to look for the next.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NextFoot {
    /// Number after that of the foot; a whole number.
    pub next: f32,
    /// The point seen from it; without, 1e18 units away with everything else 0, stretch 1.
    pub point: CurvePoint,
}

/// Where a piece has feet: parameters in the order of the curve, -1 for none.
#[inline(always)]
pub fn feet_of(p: [f32; 3], piece: &Piece, closed: bool) -> [f32; 3] {
    // How the distance grows along the curve at both ends of the piece.
    let (w, w_end) = (from_point(p, piece), end_from_point(p, piece));
    let (at_start, at_end) = (dot(w, piece.tangent), dot(w_end, piece.end_tangent));
    let forward = piece.sense > 0.0;
    let entering = if forward { at_start } else { at_end };
    let leaving = if forward { at_end } else { at_start };
    let before = dot(if forward { w } else { w_end }, piece.tangent_before);
    // The joint at its start, and the end of the curve.
    let joined_before = (piece.before == 1.0) | (closed & (piece.before == 0.0));
    let joined_after = (piece.after == 1.0) | (closed & (piece.after == 0.0));
    let is_point = piece.t_span == 0.0;
    let enters = is_point | ((entering >= 0.0) & (!joined_before | (before <= 0.0)));
    let leaves = !is_point & !joined_after & (leaving <= 0.0);
    // Inside.
    let found = inner(p, piece);
    let approached = piece.sense * at_start < 0.0;
    let left = piece.sense * at_end > 0.0;
    let inside = !is_point & left & (approached | found.dips);
    let (first, last) = if forward { (0.0, 1.0) } else { (1.0, 0.0) };
    [if enters { first } else { -1.0 }, if inside { found.t } else { -1.0 }, if leaves { last } else { -1.0 }]
}

/// The first foot whose number is at least `start` and whose distance is at most `most`.
///
/// * `start`: a whole number, 0 or what the last call said; `most`: scene units, at most 1e15
/// * `closed`: whether the end of the curve is joined to its start
/// * error: that of [`super::closest`] for the coordinates of a foot; whether there is one is sure
///   where the point is farther than rounding from the surface at distance `most` and from focal lines
///   (test `feet_agree_with_f64`)
pub fn next_foot(
    point: [f32; 3],
    [start, most, closed]: [f32; 3],
    pieces: &[Piece],
    nodes: &[Node],
) -> NextFoot {
    let p = held_point(point);
    let reach = nodes::reach_of(most * most);
    let (from, closed) = (start as u32, closed != 0.0);
    let nothing = Capsule { start: [0.0; 3], along: [0.0; 3], per_length_sq: 0.0, radius: 0.0 };
    let whole = Node { capsule: nothing, skip: 1, first: 0, end: pieces.len() as u32 };
    let few = nodes.is_empty();
    let nodes = if few { std::slice::from_ref(&whole) } else { nodes };
    // Pass over capsules that are too far or behind.
    let mut at = 0;
    while at < nodes.len() {
        let node = &nodes[at];
        if (!few & !nodes::may_hold(p, &node.capsule, reach)) | (node.end * FEET <= from) {
            at = node.skip as usize;
            continue;
        }
        if node.skip as usize == at + 1 {
            // Describe the first foot that is near enough.
            for index in node.first..node.end {
                let piece = &pieces[index as usize];
                for (kind, t) in (0..FEET).zip(feet_of(p, piece, closed)) {
                    let number = (index * FEET) + kind;
                    if (t < 0.0) | (number < from) {
                        continue;
                    }
                    let described = describe(p, piece, t);
                    if described.distance <= most {
                        return NextFoot { next: (number + 1) as f32, point: described };
                    }
                }
            }
        }
        at += 1;
    }
    NextFoot { next: start, point: CurvePoint { x: 0.0, ..NOWHERE } }
}
