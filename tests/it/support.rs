//! Scenes and functions made ready for tests.

use libtest_mimic::{Failed, Trial};
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use vol_compiler::frame::{Frame, Image, Job, Quadrature, Sampling};
pub(crate) use vol_compiler::ir::verify::random::Random;
use vol_compiler::ir::{Function, FunctionId, Module};
use vol_compiler::program::Program;
use vol_compiler::skip::Skips;
use vol_language::Analysis;
use vol_language::diag::Diagnostic;
use vol_language::module::Loader;
use vol_language::source::{SourceFile, Sources};

/// The scenes of `examples/`, in alphabetical order.
pub(crate) fn examples() -> Vec<(String, PathBuf)> {
    scenes_in("examples")
}

/// The `.vol` files of a folder of the repository with their stems, sorted.
pub(crate) fn scenes_in(folder: &str) -> Vec<(String, PathBuf)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join(folder);
    let entries =
        std::fs::read_dir(&folder).map(|entries| entries.flatten().collect()).unwrap_or_else(|_| Vec::new());
    let mut scenes: Vec<(String, PathBuf)> = entries
        .into_iter()
        .map(|entry| entry.path())
        .filter(|path| path.extension().is_some_and(|extension| extension == "vol"))
        .map(|path| (path.file_stem().map(|s| s.to_string_lossy().into_owned()).unwrap_or_default(), path))
        .collect();
    scenes.sort();
    scenes
}

/// Analyses and compiles a scene text; the rendered messages are the error.
pub(crate) fn compile(name: &str, text: &str) -> Result<Program, Failed> {
    let (program, messages) = compile_with_messages(name, text);
    program.ok_or_else(|| messages.into())
}

/// Analyses and compiles a scene text and renders what there is to say about it.
pub(crate) fn compile_with_messages(name: &str, text: &str) -> (Option<Program>, String) {
    let Diagnosed { program, diagnostics, sources } = diagnose(SourceFile::new(name, text));
    (program, vol_language::diag::render::human(&sources, &diagnostics, false))
}

/// Compiles a correct scene text with some ways of leaving work out switched off.
pub(crate) fn compile_without(text: &str, skips: Skips) -> Result<Program, Failed> {
    let file = SourceFile::new("test.vol", text);
    let Analysis { scene, .. } = vol_language::analyse_with(file, &vol_compiler::library::library(), &Shared);
    let program = scene.and_then(|scene| vol_compiler::lower::compile_with(&scene, skips).0);
    program.ok_or_else(|| "the scene does not compile".into())
}

/// A scene as far as it goes, and what there is to say about it.
pub(crate) struct Diagnosed {
    /// Present if it compiles and its first frame can be made.
    pub(crate) program: Option<Program>,
    pub(crate) diagnostics: Vec<Diagnostic>,
    pub(crate) sources: Sources,
}

/// Analyses and compiles a scene and makes its first frame.
pub(crate) fn diagnose(file: SourceFile) -> Diagnosed {
    let Analysis { scene, mut diagnostics, sources } =
        vol_language::analyse_with(file, &vol_compiler::library::library(), &Shared);
    let mut program = None;
    if let Some(scene) = scene {
        let (compiled, more) = vol_compiler::lower::compile(&scene);
        program = compiled;
        diagnostics.extend(more);
    }
    let frame =
        program.as_ref().map(|ready| ready.frame(&ready.default_params(), 0.0, 0.0, ready.render.size));
    let frame = frame.map(|frame| styled(program.as_ref(), frame?, &sources));
    match (&program, frame) {
        (Some(ready), Some(Ok(frame))) => diagnostics.extend(vol_compiler::lints::warnings(ready, &frame)),
        (_, Some(Err(diagnostic))) => {
            diagnostics.push(diagnostic);
            program = None;
        }
        (_, None | Some(Ok(_))) => {}
    }
    Diagnosed { program, diagnostics, sources }
}

/// The frame with its styles prepared.
fn styled(program: Option<&Program>, mut frame: Frame, sources: &Sources) -> Result<Frame, Diagnostic> {
    let Some(program) = program else { return Ok(frame) };
    let images = match vol::styles::pictures(sources, program) {
        Ok(images) => images,
        Err(vol::failure::Failure::Scene { diagnostics, .. }) => {
            return Err(diagnostics.into_iter().next().expect("a failure has a reason"));
        }
        Err(_) => Vec::new(),
    };
    let prepared = vol_runtime_cpu::style::prepare(program, &frame, program.render.size, &images, &|_| None)?;
    frame.styled_lights = prepared.lights;
    Ok(frame)
}

/// Imports come from `tests/ui`.
struct Shared;

impl Loader for Shared {
    fn read(&self, path: &str) -> Result<SourceFile, String> {
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/ui").join(path);
        let text = std::fs::read_to_string(file).map_err(|_| "no such file".to_owned())?;
        Ok(SourceFile::new(path, text))
    }
}

/// Compiles a file of the repository.
pub(crate) fn compile_file(path: &Path) -> Result<Program, Failed> {
    let text = std::fs::read_to_string(path).map_err(|error| format!("{}: {error}", path.display()))?;
    compile(&path.display().to_string(), &text)
}

/// A frame at a time with default params.
pub(crate) fn frame(program: &Program, time: f64, size: [u32; 2]) -> Result<Frame, Failed> {
    frame_at(program, [time, 0.0], size)
}

/// A frame at a time and with a number, its styles prepared.
pub(crate) fn frame_at(program: &Program, [time, number]: [f64; 2], size: [u32; 2]) -> Result<Frame, Failed> {
    let prepared = || {
        let mut frame = program.frame(&program.default_params(), time, number, size)?;
        let prepared = vol_runtime_cpu::style::prepare(program, &frame, size, &[], &|_| None)?;
        frame.styled_lights = prepared.lights;
        Ok::<_, Diagnostic>(frame)
    };
    prepared().map_err(|diagnostic| diagnostic.message.into())
}

/// A small picture on the CPU.
pub(crate) fn render(program: &Program, frame: &Frame, job: &Job, threads: usize) -> Result<Image, Failed> {
    let cancelled = AtomicBool::new(false);
    vol_runtime_cpu::render(program, frame, job, Some(threads), &|_| {}, &cancelled)
        .map(|(image, _)| image)
        .ok_or_else(|| "the render was cancelled by nobody".into())
}

/// Draws a frame of a program.
pub(crate) type Draw<'a> = dyn Fn(&Program, &Frame, &Job) -> Result<Image, Failed> + 'a;

/// A check of a backend.
pub(crate) type Body = fn(&Draw<'_>) -> Result<(), Failed>;

/// A check as a trial of each backend.
pub(crate) fn on_both(name: &str, body: Body) -> Vec<Trial> {
    vec![
        Trial::test(format!("{name}__cpu"), move || {
            body(&|program, frame, job| render(program, frame, job, 2))
        }),
        #[cfg(feature = "gpu")]
        crate::gpu_device::gpu_trial(name, move |gpu| {
            body(&|program, frame, job| draw_on_gpu(gpu, program, frame, job))
        }),
    ]
}

#[cfg(feature = "gpu")]
fn draw_on_gpu(
    gpu: &vol_runtime_gpu::Gpu,
    program: &Program,
    frame: &Frame,
    job: &Job,
) -> Result<Image, Failed> {
    let renderer = vol_runtime_gpu::Renderer::new(gpu, program)?;
    let drawn = renderer.render(gpu, program, frame, job, &|_| {}, &AtomicBool::new(false))?;
    Ok(drawn.ok_or("the render was cancelled by nobody")?.0)
}

/// A scene text rendered on the CPU with a given step.
pub(crate) fn picture(text: &str, size: [u32; 2], step: f32) -> Result<Image, Failed> {
    let program = compile("test.vol", text)?;
    let frame = frame(&program, 0.0, size)?;
    render(
        &program,
        &frame,
        &Job { size, step, shadow_step: step, quadrature: Quadrature::Midpoint, sampling: Sampling::CENTRE },
        2,
    )
}

/// A program that only holds one function, to evaluate it on every backend. Its curves are those of a
/// medium with two bent tubes.
pub(crate) fn program_of(function: Function) -> Result<Program, Failed> {
    let tubes = "medium a { region: tube(bezier((0, 0, 0), (0.4, 1.1, 0.2), (0, 2.2, 0)), radius: 0.3) }\n\
                 medium b { region: tube(bezier((-1, 0, 0), (0.2, 0.1, 0.9), (0.7, -1, 0)), radius: 0.2) }";
    let mut program = compile("function.vol", tubes)?;
    program.module = Module { frame: program.module.frame, functions: vec![function] };
    program.media.clear();
    program.tubes.clear();
    program.fields.clear();
    Ok(program)
}

/// The first function of [`program_of`].
pub(crate) const FIRST: FunctionId = FunctionId(0);

/// A point in a box.
pub(crate) fn point(random: &mut Random, lo: [f64; 3], hi: [f64; 3]) -> [f32; 3] {
    [0, 1, 2].map(|i| random.between(lo[i], hi[i]) as f32)
}

/// Fails with a message unless a condition holds.
pub(crate) fn ensure(condition: bool, message: impl FnOnce() -> String) -> Result<(), Failed> {
    if condition { Ok(()) } else { Err(message().into()) }
}

/// Fails unless a generated page of the repository holds `text`; with the environment variable
/// `VOL_UPDATE_DOCS` set it writes the page instead.
pub(crate) fn ensure_page(page: &str, text: &str) -> Result<(), Failed> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(page);
    if std::env::var_os("VOL_UPDATE_DOCS").is_some() {
        return Ok(std::fs::write(path, text)?);
    }
    let found = std::fs::read_to_string(&path).unwrap_or_default();
    ensure(found == text, || {
        format!("{page} is out of date: run `VOL_UPDATE_DOCS=1 cargo test --test it -- docs::`")
    })
}

/// Tubes side by side in a solid and in a medium: alike, of several kinds, and one tube in several places.
pub(crate) const MANY_TUBES: &str = "\
fn way(i: float) -> curve { bezier((-1.8 + 0.05 * i, -0.8, 0.11 * i - 0.5), (0.2 * i - 1, 0.9, 0), (1.8, -0.3 + 0.07 * i, 0.06 * i)) }
let strand = tube(helix(0.3, 2, 3), radius: 0.06)
object brush {
  shape: union([
    union([for i in 0..12: tube(way(i), radius: t => mix(0.03, 0.06 + 0.002 * i, t))]),
    union([for i in 0..3: tube(way(3 * i + 0.5), radius: 0.05, caps: round)]),
    union([for i in 0..4: strand.translate((0.5 * i - 0.7, -1, 0.1 * i))]),
  ])
  material: phong(0.04, q => rgb(0.5 + 0.2 * q.local.x, 0.5, 0.3), 0.5, 60)
}
medium smoke {
  region: union([for i in 0..5: tube(way(2 * i), radius: t => mix(0.2, 0.1, t)).translate((0, 0.4, 0.3))])
  density: q => 2 + q.local.x
  absorb: 0.1
  scatter: 0.3
  emit: 0.1
}
light sun { from: (0.2, 1, 0.4) }
camera { from: (0, 1, 6), at: (0, 0, 0), fov: 40deg }
";
