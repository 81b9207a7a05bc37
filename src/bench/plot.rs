//! Error over run time as a picture: both axes logarithmic, one line per series, as SVG and as PNG.
//!
//! The PNG is the SVG rasterised, so that both show the same.

use std::error::Error;

use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use resvg::{tiny_skia, usvg};

use super::Run;

/// Size of the picture in pixels.
const SIZE: (u32, u32) = (900, 600);

/// Family of the texts; the PNG is drawn with the first.
const FONT: &str = "Ubuntu, sans-serif";

/// Colours that people with any colour vision tell apart (Okabe and Ito 2008).
const COLOURS: [RGBColor; 6] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(230, 159, 0),
    RGBColor(86, 180, 233),
];

/// Draws runs as an SVG text; `title` and `subtitle` stand above.
///
/// # Errors
/// What the drawing library reports.
pub fn svg(title: &str, subtitle: &str, runs: &[Run]) -> Result<String, String> {
    let mut text = String::new();
    draw(&mut text, title, subtitle, runs).map_err(|error| error.to_string())?;
    Ok(text)
}

fn draw(text: &mut String, title: &str, subtitle: &str, runs: &[Run]) -> Result<(), Box<dyn Error>> {
    let area = SVGBackend::with_string(text, SIZE).into_drawing_area();
    area.fill(&WHITE)?;
    let middle = Pos::new(HPos::Center, VPos::Top);
    let heading = |size: u32| (FONT, size).into_font().color(&BLACK).pos(middle);
    area.draw_text(title, &heading(22), (SIZE.0 as i32 / 2, 12))?;
    area.draw_text(subtitle, &heading(14), (SIZE.0 as i32 / 2, 40))?;
    let (_, below) = area.split_vertically(60);
    let seconds = axis(runs.iter().map(|run| run.seconds));
    let errors = axis(runs.iter().map(|run| run.error));
    let mut chart = ChartBuilder::on(&below)
        .margin(16)
        .x_label_area_size(44)
        .y_label_area_size(64)
        .build_cartesian_2d((seconds[0]..seconds[1]).log_scale(), (errors[0]..errors[1]).log_scale())?;
    chart
        .configure_mesh()
        .light_line_style(BLACK.mix(0.06))
        .bold_line_style(BLACK.mix(0.18))
        .x_desc("seconds")
        .y_desc("relative error (rms over the picture)")
        .x_label_formatter(&|value| number(*value))
        .y_label_formatter(&|value| number(*value))
        .label_style((FONT, 14))
        .axis_desc_style((FONT, 15))
        .draw()?;
    for (index, series) in super::series(runs).into_iter().enumerate() {
        let colour = COLOURS[index % COLOURS.len()];
        let points: Vec<(f64, f64)> = runs
            .iter()
            .filter(|run| run.series == series)
            .map(|run| (run.seconds, run.error.max(errors[0])))
            .collect();
        chart
            .draw_series(LineSeries::new(points.iter().copied(), colour.stroke_width(2)))?
            .label(series)
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 20, y)], colour.stroke_width(2)));
        chart.draw_series(points.iter().map(|&point| Circle::new(point, 4, colour.filled())))?;
    }
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::UpperRight)
        .background_style(WHITE.mix(0.9))
        .border_style(BLACK.mix(0.3))
        .label_font((FONT, 14))
        .draw()?;
    area.present()?;
    Ok(())
}

/// From the power of ten below the smallest number to that above the largest; numbers that are not
/// above 0 do not count.
fn axis(values: impl Iterator<Item = f64>) -> [f64; 2] {
    let [least, most] = values
        .filter(|value| *value > 0.0 && value.is_finite())
        .fold([f64::INFINITY, 0.0], |[least, most], value| [value.min(least), value.max(most)]);
    if most <= 0.0 {
        return [0.1, 1.0];
    }
    let [least, most] = [least.log10().floor(), (most.log10() + 1e-9).ceil()];
    [10f64.powf(least), 10f64.powf(most.max(least + 1.0))]
}

/// 0.001 as `1e-3`, what is between 0.01 and 100 as it is.
fn number(value: f64) -> String {
    if (0.0099..100.1).contains(&value) { format!("{value}") } else { format!("{value:.0e}") }
}

/// Draws an SVG text of [`svg`] as rows of sRGB pixels, 8 bit; with width and height.
///
/// # Errors
/// A sentence if the text is no SVG.
pub fn rasterise(svg: &str) -> Result<(Vec<u8>, [u32; 2]), String> {
    let mut options = usvg::Options { font_family: "Ubuntu".to_owned(), ..usvg::Options::default() };
    options.fontdb_mut().load_font_data(epaint_default_fonts::UBUNTU_LIGHT.to_vec());
    let tree = usvg::Tree::from_str(svg, &options).map_err(|error| error.to_string())?;
    let mut picture = tiny_skia::Pixmap::new(SIZE.0, SIZE.1).ok_or("the plot has no size")?;
    resvg::render(&tree, tiny_skia::Transform::identity(), &mut picture.as_mut());
    // The white ground leaves nothing to see through.
    let pixels = picture.data().chunks_exact(4).flat_map(|pixel| [pixel[0], pixel[1], pixel[2]]);
    Ok((pixels.collect(), [SIZE.0, SIZE.1]))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn runs() -> Vec<Run> {
        let run = |series: &str, seconds, error| Run {
            series: series.to_owned(),
            setting: String::new(),
            promised: None,
            seconds,
            error,
            samples: 0,
            evaluations: 0,
        };
        vec![
            run("cpu", 0.1, 1e-2),
            run("cpu", 0.7, 1e-3),
            run("fixed steps", 2.0, 3e-2),
            run("gpu", 5.0, 0.0),
        ]
    }

    #[test]
    fn axes_are_powers_of_ten() {
        let close = |[a, b]: [f64; 2], [c, d]: [f64; 2]| (a / c - 1.0).abs() + (b / d - 1.0).abs() < 1e-9;
        assert!(close(axis([0.03, 0.2, 0.0].into_iter()), [0.01, 1.0]));
        assert!(close(axis([1.0].into_iter()), [1.0, 10.0]));
        assert!(close(axis([0.0, f64::NAN].into_iter()), [0.1, 1.0]));
    }

    #[test]
    fn both_pictures_show_the_lines() {
        let svg = svg("a scene", "a machine", &runs()).expect("drawn");
        for text in ["a scene", "a machine", "fixed steps", "seconds"] {
            assert!(svg.contains(text), "{text}");
        }
        let (pixels, [width, height]) = rasterise(&svg).expect("rasterised");
        assert_eq!(pixels.len(), 3 * width as usize * height as usize);
        let has = |colour: RGBColor| pixels.chunks(3).any(|p| p == [colour.0, colour.1, colour.2]);
        assert!(has(COLOURS[0]) && has(COLOURS[1]) && has(WHITE));
    }
}
