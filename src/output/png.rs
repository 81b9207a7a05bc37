//! PNG: what a screen shows. sRGB, 8 bits a channel, opaque.
//!
//! Example: linear 0.216 becomes 128, 1 and everything above 255, negative and NaN 0.

use std::io::{self, Write};
use std::sync::LazyLock;

use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder as _};
use vol_compiler::frame::Image;

/// Smallest linear value of each 8-bit sRGB code from 1 to 255.
static CODE_STARTS: LazyLock<[f32; 255]> =
    LazyLock::new(|| std::array::from_fn(|i| linear_from_srgb((i as f64 + 0.5) / 255.0) as f32));

/// Writes `picture` as a PNG file.
///
/// # Errors
/// What the writer reports.
pub fn write(picture: &Image, out: &mut dyn Write) -> io::Result<()> {
    let codes: Vec<u8> = picture.pixels.iter().flat_map(|pixel| pixel.color.map(srgb_code)).collect();
    write_codes(&codes, [picture.width, picture.height], out)
}

/// Writes rows of sRGB pixels, 8 bit, as a PNG file.
///
/// # Errors
/// What the writer reports, among it that `codes` are not three for each pixel.
pub fn write_codes(codes: &[u8], [width, height]: [u32; 2], out: &mut dyn Write) -> io::Result<()> {
    // Fixed settings: the same picture gives the same bytes.
    PngEncoder::new_with_quality(out, CompressionType::Default, FilterType::Adaptive)
        .write_image(codes, width, height, ExtendedColorType::Rgb8)
        .map_err(|error| match error {
            image::ImageError::IoError(error) => error,
            other => io::Error::other(other),
        })
}

/// The 8-bit sRGB code nearest to a linear value.
#[must_use]
pub fn srgb_code(linear: f32) -> u8 {
    // Comparisons with NaN are false, so it becomes 0.
    CODE_STARTS.partition_point(|&start| start <= linear) as u8
}

/// The sRGB transfer function (IEC 61966-2-1), code in 0..1 to linear.
fn linear_from_srgb(code: f64) -> f64 {
    if code <= 0.04045 { code / 12.92 } else { ((code + 0.055) / 1.055).powf(2.4) }
}

#[cfg(test)]
mod tests {
    use super::srgb_code;

    #[test]
    fn codes_round_to_the_nearest() {
        for code in 0..=255_u8 {
            let linear = super::linear_from_srgb(f64::from(code) / 255.0) as f32;
            assert_eq!(srgb_code(linear), code);
        }
        assert_eq!(srgb_code(0.216), 128);
    }

    #[test]
    fn what_a_screen_cannot_show_is_clamped() {
        assert_eq!([-1.0, f32::NAN, 0.0, 1.0, 7.0, f32::INFINITY].map(srgb_code), [0, 0, 0, 255, 255, 255]);
    }
}
