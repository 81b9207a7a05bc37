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
