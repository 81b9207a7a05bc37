//! `vol compile`: a scene as a shader.

use std::io::{self, Write as _};

use vol::failure::Failure;
use vol::output::atomic;
use vol_compiler::frame::Quadrature;
use vol_compiler::skip::Skips;
use vol_compiler::wgsl;

use crate::cli;

pub(super) fn run(arguments: &cli::Compile) -> Result<(), Failure> {
    if let Some(path) = &arguments.output {
        atomic::probe(path)?;
    }
    let session = super::load(&arguments.scene, Skips::ALL)?;
    let text = match arguments.target {
        cli::Target::Wgsl => wgsl::render::render_module(&session.program, Quadrature::Midpoint),
    };
    let text = text.map_err(|error| {
        let text = format!("cannot translate `{}`: {error}", arguments.scene.display());
        Failure::content(text).with_help("this is a mistake of vol itself; please report it with the scene")
    })?;
    match &arguments.output {
        Some(path) => atomic::write(path, |out| out.write_all(text.as_bytes())),
        None => {
            let mut out = io::stdout().lock();
            let written = out.write_all(text.as_bytes()).and_then(|()| out.flush());
            written.map_err(|error| Failure::stdout(&error))
        }
    }
}
