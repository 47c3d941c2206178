//! Answers from stand-ins hold the truth, and contradict no verdict.

use std::{ops::ControlFlow, sync::Arc};

use collision::{
    DQuat, DVec3,
    accuracy::{Accuracy, Tier},
    answer::{Bound, Model, Representation, Verdict, Work},
    decompose::{Options, decompose},
    math::Pose,
    narrow::{self, Placed},
    shape::{Form, Geometry},
};

use crate::forms::{Body, KINDS, Noise, bumpy, form, l_prism, pair};

/// Pairs of each test: all kinds, three times.
const PAIRS: usize = 3 * 7 * KINDS;

/// Pairs of meshes close by, of which alone the simplified hull is asked whether they touch.
const MESH_PAIRS: usize = 200;

fn loose(max_error: f64, max_error_relative: f64) -> Accuracy {
    Accuracy { max_error, max_error_relative, ..Accuracy::default() }
}

fn tolerances(size: f64) -> [Accuracy; 5] {
    [loose(size, 0.0), loose(0.1 * size, 0.0), loose(0.01 * size, 0.0), loose(0.0, 0.1), Accuracy::of(Tier::Fast)]
}

fn size([a, b]: &[Body; 2]) -> f64 {
    a.geometry.reach().max(b.geometry.reach())
}

/// Counts of answers by what they were found on.
#[derive(Debug, Default)]
struct Tally([usize; 5]);

impl Tally {
    fn add(&mut self, representation: Representation) {
        self.0[representation as usize] += 1;
    }
}

#[test]
fn the_distance_lies_in_the_interval_of_every_rung() {
    let mut noise = Noise(21);
    let mut tally = Tally::default();
    for number in 0..PAIRS {
        let bodies = pair(&mut noise, number);
        let [a, b] = [bodies[0].placed(), bodies[1].placed()];
        let exact = narrow::distance(a, b, 1e12, &Accuracy::of(Tier::Exact), &mut Work::default());
        let exact = exact.expect("within any distance").certificate.bound;
        for accuracy in tolerances(size(&bodies)) {
            let ask =
                |a, b| narrow::distance(a, b, 1e12, &accuracy, &mut Work::default()).expect("within any distance");
            let found = ask(a, b);
            let (bound, model) = (found.certificate.bound, found.certificate.model);
            assert!(bound.lower <= exact.upper && exact.lower <= bound.upper, "{number}: {bound:?} not {exact:?}");
            assert!(bound.contains(found.distance) && found.distance >= 0.0, "{number}: {found:?}");
            if model.representation != Representation::Exact {
                let allowed = accuracy.max_error.max(accuracy.max_error_relative * bound.lower);
                assert!(bound.width() <= allowed, "{number}: {bound:?} is wider than {allowed}");
                assert!(model.outside + model.inside > 0.0, "{number}: {model:?}");
            }
            let back = ask(b, a);
            assert_eq!((back.certificate, back.distance), (found.certificate, found.distance), "{number}");
            assert_eq!((back.point_on_a, back.point_on_b), (found.point_on_b, found.point_on_a), "{number}");
            tally.add(model.representation);
        }
    }
    // No mesh brings parts here.
    let [ball, oriented_box, hull, _, exact] = tally.0;
    assert!([ball, oriented_box, hull, exact].iter().all(|&count| count > 25), "vacuous: {tally:?}");
}

#[test]
fn what_is_beyond_a_limit_is_beyond_it() {
    let mut noise = Noise(22);
    let (mut none, mut hit) = (0, 0);
    for number in 0..PAIRS {
        let bodies = pair(&mut noise, number);
        let [a, b] = [bodies[0].placed(), bodies[1].placed()];
        let exact = narrow::distance(a, b, 1e12, &Accuracy::of(Tier::Exact), &mut Work::default());
        let exact = exact.expect("within any distance").certificate.bound;
        let limit = exact.upper * noise.between(0.5, 1.5);
        for accuracy in tolerances(size(&bodies)) {
            match narrow::distance(a, b, limit, &accuracy, &mut Work::default()) {
                None => {
                    assert!(exact.upper > limit, "{number}: {exact:?} is within {limit}");
                    none += 1;
                }
                Some(found) if found.certificate.verdict == Verdict::Hit => {
                    assert!(exact.lower <= limit, "{number}: {exact:?} is beyond {limit}");
                    hit += 1;
                }
                Some(_) => {}
            }
        }
    }
    assert!(none > PAIRS / 2 && hit > PAIRS / 2, "vacuous: {none} and {hit}");
}

#[test]
fn no_verdict_is_contradicted() {
    let mut noise = Noise(23);
    let mut tallies = [Tally::default(), Tally::default()];
    let all = (0..PAIRS + MESH_PAIRS).map(|number| match number < PAIRS {
        true => pair(&mut noise, number),
        false => [(); 2].map(|()| Body { geometry: Arc::new(bumpy(&mut noise, 1.0)), pose: noise.pose(1.2) }),
    });
    for (number, bodies) in all.enumerate() {
        let [a, b] = [bodies[0].placed(), bodies[1].placed()];
        let exact = narrow::overlap(a, b, &Accuracy::of(Tier::Exact), &mut Work::default());
        let accuracy = loose(0.1 * size(&bodies), 0.0);
        let found = narrow::overlap(a, b, &accuracy, &mut Work::default());
        assert_eq!(found.verdict, exact.verdict, "{number}: {found:?} but {exact:?}");
        assert_eq!(found, narrow::overlap(b, a, &accuracy, &mut Work::default()), "{number}");
        tallies[usize::from(found.verdict == Verdict::Hit)].add(found.model.representation);
        if found.verdict != Verdict::Miss {
            assert_eq!(found.model, Model::EXACT, "{number}: no stand-in proves a touch");
        }
        if let (Verdict::Miss, Some(apart)) =
            (found.verdict, narrow::distance(a, b, 1e12, &Accuracy::of(Tier::Exact), &mut Work::default()))
        {
            let lower = found.bound.lower;
            assert!(lower <= apart.certificate.bound.upper, "{number}: {lower} but {:?}", apart.certificate.bound);
        }
    }
    let [miss, hit] = tallies;
    assert!(miss.0[1] > 60 && miss.0[2] > 5 && hit.0[4] > 10, "vacuous: {miss:?} and {hit:?}");
}

#[test]
fn depths_are_asked_of_the_geometries() {
    let mut noise = Noise(24);
    for number in 0..PAIRS {
        let bodies = pair(&mut noise, number);
        let [a, b] = [bodies[0].placed(), bodies[1].placed()];
        for accuracy in tolerances(size(&bodies)) {
            let Some(found) = narrow::depth(a, b, 1e12, &accuracy, &mut Work::default()) else { continue };
            assert_eq!(found.certificate.model, Model::EXACT, "{number}");
        }
    }
}

#[test]
fn a_hollow_is_never_taken_for_matter() {
    let shell = Body { geometry: bumpy(&mut Noise(25), 1.0).into(), pose: Pose::IDENTITY };
    let center = shell.geometry.local_bounds().center();
    let bubble = Body { geometry: Geometry::sphere(0.05).expect("a ball").into(), pose: Pose::at(center) };
    for accuracy in tolerances(10.0) {
        let found = narrow::overlap(shell.placed(), bubble.placed(), &accuracy, &mut Work::default());
        assert_eq!((found.verdict, found.model.representation), (Verdict::Miss, Representation::Exact));
        let apart = narrow::distance(shell.placed(), bubble.placed(), 1e12, &accuracy, &mut Work::default());
        let apart = apart.expect("within any distance").certificate;
        assert!(apart.model.representation == Representation::Exact && apart.bound.lower > 0.0, "{apart:?}");
    }
}

#[test]
fn convex_parts_that_a_mesh_brings_along_are_a_rung() {
    let mut noise = Noise(27);
    let bare = l_prism();
    let Form::Mesh(mesh) = bare.form() else { unreachable!("it is a mesh") };
    let options = Options::default();
    let parts = decompose(mesh, &options, &mut |_| ControlFlow::Continue(())).expect("nobody calls it off");
    let parted = parts.attached(&bare, &options).expect("a mesh");
    let mut tally = Tally::default();
    for number in 0..200 {
        let far = noise.between(1.0, 4.0);
        let other = form(&mut noise, number, 0.5);
        let (here, there) = (noise.pose(0.0), noise.pose(far));
        let [a, b] = [(&parted, here), (&other, there)].map(|(geometry, pose)| Placed { geometry, pose });
        let exact = narrow::distance(a, b, 1e12, &Accuracy::of(Tier::Exact), &mut Work::default());
        let exact = exact.expect("within any distance").certificate.bound;
        for max_error in [1.0, 0.3, 0.1] {
            let found = narrow::distance(a, b, 1e12, &loose(max_error, 0.0), &mut Work::default());
            let found = found.expect("within any distance").certificate;
            let bound = found.bound;
            assert!(bound.lower <= exact.upper && exact.lower <= bound.upper, "{number}: {found:?} not {exact:?}");
            tally.add(found.model.representation);
        }
    }
    assert!(tally.0[Representation::Decomposition as usize] > 50, "vacuous: {tally:?}");
}

/// Whole turns about an axis and powers of two change no digit of a stand-in's errors.
#[test]
fn moving_and_scaling_both_moves_and_scales_the_answer() {
    let mut noise = Noise(26);
    let accuracy = loose(0.0, 0.1);
    let mut from_rungs = 0;
    for number in 0..400 {
        let bodies = pair(&mut noise, number);
        let ask = |bodies: &[Body; 2]| {
            let [a, b] = [bodies[0].placed(), bodies[1].placed()];
            narrow::distance(a, b, 1e12, &accuracy, &mut Work::default()).expect("within any distance").certificate
        };
        let found = ask(&bodies);
        let turned = bodies.clone().map(|body| {
            let turn = DQuat::from_xyzw(0.0, 1.0, 0.0, 0.0);
            let [x, y, z] = body.pose.position.to_array();
            let pose = Pose::new(DVec3::new(-x, y, -z), turn * body.pose.rotation);
            Body { pose, ..body }
        });
        let scaled = bodies.clone().map(|body| Body {
            geometry: Geometry::clone(&body.geometry).scaled(8.0).expect("within limits").into(),
            pose: Pose { position: body.pose.position * 8.0, ..body.pose },
        });
        let (turned, scaled) = (ask(&turned), ask(&scaled));
        assert_eq!(turned.model, found.model, "{number}");
        assert_eq!(scaled.model.representation, found.model.representation, "{number}");
        // The kernels stop as soon as an interval is narrow enough, so that others are found; one truth lies in all.
        let meets =
            |bound: Bound, by: f64| bound.lower <= found.bound.upper * by && found.bound.lower * by <= bound.upper;
        assert!(meets(turned.bound, 1.0) && meets(scaled.bound, 8.0), "{number}: {found:?} {turned:?} {scaled:?}");
        from_rungs += usize::from(found.model.representation != Representation::Exact);
    }
    assert!(from_rungs > 50, "vacuous: {from_rungs}");
}
