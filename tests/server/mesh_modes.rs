//! Modes of meshes over the wire: what each question says of a body, of fronts, and of a surface.

use tonic::Code;
use wire::v1::{self as pb, MeshMode, geometry::Kind};

use crate::harness::{Bench, assert_refused, at, geometry, insert, shape, sphere, subject, vec3};

/// A cube of edge 2 about the origin, of twelve triangles that face outwards.
fn cube(mode: MeshMode) -> pb::Geometry {
    let corner = |i: u32| [i & 1, i >> 1 & 1, i >> 2].map(|bit| 2.0 * bit as f32 - 1.0);
    let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    geometry(Kind::Mesh(pb::TriangleMesh {
        vertices: (0..8).flat_map(corner).collect(),
        indices: quads.into_iter().flat_map(|[a, b, c, d]| [a, b, c, a, c, d]).collect(),
        mode: mode.into(),
        decompose: None,
    }))
}

async fn world_of(mode: MeshMode) -> Bench {
    let mut bench = Bench::start().await;
    bench.edit(vec![insert(shape(1, cube(mode), at(0.0, 0.0, 0.0)))]).await.unwrap();
    bench
}

async fn distance_from_inside(bench: &mut Bench) -> f64 {
    let request = pb::DistanceRequest {
        subject: Some(subject(sphere(0.25), at(0.0, 0.0, 0.0))),
        ..pb::DistanceRequest::default()
    };
    bench.questions.distance(request).await.unwrap().into_inner().hits[0].distance.unwrap()
}

async fn overlap_inside(bench: &mut Bench) -> pb::Verdict {
    let request =
        pb::OverlapRequest { subject: Some(subject(sphere(0.25), at(0.0, 0.0, 0.0))), ..pb::OverlapRequest::default() };
    bench.questions.overlap(request).await.unwrap().into_inner().verdict()
}

/// A ray from the middle of the cube along x: how far it gets, and whether it began inside.
async fn ray_from_inside(bench: &mut Bench, hollow: bool) -> Option<(f64, bool)> {
    let request = pb::RaycastRequest { direction: Some(vec3(3.0, 0.1, 0.2)), hollow, ..pb::RaycastRequest::default() };
    let answer = bench.questions.raycast(request).await.unwrap().into_inner();
    answer.hits.first().map(|hit| (hit.distance.unwrap(), hit.inside))
}

/// A small ball that goes from the middle of the cube out along x: when it touches.
async fn way_out(bench: &mut Bench) -> Option<(f64, bool)> {
    let request = pb::TimeOfImpactRequest {
        subject: Some(subject(sphere(0.5), at(0.0, 0.0, 0.0))),
        end: Some(at(4.0, 0.0, 0.0)),
        ..pb::TimeOfImpactRequest::default()
    };
    let answer = bench.questions.time_of_impact(request).await.unwrap().into_inner();
    answer.hits.first().map(|hit| (hit.fraction.unwrap(), hit.initial))
}

#[tokio::test]
async fn a_body_is_full() {
    let mut bench = world_of(MeshMode::Solid).await;
    assert_eq!(overlap_inside(&mut bench).await, pb::Verdict::Hit);
    assert_eq!(distance_from_inside(&mut bench).await, 0.0);
    assert_eq!(ray_from_inside(&mut bench, false).await, Some((0.0, true)));
    let (wall, is_inside) = ray_from_inside(&mut bench, true).await.unwrap();
    assert!(wall > 1.0 && !is_inside);
    assert_eq!(way_out(&mut bench).await, Some((0.0, true)));
}

#[tokio::test]
async fn a_surface_is_empty_inside() {
    let mut bench = world_of(MeshMode::TwoSided).await;
    assert_eq!(overlap_inside(&mut bench).await, pb::Verdict::Miss);
    assert!((distance_from_inside(&mut bench).await - 0.75).abs() < 1e-12);
    assert!(ray_from_inside(&mut bench, false).await.is_some_and(|(wall, _)| wall > 1.0));
    assert!(way_out(&mut bench).await.is_some_and(|(fraction, _)| (fraction - 0.125).abs() < 1e-12));
}

#[tokio::test]
async fn fronts_are_left_from_behind() {
    let mut bench = world_of(MeshMode::OneSided).await;
    assert_eq!(overlap_inside(&mut bench).await, pb::Verdict::Miss);
    assert!((distance_from_inside(&mut bench).await - 0.75).abs() < 1e-12);
    assert_eq!(ray_from_inside(&mut bench, false).await, None);
    assert_eq!(way_out(&mut bench).await, None);
}

#[tokio::test]
async fn a_depth_is_told_at_the_surface_of_a_body_and_refused_deep_in_it() {
    let mut bench = world_of(MeshMode::Solid).await;
    let ball = |y: f64| pb::PenetrationRequest {
        subject: Some(subject(sphere(0.5), at(0.5, y, -0.5))),
        ..pb::PenetrationRequest::default()
    };
    let answer = bench.questions.penetration(ball(1.375)).await.unwrap().into_inner();
    assert_eq!((answer.verdict(), answer.contacts.len()), (pb::Verdict::Hit, 1));
    let contact = &answer.contacts[0];
    assert_eq!(contact.normal, Some(vec3(0.0, 1.0, 0.0)));
    assert!((contact.depth.unwrap() - 0.125).abs() < 1e-12, "{contact:?}");
    let status = bench.questions.penetration(ball(0.5)).await.unwrap_err();
    assert_refused(&status, Code::FailedPrecondition, "NEEDS_DECOMPOSITION", "", &["shape 1", "solid", "Distance"]);
}
