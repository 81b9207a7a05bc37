//! The light map whose scattered light comes nearest to painted strokes: sparse linear least squares.
//!
//! In: for every constraint pixel the weights of the texels that its ray sees ([`Transport`], `T`), and the radiance
//! wanted there (`b`). Out: the colours `x` of the map that make
//! `|T x - b|^2 + lambda |x - x0|^2 + mu |grad x|^2` least, `x0` white; then without negative light.
//!
//! By CGLS: conjugate gradients on the normal equations without forming them. The channels are three problems that
//! share the passes over the matrix, each with its own step lengths. Then light below 0 is cut off, and projected
//! gradient steps win back most of what that cost.
//!
//! Each channel is solved in units of its own, so that no power of ten in weights or targets overflows: weights of
//! the largest one, distances from white of the largest residual that a white map leaves.
//!
//! Both products are gathers, and every sum has one order: bit-equal whatever the number of threads.
//!
//! Example: a pixel that sees two texels with weight 1 and wants radiance 1 makes both 0.5; without `mu` the others
//! stay white.
//!
//! * source: algorithms.md §6.3; Kol et al., "Expressive Single Scattering for Light Shaft Stylization", "Light Map
//!   Optimization"; Å. Björck, "Numerical Methods for Least Squares Problems", SIAM 1996, §7.4

use rayon::prelude::*;
use std::array::from_fn;
use std::ops::Range;

#[cfg(test)]
mod tests;

/// What a texel or a pixel has in each channel.
type Rgb = [f32; 3];

/// What is wanted of a fit beside the target.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Fit {
    /// Pull to white, relative to the largest diagonal of `T'T`; at least 0. It makes the solution the only one.
    pub(crate) lambda: f64,
    /// Pull to the neighbours, relative to the same; at least 0. At 0 a texel that no pixel sees stays white; else it
    /// takes over from its neighbours, less and less over `sqrt(mu / lambda)` texels.
    pub(crate) mu: f64,
    /// Most steps of conjugate gradients.
    pub(crate) iterations: usize,
    /// Converged when `|gradient|^2` is below this part of what it is for a white map.
    pub(crate) tolerance: f64,
    /// Projected gradient steps, where light had to be cut off.
    pub(crate) projections: usize,
}

impl Default for Fit {
    /// `mu` is large enough to carry colours between strokes, and costs little at the strokes. Measured with a map of
    /// 6 x 6 panes of colour and 18 strokes in 3 views, relative residuals at the strokes and at other pixels of the
    /// views: without `mu` 0.0024 and 0.48; 1e-3: 0.0026 and 0.32; 1e-2: 0.0073 and 0.23; 1e-1: 0.034 and 0.12. It
    /// also keeps texels from running away where strokes contradict each other: of such a set the brightest texel was
    /// at 17 without it, and at 5 with it.
    fn default() -> Self {
        Self { lambda: 1e-4, mu: 1e-2, iterations: 64, tolerance: 1e-8, projections: 8 }
    }
}

/// How far a fit has come.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Progress {
    /// `|gradient|^2` relative to that of the white map, of the channel where it is largest.
    pub(crate) gradient: f64,
    /// `|T x - b| / |b|` over all channels; where `b` is 0, relative to the white map's `|T x0|`.
    pub(crate) residual: f64,
}

/// A fitted map.
#[derive(Clone, Debug)]
pub(crate) struct Solution {
    /// Colours of the texels, finite and at least 0.
    pub(crate) texels: Vec<Rgb>,
    /// Steps of conjugate gradients taken.
    pub(crate) iterations: usize,
    /// Whether all channels met the tolerance.
    pub(crate) converged: bool,
    /// Of the white map and after each step, when light may still be negative.
    pub(crate) history: Vec<Progress>,
    /// Residual of `texels`, as in [`Progress`]; that before light was cut off ends the history.
    pub(crate) residual: f64,
}

/// The map that comes nearest to a target.
///
/// * `target`: radiance, one per row of the matrix; what is negative or not finite counts as 0
/// * `size`: texels along each side of the map, which has them in rows
pub(crate) fn fit(transport: &Transport, target: &[Rgb], size: usize, settings: &Fit) -> Solution {
    assert_eq!(transport.pixels, target.len(), "a target for each pixel");
    assert_eq!(transport.texels, size * size, "a column for each texel");
    let problem = Problem::new(transport, target, size, settings);
    let mut map = Map { offsets: vec![[0.0; 3]; transport.texels], residuals: problem.misfit.clone() };
    let (history, converged) = problem.descend(&mut map, settings);
    problem.project(&mut map, settings.projections);
    Solution {
        texels: problem.texels(&map.offsets),
        iterations: history.len() - 1,
        converged,
        residual: problem.residual(squares(&map.residuals)),
        history,
    }
}

/// How much of the light of each texel comes to each constraint pixel: a sparse matrix, a row per pixel.
#[derive(Debug)]
pub(crate) struct Transport {
    pixels: usize,
    texels: usize,
    /// Largest weight of each channel. Those stored are relative to it.
    unit: [f64; 3],
    weights: Weights,
}

#[derive(Debug)]
enum Weights {
    /// One for all channels: the unit has the colour of all of them, as in media whose extinction is grey.
    Alike(Pair<f32>),
    /// One for each channel.
    Colored(Pair<Rgb>),
}

/// The matrix by pixel and by texel: twice 8 bytes an entry if the weights are alike, else twice 16.
#[derive(Debug)]
struct Pair<W> {
    by_pixel: Sparse<W>,
    by_texel: Sparse<W>,
}

impl Transport {
    /// Packs rows of texel indices with weights. Weights of one row and texel add up. A weight that is not positive
    /// and finite is 0, and so are those of texels outside the map.
    pub(crate) fn new(mut rows: Vec<Vec<(u32, Rgb)>>, texels: usize) -> Self {
        let larger = |a: Rgb, b: Rgb| from_fn(|channel| a[channel].max(b[channel]));
        let largest = rows.par_iter_mut().map(|row| {
            merge(row, texels);
            row.iter().fold([0.0; 3], |most, &(_, weight)| larger(most, weight))
        });
        let largest = largest.reduce(|| [0.0; 3], larger);
        let unit = largest.map(|largest| if largest > 0.0 { f64::from(largest) } else { 1.0 });
        let inverse = unit.map(|unit| 1.0 / unit);
        let relative =
            |weight: Rgb| from_fn(|channel| (f64::from(weight[channel]) * inverse[channel]) as f32);
        let alike = rows.par_iter().all(|row| row.iter().all(|&(_, weight)| is_grey(relative(weight))));
        let pixels = rows.len();
        let weights = if alike {
            Weights::Alike(Pair::new(rows, texels, |weight| relative(weight)[0]))
        } else {
            Weights::Colored(Pair::new(rows, texels, relative))
        };
        Self { pixels, texels, unit, weights }
    }

    /// `T x`: radiance at the pixels from the colours of the texels.
    #[cfg(test)]
    pub(crate) fn forward(&self, x: &[Rgb]) -> Vec<Rgb> {
        let mut sums = vec![[0.0; 3]; self.pixels];
        self.to_pixels(x, &mut sums);
        self.in_scene(sums)
    }

    /// `T' y`: sums over the pixels that the light of each texel comes to.
    #[cfg(test)]
    pub(crate) fn transposed(&self, y: &[Rgb]) -> Vec<Rgb> {
        let mut sums = vec![[0.0; 3]; self.texels];
        self.to_texels(y, &mut sums);
        self.in_scene(sums)
    }

    /// With the weights as they were given.
    #[cfg(test)]
    fn in_scene(&self, mut sums: Vec<Rgb>) -> Vec<Rgb> {
        let scale = |sum: Rgb| from_fn(|channel| (f64::from(sum[channel]) * self.unit[channel]) as f32);
        sums.par_iter_mut().for_each(|sum| *sum = scale(*sum));
        sums
    }

    /// `T x` with relative weights.
    fn to_pixels(&self, x: &[Rgb], sums: &mut [Rgb]) {
        match &self.weights {
            Weights::Alike(pair) => pair.by_pixel.gather(x, sums, |weight| weight),
            Weights::Colored(pair) => pair.by_pixel.gather(x, sums, |weight| weight),
        }
    }

    /// `T' y` with relative weights.
    fn to_texels(&self, y: &[Rgb], sums: &mut [Rgb]) {
        match &self.weights {
            Weights::Alike(pair) => pair.by_texel.gather(y, sums, |weight| weight),
            Weights::Colored(pair) => pair.by_texel.gather(y, sums, |weight| weight),
        }
    }

    /// Largest element on the diagonal of `T'T` in each channel, with relative weights.
    fn largest_diagonal(&self) -> Rgb {
        let ones = vec![[1.0; 3]; self.pixels];
        let mut sums = vec![[0.0; 3]; self.texels];
        match &self.weights {
            Weights::Alike(pair) => pair.by_texel.gather(&ones, &mut sums, |weight| weight * weight),
            Weights::Colored(pair) => pair.by_texel.gather(&ones, &mut sums, |weight| weight.map(|x| x * x)),
        }
        sums.iter().fold([0.0; 3], |most, sum| from_fn(|channel| f32::max(most[channel], sum[channel])))
    }
}

/// Keeps what counts of a row, one entry a texel, in order.
fn merge(row: &mut Vec<(u32, Rgb)>, texels: usize) {
    let valid = |weight: f32| if weight.is_finite() { weight.max(0.0) } else { 0.0 };
    row.retain_mut(|(texel, weight)| {
        *weight = weight.map(valid);
        (*texel as usize) < texels && *weight != [0.0; 3]
    });
    // A ray crosses the rows of the map one after the other: this sort gains by what is in order already.
    row.sort_by_key(|&(texel, _)| texel);
    row.dedup_by(|(texel, weight), (kept, sum)| {
        let same = texel == kept;
        if same {
            *sum = from_fn(|channel| (sum[channel] + weight[channel]).min(f32::MAX));
        }
        same
    });
}

/// Largest difference of two channels, relative to them, that rounding of weights may make.
const SAME: f32 = 1e-6;

fn is_grey([r, g, b]: Rgb) -> bool {
    (g - r).abs() <= SAME * r && (b - r).abs() <= SAME * r
}

/// The weight of an entry: one for all channels, or each.
trait Weight: Copy + Default + Send + Sync {
    /// What it makes of a value.
    fn times(self, value: Rgb) -> Rgb;
}

impl Weight for f32 {
    #[inline(always)]
    fn times(self, value: Rgb) -> Rgb {
        value.map(|x| self * x)
    }
}

impl Weight for Rgb {
    #[inline(always)]
    fn times(self, value: Rgb) -> Rgb {
        from_fn(|channel| self[channel] * value[channel])
    }
}

/// A sparse matrix, by rows.
#[derive(Debug)]
struct Sparse<W> {
    blocks: Vec<Block<W>>,
}

/// Rows that follow each other.
#[derive(Debug)]
struct Block<W> {
    /// Where the entries of each row end.
    ends: Vec<u32>,
    entries: Vec<Entry<W>>,
}

#[derive(Clone, Copy, Debug, Default)]
struct Entry<W> {
    column: u32,
    weight: W,
}

/// Most blocks, about: enough for 16 threads to share evenly, and few enough that the table made for
/// [`Sparse::transposed`] stays small beside the matrix.
const BLOCKS: usize = 128;

/// Least entries of a block, but for the last one: smaller ones cost more than a second thread gains.
const LEAST_ENTRIES: usize = 4096;

/// Cuts rows into blocks of about as many entries.
fn share_out(counts: impl ExactSizeIterator<Item = usize> + Clone) -> Vec<Range<usize>> {
    let rows = counts.len();
    let enough = counts.clone().sum::<usize>().div_ceil(BLOCKS).max(LEAST_ENTRIES);
    let (mut blocks, mut start, mut entries) = (Vec::new(), 0, 0);
    for (row, count) in counts.enumerate() {
        entries += count;
        if entries >= enough || row + 1 == rows {
            blocks.push(start..row + 1);
            (start, entries) = (row + 1, 0);
        }
    }
    blocks
}

impl<W: Weight> Pair<W> {
    fn new(rows: Vec<Vec<(u32, Rgb)>>, texels: usize, weight: impl Fn(Rgb) -> W + Sync) -> Self {
        let by_pixel = Sparse::new(rows, weight);
        let by_texel = by_pixel.transposed(texels);
        Self { by_pixel, by_texel }
    }
}

impl<W: Weight> Sparse<W> {
    fn new(rows: Vec<Vec<(u32, Rgb)>>, weight: impl Fn(Rgb) -> W + Sync) -> Self {
        let blocks = share_out(rows.iter().map(Vec::len));
        let mut rows = rows.into_iter();
        let parts: Vec<Vec<_>> =
            blocks.iter().map(|block| rows.by_ref().take(block.len()).collect()).collect();
        // Each row goes when it is packed, so that there is never all of it twice.
        let pack = |rows: Vec<Vec<(u32, Rgb)>>| {
            let mut ends = Vec::with_capacity(rows.len());
            let mut entries = Vec::with_capacity(rows.iter().map(Vec::len).sum());
            for row in rows {
                entries.extend(row.iter().map(|&(column, color)| Entry { column, weight: weight(color) }));
                ends.push(entries.len() as u32);
            }
            Block { ends, entries }
        };
        Self { blocks: parts.into_par_iter().map(pack).collect() }
    }

    /// The same by columns, the entries of each in the order of the rows.
    fn transposed(&self, columns: usize) -> Self {
        let counts = self.count(columns);
        let ranges = share_out(counts.iter().map(|&count| count as usize));
        let tables: Vec<_> = self.blocks.par_iter().map(|block| block.starts(&ranges)).collect();
        let transpose = |(which, range): (usize, &Range<usize>)| {
            // Find where each column begins.
            let mut places = Vec::with_capacity(range.len() + 1);
            places.push(0);
            places.extend(counts[range.clone()].iter().scan(0, |end, &count| {
                *end += count;
                Some(*end)
            }));
            let ends = places[1..].to_vec();
            // Put the part of every row that is in the range behind what its columns have.
            let mut entries = vec![Entry::default(); places[range.len()] as usize];
            let mut row = 0;
            for (block, table) in self.blocks.iter().zip(&tables) {
                for starts in table.chunks_exact(ranges.len() + 1) {
                    for entry in &block.entries[starts[which] as usize..starts[which + 1] as usize] {
                        let place = &mut places[entry.column as usize - range.start];
                        entries[*place as usize] = Entry { column: row, weight: entry.weight };
                        *place += 1;
                    }
                    row += 1;
                }
            }
            Block { ends, entries }
        };
        Self { blocks: ranges.par_iter().enumerate().map(transpose).collect() }
    }

    /// Entries of each column.
    fn count(&self, columns: usize) -> Vec<u32> {
        let add = |mut counts: Vec<u32>, block: &Block<W>| {
            block.entries.iter().for_each(|entry| counts[entry.column as usize] += 1);
            counts
        };
        let join = |mut counts: Vec<u32>, others: Vec<u32>| {
            counts.iter_mut().zip(others).for_each(|(count, other)| *count += other);
            counts
        };
        let none = || vec![0; columns];
        self.blocks.par_iter().fold(none, add).reduce(none, join)
    }

    /// The product with a vector: for each row the sum over `weight` of its weights times the values of its columns.
    fn gather(&self, values: &[Rgb], sums: &mut [Rgb], weight: impl Fn(W) -> W + Sync) {
        let mut rest = sums;
        let mut part = |rows: usize| rest.split_off_mut(..rows).expect("a sum for each row");
        let parts: Vec<_> = self.blocks.iter().map(|block| (block, part(block.ends.len()))).collect();
        parts.into_par_iter().for_each(|(block, sums)| {
            let mut start = 0;
            for (sum, &end) in sums.iter_mut().zip(&block.ends) {
                let row = &block.entries[start..end as usize];
                *sum = row.iter().fold([0.0; 3], |sum, entry| {
                    let part = weight(entry.weight).times(values[entry.column as usize]);
                    from_fn(|channel| sum[channel] + part[channel])
                });
                start = end as usize;
            }
        });
    }
}

impl<W> Block<W> {
    /// Where the entries of each row begin in each range of columns, and where the row ends.
    fn starts(&self, ranges: &[Range<usize>]) -> Vec<u32> {
        let mut starts = Vec::with_capacity(self.ends.len() * (ranges.len() + 1));
        let mut at = 0;
        for &end in &self.ends {
            for range in ranges {
                starts.push(at);
                while at < end && (self.entries[at as usize].column as usize) < range.end {
                    at += 1;
                }
            }
            starts.push(end);
        }
        starts
    }
}

/// The problem of each channel in its units: offsets `d` that make `|T d - c|^2 + lambda |d|^2 + mu |grad d|^2`
/// least. The map is `1 + span d`.
struct Problem<'a> {
    transport: &'a Transport,
    /// Texels along each side of the map.
    size: usize,
    /// `c` of each pixel, at most 1: what a white map lacks there.
    misfit: Vec<Rgb>,
    /// Unit of the offsets; 0 where a white map is right.
    span: [f64; 3],
    lambda: Rgb,
    mu: Rgb,
    /// What makes a residual relative.
    scale: [f64; 3],
}

/// A map while it is fitted.
struct Map {
    /// `d` of each texel.
    offsets: Vec<Rgb>,
    /// `r = c - T d` of each pixel.
    residuals: Vec<Rgb>,
}

/// Differences from what a white map gives, relative to the largest of that, which are rounding of sums along rays.
const ROUNDING: f64 = 1e-5;

impl<'a> Problem<'a> {
    fn new(transport: &'a Transport, target: &[Rgb], size: usize, settings: &Fit) -> Self {
        let unit = transport.unit;
        let mut white = vec![[0.0; 3]; transport.pixels];
        transport.to_pixels(&vec![[1.0; 3]; transport.texels], &mut white);
        let white: Vec<[f64; 3]> = white.iter().map(|color| color.map(f64::from)).collect();
        let valid = |x: f32| if x.is_finite() { f64::from(x).max(0.0) } else { 0.0 };
        let relative = |color: &Rgb| from_fn(|channel| valid(color[channel]) / unit[channel]);
        let target: Vec<[f64; 3]> = target.iter().map(relative).collect();
        // Find what white lacks, and the unit of it.
        let lack =
            |(target, white): (&[f64; 3], &[f64; 3])| from_fn(|channel| target[channel] - white[channel]);
        let lacks: Vec<[f64; 3]> = target.iter().zip(&white).map(lack).collect();
        let (most, brightest) = (largest(&lacks), largest(&white));
        let span = from_fn(
            |channel| if most[channel] > ROUNDING * brightest[channel] { most[channel] } else { 0.0 },
        );
        let part = |x: f64, whole: f64| if whole > 0.0 { x / whole } else { 0.0 };
        let misfit =
            lacks.iter().map(|lack| from_fn(|channel| part(lack[channel], span[channel]) as f32)).collect();
        // Find what residuals are relative to.
        let length = |colors: &[[f64; 3]]| {
            let squares = colors
                .iter()
                .flat_map(|color| (0..3).map(|channel| (color[channel] * unit[channel]).powi(2)));
            squares.sum::<f64>().sqrt()
        };
        let whole = Some(length(&target)).filter(|&whole| whole > 0.0).unwrap_or_else(|| length(&white));
        let scale = from_fn(|channel| part(span[channel] * unit[channel], whole));
        let diagonal = transport.largest_diagonal();
        let pull = |relative: f64| diagonal.map(|diagonal| (f64::from(diagonal) * relative.max(0.0)) as f32);
        Self { transport, size, misfit, span, lambda: pull(settings.lambda), mu: pull(settings.mu), scale }
    }

    /// Conjugate gradients. How it went, and whether it converged.
    fn descend(&self, map: &mut Map, settings: &Fit) -> (Vec<Progress>, bool) {
        let mut slopes = vec![[0.0; 3]; map.offsets.len()];
        let mut changes = vec![[0.0; 3]; map.residuals.len()];
        let first = self.slopes(map, &mut slopes);
        let mut gradient = first;
        let mut directions = slopes.clone();
        let progress = |gradient: [f64; 3], map: &Map| {
            let parts = (0..3)
                .filter(|&channel| first[channel] > 0.0)
                .map(|channel| gradient[channel] / first[channel]);
            Progress { gradient: parts.fold(0.0, f64::max), residual: self.residual(squares(&map.residuals)) }
        };
        let mut history = vec![progress(first, map)];
        let mut open = first.map(|first| first > 0.0);
        while open.contains(&true) && history.len() <= settings.iterations {
            // Go to the lowest point of the line: `alpha = p.s / (q.q + p.(lambda + mu K) p)`, `q = T p`. In the
            // end rounding makes `p.s` another number than `g`, and only with this one the objective still falls.
            self.transport.to_pixels(&directions, &mut changes);
            let (seen, pulled) = (squares(&changes), self.pulled(&directions));
            let fall = dots(&directions, &slopes);
            let step = from_fn(|channel| {
                let curvature = seen[channel] + pulled[channel];
                if open[channel] && curvature > 0.0 { (fall[channel] / curvature) as f32 } else { 0.0 }
            });
            add_scaled(&mut map.offsets, step, &directions);
            add_scaled(&mut map.residuals, step.map(|step| -step), &changes);
            // Turn so that what earlier steps won is kept: `p = s + (g1 / g) p`.
            let next = self.slopes(map, &mut slopes);
            let keep = from_fn(
                |channel| {
                    if open[channel] { (next[channel] / gradient[channel]) as f32 } else { 0.0 }
                },
            );
            turn(&mut directions, keep, &slopes);
            gradient = next;
            open = from_fn(|channel| gradient[channel] > settings.tolerance * first[channel]);
            history.push(progress(gradient, map));
        }
        (history, !open.contains(&true))
    }

    /// Cuts off light below 0, and goes on from there along the gradient.
    ///
    /// The step length of a texel is `1 / D`, `D = T'(T 1) + lambda + 8 mu`: at least the sum of the magnitudes in its
    /// row of `H = T'T + lambda + mu K`, as no weight is negative. So `D - H` is diagonally dominant, and the parabola
    /// with `D` in place of `H` that touches the objective here lies above it. A step goes to the parabola's lowest
    /// point that is not negative: the objective never rises. One length for all texels would do as well, but it is
    /// that of the one that most pixels see.
    fn project(&self, map: &mut Map, steps: usize) {
        // Rounded down, so that what is held there is exactly 0.
        let floor = self.span.map(|span| ((-1.0 / span) as f32).next_down());
        let hold = |offset: Rgb| from_fn(|channel| offset[channel].max(floor[channel]));
        if map.offsets.par_iter().all(|&offset| offset == hold(offset)) {
            return;
        }
        map.offsets.par_iter_mut().for_each(|offset| *offset = hold(*offset));
        self.update(map);
        let mut sums = vec![[0.0; 3]; map.residuals.len()];
        let mut bounds = vec![[0.0; 3]; map.offsets.len()];
        let mut slopes = vec![[0.0; 3]; map.offsets.len()];
        self.transport.to_pixels(&vec![[1.0; 3]; map.offsets.len()], &mut sums);
        self.transport.to_texels(&sums, &mut bounds);
        for _ in 0..steps {
            self.slopes(map, &mut slopes);
            map.offsets.par_iter_mut().zip(&slopes).zip(&bounds).for_each(|((offset, slope), bound)| {
                *offset = hold(from_fn(|channel| {
                    let bound = bound[channel] + self.lambda[channel] + 8.0 * self.mu[channel];
                    if bound > 0.0 { offset[channel] + slope[channel] / bound } else { offset[channel] }
                }));
            });
            self.update(map);
        }
    }

    /// Computes the residuals from the offsets.
    fn update(&self, map: &mut Map) {
        self.transport.to_pixels(&map.offsets, &mut map.residuals);
        map.residuals.par_iter_mut().zip(&self.misfit).for_each(|(residual, misfit)| {
            *residual = from_fn(|channel| misfit[channel] - residual[channel]);
        });
    }

    /// Half the gradient downwards, `s = T'r - (lambda + mu K) d`; returns `s.s`.
    fn slopes(&self, map: &Map, slopes: &mut [Rgb]) -> [f64; 3] {
        self.transport.to_texels(&map.residuals, slopes);
        let rows = slopes.par_chunks_mut(self.size.max(1)).enumerate().map(|(row, slopes)| {
            for (column, slope) in slopes.iter_mut().enumerate() {
                let pull = self.pull(&map.offsets, row, column);
                *slope = from_fn(|channel| slope[channel] - pull[channel]);
            }
            slopes.iter().fold([0.0; 3], |sum, slope| add_product(sum, slope, slope))
        });
        sum(rows)
    }

    /// `p.(lambda + mu K) p`.
    fn pulled(&self, p: &[Rgb]) -> [f64; 3] {
        let rows = p.par_chunks(self.size.max(1)).enumerate().map(|(row, texels)| {
            texels
                .iter()
                .enumerate()
                .fold([0.0; 3], |sum, (column, texel)| add_product(sum, texel, &self.pull(p, row, column)))
        });
        sum(rows)
    }

    /// `(lambda + mu K) d` of one texel. `K d` is the sum of its differences to its neighbours, `|grad d|^2 = d.K d`;
    /// nothing is beyond the border.
    #[inline(always)]
    fn pull(&self, d: &[Rgb], row: usize, column: usize) -> Rgb {
        let at = row * self.size + column;
        let own = d[at];
        let mut excess = [0.0; 3];
        if self.mu != [0.0; 3] {
            let last = self.size - 1;
            let neighbours = [
                (column > 0).then(|| d[at - 1]),
                (column < last).then(|| d[at + 1]),
                (row > 0).then(|| d[at - self.size]),
                (row < last).then(|| d[at + self.size]),
            ];
            for other in neighbours.into_iter().flatten() {
                excess = from_fn(|channel| excess[channel] + (own[channel] - other[channel]));
            }
        }
        from_fn(|channel| self.lambda[channel] * own[channel] + self.mu[channel] * excess[channel])
    }

    /// Relative residual from the sums of the squares of `r`.
    fn residual(&self, squares: [f64; 3]) -> f64 {
        squares.iter().zip(self.scale).map(|(square, scale)| square * scale * scale).sum::<f64>().sqrt()
    }

    /// The colours of a map.
    fn texels(&self, offsets: &[Rgb]) -> Vec<Rgb> {
        let color = |offset: &Rgb| {
            let light = |channel: usize| 1.0 + self.span[channel] * f64::from(offset[channel]);
            from_fn(|channel| light(channel).clamp(0.0, f64::from(f32::MAX)) as f32)
        };
        offsets.par_iter().map(color).collect()
    }
}

/// Largest magnitude in each channel.
fn largest(colors: &[[f64; 3]]) -> [f64; 3] {
    colors
        .iter()
        .fold([0.0; 3], |most, color| from_fn(|channel| f64::max(most[channel], color[channel].abs())))
}

/// Texels or pixels that one thread takes at a time, and that are summed up before the sums are.
const CHUNK: usize = 1024;

/// `x += step y`.
fn add_scaled(x: &mut [Rgb], step: Rgb, y: &[Rgb]) {
    x.par_iter_mut().zip(y).with_min_len(CHUNK).for_each(|(x, y)| {
        *x = from_fn(|channel| x[channel] + step[channel] * y[channel]);
    });
}

/// `p = s + keep p`.
fn turn(p: &mut [Rgb], keep: Rgb, s: &[Rgb]) {
    p.par_iter_mut().zip(s).with_min_len(CHUNK).for_each(|(p, s)| {
        *p = from_fn(|channel| s[channel] + keep[channel] * p[channel]);
    });
}

/// `x.x`.
fn squares(x: &[Rgb]) -> [f64; 3] {
    dots(x, x)
}

/// `x.y`.
fn dots(x: &[Rgb], y: &[Rgb]) -> [f64; 3] {
    let chunks = x.par_chunks(CHUNK).zip(y.par_chunks(CHUNK));
    sum(chunks.map(|(x, y)| x.iter().zip(y).fold([0.0; 3], |sum, (x, y)| add_product(sum, x, y))))
}

#[inline(always)]
fn add_product(sum: [f64; 3], x: &Rgb, y: &Rgb) -> [f64; 3] {
    from_fn(|channel| sum[channel] + f64::from(x[channel]) * f64::from(y[channel]))
}

/// Adds up in order, so that it does not matter which thread computed which part.
fn sum(parts: impl IndexedParallelIterator<Item = [f64; 3]>) -> [f64; 3] {
    let parts: Vec<_> = parts.collect();
    parts.iter().fold([0.0; 3], |sum, part| from_fn(|channel| sum[channel] + part[channel]))
}
