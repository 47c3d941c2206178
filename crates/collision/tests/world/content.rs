//! The hash of a version's content: the same for the same shapes, whatever happened before, and another for others.

use std::sync::Arc;

use collision::{
    DVec3,
    math::Pose,
    shape::Geometry,
    world::{Edit, EditRule, Mobility, Shape, Time},
};

use crate::determinism::by_detours;
use crate::random::Random;
use crate::scene::{Frame, half_spaces, id, random_geometry, random_shapes, shape, world_of};

#[test]
fn it_is_that_of_the_shapes_whatever_happened_before() {
    let mut random = Random::new(31);
    for _ in 0..4 {
        let mut shapes = random_shapes(&mut random, Frame::UNIT, 150);
        shapes.extend(half_spaces(&mut random, Frame::UNIT, 1000));
        let mut straight = world_of(shapes.clone());
        let version = straight.newest();
        let hash = version.content_hash();
        assert_eq!(hash, world_of(shapes.iter().rev().cloned()).newest().content_hash());
        assert_eq!(hash, by_detours(&shapes, Frame::UNIT, &mut random).newest().content_hash());
        // Questions build what they need, and a tick goes by.
        assert_eq!(version.describe().shape_count, 153);
        straight.apply(vec![Edit::Remove(id(5000))], Time(9), EditRule::AllOrNothing).expect("a tick");
        assert_eq!(hash, straight.newest().content_hash());
    }
}

#[test]
fn every_field_counts() {
    let mut random = Random::new(32);
    let shapes = random_shapes(&mut random, Frame::UNIT, 20);
    let other_geometry = random_geometry(&mut random, Frame::UNIT);
    let changes: [&dyn Fn(&mut Shape); 14] = [
        &|shape| shape.id = id(99),
        &|shape| shape.geometry = other_geometry.clone(),
        &|shape| shape.pose.position.y = shape.pose.position.y.next_up(),
        &|shape| shape.pose.rotation = -shape.pose.rotation,
        &|shape| shape.layers ^= 1 << 31,
        &|shape| shape.collides_with ^= 1 << 31,
        &|shape| {
            let is_static = shape.mobility == Mobility::Static;
            shape.mobility = if is_static { Mobility::Dynamic } else { Mobility::Static };
        },
        &|shape| shape.bullet = !shape.bullet,
        &|shape| shape.sensor = !shape.sensor,
        &|shape| shape.group ^= 8,
        &|shape| shape.user_data ^= 1 << 63,
        &|shape| shape.velocity = DVec3::Z,
        &|shape| shape.velocity = DVec3::new(0.0, -0.0, 0.0),
        &|shape| shape.angular_velocity = DVec3::Z,
    ];
    let mut hashes = vec![world_of(shapes.clone()).newest().content_hash()];
    for change in changes {
        let mut changed = shapes.clone();
        change(&mut changed[7]);
        hashes.push(world_of(changed).newest().content_hash());
    }
    hashes.push(world_of(shapes[1..].iter().cloned()).newest().content_hash());
    hashes.push(world_of([]).newest().content_hash());
    let count = hashes.len();
    hashes.sort_unstable();
    hashes.dedup();
    assert_eq!(hashes.len(), count);
}

#[test]
fn its_layout_is_what_it_was() {
    let shapes = (1..=3_u32).map(|i| {
        let geometry = Geometry::cuboid(DVec3::new(1.0, 2.0, f64::from(i))).expect("a box");
        Shape { sensor: i == 2, ..shape(i.into(), Arc::new(geometry), Pose::at(DVec3::X * f64::from(i))) }
    });
    let hash = world_of(shapes).newest().content_hash();
    let hex: String = hash.iter().map(|byte| format!("{byte:02x}")).collect();
    assert_eq!(hex, "0449415a311704f9a5d586a1e60b1b9c2f2cda6f14e2eee946e4a4200643334f");
}
