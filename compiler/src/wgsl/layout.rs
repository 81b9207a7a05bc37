//! Where the shaders find the numbers of a frame, and the words that the host puts there.
//!
//! | binding | name | words |
//! |---|---|---|
//! | 0 | `vol_uniforms` | outputs of the frame function (f32), then for each curve its first piece and its number of pieces (u32) |
//! | 1 | `vol_curves` | pieces of all curves, [`Piece::WORDS`] each (f32) |
//! | 2 | `vol_permutation` | permutation of the noise with seed 0 (u32) |
//! | 3 | `vol_input` | what the entry point says (f32) |
//! | 4 | `vol_output` | what the entry point says (f32) |
//!
//! All are storage buffers of group 0, the last one writable. Words that are integers are read with
//! `bitcast`, which keeps their bits even where a driver flushes denormals.

use crate::curve::Piece;
use crate::frame::Frame;
use crate::ir::Module;
use crate::noise_table;

/// Bindings of a scene's numbers as WGSL.
pub(super) const SCENE_BINDINGS: &str = "\
@group(0) @binding(0) var<storage, read> vol_uniforms: array<f32>;
@group(0) @binding(1) var<storage, read> vol_curves: array<f32>;
@group(0) @binding(2) var<storage, read> vol_permutation: array<u32>;
";

/// Bindings of an entry point as WGSL.
pub(super) const ENTRY_BINDINGS: &str = "\
@group(0) @binding(3) var<storage, read> vol_input: array<f32>;
@group(0) @binding(4) var<storage, read_write> vol_output: array<f32>;

";

/// First word of `vol_uniforms` that belongs to the curves.
pub(super) fn curve_table(module: &Module) -> u32 {
    module.frame.outputs.len() as u32
}

/// Words of `vol_uniforms`.
#[must_use]
pub fn uniform_words(frame: &Frame) -> Vec<u32> {
    let mut words: Vec<u32> = frame.uniforms_f32.iter().map(|x| x.to_bits()).collect();
    let mut first = 0;
    for table in &frame.curve_tables {
        let count = table.pieces.len() as u32;
        words.extend([first, count]);
        first += count;
    }
    words
}

/// Words of `vol_curves`.
#[must_use]
pub fn curve_words(frame: &Frame) -> Vec<u32> {
    let pieces = frame.curve_tables.iter().flat_map(|table| &table.pieces);
    pieces.flat_map(Piece::words).map(f32::to_bits).collect()
}

/// Words of `vol_permutation`.
#[must_use]
pub fn permutation_words() -> Vec<u32> {
    noise_table::permutation_words().to_vec()
}
