//! `vol query`: values of a field at points.

use std::fs::File;
use std::io::{self, BufRead, BufReader, BufWriter, Write as _};
use std::path::Path;

use vol::backend::{Choice, Device};
use vol::failure::Failure;
use vol_compiler::frame::Frame;
use vol_compiler::ir::FunctionId;
use vol_compiler::reference;

use super::Prepared;
use crate::cli::{self, QueryBackend};

/// Points evaluated at a time.
const BATCH: usize = 1 << 16;

pub(super) fn run(arguments: &cli::Query) -> Result<(), Failure> {
    let prepared = Prepared::new(&arguments.scene)?;
    let function = prepared.session.field(&arguments.field)?.function;
    let frame = prepared.frame(prepared.session.program.render.size)?;
    let arithmetic = super::arithmetic(arguments.strict);
    let device = match arguments.backend {
        QueryBackend::Reference => None,
        QueryBackend::Cpu => Some(Device::open(Choice::Cpu, arithmetic)?),
        QueryBackend::Gpu => Some(Device::open(Choice::Gpu, arithmetic)?),
    };
    let points = read_points(&arguments.at)?;
    let outputs = prepared.session.program.module.function(function).outputs.len();
    let mut out = BufWriter::new(io::stdout().lock());
    for points in points.chunks(BATCH) {
        let values = evaluate(&prepared, &frame, device.as_ref(), function, points)?;
        for row in values.chunks_exact(outputs) {
            let row: Vec<String> = row.iter().map(|&value| nine_digits(value)).collect();
            writeln!(out, "{}", row.join(",")).map_err(|error| Failure::stdout(&error))?;
        }
    }
    out.flush().map_err(|error| Failure::stdout(&error))
}

fn evaluate(
    prepared: &Prepared,
    frame: &Frame,
    device: Option<&Device>,
    function: FunctionId,
    points: &[[f32; 3]],
) -> Result<Vec<f64>, Failure> {
    let program = &prepared.session.program;
    match device {
        Some(device) => {
            let values = device.evaluate(program, frame, function, points)?;
            Ok(values.into_iter().map(f64::from).collect())
        }
        None => {
            let function = program.module.function(function);
            let at = |point: &[f32; 3]| {
                reference::evaluate(function, &point.map(f64::from), &frame.uniforms, &frame.curves)
            };
            Ok(points.iter().flat_map(at).collect())
        }
    }
}

/// Reads all points, so that a bad line is found before anything is written.
fn read_points(path: &Path) -> Result<Vec<[f32; 3]>, Failure> {
    if path == Path::new("-") {
        return parse_points(io::stdin().lock(), Path::new("standard input"));
    }
    if path.is_dir() {
        return Err(Failure::io("cannot read", path, "it is a folder, not a list of points"));
    }
    let file = File::open(path).map_err(|error| Failure::io("cannot read", path, error))?;
    parse_points(BufReader::new(file), path)
}

fn parse_points(mut lines: impl BufRead, path: &Path) -> Result<Vec<[f32; 3]>, Failure> {
    let mut points = Vec::new();
    let mut line = Vec::new();
    for number in 1.. {
        line.clear();
        let read = lines.read_until(b'\n', &mut line);
        if read.map_err(|error| Failure::io("cannot read", path, error))? == 0 {
            break;
        }
        let text = String::from_utf8_lossy(&line);
        // A comment goes from its sign to the end of the line.
        let text = text.split('#').next().unwrap_or_default().trim();
        if text.is_empty() {
            continue;
        }
        points.push(point(text).ok_or_else(|| {
            let failure = Failure::usage(format!(
                "line {number} of {} is no point: `{}`",
                path.display(),
                shortened(text)
            ));
            failure.with_help("write three numbers as in 0.5,1,-2")
        })?);
    }
    Ok(points)
}

/// `x,y,z`, as the runtimes see it: rounded to f32.
fn point(text: &str) -> Option<[f32; 3]> {
    let mut parts = text.split(',').map(|part| part.trim().parse::<f32>().ok().filter(|x| x.is_finite()));
    let point = [parts.next()??, parts.next()??, parts.next()??];
    parts.next().is_none().then_some(point)
}

fn shortened(text: &str) -> String {
    const LONGEST: usize = 60;
    let start: String = text.chars().take(LONGEST).collect();
    if start.len() < text.len() { start + "…" } else { start }
}

/// Nine significant digits, which tell any two f32 apart, without the zeros at the end; an
/// exponent where the number is very large or small.
fn nine_digits(value: f64) -> String {
    let scientific = format!("{value:.8e}");
    let Some((digits, exponent)) = scientific.split_once('e') else {
        // inf or NaN
        return scientific;
    };
    match exponent.parse::<i32>() {
        Ok(exponent @ -5..=8) => trimmed(&format!("{value:.*}", (8 - exponent) as usize)),
        _ => format!("{}e{exponent}", trimmed(digits)),
    }
}

fn trimmed(number: &str) -> String {
    match number.contains('.') {
        true => number.trim_end_matches('0').trim_end_matches('.').to_owned(),
        false => number.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::{nine_digits, parse_points};
    use std::path::Path;

    fn points(text: &[u8]) -> Result<Vec<[f32; 3]>, String> {
        parse_points(text, Path::new("p")).map_err(|failure| format!("{failure:?}"))
    }

    #[test]
    fn lines_are_points_comments_or_blank() {
        let text = b"1,2,3\r\n\n  # note\n -0.5 , 1e-3,0 # here\n4,5,6";
        assert_eq!(points(text), Ok(vec![[1.0, 2.0, 3.0], [-0.5, 1e-3, 0.0], [4.0, 5.0, 6.0]]));
        assert_eq!(points(b""), Ok(vec![]));
    }

    #[test]
    fn bad_lines_are_named() {
        for bad in ["1,2", "1,2,3,4", "1 2 3", "a,b,c", "nan,0,0", "1e39,0,0", "1,2,", "\u{fffd},0,0"] {
            let message = points(format!("1,2,3\n\n{bad}\n").as_bytes()).expect_err(bad);
            assert!(message.contains("line 3 of p"), "{message}");
        }
        assert!(points(b"\xff,0,0").is_err());
    }

    #[test]
    fn numbers_are_readable_and_exact() {
        let cases = [
            (0.0, "0"),
            (-0.0, "-0"),
            (1.0, "1"),
            (-1.5, "-1.5"),
            (0.1, "0.1"),
            (1.0 / 3.0, "0.333333333"),
            (123_456_789.4, "123456789"),
            (1e9, "1e9"),
            (2.5e-7, "2.5e-7"),
            (1e-5, "0.00001"),
            (100.0, "100"),
            (f64::INFINITY, "inf"),
            (f64::NAN, "NaN"),
            (999_999_999.9, "1e9"),
        ];
        for (value, text) in cases {
            assert_eq!(nine_digits(value), text);
            assert!(text.parse::<f64>().is_ok());
        }
        let mut bits = 1_u32;
        for _ in 0..10_000 {
            bits = bits.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let value = f32::from_bits(bits);
            if value.is_finite() {
                assert_eq!(nine_digits(f64::from(value)).parse::<f32>(), Ok(value));
            }
        }
    }
}
