//! Blocks to the plan of the program.

use super::optics::{self, Material, Phase};
use super::shape::{self, Shape};
use super::value::{Closure, LocalPoint, Value};
use super::{Lowered, Lowerer};
use crate::ir::ValueId;
use crate::ops::Op;
use crate::program::{Camera, Field, Light, LightKind, Lighting, Medium, Object, Render, Slot, Slot3};
use std::rc::Rc;
use vol_language::blocks::BlockKind;
use vol_language::diag::Diagnostic;
use vol_language::hir::{Block, ExprId};
use vol_language::module::ModuleId;
use vol_language::source::Span;
use vol_language::ty::Type;

/// Everything of a program but its functions.
pub(super) struct Plan {
    pub(super) objects: Vec<Object>,
    pub(super) media: Vec<Medium>,
    pub(super) lights: Vec<Light>,
    pub(super) camera: Camera,
    pub(super) render: Render,
    pub(super) fields: Vec<Field>,
    pub(super) report: Vec<String>,
}

/// Default picture width and height.
const SIZE: [u32; 2] = [960, 540];

/// The soft key light of scenes without lights: from above, left and front.
const KEY_LIGHT: ([f64; 3], f64) = ([-0.5, 0.8, 0.6], 3.0);

/// Lowers all blocks; blocks with errors are reported and left out. `None` if nothing is left.
pub(super) fn plan(lowerer: &mut Lowerer<'_>) -> Option<Plan> {
    let hir = lowerer.hir;
    // In order, so that a chain of `let`s does not nest.
    for index in 0..hir.lets.len() {
        let value = lowerer.let_value(index);
        keep(lowerer, value);
    }
    let render_block = hir.blocks.iter().find(|b| b.kind == BlockKind::Render);
    let render = render(lowerer, render_block);
    let ambient = ambient(lowerer, render_block);
    let camera = camera(lowerer, hir.blocks.iter().find(|b| b.kind == BlockKind::Camera));
    let mut plan = Plan {
        objects: Vec::new(),
        media: Vec::new(),
        lights: Vec::new(),
        camera: keep(lowerer, camera)?,
        render: keep(lowerer, render)?,
        fields: Vec::new(),
        report: Vec::new(),
    };
    let ambient = keep(lowerer, ambient)?;
    for block in &hir.blocks {
        match block.kind {
            BlockKind::Light => {
                let light = light(lowerer, block);
                plan.lights.extend(keep(lowerer, light));
            }
            BlockKind::Object => {
                let object = object(lowerer, block, ambient, &mut plan.fields);
                plan.objects.extend(keep(lowerer, object));
            }
            BlockKind::Medium => {
                let medium = medium(lowerer, block, &mut plan);
                plan.media.extend(keep(lowerer, medium));
            }
            BlockKind::Style => lowerer.report(idle_style(block)),
            BlockKind::Camera | BlockKind::Render => {}
        }
    }
    if plan.lights.is_empty() {
        plan.lights.push(key_light(lowerer));
    }
    function_fields(lowerer, &mut plan.fields);
    Some(plan)
}

/// Styles are checked in full, but nothing renders them.
fn idle_style(block: &Block) -> Diagnostic {
    let message = format!("the style `{}` does not change the picture yet", block.name);
    Diagnostic::warning("W0401", message, block.span, "checked, but not rendered")
        .with_help("the scene renders as if the style were off")
}

fn keep<T>(lowerer: &mut Lowerer<'_>, lowered: Lowered<T>) -> Option<T> {
    lowered.map_err(|diagnostic| lowerer.report(*diagnostic)).ok()
}

impl Lowerer<'_> {
    /// The value of a key and its place, if the block gives it.
    fn entry(&mut self, block: &Block, key: &str) -> Lowered<Option<(Value, Span)>> {
        let Some(id) = block.entry(key) else { return Ok(None) };
        let value = self.expr(id)?;
        Ok(Some((value, self.hir.expr(id).span)))
    }

    fn scalar_slot(&mut self, block: &Block, key: &str, default: f64) -> Lowered<Slot> {
        match self.entry(block, key)? {
            Some((value, span)) => self.slot(value.scalar(), &format!("`{key}`"), span),
            None => Ok(self.constant_slot(default)),
        }
    }

    /// The slot of a number that is left out where it is always 0.
    fn optional_slot(&mut self, block: &Block, key: &str) -> Lowered<Option<Slot>> {
        let Some((value, span)) = self.entry(block, key)? else { return Ok(None) };
        if self.graph.constant(value.scalar()) == Some(0.0) {
            return Ok(None);
        }
        Ok(Some(self.slot(value.scalar(), &format!("`{key}`"), span)?))
    }

    fn vector_slots(&mut self, block: &Block, key: &str) -> Lowered<Option<Slot3>> {
        match self.entry(block, key)? {
            Some((value, span)) => Ok(Some(self.slots(value.vec3(), &format!("`{key}`"), span)?)),
            None => Ok(None),
        }
    }

    fn closure(&mut self, block: &Block, key: &str, default: f64, components: usize) -> Lowered<Rc<Closure>> {
        let given = self.entry(block, key)?;
        Ok(given.map_or_else(
            || {
                let number = self.graph.number(default);
                Rc::new(Closure::Constant(Value::Numbers(vec![number; components])))
            },
            |(value, _)| value.function(),
        ))
    }
}

fn render(lowerer: &mut Lowerer<'_>, block: Option<&Block>) -> Lowered<Render> {
    let empty = no_block(BlockKind::Render);
    let block = block.unwrap_or(&empty);
    let size = match lowerer.entry(block, "size")? {
        Some((value, span)) => {
            let side = |i: usize| -> Lowered<u32> {
                Ok(lowerer.compile_time(value.numbers()[i], "the size of the picture", span)? as u32)
            };
            [side(0)?, side(1)?]
        }
        None => SIZE,
    };
    let black = lowerer.constant_slots([0.0; 3]);
    Ok(Render {
        size,
        background: lowerer.vector_slots(block, "background")?.unwrap_or(black),
        samples: match block.entry("samples") {
            Some(_) => Some(lowerer.scalar_slot(block, "samples", 1.0)?),
            None => None,
        },
        adaptive: lowerer.scalar_slot(block, "adaptive", 0.0)?,
        duration: lowerer.scalar_slot(block, "duration", 0.0)?,
        fps: lowerer.scalar_slot(block, "fps", 30.0)?,
    })
}

/// Ambient light as values, for the surfaces' emitted part.
fn ambient(lowerer: &mut Lowerer<'_>, block: Option<&Block>) -> Lowered<[ValueId; 3]> {
    let white = lowerer.graph.number(1.0);
    let Some(block) = block else { return Ok([white; 3]) };
    Ok(lowerer.entry(block, "ambient")?.map_or([white; 3], |(value, _)| value.vec3()))
}

fn camera(lowerer: &mut Lowerer<'_>, block: Option<&Block>) -> Lowered<Camera> {
    let empty = no_block(BlockKind::Camera);
    let block = block.unwrap_or(&empty);
    let up = lowerer.constant_slots([0.0, 1.0, 0.0]);
    Ok(Camera {
        from: lowerer.vector_slots(block, "from")?,
        at: lowerer.vector_slots(block, "at")?,
        up: lowerer.vector_slots(block, "up")?.unwrap_or(up),
        fov: lowerer.scalar_slot(block, "fov", 40f64.to_radians())?,
    })
}

fn no_block(kind: BlockKind) -> Block {
    Block { kind, name: String::new(), entries: Vec::new(), span: Span::default() }
}

fn light(lowerer: &mut Lowerer<'_>, block: &Block) -> Lowered<Light> {
    let kind = match (lowerer.vector_slots(block, "from")?, lowerer.vector_slots(block, "at")?) {
        (Some(direction), _) => LightKind::Distant(direction),
        (None, Some(position)) => LightKind::Point(position),
        (None, None) => unreachable!("the checker asks a light for `from` or `at`"),
    };
    let white = lowerer.constant_slots([1.0; 3]);
    let size = match kind {
        LightKind::Distant(_) => lowerer.optional_slot(block, "spread")?,
        LightKind::Point(_) => lowerer.optional_slot(block, "radius")?,
    };
    Ok(Light {
        name: block.name.clone(),
        kind,
        color: lowerer.vector_slots(block, "color")?.unwrap_or(white),
        shadows: lowerer.scalar_slot(block, "shadows", 1.0)?,
        size,
        occlusion: lowerer.optional_slot(block, "occlusion")?,
        enabled: lowerer.scalar_slot(block, "when", 1.0)?,
    })
}

fn key_light(lowerer: &mut Lowerer<'_>) -> Light {
    let (direction, strength) = KEY_LIGHT;
    let on = lowerer.constant_slot(1.0);
    Light {
        name: "key".to_owned(),
        kind: LightKind::Distant(lowerer.constant_slots(direction)),
        color: lowerer.constant_slots([strength; 3]),
        shadows: on,
        size: None,
        occlusion: None,
        enabled: on,
    }
}

fn object(
    lowerer: &mut Lowerer<'_>,
    block: &Block,
    ambient: [ValueId; 3],
    fields: &mut Vec<Field>,
) -> Lowered<Object> {
    let name = &block.name;
    let (shape, span) = solid(lowerer, block, "shape")?;
    let material = match lowerer.entry(block, "material")? {
        Some((Value::Material(material), _)) => material,
        Some((other, _)) => unreachable!("the checker gives a material, not {other:?}"),
        None => {
            let grey = lowerer.graph.number(0.8);
            Rc::new(Material::Diffuse { albedo: Rc::new(Closure::Constant(Value::Numbers(vec![grey; 3]))) })
        }
    };
    let p = lowerer.position();
    let point = Rc::new(LocalPoint { world: p, region: Rc::clone(&shape) });
    let distance = shape.distance(lowerer, p)?;
    let slope = shape::gradient(lowerer, distance, span)?;
    let surface = material.surface(lowerer, &point, ambient)?;
    let base = material.base_color(lowerer, &point)?;
    let object = Object {
        name: name.clone(),
        distance: lowerer.function(&format!("distance:{name}"), 3, &[distance]),
        gradient: lowerer.function(&format!("gradient:{name}"), 3, &slope),
        steepness: shape.steepness(lowerer, name, span)?,
        surface: lowerer.function(&format!("surface:{name}"), 3, &surface),
        shows_normals: matches!(*material, Material::Normals),
        extent: shape.extent(lowerer, span)?,
        enabled: lowerer.scalar_slot(block, "when", 1.0)?,
        span: block.span,
    };
    fields.push(Field { name: format!("distance:{name}"), function: object.distance });
    add_field(lowerer, fields, format!("colour:{name}"), &base);
    let local = shape.local_field(lowerer, p, vol_language::hir::LocalField::Local, span)?;
    add_field(lowerer, fields, format!("local:{name}"), &local);
    Ok(object)
}

fn solid(lowerer: &mut Lowerer<'_>, block: &Block, key: &str) -> Lowered<(Rc<Shape>, Span)> {
    let (value, span) = lowerer.entry(block, key)?.expect("the checker asks for this key");
    Ok((value.shape(), span))
}

fn add_field(lowerer: &mut Lowerer<'_>, fields: &mut Vec<Field>, name: String, outputs: &[ValueId]) {
    let function = lowerer.function(&name, 3, outputs);
    fields.push(Field { name, function });
}

fn medium(lowerer: &mut Lowerer<'_>, block: &Block, plan: &mut Plan) -> Lowered<Medium> {
    let name = &block.name;
    let (region, span) = solid(lowerer, block, "region")?;
    let p = lowerer.position();
    let point = Rc::new(LocalPoint { world: p, region: Rc::clone(&region) });
    let distance = region.distance(lowerer, p)?;
    let matter = matter(lowerer, block, &point)?;
    if matter.is_empty(lowerer) {
        plan.report.push(format!("medium `{name}` neither scatters, absorbs nor emits"));
    }
    let phase = match lowerer.entry(block, "phase")? {
        Some((Value::Phase(phase), _)) => phase,
        Some((other, _)) => unreachable!("the checker gives a phase function, not {other:?}"),
        None => Rc::new(Phase::Isotropic),
    };
    let phase = phase.lower(&mut lowerer.graph);
    let interior = [matter.scattering, matter.extinction, matter.emission].concat();
    let medium = Medium {
        name: name.clone(),
        region: lowerer.function(&format!("region:{name}"), 3, &[distance]),
        interior: lowerer.function(&format!("interior:{name}"), 3, &interior),
        extinction: lowerer.function(&format!("extinction:{name}"), 3, &matter.extinction),
        phase: lowerer.function(&format!("phase:{name}"), 2, &[phase]),
        lighting: lighting(lowerer, block)?,
        extent: region.extent(lowerer, span)?,
        enabled: lowerer.scalar_slot(block, "when", 1.0)?,
        span: block.span,
    };
    plan.fields.push(Field { name: format!("distance:{name}"), function: medium.region });
    let zero = lowerer.graph.number(0.0);
    let outside = lowerer.graph.apply(Op::Less, &[zero, distance]);
    let density = lowerer.graph.select(outside, zero, matter.density);
    add_field(lowerer, &mut plan.fields, format!("density:{name}"), &[density]);
    add_field(lowerer, &mut plan.fields, format!("colour:{name}"), &matter.scatter);
    let local = region.local_field(lowerer, p, vol_language::hir::LocalField::Local, span)?;
    add_field(lowerer, &mut plan.fields, format!("local:{name}"), &local);
    Ok(medium)
}

/// Optical quantities of a medium at a point inside its region.
struct Matter {
    density: ValueId,
    scatter: [ValueId; 3],
    scattering: [ValueId; 3],
    extinction: [ValueId; 3],
    emission: [ValueId; 3],
}

impl Matter {
    fn is_empty(&self, lowerer: &Lowerer<'_>) -> bool {
        let zero = |&v: &ValueId| lowerer.graph.constant(v) == Some(0.0);
        self.extinction.iter().all(zero) && self.emission.iter().all(zero)
    }
}

fn matter(lowerer: &mut Lowerer<'_>, block: &Block, point: &Rc<LocalPoint>) -> Lowered<Matter> {
    let zero = lowerer.graph.number(0.0);
    let density = lowerer.closure(block, "density", 1.0, 1)?;
    let density = lowerer.call(&density, &[Value::Local(Rc::clone(point))])?.scalar();
    let density = lowerer.graph.max(density, zero);
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
        scatter,
        scattering: scatter.map(|c| graph.mul(density, c)),
        extinction: total.map(|c| graph.mul(density, c)),
        emission: emit.map(|c| graph.mul(density, c)),
    })
}

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
    Ok(lowerer.graph.div(density, stretch[0]))
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

/// Top-level functions of one position become fields that can be asked for by name.
fn function_fields(lowerer: &mut Lowerer<'_>, fields: &mut Vec<Field>) {
    let own = lowerer.hir.functions.iter().filter(|function| function.module == ModuleId::ROOT);
    for function in own {
        let [(local, Type::Vec3)] = function.params[..] else { continue };
        if function.result.components().is_none() {
            continue;
        }
        let p = lowerer.position();
        let value = call_at(lowerer, function.body, local, p);
        if let Some(value) = keep(lowerer, value) {
            add_field(lowerer, fields, function.name.clone(), value.numbers());
        }
    }
}

fn call_at(
    lowerer: &mut Lowerer<'_>,
    body: ExprId,
    local: vol_language::hir::LocalId,
    p: [ValueId; 3],
) -> Lowered<Value> {
    let closure = Closure::Lambda { params: vec![local], body, captured: lowerer.environment.clone() };
    lowerer.call(&closure, &[Value::Numbers(p.to_vec())])
}
