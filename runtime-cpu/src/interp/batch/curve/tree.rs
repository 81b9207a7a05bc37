//! The pieces of a long curve that may be nearest, by its tree of capsules; visited in the lanes that want them.
//!
//! ```text
//! reaches      how far each lane has to look: to the leaf that it is likely to be near
//! groups       sixteen lanes, which are neighbours, walk through the tree together and find leaves
//! visits       leaves that many lanes of a group want in all of these at once; others wait until every lane
//!              has some, and then each lane visits one of its own at a time
//! ```
//!
//! In each lane the pieces are visited in the order of the curve.

use super::own::Solved;
use super::{LANES, Searches};
use crate::isa::{Isa, kernel};
use crate::math::curve::{self, nodes};
use std::ops::Range;
use vol_compiler::curve::{Node, Piece};

/// [`nodes::search`] in the first `n` lanes.
pub(super) fn search(isa: Isa, searches: &mut Searches, n: usize, pieces: &[Piece], nodes: &[Node]) {
    // Pass over capsules that are farther than a foot.
    let reaches = Reaches::new(searches, n, nodes);
    let mut room = Room { few: Searches::start(), own: Solved::new() };
    let mut waiting = Waiting { pieces: [[0; MOST_WAITING]; LANES], counts: [0; LANES] };
    let mut leaves = [Leaf { piece: 0, near: 0 }; MOST_LEAVES];
    for start in (0..n).step_by(GROUP) {
        let lanes = start..n.min(start + GROUP);
        let group = Group::new(searches, &reaches, &lanes);
        let mut at = 0;
        while at < nodes.len() {
            let (count, end) = isa.run::<Walk>((&group, nodes, at, &mut leaves));
            at = end;
            let leaves = &leaves[..count];
            let wanted: u32 = leaves.iter().map(|leaf| leaf.near.count_ones()).sum();
            if wanted >= SHARED * count as u32 {
                // Pieces are visited in the order of the curve.
                if waiting.is_any_in(lanes.clone()) {
                    searches.visit_waiting(isa, &mut waiting, pieces, &mut room);
                }
                for &leaf in leaves {
                    isa.run::<VisitShared>((searches, start, leaf, pieces[leaf.piece as usize]));
                }
                continue;
            }
            for &leaf in leaves {
                if !waiting.add(start, leaf) {
                    searches.visit_waiting(isa, &mut waiting, pieces, &mut room);
                }
            }
        }
    }
    searches.visit_waiting(isa, &mut waiting, pieces, &mut room);
}

/// Distances to the winners are at most these, in each lane.
struct Reaches([f32; LANES]);

/// After so many points the leaf near one is looked for in the tree again, not beside the one before: rays end.
const NEIGHBOURS: usize = 16;

impl Reaches {
    /// From the leaf that each point is likely to be near: that of its neighbour, or not far along the curve from there.
    fn new(searches: &Searches, n: usize, nodes: &[Node]) -> Self {
        let mut reaches = Self([f32::MAX; LANES]);
        let mut leaf = 0;
        for lane in 0..n.min(LANES) {
            let p = searches.point(lane);
            leaf = if lane % NEIGHBOURS == 0 {
                nodes::likely_leaf(p, nodes)
            } else {
                nodes::nearer_leaf(p, nodes, leaf)
            };
            reaches.0[lane] = nodes::reach_into(p, &nodes[leaf].capsule);
        }
        reaches
    }
}

/// Points that walk through the tree together: one vector, of neighbours.
const GROUP: usize = 16;

/// What the tree is asked about a group of lanes, one array per word.
struct Group {
    point: [[f32; GROUP]; 3],
    reach: [f32; GROUP],
}

impl Group {
    /// Lanes from one on; those that are none are where no curve is.
    fn new(searches: &Searches, reaches: &Reaches, lanes: &Range<usize>) -> Self {
        let mut group = Self { point: [[curve::FAR; GROUP]; 3], reach: [0.0; GROUP] };
        for (to, from) in group.point.iter_mut().zip(&searches.point) {
            to[..lanes.len()].copy_from_slice(&from[lanes.clone()]);
        }
        group.reach[..lanes.len()].copy_from_slice(&reaches.0[lanes.clone()]);
        group
    }
}

/// A piece that may win in some lanes of a group, one bit each.
#[derive(Clone, Copy)]
struct Leaf {
    piece: u32,
    near: u32,
}

/// Most leaves that are found before they are visited.
const MOST_LEAVES: usize = 32;

/// Leaves that are wanted by so many lanes on the average are visited in all lanes of the group: a vector takes as long as
/// so many pieces that are brought to their lanes.
const SHARED: u32 = 6;

kernel! {
    /// Walks a group through the tree from node `at` on and finds leaves that may hold the winner, as many as there is room
    /// for. How many there are, and the node where it ends.
    fn Walk<'a>(
        (group, nodes, at, leaves): (&'a Group, &'a [Node], usize, &'a mut [Leaf; MOST_LEAVES])
    ) -> (usize, usize) {
        let (mut at, mut count) = (at, 0);
        let [x, y, z] = &group.point;
        while let Some(node) = nodes.get(at) {
            let mut near = 0;
            for i in 0..GROUP {
                near |= u32::from(nodes::may_hold([x[i], y[i], z[i]], &node.capsule, group.reach[i])) << i;
            }
            let is_leaf = node.skip as usize == at + 1;
            at = if near == 0 { node.skip as usize } else { at + 1 };
            if (near != 0) & is_leaf {
                leaves[count] = Leaf { piece: node.first, near };
                count += 1;
                if count == MOST_LEAVES {
                    break;
                }
            }
        }
        (count, at)
    }
}

kernel! {
    /// Visits a piece in those lanes of a group that may have the winner there.
    fn VisitShared<'a>((all, start, leaf, piece): (&'a mut Searches, usize, Leaf, Piece)) {
        // So that the compiler knows that all are there.
        let start = start.min(LANES - GROUP);
        for i in 0..GROUP {
            let lane = start + i;
            let search = all.search(lane);
            let next = search.visit(all.point(lane), &piece, leaf.piece);
            all.keep(lane, if leaf.near >> i & 1 == 1 { next } else { search });
        }
    }
}

kernel! {
    /// Visits a piece of its own in each of the first `n` lanes.
    fn VisitOwn<'a>((all, n, own): (&'a mut Searches, usize, &'a Solved)) {
        for lane in 0..n.min(LANES) {
            let next = all.search(lane).visit(all.point(lane), &own.piece(lane), own.index[lane]);
            all.keep(lane, next);
        }
    }
}

/// Most pieces that wait in a lane.
const MOST_WAITING: usize = 8;

/// Pieces that are to be visited, in the order of the curve in each lane.
struct Waiting {
    pieces: [[u32; MOST_WAITING]; LANES],
    counts: [usize; LANES],
}

impl Waiting {
    /// Adds a piece to those lanes of a group that want it; whether there is room for another in all of them.
    fn add(&mut self, start: usize, leaf: Leaf) -> bool {
        let (mut near, mut has_room) = (leaf.near, true);
        while near != 0 {
            let lane = start + near.trailing_zeros() as usize;
            near &= near - 1;
            let count = &mut self.counts[lane];
            self.pieces[lane][*count] = leaf.piece;
            *count += 1;
            has_room &= *count < MOST_WAITING;
        }
        has_room
    }

    /// Whether any waits in some lanes.
    fn is_any_in(&self, lanes: Range<usize>) -> bool {
        self.counts[lanes].iter().any(|&count| count > 0)
    }

    /// Those lanes in which pieces wait, with the most first, and how many lanes have more than 0, 1, 2 … of them.
    fn order(&self) -> ([usize; LANES], [usize; MOST_WAITING]) {
        let mut more_than = [0; MOST_WAITING];
        for &count in &self.counts {
            more_than[..count].iter_mut().for_each(|lanes| *lanes += 1);
        }
        // The first place of the lanes with so many: after those with more.
        let mut next = [0; MOST_WAITING + 1];
        next[..MOST_WAITING].copy_from_slice(&more_than);
        let mut lanes = [0; LANES];
        for (lane, &count) in self.counts.iter().enumerate().filter(|&(_, &count)| count > 0) {
            lanes[next[count]] = lane;
            next[count] += 1;
        }
        (lanes, more_than)
    }
}

/// Room to visit pieces in.
struct Room {
    few: Searches,
    own: Solved,
}

impl Searches {
    /// Visits the pieces that wait. In each round every lane has one of its own, so that loops are long although no two
    /// lanes need ask for the same piece.
    fn visit_waiting(&mut self, isa: Isa, waiting: &mut Waiting, pieces: &[Piece], room: &mut Room) {
        let Room { few, own } = room;
        let (lanes, more_than) = waiting.order();
        let lanes = &lanes[..more_than[0]];
        for (at, &lane) in lanes.iter().enumerate() {
            few.copy(at, self, lane);
        }
        for (round, &count) in more_than.iter().enumerate().take_while(|&(_, &count)| count > 0) {
            for (at, &lane) in lanes[..count].iter().enumerate() {
                own.set(at, pieces, waiting.pieces[lane][round]);
            }
            isa.run::<VisitOwn>((few, count, own));
        }
        for (at, &lane) in lanes.iter().enumerate() {
            self.copy(lane, few, at);
        }
        waiting.counts = [0; LANES];
    }

    /// Takes over a lane of others.
    fn copy(&mut self, to: usize, from: &Self, lane: usize) {
        for (to_axis, from_axis) in self.point.iter_mut().zip(&from.point) {
            to_axis[to] = from_axis[lane];
        }
        self.dist_sq[to] = from.dist_sq[lane];
        self.t[to] = from.t[lane];
        self.piece[to] = from.piece[lane];
        self.left_at_last[to] = from.left_at_last[lane];
    }
}
