//! The questions as parry3d answers them: in f32, without bounds.

use std::time::Duration;

use parry3d::{
    math::{Pose, Rotation, Vector},
    query::{
        self, Contact, ContactManifold, DefaultQueryDispatcher, PersistentQueryDispatcher, ShapeCastHit,
        ShapeCastOptions, Sweep, SweepToiOutput, SweepToiStatus, ToiProxy,
    },
    shape::Shape,
};

use super::{
    rows::Operation,
    workload::{Crossing, Placement, Workload},
};
use crate::{forms::parry_pose, timing::spent};

/// How near shapes must be to count as touching, metres: as for Calipers.
const PREDICTION: f32 = 0.0;

/// How near shapes must come to count as touching when they turn, metres: the library's own advice.
const SLOP: f32 = 0.005;

const SUPPORTED: &str = "all kinds of the workload are supported";

#[derive(Clone, Copy)]
struct Placed<'s> {
    shape: &'s dyn Shape,
    pose: Pose,
}

type Pair<'s> = [Placed<'s>; 2];

#[derive(Clone, Copy)]
struct Moving<'s> {
    pair: Pair<'s>,
    displacement: Vector,
    /// Where `b` is at the end if it turns.
    end: Pose,
    way: f64,
    way_turning: f64,
}

/// What one pair keeps from one question to the next.
type Manifolds = Vec<ContactManifold<(), ()>>;

/// All pairs of a workload.
pub(crate) struct Side<'s> {
    near: Vec<Pair<'s>>,
    crossings: Vec<Moving<'s>>,
    manifolds: Vec<Manifolds>,
}

impl<'s> Side<'s> {
    /// The workload's pairs; `shapes` are those of its forms.
    pub(crate) fn new(shapes: &'s [Box<dyn Shape>], workload: &Workload) -> Self {
        let placed = |place: &Placement| Placed { shape: &*shapes[place.form], pose: parry_pose(&place.place) };
        Self {
            near: workload.near.iter().map(|pair| [placed(&pair[0]), placed(&pair[1])]).collect(),
            crossings: workload
                .crossings
                .iter()
                .map(|crossing| moving([placed(&crossing.a), placed(&crossing.b)], crossing))
                .collect(),
            manifolds: vec![Manifolds::new(); workload.near.len()],
        }
    }

    /// Its answers to all pairs, metres; `None` where it says there is nothing.
    pub(crate) fn values(&mut self, operation: Operation) -> Vec<Option<f64>> {
        let near = self.near.iter();
        let crossings = self.crossings.iter();
        match operation {
            Operation::Overlap => near.map(|pair| overlap(pair).then_some(0.0)).collect(),
            Operation::Distance | Operation::DistanceWarm => near.map(|pair| Some(f64::from(distance(pair)))).collect(),
            Operation::Depth => near.map(|pair| depth(pair).map(|contact| -f64::from(contact.dist))).collect(),
            Operation::Manifold => near
                .map(|pair| {
                    let mut manifolds = Manifolds::new();
                    manifold(pair, &mut manifolds);
                    deepest(&manifolds)
                })
                .collect(),
            Operation::ManifoldWarm => near
                .zip(&mut self.manifolds)
                .map(|(pair, manifolds)| {
                    manifold(pair, manifolds);
                    deepest(manifolds)
                })
                .collect(),
            Operation::Impact => {
                crossings.map(|moving| impact(moving).map(|hit| f64::from(hit.time_of_impact) * moving.way)).collect()
            }
            Operation::ImpactRotating => crossings
                .map(|moving| first_touch(&impact_rotating(moving)).map(|fraction| fraction * moving.way_turning))
                .collect(),
        }
    }

    /// Asks each pair once where the answer leaves something for the next one to start from.
    pub(crate) fn warm_up(&mut self, operation: Operation) {
        if operation == Operation::ManifoldWarm {
            self.time(operation, self.near.len());
        }
    }

    /// CPU time of asking the first `count` pairs. There is no warm distance: that is the cold one.
    pub(crate) fn time(&mut self, operation: Operation, count: usize) -> Duration {
        let near = self.near[..count].iter();
        let crossings = self.crossings[..count].iter();
        match operation {
            Operation::Overlap => spent(near, overlap),
            Operation::Distance | Operation::DistanceWarm => spent(near, distance),
            Operation::Depth => spent(near, depth),
            Operation::Manifold => {
                let mut manifolds = Manifolds::new();
                spent(near, |pair| {
                    manifolds.clear();
                    manifold(pair, &mut manifolds);
                })
            }
            Operation::ManifoldWarm => {
                spent(near.zip(&mut self.manifolds), |(pair, manifolds)| manifold(pair, manifolds))
            }
            Operation::Impact => spent(crossings, impact),
            Operation::ImpactRotating => spent(crossings, impact_rotating),
        }
    }
}

fn moving<'s>(pair: Pair<'s>, crossing: &Crossing) -> Moving<'s> {
    let start = pair[1].pose;
    let displacement = Vector::from_array(crossing.displacement);
    let turn = Vector::from_array(crossing.turn);
    let end_rotation = (Rotation::from_scaled_axis(turn) * start.rotation).normalize();
    Moving {
        pair,
        displacement,
        end: Pose::from_parts(start.translation + displacement, end_rotation),
        way: crossing.way,
        way_turning: crossing.way_turning,
    }
}

fn overlap([a, b]: &Pair<'_>) -> bool {
    query::intersection_test(&a.pose, a.shape, &b.pose, b.shape).expect(SUPPORTED).intersecting
}

fn distance([a, b]: &Pair<'_>) -> f32 {
    query::distance(&a.pose, a.shape, &b.pose, b.shape).expect(SUPPORTED).distance
}

fn depth([a, b]: &Pair<'_>) -> Option<Contact> {
    query::contact(&a.pose, a.shape, &b.pose, b.shape, PREDICTION).expect(SUPPORTED)
}

fn manifold([a, b]: &Pair<'_>, manifolds: &mut Manifolds) {
    let pose_b_in_a = a.pose.inv_mul(&b.pose);
    DefaultQueryDispatcher
        .contact_manifolds(&pose_b_in_a, a.shape, b.shape, PREDICTION, manifolds, &mut None)
        .expect(SUPPORTED);
}

/// The greatest depth of a point.
fn deepest(manifolds: &Manifolds) -> Option<f64> {
    let points = manifolds.iter().flat_map(|manifold| &manifold.points);
    points.map(|point| -f64::from(point.dist)).filter(|depth| *depth >= 0.0).max_by(f64::total_cmp)
}

fn impact(Moving { pair: [a, b], displacement, .. }: &Moving<'_>) -> Option<ShapeCastHit> {
    let options = ShapeCastOptions {
        max_time_of_impact: 1.0,
        compute_impact_geometry_on_penetration: false,
        ..ShapeCastOptions::default()
    };
    query::cast_shapes(&a.pose, Vector::ZERO, a.shape, &b.pose, *displacement, b.shape, options).expect(SUPPORTED)
}

fn impact_rotating(Moving { pair: [a, b], end, .. }: &Moving<'_>) -> SweepToiOutput {
    let [proxy_a, proxy_b] = [a, b].map(|placed| ToiProxy::from_shape(placed.shape).expect(SUPPORTED));
    let sweep_a = Sweep::constant(&a.pose, Vector::ZERO);
    let sweep_b = Sweep::from_poses(&b.pose, end, Vector::ZERO);
    query::sweep_time_of_impact(&proxy_a, &sweep_a, &proxy_b, &sweep_b, 1.0, SLOP)
}

/// A search that failed says how far the way is free, which is where an engine would stop.
fn first_touch(output: &SweepToiOutput) -> Option<f64> {
    (output.status != SweepToiStatus::Separated).then_some(f64::from(output.fraction))
}
