//! Which side of a mesh's triangles is matter, and whether a mesh is fit to be a body.
//!
//! # Method
//! A body must be closed (each edge is passed as often one way as the other) and wound outwards (its volume is above 0).
//! What is wrong is named as it was sent, so that it can be found in the file that it came from.

use super::{GeometryError, Mesh};

/// Which side of a triangle is matter. Its front is the side from which its corners go counter-clockwise.
///
/// ```text
///              two-sided            one-sided             solid
///   ray   --> |                --> |                --> |#######|
///             | <-- ray    passes  | <-- ray: front     |#######| <-- ray
///             |            through |                    |#######|
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum MeshMode {
    /// A surface, felt from both sides.
    #[default]
    TwoSided,
    /// A surface, felt from the front. Rays and moving forms go through it from its back; a contact pushes to the front. It
    /// is at a place for whatever asks how far it is or whether it is touched there: those questions have no direction.
    OneSided,
    /// A body: what lies inside is in it.
    Solid,
}

/// Why a mesh is not fit to be a body.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum SolidFault {
    /// An edge belongs to one triangle only.
    #[error(
        "is open at the edge between vertices {} and {}, which belongs to triangle {triangle} only: close it, or send it \
         two-sided or one-sided", .vertices[0], .vertices[1]
    )]
    OpenEdge {
        /// The ends of the edge, numbered as sent.
        vertices: [u32; 2],
        /// The triangle, numbered as sent.
        triangle: u32,
    },
    /// Several triangles share an edge, but do not pass it as often one way as the other.
    #[error(
        "is not wound alike at the edge between vertices {} and {}: its triangles (one is {triangle}) must pass it as often \
         one way as the other; turn those that are wound wrongly, or send it two-sided", .vertices[0], .vertices[1]
    )]
    UnevenEdge {
        /// The ends of the edge, numbered as sent.
        vertices: [u32; 2],
        /// One of its triangles, numbered as sent.
        triangle: u32,
    },
    /// It is closed, but its triangles face inwards, or what they enclose is nothing.
    #[error("is wound inwards (its volume is {volume} m³): swap two corners of each triangle")]
    Inwards {
        /// Cubic metres, 0 or below.
        volume: f64,
    },
}

/// Refuses a solid mesh that is not closed or not wound outwards. `vertex_as_sent(triangle, k)` is the number with which the
/// corner `k` of the triangle that was sent as number `triangle` was sent.
pub(super) fn check(mesh: &Mesh, field: &str, vertex_as_sent: impl Fn(u32, usize) -> u32) -> Result<(), GeometryError> {
    if mesh.mode() != MeshMode::Solid {
        return Ok(());
    }
    let fail = |fault| Err(GeometryError::NotSolid { field: field.into(), fault });
    if let Some((triangle, k)) = mesh.adjacency().uneven_side() {
        let is_open = mesh.adjacency().across(triangle, k).next().is_none();
        let triangle = mesh.sent_number(triangle);
        let vertices = [vertex_as_sent(triangle, k), vertex_as_sent(triangle, (k + 1) % 3)];
        return fail(if is_open {
            SolidFault::OpenEdge { vertices, triangle }
        } else {
            SolidFault::UnevenEdge { vertices, triangle }
        });
    }
    match mesh.volume() {
        Some(volume) if volume > 0.0 => Ok(()),
        volume => fail(SolidFault::Inwards { volume: volume.unwrap_or_default() }),
    }
}
