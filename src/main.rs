//! The `vol` command: parses the arguments, runs the command, turns its outcome into an exit code.

mod cli;
mod commands;

use std::process::ExitCode;

use clap::Parser;

fn main() -> ExitCode {
    // Clap prints its own usage errors (code 2), `--help` and `--version` (code 0).
    let cli = cli::Cli::parse();
    match commands::run(&cli.command) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            commands::print_failure(&failure);
            ExitCode::from(failure.code())
        }
    }
}
