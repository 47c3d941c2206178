//! Poses and boxes in f64. Knows nothing of shapes.

mod aabb;
mod pose;

pub use aabb::Aabb;
pub use pose::Pose;
