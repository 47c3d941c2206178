//! What it costs to keep boxes in a tree: both engines get the same boxes, which f32 holds exactly. After each row the
//! pairs of overlapping boxes are counted through both trees, which is how a box that was lost would show.

mod ours;
mod parry;

use collision::math::Aabb;

use super::{
    obvhs,
    rows::TreeWork,
    workload::{Bounds, Change, Step, Workload},
};
use crate::{
    errors::{Errors, Proof},
    timing::{self, Times, time_of},
};

/// Measures one row.
pub(super) fn measure(workload: &Workload, work: TreeWork) -> (Times, Errors) {
    match work {
        TreeWork::Insert => insert(workload),
        TreeWork::Bulk => bulk(workload),
        TreeWork::MoveNear => rounds(
            workload,
            Step::Near,
            |tree, change| tree.update(change.shape, change.bounds.to_f64()),
            |tree, change| tree.update(change.shape, parry::bounds(&change.bounds)),
        ),
        // In parry3d, boxes that only grow in place are fast to move and slow to search: see the row of rays after moves.
        TreeWork::MoveFar => rounds(
            workload,
            Step::Far,
            |tree, change| tree.update(change.shape, change.bounds.to_f64()),
            |tree, change| tree.remove_and_insert(change.shape, parry::bounds(&change.bounds)),
        ),
        TreeWork::RemoveInsert => rounds(
            workload,
            Step::Anywhere,
            |tree, change| tree.remove_and_insert(change.shape, change.bounds.to_f64()),
            |tree, change| tree.remove_and_insert(change.shape, parry::bounds(&change.bounds)),
        ),
        TreeWork::Pairs => pairs(workload),
    }
}

fn both(boxes: &[Bounds]) -> (Vec<Aabb>, Vec<parry3d::bounding_volume::Aabb>) {
    (boxes.iter().map(|bounds| bounds.to_f64()).collect(), boxes.iter().map(parry::bounds).collect())
}

fn ours_of(boxes: &[Aabb]) -> ours::Tree {
    let mut tree = ours::Tree::default();
    (0..).zip(boxes).for_each(|(leaf, bounds)| tree.insert(leaf, *bounds));
    tree.settle();
    tree
}

fn parry_of(boxes: &[parry3d::bounding_volume::Aabb]) -> parry::Tree {
    let mut tree = parry::Tree::new();
    (0..).zip(boxes).for_each(|(leaf, bounds)| tree.insert(leaf, *bounds));
    tree
}

fn insert(workload: &Workload) -> (Times, Errors) {
    let (boxes, parry_boxes) = both(&workload.boxes);
    let times =
        timing::compare_whole(boxes.len(), || time_of(|| ours_of(&boxes)), || time_of(|| parry_of(&parry_boxes)));
    let parry = degrees(boxes.len(), |see| parry_of(&parry_boxes).visit_pairs(see));
    (times, compare(&degrees(boxes.len(), |see| ours_of(&boxes).visit_pairs(&boxes, see)), &parry))
}

fn bulk(workload: &Workload) -> (Times, Errors) {
    let (boxes, parry_boxes) = both(&workload.boxes);
    let times = timing::compare_whole(
        boxes.len(),
        || time_of(|| ours::bulk(&boxes)),
        || time_of(|| parry::Tree::bulk(&parry_boxes)),
    );
    let obvhs_boxes = obvhs::boxes(&workload.boxes);
    let times = times.beside_obvhs(|_| time_of(|| obvhs::build(&obvhs_boxes)));
    let ours = degrees(boxes.len(), |see| ours::visit_pairs_of_bulk(&ours::bulk(&boxes), &boxes, see));
    (times, compare(&ours, &degrees(boxes.len(), |see| parry::Tree::bulk(&parry_boxes).visit_pairs(see))))
}

fn pairs(workload: &Workload) -> (Times, Errors) {
    let (boxes, parry_boxes) = both(&workload.boxes);
    let ours = ours_of(&boxes);
    let mut parry = parry::Tree::bulk(&parry_boxes);
    let times = timing::compare_whole(
        boxes.len(),
        || time_of(|| number_of_pairs(|see| ours.visit_pairs(&boxes, see))),
        || time_of(|| number_of_pairs(|see| parry.visit_pairs(see))),
    );
    let errors = compare(
        &degrees(boxes.len(), |see| ours.visit_pairs(&boxes, see)),
        &degrees(boxes.len(), |see| parry.visit_pairs(see)),
    );
    (times, errors)
}

/// Where the boxes are after some rounds.
#[derive(Clone, Debug, PartialEq)]
struct Rounds {
    round: u64,
    boxes: Vec<Bounds>,
}

impl Rounds {
    fn next(&mut self, workload: &Workload, step: Step) -> Vec<Change> {
        self.round += 1;
        workload.round(step, self.round, &mut self.boxes)
    }
}

/// Rounds of changes, each engine doing the same ones in the same order.
fn rounds(
    workload: &Workload,
    step: Step,
    mut change_ours: impl FnMut(&mut ours::Tree, &Change),
    mut change_parry: impl FnMut(&mut parry::Tree, &Change),
) -> (Times, Errors) {
    let (boxes, parry_boxes) = both(&workload.boxes);
    let (mut ours, mut parry) = (ours_of(&boxes), parry::Tree::bulk(&parry_boxes));
    let mut rounds_ours = Rounds { round: 0, boxes: workload.boxes.clone() };
    let mut rounds_parry = rounds_ours.clone();
    let count = rounds_ours.clone().next(workload, step).len();
    let times = timing::compare_whole(
        count,
        || {
            let changes = rounds_ours.next(workload, step);
            time_of(|| {
                for changes in changes.chunks(ours::CHANGES_TOGETHER) {
                    ours.read_ahead(changes.iter().map(|change| change.shape));
                    changes.iter().for_each(|change| change_ours(&mut ours, change));
                }
                ours.settle();
            })
        },
        || {
            let changes = rounds_parry.next(workload, step);
            time_of(|| {
                changes.iter().for_each(|change| change_parry(&mut parry, change));
                if step == Step::Near {
                    parry.refit();
                }
            })
        },
    );
    assert_eq!(rounds_ours, rounds_parry, "both did the same");
    let (boxes, _) = both(&rounds_ours.boxes);
    let errors = compare(
        &degrees(boxes.len(), |see| ours.visit_pairs(&boxes, see)),
        &degrees(boxes.len(), |see| parry.visit_pairs(see)),
    );
    (times, errors)
}

fn number_of_pairs(visit: impl FnOnce(&mut dyn FnMut(u32, u32))) -> u64 {
    let mut count = 0;
    visit(&mut |_, _| count += 1);
    count
}

/// How many boxes of higher number each box overlaps, and the sum of their numbers.
type Degrees = Vec<(u32, u64)>;

fn degrees(count: usize, visit: impl FnOnce(&mut dyn FnMut(u32, u32))) -> Degrees {
    let mut degrees = vec![(0, 0); count];
    visit(&mut |a, b| {
        let degree = &mut degrees[a.min(b) as usize];
        *degree = (degree.0 + 1, degree.1 + u64::from(a.max(b)));
    });
    degrees
}

/// A box counts as hit if it overlaps one of higher number; the peer is wrong where it finds others.
fn compare(ours: &Degrees, parry: &Degrees) -> Errors {
    let proofs: Vec<Proof> = ours.iter().map(|degree| if degree.0 > 0 { Proof::SOME } else { Proof::NONE }).collect();
    let claims = ours.iter().zip(parry).map(|(ours, parry)| match (ours == parry, ours.0 > 0) {
        (true, true) | (false, false) => Some(0.0),
        (true, false) | (false, true) => None,
    });
    Errors::between(&proofs, &claims.collect::<Vec<_>>())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_trees_hold_the_same_boxes_after_every_kind_of_work() {
        let workload = Workload::new(1000);
        for work in [
            TreeWork::Insert,
            TreeWork::Bulk,
            TreeWork::MoveNear,
            TreeWork::MoveFar,
            TreeWork::RemoveInsert,
            TreeWork::Pairs,
        ] {
            let (times, errors) = measure(&workload, work);
            assert_eq!(errors.peer_wrong_count, 0, "{work:?}");
            assert!((0.1..0.9).contains(&errors.hit_share), "{work:?}: {}", errors.hit_share);
            assert!(times.calipers_ns > 0.0 && times.parry_ns > 0.0);
        }
    }
}
