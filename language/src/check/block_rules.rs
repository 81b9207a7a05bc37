//! What blocks ask for beyond keys and types: values that only make sense together or in a range.
//!
//! Values that are not known at compile time are let through where the language allows them.

use super::Checker;
use super::constant::{Constant, is_zero};
use crate::blocks::{BlockKind, MAX_SAMPLES};
use crate::diag::Diagnostic;
use crate::hir::{Block, ExprId};
use std::f64::consts::PI;

/// Largest angle across a distant light, in radians.
const MAX_SPREAD: f64 = 2.0 * PI / 3.0;

/// Largest width and height of a picture, in pixels.
const MAX_SIZE: f64 = 16384.0;

impl Checker<'_> {
    /// Checks a block whose entries have their types.
    pub(super) fn check_rules(&mut self, block: &Block) {
        match block.kind {
            BlockKind::Camera => {
                self.check_fov(block);
                self.check_view(block);
            }
            BlockKind::Light => {
                self.check_place(block);
                self.check_direction(block);
                self.check_light_size(block);
            }
            BlockKind::Object | BlockKind::Medium | BlockKind::Style => {}
            BlockKind::Render => {
                self.check_size(block);
                self.check_timing(block, "duration", "at least 0", |value| value >= 0.0);
                self.check_timing(block, "fps", "more than 0", |value| value > 0.0);
                self.check_sampling(block);
            }
        }
    }

    fn entry_constant(&self, block: &Block, key: &str) -> Option<(ExprId, Constant)> {
        let value = self.sound_entry(block, key)?;
        Some((value, self.constant(value)?))
    }

    fn check_fov(&mut self, block: &Block) {
        let Some(fov) = self.sound_entry(block, "fov") else { return };
        // An animated field of view is checked when its frame is drawn.
        let Some([angle, ..]) = self.constant(fov) else { return };
        if angle > 0.0 && angle < PI {
            return;
        }
        let message = "the field of view must lie between 0deg and 180deg, both excluded";
        let label = format!("this is {}deg", angle.to_degrees());
        let error = Diagnostic::error("E0312", message, self.span(fov), label);
        self.report(error.with_help("write `fov: 40deg`"));
    }

    fn check_view(&mut self, block: &Block) {
        let (Some((_, from)), Some((at, target))) =
            (self.entry_constant(block, "from"), self.entry_constant(block, "at"))
        else {
            return;
        };
        if from[..3] == target[..3] {
            let message = "the camera looks at the place where it stands";
            let error = Diagnostic::error("E0315", message, self.span(at), "the same as `from`");
            self.report(error.with_help("choose another `from` or `at`"));
        }
    }

    /// A light has a direction or a position.
    fn check_place(&mut self, block: &Block) {
        let (message, label) = match (block.entry("from"), block.entry("at")) {
            (Some(_), None) | (None, Some(_)) => return,
            (Some(_), Some(at)) => {
                let message = "a light has either `from` or `at`, not both";
                let error = Diagnostic::error("E0308", message, self.span(at), "the light has a `from`, too");
                self.report(error.with_help("keep `from` for a distant light, `at` for a light at a place"));
                return;
            }
            (None, None) => ("this light has neither `from` nor `at`", "where does it shine from"),
        };
        let error = Diagnostic::error("E0308", message, block.span, label);
        self.report(error.with_help(
            "add `from: (0, 1, 0)` for the direction towards a distant light, or `at: (0, 3, 0)` for a place",
        ));
    }

    fn check_direction(&mut self, block: &Block) {
        if let Some((from, value)) = self.entry_constant(block, "from")
            && is_zero(value)
        {
            let message = "the direction towards a light must not be zero";
            let error = Diagnostic::error("E0309", message, self.span(from), "this is zero");
            self.report(error.with_help("write `from: (0, 1, 0)` for light from above"));
        }
    }

    /// A distant light spreads over an angle, a light at a place has a radius, and none is negative.
    fn check_light_size(&mut self, block: &Block) {
        let mut misplaced = |key: &str, other: &str, label: &str, help: &str| {
            if let (Some(value), Some(_)) = (block.entry(key), block.entry(other)) {
                let message = format!("a light with `{other}` has no `{key}`");
                let error = Diagnostic::error("E0317", message, self.span(value), label);
                self.report(error.with_help(help));
            }
        };
        let far = "a distant light has an angle, but no place at which a radius could be measured";
        misplaced("radius", "from", far, "write `spread: 2deg`, the angle across the light");
        let near = "the angle across a light at a place depends on how far away one is";
        misplaced("spread", "at", near, "write `radius: 0.2`, in scene units");
        let ranges: [(&str, f64, &str, &str); 3] = [
            ("spread", MAX_SPREAD, "between 0deg and 120deg", "spread: 2deg"),
            ("radius", f64::INFINITY, "at least 0", "radius: 0.2"),
            ("occlusion", f64::INFINITY, "at least 0", "occlusion: 0.5"),
        ];
        for (key, most, range, example) in ranges {
            // An animated size is held within its range when its frame is drawn.
            let Some((value, [size, ..])) = self.entry_constant(block, key) else { continue };
            if !(0.0..=most).contains(&size) {
                let size =
                    if key == "spread" { format!("{}deg", size.to_degrees()) } else { size.to_string() };
                let message = format!("`{key}` of a light must be {range}");
                let error = Diagnostic::error("E0317", message, self.span(value), format!("this is {size}"));
                self.report(error.with_help(format!("write `{example}`")));
            }
        }
    }

    fn check_size(&mut self, block: &Block) {
        let Some(size) = self.sound_entry(block, "size") else { return };
        let label = match self.constant(size) {
            None => "not a constant".to_owned(),
            Some([width, height, ..]) => {
                let fits = |x: f64| x.fract() == 0.0 && (1.0..=MAX_SIZE).contains(&x);
                if fits(width) && fits(height) {
                    return;
                }
                format!("this is {width} by {height}")
            }
        };
        let message = "the size must be two constant whole numbers from 1 to 16384";
        let error = Diagnostic::error("E0311", message, self.span(size), label);
        self.report(error.with_help("write `size: (960, 540)`"));
    }

    fn check_timing(&mut self, block: &Block, key: &'static str, range: &str, fits: impl Fn(f64) -> bool) {
        if let Some((value, [number, ..])) = self.entry_constant(block, key)
            && !fits(number)
        {
            let message = format!("`{key}` must be {range}");
            let error = Diagnostic::error("E0314", message, self.span(value), format!("this is {number}"));
            let example = if key == "fps" { "fps: 30" } else { "duration: 10s" };
            self.report(error.with_help(format!("write `{example}`")));
        }
    }
    /// Values that depend on params or time are checked when their picture is asked for.
    fn check_sampling(&mut self, block: &Block) {
        let samples = |value: f64| value.fract() == 0.0 && (1.0..=f64::from(MAX_SAMPLES)).contains(&value);
        let range = format!("a whole number from 1 to {MAX_SAMPLES}");
        self.check_sampling_key(block, "samples", &range, "samples: 16", samples);
        let adaptive = |value: f64| (0.0..1.0).contains(&value);
        let range = "at least 0 and less than 1";
        self.check_sampling_key(block, "adaptive", range, "adaptive: 0.02", adaptive);
    }

    fn check_sampling_key(
        &mut self,
        block: &Block,
        key: &'static str,
        range: &str,
        example: &str,
        fits: impl Fn(f64) -> bool,
    ) {
        if let Some((value, [number, ..])) = self.entry_constant(block, key)
            && !fits(number)
        {
            let message = format!("`{key}` must be {range}");
            let error = Diagnostic::error("E0319", message, self.span(value), format!("this is {number}"));
            self.report(error.with_help(format!("write `{example}`")));
        }
    }
}
