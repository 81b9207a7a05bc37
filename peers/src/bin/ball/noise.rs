//! The scene's noise for sixteen points: five octaves of improved Perlin noise by the published table.
//!
//! The ball reaches few cells of the lattice, so that the gradients at the corners of a cell are looked up at once, not by three
//! steps through the permutation for each. The gradients themselves are looked up in registers.

use crate::lanes::{LANES, Lanes, Words, blend, look_up};
use crate::points::Points;
use pulp::x86::V4;
use rayon::prelude::*;
use vol_compiler::noise_table::table_cell;

/// Octaves of the sum; each has twice the frequency and half the amplitude of the one before.
const OCTAVES: i32 = 5;

/// Most that a point may be from the origin, lattice units of the last octave: 2.5 times 2^4, where the ball ends.
const REACH: i32 = 40;

/// Cells along an axis, from `-REACH - 1` on: rounding may leave the ball by a little.
const SIDE: usize = 2 * REACH as usize + 2;

/// Entries of the table of cells: a power of two, so that indices need no check but a mask.
const CELLS: usize = (SIDE * SIDE * SIDE).next_power_of_two();

/// Largest size of the noise, whatever the gradients (docs/algorithms.md, section 4.1); all octaves after one have
/// less together than this times its amplitude.
const MOST: f32 = 1.036_354;

/// Components of the gradients by their code: the edges of a cube, four of them twice.
const GRADIENT_X: [f32; LANES] =
    [1.0, -1.0, 1.0, -1.0, 1.0, -1.0, 1.0, -1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, -1.0, 0.0];
const GRADIENT_Y: [f32; LANES] =
    [1.0, 1.0, -1.0, -1.0, 0.0, 0.0, 0.0, 0.0, 1.0, -1.0, 1.0, -1.0, 1.0, -1.0, 1.0, -1.0];
const GRADIENT_Z: [f32; LANES] =
    [0.0, 0.0, 0.0, 0.0, 1.0, 1.0, -1.0, -1.0, 1.0, 1.0, -1.0, -1.0, 0.0, 1.0, 0.0, -1.0];

/// The codes of the gradients around each cell, four bits for each corner: that of `(i, j, k)` from bit `4 (i + 2 j + 4 k)` on.
pub(crate) struct Noise {
    cells: Box<[u32; CELLS]>,
}

impl Noise {
    pub(crate) fn new() -> Self {
        let mut cells = vec![0; CELLS];
        cells[..SIDE * SIDE * SIDE].par_chunks_mut(SIDE).enumerate().for_each(|(row, cells)| {
            let at = |index: usize| index as i32 - REACH - 1;
            let (y, z) = (at(row % SIDE), at(row / SIDE));
            cells.iter_mut().enumerate().for_each(|(x, codes)| *codes = codes_around([at(x), y, z]));
        });
        Self { cells: cells.try_into().expect("as many as it was made with") }
    }

    /// The sum of octaves at points whose last octave is within [`REACH`]; elsewhere any number. Of sums that are not above 0
    /// octaves may be missing: the scene cuts them off.
    #[inline(always)]
    pub(crate) fn octaves(&self, simd: V4, p: Points) -> Lanes {
        let mut sum = Lanes::splat(simd, 0.0);
        let (mut frequency, mut amplitude) = (1.0, 1.0);
        for _ in 0..OCTAVES {
            let noise = self.perlin(simd, p.scaled(frequency, 0.0));
            sum = noise.mul_add(Lanes::splat(simd, amplitude), sum);
            // What is left cannot bring any of them above 0.
            if sum.above(-MOST * amplitude) == 0 {
                break;
            }
            (frequency, amplitude) = (2.0 * frequency, 0.5 * amplitude);
        }
        sum
    }

    #[inline(always)]
    fn perlin(&self, simd: V4, p: Points) -> Lanes {
        // Find the cell and the place in it.
        let whole = p.floor();
        let near = p.minus(whole);
        let far = near.scaled(1.0, -1.0);
        let mut codes = self.codes(simd, whole);
        // Blend what the corners give along x, then along y, then along z.
        let [u, v, w] = [fade(near.x), fade(near.y), fade(near.z)];
        let codes = &mut codes;
        let front = [edge(codes, u, near.x, near.y, near.z), edge(codes, u, near.x, far.y, near.z)];
        let back = [edge(codes, u, near.x, near.y, far.z), edge(codes, u, near.x, far.y, far.z)];
        blend(w, blend(v, front[0], front[1]), blend(v, back[0], back[1]))
    }

    /// Codes around cells, given their whole coordinates.
    #[inline(always)]
    fn codes(&self, simd: V4, cell: Points) -> Words {
        let side = Lanes::splat(simd, SIDE as f32);
        // All are whole numbers below 2^24.
        let first = ((REACH + 1) as usize * (1 + SIDE + SIDE * SIDE)) as f32;
        let number = cell.z.mul_add(side, cell.y).mul_add(side, cell.x.scaled(1.0, first));
        let mut codes = number.words().array();
        for code in &mut codes {
            *code = self.cells[*code as usize % CELLS];
        }
        Words::of(simd, codes)
    }
}

fn codes_around([x, y, z]: [i32; 3]) -> u32 {
    let code = |corner: i32| table_cell(x + (corner & 1), y + (corner >> 1 & 1), z + (corner >> 2));
    (0..8).fold(0, |codes, corner| codes | code(corner) << (4 * corner))
}

/// Between the next two corners, which differ along x alone; `x` is the offset from the first.
#[inline(always)]
fn edge(codes: &mut Words, weight: Lanes, x: Lanes, y: Lanes, z: Lanes) -> Lanes {
    let start = corner(*codes, x, y, z);
    let end = corner(codes.next_code(), x.scaled(1.0, -1.0), y, z);
    *codes = codes.next_code().next_code();
    blend(weight, start, end)
}

/// What the gradient of a corner gives at an offset from it.
#[inline(always)]
fn corner(codes: Words, x: Lanes, y: Lanes, z: Lanes) -> Lanes {
    let gradient = [look_up(&GRADIENT_X, codes), look_up(&GRADIENT_Y, codes), look_up(&GRADIENT_Z, codes)];
    gradient[0].mul_add(x, gradient[1].mul_add(y, gradient[2] * z))
}

/// `6 t^5 - 15 t^4 + 10 t^3`, written about the middle of the cell.
#[inline(always)]
fn fade(t: Lanes) -> Lanes {
    let s = t.scaled(1.0, -0.5);
    let squared = s * s;
    let slope = squared.mul_add(squared.scaled(6.0, -5.0), s.same(1.875));
    s.mul_add(slope, s.same(0.5))
}
