//! Contact response over the wire: what comes back, and what is wrong with bodies.

use wire::v1::{self as pb};

use crate::harness::{Bench, assert_refused, at, cuboid, insert, shape, sphere, vec3};
use tonic::Code;

/// A floor whose top is at y = 0, shape 1, and a ball sunk into it, shape 2, that falls at 3 m/s.
async fn fallen() -> Bench {
    let mut bench = Bench::start().await;
    let floor =
        pb::Shape { mobility: pb::Mobility::Static.into(), ..shape(1, cuboid(9.0, 1.0, 9.0), at(0.0, -1.0, 0.0)) };
    let ball = pb::Shape { velocity: Some(vec3(0.0, -3.0, 0.0)), ..shape(2, sphere(0.5), at(0.0, 0.375, 0.0)) };
    bench.edit(vec![insert(floor), insert(ball)]).await.unwrap();
    bench
}

fn body(id: u64) -> pb::Body {
    pb::Body { id, mass: 2.0, restitution: 0.5, ..pb::Body::default() }
}

fn request(bodies: Vec<pb::Body>) -> pb::ResolveRequest {
    pb::ResolveRequest { bodies, ..pb::ResolveRequest::default() }
}

#[tokio::test]
async fn a_fallen_ball_bounces_and_is_lifted() {
    let mut bench = fallen().await;
    let answer = bench.questions.resolve(request(vec![body(2)])).await.unwrap().into_inner();
    let change = &answer.changes[0];
    assert_eq!(
        (change.id, change.velocity, change.translation),
        (2, Some(vec3(0.0, 1.5, 0.0)), Some(vec3(0.0, 0.125, 0.0)))
    );
    let impulse = &answer.impulses[0];
    assert_eq!((impulse.id, impulse.other_id, impulse.impulse), (2, 1, Some(vec3(0.0, 9.0, 0.0))));
    assert_eq!(answer.info.unwrap().tick, 2);
    // Another speed, half of the depth left alone, half of the rest corrected.
    let faster = pb::Body { velocity: Some(vec3(0.0, -8.0, 0.0)), ..body(2) };
    let gentle = pb::ResolveRequest { allowed_depth: 0.0625, correction: Some(0.5), ..request(vec![faster]) };
    let answer = bench.questions.resolve(gentle).await.unwrap().into_inner();
    let change = &answer.changes[0];
    assert_eq!((change.velocity, change.translation), (Some(vec3(0.0, 4.0, 0.0)), Some(vec3(0.0, 0.03125, 0.0))));
    let none = bench.questions.resolve(request(vec![])).await.unwrap().into_inner();
    assert!(none.changes.is_empty() && none.impulses.is_empty());
}

#[tokio::test]
async fn a_wrong_body_is_told_with_its_place() {
    let mut bench = fallen().await;
    let wrong = [
        (body(0), "OUT_OF_LIMITS", "bodies[1].id"),
        (pb::Body { mass: 0.0, ..body(1) }, "OUT_OF_LIMITS", "bodies[1].mass"),
        (pb::Body { mass: f64::NAN, ..body(1) }, "NOT_FINITE", "bodies[1].mass"),
        (pb::Body { inertia: Some(vec3(1.0, 0.0, 1.0)), ..body(1) }, "OUT_OF_LIMITS", "bodies[1].inertia.y"),
        (pb::Body { restitution: 1.5, ..body(1) }, "OUT_OF_LIMITS", "bodies[1].restitution"),
        (pb::Body { friction: -1.0, ..body(1) }, "OUT_OF_LIMITS", "bodies[1].friction"),
        (pb::Body { velocity: Some(vec3(0.0, f64::INFINITY, 0.0)), ..body(1) }, "NOT_FINITE", "bodies[1].velocity.y"),
        (body(2), "OUT_OF_LIMITS", "bodies"),
    ];
    for (body_sent, reason, field) in wrong {
        let status = bench.questions.resolve(request(vec![body(2), body_sent])).await.unwrap_err();
        assert_refused(&status, Code::InvalidArgument, reason, field, &[]);
    }
    let status = bench.questions.resolve(request(vec![body(2), body(9)])).await.unwrap_err();
    assert_refused(&status, Code::NotFound, "SHAPE_NOT_FOUND", "bodies[1].id", &["shape", "tick 2"]);
    let passes = pb::ResolveRequest { passes: 65, ..request(vec![body(2)]) };
    let status = bench.questions.resolve(passes).await.unwrap_err();
    assert_refused(&status, Code::InvalidArgument, "OUT_OF_LIMITS", "passes", &["1 to 64"]);
}
