//! Which shapes a question sees.

use super::ShapeId;

/// Which shapes a question sees: those with `(shape.layers & collides_with) != 0` and
/// `(shape.collides_with & layers) != 0`, less the exclusions. If the asker is a shape of the world, absent masks are
/// that shape's own, it never sees itself nor those of its group.
#[derive(Clone, Debug, Default)]
pub struct Filter {
    /// The asker's layers; absent means all.
    pub layers: Option<u32>,
    /// Layers it wants to see; absent means all.
    pub collides_with: Option<u32>,
    /// Never these shapes.
    pub exclude_ids: Vec<ShapeId>,
    /// Leave out sensors.
    pub exclude_sensors: bool,
    /// Leave out static shapes.
    pub exclude_static: bool,
    /// Never shapes of these groups.
    pub exclude_groups: Vec<u32>,
}
