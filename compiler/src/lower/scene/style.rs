//! Styles of lights.
//!
//! Numbers that are known at once are held against their ranges here; what a param or the time sets is
//! held within them when its frame is drawn.

mod heterogeneity;

use super::super::value::{Value, Word};
use super::super::{Lowered, Lowerer};
use super::Plan;
use crate::ir::ValueId;
use crate::program::style::{
    Blend, Constraint, Content, Cut, Holes, ImageFile, Layer, LightMap, MOST_KERNEL, Operator, OperatorKind,
    Place, Shafts, Stroke, Style, Transfer, View,
};
use crate::program::{LightKind, Slot, Slot3};
use vol_language::diag::Diagnostic;
use vol_language::hir::{Block, ExprId};
use vol_language::source::Span;

/// Default width and height of the shadow map.
const SHADOW_MAP: u32 = 1024;

/// Default width and height of a light map.
const LIGHT_MAP: u32 = 512;

/// Default octaves of noises.
const OCTAVES: u32 = 4;

/// The style of a block; none if its light has an error.
pub(super) fn style(
    lowerer: &mut Lowerer<'_>,
    block: &Block,
    plan: &mut Plan,
) -> Lowered<Option<Style<Slot>>> {
    let Some(light) = light(lowerer, block, plan)? else { return Ok(None) };
    let mut style = Style {
        name: block.name.clone(),
        light,
        shadow_map: SHADOW_MAP,
        shafts: Shafts::Mapped,
        operators: Vec::new(),
        transfer: None,
        depth_range: None,
        light_map: None,
        heterogeneity: None,
        enabled: lowerer.scalar_slot(block, "when", 1.0)?,
        span: block.span,
    };
    // Operators apply in the order in which they are written.
    for &(key, id) in &block.entries {
        entry(lowerer, key, id, &mut style, plan)?;
    }
    if let (Shafts::Exact, Some(operator)) = (style.shafts, style.operators.first()) {
        let message = "shafts that are marched have no shadow map to change";
        let label = "changes the shadow map";
        let error = Diagnostic::error("E0407", message, operator.span, label);
        return Err(Box::new(error.with_help("leave out `shafts: exact`, or this key")));
    }
    Ok(Some(style))
}

fn light(lowerer: &mut Lowerer<'_>, block: &Block, plan: &Plan) -> Lowered<Option<usize>> {
    let Some((Value::String(name), span)) = lowerer.entry(block, "light")? else {
        unreachable!("the checker asks a style for a light")
    };
    let Some(index) = plan.lights.iter().position(|light| *light.name == *name) else { return Ok(None) };
    if let LightKind::Point(_) = plan.lights[index].kind {
        let message = format!("`{name}` is a light at a place, and styles are for distant lights");
        let error = Diagnostic::error("E0505", message, span, "has no direction of its own");
        return Err(Box::new(error.with_help("give the light `from: (0, 1, 0)` instead of `at`")));
    }
    Ok(Some(index))
}

fn entry(
    lowerer: &mut Lowerer<'_>,
    key: &'static str,
    id: ExprId,
    style: &mut Style<Slot>,
    plan: &mut Plan,
) -> Lowered<()> {
    let span = lowerer.hir.expr(id).span;
    // These two are known by now.
    if matches!(key, "light" | "when") {
        return Ok(());
    }
    let value = lowerer.expr(id)?;
    match (key, &value) {
        ("shadow_map", value) => {
            style.shadow_map = lowerer.whole(value, span, "the size of a shadow map", 16, 8192)?;
        }
        ("shafts", Value::String(word)) if &**word == "exact" => style.shafts = Shafts::Exact,
        ("fill_holes" | "enhance_silhouettes", Value::Word(word)) => {
            style.operators.push(morphology(lowerer, word)?);
        }
        ("make_holes", Value::Settings(settings)) => {
            style.operators.push(holes(lowerer, &Given(settings), span)?);
        }
        ("transfer", value) => style.transfer = Some(transfer(lowerer, value, plan)?),
        ("depth_range", value) => {
            let [near, far] = pair(lowerer, value, "`depth_range`", span)?;
            let known =
                value.numbers().iter().map(|&v| lowerer.graph.constant(v)).collect::<Option<Vec<_>>>();
            if known.is_some_and(|ends| ends[0] >= ends[1]) {
                let message = "the second depth must be larger than the first";
                let error = Diagnostic::error("E0407", message, span, "not from near to far");
                return Err(Box::new(error.with_help("write `depth_range: (0, 10)`")));
            }
            style.depth_range = Some([near, far]);
        }
        ("light_map", Value::Word(word)) => style.light_map = Some(light_map(lowerer, word)?),
        ("heterogeneity", Value::Settings(settings)) => {
            style.heterogeneity = Some(heterogeneity::heterogeneity(lowerer, &style.name, &Given(settings))?);
        }
        _ => {}
    }
    Ok(())
}

/// No medium scatters the light of a style.
pub(super) fn nothing_to_style(block: &Block) -> Diagnostic {
    let message = format!("the style `{}` changes nothing: no medium is lit with shadows", block.name);
    Diagnostic::warning("W0401", message, block.span, "shafts are seen in media only")
        .with_help("add `medium air { region: box((10, 10, 10)), scatter: 0.02 }`")
}

/// Given settings.
struct Given<'a>(&'a [(&'static str, Value, Span)]);

impl Given<'_> {
    fn get(&self, key: &str) -> Option<(&Value, Span)> {
        self.0.iter().find(|(name, ..)| *name == key).map(|(_, value, span)| (value, *span))
    }
}

/// A range that a number must be in, for messages.
struct Within {
    wrong: fn(f64) -> bool,
    range: &'static str,
    example: &'static str,
}

const SHARE: Within =
    Within { wrong: |x| !(0.0..=1.0).contains(&x), range: "between 0 and 1", example: "0.5" };
const POSITIVE: Within =
    Within { wrong: |x| !(x > 0.0 && x.is_finite()), range: "more than 0", example: "1" };
const NOT_NEGATIVE: Within =
    Within { wrong: |x| !(x >= 0.0 && x.is_finite()), range: "at least 0", example: "1" };
const TEXELS: Within = Within {
    wrong: |x| !(1.0..=MOST_KERNEL).contains(&x),
    range: "between 1 and 8192 texels",
    example: "11",
};
const REACH: Within = Within {
    wrong: |x| !(0.0..=MOST_KERNEL).contains(&x),
    range: "between 0 and 8192 texels",
    example: "100",
};
const ANY: Within = Within { wrong: |x| !x.is_finite(), range: "finite", example: "0" };

impl Lowerer<'_> {
    /// The slot of a number that must be within a range.
    fn within(&mut self, value: ValueId, what: &str, within: &Within, span: Span) -> Lowered<Slot> {
        let message = format!("{what} must be {}", within.range);
        let help = format!("write {} here", within.example);
        self.refuse_with_help(&[value], within.wrong, &message, span, &help)?;
        self.slot(value, what, span)
    }

    /// A whole number known at compile time and within bounds.
    fn whole(&mut self, value: &Value, span: Span, what: &str, least: u32, most: u32) -> Lowered<u32> {
        let number = self.compile_time(value.scalar(), what, span)?;
        if (f64::from(least)..=f64::from(most)).contains(&number) {
            return Ok(number as u32);
        }
        let message = format!("{what} must be a whole number from {least} to {most}");
        let error = Diagnostic::error("E0407", message, span, format!("here it is {number}"));
        Err(Box::new(error.with_help(format!("write {}", 64.clamp(least, most)))))
    }

    /// A setting or its default.
    fn setting(&mut self, given: &Given<'_>, key: &str, default: f64, within: &Within) -> Lowered<Slot> {
        match given.get(key) {
            Some((value, span)) => self.within(value.scalar(), &format!("`{key}`"), within, span),
            None => Ok(self.constant_slot(default)),
        }
    }

    /// An argument of a word or its default.
    fn word_number(
        &mut self,
        word: &Word,
        index: usize,
        what: &str,
        default: f64,
        within: &Within,
    ) -> Lowered<Slot> {
        match word.arguments.get(index).and_then(Option::as_ref) {
            Some((value, span)) => self.within(value.scalar(), what, within, *span),
            None => Ok(self.constant_slot(default)),
        }
    }
}

/// A required argument.
fn argument(word: &Word, index: usize) -> (&Value, Span) {
    let argument = word.arguments.get(index).and_then(Option::as_ref);
    let (value, span) = argument.expect("the checker asks for the arguments that have no default");
    (value, *span)
}

fn optional(word: &Word, index: usize) -> Option<(&Value, Span)> {
    word.arguments.get(index)?.as_ref().map(|(value, span)| (value, *span))
}

fn pair(lowerer: &mut Lowerer<'_>, value: &Value, what: &str, span: Span) -> Lowered<[Slot; 2]> {
    let [x, y] = [value.numbers()[0], value.numbers()[1]];
    Ok([lowerer.slot(x, what, span)?, lowerer.slot(y, what, span)?])
}

fn color(lowerer: &mut Lowerer<'_>, word: &Word, index: usize) -> Lowered<Slot3> {
    let (value, span) = argument(word, index);
    lowerer.slots(value.vec3(), "a colour of a style", span)
}

/// Names of objects.
fn names(given: Option<(&Value, Span)>) -> Option<Vec<String>> {
    let name = |value: &Value| match value {
        Value::String(name) => name.to_string(),
        other => unreachable!("the checker gives names of objects, not {other:?}"),
    };
    given.map(|(value, _)| value.list().iter().map(name).collect())
}

fn morphology(lowerer: &mut Lowerer<'_>, word: &Word) -> Lowered<Operator<Slot>> {
    let (what, range) = match word.name {
        "disk" => ("the diameter of a disk", &TEXELS),
        "epipolar" => ("the length of a closing", &TEXELS),
        _ => ("the length of an enhancement", &REACH),
    };
    let length = lowerer.word_number(word, 0, what, 0.0, range)?;
    let kind = match word.name {
        "disk" => OperatorKind::CloseDisk(length),
        "epipolar" => OperatorKind::CloseEpipolar(length),
        _ => OperatorKind::Extrude(length),
    };
    Ok(Operator { kind, only: names(optional(word, 1)), span: word.span })
}

fn holes(lowerer: &mut Lowerer<'_>, given: &Given<'_>, span: Span) -> Lowered<Operator<Slot>> {
    let octaves = match given.get("octaves") {
        Some((value, span)) => lowerer.whole(value, span, "the number of octaves", 1, 16)?,
        None => OCTAVES,
    };
    let cut = match (given.get("threshold"), given.get("probability")) {
        (Some((_, span)), Some(_)) => {
            let message = "holes are cut by a `threshold` or by a `probability`, not by both";
            let error = Diagnostic::error("E0407", message, span, "there is a `probability`, too");
            return Err(Box::new(error.with_help("remove one of them")));
        }
        (Some(_), None) => Cut::Threshold(lowerer.setting(given, "threshold", 0.0, &ANY)?),
        (None, _) => Cut::Probability(lowerer.setting(given, "probability", 0.5, &SHARE)?),
    };
    let phase = match given.get("phase") {
        Some((value, span)) => Some(lowerer.slot(value.scalar(), "`phase`", span)?),
        None => None,
    };
    let holes = Holes {
        frequency: lowerer.setting(given, "frequency", 0.1, &POSITIVE)?,
        persistence: lowerer.setting(given, "persistence", 0.5, &NOT_NEGATIVE)?,
        octaves,
        cut,
        phase,
        as_printed: matches!(given.get("noise"), Some((Value::String(word), _)) if &**word == "printed"),
    };
    Ok(Operator { kind: OperatorKind::Holes(holes), only: names(given.get("only")), span })
}

fn transfer(lowerer: &mut Lowerer<'_>, value: &Value, plan: &mut Plan) -> Lowered<Transfer<Slot>> {
    let (lists, shares) = match value {
        Value::Keyed(lists, shares) => (lists.to_vec(), shares.to_vec()),
        list => (vec![list.clone()], Vec::new()),
    };
    let mut keys = Vec::with_capacity(lists.len());
    for list in lists {
        let words = list.list();
        let layers = words.iter().map(|word| layer(lowerer, word, plan)).collect::<Lowered<_>>()?;
        keys.push(layers);
    }
    let shares = shares.into_iter().map(|share| lowerer.slot(share, "the place along keys", Span::default()));
    Ok(Transfer { keys, shares: shares.collect::<Lowered<_>>()? })
}

fn layer(lowerer: &mut Lowerer<'_>, value: &Value, plan: &mut Plan) -> Lowered<Layer<Slot>> {
    let word = word(value);
    let (content, blend) = match word.name {
        "solid" => (Content::Solid(color(lowerer, word, 0)?), 1),
        "gradient" => {
            let place = |lowerer: &mut Lowerer<'_>, index| {
                let (value, span) = argument(word, index);
                pair(lowerer, value, "the place of a gradient", span)
            };
            let places = [place(lowerer, 0)?, place(lowerer, 2)?];
            let colors = [color(lowerer, word, 1)?, color(lowerer, word, 3)?];
            (Content::Gradient { places, colors }, 4)
        }
        "diffusion" => {
            let constraints = argument(word, 0).0.list();
            let constraints = constraints.iter().map(|value| constraint(lowerer, value));
            (Content::Diffusion(constraints.collect::<Lowered<_>>()?), 1)
        }
        _ => {
            let (value, span) = argument(word, 0);
            let Value::String(path) = value else { unreachable!("the checker gives a path") };
            plan.images.push(ImageFile { path: path.to_string(), span });
            (Content::Image(plan.images.len() - 1), 1)
        }
    };
    let blend = match optional(word, blend) {
        Some((Value::String(word), _)) if &**word == "add" => Blend::Add,
        Some((Value::Word(word), _)) => {
            Blend::Alpha(lowerer.word_number(word, 0, "the amount of a blend", 1.0, &SHARE)?)
        }
        _ => Blend::Multiply,
    };
    Ok(Layer { content, blend })
}

fn word(value: &Value) -> &Word {
    match value {
        Value::Word(word) => word,
        other => unreachable!("the checker gives a word with arguments, not {other:?}"),
    }
}

fn constraint(lowerer: &mut Lowerer<'_>, value: &Value) -> Lowered<Constraint<Slot>> {
    let word = word(value);
    if word.name == "place" {
        let (place, span) = argument(word, 0);
        let place = Place::Fixed(pair(lowerer, place, "the place of a constraint", span)?);
        let alpha = lowerer.word_number(word, 2, "the coverage of a constraint", 1.0, &SHARE)?;
        return Ok(Constraint { place, color: color(lowerer, word, 1)?, alpha });
    }
    let (at, span) = argument(word, 2);
    let place = Place::Tracked(lowerer.slots(at.vec3(), "the place of a constraint", span)?);
    let alpha = lowerer.word_number(word, 1, "the coverage of a constraint", 1.0, &SHARE)?;
    Ok(Constraint { place, color: color(lowerer, word, 0)?, alpha })
}

fn light_map(lowerer: &mut Lowerer<'_>, word: &Word) -> Lowered<LightMap<Slot>> {
    let size = match optional(word, 0) {
        Some((value, span)) => lowerer.whole(value, span, "the size of a light map", 4, 1024)?,
        None => LIGHT_MAP,
    };
    let strokes = argument(word, 1).0.list();
    let strokes = strokes.iter().map(|value| stroke(lowerer, value)).collect::<Lowered<_>>()?;
    Ok(LightMap { size, strokes })
}

fn stroke(lowerer: &mut Lowerer<'_>, value: &Value) -> Lowered<Stroke<Slot>> {
    let word = word(value);
    let view = match argument(word, 0).0 {
        Value::Word(view) => Some(self::view(lowerer, view)?),
        _ => None,
    };
    let end = |lowerer: &mut Lowerer<'_>, index| {
        let (value, span) = argument(word, index);
        pair(lowerer, value, "the end of a stroke", span)
    };
    let ends = [end(lowerer, 1)?, end(lowerer, 2)?];
    let width = lowerer.word_number(word, 3, "the width of a stroke", 1.0, &POSITIVE)?;
    Ok(Stroke { view, ends, width, color: color(lowerer, word, 4)?, span: word.span })
}

fn view(lowerer: &mut Lowerer<'_>, word: &Word) -> Lowered<View<Slot>> {
    let place = |lowerer: &mut Lowerer<'_>, index| {
        let (value, span) = argument(word, index);
        lowerer.slots(value.vec3(), "a view", span)
    };
    let (from, at) = (place(lowerer, 0)?, place(lowerer, 1)?);
    let up = match optional(word, 2) {
        Some((up, span)) => lowerer.slots(up.vec3(), "a view", span)?,
        None => lowerer.constant_slots([0.0, 1.0, 0.0]),
    };
    let angle = Within {
        wrong: |angle| !(angle > 0.0 && angle < std::f64::consts::PI),
        range: "between 0deg and 180deg",
        example: "40deg",
    };
    let fov = lowerer.word_number(word, 3, "the field of view", 40f64.to_radians(), &angle)?;
    Ok(View { from, at, up, fov })
}
