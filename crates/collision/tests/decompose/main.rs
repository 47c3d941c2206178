//! Convex parts of meshes: what is certified of them holds, and how good they are.

mod contacts;
#[path = "../cubes/mod.rs"]
mod cubes;
mod data;
mod laws;
mod made;
#[path = "../reference/mod.rs"]
mod reference;
mod sampled;
