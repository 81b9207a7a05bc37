//! `vol params`: what can be set from outside.

use std::io::{self, Write as _};

use vol::failure::Failure;
use vol::reflect;
use vol::session::written;
use vol_compiler::program::Param;
use vol_compiler::skip::Skips;

use crate::cli::{self, MessageFormat};

/// Lists the params of a scene on standard output.
pub(super) fn run(arguments: &cli::Params) -> Result<(), Failure> {
    let session = super::load(&arguments.scene, Skips::ALL)?;
    let params = &session.program.params;
    let text = match arguments.message_format {
        MessageFormat::Human => params.iter().map(line).collect(),
        MessageFormat::Json => json(params),
    };
    io::stdout().write_all(text.as_bytes()).map_err(|error| Failure::stdout(&error))
}

/// `spin: angle = 70deg in 0deg..240deg  // per second`, as a scene would declare it.
fn line(param: &Param) -> String {
    let Param { name, ty, default, range, label, .. } = param;
    let mut line = format!("{name}: {ty} = {}", written(ty, default));
    if let Some((lo, hi)) = range {
        line += &format!(" in {}..{}", written(ty, &[*lo]), written(ty, &[*hi]));
    }
    if !label.is_empty() {
        line += &format!("  // {}", label.replace('\n', " "));
    }
    line + "\n"
}

fn json(params: &[Param]) -> String {
    let entries = reflect::params(params);
    serde_json::to_string_pretty(&entries).expect("strings and numbers always become JSON") + "\n"
}
