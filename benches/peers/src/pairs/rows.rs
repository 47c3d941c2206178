//! The rows of part B.

use crate::rows::{Row, Task};

/// The kinds of shape of a pair, `a` then `b`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Pairing {
    BoxBox,
    CapsuleBox,
    SphereHull32,
    Hull8,
    Hull32,
    Hull128,
}

/// What is asked of a pair.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Operation {
    Overlap,
    Distance,
    DistanceWarm,
    Depth,
    Manifold,
    ManifoldWarm,
    Impact,
    ImpactRotating,
}

/// One question to the pairs of one pairing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Question {
    pub(crate) pairing: Pairing,
    pub(crate) operation: Operation,
}

/// All pairings, in the order of the columns of [`GOALS`].
pub(crate) const PAIRINGS: [Pairing; 6] =
    [Pairing::BoxBox, Pairing::CapsuleBox, Pairing::SphereHull32, Pairing::Hull8, Pairing::Hull32, Pairing::Hull128];

const PAIRING_NAMES: [&str; 6] = ["box-box", "capsule-box", "sphere-hull32", "hull8", "hull32", "hull128"];

/// What each operation is to reach with each pairing, in thousandths of parry3d's time.
const GOALS: [(Operation, &str, [u16; 6]); 8] = [
    (Operation::Overlap, "overlap", [1000, 549, 919, 710, 736, 628]),
    (Operation::Distance, "distance", [1000, 347, 934, 543, 786, 771]),
    (Operation::DistanceWarm, "distance-warm", [767, 121, 428, 318, 411, 371]),
    (Operation::Depth, "depth", [439, 95, 686, 909, 761, 727]),
    (Operation::Manifold, "manifold", [1000, 564, 687, 808, 876, 778]),
    (Operation::ManifoldWarm, "manifold-warm", [1000, 1000, 629, 781, 448, 1000]),
    (Operation::Impact, "impact", [1000, 284, 256, 908, 917, 1000]),
    (Operation::ImpactRotating, "impact-rotating", [887, 1000, 1000, 777, 875, 1000]),
];

/// All rows, operation by operation.
pub(crate) fn rows() -> Vec<Row> {
    let mut rows = Vec::new();
    for (operation, name, goals) in GOALS {
        for ((pairing, pairing_name), goal) in PAIRINGS.into_iter().zip(PAIRING_NAMES).zip(goals) {
            let id = format!("B/{pairing_name}/{name}");
            let task = Task::Pair(Question { pairing, operation });
            rows.push(Row { id, goal_over_parry: Some(f64::from(goal) / 1000.0), task });
        }
    }
    rows
}
