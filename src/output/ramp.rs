//! Counts as colours: from dark blue over green to yellow, brighter for more.
//!
//! The scale is logarithmic: the largest count has the last colour, and each tenth of the ramp is half as much, so that
//! a thousandth of it and all below have the first. Example: of 0, 1, 512 and 1024 the colours are at 0, 0, 0.9 and 1.

/// Halvings from the last colour to the first.
const HALVINGS: f64 = 10.0;

/// Nine colours of the map `viridis` (van der Walt and Smith, 2015, CC0), sRGB, evenly spaced: even in lightness, and
/// told apart by eyes that see no red or no green.
const COLORS: [[u8; 3]; 9] = [
    [68, 1, 84],
    [71, 44, 122],
    [59, 81, 139],
    [44, 113, 142],
    [33, 144, 141],
    [39, 173, 129],
    [92, 200, 99],
    [170, 220, 50],
    [253, 231, 37],
];

/// The sRGB codes of counts, three for each, on a scale up to the largest of them.
#[must_use]
pub fn codes(counts: &[u64]) -> Vec<u8> {
    let most = counts.iter().copied().max().unwrap_or(0);
    counts.iter().flat_map(|&count| color(level(count, most))).collect()
}

/// Where on the ramp a count is, 0..1; 0 is at its beginning.
fn level(count: u64, most: u64) -> f64 {
    if count == 0 {
        return 0.0;
    }
    (1.0 + (count as f64 / most as f64).log2() / HALVINGS).max(0.0)
}

/// The colour at a place of the ramp, 0..1.
fn color(level: f64) -> [u8; 3] {
    let place = level * (COLORS.len() - 1) as f64;
    let index = (place as usize).min(COLORS.len() - 2);
    let part = place - index as f64;
    let between = |channel: usize| {
        let [from, to] = [COLORS[index], COLORS[index + 1]].map(|color| f64::from(color[channel]));
        (from + part * (to - from)).round() as u8
    };
    [0, 1, 2].map(between)
}

#[cfg(test)]
mod tests {
    use super::{COLORS, codes, color, level};

    #[test]
    fn halves_are_a_tenth_apart() {
        assert_eq!([0, 1, 512, 1024].map(|count| level(count, 1024)), [0.0, 0.0, 0.9, 1.0]);
        assert_eq!(codes(&[0, 1024]), [COLORS[0], COLORS[8]].concat());
        assert_eq!(codes(&[0, 0]), [COLORS[0], COLORS[0]].concat());
        assert!(codes(&[]).is_empty());
    }

    #[test]
    fn more_is_brighter() {
        let luma = |level: f64| {
            let [r, g, b] = color(level).map(f64::from);
            0.2126 * r + 0.7152 * g + 0.0722 * b
        };
        let lumas: Vec<f64> = (0..=100).map(|i| luma(f64::from(i) / 100.0)).collect();
        assert!(lumas.windows(2).all(|pair| pair[0] < pair[1]), "{lumas:?}");
    }
}
