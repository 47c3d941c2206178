//! The shapes of a version are those of the list, and its trees are sound.

use collision::world::Snapshot;

use super::brute::Brute;

/// Every shape is there as it was put, with the box that its geometry says.
pub(crate) fn assert_same_shapes(version: &Snapshot, brute: &Brute) {
    version.assert_sound();
    assert_eq!(version.len(), brute.shapes.len(), "number of shapes");
    let listed = version.shapes_after(None, usize::MAX, None);
    for (found, expected) in listed.iter().zip(brute.shapes.values()) {
        assert_eq!((found.id, found.pose), (expected.id, expected.pose));
        assert_eq!(found.geometry.id(), expected.geometry.id(), "geometry of {}", found.id);
        assert_eq!((found.layers, found.collides_with), (expected.layers, expected.collides_with));
        assert_eq!((found.mobility, found.sensor, found.group), (expected.mobility, expected.sensor, expected.group));
        assert_eq!((found.velocity, found.angular_velocity), (expected.velocity, expected.angular_velocity));
        let bounds = expected.geometry.bounds(&expected.pose);
        assert_eq!(version.bounds_of(found.id), Some(bounds), "box of {}", found.id);
    }
}
