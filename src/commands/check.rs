//! `vol check`: the mistakes in scenes, without rendering them.

use std::io::{self, Write as _};
use std::path::Path;

use vol::failure::Failure;
use vol::output::atomic;
use vol::session::{self, Session};
use vol_compiler::program::Program;
use vol_compiler::skip::Skips;
use vol_compiler::{dropped, lints};
use vol_language::diag::{self, Diagnostic, Fix, apply_all};
use vol_language::source::Sources;

use crate::cli::{self, MessageFormat};

/// Checks all files, each reported as it is done; the worst decides the exit code.
pub(super) fn run(arguments: &cli::Check) -> Result<(), Failure> {
    let mut worst = 0;
    for path in &arguments.scenes {
        let repaired = if arguments.fix { repair(path) } else { Ok(()) };
        match repaired.and_then(|()| check(path, arguments)) {
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

/// Makes the repairs of errors in the scene's own file. Warnings are left to the author: an unused name
/// may well be the wrong one of two.
fn repair(path: &Path) -> Result<(), Failure> {
    let Err(Failure::Scene { sources, diagnostics }) =
        session::load(path, Skips::ALL).and_then(with_first_frame)
    else {
        return Ok(());
    };
    let root = sources.root();
    let is_in_root =
        |fix: &&Fix| fix.edits.iter().all(|edit| std::ptr::eq(sources.locate(edit.span).0, root));
    let only = |diagnostic: &'_ Diagnostic| match &diagnostic.fixes[..] {
        [fix] if diagnostic.is_error() => Some(fix.clone()),
        _ => None,
    };
    let fixes: Vec<Fix> = diagnostics.iter().filter_map(only).filter(|fix| is_in_root(&fix)).collect();
    let (text, count) = apply_all(&root.text, &fixes);
    if count > 0 {
        atomic::write(path, |out| out.write_all(text.as_bytes()))?;
        super::print_line(&format!("{}: {}", path.display(), counted(count, "repair", "repairs")));
    }
    Ok(())
}

fn check(path: &Path, arguments: &cli::Check) -> Result<(), Failure> {
    let format = arguments.message_format;
    match session::load(path, Skips::ALL).and_then(with_first_frame) {
        Ok(session) => {
            report(&session.sources, &session.warnings, format)?;
            if format == MessageFormat::Human {
                super::print_line(&format!("{}: {}", path.display(), summary(&session.program)));
                let notes = match arguments.verbose {
                    true => dropped::dropped(&session.program),
                    false => session.program.report.clone(),
                };
                notes.iter().for_each(|note| super::print_line(&format!("note: {note}")));
            }
            Ok(())
        }
        Err(Failure::Scene { sources, diagnostics }) => {
            report(&sources, &diagnostics, format)?;
            if format == MessageFormat::Human {
                super::print_line(&format!("{}: {}", path.display(), tally(&diagnostics)));
            }
            Err(Failure::Reported(1))
        }
        Err(other) => Err(other),
    }
}

/// Fails as well where the scene compiles but makes no sense at its first frame.
fn with_first_frame(mut session: Session) -> Result<Session, Failure> {
    let params = session.params(&[])?;
    let moment = session.moment_at(&params, 0.0)?;
    match session.frame(&params, moment, session.program.render.size) {
        Ok(frame) => {
            session.warnings.extend(lints::warnings(&session.program, &frame));
            Ok(session)
        }
        Err(Failure::Scene { sources, diagnostics }) => {
            session.warnings.extend(diagnostics);
            Err(Failure::Scene { sources, diagnostics: session.warnings })
        }
        Err(other) => Err(other),
    }
}

fn report(sources: &Sources, diagnostics: &[Diagnostic], format: MessageFormat) -> Result<(), Failure> {
    match format {
        MessageFormat::Human => {
            super::print_diagnostics(sources, diagnostics);
            Ok(())
        }
        MessageFormat::Json => {
            let text = diag::render::json(sources, diagnostics);
            let written = io::stdout().write_all(text.as_bytes());
            written.map_err(|error| Failure::stdout(&error))
        }
    }
}

/// `fine: 1 object, 2 media, 1 light, 3 params`
fn summary(program: &Program) -> String {
    let counts = [
        counted(program.blocks_of_objects().count(), "object", "objects"),
        counted(program.media.len(), "medium", "media"),
        counted(program.lights.len(), "light", "lights"),
        counted(program.params.len(), "param", "params"),
    ];
    format!("fine: {}", counts.join(", "))
}

/// `2 errors, 1 warning`
fn tally(diagnostics: &[Diagnostic]) -> String {
    let errors = diagnostics.iter().filter(|diagnostic| diagnostic.is_error()).count();
    let warnings = diagnostics.len() - errors;
    format!("{}, {}", counted(errors, "error", "errors"), counted(warnings, "warning", "warnings"))
}

fn counted(count: usize, one: &str, many: &str) -> String {
    format!("{count} {}", if count == 1 { one } else { many })
}
