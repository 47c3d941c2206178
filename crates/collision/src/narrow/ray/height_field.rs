//! Rays against height fields: bodies, whose skin is made of triangles.
//!
//! # Method
//! A ray that is to feel the inside asks first whether it begins there. Else the skin is met as a mesh is; its corners go
//! counter-clockwise seen from outside, so its front is the outside of the body.

use super::{
    Aim, Faces, RayTouch, RayTouches,
    crossing::certificate,
    frame::{LocalRay, Spot, Target},
    mesh,
};
use crate::{
    answer::{Bound, Feature, Verdict, Work},
    shape::{Geometry, HeightField, Standing},
};

/// What a ray touches of a height field.
pub(super) fn touches(
    aim: &Aim<'_>,
    (field, geometry): (&HeightField, &Geometry),
    spot: Spot<'_>,
    work: &mut Work,
) -> RayTouches {
    if aim.ray.hollow || aim.ray.faces != Faces::Both {
        return mesh::touches(aim, (field, geometry), spot, work);
    }
    let center = Target::about_center(geometry, spot.blur);
    let local = LocalRay::new(aim, spot.pose, center);
    if local.passes_ball(center.radius) {
        return RayTouches::default();
    }
    work.iterations += 1;
    let begin = local.point_at(local.first);
    let inside = |verdict: Verdict| RayTouch {
        distance: local.first + 0.0,
        point: local.to_world(spot.pose, begin),
        normal: None,
        inside: true,
        feature: Feature::default(),
        barycentric: None,
        certificate: certificate(verdict, Bound::new(local.first, local.first)),
    };
    match field.standing(begin, 2.0 * local.error) {
        Standing::Inside(_) => RayTouches { certain: Some(inside(Verdict::Hit)), undecided: None },
        Standing::Outside => mesh::touches(aim, (field, geometry), spot, work),
        Standing::Open(_) => {
            let skin = mesh::touches(aim, (field, geometry), spot, work);
            let mut open = inside(Verdict::Undecided);
            if let Some(other) = skin.undecided {
                open.certificate.bound.upper = other.certificate.bound.upper;
            }
            RayTouches { undecided: Some(open), ..skin }
        }
    }
}
