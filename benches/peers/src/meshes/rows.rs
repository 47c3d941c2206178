//! The rows of part C.

use crate::rows::{Row, Task as AnyTask};

/// A mesh that is asked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Level {
    /// Made here: rooms, corridors, pillars and ramps on two storeys, about 10,133 triangles.
    Dungeon,
    /// `nav_test` of the data, 1,612 triangles.
    NavTest,
}

/// What is done with it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Operation {
    /// Of the triangles; time is per triangle.
    Build,
    Ray,
    CastBall,
    CastCapsule,
    OverlapCapsule,
}

/// One operation with one mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Task {
    pub(crate) level: Level,
    pub(crate) operation: Operation,
}

/// Both, in the order of the columns of [`GOALS`].
pub(crate) const LEVELS: [Level; 2] = [Level::Dungeon, Level::NavTest];

const LEVEL_NAMES: [&str; 2] = ["dungeon-like", "nav_test"];

/// What each operation is to reach with each mesh, in thousandths of parry3d's time.
const GOALS: [(Operation, &str, [u16; 2]); 5] = [
    (Operation::Build, "build", [1000, 1000]),
    (Operation::Ray, "ray", [567, 562]),
    (Operation::CastBall, "cast-sphere", [469, 523]),
    (Operation::CastCapsule, "cast-capsule", [489, 482]),
    (Operation::OverlapCapsule, "overlap-capsule", [770, 517]),
];

/// All rows, operation by operation.
pub(crate) fn rows() -> Vec<Row> {
    let mut rows = Vec::new();
    for (operation, name, goals) in GOALS {
        for ((level, level_name), goal) in LEVELS.into_iter().zip(LEVEL_NAMES).zip(goals) {
            let task = AnyTask::Mesh(Task { level, operation });
            rows.push(Row {
                id: format!("C/{level_name}/{name}"),
                goal_over_parry: Some(f64::from(goal) / 1000.0),
                task,
            });
        }
    }
    rows
}
