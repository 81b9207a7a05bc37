//! OpenEXR: everything that was computed, scene-linear Rec. 709, 32-bit float.
//!
//! | channel                    | meaning                                                        |
//! |----------------------------|----------------------------------------------------------------|
//! | `R` `G` `B`                | radiance, background included                                  |
//! | `A`                        | 1 − mean transmittance                                         |
//! | `Z`                        | distance of the first surface along the viewing axis, or inf   |
//! | `Transmittance.R` `.G` `.B`| fraction of the background's light that arrives                |
//!
//! To put another background behind the picture, subtract `Transmittance` times the scene's own
//! background from `RGB` and add `Transmittance` times the other.

use std::io;

use exr::prelude::{
    Encoding, Error, Image as ExrImage, ImageAttributes, Layer, LayerAttributes, SpecificChannels, Vec2,
    WritableImage as _,
};
use vol_compiler::frame::{Image, Pixel};

use super::atomic::Sink;

/// Writes `picture` as an OpenEXR file of one part.
///
/// # Errors
/// What the writer reports.
pub fn write(picture: &Image, out: &mut dyn Sink) -> io::Result<()> {
    let size = (picture.width as usize, picture.height as usize);
    let channels = SpecificChannels::build()
        .with_channel::<f32>("R")
        .with_channel::<f32>("G")
        .with_channel::<f32>("B")
        .with_channel::<f32>("A")
        .with_channel::<f32>("Z")
        .with_channel::<f32>("Transmittance.R")
        .with_channel::<f32>("Transmittance.G")
        .with_channel::<f32>("Transmittance.B")
        .with_pixel_fn(|Vec2(x, y)| values(&picture.pixels[y * size.0 + x]));
    let attributes = LayerAttributes { software_name: Some("vol".into()), ..LayerAttributes::default() };
    let layer = Layer::new(size, attributes, Encoding::SMALL_LOSSLESS, channels);
    let mut image = ExrImage::from_layer(layer);
    image.attributes = ImageAttributes::new(image.attributes.display_window);
    image.write().non_parallel().to_buffered(out).map_err(|error| match error {
        Error::Io(error) => error,
        other => io::Error::other(other.to_string()),
    })
}

type Values = (f32, f32, f32, f32, f32, f32, f32, f32);

fn values(pixel: &Pixel) -> Values {
    let [r, g, b] = pixel.color;
    let [tr, tg, tb] = pixel.transmittance;
    (r, g, b, 1.0 - (tr + tg + tb) / 3.0, pixel.depth, tr, tg, tb)
}

#[cfg(test)]
mod tests {
    use exr::prelude::{FlatSamples, ReadChannels as _, ReadLayers as _, read};
    use std::io::Cursor;
    use vol_compiler::frame::{Image, Pixel};

    #[test]
    fn channels_come_back() {
        let pixel = |i: f32| Pixel {
            color: [i, 2.0 * i, 3.0],
            transmittance: [0.25, 0.5, 0.75],
            depth: if i > 2.0 { f32::INFINITY } else { i },
        };
        let picture = Image { width: 3, height: 2, pixels: (0..6_u8).map(|i| pixel(i.into())).collect() };
        let mut file = Cursor::new(Vec::new());
        super::write(&picture, &mut file).expect("written");
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
        let expected = ["A", "B", "G", "R", "Transmittance.B", "Transmittance.G", "Transmittance.R", "Z"];
        assert_eq!(names, expected);
        assert_eq!(found[3].1, [0.0, 1.0, 2.0, 3.0, 4.0, 5.0]);
        assert_eq!(found[2].1[5], 10.0);
        assert_eq!(found[0].1, [0.5; 6]);
        assert_eq!(found[4].1, [0.75; 6]);
        assert_eq!(found[7].1[2], 2.0);
        assert_eq!(found[7].1[3], f32::INFINITY);
    }
}
