//! Scene blocks against the table of [`crate::blocks`]: names, keys and the types of values.

use super::Checker;
use super::convert::Role;
use crate::ast::{self, Entry, ExprKind, Name};
use crate::blocks::{BLOCK_KINDS, BlockKind, Key};
use crate::diag::{Diagnostic, Fix};
use crate::hir::{self, ExprId};
use crate::source::Span;
use crate::ty::Type;
use std::collections::HashMap;

impl<'a> Checker<'a> {
    /// Checks all blocks, in source order.
    pub(super) fn check_blocks(&mut self, blocks: impl Iterator<Item = &'a ast::Block>) {
        let mut unique: HashMap<BlockKind, Span> = HashMap::new();
        let mut names: HashMap<&'a str, Span> = HashMap::new();
        let mut shows_something = false;
        for block in blocks {
            let kind = BLOCK_KINDS.into_iter().find(|kind| kind.keyword() == block.keyword.text);
            let Some(kind) = kind else {
                self.report_kind(&block.keyword);
                continue;
            };
            shows_something |= matches!(kind, BlockKind::Object | BlockKind::Medium);
            if kind.is_named() {
                self.check_block_name(block, &mut names);
            } else {
                self.check_unnamed(block);
                match unique.get(&kind) {
                    Some(&first) => self.report_second(block, first),
                    None => {
                        unique.insert(kind, block.keyword.span);
                    }
                }
            }
            self.check_block(block, kind);
        }
        if !shows_something {
            let message = "the scene has nothing to draw: it has no object and no medium";
            let error = Diagnostic::error("E0313", message, Span::default(), "nothing to draw");
            self.report(error.with_help("add `object ball { shape: sphere(1) }`"));
        }
    }

    fn report_kind(&mut self, keyword: &Name) {
        let text = &keyword.text;
        let keywords = BLOCK_KINDS.map(BlockKind::keyword);
        let message = format!("there is no block `{text}`");
        let error = Diagnostic::error("E0301", message, keyword.span, "no such block");
        let error = match self.suggest(text, |_| keywords.to_vec()) {
            Some(near) => error.did_you_mean(&near, keyword.span),
            None => error.with_help(format!("the blocks are `{}`", keywords.join("`, `"))),
        };
        self.report(error);
    }

    fn check_block_name(&mut self, block: &'a ast::Block, names: &mut HashMap<&'a str, Span>) {
        let keyword = &block.keyword;
        let Some(name) = &block.name else {
            let message = format!("this {} has no name", keyword.text);
            let error = Diagnostic::error("E0306", message, keyword.span, "a name is missing after this");
            let fix = Fix::insert(keyword.span.end, format!(" my_{}", keyword.text));
            let help = format!("write `{} my_{} {{ … }}`", keyword.text, keyword.text);
            self.report(error.with_help(help).with_fix(fix));
            return;
        };
        if let Some(&first) = names.get(name.text.as_str()) {
            let message = format!("two blocks are called `{}`", name.text);
            let error = Diagnostic::error("E0307", message, name.span, "used again here");
            let error = error.with_label(first, "first used here");
            self.report(error.with_help(format!("choose another name, such as `{}2`", name.text)));
        } else {
            names.insert(&name.text, name.span);
        }
    }

    fn check_unnamed(&mut self, block: &ast::Block) {
        if let Some(name) = &block.name {
            let keyword = &block.keyword.text;
            let message = format!("a {keyword} block takes no name");
            let error = Diagnostic::error("E0306", message, name.span, "a name stands here");
            let fix = Fix::remove(Span { start: block.keyword.span.end, end: name.span.end });
            self.report(error.with_help(format!("write `{keyword} {{ … }}`")).with_fix(fix));
        }
    }

    fn report_second(&mut self, block: &ast::Block, first: Span) {
        let keyword = &block.keyword;
        let message = format!("a scene has one {} block", keyword.text);
        let error = Diagnostic::error("E0305", message, keyword.span, "this is the second");
        self.report(error.with_label(first, "this is the first").with_help("remove one of them"));
    }

    fn check_block(&mut self, block: &'a ast::Block, kind: BlockKind) {
        let span = block.name.as_ref().map_or(block.keyword.span, |name| block.keyword.span.to(name.span));
        let keys = kind.keys();
        let mut seen: HashMap<&str, usize> = HashMap::new();
        let mut entries = Vec::with_capacity(block.entries.len());
        for (i, entry) in block.entries.iter().enumerate() {
            let Some(key) = keys.iter().find(|key| key.name == entry.key.text) else {
                let article = if kind == BlockKind::Object { "an" } else { "a" };
                self.report_key(entry, &format!("{article} {} has", kind.keyword()), &keys);
                continue;
            };
            let value = self.expect(&entry.value, &key.ty, Role::Key(key.name));
            match seen.get(key.name) {
                Some(&first) => self.report_key_twice(&block.entries, first, i),
                None => {
                    seen.insert(key.name, i);
                    entries.push((key.name, value));
                }
            }
        }
        for key in keys.iter().filter(|key| key.required && !seen.contains_key(key.name)) {
            let message = format!("this {} has no `{}`", kind.keyword(), key.name);
            let error = Diagnostic::error("E0304", message, span, format!("`{}` is missing", key.name));
            self.report(error.with_help(format!(
                "add `{}: {}`, {}",
                key.name,
                self.sample(&key.ty).unwrap_or_else(|| "…".to_owned()),
                key.doc
            )));
        }
        let name = block.name.as_ref().map_or_else(String::new, |name| name.text.clone());
        let block = hir::Block { kind, name, entries, span };
        self.check_rules(&block);
        self.scene.blocks.push(block);
    }

    /// Reports a key that `owner` ("a camera has") does not take.
    pub(super) fn report_key(&mut self, entry: &'a Entry, owner: &str, keys: &[Key]) {
        let text = &entry.key.text;
        let known: Vec<&str> = keys.iter().map(|key| key.name).collect();
        let near = self.suggest(text, |_| known.clone());
        let message = format!("{owner} no key `{text}`");
        let error = Diagnostic::error("E0302", message, entry.key.span, "no such key");
        let error = match &near {
            Some(near) => error.did_you_mean(near, entry.key.span),
            None => error.with_help(format!("the keys are `{}`", known.join("`, `"))),
        };
        self.report(error);
        // The value may have mistakes of its own, unless only its key could say what it is.
        if let Some(key) = keys.iter().find(|key| near.as_deref() == Some(key.name)) {
            self.expect(&entry.value, &key.ty, Role::Key(key.name));
        } else if !self.is_deferred(&entry.value) && !matches!(entry.value.kind, ExprKind::Record(_)) {
            self.infer(&entry.value);
        }
    }

    /// Reports that entry `second` has the key of the earlier entry `first`.
    pub(super) fn report_key_twice(&mut self, entries: &[Entry], first: usize, second: usize) {
        let (key, first_key) = (&entries[second].key, entries[first].key.span);
        let message = format!("`{}` is given twice", key.text);
        let error = Diagnostic::error("E0303", message, key.span, "given again here");
        let before = Span { start: entries[second - 1].value.span.end, end: entries[second].value.span.end };
        let after = Span { start: first_key.start, end: entries[first + 1].key.span.start };
        let fixes = [("remove the first", after), ("remove the second", before)];
        let error = error.with_label(first_key, "first given here").with_help("remove one of them");
        self.report(
            fixes
                .into_iter()
                .fold(error, |error, (title, span)| error.with_fix(Fix::new(title, [(span, "")]))),
        );
    }

    /// Whether an expression is present and free of errors.
    pub(super) fn sound_entry(&self, block: &hir::Block, key: &str) -> Option<ExprId> {
        block.entry(key).filter(|&value| *self.ty(value) != Type::Error)
    }
}
