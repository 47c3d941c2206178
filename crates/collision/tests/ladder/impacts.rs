//! Ways that stand-ins prove to be free are free.

use collision::{
    DVec3,
    accuracy::{Accuracy, Tier},
    answer::{Verdict, Work},
    narrow::{self, InitialTouch, Motion},
};

use crate::forms::{Noise, pair};

#[test]
fn a_way_that_is_proved_free_is_free() {
    let mut noise = Noise(31);
    let (mut free, mut touched, mut spared) = (0, 0, 0);
    for number in 0..216 {
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
            let mut work = Work::default();
            let found = narrow::impact(a, b, &motion, &accuracy, &mut work);
            spared += usize::from(found.is_none() && work.pairs_tested <= 2 && work.nodes_visited == 0);
            match (found, exact) {
                (None, None) => free += 1,
                (Some(found), Some(exact)) => {
                    let (bound, truth) = (found.certificate.bound, exact.certificate.bound);
                    assert!(bound.lower <= truth.upper && truth.lower <= bound.upper, "{number}: {found:?} {exact:?}");
                    touched += 1;
                }
                (Some(found), None) => assert_ne!(found.certificate.verdict, Verdict::Hit, "{number}: {found:?}"),
                (None, Some(exact)) => assert_ne!(exact.certificate.verdict, Verdict::Hit, "{number}: {exact:?}"),
            }
        }
    }
    assert!(free > 30 && touched > 30 && spared > 10, "vacuous: {free}, {touched} and {spared}");
}
