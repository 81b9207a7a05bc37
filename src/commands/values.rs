//! Argument values: from the text typed to numbers in range, or a sentence that says what is wrong.

use vol_compiler::skip::{self, Skip};
use vol_language::blocks::MAX_SAMPLES;

/// Largest width and height of a picture.
const MAX_SIZE: u32 = 16_384;

/// Width and height of a picture in pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Size(pub(crate) [u32; 2]);

/// Frames from the first to the last, both included.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct FrameRange {
    pub(crate) first: u32,
    pub(crate) last: u32,
}

/// `960x540`
pub(crate) fn size(text: &str) -> Result<Size, String> {
    let (width, height) = text.split_once(['x', 'X']).ok_or("write width and height as in 960x540")?;
    let side = |text: &str| match text.parse::<u32>() {
        Ok(pixels @ 1..=MAX_SIZE) => Ok(pixels),
        Ok(_) => Err(format!("width and height must be in 1..{MAX_SIZE}")),
        Err(_) if !text.is_empty() && text.bytes().all(|b| b.is_ascii_digit()) => {
            Err(format!("width and height must be in 1..{MAX_SIZE}"))
        }
        Err(_) => Err("write width and height as in 960x540".to_owned()),
    };
    Ok(Size([side(width)?, side(height)?]))
}

/// `2s`, `500ms` or `1.5` (seconds)
pub(crate) fn time(text: &str) -> Result<f64, String> {
    let (number, unit) = match (text.strip_suffix("ms"), text.strip_suffix('s')) {
        (Some(number), _) => (number, 1e-3),
        (None, Some(number)) => (number, 1.0),
        (None, None) => (text, 1.0),
    };
    let seconds = number.parse::<f64>().map_err(|_| "write a time as in 2s, 500ms or 1.5")? * unit;
    if seconds.is_finite() && seconds >= 0.0 {
        return Ok(seconds);
    }
    Err("a time is a number of seconds from 0 on".to_owned())
}

/// `0..59`
pub(crate) fn frames(text: &str) -> Result<FrameRange, String> {
    let wrong = "write the first and the last frame as in 0..59";
    let (first, last) = text.split_once("..").ok_or(wrong)?;
    let number = |text: &str| text.parse::<u32>().map_err(|_| wrong.to_owned());
    let (first, last) = (number(first)?, number(last)?);
    if first > last {
        return Err("the last frame is before the first".to_owned());
    }
    Ok(FrameRange { first, last })
}

/// `octaves`
pub(crate) fn skip(text: &str) -> Result<Skip, String> {
    let named = skip::TABLE.iter().find(|row| row.name == text).map(|row| row.skip);
    named.ok_or_else(|| {
        let names: Vec<_> = skip::TABLE.iter().map(|row| row.name).collect();
        format!("nothing is left out under that name; the names are: {}", names.join(", "))
    })
}

/// `name=value`
pub(crate) fn definition(text: &str) -> Result<(String, String), String> {
    let (name, value) = text.split_once('=').ok_or("write a param and its value as in spin=70deg")?;
    let (name, value) = (name.trim(), value.trim());
    if name.is_empty() || value.is_empty() {
        return Err("write a param and its value as in spin=70deg".to_owned());
    }
    Ok((name.to_owned(), value.to_owned()))
}

/// A number between 0 and 1.
pub(crate) fn max_error(text: &str) -> Result<f32, String> {
    match text.parse::<f32>() {
        Ok(error) if error > 0.0 && error < 1.0 => Ok(error),
        _ => Err("must be a number above 0 and below 1".to_owned()),
    }
}

/// A length above 0.
pub(crate) fn step(text: &str) -> Result<f32, String> {
    match text.parse::<f32>() {
        Ok(step) if step >= f32::MIN_POSITIVE && step.is_finite() => Ok(step),
        _ => Err("must be a number above 0".to_owned()),
    }
}

/// A factor from 0.01 to 100.
pub(crate) fn step_scale(text: &str) -> Result<f32, String> {
    match text.parse::<f32>() {
        Ok(factor) if (0.01..=100.0).contains(&factor) => Ok(factor),
        _ => Err("must be a number from 0.01 to 100".to_owned()),
    }
}

/// A whole number of samples per pixel.
pub(crate) fn samples(text: &str) -> Result<u32, String> {
    match text.parse::<u32>() {
        Ok(samples @ 1..=MAX_SAMPLES) => Ok(samples),
        _ => Err(format!("must be a whole number from 1 to {MAX_SAMPLES}")),
    }
}

/// `16x16`, at most 256 invocations: what any WebGPU device allows.
pub(crate) fn workgroup(text: &str) -> Result<Size, String> {
    match size(text)? {
        Size([width, height]) if u64::from(width) * u64::from(height) <= 256 => Ok(Size([width, height])),
        Size(_) => Err("must have at most 256 invocations".to_owned()),
    }
}

/// What names may start with in every shader language: a lower-case letter, then letters and digits.
pub(crate) fn prefix(text: &str) -> Result<String, String> {
    let fits = text.starts_with(|c: char| c.is_ascii_lowercase())
        && text.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit())
        && !text.starts_with("gl");
    if fits && text.len() <= 32 {
        Ok(text.to_owned())
    } else {
        Err("must be a lower-case letter and at most 31 more letters or digits, and not begin with `gl`"
            .to_owned())
    }
}

/// A number from 0 to below 1.
pub(crate) fn adaptive(text: &str) -> Result<f32, String> {
    match text.parse::<f32>() {
        Ok(error) if (0.0..1.0).contains(&error) => Ok(error),
        _ => Err("must be a number from 0 to below 1".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes() {
        assert_eq!(size("960x540"), Ok(Size([960, 540])));
        assert_eq!(size("1X16384"), Ok(Size([1, 16384])));
        for bad in
            ["", "x", "0x0", "4x0", "16385x1", "99999999999x1", "960", "-1x4", "4x4x4", "4.0x4", "+4x4 "]
        {
            assert!(size(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn times() {
        assert_eq!(time("2s"), Ok(2.0));
        assert_eq!(time("500ms"), Ok(0.5));
        assert_eq!(time("1.5"), Ok(1.5));
        for bad in ["", "s", "ms", "2m", "-1", "inf", "nan", "1e400", "2 s"] {
            assert!(time(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn frame_ranges_include_both_ends() {
        assert_eq!(frames("3..3"), Ok(FrameRange { first: 3, last: 3 }));
        for bad in ["", "3", "..", "4..3", "-1..3", "a..b", "0..=3", "0..4294967296"] {
            assert!(frames(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn definitions_split_at_the_first_sign() {
        assert_eq!(definition("a = b=c"), Ok(("a".to_owned(), "b=c".to_owned())));
        for bad in ["", "a", "=1", "a="] {
            assert!(definition(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn errors_lie_between_0_and_1() {
        assert_eq!(max_error("1e-3"), Ok(1e-3));
        for bad in ["0", "1", "-1", "nan", "x"] {
            assert!(max_error(bad).is_err(), "{bad}");
        }
        assert_eq!(step("0.25"), Ok(0.25));
        for bad in ["0", "-0", "1e-50", "-1", "nan", "inf", "1e40", "x"] {
            assert!(step(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn step_scales_are_moderate() {
        assert_eq!((step_scale("0.01"), step_scale("100")), (Ok(0.01), Ok(100.0)));
        for bad in ["", "0", "-1", "0.009", "101", "nan", "inf", "x"] {
            assert!(step_scale(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn samples_are_whole() {
        assert_eq!((samples("1"), samples("4096")), (Ok(1), Ok(4096)));
        for bad in ["", "0", "-1", "4097", "1.5", "nan", "x", "99999999999"] {
            assert!(samples(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn adaptive_errors_are_below_1() {
        assert_eq!((adaptive("0"), adaptive("0.02")), (Ok(0.0), Ok(0.02)));
        for bad in ["", "1", "-0.1", "nan", "inf", "x"] {
            assert!(adaptive(bad).is_err(), "{bad}");
        }
    }
}
