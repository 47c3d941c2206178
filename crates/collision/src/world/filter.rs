//! Which shapes a question sees.

use super::{Mobility, Shape, ShapeId, search::Side};

/// Which shapes a question sees: those with `(shape.layers & collides_with) != 0` and
/// `(shape.collides_with & layers) != 0`, less the exclusions. If the asker is a shape of the world, absent masks are
/// that shape's own, it never sees itself nor those of its group. Where a question names what it is asked `against`,
/// that pair is answered and the filter does not apply.
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
    /// Never shapes of these groups; 0 is none.
    pub exclude_groups: Vec<u32>,
}

/// Ids of so many shapes are compared one by one. More are sorted first, which asks for memory.
const EXCLUDED_UNSORTED_MAX: usize = 16;

/// A filter made ready for one asker.
#[derive(Debug)]
pub(super) struct Sieve<'a> {
    filter: &'a Filter,
    layers: u32,
    collides_with: u32,
    exclude_sensors: bool,
    /// The asker and its group, if it is a shape of the world.
    asker: Option<(ShapeId, u32)>,
    /// Sorted, if they are so many that this pays; a usual list is searched as it was sent.
    exclude_sorted: Vec<ShapeId>,
}

fn sorted(ids: &[ShapeId]) -> Vec<ShapeId> {
    let mut sorted = ids.to_vec();
    sorted.sort_unstable();
    sorted
}

impl<'a> Sieve<'a> {
    /// The filter for an asker, which may be a shape of the world.
    pub(super) fn new(filter: &'a Filter, asker: Option<&Shape>) -> Self {
        let is_sorted = filter.exclude_ids.len() > EXCLUDED_UNSORTED_MAX;
        Self {
            filter,
            layers: filter.layers.or(asker.map(|shape| shape.layers)).unwrap_or(u32::MAX),
            collides_with: filter.collides_with.or(asker.map(|shape| shape.collides_with)).unwrap_or(u32::MAX),
            exclude_sensors: filter.exclude_sensors,
            asker: asker.map(|shape| (shape.id, shape.group)),
            exclude_sorted: if is_sorted { sorted(&filter.exclude_ids) } else { Vec::new() },
        }
    }

    /// The same, which lets no sensors through.
    pub(super) fn without_sensors(self) -> Self {
        Self { exclude_sensors: true, ..self }
    }

    /// The layers that the asker sees: shapes on none of them need not be offered.
    pub(super) fn layers_seen(&self) -> u32 {
        self.collides_with
    }

    /// Whether the asker sees a side; a form that is no shape of the world it sees.
    pub(super) fn passes(&self, side: &Side<'_>) -> bool {
        side.shape.is_none_or(|shape| self.lets_through(shape))
    }

    /// Whether the asker sees a shape of the world.
    pub(super) fn lets_through(&self, shape: &Shape) -> bool {
        let is_wanted = shape.layers & self.collides_with != 0 && shape.collides_with & self.layers != 0;
        let is_own = self.asker.is_some_and(|(id, group)| id == shape.id || (group != 0 && group == shape.group));
        let is_excluded = (self.exclude_sensors && shape.sensor)
            || (self.filter.exclude_static && shape.mobility == Mobility::Static)
            || (shape.group != 0 && self.filter.exclude_groups.contains(&shape.group))
            || self.excludes(shape.id);
        is_wanted && !is_own && !is_excluded
    }

    fn excludes(&self, id: ShapeId) -> bool {
        if self.filter.exclude_ids.len() > EXCLUDED_UNSORTED_MAX {
            self.exclude_sorted.binary_search(&id).is_ok()
        } else {
            self.filter.exclude_ids.contains(&id)
        }
    }
}
