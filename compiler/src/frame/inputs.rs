//! What a result depends on of a frame, as words to compare: equal words, equal results.
//!
//! In: a program, one of its frames, and what is computed from it. Out: [`Inputs`], the bits of all that the
//! computation reads. Of the uniforms and curves those count that its functions read: a frame in which only
//! a param has moved that reaches nothing is the same as before. Numbers are compared by their bits, since `-0.0`
//! and `0.0` may lead to different pictures.

use super::{Aabb, CameraFrame, Frame, LightFrame, MediumFrame, ObjectFrame, Stride};
use crate::ir::{Function, FunctionId, Inst};
use crate::program::Program;
use std::collections::BTreeSet;

/// The bits that something was computed from.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Inputs(Vec<u64>);

impl Inputs {
    /// Of the picture of a frame, whatever the job. Grids of lights and what styles make of lights do not count: they come
    /// from the rest.
    #[must_use]
    pub fn of_picture(program: &Program, frame: &Frame) -> Self {
        let Frame {
            uniforms: _,
            uniforms_f32: _,
            curves: _,
            curve_tables: _,
            camera,
            objects,
            media,
            lights,
            light_grids: _,
            styles,
            styled_lights: _,
            background,
            bounds,
            skips,
        } = frame;
        let mut inputs = Self::default();
        inputs.read_by(frame, &Reads::of(program, picture_functions(program)));
        inputs.camera(camera);
        inputs.whole(objects.len() as u64);
        objects.iter().for_each(|object| inputs.object(object));
        inputs.whole(media.len() as u64);
        media.iter().for_each(|medium| inputs.medium(medium));
        inputs.whole(lights.len() as u64);
        lights.iter().for_each(|light| inputs.light(light));
        inputs.text(&format!("{styles:?}"));
        inputs.numbers(background);
        inputs.aabb(bounds);
        inputs.whole(skips.bits().into());
        inputs
    }

    /// Of optical depths through the media of a frame.
    #[must_use]
    pub fn of_depths(program: &Program, frame: &Frame) -> Self {
        let functions = frame.media.iter().flat_map(|medium| [medium.region, medium.extinction]);
        let mut inputs = Self::default();
        inputs.read_by(frame, &Reads::of(program, functions));
        frame.media.iter().for_each(|medium| inputs.medium(medium));
        inputs.whole(frame.skips.bits().into());
        inputs
    }

    fn whole(&mut self, number: u64) {
        self.0.push(number);
    }

    /// A text that tells all numbers apart, as the debug form of plain data does.
    fn text(&mut self, text: &str) {
        self.whole(text.len() as u64);
        self.0.extend(text.bytes().map(u64::from));
    }

    fn numbers(&mut self, numbers: &[f32]) {
        self.0.extend(numbers.iter().map(|number| u64::from(number.to_bits())));
    }

    fn doubles<'a>(&mut self, numbers: impl IntoIterator<Item = &'a f64>) {
        self.0.extend(numbers.into_iter().map(|number| number.to_bits()));
    }

    fn aabb(&mut self, bounds: &Aabb) {
        self.numbers(&bounds.lo);
        self.numbers(&bounds.hi);
    }

    /// What functions read beside their arguments, in the precision that all others come from.
    fn read_by(&mut self, frame: &Frame, reads: &Reads) {
        self.doubles(reads.uniforms.iter().map(|&index| &frame.uniforms[index as usize]));
        for &curve in &reads.curves {
            let segments = &frame.curves[curve as usize];
            self.whole(segments.len() as u64);
            let points = segments.iter().flat_map(|segment| [&segment.a, &segment.b, &segment.c]);
            self.doubles(points.flatten());
        }
    }

    fn camera(&mut self, camera: &CameraFrame) {
        let CameraFrame { origin, forward, right, up } = camera;
        [origin, forward, right, up].into_iter().for_each(|vector| self.numbers(vector));
    }

    fn object(&mut self, object: &ObjectFrame) {
        let ObjectFrame { index, whole, distance, gradient, surface, shows_normals, bounds, stride } = object;
        [distance, gradient, surface].into_iter().for_each(|function| self.whole(function.0.into()));
        self.whole(*index as u64);
        self.whole(*whole as u64);
        self.whole(u64::from(*shows_normals));
        self.aabb(bounds);
        match stride {
            Stride::Scale(scale) => self.numbers(&[0.0, *scale]),
            Stride::Within(function) => {
                self.numbers(&[1.0]);
                self.whole(function.0.into());
            }
        }
    }

    fn medium(&mut self, medium: &MediumFrame) {
        let MediumFrame { index, region, interior, extinction, phase, lighting, bounds, cells, spacing: _ } =
            medium;
        let functions = [region, interior, extinction, phase];
        functions.into_iter().for_each(|function| self.whole(function.0.into()));
        self.whole(*index as u64);
        self.whole(*lighting as u64);
        self.aabb(bounds);
        self.whole(cells.len() as u64);
        cells.iter().for_each(|cell| self.aabb(cell));
    }

    fn light(&mut self, light: &LightFrame) {
        let LightFrame { distant, position, color, shadows, size, occlusion } = light;
        self.whole(u64::from(*distant));
        self.whole(u64::from(*shadows));
        self.numbers(position);
        self.numbers(color);
        self.numbers(&[*size, *occlusion]);
    }
}

/// Functions that a picture may call: all but those that can only be asked for by name.
fn picture_functions(program: &Program) -> impl Iterator<Item = FunctionId> {
    let objects =
        program.objects.iter().flat_map(|object| [object.distance, object.gradient, object.surface]);
    let media = program.media.iter();
    let media = media.flat_map(|medium| [medium.region, medium.interior, medium.extinction, medium.phase]);
    let named: BTreeSet<FunctionId> = program.fields.iter().map(|field| field.function).collect();
    let styles = program.styles.iter().filter_map(|style| Some(style.heterogeneity?.field));
    let used: BTreeSet<FunctionId> = objects.chain(media).chain(styles).collect();
    let all = (0..program.module.functions.len() as u32).map(FunctionId);
    all.filter(move |function| used.contains(function) || !named.contains(function))
}

/// Uniforms and curves that functions read, in order.
struct Reads {
    uniforms: BTreeSet<u32>,
    curves: BTreeSet<u32>,
}

impl Reads {
    fn of(program: &Program, functions: impl IntoIterator<Item = FunctionId>) -> Self {
        let mut reads = Self { uniforms: BTreeSet::new(), curves: BTreeSet::new() };
        functions.into_iter().for_each(|id| reads.add(program.module.function(id)));
        reads
    }

    fn add(&mut self, function: &Function) {
        for inst in &function.insts {
            match inst {
                Inst::Uniform(index) => {
                    self.uniforms.insert(*index);
                }
                Inst::Apply { op, data, .. } if op.reads_curve() => {
                    self.curves.insert(*data);
                }
                Inst::Loop { body, .. } => self.add(body),
                Inst::Constant(_)
                | Inst::Boolean(_)
                | Inst::Input(_)
                | Inst::Apply { .. }
                | Inst::Extract(..) => {}
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::skip::Skips;
    use vol_language::source::SourceFile;

    const SCENE: &str = "\
param spin: float = 1
param unused: float = 1
param dense: float = 1
fn asked(p: vec3) -> float { p.x * time + unused }
object ball { shape: sphere(1).translate((0, 0.5 * floor(time), 0)) }
medium gas { region: tube(bezier((-1, 0, 0), (0, 1, spin), (1, 0, 0)), 0.1), density: q => 2 + dense * q.local.x }
light sun { from: (1, 1, 1), color: spin }
camera { from: (0, 0, 5 + 0.25 * floor(0.5 * time)) }
";

    fn compile() -> Program {
        let file = SourceFile::new("scene.vol", SCENE);
        let (scene, diagnostics) = vol_language::analyse(&file, &crate::library::library());
        assert!(diagnostics.is_empty(), "{diagnostics:?}");
        crate::lower::compile(&scene.expect("a scene")).0.expect("a program")
    }

    fn frame(program: &Program, spin: f64, unused: f64, time: f64) -> Frame {
        denser(program, [spin, unused, 1.0], time)
    }

    fn denser(program: &Program, params: [f64; 3], time: f64) -> Frame {
        let params = params.map(|param| vec![param]);
        program.frame(&params, time, 7.0 * time, [8, 8]).expect("a frame")
    }

    /// A number that functions read and that is nowhere else in a frame.
    #[test]
    fn uniforms_count() {
        let program = compile();
        let frames = [1.0, 2.0].map(|dense| denser(&program, [1.0, 1.0, dense], 0.0));
        let [a, b] = frames.each_ref().map(|frame| Inputs::of_picture(&program, frame));
        assert_ne!(a, b);
        let [a, b] = frames.each_ref().map(|frame| Inputs::of_depths(&program, frame));
        assert_ne!(a, b);
    }

    #[test]
    fn pictures_depend_on_what_is_read() {
        let program = compile();
        let inputs = |spin, unused, time| Inputs::of_picture(&program, &frame(&program, spin, unused, time));
        let still = inputs(1.0, 1.0, 0.0);
        assert_eq!(still, inputs(1.0, 2.0, 0.75), "only what is asked for by name changes");
        assert_ne!(still, inputs(1.0, 1.0, 1.0), "the ball moves");
        assert_ne!(still, inputs(0.5, 1.0, 0.0), "the curve and the light change");
        assert_ne!(inputs(0.0, 1.0, 0.0), inputs(-0.0, 1.0, 0.0), "-0 is not 0");
    }

    #[test]
    fn everything_of_a_frame_counts() {
        let program = compile();
        let still = frame(&program, 1.0, 1.0, 0.0);
        let changes: [fn(&mut Frame); 10] = [
            |frame| frame.camera.up[1] *= 2.0,
            |frame| frame.objects[0].bounds.hi[0] *= 2.0,
            |frame| frame.objects[0].shows_normals = true,
            |frame| frame.media[0].cells.truncate(1),
            |frame| frame.lights[0].size = 0.5,
            |frame| frame.lights[0].shadows = false,
            |frame| frame.background[2] = 0.5,
            |frame| frame.media.clear(),
            |frame| frame.curves[0][0].b[1] += 1e-9,
            |frame| frame.skips = Skips::NONE,
        ];
        for (index, change) in changes.into_iter().enumerate() {
            let mut changed = still.clone();
            change(&mut changed);
            let [a, b] = [&still, &changed].map(|frame| Inputs::of_picture(&program, frame));
            assert_ne!(a, b, "change {index}");
        }
    }

    #[test]
    fn depths_depend_on_media_alone() {
        let program = compile();
        let inputs = |spin, time| Inputs::of_depths(&program, &frame(&program, spin, 1.0, time));
        assert_eq!(inputs(1.0, 0.0), inputs(1.0, 2.0), "ball and camera move");
        assert_ne!(inputs(1.0, 0.0), inputs(0.5, 0.0), "the tube bends");
    }
}
