//! Parts that are made of meshes for questions that name an error.

use std::{ops::ControlFlow, sync::Arc};

use collision::{
    DVec3,
    accuracy::{Accuracy, Tier},
    answer::{Representation, Verdict, Work},
    decompose::{Options, furnish},
    math::Pose,
    narrow::{Contacts, NeedsDecomposition, PartsWanted, Placed, overlap, parts_wanted, penetration},
    shape::{Fineness, Geometry, MeshMode, Part},
    world::{Edit, EditRule, Filter, Meter, Penetration, QuestionError, Shape, ShapeId, Subject, Time, World},
};

use crate::{
    cubes::{Cubes, Noise},
    sampled::{mesh_of, parts_of},
};

/// An error for an L of three cubes.
const LOOSE: Accuracy = Accuracy { max_error: 0.25, ..Accuracy::of(Tier::Standard) };

/// An L of three cubes, closed.
fn l_shape(mode: MeshMode) -> Geometry {
    let mut cubes = vec![false; 64];
    [0, 1, 4].into_iter().for_each(|cell| cubes[cell] = true);
    let (vertices, triangles) = Cubes(cubes).surface();
    Geometry::mesh_as(mode, &vertices, &triangles).expect("a mesh")
}

fn at(geometry: &Geometry, pose: Pose) -> Placed<'_> {
    Placed { geometry, pose }
}

fn contacts(a: Placed<'_>, b: Placed<'_>, accuracy: &Accuracy) -> Result<Contacts, NeedsDecomposition> {
    penetration(a, b, 0.0, accuracy, &mut Work::default())
}

/// Makes what is wanted; how much that was.
fn make(wanted: &[PartsWanted]) -> usize {
    for PartsWanted { mesh, fineness } in wanted {
        furnish(mesh, *fineness, &mut |_| ControlFlow::Continue(())).expect("nobody calls it off");
    }
    wanted.len()
}

#[test]
fn a_question_that_names_an_error_has_an_answer_once_its_parts_are_made_and_no_other_before() {
    let [one, other] = [MeshMode::TwoSided, MeshMode::OneSided].map(l_shape);
    let (here, there) = (at(&one, Pose::IDENTITY), at(&other, Pose::at(DVec3::new(0.875, 1.125, 0.25))));
    let exact = Accuracy::of(Tier::Exact);
    for accuracy in [&exact, &Accuracy::default()] {
        assert!(parts_wanted([&one, &other], accuracy).is_empty(), "no error is named");
    }
    let wanted = parts_wanted([&one, &other], &LOOSE);
    assert_eq!(contacts(here, there, &LOOSE).err(), Some(NeedsDecomposition));
    // Half of it is not enough, since what is made must not matter.
    assert_eq!(make(&wanted[..1]), 1);
    assert_eq!(contacts(here, there, &LOOSE).err(), Some(NeedsDecomposition));
    assert_eq!(parts_wanted([&one, &other], &LOOSE), wanted[1..]);
    let before = other.memory_bytes();
    assert_eq!(make(&wanted), 2);
    assert!(other.memory_bytes() > before && parts_wanted([&one, &other], &LOOSE).is_empty());
    let found = contacts(here, there, &LOOSE).expect("both have parts");
    let touch = overlap(here, there, &exact, &mut Work::default()).verdict;
    assert_eq!(touch, Verdict::Hit);
    let mut deepest = 0.0_f64;
    for contact in &found {
        let model = contact.certificate.model;
        assert_eq!(model.representation, Representation::Decomposition);
        assert!(model.inside + model.outside <= LOOSE.max_error, "{model:?}");
        deepest = deepest.max(contact.depth);
    }
    // The upright arm of the one is 1/8 deep in the lower arm of the other.
    assert!((deepest - 0.125).abs() <= LOOSE.max_error, "{deepest}");
    // Other errors need other parts, the exact tier has none.
    let finer = Accuracy { max_error: 0.01, ..LOOSE };
    assert_eq!(parts_wanted([&one, &other], &finer).len(), 2);
    assert_eq!(contacts(here, there, &exact).err(), Some(NeedsDecomposition));
}

#[test]
fn errors_that_are_alike_share_parts_and_parts_are_as_near_as_was_asked() {
    let geometry = l_shape(MeshMode::TwoSided);
    let mesh = mesh_of(&geometry);
    let mut noise = Noise(0x77);
    let mut steps = Vec::new();
    for _ in 0..200 {
        let error = mesh_diagonal(&geometry) * noise.share() * 0.3 + 1e-9;
        let step = Fineness::within(error, mesh);
        let is_finest = step == Fineness::within(0.0, mesh);
        assert!(step.max_error(mesh) <= error || is_finest);
        assert!(step.max_error(mesh) * 2.0 > error || step == Fineness::within(f64::INFINITY, mesh));
        steps.push(step);
    }
    steps.sort();
    steps.dedup();
    assert!((3..=8).contains(&steps.len()), "{steps:?}");
    let step = steps[1];
    furnish(mesh, step, &mut |_| ControlFlow::Continue(())).expect("nobody calls it off");
    let made = mesh.made_parts(step).expect("it keeps them");
    assert!(made.inside.upper + made.outside.upper <= step.max_error(mesh) + 1e-9);
    assert_eq!(mesh.all_made_parts().count(), 1);
    assert!(furnish(mesh, steps[2], &mut |_| ControlFlow::Break(())).is_err() || mesh.made_parts(steps[2]).is_some());
}

fn mesh_diagonal(geometry: &Geometry) -> f64 {
    let bounds = geometry.local_bounds();
    (bounds.max - bounds.min).length()
}

/// A mesh with parts, a bare one and a ball beside it, as one: contacts are those of the single forms.
#[test]
fn meshes_within_compounds_are_told_by_their_parts_too() {
    let bare = l_shape(MeshMode::TwoSided);
    let options = Options::default();
    let parted = Arc::new(parts_of(&bare, &options).attached(&bare, &options).expect("a mesh"));
    let ball = Arc::new(Geometry::sphere(0.5).expect("a ball"));
    let part = |geometry: &Arc<Geometry>, x: f64| Part { geometry: geometry.clone(), pose: Pose::at(DVec3::X * x) };
    let compound = Geometry::compound(vec![part(&ball, -8.0), part(&parted, 0.0)]).expect("a compound");
    let nested = Arc::new(compound.clone());
    let nested = Geometry::compound(vec![part(&ball, 16.0), part(&nested, 0.0)]).expect("a compound");
    let exact = Accuracy::of(Tier::Exact);
    let mut noise = Noise(0x515);
    let mut deep = 0;
    for _ in 0..60 {
        let there = at(&bare, Pose::at(noise.vector() * 2.0));
        let alone = contacts(at(&parted, Pose::IDENTITY), there, &exact).expect("one has parts");
        for (whole, leaf) in [(&compound, 1), (&nested, 2)] {
            let found = contacts(at(whole, Pose::IDENTITY), there, &exact).expect("one has parts");
            assert_eq!(found.len(), alone.len());
            let depths = |contacts: &Contacts| {
                let mut depths: Vec<f64> = contacts.iter().map(|contact| contact.depth).collect();
                depths.sort_by(f64::total_cmp);
                depths
            };
            for (depth, other) in depths(&found).into_iter().zip(depths(&alone)) {
                assert!((depth - other).abs() < 1e-12, "{depth} {other}");
            }
            assert!(found.iter().all(|contact| contact.feature_a.part == Some(leaf)), "the leaf that the mesh is");
        }
        deep += u32::from(alone.iter().any(|contact| contact.depth > 0.0));
    }
    assert!((15..50).contains(&deep), "{deep}");
    // What is no mesh keeps its own say.
    let by_ball =
        contacts(at(&compound, Pose::IDENTITY), at(&bare, Pose::at(DVec3::X * -8.25)), &exact).expect("parts");
    assert!(by_ball.iter().all(|contact| contact.certificate.model.representation == Representation::Exact));
    assert!(!by_ball.is_empty());
    // With a bare mesh beside it on both sides parts are wanted of the bare ones only.
    let bare = Arc::new(bare);
    let mixed = Geometry::compound(vec![part(&parted, 0.0), part(&bare, 4.0)]).expect("a compound");
    let pair = [at(&mixed, Pose::IDENTITY), at(&mixed, Pose::at(DVec3::new(3.5, 0.25, 0.25)))];
    assert_eq!(contacts(pair[0], pair[1], &LOOSE).err(), Some(NeedsDecomposition));
    assert_eq!(make(&parts_wanted([&mixed, &mixed], &LOOSE)), 1);
    assert!(contacts(pair[0], pair[1], &LOOSE).is_ok_and(|found| !found.is_empty()));
}

#[test]
fn a_form_deep_in_a_solid_is_told_by_parts_made_for_it() {
    let solid = l_shape(MeshMode::Solid);
    let ball = Geometry::sphere(0.125).expect("a ball");
    let (here, there) = (at(&solid, Pose::IDENTITY), at(&ball, Pose::at(DVec3::splat(0.375))));
    assert_eq!(contacts(here, there, &LOOSE).err(), Some(NeedsDecomposition));
    assert_eq!(make(&parts_wanted([&solid, &ball], &LOOSE)), 1);
    let found = contacts(here, there, &LOOSE).expect("it has parts");
    let deepest = found.iter().map(|contact| contact.depth).fold(0.0, f64::max);
    assert!((deepest - 0.5).abs() <= LOOSE.max_error, "{deepest}");
    assert!(found.iter().all(|contact| contact.certificate.verdict == Verdict::Hit));
}

#[test]
fn a_world_says_all_that_is_to_be_made_at_once() {
    let id = |number| ShapeId::new(number).expect("not 0");
    let mut world = World::new(Time(0));
    let meshes = [MeshMode::TwoSided, MeshMode::OneSided, MeshMode::Solid].map(|mode| Arc::new(l_shape(mode)));
    let shapes = (1..).zip(&meshes).map(|(number, mesh)| {
        let pose = Pose::at(DVec3::X * (0.25 * number as f64));
        Edit::Insert(Shape::new(id(number), mesh.clone(), pose))
    });
    world.apply(shapes.collect(), Time(0), EditRule::AllOrNothing).expect("they fit");
    let snapshot = world.newest();
    let question = Penetration {
        subject: Subject::Shape { id: id(2), pose: None },
        against: None,
        max_gap: 0.0,
        max_contacts: 100,
    };
    let ask = |accuracy: &Accuracy| {
        snapshot.penetration(&question, &Filter::default(), accuracy, &mut Meter::new(&mut || true))
    };
    assert_eq!(ask(&Accuracy::default()).err(), Some(QuestionError::NeedsDecomposition(Some(id(1)))));
    let Err(QuestionError::PartsMissing { with, wanted }) = ask(&LOOSE) else { panic!("parts are missing") };
    assert_eq!((with, make(&wanted)), (Some(id(1)), 3));
    let found = ask(&LOOSE).expect("all have parts");
    let mut touched: Vec<u64> = found.hits.iter().filter_map(|hit| hit.id.map(ShapeId::get)).collect();
    touched.sort_unstable();
    touched.dedup();
    assert_eq!(touched, [1, 3]);
    let built = snapshot.describe().built;
    let parts = built.iter().find(|structure| structure.name == "decomposition").expect("it is told");
    assert!(parts.count == 3 && parts.memory_bytes > 0, "{parts:?}");
}
