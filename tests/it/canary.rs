//! Tests of the tests: each comparator sees an error that was planted.

use crate::support::{Random, compile, ensure, examples, frame, point, render};
use libtest_mimic::{Failed, Trial};
use vol::compare;
use vol_compiler::error_bound::Bounded;
use vol_compiler::frame::{Image, Job, Quadrature, Sampling};
use vol_compiler::ir::{Inst, Number};

/// The trials of this file.
pub(crate) fn trials() -> Vec<Trial> {
    vec![
        Trial::test("canary::field_sees_a_wrong_constant", field_sees_a_wrong_constant),
        Trial::test("canary::field_sees_a_single_wrong_value", field_sees_a_single_wrong_value),
        Trial::test("canary::field_sees_nan", field_sees_nan),
        Trial::test("canary::images_see_one_pixel", images_see_one_pixel),
        Trial::test("canary::images_see_a_faint_shift", images_see_a_faint_shift),
        Trial::test("canary::exact_images_see_the_last_bit", exact_images_see_the_last_bit),
        Trial::test("canary::examples_are_found", || ensure(examples().len() >= 4, || "no examples".into())),
    ]
}

const BALL: &str = "object ball { shape: box((0.3, 0.4, 0.5)).round(0.1) }";

/// Values of the ball's distance on the CPU and their bounds, after `tamper` on the CPU's function.
fn values(tamper: impl Fn(&mut Vec<Inst>)) -> Result<(Vec<f32>, Vec<Bounded>), Failed> {
    let program = compile("ball.vol", BALL)?;
    let frame = frame(&program, 0.0, [8, 8])?;
    let mut random = Random::new(3);
    let points: Vec<[f32; 3]> = (0..500).map(|_| point(&mut random, [-1.0; 3], [1.0; 3])).collect();
    let id = program.objects[0].distance;
    let expected = compare::expected(program.module.function(id), &frame, &points);
    let mut wrong = program.clone();
    tamper(&mut wrong.module.functions[id.index()].insts);
    let actual = vol::backend::Device::Cpu.evaluate(&wrong, &frame, id, &points);
    Ok((actual.map_err(|failure| format!("{failure:?}"))?, expected))
}

/// A constant wrong in the fifth digit.
fn field_sees_a_wrong_constant() -> Result<(), Failed> {
    let (right, expected) = values(|_| {})?;
    ensure(compare::field(&right, &expected, 1).passes(), || "the untampered values fail".into())?;
    let (wrong, expected) = values(|insts| {
        for inst in insts {
            if let Inst::Constant(Number(c)) = inst
                && *c != 0.0
            {
                *c *= 1.00003;
            }
        }
    })?;
    ensure(!compare::field(&wrong, &expected, 1).passes(), || "the planted error was not seen".into())
}

fn field_sees_a_single_wrong_value() -> Result<(), Failed> {
    let (mut values, expected) = values(|_| {})?;
    values[321] += 1e-4;
    let report = compare::field(&values, &expected, 1);
    ensure(!report.passes() && report.worst_point == 321, || {
        format!("the planted error was not seen: {report:?}")
    })
}

fn field_sees_nan() -> Result<(), Failed> {
    let (mut values, expected) = values(|_| {})?;
    values[7] = f32::NAN;
    ensure(!compare::field(&values, &expected, 1).passes(), || "a NaN was not seen".into())
}

fn ball_picture() -> Result<Image, Failed> {
    let program = compile("ball.vol", BALL)?;
    let frame = frame(&program, 0.0, [24, 24])?;
    render(
        &program,
        &frame,
        &Job {
            size: [24, 24],
            step: 1.0,
            shadow_step: 1.0,
            quadrature: Quadrature::Midpoint,
            sampling: Sampling::CENTRE,
        },
        1,
    )
}

/// Planted in the middle of the ball, not on its outline.
const MIDDLE: usize = 12 * 24 + 12;

fn images_see_one_pixel() -> Result<(), Failed> {
    let right = ball_picture()?;
    ensure(compare::images(&right, &right, compare::GPU_IMAGE).passes(), || {
        "a picture differs from itself".into()
    })?;
    let mut wrong = right.clone();
    wrong.pixels[MIDDLE].color[1] += 0.2;
    ensure(!compare::images(&right, &wrong, compare::GPU_IMAGE).passes(), || {
        "a wrong pixel was not seen".into()
    })
}

fn images_see_a_faint_shift() -> Result<(), Failed> {
    let right = ball_picture()?;
    let mut wrong = right.clone();
    wrong.pixels.iter_mut().for_each(|pixel| pixel.color[0] += 1e-3);
    ensure(!compare::images(&right, &wrong, compare::GPU_IMAGE).passes(), || {
        "a faint shift was not seen".into()
    })
}

fn exact_images_see_the_last_bit() -> Result<(), Failed> {
    let right = ball_picture()?;
    let mut wrong = right.clone();
    let value = &mut wrong.pixels[MIDDLE].color[2];
    *value = f32::from_bits(value.to_bits() + 1);
    ensure(!compare::images(&right, &wrong, compare::EXACT).passes(), || "the last bit was not seen".into())
}
