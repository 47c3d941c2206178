//! The Calipers server: messages to questions, questions to answers.
//!
//! A request passes these rooms: `rpc` (one file per question) → `convert` (checked values) → `session` (one version of
//! a world) → the collision crate. [`serve::start`] runs it; [`config::Settings`] says how.
//!
//! # Never
//! Geometry: there is no dot product here.

pub mod config;
pub mod exported;
pub mod observe;
mod past;
pub mod replay;
pub mod serve;

mod building;
mod compute;
mod convert;
mod deadline;
mod drain;
mod fence;
mod furnishing;
mod gate;
mod geometries;
mod lease;
mod problem;
mod registry;
mod retry;
mod rpc;
mod session;
mod token;
mod traces;
mod workers;
mod writer;
