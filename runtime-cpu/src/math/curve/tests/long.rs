//! Long curves: trees of capsules change nothing, and what they cost.

use super::*;
use crate::math::curve::feet::{feet_of, next_foot};
use std::time::Instant;
use vol_compiler::curve::{Capsule, CurveTable, FEW_PIECES};

/// Curves of many kinds: smooth, with corners and gaps, straight, back on themselves, with points twice.
pub(super) fn curve_of(dice: &mut Dice, kind: usize, count: usize) -> Vec<Quadratic> {
    let middle = |a: [f64; 3], b: [f64; 3]| std::array::from_fn(|k| 0.5 * (a[k] + b[k]));
    let step = 2.0 / (count as f64).sqrt();
    let mut at = dice.vector(1.0);
    let mut points = vec![at];
    for i in 0..2 * count + 1 {
        at = match kind {
            // Points of a grid: many feet at the same distance.
            0 => at.map(|x| (x + step * dice.roll()).round()),
            1 => [i as f64 * 0.1, 0.0, 0.0],
            2 if i % 5 == 0 => at,
            _ => along(at, step, dice.vector(1.0)),
        };
        points.push(at);
    }
    let smooth = |w: &[[f64; 3]]| Quadratic { a: middle(w[0], w[1]), b: w[1], c: middle(w[1], w[2]) };
    let free = |w: &[[f64; 3]]| Quadratic { a: w[0], b: w[1], c: w[2] };
    let gap = |w: &[[f64; 3]]| Quadratic { a: w[0], b: middle(w[0], w[1]), c: w[1] };
    let mut segments: Vec<Quadratic> = match kind {
        4 => points.windows(3).step_by(2).map(free).collect(),
        5 => points.windows(2).step_by(2).map(gap).collect(),
        _ => points.windows(3).map(smooth).collect(),
    };
    segments.truncate(count);
    segments
}

/// A point of interest: anywhere, on the curve, at a joint, near it, far away.
pub(super) fn point_near(dice: &mut Dice, segments: &[Quadratic], kind: usize) -> [f32; 3] {
    let segment = segments[((dice.unit() * segments.len() as f64) as usize).min(segments.len() - 1)];
    let at = match kind % 5 {
        0 => dice.vector(2.0),
        1 => segment.a,
        2 => along(segment.c, 1e-3, dice.vector(1.0)),
        3 => along(segment.b, 0.3, dice.vector(1.0)),
        _ => dice.vector(1e4),
    };
    at.map(|x| x as f32)
}

#[test]
fn trees_change_nothing() {
    let mut dice = Dice(71);
    let mut passed_over = 0;
    for kind in 0..6 {
        for count in [1, 7, 17, 40, 200, 1500] {
            let segments = curve_of(&mut dice, kind, count);
            let CurveTable { pieces, nodes, .. } = prepare(&segments);
            assert_eq!(nodes.is_empty(), pieces.len() <= FEW_PIECES);
            for i in 0..200 {
                let p = point_near(&mut dice, &segments, i);
                let (found, all) = (closest(p, &pieces, &nodes), closest(p, &pieces, &[]));
                assert_eq!(found, all, "{kind} {count} {p:?}");
                let moves = (closest_gradient(p, &pieces, &nodes), closest_gradient(p, &pieces, &[]));
                assert_eq!(moves.0, moves.1, "{kind} {count} {p:?}");
                let near = nodes.iter().filter(|n| nodes::may_hold(p, &n.capsule, all.distance));
                passed_over += usize::from(near.count() < nodes.len() / 4);
            }
        }
    }
    assert!(passed_over > 2000, "capsules help at {passed_over} points");
}

/// Far from the origin the ends of capsules are rounded by more than their room.
#[test]
fn a_leaf_is_within_its_reach() {
    let mut dice = Dice(74);
    for _ in 0..400 {
        let start = 2000.0 * dice.roll();
        let place = |i: f64| [start + 1e-3 * i, 0.0, 0.0];
        let segment = |i: f64| Quadratic { a: place(i), b: place(i + 0.5), c: place(i + 1.0) };
        let segments: Vec<Quadratic> = (0..20).map(f64::from).map(segment).collect();
        let CurveTable { pieces, nodes, .. } = prepare(&segments);
        let leaves = nodes.iter().enumerate().filter(|(at, node)| node.skip as usize == at + 1);
        for (_, leaf) in leaves {
            for offset in [-2e-3, 0.0, 0.01, 0.023] {
                let p = [(start + offset) as f32, 0.0, 0.0];
                let found = foot(p, &pieces[leaf.first as usize]).dist_sq.sqrt();
                let reach = nodes::reach_into(p, &leaf.capsule);
                assert!(found <= reach, "{found} {reach} {p:?} {leaf:?}");
            }
        }
    }
}

/// Whether a capsule holds a point, in f64.
fn holds(capsule: &Capsule, point: [f64; 3]) -> bool {
    let line = capsule.along.map(f64::from);
    let way: [f64; 3] = std::array::from_fn(|k| point[k] - f64::from(capsule.start[k]));
    let dot = |a: [f64; 3], b: [f64; 3]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let part = (dot(way, line) * f64::from(capsule.per_length_sq)).clamp(0.0, 1.0);
    let off: [f64; 3] = std::array::from_fn(|k| way[k] - part * line[k]);
    dot(off, off).sqrt() < f64::from(capsule.radius)
}

#[test]
fn capsules_hold_their_pieces() {
    let mut dice = Dice(72);
    for shift in [0.0, 1000.0] {
        let segments: Vec<Quadratic> = curve_of(&mut dice, 3, 100)
            .into_iter()
            .map(|s| Quadratic {
                a: s.a.map(|x| x + shift),
                b: s.b.map(|x| x + shift),
                c: s.c.map(|x| x + shift),
            })
            .collect();
        let CurveTable { pieces, nodes, .. } = prepare(&segments);
        for node in &nodes {
            for piece in &pieces[node.first as usize..node.end as usize] {
                for i in 0..=8 {
                    let t = f64::from(i) / 8.0;
                    let at: [f64; 3] = std::array::from_fn(|k| {
                        let curve = f64::from(piece.b1[k]) * 2.0 * t + f64::from(piece.b2[k]) * t * t;
                        f64::from(piece.origin[k]) + f64::from(piece.origin_low[k]) + curve
                    });
                    let in_box =
                        (0..3).all(|k| f64::from(piece.lo[k]) < at[k] && at[k] < f64::from(piece.hi[k]));
                    assert!(holds(&node.capsule, at) && in_box, "{node:?} {piece:?}");
                }
            }
        }
        // Every piece is in exactly one leaf, in order.
        let leaves = nodes.iter().enumerate().filter(|(i, node)| node.skip as usize == i + 1);
        let order: Vec<u32> = leaves.flat_map(|(_, node)| node.first..node.end).collect();
        assert_eq!(order, (0..pieces.len() as u32).collect::<Vec<_>>());
    }
}

/// All feet of a point, with those of the reference.
fn all_feet(p: [f32; 3], table: &CurveTable, most: f32, closed: bool) -> Vec<CurvePoint> {
    let (mut from, mut feet) = (0.0, Vec::new());
    loop {
        let found = next_foot(p, [from, most, f32::from(u8::from(closed))], &table.pieces, &table.nodes);
        if found.point.distance > most {
            return feet;
        }
        assert!(found.next > from, "{found:?}");
        from = found.next;
        feet.push(found.point);
    }
}

#[test]
fn feet_agree_with_f64() {
    let mut dice = Dice(73);
    let (mut compared, mut several, mut lost) = (0, 0, 0);
    for round in 0..120 {
        let (kind, count) = (2 + round % 4, [1, 3, 8, 24][round / 4 % 4]);
        let mut segments = curve_of(&mut dice, kind, count);
        let closed = round % 3 == 0 && count > 1;
        if closed {
            let last = segments.len() - 1;
            segments[last].c = segments[0].a;
        }
        let table = prepare(&segments);
        for i in 0..20 {
            let p = point_near(&mut dice, &segments, if i % 5 == 4 { 3 } else { i });
            let most = 1.0 + dice.unit();
            let found = all_feet(p, &table, most as f32, closed);
            let mut truth = Vec::new();
            let (mut from, mut sure) = (0, true);
            loop {
                let next = reference::next_foot(p.map(f64::from), &segments, from, most, closed);
                let Some(point) = next.point else { break };
                sure &= point.stretch > 0.05 && (point.distance - most).abs() > 1e-5;
                from = next.next;
                truth.push(point);
            }
            if found.len() != truth.len() {
                // A foot may be born or lost where two feet meet, or at the limit.
                lost += 1;
                continue;
            }
            several += usize::from(found.len() > 1);
            for (found, truth) in found.iter().zip(&truth).filter(|_| sure) {
                let off = (f64::from(found.distance) - truth.distance).abs();
                let along = (f64::from(found.arc_length) - truth.arc_length).abs();
                // The seam of a closed curve has two arc lengths.
                let along = if closed { along.min((table.length - along).abs()) } else { along };
                assert!(off < 4e-6 && along < 2e-4, "{segments:?} {p:?}: {found:?} {truth:?}");
                compared += 1;
            }
        }
    }
    assert!(lost < 8 && compared > 2000 && several > 500, "{lost} {compared} {several}");
}

#[test]
fn a_foot_beside_a_joint_is_one() {
    // A smooth curve, closed or not, and points whose only near foot slides over all joints, at every
    // f32 place around them.
    let middle = |a: [f64; 3], b: [f64; 3]| std::array::from_fn(|k| 0.5 * (a[k] + b[k]));
    let ring: Vec<[f64; 3]> = (0..12)
        .map(|i| {
            let angle = f64::from(i) * std::f64::consts::TAU / 12.0;
            [2.0 * angle.cos(), 0.3 * (3.0 * angle).sin(), 2.0 * angle.sin()]
        })
        .collect();
    let at = |i: usize| ring[i % 12];
    let segments: Vec<Quadratic> = (0..12)
        .map(|i| Quadratic { a: middle(at(i), at(i + 1)), b: at(i + 1), c: middle(at(i + 1), at(i + 2)) })
        .collect();
    let table = prepare(&segments);
    assert!(table.pieces.len() > FEW_PIECES);
    let mut dice = Dice(74);
    let (mut at_joints, mut ends) = (0, 0);
    for i in 0..6000 {
        let joint = segments[i % 12].a;
        let tiny = 10f64.powf(-3.0 - 5.0 * dice.unit());
        let p = along(along(joint, 0.2, dice.vector(0.5)), tiny, dice.vector(1.0));
        // Into the plane across the curve at the joint, but for the tiny part.
        let tangent = along(segments[i % 12].b, -1.0, joint);
        let lean = dot64(along(p, -1.0, joint), tangent) / dot64(tangent, tangent);
        let p = along(along(p, -lean, tangent), tiny * dice.roll(), tangent).map(|x| x as f32);
        let feet = all_feet(p, &table, 0.5, true);
        assert_eq!(feet.len(), 1, "{p:?} {feet:?}");
        let near = table.pieces.iter().flat_map(|piece| feet_of(p, piece, true));
        at_joints += near.filter(|&t| t == 0.0 || t == 1.0).count();
        if i % 12 == 0 {
            ends += usize::from(all_feet(p, &table, 0.5, false).len() != 1);
        }
    }
    // Not closed, the start is a foot as well as the end behind it, or neither is.
    assert!(at_joints > 50 && ends > 100, "{at_joints} {ends}");
}

/// Time of a search with and without boxes; run with `--ignored --nocapture`.
#[test]
#[ignore = "a measurement"]
fn cost_by_length() {
    for count in [1, 10, 100, 1000, 10_000] {
        let mut dice = Dice(5);
        let segments = curve_of(&mut dice, 3, count);
        let start = Instant::now();
        let table = prepare(&segments);
        let prepared = start.elapsed();
        let points: Vec<[f32; 3]> = (0..4000).map(|i| point_near(&mut dice, &segments, i % 4)).collect();
        let time = |nodes: &[Node]| {
            let start = Instant::now();
            let sum: f32 = points.iter().map(|&p| closest(p, &table.pieces, nodes).distance).sum();
            (start.elapsed().as_secs_f64() / points.len() as f64 * 1e9, sum)
        };
        println!(
            "{count}: {:.0} ns, all {:.0} ns, prepared in {prepared:?}",
            time(&table.nodes).0,
            time(&[]).0
        );
    }
}
