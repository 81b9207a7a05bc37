//! Pictures as files: which format a name asks for, and writing it whole or not at all.

pub mod atomic;
pub mod exr;
pub mod png;
pub mod ramp;

use std::path::{Path, PathBuf};

use vol_compiler::frame::Image;
use vol_runtime_cpu::PixelCost;

use crate::failure::Failure;

/// The picture formats.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// See [`png`].
    Png,
    /// See [`exr`].
    Exr,
}

impl Format {
    /// The format that the extension of `path` asks for, in either case.
    ///
    /// # Errors
    /// A usage failure for any other extension, or none.
    pub fn of(path: &Path) -> Result<Self, Failure> {
        let extension = path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase());
        match extension.as_deref() {
            Some("png") => Ok(Self::Png),
            Some("exr") => Ok(Self::Exr),
            Some(other) => {
                let text = format!("unknown picture format `.{other}` of `{}`", path.display());
                Err(Failure::usage(text).with_help("end the name with .png or .exr"))
            }
            None => {
                let text = format!("`{}` does not say which format the picture has", path.display());
                Err(Failure::usage(text).with_help("end the name with .png or .exr"))
            }
        }
    }
}

/// Writes a picture in the format of the file's extension, whole or not at all. With what each pixel costs an EXR file has
/// more channels, and a PNG file shows costs in the colours of a [`ramp`].
///
/// # Errors
/// A usage failure if the format is unknown or the file cannot be written.
pub fn write_picture(picture: &Image, costs: Option<&[PixelCost]>, path: &Path) -> Result<(), Failure> {
    match (Format::of(path)?, costs) {
        (Format::Png, None) => atomic::write(path, |mut out| png::write(picture, &mut out)),
        (Format::Png, Some(costs)) => {
            let operations: Vec<u64> = costs.iter().map(|cost| cost.operations).collect();
            let codes = ramp::codes(&operations);
            atomic::write(path, |mut out| png::write_codes(&codes, [picture.width, picture.height], &mut out))
        }
        (Format::Exr, _) => atomic::write(path, |mut out| exr::write(picture, costs, &mut out)),
    }
}

/// Whether the file's name has a place for the frame's number: one or more `#`.
#[must_use]
pub fn has_frame_number(path: &Path) -> bool {
    path.file_name().is_some_and(|name| name.to_string_lossy().contains('#'))
}

/// The name of one frame's file: the last run of `#` becomes the number, padded with zeros to the
/// length of the run. Frame 7 of `a.####.png` is `a.0007.png`.
#[must_use]
pub fn frame_path(pattern: &Path, frame: u32) -> PathBuf {
    let Some(name) = pattern.file_name() else { return pattern.to_owned() };
    let name = name.to_string_lossy();
    let Some(last) = name.rfind('#') else { return pattern.to_owned() };
    let before = name[..last].trim_end_matches('#');
    let width = last + 1 - before.len();
    pattern.with_file_name(format!("{before}{frame:0width$}{}", &name[last + 1..]))
}

/// The path with a suffix before its extension: `a.png` with `sun` is `a-sun.png`.
#[must_use]
pub fn with_suffix(path: &Path, suffix: &str) -> PathBuf {
    let part = |part: Option<&std::ffi::OsStr>| part.unwrap_or_default().to_string_lossy().into_owned();
    path.with_file_name(format!("{}-{suffix}.{}", part(path.file_stem()), part(path.extension())))
}

#[cfg(test)]
mod tests {
    use super::{Format, frame_path, has_frame_number};
    use std::path::Path;

    #[test]
    fn frame_numbers() {
        let name = |pattern, frame| frame_path(Path::new(pattern), frame).display().to_string();
        assert_eq!(name("out/f.####.png", 7), "out/f.0007.png");
        assert_eq!(name("f#.exr", 120), "f120.exr");
        assert_eq!(name("#1/a##_###.png", 5), "#1/a##_005.png");
        assert_eq!(name("a.png", 5), "a.png");
        assert!(!has_frame_number(Path::new("a#/b.png")));
    }

    #[test]
    fn extensions() {
        assert_eq!(Format::of(Path::new("a/b.PNG")).expect("known"), Format::Png);
        assert_eq!(Format::of(Path::new("b.0001.exr")).expect("known"), Format::Exr);
        for bad in ["b.jpg", "b", ".png", "a.png/b"] {
            assert_eq!(Format::of(Path::new(bad)).expect_err("unknown").code(), 2, "{bad}");
        }
    }
}
