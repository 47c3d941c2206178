//! Rays against meshes of each mode: which faces count, and whether the ray begins inside of a solid one.

use super::{
    Aim, Faces, Ray, RayTouch, RayTouches,
    crossing::certificate,
    frame::{LocalRay, Spot, Target},
    mesh,
};
use crate::{
    answer::{Bound, Feature, Verdict, Work},
    math::Pose,
    shape::{Containment, Geometry, Mesh, MeshMode},
};

/// What a ray touches of a mesh.
pub(super) fn touches(
    aim: &Aim<'_>,
    (mesh, geometry): (&Mesh, &Geometry),
    spot: Spot<'_>,
    work: &mut Work,
) -> RayTouches {
    match (mesh.mode(), aim.ray.faces) {
        (MeshMode::OneSided, Faces::Back) => return RayTouches::default(),
        (MeshMode::OneSided, Faces::Both) => {
            let fronts = Ray { faces: Faces::Front, ..*aim.ray };
            return mesh::touches(&Aim::new(&fronts), (mesh, geometry), spot, work);
        }
        (MeshMode::Solid, Faces::Both) if !aim.ray.hollow => {}
        (MeshMode::TwoSided | MeshMode::OneSided | MeshMode::Solid, _) => {
            return mesh::touches(aim, (mesh, geometry), spot, work);
        }
    }
    let center = Target::about_center(geometry, spot.blur);
    let local = LocalRay::new(aim, spot.pose, center);
    if local.passes_ball(center.radius) {
        return RayTouches::default();
    }
    match beginning(&local, mesh, work) {
        Containment::Inside => RayTouches { certain: Some(inner_touch(&local, spot.pose)), undecided: None },
        Containment::Outside => mesh::touches(aim, (mesh, geometry), spot, work),
        Containment::Undecided => {
            mesh::touches(aim, (mesh, geometry), spot, work).with_open_beginning(&local, spot.pose)
        }
    }
}

/// Where the point is from which on touches count.
fn beginning(local: &LocalRay, mesh: &Mesh, work: &mut Work) -> Containment {
    match local.exact() {
        Some(exact) if local.first == 0.0 => mesh.contains(exact.origin, work),
        _ => mesh.contains_ball(local.point_at(local.first), 2.0 * local.error, work),
    }
}

/// The touch of a ray that begins inside.
fn inner_touch(local: &LocalRay, pose: &Pose) -> RayTouch {
    RayTouch {
        distance: local.first + 0.0,
        point: local.to_world(pose, local.point_at(local.first)),
        normal: None,
        inside: true,
        feature: Feature::default(),
        barycentric: None,
        certificate: certificate(Verdict::Hit, Bound::new(local.first, local.first)),
    }
}

impl RayTouches {
    /// With what follows if the ray may as well begin inside: its beginning may be the first touch.
    fn with_open_beginning(self, local: &LocalRay, pose: &Pose) -> Self {
        let first = local.first;
        // It enters where it begins, wherever exactly that is.
        if self.certain.is_some_and(|touch| touch.certificate.bound.upper <= first + 4.0 * local.error) {
            return self;
        }
        let upper = self.undecided.map_or(first, |touch| touch.certificate.bound.upper);
        let open = RayTouch {
            certificate: certificate(Verdict::Undecided, Bound::new(first, upper)),
            ..inner_touch(local, pose)
        };
        Self { undecided: Some(open), ..self }
    }
}
