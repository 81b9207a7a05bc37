//! Run time against error: what `vol bench` measures.
//!
//! ```text
//! Frame ──reference──► converged pixels in f64, kept on disk ─┐
//!   └──ladder of settings──► pictures, seconds ───────────────┴─► [Run] ──► CSV, Markdown, plot
//! ```

pub mod plot;
pub mod reference;

use std::fmt::Write as _;

use sysinfo::{CpuRefreshKind, RefreshKind, System};

/// One picture of the benchmark.
#[derive(Clone, Debug, PartialEq)]
pub struct Run {
    /// What made it: backend and method; one line of the plot.
    pub series: String,
    /// How it was asked for, as on the command line.
    pub setting: String,
    /// The error that was asked for, if the setting names one.
    pub promised: Option<f64>,
    /// From the frame to the picture: choosing steps and rendering, not compiling.
    pub seconds: f64,
    /// Measured error: rms of the difference to the reference over rms of the reference.
    pub error: f64,
    /// Points inside media at which their properties were computed.
    pub samples: u64,
    /// Points at which functions of the scene were computed.
    pub evaluations: u64,
}

/// Names of the series in the order in which they come.
#[must_use]
pub fn series(runs: &[Run]) -> Vec<&str> {
    let mut names: Vec<&str> = Vec::new();
    for run in runs {
        if !names.contains(&run.series.as_str()) {
            names.push(&run.series);
        }
    }
    names
}

/// The machine in words: its processor and the number of its cores.
#[must_use]
pub fn machine() -> String {
    let wanted = RefreshKind::nothing().with_cpu(CpuRefreshKind::nothing());
    let system = System::new_with_specifics(wanted);
    let cpus = system.as_ref().map_or(&[][..], System::cpus);
    let cores = cpus.len();
    let brand = cpus.first().map_or("", |cpu| cpu.brand()).trim();
    let brand = if brand.is_empty() { "unknown processor" } else { brand };
    format!("{brand}, {cores} {}", if cores == 1 { "core" } else { "cores" })
}

/// The columns of [`csv`] and [`rows`].
const COLUMNS: [&str; 7] = ["series", "setting", "promised", "error", "seconds", "samples", "evaluations"];

/// Runs as comma-separated values (RFC 4180) with a line of names; all digits.
#[must_use]
pub fn csv(runs: &[Run]) -> String {
    let mut text = COLUMNS.join(",") + "\n";
    for run in runs {
        let promised = run.promised.map_or_else(String::new, |error| format!("{error:e}"));
        let Run { series, setting, error, seconds, samples, evaluations, .. } = run;
        // No series or setting holds a comma or a quote.
        let _ = writeln!(text, "{series},{setting},{promised},{error:e},{seconds},{samples},{evaluations}");
    }
    text
}

/// Runs as rows of a table for people, names of the columns first.
#[must_use]
pub fn rows(runs: &[Run]) -> Vec<Vec<String>> {
    let row = |run: &Run| {
        vec![
            run.series.clone(),
            run.setting.clone(),
            run.promised.map_or_else(String::new, |error| format!("{error:.0e}")),
            format!("{:.1e}", run.error),
            format!("{:.3}", run.seconds),
            run.samples.to_string(),
            run.evaluations.to_string(),
        ]
    };
    let mut rows = vec![COLUMNS.map(str::to_owned).to_vec()];
    rows.extend(runs.iter().map(row));
    rows
}

/// A table in Markdown.
#[must_use]
pub fn markdown(rows: &[Vec<String>]) -> String {
    let mut text = String::new();
    for (index, row) in rows.iter().enumerate() {
        let _ = writeln!(text, "| {} |", row.join(" | "));
        if index == 0 {
            let _ = writeln!(text, "|{}", "---|".repeat(row.len()));
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_hold_what_was_measured() {
        let run = Run {
            series: "cpu".into(),
            setting: "--max-error 1e-2".into(),
            promised: Some(1e-2),
            seconds: 0.25,
            error: 4.2e-3,
            samples: 10,
            evaluations: 20,
        };
        let runs = [run.clone(), Run { series: "gpu".into(), promised: None, ..run.clone() }, run];
        assert_eq!(series(&runs), ["cpu", "gpu"]);
        let lines = csv(&runs);
        let lines: Vec<&str> = lines.lines().collect();
        assert_eq!(lines[0], "series,setting,promised,error,seconds,samples,evaluations");
        assert_eq!(lines[1], "cpu,--max-error 1e-2,1e-2,4.2e-3,0.25,10,20");
        assert_eq!(lines[2], "gpu,--max-error 1e-2,,4.2e-3,0.25,10,20");
        let table = markdown(&rows(&runs));
        assert!(table.starts_with("| series | setting |") && table.contains("|---|---|"));
        assert_eq!(table.lines().count(), 5);
    }
}
