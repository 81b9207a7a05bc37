//! Transfer functions (Kol et al. 2016, §4.2): layers put over one another to a table of colours.
//!
//! Texel `(i, j)` has average visibility `i / (SIZE - 1)` and depth `j / (SIZE - 1)`; the table is meant to
//! be read bilinearly and clamped. Layers are composed lowest first over white, in linear light, each texel
//! by itself. What a layer shows is premultiplied by its coverage wherever it is interpolated, so colours of
//! what covers nothing never show. A layer, constraint or pixel with a number that is not finite covers
//! nothing.
//!
//! * source: algorithms.md §6.2

mod diffusion;
mod image;
#[cfg(test)]
mod tests;

use diffusion::{Diffusion, Knot};
use rayon::prelude::*;
use vol_compiler::frame::styled::TRANSFER_SIZE;
use vol_compiler::program::style::{Blend, Constraint, Content, Layer, Place, Transfer};

/// Texels along a side.
const SIZE: usize = TRANSFER_SIZE as usize;

/// A row of a layer: red, green and blue, premultiplied by the coverage that follows them.
type Row = [[f64; 4]; SIZE];

/// A decoded picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Linear red, green and blue, not premultiplied, and coverage, 0 to 1: rows from the top, which is depth
    /// 0.
    pub pixels: Vec<[f32; 4]>,
}

/// Maps a point of the world to the average visibility and depth, 0 to 1, of the ray through it; to nothing
/// if the point is not in the picture.
type Tracked<'a> = &'a dyn Fn([f64; 3]) -> Option<[f64; 2]>;

/// The table of a transfer function: `SIZE * SIZE` linear colours, average visibility fastest.
///
/// * `pictures`: those that [`Content::Image`] counts; one that is not there covers nothing
/// * `tracked`: where constraints at points of the world are; those at points that are nowhere are left out
pub(crate) fn texture(transfer: &Transfer<f64>, pictures: &[Picture], tracked: Tracked<'_>) -> Vec<[f32; 3]> {
    let compose = |key: usize| composed(&transfer.keys[key], pictures, tracked);
    let Some(last) = transfer.keys.len().checked_sub(1) else {
        return vec![[1.0; 3]; SIZE * SIZE];
    };
    // Keys before the last one with a share have no say but the one beside it.
    let shares = &transfer.shares[..transfer.shares.len().min(last)];
    let texels = match shares.iter().rposition(|&share| share > 0.0) {
        None => compose(0),
        Some(before) if shares[before] >= 1.0 => compose(before + 1),
        Some(before) => {
            let share = shares[before];
            let (mut texels, next) = (compose(before), compose(before + 1));
            for (texel, next) in texels.iter_mut().zip(&next) {
                *texel = mix(texel, next, share);
            }
            texels
        }
    };
    texels.iter().map(|texel| texel.map(|channel| channel as f32)).collect()
}

/// The layers of one key over white.
fn composed(layers: &[Layer<f64>], pictures: &[Picture], tracked: Tracked<'_>) -> Vec<[f64; 3]> {
    let sheets =
        layers.iter().map(|layer| Some((Sheet::new(&layer.content, pictures, tracked)?, &layer.blend)));
    let sheets: Vec<_> = sheets.flatten().collect();
    let mut texels = vec![[1.0; 3]; SIZE * SIZE];
    texels.par_chunks_mut(SIZE).enumerate().for_each(|(row, below)| {
        let mut over = [[0.0; 4]; SIZE];
        for (sheet, blend) in &sheets {
            sheet.row(row, &mut over);
            for (below, over) in below.iter_mut().zip(&over) {
                *below = blended(blend, *below, *over);
            }
        }
    });
    texels
}

/// A premultiplied colour and its coverage put over a colour.
fn blended(blend: &Blend<f64>, below: [f64; 3], [r, g, b, coverage]: [f64; 4]) -> [f64; 3] {
    let (keep, factor, share) = match *blend {
        Blend::Add => (1.0, 0.0, 1.0),
        Blend::Multiply => (1.0 - coverage, 1.0, 0.0),
        Blend::Alpha(amount) => {
            let amount = if amount.is_nan() { 0.0 } else { amount.clamp(0.0, 1.0) };
            (1.0 - amount * coverage, 0.0, amount)
        }
    };
    let over = [r, g, b];
    [0, 1, 2].map(|i| below[i] * (keep + factor * over[i]) + share * over[i])
}

/// A layer that can be asked for its rows.
enum Sheet {
    /// One colour.
    Solid([f64; 4]),
    /// From one colour to another.
    Gradient(Gradient),
    /// Smooth between fixed colours.
    Diffusion(Diffusion),
    /// All texels, row after row.
    Texels(Vec<[f64; 4]>),
}

impl Sheet {
    /// Prepares a layer; none if it covers nothing.
    fn new(content: &Content<f64>, pictures: &[Picture], tracked: Tracked<'_>) -> Option<Self> {
        match content {
            Content::Solid(color) => finite(color).then(|| Self::Solid(opaque(*color))),
            Content::Gradient { places, colors } => {
                let known = finite(places.as_flattened()) && finite(colors.as_flattened());
                known.then(|| {
                    Gradient::new(*places, *colors).map_or(Self::Solid(opaque(colors[1])), Self::Gradient)
                })
            }
            Content::Diffusion(constraints) => {
                let knots: Vec<_> =
                    constraints.iter().filter_map(|constraint| knot(constraint, tracked)).collect();
                Diffusion::new(&knots).map(Self::Diffusion)
            }
            Content::Image(index) => image::resampled(pictures.get(*index)?).map(Self::Texels),
        }
    }

    /// Writes a row.
    fn row(&self, row: usize, texels: &mut Row) {
        match self {
            Self::Solid(color) => texels.fill(*color),
            Self::Gradient(gradient) => {
                for (column, texel) in texels.iter_mut().enumerate() {
                    *texel = opaque(gradient.at([place(column), place(row)]));
                }
            }
            Self::Diffusion(diffusion) => diffusion.row(row, texels),
            Self::Texels(all) => texels.copy_from_slice(&all[row * SIZE..][..SIZE]),
        }
    }
}

/// Two colours and the way from one to the other.
struct Gradient {
    from: [f64; 2],
    /// Unit vector.
    direction: [f64; 2],
    length: f64,
    colors: [[f64; 3]; 2],
}

impl Gradient {
    /// None between equal places. What is left there is a step without a direction; all of the layer is then
    /// the second colour, as all places are at its end or beyond.
    fn new([from, to]: [[f64; 2]; 2], colors: [[f64; 3]; 2]) -> Option<Self> {
        let way = [to[0] - from[0], to[1] - from[1]];
        let length = way[0].hypot(way[1]);
        let direction = way.map(|component| component / length);
        (length > 0.0 && length.is_finite()).then_some(Self { from, direction, length, colors })
    }

    /// The colour at a place.
    fn at(&self, place: [f64; 2]) -> [f64; 3] {
        let [x, y] = [place[0] - self.from[0], place[1] - self.from[1]];
        let along = x * self.direction[0] + y * self.direction[1];
        mix(&self.colors[0], &self.colors[1], (along / self.length).clamp(0.0, 1.0))
    }
}

/// Reads a constraint; none if it is nowhere, or if its numbers are none.
fn knot(constraint: &Constraint<f64>, tracked: Tracked<'_>) -> Option<Knot> {
    let place = match constraint.place {
        Place::Fixed(place) => place,
        Place::Tracked(point) => tracked(point)?,
    };
    let known = finite(&place) && finite(&constraint.color) && finite(&[constraint.alpha]);
    known.then(|| {
        let coverage = constraint.alpha.clamp(0.0, 1.0);
        let [r, g, b] = constraint.color.map(|channel| channel * coverage);
        Knot { place: place.map(|part| part.clamp(0.0, 1.0)), value: [r, g, b, coverage] }
    })
}

/// Average visibility of a column, or depth of a row.
fn place(index: usize) -> f64 {
    index as f64 / (SIZE - 1) as f64
}

fn opaque([r, g, b]: [f64; 3]) -> [f64; 4] {
    [r, g, b, 1.0]
}

/// From `a` to `b`, exact at both.
fn mix(a: &[f64; 3], b: &[f64; 3], share: f64) -> [f64; 3] {
    [0, 1, 2].map(|i| a[i] * (1.0 - share) + b[i] * share)
}

/// Whether all are finite as f32, so that in f64 neither are their differences and products infinite.
fn finite(numbers: &[f64]) -> bool {
    numbers.iter().all(|&number| (number as f32).is_finite())
}
