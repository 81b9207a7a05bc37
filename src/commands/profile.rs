//! `vol profile`: what each line of a scene costs.

use std::io::{self, Write as _};
use std::time::{Duration, Instant};

use serde::Serialize;
use vol::backend::Device;
use vol::failure::Failure;
use vol::profile::{self, Cost, Line, Place, Report};

use super::progress::Progress;
use super::stats::timed;
use super::table::print_table;
use super::values::Size;
use super::{CANCELLED, Prepared, method, render};
use crate::cli::{self, MessageFormat};

/// Longest text of a line that is shown, in characters.
const TEXT: usize = 48;

pub(super) fn run(arguments: &cli::Profile) -> Result<(), Failure> {
    super::catch_interrupts()?;
    if let Some(threads) = arguments.threads {
        render::limit_threads(threads.into())?;
    }
    let prepared = Prepared::new(&arguments.scene)?;
    prepared.show_suspicions()?;
    let Prepared { session, params, moment } = &prepared;
    let size = arguments.size.map_or(session.program.render.size, |Size(size)| size);
    let mut frame = prepared.styled_frame(size)?;
    let sampling = session.sampling(params, *moment, arguments.samples, arguments.adaptive)?;
    let max_error = arguments.max_error.unwrap_or(method::MAX_ERROR);
    // Choose as a render does, which is not part of what is measured.
    let mut choosing = Duration::ZERO;
    let choice = timed(&mut choosing, || {
        vol_runtime_cpu::choose(&session.program, &mut frame, size, sampling, max_error)
    });
    super::stop_if_cancelled()?;
    let started = Instant::now();
    let progress = Progress::new(size.map(u64::from).iter().product());
    let report = profile::run(
        &session.program,
        &session.sources,
        &frame,
        &choice.job,
        &|done| progress.at(done),
        &CANCELLED,
    )?;
    drop(progress);
    match arguments.message_format {
        MessageFormat::Human => tables(&report)?,
        MessageFormat::Json => json(&report)?,
    }
    super::print_line(&format!(
        "{}: {}x{} in {:.2} s on {}, times added up over threads; choosing steps took {:.2} s more",
        arguments.scene.scene.display(),
        size[0],
        size[1],
        started.elapsed().as_secs_f64(),
        Device::Cpu.description(),
        choosing.as_secs_f64(),
    ));
    Ok(())
}

fn tables(report: &Report) -> Result<(), Failure> {
    let location = |place: &Place| match place {
        Place::Line(Line { file, number, .. }) => format!("{file}:{number}"),
        Place::Compiler => "(made by the compiler)".to_owned(),
        Place::Integrator => "(integrator)".to_owned(),
    };
    let locations: Vec<String> = report.places.iter().map(|(place, _)| location(place)).collect();
    let width = locations.iter().map(|location| location.chars().count()).max().unwrap_or(0);
    let named = |(location, (place, _)): (&String, &(Place, Cost))| match place {
        Place::Line(line) => format!("{location:<width$}  {}", shortened(&line.text)),
        Place::Compiler | Place::Integrator => location.clone(),
    };
    let names = locations.iter().zip(&report.places).map(named);
    let places = names.zip(report.places.iter().map(|(_, cost)| cost));
    print_table(&rows("line", places, report))?;
    writeln!(io::stdout()).map_err(|error| Failure::stdout(&error))?;
    let functions = report.functions.iter().map(|(name, cost)| (in_words(name), cost));
    print_table(&rows("function", functions, report))
}

fn rows<'a>(
    heading: &str,
    costs: impl Iterator<Item = (String, &'a Cost)>,
    report: &Report,
) -> Vec<Vec<String>> {
    let mut rows = vec![[heading, "evaluations", "operations", "ms", "share"].map(str::to_owned).to_vec()];
    let row = |name: String, cost: &Cost| {
        let share = format!("{:.1} %", 100.0 * share(cost, report));
        let milliseconds = format!("{:.1}", cost.milliseconds);
        vec![name, counted(cost.evaluations), counted(cost.operations), milliseconds, share]
    };
    rows.extend(costs.map(|(name, cost)| row(name, cost)));
    rows.push(row("total".to_owned(), &report.total));
    rows
}

/// Part of the whole time.
fn share(cost: &Cost, report: &Report) -> f64 {
    cost.milliseconds / report.total.milliseconds.max(f64::MIN_POSITIVE)
}

/// `distance:ball` as `distance of ball`.
fn in_words(name: &str) -> String {
    name.split_once(':').map_or_else(|| name.to_owned(), |(what, block)| format!("{what} of {block}"))
}

fn shortened(text: &str) -> String {
    match text.char_indices().nth(TEXT) {
        Some((end, _)) => format!("{}…", text[..end].trim_end()),
        None => text.to_owned(),
    }
}

/// Three digits or four, and k, M or G for thousands, millions and thousands of millions.
fn counted(count: u64) -> String {
    let scaled = |unit: f64, name: &str| {
        let number = count as f64 / unit;
        let digits = if number < 9.995 { 2 } else { usize::from(number < 99.95) };
        format!("{number:.digits$}{name}")
    };
    match count {
        0..10_000 => count.to_string(),
        10_000..1_000_000 => scaled(1e3, "k"),
        1_000_000..1_000_000_000 => scaled(1e6, "M"),
        _ => scaled(1e9, "G"),
    }
}

#[derive(Serialize)]
struct JsonRow<'a> {
    /// `line`, `compiler`, `integrator`, `function` or `total`.
    kind: &'a str,
    #[serde(skip_serializing_if = "Option::is_none")]
    file: Option<&'a str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    line: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    text: Option<&'a str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    function: Option<&'a str>,
    evaluations: u64,
    operations: u64,
    milliseconds: f64,
    /// Of the whole time, 0..1.
    share: f64,
}

fn json(report: &Report) -> Result<(), Failure> {
    let row = |kind: &'static str, cost: &Cost| JsonRow {
        kind,
        file: None,
        line: None,
        text: None,
        function: None,
        evaluations: cost.evaluations,
        operations: cost.operations,
        milliseconds: cost.milliseconds,
        share: share(cost, report),
    };
    let places = report.places.iter().map(|(place, cost)| match place {
        Place::Line(Line { file, number, text }) => {
            JsonRow { file: Some(file), line: Some(*number), text: Some(text), ..row("line", cost) }
        }
        Place::Compiler => row("compiler", cost),
        Place::Integrator => row("integrator", cost),
    });
    let functions =
        report.functions.iter().map(|(name, cost)| JsonRow { function: Some(name), ..row("function", cost) });
    let rows = places.chain(functions).chain([row("total", &report.total)]);
    let line = |row| serde_json::to_string(&row).expect("strings and numbers always become JSON") + "\n";
    let text: String = rows.map(line).collect();
    io::stdout().write_all(text.as_bytes()).map_err(|error| Failure::stdout(&error))
}

#[cfg(test)]
mod tests {
    use super::{counted, shortened};

    #[test]
    fn counts_are_short() {
        let shown = [0, 9999, 10_000, 123_456, 9_994_999, 45_678_901, 12_345_678_901].map(counted);
        assert_eq!(shown, ["0", "9999", "10.0k", "123k", "9.99M", "45.7M", "12.3G"]);
    }

    #[test]
    fn long_lines_are_cut() {
        assert_eq!(shortened("density: 1"), "density: 1");
        let long = shortened(&"é".repeat(60));
        assert_eq!(long.chars().count(), 49);
    }
}
