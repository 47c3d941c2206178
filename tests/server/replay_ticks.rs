//! A replay of a question about several ticks holds how the shapes went, and answers the same without its server.

use calipers::replay::ask_again;
use tonic::Code;
use wire::v1::{
    self as pb, answer::Answer as Kind, edit::Op, geometry::Kind as Form, question::Question as Asked, read_at::At,
};

use crate::{
    explain::{ask, options_of},
    first_touch::{flight, since},
    harness::{
        Bench, assert_refused, at, cuboid, geometry, insert, move_to, remove, shape, sphere, subject, subject_shape,
        vec3,
    },
    replays::{asked_again, explain},
};

/// Explains a question, checks that it answers as a plain one does and that its replay does too; and returns that.
async fn kept(bench: &mut Bench, asked: Asked) -> pb::Replay {
    let replay = explain(bench, asked.clone()).await;
    asked_again(&replay);
    if matches!(&asked, Asked::FirstTouch(_)) {
        let plain = pb::Answer { answer: Some(ask(bench, asked).await) };
        let told = replay.answer.clone().unwrap();
        match (&plain.answer, &told.answer) {
            // A batch says which of its questions it is.
            (Some(Kind::Problem(plain)), Some(Kind::Problem(told))) => assert_eq!(plain.reason, told.reason),
            _ => assert_eq!(calipers::replay::bare(told), calipers::replay::bare(plain)),
        }
    }
    replay
}

#[tokio::test]
async fn a_touch_of_the_past_is_kept_with_the_way_to_it() {
    let mut bench = flight().await;
    let against = |id| Some(Box::new(subject_shape(id)));
    let asked = [
        since(2),
        pb::FirstTouchRequest { against: against(3), ..since(2) },
        pb::FirstTouchRequest { against: against(2), ..since(2) },
        pb::FirstTouchRequest { to_tick: 4, ..since(2) },
        pb::FirstTouchRequest { subject: Some(subject(sphere(0.5), at(5.0, 0.0, 0.0))), ..since(2) },
        pb::FirstTouchRequest { against: against(9), ..since(2) },
    ];
    let mut reasons = Vec::new();
    for asked in asked {
        let replay = kept(&mut bench, asked.clone().into()).await;
        match &replay.answer.as_ref().unwrap().answer {
            Some(Kind::FirstTouch(_)) => {
                assert_eq!((replay.format, replay.earliest_tick, replay.ticks.len(), replay.tick), (2, 2, 4, 6));
            }
            Some(Kind::Problem(problem)) => reasons.push(problem.reason.clone()),
            other => panic!("{other:?}"),
        }
    }
    assert_eq!(reasons, ["SHAPE_NOT_FOUND"]);
}

/// A number from 0 to below 1.
fn unit(state: &mut u64) -> f64 {
    *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*state >> 11) as f64 / (1_u64 << 53) as f64
}

fn somewhere(state: &mut u64) -> pb::Pose {
    let mut number = |size: f64| (unit(state) - 0.5) * size;
    let place = at(number(8.0), number(8.0), number(8.0));
    let rotation = pb::Quat { x: number(1.0), y: number(1.0), z: number(1.0), w: number(1.0) };
    pb::Pose { rotation: Some(rotation), ..place }
}

/// Shapes 1 to `count` of several kinds, and ticks in which they move, jump, turn, change and go.
async fn traffic(count: u64, ticks: u64) -> Bench {
    let mut bench = Bench::start().await;
    let corners = vec![0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
    let request = pb::CreateGeometryRequest {
        geometry: Some(geometry(Form::Hull(pb::ConvexHull { points: corners }))),
        ..pb::CreateGeometryRequest::default()
    };
    let hull = bench.geometries.create_geometry(request).await.unwrap().into_inner().geometry.unwrap().geometry_id;
    let forms = [sphere(0.7), cuboid(0.4, 0.9, 0.6), geometry(Form::GeometryId(hull))];
    let mut state = 5;
    let first = (1..=count).map(|id| insert(shape(id, forms[id as usize % 2].clone(), somewhere(&mut state))));
    bench.edit(first.collect()).await.unwrap();
    for tick in 0..ticks {
        let mut edits = Vec::new();
        for id in 1..=count {
            let pose = somewhere(&mut state);
            match (unit(&mut state) * 10.0) as u32 {
                0..4 if id != 7 => {
                    let mut edit = move_to(id, pose);
                    let Some(Op::Move(moved)) = &mut edit.op else { panic!("{edit:?}") };
                    moved.teleport = unit(&mut state) < 0.2;
                    moved.velocity = (unit(&mut state) < 0.5).then(|| vec3(1.0, 0.0, unit(&mut state)));
                    edits.push(edit);
                }
                4 => edits.push(insert(shape(id, forms[(tick + id) as usize % 3].clone(), pose))),
                5 if id == 7 => edits.extend([remove(&[id]), insert(shape(id, forms[2].clone(), pose))]),
                _ => {}
            }
        }
        bench.edit(edits).await.unwrap();
    }
    bench
}

#[tokio::test]
async fn touches_and_changes_of_pairs_come_out_the_same_however_shapes_came_and_went() {
    let mut bench = traffic(24, 14).await;
    let (mut hits, mut late) = (0, 0);
    for id in 1..=24 {
        let asked =
            pb::FirstTouchRequest { subject: Some(subject_shape(id)), from_tick: 3, to_tick: 14, ..Default::default() };
        let replay = kept(&mut bench, asked.into()).await;
        let Some(Kind::FirstTouch(found)) = &replay.answer.as_ref().unwrap().answer else { panic!("{replay:?}") };
        hits += usize::from(found.verdict() == pb::Verdict::Hit);
        late += usize::from(found.hits.last().is_some_and(|hit| hit.impact.unwrap().fraction > Some(0.0)));
        assert_eq!((replay.earliest_tick, replay.ticks.len(), replay.tick), (3, 13, 16));
        assert!(replay.ticks[11..].iter().all(|tick| tick.edits.is_empty()), "what is not read is not kept");
    }
    assert!(hits > 10 && late > 3, "vacuous: {hits} hits, {late} on the way");

    for (tick, fraction) in [(16, 0.0), (11, 0.0), (11, 0.625), (5, 0.375)] {
        let mut asked = Asked::from(pb::PairsRequest { since_tick: Some(5), ..pb::PairsRequest::default() });
        let read_at = pb::ReadAt { at: Some(At::Tick(tick)), tick_fraction: fraction };
        *options_of(&mut asked) = Some(Box::new(pb::QueryOptions { read_at: Some(read_at), ..Default::default() }));
        let replay = kept(&mut bench, asked).await;
        let Some(Kind::Pairs(found)) = &replay.answer.as_ref().unwrap().answer else { panic!("{replay:?}") };
        assert!(found.changes.len() > 2, "vacuous: {found:?}");
        let count = (tick - 5) as usize + usize::from(fraction > 0.0);
        assert_eq!((replay.earliest_tick, replay.ticks.len(), replay.tick), (5, count, tick));
    }
    let same = pb::PairsRequest { since_tick: Some(16), ..pb::PairsRequest::default() };
    let replay = kept(&mut bench, same.into()).await;
    assert_eq!((replay.format, replay.earliest_tick, replay.ticks.len()), (1, 0, 0));
}

#[tokio::test]
async fn ticks_that_are_not_held_are_refused_and_wrong_ones_in_a_replay_named() {
    let mut bench = flight().await;
    let mut refused = async |asked: Asked| {
        let question = Some(pb::Question { question: Some(asked) });
        bench.worlds.explain(pb::ExplainRequest { question, ..Default::default() }).await.unwrap_err()
    };
    let status = refused(pb::FirstTouchRequest { to_tick: 9, ..since(2) }.into()).await;
    assert_refused(&status, Code::OutOfRange, "TICK_NOT_HELD", "question.first_touch.to_tick", &["is 9"]);
    let status = refused(pb::FirstTouchRequest { subject: None, ..since(2) }.into()).await;
    assert_refused(&status, Code::InvalidArgument, "MISSING", "question.first_touch.subject", &[]);
    let status = refused(pb::PairsRequest { since_tick: Some(9), ..pb::PairsRequest::default() }.into()).await;
    assert_refused(&status, Code::InvalidArgument, "OUT_OF_LIMITS", "question.pairs.since_tick", &["is 9"]);

    let replay = explain(&mut bench, since(2).into()).await;
    let mut wrong = replay.clone();
    wrong.ticks[1].edits.push(move_to(99, at(0.0, 0.0, 0.0)));
    let error = ask_again(&wrong).unwrap_err().to_string();
    assert!(error.contains("ticks[1].edits[") && error.contains("99"), "{error}");
    let error = ask_again(&pb::Replay { earliest_tick: 0, ..replay }).unwrap_err().to_string();
    assert!(error.contains("earliest_tick is 0"), "{error}");
}
