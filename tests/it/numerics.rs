//! The tables of `docs/numerics.md`: how far f32 is from f64, measured.
//!
//! `VOL_UPDATE_DOCS=1 cargo test --test it -- numerics` writes them anew. Without, the page must have the
//! same rows, and its figures of the CPU, which computes the same bits everywhere, must be those measured but
//! for what the last bit of f64 makes of them; those of the GPU are its driver's and are not compared. Without a
//! device they stay as they are.

use crate::differential::{function_of, on_cpu, operands};
use crate::primitives;
use crate::stress::{CURVES, compiled};
use crate::support::{FIRST, ensure, frame, program_of};
use libtest_mimic::{Failed, Trial};
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use vol::backend::Device;
use vol::stress::{self, Config};
use vol_compiler::error_bound::{self, Bounded};
use vol_compiler::ops::{Operation, TABLE};
use vol_compiler::wgsl::Arithmetic;

/// The trials of this file.
pub(crate) fn trials() -> Vec<Trial> {
    vec![Trial::test("numerics::tables_are_current", tables_are_current)]
}

/// Places per function of a scene.
const PLACES: Config = Config { points: 500, seed: 1 };

/// Phase functions.
const PHASES: &[&str] = &[
    "isotropic()",
    "rayleigh()",
    "henyey_greenstein(0.5)",
    "henyey_greenstein(0.99)",
    "henyey_greenstein(0.9999)",
    "schlick(0.9)",
    "double_hg(0.9, -0.3, 0.7)",
];

/// Solids made of others.
const OPERATORS: &[&str] = &[
    "box((0.5, 0.3, 0.4)) | sphere(0.4)",
    "box((0.5, 0.3, 0.4)) & sphere(0.4)",
    "box((0.5, 0.3, 0.4)) - sphere(0.4)",
    "union(box((0.5, 0.3, 0.4)), sphere(0.4), smooth: 0.3)",
    "union(box((0.5, 0.3, 0.4)), sphere(0.4), chamfer: 0.2)",
    "union(box((0.5, 0.3, 0.4)), sphere(0.4), stairs: 0.3)",
    "box((0.5, 0.3, 0.4)).twist(90deg)",
    "box((0.5, 0.3, 0.4)).bend(50deg)",
    "torus(0.4, 0.15).scale((1.5, 0.4, 1))",
    "sphere(0.3).repeat((1, 1, 1), count: (3, 2, 1))",
    "sphere(1).displace(p => 0.1 * perlin(3 * p))",
    "mandelbulb()",
];

/// Largest |f32 - f64| relative to the size of the values, and the largest share of the bound.
#[derive(Clone, Copy, Debug, Default)]
struct Off {
    apart: f64,
    share: f64,
}

impl Off {
    fn or(self, other: Self) -> Self {
        Self { apart: self.apart.max(other.apart), share: self.share.max(other.share) }
    }
}

/// A row: what it is about, the CPU, the GPU.
struct Row {
    name: String,
    cpu: Off,
    gpu: Option<Off>,
}

/// Where the GPU's column comes from, if it is measured.
fn gpu() -> Option<&'static Device> {
    static DEVICE: std::sync::OnceLock<Option<Device>> = std::sync::OnceLock::new();
    std::env::var_os("VOL_UPDATE_DOCS")?;
    DEVICE.get_or_init(|| Device::open(vol::backend::Choice::Gpu, Arithmetic::Free).ok()).as_ref()
}

fn tables_are_current() -> Result<(), Failed> {
    let path: PathBuf = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/numerics.md");
    let text = std::fs::read_to_string(&path)?;
    let known = figures(&text);
    let mut out = String::new();
    let mut skipping = false;
    for line in text.lines() {
        if let Some(name) = line.strip_prefix("<!-- table: ").and_then(|rest| rest.strip_suffix(" -->")) {
            let rows = rows(name)?;
            out += &format!("{line}\n{}", written(&rows, &known));
            if std::env::var_os("VOL_UPDATE_DOCS").is_none() {
                compare(name, &rows, &known)?;
            }
            skipping = true;
        } else if line == "<!-- end -->" {
            skipping = false;
        }
        if !skipping {
            out += line;
            out.push('\n');
        }
    }
    if std::env::var_os("VOL_UPDATE_DOCS").is_some() {
        std::fs::write(path, out)?;
        return Ok(());
    }
    // The rows are the same and in the same order.
    let names =
        |text: &str| text.lines().filter_map(|line| Some(cells(line)?[0].clone())).collect::<Vec<_>>();
    ensure(names(&text) == names(&out), || {
        "docs/numerics.md is out of date: run `VOL_UPDATE_DOCS=1 cargo test --test it -- numerics`".into()
    })
}

/// The cells of a row with figures.
fn cells(line: &str) -> Option<Vec<String>> {
    let cells: Vec<String> =
        line.strip_prefix("| ")?.trim_end_matches(" |").split(" | ").map(str::to_owned).collect();
    (cells.len() == 5 && cells[0].starts_with('`')).then_some(cells)
}

fn figures(text: &str) -> HashMap<String, Vec<String>> {
    text.lines().filter_map(cells).map(|cells| (cells[0].clone(), cells)).collect()
}

const HEADING: &str = "| | CPU | GPU | CPU, of the bound | GPU, of the bound |\n|---|---|---|---|---|\n";

fn written(rows: &[Row], known: &HashMap<String, Vec<String>>) -> String {
    let mut out = HEADING.to_owned();
    for row in rows {
        let name = cell(row);
        let old = |i: usize| known.get(&name).map_or("-", |cells| &cells[i]).to_owned();
        let gpu = row.gpu.map(|off| [apart(off), share(off)]).unwrap_or_else(|| [old(2), old(4)]);
        let [gpu_apart, gpu_share] = gpu;
        out += &format!("| {name} | {} | {gpu_apart} | {} | {gpu_share} |\n", apart(row.cpu), share(row.cpu));
    }
    out
}

/// The first cell of a row.
fn cell(row: &Row) -> String {
    format!("`{}`", row.name.replace('|', "\\|"))
}

fn apart(off: Off) -> String {
    if off.apart == 0.0 { "0".to_owned() } else { format!("{:.1e}", off.apart) }
}

fn share(off: Off) -> String {
    format!("{:.2}", off.share)
}

fn compare(table: &str, rows: &[Row], known: &HashMap<String, Vec<String>>) -> Result<(), Failed> {
    for row in rows {
        let cells = known.get(&cell(row));
        let near = |cell: &str, found: f64| {
            let told: f64 = cell.parse().unwrap_or(f64::NAN);
            (told - found).abs()
                <= 0.1 * found.abs().max(told.abs()) + 0.01 * f64::from(u8::from(found >= 1e-3))
        };
        let right =
            cells.is_some_and(|cells| near(&cells[1], row.cpu.apart) && near(&cells[3], row.cpu.share));
        ensure(right, || {
            format!("`{}` of the table {table}: {:?}, the page says {cells:?}", row.name, row.cpu)
        })?;
    }
    Ok(())
}

fn rows(table: &str) -> Result<Vec<Row>, Failed> {
    let solids =
        |texts: Vec<&str>| texts.into_iter().map(|text| (text.to_owned(), text.to_owned())).collect();
    match table {
        "operations" => TABLE.iter().map(operation).collect(),
        "primitives" => {
            shapes(solids(primitives::SOLIDS.iter().map(|row| row.0).collect()), "object o { shape: S }")
        }
        "operators" => shapes(solids(OPERATORS.to_vec()), "object o { shape: S }"),
        "tubes" => {
            let medium = "medium m { region: tube(S, radius: 0.2), density: q => 1 + q.radius + q.l }";
            shapes(solids(CURVES.to_vec()), medium)
        }
        "phases" => shapes(solids(PHASES.to_vec()), "medium m { region: sphere(1), phase: S }"),
        _ => Err(format!("there is no table `{table}`").into()),
    }
}

/// An operation at operands drawn from its domain, relative to the largest result.
fn operation(row: &Operation) -> Result<Row, Failed> {
    let (mut cpu, mut gpu_off): (Off, Option<Off>) = (Off::default(), None);
    for data in if row.has_data { 0..2 } else { 0..1 } {
        let inputs = operands(row);
        let program = program_of(function_of(row, data))?;
        let frame = frame(&program, 0.0, [8, 8])?;
        let function = program.module.function(FIRST);
        let expected: Vec<Bounded> = inputs
            .chunks_exact(function.inputs as usize)
            .flat_map(|inputs| error_bound::evaluate(function, inputs, &frame.uniforms, &frame.curves))
            .collect();
        cpu = cpu.or(off(&on_cpu(&program, &frame, &inputs)?, &expected));
        #[cfg(feature = "gpu")]
        if let Some(Device::Gpu(gpu)) = gpu() {
            let found = vol_runtime_gpu::evaluate(gpu, &program, &frame, FIRST, &inputs)?;
            gpu_off = Some(gpu_off.unwrap_or_default().or(off(&found, &expected)));
        }
    }
    Ok(Row { name: row.name.to_owned(), cpu, gpu: gpu_off })
}

fn off(found: &[f32], expected: &[Bounded]) -> Off {
    let decided = || expected.iter().zip(found).filter(|(bounded, _)| bounded.error.is_finite());
    let scale = decided().map(|(bounded, _)| bounded.value.abs()).fold(0.0, f64::max);
    let mut off = Off::default();
    for (bounded, &found) in decided() {
        let apart = (f64::from(found) - bounded.value).abs();
        if apart > 0.0 {
            off = off.or(Off { apart: apart / scale, share: apart / bounded.error });
        }
    }
    off
}

/// Scenes made of `S`; all their functions together but for those of the surface and of the default material.
fn shapes(texts: Vec<(String, String)>, scene: &str) -> Result<Vec<Row>, Failed> {
    let row = |(name, text): (String, String)| {
        let program = compiled(&scene.replace('S', &text))?;
        let (moments, _) = stress::moments(&program, &program.default_params(), 0.0);
        let measure = |device: &Device| {
            let report = stress::run(&program, &moments[..1], &PLACES, &[device]);
            let report = report.map_err(|failure| format!("{failure:?}"))?;
            let is_about = |name: &str| match scene.contains("phase") {
                true => name.starts_with("phase"),
                false => ["distance", "region", "interior"].iter().any(|what| name.starts_with(what)),
            };
            let rows = report.rows.iter().filter(|row| is_about(&row.name));
            Ok::<_, Failed>(
                rows.map(|row| Off { apart: row.apart, share: row.share }).fold(Off::default(), Off::or),
            )
        };
        Ok(Row { name, cpu: measure(&Device::Cpu)?, gpu: gpu().map(&measure).transpose()? })
    };
    texts.into_iter().map(row).collect()
}
