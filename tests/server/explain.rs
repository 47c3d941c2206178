//! A question that is asked to explain itself says what it did, pair by pair, and answers the same.

use wire::v1::{self as pb, answer::Answer as Kind, question::Question as Asked};

use crate::harness::{Bench, at, cuboid, geometry, insert, shape, sphere, subject, vec3};

fn explaining() -> Option<Box<pb::QueryOptions>> {
    Some(Box::new(pb::QueryOptions { explain: true, ..pb::QueryOptions::default() }))
}

/// Balls 1 to 20 in a row along x, a metre apart, and a box 100 under all.
async fn row() -> Bench {
    let mut bench = Bench::start().await;
    let balls = (1..=20).map(|id| insert(shape(id, sphere(0.4), at(id as f64, 0.0, 0.0))));
    let floor = insert(shape(100, cuboid(50.0, 0.5, 50.0), at(0.0, -0.9, 0.0)));
    bench.edit(balls.chain([floor]).collect()).await.unwrap();
    bench
}

/// One question of each kind, which looks at several shapes.
pub(crate) fn questions() -> Vec<Asked> {
    let ball = |x: f64| Some(subject(sphere(1.2), at(x, 0.0, 0.0)));
    vec![
        Asked::Raycast(pb::RaycastRequest {
            direction: Some(vec3(1.0, 0.05, 0.0)),
            mode: pb::HitMode::All.into(),
            ..pb::RaycastRequest::default()
        }),
        Asked::Overlap(Box::new(pb::OverlapRequest { subject: ball(5.0), ..pb::OverlapRequest::default() })),
        Asked::Penetration(Box::new(pb::PenetrationRequest {
            subject: ball(5.0),
            ..pb::PenetrationRequest::default()
        })),
        Asked::TimeOfImpact(Box::new(pb::TimeOfImpactRequest {
            subject: Some(subject(sphere(0.2), at(-3.0, 0.3, 0.0))),
            end: Some(at(9.0, 0.3, 0.0)),
            mode: pb::HitMode::All.into(),
            ..pb::TimeOfImpactRequest::default()
        })),
        Asked::Distance(Box::new(pb::DistanceRequest {
            subject: ball(5.0),
            max_hits: 3,
            ..pb::DistanceRequest::default()
        })),
        Asked::MoveCharacter(Box::new(pb::MoveCharacterRequest {
            subject: Some(subject(sphere(0.3), at(-3.0, 0.5, 0.0))),
            translation: Some(vec3(6.0, -1.0, 0.0)),
            ..pb::MoveCharacterRequest::default()
        })),
        Asked::Depenetrate(Box::new(pb::DepenetrateRequest {
            subject: ball(5.0),
            ..pb::DepenetrateRequest::default()
        })),
        Asked::Resolve(Box::new(pb::ResolveRequest {
            bodies: [8, 6].map(|id| pb::Body { id, mass: 2.0, ..pb::Body::default() }).into(),
            ..pb::ResolveRequest::default()
        })),
        Asked::Pairs(Box::default()),
    ]
}

pub(crate) fn options_of(asked: &mut Asked) -> &mut Option<Box<pb::QueryOptions>> {
    match asked {
        Asked::Raycast(it) => &mut it.options,
        Asked::Overlap(it) => &mut it.options,
        Asked::Penetration(it) => &mut it.options,
        Asked::TimeOfImpact(it) => &mut it.options,
        Asked::Distance(it) => &mut it.options,
        Asked::MoveCharacter(it) => &mut it.options,
        Asked::FirstTouch(it) => &mut it.options,
        Asked::Depenetrate(it) => &mut it.options,
        Asked::Resolve(it) => &mut it.options,
        Asked::Pairs(it) => &mut it.options,
    }
}

fn info_of(answer: &mut Kind) -> &mut Option<pb::AnswerInfo> {
    match answer {
        Kind::Raycast(it) => &mut it.info,
        Kind::Overlap(it) => &mut it.info,
        Kind::Penetration(it) => &mut it.info,
        Kind::TimeOfImpact(it) => &mut it.info,
        Kind::Distance(it) => &mut it.info,
        Kind::MoveCharacter(it) => &mut it.info,
        Kind::FirstTouch(it) => &mut it.info,
        Kind::Depenetrate(it) => &mut it.info,
        Kind::Resolve(it) => &mut it.info,
        Kind::Pairs(it) => &mut it.info,
        Kind::Problem(problem) => panic!("{problem:?}"),
    }
}

pub(crate) async fn ask(bench: &mut Bench, asked: Asked) -> Kind {
    let question = pb::Question { question: Some(asked) };
    let request = pb::BatchRequest { questions: vec![question], ..pb::BatchRequest::default() };
    let answers = bench.questions.batch(request).await.unwrap().into_inner().answers;
    answers.into_iter().next().and_then(|answer| answer.answer).expect("an answer")
}

#[tokio::test]
async fn every_question_tells_its_pairs_and_answers_the_same() {
    let mut bench = row().await;
    for mut asked in questions() {
        let mut plain = ask(&mut bench, asked.clone()).await;
        assert_eq!(*info_of(&mut plain), None, "nothing is told unless it is asked for");
        *options_of(&mut asked) = explaining();
        let mut told = ask(&mut bench, asked.clone()).await;
        let info = info_of(&mut told).take().expect("an account");
        assert_eq!(told, plain, "explaining changes no answer");

        let work = info.work.expect("counts");
        assert_eq!(info.pairs.len() as u64, work.shapes_tested, "{asked:?}");
        assert_eq!(info.pairs_left_out, 0);
        assert!(info.pairs.len() > 1, "vacuous: {asked:?}");
        let spent: u64 = info.pairs.iter().map(|pair| pair.work.unwrap().iterations).sum();
        assert_eq!(spent, work.iterations, "{asked:?}");
        for pair in &info.pairs {
            let certificate = pair.certificate.as_ref().expect("what is proved");
            let is_about_shapes = matches!(asked, Asked::Resolve(_) | Asked::Pairs(_));
            assert!(pair.id != 0 && pair.item == 0, "{pair:?}");
            assert_eq!(pair.subject_id != 0, is_about_shapes, "{pair:?}");
            let is_hit = certificate.verdict() != pb::Verdict::Miss;
            let has_method = certificate.method() != pb::Method::Unspecified;
            assert!(has_method || !is_hit, "{pair:?}");
            assert_eq!(has_method, certificate.interval.is_some(), "{pair:?}");
        }
    }
}

/// Of the shapes of the world the subject is told by its id; of two that are apart, how far.
#[tokio::test]
async fn a_pair_names_both_shapes_its_method_and_what_is_proved() {
    let mut bench = row().await;
    let request = pb::DistanceRequest {
        subject: Some(crate::harness::subject_shape(7)),
        against: Some(Box::new(crate::harness::subject_shape(9))),
        max_distance: Some(0.5),
        options: explaining(),
        ..pb::DistanceRequest::default()
    };
    let answer = bench.questions.distance(request).await.unwrap().into_inner();
    assert_eq!(answer.verdict(), pb::Verdict::Miss);
    let [pair] = answer.info.unwrap().pairs.try_into().expect("one pair");
    assert_eq!((pair.subject_id, pair.id), (7, 9));
    let certificate = pair.certificate.unwrap();
    assert_eq!(certificate.verdict(), pb::Verdict::Miss);
    let interval = certificate.interval.unwrap();
    assert!(interval.lower.unwrap() <= 1.2 && interval.upper.unwrap() >= 1.2, "{interval:?}");
    assert_eq!(certificate.method(), pb::Method::ClosedForm);
    assert_eq!(certificate.representation(), pb::Representation::Exact);
}

#[tokio::test]
async fn batches_of_columns_name_the_item_and_pairs_name_both() {
    let mut bench = row().await;
    let request = pb::OverlapBatchRequest {
        geometry: Some(sphere(0.7)),
        poses: Some(pb::PoseColumns {
            positions: vec![1.5, 0.0, 0.0, 90.0, 0.0, 0.0, 3.5, 0.0, 0.0],
            ..Default::default()
        }),
        options: explaining(),
        ..pb::OverlapBatchRequest::default()
    };
    let info = bench.questions.overlap_batch(request).await.unwrap().into_inner().info.unwrap();
    let told: Vec<(u32, u64)> =
        info.pairs.iter().map(|pair| (pair.item, pair.id)).filter(|told| told.1 != 100).collect();
    let mut sorted = told.clone();
    sorted.sort_unstable();
    assert_eq!(sorted, [(0, 1), (0, 2), (2, 3), (2, 4)], "{told:?}");

    let request = pb::PairsRequest { options: explaining(), ..pb::PairsRequest::default() };
    let mut stream = bench.questions.pairs(request).await.unwrap().into_inner();
    let info = stream.message().await.unwrap().unwrap().info.unwrap();
    assert_eq!(info.pairs.len(), 20, "each ball and the box");
    assert!(info.pairs.iter().all(|pair| pair.subject_id < 100 && pair.id == 100), "{info:?}");
}

#[tokio::test]
async fn no_more_than_256_pairs_are_told_and_the_rest_is_counted() {
    let mut bench = Bench::start().await;
    let points =
        (1..=300).map(|id| insert(shape(id, geometry(pb::geometry::Kind::Point(pb::Point {})), at(0.0, 0.0, 0.0))));
    bench.edit(points.collect()).await.unwrap();
    let request = pb::OverlapRequest {
        subject: Some(subject(sphere(1.0), at(0.0, 0.0, 0.0))),
        options: explaining(),
        ..pb::OverlapRequest::default()
    };
    let answer = bench.questions.overlap(request).await.unwrap().into_inner();
    assert_eq!(answer.hits.len(), 300);
    let info = answer.info.unwrap();
    assert_eq!((info.pairs.len(), info.pairs_left_out), (256, 44));

    let request = pb::OverlapBatchRequest {
        geometry: Some(sphere(1.0)),
        poses: Some(pb::PoseColumns { positions: vec![0.0; 6], ..Default::default() }),
        max_hits_each: 1000,
        options: explaining(),
        ..pb::OverlapBatchRequest::default()
    };
    let info = bench.questions.overlap_batch(request).await.unwrap().into_inner().info.unwrap();
    assert_eq!((info.pairs.len(), info.pairs_left_out), (256, 344));
}
