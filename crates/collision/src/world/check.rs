//! What holds in every version of a world, asserted; for tests.

use super::{Mobility, Snapshot};

impl Snapshot {
    /// Asserts what holds in every version; for tests. Costs a pass over all shapes and nodes.
    ///
    /// # Panics
    /// If the tree over the moving shapes is not sound, a shape is in no tree or in two, or an id leads to another shape.
    pub fn assert_sound(&self) {
        let state = self.state();
        state.moving.assert_sound();
        assert_eq!(state.moving.len() + state.static_count, state.shapes.len(), "each shape is in one tree");
        let mut moving_count = 0;
        for (_, entry) in state.shapes.iter() {
            let found = state.get(entry.shape().id).map(|found| found.shape().id);
            assert_eq!(found, Some(entry.shape().id), "the directory leads to each shape");
            moving_count += usize::from(entry.shape().mobility != Mobility::Static);
        }
        assert_eq!(moving_count, state.moving.len(), "the dynamic tree holds the moving shapes");
    }
}
