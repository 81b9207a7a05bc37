//! Pictures at the size of the table.
//!
//! A picture covers the table as a sheet of equal size would: pixels are areas, and so are texels, of which
//! `SIZE` fill a side. One of `SIZE` x `SIZE` pixels is taken as it is.

use super::{Picture, SIZE, finite};
use rayon::prelude::*;

/// The texels of a picture, row after row, premultiplied: along each axis the mean of the pixels that a texel
/// covers if there are more pixels than texels, else linear between the middles of pixels and steady beyond.
/// Pixels that are not finite cover nothing. None if the number of pixels is not that of its sides.
pub(super) fn resampled(picture: &Picture) -> Option<Vec<[f64; 4]>> {
    let [width, height] = [picture.width as usize, picture.height as usize];
    if width == 0 || height == 0 || width.checked_mul(height) != Some(picture.pixels.len()) {
        return None;
    }
    let (across, down) = (taps(width), taps(height));
    // Rows first, as many as the picture has.
    let mut narrow = vec![[0.0; 4]; SIZE * height];
    narrow.par_chunks_mut(SIZE).zip(picture.pixels.par_chunks(width)).for_each_init(
        Vec::new,
        |row, (texels, pixels)| {
            row.clear();
            row.extend(pixels.iter().map(premultiplied));
            for (texel, taps) in texels.iter_mut().zip(&across) {
                *texel = weighted(taps, |pixel| row[pixel]);
            }
        },
    );
    let texel = |index: usize| weighted(&down[index / SIZE], |row| narrow[row * SIZE + index % SIZE]);
    Some((0..SIZE * SIZE).into_par_iter().map(texel).collect())
}

fn premultiplied(pixel: &[f32; 4]) -> [f64; 4] {
    let [r, g, b, coverage] = pixel.map(f64::from);
    if !finite(&[r, g, b, coverage]) {
        return [0.0; 4];
    }
    let coverage = coverage.clamp(0.0, 1.0);
    [r * coverage, g * coverage, b * coverage, coverage]
}

fn weighted(taps: &[(usize, f64)], at: impl Fn(usize) -> [f64; 4]) -> [f64; 4] {
    taps.iter().fold([0.0; 4], |sum, &(index, weight)| {
        let value = at(index);
        [0, 1, 2, 3].map(|channel| sum[channel] + weight * value[channel])
    })
}

/// For each texel along an axis the pixels that it is made of, of `count`, and their weights, whose sum is 1.
fn taps(count: usize) -> Vec<Vec<(usize, f64)>> {
    let pixels = count as f64 / SIZE as f64;
    let mean = |texel: usize| {
        let [from, to] = [texel, texel + 1].map(|end| end as f64 * pixels);
        let covered = from as usize..(to.ceil() as usize).min(count);
        let share = |pixel: usize| (to.min((pixel + 1) as f64) - from.max(pixel as f64)).max(0.0) / pixels;
        covered.map(|pixel| (pixel, share(pixel))).collect()
    };
    let between = |texel: usize| {
        let place = ((texel as f64 + 0.5) * pixels - 0.5).clamp(0.0, (count - 1) as f64);
        let (below, share) = (place as usize, place.fract());
        vec![(below, 1.0 - share), ((below + 1).min(count - 1), share)]
    };
    (0..SIZE).map(|texel| if count > SIZE { mean(texel) } else { between(texel) }).collect()
}
