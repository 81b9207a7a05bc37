//! `vol diff`: the CPU, the GPU and the f64 reference on one scene.

use std::path::Path;

use vol::backend::{Choice, Device, Renderer};
use vol::compare::{self, Difference, FieldReport, GPU_IMAGE, ImageClass, ImageReport, PRECISION};
use vol::failure::Failure;
use vol::output::{Format, atomic, png, ramp};
use vol_compiler::frame::{Frame, Image, Job, Sampling};
use vol_compiler::program::Program;

use super::table::print_table;
use super::values::Size;
use super::{CANCELLED, Prepared, at_most};
use crate::cli;

/// Longest side of the compared pictures where none is asked for, in pixels.
const LONGEST_SIDE: u32 = 256;

/// Longest side of the pictures compared with the reference, in pixels.
const REFERENCE_SIDE: u32 = 32;

/// Their samples are this many times farther apart than the pilot's.
const REFERENCE_COARSENESS: f32 = 4.0;

/// Points along a ray at which fields are looked at.
const RAY_POINTS: usize = 16;

/// Samples of a pixel at most: enough for an adaptive scene to stop early, and the arithmetic of more
/// is the same.
const MAX_SAMPLES: u32 = 25;

/// Error allowed in the compared pictures; both backends use the steps chosen for it.
const MAX_ERROR: f32 = 1e-2;

pub(super) fn run(arguments: &cli::Diff) -> Result<(), Failure> {
    arguments.difference.as_deref().map(probe).transpose()?;
    super::catch_interrupts()?;
    let prepared = Prepared::new(&arguments.scene)?;
    let arithmetic = super::arithmetic(arguments.strict);
    let [cpu, gpu] = [Device::open(Choice::Cpu, arithmetic)?, Device::open(Choice::Gpu, arithmetic)?];
    super::print_line(&format!("{} against {}", cpu.description(), gpu.description()));
    let pair = Pair { cpu: &cpu, gpu: &gpu, demands_bits: arguments.strict && !gpu.is_hardware() };
    let program = &prepared.session.program;
    let size = arguments.size.map_or_else(|| at_most(program.render.size, LONGEST_SIDE), |Size(size)| size);
    let frame = prepared.frame(size)?;
    let points = compare::scatter(&frame.bounds, arguments.points);

    let fields = compare_fields(program, &frame, &points, &pair)?;
    if !fields.is_empty() {
        let rows = fields.iter().zip(&program.fields).map(|(row, field)| row.row(&field.name, &pair));
        show(&FIELD_HEADINGS, rows)?;
    }
    let pictures = compare_pictures(&prepared, size, &pair)?;
    show(&PICTURE_HEADINGS, pictures.rows.iter().map(|row| row.row(&pair)))?;
    if let Some(path) = &arguments.difference {
        let codes = pictures.difference();
        atomic::write(path, |out| png::write_codes(&codes, size, out))?;
    }

    let failed_fields: Vec<usize> = (0..fields.len()).filter(|&i| !fields[i].passes(&pair)).collect();
    let failed_pictures = pictures.rows.iter().filter(|row| !row.passes(&pair)).count();
    let failed = failed_fields.len() + failed_pictures;
    if failed == 0 {
        return Ok(());
    }
    let places = match failed_fields.as_slice() {
        [] => pictures.places(&frame, program),
        some => some.iter().map(|&i| (i, points[fields[i].worst_point(&pair)])).collect(),
    };
    explain(&prepared, &frame, &places, &pair)?;
    let all = fields.len() + pictures.rows.len();
    Err(Failure::content(format!("{failed} of {all} comparisons failed")))
}

/// Finds out whether the difference can be written before the work is done.
fn probe(path: &Path) -> Result<(), Failure> {
    if Format::of(path)? != Format::Png {
        return Err(Failure::usage(format!("the difference is a PNG, not `{}`", path.display())));
    }
    atomic::probe(path)
}

fn show(headings: &[&str], rows: impl Iterator<Item = Vec<String>>) -> Result<(), Failure> {
    let headings = headings.iter().map(|&heading| heading.to_owned()).collect();
    print_table(&[headings].into_iter().chain(rows).collect::<Vec<_>>())
}

/// What is compared, and how strictly.
struct Pair<'a> {
    cpu: &'a Device,
    gpu: &'a Device,
    /// Whether both must give the same bits: with strict arithmetic, on a device whose operations are known to round
    /// correctly. Hardware may divide and take roots otherwise; then bits are counted only.
    demands_bits: bool,
}

/// Shows the first number that differs at the first of some places at which one does.
fn explain(
    prepared: &Prepared,
    frame: &Frame,
    places: &[(usize, [f32; 3])],
    pair: &Pair<'_>,
) -> Result<(), Failure> {
    let program = &prepared.session.program;
    for &(index, point) in places {
        let field = &program.fields[index];
        let devices = [pair.cpu, pair.gpu];
        let found =
            compare::first_difference(program, frame, field.function, point, devices, pair.demands_bits)?;
        let Some(Difference { operation, place, values: [cpu, gpu], allowed }) = found else { continue };
        let [x, y, z] = point;
        super::print_line(&format!(
            "`{operation}` is the first to differ in `{}` at ({x}, {y}, {z}): {cpu:?} on the CPU, {gpu:?} on the GPU, \
             {allowed:.1e} apart is allowed",
            field.name
        ));
        if let Some(line) = place.map(|span| super::line_of(&prepared.session.sources, span)) {
            super::print_line(&format!("  {line}"));
        }
        return Ok(());
    }
    super::print_line("no field differs by more than allowed where the comparisons are worst");
    Ok(())
}

/// A field on both backends.
struct FieldRow {
    cpu: FieldReport,
    gpu: FieldReport,
    apart: f64,
    /// Values with other bits, and the first point with one.
    others: usize,
    first_other: Option<usize>,
}

const FIELD_HEADINGS: [&str; 9] = [
    "field",
    "points",
    "undecided",
    "widest bound",
    "|cpu-ref|/bound",
    "|gpu-ref|/bound",
    "max |cpu-gpu|",
    "other bits",
    "",
];

impl FieldRow {
    fn passes(&self, pair: &Pair<'_>) -> bool {
        self.cpu.passes() && self.gpu.passes() && (self.others == 0 || !pair.demands_bits)
    }

    /// The point that says most about a failure.
    fn worst_point(&self, pair: &Pair<'_>) -> usize {
        match self.first_other {
            Some(point) if pair.demands_bits => point,
            _ if self.cpu.passes() => self.gpu.worst_point,
            _ => self.cpu.worst_point,
        }
    }

    fn row(&self, name: &str, pair: &Pair<'_>) -> Vec<String> {
        vec![
            name.to_owned(),
            self.cpu.points.to_string(),
            self.cpu.undecided.to_string(),
            format!("{:.1e}", self.cpu.widest),
            format!("{:.3}", self.cpu.worst),
            format!("{:.3}", self.gpu.worst),
            format!("{:.1e}", self.apart),
            self.others.to_string(),
            verdict(self.passes(pair)),
        ]
    }
}

/// All fields, in the order of the program.
fn compare_fields(
    program: &Program,
    frame: &Frame,
    points: &[[f32; 3]],
    pair: &Pair<'_>,
) -> Result<Vec<FieldRow>, Failure> {
    let compared = program.fields.iter().map(|field| {
        super::stop_if_cancelled()?;
        let function = program.module.function(field.function);
        let outputs = function.outputs.len();
        let expected = compare::expected(function, frame, points);
        let on_cpu = pair.cpu.evaluate(program, frame, field.function, points)?;
        let on_gpu = pair.gpu.evaluate(program, frame, field.function, points)?;
        let rows = on_cpu.chunks_exact(outputs).zip(on_gpu.chunks_exact(outputs));
        Ok(FieldRow {
            cpu: compare::field(&on_cpu, &expected, outputs),
            gpu: compare::field(&on_gpu, &expected, outputs),
            apart: compare::apart(&on_cpu, &on_gpu, &expected),
            others: compare::other_bits(&on_cpu, &on_gpu),
            first_other: rows.into_iter().position(|(a, b)| compare::other_bits(a, b) > 0),
        })
    });
    compared.collect()
}

/// Pictures of both backends against each other, and small ones against the reference.
struct Pictures {
    rows: Vec<PictureRow>,
    cpu: Image,
    gpu: Image,
}

impl Pictures {
    /// How far apart the two pictures are, on a logarithmic ramp: white where no number differs.
    fn difference(&self) -> Vec<u8> {
        let pixels = self.cpu.pixels.iter().zip(&self.gpu.pixels);
        let apart: Vec<f64> = pixels.map(|(a, b)| compare::difference(a, b)).collect();
        // The ramp counts: a difference of one in a million is 1.
        let counts: Vec<u64> = apart.iter().map(|&apart| (1e9 * apart.min(1e6)) as u64).collect();
        let mut codes = ramp::codes(&counts);
        for (pixel, _) in codes.chunks_exact_mut(3).zip(&apart).filter(|&(_, &apart)| apart == 0.0) {
            pixel.fill(255);
        }
        codes
    }

    /// Where to look for what differs if no field does: along the ray of the worst pixel, in all fields.
    fn places(&self, frame: &Frame, program: &Program) -> Vec<(usize, [f32; 3])> {
        let ([column, row], camera) = (self.rows[0].report.worst_pixel, &frame.camera);
        let at = |place: u32, size: u32| 2.0 * (place as f32 + 0.5) / size as f32 - 1.0;
        let (u, v) = (at(column, self.cpu.width), -at(row, self.cpu.height));
        let depth = self.cpu.pixels[(row * self.cpu.width + column) as usize].depth;
        let farthest = if depth.is_finite() { depth } else { 2.0 * frame.bounds.diagonal().min(1e3) };
        let on_ray = |t: f32| -> [f32; 3] {
            std::array::from_fn(|axis| {
                let toward = camera.forward[axis] + u * camera.right[axis] + v * camera.up[axis];
                camera.origin[axis] + t * toward
            })
        };
        let points = (0..RAY_POINTS).rev().map(|i| on_ray(farthest * (i + 1) as f32 / RAY_POINTS as f32));
        points.flat_map(|point| (0..program.fields.len()).map(move |field| (field, point))).collect()
    }
}

fn compare_pictures(prepared: &Prepared, size: [u32; 2], pair: &Pair<'_>) -> Result<Pictures, Failure> {
    let program = &prepared.session.program;
    // Prepared once for both sizes: a pipeline takes a device seconds to compile.
    let (cpu, gpu) = (pair.cpu.prepare(program)?, pair.gpu.prepare(program)?);
    let render = |renderer: &Renderer<'_>, frame: &Frame, job: &Job| {
        Ok::<_, Failure>(renderer.render(frame, job, &|_| {}, &CANCELLED)?.image)
    };
    let mut frame = prepared.styled_frame(size)?;
    let sampling = prepared.session.sampling(&prepared.params, prepared.moment, None, None)?;
    let sampling = Sampling { most: sampling.most.min(MAX_SAMPLES), ..sampling };
    let job = vol_runtime_cpu::choose(program, &mut frame, size, sampling, MAX_ERROR).job;
    let (on_cpu, on_gpu) = (render(&cpu, &frame, &job)?, render(&gpu, &frame, &job)?);
    let both = PictureRow::new("cpu-gpu", &on_cpu, &on_gpu, GPU_IMAGE);
    // Rounding shows with few samples as well as with many, and the reference is slow.
    let small = at_most(size, REFERENCE_SIDE);
    let frame = prepared.styled_frame(small)?;
    let coarse = REFERENCE_COARSENESS;
    let (step, shadow_step) = (coarse * job.step, coarse * job.shadow_step);
    let job = Job { size: small, step, shadow_step, ..job };
    let reference = compare::reference_picture(program, &frame, &job);
    let cpu = PictureRow::new("cpu-ref", &render(&cpu, &frame, &job)?, &reference, PRECISION);
    let gpu = PictureRow::new("gpu-ref", &render(&gpu, &frame, &job)?, &reference, PRECISION);
    Ok(Pictures { rows: vec![both, cpu, gpu], cpu: on_cpu, gpu: on_gpu })
}

/// Two pictures of one scene.
struct PictureRow {
    what: &'static str,
    report: ImageReport,
    size: [u32; 2],
    /// Pixels with other bits; none of the reference, whose numbers are rounded from longer ones.
    others: Option<usize>,
}

const PICTURE_HEADINGS: [&str; 7] =
    ["picture", "size", "max difference", "at", "over tolerance", "other bits", ""];

impl PictureRow {
    fn new(what: &'static str, a: &Image, b: &Image, class: ImageClass) -> Self {
        let others = (class == GPU_IMAGE).then(|| compare::other_pixels(a, b));
        Self { what, report: compare::images(a, b, class), size: [a.width, a.height], others }
    }

    fn passes(&self, pair: &Pair<'_>) -> bool {
        self.report.passes() && (self.others.unwrap_or(0) == 0 || !pair.demands_bits)
    }

    fn row(&self, pair: &Pair<'_>) -> Vec<String> {
        let ([width, height], [column, row]) = (self.size, self.report.worst_pixel);
        vec![
            self.what.to_owned(),
            format!("{width}x{height}"),
            format!("{:.1e}", self.report.max),
            format!("{column},{row}"),
            format!("{:.3} %", 100.0 * self.report.share_over),
            self.others.map_or_else(String::new, |pixels| pixels.to_string()),
            verdict(self.passes(pair)),
        ]
    }
}

fn verdict(passes: bool) -> String {
    if passes { "ok" } else { "FAILED" }.to_owned()
}
