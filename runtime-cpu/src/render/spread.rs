//! A few pixels that stand for a whole picture.

/// At most `most` pixels all over a picture, in an order of which every beginning is spread evenly: all pixels,
/// shuffled, of a picture that has no more; of a larger one those at multiples of the powers of the plastic
/// number (M. Roberts, The Unreasonable Effectiveness of Quasirandom Sequences, 2018), where a few come twice if
/// there are hardly more.
#[must_use]
pub fn spread_pixels([width, height]: [u32; 2], most: usize) -> Vec<[u32; 2]> {
    let all = width.saturating_mul(height);
    if all as usize <= most {
        let mut order: Vec<u32> = (0..all).collect();
        order.sort_by_key(|&index| mixed(index));
        return order.into_iter().map(|index| [index % width, index / width]).collect();
    }
    let along = |index: usize, ratio: f64, length: u32| {
        ((0.5 + (index + 1) as f64 * ratio).fract() * f64::from(length)) as u32
    };
    let pixel =
        |index| [along(index, 0.754_877_666_246_692_8, width), along(index, 0.569_840_290_998_053_3, height)];
    (0..most).map(pixel).collect()
}

/// A number that says nothing about `index`, another for each (finalizer of MurmurHash3).
fn mixed(index: u32) -> u32 {
    let a = (index ^ (index >> 16)).wrapping_mul(0x85eb_ca6b);
    let b = (a ^ (a >> 13)).wrapping_mul(0xc2b2_ae35);
    b ^ (b >> 16)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn beginnings_are_spread_evenly() {
        for (size, most) in [([960, 540], 4096), ([60, 40], 4096)] {
            let pixels = spread_pixels(size, most);
            assert!(pixels.iter().all(|&[x, y]| x < size[0] && y < size[1]));
            for count in [256, 1024, 2400] {
                let left_top = pixels[..count].iter().filter(|&&[x, y]| 2 * x < size[0] && 2 * y < size[1]);
                let share = left_top.count() as f64 / count as f64;
                assert!((share - 0.25).abs() < 0.04, "{size:?} {count}: {share}");
            }
        }
    }

    #[test]
    fn small_pictures_are_taken_whole() {
        let mut pixels = spread_pixels([3, 2], 6);
        pixels.sort_unstable_by_key(|&[x, y]| (y, x));
        assert_eq!(pixels, [[0, 0], [1, 0], [2, 0], [0, 1], [1, 1], [2, 1]]);
        assert!(spread_pixels([0, 5], 8).is_empty());
    }
}
