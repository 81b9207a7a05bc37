//! Which instructions are alike for several places.
//!
//! In: searches that do not need each other. Out: loops of rows, each an instruction of every place: the searches, and what
//! follows from the search of one place alone. Places that are alike in everything have a loop, if they are many; the others
//! share one as far as they are alike. Instructions are alike if they do the same with
//! values that are alike; numbers from elsewhere and the curve may differ. Pairs are found in the order of the instructions; a pair that
//! could have been chosen better costs a number from a table, never a wrong value.

use crate::ir::{Function, Inst, ValueId};
use std::collections::{BTreeMap, BTreeSet};

/// A point and the number of a curve.
type Place = (Vec<ValueId>, u32);

/// What a value follows from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Source {
    /// No place.
    Elsewhere,
    /// One place, by number.
    Place(usize),
    /// Several.
    Places,
}

/// Fewest places with a loop of their own, if it is not all of them: each loop is another search in the text.
const LEAST_PLACES: usize = 4;

/// Instructions that a place may have more than the others of its loop: the first tube of a union also meets what is before it.
const MOST_MORE: usize = 4;

/// For each loop its rows of values by place, operands before what reads them; no loop where there are not two places.
pub(super) fn loops(function: &Function, roots: &[ValueId]) -> Vec<Vec<Vec<ValueId>>> {
    let (sources, count) = sources(function, roots);
    let mut places: Vec<Vec<ValueId>> = vec![Vec::new(); count];
    for (value, source) in (0..).map(ValueId).zip(&sources) {
        if let Source::Place(place) = source {
            places[*place].push(value);
        }
    }
    // The shortest first: the others may have more.
    places.sort_by_key(Vec::len);
    let mut loops = Vec::new();
    let mut others = Vec::new();
    while let Some(first) = places.first() {
        let is_alike = |place: &Vec<ValueId>| {
            place.len() <= first.len() + MOST_MORE
                && paired(function, &sources, first, place).iter().all(Option::is_some)
        };
        let (alike, rest): (Vec<_>, Vec<_>) = places.iter().cloned().partition(is_alike);
        if alike.len() >= LEAST_PLACES {
            loops.push(rows(function, &sources, alike));
        } else {
            others.extend(alike);
        }
        places = rest;
    }
    // What is left shares at least the search.
    if others.len() > 1 {
        loops.push(rows(function, &sources, others));
    }
    loops.retain(|rows| !rows.is_empty());
    loops
}

/// The rows that all places have.
fn rows(function: &Function, sources: &[Source], mut places: Vec<Vec<ValueId>>) -> Vec<Vec<ValueId>> {
    // In the order of the text, in which curves and uniforms most often follow a rule.
    places.sort();
    let first = &places[0];
    let pairs: Vec<_> = places.iter().map(|place| paired(function, sources, first, place)).collect();
    let mut rows: Vec<Vec<ValueId>> = Vec::new();
    let mut kept = BTreeSet::new();
    for (row, &value) in first.iter().enumerate() {
        let values: Option<Vec<ValueId>> = pairs.iter().map(|found| found[row]).collect();
        let is_there =
            |operand: &ValueId| sources[operand.index()] == Source::Elsewhere || kept.contains(operand);
        let complete = function.insts[value.index()].operands().iter().all(is_there);
        if let (Some(values), true) = (values, complete) {
            kept.insert(value);
            rows.push(values);
        }
    }
    rows
}

/// What each value follows from, and the number of places.
fn sources(function: &Function, roots: &[ValueId]) -> (Vec<Source>, usize) {
    let mut places: Vec<Place> = Vec::new();
    let mut sources: Vec<Source> = Vec::with_capacity(function.insts.len());
    let mut next_root = roots.iter().peekable();
    for (value, inst) in (0..).map(ValueId).zip(&function.insts) {
        let source = if next_root.next_if(|&&root| root == value).is_some()
            && let Inst::Apply { data, args, .. } = inst
        {
            let place = (args.clone(), *data);
            let known = places.iter().position(|other| *other == place);
            Source::Place(known.unwrap_or_else(|| {
                places.push(place);
                places.len() - 1
            }))
        } else {
            let operands = inst.operands().iter().map(|operand| sources[operand.index()]);
            operands.fold(Source::Elsewhere, joined)
        };
        sources.push(source);
    }
    (sources, places.len())
}

fn joined(a: Source, b: Source) -> Source {
    match (a, b) {
        (Source::Elsewhere, other) | (other, Source::Elsewhere) => other,
        (a, b) if a == b => a,
        _ => Source::Places,
    }
}

/// For each of the `first` values that of `others` which is alike, if there is one.
fn paired(
    function: &Function,
    sources: &[Source],
    first: &[ValueId],
    others: &[ValueId],
) -> Vec<Option<ValueId>> {
    let row_of: BTreeMap<ValueId, usize> =
        first.iter().enumerate().map(|(row, &value)| (value, row)).collect();
    let mut pairs = vec![None; first.len()];
    let mut row_of_other: BTreeMap<ValueId, usize> = BTreeMap::new();
    let mut next = 0;
    for &other in others {
        let is_alike = |&row: &usize| {
            let (a, b) = (&function.insts[first[row].index()], &function.insts[other.index()]);
            let same = |(a, b): (&ValueId, &ValueId)| {
                // Of a place, or both from elsewhere.
                let is_paired = row_of.get(a) == row_of_other.get(b);
                is_paired
                    && (row_of.contains_key(a) || sources[b.index()] == Source::Elsewhere)
                    && function.ty(*a) == function.ty(*b)
            };
            pairs[row].is_none() && same_kind(a, b) && a.operands().iter().zip(b.operands()).all(same)
        };
        // Most often the next one.
        if let Some(row) = (next..first.len()).chain(0..next).find(is_alike) {
            pairs[row] = Some(other);
            row_of_other.insert(other, row);
            next = row + 1;
        }
    }
    pairs
}

/// Whether two instructions do the same; the curve may differ.
fn same_kind(a: &Inst, b: &Inst) -> bool {
    match (a, b) {
        (Inst::Apply { op, data, .. }, Inst::Apply { op: other, data: others, .. }) => {
            op == other && (data == others || op.reads_curve())
        }
        (Inst::Extract(_, part), Inst::Extract(_, other)) => part == other,
        (Inst::Loop { most, body, args }, Inst::Loop { most: others, body: other, args: more }) => {
            most == others && body == other && args.len() == more.len()
        }
        _ => false,
    }
}
