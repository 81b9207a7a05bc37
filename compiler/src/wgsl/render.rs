//! The whole shader of a program, and the numbers of a frame as its input.
//!
//! The text depends on the program and the quadrature alone: params, time and switches change only the words
//! of the buffers, so a pipeline is built once per scene, or twice where both quadratures are used. [`render_module`] puts together
//!
//! 1. a comment on the bindings,
//! 2. the bindings, the prelude and the program's functions ([`super::functions`]),
//! 3. constants and functions that tell the integrator what there is (this file),
//! 4. the integrator, `render.wgsl` and its folder, the twin of `runtime-cpu/src/render`,
//! 5. the entry points, `render/pixel.wgsl`, for other programs also `render/paint.wgsl`.
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
//! | 27 + 8 objects | `AT_MEDIA` | 9 words per medium of the program: state (0 absent, 1 lights do not matter, 2 unshadowed, 3 shadowed), lo xyz, hi xyz, word of its first cell in `vol_input`, number of its cells |
//! | after them | `AT_LIGHTS` | 12 words per light of the program, those of the frame first: distant, position or direction xyz, color rgb, shadows, size, distance of occlusion, word of its grid (0: none), word of its style's record (0: none) |
//! | after them | `AT_GRIDS` | 28 words per light of the program, the grids of the frame first, see [`LightGrid`]: distant, origin xyz, u xyz, v xyz, w xyz, lo, scale and counts along u, v, w, tint rgb, words per point (1 or 3), word of its first depth in `vol_input`, whether it is a spline |
//! | after them | | records of the program's styles, those of the frame's lights first, see [`styles`] |
//!
//! `vol_input`, binding 4, holds what may be long, [`input_words`]: the cells, 6 words each, lo xyz, hi xyz (a medium without cells may
//! be anywhere in its box), then the depths of the grids, then for each styled light slopes, transfer
//! function, light map and means; each of these from a multiple of 64 words on.
//!
//! All words are f32; whole numbers, below 2^24, are exact, and no word is a denormal that a device
//! might flush.

mod styles;

use super::layout::{self, Row, SceneRows};
use super::{Notes, Shader, Space, WgslError, names};
use crate::frame::styled::TRANSFER_SIZE;
use crate::frame::{Aabb, Counts, Frame, Image, Job, LightGrid, MediumFrame, Pixel, Quadrature, Stride};
use crate::ir::FunctionId;
use crate::program::style::Shafts;
use crate::program::{Lighting, Program};
use std::fmt::Write;

/// The integrator.
const INTEGRATOR: [&str; 16] = [
    include_str!("render.wgsl"),
    include_str!("render/sampling.wgsl"),
    include_str!("render/camera.wgsl"),
    include_str!("render/stride.wgsl"),
    include_str!("render/surface.wgsl"),
    include_str!("render/shade.wgsl"),
    include_str!("render/shadow.wgsl"),
    include_str!("render/light_grid.wgsl"),
    include_str!("render/penumbra.wgsl"),
    include_str!("render/occlusion.wgsl"),
    include_str!("render/comb.wgsl"),
    include_str!("render/chord.wgsl"),
    include_str!("render/panel.wgsl"),
    include_str!("render/scatter.wgsl"),
    include_str!("render/corrected.wgsl"),
    include_str!("render/medium.wgsl"),
];

/// Invocations of a workgroup along x and y, where none is asked for.
pub const WORKGROUP: [u32; 2] = [8, 8];

/// Entry point of a compute shader.
const PIXEL: &str = include_str!("render/pixel.wgsl");

/// Entry points of a vertex and a fragment shader.
const PAINT: &str = include_str!("render/paint.wgsl");

/// Words before the objects.
const HEADER_WORDS: usize = 27;

/// Words of an object.
const OBJECT_WORDS: usize = 8;

/// Words of a light.
const LIGHT_WORDS: usize = 12;

/// Words of a medium.
const MEDIUM_WORDS: usize = 9;

/// Words of a cell.
const CELL_WORDS: usize = 6;

/// Words of a grid, without its depths.
const GRID_WORDS: usize = 28;

/// Depths begin at multiples of this many words: so their places are exact in f32 up to 2^30.
const GRID_ALIGNMENT: usize = 64;

/// Words of `vol_output` per pixel.
pub const PIXEL_WORDS: usize = 15;

/// Depth that stands for "no surface"; the shader writes 1e30.
const NO_DEPTH: f32 = 1e29;

/// Boxes end here on every axis: "infinite" for both backends.
const INFINITE: f32 = 1e6;

/// Places in the header, in words.
const HEADER: [(&str, usize); 13] = [
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

const BINDINGS: &str = "\
// A vol scene as a compute shader. Entry point: render, workgroups of 8 x 8 over a rectangle.
//
// Bindings, all in group 0:
//   0 vol_uniforms     numbers of the frame
//   1 vol_curves       curves of the frame
//   2 vol_permutation  table of the noise
//   3 vol_frame        f32: the rectangle, the camera, what is there; see the constants AT_...
//   4 vol_input        f32: cells around media, depths of the grids of lights
//   5 vol_output       u32: 15 words per pixel of the whole picture, rows from the top, 0 before
//                      the first dispatch: bits of f32: radiance rgb, transmittance rgb, depth (1e30:
//                      none); whole numbers, how much was computed: rays, samples of media,
//                      evaluations, camera rays; where the pixel is: samples in the mean, bits of
//                      f32 of the spread of the radiance and of the transmittance; bits of f32 of
//                      how far the radiance is from the one by every other node of the media
";

/// The complete shader of a program, for jobs with one quadrature; without media there is no difference.
///
/// * `workgroup`: invocations along x and y, at most 256 together; no picture depends on it
///
/// # Errors
///
/// If naga does not accept the text, which is a fault of this crate.
pub fn render_module(
    program: &Program,
    quadrature: Quadrature,
    workgroup: [u32; 2],
) -> Result<Shader, WgslError> {
    let text = module_text(program, quadrature, None, &[&pixel(workgroup)]);
    super::validate(&text)?;
    Ok(Shader { text, inputs: spaces(program) })
}

/// What kind of buffer each input of the shader is, by binding.
#[must_use]
pub fn spaces(program: &Program) -> Vec<Space> {
    let rows = SceneRows::of(program).all().into_iter().chain([frame_row(program), input_row()]);
    rows.map(|row| row.space()).collect()
}

/// The same for other programs: with notes about its lines, and a fragment shader beside the compute shader.
///
/// # Errors
///
/// As [`render_module`].
pub fn shared_module(
    program: &Program,
    quadrature: Quadrature,
    notes: &Notes<'_>,
) -> Result<Shader, WgslError> {
    let text = module_text(program, quadrature, Some(notes), &[&pixel(WORKGROUP), PAINT]);
    super::validate(&text)?;
    Ok(Shader { text, inputs: spaces(program) })
}

fn pixel([width, height]: [u32; 2]) -> String {
    format!("const GROUP_WIDTH: u32 = {width}u;\nconst GROUP_HEIGHT: u32 = {height}u;\n{PIXEL}")
}

/// The integrator, with styles or without.
fn integrator(program: &Program) -> String {
    format!("{}\n{}", INTEGRATOR.join("\n"), styles::text(program))
}

fn module_text(
    program: &Program,
    quadrature: Quadrature,
    notes: Option<&Notes<'_>>,
    entries: &[&str],
) -> String {
    let rows = SceneRows::of(program);
    let bindings: String = [frame_row(program), input_row()].iter().map(Row::declaration).collect();
    let functions = super::functions(program, &rows, notes);
    [
        &format!("{BINDINGS}\n{}{bindings}", super::declarations(&rows)),
        &functions,
        &glue(program, quadrature),
        &integrator(program),
        &entries.join("\n"),
    ]
    .map(String::as_str)
    .join("\n")
}

/// A program at one moment as functions without bindings and without entry points: what is a buffer elsewhere is a
/// constant here. It has no statistics.
///
/// * `job`: the picture's size and how media are sampled
/// * `keyword`: what declares the constants. Translated to SPIR-V, a `const` is copied wherever it is read, a `var<private>`
///   is not; translated to MSL it is the other way round
pub(crate) fn library_text(
    program: &Program,
    frame: &Frame,
    job: &Job,
    notes: &Notes<'_>,
    keyword: &str,
) -> String {
    let places = layout::curve_places(frame);
    let rows = SceneRows::of(program).fixed(&places);
    let whole = [0, 0, job.size[0], job.size[1]];
    let mut words = super::scene_words(program, frame);
    // Whole numbers about curves follow, which the text spells where it needs them.
    words[0].truncate(program.module.frame.outputs.len());
    let mut text: String =
        rows.all().iter().zip(&words).map(|(row, words)| row.constants(words, keyword)).collect();
    text +=
        &frame_row(program).constants(&frame_words(program, frame, job, whole, job.sampling.most), keyword);
    text += &input_row().constants(&input_words(frame), keyword);
    for part in
        [&super::functions(program, &rows, Some(notes)), &glue(program, job.quadrature), &integrator(program)]
    {
        text.push('\n');
        let lines = part.lines().filter(|line| !line.contains("counted_"));
        lines.for_each(|line| text.extend([line, "\n"]));
    }
    text
}

/// Where things begin in `vol_frame`.
struct Places {
    media: usize,
    lights: usize,
    grids: usize,
    styles: usize,
    end: usize,
}

impl Places {
    fn of(program: &Program) -> Self {
        let media = HEADER_WORDS + OBJECT_WORDS * program.objects.len();
        let lights = media + MEDIUM_WORDS * program.media.len();
        let grids = lights + LIGHT_WORDS * program.lights.len();
        let styles = grids + GRID_WORDS * program.lights.len();
        Self { media, lights, grids, styles, end: styles + styles::WORDS * program.styles.len() }
    }
}

/// Names of places in `vol_frame` and their words, as the text knows them.
#[must_use]
pub fn places(program: &Program) -> Vec<(&'static str, usize)> {
    let of = Places::of(program);
    let records = [("AT_OBJECTS", HEADER_WORDS), ("AT_MEDIA", of.media), ("AT_LIGHTS", of.lights)];
    HEADER.into_iter().chain(records).chain([("AT_GRIDS", of.grids)]).collect()
}

/// Loops of the integrator that end by a count, and the most turns of each: no loop is without a bound.
pub const LOOP_BOUNDS: [(&str, u32, &str); 5] = [
    ("MAX_STEPS", 2000, "steps of a ray to a surface"),
    ("MAX_NODES", 16384, "samples of media along a ray"),
    ("TRIES", 8, "looks ahead for the steepness of a field"),
    ("PLACE_COUNT", 19, "places of a light with a size"),
    ("MAX_PROBES", 4096, "places of a stretch at which its light is marched"),
];

fn frame_row(program: &Program) -> Row {
    Row::new(3, "vol_frame", Places::of(program).end)
}

fn input_row() -> Row {
    Row::long(4, "vol_input")
}

/// Constants and functions that the integrator needs to know a program.
fn glue(program: &Program, quadrature: Quadrature) -> String {
    let mut text =
        String::from("// ---- this program ------------------------------------------------------------\n\n");
    let (objects, media) = (program.objects.len(), program.media.len());
    let places = Places::of(program);
    let counts = [
        ("OBJECT_COUNT", objects),
        ("MEDIUM_COUNT", media),
        // Arrays cannot be empty.
        ("OBJECT_SLOTS", objects.max(1)),
        ("MEDIUM_SLOTS", media.max(1)),
        ("LIGHT_SLOTS", program.lights.len().max(1)),
        ("TRANSFER_SIZE", TRANSFER_SIZE as usize),
        ("OBJECT_WORDS", OBJECT_WORDS),
        ("MEDIUM_WORDS", MEDIUM_WORDS),
        ("CELL_WORDS", CELL_WORDS),
        ("LIGHT_WORDS", LIGHT_WORDS),
        ("PIXEL_WORDS", PIXEL_WORDS),
        ("AT_OBJECTS", HEADER_WORDS),
        ("AT_MEDIA", places.media),
        ("AT_LIGHTS", places.lights),
    ];
    for (name, value) in HEADER.iter().chain(&counts) {
        text += &format!("const {name}: u32 = {value}u;\n");
    }
    // What no light asks for, and the other quadrature, is left out by the device's compiler.
    let lights = &program.lights;
    let switches = [
        ("CORRECTED", quadrature == Quadrature::Corrected),
        ("SOFT_LIGHTS", lights.iter().any(|light| light.size.is_some())),
        ("OCCLUDING_LIGHTS", lights.iter().any(|light| light.occlusion.is_some())),
        ("LIGHT_GRIDS", media > 0 && !lights.is_empty()),
        ("STYLES", !program.styles.is_empty()),
        ("MARCHED_SHAFTS", program.styles.iter().any(|style| style.shafts == Shafts::Exact)),
    ];
    for (name, value) in switches {
        text += &format!("const {name}: bool = {value};\n");
    }
    for pick in picks(program) {
        text += &pick.wgsl(program);
    }
    if !program.styles.is_empty() {
        text += &styles::fields(program).wgsl(program);
    }
    text
}

/// A function that picks the function of one object or medium by index.
struct Pick<'a> {
    signature: &'a str,
    /// Its result for an index out of range.
    otherwise: &'a str,
    /// Arguments passed on.
    arguments: &'a str,
    /// One function per index; where there is none the result is that for an index out of range.
    functions: Vec<Option<FunctionId>>,
    /// What becomes of the result `v` of a function.
    result: &'a str,
    /// Private variables that count the calls.
    counters: &'a [&'a str],
}

impl Pick<'_> {
    fn wgsl(&self, program: &Program) -> String {
        let mut text = format!("\nfn {} {{\n", self.signature);
        for counter in self.counters {
            let _ = writeln!(text, "    {counter} += 1u;");
        }
        text += "    switch index {\n";
        for (index, function) in self.functions.iter().enumerate() {
            let Some(function) = function else { continue };
            let name = names::function(function.index(), &program.module.function(*function).name);
            let call = format!("let v = {name}({});", self.arguments);
            let _ = writeln!(
                text,
                "        case {index}u: {{\n            {call}\n            return {};\n        }}",
                self.result
            );
        }
        let _ = writeln!(
            text,
            "        default: {{\n            return {};\n        }}\n    }}\n}}",
            self.otherwise
        );
        text
    }
}

fn picks(program: &Program) -> [Pick<'static>; 8] {
    let of_objects =
        |pick: fn(&crate::program::Object) -> Option<FunctionId>| program.objects.iter().map(pick).collect();
    let of_media =
        |pick: fn(&crate::program::Medium) -> FunctionId| program.media.iter().map(pick).map(Some).collect();
    let point = |signature, otherwise, functions, result, counters| Pick {
        signature,
        otherwise,
        arguments: "p.x, p.y, p.z",
        functions,
        result,
        counters,
    };
    const SEARCH: &[&str] = &["counted_evaluations"];
    const SAMPLE: &[&str] = &["counted_evaluations", "counted_samples"];
    [
        point(
            "object_distance(index: u32, p: vec3f) -> f32",
            "FAR",
            of_objects(|o| Some(o.distance)),
            "v",
            SEARCH,
        ),
        point(
            "object_gradient(index: u32, p: vec3f) -> vec3f",
            "vec3f(0.0)",
            of_objects(|o| Some(o.gradient)),
            "v",
            SEARCH,
        ),
        Pick {
            signature: "object_steepness(index: u32, lo: vec3f, hi: vec3f) -> f32",
            otherwise: "1.0",
            arguments: "lo.x, lo.y, lo.z, hi.x, hi.y, hi.z",
            functions: of_objects(|o| o.steepness),
            result: "v",
            counters: SEARCH,
        },
        point(
            "object_surface(index: u32, p: vec3f) -> Response",
            "Response(vec3f(0.0), vec3f(0.0), vec3f(0.0), 0.0)",
            of_objects(|o| Some(o.surface)),
            "Response(vec3f(v.v0, v.v1, v.v2), vec3f(v.v3, v.v4, v.v5), vec3f(v.v6, v.v7, v.v8), v.v9)",
            &[],
        ),
        point("medium_region(index: u32, p: vec3f) -> f32", "FAR", of_media(|m| m.region), "v", SEARCH),
        point(
            "medium_interior(index: u32, p: vec3f) -> Interior",
            "Interior(0.0, vec3f(0.0), vec3f(0.0), vec3f(0.0))",
            of_media(|m| m.interior),
            "Interior(v.v0, vec3f(v.v1, v.v2, v.v3), vec3f(v.v4, v.v5, v.v6), vec3f(v.v7, v.v8, v.v9))",
            SAMPLE,
        ),
        point(
            "medium_extinction(index: u32, p: vec3f) -> vec4f",
            "vec4f(0.0)",
            of_media(|m| m.extinction),
            "v",
            SAMPLE,
        ),
        Pick {
            signature: "medium_phase(index: u32, less: f32, more: f32) -> f32",
            otherwise: "0.0",
            arguments: "less, more",
            functions: of_media(|m| m.phase),
            result: "v",
            counters: &[],
        },
    ]
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
    let mut cells_at = 0;
    for medium in &frame.media {
        let state = match medium.lighting {
            Lighting::None => 1.0,
            Lighting::Unshadowed => 2.0,
            Lighting::Shadowed => 3.0,
        };
        let cells = padded_cells(medium).len();
        media[medium.index] = record(state, padded(&medium.bounds), [cells_at as f32, cells as f32]);
        cells_at += CELL_WORDS * cells;
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
    let mut depths_at = cells_at.next_multiple_of(GRID_ALIGNMENT);
    for grid in grids(frame) {
        words.extend(grid_record(grid, depths_at));
        depths_at += grid.depths.len().next_multiple_of(GRID_ALIGNMENT);
    }
    words.resize(places.styles, 0.0);
    for light in styles::all(frame) {
        words.extend(styles::record(program, light, &mut depths_at));
    }
    frame_row(program).filled(words.into_iter().map(f32::to_bits).collect())
}

/// The contents of `vol_input`: cells of media, depths of grids.
#[must_use]
pub fn input_words(frame: &Frame) -> Vec<u32> {
    let cells = frame.media.iter().flat_map(padded_cells).flat_map(|cell| [cell.lo, cell.hi]).flatten();
    let mut words: Vec<u32> = cells.map(f32::to_bits).collect();
    for grid in grids(frame) {
        words.resize(words.len().next_multiple_of(GRID_ALIGNMENT), 0);
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

/// A grid without its depths, which begin at a word.
fn grid_record(grid: &LightGrid, depths_at: usize) -> [f32; GRID_WORDS] {
    let counts = grid.counts.map(|count| count as f32);
    let channels = if grid.colored { 3.0 } else { 1.0 };
    let [u, v, w] = grid.axes;
    let vectors = [grid.origin, u, v, w, grid.lo, grid.scale, counts, grid.tint];
    let flag = |is: bool| f32::from(u8::from(is));
    let all = [flag(grid.distant)].into_iter().chain(vectors.into_iter().flatten());
    let all = all.chain([channels, depths_at as f32, flag(grid.spline)]);
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

#[cfg(test)]
mod tests;
