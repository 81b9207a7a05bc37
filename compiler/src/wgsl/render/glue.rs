//! Constants and functions that tell the integrator what a program has.

use super::styles;
use super::words::{
    CELL_WORDS, CELLS_WORDS, HEADER, HEADER_WORDS, LIGHT_WORDS, MEDIUM_WORDS, OBJECT_WORDS, PIXEL_WORDS,
    Places,
};
use crate::frame::Quadrature;
use crate::frame::styled::TRANSFER_SIZE;
use crate::ir::FunctionId;
use crate::program::style::Shafts;
use crate::program::{Lighting, Program};
use crate::wgsl::names;
use std::fmt::Write;

/// Constants and functions that the integrator needs to know a program.
pub(super) fn glue(program: &Program, quadrature: Quadrature) -> String {
    let mut text =
        String::from("// ---- this program ------------------------------------------------------------\n\n");
    let (objects, media) = (program.objects.len(), program.media.len());
    let places = Places::of(program);
    let counts = [
        ("OBJECT_COUNT", objects),
        ("MEDIUM_COUNT", media),
        // Arrays cannot be empty.
        ("OBJECT_SLOTS", objects.max(1)),
        ("MEDIUM_SLOTS", media.max(1)),
        ("LIGHT_SLOTS", program.lights.len().max(1)),
        ("TRANSFER_SIZE", TRANSFER_SIZE as usize),
        ("OBJECT_WORDS", OBJECT_WORDS),
        ("MEDIUM_WORDS", MEDIUM_WORDS),
        ("CELL_WORDS", CELL_WORDS),
        ("CELLS_WORDS", CELLS_WORDS),
        ("LIGHT_WORDS", LIGHT_WORDS),
        ("PIXEL_WORDS", PIXEL_WORDS),
        ("AT_OBJECTS", HEADER_WORDS),
        ("AT_MEDIA", places.media),
        ("AT_LIGHTS", places.lights),
        ("AT_CELLS", places.cells),
    ];
    for (name, value) in HEADER.iter().chain(&counts) {
        text += &format!("const {name}: u32 = {value}u;\n");
    }
    // What no light asks for, and the other quadrature, is left out by the device's compiler.
    let lights = &program.lights;
    let switches = [
        ("CORRECTED", quadrature == Quadrature::Corrected),
        ("SOFT_LIGHTS", lights.iter().any(|light| light.size.is_some())),
        ("OCCLUDING_LIGHTS", lights.iter().any(|light| light.occlusion.is_some())),
        ("LIGHT_GRIDS", media > 0 && !lights.is_empty()),
        (
            "LIT_MEDIA",
            !lights.is_empty() && program.media.iter().any(|medium| medium.lighting != Lighting::None),
        ),
        ("STYLES", !program.styles.is_empty()),
        ("MARCHED_SHAFTS", program.styles.iter().any(|style| style.shafts == Shafts::Exact)),
    ];
    for (name, value) in switches {
        text += &format!("const {name}: bool = {value};\n");
    }
    for pick in picks(program) {
        text += &pick.wgsl(program);
    }
    if !program.styles.is_empty() {
        text += &styles::fields(program).wgsl(program);
    }
    text
}

/// A function that picks the function of one object or medium by index.
pub(super) struct Pick<'a> {
    pub(super) signature: &'a str,
    /// Its result for an index out of range.
    pub(super) otherwise: &'a str,
    /// Arguments passed on.
    pub(super) arguments: &'a str,
    /// One function per index; where there is none the result is that for an index out of range.
    pub(super) functions: Vec<Option<FunctionId>>,
    /// What becomes of the result `v` of a function.
    pub(super) result: &'a str,
    /// Private variables that count the calls.
    pub(super) counters: &'a [&'a str],
}

impl Pick<'_> {
    pub(super) fn wgsl(&self, program: &Program) -> String {
        let mut text = format!("\nfn {} {{\n", self.signature);
        for counter in self.counters {
            let _ = writeln!(text, "    {counter} += 1u;");
        }
        text += "    switch index {\n";
        for (index, function) in self.functions.iter().enumerate() {
            let Some(function) = function else { continue };
            let name = names::function(function.index(), &program.module.function(*function).name);
            let call = format!("let v = {name}({});", self.arguments);
            let _ = writeln!(
                text,
                "        case {index}u: {{\n            {call}\n            return {};\n        }}",
                self.result
            );
        }
        let _ = writeln!(
            text,
            "        default: {{\n            return {};\n        }}\n    }}\n}}",
            self.otherwise
        );
        text
    }
}

fn picks(program: &Program) -> [Pick<'static>; 8] {
    let of_objects =
        |pick: fn(&crate::program::Object) -> Option<FunctionId>| program.objects.iter().map(pick).collect();
    let of_media =
        |pick: fn(&crate::program::Medium) -> FunctionId| program.media.iter().map(pick).map(Some).collect();
    let point = |signature, otherwise, functions, result, counters| Pick {
        signature,
        otherwise,
        arguments: "p.x, p.y, p.z",
        functions,
        result,
        counters,
    };
    const SEARCH: &[&str] = &["counted_evaluations"];
    const SAMPLE: &[&str] = &["counted_evaluations", "counted_samples"];
    [
        point(
            "object_distance(index: u32, p: vec3f) -> f32",
            "FAR",
            of_objects(|o| Some(o.distance)),
            "v",
            SEARCH,
        ),
        point(
            "object_gradient(index: u32, p: vec3f) -> vec3f",
            "vec3f(0.0)",
            of_objects(|o| Some(o.gradient)),
            "v",
            SEARCH,
        ),
        Pick {
            signature: "object_steepness(index: u32, lo: vec3f, hi: vec3f) -> f32",
            otherwise: "1.0",
            arguments: "lo.x, lo.y, lo.z, hi.x, hi.y, hi.z",
            functions: of_objects(|o| o.steepness),
            result: "v",
            counters: SEARCH,
        },
        point(
            "object_surface(index: u32, p: vec3f) -> Response",
            "Response(vec3f(0.0), vec3f(0.0), vec3f(0.0), 0.0)",
            of_objects(|o| Some(o.surface)),
            "Response(vec3f(v.v0, v.v1, v.v2), vec3f(v.v3, v.v4, v.v5), vec3f(v.v6, v.v7, v.v8), v.v9)",
            &[],
        ),
        point("medium_region(index: u32, p: vec3f) -> f32", "FAR", of_media(|m| m.region), "v", SEARCH),
        point(
            "medium_interior(index: u32, p: vec3f) -> Interior",
            "Interior(0.0, vec3f(0.0), vec3f(0.0), vec3f(0.0))",
            of_media(|m| m.interior),
            "Interior(v.v0, vec3f(v.v1, v.v2, v.v3), vec3f(v.v4, v.v5, v.v6), vec3f(v.v7, v.v8, v.v9))",
            SAMPLE,
        ),
        point(
            "medium_extinction(index: u32, p: vec3f) -> vec4f",
            "vec4f(0.0)",
            of_media(|m| m.extinction),
            "v",
            SAMPLE,
        ),
        Pick {
            signature: "medium_phase(index: u32, less: f32, more: f32) -> f32",
            otherwise: "0.0",
            arguments: "less, more",
            functions: of_media(|m| m.phase),
            result: "v",
            counters: &[],
        },
    ]
}
