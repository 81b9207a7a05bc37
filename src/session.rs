//! From a scene file to a frame: what every command does before its own work.
//!
//! ```text
//! path ──read──► SourceFile ──analyse, compile──► Session ──params, moment──► Frame
//! ```

mod params;

pub use params::written;

use std::fs::File;
use std::io::Read as _;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use vol_compiler::frame::{Frame, Sampling};
use vol_compiler::program::{Field, Program, Slot};
use vol_compiler::skip::Skips;
use vol_compiler::{library, lower};
use vol_language::Analysis;
use vol_language::blocks::{ADAPTIVE_SAMPLES, MAX_SAMPLES};
use vol_language::diag::Diagnostic;
use vol_language::module::Loader;
use vol_language::nearest::nearest;
use vol_language::source::{MAX_SOURCE_BYTES, SourceError, SourceFile, Sources};
use vol_runtime_cpu::style::Picture;

use crate::failure::Failure;
use crate::styles;

/// A scene that is ready to render.
#[derive(Debug)]
pub struct Session {
    /// The scene's text and those that it imports.
    pub sources: Sources,
    /// The compiled scene.
    pub program: Program,
    /// The pictures that its styles name; none for a text without a file.
    pub pictures: Vec<Picture>,
    /// What is suspicious but no error.
    pub warnings: Vec<Diagnostic>,
    /// How long parsing and checking took.
    pub check_time: Duration,
    /// How long compiling took.
    pub compile_time: Duration,
}

/// A moment of the animation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment {
    /// Seconds since the start.
    pub time: f64,
    /// Number of the frame.
    pub frame: f64,
}

/// Why a file is not read.
enum ReadError {
    File(String),
    Content(SourceError),
}

impl ReadError {
    fn into_failure(self, path: &Path) -> Failure {
        match self {
            Self::File(reason) => Failure::io("cannot read", path, reason),
            Self::Content(error) => not_a_scene(path, &error),
        }
    }
}

/// Reads a scene file.
///
/// # Errors
/// A usage failure if it cannot be read, a content failure if it is no scene text.
pub fn read(path: &Path) -> Result<SourceFile, Failure> {
    read_text(path).map_err(|error| error.into_failure(path))
}

/// Reads the bytes of a scene file; of a file over the size limit no more than the limit is read.
///
/// # Errors
/// A usage failure if it cannot be read, a content failure if it is too large.
pub fn read_bytes(path: &Path) -> Result<Vec<u8>, Failure> {
    bytes_of(path).map_err(|error| error.into_failure(path))
}

/// A content failure for a file that is no scene text.
#[must_use]
pub fn not_a_scene(path: &Path, error: &SourceError) -> Failure {
    Failure::content(format!("cannot use `{}`: {error}", path.display()))
}

fn read_text(path: &Path) -> Result<SourceFile, ReadError> {
    SourceFile::from_bytes(path.display().to_string(), bytes_of(path)?).map_err(ReadError::Content)
}

fn bytes_of(path: &Path) -> Result<Vec<u8>, ReadError> {
    let failed = |error: std::io::Error| ReadError::File(error.to_string());
    let file = File::open(path).map_err(failed)?;
    let metadata = file.metadata().map_err(failed)?;
    if metadata.is_dir() {
        return Err(ReadError::File("it is a folder, not a scene".to_owned()));
    }
    let mut bytes = Vec::new();
    file.take(MAX_SOURCE_BYTES as u64 + 1).read_to_end(&mut bytes).map_err(failed)?;
    if bytes.len() > MAX_SOURCE_BYTES {
        // What was read stops at the limit.
        let bytes = bytes.len().max(metadata.len() as usize);
        return Err(ReadError::Content(SourceError::TooLarge { bytes }));
    }
    Ok(bytes)
}

/// The folder of a scene; files that it imports lie below.
struct Folder(PathBuf);

impl Loader for Folder {
    fn read(&self, path: &str) -> Result<SourceFile, String> {
        let inside = |path: &Path| path.canonicalize().map_err(|error| error.to_string());
        let root = if self.0.as_os_str().is_empty() { Path::new(".") } else { &self.0 };
        // A link may lead out of the folder although the path does not.
        if !inside(&self.0.join(path))?.starts_with(inside(root)?) {
            return Err("it lies outside of the scene's folder".to_owned());
        }
        read_text(&self.0.join(path)).map_err(|error| match error {
            ReadError::File(reason) => reason,
            ReadError::Content(error) => error.to_string(),
        })
    }
}

/// Reads, checks and compiles a scene; `skips` says what may be left out of the work.
///
/// # Errors
/// As [`read`], and a scene failure with all the mistakes found.
pub fn load(path: &Path, skips: Skips) -> Result<Session, Failure> {
    let folder = path.parent().unwrap_or(Path::new("")).to_owned();
    let mut session = compile(read(path)?, &Folder(folder), skips)?;
    session.pictures = styles::pictures(&session.sources, &session.program)?;
    Ok(session)
}

/// Checks and compiles a scene text.
///
/// # Errors
/// A scene failure with all the mistakes found.
pub fn compile(file: SourceFile, loader: &dyn Loader, skips: Skips) -> Result<Session, Failure> {
    let started = Instant::now();
    let Analysis { scene, mut diagnostics, sources } =
        vol_language::analyse_with(file, &library::library(), loader);
    let check_time = started.elapsed();
    let Some(scene) = scene else {
        return Err(Failure::Scene { sources: Box::new(sources), diagnostics });
    };
    let started = Instant::now();
    let (program, found) = lower::compile_with(&scene, skips);
    let compile_time = started.elapsed();
    diagnostics.extend(found);
    match program {
        Some(program) => {
            let (pictures, warnings) = (Vec::new(), diagnostics);
            Ok(Session { sources, program, pictures, warnings, check_time, compile_time })
        }
        None => Err(Failure::Scene { sources: Box::new(sources), diagnostics }),
    }
}

impl Session {
    /// The values of all params, in the program's order: the defaults, and what `-D` sets instead.
    ///
    /// # Errors
    /// A usage failure for an unknown param, or a value that is not of its type or range.
    pub fn params(&self, definitions: &[(String, String)]) -> Result<Vec<Vec<f64>>, Failure> {
        params::values(&self.program.params, definitions)
    }

    /// Leaves out objects and media: all but `only`, if that names any, and those that `hide` names.
    ///
    /// # Errors
    /// A usage failure for a name that no object and no medium has.
    pub fn restrict(&mut self, only: &[String], hide: &[String]) -> Result<(), Failure> {
        let Program { objects, media, .. } = &mut self.program;
        let names: Vec<&str> =
            objects.iter().map(|o| o.name.as_str()).chain(media.iter().map(|m| m.name.as_str())).collect();
        if let Some(unknown) = only.iter().chain(hide).find(|name| !names.contains(&name.as_str())) {
            let failure = Failure::usage(format!("the scene has no object and no medium `{unknown}`"));
            return Err(match nearest(unknown, names.iter().copied()) {
                Some(near) => failure.with_help(format!("did you mean `{near}`?")),
                None => failure.with_help(format!("it has: {}", names.join(", "))),
            });
        }
        let stays = |name: &String| (only.is_empty() || only.contains(name)) && !hide.contains(name);
        objects.retain(|object| stays(&object.name));
        media.retain(|medium| stays(&medium.name));
        Ok(())
    }

    /// The scene at one moment, framed for a picture of `size` pixels.
    ///
    /// # Errors
    /// A scene failure if the scene makes no sense at that moment.
    pub fn frame(&self, params: &[Vec<f64>], moment: Moment, size: [u32; 2]) -> Result<Frame, Failure> {
        let frame = self.program.frame(params, moment.time, moment.frame, size);
        frame.map_err(|diagnostic| Failure::Scene {
            sources: Box::new(self.sources.clone()),
            diagnostics: vec![diagnostic],
        })
    }

    /// The moment `time` seconds after the start.
    ///
    /// # Errors
    /// As [`Session::moment_of_frame`].
    pub fn moment_at(&self, params: &[Vec<f64>], time: f64) -> Result<Moment, Failure> {
        let fps = self.fps(params)?;
        // A time that means the start of a frame may fall just short of it: 0.1 s · 30 = 3.0000000000000004.
        Ok(Moment { time, frame: (time * fps + 1e-6).floor() })
    }

    /// The moment at which frame number `frame` starts.
    ///
    /// # Errors
    /// A content failure if the scene's frame rate is not a positive number.
    pub fn moment_of_frame(&self, params: &[Vec<f64>], frame: u32) -> Result<Moment, Failure> {
        let frame = f64::from(frame);
        Ok(Moment { time: frame / self.fps(params)?, frame })
    }

    /// Frames per second, as the scene says at its start.
    fn fps(&self, params: &[Vec<f64>]) -> Result<f64, Failure> {
        let Slot(slot) = self.program.render.fps;
        let numbers = self.program.numbers(params, 0.0, 0.0);
        let fps = numbers[slot as usize];
        if fps > 0.0 && fps.is_finite() {
            return Ok(fps);
        }
        let text = format!("`{}` renders {fps} frames per second", self.sources.root().name);
        Err(Failure::content(text).with_help("set `fps` of the render block to a number above 0"))
    }

    /// How many samples a pixel takes at a moment: what the scene asks for, or `samples` and
    /// `adaptive` instead.
    ///
    /// # Errors
    /// A content failure if the scene's is no number of samples, or its error no number from 0 to
    /// below 1.
    pub fn sampling(
        &self,
        params: &[Vec<f64>],
        moment: Moment,
        samples: Option<u32>,
        adaptive: Option<f32>,
    ) -> Result<Sampling, Failure> {
        let numbers = self.program.numbers(params, moment.time, moment.frame);
        let at = |Slot(slot): Slot| numbers[slot as usize];
        let render = &self.program.render;
        let tolerance = adaptive.map_or_else(|| self.tolerance(at(render.adaptive)), Ok)?;
        let most = match (samples, render.samples) {
            (Some(samples), _) => samples,
            (None, Some(slot)) => self.samples(at(slot))?,
            (None, None) if tolerance > 0.0 => ADAPTIVE_SAMPLES,
            (None, None) => 1,
        };
        Ok(Sampling { most, tolerance })
    }

    fn samples(&self, samples: f64) -> Result<u32, Failure> {
        if samples.fract() == 0.0 && (1.0..=f64::from(MAX_SAMPLES)).contains(&samples) {
            return Ok(samples as u32);
        }
        let text = format!("`{}` takes {samples} samples per pixel", self.sources.root().name);
        let help = format!("set `samples` of the render block to a whole number from 1 to {MAX_SAMPLES}");
        Err(Failure::content(text).with_help(help))
    }

    fn tolerance(&self, adaptive: f64) -> Result<f32, Failure> {
        // As the renderer sees it: the largest number below 1 rounds to 1.
        let tolerance = adaptive as f32;
        if (0.0..1.0).contains(&tolerance) {
            return Ok(tolerance);
        }
        let text = format!("`{}` samples to an error of {adaptive}", self.sources.root().name);
        let help = "set `adaptive` of the render block to a number from 0 to below 1";
        Err(Failure::content(text).with_help(help))
    }

    /// The field called `name`.
    ///
    /// # Errors
    /// A usage failure that lists the scene's fields.
    pub fn field(&self, name: &str) -> Result<&Field, Failure> {
        let fields = &self.program.fields;
        if let Some(field) = fields.iter().find(|field| field.name == name) {
            return Ok(field);
        }
        let names: Vec<&str> = fields.iter().map(|field| field.name.as_str()).collect();
        let failure = Failure::usage(format!("`{}` has no field `{name}`", self.sources.root().name));
        Err(match nearest(name, names.iter().copied()) {
            _ if names.is_empty() => failure.with_help("the scene has no fields"),
            Some(near) => {
                failure.with_help(format!("did you mean `{near}`? the fields are: {}", names.join(", ")))
            }
            None => failure.with_help(format!("the fields are: {}", names.join(", "))),
        })
    }
}
