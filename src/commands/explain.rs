//! `vol explain`: the long story of a code, or the list of all codes.

use std::io::{self, Write as _};

use vol::explain;
use vol::failure::Failure;

use crate::cli;

pub(super) fn run(arguments: &cli::Explain) -> Result<(), Failure> {
    let text = match &arguments.code {
        Some(code) => explain::story(code).map_err(|near| unknown(code, near))?.plain(),
        None => explain::codes().into_iter().map(|(code, meaning)| format!("{code}  {meaning}\n")).collect(),
    };
    io::stdout().write_all(text.as_bytes()).map_err(|error| Failure::stdout(&error))
}

fn unknown(code: &str, near: Option<&str>) -> Failure {
    let failure = Failure::usage(format!("there is no code `{code}`"));
    match near {
        Some(near) => failure.with_help(format!("did you mean `{near}`? `vol explain` lists all codes")),
        None => failure.with_help("`vol explain` lists all codes"),
    }
}
