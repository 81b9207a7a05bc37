//! Modules: a scene's own file and the files that it imports.
//!
//! ```text
//! root SourceFile ──load──► Sources (texts end to end), one Module per file, messages
//! ```
//!
//! Paths are relative to the file that names them and never leave the folder of the scene's own file.
//! This crate reads no files; a [`Loader`] does.

use crate::ast::{self, Import, ItemKind};
use crate::diag::Diagnostic;
use crate::parse;
use crate::source::{MAX_SOURCE_BYTES, SourceFile, Sources, Span};

/// Most files that a scene may import, directly or not.
pub const MAX_IMPORTS: usize = 64;

/// Codes of the messages about imports with what each is about.
pub const CODES: &[(&str, &str)] = &[
    ("E0601", "an imported file cannot be read"),
    ("E0602", "an import leaves the folder of the scene, or is no relative path"),
    ("E0603", "files import each other in a circle"),
    ("E0604", "a scene imports too many files, or too large ones"),
    ("E0605", "an imported file has no such item"),
    ("E0606", "the name of an import stands where a value is expected"),
];

/// Index of a file of the scene; 0 is its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct ModuleId(pub u32);

impl ModuleId {
    /// The scene's own file.
    pub const ROOT: Self = Self(0);
    /// The standard library.
    pub const LIBRARY: Self = Self(u32::MAX);
}

/// Reads imported files.
pub trait Loader {
    /// The file at `path`: relative to the folder of the scene's own file, parts separated by `/`, none
    /// of them `.` or `..`.
    ///
    /// # Errors
    /// Why it cannot be read, in words that continue "cannot read `path`: ".
    fn read(&self, path: &str) -> Result<SourceFile, String>;
}

/// Has no files: for texts that stand alone.
pub struct NoFiles;

impl Loader for NoFiles {
    fn read(&self, _path: &str) -> Result<SourceFile, String> {
        Err("this text has no folder to import from".to_owned())
    }
}

/// One file of a scene.
#[derive(Debug)]
pub struct Module {
    /// Its items; spans are those of [`Sources`].
    pub file: ast::File,
    /// What its imports are called, and the modules behind them; `None` where one could not be read.
    pub imports: Vec<(ast::Name, Option<ModuleId>)>,
    /// What stands before the names of its params outside: empty, or `clouds.`
    pub prefix: String,
    /// Path below the scene's folder.
    path: String,
}

impl Module {
    /// A file that nothing was imported into yet; `path` is its name in the scene's folder.
    #[must_use]
    pub fn root(file: ast::File, path: &str) -> Self {
        Self { file, imports: Vec::new(), prefix: String::new(), path: path.to_owned() }
    }
}

/// A scene's files.
#[derive(Debug)]
pub struct Loaded {
    /// Their texts.
    pub sources: Sources,
    /// Their trees, by [`ModuleId`].
    pub modules: Vec<Module>,
    /// Mistakes in syntax and in imports.
    pub diagnostics: Vec<Diagnostic>,
}

/// Parses a scene's own file and all that it imports.
#[must_use]
pub fn load(root: SourceFile, loader: &dyn Loader) -> Loaded {
    let (file, diagnostics) = parse::parse(&root);
    let bytes = root.text.len();
    let module = Module::root(file, root.name.rsplit(['/', '\\']).next().unwrap_or_default());
    let loaded = Loaded { sources: root.into(), modules: vec![module], diagnostics };
    let mut walk = Walk { loader, loaded, open: Vec::new(), bytes };
    walk.imports_of(0);
    walk.loaded
}

struct Walk<'a> {
    loader: &'a dyn Loader,
    loaded: Loaded,
    /// The chain of modules whose imports are being followed, with the places of those imports.
    open: Vec<(usize, Span)>,
    bytes: usize,
}

impl Walk<'_> {
    /// Follows the imports of a module. Recurses at most [`MAX_IMPORTS`] deep.
    fn imports_of(&mut self, index: usize) {
        let items = &self.loaded.modules[index].file.items;
        let imports: Vec<Import> = items
            .iter()
            .filter_map(|item| match &item.kind {
                ItemKind::Import(import) => Some(import.clone()),
                ItemKind::Param(_) | ItemKind::Let(_) | ItemKind::Function(_) | ItemKind::Block(_) => None,
            })
            .collect();
        for import in imports {
            self.open.push((index, import.path_span));
            let target = self.target(index, &import);
            self.open.pop();
            let target = target.map_err(|diagnostic| self.loaded.diagnostics.push(*diagnostic)).ok();
            self.loaded.modules[index].imports.push((import.alias, target));
        }
    }

    fn target(&mut self, from: usize, import: &Import) -> Result<ModuleId, Box<Diagnostic>> {
        let span = import.path_span;
        let path = resolve(&self.loaded.modules[from].path, &import.path)
            .ok_or_else(|| outside(span, &import.path))?;
        if let Some(known) = self.loaded.modules.iter().position(|module| module.path == path) {
            return match self.open.iter().position(|&(open, _)| open == known) {
                Some(first) => Err(self.circle(first)),
                None => Ok(ModuleId(known as u32)),
            };
        }
        if self.loaded.modules.len() > MAX_IMPORTS {
            return Err(too_many(span));
        }
        let file = self.loader.read(&path).map_err(|reason| unreadable(span, &import.path, &reason))?;
        self.bytes += file.text.len();
        if self.bytes > MAX_SOURCE_BYTES {
            return Err(too_large(span));
        }
        let (mut tree, mut found) = parse::parse(&file);
        let index = self.loaded.sources.add(file);
        let start = self.loaded.sources.start(index);
        ast::spans::shift(&mut tree, start);
        found.iter_mut().for_each(|diagnostic| diagnostic.shift(start));
        self.loaded.diagnostics.extend(found);
        let prefix = format!("{}{}.", self.loaded.modules[from].prefix, import.alias.text);
        self.loaded.modules.push(Module { file: tree, imports: Vec::new(), prefix, path });
        self.imports_of(index);
        Ok(ModuleId(index as u32))
    }

    /// The open imports from `first` on form a circle.
    fn circle(&self, first: usize) -> Box<Diagnostic> {
        let chain = &self.open[first..];
        let name = |i: usize| self.loaded.modules[chain[i % chain.len()].0].path.as_str();
        let label = |i: usize| format!("`{}` imports `{}` here", name(i), name(i + 1));
        let last = chain.len() - 1;
        let message = match last {
            0 => format!("`{}` imports itself", name(0)),
            _ => format!("`{}` imports itself through other files", name(0)),
        };
        let mut error = Diagnostic::error("E0603", message, chain[last].1, label(last));
        for (i, &(_, span)) in chain[..last].iter().enumerate() {
            error = error.with_label(span, label(i));
        }
        Box::new(error.with_help("move what both need into a third file"))
    }
}

/// A path written in the file at `from`, below the scene's folder; `None` if it leaves it.
fn resolve(from: &str, written: &str) -> Option<String> {
    let is_relative =
        !written.is_empty() && !written.starts_with('/') && !written.contains(['\\', ':', '\0']);
    if !is_relative {
        return None;
    }
    let mut parts: Vec<&str> = from.split('/').collect();
    parts.pop();
    for part in written.split('/') {
        match part {
            "" | "." => {}
            ".." => {
                parts.pop()?;
            }
            _ => parts.push(part),
        }
    }
    (!parts.is_empty()).then(|| parts.join("/"))
}

fn outside(span: Span, path: &str) -> Box<Diagnostic> {
    let message = format!("`{path}` is no path below the folder of the scene");
    Box::new(
        Diagnostic::error("E0602", message, span, "leaves the folder, or is not relative")
            .with_help("write a path from this file down, with `/`: `import \"lib/clouds.vol\" as clouds`"),
    )
}

fn unreadable(span: Span, path: &str, reason: &str) -> Box<Diagnostic> {
    let message = format!("cannot read `{path}`: {reason}");
    Box::new(
        Diagnostic::error("E0601", message, span, "imported here")
            .with_help("the path is relative to the file that imports it"),
    )
}

fn too_many(span: Span) -> Box<Diagnostic> {
    let message = format!("the scene imports more than {MAX_IMPORTS} files");
    Box::new(
        Diagnostic::error("E0604", message, span, "one too many").with_help("join some of the files to one"),
    )
}

fn too_large(span: Span) -> Box<Diagnostic> {
    let message = format!("the files of the scene have more than {MAX_SOURCE_BYTES} bytes together");
    Box::new(
        Diagnostic::error("E0604", message, span, "the limit is reached here")
            .with_help("import fewer or smaller files"),
    )
}

#[cfg(test)]
mod tests;
