//! Numbers as authors write them, and now and then as nobody should.

use crate::Generator;
use crate::piece::{Piece, level};

/// Usual numbers, the simplest first.
const USUAL: [f64; 12] = [1.0, 0.5, 2.0, 0.0, -1.0, 0.25, 3.0, 1.5, -0.5, 0.1, 7.0, -2.75];

/// Sizes of shapes.
const SIZES: [f64; 8] = [1.0, 0.5, 0.25, 2.0, 0.1, 0.75, 1.25, 4.0];

/// Nearly equal, at the ends of f32, below its smallest normal number, zero with a sign.
const ODD: [f64; 16] = [
    1.000_000_1,
    0.999_999_9,
    0.500_000_03,
    -0.0,
    1e-6,
    1e-12,
    1e-30,
    1e-40,
    1e6,
    -1e6,
    1e12,
    1e30,
    3.4e38,
    -3.4e38,
    16_777_217.0,
    4_194_304.25,
];

/// Whole numbers, the simplest first.
const WHOLE: [i64; 10] = [1, 0, 2, 3, -1, 4, 8, 5, -3, 12];

/// The largest whole number of the language.
pub(crate) const MOST: i64 = 1 << 24;

impl Generator<'_> {
    /// A real number, mostly between -3 and 3.
    pub(crate) fn real(&mut self) -> f64 {
        match self.source.below(24) {
            0..=13 => self.source.pick(&USUAL),
            14..=22 => (self.source.below(60_000) as f64 - 30_000.0) / 10_000.0,
            _ => self.source.pick(&ODD),
        }
    }

    /// A real number that is not 0.
    pub(crate) fn real_but_zero(&mut self) -> f64 {
        let number = self.real();
        if number == 0.0 { 1.75 } else { number }
    }

    /// A positive number to build shapes from; rarely degenerate, and then only 0 if `zero` is allowed.
    pub(crate) fn size_number(&mut self, zero: bool) -> f64 {
        match self.source.below(32) {
            0..=19 => self.source.pick(&SIZES),
            20..=29 => (1 + self.source.below(30_000)) as f64 / 10_000.0,
            30 if zero => 0.0,
            _ => self.source.pick(&[1e-6, 1e6, 1e-12, 1e-30, 1.000_000_1]),
        }
    }

    pub(crate) fn float_literal(&mut self) -> Piece {
        float(self.real())
    }

    pub(crate) fn int_literal(&mut self) -> Piece {
        int(match self.source.below(40) {
            39 => self.source.pick(&[MOST, -MOST, MOST - 1]),
            _ => self.source.pick(&WHOLE),
        })
    }

    pub(crate) fn angle_literal(&mut self) -> Piece {
        let number = self.real();
        let (unit, scale) = self.source.pick(&[("deg", 30.0), ("rad", 1.0), ("turn", 0.25)]);
        let number = if number.abs() < 1e30 { number * scale } else { scale };
        Piece::new(format!("{number:?}{unit}"), float(number).level)
    }

    /// An angle that is not 0.
    pub(crate) fn angle_but_zero(&mut self) -> Piece {
        let number = self.real_but_zero();
        Piece::new(format!("{number:?}rad"), float(number).level)
    }

    pub(crate) fn color_literal(&mut self) -> Piece {
        let rgb = [0, 1, 2].map(|_| self.source.below(256));
        Piece::atom(format!("#{:02x}{:02x}{:02x}", rgb[0], rgb[1], rgb[2]))
    }

    /// A time: a real number with its unit.
    pub(crate) fn seconds_literal(&mut self) -> Piece {
        let number = self.source.below(80) as f64 / 8.0;
        Piece::atom(if self.source.once_in(3) {
            format!("{}ms", number * 1000.0)
        } else {
            format!("{number}s")
        })
    }
}

/// A real number as a literal.
pub(crate) fn float(number: f64) -> Piece {
    let level = if number.is_sign_negative() { level::PREFIX } else { level::ATOM };
    Piece::new(format!("{number:?}"), level)
}

/// A whole number as a literal.
pub(crate) fn int(number: i64) -> Piece {
    let level = if number < 0 { level::PREFIX } else { level::ATOM };
    Piece::new(number.to_string(), level).bounded(number.abs())
}
