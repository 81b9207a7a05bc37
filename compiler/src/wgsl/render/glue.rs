//! Constants and functions that tell the integrator what a program has.

use super::styles;
use super::words::{
    CELL_WORDS, CELLS_WORDS, HEADER, HEADER_WORDS, LIGHT_WORDS, MEDIUM_WORDS, OBJECT_WORDS, PIXEL_WORDS,
    Places,
};
use crate::families::Families;
use crate::frame::Quadrature;
use crate::frame::styled::TRANSFER_SIZE;
use crate::ir::FunctionId;
use crate::program::style::Shafts;
use crate::program::{Lighting, Program};
use crate::wgsl::names;
use std::collections::{BTreeMap, BTreeSet};
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
        ("ROW_WORDS", Families::of(program).row),
    ];
    for (name, value) in HEADER.iter().chain(&counts) {
        text += &format!("const {name}: u32 = {value}u;\n");
    }
    // What no light asks for is left out by the device's compiler.
    let lights = &program.lights;
    let switches = [
        ("CORRECTED", quadrature == Quadrature::Corrected),
        ("SPACED", quadrature == Quadrature::Midpoint && media > 1),
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
    text += &joins(program);
    all_picks(program).for_each(|pick| text += &pick.wgsl(program));
    text
}

/// The functions of a program that pictures call.
pub(super) fn called(program: &Program) -> BTreeSet<FunctionId> {
    all_picks(program).flat_map(|pick| pick.functions.into_iter().flatten()).collect()
}

fn all_picks(program: &Program) -> impl Iterator<Item = Pick<'static>> {
    let fields = (!program.styles.is_empty()).then(|| styles::fields(program));
    picks(program).into_iter().chain(fields)
}

/// A function that tells whether an object is a part of the same solid as the one before it.
fn joins(program: &Program) -> String {
    let is_further = |object: usize| program.objects.get(object).is_some_and(|own| own.whole != object);
    let objects = 0..program.objects.len();
    let starts = objects.clone().filter(|&object| is_further(object) && !is_further(object - 1));
    let ends = objects.filter(|&object| is_further(object) && !is_further(object + 1));
    let runs: Vec<String> =
        starts.zip(ends).map(|(start, end)| format!("((object >= {start}u) & (object <= {end}u))")).collect();
    let any = if runs.is_empty() { "false".to_owned() } else { runs.join(" | ") };
    format!("\nfn joins_the_one_before(object: u32) -> bool {{\n    return {any};\n}}\n")
}

/// What is called for an object or medium.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Callee {
    /// Its own function.
    Function(FunctionId),
    /// The family that this is in, by its number.
    Family(usize),
}

/// A call of a family with the numbers of object `index`.
fn family_call(program: &Program, families: &Families, number: usize, arguments: &str) -> String {
    let family = &families.all[number];
    let name = names::function(crate::wgsl::family_index(program, number), &family.function.name);
    let numbers = (0..family.numbers).map(|word| format!("vol_input_word(row + {word}u)"));
    let arguments: Vec<String> = std::iter::once(arguments.to_owned()).chain(numbers).collect();
    format!(
        "let row = (ROW_WORDS * index) + {}u;\n            let v = {name}({});",
        family.at,
        arguments.join(", ")
    )
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
    /// What is called, with its indices: drivers write a function out wherever it is called, so each is called once.
    fn by_callee(&self, families: &Families) -> BTreeMap<Callee, Vec<usize>> {
        let mut all = BTreeMap::<Callee, Vec<usize>>::new();
        for (index, function) in self.functions.iter().enumerate() {
            let Some(function) = *function else { continue };
            let callee = families.number_of(function).map_or(Callee::Function(function), Callee::Family);
            all.entry(callee).or_default().push(index);
        }
        all
    }

    pub(super) fn wgsl(&self, program: &Program) -> String {
        let mut text = format!("\nfn {} {{\n", self.signature);
        for counter in self.counters {
            let _ = writeln!(text, "    {counter} += 1u;");
        }
        text += "    switch index {\n";
        let families = Families::of(program);
        for (function, indices) in self.by_callee(&families) {
            let call = match function {
                Callee::Function(id) => {
                    let name = names::function(id.index(), &program.module.function(id).name);
                    format!("let v = {name}({});", self.arguments)
                }
                Callee::Family(number) => family_call(program, &families, number, self.arguments),
            };
            let indices: Vec<String> = indices.iter().map(|index| format!("{index}u")).collect();
            let _ = writeln!(
                text,
                "        case {}: {{\n            {call}\n            return {};\n        }}",
                indices.join(", "),
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
