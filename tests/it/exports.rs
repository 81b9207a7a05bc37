//! Exported shaders: every language accepts every example, by a compiler that is not ours, and a library computes what
//! the scene says.

use crate::support::{MANY_TUBES, compile, compile_file, ensure, examples, frame};
use libtest_mimic::{Failed, Trial};
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use vol_compiler::export::{Form, Language, Source, export};
use vol_compiler::frame::{Job, Quadrature, Sampling};
use vol_compiler::program::Program;
use vol_compiler::wgsl::Notes;

/// Small, and coarse: only the text matters.
const JOB: Job = Job {
    size: [40, 24],
    step: 0.1,
    shadow_step: 0.2,
    quadrature: Quadrature::Corrected,
    sampling: Sampling::CENTRE,
};

/// The trials of this file.
pub(crate) fn trials() -> Vec<Trial> {
    let mut trials = Vec::new();
    let of_examples = examples().into_iter().map(|(name, path)| (name, Some(path)));
    for (name, path) in of_examples.chain([("many_tubes".into(), None)]) {
        let mut add = |what: &str, tool: Option<&str>, check: fn(&Program) -> Result<(), Failed>| {
            let path = path.clone();
            let trial =
                Trial::test(format!("exports::{name}_{what}"), move || check(&program_at(path.as_deref())?));
            trials.push(match tool.filter(|tool| !is_installed(tool)) {
                Some(tool) => trial.with_ignored_flag(true).with_kind(format!("{tool} is not installed")),
                None => trial,
            });
        };
        add("hlsl_and_msl", None, hlsl_and_msl);
        add("wgsl__tint", Some("tint"), wgsl);
        add("spirv__spirv_val", Some("spirv-val"), spirv);
        add("glsl__glslang", Some("glslangValidator"), glsl);
        add("shadertoy__glslang", Some("glslangValidator"), shadertoy);
        #[cfg(feature = "gpu")]
        if let Some(path) = path {
            trials.push(crate::gpu_device::gpu_trial(&format!("exports::{name}_library"), move |gpu| {
                on_gpu::library(gpu, &compile_file(&path)?)
            }));
        }
    }
    trials.push(Trial::test("exports::comments_point_at_the_scene", comments));
    trials
}

/// An example, or many tubes.
fn program_at(path: Option<&Path>) -> Result<Program, Failed> {
    path.map_or_else(|| compile("many tubes", MANY_TUBES), compile_file)
}

fn is_installed(tool: &str) -> bool {
    let found = Command::new(tool).arg("--version").stdout(Stdio::null()).stderr(Stdio::null()).status();
    found.is_ok()
}

fn exported(program: &Program, language: Language, form: Form) -> Result<Vec<u8>, Failed> {
    let frame = frame(program, 0.4, JOB.size)?;
    let no_line = |_| None;
    let source = Source {
        program,
        frame: &frame,
        job: &JOB,
        notes: &Notes::new(program, &no_line),
        title: &["a title".to_owned()],
        prefix: "sky",
    };
    Ok(export(&source, language, form).map_err(|error| error.to_string())?)
}

/// Runs a compiler on a file with these contents; `FILE` among the arguments is its name.
fn accepted(bytes: &[u8], extension: &str, tool: &str, arguments: &[&str]) -> Result<(), Failed> {
    let mut file = tempfile::Builder::new().suffix(extension).tempfile()?;
    file.write_all(bytes)?;
    file.flush()?;
    let name: PathBuf = file.path().to_owned();
    let arguments =
        arguments.iter().map(|&word| if word == "FILE" { name.as_path() } else { Path::new(word) });
    let output = Command::new(tool).args(arguments).output()?;
    ensure(output.status.success(), || {
        let text = [output.stdout, output.stderr].concat();
        let head: String = String::from_utf8_lossy(&text).chars().take(2000).collect();
        format!("{tool}: {head}")
    })
}

/// No compiler for these is at hand: naga's word must do.
fn hlsl_and_msl(program: &Program) -> Result<(), Failed> {
    for language in [Language::Hlsl, Language::Msl] {
        for (form, name) in [(Form::Module, "render"), (Form::Library, "sky_radiance")] {
            let text = String::from_utf8(exported(program, language, form)?)?;
            ensure(text.contains(&format!("{name}(")), || format!("{language:?}: no {name}"))?;
        }
    }
    Ok(())
}

fn wgsl(program: &Program) -> Result<(), Failed> {
    for form in [Form::Module, Form::Library] {
        let text = exported(program, Language::Wgsl, form)?;
        accepted(&text, ".wgsl", "tint", &["-f", "wgsl", "-o", "/dev/null", "FILE"])?;
    }
    Ok(())
}

fn spirv(program: &Program) -> Result<(), Failed> {
    let bytes = exported(program, Language::Spirv, Form::Module)?;
    accepted(&bytes, ".spv", "spirv-val", &["--target-env", "vulkan1.1", "FILE"])?;
    // What strict arithmetic hands to the driver.
    let shader = vol_compiler::wgsl::render::render_module(program, JOB.quadrature, [16, 4])?;
    let strict = vol_compiler::wgsl::strict_spirv(&shader.text, "render")?;
    let bytes: Vec<u8> = strict.words.into_iter().flat_map(u32::to_le_bytes).collect();
    accepted(&bytes, ".spv", "spirv-val", &["--target-env", "vulkan1.1", "FILE"])
}

fn glsl(program: &Program) -> Result<(), Failed> {
    let module = exported(program, Language::Glsl, Form::Module)?;
    for (stage, name) in [("comp", "COMPUTE"), ("vert", "VERTEX"), ("frag", "FRAGMENT")] {
        let define = format!("-DVOL_{name}");
        accepted(&module, ".glsl", "glslangValidator", &["-l", "-S", stage, &define, "FILE"])?;
    }
    let library = exported(program, Language::Glsl, Form::Library)?;
    let head = "#version 310 es\nprecision highp float;\nprecision highp int;\nout vec4 color;\n";
    let main = "void main() { color = sky_pixel(gl_FragCoord.xy) + sky_radiance(vec3(9.0), vec3(-1.0)); }\n";
    let text = [head.as_bytes(), &library, main.as_bytes()].concat();
    accepted(&text, ".frag", "glslangValidator", &["-S", "frag", "FILE"])
}

/// Behind what Shadertoy puts before and after a text.
fn shadertoy(program: &Program) -> Result<(), Failed> {
    let library = exported(program, Language::Shadertoy, Form::Library)?;
    let head = "#version 300 es\nprecision highp float;\nprecision highp int;\nuniform vec3 iResolution;\n\
        uniform float iTime;\nout vec4 color;\n";
    let main = "void main() { mainImage(color, gl_FragCoord.xy); }\n";
    let text = [head.as_bytes(), &library, main.as_bytes()].concat();
    accepted(&text, ".frag", "glslangValidator", &["-S", "frag", "FILE"])
}

fn comments() -> Result<(), Failed> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/tornado.vol");
    let program = compile_file(&path)?;
    let line = |span: vol_language::source::Span| Some(format!("byte {}", span.start));
    let frame = frame(&program, 0.0, JOB.size)?;
    let notes = Notes::new(&program, &line);
    let source =
        Source { program: &program, frame: &frame, job: &JOB, notes: &notes, title: &[], prefix: "vol" };
    let text = export(&source, Language::Wgsl, Form::Module).map_err(|error| error.to_string())?;
    let text = String::from_utf8(text)?;
    let comments = text.lines().filter(|line| line.trim_start().starts_with("// byte ")).count();
    ensure(comments > 20, || format!("{comments} comments"))?;
    ensure(text.contains("fn vol_f2_region_cloud("), || "functions do not have their names".into())
}

#[cfg(feature = "gpu")]
mod on_gpu {
    use super::{Form, JOB, Language, ensure, exported};
    use crate::support::{frame, render};
    use libtest_mimic::Failed;
    use vol::compare;
    use vol_compiler::export::entries;
    use vol_compiler::program::Program;
    use vol_compiler::wgsl::Space;
    use vol_runtime_gpu::{Gpu, groups_for};

    /// Points of each function.
    const POINTS: u32 = 100;

    /// All functions of a library in one shader of another program: fields at points against the reference and its
    /// bounds, and a picture of what has no media against that of the CPU.
    pub(super) fn library(gpu: &Gpu, program: &Program) -> Result<(), Failed> {
        let frame = frame(program, 0.4, JOB.size)?;
        let mut text = String::from_utf8(exported(program, Language::Wgsl, Form::Library)?)?;
        let fields: Vec<(usize, String)> = entries(program, &frame)
            .into_iter()
            .filter_map(|entry| Some((entry.field?, entry.name)))
            .collect();
        let outputs = |field: usize| program.module.function(program.fields[field].function).outputs.len();
        let width: usize = 4 + fields.iter().map(|&(field, _)| outputs(field)).sum::<usize>();
        text += &format!(
            "@group(0) @binding(0) var<storage, read> points: array<f32>;\n\
             @group(0) @binding(1) var<storage, read_write> values: array<f32>;\n\
             @compute @workgroup_size(64) fn main(@builtin(global_invocation_id) id: vec3u) {{\n\
             let p = vec3f(points[3u * id.x], points[(3u * id.x) + 1u], points[(3u * id.x) + 2u]);\n\
             let at = {width}u * id.x;\n"
        );
        let mut column = 0;
        for (field, name) in &fields {
            let count = outputs(*field);
            text += &format!("let v{field} = sky_{name}(p);\n");
            for i in 0..count {
                let part = if count == 1 { String::new() } else { format!("[{i}]") };
                text += &format!("values[at + {}u] = v{field}{part};\n", column + i);
            }
            column += count;
        }
        let [columns, rows] = JOB.size;
        text += &format!(
            "let c = sky_pixel(vec2f(f32(id.x % {columns}u), f32(id.x / {columns}u)) + 0.5);\n\
             values[at + {column}u] = c.x; values[at + {}u] = c.y; values[at + {}u] = c.z; values[at + {}u] = c.w;\n}}\n",
            column + 1,
            column + 2,
            column + 3
        );
        let pixels = columns * rows;
        let scattered = compare::scatter(&frame.bounds, POINTS);
        let mut points = scattered.clone();
        points.resize((pixels as usize).next_multiple_of(64), [0.0; 3]);
        let kernel = gpu.kernel("library", &text, "main", &[Space::Storage])?;
        let input = gpu.upload_f32(points.as_flattened())?;
        let output = gpu.zeroed(points.len() * width)?;
        gpu.dispatch(&kernel, &[&input], &output, groups_for(points.len() as u32, 64)?)?;
        let values = gpu.read_f32(&output)?;
        let mut column = 0;
        for (field, name) in fields {
            let function = program.module.function(program.fields[field].function);
            let (count, expected) = (outputs(field), compare::expected(function, &frame, &scattered));
            let found: Vec<f32> = values
                .chunks_exact(width)
                .take(scattered.len())
                .flat_map(|row| &row[column..column + count])
                .copied()
                .collect();
            let report = compare::field(&found, &expected, count);
            ensure(report.passes(), || format!("{name}: {report:?}"))?;
            column += count;
        }
        if program.media.is_empty() {
            let cpu = render(program, &frame, &JOB, 2)?;
            let apart = cpu.pixels.iter().zip(values.chunks_exact(width)).filter(|(pixel, row)| {
                pixel.color.iter().zip(&row[column..]).any(|(a, b)| (a - b).abs() > 1e-3 * a.abs().max(1.0))
            });
            let apart = apart.count();
            ensure(apart * 100 <= pixels as usize, || format!("{apart} of {pixels} pixels differ"))?;
        }
        Ok(())
    }
}
