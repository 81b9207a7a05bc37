//! `vol diff`: the CPU, the GPU and the f64 reference on one scene.

use vol::backend::{Choice, Device};
use vol::compare::{self, FieldReport, GPU_IMAGE, ImageReport, PRECISION};
use vol::failure::Failure;
use vol_compiler::frame::{Frame, Job, Sampling};
use vol_compiler::program::{Field, Program};

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

/// Samples of a pixel at most: enough for an adaptive scene to stop early, and the arithmetic of more
/// is the same.
const MAX_SAMPLES: u32 = 25;

/// Error allowed in the compared pictures; both backends use the steps chosen for it.
const MAX_ERROR: f32 = 1e-2;

pub(super) fn run(arguments: &cli::Diff) -> Result<(), Failure> {
    super::catch_interrupts()?;
    let prepared = Prepared::new(&arguments.scene)?;
    let arithmetic = super::arithmetic(arguments.strict);
    let cpu = Device::open(Choice::Cpu, arithmetic)?;
    let gpu = Device::open(Choice::Gpu, arithmetic)?;
    let program = &prepared.session.program;
    let size = arguments.size.map_or_else(|| at_most(program.render.size, LONGEST_SIDE), |Size(size)| size);
    let frame = prepared.frame(size)?;
    let points = compare::scatter(&frame.bounds, arguments.points);
    super::print_line(&format!("{} against {}", cpu.description(), gpu.description()));

    let mut rows = vec![FIELD_HEADINGS.map(str::to_owned).to_vec()];
    let mut failed = 0;
    for field in &program.fields {
        super::stop_if_cancelled()?;
        let report = compare_field(program, &frame, field, &points, [&cpu, &gpu])?;
        failed += usize::from(!report.passes());
        rows.push(report.row(&field.name));
    }
    if rows.len() > 1 {
        print_table(&rows)?;
    }
    let pictures = compare_pictures(&prepared, size, [&cpu, &gpu])?;
    failed += pictures.iter().filter(|picture| !picture.report.passes()).count();
    let mut rows = vec![PICTURE_HEADINGS.map(str::to_owned).to_vec()];
    rows.extend(pictures.iter().map(PictureRow::row));
    print_table(&rows)?;
    match failed {
        0 => Ok(()),
        _ => {
            let all = program.fields.len() + pictures.len();
            Err(Failure::content(format!("{failed} of {all} comparisons failed")))
        }
    }
}

/// A field on both backends.
struct FieldRow {
    cpu: FieldReport,
    gpu: FieldReport,
    apart: f64,
}

const FIELD_HEADINGS: [&str; 8] = [
    "field",
    "points",
    "undecided",
    "widest bound",
    "|cpu-ref|/bound",
    "|gpu-ref|/bound",
    "max |cpu-gpu|",
    "",
];

impl FieldRow {
    fn passes(&self) -> bool {
        self.cpu.passes() && self.gpu.passes()
    }

    fn row(&self, name: &str) -> Vec<String> {
        vec![
            name.to_owned(),
            self.cpu.points.to_string(),
            self.cpu.undecided.to_string(),
            format!("{:.1e}", self.cpu.widest),
            format!("{:.3}", self.cpu.worst),
            format!("{:.3}", self.gpu.worst),
            format!("{:.1e}", self.apart),
            verdict(self.passes()),
        ]
    }
}

fn compare_field(
    program: &Program,
    frame: &Frame,
    field: &Field,
    points: &[[f32; 3]],
    [cpu, gpu]: [&Device; 2],
) -> Result<FieldRow, Failure> {
    let function = program.module.function(field.function);
    let outputs = function.outputs.len();
    let expected = compare::expected(function, frame, points);
    let on_cpu = cpu.evaluate(program, frame, field.function, points)?;
    let on_gpu = gpu.evaluate(program, frame, field.function, points)?;
    Ok(FieldRow {
        cpu: compare::field(&on_cpu, &expected, outputs),
        gpu: compare::field(&on_gpu, &expected, outputs),
        apart: compare::apart(&on_cpu, &on_gpu, &expected),
    })
}

/// The pictures of both backends against each other, and small ones against the reference.
fn compare_pictures(
    prepared: &Prepared,
    size: [u32; 2],
    [cpu, gpu]: [&Device; 2],
) -> Result<Vec<PictureRow>, Failure> {
    let program = &prepared.session.program;
    let render = |device: &Device, frame: &Frame, job: &Job| {
        Ok::<_, Failure>(device.prepare(program)?.render(frame, job, &|_| {}, &CANCELLED)?.image)
    };
    let mut frame = prepared.frame(size)?;
    let sampling = prepared.session.sampling(&prepared.params, prepared.moment, None, None)?;
    let sampling = Sampling { most: sampling.most.min(MAX_SAMPLES), ..sampling };
    let job = vol_runtime_cpu::choose(program, &mut frame, size, sampling, MAX_ERROR).job;
    let pair = compare::images(&render(cpu, &frame, &job)?, &render(gpu, &frame, &job)?, GPU_IMAGE);
    // Rounding shows with few samples as well as with many, and the reference is slow.
    let small = at_most(size, REFERENCE_SIDE);
    let frame = prepared.frame(small)?;
    let coarse = REFERENCE_COARSENESS;
    let (step, shadow_step) = (coarse * job.step, coarse * job.shadow_step);
    let job = Job { size: small, step, shadow_step, ..job };
    let reference = compare::reference_picture(program, &frame, &job);
    let against =
        |device| Ok::<_, Failure>(compare::images(&render(device, &frame, &job)?, &reference, PRECISION));
    Ok(vec![
        PictureRow { what: "cpu-gpu", size, report: pair },
        PictureRow { what: "cpu-ref", size: small, report: against(cpu)? },
        PictureRow { what: "gpu-ref", size: small, report: against(gpu)? },
    ])
}

/// Two pictures of one scene.
struct PictureRow {
    what: &'static str,
    size: [u32; 2],
    report: ImageReport,
}

const PICTURE_HEADINGS: [&str; 6] = ["picture", "size", "max difference", "at", "over tolerance", ""];

impl PictureRow {
    fn row(&self) -> Vec<String> {
        let ([width, height], [column, row]) = (self.size, self.report.worst_pixel);
        vec![
            self.what.to_owned(),
            format!("{width}x{height}"),
            format!("{:.1e}", self.report.max),
            format!("{column},{row}"),
            format!("{:.3} %", 100.0 * self.report.share_over),
            verdict(self.report.passes()),
        ]
    }
}

fn verdict(passes: bool) -> String {
    if passes { "ok" } else { "FAILED" }.to_owned()
}
