//! Columns of a grid, without what is the same before them and behind.

use vol_compiler::frame::{GridColumn, LightGrid};

/// Columns with their depths, as a grid holds them.
pub(super) struct Packed {
    columns: Vec<GridColumn>,
    depths: Vec<f32>,
}

impl Packed {
    /// No columns. The first depths are 0: those of all columns without any.
    pub(super) fn new() -> Self {
        Self { columns: Vec::new(), depths: vec![0.0; GridColumn::ALIGNMENT] }
    }

    /// Adds a column, of which the depths of some points are given, from one on. Those before are as the first, those
    /// behind as the last.
    pub(super) fn push(&mut self, first: usize, depths: &[f32], channels: usize) {
        let points: Vec<&[f32]> = depths.chunks_exact(channels).collect();
        let as_first = points.iter().take_while(|point| **point == points[0]).count();
        let before = as_first.saturating_sub(1);
        let varied = &points[before..];
        let behind = varied.iter().rev().take_while(|point| Some(*point) == varied.last()).count();
        let kept = &depths[channels * before..channels * (points.len() - behind.saturating_sub(1))];
        if kept.iter().all(|&depth| depth == 0.0) {
            self.columns.push(GridColumn { first: 0, count: 1, at: 0 });
            return;
        }
        self.columns.push(GridColumn {
            first: (first + before) as u32,
            count: (kept.len() / channels) as u32,
            at: self.depths.len() as u32,
        });
        self.depths.extend(kept);
        self.depths.resize(self.depths.len().next_multiple_of(GridColumn::ALIGNMENT), 0.0);
    }

    /// The grid with these columns.
    pub(super) fn into_grid(self, grid: LightGrid) -> LightGrid {
        LightGrid { columns: self.columns, depths: self.depths, ..grid }
    }
}

impl FromIterator<Self> for Packed {
    /// One after the other.
    fn from_iter<I: IntoIterator<Item = Self>>(parts: I) -> Self {
        let mut all = Self::new();
        for part in parts {
            let base = all.depths.len() as u32;
            all.columns
                .extend(part.columns.into_iter().map(|column| GridColumn { at: base + column.at, ..column }));
            all.depths.extend(part.depths);
        }
        all
    }
}

/// Depths of all points of all columns, `w` fastest, then `v`, channels together.
pub(crate) fn unpacked(grid: &LightGrid) -> Vec<f32> {
    let channels = grid.channels();
    let mut all = Vec::with_capacity(channels * grid.points());
    for &GridColumn { first, count, at } in &grid.columns {
        for point in 0..grid.counts[2] as i32 {
            let place = (point - first as i32).clamp(0, count as i32 - 1) as usize;
            all.extend(&grid.depths[at as usize + channels * place..][..channels]);
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_packed_comes_out_again() {
        for channels in [1, 3] {
            let column = |depths: &[f32]| {
                depths
                    .iter()
                    .flat_map(|&d| [d, 2.0 * d, 0.5 * d].into_iter().take(channels))
                    .collect::<Vec<_>>()
            };
            let columns = [
                column(&[0.0, 0.0, 0.0, 1.0, 1.5, 1.5, 2.0, 2.0, 2.0]),
                column(&[0.0; 9]),
                column(&[0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0]),
                column(&[3.0; 9]),
                column(&[0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0]),
                column(&[
                    0.0,
                    0.0,
                    0.25,
                    f32::INFINITY,
                    f32::INFINITY,
                    f32::INFINITY,
                    f32::INFINITY,
                    f32::INFINITY,
                    f32::INFINITY,
                ]),
            ];
            let part = |columns: &[Vec<f32>]| {
                let mut packed = Packed::new();
                columns.iter().for_each(|column| packed.push(0, column, channels));
                packed
            };
            let packed: Packed = [part(&columns[..4]), part(&columns[4..])].into_iter().collect();
            let layout = LightGrid { counts: [2, 3, 9], colored: channels == 3, ..LightGrid::default() };
            let grid = packed.into_grid(layout);
            assert_eq!(unpacked(&grid), columns.concat());
            assert!(
                grid.columns.iter().all(|column| (column.at as usize).is_multiple_of(GridColumn::ALIGNMENT))
            );
            assert_eq!(grid.columns.iter().map(|column| column.count).sum::<u32>(), 5 + 1 + 9 + 1 + 2 + 3);
            assert!(grid.words() <= grid.most_words() + GridColumn::ALIGNMENT);
        }
    }

    #[test]
    fn points_that_are_not_given_are_as_those_at_the_ends() {
        let mut packed = Packed::new();
        packed.push(3, &[0.0, 1.0, 2.0, 2.0], 1);
        packed.push(0, &[], 1);
        let grid = packed.into_grid(LightGrid { counts: [1, 2, 8], ..LightGrid::default() });
        assert_eq!(
            unpacked(&grid),
            [0.0, 0.0, 0.0, 0.0, 1.0, 2.0, 2.0, 2.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]
        );
    }
}
