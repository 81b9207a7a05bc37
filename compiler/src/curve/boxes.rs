//! A tree of boxes over the pieces of a long curve, so that most pieces need not be looked at.
//!
//! In: the pieces in the order of the curve. Out: [`Node`]s in the order of a walk that enters every box,
//! first halves first: a node's first child is the next node, and `skip` is where the walk goes on if
//! the box is passed over. So a walk needs no stack, and meets the pieces in the order of the curve.
//!
//! Boxes hold their pieces with some room for the rounding of the kernels (`ROOM`), so that a point
//! which is farther from a box than from some foot is farther from every piece in it, too, whatever the
//! kernels make of its distance. Example: 40 pieces in a row become a root, 2 halves, 4 quarters …, and
//! leaves of at most [`LEAF`] pieces.

use super::Piece;

/// Curves of at most so many pieces have no tree: all pieces are looked at.
pub const FEW_PIECES: usize = 16;

/// Most pieces in a leaf.
const LEAF: usize = 4;

/// How much larger a box is than its pieces, as a share of the length of their control polygons; the
/// distance of the kernels is off by at most 4e-7 of that.
const ROOM: f64 = 4e-6;

/// A box around consecutive pieces.
///
/// It is a leaf if `skip` is the next node.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Node {
    /// Smallest corner, scene units.
    pub lo: [f32; 3],
    /// Largest corner, scene units.
    pub hi: [f32; 3],
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

/// Appends the tree over pieces whose first has the number `first`; returns the place of its root.
fn append(pieces: &[Piece], first: usize, nodes: &mut Vec<Node>) -> usize {
    let root = nodes.len();
    let end = (first + pieces.len()) as u32;
    nodes.push(Node { lo: [0.0; 3], hi: [0.0; 3], skip: 0, first: first as u32, end });
    let (lo, hi) = if pieces.len() <= LEAF {
        pieces.iter().map(|piece| (piece.lo, piece.hi)).reduce(joined).expect("a leaf has pieces")
    } else {
        let (front, back) = pieces.split_at(pieces.len() / 2);
        let children = [append(front, first, nodes), append(back, first + front.len(), nodes)];
        let [front, back] = children.map(|child| (nodes[child].lo, nodes[child].hi));
        joined(front, back)
    };
    let skip = nodes.len() as u32;
    nodes[root] = Node { lo, hi, skip, ..nodes[root] };
    root
}

type Corners = ([f32; 3], [f32; 3]);

fn joined(a: Corners, b: Corners) -> Corners {
    (std::array::from_fn(|i| a.0[i].min(b.0[i])), std::array::from_fn(|i| a.1[i].max(b.1[i])))
}

/// The box of a piece's control points, which contains it, with room.
pub(super) fn around(piece: &Piece) -> Corners {
    let wide = |v: [f32; 3]| v.map(f64::from);
    let (origin, low, b1, b2) = (wide(piece.origin), wide(piece.origin_low), wide(piece.b1), wide(piece.b2));
    let legs = super::norm(b1) + super::norm(super::along(b1, 1.0, b2));
    let points: [[f64; 3]; 3] = [[0.0; 3], b1, std::array::from_fn(|i| 2.0 * b1[i] + b2[i])];
    let bound = |i: usize, side: f64| {
        let at = |p: &[f64; 3]| side * (origin[i] + low[i] + p[i]);
        side * (points.iter().map(at).fold(f64::NEG_INFINITY, f64::max) + ROOM * legs)
    };
    let down = std::array::from_fn(|i| (bound(i, -1.0) as f32).next_down());
    (down, std::array::from_fn(|i| (bound(i, 1.0) as f32).next_up()))
}
