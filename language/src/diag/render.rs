//! Diagnostics as text for people and as JSON lines for programs; the only user of codespan.

use super::{Diagnostic, Severity};
use crate::source::{SourceFile, Sources, Span};
use codespan_reporting::diagnostic as codespan;
use codespan_reporting::files::SimpleFiles;
use codespan_reporting::term::{self, termcolor::Buffer};
use serde::Serialize;
use std::collections::HashMap;
use std::ops::Range;

/// Longest source line that is shown, in bytes; a message about a longer one has only its place.
const MAX_SHOWN_LINE: usize = 1000;

/// The messages with the source lines they point at, for a terminal.
#[must_use]
pub fn human(sources: &Sources, diagnostics: &[Diagnostic], colour: bool) -> String {
    let rich = term::Config::default();
    let brief = term::Config { display_style: term::DisplayStyle::Medium, ..term::Config::default() };
    let styles = term::Styles::default();
    let mut out = if colour { Buffer::ansi() } else { Buffer::no_color() };
    for diagnostic in diagnostics {
        let (files, shown) = codespan_diagnostic(sources, diagnostic);
        let is_long = diagnostic
            .labels
            .iter()
            .zip(&shown.labels)
            .any(|(label, shown)| has_long_line(&sources.locate(label.span).0.text, shown.range.clone()));
        let config = if is_long { &brief } else { &rich };
        let mut writer = term::StylesWriter::new(&mut out, &styles);
        // Fails only on places outside the file, of which `clamp` leaves none.
        if term::emit_to_write_style(&mut writer, config, &files, &shown).is_err() {
            return diagnostics.iter().map(|d| format!("{}: {}\n", d.code, d.message)).collect();
        }
    }
    String::from_utf8_lossy(out.as_slice()).into_owned()
}

/// Whether one of the lines that `range` touches is too long to be shown.
fn has_long_line(text: &str, range: Range<usize>) -> bool {
    let bytes = text.as_bytes();
    let is_end = |byte: &u8| *byte == b'\n';
    let start = bytes[..range.start].iter().rposition(is_end).map_or(0, |at| at + 1);
    let end = bytes[range.end..].iter().position(is_end).map_or(bytes.len(), |at| range.end + at);
    text[start..end].split('\n').any(|line| line.len() > MAX_SHOWN_LINE)
}

/// The diagnostic and the files that its labels lie in.
fn codespan_diagnostic<'a>(
    sources: &'a Sources,
    diagnostic: &Diagnostic,
) -> (SimpleFiles<&'a str, &'a str>, codespan::Diagnostic<usize>) {
    let mut files = SimpleFiles::new();
    let mut known: Vec<&SourceFile> = Vec::new();
    let labels = diagnostic.labels.iter().enumerate().map(|(i, label)| {
        let style = if i == 0 { codespan::LabelStyle::Primary } else { codespan::LabelStyle::Secondary };
        let (file, span) = sources.locate(label.span);
        let id = known.iter().position(|other| std::ptr::eq(*other, file)).unwrap_or_else(|| {
            known.push(file);
            files.add(file.name.as_str(), file.text.as_str())
        });
        codespan::Label::new(style, id, clamp(&file.text, span)).with_message(&label.text)
    });
    let labels: Vec<_> = labels.collect();
    let severity = match diagnostic.severity {
        Severity::Error => codespan::Severity::Error,
        Severity::Warning => codespan::Severity::Warning,
    };
    let shown = codespan::Diagnostic::new(severity)
        .with_code(diagnostic.code)
        .with_message(&diagnostic.message)
        .with_labels(labels)
        .with_notes_iter(diagnostic.help.iter().map(|help| format!("help: {help}")));
    (files, shown)
}

/// The bytes of a span that can be shown: inside the text, whole characters, and no line end at
/// the end.
fn clamp(text: &str, span: Span) -> Range<usize> {
    let last = text.trim_end_matches(['\n', '\r']).len();
    let start = floor_boundary(text, (span.start as usize).min(last));
    let end = (span.end as usize).clamp(start, last);
    let end = (end..=last).find(|&at| text.is_char_boundary(at)).unwrap_or(last);
    start..start + text[start..end].trim_end_matches(['\n', '\r']).len()
}

fn floor_boundary(text: &str, at: usize) -> usize {
    (0..=at).rev().find(|&at| text.is_char_boundary(at)).unwrap_or(0)
}

/// The messages as JSON, one object on each line.
///
/// ```json
/// {"file": "a.vol", "severity": "error", "code": "E0206", "message": "…", "help": "…",
///  "labels": [{"file": "a.vol", "start": PLACE, "end": PLACE, "text": "…"}],
///  "fixes": [{"title": "…", "edits": [{"file": "a.vol", "start": PLACE, "end": PLACE, "text": "45deg"}]}]}
/// ```
///
/// A `PLACE` is `{"byte": 57, "line": 3, "column": 12}`: byte offsets are those of the label's or edit's
/// file; lines and columns count from 1, columns in characters; ends are exclusive. `severity` is
/// `error` or `warning`, `help` may be `null`. The first label is the main place, and its file that of
/// the message. Each of `fixes` would do away with the message when all its `edits` are made; they do
/// not overlap, and their places are those of the file before any of them.
#[must_use]
pub fn json(sources: &Sources, diagnostics: &[Diagnostic]) -> String {
    let mut places = Places { sources, lines: HashMap::new() };
    let mut out = String::new();
    for diagnostic in diagnostics {
        let labels: Vec<_> =
            diagnostic.labels.iter().map(|label| places.text(label.span, clamp, &label.text)).collect();
        let fixes: Vec<_> = diagnostic
            .fixes
            .iter()
            .map(|fix| {
                let edits = fix.edits.iter().map(|edit| places.text(edit.span, whole, &edit.text)).collect();
                JsonFix { title: &fix.title, edits }
            })
            .collect();
        let place = diagnostic.labels.first().map_or(Span::default(), |label| label.span);
        let shown = JsonDiagnostic {
            file: &sources.locate(place).0.name,
            severity: diagnostic.severity,
            code: diagnostic.code,
            message: &diagnostic.message,
            help: diagnostic.help.as_deref(),
            labels,
            fixes,
        };
        out += &serde_json::to_string(&shown).expect("strings and numbers always become JSON");
        out.push('\n');
    }
    out
}

#[derive(Serialize)]
struct JsonDiagnostic<'a> {
    file: &'a str,
    severity: Severity,
    code: &'a str,
    message: &'a str,
    help: Option<&'a str>,
    labels: Vec<JsonLabel<'a>>,
    fixes: Vec<JsonFix<'a>>,
}

#[derive(Serialize)]
struct JsonLabel<'a> {
    file: &'a str,
    start: Position,
    end: Position,
    text: &'a str,
}

#[derive(Serialize)]
struct JsonFix<'a> {
    title: &'a str,
    edits: Vec<JsonLabel<'a>>,
}

#[derive(Serialize)]
struct Position {
    byte: usize,
    line: usize,
    column: usize,
}

/// The bytes of an edit, which may hold a line end.
fn whole(text: &str, span: Span) -> Range<usize> {
    let boundary = |byte: u32| floor_boundary(text, (byte as usize).min(text.len()));
    boundary(span.start)..boundary(span.end)
}

/// Finds lines and columns; where lines begin is looked up once for each file.
struct Places<'a> {
    sources: &'a Sources,
    lines: HashMap<&'a str, Vec<usize>>,
}

impl<'a> Places<'a> {
    /// A text about the bytes that `bytes` makes of a span in its file.
    fn text(&mut self, span: Span, bytes: fn(&str, Span) -> Range<usize>, text: &'a str) -> JsonLabel<'a> {
        let (file, span) = self.sources.locate(span);
        let lines = self.lines.entry(&file.name).or_insert_with(|| line_starts(&file.text));
        let range = bytes(&file.text, span);
        let start = position(&file.text, lines, range.start);
        let end = position(&file.text, lines, range.end);
        JsonLabel { file: &file.name, start, end, text }
    }
}

fn line_starts(text: &str) -> Vec<usize> {
    std::iter::once(0).chain(text.match_indices('\n').map(|(at, _)| at + 1)).collect()
}

fn position(text: &str, lines: &[usize], byte: usize) -> Position {
    let line = lines.partition_point(|&start| start <= byte);
    let column = text[lines[line - 1]..byte].chars().count() + 1;
    Position { byte, line, column }
}

#[cfg(test)]
mod tests {
    use super::{human, json};
    use crate::diag::{Diagnostic, Fix};
    use crate::source::{SourceFile, Span};

    fn shown(text: &str, start: usize, end: usize) -> String {
        let diagnostic =
            Diagnostic::error("E0102", "wrong", Span::new(start, end), "here").with_help("write `a`");
        human(&SourceFile::new("a.vol", text).into(), &[diagnostic], false)
    }

    #[test]
    fn shows_line_label_and_help() {
        let text = shown("let a = 1\nlet b = é!\n", 18, 20);
        assert!(text.contains("error[E0102]: wrong"), "{text}");
        assert!(text.contains("a.vol:2:9"), "{text}");
        assert!(text.contains("^ here"), "{text}");
        assert!(text.contains("help: write `a`"), "{text}");
    }

    #[test]
    fn any_span_of_any_text_can_be_shown() {
        for text in ["", "\n", "\r\n", "a", "é", "aé\n", "a\r\nb\r\n\r\n", "\t\u{1}x"] {
            let file = SourceFile::new("a.vol", text).into();
            for start in 0..text.len() + 3 {
                for end in [0, start, start + 1, start + 2, 99, u32::MAX as usize] {
                    let d = Diagnostic::warning("W0101", "odd", Span::new(start, end), "this")
                        .with_label(Span::new(end, start), "and that");
                    assert!(human(&file, std::slice::from_ref(&d), false).contains("a.vol:"));
                    assert!(human(&file, std::slice::from_ref(&d), true).contains("\u{1b}["));
                    assert!(json(&file, &[d]).ends_with("}\n"));
                }
            }
        }
    }

    #[test]
    fn the_final_line_end_is_never_spanned() {
        let text = shown("let a =\n", 7, 8);
        assert!(text.contains("1 │ let a ="), "{text}");
        assert!(!text.contains("2 │"), "{text}");
    }

    #[test]
    fn a_huge_line_is_not_shown() {
        let text = shown(&"a ".repeat(1 << 20), 1 << 20, (1 << 20) + 1);
        assert!(text.starts_with("a.vol:1:1048577: error[E0102]: wrong"), "{text}");
        assert!(text.len() < 500 && text.contains("help: write `a`"), "{text}");
    }

    #[test]
    fn a_message_without_a_place_is_shown() {
        let mut diagnostic = Diagnostic::error("E0300", "no place", Span::default(), "");
        diagnostic.labels.clear();
        assert!(human(&SourceFile::new("a.vol", "").into(), &[diagnostic], false).contains("no place"));
    }

    #[test]
    fn json_has_one_object_a_line() {
        let file = SourceFile::new("a.vol", "// é\nlet é = \"x\"\n").into();
        let first = Diagnostic::error("E0104", "a \"quoted\" word", Span::new(10, 12), "here");
        let second = Diagnostic::warning("W0101", "odd", Span::new(15, 18), "").with_help("write `a`");
        let second = second.with_fix(Fix::remove(Span::new(5, 19)));
        let text = json(&file, &[first, second]);
        let lines: Vec<serde_json::Value> =
            text.lines().map(|line| serde_json::from_str(line).expect("each line is JSON")).collect();
        assert_eq!(lines.len(), 2);
        assert_eq!(lines[0]["file"], "a.vol");
        assert_eq!(lines[0]["severity"], "error");
        assert_eq!(lines[0]["code"], "E0104");
        assert_eq!(lines[0]["message"], "a \"quoted\" word");
        assert!(lines[0]["help"].is_null());
        let start = &lines[0]["labels"][0]["start"];
        assert_eq!((&start["byte"], &start["line"], &start["column"]), (&10.into(), &2.into(), &5.into()));
        let end = &lines[1]["labels"][0]["end"];
        assert_eq!((&end["byte"], &end["line"], &end["column"]), (&18.into(), &2.into(), &12.into()));
        assert_eq!(lines[1]["help"], "write `a`");
        assert_eq!(lines[0]["fixes"], serde_json::json!([]));
        let start = serde_json::json!({"byte": 5, "line": 1, "column": 5});
        let end = serde_json::json!({"byte": 19, "line": 3, "column": 1});
        let edit = serde_json::json!({"file": "a.vol", "start": start, "end": end, "text": ""});
        assert_eq!(lines[1]["fixes"], serde_json::json!([{"title": "remove it", "edits": [edit]}]));
    }
}
