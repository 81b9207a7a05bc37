//! The whole shader of a program, and the numbers of a frame as its input.
//!
//! The text depends on the program and the quadrature alone: params, time and switches change only the words
//! of the buffers, so a pipeline is built once per scene, or twice where both quadratures are used. [`render_module`] puts together
//!
//! 1. a comment on the bindings,
//! 2. the bindings, the prelude and the program's functions ([`super::functions`]),
//! 3. constants and functions that tell the integrator what there is ([`mod@glue`]),
//! 4. the integrator, `render.wgsl` and its folder, the twin of `runtime-cpu/src/render`,
//! 5. the entry points, `render/pixel.wgsl`, for other programs also `render/paint.wgsl`.
//!
//! What the words of the buffers mean, and the words of a frame: [`words`].

mod glue;
mod styles;
mod words;

use super::layout::{self, Row, SceneRows};
use super::{Notes, Shader, Space, WgslError};
use crate::families::Families;
use crate::frame::{Frame, Job, Quadrature};
use crate::ir::FunctionId;
use crate::program::Program;
use glue::glue;
use std::collections::BTreeSet;
use std::fmt::Write;
pub use words::{PIXEL_WORDS, counts, frame_words, input_words, padded, padded_cells, places, unpack};
use words::{frame_row, input_row};

/// The integrator, but for what depends on the quadrature.
const INTEGRATOR: [&str; 14] = [
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
    include_str!("render/spacing.wgsl"),
    include_str!("render/comb.wgsl"),
    include_str!("render/scatter.wgsl"),
    include_str!("render/medium.wgsl"),
];

/// Rays through media by the midpoint rule.
const MIDPOINT: [&str; 1] = [include_str!("render/midpoint.wgsl")];

/// The same by the corrected form.
const CORRECTED: [&str; 3] = [
    include_str!("render/chord.wgsl"),
    include_str!("render/panel.wgsl"),
    include_str!("render/corrected.wgsl"),
];

/// Invocations of a workgroup along x and y, where none is asked for.
pub const WORKGROUP: [u32; 2] = [8, 8];

/// Entry point of a compute shader.
const PIXEL: &str = include_str!("render/pixel.wgsl");

/// Entry points of a vertex and a fragment shader.
const PAINT: &str = include_str!("render/paint.wgsl");

/// Most media for which the integrator is written out.
const MOST_WRITTEN_OUT: usize = 4;

/// Begins the text.
const BINDINGS: &str = "\
// A vol scene as a compute shader. Entry point: render, workgroups of 8 x 8 over a rectangle.
//
// Bindings, all in group 0:
//   0 vol_uniforms     numbers of the frame
//   1 vol_curves       curves of the frame
//   2 vol_permutation  table of the noise
//   3 vol_frame        f32: the rectangle, the camera, what is there; see the constants AT_...
//   4 vol_input        f32: numbers of objects, depths of the grids of lights, tables of styles
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

/// The integrator with one quadrature, with styles or without. Drivers take long over what is never called, too.
fn integrator(program: &Program, quadrature: Quadrature) -> String {
    let form = match quadrature {
        Quadrature::Midpoint => MIDPOINT.join("\n"),
        Quadrature::Corrected => CORRECTED.join("\n"),
    };
    let text = format!("{}\n{form}\n{}", INTEGRATOR.join("\n"), styles::text(program));
    if program.media.len() > MOST_WRITTEN_OUT { text } else { written_out(&text, program.media.len()) }
}

/// How the integrator loops over media.
const MEDIA_LOOP: &str = "for (var medium = 0u; medium < MEDIUM_COUNT; medium++) {\n";

/// A text with its loops over media written out. Drivers unroll none that holds the fields of a medium, and keep an array whose
/// index they do not know in slow memory.
fn written_out(text: &str, media: usize) -> String {
    let mut out = String::with_capacity(2 * text.len());
    let mut rest = text;
    while let Some((before, after)) = rest.split_once(MEDIA_LOOP) {
        let indent = &before[before.rfind('\n').map_or(0, |end| end + 1)..];
        let end = format!("\n{indent}}}\n");
        let Some((body, after)) = after.split_once(&end) else { break };
        out.push_str(before.strip_suffix(indent).unwrap_or(before));
        for medium in 0..media {
            let _ = write!(out, "{indent}{{\n{indent}    let medium = {medium}u;\n{body}{end}");
        }
        rest = after;
    }
    out + rest
}

fn module_text(
    program: &Program,
    quadrature: Quadrature,
    notes: Option<&Notes<'_>>,
    entries: &[&str],
) -> String {
    let rows = SceneRows::of(program);
    let bindings: String = [frame_row(program), input_row()].iter().map(Row::declaration).collect();
    let functions = asked_functions(program, &rows, notes);
    [
        &format!("{BINDINGS}\n{}{bindings}", super::declarations(&rows)),
        &functions,
        &glue(program, quadrature),
        &integrator(program, quadrature),
        &entries.join("\n"),
    ]
    .map(String::as_str)
    .join("\n")
}

/// The functions that the integrator calls, and where there are notes the fields, which others may call.
fn asked_functions(program: &Program, rows: &SceneRows<'_>, notes: Option<&Notes<'_>>) -> String {
    let (families, called) = (Families::of(program), glue::called(program));
    let fields: BTreeSet<FunctionId> =
        program.fields.iter().filter(|_| notes.is_some()).map(|field| field.function).collect();
    let is_asked = |id| fields.contains(&id) || (called.contains(&id) && families.number_of(id).is_none());
    super::functions(program, rows, notes, &is_asked)
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
    let mut numbers = frame_words(program, frame, job, whole, job.sampling.most);
    // Places for cells that no medium has.
    numbers.truncate(numbers.iter().rposition(|&word| word != 0).map_or(0, |last| last + 1));
    text += &frame_row(program).constants(&numbers, keyword);
    text += &input_row().constants(&input_words(program, frame), keyword);
    let functions = asked_functions(program, &rows, Some(notes));
    if functions.contains("vol_place_word(") {
        let (row, words) = rows.place_row();
        text += &row.constants(&words, keyword);
    }
    for part in [&functions, &glue(program, job.quadrature), &integrator(program, job.quadrature)] {
        text.push('\n');
        let lines = part.lines().filter(|line| !line.contains("counted_"));
        lines.for_each(|line| text.extend([line, "\n"]));
    }
    text
}

/// Loops of the integrator that end by a count, and the most turns of each: no loop is without a bound.
pub const LOOP_BOUNDS: [(&str, u32, &str); 5] = [
    ("MAX_STEPS", 2000, "steps of a ray to a surface"),
    ("MAX_NODES", 16384, "samples of media along a ray"),
    ("TRIES", 8, "looks ahead for the steepness of a field"),
    ("PLACE_COUNT", 19, "places of a light with a size"),
    ("MAX_PROBES", 4096, "places of a stretch at which its light is marched"),
];

#[cfg(test)]
mod tests;
