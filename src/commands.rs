//! The commands: what was typed becomes work, its outcome becomes text.
//!
//! Data goes to standard output, everything about the work (diagnostics, progress, summary) to
//! standard error.

mod bench;
mod check;
mod compile;
mod diff;
mod explain;
mod fmt;
mod memory;
mod method;
mod params;
mod profile;
mod progress;
mod query;
mod render;
mod stats;
mod stress;
mod table;
pub(crate) mod values;

use std::io::{self, IsTerminal as _, Write as _};
use std::process;
use std::sync::atomic::{AtomicBool, Ordering};

use vol::backend::{Choice, Device};
use vol::failure::{Failure, Message};
use vol::output::atomic;
use vol::session::{Moment, Session};
use vol_compiler::frame::Frame;
use vol_compiler::lints;
use vol_compiler::skip::Skips;
use vol_compiler::wgsl::Arithmetic;
use vol_language::diag::{self, Diagnostic};
use vol_language::source::{Sources, Span};

use crate::cli::{self, Command};

/// Set by the first Ctrl-C; renders look at it.
static CANCELLED: AtomicBool = AtomicBool::new(false);

/// Runs a command.
///
/// # Errors
/// Whatever ends it early.
pub(crate) fn run(command: &Command) -> Result<(), Failure> {
    match command {
        Command::Render(arguments) => render::run(arguments),
        Command::Check(arguments) => check::run(arguments),
        Command::Params(arguments) => params::run(arguments),
        Command::Fmt(arguments) => fmt::run(arguments),
        Command::Explain(arguments) => explain::run(arguments),
        Command::Compile(arguments) => compile::run(arguments),
        Command::Query(arguments) => query::run(arguments),
        Command::Diff(arguments) => diff::run(arguments),
        Command::Stress(arguments) => stress::run(arguments),
        Command::Bench(arguments) => bench::run(arguments),
        Command::Profile(arguments) => profile::run(arguments),
    }
}

/// Writes to standard error why a command failed.
pub(crate) fn print_failure(failure: &Failure) {
    match failure {
        Failure::Scene { sources, diagnostics } => print_diagnostics(sources, diagnostics),
        Failure::Usage(message) | Failure::Content(message) | Failure::Device(message) => {
            print_message("error", message);
        }
        Failure::Interrupted => print_line("interrupted"),
        Failure::BrokenPipe | Failure::Reported(_) => {}
    }
}

/// Writes diagnostics to standard error, in colour on a terminal.
fn print_diagnostics(sources: &Sources, diagnostics: &[Diagnostic]) {
    if !diagnostics.is_empty() {
        let text = diag::render::human(sources, diagnostics, has_colour());
        print_line(text.trim_end_matches('\n'));
    }
}

fn print_message(kind: &str, message: &Message) {
    print_line(&format!("{kind}: {}", message.text));
    if let Some(help) = &message.help {
        print_line(&format!("help: {help}"));
    }
}

/// Writes a line to standard error. Where nobody can read it there is nobody to tell.
fn print_line(line: &str) {
    let _ = writeln!(io::stderr(), "{line}");
}

fn has_colour() -> bool {
    io::stderr().is_terminal() && std::env::var_os("NO_COLOR").is_none_or(|value| value.is_empty())
}

/// A scene at the moment and with the params that the arguments ask for.
struct Prepared {
    session: Session,
    params: Vec<Vec<f64>>,
    moment: Moment,
}

impl Prepared {
    fn new(arguments: &cli::Scene) -> Result<Self, Failure> {
        let skips = arguments.no_skip.iter().copied().fold(Skips::ALL, Skips::without);
        let mut session = load(&arguments.scene, skips)?;
        session.restrict(&arguments.only, &arguments.hide)?;
        let params = session.params(&arguments.define)?;
        let moment = session.moment_at(&params, arguments.time.unwrap_or(0.0))?;
        Ok(Self { session, params, moment })
    }

    fn frame(&self, size: [u32; 2]) -> Result<Frame, Failure> {
        self.session.frame(&self.params, self.moment, size)
    }

    /// The same with its styles prepared, for a picture.
    fn styled_frame(&self, size: [u32; 2]) -> Result<Frame, Failure> {
        let mut frame = self.frame(size)?;
        self.session.prepare_styles(&mut frame, size)?;
        Ok(frame)
    }

    /// Shows what is suspicious at this moment.
    fn show_suspicions(&self) -> Result<(), Failure> {
        let frame = self.frame(self.session.program.render.size)?;
        print_diagnostics(&self.session.sources, &lints::warnings(&self.session.program, &frame));
        Ok(())
    }
}

/// Loads a scene and shows its warnings.
fn load(path: &std::path::Path, skips: Skips) -> Result<Session, Failure> {
    let session = vol::session::load(path, skips)?;
    print_diagnostics(&session.sources, &session.warnings);
    Ok(session)
}

/// Makes the first Ctrl-C set [`CANCELLED`] and the second end the process at once.
fn catch_interrupts() -> Result<(), Failure> {
    let handler = || {
        if CANCELLED.swap(true, Ordering::Relaxed) {
            atomic::abandon();
            process::exit(i32::from(Failure::Interrupted.code()));
        }
    };
    ctrlc::set_handler(handler).map_err(|error| Failure::usage(format!("cannot catch interrupts: {error}")))
}

/// Opens a device, and says so where it is the CPU for want of another.
fn open(choice: Choice, arithmetic: Arithmetic) -> Result<Device, Failure> {
    if choice != Choice::Auto {
        return Device::open(choice, arithmetic);
    }
    let (device, reason) = Device::open_any(arithmetic);
    if let Some(reason) = reason {
        print_line(&format!("note: {reason}; using the CPU"));
    }
    Ok(device)
}

/// The line of a place, `tornado.vol:9: density: q => …`; what is handed on says nothing of where its scene lay.
fn line_of(sources: &Sources, span: Span) -> String {
    let (file, number, text) = sources.line(span);
    format!("{}:{number}: {text}", base(&file.name))
}

/// A file's name without its folders.
fn base(name: &str) -> &str {
    name.rsplit(['/', '\\']).next().unwrap_or(name)
}

/// How a graphics device is to compute.
fn arithmetic(strict: bool) -> Arithmetic {
    if strict { Arithmetic::Strict } else { Arithmetic::Free }
}

/// [`Failure::Interrupted`] once Ctrl-C was pressed.
fn stop_if_cancelled() -> Result<(), Failure> {
    if CANCELLED.load(Ordering::Relaxed) { Err(Failure::Interrupted) } else { Ok(()) }
}

/// The size scaled down so that no side is longer than `longest`.
fn at_most([width, height]: [u32; 2], longest: u32) -> [u32; 2] {
    let side = width.max(height);
    if side <= longest {
        return [width, height];
    }
    [width, height].map(|length| (u64::from(length) * u64::from(longest) / u64::from(side)).max(1) as u32)
}

#[cfg(test)]
mod tests {
    use super::at_most;

    #[test]
    fn sizes_keep_their_aspect() {
        assert_eq!(at_most([960, 540], 256), [256, 144]);
        assert_eq!(at_most([32, 18], 256), [32, 18]);
        assert_eq!(at_most([1, 16384], 256), [1, 256]);
    }
}
