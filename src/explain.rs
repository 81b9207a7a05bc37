//! The long story of every code: what it means, why it is an error, and a scene before and after.
//!
//! A code and its meaning in one line stand in the table of the stage that reports it; the story
//! stands in `explain/CODE.md`. Its two scenes are fenced blocks, ```` ```vol before ```` and
//! ```` ```vol after ````. A first one that says `text` instead of `vol` is a sketch of a scene that
//! would be too long to show.

use vol_compiler::{lints, lower};
use vol_language::nearest::nearest;
use vol_language::{check, module, parse};

use crate::{stress, styles};

/// The texts of these codes, in this order.
macro_rules! texts {
    ($($code:literal),* $(,)?) => {
        [$(($code, include_str!(concat!("explain/", $code, ".md")))),*]
    };
}

/// The text of every code, sorted.
#[rustfmt::skip]
const TEXTS: [(&str, &str); 107] = texts![
    "E0100", "E0101", "E0102", "E0103", "E0104", "E0105", "E0106", "E0107", "E0108", "E0109", "E0110",
    "E0111", "E0112", "E0113", "E0115", "E0201", "E0202", "E0203", "E0204", "E0205", "E0206", "E0207",
    "E0208", "E0209", "E0210", "E0211", "E0212", "E0213", "E0214", "E0215", "E0216", "E0217", "E0218",
    "E0219", "E0220", "E0221", "E0222", "E0223", "E0224", "E0225", "E0226", "E0227", "E0228", "E0229",
    "E0230", "E0231", "E0232", "E0233", "E0234", "E0235", "E0236", "E0301", "E0302", "E0303", "E0304",
    "E0305", "E0306", "E0307", "E0308", "E0309", "E0310", "E0311", "E0312", "E0313", "E0314", "E0315",
    "E0316", "E0317", "E0319", "E0401", "E0402", "E0403", "E0404", "E0405", "E0406", "E0407", "E0408", "E0501", "E0502", "E0503", "E0505", "E0506", "E0507", "E0508", "E0601",
    "E0602", "E0603", "E0604", "E0605", "E0606", "E0701", "E0702", "E0703", "E0704", "W0101", "W0102", "W0103", "W0104", "W0110", "W0201", "W0401",
    "W0402", "W0403", "W0701", "W0702", "W0703", "W0704",
];

/// What there is to say about a code.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Story {
    /// `E0203` or `W0101`.
    pub code: &'static str,
    /// What it means, in one line without a final stop.
    pub meaning: &'static str,
    /// The rest, in Markdown; see the [module](self).
    pub text: &'static str,
}

/// The codes of all stages with their meanings, sorted.
#[must_use]
pub fn codes() -> Vec<(&'static str, &'static str)> {
    let stages = [
        parse::explain::CODES,
        module::CODES,
        check::CODES,
        lower::CODES,
        lints::CODES,
        stress::CODES,
        styles::CODES,
    ];
    let mut codes: Vec<_> = stages.into_iter().flatten().copied().collect();
    codes.sort_unstable();
    codes
}

/// The codes that have a text, sorted.
#[must_use]
pub fn codes_with_text() -> Vec<&'static str> {
    TEXTS.iter().map(|&(code, _)| code).collect()
}

/// The story of a code, written in letters of either case.
///
/// # Errors
/// The code that was probably meant, if there is one, for a code that does not exist.
pub fn story(code: &str) -> Result<Story, Option<&'static str>> {
    let codes = codes();
    let Some(&(code, meaning)) = codes.iter().find(|(known, _)| known.eq_ignore_ascii_case(code)) else {
        return Err(nearest(code, codes.iter().map(|&(known, _)| known)));
    };
    let text = TEXTS.iter().find(|&&(known, _)| known == code).map_or("", |&(_, text)| text);
    Ok(Story { code, meaning, text })
}

impl Story {
    /// The story for a terminal: the scenes are indented, the fences around them gone.
    #[must_use]
    pub fn plain(&self) -> String {
        let mut out = format!("{}: {}\n\n", self.code, self.meaning);
        let mut in_scene = false;
        for line in self.text.lines() {
            match line.strip_prefix("```") {
                Some("") => in_scene = false,
                Some(fence) => {
                    in_scene = true;
                    let when = fence.split(' ').nth(1).unwrap_or(fence);
                    out += &format!("{when}:\n\n");
                }
                None => {
                    let indent = if in_scene && !line.is_empty() { "    " } else { "" };
                    out += &format!("{indent}{line}\n");
                }
            }
        }
        out
    }

    /// The story as a section of a page in Markdown.
    #[must_use]
    pub fn markdown(&self) -> String {
        let text = self.text.replace("```vol before", "Before:\n\n```text");
        let text = text.replace("```text before", "Before:\n\n```text");
        let text = text.replace("```vol after", "After:\n\n```vol");
        format!("## {}\n\n*{}*\n\n{text}", self.code, self.meaning)
    }

    /// The scene with the mistake, unless it is only sketched.
    #[must_use]
    pub fn before(&self) -> Option<&'static str> {
        self.block("vol before")
    }

    /// The scene without the mistake.
    #[must_use]
    pub fn after(&self) -> Option<&'static str> {
        self.block("vol after")
    }

    fn block(&self, fence: &str) -> Option<&'static str> {
        let mut blocks = self.text.split("```").skip(1).step_by(2);
        blocks.find_map(|block| block.strip_prefix(fence)?.strip_prefix('\n'))
    }
}
