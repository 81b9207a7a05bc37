//! Functions of a scene for other shaders to call.

use super::{Source, prefix, translate};
use crate::frame::Frame;
use crate::program::Program;
use crate::wgsl::render::library_text;
use crate::wgsl::{self, WgslError, names};
use std::collections::HashSet;
use std::fmt::Write as _;

/// A function of a library for a caller.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Entry {
    /// Its name behind the prefix and an underscore.
    pub name: String,
    /// Its parameters and result in WGSL, for example `(p: vec3f) -> f32`.
    pub signature: String,
    /// What it gives, one sentence.
    pub meaning: String,
    /// The field that it is, by its index in the program.
    pub field: Option<usize>,
    /// What it does, as statements.
    body: String,
}

/// The functions of a library, those of single fields last.
#[must_use]
pub fn entries(program: &Program, frame: &Frame) -> Vec<Entry> {
    let mut all = whole_scene(program, frame);
    let mut taken: HashSet<String> = all.iter().map(|entry| entry.name.clone()).collect();
    for (index, field) in program.fields.iter().enumerate() {
        let function = program.module.function(field.function);
        let outputs = function.outputs.len();
        if outputs > 4 {
            continue;
        }
        let name = free_name(&field.name, &mut taken);
        let callee = names::function(field.function.index(), &function.name);
        all.push(Entry {
            name,
            signature: format!("(p: vec3f) -> {}", names::output_type(outputs)),
            meaning: format!("The field `{}` of the scene.", field.name),
            field: Some(index),
            body: format!("return {callee}(p.x, p.y, p.z);"),
        });
    }
    all
}

/// What a field is called: `density:cloud` is `density_cloud`, a function `wave` of the scene `field_wave`, since the bare name
/// may be one of ours. A name that ends in a digit gets an underscore: naga gives it one in some languages.
fn free_name(field: &str, taken: &mut HashSet<String>) -> String {
    let word = names::function_word(field);
    let word = if field.contains(':') { word } else { format!("field_{word}") };
    let spelled = |word: String| if word.ends_with(|c: char| c.is_ascii_digit()) { word + "_" } else { word };
    let copies = (2..).map(|copy| spelled(format!("{word}_{copy}")));
    let mut names = std::iter::once(spelled(word.clone())).chain(copies);
    // There are more numbers than fields.
    names.find(|name| taken.insert(name.clone())).unwrap_or(word)
}

fn whole_scene(program: &Program, frame: &Frame) -> Vec<Entry> {
    let mut distance = "var nearest: f32 = FAR;\n".to_owned();
    for object in &frame.objects {
        let _ = writeln!(distance, "    nearest = min(nearest, object_distance({}u, p));", object.index);
    }
    let mut density = "var sum: f32 = 0.0;\n".to_owned();
    for medium in &frame.media {
        let name = format!("density:{}", program.media[medium.index].name);
        if let Some(field) = program.fields.iter().find(|field| field.name == name) {
            let function = &program.module.function(field.function).name;
            let callee = names::function(field.function.index(), function);
            let _ = writeln!(density, "    sum += max({callee}(p.x, p.y, p.z), 0.0);");
        }
    }
    let entry = |name: &str, signature: &str, meaning: &str, body: String| Entry {
        name: name.to_owned(),
        signature: signature.to_owned(),
        meaning: meaning.to_owned(),
        field: None,
        body,
    };
    let clear = "let clear = ((t.x + t.y) + t.z) * (1.0f / 3.0f);";
    vec![
        entry(
            "distance",
            "(p: vec3f) -> f32",
            "Bound on the distance to the nearest object, negative inside, scene units.",
            format!("{distance}    return nearest;"),
        ),
        entry(
            "density",
            "(p: vec3f) -> f32",
            "Sum of the densities of all media.",
            format!("{density}    return sum;"),
        ),
        entry(
            "radiance",
            "(origin: vec3f, direction: vec3f) -> vec4f",
            "Scene-linear radiance along a ray from the camera or another place outside the objects, and what it hides of what is behind.",
            format!(
                "let found = radiance(new_ray(origin, direction / length3(direction)));\n    \
                 let t = found.transmittance;\n    {clear}\n    return vec4f(found.color, 1.0 - clear);"
            ),
        ),
        entry(
            "pixel",
            "(place: vec2f) -> vec4f",
            "The same through a place of the picture, in pixels from its upper left corner.",
            format!(
                "let found = radiance(camera_ray(place));\n    let t = found.transmittance;\n    {clear}\n    \
                 return vec4f(found.color, 1.0 - clear);"
            ),
        ),
    ]
}

/// The library as WGSL.
pub(super) fn wgsl(source: &Source<'_>) -> Result<String, WgslError> {
    written(source, "var<private>")
}

/// The library as WGSL that is to be translated further.
pub(super) fn constant(source: &Source<'_>) -> Result<String, WgslError> {
    written(source, "const")
}

fn written(source: &Source<'_>, keyword: &str) -> Result<String, WgslError> {
    let text = prefix::prefixed(&plain(source, keyword), source.prefix);
    wgsl::validate(&text)?;
    Ok(text)
}

/// The library as WGSL with an entry point that calls all that a caller may: translators leave out what nothing calls.
pub(super) fn kept(source: &Source<'_>) -> Result<String, WgslError> {
    let mut text = constant(source)?;
    text += "@fragment\nfn main_entry(@builtin(position) place: vec4f) -> @location(0) vec4f {\n  var sum = vec4f(0.0);\n";
    for entry in entries(source.program, source.frame) {
        let arguments = match entry.signature.matches(": vec").count() {
            2 => "place.xyz, place.xyz",
            _ if entry.signature.contains("vec2f)") => "place.xy",
            _ => "place.xyz",
        };
        let call = format!("{}_{}({arguments})", source.prefix, entry.name);
        let widened = match entry.signature.rsplit("-> ").next() {
            Some("vec2f") => format!("vec4f({call}, 0.0, 0.0)"),
            Some("vec3f") => format!("vec4f({call}, 0.0)"),
            Some("vec4f") => call,
            Some(_) | None => format!("vec4f({call})"),
        };
        let _ = writeln!(text, "  sum += {widened};");
    }
    text += "  return sum;\n}\n";
    wgsl::validate(&text)?;
    Ok(text)
}

fn plain(source: &Source<'_>, keyword: &str) -> String {
    let mut text = library_text(source.program, source.frame, source.job, source.notes, keyword);
    text += "\n// ---- to be called -------------------------------------------------------------\n";
    for Entry { name, signature, meaning, body, .. } in entries(source.program, source.frame) {
        let _ = write!(text, "\n// {meaning}\nfn vol_{name}{signature} {{\n    {body}\n}}\n");
    }
    text
}

/// The library in GLSL with a `mainImage`.
pub(super) fn shadertoy(source: &Source<'_>) -> Result<String, WgslError> {
    let library = translate::shadertoy_library(&kept(source)?)?;
    let ([width, height], prefix) = (source.job.size, source.prefix);
    Ok(format!(
        "{library}\n\
         void mainImage(out vec4 color, in vec2 place) {{\n    \
             // The scene's picture as large as it fits, its rows from the top.\n    \
             vec2 size = vec2({width}.0, {height}.0);\n    \
             float scale = min(iResolution.x / size.x, iResolution.y / size.y);\n    \
             vec2 away = (place - 0.5 * iResolution.xy) / scale;\n    \
             vec3 linear = {prefix}_pixel(0.5 * size + vec2(away.x, -away.y)).rgb;\n    \
             // sRGB.\n    \
             vec3 high = 1.055 * pow(max(linear, vec3(0.0031308)), vec3(1.0 / 2.4)) - 0.055;\n    \
             color = vec4(mix(high, 12.92 * linear, vec3(lessThan(linear, vec3(0.0031308)))), 1.0);\n\
         }}\n"
    ))
}
