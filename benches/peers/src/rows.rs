//! The rows there are: their ids, and the ratio to parry3d that each is to reach.

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

/// A row of the table.
#[derive(Clone, Debug)]
pub(crate) struct Row {
    /// `part/set/operation`.
    pub(crate) id: String,
    /// The greatest ratio of our time to parry3d's that reaches the goal: the fastest peer's, where one is faster.
    pub(crate) goal_over_parry: f64,
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
pub(crate) fn all() -> Vec<Row> {
    let mut rows = Vec::new();
    for (operation, name, goals) in GOALS {
        for ((pairing, pairing_name), goal) in PAIRINGS.into_iter().zip(PAIRING_NAMES).zip(goals) {
            let id = format!("B/{pairing_name}/{name}");
            rows.push(Row { id, goal_over_parry: f64::from(goal) / 1000.0, pairing, operation });
        }
    }
    rows
}

/// The rows whose id begins with `prefix`.
///
/// # Errors
/// None does; the message lists what there is.
pub(crate) fn beginning_with(prefix: &str) -> Result<Vec<Row>, String> {
    let (chosen, others): (Vec<Row>, Vec<Row>) = all().into_iter().partition(|row| row.id.starts_with(prefix));
    if chosen.is_empty() {
        let ids: Vec<String> = others.into_iter().map(|row| row.id).collect();
        return Err(format!("no row begins with {prefix:?}; there are:\n  {}", ids.join("\n  ")));
    }
    Ok(chosen)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_prefix_chooses_its_rows_and_an_unknown_one_is_told_what_there_is() {
        let count = |prefix| beginning_with(prefix).map(|rows| rows.len());
        assert_eq!(count(""), Ok(48));
        assert_eq!(count("B/"), Ok(48));
        assert_eq!(count("B/hull8/"), Ok(8));
        assert_eq!(count("B/box-box/distance"), Ok(2));
        let error = count("B/torus").expect_err("there is none");
        assert!(error.contains("B/torus") && error.contains("B/hull128/impact-rotating"), "{error}");
    }

    #[test]
    fn ids_and_goals_stand_together() {
        let goal = |id: &str| all().into_iter().find(|row| row.id == id).map(|row| row.goal_over_parry);
        assert_eq!(goal("B/capsule-box/depth"), Some(0.095));
        assert_eq!(goal("B/hull8/manifold-warm"), Some(0.781));
        assert_eq!(goal("B/hull128/impact"), Some(1.0));
    }
}
