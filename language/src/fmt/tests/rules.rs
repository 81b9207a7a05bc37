//! Each rule on a text before and after.

use super::{check, source};
use crate::fmt::{FormatError, format};

#[track_caller]
fn becomes(before: &str, after: &str) {
    assert_eq!(format(&source(before)).as_deref(), Ok(after), "{before}");
    assert!(check(before));
}

#[track_caller]
fn stays(text: &str) {
    becomes(text, text);
}

#[test]
fn blanks_between_tokens() {
    becomes("let a=-b+ - c*f (x ,y) . z==!d", "let a = -b + -c * f(x, y).z == !d\n");
    becomes("let l=[for i in 0 .. n:(i,0,)]", "let l = [for i in 0..n: (i, 0)]\n");
}

#[test]
fn literals_keep_their_spelling() {
    stays("let a = [#ffF, .5, 2e-3, 500ms, 1.0, 0.50, 1E5, \"a \\\"b\\\" // no comment\"]\n");
}

#[test]
fn line_ends_and_the_end_of_the_file() {
    becomes(
        "\n\n let a = 1\r\n\tlet b = 2 // x \r\n\r\n\r\n\r\nlet c = 3",
        "let a = 1\nlet b = 2  // x\n\nlet c = 3\n",
    );
    becomes("let a = 1\n\n\n", "let a = 1\n");
    becomes("let a = 1 let b = 2", "let a = 1\nlet b = 2\n");
    becomes(" \r\n\t", "");
    becomes("\n// only a comment", "// only a comment\n");
}

#[test]
fn the_version_stays_first() {
    becomes("\n#vol 1\n\nlet a=1", "#vol 1\n\nlet a = 1\n");
}

#[test]
fn entries_have_their_values_in_a_column() {
    becomes(
        "object a {\n shape:sphere( 1 ), material :diffuse(#fff000)\n\n when: true }",
        "object a {\n  shape:    sphere(1)\n  material: diffuse(#fff000)\n\n  when: true\n}\n",
    );
}

#[test]
fn blocks_written_on_one_line_stay_on_it() {
    becomes(
        "light key{from:(0,1,0),color:1}\nlight fill  {at: (1,2,3)}\ncamera {}\n\nrender   { fps: 1 }",
        "light key  { from: (0, 1, 0), color: 1 }\nlight fill { at: (1, 2, 3) }\ncamera     {}\n\nrender { fps: 1 }\n",
    );
    becomes("fn f(x:float)->float{let a=1  a}", "fn f(x: float) -> float { let a = 1  a }\n");
    becomes("camera {\n}", "camera {}\n");
}

#[test]
fn comments_stay_where_they_are() {
    let text = "/// doc\nobject a {  // behind the bracket\n  // before the key\n  shape: sphere(1)  // behind\n\n  // at the end\n}\n";
    stays(text);
    becomes(
        "let a = [1, // one\n2 // two\n, // three\n3]",
        "let a = [\n  1,  // one\n  2,  // two\n  // three\n  3,\n]\n",
    );
    becomes("let a = b // why\n + c", "let a = b  // why\n  + c\n");
    becomes("let a = 1 // x\nlet bcd = 2 // y", "let a = 1    // x\nlet bcd = 2  // y\n");
}

#[test]
fn line_ends_that_mean_something_stay() {
    stays("let a = {\n  let b = f\n  (b, 1)\n}\n");
    stays("let a = {\n  let b = f\n  -b\n}\n");
    let long = "a".repeat(60);
    // Here a line that begins with `-` would be the value of the block.
    becomes(
        &format!("let f = {{ let b = {long} - {long}\n b }}"),
        &format!("let f = {{\n  let b = {long} -\n    {long}\n  b\n}}\n"),
    );
    becomes(
        &format!("render {{ fps: {long} - {long} }}"),
        &format!("render {{\n  fps: {long}\n         - {long}\n}}\n"),
    );
}

#[test]
fn long_brackets_have_a_part_on_each_line() {
    let long = "b".repeat(50);
    becomes(&format!("let a = f({long}, g({long}))"), &format!("let a = f(\n  {long},\n  g({long}),\n)\n"));
    becomes(&format!("let a = f([{long}, {long}])"), &format!("let a = f([\n  {long},\n  {long},\n])\n"));
    becomes("let a = f(1, p => {\nlet b = p\nb })", "let a = f(1, p => {\n  let b = p\n  b\n})\n");
}

#[test]
fn long_chains_have_a_method_on_each_line() {
    let long = "b".repeat(50);
    becomes(
        &format!("let a = sphere(1).f({long}).g({long})"),
        &format!("let a = sphere(1)\n  .f({long})\n  .g({long})\n"),
    );
}

#[test]
fn long_choices_have_a_branch_on_each_line() {
    let long = "b".repeat(50);
    becomes(
        &format!("let a = if c then {long} else if d then {long} else e"),
        &format!("let a = if c then {long}\n  else if d then {long}\n  else e\n"),
    );
}

#[test]
fn imports_loops_and_keys() {
    becomes("import  \"a.vol\"  as  a", "import \"a.vol\" as a\n");
    stays("let a = iterate 8 from (z = p, r = 1.0) while length(z) < 2: (z = z * z, r = 2 * r)\n");
    stays("let a = keys(time, 0s: 1, 2s: 0.5, ease: smooth)\n");
    stays("param a: float = .2 in .1.. .5\n");
}

#[test]
fn what_fits_exactly_stays_on_its_line() {
    let exact = format!("let a = f({}, {})\n", "b".repeat(40), "c".repeat(47));
    assert_eq!(exact.trim_end().len(), 100);
    stays(&exact);
    let longer = exact.replace(", c", ", cc");
    assert_eq!(format(&source(&longer)).map(|text| text.lines().count()), Ok(4));
}

#[test]
fn syntax_errors_are_handed_back() {
    match format(&source("let a = \nobject b { shape: sphere( }")) {
        Err(FormatError::Syntax(diagnostics)) => assert!(diagnostics.len() > 1, "{diagnostics:?}"),
        other => panic!("{other:?}"),
    }
}

#[test]
fn deep_nests_are_formatted() {
    let levels = crate::parse::MAX_NESTING - 1;
    for (open, close) in [("(", ")"), ("[", "]"), ("f(a, ", ")"), ("{ a: ", "}"), ("(x => ", ")")] {
        assert!(check(&format!("let a = {}1{}", open.repeat(levels), close.repeat(levels))), "{open}");
    }
    assert!(check(&format!("let a = {}1", "if a then b else ".repeat(200))));
}
