//! Edits and questions, and a plain list of shapes that goes through the same: the laws are those of the crate's own test.

#[path = "../../crates/collision/tests/world/model/mod.rs"]
mod model;

/// Panics if a world breaks a law on the way that these bytes make.
pub fn check(bytes: &[u8]) {
    model::check(bytes);
}

/// The edits and questions that these bytes make.
#[must_use]
pub fn describe(bytes: &[u8]) -> String {
    model::describe(bytes)
}
