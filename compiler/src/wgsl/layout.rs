//! Where the shaders find the numbers of a frame, and the words that the host puts there.
//!
//! | binding | name | words |
//! |---|---|---|
//! | 0 | `vol_uniforms` | outputs of the frame function (f32), then for each curve its first piece and its number of pieces (u32) |
//! | 1 | `vol_curves` | pieces of all curves, [`Piece::WORDS`] each (f32) |
//! | 2 | `vol_permutation` | permutation of the noise with seed 0 (u32) |
//! | 3 and on | | what the entry point says, its output last |
//!
//! All are in group 0. A row of known length that fits is a uniform buffer, an array of vectors of four, since an array
//! of single words may not lie there; the others are storage buffers. Shaders read single words through a function
//! `…_word`, whichever it is. Software drivers read uniform buffers several times faster, and compile such reads to a
//! tenth of the code. Words that are integers are read with `bitcast`, which keeps their bits even where a driver
//! flushes denormals.

use super::names::literal;
use crate::curve::Piece;
use crate::frame::Frame;
use crate::ir::Module;
use crate::noise_table;
use crate::program::Program;
use std::fmt::Write as _;

/// Words that any WebGPU device binds as one uniform buffer, 64 KiB.
const UNIFORM_WORDS: usize = 16_384;

/// What kind of buffer holds a row of words.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Space {
    /// A uniform buffer.
    Uniform,
    /// A storage buffer that is only read.
    Storage,
}

/// A row of words of known length.
#[derive(Clone, Copy, Debug)]
pub(super) struct Row {
    pub(super) binding: u32,
    pub(super) name: &'static str,
    /// Words at most.
    words: usize,
    /// `f32` or `u32`.
    scalar: &'static str,
}

impl Row {
    pub(super) const fn new(binding: u32, name: &'static str, words: usize) -> Self {
        Self { binding, name, words, scalar: "f32" }
    }

    /// A row that may be of any length, in storage.
    pub(super) const fn long(binding: u32, name: &'static str) -> Self {
        Self::new(binding, name, usize::MAX)
    }

    pub(super) fn space(&self) -> Space {
        if self.words <= UNIFORM_WORDS { Space::Uniform } else { Space::Storage }
    }

    /// Declares the buffer, and a function that reads one word of it.
    pub(super) fn declaration(&self) -> String {
        let Self { binding, name, scalar, .. } = self;
        let (kind, ty, read) = match self.space() {
            Space::Uniform => {
                let ty = format!("array<vec4<{scalar}>, {}>", self.vectors());
                ("uniform", ty, format!("{name}[index >> 2u][index & 3u]"))
            }
            Space::Storage => ("storage, read", format!("array<{scalar}>"), format!("{name}[index]")),
        };
        format!("@group(0) @binding({binding}) var<{kind}> {name}: {ty};\n{}", self.accessor(&read))
    }

    /// The same for a text without bindings: the words are in it, declared by `keyword`.
    pub(super) fn constants(&self, words: &[u32], keyword: &str) -> String {
        let Self { name, scalar, .. } = self;
        let spell = |&word: &u32| match *scalar {
            "u32" => format!("{word}u"),
            // Negative zero is no constant expression everywhere.
            _ if f32::from_bits(word) == 0.0 => literal(0.0),
            _ => literal(f32::from_bits(word)),
        };
        let mut words: Vec<String> = words.iter().map(spell).collect();
        let zero = spell(&0);
        words.resize(words.len().next_multiple_of(4).max(4), zero);
        let ty = format!("vec4<{scalar}>");
        let vectors: Vec<String> = words.chunks(4).map(|four| format!("{ty}({})", four.join(", "))).collect();
        let all = format!("array<{ty}, {}>", vectors.len());
        let read = self.accessor(&format!("{name}[index >> 2u][index & 3u]"));
        format!("{keyword} {name}: {all} = {all}(\n  {},\n);\n{read}", vectors.join(",\n  "))
    }

    fn accessor(&self, read: &str) -> String {
        let Self { scalar, .. } = self;
        let function = format!("{}_word", self.name.strip_suffix('s').unwrap_or(self.name));
        let mut text = String::new();
        let _ = writeln!(text, "fn {function}(index: u32) -> {scalar} {{ return {read}; }}");
        text
    }

    /// One word as an expression.
    pub(super) fn word(&self, index: u64) -> String {
        match self.space() {
            Space::Uniform => {
                format!("{}[{}].{}", self.name, index / 4, ["x", "y", "z", "w"][index as usize % 4])
            }
            Space::Storage => format!("{}[{index}]", self.name),
        }
    }

    /// The words as the host hands them over: a uniform buffer is as long as it is declared.
    pub(super) fn filled(&self, mut words: Vec<u32>) -> Vec<u32> {
        if self.space() == Space::Uniform {
            words.resize(4 * self.vectors(), 0);
        }
        words
    }

    fn vectors(&self) -> usize {
        self.words.div_ceil(4).max(1)
    }
}

/// Bindings that every shader of a scene has.
#[derive(Clone, Copy, Debug)]
pub(super) struct SceneRows<'a> {
    pub(super) uniforms: Row,
    curves: Row,
    permutation: Row,
    /// First word of `uniforms` that belongs to the curves.
    curve_table: u64,
    pub(super) curve_count: usize,
    /// First piece and number of pieces of each curve, for a text of one frame.
    places: Option<&'a [[u32; 2]]>,
}

impl<'a> SceneRows<'a> {
    /// Those of a module with so many curves of so many pieces together, at most.
    pub(super) fn new(module: &Module, curves: usize, pieces: usize) -> Self {
        let outputs = module.frame.outputs.len();
        Self {
            uniforms: Row::new(0, "vol_uniforms", outputs + 2 * curves),
            curves: Row::new(1, "vol_curves", pieces * Piece::WORDS),
            permutation: Row { scalar: "u32", ..Row::new(2, "vol_permutation", noise_table::WORDS) },
            curve_table: outputs as u64,
            curve_count: curves,
            places: None,
        }
    }

    /// For a text of one frame, in which curves are where they are then, see [`curve_places`]: a whole number is no
    /// normal f32, and a constant that is none may become 0.
    pub(super) fn fixed(self, places: &'a [[u32; 2]]) -> Self {
        Self { places: Some(places), ..self }
    }

    /// First piece and number of pieces of a curve, as expressions.
    pub(super) fn curve(&self, index: u32) -> [String; 2] {
        if let Some([first, count]) = self.places.and_then(|places| places.get(index as usize)) {
            return [format!("{first}u"), format!("{count}u")];
        }
        let word = self.curve_table + 2 * u64::from(index);
        [word, word + 1].map(|word| format!("bitcast<u32>({})", self.uniforms.word(word)))
    }

    /// A function that tells where the curve of a number is; in a text of one frame it reads [`Self::place_row`].
    pub(super) fn curve_function(&self) -> String {
        let [first, count] = match self.places {
            Some(_) => [0, 1].map(|part| format!("vol_place_word((2u * number) + {part}u)")),
            None => [self.curve_table, self.curve_table + 1]
                .map(|start| format!("bitcast<u32>(vol_uniform_word({start}u + (2u * number)))")),
        };
        format!(
            "\nfn vol_curve(number: u32) -> VolCurve {{\n    return VolCurve({first}, {count}, number);\n}}\n"
        )
    }

    /// First piece and number of pieces of each curve, one after the other, in a text of one frame.
    pub(super) fn place_row(&self) -> (Row, Vec<u32>) {
        let words: Vec<u32> = self.places.unwrap_or_default().iter().flatten().copied().collect();
        (Row { scalar: "u32", ..Row::new(0, "vol_places", words.len()) }, words)
    }

    pub(super) fn of(program: &Program) -> Self {
        let segments: usize = program.curves.iter().map(|curve| curve.segments.len()).sum();
        // A segment is cut at its vertex, and an empty curve is a point.
        let pieces = 2 * segments + program.curves.len();
        Self::new(&program.module, program.curves.len(), pieces)
    }

    pub(super) fn all(&self) -> [Row; 3] {
        [self.uniforms, self.curves, self.permutation]
    }
}

/// The contents of bindings 0 to 2 for a frame.
#[must_use]
pub fn scene_words(program: &Program, frame: &Frame) -> [Vec<u32>; 3] {
    let rows = SceneRows::of(program);
    [
        rows.uniforms.filled(uniform_words(frame)),
        rows.curves.filled(curve_words(frame)),
        rows.permutation.filled(noise_table::permutation_words().to_vec()),
    ]
}

fn uniform_words(frame: &Frame) -> Vec<u32> {
    let words = frame.uniforms_f32.iter().map(|x| x.to_bits());
    words.chain(curve_places(frame).into_iter().flatten()).collect()
}

/// First piece and number of pieces of each curve.
pub(super) fn curve_places(frame: &Frame) -> Vec<[u32; 2]> {
    let mut first = 0;
    let place = |count: u32| {
        first += count;
        [first - count, count]
    };
    frame.curve_tables.iter().map(|table| table.pieces.len() as u32).map(place).collect()
}

fn curve_words(frame: &Frame) -> Vec<u32> {
    let pieces = frame.curve_tables.iter().flat_map(|table| &table.pieces);
    pieces.flat_map(Piece::words).map(f32::to_bits).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_rows_lie_in_storage() {
        let row = |words| Row::new(3, "vol_things", words);
        let short = row(9);
        assert_eq!(short.space(), Space::Uniform);
        assert!(short.declaration().contains("var<uniform> vol_things: array<vec4<f32>, 3>;"));
        assert!(short.declaration().contains("fn vol_thing_word(index: u32) -> f32"));
        assert_eq!((short.word(6), short.filled(vec![1; 9]).len()), ("vol_things[1].z".to_owned(), 12));
        let long = row(UNIFORM_WORDS + 1);
        assert_eq!(long.space(), Space::Storage);
        assert!(long.declaration().contains("var<storage, read> vol_things: array<f32>;"));
        assert_eq!((long.word(6), long.filled(vec![1; 9]).len()), ("vol_things[6]".to_owned(), 9));
        assert_eq!(row(0).filled(Vec::new()), [0; 4], "no array is empty");
    }
}
