//! First touches told by stand-ins hold the truth.

use collision::{
    DVec3,
    accuracy::{Accuracy, Tier},
    answer::{Representation, Verdict, Work},
    narrow::{self, InitialTouch, Motion},
};

use crate::forms::{Noise, pair};

#[test]
fn the_first_touch_lies_in_the_interval() {
    let mut noise = Noise(31);
    let (mut free, mut from_hulls) = (0, 0);
    for number in 0..324 {
        let bodies = pair(&mut noise, number);
        let [a, b] = [bodies[0].placed(), bodies[1].placed()];
        let size = a.geometry.reach().max(b.geometry.reach());
        let aim = b.pose.position - a.pose.position + noise.vector() * size;
        let rotation = if number % 4 == 0 { noise.vector() } else { DVec3::ZERO };
        let initial = if number % 5 == 0 { InitialTouch::IsIgnored } else { InitialTouch::Counts };
        let motion = Motion { displacement_a: aim * 1.5, rotation_a: rotation, initial, ..Motion::default() };
        let exact = narrow::impact(a, b, &motion, &Accuracy::of(Tier::Exact), &mut Work::default());
        for max_error in [size, 0.1 * size] {
            let accuracy = Accuracy { max_error, max_error_relative: 0.0, ..Accuracy::of(Tier::Standard) };
            match (narrow::impact(a, b, &motion, &accuracy, &mut Work::default()), exact) {
                (None, None) => free += 1,
                (Some(found), Some(exact)) => {
                    let (bound, truth) = (found.certificate.bound, exact.certificate.bound);
                    assert!(bound.lower <= truth.upper && truth.lower <= bound.upper, "{number}: {found:?} {exact:?}");
                    let is_hull = found.certificate.model.representation == Representation::SimplifiedHull;
                    from_hulls += usize::from(is_hull);
                }
                (Some(found), None) => assert_ne!(found.certificate.verdict, Verdict::Hit, "{number}: {found:?}"),
                (None, Some(exact)) => assert_ne!(exact.certificate.verdict, Verdict::Hit, "{number}: {exact:?}"),
            }
        }
    }
    assert!(free > 50 && from_hulls > 10, "vacuous: {free} and {from_hulls}");
}
