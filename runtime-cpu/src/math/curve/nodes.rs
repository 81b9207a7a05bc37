//! Which pieces of a long curve need to be looked at, by its tree of boxes.
//!
//! In: a point and the nodes of `vol_compiler::curve::prepare`. Out: the same [`Search`] as from visiting
//! every piece, bit for bit: pieces are visited in the order of the curve, and one that is passed over
//! is in a box farther away than some foot is, so that it could not have won (test
//! `trees_change_nothing`).
//!
//! No twin: on the GPU an invocation knows how far the curve was from its last point, which is a better bound, and
//! compares the box of each piece with that (`vol_search` of `curve.wgsl`); the tree is not there. A walk that differs from point to point was tried;
//! software drivers took minutes to compile it.

use super::{Search, foot};
use crate::math::fun::greater;
use vol_compiler::curve::{Node, Piece};

/// By how much a squared distance to a foot is taken larger before boxes are compared with it: more
/// than the kernels are off. What they are off near the curve is in the boxes.
const LOOSE: f32 = 1.000_01;

/// Squared distance from a point to the box of a node, scene units squared; 0 inside.
#[inline(always)]
pub fn box_dist_sq(p: [f32; 3], node: &Node) -> f32 {
    let x = greater(greater(node.lo[0] - p[0], p[0] - node.hi[0]), 0.0);
    let y = greater(greater(node.lo[1] - p[1], p[1] - node.hi[1]), 0.0);
    let z = greater(greater(node.lo[2] - p[2], p[2] - node.hi[2]), 0.0);
    ((x * x) + (y * y)) + (z * z)
}

/// A squared distance within which the winner lies, given that to some foot.
#[inline(always)]
pub fn bound_of(dist_sq: f32) -> f32 {
    dist_sq * LOOSE
}

/// The leaf that is found by always entering the nearer half, the first of equals.
#[inline(always)]
pub fn likely_leaf(p: [f32; 3], nodes: &[Node]) -> usize {
    let mut at = 0;
    while nodes[at].skip as usize != at + 1 {
        let (front, back) = (at + 1, nodes[at + 1].skip as usize);
        at = if box_dist_sq(p, &nodes[back]) < box_dist_sq(p, &nodes[front]) { back } else { front };
    }
    at
}

/// Squared distance to the nearest foot on the pieces of a node.
#[inline(always)]
pub fn nearest_in(p: [f32; 3], pieces: &[Piece], node: &Node) -> f32 {
    let mut nearest = f32::MAX;
    for piece in &pieces[node.first as usize..node.end as usize] {
        let found = foot(p, piece);
        nearest = if found.dist_sq < nearest { found.dist_sq } else { nearest };
    }
    nearest
}

/// The closest point of a curve, from [`super::held_point`].
#[inline(always)]
pub fn search(p: [f32; 3], pieces: &[Piece], nodes: &[Node]) -> Search {
    let mut search = Search::START;
    // Visit the pieces along the curve.
    if nodes.is_empty() {
        for (index, piece) in (0u32..).zip(pieces) {
            search = search.visit(p, piece, index);
        }
        return search;
    }
    // Pass over boxes that are farther than a foot.
    let mut bound = bound_of(nearest_in(p, pieces, &nodes[likely_leaf(p, nodes)]));
    let mut at = 0;
    while at < nodes.len() {
        let node = &nodes[at];
        if box_dist_sq(p, node) > bound {
            at = node.skip as usize;
            continue;
        }
        if node.skip as usize == at + 1 {
            for index in node.first..node.end {
                search = search.visit(p, &pieces[index as usize], index);
            }
            let nearer = bound_of(search.dist_sq);
            bound = if nearer < bound { nearer } else { bound };
        }
        at += 1;
    }
    search
}
