//! Styles in the shader: its text where a scene has any, and where their tables are.
//!
//! A record in `vol_frame` has the words
//!
//! | word | meaning |
//! |---|---|
//! | 0 | occluders: 0 none, 1 slices, 2 marched |
//! | 1 | lo xyz and hi xyz of the box around the media |
//! | 7 | toward the light, xyz |
//! | 10 | axes of the slices u, v, w, xyz each |
//! | 19 | first angle, slices per radian, slices |
//! | 22 | first distance, texels per unit, texels of a slice, word of the first slope in `vol_input` |
//! | 26 | transfer function (0 none), near, per unit, word of its first texel |
//! | 30 | size of the light map (0 none), origin xyz, u xyz, v xyz, word of its first texel |
//! | 41 | steps of the heterogeneity (0 none), index of its field, pixels between known means (0 none), means across, down, word of the first |
//!
//! In `vol_input` follow for each styled light slopes, transfer function, light map and means.

use super::glue::Pick;
use super::words::GRID_ALIGNMENT;
use crate::frame::Frame;
use crate::frame::styled::{Occluders, StyledLight};
use crate::program::style::Style;
use crate::program::{Program, Slot};

/// Words of a record.
pub(super) const WORDS: usize = 47;

/// What the integrator adds for scenes with styles, and for those without.
pub(super) const STYLED: [&str; 2] = [include_str!("styled.wgsl"), include_str!("marched.wgsl")];
const UNSTYLED: &str = include_str!("unstyled.wgsl");

/// What the integrator needs beside the rest.
pub(super) fn text(program: &Program) -> String {
    if program.styles.is_empty() { UNSTYLED.to_owned() } else { STYLED.join("\n") }
}

/// Picks the heterogeneity of a style.
pub(super) fn fields(program: &Program) -> Pick<'static> {
    let fields = program.styles.iter().map(|style| Some(style.heterogeneity?.field));
    Pick {
        signature: "style_field(index: u32, p: vec3f) -> f32",
        otherwise: "1.0",
        arguments: "p.x, p.y, p.z",
        functions: fields.collect(),
        result: "v",
        counters: &[],
    }
}

/// The light with a style at an index.
pub(super) fn of_light(frame: &Frame, light: usize) -> Option<&StyledLight> {
    frame.styled_lights.get(light)?.as_deref()
}

/// All lights that have a style.
pub(super) fn all(frame: &Frame) -> impl Iterator<Item = &StyledLight> {
    (0..frame.lights.len()).filter_map(|light| of_light(frame, light))
}

/// The tables of a styled light: slopes, transfer function, light map, means; empty where there is none.
pub(super) fn tables(light: &StyledLight) -> [&[f32]; 4] {
    let slopes: &[f32] = match &light.occluders {
        Occluders::Slices(slices) => &slices.slopes,
        Occluders::None | Occluders::Marched => &[],
    };
    let transfer = light.transfer.as_ref().map_or(&[][..], |table| table.texels.as_flattened());
    let map = light.light_map.as_ref().map_or(&[][..], |table| table.texels.as_flattened());
    let means = light.heterogeneity.as_ref().and_then(|table| table.means.as_ref());
    [slopes, transfer, map, means.map_or(&[][..], |means| means.texels.as_flattened())]
}

/// A styled light without its tables, which follow one another in `vol_input` from a word on.
pub(super) fn record(program: &Program, light: &StyledLight, at: &mut usize) -> [f32; WORDS] {
    let mut words = [0.0; WORDS];
    let places = tables(light).map(|table| {
        let place = *at;
        *at += table.len().next_multiple_of(GRID_ALIGNMENT);
        place as f32
    });
    let mut put = |first: usize, numbers: &[f32]| words[first..][..numbers.len()].copy_from_slice(numbers);
    let StyledLight { toward, bounds, occluders, transfer, light_map, heterogeneity } = light;
    put(1, &[bounds.lo, bounds.hi, *toward].concat());
    match occluders {
        Occluders::None => {}
        Occluders::Marched => put(0, &[2.0]),
        Occluders::Slices(slices) => {
            put(0, &[1.0]);
            put(10, slices.axes.as_flattened());
            let [rows, columns] = [slices.rows, slices.columns].map(|count| count as f32);
            put(19, &[slices.first_angle, slices.per_radian, rows]);
            put(22, &[slices.first_distance, slices.per_unit, columns, places[0]]);
        }
    }
    if let Some(table) = transfer {
        put(26, &[1.0, table.near, table.per_unit, places[1]]);
    }
    if let Some(map) = light_map {
        put(30, &[map.size as f32]);
        put(31, &[map.origin, map.axes[0], map.axes[1]].concat());
        put(40, &[places[2]]);
    }
    if let Some(table) = heterogeneity {
        let own = |style: &Style<Slot>| style.heterogeneity.is_some_and(|own| own.field == table.field);
        let index = program.styles.iter().position(own).unwrap_or(program.styles.len());
        put(41, &[table.steps as f32, index as f32]);
        if let Some(means) = &table.means {
            put(43, &[means.spacing as f32, means.counts[0] as f32, means.counts[1] as f32, places[3]]);
        }
    }
    words
}
