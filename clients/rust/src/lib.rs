//! A Rust client of the Calipers collision query service.
//!
//! [`Client`] asks questions and edits worlds, one call for each RPC; [`EditWriter`] keeps a world up to date over a
//! stream and survives broken connections, as does [`Watch`], which follows what changes. Requests and answers are the wire's own messages ([`proto`]), whose `.proto`
//! files document every field; [`geometry`], [`shape`], [`edit`] and [`ask`] build the common ones in a line.
//!
//! Units are metres, seconds and radians; coordinates are right-handed; a rotation is a quaternion `[x, y, z, w]`.
//!
//! ```no_run
//! use calipers_client::{Client, ask, shape};
//!
//! # async fn example() -> Result<(), calipers_client::Error> {
//! let client = Client::connect("http://127.0.0.1:7070").await?;
//! client.edit([shape::sphere(1, 1.0).at([0.0, 0.0, 5.0]).insert()]).await?;
//! let answer = client.raycast(ask::ray([0.0, 0.0, 0.0], [0.0, 0.0, 1.0])).await?;
//! assert_eq!(answer.hits[0].id, 1);
//! assert_eq!(answer.hits[0].distance, Some(4.0));
//! # Ok(())
//! # }
//! ```
//!
//! # Never
//!
//! This crate computes no geometry and knows nothing of the server's insides: all it knows is `proto/`.

pub mod ask;
mod calls;
mod client;
pub mod edit;
mod error;
mod export;
mod follow;
pub mod geometry;
mod pipeline;
pub mod shape;
mod upload;
mod writer;

pub use client::{Bearer, Client, Secured};
pub use error::Error;
pub use follow::{Turn, Watch};
pub use upload::Uploaded;
pub use writer::{EditWriter, Report, WriterOptions};

/// The messages and raw stubs of the API, version 1.
pub use wire::v1 as proto;

/// A vector of the wire from `[x, y, z]`.
pub(crate) fn vec3([x, y, z]: [f64; 3]) -> proto::Vec3 {
    proto::Vec3 { x, y, z }
}

/// A rotation of the wire from a quaternion `[x, y, z, w]`.
pub(crate) fn quat([x, y, z, w]: [f64; 4]) -> proto::Quat {
    proto::Quat { x, y, z, w }
}
