//! Repairs that a program can make.

use crate::source::Span;

/// One replacement in a text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Edit {
    /// What goes; empty for an insertion.
    pub span: Span,
    /// What comes instead; empty for a removal.
    pub text: String,
}

/// A repair: edits that belong together. Their spans are those of the text that the diagnostic is
/// about, and do not overlap.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fix {
    /// What it does, as a menu would show it: lower case, no final stop.
    pub title: String,
    /// The replacements.
    pub edits: Vec<Edit>,
}

impl Fix {
    /// Several edits at once.
    #[must_use]
    pub fn new<T: Into<String>>(
        title: impl Into<String>,
        edits: impl IntoIterator<Item = (Span, T)>,
    ) -> Self {
        let edits = edits.into_iter().map(|(span, text)| Edit { span, text: text.into() });
        Self { title: title.into(), edits: edits.collect() }
    }

    /// Writes `text` in place of what stands at `span`.
    #[must_use]
    pub fn replace(span: Span, text: impl Into<String>) -> Self {
        let text = text.into();
        Self::new(format!("write `{}`", text.trim()), [(span, text)])
    }

    /// Writes `text` before the byte `at`.
    #[must_use]
    pub fn insert(at: u32, text: impl Into<String>) -> Self {
        let text = text.into();
        Self::new(format!("insert `{}`", text.trim()), [(Span { start: at, end: at }, text)])
    }

    /// Takes away what stands at `span`.
    #[must_use]
    pub fn remove(span: Span) -> Self {
        Self::new("remove it", [(span, "")])
    }

    /// The text after the repair.
    #[must_use]
    pub fn apply(&self, text: &str) -> String {
        apply_all(text, [self]).0
    }
}

/// Makes the repairs one after the other, leaving out each that touches an earlier one; returns
/// the new text and the number of repairs made. A repair whose spans are not places in `text` is
/// left out, too.
#[must_use]
pub fn apply_all<'a>(text: &str, fixes: impl IntoIterator<Item = &'a Fix>) -> (String, usize) {
    let mut chosen: Vec<&Edit> = Vec::new();
    let mut count = 0;
    for fix in fixes {
        let is_free = |edit: &Edit| {
            is_place(text, edit.span) && !chosen.iter().any(|other| touch(other.span, edit.span))
        };
        if fix.edits.iter().all(is_free) {
            chosen.extend(&fix.edits);
            count += 1;
        }
    }
    chosen.sort_by_key(|edit| edit.span.start);
    let mut out = String::with_capacity(text.len());
    let mut done = 0;
    for edit in chosen {
        out.push_str(&text[done..edit.span.start as usize]);
        out.push_str(&edit.text);
        done = edit.span.end as usize;
    }
    out.push_str(&text[done..]);
    (out, count)
}

fn is_place(text: &str, span: Span) -> bool {
    span.start <= span.end && text.get(span.start as usize..span.end as usize).is_some()
}

/// Whether two spans share a byte or an end; two insertions at one place would have no order.
fn touch(a: Span, b: Span) -> bool {
    a.start <= b.end && b.start <= a.end
}

#[cfg(test)]
mod tests {
    use super::{Fix, apply_all};
    use crate::source::Span;

    #[test]
    fn edits_are_made_from_left_to_right() {
        let fix = Fix::new("turn", [(Span::new(4, 5), "d"), (Span::new(0, 1), ""), (Span::new(2, 2), "xx")]);
        assert_eq!(fix.apply("a-b-c"), "-xxb-d");
        assert_eq!(Fix::remove(Span::new(0, 3)).apply("abc"), "");
        assert_eq!(Fix::insert(3, " d").apply("abc"), "abc d");
    }

    #[test]
    fn a_repair_that_touches_an_earlier_one_is_left_out() {
        let first = Fix::replace(Span::new(0, 2), "x");
        for second in [Fix::insert(2, "y"), Fix::remove(Span::new(1, 3)), Fix::insert(0, "z")] {
            assert_eq!(apply_all("abcd", [&first, &second]), ("xcd".to_owned(), 1), "{second:?}");
        }
        let far = Fix::insert(4, "!");
        assert_eq!(apply_all("abcd", [&far, &first]), ("xcd!".to_owned(), 2));
    }

    #[test]
    fn places_outside_the_text_are_left_alone() {
        for span in
            [Span::new(1, 9), Span::new(2, 1), Span::new(1, 2), Span { start: u32::MAX, end: u32::MAX }]
        {
            assert_eq!(apply_all("aé", [&Fix::replace(span, "x")]), ("aé".to_owned(), 0), "{span:?}");
        }
    }
}
