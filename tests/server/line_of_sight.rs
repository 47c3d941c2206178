//! What observers see, over the wire: counts and points, who is left out, wrong columns, and the stream.

use tonic::Code;
use wire::v1::{
    self as pb, query_stream_request::Request as Asked, query_stream_response::Response as Answered, read_at::At,
};

use crate::harness::{Bench, Refusal, assert_invalid, at, cuboid, insert, move_to, read_at, shape, sphere, vec3};

/// A wall across the way of the eyes, 2 m high, and a ball, number 7, behind it.
async fn yard() -> Bench {
    let mut bench = Bench::start().await;
    let wall = shape(1, cuboid(0.25, 1.0, 8.0), at(5.0, 1.0, 0.0));
    bench.edit(vec![insert(wall), insert(shape(7, sphere(0.5), at(10.0, 1.5, 0.0)))]).await.unwrap();
    bench
}

/// Two eyes, one low and one high, look at a figure of head and feet behind the wall and at a point before it.
fn look() -> pb::LineOfSightRequest {
    pb::LineOfSightRequest {
        eyes: vec![0.0, 0.5, 0.0, 0.0, 3.0, 0.0],
        points: vec![10.0, 1.5, 0.0, 10.0, 0.25, 0.0, 3.0, 0.25, 0.0],
        offsets: vec![0, 2, 3],
        target_ids: vec![7, 0],
        want_points: true,
        ..pb::LineOfSightRequest::default()
    }
}

async fn seen(bench: &mut Bench, request: pb::LineOfSightRequest) -> pb::LineOfSightResponse {
    bench.questions.line_of_sight(request).await.unwrap().into_inner()
}

fn sights(answer: &pb::LineOfSightResponse) -> Vec<pb::Sight> {
    answer.points.iter().map(|&sight| pb::Sight::try_from(sight).unwrap()).collect()
}

#[tokio::test]
async fn each_eye_sees_what_no_shape_but_its_own_and_the_targets_hides() {
    use pb::Sight::{Beyond, Hidden, Unspecified, Visible};
    let mut bench = yard().await;
    let answer = seen(&mut bench, look()).await;
    // The high eye sees the head over the wall, and not the feet.
    assert_eq!(answer.visible, [0, 1, 1, 1]);
    assert_eq!(answer.hidden, [2, 0, 1, 0]);
    assert_eq!(answer.undecided, [0; 4]);
    let points: Vec<pb::Sight> = sights(&answer);
    assert_eq!(points, [Hidden, Hidden, Visible, Visible, Hidden, Visible]);
    assert_eq!(answer.info.as_ref().unwrap().tick, 2);
    // A figure that is not left out hides its own head.
    let all = seen(&mut bench, pb::LineOfSightRequest { target_ids: vec![], ..look() }).await;
    assert_eq!(all.visible, [0, 1, 0, 1]);
    // An observer in a shape sees out of it if that is its own.
    let inside = |eye_ids| pb::LineOfSightRequest {
        eyes: vec![10.0, 1.5, 0.0],
        eye_ids,
        points: vec![12.0, 1.5, 0.0],
        ..Default::default()
    };
    assert_eq!(seen(&mut bench, inside(vec![])).await.hidden, [1]);
    assert_eq!(seen(&mut bench, inside(vec![7])).await.visible, [1]);
    // One point is enough, and what is too far is not looked at.
    let request = pb::LineOfSightRequest { enough: 1, eyes: vec![0.0, 3.0, 0.0], max_distances: vec![4.5], ..look() };
    let near: Vec<pb::Sight> = sights(&seen(&mut bench, request.clone()).await);
    assert_eq!(near, [Beyond, Beyond, Visible]);
    let request = pb::LineOfSightRequest { max_distances: vec![], ..request };
    let first: Vec<pb::Sight> = sights(&seen(&mut bench, request).await);
    assert_eq!(first, [Visible, Unspecified, Visible]);
}

#[tokio::test]
async fn it_is_asked_at_a_tick_and_goes_onto_the_stream() {
    let mut bench = yard().await;
    bench.edit(vec![move_to(1, at(5.0, 1.0, 90.0))]).await.unwrap();
    assert_eq!(seen(&mut bench, look()).await.visible, [2, 1, 2, 1], "the wall is gone");
    let past = pb::LineOfSightRequest { options: Some(Box::new(read_at(At::Tick(2)))), ..look() };
    let answer = seen(&mut bench, past.clone()).await;
    assert_eq!((answer.visible.as_slice(), answer.info.as_ref().unwrap().tick), (&[0, 1, 1, 1][..], 2));
    let messages = vec![
        pb::QueryStreamRequest { request_id: 4, request: Some(Asked::LineOfSight(Box::new(past))) },
        pb::QueryStreamRequest { request_id: 5, request: Some(Asked::LineOfSight(Box::default())) },
    ];
    let stream = bench.questions.query_stream(tokio_stream::iter(messages)).await.unwrap();
    let mut answers = stream.into_inner();
    let first = answers.message().await.unwrap().unwrap();
    assert_eq!((first.request_id, first.response), (4, Some(Answered::LineOfSight(Box::new(answer)))));
    let Some(Answered::Problem(problem)) = answers.message().await.unwrap().unwrap().response else { panic!() };
    assert_eq!((problem.field.as_str(), problem.reason.as_str()), ("line_of_sight.eyes", "MISSING"));
}

#[tokio::test]
async fn wrong_columns_are_told_by_name() {
    let mut bench = yard().await;
    let wrong: Vec<(pb::LineOfSightRequest, Refusal)> = vec![
        (pb::LineOfSightRequest { eyes: vec![], ..look() }, ("MISSING", "eyes", &["x, y, z"])),
        (pb::LineOfSightRequest { points: vec![], ..look() }, ("MISSING", "points", &["x, y, z"])),
        (pb::LineOfSightRequest { eyes: vec![0.0; 4], ..look() }, ("COLUMN_LENGTH", "eyes", &["4", "multiple of 3"])),
        (pb::LineOfSightRequest { offsets: vec![1, 2, 3], ..look() }, ("OUT_OF_LIMITS", "offsets[0]", &["must be 0"])),
        (pb::LineOfSightRequest { offsets: vec![0, 3, 2], ..look() }, ("OUT_OF_LIMITS", "offsets[2]", &["ascend"])),
        (pb::LineOfSightRequest { offsets: vec![0, 2], ..look() }, ("OUT_OF_LIMITS", "offsets[1]", &["3 points"])),
        (pb::LineOfSightRequest { target_ids: vec![1; 3], ..look() }, ("COLUMN_LENGTH", "target_ids", &["2"])),
        (pb::LineOfSightRequest { eye_ids: vec![1; 3], ..look() }, ("COLUMN_LENGTH", "eye_ids", &["2"])),
        (
            pb::LineOfSightRequest { max_distances: vec![-1.0], ..look() },
            ("OUT_OF_LIMITS", "max_distances[0]", &["-1"]),
        ),
        (
            pb::LineOfSightRequest { points: vec![0.0, f32::NAN, 0.0], offsets: vec![], target_ids: vec![], ..look() },
            ("NOT_FINITE", "points[1]", &["NaN"]),
        ),
        (
            pb::LineOfSightRequest { eyes: vec![0.0; 3 * 30_000], ..look() },
            ("TOO_MANY_ITEMS", "points", &["65536", "several calls"]),
        ),
    ];
    for (request, refusal) in wrong {
        assert_invalid(&bench.questions.line_of_sight(request).await.unwrap_err(), refusal);
    }
    let unmade = pb::LineOfSightRequest { options: Some(Box::new(read_at(At::Tick(99)))), ..look() };
    let status = bench.questions.line_of_sight(unmade).await.unwrap_err();
    assert_eq!(status.code(), Code::OutOfRange);
    let far = pb::LineOfSightRequest { frame_origin: Some(vec3(1e12, 0.0, 0.0)), eyes: vec![1e6, 0.0, 0.0], ..look() };
    assert_invalid(&bench.questions.line_of_sight(far).await.unwrap_err(), ("OUT_OF_LIMITS", "eyes[0]", &["1e12"]));
}
