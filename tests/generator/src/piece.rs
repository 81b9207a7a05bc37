//! Text of an expression with what its surroundings must know of it.

/// What binds how tightly; the larger, the tighter.
pub(crate) mod level {
    /// `if … else a`, `x => a`: swallows what follows.
    pub(crate) const OPEN: u8 = 0;
    pub(crate) const OR: u8 = 1;
    pub(crate) const AND: u8 = 2;
    pub(crate) const COMPARISON: u8 = 3;
    pub(crate) const UNION: u8 = 4;
    pub(crate) const INTERSECTION: u8 = 5;
    pub(crate) const SUM: u8 = 6;
    pub(crate) const PRODUCT: u8 = 7;
    pub(crate) const PREFIX: u8 = 8;
    /// Needs no parentheses anywhere.
    pub(crate) const ATOM: u8 = 9;
}

/// Coordinates that the local point of a region has beyond those that every region has.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Coordinates {
    /// `radius`
    pub(crate) radius: bool,
    /// `t` and `l`
    pub(crate) along: bool,
}

/// Text of an expression.
#[derive(Clone, Debug)]
pub(crate) struct Piece {
    pub(crate) text: String,
    pub(crate) level: u8,
    /// Of a whole number known at compile time: its largest possible magnitude.
    pub(crate) bound: i64,
    /// Of a shape.
    pub(crate) coordinates: Coordinates,
}

/// Bound of whole numbers of which the checker knows nothing.
const UNKNOWN_BOUND: i64 = 16;

impl Piece {
    pub(crate) fn new(text: impl Into<String>, level: u8) -> Self {
        Self { text: text.into(), level, bound: UNKNOWN_BOUND, coordinates: Coordinates::default() }
    }

    pub(crate) fn atom(text: impl Into<String>) -> Self {
        Self::new(text, level::ATOM)
    }

    pub(crate) fn bounded(self, bound: i64) -> Self {
        Self { bound, ..self }
    }

    /// The text where only what binds at least so tightly may stand.
    pub(crate) fn at(&self, level: u8) -> String {
        if self.level < level { format!("({})", self.text) } else { self.text.clone() }
    }

    /// The text before a dot. A number would take the dot for its own.
    pub(crate) fn receiver(&self) -> String {
        let is_number = self.text.starts_with(|c: char| c.is_ascii_digit());
        if is_number { format!("({})", self.text) } else { self.at(level::ATOM) }
    }
}
