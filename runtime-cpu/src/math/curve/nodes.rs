//! Which pieces of a long curve need to be looked at, by its tree of capsules.
//!
//! In: a point and the nodes of `vol_compiler::curve::prepare`. Out: the same [`Search`] as from visiting
//! every piece, bit for bit: pieces are visited in the order of the curve, and one that is passed over
//! is in a capsule farther away than some foot is, so that it could not have won (test
//! `trees_change_nothing`).
//!
//! No twin: on the GPU an invocation knows how far the curve was from its last point, which is a better bound, and
//! compares the box of each piece with that (`vol_search` of `curve.wgsl`); the tree is not there. A walk that differs from point to point was tried;
//! software drivers took minutes to compile it.

use super::{Search, dot};
use crate::math::fun::hold;
use vol_compiler::curve::{Capsule, Node, Piece};

/// By how much a distance to a foot is taken larger before capsules are compared with it: more
/// than the kernels are off. What they are off near the curve is in the capsules.
const LOOSE: f32 = 1.000_005;

/// Squared distance from a point to the line of a capsule, scene units squared.
#[inline(always)]
pub fn line_dist_sq(p: [f32; 3], capsule: &Capsule) -> f32 {
    let Capsule { start, along, per_length_sq, .. } = capsule;
    let way = [p[0] - start[0], p[1] - start[1], p[2] - start[2]];
    let part = hold(dot(way, *along) * per_length_sq, 0.0, 1.0);
    let off = [way[0] - (part * along[0]), way[1] - (part * along[1]), way[2] - (part * along[2])];
    dot(off, off)
}

/// Whether something in a capsule may be within `reach` of a point, [`reach_of`] the foot that is known.
#[inline(always)]
pub fn may_hold(p: [f32; 3], capsule: &Capsule, reach: f32) -> bool {
    let far = reach + capsule.radius;
    line_dist_sq(p, capsule) <= far * far
}

/// A distance within which the winner lies, given the square of that to some foot.
#[inline(always)]
pub fn reach_of(dist_sq: f32) -> f32 {
    dist_sq.sqrt() * LOOSE
}

/// A distance within which something in a leaf is: part of the piece is beside each point of the line.
#[inline(always)]
pub fn reach_into(p: [f32; 3], leaf: &Capsule) -> f32 {
    (line_dist_sq(p, leaf).sqrt() + leaf.radius) * LOOSE
}

fn is_leaf(nodes: &[Node], at: usize) -> bool {
    nodes[at].skip as usize == at + 1
}

/// The leaf that is found by always entering the nearer half, the first of equals.
pub fn likely_leaf(p: [f32; 3], nodes: &[Node]) -> usize {
    let mut at = 0;
    while !is_leaf(nodes, at) {
        let (front, back) = (at + 1, nodes[at + 1].skip as usize);
        let [before, after] = [front, back].map(|node| line_dist_sq(p, &nodes[node].capsule));
        at = if after < before { back } else { front };
    }
    at
}

/// So many leaves farther along the curve the tree knows better.
const FAR_ALONG: usize = 8;

/// The leaf that is found from one by going along the curve, either way, as long as it comes nearer; [`likely_leaf`] if that is
/// far.
pub fn nearer_leaf(p: [f32; 3], nodes: &[Node], start: usize) -> usize {
    let distance = |at: usize| line_dist_sq(p, &nodes[at].capsule);
    let (mut at, mut best) = (start, distance(start));
    for forward in [true, false] {
        for _ in 0..FAR_ALONG {
            let next = if forward {
                (at + 1..nodes.len()).find(|&next| is_leaf(nodes, next))
            } else {
                (0..at).rev().find(|&next| is_leaf(nodes, next))
            };
            match next.map(|next| (next, distance(next))) {
                Some((next, found)) if found < best => (at, best) = (next, found),
                // Turn around only where it began.
                _ if at == start => break,
                _ => return at,
            }
        }
        if at != start {
            return likely_leaf(p, nodes);
        }
    }
    at
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
    // Pass over capsules that are farther than a foot.
    let mut reach = reach_into(p, &nodes[likely_leaf(p, nodes)].capsule);
    let mut at = 0;
    while at < nodes.len() {
        let node = &nodes[at];
        if !may_hold(p, &node.capsule, reach) {
            at = node.skip as usize;
            continue;
        }
        if node.skip as usize == at + 1 {
            for index in node.first..node.end {
                search = search.visit(p, &pieces[index as usize], index);
            }
            let nearer = reach_of(search.dist_sq);
            reach = if nearer < reach { nearer } else { reach };
        }
        at += 1;
    }
    search
}
