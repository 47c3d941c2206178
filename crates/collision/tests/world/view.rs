//! What a viewer is told keeps its picture equal to the world.

use std::collections::BTreeMap;

use collision::{
    DVec3,
    broad::NodeBox,
    math::Aabb,
    world::{Edit, EditRule, Filter, Shape, ShapeId, Snapshot, Time, View, World},
};

use crate::{
    random::Random,
    scene::{Frame, id, random_filter, random_pose, random_shapes, world_of},
};

const SHAPES: u64 = 60;

fn all(newest: &Snapshot, view: &View) -> BTreeMap<ShapeId, String> {
    let lets_through = |shape: &&Shape| {
        let filter = &view.filter;
        let (layers, wanted) = (filter.layers.unwrap_or(u32::MAX), filter.collides_with.unwrap_or(u32::MAX));
        shape.layers & wanted != 0
            && shape.collides_with & layers != 0
            && !filter.exclude_ids.contains(&shape.id)
            && !(filter.exclude_sensors && shape.sensor)
            && !(filter.exclude_static && shape.mobility == collision::world::Mobility::Static)
            && !(shape.group != 0 && filter.exclude_groups.contains(&shape.group))
    };
    let shapes = newest.shapes_after(None, usize::MAX, view.bounds);
    shapes.into_iter().filter(lets_through).map(|shape| (shape.id, format!("{shape:?}"))).collect()
}

fn some_edits(newest: &Snapshot, random: &mut Random) -> Vec<Edit> {
    let moved = |random: &mut Random, number: u64, velocity| Edit::Move {
        id: id(number),
        position: (random.unit() < 0.8).then(|| random_pose(random, Frame::UNIT, 4.0).position),
        rotation: None,
        velocity: Some(velocity),
        angular_velocity: None,
        teleport: false,
    };
    (0..random.bits() % 9)
        .map(|_| {
            let (number, velocity) = (1 + random.bits() % SHAPES, DVec3::X * random.unit());
            match (random.bits() % 10, newest.shape(id(number))) {
                (0, _) => Edit::Remove(id(number)),
                (1, Some(shape)) => Edit::Insert(Shape { user_data: random.bits(), ..shape.into_owned() }),
                (2, Some(shape)) => Edit::Insert(shape.into_owned()),
                (3, _) => Edit::Insert(Shape { id: id(number), ..random_shapes(random, Frame::UNIT, 1).remove(0) }),
                (4, _) => moved(random, number, DVec3::ZERO),
                (_, _) => moved(random, number, velocity),
            }
        })
        .collect()
}

fn apply(world: &mut World, random: &mut Random) {
    let edits = some_edits(&world.newest(), random);
    world.apply(edits, Time(0), EditRule::LeaveOutWrong).expect("a tick");
}

#[test]
fn a_picture_that_is_told_the_changes_is_that_of_the_world() {
    let mut random = Random::new(81);
    let mut sums = [0; 3];
    for _ in 0..20 {
        let view = View {
            bounds: (random.unit() < 0.5).then(|| Aabb::new(DVec3::splat(-2.0), random.vector().abs() * 4.0)),
            filter: if random.unit() < 0.5 { Filter::default() } else { random_filter(&mut random) },
        };
        let mut world = world_of(random_shapes(&mut random, Frame::UNIT, SHAPES));
        let mut told = world.newest();
        let first = told.view(&view).inserted;
        let mut picture: BTreeMap<ShapeId, Shape> = first.into_iter().map(|shape| (shape.id, shape)).collect();
        for _ in 0..40 {
            for _ in 0..=random.bits() % 3 {
                apply(&mut world, &mut random);
            }
            let newest = world.newest();
            let changes = newest.view_since(&told, &view);
            sums = [sums[0] + changes.inserted.len(), sums[1] + changes.moved.len(), sums[2] + changes.removed.len()];
            for shape in changes.moved {
                let known = picture.get_mut(&shape.id).expect("it was in the picture");
                (known.pose, known.velocity) = (shape.pose, shape.velocity);
            }
            picture.extend(changes.inserted.into_iter().map(|shape| (shape.id, shape)));
            for id in changes.removed {
                assert!(picture.remove(&id).is_some());
            }
            let drawn: BTreeMap<_, _> = picture.iter().map(|(id, shape)| (*id, format!("{shape:?}"))).collect();
            assert_eq!(drawn, all(&newest, &view));
            assert!(newest.view_since(&newest, &view).is_empty());
            told = newest;
        }
    }
    assert!(sums.iter().all(|&sum| sum > 200), "vacuous: {sums:?}");
}

#[test]
fn the_boxes_of_a_level_lie_in_those_above_and_the_last_ones_hold_the_shapes() {
    let mut random = Random::new(82);
    let world = world_of(random_shapes(&mut random, Frame::UNIT, 500));
    let newest = world.newest();
    let all = newest.tree_boxes(u32::MAX, usize::MAX);
    let on = |level: u32| all.iter().filter(move |found| found.level == level).map(|found| found.bounds);
    let deepest = all.iter().map(|found| found.level).max().expect("some");
    assert!(deepest >= 3, "vacuous: {deepest}");
    for level in 1..=deepest {
        let above: Vec<Aabb> = on(level - 1).collect();
        for bounds in on(level) {
            // Each is rounded outwards on its own.
            let within = Aabb::new(bounds.min.map(f64::next_up), bounds.max.map(f64::next_down));
            assert!(above.iter().any(|above| above.contains(within)), "level {level}");
        }
    }
    for shape in newest.shapes_after(None, usize::MAX, None) {
        let bounds = newest.bounds_of(shape.id).expect("it is there");
        let is_static = shape.mobility == collision::world::Mobility::Static;
        assert!(is_static || all.iter().any(|found| found.level > 0 && found.bounds.contains(bounds)));
    }
    let few = newest.tree_boxes(1, 5);
    assert!(few.len() == 5 && few.iter().all(|found: &NodeBox| found.level <= 1));
}
