//! Smaller bytes for the same failure.

/// Most candidates that are tried.
const MOST_TRIES: usize = 120;

/// The smallest bytes found that still fail, starting from some that do: cut short, without a part, or
/// with a part set to 0, which makes first choices.
pub fn shrink(bytes: &[u8], mut fails: impl FnMut(&[u8]) -> bool) -> Vec<u8> {
    let mut best = bytes.to_vec();
    let mut tries = 0;
    let mut part = best.len() / 2;
    while part > 0 && tries < MOST_TRIES {
        let before = best.clone();
        let mut at = 0;
        while at < best.len() && tries < MOST_TRIES {
            let end = (at + part).min(best.len());
            let without = [&best[..at], &best[end..]].concat();
            let mut zeroed = best.clone();
            zeroed[at..end].fill(0);
            let smaller = [without, zeroed].into_iter().find(|candidate| {
                tries += 1;
                *candidate != best && fails(candidate)
            });
            match smaller {
                Some(smaller) if smaller.len() < best.len() => best = smaller,
                Some(smaller) => {
                    best = smaller;
                    at = end;
                }
                None => at = end,
            }
        }
        if best == before {
            part /= 2;
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::shrink;

    #[test]
    fn only_what_matters_stays() {
        let bytes: Vec<u8> = (0..200).collect();
        let small = shrink(&bytes, |bytes| bytes.contains(&77));
        assert!(small.contains(&77));
        assert!(small.len() < 10, "{small:?}");
    }
}
