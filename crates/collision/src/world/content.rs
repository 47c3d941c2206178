//! The hash of what a version holds: for tests, replicas and recovery.
//!
//! # Method
//! BLAKE3 over a header with the number of shapes, and then the shapes by id, each as the hash of its geometry's content
//! and all else as little-endian numbers, bit by bit as sent. The tick, the time, the trees and the order of edits do not
//! count. A change of this layout changes the header.

use super::{Mobility, Shape, Snapshot};
use crate::math::Pose;

/// Says what is hashed, and in which layout.
const HEADER: &[u8] = b"calipers world content 1";

impl Snapshot {
    /// A hash of all shapes: two versions have the same one if, and in practice only if, they hold the same shapes with the
    /// same numbers, whatever their ticks and whatever happened before. −0 is not 0 in a pose or a velocity; in a geometry
    /// it is. Costs a pass over the shapes, and at each geometry that was never hashed before a pass over that.
    ///
    /// ```
    /// use std::sync::Arc;
    /// use collision::{DVec3, math::Pose, shape::Geometry, world::*};
    ///
    /// let ball = Shape::new(ShapeId::MIN, Arc::new(Geometry::sphere(1.0)?), Pose::IDENTITY);
    /// let mut world = World::new(Time(0));
    /// let empty = world.newest().content_hash();
    /// world.apply(vec![Edit::Insert(ball)], Time(0), EditRule::AllOrNothing)?;
    /// assert_ne!(world.newest().content_hash(), empty);
    /// world.apply(vec![Edit::Clear], Time(7), EditRule::AllOrNothing)?;
    /// assert_eq!(world.newest().content_hash(), empty);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn content_hash(&self) -> [u8; 32] {
        let mut hasher = blake3::Hasher::new();
        hasher.update(HEADER);
        hasher.update(&(self.len() as u64).to_le_bytes());
        let mut bytes = Vec::with_capacity(SHAPE_BYTES);
        for (_, slot) in self.state().ids.after(None) {
            bytes.clear();
            write(self.state().shapes.entry(slot).shape(), &mut bytes);
            debug_assert_eq!(bytes.len(), SHAPE_BYTES, "all shapes are as long, so that none can look like another");
            hasher.update(&bytes);
        }
        *hasher.finalize().as_bytes()
    }
}

/// Bytes of each shape: the geometry's hash, 15 numbers of eight bytes, three of four and three flags.
const SHAPE_BYTES: usize = 32 + 15 * 8 + 3 * 4 + 3;

fn write(shape: &Shape, bytes: &mut Vec<u8>) {
    // Whole, so that a new field cannot be forgotten.
    let Shape {
        id,
        geometry,
        pose: Pose { position, rotation },
        layers,
        collides_with,
        mobility,
        bullet,
        sensor,
        group,
        user_data,
        velocity,
        angular_velocity,
    } = shape;
    bytes.extend(geometry.id().0);
    bytes.extend(id.get().to_le_bytes());
    bytes.extend(user_data.to_le_bytes());
    let vectors = [position, velocity, angular_velocity].into_iter().flat_map(|vector| vector.to_array());
    for number in vectors.chain(rotation.to_array()) {
        bytes.extend(number.to_bits().to_le_bytes());
    }
    for number in [layers, collides_with, group] {
        bytes.extend(number.to_le_bytes());
    }
    let mobility = match mobility {
        Mobility::Static => 1,
        Mobility::Dynamic => 2,
        Mobility::Kinematic => 3,
    };
    bytes.extend([mobility, u8::from(*bullet), u8::from(*sensor)]);
}
