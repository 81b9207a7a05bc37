//! Closing of maps of heights: what is narrower than a kernel between two heights is filled.
//!
//! Larger is nearer to the light; `-inf` is where nothing is. Dilation is the largest of all heights in a kernel
//! around a texel, erosion the smallest, and closing the one after the other. A kernel ends where the map does. There
//! are no NaNs.
//!
//! A disk is the union of its columns. [`close_disk`] finds the maxima of the columns around each texel of a row
//! while they grow from the shortest to the longest, then the maximum of those side by side: for diameter `d`
//! about `1.7 d` comparisons per texel, where the disk has `pi d^2 / 4` texels. For each texel they are the same ones
//! in the same order wherever they are made: the bits do not depend on the number of threads.
//!
//! * source: algorithms.md §6.1; E. R. Urbach, M. H. F. Wilkinson, "Efficient 2-D Grayscale Morphological
//!   Transformations With Arbitrary Flat Structuring Elements", IEEE TIP 2008, for the union of chords

use crate::isa::{Isa, kernel};
use rayon::prelude::*;

/// Texels that are computed together: a whole number of vectors of any instruction set, and enough of them to hide
/// what finding their places costs.
const LANES: usize = 32;

/// Neighbouring texels of a row.
type Lanes = [f32; LANES];

/// What is before the comparisons.
const NOTHING: Lanes = [f32::NEG_INFINITY; LANES];

/// Rows of a strip, which is a task: an even number, for they are dilated in pairs.
const ROWS: usize = 32;

/// Closes a map, rows of `width`, by the disk of all offsets between texels that are at most
/// `(diameter - 1) / 2 + 1/4` long. A disk of one texel changes nothing.
pub(crate) fn close_disk(map: &mut [f32], width: usize, diameter: f32) {
    let reach = 0.5 * (f64::from(diameter) - 1.0) + 0.25;
    if map.is_empty() || reach < 1.0 {
        return;
    }
    let disk = Disk::new(reach, width, map.len() / width);
    let mut dilated = vec![0.0; map.len()];
    dilate_negated(map, width, &disk, &mut dilated);
    // The least of some heights is minus the largest of their negatives.
    dilate_negated(&dilated, width, &disk, map);
}

/// A disk as columns side by side, none of them longer than a map needs it.
struct Disk {
    /// Texels above the middle of a column and as many below, each number once, the least one first.
    heights: Vec<usize>,
    /// Which of the heights the columns beside the middle of the disk have, the middle one first.
    columns: Vec<usize>,
}

impl Disk {
    fn new(reach: f64, width: usize, height: usize) -> Self {
        let side = reach.min((width - 1) as f64) as usize;
        let mut heights: Vec<usize> = Vec::new();
        let mut columns = Vec::with_capacity(side + 1);
        for offset in (0..=side).rev() {
            let chord = (reach * reach - (offset * offset) as f64).sqrt();
            let half = chord.min((height - 1) as f64) as usize;
            if heights.last() != Some(&half) {
                heights.push(half);
            }
            columns.push(heights.len() - 1);
        }
        columns.reverse();
        Self { heights, columns }
    }

    /// Rows above its middle, and as many below.
    fn top(&self) -> usize {
        self.heights[self.heights.len() - 1]
    }

    /// Columns at either side of its middle.
    fn side(&self) -> usize {
        self.columns.len() - 1
    }
}

/// Dilates a map; what comes out has the other sign.
fn dilate_negated(map: &[f32], width: usize, disk: &Disk, out: &mut [f32]) {
    let isa = Isa::best();
    let fill = |strip: &mut Strip, (index, out): (usize, &mut [f32])| {
        strip.read(map, index * ROWS);
        isa.run::<DilateStrip>((strip, out));
    };
    out.par_chunks_mut(ROWS * width).enumerate().for_each_init(|| Strip::new(disk, width), fill);
}

kernel! {
    fn DilateStrip<'a>((strip, out): (&'a mut Strip, &'a mut [f32])) {
        strip.dilate_negated(out);
    }
}

/// Rows of a map with all that disks around their texels reach, and the maxima of columns in them.
struct Strip {
    /// See [`Disk`].
    heights: Vec<usize>,
    top: usize,
    side: usize,
    /// Texels of a row without those at the sides, where nothing is.
    width: usize,
    /// Groups of texels in a row.
    stride: usize,
    texels: Vec<Lanes>,
    /// Maxima of columns around the texels of two rows: for each height of the disk a row.
    maxima: [Vec<Lanes>; 2],
    /// Where the maxima are that the first texel of a row needs.
    places: Vec<usize>,
    /// A row of results.
    row: Vec<Lanes>,
}

impl Strip {
    fn new(disk: &Disk, width: usize) -> Self {
        let (heights, top, side) = (disk.heights.clone(), disk.top(), disk.side());
        let groups = width.div_ceil(LANES);
        let stride = groups + (2 * side).div_ceil(LANES);
        let rows = |count: usize| vec![NOTHING; count * stride];
        let maxima = [rows(heights.len()), rows(heights.len())];
        let beside = |(offset, height): (usize, &usize)| {
            let middle = height * stride * LANES + side;
            [middle - offset, middle + offset]
        };
        let places = disk.columns.iter().enumerate().flat_map(beside).skip(1).collect();
        let texels = rows(ROWS + 2 * top);
        Self { heights, top, side, width, stride, texels, maxima, places, row: vec![NOTHING; groups] }
    }

    /// Copies the rows of a map from `first` on and those around them; beyond its borders nothing is.
    fn read(&mut self, map: &[f32], first: usize) {
        for (row, texels) in self.texels.chunks_mut(self.stride).enumerate() {
            let texels = &mut texels.as_flattened_mut()[self.side..self.side + self.width];
            let row = (first + row).checked_sub(self.top);
            match row.and_then(|row| map.chunks(self.width).nth(row)) {
                Some(row) => texels.copy_from_slice(row),
                None => texels.fill(f32::NEG_INFINITY),
            }
        }
    }

    /// Dilates what was read.
    #[inline(always)]
    fn dilate_negated(&mut self, out: &mut [f32]) {
        for (pair, rows) in out.chunks_mut(2 * self.width).enumerate() {
            let around = &self.texels[2 * pair * self.stride..];
            grow_columns(around, self.stride, self.top, &self.heights, &mut self.maxima);
            for (out, maxima) in rows.chunks_mut(self.width).zip(&self.maxima) {
                join_columns(maxima.as_flattened(), &self.places, &mut self.row);
                out.copy_from_slice(&self.row.as_flattened()[..self.width]);
            }
        }
    }
}

/// Maxima of columns of all heights around the texels of two neighbouring rows, the upper one `top` rows below the
/// start of `texels`.
#[inline(always)]
fn grow_columns(
    texels: &[Lanes],
    stride: usize,
    top: usize,
    heights: &[usize],
    [upper, lower]: &mut [Vec<Lanes>; 2],
) {
    for x in 0..stride {
        let above = |distance: usize| &texels[(top - distance) * stride + x];
        let below = |distance: usize| &texels[(top + 1 + distance) * stride + x];
        // Of the texels in both columns.
        let mut common = NOTHING;
        let mut grown = 0;
        for (index, &height) in heights.iter().enumerate() {
            for distance in grown..height {
                common = larger(&larger(&common, above(distance)), below(distance));
            }
            let own = [larger(&common, above(height)), larger(&common, below(height))];
            common = larger(&own[0], &own[1]);
            [upper[index * stride + x], lower[index * stride + x]] = own;
            grown = height + 1;
        }
    }
}

/// Maxima of the columns side by side around the texels of a row, with the other sign; `places` is where those are
/// that the first one needs.
#[inline(always)]
fn join_columns(maxima: &[f32], places: &[usize], row: &mut [Lanes]) {
    for (group, out) in row.iter_mut().enumerate() {
        let maxima = &maxima[group * LANES..];
        let mut largest = NOTHING;
        for &place in places {
            if let Some(column) = maxima[place..].first_chunk() {
                largest = larger(&largest, column);
            }
        }
        for (out, largest) in out.iter_mut().zip(largest) {
            *out = -largest;
        }
    }
}

/// The larger of two heights each: unlike `f32::max` one instruction, for NaNs do not matter.
#[inline(always)]
fn larger(a: &Lanes, b: &Lanes) -> Lanes {
    std::array::from_fn(|lane| if a[lane] > b[lane] { a[lane] } else { b[lane] })
}

/// Dilates a row: the kernel goes from each texel to the one `length` before it.
pub(crate) fn dilate_row(row: &mut [f32], length: usize, scratch: &mut Vec<f32>) {
    combine(row, length, scratch, |from, to, shift| {
        let (start, rest) = to.split_at_mut(shift);
        start.copy_from_slice(&from[..shift]);
        for ((to, &own), &other) in rest.iter_mut().zip(&from[shift..]).zip(from) {
            *to = if own > other { own } else { other };
        }
    });
}

/// Erodes a row: the kernel goes from each texel to the one `length` behind it, so that this closes what
/// [`dilate_row`] began.
pub(crate) fn erode_row(row: &mut [f32], length: usize, scratch: &mut Vec<f32>) {
    combine(row, length, scratch, |from, to, shift| {
        let (rest, end) = to.split_at_mut(from.len() - shift);
        end.copy_from_slice(&from[rest.len()..]);
        for ((to, &own), &other) in rest.iter_mut().zip(from).zip(&from[shift..]) {
            *to = if own < other { own } else { other };
        }
    });
}

/// Combines each texel with `length` others by steps that combine it with the one `shift` away. After a step each
/// stands for twice as many; the last one is shorter, and what two parts have in common counts only once in a maximum.
#[inline(always)]
fn combine(row: &mut [f32], length: usize, scratch: &mut Vec<f32>, step: impl Fn(&[f32], &mut [f32], usize)) {
    let length = length.min(row.len().saturating_sub(1));
    scratch.resize(row.len(), 0.0);
    let (mut from, mut to) = (&mut *row, scratch.as_mut_slice());
    let (mut reached, mut elsewhere) = (0, false);
    while reached < length {
        let shift = (reached + 1).min(length - reached);
        step(from, to, shift);
        (from, to) = (to, from);
        reached += shift;
        elsewhere = !elsewhere;
    }
    if elsewhere {
        row.copy_from_slice(scratch);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const NONE: f32 = f32::NEG_INFINITY;
    const DIAMETERS: [f32; 14] =
        [f32::NEG_INFINITY, 0.0, 1.0, 2.0, 2.5, 3.0, 4.7, 10.0, 11.0, 21.0, 41.0, 150.0, 1e4, f32::INFINITY];
    /// Among them maps of several strips, of these and one row or column more.
    const SIZES: [[usize; 2]; 9] =
        [[37, 23], [1, 1], [1, 50], [50, 1], [2, 3], [19, 131], [32, 65], [33, 64], [530, 67]];

    /// Random heights in -1..1, some of them equal; in a part of the texels nothing.
    fn random(count: usize, mut seed: u32) -> Vec<f32> {
        let mut next = || {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            seed >> 16
        };
        let mut height = || if next() % 3 == 0 { NONE } else { (next() % 999) as f32 / 499.5 - 1.0 };
        (0..count).map(|_| height()).collect()
    }

    fn closed(map: &[f32], width: usize, diameter: f32) -> Vec<f32> {
        let mut map = map.to_vec();
        close_disk(&mut map, width, diameter);
        map
    }

    fn closed_row(row: &[f32], length: usize) -> Vec<f32> {
        let (mut row, mut scratch) = (row.to_vec(), vec![7.0; 3]);
        dilate_row(&mut row, length, &mut scratch);
        erode_row(&mut row, length, &mut scratch);
        row
    }

    /// `operator` over all texels of a map in the disk around each, offset by offset.
    fn over_disk(map: &[f32], width: usize, diameter: f32, operator: fn(f32, f32) -> f32) -> Vec<f32> {
        let reach = (diameter - 1.0) / 2.0 + 0.25;
        let (columns, rows) = (width as i32, (map.len() / width) as i32);
        let mut out = map.to_vec();
        let offsets = (1 - rows..rows).flat_map(|dy| (1 - columns..columns).map(move |dx| (dx, dy)));
        for (dx, dy) in offsets.filter(|(dx, dy)| (dx * dx + dy * dy) as f32 <= reach * reach) {
            for y in 0.max(-dy)..rows.min(rows - dy) {
                for x in 0.max(-dx)..columns.min(columns - dx) {
                    let at = |x: i32, y: i32| (y * columns + x) as usize;
                    out[at(x, y)] = operator(out[at(x, y)], map[at(x + dx, y + dy)]);
                }
            }
        }
        out
    }

    fn closed_slowly(map: &[f32], width: usize, diameter: f32) -> Vec<f32> {
        if diameter <= 1.0 {
            return map.to_vec();
        }
        over_disk(&over_disk(map, width, diameter, f32::max), width, diameter, f32::min)
    }

    fn at_least(a: &[f32], b: &[f32]) -> bool {
        a.iter().zip(b).all(|(a, b)| a >= b)
    }

    #[test]
    fn a_disk_closes_as_its_definition_says() {
        for (seed, [width, height]) in (1..).zip(SIZES) {
            let map = random(width * height, seed);
            // The definition takes as many steps as the map has texels, squared.
            let large = width * height > 10_000;
            for diameter in DIAMETERS.into_iter().filter(|&diameter| !large || diameter < 30.0) {
                let expected = closed_slowly(&map, width, diameter);
                assert!(closed(&map, width, diameter) == expected, "{width}x{height}, {diameter}");
            }
        }
    }

    #[test]
    fn closing_by_a_disk_is_extensive_idempotent_and_increasing() {
        let width = 37;
        let low = random(width * 23, 5);
        let high: Vec<f32> = low.iter().zip(random(low.len(), 6)).map(|(a, b)| a.max(b)).collect();
        for diameter in DIAMETERS {
            let once = closed(&low, width, diameter);
            assert!(at_least(&once, &low), "extensive, {diameter}");
            assert!(closed(&once, width, diameter) == once, "idempotent, {diameter}");
            assert!(at_least(&closed(&high, width, diameter), &once), "increasing, {diameter}");
        }
    }

    #[test]
    fn a_disk_fills_gaps_into_which_it_does_not_fit() {
        let width = 60;
        let gap = |columns: usize| {
            let walls = |at: usize| if (20..20 + columns).contains(&(at % width)) { NONE } else { 1.0 };
            (0..width * 40).map(walls).collect::<Vec<_>>()
        };
        assert!(closed(&gap(10), width, 11.0).iter().all(|&height| height == 1.0));
        assert!(closed(&gap(11), width, 11.0) == gap(11));
        assert!(closed(&vec![NONE; 600], width, 11.0) == vec![NONE; 600]);
        assert!(closed(&[], width, 11.0).is_empty());
    }

    #[test]
    fn bits_do_not_depend_on_the_number_of_threads() {
        let (width, height) = (531, 301);
        // Zeros of both signs are equal, and yet not the same.
        let height_or_zero = |height: f32| if height < -0.5 { height } else { 0.0_f32.copysign(height) };
        let map: Vec<f32> = random(width * height, 9).into_iter().map(height_or_zero).collect();
        let bits = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a few threads");
            let closed = pool.install(|| closed(&map, width, 11.0));
            closed.into_iter().map(f32::to_bits).collect::<Vec<_>>()
        };
        let one = bits(1);
        assert!([2, 3, 8].into_iter().all(|threads| bits(threads) == one));
    }

    #[test]
    fn rows_are_combined_as_their_definition_says() {
        let mut scratch = Vec::new();
        for count in [0, 1, 2, 3, 17, 100] {
            let row = random(count, count as u32);
            for length in [0, 1, 2, 3, 4, 7, 15, 16, 30, 60, 99, 100, 101, usize::MAX] {
                let before =
                    |j: usize| row[j.saturating_sub(length)..=j].iter().copied().fold(NONE, f32::max);
                let behind = |j: usize| row[j..].iter().take(length.saturating_add(1)).copied();
                let mut dilated = row.clone();
                dilate_row(&mut dilated, length, &mut scratch);
                assert!(dilated == (0..count).map(before).collect::<Vec<_>>(), "dilation {count} {length}");
                let mut eroded = row.clone();
                erode_row(&mut eroded, length, &mut scratch);
                let expected = (0..count).map(|j| behind(j).fold(f32::INFINITY, f32::min));
                assert!(eroded == expected.collect::<Vec<_>>(), "erosion {count} {length}");
            }
        }
    }

    #[test]
    fn closing_a_row_is_extensive_idempotent_and_increasing() {
        let low = random(103, 1);
        let high: Vec<f32> = low.iter().zip(random(103, 2)).map(|(a, b)| a.max(b)).collect();
        for length in [0, 1, 2, 5, 15, 30, 60, 102, 200] {
            let once = closed_row(&low, length);
            assert!(at_least(&once, &low), "extensive, {length}");
            assert!(closed_row(&once, length) == once, "idempotent, {length}");
            assert!(at_least(&closed_row(&high, length), &once), "increasing, {length}");
        }
        assert_eq!(closed_row(&[1.0, NONE, NONE, NONE, 2.0, NONE], 3), [1.0, 1.0, 1.0, 1.0, 2.0, 2.0]);
        assert_eq!(closed_row(&[1.0, NONE, NONE, NONE, 2.0], 2), [1.0, NONE, NONE, NONE, 2.0]);
    }
}
