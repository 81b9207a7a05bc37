//! Why a command stops, and the exit code that says so.
//!
//! Everything that can go wrong between the command line and the finished file ends up as one
//! [`Failure`]; `main` prints it and turns it into the process's exit code:
//!
//! | code | meaning                                                       |
//! |------|---------------------------------------------------------------|
//! | 0    | fine                                                          |
//! | 1    | the scene is at fault, or a comparison failed                 |
//! | 2    | wrong usage, or a file could not be read or written           |
//! | 3    | no graphics device, or it was lost                            |
//! | 130  | interrupted                                                   |

use std::fmt::Display;
use std::io;
use std::path::Path;

use vol_language::diag::Diagnostic;
use vol_language::source::Sources;

/// Why a command stops.
#[derive(Debug)]
pub enum Failure {
    /// Wrong arguments, or a file that cannot be read or written. Exit code 2.
    Usage(Message),
    /// The scene has mistakes at known places. Exit code 1.
    Scene {
        /// The scene's texts.
        sources: Box<Sources>,
        /// At least one error; warnings may stand beside it.
        diagnostics: Vec<Diagnostic>,
    },
    /// The file is no scene, or a comparison failed. Exit code 1.
    Content(Message),
    /// No graphics device, or it could not do the work. Exit code 3.
    Device(Message),
    /// The user asked to stop. Exit code 130.
    Interrupted,
    /// The reader of our output has gone (`vol query … | head`). Exit code 0, without a word.
    BrokenPipe,
    /// What went wrong is already on the screen; only this exit code is left to give.
    Reported(u8),
}

/// What is printed after `error:` and `help:`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Message {
    /// One sentence: lower case, no final stop.
    pub text: String,
    /// What to do about it.
    pub help: Option<String>,
}

impl Failure {
    /// Wrong usage.
    pub fn usage(text: impl Into<String>) -> Self {
        Self::Usage(Message { text: text.into(), help: None })
    }

    /// A file that cannot be read or written: `doing` is what was tried, as in `cannot read`.
    pub fn io(doing: &str, path: &Path, error: impl Display) -> Self {
        Self::usage(format!("{doing} `{}`: {error}", path.display()))
    }

    /// Something wrong with the content of the scene file or with a comparison.
    pub fn content(text: impl Into<String>) -> Self {
        Self::Content(Message { text: text.into(), help: None })
    }

    /// Trouble with the graphics device.
    pub fn device(text: impl Into<String>) -> Self {
        Self::Device(Message { text: text.into(), help: None })
    }

    /// An error while writing to standard output.
    pub fn stdout(error: &io::Error) -> Self {
        if error.kind() == io::ErrorKind::BrokenPipe {
            return Self::BrokenPipe;
        }
        Self::usage(format!("cannot write to standard output: {error}"))
    }

    /// The same failure with a help line, where it can have one.
    #[must_use]
    pub fn with_help(mut self, help: impl Into<String>) -> Self {
        if let Self::Usage(message) | Self::Content(message) | Self::Device(message) = &mut self {
            message.help = Some(help.into());
        }
        self
    }

    /// The exit code.
    #[must_use]
    pub fn code(&self) -> u8 {
        match self {
            Self::BrokenPipe => 0,
            Self::Scene { .. } | Self::Content(_) => 1,
            Self::Usage(_) => 2,
            Self::Device(_) => 3,
            Self::Interrupted => 130,
            Self::Reported(code) => *code,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Failure;
    use std::io::{Error, ErrorKind};

    #[test]
    fn a_broken_pipe_is_no_error() {
        assert_eq!(Failure::stdout(&Error::from(ErrorKind::BrokenPipe)).code(), 0);
        assert_eq!(Failure::stdout(&Error::from(ErrorKind::StorageFull)).code(), 2);
    }

    #[test]
    fn codes_follow_the_table() {
        assert_eq!(Failure::content("x").code(), 1);
        assert_eq!(Failure::usage("x").code(), 2);
        assert_eq!(Failure::device("x").with_help("y").code(), 3);
        assert_eq!(Failure::Interrupted.code(), 130);
    }
}
