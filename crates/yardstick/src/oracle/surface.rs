//! Points and triangles, all of them.

use glam::DVec3;

use crate::sets::{Pose, TriangleMesh};

/// Distance of a point to a triangle by its corners, metres.
#[must_use]
pub fn distance_to_triangle(corners: [DVec3; 3], point: DVec3) -> f64 {
    (nearest_on_triangle(corners, point) - point).length()
}

/// The nearest point of a triangle, by the region the point's projection falls into (Ericson, Real-Time Collision
/// Detection, 2005, 5.1.5). The point is made the origin first, so that small distances keep their digits.
fn nearest_on_triangle(corners: [DVec3; 3], point: DVec3) -> DVec3 {
    let [a, b, c] = corners.map(|corner| corner - point);
    let (ab, ac) = (b - a, c - a);
    let normal = ab.cross(ac);
    let normal_sq = normal.length_squared();
    // A triangle without area is its edges.
    if normal_sq > 0.0 {
        let inside = |from: DVec3, to: DVec3| (to - from).cross(-from).dot(normal) >= 0.0;
        if inside(a, b) && inside(b, c) && inside(c, a) {
            return point + normal * (a.dot(normal) / normal_sq);
        }
    }
    let edges = [nearest_to_origin(a, b), nearest_to_origin(b, c), nearest_to_origin(c, a)];
    let nearest = edges
        .into_iter()
        .fold(edges[0], |best, next| if next.length_squared() < best.length_squared() { next } else { best });
    point + nearest
}

fn nearest_to_origin(from: DVec3, to: DVec3) -> DVec3 {
    let way = to - from;
    let length_sq = way.length_squared();
    if length_sq == 0.0 {
        return from;
    }
    from + way * (-from.dot(way) / length_sq).clamp(0.0, 1.0)
}

/// The point of a placed mesh that is nearest to a point, and how far that is, metres.
#[must_use]
pub fn nearest_on_mesh(mesh: &TriangleMesh, pose: &Pose, point: DVec3) -> (DVec3, f64) {
    let matrix = pose.matrix();
    let local = matrix.transpose() * (point - pose.position);
    let mut best = (DVec3::ZERO, f64::INFINITY);
    for triangle in 0..mesh.triangles.len() {
        let nearest = nearest_on_triangle(mesh.corners(triangle), local);
        let distance = (nearest - local).length();
        if distance < best.1 {
            best = (nearest, distance);
        }
    }
    (matrix * best.0 + pose.position, best.1)
}

/// How far a point is from a placed mesh, metres.
#[must_use]
pub fn distance_to_mesh(mesh: &TriangleMesh, pose: &Pose, point: DVec3) -> f64 {
    nearest_on_mesh(mesh, pose, point).1
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Random;

    const CORNERS: [DVec3; 3] = [DVec3::ZERO, DVec3::new(2.0, 0.0, 0.0), DVec3::new(0.0, 3.0, 0.0)];

    #[test]
    fn every_region_of_a_triangle() {
        for (point, distance) in [
            (DVec3::new(0.5, 0.5, 2.0), 2.0),
            (DVec3::new(1.0, -3.0, 4.0), 5.0),
            (DVec3::new(-3.0, -4.0, 0.0), 5.0),
            (DVec3::new(2.0 + 3.0, 2.0, 0.0), 13.0_f64.sqrt()),
        ] {
            assert!((distance_to_triangle(CORNERS, point) - distance).abs() < 1e-15, "{point}");
        }
    }

    #[test]
    fn no_sampled_point_of_the_triangle_is_nearer() {
        let mut random = Random::new(1);
        for _ in 0..200 {
            let point = random.direction() * random.uniform(0.0, 5.0);
            let distance = distance_to_triangle(CORNERS, point);
            for step in 0..400 {
                let (u, v) = (f64::from(step % 20) / 19.0, f64::from(step / 20) / 19.0);
                let sample = CORNERS[0] * (1.0 - u) + CORNERS[1] * (u * (1.0 - v)) + CORNERS[2] * (u * v);
                assert!((sample - point).length() >= distance - 1e-12);
            }
        }
    }
}
