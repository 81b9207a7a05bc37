//! Items: scene blocks cut by hand into entries, all else read whole by the grammar.

use super::expr::Lowerer;
use super::{Parts, Rule, Unit};
use crate::ast;
use crate::blocks::BLOCK_KINDS;
use crate::parse::guard::is_block_word;
use crate::parse::scan::{Kind, Token};
use crate::parse::split::{self, Separator};
use crate::parse::{Report, Source, explain};

/// Reads one item; `None` if it has errors, which are then in `report`.
pub(in crate::parse) fn item(
    source: &Source<'_>,
    tokens: &[Token],
    report: &mut Report,
) -> Option<ast::ItemKind> {
    let first = tokens.first()?;
    let unit = Unit { source, tokens, name: "item" };
    match first.text(source.text) {
        "let" => binding(&unit, report).map(ast::ItemKind::Let),
        "param" => param(&unit, report).map(ast::ItemKind::Param),
        "fn" => function(&unit, report).map(ast::ItemKind::Function),
        "import" => import(&unit, report).map(ast::ItemKind::Import),
        word if is_block_word(word) => block(&unit, report).map(ast::ItemKind::Block),
        word => {
            if !report.is_broken(first.span()) {
                let next = tokens.get(1).map(|token| token.text(source.text));
                report.add(explain::unknown_item(first.span(), word, next));
            }
            None
        }
    }
}

fn import(unit: &Unit<'_>, report: &mut Report) -> Option<ast::Import> {
    let mut parts = Parts { pairs: unit.parse(Rule::import_unit, report)? };
    let lowerer = Lowerer::new(unit, report);
    parts.next_if(Rule::kw_import);
    let (path, path_span) = lowerer.text(&parts.next());
    parts.next_if(Rule::kw_as);
    let alias = lowerer.name(&parts.next());
    Some(ast::Import { path, path_span, alias })
}

fn binding(unit: &Unit<'_>, report: &mut Report) -> Option<ast::Let> {
    let mut parts = Parts { pairs: unit.parse(Rule::let_unit, report)? };
    let lowerer = Lowerer::new(unit, report);
    parts.next_if(Rule::kw_let);
    let name = lowerer.name(&parts.next());
    parts.next_if(Rule::equals);
    let value = lowerer.expr(parts.next());
    Some(ast::Let { name, value })
}

fn param(unit: &Unit<'_>, report: &mut Report) -> Option<ast::Param> {
    let mut parts = Parts { pairs: unit.parse(Rule::param_unit, report)? };
    let lowerer = Lowerer::new(unit, report);
    parts.next_if(Rule::kw_param);
    let name = lowerer.name(&parts.next());
    parts.next_if(Rule::colon);
    let ty = lowerer.type_expr(parts.next());
    parts.next_if(Rule::equals);
    let default = lowerer.expr(parts.next());
    let mut range = None;
    if parts.next_if(Rule::kw_in).is_some() {
        let low = lowerer.expr(parts.next());
        match parts.next_if(Rule::range_to) {
            Some(_) => range = Some((low, lowerer.expr(parts.next()))),
            None => lowerer.report(explain::not_a_range(low.span)),
        }
    }
    Some(ast::Param { name, ty, default, range })
}

fn function(unit: &Unit<'_>, report: &mut Report) -> Option<ast::Function> {
    let mut parts = Parts { pairs: unit.parse(Rule::fn_unit, report)? };
    let lowerer = Lowerer::new(unit, report);
    parts.next_if(Rule::kw_fn);
    let name = lowerer.name(&parts.next());
    let params = parts.next().into_inner().map(|pair| function_param(&lowerer, Parts::of(pair))).collect();
    parts.next_if(Rule::arrow);
    let result = lowerer.type_expr(parts.next());
    let body = lowerer.block(parts.next());
    Some(ast::Function { name, params, result, body })
}

fn function_param(lowerer: &Lowerer<'_>, mut parts: Parts<'_>) -> ast::FunctionParam {
    let name = lowerer.name(&parts.next());
    parts.next_if(Rule::colon);
    let ty = lowerer.type_expr(parts.next());
    let default = parts.next_if(Rule::equals).map(|_| lowerer.expr(parts.next()));
    ast::FunctionParam { name, ty, default }
}

/// A scene block. All its entries are read, also after one with an error.
fn block(unit: &Unit<'_>, report: &mut Report) -> Option<ast::Block> {
    let text = unit.source.text;
    let (head, rest) = unit.tokens.split_first()?;
    let keyword = name_of(head, text);
    let has_name = rest.first().is_some_and(|token| token.kind == Kind::Word);
    let (names, rest) = rest.split_at(usize::from(has_name));
    let name = names.first().map(|token| name_of(token, text));
    let Some((open, rest)) = rest.split_first().filter(|(token, _)| token.text(text) == "{") else {
        if !unit.is_broken(report) {
            let at = rest.first().or(names.first()).unwrap_or(head).span();
            let stray = (rest.get(1).is_some_and(|next| next.text(text) == "{")).then_some(at);
            report.add(explain::expected_block(at, &keyword.text, is_named(&keyword.text), stray));
        }
        return None;
    };
    if report.is_broken(open.span()) {
        return None;
    }
    let length = rest.iter().take_while(|token| token.kind != Kind::Close || token.depth > 0).count();
    let (inside, end) = rest.split_at(length);
    if let Some(extra) = end.get(1).filter(|extra| !report.is_broken(extra.span())) {
        report.add(explain::after_block(extra.span(), extra.text(text)));
    }
    let entries = entries(unit, inside, report);
    Some(ast::Block { keyword, name, entries })
}

fn is_named(keyword: &str) -> bool {
    BLOCK_KINDS.iter().any(|kind| kind.keyword() == keyword && kind.is_named())
}

fn name_of(token: &Token, text: &str) -> ast::Name {
    ast::Name { text: token.text(text).to_owned(), span: token.span() }
}

fn entries(unit: &Unit<'_>, inside: &[Token], report: &mut Report) -> Vec<ast::Entry> {
    let mut entries = Vec::new();
    let cut = split::entries(unit.source.text, inside);
    let mut rest = cut.as_slice();
    let mut end = inside.first().map_or(0, |token| token.start);
    while let [raw, after @ ..] = rest {
        rest = after;
        let [first, ..] = raw.tokens else {
            report.add(explain::stray_comma(raw.end));
            continue;
        };
        let unit = Unit { source: unit.source, tokens: raw.tokens, name: "entry" };
        if raw.separator == Separator::Missing && !unit.is_broken(report) {
            report.add(explain::missing_comma(first.span(), end));
        }
        end = unit.span().end;
        let loose = loose_components(&unit, after);
        if let Some((last, between)) = rest[..loose].split_last() {
            let others = between.first().unwrap_or(last).tokens[0].span().to(split::cover(last.tokens));
            let value = split::cover(&raw.tokens[2..]);
            report.add(explain::loose_components(value, others, unit.source.text));
            rest = &rest[loose..];
            continue;
        }
        entries.extend(entry(&unit, report));
    }
    entries
}

/// How many of the entries after `key: number` are further numbers: the components of a vector whose
/// brackets were forgotten.
fn loose_components(unit: &Unit<'_>, after: &[split::RawEntry<'_>]) -> usize {
    let text = unit.source.text;
    let is_number = |tokens: &[Token]| match tokens {
        [number] => number.kind == Kind::Number,
        [sign, number] => sign.text(text) == "-" && number.kind == Kind::Number,
        _ => false,
    };
    match unit.tokens {
        [key, colon, value @ ..] if key.kind == Kind::Word && colon.text(text) == ":" && is_number(value) => {
            let is_component =
                |raw: &&split::RawEntry<'_>| raw.separator == Separator::Comma && is_number(raw.tokens);
            after.iter().take_while(is_component).count()
        }
        _ => 0,
    }
}

fn entry(unit: &Unit<'_>, report: &mut Report) -> Option<ast::Entry> {
    let mut parts = Parts { pairs: unit.parse(Rule::entry_unit, report)? };
    let lowerer = Lowerer::new(unit, report);
    Some(lowerer.entry(parts.next()))
}
