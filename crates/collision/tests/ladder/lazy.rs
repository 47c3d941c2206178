//! A rung is built when a question first needs it, once, and no answer depends on what is built.

use std::{
    cell::Cell,
    sync::{Arc, Barrier},
};

use collision::{
    DVec3,
    accuracy::{Accuracy, Tier},
    answer::{Representation, Verdict, Work},
    math::Pose,
    narrow,
    shape::Geometry,
    world::{
        Distance, Edit, EditRule, Filter, Found, Means, Meter, Moment, Neighbor, Overlap, Settings, Shape, ShapeId,
        Snapshot, Subject, Tick, Time, World,
    },
};

use crate::forms::{Body, Noise, bumpy, large_hull, pair};

/// Meshes and large hulls in a row, ten metres apart.
fn world() -> (World, Vec<Arc<Geometry>>) {
    let mut noise = Noise(41);
    let geometries: Vec<Arc<Geometry>> = (0..6)
        .map(|i| Arc::new(if i % 2 == 0 { bumpy(&mut noise, 1.0) } else { large_hull(&mut noise, 1.0) }))
        .collect();
    let shapes = (1..).zip(&geometries).map(|(number, geometry)| {
        let id = ShapeId::new(number).expect("not 0");
        Shape::new(id, Arc::clone(geometry), Pose::at(DVec3::X * (10 * number) as f64))
    });
    let mut world = World::new(Time(0));
    world.apply(shapes.map(Edit::Insert).collect(), Time(1), EditRule::AllOrNothing).expect("a tick");
    (world, geometries)
}

fn ball(position: DVec3) -> Subject {
    Subject::Geometry { geometry: Arc::new(Geometry::sphere(0.5).expect("a ball")), pose: Pose::at(position) }
}

fn distances(world: &World, accuracy: &Accuracy) -> Found<Neighbor> {
    distances_in(&world.newest(), accuracy)
}

fn distances_in(version: &Snapshot, accuracy: &Accuracy) -> Found<Neighbor> {
    let mut keep_going = || true;
    let question =
        Distance { subject: ball(DVec3::new(35.0, 15.0, 0.0)), against: None, max_distance: 1e3, max_hits: 10 };
    let found = version.distance(&question, &Filter::default(), accuracy, &mut Meter::new(&mut keep_going));
    found.expect("an answer")
}

/// What a geometry holds beside its rungs, bytes.
fn without_rungs(geometry: &Geometry) -> u64 {
    geometry.memory_bytes() - geometry.stand_ins_built().map(|rung| rung.memory_bytes()).sum::<u64>()
}

#[test]
fn loose_questions_build_nothing_exact_and_others_get_it() {
    let (world, geometries) = world();
    let before: Vec<u64> = geometries.iter().map(|geometry| geometry.memory_bytes()).collect();
    let loose = Accuracy { max_error: 3.0, max_error_relative: 0.0, ..Accuracy::default() };
    assert_eq!(distances(&world, &loose).hits.len(), 6);
    let mut keep_going = || true;
    let question = Overlap { subject: ball(DVec3::new(11.9, 1.9, 1.9)), against: None, max_hits: 10 };
    let found = world.newest().overlap(&question, &Filter::default(), &loose, &mut Meter::new(&mut keep_going));
    assert_eq!(found.expect("an answer").verdict, Verdict::Miss);
    for (geometry, before) in geometries.iter().zip(&before) {
        assert!(geometry.stand_ins_built().count() >= 2, "ball and box");
        assert_eq!(without_rungs(geometry), *before, "nothing else was built");
    }
    let built: Vec<&str> = world.newest().describe().built.iter().map(|built| built.name).collect();
    assert!(built.contains(&"ball_and_box") && !built.contains(&"mesh_tree"), "{built:?}");
    distances(&world, &Accuracy::of(Tier::Exact));
    for (geometry, before) in geometries.iter().zip(&before) {
        assert!(without_rungs(geometry) > *before, "now it was");
    }
}

#[test]
fn a_question_that_names_no_error_is_asked_of_the_geometry() {
    let (world, geometries) = world();
    for accuracy in [Accuracy::default(), Accuracy::of(Tier::Exact)] {
        let found = distances(&world, &accuracy);
        assert!(found.hits.iter().all(|hit| hit.separation.certificate.model.representation == Representation::Exact));
    }
    assert!(geometries.iter().all(|geometry| geometry.stand_ins_built().next().is_none()), "no rung was needed");
}

#[test]
fn first_questions_at_once_build_once() {
    let mut noise = Noise(42);
    for geometry in [bumpy(&mut noise, 1.0), large_hull(&mut noise, 1.0)] {
        let start = Barrier::new(8);
        let found: Vec<usize> = std::thread::scope(|scope| {
            let ask = || {
                start.wait();
                let rungs = [Representation::Ball, Representation::OrientedBox, Representation::SimplifiedHull];
                let rung = |rung| std::ptr::from_ref(geometry.stand_in(rung).expect("a rung")) as usize;
                rungs.map(rung).iter().fold(0, |all: usize, &at| all.wrapping_mul(31).wrapping_add(at))
            };
            let asking: Vec<_> = (0..8).map(|_| scope.spawn(ask)).collect();
            asking.into_iter().map(|thread| thread.join().expect("no panic")).collect()
        });
        assert!(found.iter().all(|&rungs| rungs == found[0]), "all have the same");
        assert_eq!(geometry.stand_ins_built().count(), 3);
    }
}

#[test]
fn what_is_built_says_at_which_tick_and_how_long_that_took() {
    thread_local!(static READ: Cell<i64> = const { Cell::new(0) });
    // Each look at the clock is a nanosecond later.
    let clock = || {
        READ.set(READ.get() + 1);
        READ.get()
    };
    let (_, geometries) = world();
    let shapes: Vec<Shape> = (1..)
        .zip(&geometries)
        .map(|(number, geometry)| {
            let id = ShapeId::new(number).expect("not 0");
            Shape::new(id, Arc::clone(geometry), Pose::at(DVec3::X * (10 * number) as f64))
        })
        .collect();
    let (tick, settings) = (Tick::new(40).expect("not 0"), Settings { history_ticks: 8, ..Settings::default() });
    let means = Means { clock: Some(clock), ..Means::default() };
    let mut world = World::holding(shapes, tick, Time(0), settings, means);
    let step = |world: &mut World, time| {
        let id = ShapeId::new(1).expect("not 0");
        let position = Some(DVec3::new(10.0, 0.0, time as f64 * 1e-3));
        let moved =
            Edit::Move { id, position, rotation: None, velocity: None, angular_velocity: None, teleport: false };
        world.apply(vec![moved], Time(time), EditRule::AllOrNothing).expect("a tick");
    };
    step(&mut world, 1);
    let named = |world: &World, name: &str| {
        let built = world.newest().describe().built;
        built
            .into_iter()
            .find(|built| built.name == name)
            .map(|built| (built.build_ns, built.first_tick.map(Tick::get)))
    };
    let loose = Accuracy { max_error: 3.0, max_error_relative: 0.0, ..Accuracy::default() };
    distances(&world, &loose);
    assert_eq!(named(&world, "ball_and_box"), Some((Some(6), Some(41))), "six geometries, a nanosecond each");
    assert_eq!(named(&world, "mesh_tree"), None);
    step(&mut world, 2);
    // A question to the past is of the past's tick.
    let past = world.newest().at(Moment::Tick(Tick::new(41).expect("not 0"))).expect("it is held");
    distances_in(&past, &Accuracy::of(Tier::Exact));
    step(&mut world, 3);
    distances(&world, &Accuracy::of(Tier::Exact));
    assert_eq!(named(&world, "mesh_tree"), Some((Some(3), Some(41))));
    assert_eq!(named(&world, "ball_and_box"), Some((Some(6), Some(41))), "nothing was built twice");
    for geometry in &geometries {
        assert!(geometry.stand_ins_built().all(|rung| rung.receipt().first_tick == Some(41)));
        assert!(
            geometry.structures_built().iter().all(|built| built.memory_bytes > 0 && built.receipt.build_ns.is_some())
        );
    }
}

/// The same forms, with nothing built.
fn afresh(bodies: &[Body; 2]) -> [Body; 2] {
    bodies.clone().map(|body| Body {
        // Twice as large and half of that is made anew, from the same numbers.
        geometry: Arc::new(
            Geometry::clone(&body.geometry).scaled(2.0).and_then(|twice| twice.scaled(0.5)).expect("within limits"),
        ),
        ..body
    })
}

#[test]
fn no_answer_depends_on_what_is_built() {
    let mut noise = Noise(43);
    for number in 0..200 {
        let bodies = pair(&mut noise, number * 7);
        let size = bodies[0].geometry.reach();
        let accuracies = [1.0, 0.1, 0.001].map(|part| Accuracy { max_error: part * size, ..Accuracy::default() });
        let ask = |bodies: &[Body; 2], accuracy: &Accuracy| {
            let [a, b] = [bodies[0].placed(), bodies[1].placed()];
            let overlap = narrow::overlap(a, b, accuracy, &mut Work::default());
            format!("{overlap:?} {:?}", narrow::distance(a, b, 1e12, accuracy, &mut Work::default()))
        };
        let (up, down) = (afresh(&bodies), afresh(&bodies));
        let loose_first: Vec<String> = accuracies.iter().map(|accuracy| ask(&up, accuracy)).collect();
        let mut exact_first: Vec<String> = accuracies.iter().rev().map(|accuracy| ask(&down, accuracy)).collect();
        exact_first.reverse();
        assert_eq!(loose_first, exact_first, "{number}");
    }
}
