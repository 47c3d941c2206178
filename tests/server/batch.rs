//! Batches: one tick, each item by itself, and the same answers as single questions.

use wire::v1::{self as pb, answer::Answer, question::Question, read_at::At};

use crate::harness::{ray_along_z, read_at, readme_world};

#[tokio::test]
async fn a_batch_is_answered_on_one_tick_and_fails_item_by_item() {
    let mut bench = readme_world().await;
    let question = |question| pb::Question { question: Some(question) };
    let named = pb::RaycastRequest { session: "default".to_owned(), ..ray_along_z() };
    let pinned = pb::RaycastRequest { options: Some(Box::new(read_at(At::Tick(2)))), ..ray_along_z() };
    let request = pb::BatchRequest {
        questions: vec![
            question(Question::Raycast(ray_along_z())),
            question(Question::Raycast(pb::RaycastRequest::default())),
            pb::Question::default(),
            question(Question::Raycast(named)),
            question(Question::Raycast(pinned)),
            question(Question::MoveCharacter(Box::default())),
            question(Question::Distance(Box::new(pb::DistanceRequest {
                subject: Some(pb::Subject::default()),
                ..pb::DistanceRequest::default()
            }))),
        ],
        ..pb::BatchRequest::default()
    };
    let response = bench.questions.batch(request).await.unwrap().into_inner();
    assert_eq!(response.info.unwrap().tick, 2);
    let answers: Vec<_> = response.answers.into_iter().map(|answer| answer.answer.unwrap()).collect();
    assert!(matches!(&answers[0], Answer::Raycast(found) if found.hits.len() == 1 && found.info.is_none()));
    let problems = [
        (1, "questions[1].raycast.direction", "MISSING"),
        (2, "questions[2].question", "MISSING"),
        (3, "questions[3].raycast.session", "OUT_OF_LIMITS"),
        (4, "questions[4].raycast.options.read_at", "OUT_OF_LIMITS"),
        (5, "questions[5].move_character.subject", "MISSING"),
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
        filter: Some(pb::Filter { exclude_ids: ids.to_vec(), ..pb::Filter::default() }),
        ..pb::QueryOptions::default()
    };
    let overriding = pb::RaycastRequest { options: Some(Box::new(exclude(&[7]))), ..ray_along_z() };
    let single = bench.questions.raycast(ray_along_z()).await.unwrap().into_inner();
    let questions = [ray_along_z(), overriding].map(|ray| pb::Question { question: Some(Question::Raycast(ray)) });
    let request = pb::BatchRequest {
        questions: questions.to_vec(),
        options: Some(Box::new(exclude(&[1]))),
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

/// Rays in a row are asked together, which shows in nothing: not in answers, nor problems, nor counts.
#[tokio::test]
async fn many_rays_of_a_batch_answer_as_each_does_alone() {
    let mut bench = readme_world().await;
    let ray = |number: u32| {
        let lean = f64::from(number) * 0.004 - 0.4;
        let direction = Some(pb::Vec3 { x: lean, y: 0.0, z: 1.0 });
        let explain = number == 50;
        let options = explain.then(|| Box::new(pb::QueryOptions { explain, ..pb::QueryOptions::default() }));
        match number {
            100 => pb::RaycastRequest::default(),
            _ => pb::RaycastRequest { direction, options, ..pb::RaycastRequest::default() },
        }
    };
    let questions = (0..200).map(|number| pb::Question { question: Some(Question::Raycast(ray(number))) }).collect();
    let asked_before = bench.describe().await.question_count;
    let request = pb::BatchRequest { questions, ..pb::BatchRequest::default() };
    let answers = bench.questions.batch(request).await.unwrap().into_inner().answers;
    assert_eq!(bench.describe().await.question_count - asked_before, 199, "the wrong one is not answered");
    let (mut hits, mut misses) = (0, 0);
    for (number, answer) in (0..).zip(answers) {
        match answer.answer.unwrap() {
            Answer::Raycast(told) => {
                let alone = bench.questions.raycast(ray(number)).await.unwrap().into_inner();
                assert_eq!((told.verdict, &told.hits), (alone.verdict, &alone.hits), "ray {number}");
                assert_eq!(told.info.is_some(), number == 50);
                hits += told.hits.len();
                misses += usize::from(told.hits.is_empty());
            }
            Answer::Problem(problem) => {
                assert_eq!((number, problem.field.as_str()), (100, "questions[100].raycast.direction"));
            }
            other => panic!("{other:?}"),
        }
    }
    assert!(hits > 20 && misses > 20, "vacuous: {hits} hits, {misses} misses");
}
