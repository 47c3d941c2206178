//! The two sets whose questions are about a whole world: streams of moves, and pairs of boxes.

use std::{
    collections::{BTreeMap, BTreeSet, HashMap},
    ops::ControlFlow,
    time::{Duration, Instant},
};

use collision::{
    answer::Work,
    broad::{ALL_LAYERS, StaticTree, Tree},
    math::Aabb,
};
use glam::DVec3;

use super::{Asker, ContactAnswer, FaultKind, Limit, Near, Outcome, PairTally, Stage, Verdict, tolerance};
use crate::sets::{
    Form,
    aabb::{BoxSet, pair_hash},
    stream::{ActorKind, Change, Frame},
};

/// The form of an actor, as the format says.
pub(super) fn actor_form(kind: ActorKind) -> Form {
    match kind {
        ActorKind::Car => Form::Cuboid { half_extents: DVec3::new(59.0, 42.0, 18.0) },
        ActorKind::Ball => Form::Sphere { radius: 91.25 },
    }
}

/// Actors are numbered from 0, shapes from 1.
pub(super) fn shape_id(actor: u64) -> u64 {
    actor + 1
}

/// Pairs nearer than this are listed.
const CLOSE: f64 = 100.0;

/// The size that errors of a frame are relative to: the largest of the forms, and the distance that is looked at.
const FRAME_SCALE: f64 = CLOSE;

/// Plays a stream, one tick for each frame, and judges the close pairs after each. The category is `frame`.
///
/// # Errors
/// There is no world to play it in.
pub(super) fn play(asker: &mut dyn Asker, frames: &[Frame]) -> Result<Vec<(u64, Outcome, Duration)>, String> {
    let mut stage = asker.stage()?;
    let mut alive = BTreeSet::new();
    let mut outcomes = Vec::with_capacity(frames.len());
    for frame in frames {
        for change in &frame.changes {
            match change {
                Change::Move { actor, .. } => alive.insert(*actor),
                Change::Remove { actor } => alive.remove(actor),
            };
        }
        let actors: Vec<u64> = alive.iter().copied().collect();
        let start = Instant::now();
        let found = ask_frame(stage.as_mut(), frame, &actors);
        let time = start.elapsed();
        let outcome = match found {
            Ok(found) => judge_frame(frame, &found),
            Err(reason) => {
                let mut outcome = Outcome::default();
                outcome.fault(FaultKind::Unanswered, reason);
                outcome
            }
        };
        outcomes.push((frame.number, outcome, time));
    }
    Ok(outcomes)
}

/// What was found after a frame: what is near each actor, and the contacts of those that overlap something.
struct Found {
    near: BTreeMap<(u64, u64), Near>,
    contacts: HashMap<(u64, u64), ContactAnswer>,
}

fn ask_frame(stage: &mut dyn Stage, frame: &Frame, actors: &[u64]) -> Result<Found, String> {
    stage.tick(&frame.changes)?;
    let mut found = Found { near: BTreeMap::new(), contacts: HashMap::new() };
    let lists = stage.neighbors(actors, CLOSE);
    for (&actor, list) in actors.iter().zip(lists) {
        let list = list?;
        let overlaps = list.iter().any(|(_, near)| near.distance <= 0.0);
        found.near.extend(list.into_iter().map(|(other, near)| ((actor, other), near)));
        if overlaps {
            let contacts = stage.contacts(actor)?;
            found.contacts.extend(contacts.into_iter().map(|(other, contact)| ((actor, other), contact)));
        }
    }
    Ok(found)
}

fn judge_frame(frame: &Frame, found: &Found) -> Outcome {
    let mut outcome = Outcome::default();
    let both_ways = |&(a, b, distance): &(u64, u64, f64)| [((a, b), distance), ((b, a), distance)];
    let expected: BTreeMap<(u64, u64), f64> = frame.close_pairs.iter().flat_map(both_ways).collect();
    for (&(a, b), &distance) in &expected {
        match (found.near.get(&(a, b)), found.contacts.get(&(a, b))) {
            (Some(near), _) if distance > 0.0 => compare(&mut outcome, (a, b), near.distance, distance),
            (Some(_), Some(contact)) => compare(&mut outcome, (a, b), -contact.depth, distance),
            // Whether a pair at the limit is in the list is for the decimals to say.
            (None, _) if distance > CLOSE - tolerance::STREAM_DECIMALS => {}
            _ => outcome.fault(FaultKind::Verdict, format!("{a} and {b}: nothing found, expected {distance}")),
        }
    }
    for (&(a, b), near) in &found.near {
        if near.claim.verdict != Verdict::Hit {
            outcome.fault(FaultKind::Verdict, format!("{a} and {b}: {:?}", near.claim.verdict));
        }
        if !expected.contains_key(&(a, b)) && near.distance < CLOSE - tolerance::STREAM_DECIMALS {
            outcome.fault(FaultKind::Verdict, format!("{a} and {b}: {} found, nothing expected", near.distance));
        }
        if let Some(&distance) = expected.get(&(a, b)) {
            let slack = tolerance::STREAM_DECIMALS + tolerance::REFERENCE * FRAME_SCALE;
            outcome.hold(&format!("{a} and {b}"), &near.claim, distance.max(0.0), slack);
        }
    }
    outcome
}

fn compare(outcome: &mut Outcome, (a, b): (u64, u64), value: f64, truth: f64) {
    let tolerance = tolerance::STREAM_DECIMALS + tolerance::DISTANCE * FRAME_SCALE;
    outcome.compare(&format!("{a} and {b}:"), value, truth, Limit { tolerance, scale: FRAME_SCALE });
}

/// Builds a tree over boxes, asks it for the overlaps of each, and counts the pairs.
///
/// # Errors
/// The boxes are too many to number.
pub(super) fn pairs_of_boxes(set: &BoxSet) -> Result<PairTally, String> {
    let boxes: Vec<Aabb> = set.boxes.iter().map(|&(min, max)| Aabb::new(min, max)).collect();
    let tree = StaticTree::build(&boxes);
    let mut work = Work::default();
    let mut tally = PairTally { count: 0, hash: 0 };
    for (first, query) in boxes.iter().enumerate() {
        let first = u32::try_from(first).map_err(|error| error.to_string())?;
        let result = tree.visit_box(*query, ALL_LAYERS, &mut work, |_, second| {
            // A tree may name leaves that are merely near: the boxes decide.
            if first < second && query.intersects(boxes[second as usize]) {
                tally.count += 1;
                tally.hash = tally.hash.wrapping_add(pair_hash(u64::from(first), u64::from(second)));
            }
            Ok(ControlFlow::Continue(()))
        });
        match result {
            Ok(()) => {}
            Err(never) => match never {},
        }
    }
    Ok(tally)
}

/// Compares what was counted with what is expected.
pub(super) fn judge_boxes(set: &BoxSet, found: Result<PairTally, String>) -> Outcome {
    let mut outcome = Outcome::default();
    let expected = PairTally { count: set.pair_count, hash: set.pair_hash };
    match found {
        Err(reason) => outcome.fault(FaultKind::Unanswered, reason),
        Ok(tally) if tally != expected => {
            outcome.fault(FaultKind::Value, format!("{tally:?}, expected {expected:?}"));
        }
        Ok(_) => {}
    }
    outcome
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{check::Claim, scene::Random};

    #[test]
    fn the_tree_counts_what_every_pair_counts() {
        let mut random = Random::new(5);
        let mut place = |low: f64, high: f64| {
            DVec3::new(random.uniform(low, high), random.uniform(low, high), random.uniform(low, high))
        };
        let boxes: Vec<(DVec3, DVec3)> = (0..300)
            .map(|_| {
                let min = place(0.0, 10.0);
                (min, min + place(0.0, 1.5))
            })
            .collect();
        let meets = |a: (DVec3, DVec3), b: (DVec3, DVec3)| a.0.cmple(b.1).all() && b.0.cmple(a.1).all();
        let mut expected = PairTally { count: 0, hash: 0 };
        for j in 0..boxes.len() {
            for i in 0..j {
                if meets(boxes[i], boxes[j]) {
                    expected.count += 1;
                    expected.hash = expected.hash.wrapping_add(pair_hash(i as u64, j as u64));
                }
            }
        }
        assert!(expected.count > 100, "{}", expected.count);
        let set = BoxSet { boxes, pair_count: expected.count, pair_hash: expected.hash };
        assert!(judge_boxes(&set, pairs_of_boxes(&set)).faults.is_empty());
        let wrong = BoxSet { pair_count: expected.count + 1, ..set };
        assert_eq!(judge_boxes(&wrong, pairs_of_boxes(&wrong)).faults.len(), 1);
    }

    #[test]
    fn frames_are_judged_from_both_sides() {
        let near = |distance: f64| Near {
            distance,
            point_on_a: DVec3::ZERO,
            point_on_b: DVec3::ZERO,
            normal_b_to_a: None,
            claim: Claim { verdict: Verdict::Hit, lower: distance, upper: distance },
        };
        let frame = Frame { number: 1, changes: vec![], close_pairs: vec![(0, 1, 50.0)] };
        let faults = |pairs: &[((u64, u64), f64)]| {
            let near = pairs.iter().map(|&(pair, distance)| (pair, near(distance))).collect();
            judge_frame(&frame, &Found { near, contacts: HashMap::new() }).faults.len()
        };
        assert_eq!(faults(&[((0, 1), 50.0), ((1, 0), 50.0)]), 0);
        assert_eq!(faults(&[((0, 1), 50.0)]), 1, "one side is missing");
        assert_eq!(faults(&[((0, 1), 50.0), ((1, 0), 50.0), ((0, 2), 60.0)]), 1, "one pair too many");
        assert_eq!(faults(&[((0, 1), 50.1), ((1, 0), 50.0)]), 2, "a value and its interval are off");
    }
}
