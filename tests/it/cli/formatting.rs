//! What `vol fmt` writes and says.

use super::{Outcome, Sandbox, equal, trial};
use crate::support::scenes_in;
use libtest_mimic::{Failed, Trial};
use std::fs;

pub(super) fn trials() -> Vec<Trial> {
    vec![
        trial("fmt::in_place", in_place),
        trial("fmt::check", check),
        trial("fmt::diff", diff),
        trial("fmt::standard_input", standard_input),
        trial("fmt::mistakes_leave_the_file", mistakes),
        trial("fmt::line_ends_and_byte_order_mark", line_ends),
        trial("fmt::examples_are_formatted", examples),
        #[cfg(unix)]
        trial("fmt::permissions_and_links_stay", permissions),
    ]
}

const UGLY: &str = "object a{shape:sphere(1)}  // a ball\n";
const TIDY: &str = "object a { shape: sphere(1) }  // a ball\n";

fn written(sandbox: &Sandbox, name: &str) -> Result<String, Failed> {
    Ok(String::from_utf8(sandbox.read(name)?)?)
}

fn silent(outcome: &Outcome) -> Result<(), Failed> {
    equal((outcome.stdout.as_str(), outcome.stderr.as_str()), ("", ""))
}

fn in_place(sandbox: &Sandbox) -> Result<(), Failed> {
    sandbox.write("ugly.vol", UGLY)?;
    sandbox.write("tidy.vol", TIDY)?;
    let modified = || fs::metadata(sandbox.path("tidy.vol")).and_then(|metadata| metadata.modified());
    let before = modified()?;
    silent(&sandbox.vol("fmt ugly.vol tidy.vol")?.expect(0, &[])?)?;
    equal(written(sandbox, "ugly.vol")?.as_str(), TIDY)?;
    equal(modified()?, before)?;
    equal(sandbox.new_files()?.join(" "), "tidy.vol ugly.vol".to_owned())
}

fn check(sandbox: &Sandbox) -> Result<(), Failed> {
    sandbox.write("ugly.vol", UGLY)?;
    sandbox.write("tidy.vol", TIDY)?;
    let outcome = sandbox.vol("fmt --check ugly.vol tidy.vol")?.expect(1, &[])?;
    equal((outcome.stdout.as_str(), outcome.stderr.as_str()), ("ugly.vol\n", ""))?;
    equal(written(sandbox, "ugly.vol")?.as_str(), UGLY)?;
    silent(&sandbox.vol("fmt --check tidy.vol")?.expect(0, &[])?)
}

fn diff(sandbox: &Sandbox) -> Result<(), Failed> {
    sandbox.write("ugly.vol", UGLY)?;
    let expected = "--- ugly.vol\n+++ ugly.vol\n@@ -1 +1 @@\n\
                    -object a{shape:sphere(1)}  // a ball\n+object a { shape: sphere(1) }  // a ball\n";
    equal(sandbox.vol("fmt --diff ugly.vol")?.expect(0, &[])?.stdout.as_str(), expected)?;
    equal(sandbox.vol("fmt --diff --check ugly.vol")?.expect(1, &[])?.stdout.as_str(), expected)?;
    equal(written(sandbox, "ugly.vol")?.as_str(), UGLY)?;
    sandbox.write("tidy.vol", TIDY)?;
    silent(&sandbox.vol("fmt --diff tidy.vol")?.expect(0, &[])?)?;
    sandbox.write("open.vol", TIDY.trim_end())?;
    let open = sandbox.vol("fmt --diff open.vol")?.expect(0, &[])?.stdout;
    equal(open.contains("\\ No newline at end of file"), true)
}

fn standard_input(sandbox: &Sandbox) -> Result<(), Failed> {
    equal(sandbox.vol_reading("fmt -", UGLY)?.expect(0, &[])?.stdout.as_str(), TIDY)?;
    equal(sandbox.vol_reading("fmt -", TIDY)?.expect(0, &[])?.stdout.as_str(), TIDY)?;
    let outcome = sandbox.vol_reading("fmt --check -", UGLY)?.expect(1, &[])?;
    equal(outcome.stdout.as_str(), "standard input\n")?;
    let outcome = sandbox.vol_reading("fmt -", "object a {")?.expect(1, &["error[E", "standard input:1"])?;
    equal(outcome.stdout.as_str(), "")
}

fn mistakes(sandbox: &Sandbox) -> Result<(), Failed> {
    let broken = "object a{shape:sphere(}\nlet b = \n";
    sandbox.write("broken.vol", broken)?;
    sandbox.write("ugly.vol", UGLY)?;
    sandbox.vol("fmt broken.vol ugly.vol")?.expect(1, &["error[E", "broken.vol:1", "broken.vol:2"])?;
    equal(written(sandbox, "broken.vol")?.as_str(), broken)?;
    equal(written(sandbox, "ugly.vol")?.as_str(), TIDY)?;
    // A scene with other mistakes is formatted: names are not the formatter's business.
    sandbox.write("names.vol", "object a{shape:sphre(b)}")?;
    silent(&sandbox.vol("fmt names.vol")?.expect(0, &[])?)?;
    equal(written(sandbox, "names.vol")?.as_str(), "object a { shape: sphre(b) }\n")?;
    let words = ["cannot read `missing.vol`", "broken.vol:1"];
    sandbox.vol("fmt broken.vol missing.vol ugly.vol")?.expect(2, &words)?;
    sandbox.vol("fmt .")?.expect(2, &["cannot read `.`: it is a folder"])?;
    sandbox.write("latin.vol", b"// caf\xe9\n")?;
    sandbox.vol("fmt latin.vol")?.expect(1, &["latin.vol", "not UTF-8"])?;
    sandbox.vol("fmt")?.expect(2, &["<SCENE>"]).map(drop)
}

fn line_ends(sandbox: &Sandbox) -> Result<(), Failed> {
    sandbox.write("dos.vol", TIDY.replace('\n', "\r\n"))?;
    sandbox.write("marked.vol", format!("\u{feff}{TIDY}"))?;
    sandbox.write("open.vol", TIDY.trim_end())?;
    sandbox.write("empty.vol", "")?;
    let outcome = sandbox.vol("fmt --check dos.vol marked.vol open.vol empty.vol")?.expect(1, &[])?;
    equal(outcome.stdout.as_str(), "dos.vol\nmarked.vol\nopen.vol\n")?;
    sandbox.vol("fmt dos.vol marked.vol open.vol empty.vol")?.expect(0, &[])?;
    for name in ["dos.vol", "marked.vol", "open.vol"] {
        equal(written(sandbox, name)?.as_str(), TIDY)?;
    }
    equal(written(sandbox, "empty.vol")?.as_str(), "")
}

fn examples(sandbox: &Sandbox) -> Result<(), Failed> {
    let scenes = scenes_in("examples").into_iter().chain(scenes_in("language/src/standard"));
    let paths: Vec<_> = scenes.map(|(_, path)| path).collect();
    equal(paths.len() > 4, true)?;
    let arguments = ["fmt", "--diff", "--check"].map(Into::into).into_iter().chain(paths);
    let outcome: Outcome =
        sandbox.command(arguments.map(std::path::PathBuf::into_os_string)).output()?.into();
    silent(&outcome.expect(0, &[])?)
}

#[cfg(unix)]
fn permissions(sandbox: &Sandbox) -> Result<(), Failed> {
    use std::os::unix::fs::{PermissionsExt as _, symlink};
    let path = sandbox.path("ugly.vol");
    sandbox.write("ugly.vol", UGLY)?;
    symlink(&path, sandbox.path("link.vol"))?;
    fs::set_permissions(&path, fs::Permissions::from_mode(0o600))?;
    sandbox.vol("fmt link.vol")?.expect(0, &[])?;
    equal(written(sandbox, "ugly.vol")?.as_str(), TIDY)?;
    equal(fs::metadata(&path)?.permissions().mode() & 0o777, 0o600)?;
    equal(fs::symlink_metadata(sandbox.path("link.vol"))?.is_symlink(), true)?;
    sandbox.write("ugly.vol", UGLY)?;
    fs::set_permissions(&path, fs::Permissions::from_mode(0o444))?;
    sandbox.vol("fmt ugly.vol")?.expect(2, &["cannot write `ugly.vol`: it is read-only"])?;
    equal(written(sandbox, "ugly.vol")?.as_str(), UGLY)
}
