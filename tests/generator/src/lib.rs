//! Random scenes that are correct: well typed, within the language's limits, with all it can say.
//!
//! ```text
//! bytes (a fuzzer's, or of a seed) ──choices──► text of a .vol scene
//! ```
//!
//! In: any bytes. Out: a text that must compile without an error, the same for the same bytes; fewer
//! bytes give a smaller scene. Library functions come from the compiler's own table, so new ones take
//! part at once. Where a rule of the language is not in a type (a size is not negative, a seed is known
//! at compile time, a shape does not depend on the position), the generator keeps it by itself: it asks
//! neither the checker nor the compiler.

mod block;
mod call;
mod expr;
mod item;
mod iterate;
mod literal;
mod operator;
mod piece;
mod scope;
mod shape;
mod shrink;
mod source;
#[cfg(test)]
mod tests;

pub use shrink::shrink;

use piece::Coordinates;
use scope::{Function, Scope};
use source::Source;
use vol_compiler::ir::verify::random::Random;
use vol_language::library::Library;
use vol_language::standard;

/// Expressions that a scene may unroll to by this crate's own count, far below the compiler's limit.
const MOST_WORK: u64 = 6000;

/// The scene that some bytes stand for.
#[must_use]
pub fn scene(bytes: &[u8]) -> String {
    Generator::new(bytes).scene()
}

/// Bytes for [`scene`] out of a seed; `length` of them, the same on every machine.
#[must_use]
pub fn bytes(seed: u64, length: usize) -> Vec<u8> {
    let mut random = Random::new(seed);
    (0..length).map(|_| random.below(256) as u8).collect()
}

/// A scene being written.
struct Generator<'a> {
    source: Source<'a>,
    library: Library,
    /// Params, `let`s and local bindings.
    scope: Scope,
    functions: Vec<Function>,
    /// Texts of the items, to be put in some order.
    items: Vec<String>,
    /// Expressions so far, unrolled.
    work: u64,
    /// How often the expression being written is unrolled.
    multiplier: u64,
    /// The coordinates of the region or shape of the block being written.
    region: Coordinates,
}

impl<'a> Generator<'a> {
    fn new(bytes: &'a [u8]) -> Self {
        Self {
            source: Source::new(bytes),
            library: standard::extended(&vol_compiler::library::library()),
            scope: Scope::default(),
            functions: Vec::new(),
            items: Vec::new(),
            work: 0,
            multiplier: 1,
            region: Coordinates::default(),
        }
    }

    /// Counts expressions.
    fn spend(&mut self, work: u64) {
        self.work = self.work.saturating_add(work.saturating_mul(self.multiplier));
    }

    /// Whether only leaves may follow.
    fn is_spent(&self) -> bool {
        self.source.is_empty() || self.work > MOST_WORK
    }

    fn scene(mut self) -> String {
        let definitions = self.source.below(8);
        for index in 0..definitions {
            self.definition(index);
        }
        self.blocks();
        let mut items = std::mem::take(&mut self.items);
        // Definitions may stand in any order.
        if self.source.once_in(3) {
            self.source.shuffle(&mut items);
        }
        let mut text = String::new();
        if self.source.once_in(8) {
            text.push_str("#vol 1\n");
        }
        for item in items {
            self.comment(&mut text);
            text.push_str(&item);
            text.push('\n');
        }
        text
    }

    /// Blank lines, comments and doc comments before an item.
    fn comment(&mut self, text: &mut String) {
        text.push_str(match self.source.below(10) {
            6 => "\n// a comment: { ( [ \" that closes nothing\n",
            7 => "\n/// What the next item is for, with an é and a 🌪.\n",
            8 => "/// Two lines,\n/// the second with a `name`.\n",
            9 => "\n\n",
            _ => "",
        });
    }
}
