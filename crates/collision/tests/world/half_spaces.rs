//! Half spaces among many shapes: their boxes have no end, and yet trees stay what they are.

use std::sync::Arc;

use collision::{
    DQuat, DVec3,
    accuracy::Accuracy,
    answer::{Verdict, Work},
    math::Pose,
    shape::Geometry,
    world::{
        Edit, EditRule, Filter, HitMode, Meter, Mobility, Overlap, Raycast, Shape, Snapshot, Subject, Time, World,
    },
};

use crate::random::Random;
use crate::scene::{Frame, half_spaces, id, random_pose, ray, shape, world_of};

const SIDE: u32 = 10;

/// A thousand boxes on a grid, and three half spaces below, beside and askew of them, moving or not.
fn scene(spaces: &[(DVec3, Mobility)]) -> Vec<Shape> {
    let cube = Arc::new(Geometry::cuboid(DVec3::splat(0.4)).expect("a box"));
    let boxes = (0..SIDE * SIDE * SIDE).map(|i| {
        let cell = DVec3::new(f64::from(i % SIDE), f64::from(i / SIDE % SIDE), f64::from(i / SIDE / SIDE));
        shape(u64::from(i) + 1, Arc::clone(&cube), Pose::at(cell * 2.0))
    });
    let spaces = spaces.iter().zip(2000..).map(|(&(normal, mobility), number)| {
        let geometry = Arc::new(Geometry::half_space(normal, -1.0).expect("a half space"));
        Shape { mobility, ..shape(number, geometry, Pose::IDENTITY) }
    });
    boxes.chain(spaces).collect()
}

/// What a small ball in the middle and a ray through the middle cost.
fn work(snapshot: &Snapshot) -> Work {
    let mut go_on = || true;
    let mut meter = Meter::new(&mut go_on);
    let (filter, accuracy) = (Filter::default(), Accuracy::default());
    let ball = Arc::new(Geometry::sphere(0.7).expect("a ball"));
    let subject = Subject::Geometry { geometry: ball, pose: Pose::at(DVec3::splat(9.0)) };
    let overlap = snapshot.overlap(&Overlap { subject, against: None, max_hits: 100 }, &filter, &accuracy, &mut meter);
    assert_eq!(overlap.expect("an answer").verdict, Verdict::Miss);
    let down = Raycast { ray: ray(DVec3::new(9.0, 30.0, 9.0), -DVec3::Y), mode: HitMode::Closest };
    let hit = snapshot.raycast(&down, &filter, &accuracy, &mut meter).expect("an answer");
    assert_eq!(hit.hits.first().map(|hit| (hit.id, hit.touch.distance)), Some((Some(id(2000)), 31.0)));
    meter.work
}

#[test]
fn three_half_spaces_among_a_thousand_boxes_cost_a_path_each() {
    let floor = (DVec3::Y, Mobility::Dynamic);
    let one = work(&world_of(scene(&[floor])).newest());
    for mobility in [Mobility::Dynamic, Mobility::Static] {
        let all = [(DVec3::Y, mobility), (DVec3::X, mobility), (DVec3::new(1.0, 2.0, 3.0), mobility)];
        let snapshot = world_of(scene(&all)).newest();
        let three = work(&snapshot);
        let more = three.nodes_visited.saturating_sub(one.nodes_visited);
        assert!(more < 3 * 40, "{one:?} {three:?}");
        assert!(three.shapes_tested <= one.shapes_tested + 8, "{one:?} {three:?}");
        let description = snapshot.describe();
        assert!(description.tree_cost.is_finite() && description.tree_depth < 40, "{description:?}");
    }
}

#[test]
fn half_spaces_move_and_go_like_any_shape() {
    let mut world: World = world_of(scene(&[(DVec3::Y, Mobility::Dynamic)]));
    let mut random = Random::new(5);
    for round in 0..50 {
        let rotation = if round % 3 == 0 { DQuat::from_rotation_x(0.3) } else { DQuat::IDENTITY };
        let edit = Edit::Move {
            id: id(2000),
            position: Some(random.vector() * 1e6),
            rotation: Some(rotation),
            velocity: None,
            angular_velocity: None,
            teleport: round % 2 == 0,
        };
        world.apply(vec![edit], Time(0), EditRule::AllOrNothing).expect("a tick");
    }
    let home = Edit::Move {
        id: id(2000),
        position: Some(DVec3::ZERO),
        rotation: Some(DQuat::IDENTITY),
        velocity: None,
        angular_velocity: None,
        teleport: false,
    };
    world.apply(vec![home], Time(0), EditRule::AllOrNothing).expect("a tick");
    let fresh = work(&world_of(scene(&[(DVec3::Y, Mobility::Dynamic)])).newest());
    let used = work(&world.newest());
    assert!(used.nodes_visited <= 3 * fresh.nodes_visited, "{fresh:?} {used:?}");
    world.apply(vec![Edit::Remove(id(2000))], Time(0), EditRule::AllOrNothing).expect("a tick");
    let bounds = world.newest().describe().bounds.expect("boxes");
    assert!(bounds.max.max_element() < 20.0, "{bounds:?}");
}

#[test]
fn a_shape_that_is_a_half_space_is_no_subject() {
    let mut random = Random::new(6);
    let floor = half_spaces(&mut random, Frame::UNIT, 1)[0].clone();
    let pose = random_pose(&mut random, Frame::UNIT, 1.0);
    let snapshot = world_of([floor]).newest();
    let mut go_on = || true;
    let meter = &mut Meter::new(&mut go_on);
    for pose in [None, Some(pose)] {
        let question = Overlap { subject: Subject::Shape { id: id(1), pose }, against: None, max_hits: 9 };
        let refused = snapshot.overlap(&question, &Filter::default(), &Accuracy::default(), meter);
        assert_eq!(
            refused.expect_err("a half space").to_string(),
            "shape 1 is a half space, which no question is asked about: ask about the other form, against it"
        );
    }
}
