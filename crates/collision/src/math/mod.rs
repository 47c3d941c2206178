//! Poses and boxes in f64, and arithmetic that keeps its rounding errors. Knows nothing of shapes.

mod aabb;
pub mod directed;
pub mod exact;
pub mod expansion;
mod pose;

pub use aabb::Aabb;
pub use pose::Pose;
