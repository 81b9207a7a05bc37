//! Layers that show pictures.

use super::*;

fn picture(width: u32, height: u32, pixel: impl Fn(u32, u32) -> [f32; 4]) -> Picture {
    let places = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    Picture { width, height, pixels: places.map(|(x, y)| pixel(x, y)).collect() }
}

/// A picture put over white.
fn show(picture: Picture) -> Texels {
    compose(vec![layer(Content::Image(0), Blend::Alpha(1.0))], &[picture])
}

fn mean(texels: &Texels, channel: usize) -> f64 {
    texels.iter().map(|texel| f64::from(texel[channel])).sum::<f64>() / texels.len() as f64
}

#[test]
fn one_colour_stays_one_colour() {
    for (width, height) in [(1, 1), (3, 7), (255, 257), (256, 256), (1000, 37)] {
        let texels = show(picture(width, height, |_, _| [0.25, 0.5, 2.0, 1.0]));
        texels.iter().for_each(|&texel| near(texel, [0.25, 0.5, 2.0], 1e-6));
    }
}

#[test]
fn a_picture_of_the_tables_size_is_taken_as_it_is() {
    let pixel = |x: u32, y: u32| [(x as f32).sin(), (y as f32).cos(), (x * y) as f32, 1.0];
    let texels = show(picture(256, 256, pixel));
    for (index, texel) in texels.iter().enumerate() {
        assert_eq!(*texel, pixel(index as u32 % 256, index as u32 / 256)[..3]);
    }
}

#[test]
fn the_mean_is_kept() {
    // Larger ones keep it whatever their size, smaller ones where a pixel is a whole number of texels.
    for (width, height) in [(512, 512), (700, 300), (257, 1001), (403, 300), (64, 128), (1, 4)] {
        let pixel = |x: u32, y: u32| [((x * x * 7 + y * y * 3) % 11) as f32, (x + 2 * y) as f32, 0.0, 1.0];
        let image = picture(width, height, pixel);
        let whole = |channel: usize| {
            let sum: f64 = image.pixels.iter().map(|pixel| f64::from(pixel[channel])).sum();
            sum / image.pixels.len() as f64
        };
        let wanted = [whole(0), whole(1)];
        let texels = show(image);
        for (channel, wanted) in wanted.into_iter().enumerate() {
            assert!((mean(&texels, channel) - wanted).abs() <= 1e-6 * wanted, "{width} x {height}");
        }
    }
    let checks = show(picture(512, 512, |x, y| [((x + y) % 2) as f32, 0.0, 0.0, 1.0]));
    assert!(checks.iter().all(|texel| texel[0] == 0.5));
}

#[test]
fn fewer_pixels_than_texels_are_linear_between_their_middles() {
    // The left is little visibility, the top is near; the middles are at a quarter and three quarters.
    let texels = show(picture(2, 2, |x, y| [x as f32, y as f32, 0.0, 1.0]));
    let level = |index: usize| ((index as f64 + 0.5) / 128.0 - 0.5).clamp(0.0, 1.0);
    for (index, &texel) in texels.iter().enumerate() {
        near(texel, [level(index % SIZE), level(index / SIZE), 0.0], 1e-6);
    }
}

#[test]
fn pictures_cover_by_their_alpha() {
    let image = picture(4, 4, |_, _| [0.2, 0.4, 0.6, 0.5]);
    let blended = |blend| compose(vec![layer(Content::Image(0), blend)], std::slice::from_ref(&image))[5];
    near(blended(Blend::Alpha(1.0)), [0.6, 0.7, 0.8], 1e-6);
    near(blended(Blend::Alpha(0.5)), [0.8, 0.85, 0.9], 1e-6);
    near(blended(Blend::Multiply), [0.6, 0.7, 0.8], 1e-6);
    near(blended(Blend::Add), [1.1, 1.2, 1.3], 1e-6);
}

#[test]
fn colours_of_clear_pixels_do_not_show() {
    // Green where nothing is covered: neither the mean nor what is between pixels gets any of it.
    for size in [2, 512] {
        let pixel =
            |x: u32, _: u32| if x.is_multiple_of(2) { [1.0, 0.0, 0.0, 1.0] } else { [0.0, 9.0, 0.0, 0.0] };
        for texel in show(picture(size, size, pixel)) {
            let [r, g, b] = texel;
            assert!(
                (r - 1.0).abs() < 1e-6 && (-1e-6..=1.0 + 1e-6).contains(&g) && (g - b).abs() < 1e-6,
                "{texel:?}"
            );
        }
    }
}

#[test]
fn what_is_no_picture_covers_nothing() {
    let none = Picture { width: 0, height: 3, pixels: Vec::new() };
    let short = Picture { width: 2, height: 2, pixels: vec![[0.0; 4]; 3] };
    near(show(none)[0], WHITE, 0.0);
    near(show(short)[0], WHITE, 0.0);
    near(compose(vec![layer(Content::Image(3), Blend::Multiply)], &[])[0], WHITE, 0.0);
}

#[test]
fn pixels_that_are_not_finite_cover_nothing() {
    let pixel =
        |x: u32, _: u32| if x == 128 { [f32::NAN, 0.0, f32::INFINITY, 1.0] } else { [0.0, 0.0, 0.0, 7.0] };
    let texels = show(picture(256, 256, pixel));
    near(texels[127], BLACK, 0.0);
    near(texels[128], WHITE, 0.0);
}
