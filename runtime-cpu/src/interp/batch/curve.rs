//! Closest points of a batch: pieces outside, lanes inside; of long curves only the pieces that may be nearest ([`tree`]).
//!
//! Values are those of [`crate::math::curve::closest`] bit for bit (test
//! `closest_points_are_those_of_the_kernel`); the loops are turned around so that the lanes of the
//! search vectorise.

mod own;
mod tree;

use super::{LANES, Operands, Out};
use crate::isa::{Isa, Kernel, kernel};
use crate::math::curve::{self, CurvePoint, Search, feet};
use own::Described;
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
    /// Nothing visited, all points 0.
    fn start() -> Self {
        Self {
            point: [[0.0; LANES]; 3],
            dist_sq: [Search::START.dist_sq; LANES],
            t: [Search::START.t; LANES],
            piece: [Search::START.piece; LANES],
            left_at_last: [u32::from(Search::START.left_at_last); LANES],
        }
    }

    fn new(x: &Operands<'_>) -> Self {
        let mut all = Self::start();
        let [px, py, pz] = &mut all.point;
        let lanes = px.iter_mut().zip(py).zip(pz).zip(x[0].iter().zip(x[1]).zip(x[2]));
        for (((px, py), pz), ((&x, &y), &z)) in lanes {
            [*px, *py, *pz] = curve::held_point([x, y, z]);
        }
        all
    }

    #[inline(always)]
    fn point(&self, lane: usize) -> [f32; 3] {
        [self.point[0][lane], self.point[1][lane], self.point[2][lane]]
    }

    #[inline(always)]
    fn search(&self, lane: usize) -> Search {
        Search {
            dist_sq: self.dist_sq[lane],
            t: self.t[lane],
            piece: self.piece[lane],
            left_at_last: self.left_at_last[lane] != 0,
        }
    }

    #[inline(always)]
    fn keep(&mut self, lane: usize, search: Search) {
        self.dist_sq[lane] = search.dist_sq;
        self.t[lane] = search.t;
        self.piece[lane] = search.piece;
        self.left_at_last[lane] = u32::from(search.left_at_last);
    }
}

kernel! {
    /// Visits the next piece in the first `n` lanes.
    fn Visit<'a>((all, n, piece, index): (&'a mut Searches, usize, Piece, u32)) {
        for lane in 0..n.min(LANES) {
            let next = all.search(lane).visit(all.point(lane), &piece, index);
            all.keep(lane, next);
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

/// Describes the foot in the first `n` lanes, each on a piece of its own: of the results those in `WANTED`.
struct DescribeOwn<const WANTED: u8>;

impl<const WANTED: u8> Kernel for DescribeOwn<WANTED> {
    type Args<'a> = (&'a Searches, usize, &'a Described, &'a mut [[f32; LANES]; MAX_RESULTS]);
    type Out = ();

    #[inline(always)]
    fn run((searches, n, own, found): Self::Args<'_>) {
        for lane in 0..n.min(LANES) {
            let values = values(&curve::describe(searches.point(lane), &own.piece(lane), searches.t[lane]));
            for (result, (found, value)) in found.iter_mut().zip(values).enumerate() {
                if WANTED >> result & 1 == 1 {
                    found[lane] = value;
                }
            }
        }
    }
}

/// [`nodes::search`](crate::math::curve::nodes::search) in each lane.
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
    tree::search(isa, &mut searches, n, pieces, nodes);
    searches
}

/// The pieces that won in some lane, unless there are so many that each lane is better given one of its own.
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
    let mut found = [[0.0; LANES]; MAX_RESULTS];
    if pieces.is_empty() {
        let nowhere = values(&curve::closest([0.0; 3], &[], &[]));
        found.iter_mut().zip(nowhere).for_each(|(found, value)| found.fill(value));
    } else if let Some((all, count)) = winners(&searches, n) {
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
    } else {
        let mut own = Described::new();
        (0..n).for_each(|lane| own.set(lane, pieces, searches.piece[lane]));
        let args = (&searches, n, &own, &mut found);
        if wanted & !WALL == 0 {
            isa.run::<DescribeOwn<WALL>>(args);
        } else if wanted & !WITHOUT_LENGTH == 0 {
            isa.run::<DescribeOwn<WITHOUT_LENGTH>>(args);
        } else {
            isa.run::<DescribeOwn<{ u8::MAX }>>(args);
        }
    }
    for (out, found) in out.iter_mut().zip(&found) {
        out.0[..n].copy_from_slice(&found[..n]);
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
