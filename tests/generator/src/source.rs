//! Choices out of a string of bytes.

use arbitrary::Unstructured;

/// Choices that a string of bytes makes. Past its end every choice is the first one, so options stand
/// in order of size: a shorter string gives a smaller scene.
pub(crate) struct Source<'a>(Unstructured<'a>);

impl<'a> Source<'a> {
    pub(crate) fn new(bytes: &'a [u8]) -> Self {
        Self(Unstructured::new(bytes))
    }

    /// Whether only first choices are left.
    pub(crate) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// A whole number below `count`, which is positive.
    pub(crate) fn below(&mut self, count: usize) -> usize {
        self.0.int_in_range(0..=count.saturating_sub(1)).unwrap_or(0)
    }

    /// True once in `count` times.
    pub(crate) fn once_in(&mut self, count: usize) -> bool {
        self.below(count) + 1 == count
    }

    /// One of some values.
    pub(crate) fn pick<T: Copy>(&mut self, values: &[T]) -> T {
        values[self.below(values.len())]
    }

    /// All of some values, in some order.
    pub(crate) fn shuffle<T>(&mut self, values: &mut [T]) {
        for last in (1..values.len()).rev() {
            // The first choice leaves them as they are.
            values.swap(last, last - self.below(last + 1));
        }
    }
}
