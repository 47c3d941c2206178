//! All pairs that overlap: those that the kernels find when every shape is asked against every other.

use std::sync::Arc;

use collision::{
    DVec3,
    accuracy::Accuracy,
    answer::{Verdict, Work},
    math::Pose,
    narrow::{self, Placed},
    shape::Geometry,
    world::{Filter, Meter, Mobility, Pair, QuestionError, Shape, ShapeId, Snapshot},
};

use crate::determinism::{FRAMES, by_detours};
use crate::random::Random;
use crate::scene::{Frame, grid_shapes, half_spaces, id, random_filter, random_shapes, shape, world_of};

pub(crate) fn pairs(snapshot: &Snapshot, filter: &Filter) -> Vec<Pair> {
    let mut go_on = || true;
    snapshot.pairs(filter, &Accuracy::default(), &mut Meter::new(&mut go_on)).expect("an answer")
}

fn box_pairs(snapshot: &Snapshot, filter: &Filter) -> Vec<(ShapeId, ShapeId)> {
    let mut found = Vec::new();
    let mut go_on = || true;
    let visit = |a, b| {
        found.push((a, b));
        Ok(())
    };
    snapshot.box_pairs(filter, &mut Meter::new(&mut go_on), visit).expect("an answer");
    found.sort_unstable();
    found
}

fn passes(shape: &Shape, filter: &Filter) -> bool {
    shape.layers & filter.collides_with.unwrap_or(u32::MAX) != 0
        && shape.collides_with & filter.layers.unwrap_or(u32::MAX) != 0
        && !filter.exclude_ids.contains(&shape.id)
        && !(filter.exclude_sensors && shape.sensor)
        && !(filter.exclude_static && shape.mobility == Mobility::Static)
        && !(shape.group != 0 && filter.exclude_groups.contains(&shape.group))
}

fn are_a_pair(a: &Shape, b: &Shape) -> bool {
    let one_wants = |a: &Shape, b: &Shape| a.collides_with & b.layers != 0;
    one_wants(a, b)
        && one_wants(b, a)
        && (a.group == 0 || a.group != b.group)
        && (a.mobility != Mobility::Static || b.mobility != Mobility::Static)
}

/// All box pairs by asking every shape against every other, ascending.
fn all_box_pairs<'a>(shapes: &[&'a Shape], filter: &Filter) -> Vec<(&'a Shape, &'a Shape)> {
    let mut found = Vec::new();
    for (index, &a) in shapes.iter().enumerate() {
        for &b in &shapes[index + 1..] {
            let touch = a.geometry.bounds(&a.pose).intersects(b.geometry.bounds(&b.pose));
            if touch && are_a_pair(a, b) && passes(a, filter) && passes(b, filter) {
                found.push((a, b));
            }
        }
    }
    found
}

fn scene(number: usize, random: &mut Random) -> Vec<Shape> {
    let frame = FRAMES[number % 4];
    if number % 4 == 3 {
        return grid_shapes();
    }
    let mut shapes = random_shapes(random, frame, 60);
    // Of some scenes nearly all shapes stand, of some nearly none: then the others ask.
    for shape in &mut shapes {
        match number / 4 {
            1 if random.unit() < 0.8 => shape.mobility = Mobility::Static,
            2 if random.unit() < 0.8 => shape.mobility = Mobility::Kinematic,
            _ => {}
        }
    }
    shapes.extend(half_spaces(random, frame, 100));
    shapes
}

#[test]
fn they_are_all_that_touch_and_no_others() {
    let mut random = Random::new(41);
    let (mut candidate_count, mut hit_count) = (0, 0);
    for number in 0..12 {
        let shapes = scene(number, &mut random);
        let straight = world_of(shapes.clone()).newest();
        let detoured = by_detours(&shapes, FRAMES[number % 4], &mut random).newest();
        let mut by_id: Vec<&Shape> = shapes.iter().collect();
        by_id.sort_unstable_by_key(|shape| shape.id);
        for filter in [Filter::default(), random_filter(&mut random), random_filter(&mut random)] {
            let candidates = all_box_pairs(&by_id, &filter);
            let ids: Vec<_> = candidates.iter().map(|(a, b)| (a.id, b.id)).collect();
            assert_eq!(box_pairs(&straight, &filter), ids);
            assert_eq!(box_pairs(&detoured, &filter), ids);
            let touching = candidates.iter().filter_map(|(a, b)| {
                let [placed_a, placed_b] = [a, b].map(|shape| Placed { geometry: &shape.geometry, pose: shape.pose });
                let certificate = narrow::overlap(placed_a, placed_b, &Accuracy::default(), &mut Work::default());
                (certificate.verdict != Verdict::Miss).then_some(Pair { a: a.id, b: b.id, certificate })
            });
            let expected: Vec<Pair> = touching.collect();
            let found = pairs(&straight, &filter);
            assert_eq!(found, expected, "scene {number}, {filter:?}");
            assert_eq!(format!("{found:?}"), format!("{:?}", pairs(&detoured, &filter)));
            // Of the grid all boxes that touch are pairs.
            if number % 4 != 3 {
                candidate_count += candidates.len();
                hit_count += found.len();
            }
        }
    }
    let share = hit_count as f64 / candidate_count as f64;
    assert!(candidate_count > 1000 && (0.3..0.9).contains(&share), "vacuous: {hit_count} of {candidate_count}");
}

#[test]
fn two_meshes_are_a_pair_where_their_surfaces_cross() {
    let corners = [DVec3::new(-1.0, 0.0, -1.0), DVec3::new(1.0, 0.0, -1.0), DVec3::new(0.0, 0.0, 2.0)];
    let sheet = Arc::new(Geometry::mesh(&corners, &[[0, 1, 2]]).expect("a mesh"));
    let upright = collision::DQuat::from_xyzw(0.0, 0.0, 1.0, 1.0);
    let shapes = [
        shape(3, Arc::clone(&sheet), Pose::IDENTITY),
        shape(1, Arc::clone(&sheet), Pose::new(DVec3::ZERO, upright)),
        shape(2, sheet, Pose::at(DVec3::Y * 1.5)),
    ];
    let found = pairs(&world_of(shapes).newest(), &Filter::default());
    let ids: Vec<_> = found.iter().map(|pair| (pair.a.get(), pair.b.get(), pair.certificate.verdict)).collect();
    assert_eq!(ids, [(1, 3, Verdict::Hit)]);
}

#[test]
fn a_heap_in_one_place_ends_in_an_error() {
    let point = Arc::new(Geometry::sphere(1.0).expect("a sphere"));
    let heap = |count| world_of((1..=count).map(|number| shape(number, Arc::clone(&point), Pose::IDENTITY)));
    assert_eq!(pairs(&heap(300).newest(), &Filter::default()).len(), 300 * 299 / 2);
    let mut go_on = || true;
    let meter = &mut Meter::new(&mut go_on);
    let refused = heap(100_000).newest().pairs(&Filter::default(), &Accuracy::default(), meter);
    assert_eq!(refused.expect_err("5e9 pairs"), QuestionError::TooManyPairs);
    assert!(meter.work.shapes_tested <= collision::world::PAIRS_MAX as u64 + 1, "it went on");
}

#[test]
fn it_can_be_interrupted_and_a_world_that_stands_has_no_pairs_and_no_tree() {
    let shapes = random_shapes(&mut Random::new(3), Frame::UNIT, 400);
    let mut stop = || false;
    let interrupted =
        world_of(shapes.clone()).newest().pairs(&Filter::default(), &Accuracy::default(), &mut Meter::new(&mut stop));
    assert_eq!(interrupted.expect_err("stopped"), QuestionError::Interrupted);
    let standing = world_of(shapes.into_iter().map(|shape| Shape { mobility: Mobility::Static, ..shape })).newest();
    assert!(pairs(&standing, &Filter::default()).is_empty());
    assert!(standing.describe().built.iter().all(|built| !built.name.ends_with("c_tree")));
    assert!(standing.shape(id(1)).is_some());
}
