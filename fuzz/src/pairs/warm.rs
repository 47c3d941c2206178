//! Warm questions: the interval has a value in common with the cold one, whatever was asked before.

use collision::{
    DQuat, DVec3,
    answer::{Bound, Work},
    math::Pose,
    narrow::{self, Warm},
};

use super::Case;
use crate::{
    law,
    numbers::{Numbers, pose_code, vector_within},
};

pub(super) fn check(case: &Case, numbers: &mut Numbers<'_>) {
    let (warm_distance, warm_contact) = (&mut Warm::default(), &mut Warm::default());
    let work = &mut Work::default();
    let (mut pose_a, mut pose_b) = (case.pose_a, case.pose_b);
    for round in 0..4 {
        let (a, b) = (case.a.at(pose_a), case.b.at(pose_b));
        // The arguments change places now and then.
        let (a, b) = if round == 3 && numbers.byte() & 1 == 1 { (b, a) } else { (a, b) };
        let accuracy = &case.accuracy;
        let cold = narrow::distance(a, b, case.limit, accuracy, work).map(|found| found.certificate.bound);
        let warm = narrow::distance_warm(a, b, case.limit, accuracy, warm_distance, work);
        let warm = warm.map(|found| {
            law!(case, found.certificate.bound.contains(found.distance), "round {round}: {found:?}");
            law!(case, found.point_on_a.is_finite() && found.point_on_b.is_finite(), "round {round}: {found:?}");
            found.certificate.bound
        });
        let place = || format!("round {round}, {} {}", pose_code(&pose_a), pose_code(&pose_b));
        agree(case, "distance", &place(), cold, warm, Bound::new(case.limit, f64::INFINITY));
        let cold = narrow::penetration(a, b, case.max_gap, accuracy, work);
        let warm = narrow::penetration_warm(a, b, case.max_gap, accuracy, warm_contact, work);
        law!(case, cold.is_ok() == warm.is_ok(), "{}", place());
        let (Ok(cold), Ok(warm)) = (cold, warm) else { return };
        if !case.is_concave() {
            let bound = |found: &narrow::Contacts| found.first().map(|contact| contact.certificate.bound);
            let none = Bound::new(f64::NEG_INFINITY, -case.max_gap);
            agree(case, "contact", &place(), bound(&cold), bound(&warm), none);
        }
        for contact in &warm {
            law!(case, contact.certificate.bound.contains(contact.depth), "{}: {contact:?}", place());
        }
        (pose_a, pose_b) = (moved(numbers, pose_a), moved(numbers, pose_b));
    }
}

/// Both hold the truth; no answer is a proof that it lies in `none`.
fn agree(case: &Case, what: &str, place: &str, cold: Option<Bound>, warm: Option<Bound>, none: Bound) {
    let (one, other) = (cold.unwrap_or(none), warm.unwrap_or(none));
    let meet = one.lower <= other.upper && other.lower <= one.upper;
    law!(case, meet, "{what}: cold {cold:?}, warm {warm:?}; {place}");
}

fn moved(numbers: &mut Numbers<'_>, pose: Pose) -> Pose {
    match numbers.below(5) {
        0 => pose,
        1 => Pose::new(vector_within(pose.position + numbers.vector()), pose.rotation),
        2 => Pose::new(vector_within(pose.position + numbers.direction() * 1e-3), pose.rotation),
        3 => {
            let turn = DQuat::from_xyzw(1e-3, -2e-3, 1e-3, 1.0);
            Pose::new(pose.position, (turn * pose.unit_rotation()).normalize())
        }
        _ => Pose::new(vector_within(DVec3::ZERO + numbers.vector()), numbers.rotation()),
    }
}
