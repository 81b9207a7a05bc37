//! Every `vol` block of the documentation compiles without a message, and the steps of the tutorial render.

use crate::support::compile_with_messages;
use libtest_mimic::{Failed, Trial};
use std::path::Path;

/// Pages whose blocks are scenes.
const PAGES: [&str; 3] = ["README.md", "docs/language.md", TUTORIAL];

/// The page whose blocks are whole scenes that build on each other.
const TUTORIAL: &str = "docs/tutorial.md";

/// The trials of this file: one per block.
pub(crate) fn trials() -> Vec<Trial> {
    let mut trials = Vec::new();
    for page in PAGES {
        let blocks = blocks_of(page);
        let count = blocks.len();
        trials.push(Trial::test(format!("spec::{page}_has_blocks"), move || {
            if count > 0 { Ok(()) } else { Err("no block of vol code was found".into()) }
        }));
        for (line, block) in blocks {
            if page == TUTORIAL {
                let block = block.clone();
                trials.push(Trial::test(format!("spec::{page}:{line}_renders"), move || renders(&block)));
            }
            trials.push(Trial::test(format!("spec::{page}:{line}"), move || compiles(&block)));
        }
    }
    trials
}

/// All blocks: page, line and text.
pub(crate) fn all_blocks() -> Vec<(&'static str, usize, String)> {
    let of_page = |page| blocks_of(page).into_iter().map(move |(line, block)| (page, line, block));
    PAGES.into_iter().flat_map(of_page).collect()
}

fn blocks_of(page: &str) -> Vec<(usize, String)> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(page);
    blocks(&std::fs::read_to_string(path).unwrap_or_default())
}

fn compiles(block: &str) -> Result<(), Failed> {
    // A block that shows definitions alone becomes a scene by adding a ball.
    let whole = ["object ", "medium "].iter().any(|item| block.contains(item));
    let scene =
        if whole { block.to_owned() } else { format!("{block}\nobject ball {{ shape: sphere(1) }}\n") };
    let (program, messages) = compile_with_messages("block.vol", &scene);
    if program.is_some() && messages.is_empty() { Ok(()) } else { Err(messages.into()) }
}

fn renders(block: &str) -> Result<(), Failed> {
    let image = crate::support::picture(block, [48, 30], 0.05)?;
    if crate::examples::has_content(&image) { Ok(()) } else { Err("the picture is empty".into()) }
}

/// The fenced `vol` blocks of a page with the line on which each begins.
pub(crate) fn blocks(page: &str) -> Vec<(usize, String)> {
    let mut blocks = Vec::new();
    let mut open: Option<(usize, String)> = None;
    for (number, line) in page.lines().enumerate() {
        match (&mut open, line.trim_end()) {
            (None, "```vol") => open = Some((number + 2, String::new())),
            (Some(_), "```") => blocks.extend(open.take()),
            (Some((_, text)), line) => {
                text.push_str(line);
                text.push('\n');
            }
            (None, _) => {}
        }
    }
    blocks
}
