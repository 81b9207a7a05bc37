//! Objects, media, lights, the camera and the picture's settings.

use crate::Generator;
use crate::literal::float;
use crate::piece::{Coordinates, Piece};
use crate::scope::{Place, Stage};
use vol_language::blocks::{BlockKind, Key};
use vol_language::ty::Type;

/// Levels of expressions in the value of a key.
const DEPTH: u32 = 5;

impl Generator<'_> {
    /// At least one object or medium, then the rest.
    pub(crate) fn blocks(&mut self) {
        for index in 0..=self.source.below(3) {
            let kind = self.source.pick(&[BlockKind::Object, BlockKind::Medium]);
            self.solid_block(kind, index);
        }
        let distant: Vec<bool> = (0..self.source.below(3)).map(|index| self.light(index)).collect();
        // Styles are of distant lights.
        if distant.first() == Some(&true) && self.source.once_in(2) {
            self.style();
        }
        if self.source.once_in(2) {
            self.camera();
        }
        if self.source.once_in(2) {
            self.render();
        }
        self.region = Coordinates::default();
    }

    /// `keyword name { … }`, with the entries in some order.
    fn write_block(&mut self, kind: BlockKind, name: &str, mut entries: Vec<String>) {
        self.source.shuffle(&mut entries);
        let head = format!("{} {name}", kind.keyword());
        let text = if self.source.once_in(3) && !entries.iter().any(|entry| entry.contains('\n')) {
            format!("{} {{ {} }}", head.trim_end(), entries.join(", "))
        } else {
            format!("{} {{\n  {}\n}}", head.trim_end(), entries.join("\n  "))
        };
        self.items.push(text);
    }

    /// An object or a medium: its shape first, so that functions of the local point know its coordinates.
    fn solid_block(&mut self, kind: BlockKind, index: usize) {
        let mut entries = Vec::new();
        self.region = Coordinates::default();
        for key in kind.keys() {
            if !key.required && !self.source.once_in(2) {
                continue;
            }
            let is_medium = kind == BlockKind::Medium;
            let place = Place::new(Stage::Frame, DEPTH);
            let place = Place { solid: !is_medium, smooth: !is_medium || key.required, ..place };
            let value = match key.ty {
                Type::Choice(_) => self.leaf(&key.ty, place),
                // Few other shapes have all coordinates of the local point.
                Type::Shape if self.source.once_in(6) => {
                    let coordinates = Coordinates { radius: true, along: true };
                    Piece { coordinates, ..Piece::atom("cylinder(0.7, 1.1)") }
                }
                Type::Shape if self.source.once_in(8) => {
                    let bulb = self.mandelbulb(place);
                    bulb.unwrap_or_else(|| self.plain_shape())
                }
                // What a medium keeps is known at compile time.
                Type::Bool if key.name == "conserve_mass" => Piece::atom("false"),
                _ => self.coerced(&key.ty, place),
            };
            if key.required {
                self.region = value.coordinates;
            }
            entries.push(format!("{}: {}", key.name, value.text));
        }
        let name = format!("{}{index}", self.source.pick(&["thing", "stuff"]));
        self.write_block(kind, &name, entries);
    }

    /// Whether it is a distant one.
    fn light(&mut self, index: usize) -> bool {
        let place = if self.source.once_in(2) { "from" } else { "at" };
        let mut entries = vec![format!("{place}: {}", self.direction())];
        let size = if place == "from" { "spread" } else { "radius" };
        for key in BlockKind::Light.keys() {
            if !self.source.once_in(2) {
                continue;
            }
            match key.name {
                "from" | "at" => {}
                // A light has the size of its kind, and none is negative.
                "spread" | "radius" if key.name != size => {}
                "spread" => entries.push(format!("spread: {}deg", self.source.below(120))),
                "radius" | "occlusion" => {
                    let amount = self.source.pick(&["0", "0.3", "0.2 * time", "sin(time)", "40"]);
                    entries.push(format!("{}: {amount}", key.name));
                }
                _ => entries.push(self.free_entry(&key)),
            }
        }
        self.write_block(BlockKind::Light, &format!("lamp{index}"), entries);
        place == "from"
    }

    /// A style of the first light. Shafts that are marched have no map to change.
    fn style(&mut self) {
        let mut entries = vec!["light: lamp0".to_owned()];
        let of_map = [
            "fill_holes: disk(11)",
            "fill_holes: epipolar(7 + 3 * time)",
            "enhance_silhouettes: 20 + time",
            "make_holes: { frequency: 0.3, phase: 0.2 * time }",
            "make_holes: { frequency: 0.1, octaves: 2, threshold: sin(time), noise: printed }",
        ];
        let of_all = [
            "transfer: [gradient((0, 0), #ffb347, (1, 0), #26004d), image(\"examples/styles/mood.png\", blend: alpha(0.5))]",
            "transfer: keys(time, 0: [solid(#ff8800)], 2: [diffusion([((0, 0.5), #fff), (at: (0, 0, 0), #08f)])])",
            "depth_range: (1 + time, 20)",
            "light_map: paint(8, [stroke(camera, (0, 1), (3, 4), 2, #fff)])",
            "heterogeneity: { noise: perlin, steps: 3, brushes: [brush((0, 1, 0), (1, 2, 1)), eraser((0, 0, 0), 1)] }",
            "heterogeneity: { frequency: 2 + time, amount: 0.5, steps: 4, upsample: 4 }",
            "when: time < 2",
        ];
        if self.source.once_in(4) {
            entries.push("shafts: exact".to_owned());
        } else {
            entries.push("shadow_map: 64".to_owned());
            entries.extend(of_map.iter().filter(|_| self.source.once_in(3)).map(|entry| (*entry).to_owned()));
        }
        entries.extend(of_all.iter().filter(|_| self.source.once_in(3)).map(|entry| (*entry).to_owned()));
        // Each key once.
        let key = |entry: &str| entry.split(':').next().unwrap_or_default().to_owned();
        let mut seen = Vec::new();
        entries.retain(|entry| {
            let new = !seen.contains(&key(entry));
            seen.push(key(entry));
            new
        });
        self.write_block(BlockKind::Style, "mood", entries);
    }

    fn camera(&mut self) {
        let mut entries = Vec::new();
        for key in BlockKind::Camera.keys() {
            if !self.source.once_in(2) {
                continue;
            }
            entries.push(match key.name {
                // Never where it looks at.
                "from" => format!("from: (0.5, {}, 6.5)", float(self.real()).text),
                "at" => format!("at: ({}, 0.5, 0)", float(self.real()).text),
                "fov" => format!("fov: {}deg", 5 + self.source.below(170)),
                _ => self.free_entry(&key),
            });
        }
        self.write_block(BlockKind::Camera, "", entries);
    }

    fn render(&mut self) {
        let mut entries = Vec::new();
        for key in BlockKind::Render.keys() {
            if !self.source.once_in(2) {
                continue;
            }
            entries.push(match key.name {
                "size" => format!("size: ({}, {})", 1 + self.source.below(64), 1 + self.source.below(64)),
                "duration" => format!("duration: {}", self.seconds_literal().text),
                "fps" => format!("fps: {}", 1 + self.source.below(60)),
                "samples" => format!("samples: {}", 1 + self.source.below(20)),
                "adaptive" => format!("adaptive: 0.{}", self.source.below(100)),
                _ => self.free_entry(&key),
            });
        }
        self.write_block(BlockKind::Render, "", entries);
    }

    /// A key whose values the language does not restrict.
    fn free_entry(&mut self, key: &Key) -> String {
        let value = match &key.ty {
            Type::String => self.leaf(&key.ty, Place::new(Stage::Constant, 0)),
            ty => self.coerced(ty, Place::new(Stage::Frame, 3)),
        };
        format!("{}: {}", key.name, value.text)
    }

    /// A direction that is not 0.
    fn direction(&mut self) -> String {
        let [x, y, z] = [0, 1, 2].map(|_| float(self.real_but_zero()).text);
        format!("({x}, {y}, {z})")
    }
}
