//! The moments at which a scene is looked at: as asked, with each param at each end of its range, at other times.

use vol_compiler::frame::Frame;
use vol_compiler::program::{Param, Program};
use vol_language::diag::Diagnostic;
use vol_language::ty::Type;

use crate::session::written;

/// Far in the future, in seconds: a quarter of an hour, longer than most animations.
const LATE: f64 = 1e3;

/// Size of the picture for which frames are made: only the aspect ratio of the camera depends on it.
const SIZE: [u32; 2] = [96, 54];

/// A scene at a moment.
#[derive(Clone, Debug)]
pub struct Moment {
    /// What is special about it, as in `spin = 240deg`; empty for what was asked for.
    pub label: String,
    /// The scene.
    pub frame: Frame,
}

/// The moment asked for, then those with a param changed, then other times. Moments that come out the
/// same are left out.
///
/// * returns: also the messages of moments at which the scene makes no sense
#[must_use]
pub fn moments(program: &Program, params: &[Vec<f64>], time: f64) -> (Vec<Moment>, Vec<Diagnostic>) {
    let mut cases = vec![(String::new(), params.to_vec(), time)];
    for (index, param) in program.params.iter().enumerate() {
        for end in ends(param) {
            let mut changed = params.to_vec();
            changed[index] = vec![end];
            let label = format!("{} = {}", param.name, written(&param.ty, &[end]));
            cases.push((label, changed, time));
        }
    }
    cases.extend([0.0, LATE].map(|time| (format!("time = {time} s"), params.to_vec(), time)));
    let (mut moments, mut messages): (Vec<Moment>, Vec<Diagnostic>) = (Vec::new(), Vec::new());
    for (label, params, time) in cases {
        match program.frame(&params, time, number(program, &params, time), SIZE) {
            Ok(frame) => {
                let is_new = |other: &Moment| other.frame.uniforms != frame.uniforms;
                if moments.iter().all(is_new) {
                    moments.push(Moment { label, frame });
                }
            }
            Err(message) if messages.iter().any(|known| known.labels == message.labels) => {}
            Err(mut message) => {
                if !label.is_empty() {
                    message.message += &format!(" with {label}");
                }
                messages.push(message);
            }
        }
    }
    (moments, messages)
}

/// Number of the frame at a time; a time that means the start of a frame may fall just short of it.
fn number(program: &Program, params: &[Vec<f64>], time: f64) -> f64 {
    let fps = program.numbers(params, 0.0, 0.0)[program.render.fps.0 as usize];
    if fps.is_finite() { (time * fps + 1e-6).floor() } else { 0.0 }
}

/// The ends of the range of a param, or the other truth value.
fn ends(param: &Param) -> Vec<f64> {
    match (&param.ty, param.range) {
        (_, Some((lo, hi))) => vec![lo, hi],
        (Type::Bool, None) => vec![1.0 - param.default.first().copied().unwrap_or(0.0)],
        (_, None) => Vec::new(),
    }
}
