//! Materials and phase functions.

use super::cloud::Cloud;
use super::value::{Closure, LocalPoint, Value};
use super::{Lowered, Lowerer};
use crate::ir::ValueId;
use crate::ir::graph::Graph;
use crate::ops::Op;
use crate::program::SURFACE_OUTPUTS;
use std::f64::consts::PI;
use std::rc::Rc;
use vol_language::source::Span;

/// How a surface answers light; colours are functions of the local point.
#[derive(Clone, Debug)]
pub(crate) enum Material {
    /// Reflects `albedo / pi` in all directions.
    Diffuse { albedo: Rc<Closure> },
    /// `ka * ambient + sum over lights of E (kd max(0, N.L) + ks max(0, R.E)^shininess)`.
    Phong { ambient: Rc<Closure>, diffuse: Rc<Closure>, specular: Rc<Closure>, shininess: ValueId },
    /// Colour `(N + 1) / 2`.
    Normals,
    /// One colour, whatever the light.
    Flat { color: Rc<Closure> },
    /// A cloud texture over a colour, whatever the light.
    Cloud2d { cloud: Cloud, behind: Rc<Closure> },
    /// A cloud in the solid, down to a depth; density at its densest. The object becomes a medium and
    /// has no surface.
    Cloud3d { cloud: Cloud, depth: ValueId, density: ValueId },
}

impl Material {
    /// The surface response at a point: see [`SURFACE_OUTPUTS`].
    pub(crate) fn surface(
        &self,
        lowerer: &mut Lowerer<'_>,
        point: &Rc<LocalPoint>,
        ambient_light: [ValueId; 3],
        span: Span,
    ) -> Lowered<Vec<ValueId>> {
        let zero = lowerer.graph.number(0.0);
        let black = [zero; 3];
        let (emitted, diffuse, specular, shininess) = match self {
            Self::Diffuse { albedo } => {
                let albedo = color(lowerer, albedo, point)?;
                let per_pi = lowerer.graph.number(1.0 / PI);
                (black, albedo.map(|c| lowerer.graph.mul(c, per_pi)), black, zero)
            }
            Self::Phong { ambient, diffuse, specular, shininess } => {
                let ambient = color(lowerer, ambient, point)?;
                let emitted = [0, 1, 2].map(|i| lowerer.graph.mul(ambient[i], ambient_light[i]));
                let diffuse = color(lowerer, diffuse, point)?;
                (emitted, diffuse, color(lowerer, specular, point)?, *shininess)
            }
            Self::Normals | Self::Cloud3d { .. } => (black, black, black, zero),
            Self::Cloud2d { cloud, behind } => {
                (cloud.over(lowerer, behind, point, span)?, black, black, zero)
            }
            Self::Flat { color: flat } => (color(lowerer, flat, point)?, black, black, zero),
        };
        let mut outputs = Vec::with_capacity(SURFACE_OUTPUTS);
        outputs.extend([emitted, diffuse, specular].concat());
        outputs.push(shininess);
        Ok(outputs)
    }

    /// The colour that an artist would name: albedo, kd, the flat colour or that of the cloud.
    pub(crate) fn base_color(
        &self,
        lowerer: &mut Lowerer<'_>,
        point: &Rc<LocalPoint>,
        span: Span,
    ) -> Lowered<[ValueId; 3]> {
        match self {
            Self::Cloud2d { cloud, behind } => cloud.over(lowerer, behind, point, span),
            Self::Diffuse { albedo: base }
            | Self::Phong { diffuse: base, .. }
            | Self::Flat { color: base }
            | Self::Cloud3d { cloud: Cloud { color: base, .. }, .. } => color(lowerer, base, point),
            Self::Normals => {
                let zero = lowerer.graph.number(0.0);
                Ok([zero; 3])
            }
        }
    }
}

/// A colour function at a local point.
pub(crate) fn color(
    lowerer: &mut Lowerer<'_>,
    closure: &Closure,
    point: &Rc<LocalPoint>,
) -> Lowered<[ValueId; 3]> {
    Ok(lowerer.call(closure, &[Value::Local(Rc::clone(point))])?.vec3())
}

/// A phase function with parameters that do not depend on the position.
#[derive(Clone, Debug)]
pub(crate) enum Phase {
    /// `1 / (4 pi)`
    Isotropic,
    /// Henyey and Greenstein 1941.
    HenyeyGreenstein(ValueId),
    /// `3 / (16 pi) (1 + cos^2)`
    Rayleigh,
    /// Blasi, Le Saec and Schlick 1993: `(1 - k^2) / (4 pi (1 - k cos)^2)`
    Schlick(ValueId),
    /// `w` times the first lobe plus `1 - w` times the second.
    DoubleHenyeyGreenstein(ValueId, ValueId, ValueId),
}

impl Phase {
    /// The phase function as IR of two inputs, `1 - cos` and `1 + cos`.
    ///
    /// Both are given because `1 + g^2 - 2 g cos` loses all digits in f32 when `|g|` nears 1:
    /// relative error 0.69 at g = 0.999 against 7e-7 of the form used here.
    pub(crate) fn lower(&self, graph: &mut Graph) -> ValueId {
        let (versine, coversine) = (graph.input(0), graph.input(1));
        match self {
            Self::Isotropic => graph.number(1.0 / (4.0 * PI)),
            Self::HenyeyGreenstein(g) => henyey_greenstein(graph, *g, versine, coversine),
            Self::Rayleigh => {
                let half = graph.number(0.5);
                let twice = graph.sub(coversine, versine);
                let cosine = graph.mul(twice, half);
                let squared = graph.mul(cosine, cosine);
                let one = graph.number(1.0);
                let lobe = graph.add(one, squared);
                let scale = graph.number(3.0 / (16.0 * PI));
                graph.mul(scale, lobe)
            }
            Self::Schlick(k) => schlick(graph, *k, versine, coversine),
            Self::DoubleHenyeyGreenstein(g1, g2, weight) => {
                let first = henyey_greenstein(graph, *g1, versine, coversine);
                let second = henyey_greenstein(graph, *g2, versine, coversine);
                // Not `second + weight (first - second)`: beside a sharp lobe of weight 0 nothing would
                // be left of the other.
                let one = graph.number(1.0);
                let rest = graph.sub(one, *weight);
                let (first, second) = (graph.mul(*weight, first), graph.mul(rest, second));
                graph.add(first, second)
            }
        }
    }
}

/// `(1 - |a|, |a|, 1 - cos or 1 + cos)`: the parts from which both lobes are built without
/// cancellation. The parameter is kept within ±0.9999, where f32 still resolves the peak.
fn lobe_parts(
    graph: &mut Graph,
    a: ValueId,
    versine: ValueId,
    coversine: ValueId,
) -> (ValueId, ValueId, ValueId) {
    let most = graph.number(0.9999);
    let size = graph.apply(Op::Abs, &[a]);
    let size = graph.min(size, most);
    let one = graph.number(1.0);
    let rest = graph.sub(one, size);
    let zero = graph.number(0.0);
    let backward = graph.apply(Op::Less, &[a, zero]);
    let away = graph.select(backward, coversine, versine);
    (rest, size, away)
}

/// `(1 - g^2) / (4 pi d^(3/2))`, `d = (1-|g|)^2 + 2 |g| (1 - sgn(g) cos)`
fn henyey_greenstein(graph: &mut Graph, g: ValueId, versine: ValueId, coversine: ValueId) -> ValueId {
    let (rest, size, away) = lobe_parts(graph, g, versine, coversine);
    let one = graph.number(1.0);
    let two = graph.number(2.0);
    let squared = graph.mul(rest, rest);
    let double = graph.mul(two, size);
    let spread = graph.mul(double, away);
    let d = graph.add(squared, spread);
    let root = graph.apply(Op::Sqrt, &[d]);
    let cube = graph.mul(d, root);
    let scale = graph.number(4.0 * PI);
    let below = graph.mul(scale, cube);
    let more = graph.add(one, size);
    let above = graph.mul(rest, more);
    graph.div(above, below)
}

fn schlick(graph: &mut Graph, k: ValueId, versine: ValueId, coversine: ValueId) -> ValueId {
    let (rest, size, away) = lobe_parts(graph, k, versine, coversine);
    let one = graph.number(1.0);
    let spread = graph.mul(size, away);
    let d = graph.add(rest, spread);
    let squared = graph.mul(d, d);
    let scale = graph.number(4.0 * PI);
    let below = graph.mul(scale, squared);
    let more = graph.add(one, size);
    let above = graph.mul(rest, more);
    graph.div(above, below)
}
