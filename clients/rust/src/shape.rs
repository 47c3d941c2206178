//! Builds shapes: geometries placed in a world, under an id that the client chooses (never 0).
//!
//! ```
//! use calipers_client::shape;
//!
//! let wall = shape::cuboid(10, [4.0, 1.5, 0.1]).at([0.0, 1.5, 8.0]).fixed().build();
//! assert_eq!(wall.id, 10);
//! assert_eq!(wall.pose.unwrap().position.unwrap().z, 8.0);
//! ```

use crate::proto;
use crate::{geometry, quat, vec3};

/// A shape in the making.
#[derive(Clone, Debug, PartialEq)]
#[must_use = "a shape is not in the world until its insert() is sent"]
pub struct Builder {
    shape: proto::Shape,
}

/// A shape of any geometry, at the origin.
pub fn of(id: u64, geometry: proto::Geometry) -> Builder {
    Builder { shape: proto::Shape { id, geometry: Some(geometry), ..proto::Shape::default() } }
}

/// A sphere.
pub fn sphere(id: u64, radius: f64) -> Builder {
    of(id, geometry::sphere(radius))
}

/// A box, given by half of each edge.
pub fn cuboid(id: u64, half_extents: [f64; 3]) -> Builder {
    of(id, geometry::cuboid(half_extents))
}

/// A capsule along its local y.
pub fn capsule(id: u64, half_height: f64, radius: f64) -> Builder {
    of(id, geometry::capsule(half_height, radius))
}

/// A cylinder along its local y.
pub fn cylinder(id: u64, half_height: f64, radius: f64) -> Builder {
    of(id, geometry::cylinder(half_height, radius))
}

/// A cone along its local y, the apex up.
pub fn cone(id: u64, half_height: f64, radius: f64) -> Builder {
    of(id, geometry::cone(half_height, radius))
}

/// An ellipsoid, given by its half axes.
pub fn ellipsoid(id: u64, radii: [f64; 3]) -> Builder {
    of(id, geometry::ellipsoid(radii))
}

/// Everything below a plane, given by its outward normal and where it cuts that, in the shape's own frame.
pub fn half_space(id: u64, normal: [f64; 3], offset: f64) -> Builder {
    of(id, geometry::half_space(normal, offset))
}

/// A convex hull of points in the shape's own frame.
pub fn hull(id: u64, points: impl IntoIterator<Item = [f32; 3]>) -> Builder {
    of(id, geometry::hull(points))
}

impl Builder {
    /// Places it: the world position of its local origin.
    pub fn at(mut self, position: [f64; 3]) -> Self {
        self.shape.pose.get_or_insert_default().position = Some(vec3(position));
        self
    }

    /// Turns it: a quaternion `[x, y, z, w]` of any length but 0.
    pub fn rotated(mut self, rotation: [f64; 4]) -> Self {
        self.shape.pose.get_or_insert_default().rotation = Some(quat(rotation));
        self
    }

    /// Keeps it in the static tree, for what seldom moves.
    pub fn fixed(mut self) -> Self {
        self.shape.mobility = proto::Mobility::Static.into();
        self
    }

    /// The layers it is on, and those it overlaps with; a bit for each.
    pub fn layers(mut self, layers: u32, collides_with: u32) -> Self {
        self.shape.layers = Some(layers);
        self.shape.collides_with = Some(collides_with);
        self
    }

    /// Sweeps the way of each of its moves; what it touched comes with the edit's answer.
    pub fn bullet(mut self) -> Self {
        self.shape.bullet = true;
        self
    }

    /// A number that comes back with every hit.
    pub fn user_data(mut self, user_data: u64) -> Self {
        self.shape.user_data = user_data;
        self
    }

    /// The message.
    pub fn build(self) -> proto::Shape {
        self.shape
    }

    /// The edit that inserts it, replacing whole what has its id.
    pub fn insert(self) -> proto::Edit {
        crate::edit::insert(self.shape)
    }
}

impl From<Builder> for proto::Shape {
    fn from(builder: Builder) -> Self {
        builder.shape
    }
}
