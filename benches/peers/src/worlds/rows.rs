//! The rows of part A.

use crate::rows::{Row, Task as AnyTask};

/// What is done to a tree of boxes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum TreeWork {
    /// All shapes, one by one, into an empty tree.
    Insert,
    /// All shapes at once.
    Bulk,
    /// A tenth of the shapes by a little.
    MoveNear,
    /// A tenth of the shapes by a lot.
    MoveFar,
    /// A thousand shapes go and come back elsewhere.
    RemoveInsert,
    /// All pairs of boxes that overlap.
    Pairs,
}

/// What is asked of a world.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Question {
    RayShort,
    RayLong,
    RayLongAfterMoves,
    OverlapBall,
    OverlapCuboid,
    CastBall,
}

/// What a row does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Operation {
    Work(TreeWork),
    Ask(Question),
}

/// One operation with a world of so many shapes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Task {
    pub(crate) shape_count: u32,
    pub(crate) operation: Operation,
}

/// What each operation is to reach with 1,000, 10,000 and 100,000 shapes, in thousandths of parry3d's time.
const GOALS: [(Operation, &str, [u16; 3]); 12] = [
    (Operation::Work(TreeWork::Insert), "insert", [976, 644, 552]),
    (Operation::Work(TreeWork::Bulk), "bulk", [978, 771, 709]),
    (Operation::Work(TreeWork::MoveNear), "move-0.1m", [779, 599, 424]),
    (Operation::Work(TreeWork::MoveFar), "move-10m", [904, 627, 465]),
    (Operation::Work(TreeWork::RemoveInsert), "remove-insert", [807, 674, 478]),
    (Operation::Ask(Question::RayShort), "ray-10m", [685, 640, 577]),
    (Operation::Ask(Question::RayLong), "ray-1000m", [609, 585, 541]),
    (Operation::Ask(Question::RayLongAfterMoves), "ray-1000m-after-moves", [341, 289, 323]),
    (Operation::Ask(Question::OverlapBall), "overlap-sphere", [749, 779, 720]),
    (Operation::Ask(Question::OverlapCuboid), "overlap-box", [695, 642, 590]),
    (Operation::Ask(Question::CastBall), "cast-sphere", [348, 465, 467]),
    (Operation::Work(TreeWork::Pairs), "pairs", [1000, 862, 909]),
];

/// All rows, operation by operation, for worlds of these numbers of shapes.
pub(crate) fn rows(shape_counts: &[u32]) -> Vec<Row> {
    let mut rows = Vec::new();
    for (operation, name, goals) in GOALS {
        for &shape_count in shape_counts {
            let goal = match shape_count {
                1000 => Some(goals[0]),
                10_000 => Some(goals[1]),
                100_000 => Some(goals[2]),
                _ => None,
            };
            rows.push(Row {
                id: format!("A/{name}/{}", short(shape_count)),
                goal_over_parry: goal.map(|goal| f64::from(goal) / 1000.0),
                task: AnyTask::World(Task { shape_count, operation }),
            });
        }
    }
    rows
}

/// `10k` for 10,000.
fn short(count: u32) -> String {
    if count.is_multiple_of(1_000_000) {
        format!("{}m", count / 1_000_000)
    } else if count.is_multiple_of(1000) {
        format!("{}k", count / 1000)
    } else {
        count.to_string()
    }
}
