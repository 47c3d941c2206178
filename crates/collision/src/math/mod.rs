//! Poses and boxes in f64, and arithmetic that keeps its rounding errors. Knows nothing of shapes.

mod aabb;
pub mod directed;
mod direction;
pub mod exact;
pub mod expansion;
mod larger;
mod norm;
mod pose;
pub mod twofold;

pub use aabb::{Aabb, Ball};
pub use direction::{scaled_by_power_of_two, try_unit};
pub use larger::{larger, smaller};
pub use norm::Norm;
pub use pose::Pose;
