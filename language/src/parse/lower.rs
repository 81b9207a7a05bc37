//! Items and entries to tree nodes; this folder alone names rules of the grammar.

mod expr;
mod item;
mod literal;
mod words;

use super::scan::Token;
use super::{Report, Source, explain, split};
use crate::source::Span;
pub(super) use item::item;
use pest::Parser as _;
use pest::error::{ErrorVariant, InputLocation};
use pest::iterators::{Pair, Pairs};

/// The parser that pest makes of the grammar.
#[derive(pest_derive::Parser)]
#[grammar = "grammar.pest"]
struct Grammar;

/// A piece of the file that the grammar reads at once.
struct Unit<'a> {
    source: &'a Source<'a>,
    tokens: &'a [Token],
    /// What it is, in words: `entry` or `item`.
    name: &'static str,
}

impl<'a> Unit<'a> {
    fn span(&self) -> Span {
        split::cover(self.tokens)
    }

    /// Whether an error that is already reported spoils the unit: in it, or between it and the
    /// token after it.
    fn is_broken(&self, report: &Report) -> bool {
        let span = self.span();
        let tokens = self.source.tokens;
        let next = tokens.partition_point(|token| token.start < span.end);
        let end = tokens.get(next).map_or(u32::MAX, |token| token.start);
        report.is_broken(Span { end, ..span })
    }

    /// Reads the unit; `None` if it has an error, which is reported.
    fn parse(&self, rule: Rule, report: &mut Report) -> Option<Pairs<'a, Rule>> {
        let span = self.span();
        if self.is_broken(report) {
            return None;
        }
        let (start, end) = (span.start as usize, span.end as usize);
        let text = &self.source.mask[start..end];
        match Grammar::parse(rule, text) {
            Ok(pairs) => Some(pairs),
            Err(error) => {
                let offset = match error.location {
                    InputLocation::Pos(at) | InputLocation::Span((at, _)) => start + at,
                };
                report.add(match error.variant {
                    ErrorVariant::ParsingError { positives, .. } => explain::unexpected(&explain::Place {
                        text: self.source.text,
                        tokens: self.tokens,
                        unit: self.name,
                        offset,
                        expected: positives.into_iter().map(words::words).collect(),
                    }),
                    // pest found its stack short, in spite of the guard.
                    ErrorVariant::CustomError { .. } => explain::too_deep(Span::new(offset, offset)),
                });
                None
            }
        }
    }
}

/// Hands out the parts of a rule, in order.
struct Parts<'i> {
    pairs: Pairs<'i, Rule>,
}

impl<'i> Parts<'i> {
    fn of(pair: Pair<'i, Rule>) -> Self {
        Self { pairs: pair.into_inner() }
    }

    /// The next part; the grammar says that there is one.
    fn next(&mut self) -> Pair<'i, Rule> {
        self.pairs.next().expect("the grammar's rule has this part")
    }

    /// The next part if it is of this rule.
    fn next_if(&mut self, rule: Rule) -> Option<Pair<'i, Rule>> {
        self.has(rule).then(|| self.next())
    }

    fn has(&self, rule: Rule) -> bool {
        self.pairs.peek().is_some_and(|pair| pair.as_rule() == rule)
    }
}
