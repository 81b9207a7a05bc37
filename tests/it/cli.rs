//! The command line from outside: the built binary, its files, its words and its exit codes.
//!
//! * [`pictures`]: what `vol render` writes
//! * [`animations`]: what is kept from frame to frame
//! * [`answers`]: what `vol check`, `compile`, `query` and `diff` say
//! * [`costs`]: what `vol profile` and `vol render --aov cost` count
//! * [`files`]: scenes of several files, params and chosen blocks
//! * [`formatting`]: what `vol fmt` writes and says
//! * [`limits`]: scenes that ask for too much, and the memory that they take
//! * [`styles`]: maps of styles as files, and what refuses styles
//! * [`mistakes`]: bad input of every kind, and what is left behind (nothing)

mod animations;
mod answers;
mod costs;
mod files;
mod formatting;
mod limits;
mod mistakes;
mod pictures;
mod styles;

use libtest_mimic::{Failed, Trial};
use std::ffi::OsStr;
use std::path::PathBuf;
use std::process::{Command, Output, Stdio};
use tempfile::TempDir;

/// The trials of this folder.
pub(crate) fn trials() -> Vec<Trial> {
    [
        animations::trials(),
        pictures::trials(),
        answers::trials(),
        costs::trials(),
        files::trials(),
        formatting::trials(),
        limits::trials(),
        mistakes::trials(),
        styles::trials(),
    ]
    .into_iter()
    .flatten()
    .collect()
}

/// A trial named `cli::<name>`.
fn trial(name: &str, body: impl FnOnce(&Sandbox) -> Result<(), Failed> + Send + 'static) -> Trial {
    Trial::test(format!("cli::{name}"), move || body(&Sandbox::new()?))
}

/// A solid with two params and a function of a position.
const BALL: &str = "\
param size: float = 1 in 0.1..2
param turn: angle = 30deg in 0deg..90deg
param tint: color = #ffffff
param steps: int = 3 in 1..8
param shown: bool = true
param place: vec3 = (0, 0, 0)
fn ramp(p: vec3) -> float { p.x * 2 + time + place.y }
fn seen(p: vec3) -> float { p.x + frame + turn / 1rad + steps }
object ball { shape: sphere(size), material: diffuse(tint), when: shown }
light sun { from: (1, 1, 1), color: 2 }
render { size: (32, 18), fps: 10 }
";

/// A medium with a density that varies.
const FOG: &str = "\
medium fog { region: sphere(1), density: q => 2 + q.local.x, scatter: 1 }
light sun { from: (1, 1, 1), color: 2 }
render { size: (32, 18), background: #203040 }
";

/// A temporary folder in which `vol` runs.
struct Sandbox {
    folder: TempDir,
}

impl Sandbox {
    fn new() -> Result<Self, Failed> {
        let sandbox = Self { folder: tempfile::tempdir()? };
        sandbox.write("ball.vol", BALL)?;
        sandbox.write("fog.vol", FOG)?;
        Ok(sandbox)
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn write(&self, name: &str, content: impl AsRef<[u8]>) -> Result<(), Failed> {
        Ok(std::fs::write(self.path(name), content)?)
    }

    fn read(&self, name: &str) -> Result<Vec<u8>, Failed> {
        std::fs::read(self.path(name)).map_err(|error| format!("{name}: {error}").into())
    }

    /// Names of the files that are not the given scenes, sorted.
    fn new_files(&self) -> Result<Vec<String>, Failed> {
        let mut names = Vec::new();
        for entry in std::fs::read_dir(self.folder.path())? {
            names.push(entry?.file_name().to_string_lossy().into_owned());
        }
        names.retain(|name| name != "ball.vol" && name != "fog.vol");
        names.sort();
        Ok(names)
    }

    /// `vol` with arguments, in the folder, with nothing to read.
    fn command<S: AsRef<OsStr>>(&self, arguments: impl IntoIterator<Item = S>) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_vol"));
        command.current_dir(self.folder.path()).args(arguments).stdin(Stdio::null());
        command
    }

    /// Runs `vol` with arguments separated by spaces.
    fn vol(&self, arguments: &str) -> Result<Outcome, Failed> {
        Ok(self.command(arguments.split_whitespace()).output()?.into())
    }

    /// Runs `vol` with something to read.
    fn vol_reading(&self, arguments: &str, input: &str) -> Result<Outcome, Failed> {
        self.write("stdin.txt", input)?;
        let input = std::fs::File::open(self.path("stdin.txt"))?;
        Ok(self.command(arguments.split_whitespace()).stdin(input).output()?.into())
    }
}

/// What a run left.
#[derive(Debug)]
struct Outcome {
    /// The exit code; -1 for a signal.
    code: i32,
    stdout: String,
    stderr: String,
}

impl From<Output> for Outcome {
    fn from(output: Output) -> Self {
        let text = |bytes: Vec<u8>| String::from_utf8_lossy(&bytes).into_owned();
        Self {
            code: output.status.code().unwrap_or(-1),
            stdout: text(output.stdout),
            stderr: text(output.stderr),
        }
    }
}

impl Outcome {
    /// Fails unless the exit code is `code` and standard error contains all of `words`.
    fn expect(self, code: i32, words: &[&str]) -> Result<Self, Failed> {
        if self.code != code {
            return Err(format!("exit code {code} expected: {self:#?}").into());
        }
        for word in words {
            if !self.stderr.contains(word) {
                return Err(format!("`{word}` expected on stderr: {self:#?}").into());
            }
        }
        Ok(self)
    }
}

fn equal<T: PartialEq + std::fmt::Debug>(found: T, expected: T) -> Result<(), Failed> {
    if found == expected { Ok(()) } else { Err(format!("found {found:?}, expected {expected:?}").into()) }
}
