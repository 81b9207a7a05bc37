//! Closest points of a batch: pieces outside, lanes inside.
//!
//! Values are those of [`crate::math::curve::closest`] bit for bit (test
//! `closest_points_are_those_of_the_kernel`); the loops are turned around so that the lanes of the
//! search vectorise.

use super::{LANES, Operands, Out};
use crate::isa::{Isa, Kernel, kernel};
use crate::math::curve::{self, CurvePoint, Search, feet, nodes};
use vol_compiler::curve::{Node, Piece};
use vol_compiler::ops::MAX_RESULTS;

/// Points and searches of all lanes, one array per field.
struct Searches {
    point: [[f32; LANES]; 3],
    dist_sq: [f32; LANES],
    t: [f32; LANES],
    piece: [u32; LANES],
    left_at_last: [u32; LANES],
}

impl Searches {
    fn new(x: &Operands<'_>) -> Self {
        let mut point = [[0.0; LANES]; 3];
        let [px, py, pz] = &mut point;
        let lanes = px.iter_mut().zip(py).zip(pz).zip(x[0].iter().zip(x[1]).zip(x[2]));
        for (((px, py), pz), ((&x, &y), &z)) in lanes {
            [*px, *py, *pz] = curve::held_point([x, y, z]);
        }
        Self {
            point,
            dist_sq: [Search::START.dist_sq; LANES],
            t: [Search::START.t; LANES],
            piece: [Search::START.piece; LANES],
            left_at_last: [u32::from(Search::START.left_at_last); LANES],
        }
    }

    #[inline(always)]
    fn point(&self, lane: usize) -> [f32; 3] {
        [self.point[0][lane], self.point[1][lane], self.point[2][lane]]
    }
}

kernel! {
    /// Visits the next piece in the first `n` lanes.
    fn Visit<'a>((all, n, piece, index): (&'a mut Searches, usize, Piece, u32)) {
        for lane in 0..n.min(LANES) {
            let search = Search {
                dist_sq: all.dist_sq[lane],
                t: all.t[lane],
                piece: all.piece[lane],
                left_at_last: all.left_at_last[lane] != 0,
            };
            let next = search.visit(all.point(lane), &piece, index);
            all.dist_sq[lane] = next.dist_sq;
            all.t[lane] = next.t;
            all.piece[lane] = next.piece;
            all.left_at_last[lane] = u32::from(next.left_at_last);
        }
    }
}

/// Describes the foot in the first `n` lanes on one piece and keeps it where that piece won: of the results those in
/// `WANTED`, one bit each. Arrays of its own, so that the compiler need not fear that they overlap.
struct Describe<const WANTED: u8>;

impl<const WANTED: u8> Kernel for Describe<WANTED> {
    type Args<'a> = (&'a Searches, usize, Piece, u32, &'a mut [[f32; LANES]; MAX_RESULTS]);
    type Out = ();

    #[inline(always)]
    fn run((searches, n, piece, index, found): Self::Args<'_>) {
        for lane in 0..n.min(LANES) {
            let values = values(&curve::describe(searches.point(lane), &piece, searches.t[lane]));
            let won = searches.piece[lane] == index;
            for (result, (found, value)) in found.iter_mut().zip(values).enumerate() {
                if WANTED >> result & 1 == 1 {
                    found[lane] = if won { value } else { found[lane] };
                }
            }
        }
    }
}

/// The results that most regions need: t, distance, overshoot.
const WALL: u8 = 1 << 0 | 1 << 5 | 1 << 6;

/// All but the arc length, which takes a logarithm.
const WITHOUT_LENGTH: u8 = !(1 << 1);

/// In the order of the operation's results.
#[inline(always)]
fn values(found: &CurvePoint) -> [f32; MAX_RESULTS] {
    let CurvePoint { t, arc_length, curve_length, x, y, distance, overshoot, stretch } = *found;
    [t, arc_length, curve_length, x, y, distance, overshoot, stretch]
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

kernel! {
    /// Lowers them to what has been found.
    fn Lower<'a>((reaches, searches, n): (&'a mut Reaches, &'a Searches, usize)) {
        for lane in 0..n.min(LANES) {
            let found = nodes::reach_of(searches.dist_sq[lane]);
            reaches.0[lane] = if found < reaches.0[lane] { found } else { reaches.0[lane] };
        }
    }
}

kernel! {
    /// In which lanes the winner may be in a capsule, and in how many: 0 or 1 each.
    fn Reach<'a>(
        (reaches, searches, n, node, near): (&'a Reaches, &'a Searches, usize, &'a Node, &'a mut [u32; LANES])
    ) -> usize {
        for (lane, near) in near.iter_mut().enumerate().take(n.min(LANES)) {
            *near = u32::from(nodes::may_hold(searches.point(lane), &node.capsule, reaches.0[lane]));
        }
        near.iter().sum::<u32>() as usize
    }
}

impl Searches {
    /// Visits the pieces of a leaf in the lanes that want it, side by side so that loops are as short as
    /// they are few.
    fn visit_leaf(
        &mut self,
        isa: Isa,
        n: usize,
        near: &[u32; LANES],
        few: &mut Self,
        pieces: &[Piece],
        first: u32,
    ) {
        let mut lanes = [0; LANES];
        let mut count = 0;
        for lane in (0..n.min(LANES)).filter(|&lane| near[lane] != 0) {
            few.copy(count, self, lane);
            lanes[count] = lane;
            count += 1;
        }
        for (index, piece) in (first..).zip(pieces) {
            isa.run::<Visit>((few, count, *piece, index));
        }
        for (at, &lane) in lanes[..count].iter().enumerate() {
            self.copy(lane, few, at);
        }
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

/// [`nodes::search`] in each lane: a capsule is entered if some lane wants it, but its pieces are visited in those lanes only.
fn search(isa: Isa, x: &Operands<'_>, (pieces, nodes): (&[Piece], &[Node])) -> Searches {
    let n = x[0].len().min(LANES);
    let mut searches = Searches::new(x);
    // Visit the pieces along the curve.
    if nodes.is_empty() {
        for (index, piece) in (0u32..).zip(pieces) {
            isa.run::<Visit>((&mut searches, n, *piece, index));
        }
        return searches;
    }
    // Pass over capsules that are farther than a foot.
    let mut reaches = Reaches::new(&searches, n, nodes);
    let (mut few, mut near, mut at) = (Searches::new(x), [0; LANES], 0);
    while at < nodes.len() {
        let node = &nodes[at];
        if isa.run::<Reach>((&reaches, &searches, n, node, &mut near)) == 0 {
            at = node.skip as usize;
            continue;
        }
        if node.skip as usize == at + 1 {
            let leaf = &pieces[node.first as usize..node.end as usize];
            searches.visit_leaf(isa, n, &near, &mut few, leaf, node.first);
            isa.run::<Lower>((&mut reaches, &searches, n));
        }
        at += 1;
    }
    searches
}

/// The pieces that won in some lane, unless there are so many that each lane is better described by itself.
fn winners(searches: &Searches, n: usize) -> Option<([u32; MOST_WINNERS], usize)> {
    let (mut all, mut count) = ([0; MOST_WINNERS], 0);
    for &piece in &searches.piece[..n] {
        if !all[..count].contains(&piece) {
            *all.get_mut(count)? = piece;
            count += 1;
        }
    }
    Some((all, count))
}

/// So many pieces are described in loops that vectorise.
const MOST_WINNERS: usize = 6;

/// [`curve::closest`] in each lane.
pub(super) fn closest(
    isa: Isa,
    x: &Operands<'_>,
    out: &mut Out,
    parts: (&[Piece], &[Node]),
    wanted: u8,
) -> usize {
    let (n, pieces) = (x[0].len().min(LANES), parts.0);
    let searches = search(isa, x, parts);
    // Describe the foot on the winner.
    if let Some((all, count)) = winners(&searches, n).filter(|_| !pieces.is_empty()) {
        let mut found = [[0.0; LANES]; MAX_RESULTS];
        for &index in &all[..count] {
            let args = (&searches, n, pieces[index as usize], index, &mut found);
            if wanted & !WALL == 0 {
                isa.run::<Describe<WALL>>(args);
            } else if wanted & !WITHOUT_LENGTH == 0 {
                isa.run::<Describe<WITHOUT_LENGTH>>(args);
            } else {
                isa.run::<Describe<{ u8::MAX }>>(args);
            }
        }
        for (out, found) in out.iter_mut().zip(&found) {
            out.0[..n].copy_from_slice(&found[..n]);
        }
        return MAX_RESULTS;
    }
    for lane in 0..n {
        let found = match pieces.get(searches.piece[lane] as usize) {
            Some(piece) => curve::describe(searches.point(lane), piece, searches.t[lane]),
            None => curve::closest(searches.point(lane), &[], &[]),
        };
        for (out, value) in out.iter_mut().zip(values(&found)) {
            out.0[lane] = value;
        }
    }
    MAX_RESULTS
}

/// [`curve::closest_gradient`] in each lane: asked for at hits only, so it may be slower.
pub(super) fn closest_gradient(
    isa: Isa,
    x: &Operands<'_>,
    out: &mut Out,
    parts: (&[Piece], &[Node]),
) -> usize {
    let (n, pieces) = (x[0].len().min(LANES), parts.0);
    let searches = search(isa, x, parts);
    for lane in 0..n {
        let found = match pieces.get(searches.piece[lane] as usize) {
            Some(piece) => curve::slopes(searches.point(lane), piece, searches.t[lane]),
            None => curve::closest_gradient(searches.point(lane), &[], &[]),
        };
        let ([dx, dy, dz], [tx, ty, tz]) = (found.direction, found.tangent);
        let values = [dx, dy, dz, tx, ty, tz, found.rate, found.slide];
        for (out, value) in out.iter_mut().zip(values) {
            out.0[lane] = value;
        }
    }
    MAX_RESULTS
}

/// [`feet::next_foot`] in each lane, by itself: how far each has to look differs.
pub(super) fn next_foot(x: &Operands<'_>, out: &mut Out, (pieces, nodes): (&[Piece], &[Node])) -> usize {
    for lane in 0..x[0].len().min(LANES) {
        let (point, ask) = ([x[0][lane], x[1][lane], x[2][lane]], [x[3][lane], x[4][lane], x[5][lane]]);
        let found = feet::next_foot(point, ask, pieces, nodes);
        let CurvePoint { t, arc_length, x, y, distance, overshoot, stretch, .. } = found.point;
        let values = [found.next, t, arc_length, x, y, distance, overshoot, stretch];
        for (out, value) in out.iter_mut().zip(values) {
            out.0[lane] = value;
        }
    }
    MAX_RESULTS
}
