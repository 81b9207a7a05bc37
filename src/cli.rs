//! The command line as typed: clap structs and nothing else.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum};
use vol_compiler::skip::Skip;

use crate::commands::values::{self, FrameRange, Size};

/// Compiler and renderer for `.vol` scene scripts.
///
/// Exit codes: 0 fine; 1 the scene is at fault or a comparison failed; 2 wrong usage, or a file
/// could not be read or written; 3 no graphics device, or it was lost; 130 interrupted.
#[derive(Debug, Parser)]
#[command(name = "vol", version, propagate_version = true)]
pub(crate) struct Cli {
    /// What to do.
    #[command(subcommand)]
    pub(crate) command: Command,
}

/// The subcommands.
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Render a scene to a picture, or to one picture per frame
    Render(Render),
    /// Report the mistakes in scenes without rendering them
    Check(Check),
    /// List the params of a scene: type, default, range and label
    Params(Params),
    /// Lay out scenes in the one usual way
    Fmt(Fmt),
    /// Tell the story behind a code such as E0203, with a scene before and after
    Explain(Explain),
    /// Translate a scene to a shader
    Compile(Compile),
    /// Evaluate a field of a scene at given points
    Query(Query),
    /// Compare the CPU, the GPU and the f64 reference on a scene
    Diff(Diff),
    /// Look for trouble with the numbers of a scene: NaN, lost digits, jumps, steps too long, slow rays
    Stress(Stress),
    /// Measure run time against error over a ladder of settings
    Bench(Bench),
    /// Tell what each line of a scene costs
    Profile(Profile),
}

/// Which scene at which moment.
#[derive(Debug, Args)]
pub(crate) struct Scene {
    /// The scene script
    pub(crate) scene: PathBuf,
    /// Set a param, written as in the language: `-D spin=70deg`, `-D tint=#ffcc00`
    #[arg(short = 'D', value_name = "NAME=VALUE", value_parser = values::definition)]
    pub(crate) define: Vec<(String, String)>,
    /// Moment of the animation: `2s`, `500ms`, `1.5` (seconds) [default: 0s]
    #[arg(long, value_parser = values::time, allow_negative_numbers = true)]
    pub(crate) time: Option<f64>,
    /// Leave out all objects and media but these; may be given several times
    #[arg(long, value_name = "NAME")]
    pub(crate) only: Vec<String>,
    /// Leave out this object or medium; may be given several times
    #[arg(long, value_name = "NAME", conflicts_with = "only")]
    pub(crate) hide: Vec<String>,
    /// Do not leave out this part of the work, to see that it changes nothing; may be given several times.
    /// Names and what is left out under each: docs/performance.md
    #[arg(long, value_name = "NAME", value_parser = values::skip)]
    pub(crate) no_skip: Vec<Skip>,
}

/// Arguments of `vol render`.
#[derive(Debug, Args)]
pub(crate) struct Render {
    /// Scene, params and moment.
    #[command(flatten)]
    pub(crate) scene: Scene,
    /// The picture: `.png` (sRGB, 8 bit, opaque) or `.exr` (scene-linear float with alpha, depth
    /// and transmittance); with --frames a name in which `####` stands for the frame's number
    #[arg(short, long)]
    pub(crate) output: PathBuf,
    /// What computes the picture; `auto` takes a hardware GPU if there is one, else the CPU
    #[arg(long, value_enum, default_value_t = Backend::Auto)]
    pub(crate) backend: Backend,
    /// Have the GPU round each operation by itself, as the CPU does: slower, needs native Vulkan; pictures of both are then equal bit for
    /// bit on a device whose single operations round correctly
    #[arg(long)]
    pub(crate) strict: bool,
    /// Shape of the GPU's workgroups, at most 256 invocations; no picture depends on it [default: 8x8]
    #[arg(long, value_name = "WxH", value_parser = values::workgroup)]
    pub(crate) workgroup: Option<Size>,
    /// Picture size in pixels instead of the scene's
    #[arg(long, value_name = "WxH", value_parser = values::size)]
    pub(crate) size: Option<Size>,
    /// Render frames A to B, both included; frame f is at time f / fps
    #[arg(long, value_name = "A..B", value_parser = values::frames, conflicts_with = "time")]
    pub(crate) frames: Option<FrameRange>,
    /// CPU threads [default: as many as the machine has cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(crate) threads: Option<u16>,
    /// Seed of what is random: the paths of `--integrator monte-carlo` and `--jitter`. Nothing else is;
    /// it is recorded in --stats
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub(crate) seed: u64,
    /// How media along rays are integrated; all but `comb` are references to compare it with, on the CPU only
    #[arg(long, value_enum, default_value_t = Integrator::Comb)]
    pub(crate) integrator: Integrator,
    /// Settings of the reference integrators.
    #[command(flatten)]
    pub(crate) fixed: FixedStep,
    /// Error allowed from sampling media, root mean square over the picture relative to its
    /// brightness; the distance between samples of the comb is chosen to meet it [default: 0.01]
    #[arg(long, value_name = "E", value_parser = values::max_error)]
    pub(crate) max_error: Option<f32>,
    /// Multiply the distance between samples that was chosen, 0.01 to 100: for comparisons of time with
    /// error; the estimated error is that before [default: 1]
    #[arg(long, value_name = "F", value_parser = values::step_scale, allow_negative_numbers = true)]
    pub(crate) step_scale: Option<f32>,
    /// Compare with this picture, an `.exr` of `vol render` of the same size: root mean square difference
    /// of the colours relative to its brightness, in the summary and in --stats
    #[arg(long, value_name = "FILE.exr", conflicts_with = "frames")]
    pub(crate) reference: Option<PathBuf>,
    /// Rays per pixel, 1 to 4096, instead of the scene's; with an adaptive error the most of them
    /// [default: 1, with an adaptive error 65]; of `--integrator monte-carlo` the paths [default: 64]
    #[arg(long, value_name = "N", value_parser = values::samples, allow_negative_numbers = true)]
    pub(crate) samples: Option<u32>,
    /// Standard error of a pixel relative to its brightness at which it takes no more samples,
    /// instead of the scene's; 0 for as many samples everywhere
    #[arg(long, value_name = "E", value_parser = values::adaptive, allow_negative_numbers = true)]
    pub(crate) adaptive: Option<f32>,
    /// What else a picture shows, on the CPU only: an `.exr` gets channels for it beside those of the picture, a `.png`
    /// shows it instead, in false colours
    #[arg(long, value_enum, conflicts_with = "reference")]
    pub(crate) aov: Option<Aov>,
    /// Write the light map that a style fits to its strokes to this `.exr` or `.png`; of several each with the name of
    /// its style before the extension
    #[arg(long, value_name = "FILE")]
    pub(crate) light_map: Option<PathBuf>,
    /// Write the shadow map that a style has made to this `.exr` or `.png`, what is near the light white; of several each
    /// with the name of its style before the extension
    #[arg(long, value_name = "FILE")]
    pub(crate) shadow_map: Option<PathBuf>,
    /// Write what was done and how long it took to this JSON file
    #[arg(long, value_name = "FILE")]
    pub(crate) stats: Option<PathBuf>,
}

/// What a picture may show beside light.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Aov {
    /// What each pixel costs: operations and evaluations of the scene's functions
    Cost,
}

/// Settings of `--integrator fixed-step`.
#[derive(Debug, Args)]
pub(crate) struct FixedStep {
    /// Fixed step along camera rays, in scene units [default: a 96th of the diagonal of the box around the media]
    #[arg(long, value_name = "S", value_parser = values::step, allow_negative_numbers = true)]
    pub(crate) step: Option<f32>,
    /// Fixed step towards lights [default: as --step]
    #[arg(long, value_name = "S", value_parser = values::step, allow_negative_numbers = true)]
    pub(crate) light_step: Option<f32>,
    /// Sample each fixed step at a random place, by --seed, instead of in its middle
    #[arg(long)]
    pub(crate) jitter: bool,
    /// How fixed steps find tubes [default: cells]
    #[arg(long, value_enum)]
    pub(crate) tube_bounds: Option<TubeBounds>,
}

/// Arguments of `vol check`.
#[derive(Debug, Args)]
pub(crate) struct Check {
    /// The scene scripts
    #[arg(required = true, value_name = "SCENE")]
    pub(crate) scenes: Vec<PathBuf>,
    /// First repair in place each error for which there is exactly one repair; imported files stay
    /// as they are
    #[arg(long)]
    pub(crate) fix: bool,
    /// Also list what is left out of the work because the scene does not need it
    #[arg(short, long)]
    pub(crate) verbose: bool,
    /// `human` writes to stderr, `json` to stdout
    #[arg(long, value_enum, default_value_t = MessageFormat::Human)]
    pub(crate) message_format: MessageFormat,
}

/// Arguments of `vol params`.
#[derive(Debug, Args)]
pub(crate) struct Params {
    /// The scene script
    pub(crate) scene: PathBuf,
    /// `human` writes a line per param, `json` one list
    #[arg(long, value_enum, default_value_t = MessageFormat::Human)]
    pub(crate) message_format: MessageFormat,
}

/// Arguments of `vol fmt`.
#[derive(Debug, Args)]
pub(crate) struct Fmt {
    /// The scene scripts, rewritten in place; `-` is standard input, written to standard output
    #[arg(required = true, value_name = "SCENE")]
    pub(crate) scenes: Vec<PathBuf>,
    /// Write nothing; list the scenes that would change, exit code 1 if there are any
    #[arg(long)]
    pub(crate) check: bool,
    /// Write nothing; show what would change as a unified diff
    #[arg(long)]
    pub(crate) diff: bool,
}

/// Arguments of `vol explain`.
#[derive(Debug, Args)]
pub(crate) struct Explain {
    /// The code [default: list all codes]
    pub(crate) code: Option<String>,
}

/// Arguments of `vol compile`.
#[derive(Debug, Args)]
pub(crate) struct Compile {
    /// Scene, params and moment: of a module what the reflection says of its data, of a library all there is.
    #[command(flatten)]
    pub(crate) scene: Scene,
    /// The shader language
    #[arg(long, value_enum)]
    pub(crate) target: Target,
    /// A complete module with bindings and entry points, or functions of points and rays with the moment baked in
    /// [default: module, for Shadertoy library]
    #[arg(long = "as", value_enum, value_name = "FORM")]
    pub(crate) form: Option<ExportForm>,
    /// What all names of a library start with
    #[arg(long, default_value = "vol", value_parser = values::prefix)]
    pub(crate) prefix: String,
    /// Picture size in pixels instead of the scene's
    #[arg(long, value_name = "WxH", value_parser = values::size)]
    pub(crate) size: Option<Size>,
    /// Error allowed from sampling media, for the distance between samples
    #[arg(long, value_name = "E", default_value_t = 0.01, value_parser = values::max_error)]
    pub(crate) max_error: f32,
    /// Distance between samples of media in scene units, instead of one for an error; twice as much towards lights
    #[arg(long, value_name = "S", value_parser = values::step, conflicts_with = "max_error")]
    pub(crate) step: Option<f32>,
    /// Where to write it [default: standard output]
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: Option<PathBuf>,
    /// Also write what a caller must know, as JSON: bindings and their contents, params, conventions, test vectors
    #[arg(long, value_name = "FILE")]
    pub(crate) reflect: Option<PathBuf>,
}

/// Arguments of `vol query`.
#[derive(Debug, Args)]
pub(crate) struct Query {
    /// Scene, params and moment.
    #[command(flatten)]
    pub(crate) scene: Scene,
    /// `distance:NAME`, `gradient:NAME`, `density:NAME`, `colour:NAME`, `local:NAME`, or a top-level
    /// function of a position
    pub(crate) field: String,
    /// File with one point per line, `x,y,z`; blank lines and `#` comments are skipped; `-` is
    /// standard input
    #[arg(long, value_name = "FILE", default_value = "-")]
    pub(crate) at: PathBuf,
    /// What evaluates the field; the reference computes in f64 and rounds to nine digits
    #[arg(long, value_enum, default_value_t = QueryBackend::Reference)]
    pub(crate) backend: QueryBackend,
    /// Have the GPU round each operation by itself, as the CPU does: slower, needs native Vulkan; pictures of both are then equal bit for
    /// bit on a device whose single operations round correctly
    #[arg(long)]
    pub(crate) strict: bool,
}

/// Arguments of `vol diff`.
#[derive(Debug, Args)]
pub(crate) struct Diff {
    /// Scene, params and moment.
    #[command(flatten)]
    pub(crate) scene: Scene,
    /// Points at which each field is compared
    #[arg(long, value_name = "N", default_value_t = 10_000, value_parser = clap::value_parser!(u32).range(1..=10_000_000))]
    pub(crate) points: u32,
    /// Size of the compared pictures [default: the scene's, at most 256 pixels wide and high]
    #[arg(long, value_name = "WxH", value_parser = values::size)]
    pub(crate) size: Option<Size>,
    /// Also write how far apart the pictures are, a PNG in false colours: white where all bits are the same
    #[arg(long, value_name = "FILE.png")]
    pub(crate) difference: Option<PathBuf>,
    /// Have the GPU round each operation by itself, as the CPU does: slower, needs native Vulkan; pictures of both are then equal bit for
    /// bit on a device whose single operations round correctly
    #[arg(long)]
    pub(crate) strict: bool,
}

/// Arguments of `vol stress`.
#[derive(Debug, Args)]
pub(crate) struct Stress {
    /// Scene, params and moment.
    #[command(flatten)]
    pub(crate) scene: Scene,
    /// Places at which each function is tried; params are also set to the ends of their ranges, with
    /// a quarter of the places each
    #[arg(long, value_name = "N", default_value_t = 1000, value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    pub(crate) points: u32,
    /// Which places; equal seeds give equal reports
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub(crate) seed: u64,
    /// What computes in 32 bits beside the CPU; `auto` takes a hardware GPU if there is one
    #[arg(long, value_enum, default_value_t = Backend::Auto)]
    pub(crate) backend: Backend,
    /// `human` writes messages to stderr and a table to stdout, `json` both to stdout, one object a line
    #[arg(long, value_enum, default_value_t = MessageFormat::Human)]
    pub(crate) message_format: MessageFormat,
}

/// Arguments of `vol bench`.
#[derive(Debug, Args)]
pub(crate) struct Bench {
    /// Scene, params and moment.
    #[command(flatten)]
    pub(crate) scene: Scene,
    /// Folder for SCENE.csv, SCENE.md, SCENE.svg and SCENE.png, made where it is missing
    #[arg(short, long, value_name = "FOLDER", default_value = "bench")]
    pub(crate) output: PathBuf,
    /// What computes the pictures; `both` leaves the GPU out, with a note, where there is none
    #[arg(long, value_enum, default_value_t = BenchBackend::Both)]
    pub(crate) backend: BenchBackend,
    /// Size of the pictures [default: the scene's, at most 256 pixels wide and high]
    #[arg(long, value_name = "WxH", value_parser = values::size)]
    pub(crate) size: Option<Size>,
    /// Errors to ask for, as with `vol render --max-error`
    #[arg(long, value_name = "E,…", value_delimiter = ',', value_parser = values::max_error, default_values_t = [3e-2, 1e-2, 3e-3, 1e-3, 3e-4, 1e-4])]
    pub(crate) max_error: Vec<f32>,
    /// Pixels at which pictures are compared with the reference
    #[arg(long, value_name = "N", default_value_t = 256, value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    pub(crate) places: u32,
    /// Folder in which references are kept [default: `vol/references` in the user's cache]
    #[arg(long, value_name = "FOLDER")]
    pub(crate) cache: Option<PathBuf>,
}

/// Arguments of `vol profile`.
#[derive(Debug, Args)]
pub(crate) struct Profile {
    /// Scene, params and moment.
    #[command(flatten)]
    pub(crate) scene: Scene,
    /// Picture size in pixels instead of the scene's
    #[arg(long, value_name = "WxH", value_parser = values::size)]
    pub(crate) size: Option<Size>,
    /// CPU threads, whose times are added up [default: as many as the machine has cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(crate) threads: Option<u16>,
    /// Error allowed from sampling media, as with `vol render` [default: 0.01]
    #[arg(long, value_name = "E", value_parser = values::max_error)]
    pub(crate) max_error: Option<f32>,
    /// Rays per pixel, as with `vol render`
    #[arg(long, value_name = "N", value_parser = values::samples, allow_negative_numbers = true)]
    pub(crate) samples: Option<u32>,
    /// Error of a pixel at which it takes no more samples, as with `vol render`
    #[arg(long, value_name = "E", value_parser = values::adaptive, allow_negative_numbers = true)]
    pub(crate) adaptive: Option<f32>,
    /// `human` writes two tables, `json` one object a line
    #[arg(long, value_enum, default_value_t = MessageFormat::Human)]
    pub(crate) message_format: MessageFormat,
}

/// What computes the pictures of a benchmark.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum BenchBackend {
    Cpu,
    Gpu,
    Both,
}

/// What computes a picture.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum Backend {
    Cpu,
    Gpu,
    Auto,
}

/// How media along rays are integrated.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Integrator {
    /// Samples on one comb per ray, walls placed by distances, steps chosen for --max-error
    Comb,
    /// The plain marcher: even steps, light added after the step's absorption, first order
    FixedStep,
    /// Random free paths: unbiased, the error falls with the root of --samples
    MonteCarlo,
}

/// How fixed steps find tubes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum TubeBounds {
    /// Steps through the box around the media; outside the boxes along the tube nothing is evaluated
    Cells,
    /// Walking the distance to the axis less the radius there, which may overshoot where it varies
    SphereMarch,
}

/// What evaluates a field.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum QueryBackend {
    Reference,
    Cpu,
    Gpu,
}

/// How diagnostics are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum MessageFormat {
    Human,
    Json,
}

/// The shader languages.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum Target {
    Wgsl,
    Glsl,
    Spirv,
    Hlsl,
    Msl,
    Shadertoy,
}

/// What `vol compile` writes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum ExportForm {
    Module,
    Library,
}
