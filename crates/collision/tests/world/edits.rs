//! Laws of editing: a world does what a map from ids to shapes does, each batch at once, and versions never change.

use std::{collections::BTreeMap, sync::Arc};

use collision::{
    DQuat, DVec3,
    accuracy::Accuracy,
    answer::{Verdict, Work},
    math::{Aabb, Pose},
    narrow::{self, Placed},
    shape::Geometry,
    world::{
        Edit, EditError, EditFault, EditRule, Filter, Meter, Mobility, Overlap, Shape, ShapeId, Snapshot, Subject,
        Time, World,
    },
};

use crate::{
    random::Random,
    scene::{self, id},
};

type Model = BTreeMap<ShapeId, Shape>;

fn shape(number: u64, geometry: &Arc<Geometry>, position: DVec3, mobility: Mobility) -> Shape {
    Shape { mobility, ..scene::shape(number, Arc::clone(geometry), Pose::at(position)) }
}

fn random_edit(random: &mut Random, geometries: &[Arc<Geometry>]) -> Edit {
    // Ids from a small range, spread so that chunks of the directory split and merge.
    let number = 1 + (random.bits() % 700) * 37;
    match random.unit() {
        0.0..0.35 => {
            let geometry = &geometries[(random.bits() % geometries.len() as u64) as usize];
            let mobility = match random.bits() % 4 {
                0 => Mobility::Static,
                1 => Mobility::Kinematic,
                _ => Mobility::Dynamic,
            };
            Edit::Insert(shape(number, geometry, random.vector() * 10.0, mobility))
        }
        0.35..0.85 => {
            let mut maybe = |chance: f64| (random.unit() < chance).then(|| random.vector());
            let position = maybe(0.8).map(|v| v * 10.0);
            let rotation = maybe(0.5).map(|v| DQuat::from_xyzw(v.x, v.y, v.z, 1.0));
            let (velocity, angular_velocity) = (maybe(0.3), maybe(0.3));
            Edit::Move { id: id(number), position, rotation, velocity, angular_velocity, teleport: random.unit() < 0.3 }
        }
        0.85..0.998 => Edit::Remove(id(number)),
        _ => Edit::Clear,
    }
}

/// What an edit does to a map, and how many shapes it changed.
fn apply_to_model(model: &mut Model, edit: &Edit) -> Result<u64, ShapeId> {
    match edit {
        Edit::Insert(shape) => {
            model.insert(shape.id, shape.clone());
            Ok(1)
        }
        Edit::Move { id, position, rotation, velocity, angular_velocity, .. } => {
            let shape = model.get_mut(id).ok_or(*id)?;
            shape.pose.position = position.unwrap_or(shape.pose.position);
            shape.pose.rotation = rotation.unwrap_or(shape.pose.rotation);
            shape.velocity = velocity.unwrap_or(shape.velocity);
            shape.angular_velocity = angular_velocity.unwrap_or(shape.angular_velocity);
            Ok(1)
        }
        Edit::Remove(id) => Ok(u64::from(model.remove(id).is_some())),
        Edit::Clear => Ok(std::mem::take(model).len() as u64),
    }
}

fn assert_equals(snapshot: &Snapshot, model: &Model) {
    assert_eq!(snapshot.len(), model.len());
    let listed = snapshot.shapes_after(None, usize::MAX, None);
    assert_eq!(format!("{listed:?}"), format!("{:?}", model.values().collect::<Vec<_>>()), "listing by id");
    for number in 0..700 {
        let id = id(1 + number * 37);
        assert_eq!(snapshot.shape(id).map(|shape| shape.pose), model.get(&id).map(|shape| shape.pose));
        let bounds = model.get(&id).map(|shape| shape.geometry.bounds(&shape.pose));
        assert_eq!(snapshot.bounds_of(id), bounds, "canonical box of {id}");
    }
    let description = snapshot.describe();
    let static_count = model.values().filter(|shape| shape.mobility == Mobility::Static).count();
    assert_eq!(description.shape_count, model.len() as u64);
    assert_eq!(description.static_count, static_count as u64);
    let boxes = model.values().map(|shape| shape.geometry.bounds(&shape.pose));
    assert_eq!(description.bounds, boxes.reduce(Aabb::union));
    assert_eq!(description.tree_depth == 0, static_count == model.len(), "only moving shapes are in the dynamic tree");
}

fn geometries() -> Vec<Arc<Geometry>> {
    vec![
        Arc::new(Geometry::sphere(0.5).expect("a sphere")),
        Arc::new(Geometry::cuboid(DVec3::new(0.2, 1.0, 0.4)).expect("a box")),
    ]
}

/// Ids of what a box touches, which goes through both trees.
fn touching(snapshot: &Snapshot, half: f64) -> Vec<u64> {
    let question = Overlap {
        subject: Subject::Geometry {
            geometry: Arc::new(Geometry::cuboid(DVec3::splat(half)).expect("a box")),
            pose: Pose::IDENTITY,
        },
        against: None,
        max_hits: usize::MAX,
    };
    let mut go_on = || true;
    let found = snapshot
        .overlap(&question, &Filter::default(), &Accuracy::default(), &mut Meter::new(&mut go_on))
        .expect("an answer");
    found.hits.iter().map(|hit| hit.id.expect("a shape").get()).collect()
}

/// The same by asking the kernel about every shape.
fn touching_in_model(model: &Model, half: f64) -> Vec<u64> {
    let geometry = Geometry::cuboid(DVec3::splat(half)).expect("a box");
    let subject = Placed { geometry: &geometry, pose: Pose::IDENTITY };
    let touches = |shape: &&Shape| {
        let other = Placed { geometry: &shape.geometry, pose: shape.pose };
        narrow::overlap(subject, other, &Accuracy::default(), &mut Work::default()).verdict != Verdict::Miss
    };
    model.values().filter(touches).map(|shape| shape.id.get()).collect()
}

#[test]
fn a_world_does_what_a_map_does_and_versions_never_change() {
    let geometries = geometries();
    let (mut changed, mut fault_count, mut refused) = (0, 0, 0);
    for seed in 1..=6 {
        let mut random = Random::new(seed);
        let mut world = World::new(Time(0));
        let mut model = Model::new();
        let mut versions: Vec<(Arc<Snapshot>, Model, Vec<u64>)> = Vec::new();
        for batch in 0..60_i64 {
            let edits: Vec<Edit> = (0..random.bits() % 80).map(|_| random_edit(&mut random, &geometries)).collect();
            let rule = if random.unit() < 0.2 { EditRule::AllOrNothing } else { EditRule::LeaveOutWrong };
            let mut draft = model.clone();
            let results: Vec<_> = edits.iter().map(|edit| apply_to_model(&mut draft, edit)).collect();
            let faults: Vec<EditFault> = (0..)
                .zip(&results)
                .filter_map(|(index, result)| result.err().map(|id| EditFault { index, id }))
                .collect();
            let tick = world.newest().tick();
            match (world.apply(edits, Time(batch), rule), rule, faults.first()) {
                (Err(error), EditRule::AllOrNothing, Some(first)) => {
                    assert_eq!(error, EditError::Fault(*first));
                    assert_eq!(world.newest().tick(), tick, "no tick is made");
                    refused += 1;
                }
                (Ok(report), ..) => {
                    assert!(rule == EditRule::LeaveOutWrong || faults.is_empty());
                    assert_eq!(report.tick.get(), tick.get() + 1);
                    assert_eq!(report.tick, world.newest().tick());
                    assert_eq!(report.changed_count, results.iter().flatten().sum::<u64>());
                    fault_count += faults.len();
                    changed += report.changed_count;
                    assert_eq!(report.faults, faults);
                    model = draft;
                }
                (result, ..) => panic!("{result:?} with {faults:?}"),
            }
            let newest = world.newest();
            assert_equals(&newest, &model);
            let touched = touching(&newest, 4.0);
            assert_eq!(touched, touching_in_model(&model, 4.0), "tick {}", newest.tick());
            versions.push((Arc::clone(&newest), model.clone(), touched));
        }
        for (snapshot, model, touched) in &versions {
            assert_equals(snapshot, model);
            assert_eq!(&touching(snapshot, 4.0), touched, "tick {} answers as it did", snapshot.tick());
        }
    }
    assert!(changed > 4000 && fault_count > 500 && refused > 20, "vacuous: {changed}, {fault_count}, {refused}");
}

#[test]
fn time_does_not_go_back_and_may_stand_still() {
    let mut world = World::new(Time(5));
    assert_eq!(world.newest().tick().get(), 1);
    assert!(world.apply(Vec::new(), Time(5), EditRule::LeaveOutWrong).is_ok());
    assert!(world.apply(Vec::new(), Time(9), EditRule::LeaveOutWrong).is_ok());
    let error = world.apply(vec![Edit::Clear], Time(8), EditRule::LeaveOutWrong).expect_err("it goes back");
    assert_eq!(error, EditError::TimeGoesBack { newest: Time(9), found: Time(8) });
    assert_eq!(error.to_string(), "time is 8 ns: it must not be before that of the newest tick, 9 ns");
    assert_eq!((world.newest().tick().get(), world.newest().time()), (3, Time(9)));
}

#[test]
fn listing_goes_on_after_an_id_and_keeps_to_bounds() {
    let geometries = geometries();
    let mut world = World::new(Time(0));
    // In falling order, so that every chunk is split in its middle.
    let edits = (1..=1000_u64)
        .rev()
        .map(|number| Edit::Insert(shape(number, &geometries[0], DVec3::X * number as f64, Mobility::Dynamic)));
    world.apply(edits.collect(), Time(0), EditRule::AllOrNothing).expect("a tick");
    let snapshot = world.newest();
    let mut pages = Vec::new();
    let mut after = None;
    loop {
        let page = snapshot.shapes_after(after, 130, None);
        let Some(last) = page.last() else {
            break;
        };
        after = Some(last.id);
        pages.extend(page.into_iter().map(|shape| shape.id.get()));
    }
    assert_eq!(pages, (1..=1000).collect::<Vec<_>>());
    let bounds = Aabb::new(DVec3::new(100.0, -1.0, -1.0), DVec3::new(110.0, 1.0, 1.0));
    let listed = snapshot.shapes_after(Some(id(104)), 3, Some(bounds));
    assert_eq!(listed.iter().map(|shape| shape.id.get()).collect::<Vec<_>>(), [105, 106, 107]);
    assert!(snapshot.shapes_after(Some(id(110)), 9, Some(bounds)).is_empty());
}

#[test]
fn a_world_of_static_shapes_builds_a_tree_only_when_it_is_asked() {
    let geometries = geometries();
    let mut world = World::new(Time(0));
    let built =
        |world: &World| -> Vec<&str> { world.newest().describe().built.iter().map(|built| built.name).collect() };
    assert!(built(&world).is_empty());
    let edits = (1..=50).map(|number| Edit::Insert(shape(number, &geometries[1], DVec3::ZERO, Mobility::Static)));
    world.apply(edits.collect(), Time(0), EditRule::AllOrNothing).expect("a tick");
    assert!(built(&world).is_empty(), "nobody asked");
    assert_eq!(touching(&world.newest(), 1.0).len(), 50);
    assert_eq!(built(&world), ["static_tree"]);
    let moving = Edit::Insert(shape(99, &geometries[0], DVec3::ZERO, Mobility::Dynamic));
    world.apply(vec![moving], Time(0), EditRule::AllOrNothing).expect("a tick");
    assert_eq!(built(&world), ["dynamic_tree", "static_tree"], "the static tree of the version before still serves");
    world.apply(vec![Edit::Remove(id(7))], Time(0), EditRule::AllOrNothing).expect("a tick");
    assert_eq!(built(&world), ["dynamic_tree"]);
    assert_eq!(touching(&world.newest(), 1.0).len(), 50);
}

#[test]
fn a_static_shape_is_found_where_it_was_moved_to() {
    let geometries = geometries();
    // So many that they do not share a leaf of the tree.
    let shapes: Vec<Shape> = (1..=50)
        .map(|number| shape(number, &geometries[1], DVec3::X * (number - 1) as f64 * 10.0, Mobility::Static))
        .collect();
    let mut world = World::new(Time(0));
    world.apply(shapes.into_iter().map(Edit::Insert).collect(), Time(0), EditRule::AllOrNothing).expect("a tick");
    let before = world.newest();
    assert_eq!(touching(&before, 1.0), [1], "its tree is built");
    let come = Edit::Move {
        id: id(50),
        position: Some(DVec3::Y),
        rotation: None,
        velocity: None,
        angular_velocity: None,
        teleport: false,
    };
    world.apply(vec![come], Time(0), EditRule::AllOrNothing).expect("a tick");
    assert_eq!(touching(&world.newest(), 1.0), [1, 50]);
    assert_eq!(touching(&before, 1.0), [1]);
}

#[test]
fn a_shape_replaced_whole_keeps_nothing_and_ids_are_used_again() {
    let geometries = geometries();
    let mut world = World::new(Time(0));
    let mut first = shape(3, &geometries[0], DVec3::X, Mobility::Static);
    first.layers = 6;
    first.velocity = DVec3::Y;
    let second = shape(3, &geometries[1], DVec3::ZERO, Mobility::Kinematic);
    let report = world.apply(
        vec![Edit::Insert(first), Edit::Insert(second.clone()), Edit::Remove(id(4))],
        Time(0),
        EditRule::AllOrNothing,
    );
    assert_eq!(report.expect("a tick").changed_count, 2, "what is gone is no error and no change");
    let newest = world.newest();
    assert_eq!(format!("{:?}", newest.shape(id(3))), format!("{:?}", Some(&second)));
    assert_eq!(newest.describe().static_count, 0);
}
