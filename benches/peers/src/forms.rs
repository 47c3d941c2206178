//! The shapes that are asked about, as each engine has them: the same numbers, all of which f32 holds exactly.

use collision::{DQuat, DVec3, math::Pose, shape::Geometry};
use parry3d::shape::{Ball, Capsule, ConvexPolyhedron, Cuboid, Shape};

/// A shape in its own frame.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Form {
    /// Half extents.
    Cuboid([f32; 3]),
    /// Radius.
    Ball(f32),
    /// Along y.
    Capsule { half_height: f32, radius: f32 },
    /// The hull of these.
    Hull(Vec<[f32; 3]>),
}

/// Where a shape is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Place {
    pub(crate) position: [f32; 3],
    /// A unit quaternion, x, y, z, w.
    pub(crate) rotation: [f32; 4],
}

/// Rounded to f32.
pub(crate) fn single(vector: DVec3) -> [f32; 3] {
    vector.to_array().map(|coordinate| coordinate as f32)
}

/// The vector of these coordinates.
pub(crate) fn vector(coordinates: [f32; 3]) -> DVec3 {
    DVec3::from_array(coordinates.map(f64::from))
}

/// The geometry of a form.
pub(crate) fn geometry(form: &Form) -> Geometry {
    let geometry = match form {
        Form::Cuboid(half_extents) => Geometry::cuboid(vector(*half_extents)),
        Form::Ball(radius) => Geometry::sphere(f64::from(*radius)),
        Form::Capsule { half_height, radius } => Geometry::capsule(f64::from(*half_height), f64::from(*radius)),
        Form::Hull(points) => Geometry::hull(&points.iter().copied().map(vector).collect::<Vec<_>>()),
    };
    geometry.expect("sizes of the workload are within limits")
}

/// The pose of a place.
pub(crate) fn pose(place: &Place) -> Pose {
    Pose::new(vector(place.position), DQuat::from_array(place.rotation.map(f64::from)))
}

/// parry3d's shape of a form.
pub(crate) fn parry_shape(form: &Form) -> Box<dyn Shape> {
    use parry3d::math::Vector;
    match form {
        Form::Cuboid(half_extents) => Box::new(Cuboid::new(Vector::from_array(*half_extents))),
        Form::Ball(radius) => Box::new(Ball::new(*radius)),
        Form::Capsule { half_height, radius } => Box::new(Capsule::new_y(*half_height, *radius)),
        Form::Hull(points) => {
            let points: Vec<Vector> = points.iter().copied().map(Vector::from_array).collect();
            Box::new(ConvexPolyhedron::from_convex_hull(&points).expect("points all around have a hull"))
        }
    }
}

/// parry3d's pose of a place.
pub(crate) fn parry_pose(place: &Place) -> parry3d::math::Pose {
    use parry3d::math::{Pose, Rotation, Vector};
    Pose::from_parts(Vector::from_array(place.position), Rotation::from_array(place.rotation))
}
