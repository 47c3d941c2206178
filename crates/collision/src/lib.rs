//! The collision domain of Calipers: forms, trees, kernels, response and worlds.
//!
//! # Conventions
//! Metres, seconds, radians; f64; right-handed coordinates, no notion of up. Sets are closed: exact touch is an
//! overlap. Normals are unit vectors from `b` to `a` (from the shape of the world to the asker).
//!
//! # Layers
//! `math → broad → shape → narrow → decompose → response → world`; each uses only those to its left (a mesh keeps a tree of boxes).
//!
//! # Never
//! Network, threads, clocks, files, logging, randomness.

pub mod accuracy;
pub mod answer;
pub mod broad;
pub mod decompose;
pub mod math;
pub mod narrow;
mod pages;
pub mod response;
pub mod shape;
pub mod tolerance;
pub mod world;

pub use glam::{DQuat, DVec3};
