//! From values at the points of a grid to the coefficients of the cubic B-spline through them.
//!
//! Along one axis the spline at a point is `(c[i-1] + 4 c[i] + c[i+1]) / 6`; beyond the ends the last coefficient counts
//! again. That is one system of equations for each line of points, tridiagonal with a diagonal that outweighs the rest, so it is
//! solved by elimination in their order. Axis by axis, since the spline is a product of those along the axes.
//!
//! Error: 2e-7 of the largest value about (test `the_spline_goes_through_all_points`).
//!
//! * source: M. Unser, "Splines: A Perfect Fit for Signal and Image Processing", IEEE Signal Processing Magazine 1999

use rayon::prelude::*;

/// Words of a slab that one thread solves across: a few rows of the fastest axis.
const SLAB: usize = 256;

/// Lines along the fastest axis that are solved together, as each number waits for the one before.
const LINES: usize = 16;

/// Coefficients of values at points, `counts` along each axis, the last one fastest, with some channels together.
pub(super) fn coefficients(mut values: Vec<f32>, counts: [u32; 3], channels: usize) -> Vec<f32> {
    let [planes, rows, columns] = counts.map(|count| count as usize);
    let row = columns * channels;
    let pivots = [planes, rows, columns].map(pivots);
    // A plane is small enough to stay near.
    values.par_chunks_mut(rows * row).for_each(|plane| {
        plane.chunks_mut(LINES * row).for_each(|lines| along(lines, &pivots[2], channels));
        solve_rows(&mut plane.chunks_mut(row).collect::<Vec<_>>(), &pivots[1]);
    });
    across(&mut values, &pivots[0], rows * row);
    values
}

/// One over what elimination leaves on the diagonal of `count` equations.
fn pivots(count: usize) -> Vec<f32> {
    let mut pivots = Vec::with_capacity(count);
    let mut before = 0.0;
    for index in 0..count {
        let at_end = index == 0 || index + 1 == count;
        before = 1.0 / (if at_end { 5.0 } else { 4.0 } - before);
        pivots.push(before);
    }
    pivots
}

/// Solves the equations of lines that follow one another.
fn along(words: &mut [f32], pivots: &[f32], channels: usize) {
    let length = pivots.len() * channels;
    let mut lines: Vec<&mut [f32]> = words.chunks_mut(length).collect();
    for line in &mut lines {
        line[..channels].iter_mut().for_each(|x| *x = 6.0 * *x * pivots[0]);
    }
    for (index, pivot) in pivots.iter().enumerate().skip(1) {
        for at in index * channels..(index + 1) * channels {
            lines.iter_mut().for_each(|line| line[at] = (6.0 * line[at] - line[at - channels]) * pivot);
        }
    }
    for (index, pivot) in pivots.iter().enumerate().rev().skip(1) {
        for at in index * channels..(index + 1) * channels {
            lines.iter_mut().for_each(|line| line[at] -= pivot * line[at + channels]);
        }
    }
}

/// Solves the equations across planes of `width` words, by many threads.
fn across(words: &mut [f32], pivots: &[f32], width: usize) {
    let mut slabs: Vec<Vec<&mut [f32]>> =
        (0..width.div_ceil(SLAB)).map(|_| Vec::with_capacity(pivots.len())).collect();
    for plane in words.chunks_mut(width) {
        slabs.iter_mut().zip(plane.chunks_mut(SLAB)).for_each(|(slab, part)| slab.push(part));
    }
    slabs.par_iter_mut().for_each(|slab| solve_rows(slab, pivots));
}

/// Solves the equations of lines that run side by side, of which each row holds a number of each.
fn solve_rows(rows: &mut [&mut [f32]], pivots: &[f32]) {
    rows[0].iter_mut().for_each(|x| *x = 6.0 * *x * pivots[0]);
    for index in 1..rows.len() {
        let [before, row] = &mut rows[index - 1..=index] else { return };
        row.iter_mut().zip(&**before).for_each(|(x, before)| *x = (6.0 * *x - before) * pivots[index]);
    }
    for index in (1..rows.len()).rev() {
        let [row, after] = &mut rows[index - 1..=index] else { return };
        row.iter_mut().zip(&**after).for_each(|(x, after)| *x -= pivots[index - 1] * after);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What the spline is at a point, in f64.
    fn at_point(
        coefficients: &[f32],
        counts: [u32; 3],
        channels: usize,
        point: [usize; 3],
        channel: usize,
    ) -> f64 {
        let [planes, rows, columns] = counts.map(|count| count as usize);
        let near = |index: usize, count: usize| {
            [(index.saturating_sub(1), 1.0), (index, 4.0), ((index + 1).min(count - 1), 1.0)]
        };
        let mut sum = 0.0;
        for (u, a) in near(point[0], planes) {
            for (v, b) in near(point[1], rows) {
                for (w, c) in near(point[2], columns) {
                    let word = ((u * rows + v) * columns + w) * channels + channel;
                    sum += a * b * c * f64::from(coefficients[word]);
                }
            }
        }
        sum / 216.0
    }

    #[test]
    fn the_spline_goes_through_all_points() {
        for (counts, channels) in [([2, 2, 2], 1), ([9, 3, 40], 3), ([5, 33, 17], 1), ([300, 2, 70], 1)] {
            let points = counts.iter().product::<u32>() as usize * channels;
            let values: Vec<f32> = (0..points).map(|i| ((i * i + 7 * i) % 97) as f32 / 97.0).collect();
            let found = coefficients(values.clone(), counts, channels);
            let [_, rows, columns] = counts.map(|count| count as usize);
            for (word, value) in values.iter().enumerate() {
                let (point, channel) = (word / channels, word % channels);
                let place = [point / columns / rows, point / columns % rows, point % columns];
                let got = at_point(&found, counts, channels, place, channel);
                assert!((got - f64::from(*value)).abs() < 1e-6, "{counts:?} {place:?}: {got} for {value}");
            }
        }
    }

    #[test]
    fn what_is_constant_stays_and_large_depths_stay_finite() {
        for value in [0.0, 1.0, 1e30] {
            let found = coefficients(vec![value; 6 * 5 * 4], [6, 5, 4], 1);
            assert!(found.iter().all(|x| (x - value).abs() <= 1e-6 * value), "{value:e}: {found:?}");
        }
        let cliff: Vec<f32> = (0..1000).map(|i| if i % 10 < 5 { 0.0 } else { 1e30 }).collect();
        assert!(coefficients(cliff, [10, 10, 10], 1).iter().all(|x| x.abs() < 1e31));
    }
}
