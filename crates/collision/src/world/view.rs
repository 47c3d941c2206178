//! What a viewer draws: the shapes that it sees, how they differ between two versions, and the boxes of the trees.
//!
//! # Method
//! Two versions are compared page by page, however many ticks lie between them: what came and went meanwhile is not seen. A
//! shape that comes into view is inserted, one that leaves it is removed.

use super::{
    Filter, Shape, ShapeId, Snapshot,
    changed::{is_same_but_for_motion, pose_bits},
    filter::Sieve,
};
use crate::{broad::NodeBox, math::Aabb};

/// Which shapes a viewer sees.
#[derive(Clone, Debug, Default)]
pub struct View {
    /// Only those whose canonical boxes touch this.
    pub bounds: Option<Aabb>,
    /// Only those that pass.
    pub filter: Filter,
}

/// How what a viewer sees differs between two versions; by id.
#[derive(Clone, Debug, Default)]
pub struct ViewChanges {
    /// Shapes that came into view or were replaced.
    pub inserted: Vec<Shape>,
    /// Shapes that differ in pose or velocities only, as they are now.
    pub moved: Vec<Shape>,
    /// Shapes that went out of view.
    pub removed: Vec<ShapeId>,
}

impl ViewChanges {
    /// Whether nothing changed.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.inserted.is_empty() && self.moved.is_empty() && self.removed.is_empty()
    }
}

impl Snapshot {
    /// All shapes that a viewer sees, by id, as if they had just come.
    #[must_use]
    pub fn view(&self, view: &View) -> ViewChanges {
        let sieve = Sieve::new(&view.filter, None);
        let entries = self.state().ids.after(None).map(|(_, slot)| self.state().shapes.entry(slot));
        let seen = entries.filter(|entry| {
            view.bounds.is_none_or(|bounds| bounds.intersects(entry.bounds)) && sieve.lets_through(entry.shape())
        });
        ViewChanges { inserted: seen.map(|entry| entry.shape().clone()).collect(), ..ViewChanges::default() }
    }

    /// How what a viewer sees came from what it saw of `old`, which may be any version of any world. Costs what differs.
    ///
    /// ```
    /// use std::sync::Arc;
    /// use collision::{DVec3, math::Pose, shape::Geometry, world::*};
    ///
    /// let mut world = World::new(Time(0));
    /// let empty = world.newest();
    /// let ball = Shape::new(ShapeId::MIN, Arc::new(Geometry::sphere(1.0)?), Pose::IDENTITY);
    /// world.apply(vec![Edit::Insert(ball)], Time(0), EditRule::AllOrNothing)?;
    /// let changes = world.newest().view_since(&empty, &View::default());
    /// assert_eq!((changes.inserted.len(), changes.moved.len(), changes.removed.len()), (1, 0, 0));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn view_since(&self, old: &Self, view: &View) -> ViewChanges {
        let sieve = Sieve::new(&view.filter, None);
        let seen = |version: &Self, id: ShapeId| {
            let entry = version.state().get(id)?;
            let is_near = view.bounds.is_none_or(|bounds| bounds.intersects(entry.bounds));
            (is_near && sieve.lets_through(entry.shape())).then(|| entry.shape().clone())
        };
        let mut changes = ViewChanges::default();
        for id in self.differing_from(old, is_same) {
            match (seen(old, id), seen(self, id)) {
                (None, None) => {}
                (Some(_), None) => changes.removed.push(id),
                (Some(before), Some(after)) if is_same_but_moved(&before, &after) => changes.moved.push(after),
                (_, Some(after)) => changes.inserted.push(after),
            }
        }
        changes
    }

    /// The boxes of the trees, those of the static one only if it was built; down to a level, at most so many of each.
    #[must_use]
    pub fn tree_boxes(&self, level_max: u32, count_max: usize) -> Vec<NodeBox> {
        let mut boxes = self.state().moving.node_boxes(level_max, count_max);
        let fixed = self.state().fixed_if_built();
        boxes.extend(fixed.into_iter().flat_map(|fixed| fixed.tree.node_boxes(level_max, count_max)));
        boxes
    }
}

/// Whether nothing can tell them apart.
fn is_same(a: &Shape, b: &Shape) -> bool {
    let motion = |shape: &Shape| {
        let [linear, angular] = [shape.velocity, shape.angular_velocity].map(|v| v.to_array().map(f64::to_bits));
        (pose_bits(&shape.pose), linear, angular)
    };
    motion(a) == motion(b) && is_same_but_moved(a, b)
}

/// Whether they differ in pose and velocities only.
fn is_same_but_moved(a: &Shape, b: &Shape) -> bool {
    is_same_but_for_motion(a, b) && (a.bullet, a.user_data) == (b.bullet, b.user_data)
}
