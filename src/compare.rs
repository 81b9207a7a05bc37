//! Comparisons between backends: numbers in, reports out. Used by `vol diff` and by the tests.
//!
//! * [`field`]: values of a field against the f64 reference and its running error bound
//! * [`images`]: two pictures under a named tolerance class
//! * [`first_difference`]: the number of a function at which two backends part
//!
//! A report says what was found and whether it [passes](ImageReport::passes); nothing here prints.

mod points;
mod trace;

pub use points::scatter;
pub use trace::{Difference, first_difference};

use rayon::prelude::*;
use vol_compiler::error_bound::{self, Bounded};
use vol_compiler::frame::{Frame, Image, Job, Pixel};
use vol_compiler::ir::Function;
use vol_compiler::program::Program;

/// The reference values of a function at points, each with the largest error that a conforming f32
/// evaluation can have there; as many in a row as the function has outputs.
#[must_use]
pub fn expected(function: &Function, frame: &Frame, points: &[[f32; 3]]) -> Vec<Bounded> {
    let at = |point: &[f32; 3]| error_bound::evaluate(function, point, &frame.uniforms, &frame.curves);
    points.par_iter().flat_map_iter(at).collect()
}

/// How far one backend's values of a field are from the reference.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FieldReport {
    /// Points compared.
    pub points: usize,
    /// Points with a value for which the reference gives no bound, because a decision (a
    /// comparison, a noise cell, the nearest foot) can fall either way. Not judged.
    pub undecided: usize,
    /// Largest |value − reference| / bound over the decided values; infinite if a value is no
    /// number or the bound is 0 and missed.
    pub worst: f64,
    /// Index of the point where `worst` was found.
    pub worst_point: usize,
    /// Largest finite bound.
    pub widest: f64,
}

impl FieldReport {
    /// Whether every decided value is within its bound.
    #[must_use]
    pub fn passes(&self) -> bool {
        self.worst <= 1.0
    }
}

/// Compares values of a field with the reference; both hold `outputs` numbers per point.
///
/// # Panics
/// If the numbers of values differ, which is a mistake of the caller.
#[must_use]
pub fn field(actual: &[f32], expected: &[Bounded], outputs: usize) -> FieldReport {
    assert_eq!(actual.len(), expected.len(), "as many values as references");
    let outputs = outputs.max(1);
    let mut report = FieldReport {
        points: expected.len() / outputs,
        undecided: 0,
        worst: 0.0,
        worst_point: 0,
        widest: 0.0,
    };
    let rows = actual.chunks_exact(outputs).zip(expected.chunks_exact(outputs));
    for (point, (actual, expected)) in rows.enumerate() {
        report.undecided += usize::from(!expected.iter().all(is_decided));
        for (&value, bounded) in actual.iter().zip(expected).filter(|(_, b)| is_decided(b)) {
            report.widest = report.widest.max(bounded.error);
            let share = share_of_bound(f64::from(value) - bounded.value, bounded.error);
            if share > report.worst {
                (report.worst, report.worst_point) = (share, point);
            }
        }
    }
    report
}

/// Largest difference between two backends' values of a field where the reference is decided.
#[must_use]
pub fn apart(a: &[f32], b: &[f32], expected: &[Bounded]) -> f64 {
    let decided = a.iter().zip(b).zip(expected).filter(|(_, bounded)| is_decided(bounded));
    let apart = decided.map(|((&a, &b), _)| if a == b { 0.0 } else { number(f64::from(a) - f64::from(b)) });
    apart.fold(0.0, f64::max)
}

/// How many values of two rows have other bits; what is no number is the same as any other.
#[must_use]
pub fn other_bits(a: &[f32], b: &[f32]) -> usize {
    a.iter().zip(b).filter(|(a, b)| a.to_bits() != b.to_bits() && !(a.is_nan() && b.is_nan())).count()
}

/// How many pixels of two pictures of one size have other bits.
#[must_use]
pub fn other_pixels(a: &Image, b: &Image) -> usize {
    let numbers = |pixel: &Pixel| {
        let [r, g, b] = pixel.color;
        let [red, green, blue] = pixel.transmittance;
        [r, g, b, red, green, blue, pixel.depth]
    };
    let pixels = a.pixels.iter().zip(&b.pixels);
    pixels.filter(|(a, b)| other_bits(&numbers(a), &numbers(b)) > 0).count()
}

fn is_decided(bounded: &Bounded) -> bool {
    bounded.error.is_finite() && bounded.value.is_finite()
}

fn share_of_bound(difference: f64, bound: f64) -> f64 {
    if difference == 0.0 { 0.0 } else { number(difference / bound) }
}

/// The magnitude; infinite for what is no number, so that it fails every test.
fn number(x: f64) -> f64 {
    if x.is_nan() { f64::INFINITY } else { x.abs() }
}

/// A tolerance for pictures. Differences are absolute up to 1 and relative above; see
/// [`difference`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ImageClass {
    /// For reports.
    pub name: &'static str,
    /// Pixels that differ by more than this count as different.
    pub threshold: f64,
    /// Largest share of different pixels, in 0..1.
    pub allowed_share: f64,
    /// No pixel may differ by more, but those where the rays met different surfaces: along an
    /// outline the last bit decides what is seen.
    pub hard_cap: f64,
}

/// The same arithmetic, bit for bit.
pub const EXACT: ImageClass = ImageClass { name: "EXACT", threshold: 0.0, allowed_share: 0.0, hard_cap: 0.0 };

/// CPU against GPU: the same formulas, contracted and reordered by the driver. On software Vulkan
/// the examples differ by at most 6e-6; the rest is room for hardware.
pub const GPU_IMAGE: ImageClass =
    ImageClass { name: "GPU_IMAGE", threshold: 1e-4, allowed_share: 2e-3, hard_cap: 0.1 };

/// f32 against f64 with the same samples: rounding alone. The examples differ by at most 2e-5, but
/// where a ray grazes a surface; pictures for this are small, so one such ray is a larger share.
pub const PRECISION: ImageClass =
    ImageClass { name: "PRECISION", threshold: 1e-4, allowed_share: 2e-2, hard_cap: 0.1 };

/// The picture that exact arithmetic would give for the same samples, by the f64 reference; slow.
#[must_use]
pub fn reference_picture(program: &Program, frame: &Frame, job: &Job) -> Image {
    let pixel = |values: &[f64; 7]| {
        let [r, g, b, red, green, blue, depth] = values.map(|value| value as f32);
        Pixel { color: [r, g, b], transmittance: [red, green, blue], depth, error: 0.0 }
    };
    let pixels = vol_runtime_cpu::render_reference(program, frame, job).iter().map(pixel).collect();
    Image { width: job.size[0], height: job.size[1], pixels }
}

/// How two pictures differ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ImageReport {
    /// The tolerance asked for.
    pub class: ImageClass,
    /// Pixels compared.
    pub pixels: usize,
    /// Largest difference of a pixel.
    pub max: f64,
    /// Largest difference of a pixel where both rays met the same surface, or none.
    pub max_inside: f64,
    /// Column and row of the pixel with the largest difference.
    pub worst_pixel: [u32; 2],
    /// Share of pixels over the threshold, in 0..1.
    pub share_over: f64,
    /// Whether the pictures have the same size; if not, nothing else was compared.
    pub same_size: bool,
}

impl ImageReport {
    /// Whether the pictures agree as the class demands.
    #[must_use]
    pub fn passes(&self) -> bool {
        self.same_size
            && self.max.is_finite()
            && self.share_over <= self.class.allowed_share
            && self.max_inside <= self.class.hard_cap
    }
}

/// Compares two pictures: radiance, transmittance and depth.
#[must_use]
pub fn images(a: &Image, b: &Image, class: ImageClass) -> ImageReport {
    let same_size = [a.width, a.height] == [b.width, b.height] && a.pixels.len() == b.pixels.len();
    let mut report = ImageReport {
        class,
        pixels: a.pixels.len(),
        max: 0.0,
        max_inside: 0.0,
        worst_pixel: [0; 2],
        share_over: 0.0,
        same_size,
    };
    if !same_size {
        return report;
    }
    let mut over = 0;
    for (i, (a_pixel, b_pixel)) in (0..).zip(a.pixels.iter().zip(&b.pixels)) {
        let difference = difference(a_pixel, b_pixel);
        over += u32::from(difference > class.threshold);
        if same_surface(a_pixel, b_pixel) {
            report.max_inside = report.max_inside.max(difference);
        }
        if difference > report.max {
            report.max = difference;
            report.worst_pixel = [i % a.width, i / a.width];
        }
    }
    report.share_over = f64::from(over) / a.pixels.len().max(1) as f64;
    report
}

/// The largest difference of two pixels' numbers: |a − b| / max(1, |a|, |b|) for each, 1 for a
/// depth that only one of them has, infinite if only one is a number.
#[must_use]
pub fn difference(a: &Pixel, b: &Pixel) -> f64 {
    let colors = a.color.into_iter().zip(b.color);
    let numbers = colors.chain(a.transmittance.into_iter().zip(b.transmittance));
    let worst = numbers.map(|(a, b)| relative(a, b)).fold(0.0, f64::max);
    let depth = match (a.depth.is_infinite(), b.depth.is_infinite()) {
        (true, true) => 0.0,
        (false, false) => relative(a.depth, b.depth),
        _ => 1.0,
    };
    worst.max(depth)
}

/// Root mean square of the differences of pairs (found, right) over that of the right numbers; 0 if all are
/// equal, infinite if only all right ones are 0.
#[must_use]
pub fn relative_rms(pairs: impl IntoIterator<Item = (f64, f64)>) -> f64 {
    let (mut apart, mut whole) = (0.0_f64, 0.0_f64);
    for (found, right) in pairs {
        apart += (found - right).powi(2);
        whole += right * right;
    }
    if apart == 0.0 { 0.0 } else { (apart / whole).sqrt() }
}

/// [`relative_rms`] of the colours of two pictures of one size.
#[must_use]
pub fn color_error(found: &Image, right: &Image) -> f64 {
    let colors = |image: &Image| image.pixels.iter().flat_map(|pixel| pixel.color).map(f64::from).collect();
    let [found, right]: [Vec<f64>; 2] = [colors(found), colors(right)];
    relative_rms(found.into_iter().zip(right))
}

/// Whether two rays met the same surface, or none: depths within one percent.
fn same_surface(a: &Pixel, b: &Pixel) -> bool {
    a.depth == b.depth || relative(a.depth, b.depth) <= 0.01
}

fn relative(a: f32, b: f32) -> f64 {
    let (a, b) = (f64::from(a), f64::from(b));
    // NaN is wrong in any picture, infinity where it is not in both.
    if a == b { 0.0 } else { number((a - b) / a.abs().max(b.abs()).max(1.0)) }
}

#[cfg(test)]
mod tests;
