//! "Did you mean": the known name nearest to a mistyped one.

/// Names longer than this are not compared, so that the search stays quick on any input.
const MAX_LENGTH: usize = 64;

/// The candidate with the fewest typing mistakes between it and `name`, if they are at most a
/// third of the longer one's length; of equals the first in the alphabet. Case counts as no
/// mistake.
pub fn nearest<'a>(name: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let typed = folded(name)?;
    let scored = candidates.into_iter().filter(|candidate| *candidate != name).filter_map(|candidate| {
        let known = folded(candidate)?;
        let longest = typed.len().max(known.len());
        let limit = longest.max(3) / 3;
        if longest - typed.len().min(known.len()) > limit {
            return None;
        }
        let mistakes = distance(&typed, &known);
        // A name of which nothing is left is no suggestion.
        (mistakes <= limit && mistakes < longest).then_some((mistakes, candidate))
    });
    scored.min().map(|(_, candidate)| candidate)
}

fn folded(name: &str) -> Option<Vec<char>> {
    (name.len() <= MAX_LENGTH).then(|| name.chars().map(|c| c.to_ascii_lowercase()).collect())
}

/// Damerau–Levenshtein distance (optimal string alignment): insertions, deletions, replacements
/// and swaps of neighbours.
fn distance(a: &[char], b: &[char]) -> usize {
    let mut before: Vec<usize> = Vec::new();
    let mut last: Vec<usize> = (0..=b.len()).collect();
    for i in 1..=a.len() {
        let mut row = vec![i];
        for j in 1..=b.len() {
            let replaced = last[j - 1] + usize::from(a[i - 1] != b[j - 1]);
            let mut best = replaced.min(last[j] + 1).min(row[j - 1] + 1);
            if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                best = best.min(before[j - 2] + 1);
            }
            row.push(best);
        }
        before = std::mem::replace(&mut last, row);
    }
    last[b.len()]
}

#[cfg(test)]
mod tests {
    use super::nearest;

    #[test]
    fn finds_the_likely_name() {
        let kinds = ["camera", "light", "object", "medium", "render"];
        assert_eq!(nearest("objct", kinds), Some("object"));
        assert_eq!(nearest("ligth", kinds), Some("light"));
        assert_eq!(nearest("Camera", kinds), Some("camera"));
        assert_eq!(nearest("sphere", kinds), None);
        assert_eq!(nearest("", kinds), None);
    }

    #[test]
    fn short_names_allow_one_mistake() {
        assert_eq!(nearest("ta", ["at", "of"]), Some("at"));
        assert_eq!(nearest("xy", ["at", "of"]), None);
    }

    #[test]
    fn ties_go_by_the_alphabet_in_any_order() {
        assert_eq!(nearest("car", ["cat", "bar", "cab"]), Some("bar"));
        assert_eq!(nearest("car", ["cab", "cat", "bar"]), Some("bar"));
    }

    #[test]
    fn a_huge_name_is_no_work() {
        assert_eq!(nearest(&"a".repeat(1 << 20), ["a"]), None);
    }
}
