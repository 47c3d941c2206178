//! Ways that stand-ins prove to be free are free, and times that they tell are true.

use collision::{
    DVec3,
    accuracy::{Accuracy, Tier},
    answer::{Representation, Verdict, Work},
    narrow::{self, InitialTouch, Motion, Placed},
    shape::{Form, Geometry},
};

use crate::forms::{Body, Noise, bumpy, l_prism, pair};

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

/// Two meshes, one of which goes and turns towards the other.
fn meeting(noise: &mut Noise, number: usize) -> ([Body; 2], Motion) {
    let bodies = [0, 1].map(|side| {
        let geometry = if (number + side).is_multiple_of(3) { l_prism() } else { bumpy(noise, 1.0) };
        let far = if side == 0 { 0.0 } else { 6.0 };
        Body { geometry: geometry.into(), pose: noise.pose(far) }
    });
    let aim = bodies[1].pose.position - bodies[0].pose.position;
    let turn = |noise: &mut Noise| if number.is_multiple_of(2) { noise.vector() * 2.0 } else { DVec3::ZERO };
    let (rotation_a, rotation_b) = (turn(noise), turn(noise));
    (bodies, Motion { displacement_a: aim * 1.5 + noise.vector(), rotation_a, rotation_b, ..Motion::default() })
}

#[test]
fn a_time_that_stand_ins_tell_is_true_and_as_narrow_as_asked() {
    let mut noise = Noise(32);
    let (mut told, mut geometries) = (0, 0);
    for number in 0..300 {
        let (bodies, motion) = meeting(&mut noise, number);
        let [a, b] = [bodies[0].placed(), bodies[1].placed()];
        let exact = narrow::impact(a, b, &motion, &Accuracy::of(Tier::Exact), &mut Work::default());
        for part in [1.0, 0.2, 0.05] {
            let accuracy = Accuracy { max_error_relative: part, ..Accuracy::default() };
            let ask = |a, b, motion: &Motion| narrow::impact(a, b, motion, &accuracy, &mut Work::default());
            let (Some(found), Some(exact)) = (ask(a, b, &motion), exact) else { continue };
            if found.certificate.model.representation == Representation::Exact {
                geometries += 1;
                continue;
            }
            let (bound, truth) = (found.certificate.bound, exact.certificate.bound);
            assert!(bound.lower <= truth.upper && truth.lower <= bound.upper, "{number}: {found:?} {exact:?}");
            assert!(bound.contains(found.fraction) && bound.width() <= part * bound.lower, "{number}: {found:?}");
            assert_eq!(found.certificate.verdict, Verdict::Hit, "{number}");
            let Motion { displacement_a, rotation_a, rotation_b, .. } = motion;
            let swapped = Motion {
                displacement_a: DVec3::ZERO,
                displacement_b: displacement_a,
                rotation_a: rotation_b,
                rotation_b: rotation_a,
                ..motion
            };
            assert_eq!(ask(b, a, &swapped).expect("it is met").certificate, found.certificate, "{number}");
            told += 1;
        }
    }
    assert!(told > 100 && geometries > 30, "vacuous: {told} and {geometries}");
}

/// Of two meshes that turn all triangles are asked, in one span of time.
#[test]
fn spans_of_a_turn_leave_out_nothing_that_is_touched() {
    let mut noise = Noise(33);
    let exact = Accuracy::of(Tier::Exact);
    let mut touched = 0;
    // One of each pair at least is of few triangles.
    for number in (0..24).filter(|number| number % 3 != 2) {
        let (bodies, motion) = meeting(&mut noise, 2 * number);
        let [a, b] = [bodies[0].placed(), bodies[1].placed()];
        let found = narrow::impact(a, b, &motion, &exact, &mut Work::default());
        let triangles = |body: &Body| {
            let Form::Mesh(mesh) = body.geometry.form() else { unreachable!("it is a mesh") };
            let corners = (0..mesh.triangles().len()).map(|triangle| mesh.corners(triangle));
            corners.map(|corners| Geometry::mesh(&corners, &[[0, 1, 2]]).expect("a triangle")).collect::<Vec<_>>()
        };
        let (of_a, of_b) = (triangles(&bodies[0]), triangles(&bodies[1]));
        let times =
            of_a.iter().flat_map(|one| of_b.iter().map(move |other| (one, other))).filter_map(|(one, other)| {
                let [one, other] = [(one, a.pose), (other, b.pose)].map(|(geometry, pose)| Placed { geometry, pose });
                narrow::impact(one, other, &motion, &exact, &mut Work::default()).map(|touch| touch.certificate.bound)
            });
        let first = times.reduce(|one, other| if other.upper < one.upper { other } else { one });
        match (found.map(|found| found.certificate.bound), first) {
            (None, None) => {}
            (Some(found), Some(first)) => {
                assert!(found.lower <= first.upper && first.lower <= found.upper, "{number}: {found:?} {first:?}");
                touched += 1;
            }
            found => panic!("{number}: {found:?}"),
        }
    }
    assert!((5..16).contains(&touched), "vacuous: {touched}");
}
