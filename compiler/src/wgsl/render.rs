//! The whole shader of a program, and the numbers of a frame as its input.
//!
//! The text depends on the program alone: params, time and switches change only the words of
//! `vol_input`, so a pipeline is built once per scene. [`render_module`] puts together
//!
//! 1. a comment on the bindings and the words of `vol_input`,
//! 2. the prelude and the program's functions ([`super::functions`]),
//! 3. constants and functions that tell the integrator what there is (this file),
//! 4. the integrator, `render.wgsl` and its folder, the twin of `runtime-cpu/src/render`.
//!
//! | word | name | meaning |
//! |---|---|---|
//! | 0 | `AT_TILE` | the rectangle to render: x, y of its upper left pixel, width, height |
//! | 4 | `AT_SIZE` | width and height of the picture |
//! | 6 | `AT_STEP` | distance between nodes along camera rays |
//! | 7 | `AT_SHADOW_STEP` | distance between nodes along shadow rays |
//! | 8 | `AT_EYE` | origin of the camera, xyz |
//! | 11 | `AT_FORWARD` | unit vector into the picture, xyz |
//! | 14 | `AT_RIGHT` | to the right edge at distance 1, xyz |
//! | 17 | `AT_UP` | to the upper edge at distance 1, xyz |
//! | 20 | `AT_BACKGROUND` | rgb |
//! | 23 | `AT_LIGHT_COUNT` | number of lights |
//! | 24 | `AT_OBJECTS` | 8 words per object of the program: state (0 absent, 1 lit, 2 shows its normals), lo xyz, hi xyz, safe scale |
//! | 24 + 8 objects | `AT_MEDIA` | 8 words per medium of the program: state (0 absent, 1 lights do not matter, 2 unshadowed, 3 shadowed), lo xyz, hi xyz, 0 |
//! | after them | `AT_LIGHTS` | 8 words per light of the frame: distant, position or direction xyz, color rgb, shadows |
//!
//! All words are f32; whole numbers, below 2^24, are exact, and no word is a denormal that a device
//! might flush.

use super::WgslError;
use crate::frame::{Aabb, Frame, Image, Job, Pixel};
use crate::ir::FunctionId;
use crate::program::{Lighting, Program};
use std::fmt::Write;

/// The integrator.
const INTEGRATOR: [&str; 7] = [
    include_str!("render.wgsl"),
    include_str!("render/camera.wgsl"),
    include_str!("render/surface.wgsl"),
    include_str!("render/shade.wgsl"),
    include_str!("render/shadow.wgsl"),
    include_str!("render/comb.wgsl"),
    include_str!("render/medium.wgsl"),
];

/// Words before the objects.
const HEADER_WORDS: usize = 24;

/// Words of an object, of a medium and of a light.
const RECORD_WORDS: usize = 8;

/// Words of `vol_output` per pixel.
pub const PIXEL_WORDS: usize = 8;

/// Depth that stands for "no surface"; the shader writes 1e30.
const NO_DEPTH: f32 = 1e29;

/// Boxes end here on every axis: "infinite" for both backends.
const INFINITE: f32 = 1e6;

/// Places in the header, in words.
const HEADER: [(&str, usize); 10] = [
    ("AT_TILE", 0),
    ("AT_SIZE", 4),
    ("AT_STEP", 6),
    ("AT_SHADOW_STEP", 7),
    ("AT_EYE", 8),
    ("AT_FORWARD", 11),
    ("AT_RIGHT", 14),
    ("AT_UP", 17),
    ("AT_BACKGROUND", 20),
    ("AT_LIGHT_COUNT", 23),
];

const BINDINGS: &str = "\
// A vol scene as a compute shader. Entry point: render, workgroups of 8 x 8 over a rectangle.
//
// Bindings, all in group 0, all runtime-sized arrays:
//   0 vol_uniforms     numbers of the frame
//   1 vol_curves       curves of the frame
//   2 vol_permutation  table of the noise
//   3 vol_input        f32: the rectangle, the camera, what is there; see the constants AT_...
//   4 vol_output       f32: 8 words per pixel of the whole picture, rows from the top:
//                      radiance rgb, transmittance rgb, depth (1e30: none), 0
";

/// The complete shader of a program.
///
/// # Errors
///
/// If naga does not accept the text, which is a fault of this crate.
pub fn render_module(program: &Program) -> Result<String, WgslError> {
    let functions = super::functions(&program.module);
    let text = format!("{BINDINGS}\n{functions}\n{}\n{}", glue(program), INTEGRATOR.join("\n"));
    super::validate(&text)?;
    Ok(text)
}

/// Constants and functions that the integrator needs to know a program.
fn glue(program: &Program) -> String {
    let mut text =
        String::from("// ---- this program ------------------------------------------------------------\n\n");
    let (objects, media) = (program.objects.len(), program.media.len());
    let media_at = HEADER_WORDS + RECORD_WORDS * objects;
    let counts = [
        ("OBJECT_COUNT", objects),
        ("MEDIUM_COUNT", media),
        // Arrays cannot be empty.
        ("OBJECT_SLOTS", objects.max(1)),
        ("MEDIUM_SLOTS", media.max(1)),
        ("OBJECT_WORDS", RECORD_WORDS),
        ("MEDIUM_WORDS", RECORD_WORDS),
        ("LIGHT_WORDS", RECORD_WORDS),
        ("AT_OBJECTS", HEADER_WORDS),
        ("AT_MEDIA", media_at),
        ("AT_LIGHTS", media_at + RECORD_WORDS * media),
    ];
    for (name, value) in HEADER.iter().chain(&counts) {
        text += &format!("const {name}: u32 = {value}u;\n");
    }
    for pick in picks(program) {
        text += &pick.wgsl();
    }
    text
}

/// A function that picks the function of one object or medium by index.
struct Pick<'a> {
    signature: &'a str,
    /// Its result for an index out of range.
    otherwise: &'a str,
    /// Arguments passed on.
    arguments: &'a str,
    /// One function per index.
    functions: Vec<FunctionId>,
    /// What becomes of the result `v` of a function.
    result: &'a str,
}

impl Pick<'_> {
    fn wgsl(&self) -> String {
        let mut text = format!("\nfn {} {{\n    switch index {{\n", self.signature);
        for (index, function) in self.functions.iter().enumerate() {
            let call = format!("let v = vol_f{}({});", function.0, self.arguments);
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

fn picks(program: &Program) -> [Pick<'static>; 7] {
    let of_objects =
        |pick: fn(&crate::program::Object) -> FunctionId| program.objects.iter().map(pick).collect();
    let of_media = |pick: fn(&crate::program::Medium) -> FunctionId| program.media.iter().map(pick).collect();
    let point = |signature, otherwise, functions, result| Pick {
        signature,
        otherwise,
        arguments: "p.x, p.y, p.z",
        functions,
        result,
    };
    [
        point("object_distance(index: u32, p: vec3f) -> f32", "FAR", of_objects(|o| o.distance), "v"),
        point(
            "object_gradient(index: u32, p: vec3f) -> vec3f",
            "vec3f(0.0)",
            of_objects(|o| o.gradient),
            "v",
        ),
        point(
            "object_surface(index: u32, p: vec3f) -> Response",
            "Response(vec3f(0.0), vec3f(0.0), vec3f(0.0), 0.0)",
            of_objects(|o| o.surface),
            "Response(vec3f(v.v0, v.v1, v.v2), vec3f(v.v3, v.v4, v.v5), vec3f(v.v6, v.v7, v.v8), v.v9)",
        ),
        point("medium_region(index: u32, p: vec3f) -> f32", "FAR", of_media(|m| m.region), "v"),
        point(
            "medium_interior(index: u32, p: vec3f) -> Interior",
            "Interior(vec3f(0.0), vec3f(0.0), vec3f(0.0))",
            of_media(|m| m.interior),
            "Interior(vec3f(v.v0, v.v1, v.v2), vec3f(v.v3, v.v4, v.v5), vec3f(v.v6, v.v7, v.v8))",
        ),
        point(
            "medium_extinction(index: u32, p: vec3f) -> vec3f",
            "vec3f(0.0)",
            of_media(|m| m.extinction),
            "v",
        ),
        Pick {
            signature: "medium_phase(index: u32, less: f32, more: f32) -> f32",
            otherwise: "0.0",
            arguments: "less, more",
            functions: of_media(|m| m.phase),
            result: "v",
        },
    ]
}

/// A box as the runtimes use it: finite, and larger by what rounding may take off a ray's entry and
/// exit. `None` if it is empty.
#[must_use]
pub fn padded(bounds: &Aabb) -> Option<Aabb> {
    let finite = |corner: [f32; 3]| corner.map(|x| x.clamp(-INFINITE, INFINITE));
    if (0..3).any(|axis| bounds.lo[axis] > bounds.hi[axis]) {
        return None;
    }
    let (lo, hi) = (finite(bounds.lo), finite(bounds.hi));
    let size = lo.iter().chain(&hi).fold(0.0_f32, |size, x| size.max(x.abs()));
    let margin = 1e-5 * size;
    Some(Aabb { lo: lo.map(|x| x - margin), hi: hi.map(|x| x + margin) })
}

/// The contents of `vol_input`: a frame, a job, and the part of the picture to render
/// (`[x, y, width, height]` in pixels), laid out as the module's documentation says.
#[must_use]
pub fn frame_words(program: &Program, frame: &Frame, job: &Job, tile: [u32; 4]) -> Vec<u32> {
    let mut words = Vec::new();
    words.extend(tile.map(|x| x as f32));
    words.extend(job.size.map(|x| x as f32));
    words.extend([job.step, job.shadow_step]);
    let camera = &frame.camera;
    words.extend([camera.origin, camera.forward, camera.right, camera.up, frame.background].concat());
    words.push(frame.lights.len() as f32);
    // Records of all objects and media of the program; those that are not in the frame stay 0.
    let mut records = vec![[0.0; RECORD_WORDS]; program.objects.len() + program.media.len()];
    for object in &frame.objects {
        let state = if object.shows_normals { 2.0 } else { 1.0 };
        records[object.index] = record(state, padded(&object.bounds), object.safe_scale);
    }
    for medium in &frame.media {
        let state = match medium.lighting {
            Lighting::None => 1.0,
            Lighting::Unshadowed => 2.0,
            Lighting::Shadowed => 3.0,
        };
        records[program.objects.len() + medium.index] = record(state, padded(&medium.bounds), 0.0);
    }
    words.extend(records.concat());
    for light in &frame.lights {
        words.push(f32::from(u8::from(light.distant)));
        words.extend([light.position, light.color].concat());
        words.push(f32::from(u8::from(light.shadows)));
    }
    words.into_iter().map(f32::to_bits).collect()
}

/// State, box and one more number of an object or medium; nothing for an empty box.
fn record(state: f32, bounds: Option<Aabb>, last: f32) -> [f32; RECORD_WORDS] {
    let Some(Aabb { lo, hi }) = bounds else { return [0.0; RECORD_WORDS] };
    [state, lo[0], lo[1], lo[2], hi[0], hi[1], hi[2], last]
}

/// The contents of `vol_output` as a picture.
#[must_use]
pub fn unpack(width: u32, height: u32, words: &[u32]) -> Image {
    let pixel = |words: &[u32]| {
        let word = |index: usize| f32::from_bits(words[index]);
        Pixel {
            color: [word(0), word(1), word(2)],
            transmittance: [word(3), word(4), word(5)],
            depth: if word(6) < NO_DEPTH { word(6) } else { f32::INFINITY },
        }
    };
    Image { width, height, pixels: words.chunks_exact(PIXEL_WORDS).map(pixel).collect() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::{CameraFrame, LightFrame, MediumFrame, ObjectFrame};
    use crate::ir::text;
    use crate::program::{Camera, Extent, Medium, Object, Render, Slot};
    use vol_language::source::Span;

    const NOWHERE: Slot = Slot(0);

    /// Objects and media of constant functions.
    fn program(objects: usize, media: usize) -> Program {
        let function = |inputs: u32, outputs: usize| {
            let body = format!("fn f({inputs}) {{\n%0 = constant 0.5\nreturn{}\n}}", " %0".repeat(outputs));
            text::parse_function(&body).expect("well-formed text")
        };
        let mut module =
            text::parse_module("frame(1) {\n%0 = input 0\nreturn %0\n}").expect("well-formed text");
        module.functions = [(3, 1), (3, 3), (3, 10), (3, 9), (2, 1)].map(|(i, o)| function(i, o)).to_vec();
        let object = Object {
            name: "ball".to_owned(),
            distance: FunctionId(0),
            gradient: FunctionId(1),
            surface: FunctionId(2),
            shows_normals: false,
            extent: Extent::Unbounded,
            enabled: NOWHERE,
            span: Span::default(),
        };
        let medium = Medium {
            name: "gas".to_owned(),
            region: FunctionId(0),
            interior: FunctionId(3),
            extinction: FunctionId(1),
            phase: FunctionId(4),
            lighting: Lighting::Shadowed,
            extent: Extent::Unbounded,
            enabled: NOWHERE,
            span: Span::default(),
        };
        Program {
            module,
            params: Vec::new(),
            curves: Vec::new(),
            objects: vec![object; objects],
            media: vec![medium; media],
            lights: Vec::new(),
            camera: Camera { from: None, at: None, up: [NOWHERE; 3], fov: NOWHERE },
            render: Render {
                size: [4, 4],
                background: [NOWHERE; 3],
                ambient: [NOWHERE; 3],
                duration: NOWHERE,
                fps: NOWHERE,
            },
            fields: Vec::new(),
            report: Vec::new(),
        }
    }

    fn frame(program: &Program) -> Frame {
        let whole = Aabb { lo: [f32::NEG_INFINITY; 3], hi: [f32::INFINITY; 3] };
        let (object, medium) = (&program.objects[1], &program.media[0]);
        Frame {
            uniforms: vec![0.0],
            uniforms_f32: vec![0.0],
            curves: Vec::new(),
            curve_tables: Vec::new(),
            camera: CameraFrame {
                origin: [1.0, 2.0, 3.0],
                forward: [4.0, 5.0, 6.0],
                right: [7.0, 8.0, 9.0],
                up: [10.0, 11.0, 12.0],
            },
            objects: vec![ObjectFrame {
                index: 1,
                distance: object.distance,
                gradient: object.gradient,
                surface: object.surface,
                shows_normals: true,
                bounds: whole,
                safe_scale: 0.25,
            }],
            media: vec![MediumFrame {
                index: 0,
                region: medium.region,
                interior: medium.interior,
                extinction: medium.extinction,
                phase: medium.phase,
                lighting: Lighting::Unshadowed,
                bounds: Aabb { lo: [0.0; 3], hi: [0.0; 3] },
            }],
            lights: vec![LightFrame {
                distant: true,
                position: [0.0, 1.0, 0.0],
                color: [2.0; 3],
                shadows: true,
            }],
            background: [13.0, 14.0, 15.0],
            ambient: [0.0; 3],
            bounds: whole,
        }
    }

    #[test]
    fn modules_are_accepted() {
        for (objects, media) in [(0, 0), (1, 0), (0, 1), (3, 2)] {
            let text = render_module(&program(objects, media));
            assert!(text.is_ok_and(|text| text.contains("fn render(")), "{objects} objects, {media} media");
        }
    }

    #[test]
    fn words_stand_where_the_shader_looks() {
        let program = program(2, 1);
        let job = Job { size: [40, 30], step: 0.1, shadow_step: 0.2 };
        let words = frame_words(&program, &frame(&program), &job, [8, 16, 24, 32]);
        let words: Vec<f32> = words.into_iter().map(f32::from_bits).collect();
        assert_eq!(words[..8], [8.0, 16.0, 24.0, 32.0, 40.0, 30.0, 0.1, 0.2]);
        assert_eq!(words[8..24], [1., 2., 3., 4., 5., 6., 7., 8., 9., 10., 11., 12., 13., 14., 15., 1.]);
        let text = glue(&program);
        let place = |name: &str| -> usize {
            let line = text.lines().find_map(|line| line.strip_prefix(&format!("const {name}: u32 = ")));
            line.and_then(|line| line.strip_suffix("u;")?.parse().ok()).expect("a constant of the glue")
        };
        assert_eq!(place("AT_OBJECTS"), 24);
        let (objects, media, lights) = (place("AT_OBJECTS"), place("AT_MEDIA"), place("AT_LIGHTS"));
        assert_eq!(words[objects..objects + 8], [0.0; 8], "an absent object");
        let (lo, hi) = (-INFINITE * 1.00001, INFINITE * 1.00001);
        assert_eq!(words[objects + 8..media], [2.0, lo, lo, lo, hi, hi, hi, 0.25]);
        assert_eq!(words[media..lights], [2.0, 0., 0., 0., 0., 0., 0., 0.]);
        assert_eq!(words[lights..], [1.0, 0.0, 1.0, 0.0, 2.0, 2.0, 2.0, 1.0]);
    }

    #[test]
    fn empty_boxes_are_nothing() {
        assert_eq!(padded(&Aabb { lo: [0.0, 1.0, 0.0], hi: [1.0, 0.0, 1.0] }), None);
        let grown = padded(&Aabb { lo: [0.0; 3], hi: [1.0, 2.0, 4.0] }).expect("not empty");
        assert!(grown.lo.iter().all(|&x| x < 0.0 && x > -1e-4) && grown.hi[2] > 4.0);
    }

    #[test]
    fn depth_without_a_surface_is_infinite() {
        let words = [1.0, 2.0, 3.0, 0.5, 0.25, 0.125, 1e30, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 7.0, 0.0_f32];
        let image = unpack(2, 1, &words.map(f32::to_bits));
        assert_eq!(image.pixels[0].depth, f32::INFINITY);
        assert_eq!(image.pixels[0].transmittance, [0.5, 0.25, 0.125]);
        assert_eq!(image.pixels[1].depth, 7.0);
    }
}
