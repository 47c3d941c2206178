//! Trees of boxes. Knows boxes and leaf numbers only, never a shape.
//!
//! A tree enumerates a *superset* of what was asked for: it never leaves out a leaf whose box qualifies, and it may
//! offer some whose box does not. What is true is for the caller to decide on the canonical boxes and the shapes, so
//! answers depend on neither the tree nor the order in which it was built.

mod build;
mod cut;
mod dynamic;
mod fixed;
mod forest;
mod item;
mod levels;
mod local;
mod node;
mod open;
mod pairs;
mod path;
mod traverse;
mod walk;
mod wide;

pub use dynamic::{DynamicTree, Refit};
pub use fixed::StaticTree;
pub use levels::NodeBox;
pub use path::{Line, Path};
pub use traverse::{ALL_LAYERS, Toll, Tree, distance_at_least};
pub use walk::{Step, Walk, Walked};
