//! The numbers of a frame as words of the buffers, and the words of a finished picture.
//!
//! `vol_frame`, binding 3, holds what every ray may need, [`frame_words`]:
//!
//! | word | name | meaning |
//! |---|---|---|
//! | 0 | `AT_TILE` | the rectangle to render: x, y of its upper left pixel, width, height |
//! | 4 | `AT_SIZE` | width and height of the picture |
//! | 6 | `AT_STEP` | distance between nodes along camera rays |
//! | 7 | `AT_SHADOW_STEP` | distance between nodes along shadow rays |
//! | 8 | `AT_EYE` | origin of the camera, xyz |
//! | 11 | `AT_FORWARD` | unit vector into the picture, xyz |
//! | 14 | `AT_RIGHT` | to the right edge at distance 1, xyz |
//! | 17 | `AT_UP` | to the upper edge at distance 1, xyz |
//! | 20 | `AT_BACKGROUND` | rgb |
//! | 23 | `AT_LIGHT_COUNT` | number of lights |
//! | 24 | `AT_SAMPLES` | samples of a pixel, or the most |
//! | 25 | `AT_TOLERANCE` | error at which a pixel takes no more of them, 0 for as many everywhere |
//! | 26 | `AT_BUDGET` | samples to take now; each pixel goes on where `vol_output` says that it is |
//! | 27 | `AT_OBJECTS` | 8 words per object of the program: state (0 absent, 1 lit, 2 shows its normals), lo xyz, hi xyz, safe scale (0: by `object_steepness`) |
//! | 27 + 8 objects | `AT_MEDIA` | 9 words per medium of the program: state (0 absent, 1 lights do not matter, 2 unshadowed, 3 shadowed), lo xyz, hi xyz, number of its cells, its spacing |
//! | after them | `AT_LIGHTS` | 12 words per light of the program, those of the frame first: distant, position or direction xyz, color rgb, shadows, size, distance of occlusion, word of its grid (0: none), word of its style's record (0: none) |
//! | after them | `AT_GRIDS` | 28 words per light of the program, the grids of the frame first, see [`LightGrid`]: distant, origin xyz, u xyz, v xyz, w xyz, lo, scale and counts along u, v, w, tint rgb, words per point (1 or 3), word of its first column in `vol_input`, whether it is a spline |
//! | after them | | records of the program's styles, those of the frame's lights first, see [`styles`] |
//! | after them | `AT_CELLS` | 64 cells per medium of the program, 6 words each, lo xyz, hi xyz; a medium without cells may be anywhere in its box |
//!
//! `vol_input`, binding 4, holds what may be long, [`input_words`]: the numbers of objects whose functions differ in them alone
//! ([`crate::families`]), `ROW_WORDS` for each object of the program; the grids; then for each styled light slopes,
//! transfer function, light map and means; each of these from a multiple of 64 words on. A grid has 3 words for each column, the
//! number of its first point, how many follow that, and a quarter of the words from the grid's first one to the column's first
//! depth; then, from a multiple of 4 words on, the depths.
//!
//! All words are f32; whole numbers, below 2^24, are exact, and no word is a denormal that a device
//! might flush.

use super::styles;
use crate::families::Families;
use crate::frame::{
    Aabb, Counts, Frame, GridColumn, Image, Job, LightGrid, MOST_CELLS, MediumFrame, Pixel, Stride,
};
use crate::program::{Lighting, Program};
use crate::wgsl::layout::Row;

/// Words before the objects.
pub(super) const HEADER_WORDS: usize = 27;

/// Words of an object.
pub(super) const OBJECT_WORDS: usize = 8;

/// Words of a light.
pub(super) const LIGHT_WORDS: usize = 12;

/// Words of a medium.
pub(super) const MEDIUM_WORDS: usize = 9;

/// Words of a cell.
pub(super) const CELL_WORDS: usize = 6;

/// Words of the cells of a medium.
pub(super) const CELLS_WORDS: usize = CELL_WORDS * MOST_CELLS;

/// Words of a grid, without its depths.
const GRID_WORDS: usize = 28;

/// Grids and tables begin at multiples of this many words: so their places are exact in f32 up to 2^30.
pub(super) const GRID_ALIGNMENT: usize = 64;

/// Words of `vol_output` per pixel.
pub const PIXEL_WORDS: usize = 15;

/// Depth that stands for "no surface"; the shader writes 1e30.
const NO_DEPTH: f32 = 1e29;

/// Boxes end here on every axis: "infinite" for both backends.
pub(super) const INFINITE: f32 = 1e6;

/// Places in the header, in words.
pub(super) const HEADER: [(&str, usize); 13] = [
    ("AT_TILE", 0),
    ("AT_SIZE", 4),
    ("AT_STEP", 6),
    ("AT_SHADOW_STEP", 7),
    ("AT_EYE", 8),
    ("AT_FORWARD", 11),
    ("AT_RIGHT", 14),
    ("AT_UP", 17),
    ("AT_BACKGROUND", 20),
    ("AT_LIGHT_COUNT", 23),
    ("AT_SAMPLES", 24),
    ("AT_TOLERANCE", 25),
    ("AT_BUDGET", 26),
];

/// Where things begin in `vol_frame`.
pub(super) struct Places {
    pub(super) media: usize,
    pub(super) lights: usize,
    pub(super) grids: usize,
    styles: usize,
    pub(super) cells: usize,
    pub(super) end: usize,
}

impl Places {
    pub(super) fn of(program: &Program) -> Self {
        let media = HEADER_WORDS + OBJECT_WORDS * program.objects.len();
        let lights = media + MEDIUM_WORDS * program.media.len();
        let grids = lights + LIGHT_WORDS * program.lights.len();
        let styles = grids + GRID_WORDS * program.lights.len();
        let cells = styles + styles::WORDS * program.styles.len();
        Self { media, lights, grids, styles, cells, end: cells + CELLS_WORDS * program.media.len() }
    }
}

/// `vol_frame` of a program.
pub(super) fn frame_row(program: &Program) -> Row {
    Row::new(3, "vol_frame", Places::of(program).end)
}

/// `vol_input`.
pub(super) fn input_row() -> Row {
    Row::long(4, "vol_input")
}

/// Names of places in `vol_frame` and their words, as the text knows them.
#[must_use]
pub fn places(program: &Program) -> Vec<(&'static str, usize)> {
    let of = Places::of(program);
    let records = [("AT_OBJECTS", HEADER_WORDS), ("AT_MEDIA", of.media), ("AT_LIGHTS", of.lights)];
    HEADER.into_iter().chain(records).chain([("AT_GRIDS", of.grids), ("AT_CELLS", of.cells)]).collect()
}

/// A box as the runtimes use it: finite, and larger by what rounding may take off a ray's entry and
/// exit. `None` if it is empty.
#[must_use]
pub fn padded(bounds: &Aabb) -> Option<Aabb> {
    let finite = |corner: [f32; 3]| corner.map(|x| x.clamp(-INFINITE, INFINITE));
    if (0..3).any(|axis| bounds.lo[axis] > bounds.hi[axis]) {
        return None;
    }
    let held = Aabb { lo: finite(bounds.lo), hi: finite(bounds.hi) };
    Some(wider(&held, margin(&held)))
}

/// The cells of a medium as the runtimes use them, all larger by as much: the region is outside
/// wherever no cell is. None if that is not known, as of a medium with one cell, its box.
#[must_use]
pub fn padded_cells(medium: &MediumFrame) -> Vec<Aabb> {
    let cells = medium.cells.iter().filter(|cell| (0..3).all(|axis| cell.lo[axis] <= cell.hi[axis]));
    let near = |cell: &&Aabb| cell.lo.iter().chain(&cell.hi).all(|x| x.abs() < INFINITE);
    if medium.cells.len() < 2 || !cells.clone().all(|cell| near(&cell)) {
        return Vec::new();
    }
    let around = cells.clone().map(margin).fold(0.0, f32::max);
    cells.map(|cell| wider(cell, around)).collect()
}

/// What rounding may take off a ray's entry into a box and its exit.
fn margin(bounds: &Aabb) -> f32 {
    1e-5 * bounds.lo.iter().chain(&bounds.hi).fold(0.0_f32, |size, x| size.max(x.abs()))
}

fn wider(bounds: &Aabb, by: f32) -> Aabb {
    Aabb { lo: bounds.lo.map(|x| x - by), hi: bounds.hi.map(|x| x + by) }
}

/// The contents of `vol_frame`: a frame, a job, and the part of the picture to render
/// (`[x, y, width, height]` in pixels) with at most `budget` more samples for each of its pixels, laid
/// out as the module's documentation says.
#[must_use]
pub fn frame_words(program: &Program, frame: &Frame, job: &Job, tile: [u32; 4], budget: u32) -> Vec<u32> {
    let places = Places::of(program);
    let mut words = Vec::with_capacity(places.end);
    words.extend(tile.map(|x| x as f32));
    words.extend(job.size.map(|x| x as f32));
    words.extend([job.step, job.shadow_step]);
    let camera = &frame.camera;
    words.extend([camera.origin, camera.forward, camera.right, camera.up, frame.background].concat());
    words.push(frame.lights.len() as f32);
    words.extend([job.sampling.most as f32, job.sampling.tolerance, budget as f32]);
    // Records of all objects and media of the program; those that are not in the frame stay 0.
    let mut objects = vec![[0.0; OBJECT_WORDS]; program.objects.len()];
    for object in &frame.objects {
        let state = if object.shows_normals { 2.0 } else { 1.0 };
        let safe_scale = match object.stride {
            Stride::Scale(scale) => scale,
            Stride::Within(_) => 0.0,
        };
        objects[object.index] = record(state, padded(&object.bounds), [safe_scale]);
    }
    words.extend(objects.as_flattened());
    let mut media = vec![[0.0; MEDIUM_WORDS]; program.media.len()];
    let mut cells = vec![[0.0; CELLS_WORDS]; program.media.len()];
    for medium in &frame.media {
        let state = match medium.lighting {
            Lighting::None => 1.0,
            Lighting::Unshadowed => 2.0,
            Lighting::Shadowed => 3.0,
        };
        let padded_cells = padded_cells(medium);
        media[medium.index] =
            record(state, padded(&medium.bounds), [padded_cells.len() as f32, medium.spacing as f32]);
        let corners = padded_cells.iter().flat_map(|cell| [cell.lo, cell.hi]).flatten();
        cells[medium.index].iter_mut().zip(corners).for_each(|(word, corner)| *word = corner);
    }
    words.extend(media.as_flattened());
    let (mut grids_at, mut styles_at) = (places.grids, places.styles);
    for (index, light) in frame.lights.iter().enumerate() {
        words.push(f32::from(u8::from(light.distant)));
        words.extend([light.position, light.color].concat());
        words.extend([f32::from(u8::from(light.shadows)), light.size, light.occlusion]);
        let grid = grid_of(frame, index).map_or(0, |_| grids_at);
        words.push(grid as f32);
        grids_at += if grid > 0 { GRID_WORDS } else { 0 };
        let style = styles::of_light(frame, index).map_or(0, |_| styles_at);
        words.push(style as f32);
        styles_at += if style > 0 { styles::WORDS } else { 0 };
    }
    words.resize(places.grids, 0.0);
    let mut input_at = Families::of(program).word_count().next_multiple_of(GRID_ALIGNMENT);
    for grid in grids(frame) {
        words.extend(grid_record(grid, input_at));
        input_at += (depths_at(grid) + grid.depths.len()).next_multiple_of(GRID_ALIGNMENT);
    }
    words.resize(places.styles, 0.0);
    for light in styles::all(frame) {
        words.extend(styles::record(program, light, &mut input_at));
    }
    words.resize(places.cells, 0.0);
    words.extend(cells.as_flattened());
    frame_row(program).filled(words.into_iter().map(f32::to_bits).collect())
}

/// The contents of `vol_input`: numbers of objects, grids, tables of styles.
#[must_use]
pub fn input_words(program: &Program, frame: &Frame) -> Vec<u32> {
    let mut words: Vec<u32> = Families::of(program).words(frame).into_iter().map(f32::to_bits).collect();
    for grid in grids(frame) {
        words.resize(words.len().next_multiple_of(GRID_ALIGNMENT), 0);
        let begin = words.len();
        words.extend(grid.columns.iter().flat_map(|column| column_words(grid, column)).map(f32::to_bits));
        words.resize(begin + depths_at(grid), 0);
        words.extend(grid.depths.iter().map(|depth| depth.to_bits()));
    }
    for table in styles::all(frame).flat_map(styles::tables) {
        words.resize(words.len().next_multiple_of(GRID_ALIGNMENT), 0);
        words.extend(table.iter().map(|number| number.to_bits()));
    }
    words
}

/// The grid of a light.
fn grid_of(frame: &Frame, light: usize) -> Option<&LightGrid> {
    frame.light_grids.get(light)?.as_deref()
}

/// The grids of all lights that have one.
fn grids(frame: &Frame) -> impl Iterator<Item = &LightGrid> {
    (0..frame.lights.len()).filter_map(|light| grid_of(frame, light))
}

/// Words from the first column of a grid to the first depth.
fn depths_at(grid: &LightGrid) -> usize {
    (GridColumn::WORDS * grid.columns.len()).next_multiple_of(GridColumn::ALIGNMENT)
}

fn column_words(grid: &LightGrid, column: &GridColumn) -> [f32; GridColumn::WORDS] {
    let at = (depths_at(grid) + column.at as usize) / GridColumn::ALIGNMENT;
    [column.first as f32, (column.count - 1) as f32, at as f32]
}

/// A grid without its columns, which begin at a word.
fn grid_record(grid: &LightGrid, columns_at: usize) -> [f32; GRID_WORDS] {
    let counts = grid.counts.map(|count| count as f32);
    let channels = grid.channels() as f32;
    let [u, v, w] = grid.axes;
    let vectors = [grid.origin, u, v, w, grid.lo, grid.scale, counts, grid.tint];
    let flag = |is: bool| f32::from(u8::from(is));
    let all = [flag(grid.distant)].into_iter().chain(vectors.into_iter().flatten());
    let all = all.chain([channels, columns_at as f32, flag(grid.spline)]);
    let mut words = [0.0; GRID_WORDS];
    words.iter_mut().zip(all).for_each(|(word, value)| *word = value);
    words
}

/// State, box and more numbers of an object or medium; nothing for an empty box.
fn record<const MORE: usize, const WORDS: usize>(
    state: f32,
    bounds: Option<Aabb>,
    more: [f32; MORE],
) -> [f32; WORDS] {
    let mut words = [0.0; WORDS];
    if let Some(Aabb { lo, hi }) = bounds {
        let all = [state].into_iter().chain(lo).chain(hi).chain(more);
        words.iter_mut().zip(all).for_each(|(word, value)| *word = value);
    }
    words
}

/// The contents of `vol_output` as a picture.
#[must_use]
pub fn unpack(width: u32, height: u32, words: &[u32]) -> Image {
    let pixel = |words: &[u32]| {
        let word = |index: usize| f32::from_bits(words[index]);
        Pixel {
            color: [word(0), word(1), word(2)],
            transmittance: [word(3), word(4), word(5)],
            depth: if word(6) < NO_DEPTH { word(6) } else { f32::INFINITY },
            error: word(14),
        }
    };
    Image { width, height, pixels: words.chunks_exact(PIXEL_WORDS).map(pixel).collect() }
}

/// How much was computed, of the contents of `vol_output`.
#[must_use]
pub fn counts(words: &[u32]) -> Counts {
    let mut counts = Counts::default();
    for pixel in words.chunks_exact(PIXEL_WORDS) {
        let [rays, samples, evaluations, camera_rays] = [7, 8, 9, 10].map(|index| u64::from(pixel[index]));
        counts = counts.plus(Counts { camera_rays, rays, samples, evaluations });
    }
    counts
}
