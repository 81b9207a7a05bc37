//! What a program that uses an exported shader must know, as JSON.
//!
//! * of a module: bindings with the words to put there, places in `vol_frame`, entry points
//! * of a library: functions
//! * of both: params, conventions, bounds of loops, and points with the values that functions must give there

use serde::Serialize;
use vol_compiler::export::{self, Form, Language, Source};
use vol_compiler::program::{Param, Program};
use vol_compiler::wgsl::{self, Space, names, render};

use crate::compare;

/// Points of each function.
const POINTS: u32 = 16;

#[derive(Serialize)]
struct Reflection<'a> {
    version: &'static str,
    language: String,
    form: String,
    moment: Moment<'a>,
    conventions: Conventions,
    params: Vec<ParamEntry<'a>>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    bindings: Vec<Binding>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    frame_words: Vec<Place>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    entry_points: Vec<EntryPoint>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    functions: Vec<FunctionEntry>,
    loop_bounds: Vec<LoopBound>,
    test_vectors: Vec<TestVectors<'a>>,
}

#[derive(Serialize)]
struct Moment<'a> {
    /// Seconds.
    time: f64,
    /// In the order of `params`; radians for angles, linear light for colours.
    params: &'a [Vec<f64>],
    size: [u32; 2],
    samples: u32,
    /// Distances between samples of media towards the camera and towards lights, scene units.
    steps: [f32; 2],
}

#[derive(Serialize)]
struct Conventions {
    coordinates: &'static str,
    picture: &'static str,
    color: &'static str,
    words: &'static str,
}

const CONVENTIONS: Conventions = Conventions {
    coordinates: "right-handed, y up, scene units",
    picture: "place (0, 0) is the upper left corner, rows downwards, in pixels",
    color: "scene-linear light with Rec. 709 primaries; alpha is 1 where nothing behind the scene shows",
    words: "contents are 32-bit words; a buffer of f32 holds their bits",
};

/// A param for programs.
#[derive(Debug, Serialize)]
pub struct ParamEntry<'a> {
    name: &'a str,
    r#type: String,
    /// One number per component; radians for angles, linear light for colours.
    default: &'a [f64],
    range: Option<(f64, f64)>,
    label: &'a str,
}

#[derive(Serialize)]
struct Binding {
    group: u32,
    binding: usize,
    name: &'static str,
    /// `uniform`, `storage, read` or `storage, read_write`.
    space: &'static str,
    contents: &'static str,
    bytes: usize,
    /// What it holds at this moment; none for the output, which starts as zeros.
    words: Option<Vec<u32>>,
}

#[derive(Serialize)]
struct Place {
    name: String,
    word: usize,
}

#[derive(Serialize)]
struct EntryPoint {
    name: &'static str,
    stage: &'static str,
    workgroup_size: Option<[u32; 3]>,
}

#[derive(Serialize)]
struct FunctionEntry {
    name: String,
    signature: String,
    meaning: String,
}

#[derive(Serialize)]
struct LoopBound {
    name: &'static str,
    most: u32,
    of: &'static str,
}

/// Values by the f64 reference; `tolerance` is what any conforming device may be off.
#[derive(Serialize)]
struct TestVectors<'a> {
    function: String,
    field: &'a str,
    points: Vec<[f32; 3]>,
    expected: Vec<Vec<f64>>,
    tolerance: Vec<Vec<f64>>,
}

/// The JSON of an export.
#[must_use]
pub fn json(source: &Source<'_>, language: Language, form: Form, time: f64, params: &[Vec<f64>]) -> String {
    let (program, job) = (source.program, source.job);
    let is_module = form == Form::Module;
    let reflection = Reflection {
        version: env!("CARGO_PKG_VERSION"),
        language: format!("{language:?}").to_lowercase(),
        form: format!("{form:?}").to_lowercase(),
        moment: Moment {
            time,
            params,
            size: job.size,
            samples: job.sampling.most,
            steps: [job.step, job.shadow_step],
        },
        conventions: CONVENTIONS,
        params: self::params(&program.params),
        bindings: if is_module { bindings(source) } else { Vec::new() },
        frame_words: if is_module { frame_words(program) } else { Vec::new() },
        entry_points: if is_module { entry_points() } else { Vec::new() },
        functions: if is_module { Vec::new() } else { functions(source) },
        loop_bounds: render::LOOP_BOUNDS
            .into_iter()
            .map(|(name, most, of)| LoopBound { name, most, of })
            .collect(),
        test_vectors: test_vectors(source, form),
    };
    serde_json::to_string_pretty(&reflection).expect("strings and numbers always become JSON") + "\n"
}

/// What a program must know of params.
#[must_use]
pub fn params(params: &[Param]) -> Vec<ParamEntry<'_>> {
    params.iter().map(entry).collect()
}

fn entry(param: &Param) -> ParamEntry<'_> {
    let Param { name, ty, default, range, label, .. } = param;
    ParamEntry { name, r#type: ty.to_string(), default, range: *range, label }
}

fn bindings(source: &Source<'_>) -> Vec<Binding> {
    let Source { program, frame, job, .. } = source;
    let [width, height] = job.size;
    let [uniforms, curves, permutation] = wgsl::scene_words(program, frame);
    let header = render::frame_words(program, frame, job, [0, 0, width, height], job.sampling.most);
    let input = render::input_words(program, frame);
    let spaces = render::spaces(program);
    let inputs = [
        ("vol_uniforms", "numbers of the frame, f32", uniforms),
        ("vol_curves", "curves of the frame, f32", curves),
        ("vol_permutation", "table of the noise, u32", permutation),
        ("vol_frame", "camera, objects, media, lights, f32; see frame_words", header),
        (
            "vol_input",
            "numbers of objects, depths of the grids of lights, tables of styles, f32; at least one word must be bound",
            input,
        ),
    ];
    let mut all: Vec<Binding> = inputs
        .into_iter()
        .zip(spaces)
        .enumerate()
        .map(|(binding, ((name, contents, words), space))| Binding {
            group: 0,
            binding,
            name,
            space: match space {
                Space::Uniform => "uniform",
                Space::Storage => "storage, read",
            },
            contents,
            bytes: 4 * words.len(),
            words: Some(words),
        })
        .collect();
    all.push(Binding {
        group: 0,
        binding: all.len(),
        name: "vol_output",
        space: "storage, read_write",
        contents: "of `render` alone: 15 words per pixel, radiance rgb first, as the shader's first comment says",
        bytes: 4 * render::PIXEL_WORDS * width as usize * height as usize,
        words: None,
    });
    all
}

fn frame_words(program: &Program) -> Vec<Place> {
    let spelled = |name: &str| name.trim_start_matches("AT_").to_lowercase();
    render::places(program).into_iter().map(|(name, word)| Place { name: spelled(name), word }).collect()
}

fn entry_points() -> Vec<EntryPoint> {
    let entry = |name, stage, workgroup_size| EntryPoint { name, stage, workgroup_size };
    vec![
        entry("render", "compute", Some([render::WORKGROUP[0], render::WORKGROUP[1], 1])),
        entry("cover", "vertex", None),
        entry("paint", "fragment", None),
    ]
}

fn functions(source: &Source<'_>) -> Vec<FunctionEntry> {
    let entries = export::entries(source.program, source.frame).into_iter();
    entries
        .map(|entry| FunctionEntry {
            name: format!("{}_{}", source.prefix, entry.name),
            signature: entry.signature,
            meaning: entry.meaning,
        })
        .collect()
}

/// Where a decision may fall either way there is nothing to test.
fn test_vectors<'a>(source: &Source<'a>, form: Form) -> Vec<TestVectors<'a>> {
    let Source { program, frame, .. } = source;
    let points = compare::scatter(&frame.bounds, POINTS);
    let entries = export::entries(program, frame).into_iter();
    let fields = entries.filter_map(|entry| Some((entry.field?, entry.name)));
    let of_field = |(index, name): (usize, String)| {
        let field = &program.fields[index];
        let function = program.module.function(field.function);
        let called = match form {
            Form::Module => names::function(field.function.index(), &function.name),
            Form::Library => format!("{}_{name}", source.prefix),
        };
        let mut vectors = TestVectors {
            function: called,
            field: &field.name,
            points: Vec::new(),
            expected: Vec::new(),
            tolerance: Vec::new(),
        };
        let all = compare::expected(function, frame, &points);
        for (point, row) in points.iter().zip(all.chunks_exact(function.outputs.len().max(1))) {
            if row.iter().all(|bounded| bounded.value.is_finite() && bounded.error.is_finite()) {
                vectors.points.push(*point);
                vectors.expected.push(row.iter().map(|bounded| bounded.value).collect());
                vectors.tolerance.push(row.iter().map(|bounded| bounded.error).collect());
            }
        }
        vectors
    };
    fields.map(of_field).collect()
}
