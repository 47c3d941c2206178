//! Who is left out at "now" while the past is read, and one against one, for every kind of question.

use wire::v1::{self as pb, answer::Answer, question::Question, read_at::At};

use crate::harness::{
    Bench, assert_refused, at, insert, ray_along_z, read_at, remove, shape, sphere, subject, subject_shape,
};

/// At tick 2 shooter 1 stands at the origin, target 2 at z = 5 and bystander 3 at z = 9; at tick 3 the shooter is gone.
async fn duel() -> Bench {
    let mut bench = Bench::start().await;
    let ball = |id, z| insert(shape(id, sphere(1.0), at(0.0, 0.0, z)));
    bench.edit(vec![ball(1, 0.0), ball(2, 5.0), ball(3, 9.0)]).await.unwrap();
    bench.edit(vec![remove(&[1])]).await.unwrap();
    bench
}

/// A question of each kind, from where the shooter stands towards the others.
fn questions(against: Option<Box<pb::Subject>>, options: Option<Box<pb::QueryOptions>>) -> Vec<Question> {
    let muzzle = || Some(subject(sphere(0.5), at(0.0, 0.0, 0.0)));
    let all_in_reach = || Some(subject(sphere(4.5), at(0.0, 0.0, 0.0)));
    vec![
        Question::Raycast(pb::RaycastRequest { against: against.clone(), options: options.clone(), ..ray_along_z() }),
        Question::TimeOfImpact(Box::new(pb::TimeOfImpactRequest {
            subject: muzzle(),
            end: Some(at(0.0, 0.0, 16.0)),
            against: against.clone(),
            options: options.clone(),
            ..Default::default()
        })),
        Question::Distance(Box::new(pb::DistanceRequest {
            subject: muzzle(),
            against: against.clone(),
            options: options.clone(),
            ..Default::default()
        })),
        Question::Overlap(Box::new(pb::OverlapRequest {
            subject: all_in_reach(),
            against: against.clone(),
            options: options.clone(),
            ..Default::default()
        })),
        Question::Penetration(Box::new(pb::PenetrationRequest {
            subject: all_in_reach(),
            against: against.clone(),
            options: options.clone(),
            ..Default::default()
        })),
        Question::Depenetrate(Box::new(pb::DepenetrateRequest {
            subject: all_in_reach(),
            against,
            options,
            ..Default::default()
        })),
    ]
}

/// The first shape that each answer names.
async fn named(bench: &mut Bench, questions: Vec<Question>, options: Option<Box<pb::QueryOptions>>) -> Vec<u64> {
    let questions = questions.into_iter().map(|question| pb::Question { question: Some(question) }).collect();
    let batch = pb::BatchRequest { questions, options, ..Default::default() };
    let answers = bench.questions.batch(batch).await.unwrap().into_inner().answers;
    let first = answers.into_iter().map(|answer| match answer.answer.unwrap() {
        Answer::Raycast(found) => found.hits.last().map(|hit| hit.id),
        Answer::TimeOfImpact(found) => found.hits.last().map(|hit| hit.id),
        Answer::Distance(found) => found.hits.first().map(|hit| hit.id),
        Answer::Overlap(found) => found.hits.first().map(|hit| hit.id),
        Answer::Penetration(found) => found.contacts.first().map(|contact| contact.id),
        Answer::Depenetrate(out) => out.ids.first().copied(),
        other => panic!("{other:?}"),
    });
    first.map(|id| id.unwrap_or(0)).collect()
}

fn excluding(ids: &[u64]) -> pb::Filter {
    pb::Filter { exclude_ids: ids.to_vec(), ..pb::Filter::default() }
}

#[tokio::test]
async fn the_shooters_own_body_is_left_out_of_the_past_be_it_gone_since() {
    let mut bench = duel().await;
    let then = |ids: &[u64]| Some(Box::new(pb::QueryOptions { filter: Some(excluding(ids)), ..read_at(At::Tick(2)) }));
    assert_eq!(named(&mut bench, questions(None, None), then(&[])).await, [1; 6], "its body was in the way");
    assert_eq!(named(&mut bench, questions(None, None), then(&[1])).await, [2; 6]);
    // Each question has exclusions of its own; nobody is there at tick 3 to be left out.
    let own = Some(Box::new(pb::QueryOptions { filter: Some(excluding(&[1, 2])), ..pb::QueryOptions::default() }));
    assert_eq!(named(&mut bench, questions(None, own.clone()), then(&[1])).await, [3, 3, 3, 0, 0, 0]);
    assert_eq!(named(&mut bench, questions(None, None), None).await, [2; 6]);
    let columns = pb::RaycastBatchRequest {
        directions: vec![0.0, 0.0, 1.0],
        ignore_ids: vec![0, 1],
        options: then(&[]),
        ..Default::default()
    };
    let hits = bench.questions.raycast_batch(columns).await.unwrap().into_inner().hits.unwrap();
    assert_eq!(hits.ids, [1, 2]);
}

#[tokio::test]
async fn every_kind_can_be_asked_of_one_against_one_whatever_the_filter_says() {
    let mut bench = duel().await;
    let options =
        |ids: &[u64]| Some(Box::new(pb::QueryOptions { filter: Some(excluding(ids)), ..read_at(At::Tick(2)) }));
    let shape = |id| Some(Box::new(subject_shape(id)));
    assert_eq!(named(&mut bench, questions(shape(2), None), options(&[2])).await, [2; 6]);
    assert_eq!(named(&mut bench, questions(shape(3), None), options(&[])).await, [3, 3, 3, 0, 0, 0]);
    // Shape 1 where it was not, and a form that is no shape: 0 in answers.
    let elsewhere = pb::Subject { pose: Some(at(0.0, 0.0, 5.0)), ..subject_shape(1) };
    assert_eq!(named(&mut bench, questions(Some(Box::new(elsewhere)), None), options(&[])).await, [1; 6]);
    let form = pb::RaycastRequest { against: Some(Box::new(subject(sphere(1.0), at(0.0, 0.0, 5.0)))), ..ray_along_z() };
    let found = bench.questions.raycast(form.clone()).await.unwrap().into_inner();
    assert_eq!((found.hits[0].id, found.hits[0].distance, found.verdict()), (0, Some(4.0), pb::Verdict::Hit));
    let short = pb::RaycastRequest { max_distance: Some(3.0), ..form };
    let found = bench.questions.raycast(short).await.unwrap().into_inner();
    assert_eq!((found.verdict(), found.hits.len()), (pb::Verdict::Miss, 0));
    let gone = pb::RaycastRequest { against: shape(9), ..ray_along_z() };
    let status = bench.questions.raycast(gone).await.unwrap_err();
    assert_refused(&status, tonic::Code::NotFound, "SHAPE_NOT_FOUND", "against.id", &["9"]);
}
