//! Media: blocks of their own, and clouds that fill an object.

use super::super::cloud::Cloud;
use super::super::optics::{self, Phase};
use super::super::tube::Tube;
use super::super::value::{LocalPoint, Value};
use super::super::{Lowered, Lowerer};
use super::{Plan, add_field, solid};
use crate::ir::ValueId;
use crate::ops::Op;
use crate::passes::unclip::unclipped;
use crate::program::{Field, Lighting, Medium};
use std::rc::Rc;
use vol_language::diag::Diagnostic;
use vol_language::hir::Block;
use vol_language::source::Span;

/// The medium of a block.
pub(super) fn medium(lowerer: &mut Lowerer<'_>, block: &Block, plan: &mut Plan) -> Lowered<()> {
    let (region, span) = solid(lowerer, block, "region")?;
    let point = Rc::new(LocalPoint { world: lowerer.position(), region });
    let mut matter = matter(lowerer, block, &point)?;
    add_up(lowerer, block, &point, span, &mut matter)?;
    if matter.is_empty(lowerer) {
        plan.report.push(format!("medium `{}` neither scatters, absorbs nor emits", block.name));
    }
    let phase = match lowerer.entry(block, "phase")? {
        Some((Value::Phase(phase), _)) => phase,
        Some((other, _)) => unreachable!("the checker gives a phase function, not {other:?}"),
        None => Rc::new(Phase::Isotropic),
    };
    let lighting = lighting(lowerer, block)?;
    fill(lowerer, block, &point, span, Filling { matter, phase, lighting }, plan)
}

/// The medium that fills a solid as a cloud: absorbs and glows, down to a depth, and answers no light.
pub(super) fn cloud(
    lowerer: &mut Lowerer<'_>,
    block: &Block,
    cloud: &Cloud,
    [depth, most]: [ValueId; 2],
    plan: &mut Plan,
) -> Lowered<()> {
    let (region, span) = solid(lowerer, block, "shape")?;
    if region.has_tube(&Tube::adds_up) {
        return Err(adds_up_elsewhere(span));
    }
    let point = Rc::new(LocalPoint { world: lowerer.position(), region });
    let distance = point.region.distance(lowerer, point.world)?;
    let amount = cloud.amount(lowerer, &point, block.span)?;
    let color = optics::color(lowerer, &cloud.color, &point)?;
    let graph = &mut lowerer.graph;
    let (zero, one) = (graph.number(0.0), graph.number(1.0));
    // What is left of cloud and colour at this depth: 1 at the surface.
    let thinnest = graph.number(1e-6);
    let depth = graph.max(depth, thinnest);
    let gone = graph.div(distance, depth);
    let left = graph.add(one, gone);
    let left = graph.max(left, zero);
    let left = graph.min(left, one);
    let most = graph.max(most, zero);
    let dense = graph.mul(most, amount);
    let density = graph.mul(dense, left);
    let density = unclipped(graph, density);
    let matter = Matter {
        density,
        shown: density,
        color,
        scattering: [zero; 3],
        extinction: [one; 3],
        extinction_alone: [one; 3],
        emission: color.map(|c| {
            let c = graph.max(c, zero);
            graph.mul(left, c)
        }),
    };
    let filling = Filling { matter, phase: Rc::new(Phase::Isotropic), lighting: Lighting::None };
    fill(lowerer, block, &point, span, filling, plan)
}

/// What a medium is, beside its region.
struct Filling {
    matter: Matter,
    phase: Rc<Phase>,
    lighting: Lighting,
}

/// Adds a medium and its fields.
fn fill(
    lowerer: &mut Lowerer<'_>,
    block: &Block,
    point: &LocalPoint,
    span: Span,
    Filling { matter, phase, lighting }: Filling,
    plan: &mut Plan,
) -> Lowered<()> {
    let (name, region, p) = (&block.name, &point.region, point.world);
    let distance = region.distance(lowerer, p)?;
    let phase = phase.lower(&mut lowerer.graph);
    let per_density = [matter.scattering, matter.extinction, matter.emission].concat();
    let interior = [&[matter.density][..], &per_density].concat();
    let extinction = [&[matter.density][..], &matter.extinction_alone].concat();
    let medium = Medium {
        name: name.clone(),
        region: lowerer.function(&format!("region:{name}"), 3, &[distance]),
        interior: lowerer.function(&format!("interior:{name}"), 3, &interior),
        extinction: lowerer.function(&format!("extinction:{name}"), 3, &extinction),
        phase: lowerer.function(&format!("phase:{name}"), 2, &[phase]),
        lighting,
        extent: region.extent(lowerer, span)?,
        enabled: lowerer.scalar_slot(block, "when", 1.0)?,
        span: block.span,
    };
    plan.fields.push(Field { name: format!("distance:{name}"), function: medium.region });
    let zero = lowerer.graph.number(0.0);
    let outside = lowerer.graph.apply(Op::Less, &[zero, distance]);
    let density = lowerer.graph.max(matter.shown, zero);
    let density = lowerer.graph.select(outside, zero, density);
    add_field(lowerer, &mut plan.fields, format!("density:{name}"), &[density]);
    add_field(lowerer, &mut plan.fields, format!("colour:{name}"), &matter.color);
    let local = region.local_field(lowerer, p, vol_language::hir::LocalField::Local, span)?;
    add_field(lowerer, &mut plan.fields, format!("local:{name}"), &local);
    plan.media.push(medium);
    Ok(())
}

/// Optical quantities of a medium at a point inside its region.
struct Matter {
    /// Nothing where negative; continued below 0 where the author cut it off, so that the place where it
    /// ends can be found between two samples.
    density: ValueId,
    /// The density as the author sees it: the same, or the sum over the feet of a tube.
    shown: ValueId,
    /// What the author calls its colour.
    color: [ValueId; 3],
    /// Coefficients per unit of density, never negative.
    scattering: [ValueId; 3],
    extinction: [ValueId; 3],
    /// The same where nothing else is asked for: shadow rays.
    extinction_alone: [ValueId; 3],
    emission: [ValueId; 3],
}

impl Matter {
    fn is_empty(&self, lowerer: &Lowerer<'_>) -> bool {
        let zero = |&v: &ValueId| lowerer.graph.constant(v) == Some(0.0);
        zero(&self.density) || self.extinction.iter().all(zero) && self.emission.iter().all(zero)
    }

    /// Coefficients times the density, per unit length.
    fn times_density(&self, lowerer: &mut Lowerer<'_>, coefficients: &[ValueId]) -> Vec<ValueId> {
        let zero = lowerer.graph.number(0.0);
        let density = lowerer.graph.max(self.density, zero);
        coefficients.iter().map(|&c| lowerer.graph.mul(density, c)).collect()
    }
}

fn matter(lowerer: &mut Lowerer<'_>, block: &Block, point: &Rc<LocalPoint>) -> Lowered<Matter> {
    let zero = lowerer.graph.number(0.0);
    let density = lowerer.closure(block, "density", 1.0, 1)?;
    let density = lowerer.call(&density, &[Value::Local(Rc::clone(point))])?.scalar();
    let density = unclipped(&mut lowerer.graph, density);
    let density = conserved(lowerer, block, point, density)?;
    let mut coefficient = |key: &str, default: f64| -> Lowered<[ValueId; 3]> {
        let closure = lowerer.closure(block, key, default, 3)?;
        let given = optics::color(lowerer, &closure, point)?;
        Ok(given.map(|c| lowerer.graph.max(c, zero)))
    };
    let scatter = coefficient("scatter", 1.0)?;
    let absorb = coefficient("absorb", 0.0)?;
    let emit = coefficient("emit", 0.0)?;
    let graph = &mut lowerer.graph;
    let total = [0, 1, 2].map(|i| graph.add(scatter[i], absorb[i]));
    Ok(Matter {
        density,
        shown: density,
        color: scatter,
        scattering: scatter,
        extinction: total,
        extinction_alone: total,
        emission: emit,
    })
}

/// Makes the quantities of a medium in a tube whose parts add up their sums over all feet; the colour
/// stays that at the foot nearest for its radius.
fn add_up(
    lowerer: &mut Lowerer<'_>,
    block: &Block,
    point: &Rc<LocalPoint>,
    span: Span,
    matter: &mut Matter,
) -> Lowered<()> {
    let Some((tube, p)) = point.region.adding_up(&mut lowerer.graph, point.world) else {
        return if point.region.has_tube(&Tube::adds_up) { Err(adds_up_elsewhere(span)) } else { Ok(()) };
    };
    // A loop of its own for each use: loops carry all of their sums.
    let sums = tube.sum_by_feet(lowerer, p, 9, span, |lowerer| {
        let matter = self::matter(lowerer, block, point)?;
        Ok(matter.times_density(lowerer, &[matter.scattering, matter.extinction, matter.emission].concat()))
    })?;
    let three = |first: usize| [sums[first], sums[first + 1], sums[first + 2]];
    (matter.scattering, matter.extinction, matter.emission) = (three(0), three(3), three(6));
    let alone = tube.sum_by_feet(lowerer, p, 3, span, |lowerer| {
        let matter = self::matter(lowerer, block, point)?;
        Ok(matter.times_density(lowerer, &matter.extinction))
    })?;
    matter.extinction_alone = [alone[0], alone[1], alone[2]];
    let one = lowerer.graph.number(1.0);
    let density = tube.sum_by_feet(lowerer, p, 1, span, |lowerer| {
        Ok(self::matter(lowerer, block, point)?.times_density(lowerer, &[one]))
    })?;
    // The densities are in the coefficients now.
    (matter.density, matter.shown) = (one, density[0]);
    Ok(())
}

fn adds_up_elsewhere(span: Span) -> Box<Diagnostic> {
    let message = "a tube with `overlap: sum` is the whole region of a medium, moved or not";
    let label = "here it is a part of another shape";
    let help = "write `overlap: min_ratio`, or give each part a medium of its own: media add up";
    Box::new(Diagnostic::error("E0407", message, span, label).with_help(help))
}

/// A volume that is squeezed more counts as squeezed by this: where a curve has no length its matter is dense, not
/// infinitely so.
const LEAST_STRETCH: f64 = 1e-12;

/// The density, divided by the stretch of volume where a key of the medium or its tube asks for that:
/// then it is the density of the unit cylinder, and the mass does not depend on the tube's shape.
fn conserved(
    lowerer: &mut Lowerer<'_>,
    block: &Block,
    point: &Rc<LocalPoint>,
    density: ValueId,
) -> Lowered<ValueId> {
    let asked = match lowerer.entry(block, "conserve_mass")? {
        Some((value, span)) => lowerer.compile_time(value.scalar(), "`conserve_mass`", span)? != 0.0,
        None => point.region.conserves_mass(),
    };
    if !asked {
        return Ok(density);
    }
    let field = vol_language::hir::LocalField::Stretch;
    let stretch = point.region.local_field(lowerer, point.world, field, block.span)?;
    let least = lowerer.graph.number(LEAST_STRETCH);
    let stretch = lowerer.graph.max(stretch[0], least);
    Ok(lowerer.graph.div(density, stretch))
}

fn lighting(lowerer: &mut Lowerer<'_>, block: &Block) -> Lowered<Lighting> {
    Ok(match lowerer.entry(block, "lighting")? {
        None => Lighting::Shadowed,
        Some((Value::String(name), _)) => match &*name {
            "none" => Lighting::None,
            "unshadowed" => Lighting::Unshadowed,
            _ => Lighting::Shadowed,
        },
        Some((other, _)) => unreachable!("the checker gives a string, not {other:?}"),
    })
}
