//! Styles in pictures: the files that they name, and light maps that are kept from run to run.
//!
//! A light map takes seconds to fit and seldom changes. It is kept as an OpenEXR picture in the user's cache folder
//! (`$XDG_CACHE_HOME/vol/light-maps`, else `~/.cache/vol/light-maps`), named by a hash of everything that it depends on; whatever is wrong with that
//! folder only costs the time to fit again.

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

use image::{ImageReader, Limits};
use sha2::{Digest as _, Sha256};
use vol_compiler::frame::{Frame, Image, Inputs, Pixel};
use vol_compiler::program::Program;
use vol_compiler::program::style::{ImageFile, Style};
use vol_language::diag::Diagnostic;
use vol_language::source::Sources;
use vol_runtime_cpu::style::{self, FittedMap, Picture};

use crate::failure::Failure;
use crate::output::{atomic, exr};
use crate::session::Session;

/// Codes of this stage with what each is about.
pub const CODES: &[(&str, &str)] = &[("E0508", "a picture that cannot be read")];

/// Largest width and height of a picture in a transfer function.
const MAX_SIDE: u32 = 8192;

/// Most bytes that its decoder may take.
const MAX_BYTES: u64 = 1 << 30;

/// Reads the pictures that a program's styles name.
///
/// # Errors
/// A scene failure with all the pictures that cannot be read.
pub fn pictures(sources: &Sources, program: &Program) -> Result<Vec<Picture>, Failure> {
    let read = program.images.iter().map(|file| picture(sources, file));
    let (pictures, wrong): (Vec<_>, Vec<_>) = read.partition(Result::is_ok);
    if wrong.is_empty() {
        return Ok(pictures.into_iter().flatten().collect());
    }
    let diagnostics = wrong.into_iter().filter_map(Result::err).collect();
    Err(Failure::Scene { sources: Box::new(sources.clone()), diagnostics })
}

/// A picture, its path relative to the file that names it.
fn picture(sources: &Sources, file: &ImageFile) -> Result<Picture, Diagnostic> {
    let (named_in, _) = sources.locate(file.span);
    let folder = Path::new(&named_in.name).parent().unwrap_or(Path::new(""));
    decode(&folder.join(&file.path)).map_err(|reason| {
        let message = format!("cannot read the picture `{}`", file.path);
        let help = format!(
            "write the path of a PNG of at most {MAX_SIDE} x {MAX_SIDE} pixels, relative to this file"
        );
        Diagnostic::error("E0508", message, file.span, reason).with_help(help)
    })
}

fn decode(path: &Path) -> Result<Picture, String> {
    let mut reader = ImageReader::open(path).map_err(|error| error.to_string())?;
    reader.set_format(image::ImageFormat::Png);
    let mut limits = Limits::default();
    limits.max_image_width = Some(MAX_SIDE);
    limits.max_image_height = Some(MAX_SIDE);
    limits.max_alloc = Some(MAX_BYTES);
    reader.limits(limits);
    let decoded = reader.decode().map_err(|error| error.to_string())?.into_rgba16();
    let unit = |code: u16| f32::from(code) / f32::from(u16::MAX);
    let pixel = |pixel: &image::Rgba<u16>| {
        let [r, g, b, a] = pixel.0.map(unit);
        [linear(r), linear(g), linear(b), a]
    };
    Ok(Picture {
        width: decoded.width(),
        height: decoded.height(),
        pixels: decoded.pixels().map(pixel).collect(),
    })
}

/// sRGB to linear (IEC 61966-2-1).
fn linear(encoded: f32) -> f32 {
    if encoded <= 0.040_45 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
}

impl Session {
    /// Prepares the styles of a frame for a picture of `size` pixels; the light maps that were fitted, or known.
    ///
    /// # Errors
    /// A scene failure for a stroke outside of the picture.
    pub fn prepare_styles(&self, frame: &mut Frame, size: [u32; 2]) -> Result<Vec<FittedMap>, Failure> {
        if frame.styles.is_empty() {
            return Ok(Vec::new());
        }
        let folder = cache_folder();
        let file = |style: &Style<f64>| Some(folder.as_ref()?.join(self.name_of_map(frame, style, size)));
        let known = |style: &Style<f64>| texels(&exr::read(&file(style).filter(|file| file.exists())?).ok()?);
        let prepared = style::prepare(&self.program, frame, size, &self.pictures, &known);
        let prepared = prepared.map_err(|diagnostic| Failure::Scene {
            sources: Box::new(self.sources.clone()),
            diagnostics: vec![diagnostic],
        })?;
        for map in prepared.light_maps.iter().filter(|map| map.fit.is_some()) {
            let style = frame.styles.iter().find(|style| style.name == map.style);
            if let Some(path) = style.and_then(file) {
                // Without a cache the next run fits again.
                let _ = keep(map, &path);
            }
        }
        frame.styled_lights = prepared.lights;
        Ok(prepared.light_maps)
    }

    /// A name for the light map of a style: of all that it depends on.
    fn name_of_map(&self, frame: &Frame, style: &Style<f64>, size: [u32; 2]) -> String {
        let mut seen = frame.clone();
        let Some(map) = &style.light_map else { return String::new() };
        if map.strokes.iter().all(|stroke| stroke.view.is_some()) {
            // The scene's own camera paints nothing.
            seen.camera = Frame::default_camera();
        }
        // Of the style everything but how the map is used.
        let own = Style { transfer: None, depth_range: None, heterogeneity: None, ..style.clone() };
        seen.styles = vec![own];
        let mut hash = Sha256::new();
        hash.update(env!("CARGO_PKG_VERSION"));
        hash.update(format!(
            "{:?} {size:?} {:?}",
            Inputs::of_picture(&self.program, &seen),
            self.program.module
        ));
        let digest = hash.finalize();
        let mut name = digest.iter().take(16).fold(String::new(), |mut name, byte| {
            let _ = write!(name, "{byte:02x}");
            name
        });
        name.push_str(".exr");
        name
    }
}

fn cache_folder() -> Option<PathBuf> {
    let set = |name: &str| std::env::var_os(name).filter(|value| !value.is_empty()).map(PathBuf::from);
    let base = set("XDG_CACHE_HOME").or_else(|| Some(set("HOME")?.join(".cache")))?;
    Some(base.join("vol").join("light-maps"))
}

/// A light map as a picture.
#[must_use]
pub fn as_image(map: &FittedMap) -> Image {
    let pixel = |&color: &[f32; 3]| Pixel { color, depth: f32::INFINITY, ..Pixel::default() };
    let size = map.table.size;
    Image { width: size, height: size, pixels: map.table.texels.iter().map(pixel).collect() }
}

fn keep(map: &FittedMap, path: &Path) -> Result<(), Failure> {
    let folder = path.parent().unwrap_or(Path::new(""));
    fs::create_dir_all(folder).map_err(|error| Failure::io("cannot create", folder, error))?;
    atomic::write(path, |out| exr::write(&as_image(map), None, out))
}

fn texels(colors: &exr::Colors) -> Option<Vec<[f32; 3]>> {
    (colors.size[0] == colors.size[1]).then(|| colors.pixels.clone())
}
