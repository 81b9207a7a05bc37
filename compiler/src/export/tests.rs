use super::*;
use crate::frame::{Quadrature, Sampling};

const JOB: Job = Job {
    size: [8, 8],
    step: 0.1,
    shadow_step: 0.1,
    quadrature: Quadrature::Midpoint,
    sampling: Sampling::CENTRE,
};

fn exported(language: Language, form: Form) -> Result<String, ExportError> {
    exported_scene("object ball { shape: sphere(1) }", language, form)
}

fn exported_scene(text: &str, language: Language, form: Form) -> Result<String, ExportError> {
    let file = vol_language::source::SourceFile::new("ball.vol", text);
    let (scene, _) = vol_language::analyse(&file, &crate::library::library());
    let program = crate::lower::compile(&scene.expect("a scene")).0.expect("a program");
    let frame = program.frame(&program.default_params(), 0.0, 0.0, JOB.size).expect("a frame");
    let nothing = |_| None;
    let notes = Notes::new(&program, &nothing);
    let title = ["ball.vol".to_owned()];
    let source =
        Source { program: &program, frame: &frame, job: &JOB, notes: &notes, title: &title, prefix: "sky" };
    export(&source, language, form).map(|bytes| String::from_utf8(bytes).expect("text"))
}

#[test]
fn libraries_have_neither_bindings_nor_entry_points() {
    for language in [Language::Wgsl, Language::Glsl, Language::Hlsl, Language::Msl] {
        let text = exported(language, Form::Library).expect("it can be said");
        assert!(text.contains("sky_distance_ball") && text.contains("sky_radiance"), "{language:?}");
        for word in [
            "@group",
            "@compute",
            "@fragment",
            "main_entry",
            "uniform ",
            "register(",
            "[[buffer",
            "layout(location",
            "void main(",
        ] {
            assert!(!text.contains(word), "{language:?} has `{word}`");
        }
    }
}

#[test]
fn the_version_stays_first() {
    let text = exported(Language::Glsl, Form::Module).expect("it can be said");
    assert!(text.starts_with("#version 310 es\n// ball.vol\n"));
    assert_eq!(text.matches("#version").count(), 1);
    assert!(exported(Language::Wgsl, Form::Module).expect("it can be said").starts_with("// ball.vol\n"));
}

#[test]
fn some_forms_do_not_exist() {
    for (language, form) in [(Language::Spirv, Form::Library), (Language::Shadertoy, Form::Module)] {
        assert!(matches!(exported(language, form), Err(ExportError::NoSuchForm(_))));
    }
}

/// Names of scenes that are also ours, that end in digits, and that are the same without their signs.
#[test]
fn names_do_not_clash() {
    let scene = "fn fade(p: vec3) -> float { p.x }\nfn hold(p: vec3) -> float { p.y + fade(p) }\nobject ball2 { shape: sphere(1) }\n\
        object radiance { shape: box((1, 1, 1)) }\nmedium _fog_ { region: sphere(2), density: 1 }\n\
        medium fog { region: sphere(2), density: 1 }";
    for language in [Language::Wgsl, Language::Glsl, Language::Hlsl, Language::Msl, Language::Shadertoy] {
        let text = exported_scene(scene, language, Form::Library).expect("it can be said");
        for name in [
            "field_fade",
            "field_hold",
            "distance_ball2_",
            "distance_radiance",
            "density_fog",
            "density_fog_2_",
        ] {
            assert!(text.contains(&format!("sky_{name}(")), "{language:?} has no {name}");
        }
    }
}
