//! Builds edits: what is inserted, moved and removed in one tick.
//!
//! ```
//! use calipers_client::{edit, shape};
//!
//! let tick = [shape::sphere(1, 0.5).insert(), edit::move_to(2, [0.0, 1.0, 0.0]), edit::remove([3, 4])];
//! assert!(tick.iter().all(|edit| edit.op.is_some()));
//! ```

use crate::proto::{self, edit::Op};
use crate::{quat, vec3};

/// Inserts a shape; if its id is taken, the old shape is replaced whole.
pub fn insert(shape: impl Into<proto::Shape>) -> proto::Edit {
    of(Op::Insert(shape.into()))
}

/// Moves a shape to a position; its rotation stays.
pub fn move_to(id: u64, position: [f64; 3]) -> proto::Edit {
    place(id, Some(vec3(position)), None)
}

/// Moves and turns a shape; `rotation` is a quaternion `[x, y, z, w]` of any length but 0.
pub fn move_and_turn(id: u64, position: [f64; 3], rotation: [f64; 4]) -> proto::Edit {
    place(id, Some(vec3(position)), Some(quat(rotation)))
}

/// Removes shapes; ids that are gone are no error.
pub fn remove(ids: impl IntoIterator<Item = u64>) -> proto::Edit {
    of(Op::Remove(proto::Remove { ids: ids.into_iter().collect() }))
}

/// Removes everything.
pub fn clear() -> proto::Edit {
    of(Op::Clear(proto::Clear {}))
}

fn place(id: u64, position: Option<proto::Vec3>, rotation: Option<proto::Quat>) -> proto::Edit {
    of(Op::Move(proto::Move { id, pose: Some(proto::Pose { position, rotation }), ..proto::Move::default() }))
}

fn of(op: Op) -> proto::Edit {
    proto::Edit { op: Some(op) }
}
