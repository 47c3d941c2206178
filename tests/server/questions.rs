//! The questions: the README's examples with their answers, batches, versions, and what an answer says of itself.

use tonic::Code;
use wire::v1::{self as pb, geometry::Kind};

use crate::harness::{
    Bench, assert_refused, at, cuboid, geometry, insert, ray_along_z, readme_world, shape, sphere, subject,
    subject_shape, vec3,
};

#[track_caller]
fn assert_near(found: Option<f64>, expected: f64, certificate: Option<&pb::Certificate>) {
    let found = found.expect("a value");
    assert!((found - expected).abs() < 1e-9, "{found} is not {expected}");
    let interval = certificate.expect("a certificate").interval.expect("an interval");
    assert!(interval.lower.is_none_or(|lower| lower <= expected), "{interval:?} misses {expected}");
    assert!(interval.upper.is_none_or(|upper| upper >= expected), "{interval:?} misses {expected}");
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
async fn a_stick_that_makes_half_a_turn_meets_a_ball_on_its_way() {
    let mut bench = Bench::start().await;
    let (stick, ball) = (geometry(Kind::Capsule(pb::Capsule { half_height: 3.25, radius: 0.25 })), sphere(0.25));
    let (here, there) = (at(0.0, 0.0, 0.0), at(-3.0, -0.5, 0.0));
    let turned = |z, w| pb::Pose { position: None, rotation: Some(pb::Quat { x: 0.0, y: 0.0, z, w }) };
    bench.edit(vec![insert(shape(1, ball.clone(), there))]).await.unwrap();
    // The upper half comes down on the ball after a quarter turn, whatever the length of the quaternion; the other way round
    // the lower half comes up to it a little earlier than that.
    let earlier = 1.0
        - (1.0f64 / 6.0).atan() * std::f64::consts::FRAC_2_PI
        - (0.5 / 9.25f64.sqrt()).asin() * std::f64::consts::FRAC_2_PI;
    for (z, w, fraction) in [(2.0, 0.0, 0.5), (-1.0, 0.0, earlier / 2.0), (1.0, 1.0, 1.0), (-1.0, 1.0, earlier)] {
        let request = pb::TimeOfImpactRequest {
            subject: Some(subject(stick.clone(), here)),
            end: Some(turned(z, w)),
            ..pb::TimeOfImpactRequest::default()
        };
        let answer = bench.questions.time_of_impact(request).await.unwrap().into_inner();
        if fraction < 1.0 {
            assert_eq!(answer.verdict(), pb::Verdict::Hit);
        }
        let near = answer.hits.iter().find(|hit| hit.id == 1);
        assert_near(
            near.and_then(|hit| hit.fraction).or(Some(1.0)),
            fraction,
            near.and_then(|hit| hit.certificate.as_ref()),
        );
    }
    // The same seen from the ball, which the stick turns towards.
    let request = pb::TimeOfImpactRequest {
        subject: Some(subject(ball, there)),
        end: Some(there),
        against: Some(Box::new(subject(stick, here))),
        against_end: Some(turned(1.0, 0.0)),
        ..pb::TimeOfImpactRequest::default()
    };
    let answer = bench.questions.time_of_impact(request).await.unwrap().into_inner();
    assert_eq!((answer.verdict(), answer.hits[0].initial), (pb::Verdict::Hit, false));
    assert_near(answer.hits[0].fraction, 0.5, answer.hits[0].certificate.as_ref());
}

#[tokio::test]
async fn distance_to_the_nearest_and_to_one_geometry() {
    let mut bench = readme_world().await;
    let mut request = pb::DistanceRequest { subject: Some(pb::Subject::default()), ..pb::DistanceRequest::default() };
    let answer = bench.questions.distance(request.clone()).await.unwrap().into_inner();
    assert_near(answer.hits[0].distance, 4.0, answer.hits[0].certificate.as_ref());
    request.against = Some(Box::new(subject(cuboid(1.0, 1.0, 1.0), at(3.0, 0.0, 0.0))));
    let answer = bench.questions.distance(request).await.unwrap().into_inner();
    assert_eq!(answer.hits[0].id, 0, "a geometry has no id");
    assert_near(answer.hits[0].distance, 2.0, answer.hits[0].certificate.as_ref());
}

#[tokio::test]
async fn the_nearest_triangles_are_named_on_either_side() {
    let mut bench = readme_world().await;
    let mesh = pb::TriangleMesh {
        vertices: vec![0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 9.0, 1.0, 0.0, 9.0, 0.0, 1.0, 9.0],
        indices: vec![3, 4, 5, 0, 1, 2],
        ..pb::TriangleMesh::default()
    };
    let mesh = subject(geometry(Kind::Mesh(mesh)), at(0.0, 0.0, 0.0));
    let ball = subject(sphere(0.5), at(0.25, 0.25, -2.0));
    for (of_subject, of_shape, subject, against) in
        [(Some(1), None, mesh.clone(), ball.clone()), (None, Some(1), ball, mesh)]
    {
        let request = pb::DistanceRequest {
            subject: Some(subject),
            against: Some(Box::new(against)),
            ..pb::DistanceRequest::default()
        };
        let hit = bench.questions.distance(request).await.unwrap().into_inner().hits.remove(0);
        assert_near(hit.distance, 1.5, hit.certificate.as_ref());
        let face = |feature: Option<pb::Feature>| feature.and_then(|feature| feature.face);
        assert_eq!((face(hit.subject_feature), face(hit.feature)), (of_subject, of_shape));
    }
}

#[tokio::test]
async fn a_ray_chooses_the_side_of_surfaces_and_learns_where_in_the_triangle_it_hit() {
    let mut bench = readme_world().await;
    let mesh = pb::TriangleMesh {
        vertices: vec![0.0, 0.0, 0.0, 4.0, 0.0, 0.0, 0.0, 4.0, 0.0],
        indices: vec![0, 2, 1],
        ..pb::TriangleMesh::default()
    };
    // Its corners go counter-clockwise as seen from where the ray comes; the README's ball is behind it.
    let floor = insert(shape(9, geometry(Kind::Mesh(mesh)), at(-1.0, -2.0, 2.0)));
    bench.edit(vec![floor]).await.unwrap();
    for (faces, id, distance) in
        [(pb::RayFaces::Unspecified, 9, 2.0), (pb::RayFaces::Front, 9, 2.0), (pb::RayFaces::Back, 1, 6.0)]
    {
        let request = pb::RaycastRequest { faces: faces.into(), ..ray_along_z() };
        let hit = bench.questions.raycast(request).await.unwrap().into_inner().hits.remove(0);
        assert_eq!(hit.id, id, "{faces:?}");
        assert_near(hit.distance, distance, hit.certificate.as_ref());
        let weights = hit.barycentric.map(|weights| [weights.x, weights.y, weights.z]);
        assert_eq!(weights, (id == 9).then_some([0.25, 0.5, 0.25]), "in the order sent; a ball has none");
    }
}

#[tokio::test]
async fn a_shape_asks_without_seeing_itself() {
    let mut bench = readme_world().await;
    let second = insert(shape(2, sphere(1.0), at(0.0, 0.0, 6.5)));
    bench.edit(vec![second]).await.unwrap();
    let request = pb::OverlapRequest { subject: Some(subject_shape(1)), ..pb::OverlapRequest::default() };
    let answer = bench.questions.overlap(request).await.unwrap().into_inner();
    assert_eq!(answer.hits.iter().map(|hit| hit.id).collect::<Vec<_>>(), [2]);
    let gone = pb::OverlapRequest { subject: Some(subject_shape(9)), ..pb::OverlapRequest::default() };
    let status = bench.questions.overlap(gone).await.unwrap_err();
    assert_refused(&status, Code::NotFound, "SHAPE_NOT_FOUND", "subject.id", &["is 9", "tick 3"]);
}

#[tokio::test]
async fn all_hits_come_closest_first_and_a_cut_list_says_so() {
    let mut bench = Bench::start().await;
    let row = (1..=5).map(|id| insert(shape(id, sphere(0.25), at(0.0, 0.0, 7.0 - id as f64)))).collect();
    bench.edit(row).await.unwrap();
    let mut request = pb::RaycastRequest { mode: pb::HitMode::All.into(), ..ray_along_z() };
    let answer = bench.questions.raycast(request.clone()).await.unwrap().into_inner();
    assert_eq!(answer.hits.iter().map(|hit| hit.id).collect::<Vec<_>>(), [5, 4, 3, 2, 1]);
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
        (pb::Filter { collides_with: Some(2), ..everything.clone() }, vec![1]),
        (pb::Filter { exclude_ids: vec![1, 2], ..everything.clone() }, vec![3, 4, 5]),
        (pb::Filter { exclude_sensors: true, ..everything.clone() }, vec![1, 2, 4, 5]),
        (pb::Filter { exclude_static: true, ..everything.clone() }, vec![1, 2, 3, 5]),
        (pb::Filter { exclude_groups: vec![8], ..everything }, vec![1, 2, 3, 4]),
    ];
    for (filter, expected) in cases {
        let request = pb::RaycastRequest {
            mode: pb::HitMode::All.into(),
            options: Some(Box::new(pb::QueryOptions { filter: Some(filter.clone()), ..pb::QueryOptions::default() })),
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
    let mut request = pb::RaycastRequest { direction: Some(vec3(0.0, 1.0, 0.0)), ..pb::RaycastRequest::default() };
    let answer = bench.questions.raycast(request.clone()).await.unwrap().into_inner();
    assert_eq!(answer.verdict(), pb::Verdict::Miss);
    assert!(answer.hits.is_empty());
    assert!(answer.info.unwrap().work.is_none());
    request.options = Some(Box::new(pb::QueryOptions { explain: true, ..pb::QueryOptions::default() }));
    let answer = bench.questions.raycast(request).await.unwrap().into_inner();
    assert!(answer.info.unwrap().work.is_some());
}

#[tokio::test]
async fn a_hit_at_distance_zero_has_its_distance_and_a_positive_zero() {
    let mut bench = readme_world().await;
    let request = pb::RaycastRequest { origin: Some(vec3(0.0, 0.0, 5.0)), ..ray_along_z() };
    let answer = bench.questions.raycast(request).await.unwrap().into_inner();
    let distance = answer.hits[0].distance.expect("a zero is sent");
    assert!(distance == 0.0 && distance.is_sign_positive());
    assert!(answer.hits[0].inside);
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
