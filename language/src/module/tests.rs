//! Imports: what is found, and every way in which they go wrong.

use super::{Loader, MAX_IMPORTS, resolve};
use crate::library::Library;
use crate::source::SourceFile;
use crate::{Analysis, analyse_with};

/// Files by path.
struct Files<'a>(&'a [(&'a str, &'a str)]);

impl Loader for Files<'_> {
    fn read(&self, path: &str) -> Result<SourceFile, String> {
        let found = self.0.iter().find(|(known, _)| *known == path);
        found.map(|(_, text)| SourceFile::new(path, *text)).ok_or_else(|| "no such file".to_owned())
    }
}

/// A scene whose medium is as dense as `density` says.
fn scene(items: &str, density: &str) -> String {
    format!("{items}\nmedium m {{ region: ball, density: {density} }}")
}

/// A library with one function that gives a shape.
fn library() -> Library {
    let params = Vec::new();
    let result = crate::ty::Type::Shape;
    Library { signatures: vec![crate::library::Signature { name: "dot", params, result, doc: "" }] }
}

fn analysis(root: &str, files: &[(&str, &str)]) -> Analysis {
    let root = root.replace("region: ball", "region: dot()");
    analyse_with(SourceFile::new("scenes/root.vol", root), &library(), &Files(files))
}

/// Code, file and marked text of each message.
fn messages(root: &str, files: &[(&str, &str)]) -> Vec<String> {
    let Analysis { diagnostics, sources, .. } = analysis(root, files);
    let line = |diagnostic: &crate::diag::Diagnostic| {
        let (file, span) = sources.locate(diagnostic.labels[0].span);
        format!("{} {} `{}`", diagnostic.code, file.name, &file.text[span.start as usize..span.end as usize])
    };
    diagnostics.iter().map(line).collect()
}

const CLOUDS: (&str, &str) = (
    "lib/clouds.vol",
    "/// How much of it.\nparam amount: float = 0.5 in 0..1\nlet base = 2 * amount\n\
     fn puff(p: vec3, k: float = 3) -> float { base * k * p.x }\nobject ignored { shape: nix }",
);
const IMPORT: &str = "import \"lib/clouds.vol\" as clouds";

#[test]
fn functions_values_and_params_are_reached_by_name() {
    let root = scene(IMPORT, "q => clouds.puff(q.local, k: 2) + clouds.base + clouds.amount");
    let found = analysis(&root, &[CLOUDS]);
    assert_eq!(found.diagnostics, []);
    let scene = found.scene.expect("no errors");
    assert_eq!(scene.params[0].name, "clouds.amount");
    assert_eq!(scene.params[0].doc, "How much of it.");
    assert_eq!(scene.blocks.len(), 1, "blocks of imported files do not count");
}

#[test]
fn functions_are_values_too() {
    let items = format!("{IMPORT}\nfn twice(f: (vec3) -> float, p: vec3) -> float {{ 2 * f(p) }}");
    assert_eq!(messages(&scene(&items, "q => twice(clouds.puff, q.local)"), &[CLOUDS]), [""; 0]);
    let wrong = "E0205 scenes/root.vol `clouds.puff`";
    let items = format!("{IMPORT}\nfn twice(f: (vec2) -> float) -> float {{ f(vec2(1, 2)) }}");
    assert_eq!(messages(&scene(&items, "q => twice(clouds.puff)"), &[CLOUDS]), [wrong]);
}

#[test]
fn names_of_a_file_are_its_own() {
    // Both files have a `base`; the imported function sees its own.
    let root = scene(&format!("{IMPORT}\nlet base = (1, 2, 3)"), "q => clouds.puff(q.local) + base.x");
    assert_eq!(messages(&root, &[CLOUDS]), [""; 0]);
    let root = scene(IMPORT, "q => puff(q.local)");
    assert_eq!(messages(&root, &[CLOUDS]), ["E0201 scenes/root.vol `puff`"]);
    let root = scene(IMPORT, "q => clouds.puf(q.local)");
    assert_eq!(messages(&root, &[CLOUDS]), ["E0605 scenes/root.vol `puf`"]);
    assert_eq!(messages(&scene(IMPORT, "q => clouds"), &[CLOUDS]), ["E0606 scenes/root.vol `clouds`"]);
}

#[test]
fn a_local_hides_an_import() {
    assert_eq!(messages(&scene(IMPORT, "clouds => clouds.depth"), &[CLOUDS]), [""; 0]);
}

#[test]
fn mistakes_stand_in_their_file() {
    let bad = ("lib/clouds.vol", "fn puff(p: vec3) -> float { p.q }\nlet a = \n");
    let root = scene(IMPORT, "q => clouds.puff(q.local)");
    let found = messages(&root, &[bad]);
    assert_eq!(found, ["E0209 lib/clouds.vol `q`", "E0102 lib/clouds.vol `=`"]);
}

#[test]
fn files_that_are_not_there() {
    let root = scene("import \"nix.vol\" as nix", "q => nix.puff(q.local) + nix.base");
    assert_eq!(messages(&root, &[]), ["E0601 scenes/root.vol `\"nix.vol\"`"]);
}

#[test]
fn paths_stay_in_the_folder() {
    for path in ["../a.vol", "/etc/passwd", "lib/../../a.vol", "", ".", "C:\\\\a.vol", "a\\\\b.vol"] {
        let root = scene(&format!("import \"{path}\" as a"), "1");
        assert_eq!(messages(&root, &[("a.vol", "")])[0][..5], *"E0602", "{path}");
    }
    assert_eq!(resolve("lib/a.vol", "b.vol").as_deref(), Some("lib/b.vol"));
    assert_eq!(resolve("lib/a.vol", "../b.vol").as_deref(), Some("b.vol"));
    assert_eq!(resolve("lib/a.vol", "./sub//b.vol").as_deref(), Some("lib/sub/b.vol"));
    assert_eq!(resolve("a.vol", "../b.vol"), None);
}

#[test]
fn circles_are_reported_once() {
    let files = [("a.vol", "import \"b.vol\" as b"), ("b.vol", "import \"a.vol\" as a")];
    assert_eq!(messages(&scene("import \"a.vol\" as a", "1"), &files), ["E0603 b.vol `\"a.vol\"`"]);
    let root = scene("import \"root.vol\" as me", "1");
    assert_eq!(messages(&root, &[]), ["E0603 scenes/root.vol `\"root.vol\"`"]);
}

#[test]
fn a_file_imported_twice_is_one() {
    let files = [
        CLOUDS,
        ("a.vol", "import \"lib/clouds.vol\" as c\nfn f(p: vec3) -> float { c.puff(p) }"),
        ("b.vol", "import \"lib/clouds.vol\" as d\nfn f(p: vec3) -> float { d.puff(p) }"),
    ];
    let root = scene("import \"a.vol\" as a\nimport \"b.vol\" as b", "q => a.f(q.local) + b.f(q.local)");
    let found = analysis(&root, &files);
    assert_eq!(found.diagnostics, []);
    let params: Vec<String> = found.scene.expect("no errors").params.into_iter().map(|p| p.name).collect();
    assert_eq!(params, ["a.c.amount"]);
}

#[test]
fn names_are_given_once() {
    let files = [("a.vol", ""), ("b.vol", "")];
    let twice = scene("import \"a.vol\" as a\nimport \"b.vol\" as a", "1");
    assert_eq!(messages(&twice, &files), ["E0202 scenes/root.vol `a`"]);
    let item = scene("import \"a.vol\" as a\nlet a = 1", "1");
    assert_eq!(messages(&item, &files), ["E0202 scenes/root.vol `a`"]);
    assert_eq!(messages(&scene("import \"a.vol\" as time", "1"), &files), ["E0203 scenes/root.vol `time`"]);
}

#[test]
fn the_number_of_files_is_limited() {
    let names: Vec<String> = (0..=MAX_IMPORTS).map(|i| format!("f{i}.vol")).collect();
    let texts: Vec<String> = (1..=MAX_IMPORTS + 1).map(|i| format!("import \"f{i}.vol\" as next")).collect();
    let files: Vec<(&str, &str)> = names.iter().zip(&texts).map(|(n, t)| (n.as_str(), t.as_str())).collect();
    let found = messages(&scene("import \"f0.vol\" as first", "1"), &files);
    assert_eq!(found, [format!("E0604 f{}.vol `\"f{MAX_IMPORTS}.vol\"`", MAX_IMPORTS - 1)]);
}
