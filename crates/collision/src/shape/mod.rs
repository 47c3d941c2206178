//! Immutable forms and how they are placed. Knows nothing of trees of shapes or of worlds.
//!
//! A *convex* form is a core (point, segment, box, hull) and all points within a radius of it: a sphere is a rounded
//! point, a capsule a rounded segment. So a kernel that knows cores and a radius knows every rounded form as well.

mod adjacency;
mod bounds;
mod built;
mod climb;
mod compound;
mod convex;
mod creases;
mod equal;
mod farthest;
mod foot;
mod geometry;
mod half_space;
mod height_field;
mod hull;
mod identity;
mod islands;
mod ladder;
mod lazy;
mod limits;
mod mesh;
mod mode;
mod parts;
mod planar;
mod quickhull;
mod scale;
mod simple;
mod simplify;
mod solid;
mod topology;

pub(crate) use foot::{foot, radius_up};
pub(crate) use lazy::receipted;

pub use adjacency::Adjacency;
pub use built::Structure;
pub use compound::{Compound, Part, distinct};
pub use convex::{Convex, Core};
pub use creases::{Normals, Sides};
pub use geometry::{Form, Geometry, GeometryId};
pub use half_space::HalfSpace;
pub(crate) use height_field::Standing;
pub use height_field::{HeightField, Terrain};
pub use hull::Hull;
pub use ladder::{SIMPLIFIED_VERTICES, StandIn};
pub use lazy::{Asking, Clock, Receipt};
pub use limits::{GeometryError, Limits};
pub use mesh::{Mesh, MeshReport};
pub use mode::{MeshMode, SolidFault};
pub use parts::{Fineness, MeshParts, PartsAsked};
pub use simplify::Simplified;
pub use solid::Containment;
pub use topology::{Edge, Face, Span, Topology};

pub(crate) use simple::Simple;
