//! `vol fmt`: scenes laid out in the one usual way.

use std::fs;
use std::io::{self, Read as _, Write as _};
use std::path::Path;

use similar::TextDiff;
use vol::failure::Failure;
use vol::output::atomic;
use vol::session;
use vol_language::fmt::{self, FormatError};
use vol_language::source::{MAX_SOURCE_BYTES, SourceFile};

use crate::cli;

/// Unchanged lines shown around each change of a diff.
const CONTEXT_LINES: usize = 3;

/// Formats all files; the worst decides the exit code.
pub(super) fn run(arguments: &cli::Fmt) -> Result<(), Failure> {
    let mut worst = 0;
    for path in &arguments.scenes {
        match format(path, arguments) {
            Ok(()) => {}
            Err(Failure::BrokenPipe) => return Err(Failure::BrokenPipe),
            Err(failure) => {
                super::print_failure(&failure);
                worst = worst.max(failure.code());
            }
        }
    }
    if worst == 0 { Ok(()) } else { Err(Failure::Reported(worst)) }
}

/// A scene before and after.
struct Change {
    /// As messages call it.
    name: String,
    /// As it was read, with its byte-order mark and line ends.
    before: String,
    after: String,
}

fn format(path: &Path, arguments: &cli::Fmt) -> Result<(), Failure> {
    let is_stdin = path == Path::new("-");
    let change = if is_stdin {
        let name = Path::new("standard input");
        change(name, read_stdin().map_err(|error| Failure::io("cannot read", name, error))?)?
    } else {
        change(path, session::read_bytes(path)?)?
    };
    if arguments.check || arguments.diff {
        return show(&change, arguments);
    }
    match (is_stdin, change.before == change.after) {
        (true, _) => print(&change.after),
        (false, true) => Ok(()),
        (false, false) => write(path, &change.after),
    }
}

/// Of a text over the size limit no more than the limit is read.
fn read_stdin() -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    io::stdin().lock().take(MAX_SOURCE_BYTES as u64 + 1).read_to_end(&mut bytes)?;
    Ok(bytes)
}

fn change(name: &Path, bytes: Vec<u8>) -> Result<Change, Failure> {
    let before = String::from_utf8_lossy(&bytes).into_owned();
    let file = SourceFile::from_bytes(name.display().to_string(), bytes)
        .map_err(|error| session::not_a_scene(name, &error))?;
    match fmt::format(&file) {
        Ok(after) => Ok(Change { name: name.display().to_string(), before, after }),
        Err(FormatError::Syntax(diagnostics)) => {
            Err(Failure::Scene { sources: Box::new(file.into()), diagnostics })
        }
        Err(error @ FormatError::Damaged) => {
            let failure = Failure::content(format!("cannot format `{}`: {error}", name.display()));
            Err(failure.with_help("this is a mistake of vol, please report it; the scene was left as it is"))
        }
    }
}

/// For `--check` and `--diff`.
fn show(change: &Change, arguments: &cli::Fmt) -> Result<(), Failure> {
    if change.before == change.after {
        return Ok(());
    }
    let name = &change.name;
    if arguments.diff {
        let diff = TextDiff::from_lines(&change.before, &change.after);
        let mut diff = diff.unified_diff();
        print(&diff.context_radius(CONTEXT_LINES).header(name, name).to_string())?;
    } else {
        print(&format!("{name}\n"))?;
    }
    if arguments.check { Err(Failure::Reported(1)) } else { Ok(()) }
}

fn print(text: &str) -> Result<(), Failure> {
    let mut stdout = io::stdout();
    let written = stdout.write_all(text.as_bytes()).and_then(|()| stdout.flush());
    written.map_err(|error| Failure::stdout(&error))
}

/// Replaces a scene. Its permissions stay, and who may not write it may not replace it either.
fn write(path: &Path, text: &str) -> Result<(), Failure> {
    let failed = |error| Failure::io("cannot write", path, error);
    let permissions = fs::metadata(path).map_err(failed)?.permissions();
    if permissions.readonly() {
        return Err(Failure::io("cannot write", path, "it is read-only"));
    }
    atomic::write(path, |file| file.write_all(text.as_bytes()))?;
    fs::set_permissions(path, permissions).map_err(failed)
}
