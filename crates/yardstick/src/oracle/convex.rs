//! Support heights of convex forms, and what follows from them.

use glam::{DMat3, DVec3};

use crate::sets::{Form, Placed, PointCloud};

/// How far a placed form reaches along a direction from its own origin: the maximum of `direction · (x − position)`
/// over its points `x`, metres for a unit direction. A mesh counts as the hull of its vertices.
#[must_use]
pub fn support_height(placed: &Placed, direction: DVec3) -> f64 {
    let local = placed.pose.matrix().transpose() * direction;
    let highest = |points: &[DVec3]| points.iter().map(|point| local.dot(*point)).fold(f64::NEG_INFINITY, f64::max);
    match &placed.form {
        Form::Sphere { radius } => radius * direction.length(),
        Form::Capsule { half_height, radius } => half_height * local.y.abs() + radius * direction.length(),
        Form::Cuboid { half_extents } => half_extents.dot(local.abs()),
        Form::Hull(cloud) => highest(&cloud.points),
        Form::Mesh(mesh) => highest(&mesh.vertices),
    }
}

/// The gap between two placed convex forms along a unit vector from `a` to `b`: positive if a plane across it parts
/// them, else minus the way that `b` must go along it to be clear. Whatever the vector, the signed distance is not
/// below it. Positions are differenced first, so that nothing is lost far from the origin.
#[must_use]
pub fn separation_along(a: &Placed, b: &Placed, a_to_b: DVec3) -> f64 {
    let offset = b.pose.position - a.pose.position;
    a_to_b.dot(offset) - support_height(a, a_to_b) - support_height(b, -a_to_b)
}

/// Most points of a hull whose faces are looked for: their number is cubed.
const HULL_POINTS_WITH_FACES: usize = 128;

/// Signed distance of a point to a convex form: exact for spheres and capsules, boxes and points inside a hull; for
/// points outside a hull it is the distance to the plane of the farthest face, which is a lower bound.
#[must_use]
pub fn signed_distance_lower(placed: &Placed, point: DVec3) -> f64 {
    let local = placed.pose.matrix().transpose() * (point - placed.pose.position);
    match &placed.form {
        Form::Sphere { radius } => local.length() - radius,
        Form::Capsule { half_height, radius } => {
            let on_segment = DVec3::new(0.0, local.y.clamp(-half_height, *half_height), 0.0);
            (local - on_segment).length() - radius
        }
        Form::Cuboid { half_extents } => {
            let beyond = local.abs() - *half_extents;
            let outside = beyond.max(DVec3::ZERO).length();
            if outside > 0.0 { outside } else { beyond.max_element() }
        }
        Form::Hull(cloud) => farthest_plane(cloud, local),
        Form::Mesh(_) => f64::NAN,
    }
}

/// The greatest signed distance of a point to the planes of a hull's faces; 0 if the hull has no faces to look at (it
/// is flat, or too large) and the point lies in its box.
fn farthest_plane(cloud: &PointCloud, point: DVec3) -> f64 {
    let mut farthest = f64::NEG_INFINITY;
    if cloud.points.len() <= HULL_POINTS_WITH_FACES {
        for_each_face(&cloud.points, |normal, height| farthest = farthest.max(normal.dot(point) - height));
    }
    if farthest.is_finite() {
        return farthest;
    }
    DMat3::IDENTITY
        .to_cols_array_2d()
        .iter()
        .flat_map(|axis| [DVec3::from_array(*axis), -DVec3::from_array(*axis)])
        .map(|axis| axis.dot(point) - highest(&cloud.points, axis))
        .fold(0.0, f64::max)
}

fn highest(points: &[DVec3], direction: DVec3) -> f64 {
    points.iter().map(|point| direction.dot(*point)).fold(f64::NEG_INFINITY, f64::max)
}

/// Calls with unit normal and height of every plane through three of the points that has all others on one side. The
/// height is that of the highest point, so that the half space holds the hull even if the plane is a little off.
fn for_each_face(points: &[DVec3], mut call: impl FnMut(DVec3, f64)) {
    let size = points.iter().map(|point| point.abs().max_element()).fold(0.0, f64::max);
    let off_plane = 1e-12 * size;
    for (i, &a) in points.iter().enumerate() {
        for (j, &b) in points.iter().enumerate().skip(i + 1) {
            for &c in &points[j + 1..] {
                let cross = (b - a).cross(c - a);
                // Three points nearly on a line span no plane that could be trusted.
                if cross.length() <= 1e-6 * (b - a).length() * (c - a).length() {
                    continue;
                }
                let normal = cross.normalize();
                let height = normal.dot(a);
                if points.iter().all(|point| normal.dot(*point) - height <= off_plane) {
                    call(normal, highest(points, normal));
                }
                if points.iter().all(|point| normal.dot(*point) - height >= -off_plane) {
                    call(-normal, highest(points, -normal));
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::sets::Pose;

    fn cube_points() -> Vec<DVec3> {
        (0..8)
            .map(|corner| DVec3::new(f64::from(corner & 1), f64::from(corner >> 1 & 1), f64::from(corner >> 2)))
            .collect()
    }

    #[test]
    fn a_cube_is_a_cube_as_box_and_as_hull() {
        let rotation = [0.2, -0.4, 0.1, 0.7];
        let hull_points = cube_points().into_iter().map(|corner| corner * 2.0 - 1.0).collect();
        let hull = Form::Hull(Arc::new(PointCloud { points: hull_points }));
        let pose = Pose::from_arrays([5.0, -3.0, 2.0], rotation);
        let [cuboid, hull] = [Form::Cuboid { half_extents: DVec3::ONE }, hull].map(|form| Placed { form, pose });
        for direction in [DVec3::X, DVec3::new(0.6, 0.0, -0.8), DVec3::new(1.0, 2.0, 3.0).normalize()] {
            let difference = support_height(&cuboid, direction) - support_height(&hull, direction);
            assert!(difference.abs() < 1e-15);
            let inside = pose.position + 0.3 * direction;
            let difference = signed_distance_lower(&cuboid, inside) - signed_distance_lower(&hull, inside);
            assert!(difference.abs() < 1e-15, "{difference}");
        }
    }

    #[test]
    fn separation_of_balls_is_their_gap() {
        let ball = |x: f64, radius: f64| Placed { form: Form::Sphere { radius }, pose: Pose::at(DVec3::X * x) };
        assert_eq!(separation_along(&ball(0.0, 1.0), &ball(4.0, 2.0), DVec3::X), 1.0);
        assert_eq!(separation_along(&ball(0.0, 1.0), &ball(2.5, 2.0), DVec3::X), -0.5);
        assert_eq!(signed_distance_lower(&ball(0.0, 1.0), DVec3::Y * 3.0), 2.0);
    }

    #[test]
    fn a_capsule_reaches_along_its_segment() {
        let capsule = Placed { form: Form::Capsule { half_height: 2.0, radius: 0.5 }, pose: Pose::at(DVec3::ZERO) };
        assert_eq!(support_height(&capsule, DVec3::Y), 2.5);
        assert_eq!(support_height(&capsule, DVec3::X), 0.5);
        assert_eq!(signed_distance_lower(&capsule, DVec3::new(1.0, 1.0, 0.0)), 0.5);
    }
}
