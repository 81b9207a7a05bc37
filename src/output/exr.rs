//! OpenEXR: everything that was computed, scene-linear Rec. 709, 32-bit float.
//!
//! | channel                    | meaning                                                        |
//! |----------------------------|----------------------------------------------------------------|
//! | `R` `G` `B`                | radiance, background included                                  |
//! | `A`                        | 1 − mean transmittance                                         |
//! | `Z`                        | distance of the first surface along the viewing axis, or inf   |
//! | `Transmittance.R` `.G` `.B`| fraction of the background's light that arrives                |
//! | `Error.Estimate`           | how far `RGB` may be off for want of samples of media          |
//! | `Cost.Operations`          | of the scene's functions for the pixel, in additions; if asked |
//! | `Cost.Evaluations`         | points at which functions were evaluated for it; if asked      |
//!
//! To put another background behind the picture, subtract `Transmittance` times the scene's own
//! background from `RGB` and add `Transmittance` times the other.
//!
//! `Error.Estimate` is an rms over the three channels. Its rms over the picture is the estimate that `--stats`
//! reports, times the rms of the radiance: that is safe. The number of one pixel tells where errors are likely,
//! and may be several times too large or too small.

use std::io;
use std::path::Path;

use exr::prelude::{
    AnyChannel, AnyChannels, Encoding, Error, FlatSamples, Image as ExrImage, ImageAttributes, Layer,
    LayerAttributes, ReadChannels as _, ReadLayers as _, ReadSpecificChannel as _, Vec2, WritableImage as _,
    read as reader,
};
use vol_compiler::frame::{Image, Pixel};
use vol_runtime_cpu::PixelCost;

use super::atomic::Sink;
use crate::compare::relative_rms;
use crate::failure::Failure;

/// A name, and what is stored under it.
type Channel<P, T> = (&'static str, fn(&P) -> T);

/// Channels of a picture, and what they hold.
const CHANNELS: [Channel<Pixel, f32>; 9] = [
    ("R", |pixel| pixel.color[0]),
    ("G", |pixel| pixel.color[1]),
    ("B", |pixel| pixel.color[2]),
    ("A", |pixel| 1.0 - pixel.transmittance.iter().sum::<f32>() / 3.0),
    ("Z", |pixel| pixel.depth),
    ("Transmittance.R", |pixel| pixel.transmittance[0]),
    ("Transmittance.G", |pixel| pixel.transmittance[1]),
    ("Transmittance.B", |pixel| pixel.transmittance[2]),
    ("Error.Estimate", |pixel| pixel.error),
];

/// Channels of what pixels cost.
const COSTS: [Channel<PixelCost, u64>; 2] =
    [("Cost.Operations", |cost| cost.operations), ("Cost.Evaluations", |cost| cost.evaluations)];

/// Writes `picture` as an OpenEXR file of one part, and what each pixel costs, if that is known.
///
/// # Errors
/// What the writer reports.
pub fn write(picture: &Image, costs: Option<&[PixelCost]>, out: &mut dyn Sink) -> io::Result<()> {
    let size = (picture.width as usize, picture.height as usize);
    let channel = |name: &str, samples: Vec<f32>| AnyChannel::new(name, FlatSamples::F32(samples));
    let of_pixels =
        |(name, value): (&str, fn(&Pixel) -> f32)| channel(name, picture.pixels.iter().map(value).collect());
    let of_costs = |(name, value): (&str, fn(&PixelCost) -> u64)| {
        costs.map(|costs| channel(name, costs.iter().map(|cost| value(cost) as f32).collect()))
    };
    let channels = CHANNELS.map(of_pixels).into_iter().chain(COSTS.into_iter().filter_map(of_costs));
    let channels = AnyChannels::sort(channels.collect());
    let attributes = LayerAttributes { software_name: Some("vol".into()), ..LayerAttributes::default() };
    let layer = Layer::new(size, attributes, Encoding::SMALL_LOSSLESS, channels);
    let mut image = ExrImage::from_layer(layer);
    image.attributes = ImageAttributes::new(image.attributes.display_window);
    image.write().non_parallel().to_buffered(out).map_err(|error| match error {
        Error::Io(error) => error,
        other => io::Error::other(other.to_string()),
    })
}

/// The colours of a picture in a file.
#[derive(Clone, Debug, PartialEq)]
pub struct Colors {
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Row by row from the top, linear.
    pub pixels: Vec<[f32; 3]>,
}

impl Colors {
    /// Root mean square difference of a picture of the same size, over the root mean square of this one; 0 for equal
    /// pictures, infinite if this one is black and the other is not.
    #[must_use]
    pub fn error_of(&self, picture: &Image) -> f64 {
        let found = picture.pixels.iter().flat_map(|pixel| pixel.color);
        relative_rms(
            found.zip(self.pixels.iter().flatten()).map(|(found, &right)| (found.into(), right.into())),
        )
    }
}

/// Reads the colours of an OpenEXR file, such as [`write()`] makes.
///
/// # Errors
/// A usage failure if the file cannot be read or has no `R`, `G` and `B`.
pub fn read(path: &Path) -> Result<Colors, Failure> {
    let colors = reader()
        .no_deep_data()
        .largest_resolution_level()
        .specific_channels()
        .required::<f32>("R")
        .required::<f32>("G")
        .required::<f32>("B")
        .collect_pixels(
            |Vec2(width, height), _| (width, vec![[0.0_f32; 3]; width * height]),
            |(width, pixels), Vec2(x, y), (r, g, b): (f32, f32, f32)| pixels[y * *width + x] = [r, g, b],
        )
        .first_valid_layer()
        .all_attributes()
        .non_parallel()
        .from_file(path)
        .map_err(|error| Failure::io("cannot read", path, error))?;
    let (size, (_, pixels)) = (colors.layer_data.size, colors.layer_data.channel_data.pixels);
    Ok(Colors { size: [size.0 as u32, size.1 as u32], pixels })
}

#[cfg(test)]
mod tests {
    use exr::prelude::{FlatSamples, ReadChannels as _, ReadLayers as _, read};
    use std::io::Cursor;
    use vol_compiler::frame::{Image, Pixel};

    #[test]
    fn errors_are_relative() {
        let pixel = |color| Pixel { color, transmittance: [0.0; 3], depth: 1.0, error: 0.0 };
        let colors = super::Colors { size: [1, 2], pixels: vec![[3.0, 0.0, 0.0], [0.0, 4.0, 0.0]] };
        let picture = |pixels: Vec<_>| Image { width: 1, height: 2, pixels };
        let same = picture(colors.pixels.iter().copied().map(pixel).collect());
        assert_eq!(colors.error_of(&same), 0.0);
        let off = picture(vec![pixel([3.0, 0.0, 0.3]), pixel([0.0, 4.4, 0.0])]);
        assert!((colors.error_of(&off) - 0.1).abs() < 1e-6);
        let black = super::Colors { size: [1, 2], pixels: vec![[0.0; 3]; 2] };
        assert_eq!(black.error_of(&off), f64::INFINITY);
    }

    #[test]
    fn channels_come_back() {
        let pixel = |i: f32| Pixel {
            color: [i, 2.0 * i, 3.0],
            transmittance: [0.25, 0.5, 0.75],
            depth: if i > 2.0 { f32::INFINITY } else { i },
            error: 0.125 * i,
        };
        let picture = Image { width: 3, height: 2, pixels: (0..6_u8).map(|i| pixel(i.into())).collect() };
        let mut file = Cursor::new(Vec::new());
        super::write(&picture, None, &mut file).expect("written");
        file.set_position(0);
        let image = read().no_deep_data().largest_resolution_level().all_channels().first_valid_layer();
        let image = image.all_attributes().non_parallel().from_buffered(file).expect("read");
        let found: Vec<(String, Vec<f32>)> = image
            .layer_data
            .channel_data
            .list
            .iter()
            .map(|channel| {
                let FlatSamples::F32(samples) = &channel.sample_data else { panic!("not 32-bit float") };
                (channel.name.to_string(), samples.clone())
            })
            .collect();
        let names: Vec<&str> = found.iter().map(|(name, _)| name.as_str()).collect();
        let expected = [
            "A",
            "B",
            "Error.Estimate",
            "G",
            "R",
            "Transmittance.B",
            "Transmittance.G",
            "Transmittance.R",
            "Z",
        ];
        assert_eq!(names, expected);
        assert_eq!(found[4].1, [0.0, 1.0, 2.0, 3.0, 4.0, 5.0]);
        assert_eq!(found[3].1[5], 10.0);
        assert_eq!(found[0].1, [0.5; 6]);
        assert_eq!(found[2].1[5], 0.625);
        assert_eq!(found[5].1, [0.75; 6]);
        assert_eq!(found[8].1[2], 2.0);
        assert_eq!(found[8].1[3], f32::INFINITY);
    }
}
