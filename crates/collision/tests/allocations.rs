//! A question asks for no memory but that of the list it returns, whatever it has to look at: once what is built on first
//! use is built, a question that finds nothing allocates nothing.

use std::{num::NonZeroU64, sync::Arc};

use allocation_counter::measure;
use collision::{
    DQuat, DVec3,
    accuracy::{Accuracy, Tier},
    math::Pose,
    narrow::{Faces, InitialTouch, Ray},
    shape::Geometry,
    world::{
        Distance, Edit, EditRule, Filter, HitMode, Meter, Mobility, Overlap, Penetration, QuestionError, Raycast,
        Shape, Snapshot, Subject, Time, TimeOfImpact, World,
    },
};

/// Shapes along each edge of the grid.
const EDGE: u64 = 12;
/// Metres between neighbours: about a quarter of it is free between the boxes of any two.
const PITCH: f64 = 4.0;

/// A grid of shapes of all kinds, of which every second is static, and a floor.
fn world() -> Arc<Snapshot> {
    let points: Vec<DVec3> = (0..20_u32)
        .map(|i| {
            let turn =
                DQuat::from_xyzw(f64::from(i % 3), f64::from(i % 5) - 2.0, f64::from(i % 7) - 3.0, 1.0).normalize();
            turn * DVec3::X * 1.4
        })
        .collect();
    let roof = [DVec3::Y, DVec3::X, DVec3::Z, -DVec3::X, -DVec3::Z];
    let geometries = [
        Geometry::sphere(1.4),
        Geometry::cuboid(DVec3::new(1.2, 0.8, 1.0)),
        Geometry::capsule(0.7, 0.6),
        Geometry::hull(&points),
        Geometry::mesh(&roof, &[[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 1]]),
        Geometry::cylinder(0.9, 0.9),
        Geometry::ellipsoid(DVec3::new(1.2, 0.6, 0.9)),
    ];
    let geometries = geometries.map(|geometry| Arc::new(geometry.expect("a geometry")));
    let grid = (0..EDGE.pow(3)).map(|number| {
        let cell = DVec3::new((number % EDGE) as f64, (number / EDGE % EDGE) as f64, (number / EDGE / EDGE) as f64);
        let turn = DQuat::from_xyzw((number % 3) as f64, (number % 5) as f64 - 2.0, 1.0, (number % 11) as f64);
        let mobility = if number % 2 == 0 { Mobility::Static } else { Mobility::Dynamic };
        let geometry = Arc::clone(&geometries[(number % geometries.len() as u64) as usize]);
        Edit::Insert(Shape { mobility, ..shape(number + 1, geometry, Pose::new(cell * PITCH, turn)) })
    });
    let floor = Arc::new(Geometry::half_space(DVec3::Y, -3.0).expect("a half space"));
    let floor = Edit::Insert(shape(EDGE.pow(3) + 1, floor, Pose::IDENTITY));
    let mut world = World::new(Time(0));
    world.apply(grid.chain([floor]).collect(), Time(0), EditRule::AllOrNothing).expect("a tick");
    world.newest()
}

fn shape(number: u64, geometry: Arc<Geometry>, pose: Pose) -> Shape {
    Shape::new(NonZeroU64::new(number).expect("not 0"), geometry, pose)
}

/// A filter with something of everything in it.
fn filter() -> Filter {
    Filter {
        exclude_ids: [901, 7, 333].into_iter().filter_map(NonZeroU64::new).collect(),
        exclude_groups: vec![3, 1],
        exclude_sensors: true,
        ..Filter::default()
    }
}

/// How far the question of a step is from the corner of the grid, metres.
fn offset(step: u64) -> DVec3 {
    DVec3::new((step % EDGE) as f64, (step / EDGE % EDGE) as f64, (step / 7 % EDGE) as f64) * PITCH
}

/// Between eight shapes: its box touches theirs, it touches none of them.
fn between(step: u64) -> Subject {
    let geometry = Arc::new(Geometry::cuboid(DVec3::splat(0.55)).expect("a box"));
    let pose = Pose::new(offset(step) + 0.5 * PITCH, DQuat::from_xyzw(0.0, 0.38, 0.3, 0.92));
    Subject::Geometry { geometry, pose }
}

/// As large as several cells.
fn amidst(step: u64) -> Subject {
    let geometry = Arc::new(Geometry::sphere(6.0).expect("a sphere"));
    Subject::Geometry { geometry, pose: Pose::at(offset(step)) }
}

/// What a list of hits may take: none if it is empty, else as often as a growing list asks.
fn growth(hit_count: usize) -> u64 {
    if hit_count == 0 { 0 } else { u64::from(hit_count.next_power_of_two().ilog2()) + 1 }
}

/// Asks many questions twice, the first time to build what is built on first use; then none may allocate more than its
/// list. Fails as well if it is not from `least` to `most` percent of the questions that find something.
fn assert_frugal<Question>(
    make: impl Fn(u64) -> Question,
    ask: impl Fn(&Snapshot, &Question, &mut Meter<'_>) -> Result<usize, QuestionError>,
    [least, most]: [u64; 2],
) {
    const QUESTIONS: u64 = 200;
    let world = world();
    let mut go_on = || true;
    let meter = &mut Meter::new(&mut go_on);
    let questions: Vec<Question> = (0..QUESTIONS).map(make).collect();
    for question in &questions {
        ask(&world, question, meter).expect("an answer");
    }
    let (mut found_count, mut wasteful) = (0, Vec::new());
    for question in &questions {
        let mut hits = Ok(0);
        let info = measure(|| hits = ask(&world, question, meter));
        let hits = hits.expect("an answer");
        found_count += u64::from(hits > 0);
        if info.count_total > growth(hits) {
            wasteful.push((hits, info.count_total));
        }
    }
    assert!(meter.work.shapes_tested > QUESTIONS, "vacuous: {:?}", meter.work);
    let share = found_count * 100 / QUESTIONS;
    assert!((least..=most).contains(&share), "{share} % find something");
    assert!(
        wasteful.is_empty(),
        "{} of {QUESTIONS} ask for memory beyond their lists; some as (hits, allocations): {:?}",
        wasteful.len(),
        &wasteful[..wasteful.len().min(8)]
    );
}

const EXACT: Accuracy = Accuracy::of(Tier::Exact);
const SOME: [u64; 2] = [20, 90];
const NONE: [u64; 2] = [0, 0];
const ALL: [u64; 2] = [100, 100];

fn rays(step: u64, mode: HitMode) -> Raycast {
    let to = offset(step.wrapping_mul(0x9E37_79B9) >> 3) + DVec3::new(0.5, 1.3, -0.8);
    let origin = offset(step) + 0.5 * PITCH;
    let ray =
        Ray { origin, direction: to - origin, min_distance: 0.0, max_distance: 8.0, hollow: false, faces: Faces::Both };
    Raycast { ray, mode }
}

fn casts(step: u64, rotation: DVec3) -> TimeOfImpact {
    let to = offset(step.wrapping_mul(0x9E37_79B9) >> 3) + DVec3::new(0.5, 1.3, -0.8);
    TimeOfImpact {
        subject: between(step),
        displacement: (to - offset(step)).normalize_or(DVec3::X) * 1.8,
        rotation,
        against: None,
        against_displacement: DVec3::ZERO,
        against_rotation: DVec3::ZERO,
        initial: InitialTouch::Counts,
        mode: HitMode::Closest,
    }
}

#[test]
fn the_closest_hit_of_a_ray() {
    assert_frugal(
        |step| rays(step, HitMode::Closest),
        |world, question, meter| Ok(world.raycast(question, &Filter::default(), &EXACT, meter)?.hits.len()),
        SOME,
    );
}

#[test]
fn any_hit_of_a_ray() {
    assert_frugal(
        |step| rays(step, HitMode::Any),
        |world, question, meter| Ok(world.raycast(question, &Filter::default(), &EXACT, meter)?.hits.len()),
        SOME,
    );
}

#[test]
fn all_hits_of_a_ray() {
    assert_frugal(
        |step| rays(step, HitMode::All(100)),
        |world, question, meter| Ok(world.raycast(question, &Filter::default(), &EXACT, meter)?.hits.len()),
        SOME,
    );
}

#[test]
fn a_ray_with_a_filter() {
    let filter = filter();
    assert_frugal(
        |step| rays(step, HitMode::Closest),
        |world, question, meter| Ok(world.raycast(question, &filter, &EXACT, meter)?.hits.len()),
        SOME,
    );
}

#[test]
fn an_overlap_with_nothing() {
    assert_frugal(
        |step| Overlap { subject: between(step), against: None, max_hits: 100 },
        |world, question, meter| Ok(world.overlap(question, &Filter::default(), &EXACT, meter)?.hits.len()),
        NONE,
    );
}

#[test]
fn an_overlap_with_much() {
    assert_frugal(
        |step| Overlap { subject: amidst(step), against: None, max_hits: 1000 },
        |world, question, meter| Ok(world.overlap(question, &Filter::default(), &EXACT, meter)?.hits.len()),
        ALL,
    );
}

#[test]
fn no_contact() {
    assert_frugal(
        |step| Penetration { subject: between(step), against: None, max_gap: 0.0, max_contacts: 100 },
        |world, question, meter| Ok(world.penetration(question, &Filter::default(), &EXACT, meter)?.hits.len()),
        NONE,
    );
}

#[test]
fn the_nearest_shape() {
    assert_frugal(
        |step| Distance { subject: between(step), against: None, max_distance: f64::MAX, max_hits: 1 },
        |world, question, meter| Ok(world.distance(question, &Filter::default(), &EXACT, meter)?.hits.len()),
        ALL,
    );
}

#[test]
fn no_shape_within_a_distance() {
    assert_frugal(
        |step| Distance { subject: between(step), against: None, max_distance: 0.01, max_hits: 8 },
        |world, question, meter| Ok(world.distance(question, &Filter::default(), &EXACT, meter)?.hits.len()),
        NONE,
    );
}

#[test]
fn the_first_impact_of_a_motion() {
    assert_frugal(
        |step| casts(step, DVec3::ZERO),
        |world, question, meter| Ok(world.time_of_impact(question, &Filter::default(), &EXACT, meter)?.hits.len()),
        SOME,
    );
}

#[test]
fn the_first_impact_of_a_motion_that_turns() {
    assert_frugal(
        |step| casts(step, DVec3::new(0.3, 0.9, -0.4)),
        |world, question, meter| {
            Ok(world.time_of_impact(question, &Filter::default(), &Accuracy::default(), meter)?.hits.len())
        },
        SOME,
    );
}
