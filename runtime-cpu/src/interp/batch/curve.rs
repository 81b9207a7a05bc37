//! Closest points of a batch: pieces outside, lanes inside.
//!
//! Values are those of [`crate::math::curve::closest`] bit for bit (test
//! `closest_points_are_those_of_the_kernel`); the loops are turned around so that the lanes of the
//! search vectorise.

use super::{LANES, Operands, Out};
use crate::math::curve::{self, CurvePoint, Search};
use vol_compiler::curve::Piece;
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

    /// Visits the next piece in the first `n` lanes. Out of line, so that the compiler sees nothing
    /// but the loop: inside the loop over pieces it does not vectorise.
    #[inline(never)]
    fn visit(&mut self, n: usize, piece: Piece, index: u32) {
        for lane in 0..n.min(LANES) {
            let search = Search {
                dist_sq: self.dist_sq[lane],
                t: self.t[lane],
                piece: self.piece[lane],
                left_at_last: self.left_at_last[lane] != 0,
            };
            let next = search.visit(self.point(lane), &piece, index);
            self.dist_sq[lane] = next.dist_sq;
            self.t[lane] = next.t;
            self.piece[lane] = next.piece;
            self.left_at_last[lane] = u32::from(next.left_at_last);
        }
    }
}

/// Curves of at most so many pieces are described on every piece in loops that vectorise; on longer
/// ones that is more work than each lane's own piece.
const FEW: usize = 4;

/// Describes the foot in the first `n` lanes on one piece and keeps it where that piece won. Out of
/// line and with arrays of its own for the same reason as [`Searches::visit`].
#[inline(never)]
fn describe(
    searches: &Searches,
    n: usize,
    piece: Piece,
    index: u32,
    found: &mut [[f32; LANES]; MAX_RESULTS],
) {
    for lane in 0..n.min(LANES) {
        let values = values(&curve::describe(searches.point(lane), &piece, searches.t[lane]));
        let won = searches.piece[lane] == index;
        for (found, value) in found.iter_mut().zip(values) {
            found[lane] = if won { value } else { found[lane] };
        }
    }
}

/// In the order of the operation's results.
#[inline(always)]
fn values(found: &CurvePoint) -> [f32; MAX_RESULTS] {
    let CurvePoint { t, arc_length, curve_length, x, y, distance, overshoot, stretch } = *found;
    [t, arc_length, curve_length, x, y, distance, overshoot, stretch]
}

/// [`curve::closest`] in each lane.
pub(super) fn closest(x: &Operands<'_>, out: &mut Out, pieces: &[Piece]) -> usize {
    let n = x[0].len().min(LANES);
    let mut searches = Searches::new(x);
    // Visit the pieces along the curve.
    for (index, piece) in (0u32..).zip(pieces) {
        searches.visit(n, *piece, index);
    }
    // Describe the foot on the winner.
    if (1..=FEW).contains(&pieces.len()) {
        let mut found = [[0.0; LANES]; MAX_RESULTS];
        for (index, piece) in (0u32..).zip(pieces) {
            describe(&searches, n, *piece, index, &mut found);
        }
        for (out, found) in out.iter_mut().zip(&found) {
            out.0[..n].copy_from_slice(&found[..n]);
        }
        return MAX_RESULTS;
    }
    for lane in 0..n {
        let found = match pieces.get(searches.piece[lane] as usize) {
            Some(piece) => curve::describe(searches.point(lane), piece, searches.t[lane]),
            None => curve::closest(searches.point(lane), &[]),
        };
        for (out, value) in out.iter_mut().zip(values(&found)) {
            out.0[lane] = value;
        }
    }
    MAX_RESULTS
}

/// [`curve::closest_gradient`] in each lane: asked for at hits only, so it may be slower.
pub(super) fn closest_gradient(x: &Operands<'_>, out: &mut Out, pieces: &[Piece]) -> usize {
    let n = x[0].len().min(LANES);
    let mut searches = Searches::new(x);
    for (index, piece) in (0u32..).zip(pieces) {
        searches.visit(n, *piece, index);
    }
    for lane in 0..n {
        let found = match pieces.get(searches.piece[lane] as usize) {
            Some(piece) => curve::slopes(searches.point(lane), piece, searches.t[lane]),
            None => curve::closest_gradient(searches.point(lane), &[]),
        };
        let ([dx, dy, dz], [tx, ty, tz]) = (found.direction, found.tangent);
        let values = [dx, dy, dz, tx, ty, tz, found.rate, found.slide];
        for (out, value) in out.iter_mut().zip(values) {
            out.0[lane] = value;
        }
    }
    MAX_RESULTS
}
