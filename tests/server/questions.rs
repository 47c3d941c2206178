//! The questions: the README's examples with their answers, batches, versions, and what an answer says of itself.

use std::time::Duration;

use tonic::Code;
use wire::v1::{self as pb, answer::Answer, question::Question, read_at::At};

use crate::harness::{
    Bench, assert_refused, at, cuboid, insert, ray_along_z, read_at, shape, sphere, subject, subject_shape, vec3,
};

/// The world of the README: a sphere of radius 1 at z = 5.
async fn readme_world() -> Bench {
    let mut bench = Bench::start().await;
    let tick = bench
        .edit(vec![insert(shape(1, sphere(1.0), at(0.0, 0.0, 5.0)))])
        .await
        .unwrap();
    assert_eq!(tick, 2);
    bench
}

#[track_caller]
fn assert_near(found: Option<f64>, expected: f64, certificate: Option<&pb::Certificate>) {
    let found = found.expect("a value");
    assert!((found - expected).abs() < 1e-9, "{found} is not {expected}");
    let interval = certificate.expect("a certificate").interval.expect("an interval");
    assert!(
        interval.lower.is_none_or(|lower| lower <= expected),
        "{interval:?} misses {expected}"
    );
    assert!(
        interval.upper.is_none_or(|upper| upper >= expected),
        "{interval:?} misses {expected}"
    );
}

#[tokio::test]
async fn readme_raycast() {
    let mut bench = readme_world().await;
    let answer = bench.questions.raycast(ray_along_z()).await.unwrap().into_inner();
    assert_eq!(answer.verdict(), pb::Verdict::Hit);
    let hit = &answer.hits[0];
    assert_eq!(hit.id, 1);
    assert_near(hit.distance, 4.0, hit.certificate.as_ref());
    assert_eq!(answer.info.unwrap().tick, 2);
}

#[tokio::test]
async fn readme_overlap() {
    let mut bench = readme_world().await;
    let request = pb::OverlapRequest {
        subject: Some(subject(cuboid(9.0, 9.0, 9.0), at(0.0, 0.0, 0.0))),
        ..pb::OverlapRequest::default()
    };
    let answer = bench.questions.overlap(request).await.unwrap().into_inner();
    assert_eq!(answer.verdict(), pb::Verdict::Hit);
    assert_eq!(answer.hits.iter().map(|hit| hit.id).collect::<Vec<_>>(), [1]);
}

#[tokio::test]
async fn readme_penetration() {
    let mut bench = readme_world().await;
    let request = pb::PenetrationRequest {
        subject: Some(subject(sphere(1.0), at(0.0, 0.0, 3.5))),
        ..pb::PenetrationRequest::default()
    };
    let answer = bench.questions.penetration(request).await.unwrap().into_inner();
    assert_eq!(answer.verdict(), pb::Verdict::Hit);
    let contact = &answer.contacts[0];
    assert_near(contact.depth, 0.5, contact.certificate.as_ref());
    let normal = contact.normal.unwrap();
    assert!((normal.z + 1.0).abs() < 1e-9, "{normal:?}");
}

#[tokio::test]
async fn readme_time_of_impact() {
    let mut bench = readme_world().await;
    let request = pb::TimeOfImpactRequest {
        subject: Some(subject(sphere(0.5), at(0.0, 0.0, 0.0))),
        end: Some(at(0.0, 0.0, 10.0)),
        ..pb::TimeOfImpactRequest::default()
    };
    let answer = bench.questions.time_of_impact(request).await.unwrap().into_inner();
    assert_eq!(answer.verdict(), pb::Verdict::Hit);
    let hit = &answer.hits[0];
    assert_near(hit.fraction, 0.35, hit.certificate.as_ref());
}

#[tokio::test]
async fn distance_to_the_nearest_and_to_one_geometry() {
    let mut bench = readme_world().await;
    let mut request = pb::DistanceRequest {
        subject: Some(pb::Subject::default()),
        ..pb::DistanceRequest::default()
    };
    let answer = bench.questions.distance(request.clone()).await.unwrap().into_inner();
    assert_near(answer.hits[0].distance, 4.0, answer.hits[0].certificate.as_ref());
    request.against = Some(subject(cuboid(1.0, 1.0, 1.0), at(3.0, 0.0, 0.0)));
    let answer = bench.questions.distance(request).await.unwrap().into_inner();
    assert_eq!(answer.hits[0].id, 0, "a geometry has no id");
    assert_near(answer.hits[0].distance, 2.0, answer.hits[0].certificate.as_ref());
}

#[tokio::test]
async fn a_shape_asks_without_seeing_itself() {
    let mut bench = readme_world().await;
    let second = insert(shape(2, sphere(1.0), at(0.0, 0.0, 6.5)));
    bench.edit(vec![second]).await.unwrap();
    let request = pb::OverlapRequest {
        subject: Some(subject_shape(1)),
        ..pb::OverlapRequest::default()
    };
    let answer = bench.questions.overlap(request).await.unwrap().into_inner();
    assert_eq!(answer.hits.iter().map(|hit| hit.id).collect::<Vec<_>>(), [2]);
    let gone = pb::OverlapRequest {
        subject: Some(subject_shape(9)),
        ..pb::OverlapRequest::default()
    };
    let status = bench.questions.overlap(gone).await.unwrap_err();
    assert_refused(
        &status,
        Code::NotFound,
        "SHAPE_NOT_FOUND",
        "subject.id",
        &["is 9", "tick 3"],
    );
}

#[tokio::test]
async fn all_hits_come_closest_first_and_a_cut_list_says_so() {
    let mut bench = Bench::start().await;
    let row = (1..=5)
        .map(|id| insert(shape(id, sphere(0.25), at(0.0, 0.0, 7.0 - id as f64))))
        .collect();
    bench.edit(row).await.unwrap();
    let mut request = pb::RaycastRequest {
        mode: pb::HitMode::All.into(),
        ..ray_along_z()
    };
    let answer = bench.questions.raycast(request.clone()).await.unwrap().into_inner();
    assert_eq!(
        answer.hits.iter().map(|hit| hit.id).collect::<Vec<_>>(),
        [5, 4, 3, 2, 1]
    );
    assert!(!answer.truncated);
    request.max_hits = 2;
    let answer = bench.questions.raycast(request).await.unwrap().into_inner();
    assert_eq!(answer.hits.iter().map(|hit| hit.id).collect::<Vec<_>>(), [5, 4]);
    assert!(answer.truncated);
}

#[tokio::test]
async fn a_filter_hides_layers_ids_sensors_static_shapes_and_groups() {
    let mut bench = Bench::start().await;
    let mut shapes: Vec<_> = (1..=5).map(|id| shape(id, sphere(1.0), at(0.0, 0.0, 5.0))).collect();
    shapes[0].layers = Some(2);
    shapes[2].sensor = true;
    shapes[3].mobility = pb::Mobility::Static.into();
    shapes[4].group = 8;
    bench.edit(shapes.into_iter().map(insert).collect()).await.unwrap();
    let everything = pb::Filter::default();
    let cases = [
        (everything.clone(), vec![1, 2, 3, 4, 5]),
        (
            pb::Filter {
                collides_with: Some(2),
                ..everything.clone()
            },
            vec![1],
        ),
        (
            pb::Filter {
                exclude_ids: vec![1, 2],
                ..everything.clone()
            },
            vec![3, 4, 5],
        ),
        (
            pb::Filter {
                exclude_sensors: true,
                ..everything.clone()
            },
            vec![1, 2, 4, 5],
        ),
        (
            pb::Filter {
                exclude_static: true,
                ..everything.clone()
            },
            vec![1, 2, 3, 5],
        ),
        (
            pb::Filter {
                exclude_groups: vec![8],
                ..everything
            },
            vec![1, 2, 3, 4],
        ),
    ];
    for (filter, expected) in cases {
        let request = pb::RaycastRequest {
            mode: pb::HitMode::All.into(),
            options: Some(pb::QueryOptions {
                filter: Some(filter.clone()),
                ..pb::QueryOptions::default()
            }),
            ..ray_along_z()
        };
        let answer = bench.questions.raycast(request).await.unwrap().into_inner();
        let mut ids: Vec<_> = answer.hits.iter().map(|hit| hit.id).collect();
        ids.sort_unstable();
        assert_eq!(ids, expected, "{filter:?}");
    }
}

#[tokio::test]
async fn a_miss_is_proved_and_has_no_hits_and_work_comes_only_when_asked() {
    let mut bench = readme_world().await;
    let mut request = pb::RaycastRequest {
        direction: Some(vec3(0.0, 1.0, 0.0)),
        ..pb::RaycastRequest::default()
    };
    let answer = bench.questions.raycast(request.clone()).await.unwrap().into_inner();
    assert_eq!(answer.verdict(), pb::Verdict::Miss);
    assert!(answer.hits.is_empty());
    assert!(answer.info.unwrap().work.is_none());
    request.options = Some(pb::QueryOptions {
        explain: true,
        ..pb::QueryOptions::default()
    });
    let answer = bench.questions.raycast(request).await.unwrap().into_inner();
    assert!(answer.info.unwrap().work.is_some());
}

#[tokio::test]
async fn a_hit_at_distance_zero_has_its_distance_and_a_positive_zero() {
    let mut bench = readme_world().await;
    let request = pb::RaycastRequest {
        origin: Some(vec3(0.0, 0.0, 5.0)),
        ..ray_along_z()
    };
    let answer = bench.questions.raycast(request).await.unwrap().into_inner();
    let distance = answer.hits[0].distance.expect("a zero is sent");
    assert!(distance == 0.0 && distance.is_sign_positive());
    assert!(answer.hits[0].inside);
}

#[tokio::test]
async fn a_batch_is_answered_on_one_tick_and_fails_item_by_item() {
    let mut bench = readme_world().await;
    let question = |question| pb::Question {
        question: Some(question),
    };
    let named = pb::RaycastRequest {
        session: "default".to_owned(),
        ..ray_along_z()
    };
    let pinned = pb::RaycastRequest {
        options: Some(read_at(At::Tick(2))),
        ..ray_along_z()
    };
    let request = pb::BatchRequest {
        questions: vec![
            question(Question::Raycast(ray_along_z())),
            question(Question::Raycast(pb::RaycastRequest::default())),
            pb::Question::default(),
            question(Question::Raycast(named)),
            question(Question::Raycast(pinned)),
            question(Question::MoveCharacter(pb::MoveCharacterRequest::default())),
            question(Question::Distance(pb::DistanceRequest {
                subject: Some(pb::Subject::default()),
                ..pb::DistanceRequest::default()
            })),
        ],
        ..pb::BatchRequest::default()
    };
    let response = bench.questions.batch(request).await.unwrap().into_inner();
    assert_eq!(response.info.unwrap().tick, 2);
    let answers: Vec<_> = response
        .answers
        .into_iter()
        .map(|answer| answer.answer.unwrap())
        .collect();
    assert!(matches!(&answers[0], Answer::Raycast(found) if found.hits.len() == 1 && found.info.is_none()));
    let problems = [
        (1, "questions[1].raycast.direction", "MISSING"),
        (2, "questions[2].question", "MISSING"),
        (3, "questions[3].raycast.session", "OUT_OF_LIMITS"),
        (4, "questions[4].raycast.options.read_at", "OUT_OF_LIMITS"),
        (5, "", "NOT_YET"),
    ];
    for (index, field, reason) in problems {
        let Answer::Problem(problem) = &answers[index] else {
            panic!("answer {index} is {:?}", answers[index]);
        };
        assert_eq!((problem.field.as_str(), problem.reason.as_str()), (field, reason));
        assert!(!problem.message.is_empty());
    }
    assert!(matches!(&answers[6], Answer::Distance(found) if found.hits[0].id == 1));
}

#[tokio::test]
async fn a_batch_gives_the_same_answers_as_single_questions_and_items_override_its_options() {
    let mut bench = readme_world().await;
    let exclude = |ids: &[u64]| pb::QueryOptions {
        filter: Some(pb::Filter {
            exclude_ids: ids.to_vec(),
            ..pb::Filter::default()
        }),
        ..pb::QueryOptions::default()
    };
    let overriding = pb::RaycastRequest {
        options: Some(exclude(&[7])),
        ..ray_along_z()
    };
    let single = bench.questions.raycast(ray_along_z()).await.unwrap().into_inner();
    let questions = [ray_along_z(), overriding].map(|ray| pb::Question {
        question: Some(Question::Raycast(ray)),
    });
    let request = pb::BatchRequest {
        questions: questions.to_vec(),
        options: Some(exclude(&[1])),
        ..pb::BatchRequest::default()
    };
    let response = bench.questions.batch(request).await.unwrap().into_inner();
    let hits: Vec<_> = response
        .answers
        .into_iter()
        .map(|answer| match answer.answer {
            Some(Answer::Raycast(found)) => found.hits,
            other => panic!("{other:?}"),
        })
        .collect();
    assert!(hits[0].is_empty(), "the batch excludes shape 1");
    assert_eq!(hits[1], single.hits, "the item excludes another one instead");
}

#[tokio::test]
async fn versions_that_are_not_held_are_refused_with_the_ones_that_are() {
    let mut bench = readme_world().await;
    let mut ask = async |at: pb::ReadAt| {
        let request = pb::RaycastRequest {
            options: Some(pb::QueryOptions {
                read_at: Some(at),
                ..pb::QueryOptions::default()
            }),
            ..ray_along_z()
        };
        bench.questions.raycast(request).await
    };
    let whole = |at| pb::ReadAt {
        at: Some(at),
        tick_fraction: 0.0,
    };
    assert_eq!(
        ask(whole(At::Tick(2))).await.unwrap().into_inner().info.unwrap().tick,
        2
    );
    for tick in [1, 3] {
        let status = ask(whole(At::Tick(tick))).await.unwrap_err();
        let parts = ["oldest and newest are 2"];
        assert_refused(
            &status,
            Code::OutOfRange,
            "TICK_NOT_HELD",
            "options.read_at.tick",
            &parts,
        );
    }
    let fraction = pb::ReadAt {
        at: Some(At::Tick(2)),
        tick_fraction: 0.5,
    };
    let status = ask(fraction).await.unwrap_err();
    assert_refused(
        &status,
        Code::OutOfRange,
        "TICK_NOT_HELD",
        "options.read_at.tick_fraction",
        &[],
    );
    let alone = pb::ReadAt {
        at: None,
        tick_fraction: 0.5,
    };
    let status = ask(alone).await.unwrap_err();
    assert_refused(
        &status,
        Code::InvalidArgument,
        "OUT_OF_LIMITS",
        "options.read_at.tick_fraction",
        &[],
    );
    let status = ask(whole(At::Tick(0))).await.unwrap_err();
    assert_refused(
        &status,
        Code::InvalidArgument,
        "OUT_OF_LIMITS",
        "options.read_at.tick",
        &["begin at 1"],
    );
    let long_ago = prost_types::Timestamp { seconds: 0, nanos: 0 };
    let status = ask(whole(At::Time(long_ago))).await.unwrap_err();
    assert_refused(&status, Code::OutOfRange, "TICK_NOT_HELD", "options.read_at.time", &[]);
    let far_on = prost_types::Timestamp {
        seconds: 9_000_000_000,
        nanos: 0,
    };
    assert_eq!(
        ask(whole(At::Time(far_on)))
            .await
            .unwrap()
            .into_inner()
            .info
            .unwrap()
            .tick,
        2
    );
}

#[tokio::test]
async fn min_tick_waits_for_the_tick_and_not_beyond_the_deadline() {
    let mut bench = readme_world().await;
    let waiting = pb::RaycastRequest {
        options: Some(read_at(At::MinTick(3))),
        ..ray_along_z()
    };
    let mut late = tonic::Request::new(waiting.clone());
    late.set_timeout(Duration::from_millis(100));
    let status = bench.questions.raycast(late).await.unwrap_err();
    assert_eq!(status.code(), Code::DeadlineExceeded, "{status}");
    let mut questions = bench.questions.clone();
    let asked = tokio::spawn(async move { questions.raycast(waiting).await });
    tokio::time::sleep(Duration::from_millis(50)).await;
    assert!(!asked.is_finished());
    bench.edit(Vec::new()).await.unwrap();
    let answer = asked.await.unwrap().unwrap().into_inner();
    assert_eq!(answer.info.unwrap().tick, 3);
}

#[tokio::test]
async fn no_number_in_any_answer_is_nan_infinite_or_a_negative_zero() {
    let mut bench = readme_world().await;
    let request = pb::PenetrationRequest {
        subject: Some(subject(sphere(1.0), at(0.0, 0.0, 5.0))),
        ..pb::PenetrationRequest::default()
    };
    let answer = bench.questions.penetration(request).await.unwrap().into_inner();
    let text = format!("{answer:?}");
    for bad in ["NaN", " inf,", "(inf)", "-inf", "-0.0,", "-0.0 ", "-0.0)"] {
        assert!(!text.contains(bad), "{bad} in {text}");
    }
}
