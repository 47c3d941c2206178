//! The rows there are: their ids, and the ratio to parry3d that each is to reach. Each part lists its own.

use crate::{meshes, pairs, worlds};

/// A row of the table.
#[derive(Clone, Debug)]
pub(crate) struct Row {
    /// `part/set/operation`, or `part/operation/set`.
    pub(crate) id: String,
    /// The greatest ratio of our time to parry3d's that reaches the goal; `None` where none is set.
    pub(crate) goal_over_parry: Option<f64>,
    pub(crate) task: Task,
}

/// What a row measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Task {
    World(worlds::Task),
    Pair(pairs::Question),
    Mesh(meshes::Task),
}

/// All rows, those of worlds for each of these numbers of shapes.
pub(crate) fn all(shape_counts: &[u32]) -> Vec<Row> {
    let mut rows = worlds::rows(shape_counts);
    rows.extend(pairs::rows());
    rows.extend(meshes::rows());
    rows
}

/// The rows whose id begins with `prefix`.
///
/// # Errors
/// None does; the message lists what there is.
pub(crate) fn beginning_with(prefix: &str, shape_counts: &[u32]) -> Result<Vec<Row>, String> {
    let (chosen, others): (Vec<Row>, Vec<Row>) =
        all(shape_counts).into_iter().partition(|row| row.id.starts_with(prefix));
    if chosen.is_empty() {
        let ids: Vec<String> = others.into_iter().map(|row| row.id).collect();
        return Err(format!("no row begins with {prefix:?}; there are:\n  {}", ids.join("\n  ")));
    }
    Ok(chosen)
}

#[cfg(test)]
mod tests {
    use super::*;

    const USUAL: [u32; 3] = [1000, 10_000, 100_000];

    #[test]
    fn a_prefix_chooses_its_rows_and_an_unknown_one_is_told_what_there_is() {
        let count = |prefix| beginning_with(prefix, &USUAL).map(|rows| rows.len());
        assert_eq!(count(""), Ok(36 + 48 + 10));
        assert_eq!(count("A/"), Ok(36));
        assert_eq!(count("A/ray-1000m"), Ok(6));
        assert_eq!(count("B/"), Ok(48));
        assert_eq!(count("B/hull8/"), Ok(8));
        assert_eq!(count("B/box-box/distance"), Ok(2));
        assert_eq!(count("C/nav_test/"), Ok(5));
        let error = count("B/torus").expect_err("there is none");
        assert!(error.contains("B/torus") && error.contains("B/hull128/impact-rotating"), "{error}");
    }

    #[test]
    fn ids_and_goals_stand_together() {
        let rows = all(&[1000, 10_000, 100_000, 1_000_000]);
        let goal = |id: &str| rows.iter().find(|row| row.id == id).map(|row| row.goal_over_parry);
        assert_eq!(goal("B/capsule-box/depth"), Some(Some(0.095)));
        assert_eq!(goal("B/hull8/manifold-warm"), Some(Some(0.781)));
        assert_eq!(goal("B/hull128/impact"), Some(Some(1.0)));
        assert_eq!(goal("A/insert/1k"), Some(Some(0.976)));
        assert_eq!(goal("A/ray-1000m-after-moves/100k"), Some(Some(0.323)));
        assert_eq!(goal("A/pairs/10k"), Some(Some(0.862)));
        assert_eq!(goal("A/pairs/1m"), Some(None));
        assert_eq!(goal("C/dungeon-like/ray"), Some(Some(0.567)));
        assert_eq!(goal("C/nav_test/overlap-capsule"), Some(Some(0.517)));
    }
}
