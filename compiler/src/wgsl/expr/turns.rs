//! The loop of a [`Batch`]: its instructions once, a turn for each place.

use super::Writer;
use crate::ir::ValueId;
use crate::ops::Ty;
use crate::wgsl::batch::{Batch, even_step, even_uniforms};
use std::fmt::Write as _;

impl Writer<'_> {
    /// The loop of the batch with this index.
    pub(super) fn batch(&self, text: &mut String, index: usize) {
        let batch = &self.schedule.batches[index];
        let (indent, turn, turns) = (&self.indent, self.turn(batch), batch.turns());
        self.tables(text, batch);
        for &(row, part) in &batch.results {
            let ty = if part.is_some() { "f32" } else { self.type_name(batch.rows[row][0]) };
            let _ = writeln!(text, "{indent}var {}: array<{ty}, {turns}>;", self.array(index, row, part));
        }
        let _ =
            writeln!(text, "{indent}for (var {turn}: u32 = 0u; {turn} < {turns}u; {turn} = {turn} + 1u) {{");
        let inside = Writer {
            inside: Some(index),
            inputs: self.inputs.clone(),
            prefix: self.prefix.clone(),
            indent: format!("{indent}  "),
            ..*self
        };
        for (number, values) in batch.inputs.iter().enumerate() {
            let (name, ty) = (self.input(batch, number), self.type_name(values[0]));
            let from_table = || format!("{name}_of[{turn}]");
            let expression = self.uniforms(batch, number).unwrap_or_else(from_table);
            let _ = writeln!(text, "{indent}  let {name}: {ty} = {expression};");
        }
        let mut last = None;
        for values in &batch.rows {
            inside.commented(text, values[0], &mut last);
        }
        for &(row, part) in &batch.results {
            let value = batch.rows[row][0];
            let name = inside.name(value);
            let expression = part.map_or_else(|| name.clone(), |part| inside.extract(value, part, &name));
            let _ = writeln!(text, "{indent}  {}[{turn}] = {expression};", self.array(index, row, part));
        }
        let _ = writeln!(text, "{indent}}}");
    }

    /// Arrays for what no rule gives by turn. They are variables: only those have an index that is no constant.
    fn tables(&self, text: &mut String, batch: &Batch) {
        let mut table = |name: &str, ty: &str, items: &[String]| {
            let (indent, count) = (&self.indent, items.len());
            let _ = writeln!(
                text,
                "{indent}var {name}_of: array<{ty}, {count}> = array<{ty}, {count}>({});",
                items.join(", ")
            );
        };
        for (number, values) in batch.inputs.iter().enumerate() {
            if self.uniforms(batch, number).is_none() {
                let items: Vec<String> = values.iter().map(|&value| self.name(value)).collect();
                table(&self.input(batch, number), self.type_name(values[0]), &items);
            }
        }
        for (row, values) in batch.rows.iter().enumerate() {
            let curves: Vec<u32> = values.iter().map(|&value| self.data(value)).collect();
            if progression(&curves, "").is_none() {
                let items: Vec<String> = curves.iter().map(|curve| format!("{curve}u")).collect();
                table(&self.curves(batch, row), "u32", &items);
            }
        }
    }

    /// The counter of the loop.
    pub(super) fn turn(&self, batch: &Batch) -> String {
        format!("{}_i", self.first(batch))
    }

    /// An input of the loop.
    pub(super) fn input(&self, batch: &Batch, number: usize) -> String {
        format!("{}_in{number}", self.first(batch))
    }

    /// The array of a result, with an element for each turn.
    pub(super) fn array(&self, index: usize, row: usize, part: Option<u32>) -> String {
        let value = self.schedule.batches[index].rows[row][0];
        let part = part.map_or_else(String::new, |part| self.suffix(value, part).replace('.', "_"));
        format!("{}{}{part}_of", self.prefix, value.0)
    }

    /// The array of the numbers of curves of a row.
    fn curves(&self, batch: &Batch, row: usize) -> String {
        format!("{}{}_curve", self.prefix, batch.rows[row][0].0)
    }

    /// The number of the curve of a row, where it changes from turn to turn.
    pub(super) fn curve_of_turn(&self, batch: &Batch, row: usize) -> Option<String> {
        let curves: Vec<u32> = batch.rows[row].iter().map(|&value| self.data(value)).collect();
        let turn = self.turn(batch);
        let from_table = || format!("{}_of[{turn}]", self.curves(batch, row));
        let changes = curves.iter().any(|&curve| curve != curves[0]);
        changes.then(|| progression(&curves, &turn).unwrap_or_else(from_table))
    }

    /// What the names of a batch begin with.
    fn first(&self, batch: &Batch) -> String {
        format!("{}{}", self.prefix, batch.rows[0][0].0)
    }

    /// An input that is a word of the frame in every turn, each as far from the last.
    fn uniforms(&self, batch: &Batch, number: usize) -> Option<String> {
        let words = even_uniforms(self.function, &batch.inputs[number])?;
        Some(format!("vol_uniform_word({})", progression(&words, &self.turn(batch))?))
    }

    fn type_name(&self, value: ValueId) -> &'static str {
        match self.function.ty(value) {
            Ty::Number => "f32",
            Ty::Bool => "bool",
        }
    }
}

/// Whole numbers that are equally far apart as an expression of their place.
fn progression(numbers: &[u32], place: &str) -> Option<String> {
    let step = even_step(numbers)?;
    let (first, size) = (numbers[0], step.unsigned_abs());
    let moved = if size == 1 { place.to_owned() } else { format!("({size}u * {place})") };
    Some(match step {
        0 => format!("{first}u"),
        1.. if first == 0 => moved,
        1.. => format!("{first}u + {moved}"),
        _ => format!("{first}u - {moved}"),
    })
}

#[cfg(test)]
mod tests {
    use super::progression;

    #[test]
    fn even_steps_are_an_expression() {
        let cases: [(&[u32], Option<&str>); 6] = [
            (&[3, 4, 5], Some("3u + i")),
            (&[3, 3, 3], Some("3u")),
            (&[0, 7, 14], Some("(7u * i)")),
            (&[9, 7, 5], Some("9u - (2u * i)")),
            (&[2, 1], Some("2u - i")),
            (&[1, 2, 4], None),
        ];
        for (numbers, expected) in cases {
            assert_eq!(progression(numbers, "i").as_deref(), expected, "{numbers:?}");
        }
    }
}
