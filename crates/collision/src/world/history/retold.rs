//! How a version came from an earlier one, retold as edits of a few shapes.

use super::super::{
    Edit, Shape, ShapeId, Snapshot,
    changed::{is_same_but_for_motion, pose_bits},
};

impl Snapshot {
    /// Edits that lead these shapes from where they were in `old` to where they are here, in the order of `ids`, each at most once.
    /// From the tick before, if that is held, what travelled is moved; what was put where it is, and from any other version all that
    /// differs, is inserted. A world that held `old` and applies them answers every question about these shapes alone as this world
    /// does, also between the two and of the way.
    #[must_use]
    pub fn edits_from(&self, old: &Self, ids: impl IntoIterator<Item = ShapeId>) -> Vec<Edit> {
        let passage = self.passage_from(old);
        let edit = |id: ShapeId| match (old.shape(id), self.shape(id)) {
            (None, None) => None,
            (Some(_), None) => Some(Edit::Remove(id)),
            (Some(before), Some(after)) if passage.travelled(id) && is_same_but_for_place(&before, &after) => {
                Some(travel(&after))
            }
            (Some(before), Some(after)) if is_same(&before, &after) && !passage.changed(id) => None,
            (_, Some(after)) => Some(Edit::Insert(after.into_owned())),
        };
        ids.into_iter().filter_map(edit).collect()
    }
}

fn travel(shape: &Shape) -> Edit {
    Edit::Move {
        id: shape.id,
        position: Some(shape.pose.position),
        rotation: Some(shape.pose.rotation),
        velocity: Some(shape.velocity),
        angular_velocity: Some(shape.angular_velocity),
        teleport: false,
    }
}

fn is_same_but_for_place(a: &Shape, b: &Shape) -> bool {
    is_same_but_for_motion(a, b) && (a.user_data, a.bullet) == (b.user_data, b.bullet)
}

fn is_same(a: &Shape, b: &Shape) -> bool {
    let speed = |shape: &Shape| [shape.velocity, shape.angular_velocity];
    is_same_but_for_place(a, b) && pose_bits(&a.pose) == pose_bits(&b.pose) && speed(a) == speed(b)
}
