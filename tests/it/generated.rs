//! Generated scenes: what they compute on the CPU and the GPU against the f64 reference, within the
//! running error bound. A scene that fails is made smaller before it is shown.

use crate::differential::{EvaluateField, compare_fields};
use crate::support::{compile, ensure};
use libtest_mimic::{Failed, Trial};
use vol::backend::Device;
use vol_compiler::program::Program;

/// Scenes on each backend.
const SCENES: u64 = 1000;

/// As many as `VOL_SCENES` says, for long runs, else the usual number.
pub(crate) fn scenes(usual: u64) -> u64 {
    std::env::var("VOL_SCENES").ok().and_then(|number| number.parse().ok()).unwrap_or(usual)
}

/// Points of each field.
const POINTS: usize = 24;

/// The trials of this file.
pub(crate) fn trials() -> Vec<Trial> {
    vec![
        Trial::test("generated::fields__cpu", || {
            check_all(scenes(SCENES), &|program, frame, id, points| {
                let values = Device::Cpu.evaluate(program, frame, id, points);
                values.map_err(|failure| format!("{failure:?}").into())
            })
        }),
        #[cfg(feature = "gpu")]
        crate::gpu_device::gpu_trial("generated::fields", |gpu| {
            check_all(scenes(SCENES), &|program, frame, id, points| {
                Ok(vol_runtime_gpu::evaluate(gpu, program, frame, id, points.as_flattened())?)
            })
        }),
    ]
}

/// What became of a scene.
enum Outcome {
    /// It was compared: points in all, and those that the reference cannot decide.
    Compared(usize, usize),
    /// It makes no sense at this moment, which a message says.
    Refused,
}

fn check_all(scenes: u64, evaluate: &EvaluateField) -> Result<(), Failed> {
    let (mut points, mut undecided, mut refused) = (0, 0, 0);
    for seed in 0..scenes {
        let bytes = vol_generator::bytes(seed, [60, 150, 300, 600][seed as usize % 4]);
        match check(&bytes, evaluate) {
            Ok(Outcome::Compared(all, unknown)) => {
                points += all;
                undecided += unknown;
            }
            Ok(Outcome::Refused) => refused += 1,
            Err(_) => {
                let smallest = vol_generator::shrink(&bytes, |bytes| check(bytes, evaluate).is_err());
                let error =
                    check(&smallest, evaluate).err().map_or(String::new(), |error| format!("{error:?}"));
                return Err(format!("seed {seed}: {error}\n{}", vol_generator::scene(&smallest)).into());
            }
        }
    }
    ensure(refused * 4 < scenes, || format!("{refused} of {scenes} scenes have no first frame"))?;
    ensure(undecided * 2 < points, || format!("{undecided} of {points} points are undecided"))
}

fn check(bytes: &[u8], evaluate: &EvaluateField) -> Result<Outcome, Failed> {
    let Some(program) = compiled(bytes)? else { return Ok(Outcome::Refused) };
    let frame = program.frame(&program.default_params(), 0.7, 2.0, [8, 8]).map_err(|d| d.message)?;
    let (mut points, mut undecided) = (0, 0);
    for (name, report) in compare_fields(&program, &frame, POINTS, evaluate)? {
        ensure(report.passes(), || format!("{name}: {report:?}"))?;
        points += report.points;
        undecided += report.undecided;
    }
    Ok(Outcome::Compared(points, undecided))
}

/// The program of a generated scene; none if its first frame makes no sense, which a message says.
pub(crate) fn compiled(bytes: &[u8]) -> Result<Option<Program>, Failed> {
    match compile("generated.vol", &vol_generator::scene(bytes)) {
        Ok(program) => Ok(Some(program)),
        // Numbers that only a frame knows may be out of range.
        Err(failed) if failed.message().is_some_and(is_of_frame) => Ok(None),
        Err(failed) => Err(failed),
    }
}

/// Whether a message is about a frame: bounds and slopes that are known only then.
fn is_of_frame(message: &str) -> bool {
    ["E0501", "E0502", "E0503"].iter().any(|code| message.contains(code))
}
