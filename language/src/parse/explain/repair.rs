//! Repairs that take more than one word.

use crate::diag::Fix;
use crate::source::Span;

/// `//` on each line instead of `/* … */`; `None` if the comment has no end.
pub(super) fn block_comment(title: &str, text: &str, at: usize, length: usize) -> Option<Fix> {
    let comment = &text[at..at + length];
    let end = at + comment.strip_suffix("*/").filter(|inside| inside.len() >= 2)?.len();
    let mut edits = vec![(Span::new(at, at + 2), "//")];
    for (newline, _) in text[at..end].match_indices('\n') {
        let start = at + newline + 1;
        let blank = text[start..end].len() - text[start..end].trim_start_matches([' ', '\t']).len();
        // The last line may hold nothing but the end of the comment.
        if start + blank < end {
            edits.push((Span::new(start + blank, start + blank), "// "));
        }
    }
    let is_last = line_after(text, end + 2).trim().is_empty();
    edits.push((Span::new(end, end + 2), if is_last { "" } else { "\n" }));
    Some(Fix::new(title, edits))
}

/// What the language has for a character from elsewhere.
pub(super) fn bad_character(text: &str, span: Span, character: char) -> Option<Fix> {
    let written = match character {
        '^' | '?' => return None,
        ';' if line_after(text, span.end as usize).trim().is_empty() => return Some(Fix::remove(span)),
        ';' => return Some(Fix::new("begin a new line", [(span, "\n")])),
        '\'' | '‘' | '’' | '“' | '”' => return quotes(text, span),
        '×' | '·' => "*",
        '÷' => "/",
        '−' | '–' | '—' => "-",
        '°' => "deg",
        'π' => "pi",
        character if character.is_whitespace() => {
            return Some(Fix::new("write a plain space", [(span, " ")]));
        }
        character if character.is_alphabetic() => return None,
        _ => return Some(Fix::remove(span)),
    };
    Some(Fix::replace(span, written))
}

/// Both marks of the pair around a text that the mark at `span` belongs to.
fn quotes(text: &str, span: Span) -> Option<Fix> {
    let is_mark = |c: char| matches!(c, '\'' | '‘' | '’' | '“' | '”');
    let start = text[..span.start as usize].rfind('\n').map_or(0, |newline| newline + 1);
    let line = &text[start..start + line_after(text, start).len()];
    let marks: Vec<Span> = line
        .match_indices(is_mark)
        .map(|(at, mark)| Span::new(start + at, start + at + mark.len()))
        .collect();
    let pair = marks.chunks_exact(2).find(|pair| pair.contains(&span))?;
    let inside = &text[pair[0].end as usize..pair[1].start as usize];
    (!inside.contains('"'))
        .then(|| Fix::new("write it between two `\"`", pair.iter().map(|&mark| (mark, "\""))))
}

/// The rest of the line from byte `at` on.
fn line_after(text: &str, at: usize) -> &str {
    text[at..].split('\n').next().unwrap_or_default()
}
