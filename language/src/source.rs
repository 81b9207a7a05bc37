//! Source files and byte spans.

use std::fmt;

/// Largest scene file that is read, in bytes.
pub const MAX_SOURCE_BYTES: usize = 8 << 20;

/// A half-open range of bytes in one source file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Span {
    /// First byte.
    pub start: u32,
    /// One past the last byte.
    pub end: u32,
}

impl Span {
    /// The span from `start` to `end`, in bytes.
    #[must_use]
    pub fn new(start: usize, end: usize) -> Self {
        Self { start: start as u32, end: end as u32 }
    }

    /// The span moved towards the end by `bytes`.
    #[must_use]
    pub fn shifted(self, bytes: u32) -> Self {
        Self { start: self.start.saturating_add(bytes), end: self.end.saturating_add(bytes) }
    }

    /// The span moved towards the start by `bytes`.
    #[must_use]
    pub fn back(self, bytes: u32) -> Self {
        Self { start: self.start.saturating_sub(bytes), end: self.end.saturating_sub(bytes) }
    }

    /// The smallest span that covers both.
    #[must_use]
    pub fn to(self, other: Self) -> Self {
        Self { start: self.start.min(other.start), end: self.end.max(other.end) }
    }
}

/// One scene text with the name that messages show.
#[derive(Clone, Debug)]
pub struct SourceFile {
    /// Path or other name, as the user typed it.
    pub name: String,
    /// The text, strict UTF-8.
    pub text: String,
}

/// The texts of a scene: its own file and those that it imports, end to end in one space of bytes.
///
/// Spans of the scene's own file are those of its text; spans of the file at index `i` are shifted by
/// [`Sources::start`] of `i`. Spans from [`crate::standard::START`] on lie in the standard library.
#[derive(Clone, Debug)]
pub struct Sources {
    files: Vec<SourceFile>,
    starts: Vec<u32>,
}

impl From<SourceFile> for Sources {
    fn from(root: SourceFile) -> Self {
        Self { files: vec![root], starts: vec![0] }
    }
}

impl Sources {
    /// Adds a file; returns its index.
    pub fn add(&mut self, file: SourceFile) -> usize {
        let (last, start) = (&self.files[self.files.len() - 1], self.starts[self.starts.len() - 1]);
        // One byte between files, so that the end of one is not the start of the next.
        self.starts.push(start.saturating_add(last.text.len() as u32).saturating_add(1));
        self.files.push(file);
        self.files.len() - 1
    }

    /// The scene's own file.
    #[must_use]
    pub fn root(&self) -> &SourceFile {
        &self.files[0]
    }

    /// All files, the scene's own first.
    #[must_use]
    pub fn files(&self) -> &[SourceFile] {
        &self.files
    }

    /// Offset of the first byte of file `index`.
    #[must_use]
    pub fn start(&self, index: usize) -> u32 {
        self.starts[index]
    }

    /// The file that a span lies in, and the span in that file's text.
    #[must_use]
    pub fn locate(&self, span: Span) -> (&SourceFile, Span) {
        if span.start >= crate::standard::START {
            return (crate::standard::file(), span.back(crate::standard::START));
        }
        let index = self.starts.partition_point(|&start| start <= span.start).max(1) - 1;
        (&self.files[index], span.back(self.starts[index]))
    }

    /// The line that a span begins in: its file, its number from 1, its text without the blanks around it.
    #[must_use]
    pub fn line(&self, span: Span) -> (&SourceFile, usize, &str) {
        let (file, span) = self.locate(span);
        let start = file.text.floor_char_boundary(span.start as usize);
        let before = file.text[..start].matches('\n').count();
        (file, before + 1, file.text.lines().nth(before).unwrap_or_default().trim())
    }
}

/// Why bytes are not a scene text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum SourceError {
    /// More than [`MAX_SOURCE_BYTES`].
    TooLarge {
        /// Size found, in bytes.
        bytes: usize,
    },
    /// A binary voxel grid that shares the file extension (`VOL`, 0x03).
    BinaryGrid,
    /// Not UTF-8.
    NotUtf8 {
        /// Offset of the first wrong byte.
        offset: usize,
    },
}

impl fmt::Display for SourceError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::TooLarge { bytes } => {
                write!(f, "the file has {bytes} bytes; a scene may have at most {MAX_SOURCE_BYTES}")
            }
            Self::BinaryGrid => write!(
                f,
                "this is a binary voxel grid (it begins with the bytes `VOL` and 0x03), not a scene script"
            ),
            Self::NotUtf8 { offset } => {
                write!(f, "the file is not UTF-8 text: the byte at offset {offset} is wrong")
            }
        }
    }
}

impl std::error::Error for SourceError {}

impl SourceFile {
    /// A file from text.
    #[must_use]
    pub fn new(name: impl Into<String>, text: impl Into<String>) -> Self {
        Self { name: name.into(), text: text.into() }
    }

    /// A file from the bytes read from disk. A byte-order mark is dropped.
    ///
    /// # Errors
    /// [`SourceError`] if the bytes cannot be a scene text.
    pub fn from_bytes(name: impl Into<String>, bytes: Vec<u8>) -> Result<Self, SourceError> {
        if bytes.starts_with(b"VOL\x03") {
            return Err(SourceError::BinaryGrid);
        }
        if bytes.len() > MAX_SOURCE_BYTES {
            return Err(SourceError::TooLarge { bytes: bytes.len() });
        }
        let text = String::from_utf8(bytes)
            .map_err(|error| SourceError::NotUtf8 { offset: error.utf8_error().valid_up_to() })?;
        let text = text.strip_prefix('\u{feff}').map_or(text.clone(), str::to_owned);
        Ok(Self::new(name, text))
    }
}
