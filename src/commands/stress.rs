//! `vol stress`: what can go wrong with the numbers of a scene.

use std::io::{self, Write as _};

use serde::Serialize;
use vol::backend::{Choice, Device};
use vol::failure::Failure;
use vol::stress::{self, Config, Report, Row};
use vol_compiler::wgsl::Arithmetic;
use vol_language::diag::{self, Diagnostic};

use super::Prepared;
use super::table::print_table;
use crate::cli::{self, Backend, MessageFormat};

pub(super) fn run(arguments: &cli::Stress) -> Result<(), Failure> {
    let prepared = Prepared::new(&arguments.scene)?;
    let program = &prepared.session.program;
    let (moments, mut messages) = stress::moments(program, &prepared.params, prepared.moment.time);
    let device = match arguments.backend {
        Backend::Cpu => Device::Cpu,
        Backend::Gpu => Device::open(Choice::Gpu, Arithmetic::Free)?,
        Backend::Auto => super::open(Choice::Auto, Arithmetic::Free)?,
    };
    let mut devices = vec![&Device::Cpu];
    if !matches!(device, Device::Cpu) {
        devices.push(&device);
    }
    let config = Config { points: arguments.points, seed: arguments.seed };
    let report = stress::run(program, &moments, &config, &devices)?;
    messages.extend(report.diagnostics.iter().cloned());
    match arguments.message_format {
        MessageFormat::Human => {
            super::print_diagnostics(&prepared.session.sources, &messages);
            let names: Vec<String> = devices.iter().map(|device| device.description()).collect();
            super::print_line(&format!("{} moments, {} against f64", moments.len(), names.join(" and ")));
            table(&report)?;
        }
        MessageFormat::Json => {
            let mut text = diag::render::json(&prepared.session.sources, &messages);
            for row in &report.rows {
                text += &json(row);
            }
            io::stdout().write_all(text.as_bytes()).map_err(|error| Failure::stdout(&error))?;
        }
    }
    let failed = messages.iter().any(Diagnostic::is_error);
    if failed { Err(Failure::Reported(1)) } else { Ok(()) }
}

const HEADINGS: [&str; 6] =
    ["function", "points", "undecided", "max |f32-f64|/size", "max |f32-f64|/bound", "findings"];

fn table(report: &Report) -> Result<(), Failure> {
    let mut rows = vec![HEADINGS.map(str::to_owned).to_vec()];
    rows.extend(report.rows.iter().map(|row| {
        vec![
            row.name.clone(),
            row.points.to_string(),
            row.undecided.to_string(),
            format!("{:.1e}", row.apart),
            format!("{:.3}", row.share),
            row.findings.to_string(),
        ]
    }));
    print_table(&rows)
}

#[derive(Serialize)]
struct JsonRow<'a> {
    function: &'a str,
    points: usize,
    undecided: usize,
    /// Largest |f32 - f64| relative to the size of the values.
    apart: f64,
    /// Largest |f32 - f64| relative to the error bound.
    share_of_bound: f64,
    findings: usize,
}

fn json(row: &Row) -> String {
    let row = JsonRow {
        function: &row.name,
        points: row.points,
        undecided: row.undecided,
        apart: row.apart,
        share_of_bound: row.share,
        findings: row.findings,
    };
    serde_json::to_string(&row).expect("strings and numbers always become JSON") + "\n"
}
