//! The questions as Calipers answers them: in f64, exactly, with proof.

use std::time::Duration;

use collision::{
    accuracy::{Accuracy, Tier},
    answer::{Certificate, Work},
    narrow::{self, Contacts, Depth, ImpactTouch, Motion, Placed, Separation, Warm},
    shape::Geometry,
};

use super::{
    rows::Operation,
    workload::{Crossing, Placement, Workload},
};
use crate::{
    errors::Proof,
    forms::{pose, vector},
    timing::spent,
};

const EXACT: Accuracy = Accuracy::of(Tier::Exact);

/// What turning impacts are asked for: 5 mm, which is what the peers leave open.
const TURNING: Accuracy = Accuracy { max_error: 0.005, max_error_relative: 0.0, ..EXACT };

/// Two placed geometries.
type Pair<'g> = [Placed<'g>; 2];

#[derive(Clone, Copy, Debug)]
struct Moving<'g> {
    pair: Pair<'g>,
    motion: Motion,
    motion_turning: Motion,
    way: f64,
    way_turning: f64,
}

/// All pairs of a workload.
#[derive(Debug)]
pub(crate) struct Side<'g> {
    near: Vec<Pair<'g>>,
    crossings: Vec<Moving<'g>>,
    /// What the last answer to each near pair left.
    warm: Vec<Warm>,
}

impl<'g> Side<'g> {
    /// The workload's pairs; `geometries` are those of its forms.
    pub(crate) fn new(geometries: &'g [Geometry], workload: &Workload) -> Self {
        let placed = |place: &Placement| Placed { geometry: &geometries[place.form], pose: pose(&place.place) };
        let moving = |crossing: &Crossing| {
            let motion = Motion { displacement_b: vector(crossing.displacement), ..Motion::default() };
            Moving {
                pair: [placed(&crossing.a), placed(&crossing.b)],
                motion,
                motion_turning: Motion { rotation_b: vector(crossing.turn), ..motion },
                way: crossing.way,
                way_turning: crossing.way_turning,
            }
        };
        Self {
            near: workload.near.iter().map(|pair| [placed(&pair[0]), placed(&pair[1])]).collect(),
            crossings: workload.crossings.iter().map(moving).collect(),
            warm: vec![Warm::default(); workload.near.len()],
        }
    }

    /// What the answers to all pairs prove.
    pub(crate) fn proofs(&mut self, operation: Operation) -> Vec<Proof> {
        let near = self.near.iter();
        let crossings = self.crossings.iter();
        match operation {
            Operation::Overlap => near.map(|pair| Proof::of_verdict(&overlap(pair))).collect(),
            Operation::Distance => near.map(|pair| of_separation(distance(pair))).collect(),
            Operation::DistanceWarm => {
                near.zip(&mut self.warm).map(|(pair, warm)| of_separation(distance_warm(pair, warm))).collect()
            }
            Operation::Depth => near.map(|pair| of_depth(depth(pair))).collect(),
            Operation::Manifold => near.map(|pair| of_contact(&manifold(pair))).collect(),
            Operation::ManifoldWarm => {
                near.zip(&mut self.warm).map(|(pair, warm)| of_contact(&manifold_warm(pair, warm))).collect()
            }
            Operation::Impact => crossings.map(|moving| of_impact(impact(moving), moving.way)).collect(),
            Operation::ImpactRotating => {
                crossings.map(|moving| of_impact(impact_rotating(moving), moving.way_turning)).collect()
            }
        }
    }

    /// Asks each pair once where the answer leaves something for the next one to start from.
    pub(crate) fn warm_up(&mut self, operation: Operation) {
        if matches!(operation, Operation::DistanceWarm | Operation::ManifoldWarm) {
            self.warm.fill(Warm::default());
            self.time(operation, self.near.len());
        }
    }

    /// CPU time of asking the first `count` pairs.
    pub(crate) fn time(&mut self, operation: Operation, count: usize) -> Duration {
        let near = self.near[..count].iter();
        let crossings = self.crossings[..count].iter();
        match operation {
            Operation::Overlap => spent(near, overlap),
            Operation::Distance => spent(near, distance),
            Operation::DistanceWarm => spent(near.zip(&mut self.warm), |(pair, warm)| distance_warm(pair, warm)),
            Operation::Depth => spent(near, depth),
            Operation::Manifold => spent(near, manifold),
            Operation::ManifoldWarm => spent(near.zip(&mut self.warm), |(pair, warm)| manifold_warm(pair, warm)),
            Operation::Impact => spent(crossings, impact),
            Operation::ImpactRotating => spent(crossings, impact_rotating),
        }
    }
}

fn overlap([a, b]: &Pair<'_>) -> Certificate {
    narrow::overlap(*a, *b, &EXACT, &mut Work::default())
}

fn distance([a, b]: &Pair<'_>) -> Option<Separation> {
    narrow::distance(*a, *b, f64::INFINITY, &EXACT, &mut Work::default())
}

fn distance_warm([a, b]: &Pair<'_>, warm: &mut Warm) -> Option<Separation> {
    narrow::distance_warm(*a, *b, f64::INFINITY, &EXACT, warm, &mut Work::default())
}

fn depth([a, b]: &Pair<'_>) -> Option<Depth> {
    narrow::depth(*a, *b, 0.0, &EXACT, &mut Work::default())
}

fn manifold([a, b]: &Pair<'_>) -> Contacts {
    narrow::penetration(*a, *b, 0.0, &EXACT, &mut Work::default()).expect("both are convex")
}

fn manifold_warm([a, b]: &Pair<'_>, warm: &mut Warm) -> Contacts {
    narrow::penetration_warm(*a, *b, 0.0, &EXACT, warm, &mut Work::default()).expect("both are convex")
}

fn impact(Moving { pair: [a, b], motion, .. }: &Moving<'_>) -> Option<ImpactTouch> {
    narrow::impact(*a, *b, motion, &EXACT, &mut Work::default())
}

fn impact_rotating(Moving { pair: [a, b], motion_turning, .. }: &Moving<'_>) -> Option<ImpactTouch> {
    narrow::impact(*a, *b, motion_turning, &TURNING, &mut Work::default())
}

fn of_separation(separation: Option<Separation>) -> Proof {
    let separation = separation.expect("no distance is beyond an infinite limit");
    Proof::of_value(&separation.certificate, separation.distance, 1.0)
}

fn of_depth(depth: Option<Depth>) -> Proof {
    depth.map_or(Proof::NONE, |depth| Proof::of_value(&depth.certificate, depth.depth, 1.0))
}

fn of_contact(contacts: &Contacts) -> Proof {
    contacts.first().map_or(Proof::NONE, |contact| Proof::of_value(&contact.certificate, contact.depth, 1.0))
}

fn of_impact(touch: Option<ImpactTouch>, way: f64) -> Proof {
    touch.map_or(Proof::NONE, |touch| Proof::of_value(&touch.certificate, touch.fraction, way))
}
