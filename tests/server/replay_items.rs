//! An item of a call with columns is explained as the single question that it stands for, and answers as the item did.

use calipers::replay::{ask_again, bare, info_of};
use tonic::Code;
use wire::v1::{self as pb, answer::Answer as Kind, column_item::Call};

use crate::{
    harness::{Bench, assert_refused, sphere, vec3},
    replays::zoo,
};

async fn explain(bench: &mut Bench, call: Call, index: usize) -> Result<pb::Replay, tonic::Status> {
    let item = Some(Box::new(pb::ColumnItem { index: index as u32, call: Some(call) }));
    let answered = bench.worlds.explain(pb::ExplainRequest { item, ..pb::ExplainRequest::default() }).await?;
    let replay = answered.into_inner().replay.unwrap();
    let again = ask_again(&replay).unwrap();
    assert_eq!(bare(again.clone()), bare(replay.answer.clone().unwrap()), "{:?}", replay.question);
    assert!(info_of(&again).is_some());
    Ok(replay)
}

/// The verdict of an answer, and the id and value of its first hit.
fn told(replay: &pb::Replay) -> (i32, u64, Option<f64>) {
    match replay.answer.as_ref().unwrap().answer.as_ref().unwrap() {
        Kind::Raycast(it) => {
            let hit = it.hits.first();
            (it.verdict, hit.map_or(0, |hit| hit.id), hit.and_then(|hit| hit.distance))
        }
        Kind::TimeOfImpact(it) => {
            let hit = it.hits.first();
            (it.verdict, hit.map_or(0, |hit| hit.id), hit.and_then(|hit| hit.fraction))
        }
        Kind::Distance(it) => {
            let hit = it.hits.first();
            (it.verdict, hit.map_or(0, |hit| hit.id), hit.and_then(|hit| hit.distance))
        }
        other => panic!("{other:?}"),
    }
}

/// Checks each item's explanation against the columns; there is a hit and a miss among them.
async fn check(bench: &mut Bench, call: Call, hits: &pb::HitColumns) {
    for index in 0..hits.verdicts.len() {
        let replay = explain(bench, call.clone(), index).await.unwrap();
        let (verdict, id, value) = told(&replay);
        assert_eq!((verdict, id), (hits.verdicts[index], hits.ids[index]), "item {index} of {call:?}");
        if let Some(value) = value {
            assert_eq!(value as f32, hits.values[index], "item {index} of {call:?}");
        }
    }
    let has = |verdict: pb::Verdict| hits.verdicts.contains(&verdict.into());
    assert!(has(pb::Verdict::Hit) && has(pb::Verdict::Miss), "vacuous: {hits:?}");
}

#[tokio::test]
async fn rays_ways_and_places_are_explained_item_by_item() {
    let mut bench = zoo().await;
    let frame_origin = Some(vec3(-3.0, 0.25, 0.1));
    let rays = pb::RaycastBatchRequest {
        frame_origin,
        directions: vec![1.0, 0.01, 0.0, 1.0, 0.01, 0.0, 0.0, 1.0, 0.0],
        max_distances: vec![20.0],
        ignore_ids: vec![0, 8, 0],
        ..pb::RaycastBatchRequest::default()
    };
    let hits = bench.questions.raycast_batch(rays.clone()).await.unwrap().into_inner().hits.unwrap();
    assert_ne!(hits.ids[0], hits.ids[1], "what is not seen is no hit");
    check(&mut bench, Call::RaycastBatch(Box::new(rays)), &hits).await;

    let columns = |positions: &[f32]| {
        Some(pb::PoseColumns { frame_origin, positions: positions.to_vec(), rotations: Vec::new() })
    };
    let ways = pb::TimeOfImpactBatchRequest {
        geometry: Some(sphere(0.2)),
        starts: columns(&[0.0, 0.0, 0.0]),
        ends: columns(&[9.0, 0.0, 0.0, 0.0, 9.0, 0.0]),
        ..pb::TimeOfImpactBatchRequest::default()
    };
    let hits = bench.questions.time_of_impact_batch(ways.clone()).await.unwrap().into_inner().hits.unwrap();
    check(&mut bench, Call::TimeOfImpactBatch(Box::new(ways)), &hits).await;

    let places = pb::DistanceBatchRequest {
        geometry: Some(sphere(0.2)),
        poses: columns(&[0.0, 0.0, 0.0, 0.0, 300.0, 0.0]),
        max_distances: vec![9.0, 5.0],
        ..pb::DistanceBatchRequest::default()
    };
    let hits = bench.questions.distance_batch(places.clone()).await.unwrap().into_inner().hits.unwrap();
    check(&mut bench, Call::DistanceBatch(Box::new(places)), &hits).await;
}

#[tokio::test]
async fn overlaps_are_explained_at_the_scale_of_their_place() {
    let mut bench = zoo().await;
    let places = pb::OverlapBatchRequest {
        geometry: Some(sphere(0.5)),
        poses: Some(pb::PoseColumns { positions: vec![3.0, 0.5, 0.0], ..pb::PoseColumns::default() }),
        scales: vec![0.1, 1.0, 4.0],
        ..pb::OverlapBatchRequest::default()
    };
    let answer = bench.questions.overlap_batch(places.clone()).await.unwrap().into_inner();
    let mut counts = Vec::new();
    for (index, ends) in answer.offsets.windows(2).enumerate() {
        let replay = explain(&mut bench, Call::OverlapBatch(Box::new(places.clone())), index).await.unwrap();
        let Some(Kind::Overlap(told)) = replay.answer.unwrap().answer else { panic!("an overlap") };
        let ids: Vec<u64> = told.hits.iter().map(|hit| hit.id).collect();
        assert_eq!(ids, answer.ids[ends[0] as usize..ends[1] as usize], "item {index}");
        counts.push(ids.len());
    }
    assert!(counts.len() == 3 && counts[0] < counts[2], "vacuous: {counts:?}");
}

#[tokio::test]
async fn a_sight_is_explained_as_the_ray_that_it_is() {
    let mut bench = zoo().await;
    let mut sensor = crate::harness::shape(30, sphere(0.5), crate::harness::at(-3.0, 5.0, 0.0));
    sensor.sensor = true;
    bench.edit(vec![crate::harness::insert(sensor)]).await.unwrap();
    let sights = pb::LineOfSightRequest {
        eyes: vec![-3.0, 0.2, 0.0, 2.0, 0.2, 0.0],
        points: vec![1.0, 0.2, 0.0, 9.0, 0.2, 0.0, -3.0, 9.0, 0.0],
        offsets: vec![0, 2, 3],
        eye_ids: vec![0, 8],
        want_points: true,
        ..pb::LineOfSightRequest::default()
    };
    let seen = bench.questions.line_of_sight(sights.clone()).await.unwrap().into_inner();
    for (index, &point) in seen.points.iter().enumerate() {
        let replay = explain(&mut bench, Call::LineOfSight(Box::new(sights.clone())), index).await.unwrap();
        let is_hidden = told(&replay).0 == i32::from(pb::Verdict::Hit);
        let expected = if is_hidden { pb::Sight::Hidden } else { pb::Sight::Visible };
        assert_eq!(point, i32::from(expected), "item {index}");
    }
    let has = |sight: pb::Sight| seen.points.contains(&sight.into());
    assert!(seen.points.len() == 6 && has(pb::Sight::Hidden) && has(pb::Sight::Visible), "vacuous: {seen:?}");

    let near = pb::LineOfSightRequest { max_distances: vec![1.0], ..sights };
    let status = explain(&mut bench, Call::LineOfSight(Box::new(near)), 1).await.unwrap_err();
    let field = "item.line_of_sight.max_distances";
    assert_refused(&status, Code::InvalidArgument, "OUT_OF_LIMITS", field, &["before the point"]);
}

#[tokio::test]
async fn items_that_are_not_there_are_refused_by_name() {
    let mut bench = zoo().await;
    let rays = pb::RaycastBatchRequest { directions: vec![0.0, 0.0, 1.0], ..pb::RaycastBatchRequest::default() };
    let call = |rays: &pb::RaycastBatchRequest| Call::RaycastBatch(Box::new(rays.clone()));
    let status = explain(&mut bench, call(&rays), 1).await.unwrap_err();
    assert_refused(&status, Code::InvalidArgument, "OUT_OF_LIMITS", "item.index", &["is 1"]);
    let bent = pb::RaycastBatchRequest { directions: vec![0.0; 3], ..rays.clone() };
    let status = explain(&mut bench, call(&bent), 0).await.unwrap_err();
    let field = "item.raycast_batch.directions[0]";
    assert_refused(&status, Code::InvalidArgument, "OUT_OF_LIMITS", field, &["any length but 0"]);
    let elsewhere = pb::RaycastBatchRequest { session: "arena".to_owned(), ..rays };
    let status = explain(&mut bench, call(&elsewhere), 0).await.unwrap_err();
    assert_refused(&status, Code::InvalidArgument, "OUT_OF_LIMITS", "item.raycast_batch.session", &["beside the item"]);
    let item = Some(Box::new(pb::ColumnItem::default()));
    let status = bench.worlds.explain(pb::ExplainRequest { item, ..Default::default() }).await.unwrap_err();
    assert_refused(&status, Code::InvalidArgument, "MISSING", "item.call", &["raycast_batch"]);
}
