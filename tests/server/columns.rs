//! Questions as columns: they answer what the same questions answer one by one, and wrong columns are told by name.

use tonic::{Code, Status};
use wire::v1::{self as pb, answer::Answer as Kind, geometry::Kind as Form, question::Question as Asked};

use crate::harness::{
    Bench, Refusal, assert_invalid, assert_refused, cuboid, geometry, insert, shape, sphere, subject, vec3,
};

/// Where everything is: far enough out that singles alone would not do.
const FRAME: [f64; 3] = [1e6, -2e6, 3e5];

/// Some hundred shapes in a cube of 20 m around the frame's origin.
async fn crowd() -> Bench {
    let mut bench = Bench::start().await;
    let places = numbers(600, 9);
    let edits = (1..=200_u64).zip(0..).map(|(id, index)| {
        let form = if id % 2 == 0 { sphere(1.25) } else { cuboid(1.0, 0.75, 1.25) };
        insert(shape(id, form, pose_of(&places, index, TURNED)))
    });
    bench.edit(edits.collect()).await.unwrap();
    bench
}

/// Numbers from -10 to 10.
fn numbers(count: usize, seed: u64) -> Vec<f32> {
    let mut state = seed;
    let mut number = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 40) as f32 / (1 << 24) as f32 * 20.0 - 10.0
    };
    (0..count).map(|_| number()).collect()
}

fn origin() -> Option<pb::Vec3> {
    Some(vec3(FRAME[0], FRAME[1], FRAME[2]))
}

fn all_columns() -> Option<pb::ColumnChoice> {
    Some(pb::ColumnChoice { points: true, normals: true, features: true, intervals: true })
}

fn exact() -> Option<Box<pb::QueryOptions>> {
    let accuracy = Some(pb::Accuracy { tier: pb::Tier::Exact.into(), ..pb::Accuracy::default() });
    Some(Box::new(pb::QueryOptions { accuracy, ..pb::QueryOptions::default() }))
}

async fn one_by_one(bench: &mut Bench, questions: Vec<Asked>) -> Vec<Kind> {
    let questions = questions.into_iter().map(|question| pb::Question { question: Some(question) }).collect();
    let request = pb::BatchRequest { questions, options: exact(), ..pb::BatchRequest::default() };
    let answers = bench.questions.batch(request).await.unwrap().into_inner().answers;
    answers.into_iter().map(|answer| answer.answer.unwrap()).collect()
}

/// What one question answered, in the terms of columns.
struct Single {
    verdict: i32,
    id: u64,
    value: f64,
    point: pb::Vec3,
    normal: pb::Vec3,
    feature: pb::Feature,
    interval: pb::Interval,
}

/// Checks that columns say what single answers said; `None` is nothing hit. Returns how many hit.
fn assert_same(columns: &pb::HitColumns, singles: &[Option<Single>], none: f64) -> usize {
    assert_eq!(columns.verdicts.len(), singles.len());
    let place = |vector: &[f32], frame: [f64; 3]| {
        vec3(f64::from(vector[0]) + frame[0], f64::from(vector[1]) + frame[1], f64::from(vector[2]) + frame[2])
    };
    let near = |a: pb::Vec3, b: pb::Vec3| (a.x - b.x).abs() + (a.y - b.y).abs() + (a.z - b.z).abs() < 1e-5;
    let mut hits = 0;
    for (index, single) in singles.iter().enumerate() {
        let (value, id) = (f64::from(columns.values[index]), columns.ids[index]);
        let Some(single) = single else {
            assert_eq!((columns.verdicts[index], id, value), (pb::Verdict::Miss.into(), 0, f64::from(none as f32)));
            continue;
        };
        hits += 1;
        assert_eq!((columns.verdicts[index], id), (single.verdict, single.id), "item {index}");
        assert_eq!(columns.values[index], single.value as f32, "item {index}");
        assert!(near(place(&columns.points[3 * index..], FRAME), single.point), "item {index}");
        assert!(near(place(&columns.normals[3 * index..], [0.0; 3]), single.normal), "item {index}");
        assert_eq!(columns.faces[index], single.feature.face.unwrap_or(0), "item {index}");
        let (lower, upper) = (f64::from(columns.lower[index]), f64::from(columns.upper[index]));
        assert!(lower <= single.interval.lower.unwrap() && single.interval.upper.unwrap() <= upper, "item {index}");
        assert!(upper - lower <= columns.max_width && columns.max_width < 1e-4, "item {index}");
    }
    hits
}

#[tokio::test]
async fn rays_as_columns_answer_as_rays_one_by_one() {
    let mut bench = crowd().await;
    let (origins, directions) = (numbers(900, 1), numbers(900, 2));
    let vector = |numbers: &[f32], index: usize, frame: [f64; 3]| {
        let number = |axis: usize| f64::from(numbers[3 * index + axis]) + frame[axis];
        Some(vec3(number(0), number(1), number(2)))
    };
    let ray = |index| pb::RaycastRequest {
        origin: vector(&origins, index, FRAME),
        direction: vector(&directions, index, [0.0; 3]),
        max_distance: Some(6.0),
        hollow: true,
        ..pb::RaycastRequest::default()
    };
    let singles = one_by_one(&mut bench, (0..300).map(|index| Asked::Raycast(ray(index))).collect()).await;
    let singles = singles.into_iter().map(|answer| {
        let Kind::Raycast(answer) = answer else { panic!("{answer:?}") };
        answer.hits.into_iter().next().map(|hit| Single {
            verdict: answer.verdict,
            id: hit.id,
            value: hit.distance.unwrap(),
            point: hit.point.unwrap(),
            normal: hit.normal.unwrap_or_default(),
            feature: hit.feature.unwrap_or_default(),
            interval: hit.certificate.unwrap().interval.unwrap(),
        })
    });
    let singles: Vec<_> = singles.collect();
    let request = pb::RaycastBatchRequest {
        frame_origin: origin(),
        origins,
        directions,
        max_distances: vec![6.0],
        hollow: true,
        want: all_columns(),
        options: exact(),
        ..pb::RaycastBatchRequest::default()
    };
    let answer = bench.questions.raycast_batch(request.clone()).await.unwrap().into_inner();
    assert_eq!(answer.info.unwrap().tick, 2);
    let columns = answer.hits.unwrap();
    let hits = assert_same(&columns, &singles, 6.0);
    assert!((90..=210).contains(&hits), "{hits}");
    // Without wishes there are verdicts, ids and values alone.
    let bare = pb::RaycastBatchRequest { want: None, ..request.clone() };
    let bare = bench.questions.raycast_batch(bare).await.unwrap().into_inner().hits.unwrap();
    let expected = pb::HitColumns {
        points: vec![],
        normals: vec![],
        parts: vec![],
        faces: vec![],
        lower: vec![],
        upper: vec![],
        ..columns.clone()
    };
    assert_eq!(bare, expected);
    // A ray that does not see what it hit hits something else, or nothing.
    let blind = pb::RaycastBatchRequest { ignore_ids: columns.ids.clone(), ..request };
    let others = bench.questions.raycast_batch(blind).await.unwrap().into_inner().hits.unwrap();
    for index in 0..300 {
        let was_hit = columns.ids[index] != 0;
        assert!(!was_hit || others.ids[index] != columns.ids[index], "item {index}");
        assert!(others.values[index] >= columns.values[index], "item {index}");
    }
}

fn poses(positions: Vec<f32>, rotations: Vec<f32>) -> Option<pb::PoseColumns> {
    Some(pb::PoseColumns { frame_origin: origin(), positions, rotations })
}

fn pose_of(positions: &[f32], index: usize, rotation: [f32; 4]) -> pb::Pose {
    let number = |axis: usize| f64::from(positions[3 * index + axis]) + FRAME[axis];
    let [x, y, z, w] = rotation.map(f64::from);
    pb::Pose { position: Some(vec3(number(0), number(1), number(2))), rotation: Some(pb::Quat { x, y, z, w }) }
}

const TURNED: [f32; 4] = [0.25, 0.5, -0.125, 1.0];

#[tokio::test]
async fn distances_as_columns_answer_as_distances_one_by_one() {
    let mut bench = crowd().await;
    let positions = numbers(600, 3);
    let form = cuboid(0.25, 0.5, 0.75);
    let question = |index| {
        let subject = Some(subject(form.clone(), pose_of(&positions, index, TURNED)));
        Asked::Distance(Box::new(pb::DistanceRequest {
            subject,
            max_distance: Some(0.75),
            ..pb::DistanceRequest::default()
        }))
    };
    let singles = one_by_one(&mut bench, (0..200).map(question).collect()).await;
    let singles: Vec<_> = singles
        .into_iter()
        .map(|answer| {
            let Kind::Distance(answer) = answer else { panic!("{answer:?}") };
            answer.hits.into_iter().next().map(|hit| Single {
                verdict: answer.verdict,
                id: hit.id,
                value: hit.distance.unwrap(),
                point: hit.point_on_shape.unwrap(),
                normal: hit.normal.unwrap_or_default(),
                feature: hit.feature.unwrap_or_default(),
                interval: hit.certificate.unwrap().interval.unwrap(),
            })
        })
        .collect();
    let request = pb::DistanceBatchRequest {
        geometry: Some(form.clone()),
        poses: poses(positions, TURNED.to_vec()),
        max_distances: vec![0.75; 200],
        want: all_columns(),
        options: exact(),
        ..pb::DistanceBatchRequest::default()
    };
    let columns = bench.questions.distance_batch(request).await.unwrap().into_inner().hits.unwrap();
    let hits = assert_same(&columns, &singles, 0.75);
    assert!((60..=180).contains(&hits), "{hits}");
}

#[tokio::test]
async fn ways_as_columns_answer_as_ways_one_by_one() {
    let mut bench = crowd().await;
    let starts = numbers(600, 4);
    let ends: Vec<f32> = starts.iter().zip(numbers(600, 5)).map(|(start, way)| start + 0.25 * way).collect();
    let form = cuboid(0.25, 0.5, 0.25);
    let question = |index| {
        Asked::TimeOfImpact(Box::new(pb::TimeOfImpactRequest {
            subject: Some(subject(form.clone(), pose_of(&starts, index, [0.0, 0.0, 0.0, 1.0]))),
            end: Some(pose_of(&ends, index, TURNED)),
            ignore_initial: true,
            ..pb::TimeOfImpactRequest::default()
        }))
    };
    let singles = one_by_one(&mut bench, (0..200).map(question).collect()).await;
    let singles: Vec<_> = singles
        .into_iter()
        .map(|answer| {
            let Kind::TimeOfImpact(answer) = answer else { panic!("{answer:?}") };
            answer.hits.into_iter().next().map(|hit| Single {
                verdict: answer.verdict,
                id: hit.id,
                value: hit.fraction.unwrap(),
                point: hit.point.unwrap(),
                normal: hit.normal.unwrap_or_default(),
                feature: hit.feature.unwrap_or_default(),
                interval: hit.certificate.unwrap().interval.unwrap(),
            })
        })
        .collect();
    let request = pb::TimeOfImpactBatchRequest {
        geometry: Some(form.clone()),
        starts: poses(starts, vec![]),
        ends: poses(ends, TURNED.to_vec()),
        ignore_initial: true,
        want: all_columns(),
        options: exact(),
        ..pb::TimeOfImpactBatchRequest::default()
    };
    let columns = bench.questions.time_of_impact_batch(request).await.unwrap().into_inner().hits.unwrap();
    let hits = assert_same(&columns, &singles, 1.0);
    assert!((60..=180).contains(&hits), "{hits}");
}

#[tokio::test]
async fn places_as_columns_answer_as_overlaps_one_by_one() {
    let mut bench = crowd().await;
    let positions = numbers(600, 6);
    let scales: Vec<f32> = (0..200).map(|index| 0.5 + (index % 4) as f32).collect();
    let question = |index: usize| {
        let form = pb::Geometry { scale: Some(scales[index].into()), ..cuboid(0.25, 0.5, 0.75) };
        let subject = Some(subject(form, pose_of(&positions, index, TURNED)));
        Asked::Overlap(Box::new(pb::OverlapRequest { subject, max_hits: 2, ..pb::OverlapRequest::default() }))
    };
    let singles = one_by_one(&mut bench, (0..200).map(question).collect()).await;
    let request = pb::OverlapBatchRequest {
        geometry: Some(cuboid(0.25, 0.5, 0.75)),
        poses: poses(positions, TURNED.to_vec()),
        scales,
        max_hits_each: 2,
        options: exact(),
        ..pb::OverlapBatchRequest::default()
    };
    let columns = bench.questions.overlap_batch(request).await.unwrap().into_inner();
    assert_eq!(columns.offsets.len(), 201);
    let mut truncated = Vec::new();
    for (index, single) in singles.into_iter().enumerate() {
        let Kind::Overlap(single) = single else { panic!("{single:?}") };
        let range = columns.offsets[index] as usize..columns.offsets[index + 1] as usize;
        let ids: Vec<u64> = single.hits.iter().map(|hit| hit.id).collect();
        assert_eq!(columns.ids[range.clone()], ids, "place {index}");
        let verdicts = single.hits.iter().map(|hit| hit.certificate.as_ref().unwrap().verdict);
        assert_eq!(columns.verdicts[range], verdicts.collect::<Vec<_>>(), "place {index}");
        if single.truncated {
            truncated.push(u32::try_from(index).unwrap());
        }
    }
    assert_eq!(columns.truncated, truncated);
    assert!(!truncated.is_empty() && columns.ids.len() > 60, "{} of {}", truncated.len(), columns.ids.len());
}

#[tokio::test]
async fn what_is_empty_is_answered_with_nothing() {
    let mut bench = crowd().await;
    let nowhere = bench.questions.overlap_batch(pb::OverlapBatchRequest::default()).await.unwrap().into_inner();
    assert_eq!((nowhere.offsets, nowhere.ids.len()), (vec![0], 0));
    let nowhere = bench.questions.distance_batch(pb::DistanceBatchRequest::default()).await.unwrap().into_inner();
    assert_eq!(nowhere.hits, Some(pb::HitColumns::default()));
    let still = bench.questions.time_of_impact_batch(pb::TimeOfImpactBatchRequest::default()).await.unwrap();
    assert_eq!(still.into_inner().hits, Some(pb::HitColumns::default()));
    // No column but the one that says how far: a point at the frame's origin.
    let request = pb::DistanceBatchRequest { max_distances: vec![1.0, 2.0], ..pb::DistanceBatchRequest::default() };
    let points = bench.questions.distance_batch(request).await.unwrap().into_inner().hits.unwrap();
    assert_eq!((points.values, points.ids), (vec![1.0, 2.0], vec![0, 0]));
}

fn rays(directions: &[f32]) -> pb::RaycastBatchRequest {
    pb::RaycastBatchRequest { directions: directions.to_vec(), ..pb::RaycastBatchRequest::default() }
}

#[tokio::test]
async fn a_wrong_ray_or_column_is_told_by_name_and_place() {
    let mut bench = crowd().await;
    let two = [0.0, 0.0, 1.0, 0.0, 0.0, 1.0];
    let wrong: Vec<(pb::RaycastBatchRequest, Refusal)> = vec![
        (rays(&[]), ("MISSING", "directions", &["[0, 0, 1]"])),
        (rays(&two[..5]), ("COLUMN_LENGTH", "directions", &["has 5 numbers"])),
        (rays(&[0.0, 0.0, 1.0, 0.0, 0.0, 0.0]), ("OUT_OF_LIMITS", "directions[3]", &["(0, 0, 0)"])),
        (rays(&[0.0, 0.0, 1.0, 0.0, f32::NAN, 0.0]), ("NOT_FINITE", "directions[4]", &["is NaN"])),
        (
            pb::RaycastBatchRequest { origins: vec![0.0; 9], ..rays(&two) },
            ("COLUMN_LENGTH", "directions", &["has 6 numbers", "9 (3 for each of 3 items)"]),
        ),
        (
            pb::RaycastBatchRequest { max_distances: vec![1.0, -1.0], ..rays(&two) },
            ("OUT_OF_LIMITS", "max_distances[1]", &["is -1", "4e12"]),
        ),
        (
            pb::RaycastBatchRequest { origins: vec![2e12, 0.0, 0.0], ..rays(&two) },
            ("OUT_OF_LIMITS", "origins[0]", &["1e12"]),
        ),
        (
            pb::RaycastBatchRequest { ignore_ids: vec![1, 2, 3], ..rays(&[0.0, 0.0, 1.0, 0.0, 0.0, 1.0]) },
            ("COLUMN_LENGTH", "directions", &["3 items"]),
        ),
        (
            pb::RaycastBatchRequest { mode: pb::HitMode::All.into(), ..rays(&two) },
            ("OUT_OF_LIMITS", "mode", &["one hit for each ray", "Batch"]),
        ),
        (
            pb::RaycastBatchRequest { frame_origin: Some(vec3(f64::NAN, 0.0, 0.0)), ..rays(&two) },
            ("NOT_FINITE", "frame_origin.x", &["is NaN"]),
        ),
    ];
    for (request, refusal) in wrong {
        assert_invalid(&bench.questions.raycast_batch(request).await.unwrap_err(), refusal);
    }
}

#[tokio::test]
async fn a_wrong_place_or_way_is_told_by_name_and_place() {
    let mut bench = crowd().await;
    let overlap = pb::OverlapBatchRequest { poses: poses(vec![0.0; 6], vec![]), ..pb::OverlapBatchRequest::default() };
    let plane = geometry(Form::HalfSpace(pb::HalfSpace::default()));
    let wrong: Vec<(pb::OverlapBatchRequest, Refusal)> = vec![
        (
            pb::OverlapBatchRequest { geometry: Some(sphere(-1.0)), ..overlap.clone() },
            ("OUT_OF_LIMITS", "geometry.sphere.radius", &["is -1"]),
        ),
        (
            pb::OverlapBatchRequest { geometry: Some(plane), ..overlap.clone() },
            ("BAD_GEOMETRY", "geometry.half_space", &["against"]),
        ),
        (
            pb::OverlapBatchRequest { geometry: Some(sphere(1.0)), scales: vec![1.0, 0.0], ..overlap.clone() },
            ("OUT_OF_LIMITS", "scales[1]", &["is 0", "above 0"]),
        ),
        (
            pb::OverlapBatchRequest { poses: poses(vec![0.0; 6], vec![0.0; 8]), ..overlap.clone() },
            ("OUT_OF_LIMITS", "poses.rotations[0]", &["four zeros"]),
        ),
        (pb::OverlapBatchRequest { max_hits_each: 70_000, ..overlap }, ("OUT_OF_LIMITS", "max_hits_each", &["65536"])),
    ];
    for (request, refusal) in wrong {
        assert_invalid(&bench.questions.overlap_batch(request).await.unwrap_err(), refusal);
    }
    let way = pb::TimeOfImpactBatchRequest {
        starts: poses(vec![0.0; 6], vec![]),
        ends: Some(pb::PoseColumns { positions: vec![1.0; 6], ..pb::PoseColumns::default() }),
        ..pb::TimeOfImpactBatchRequest::default()
    };
    let status = bench.questions.time_of_impact_batch(way).await.unwrap_err();
    assert_invalid(&status, ("OUT_OF_LIMITS", "ends.frame_origin", &["starts"]));
    let status = too_large(&mut bench).await.unwrap_err();
    assert_refused(&status, Code::ResourceExhausted, "QUOTA_EXCEEDED", "", &["fewer columns"]);
}

/// More answers than one message holds.
async fn too_large(bench: &mut Bench) -> Result<(), Status> {
    let request = pb::RaycastBatchRequest { want: all_columns(), ..rays(&[0.0, 0.0, 1.0].repeat(90_000)) };
    bench.questions.raycast_batch(request).await.map(|_| ())
}
