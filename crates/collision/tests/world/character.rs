//! Characters: where they stop, slide, climb and stand, and that they never end deeper in a shape than they began.

use std::{f64::consts::FRAC_PI_4, sync::Arc};

use collision::{
    DQuat, DVec3,
    accuracy::Accuracy,
    answer::Verdict,
    math::Pose,
    shape::Geometry,
    world::{
        Filter, Meter, MoveCharacter, MovedCharacter, Penetration, QuestionError, Shape, Snapshot, Subject, World,
    },
};

use crate::random::Random;
use crate::scene::{Frame, id, random_shapes, shape, world_of};

const SKIN: f64 = 0.01;
/// Of the capsule that walks: its middle is this far above what it stands on, its skin included.
const STANDING: f64 = 0.9 + SKIN;

fn capsule() -> Arc<Geometry> {
    Arc::new(Geometry::capsule(0.5, 0.4).expect("a capsule"))
}

fn block(number: u64, half: DVec3, center: DVec3) -> Shape {
    shape(number, Arc::new(Geometry::cuboid(half).expect("a box")), Pose::at(center))
}

/// A floor of 40 m whose top is at y = 0.
fn floor(number: u64) -> Shape {
    block(number, DVec3::new(20.0, 0.5, 20.0), DVec3::new(0.0, -0.5, 0.0))
}

fn walker(place: DVec3, translation: DVec3) -> MoveCharacter {
    MoveCharacter {
        subject: Subject::Geometry { geometry: capsule(), pose: Pose::at(place) },
        translation,
        up: DVec3::Y,
        max_slope: FRAC_PI_4,
        step_height: 0.0,
        snap_distance: 0.0,
        skin: SKIN,
        max_slides: 8,
        max_push: 0.0,
    }
}

fn walk(world: &Snapshot, question: &MoveCharacter) -> MovedCharacter {
    try_walk(world, question, &Filter::default()).expect("an answer")
}

fn try_walk(world: &Snapshot, question: &MoveCharacter, filter: &Filter) -> Result<MovedCharacter, QuestionError> {
    let mut keep_going = || true;
    world.move_character(question, filter, &Accuracy::default(), &mut Meter::new(&mut keep_going))
}

/// How deep a form is in the world, its deepest contact; a gap is negative, and nothing near is −1.
fn depth(world: &Snapshot, geometry: &Arc<Geometry>, position: DVec3) -> f64 {
    let subject = Subject::Geometry { geometry: geometry.clone(), pose: Pose::at(position) };
    let question = Penetration { subject, against: None, max_gap: 0.5, max_contacts: 1 };
    let mut keep_going = || true;
    let meter = &mut Meter::new(&mut keep_going);
    let filter = Filter { exclude_sensors: true, ..Filter::default() };
    let found = world.penetration(&question, &filter, &Accuracy::default(), meter).expect("an answer");
    found.hits.first().map_or(-1.0, |contact| contact.depth)
}

fn ids(moved: &MovedCharacter) -> Vec<u64> {
    moved.hits.iter().map(|hit| hit.id.expect("a shape").get()).collect()
}

#[track_caller]
fn assert_near(found: DVec3, expected: DVec3) {
    assert!((found - expected).length() < 1e-7, "{found} is not {expected}");
}

#[test]
fn a_free_way_is_gone_to_its_end() {
    let world = world_of([floor(1)]);
    let way = DVec3::new(1.0, 0.25, -3.0);
    let moved = walk(&world.newest(), &walker(DVec3::Y * 5.0, way));
    assert_eq!((moved.verdict, moved.position), (Verdict::Miss, DVec3::Y * 5.0 + way));
    assert!(moved.hits.is_empty() && moved.ground.is_none());
}

#[test]
fn a_wall_is_slid_along_at_the_distance_of_the_skin() {
    let world = world_of([block(1, DVec3::new(0.5, 10.0, 10.0), DVec3::X * 2.5)]);
    let moved = walk(&world.newest(), &walker(DVec3::ZERO, DVec3::new(4.0, 0.0, 3.0)));
    assert_near(moved.position, DVec3::new(2.0 - 0.4 - SKIN, 0.0, 3.0));
    assert_eq!((moved.verdict, ids(&moved)), (Verdict::Hit, vec![1]));
    let touch = &moved.hits[0].touch;
    assert!((touch.fraction - 1.59 / 4.0).abs() < 1e-9 && !touch.initial, "{touch:?}");
    // Asked again from there, straight into the wall, it stays, and says what it touches.
    let stuck = walk(&world.newest(), &walker(moved.position, DVec3::X));
    assert_near(stuck.position, moved.position);
    assert_eq!((stuck.verdict, ids(&stuck), stuck.hits[0].touch.initial), (Verdict::Hit, vec![1], true));
}

#[test]
fn without_a_skin_it_comes_as_near_as_rounding_lets_it() {
    let world = world_of([block(1, DVec3::new(0.5, 10.0, 10.0), DVec3::X * 2.5)]);
    let question = MoveCharacter { skin: 0.0, ..walker(DVec3::ZERO, DVec3::new(4.0, 0.0, 3.0)) };
    let moved = walk(&world.newest(), &question);
    assert!((moved.position - DVec3::new(1.6, 0.0, 3.0)).length() < 1e-7, "{moved:?}");
    assert!(depth(&world.newest(), &capsule(), moved.position) < 0.0);
}

#[test]
fn a_corner_ends_the_way_and_an_edge_leads_on() {
    let wall = |number, normal: DVec3| block(number, DVec3::splat(10.0), normal * -12.0);
    let corner = world_of([wall(1, DVec3::NEG_X), wall(2, DVec3::NEG_Z)]);
    let moved = walk(&corner.newest(), &walker(DVec3::ZERO, DVec3::new(9.0, 0.0, 7.0)));
    assert_near(moved.position, DVec3::new(1.59, 0.0, 1.59));
    assert_eq!(ids(&moved), [1, 2]);
    let moved = walk(&corner.newest(), &walker(DVec3::ZERO, DVec3::new(9.0, 2.0, 7.0)));
    assert_near(moved.position, DVec3::new(1.59, 2.0, 1.59));
}

#[test]
fn weight_does_not_make_it_slide_on_a_floor_it_can_stand_on() {
    for (degrees, stands) in [(0.0_f64, true), (30.0, true), (44.0, true), (50.0, false), (80.0, false)] {
        let turn = DQuat::from_rotation_z(degrees.to_radians());
        let slope = Pose::new(turn * DVec3::NEG_Y, turn);
        let slab = Arc::new(Geometry::cuboid(DVec3::new(30.0, 1.0, 30.0)).expect("a box"));
        let world = world_of([shape(1, slab, slope)]);
        let start = DVec3::Y * (0.5 + (0.4 + SKIN) / degrees.to_radians().cos());
        let moved = walk(&world.newest(), &walker(start, DVec3::NEG_Y * 0.1));
        assert_eq!(moved.position.y >= start.y - 1e-9, stands, "{degrees}: {moved:?}");
        assert_eq!(moved.ground.is_some(), stands, "{degrees}: {moved:?}");
        // Nothing climbs what it cannot stand on: its way ends at the foot.
        let up = walk(&world.newest(), &walker(start, DVec3::X));
        assert_eq!(
            up.position.y > start.y + 0.1 * degrees.to_radians().sin(),
            stands && degrees > 0.0,
            "{degrees}: {up:?}"
        );
    }
}

fn stairs(count: u64, rise: f64, tread: f64) -> World {
    let step = |number: u64| {
        let (height, begin) = (rise * number as f64, 1.0 + tread * (number - 1) as f64);
        block(number + 1, DVec3::new(5.0, height * 0.5, 5.0), DVec3::new(begin + 5.0, height * 0.5, 0.0))
    };
    world_of([floor(1)].into_iter().chain((1..=count).map(step)))
}

#[test]
fn stairs_are_climbed_if_they_are_low_enough_and_gone_down_by_being_put_down() {
    let world = stairs(6, 0.2, 0.4);
    let mut place = DVec3::new(0.0, STANDING, 0.0);
    let walker = |place, translation, step_height| MoveCharacter {
        step_height,
        snap_distance: 0.25,
        ..walker(place, translation)
    };
    let low = walk(&world.newest(), &walker(place, DVec3::X * 4.0, 0.05));
    assert!(low.position.x < 1.0 && low.position.y < STANDING + 0.2, "{low:?}");
    for _ in 0..60 {
        place = walk(&world.newest(), &walker(place, DVec3::new(0.1, -0.02, 0.0), 0.3)).position;
    }
    assert!(place.x > 4.5, "{place}");
    assert!((place.y - (STANDING + 1.2)).abs() < 0.02, "{place}");
    let mut heights = Vec::new();
    for _ in 0..60 {
        let moved = walk(&world.newest(), &walker(place, DVec3::X * -0.1, 0.3));
        assert!(moved.ground.is_some() || moved.position.x < 4.0, "{moved:?}");
        place = moved.position;
        heights.push(place.y);
    }
    assert!(heights.is_sorted_by(|a, b| a >= b), "{heights:?}");
    assert!(place.x < 0.0 && (place.y - STANDING).abs() < 0.02, "{place}");
}

#[test]
fn what_is_too_high_or_leads_nowhere_is_no_step() {
    let walker =
        |translation| MoveCharacter { step_height: 0.5, ..walker(DVec3::new(0.0, STANDING, 0.0), translation) };
    // A wall with a ledge that is too narrow to stand on.
    let wall = block(2, DVec3::new(1.0, 5.0, 5.0), DVec3::new(2.0, 5.0, 0.0));
    let ledge = block(3, DVec3::new(0.01, 0.1, 5.0), DVec3::new(0.99, 0.1, 0.0));
    let world = world_of([floor(1), wall, ledge]);
    let moved = walk(&world.newest(), &walker(DVec3::X * 3.0));
    assert!(moved.position.y < STANDING + 0.01 && moved.position.x < 1.0, "{moved:?}");
    // A low ceiling over the step leaves no room to climb it.
    let step = block(2, DVec3::new(5.0, 0.2, 5.0), DVec3::new(6.0, 0.2, 0.0));
    let ceiling = block(3, DVec3::new(20.0, 0.5, 20.0), DVec3::Y * (2.0 + 0.5));
    let world = world_of([floor(1), step.clone(), ceiling]);
    let moved = walk(&world.newest(), &walker(DVec3::X * 3.0));
    assert!(moved.position.y < STANDING + 0.01, "{moved:?}");
    let world = world_of([floor(1), step]);
    let moved = walk(&world.newest(), &walker(DVec3::X * 3.0));
    assert!(moved.position.y > STANDING + 0.39 && moved.position.x > 2.9, "{moved:?}");
}

#[test]
fn who_goes_up_is_not_put_down_and_who_was_in_the_air_neither() {
    let world = world_of([floor(1)]);
    let snapping = |place, translation| MoveCharacter { snap_distance: 1.0, ..walker(place, translation) };
    let standing = DVec3::Y * STANDING;
    let jump = walk(&world.newest(), &snapping(standing, DVec3::Y * 0.5));
    assert_eq!(jump.position, standing + DVec3::Y * 0.5);
    let falling = walk(&world.newest(), &snapping(standing + DVec3::Y * 0.5, DVec3::X));
    assert_eq!(falling.position, standing + DVec3::new(1.0, 0.5, 0.0));
}

/// A flat floor of many triangles is a flat floor.
#[test]
fn a_floor_of_triangles_is_walked_like_one_of_a_single_box() {
    let side = 12_u32;
    let mut random = Random::new(4);
    let vertices: Vec<DVec3> = (0..side * side)
        .map(|index| {
            let (column, row) = (f64::from(index % side), f64::from(index / side));
            DVec3::new(column - 5.5 + 0.3 * random.unit(), 0.0, row - 5.5 + 0.3 * random.unit())
        })
        .collect();
    let mut triangles = Vec::new();
    for row in 1..side {
        for column in 1..side {
            let corner = row * side + column;
            triangles.push([corner, corner - side, corner - 1]);
            triangles.push([corner - 1, corner - side, corner - side - 1]);
        }
    }
    let mesh = Arc::new(Geometry::mesh(&vertices, &triangles).expect("a mesh"));
    let world = world_of([shape(1, mesh, Pose::IDENTITY)]);
    let mut place = DVec3::new(-4.0, STANDING, -3.0);
    for _ in 0..80 {
        let moved = walk(&world.newest(), &walker(place, DVec3::new(0.1, -0.05, 0.07)));
        let wanted = place + DVec3::new(0.1, 0.0, 0.07);
        assert!((moved.position - wanted).length() < 1e-9, "{} is not {wanted}", moved.position);
        let ground = moved.ground.expect("a floor");
        assert!(ground.normal.y > 1.0 - 1e-9, "{ground:?}");
        place = moved.position;
    }
}

#[test]
fn it_never_ends_deeper_than_it_began_in_random_worlds() {
    let mut random = Random::new(8);
    let (mut touched, mut cases) = (0, 0);
    for seed in 0..12 {
        let world = world_of(random_shapes(&mut Random::new(seed), Frame::UNIT, 60));
        let world = world.newest();
        for _ in 0..40 {
            let start = random.vector() * 6.0;
            let question =
                MoveCharacter { step_height: 0.3, snap_distance: 0.2, ..walker(start, random.vector() * 4.0) };
            let Ok(moved) = try_walk(&world, &question, &Filter::default()) else { continue };
            cases += 1;
            touched += usize::from(moved.verdict == Verdict::Hit);
            let (before, after) = (depth(&world, &capsule(), start), depth(&world, &capsule(), moved.position));
            assert!(after <= before.max(-SKIN) + 1e-7, "{before} became {after}: {question:?}");
            assert!(moved.verdict != Verdict::Miss || moved.position.y <= start.y + question.translation.y);
        }
    }
    assert!(cases > 300 && (touched * 10 > cases * 3) && (touched * 10 < cases * 9), "{touched} of {cases}");
}

#[test]
fn a_shape_walks_as_its_form_and_sees_what_the_shape_sees() {
    let mut walking = shape(7, capsule(), Pose::at(DVec3::ZERO));
    walking.group = 3;
    let wall = block(1, DVec3::new(0.5, 10.0, 10.0), DVec3::X * 2.5);
    let mut friend = block(2, DVec3::new(0.5, 10.0, 10.0), DVec3::X * 1.5);
    friend.group = 3;
    let mut sensor = block(3, DVec3::new(0.1, 10.0, 10.0), DVec3::X);
    sensor.sensor = true;
    let world = world_of([walking, wall, friend, sensor]);
    let question =
        MoveCharacter { subject: Subject::Shape { id: id(7), pose: None }, ..walker(DVec3::ZERO, DVec3::X * 3.0) };
    let moved = walk(&world.newest(), &question);
    assert_near(moved.position, DVec3::X * 1.59);
    assert_eq!(ids(&moved), [1]);
    let blind = Filter { exclude_ids: vec![id(1)], ..Filter::default() };
    let free = try_walk(&world.newest(), &question, &blind).expect("an answer");
    assert_eq!((free.verdict, free.position), (Verdict::Miss, DVec3::X * 3.0));
}

#[test]
fn what_cannot_walk_is_refused() {
    let world = world_of([floor(1)]);
    let of = |geometry: Geometry| MoveCharacter {
        subject: Subject::Geometry { geometry: Arc::new(geometry), pose: Pose::IDENTITY },
        ..walker(DVec3::ZERO, DVec3::X)
    };
    let refusal = |question| try_walk(&world.newest(), &question, &Filter::default()).expect_err("it is refused");
    let mesh = Geometry::mesh(&[DVec3::ZERO, DVec3::X, DVec3::Y], &[[0, 1, 2]]).expect("a mesh");
    assert_eq!(refusal(of(mesh)), QuestionError::SubjectNotConvex(None));
    let plane = Geometry::half_space(DVec3::Y, 0.0).expect("a half space");
    assert_eq!(refusal(of(plane)), QuestionError::SubjectUnbounded(None));
    let large = MoveCharacter { skin: 1e9, ..of(Geometry::sphere(1e9).expect("a sphere")) };
    assert!(matches!(refusal(large), QuestionError::Skin(_)));
    let missing = MoveCharacter { subject: Subject::Shape { id: id(9), pose: None }, ..walker(DVec3::ZERO, DVec3::X) };
    assert_eq!(refusal(missing), QuestionError::SubjectNotFound(id(9)));
}

#[test]
fn a_character_is_pushed_out_of_what_it_overlaps_before_it_goes() {
    let world = world_of([floor(1)]);
    let sunk = walker(DVec3::Y * 0.8, DVec3::X);
    let stays = walk(&world.newest(), &sunk);
    assert!(stays.position.y < STANDING - 0.05 && stays.pushed == DVec3::ZERO, "{stays:?}");
    let out = walk(&world.newest(), &MoveCharacter { max_push: 0.5, ..sunk.clone() });
    assert_near(out.pushed, DVec3::Y * 0.1);
    assert_near(out.position, DVec3::new(1.0, 0.9, 0.0));
    let held = walk(&world.newest(), &MoveCharacter { max_push: 0.05, ..sunk });
    assert_eq!(held.pushed, DVec3::ZERO, "it would have to go farther");
}
