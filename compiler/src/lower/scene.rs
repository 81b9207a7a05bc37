//! Blocks to the plan of the program.

mod medium;
mod style;

use super::optics::Material;
use super::shape::{self, Shape};
use super::tube::Tube;
use super::value::{Closure, LocalPoint, Value};
use super::{Lowered, Lowerer};
use crate::ir::{FunctionId, ValueId};
use crate::program::style::{ImageFile, Style};
use crate::program::{Camera, Field, Light, LightKind, Lighting, Medium, Object, Render, Slot, Slot3};
use crate::skip::Skip;
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
    pub(super) styles: Vec<Style<Slot>>,
    pub(super) images: Vec<ImageFile>,
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
        styles: Vec::new(),
        images: Vec::new(),
        camera: keep(lowerer, camera)?,
        render: keep(lowerer, render)?,
        fields: Vec::new(),
        report: Vec::new(),
    };
    let ambient = keep(lowerer, ambient)?;
    for block in &hir.blocks {
        lowerer.graph.set_place(Some(block.span));
        match block.kind {
            BlockKind::Light => {
                let light = light(lowerer, block);
                plan.lights.extend(keep(lowerer, light));
            }
            BlockKind::Object => {
                let object = object(lowerer, block, ambient, &mut plan);
                keep(lowerer, object);
            }
            BlockKind::Medium => {
                let medium = medium::medium(lowerer, block, &mut plan);
                keep(lowerer, medium);
            }
            // After all lights.
            BlockKind::Style | BlockKind::Camera | BlockKind::Render => {}
        }
    }
    for block in hir.blocks.iter().filter(|block| block.kind == BlockKind::Style) {
        lowerer.graph.set_place(Some(block.span));
        let style = style::style(lowerer, block, &mut plan);
        plan.styles.extend(keep(lowerer, style).flatten());
        if !plan.media.iter().any(|medium| medium.lighting == Lighting::Shadowed) {
            lowerer.report(style::nothing_to_style(block));
        }
    }
    lowerer.graph.set_place(None);
    if plan.lights.is_empty() {
        plan.lights.push(key_light(lowerer));
    }
    function_fields(lowerer, &mut plan.fields);
    Some(plan)
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

/// A solid, or a medium if its material is a cloud that fills it.
fn object(lowerer: &mut Lowerer<'_>, block: &Block, ambient: [ValueId; 3], plan: &mut Plan) -> Lowered<()> {
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
    if let Material::Cloud3d { cloud, depth, density } = &*material {
        return medium::cloud(lowerer, block, cloud, [*depth, *density], plan);
    }
    if shape.has_tube(&Tube::by_feet) {
        return Err(overlapping_surface(span));
    }
    let p = lowerer.position();
    let point = Rc::new(LocalPoint { world: p, region: Rc::clone(&shape) });
    let [distance, gradient] = distance_and_gradient(lowerer, &shape, name, span)?;
    let surface = material.surface(lowerer, &point, ambient, block.span)?;
    let base = material.base_color(lowerer, &point, block.span)?;
    let surface = lowerer.function(&format!("surface:{name}"), 3, &surface);
    let enabled = lowerer.scalar_slot(block, "when", 1.0)?;
    let whole = plan.objects.len();
    let parts = if lowerer.skips.has(Skip::Parts) { shape.parts_to_march() } else { vec![Rc::clone(&shape)] };
    for part in &parts {
        // A union of one part is that part.
        let own = if parts.len() == 1 {
            [distance, gradient]
        } else {
            distance_and_gradient(lowerer, part, name, span)?
        };
        let [distance, gradient] = own;
        plan.objects.push(Object {
            name: name.clone(),
            whole,
            distance,
            gradient,
            steepness: part.steepness(lowerer, name, span)?,
            surface,
            shows_normals: matches!(*material, Material::Normals),
            steady: part.is_steady(),
            extent: part.extent(lowerer, span)?,
            enabled,
            span: block.span,
        });
    }
    let fields = &mut plan.fields;
    fields.push(Field { name: format!("distance:{name}"), function: distance });
    fields.push(Field { name: format!("gradient:{name}"), function: gradient });
    add_field(lowerer, fields, format!("colour:{name}"), &base);
    let local = shape.local_field(lowerer, p, vol_language::hir::LocalField::Local, span)?;
    add_field(lowerer, fields, format!("local:{name}"), &local);
    Ok(())
}

/// The functions of a solid's distance and its gradient.
fn distance_and_gradient(
    lowerer: &mut Lowerer<'_>,
    shape: &Shape,
    name: &str,
    span: Span,
) -> Lowered<[FunctionId; 2]> {
    let p = lowerer.position();
    let distance = shape.distance(lowerer, p)?;
    let slope = shape::gradient(lowerer, distance, span)?;
    let distance = lowerer.function(&format!("distance:{name}"), 3, &[distance]);
    Ok([distance, lowerer.function(&format!("gradient:{name}"), 3, &slope)])
}

fn overlapping_surface(span: Span) -> Box<Diagnostic> {
    let message = "the surface of a tube with this overlap rule cannot be marched safely";
    let label = "distances to parts with different radii are no bounds";
    let help = "leave `overlap` out, or fill it with a medium; for crossing parts join several tubes by `|`";
    Box::new(Diagnostic::error("E0503", message, span, label).with_help(help))
}

fn solid(lowerer: &mut Lowerer<'_>, block: &Block, key: &str) -> Lowered<(Rc<Shape>, Span)> {
    let (value, span) = lowerer.entry(block, key)?.expect("the checker asks for this key");
    Ok((value.shape(), span))
}

fn add_field(lowerer: &mut Lowerer<'_>, fields: &mut Vec<Field>, name: String, outputs: &[ValueId]) {
    let function = lowerer.function(&name, 3, outputs);
    fields.push(Field { name, function });
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
