//! Each comparator sees a planted error, and lets pass what it should.

use super::{EXACT, GPU_IMAGE, apart, field, images};
use vol_compiler::error_bound::Bounded;
use vol_compiler::frame::{Image, Pixel};

fn bounded(value: f64, error: f64) -> Bounded {
    Bounded { value, error }
}

fn picture() -> Image {
    let pixel =
        |i: u8| Pixel { color: [f32::from(i) / 50.0; 3], transmittance: [0.5; 3], depth: 2.0, error: 0.0 };
    Image { width: 40, height: 50, pixels: (0..2000_u16).map(|i| pixel((i % 100) as u8)).collect() }
}

#[test]
fn a_value_outside_its_bound_fails() {
    let expected = [bounded(1.0, 1e-6), bounded(2.0, 1e-6), bounded(3.0, 1e-6)];
    assert!(field(&[1.0, 2.0, 3.0], &expected, 1).passes());
    let report = field(&[1.0, 2.000_002, 3.0], &expected, 1);
    assert!(!report.passes());
    assert_eq!(report.worst_point, 1);
    assert!((report.worst - 2.0).abs() < 0.2, "{report:?}");
}

#[test]
fn nan_fails_and_so_does_missing_a_bound_of_zero() {
    assert!(!field(&[f32::NAN], &[bounded(1.0, 1.0)], 1).passes());
    assert!(!field(&[f32::INFINITY], &[bounded(1.0, 1.0)], 1).passes());
    assert!(!field(&[1.5], &[bounded(1.0, 0.0)], 1).passes());
    assert!(field(&[1.0], &[bounded(1.0, 0.0)], 1).passes());
}

#[test]
fn undecided_points_are_counted_not_judged() {
    let expected = [bounded(0.0, f64::INFINITY), bounded(0.0, 0.1), bounded(1.0, 0.1), bounded(1.0, 0.1)];
    let report = field(&[9.0, 0.0, 1.0, 1.0], &expected, 2);
    assert!(report.passes());
    assert_eq!((report.points, report.undecided), (2, 1));
    // The decided value of an undecided point is still judged.
    assert!(!field(&[9.0, 0.2, 1.0, 1.0], &expected, 2).passes());
    assert_eq!(apart(&[9.0, 0.0, 1.0, 1.0], &[0.0, 0.0, 1.0, 0.5], &expected), 0.5);
    assert_eq!(apart(&[9.0, f32::NAN, 1.0, 1.0], &[0.0, 0.0, 1.0, 1.0], &expected), f64::INFINITY);
}

#[test]
fn equal_pictures_pass_exactly() {
    assert!(images(&picture(), &picture(), EXACT).passes());
    let mut other = picture();
    other.pixels[7].color[1] = other.pixels[7].color[1].next_up();
    assert!(!images(&picture(), &other, EXACT).passes());
    assert!(images(&picture(), &other, GPU_IMAGE).passes());
}

#[test]
fn one_pixel_far_off_fails() {
    for channel in 0..6 {
        let mut other = picture();
        let pixel = &mut other.pixels[81];
        if channel < 3 {
            pixel.color[channel] += 0.3;
        } else {
            pixel.transmittance[channel - 3] -= 0.3;
        }
        let report = images(&picture(), &other, GPU_IMAGE);
        assert!(!report.passes());
        assert_eq!(report.worst_pixel, [1, 2]);
    }
}

#[test]
fn many_pixels_a_little_off_fail() {
    let mut other = picture();
    for pixel in &mut other.pixels[..5] {
        pixel.color[0] += 0.01;
    }
    assert!(!images(&picture(), &other, GPU_IMAGE).passes());
    let few = images(
        &other,
        &Image { pixels: [&picture().pixels[..4], &other.pixels[4..]].concat(), ..picture() },
        GPU_IMAGE,
    );
    assert!(few.passes(), "{few:?}");
}

#[test]
fn outlines_may_flip_here_and_there() {
    let mut other = picture();
    other.pixels[0] = Pixel { color: [0.9; 3], transmittance: [1.0; 3], depth: f32::INFINITY, error: 0.0 };
    let report = images(&picture(), &other, GPU_IMAGE);
    assert!(report.passes(), "{report:?}");
    assert!(report.max > 0.5);
    for pixel in &mut other.pixels[..5] {
        pixel.depth = f32::INFINITY;
    }
    assert!(!images(&picture(), &other, GPU_IMAGE).passes());
}

#[test]
fn what_is_no_number_fails_even_on_an_outline() {
    let mut other = picture();
    other.pixels[0] =
        Pixel { color: [f32::NAN; 3], transmittance: [1.0; 3], depth: f32::INFINITY, error: 0.0 };
    assert!(!images(&picture(), &other, GPU_IMAGE).passes());
    // NaN in both is not agreement.
    assert!(!images(&other, &other, EXACT).passes());
}

#[test]
fn pictures_of_different_size_fail() {
    let other = Image { width: 50, height: 40, ..picture() };
    assert!(!images(&picture(), &other, GPU_IMAGE).passes());
}
