//! Where the pieces of a curve are, so that most need not be looked at: a tree of capsules around those of a long curve, and
//! a box around each for devices that have no tree.
//!
//! In: the pieces in the order of the curve. Out: [`Node`]s in the order of a walk that enters every capsule,
//! first halves first: a node's first child is the next node, and `skip` is where the walk goes on if
//! the capsule is passed over. So a walk needs no stack, and meets the pieces in the order of the curve.
//!
//! Capsules hold their pieces with some room for the rounding of the kernels (`ROOM`), so that a point
//! which is farther from a capsule than from some foot is farther from every piece in it, too, whatever the
//! kernels make of its distance. Example: 40 pieces in a row become a root, 2 halves, 4 quarters …, and
//! 40 leaves.
//!
//! Boxes along the axes were tried before: around a short part of a curve that goes across the axes a box is as thick as it
//! is long, a capsule a hundredth of that, and a point beside the curve is as near to many such boxes as to its foot. For the few
//! pieces of one curve by themselves boxes are better: they take a twentieth less time on software Vulkan.

use super::{Piece, along, dot, norm, sub};

/// Curves of at most so many pieces have no tree: all pieces are looked at.
pub const FEW_PIECES: usize = 16;

/// How much larger a capsule is than its pieces, as a share of their length; distances to the pieces and to the capsule are
/// off by at most a fifth of that.
const ROOM: f64 = 4e-6;

/// A line whose length squared is less counts as a point, scene units squared: the quotient stays finite.
const SHORTEST_SQ: f64 = 1e-30;

/// All points within a distance of the line between two.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Capsule {
    /// One end of the line, scene units.
    pub start: [f32; 3],
    /// From there to the other end.
    pub along: [f32; 3],
    /// 1 over its length squared; 0 if it counts as a point.
    pub per_length_sq: f32,
    /// The distance, scene units.
    pub radius: f32,
}

/// A capsule around consecutive pieces.
///
/// It is a leaf, of one piece, if `skip` is the next node. A piece goes from one end of its capsule's line to the other, so
/// some of it is beside each point of the line, at most `radius` away.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Node {
    /// Where the pieces are.
    pub capsule: Capsule,
    /// Number of the node after this one's whole tree.
    pub skip: u32,
    /// Number of its first piece.
    pub first: u32,
    /// Number of the piece after its last.
    pub end: u32,
}

/// The tree over all pieces; none for a few.
pub(super) fn tree(pieces: &[Piece]) -> Vec<Node> {
    let mut nodes = Vec::new();
    if pieces.len() > FEW_PIECES {
        append(pieces, 0, &mut nodes);
    }
    nodes
}

/// Appends the tree over pieces whose first has the number `first`.
fn append(pieces: &[Piece], first: usize, nodes: &mut Vec<Node>) {
    let root = nodes.len();
    let end = (first + pieces.len()) as u32;
    nodes.push(Node { capsule: Capsule::around(pieces), skip: 0, first: first as u32, end });
    if pieces.len() > 1 {
        let (front, back) = pieces.split_at(pieces.len() / 2);
        append(front, first, nodes);
        append(back, first + front.len(), nodes);
    }
    nodes[root].skip = nodes.len() as u32;
}

impl Capsule {
    /// Around consecutive pieces, one at least; the line joins the ends of the curve that they are.
    pub(super) fn around(pieces: &[Piece]) -> Self {
        let hulls = pieces.iter().map(control_points);
        let [from, to] = [&pieces[0], &pieces[pieces.len() - 1]].map(|piece| {
            let [start, _, end] = control_points(piece);
            if piece.sense > 0.0 { [start, end] } else { [end, start] }
        });
        let start = from[0].map(|x| x as f32);
        let base = start.map(f64::from);
        let line = sub(to[1], base).map(|x| x as f32);
        let wide = line.map(f64::from);
        let square = dot(wide, wide);
        let per_length_sq = if square > SHORTEST_SQ { (1.0 / square) as f32 } else { 0.0 };
        // The distance to a line is convex: it is largest at a control point.
        let distance = |point: [f64; 3]| {
            let way = sub(point, base);
            let part = (dot(way, wide) * f64::from(per_length_sq)).clamp(0.0, 1.0);
            norm(along(way, -part, wide))
        };
        // What rounding moved the start by may be along the line.
        let moved = norm(sub(from[0], base));
        let radius = hulls.clone().flatten().map(distance).fold(moved, f64::max);
        let legs = hulls.map(|[a, b, c]| norm(sub(b, a)) + norm(sub(c, b))).fold(0.0, f64::max);
        let radius = ((radius + ROOM * (legs + square.sqrt())) as f32).next_up();
        Self { start, along: line, per_length_sq, radius }
    }
}

/// The box of a piece's control points, which contains it, with room: smallest and largest corner.
pub(super) fn around(piece: &Piece) -> ([f32; 3], [f32; 3]) {
    let points = control_points(piece);
    let room = ROOM * (norm(sub(points[1], points[0])) + norm(sub(points[2], points[1])));
    let bound = |i: usize, side: f64| {
        side * (points.iter().map(|point| side * point[i]).fold(f64::NEG_INFINITY, f64::max) + room)
    };
    let down = std::array::from_fn(|i| (bound(i, -1.0) as f32).next_down());
    (down, std::array::from_fn(|i| (bound(i, 1.0) as f32).next_up()))
}

/// Control points of a piece from its start to its end, scene units.
fn control_points(piece: &Piece) -> [[f64; 3]; 3] {
    let [origin, low, b1, b2] =
        [piece.origin, piece.origin_low, piece.b1, piece.b2].map(|vector| vector.map(f64::from));
    let start = along(origin, 1.0, low);
    [start, along(start, 1.0, b1), along(along(start, 2.0, b1), 1.0, b2)]
}
