//! The order of definitions: each after those it uses.

use crate::source::Span;

/// A use of an item: its index and the place of its name.
pub(super) type Use = (usize, Span);

/// A chain of items of which each uses the next and the last uses the first; the place is where
/// the next one is used.
pub(super) type Cycle = Vec<(usize, Span)>;

/// Most cycles that are looked at; each may be as long as the file.
const MAX_CYCLES: usize = 32;

#[derive(Clone, Copy, PartialEq, Eq)]
enum State {
    New,
    Open,
    Done,
}

/// All items, each after those it uses (`edges[i]` are the uses of item `i`), and the cycles found.
///
/// Members of a cycle are in the order too, each once; their order among each other is arbitrary
/// but the same in every run.
pub(super) fn sort(edges: &[Vec<Use>]) -> (Vec<usize>, Vec<Cycle>) {
    let mut states = vec![State::New; edges.len()];
    let (mut order, mut cycles) = (Vec::new(), Vec::new());
    for root in 0..edges.len() {
        if states[root] != State::New {
            continue;
        }
        // Walk depth first; each open item knows how many of its uses were followed.
        let mut open = vec![(root, 0)];
        states[root] = State::Open;
        while let Some((item, followed)) = open.last_mut() {
            let Some(&(next, _)) = edges[*item].get(*followed) else {
                states[*item] = State::Done;
                order.push(*item);
                open.pop();
                continue;
            };
            *followed += 1;
            match states[next] {
                State::New => {
                    states[next] = State::Open;
                    open.push((next, 0));
                }
                State::Open if cycles.len() < MAX_CYCLES => cycles.push(cycle(&open, next, edges)),
                State::Open => {}
                State::Done => {}
            }
        }
    }
    (order, cycles)
}

/// The part of the open chain from `first` on, with the uses that were followed last.
fn cycle(open: &[(usize, usize)], first: usize, edges: &[Vec<Use>]) -> Cycle {
    let start = open.iter().position(|&(item, _)| item == first).unwrap_or(0);
    open[start..].iter().map(|&(item, followed)| (item, edges[item][followed - 1].1)).collect()
}
