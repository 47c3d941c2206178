//! Questions that name an error, and what is told of what stood in for geometries.

use wire::v1::{self as pb, geometry::Kind};

use crate::harness::{Bench, at, geometry, insert, shape, sphere, subject};

/// A closed box of twelve triangles, two metres wide.
fn mesh() -> pb::TriangleMesh {
    let corner = |index: u32| [0, 1, 2].map(|axis| if index >> axis & 1 == 1 { 1.0 } else { -1.0 });
    let sides = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    pb::TriangleMesh {
        vertices: (0..8).flat_map(corner).collect(),
        indices: sides.into_iter().flat_map(|[a, b, c, d]: [u32; 4]| [a, b, c, a, c, d]).collect(),
        ..pb::TriangleMesh::default()
    }
}

async fn certificate(bench: &mut Bench, max_error: Option<f64>) -> pb::Certificate {
    let accuracy = pb::Accuracy { max_error, ..pb::Accuracy::default() };
    let request = pb::DistanceRequest {
        subject: Some(subject(sphere(1.0), at(0.0, 0.0, 0.0))),
        options: Some(Box::new(pb::QueryOptions { accuracy: Some(accuracy), ..pb::QueryOptions::default() })),
        ..pb::DistanceRequest::default()
    };
    let answer = bench.questions.distance(request).await.unwrap().into_inner();
    answer.hits[0].certificate.unwrap()
}

#[tokio::test]
async fn an_answer_says_what_stood_in_and_the_world_what_was_built() {
    let mut bench = Bench::start().await;
    let request = pb::CreateGeometryRequest { session: String::new(), geometry: Some(geometry(Kind::Mesh(mesh()))) };
    let id = bench.geometries.create_geometry(request).await.unwrap().into_inner().geometry.unwrap().geometry_id;
    let placed = shape(1, geometry(Kind::GeometryId(id.clone())), at(10.0, 0.0, 0.0));
    bench.edit(vec![insert(placed)]).await.unwrap();
    let get = pb::GetGeometryRequest { geometry_id: id, ..pb::GetGeometryRequest::default() };

    let exact = certificate(&mut bench, None).await;
    assert_eq!(exact.representation(), pb::Representation::Exact);
    assert_eq!((exact.outside, exact.inside), (0.0, 0.0));
    let told = bench.geometries.get_geometry(get.clone()).await.unwrap().into_inner().geometry.unwrap();
    assert!(told.stand_ins.is_empty(), "no question has needed any: {:?}", told.stand_ins);
    let names: Vec<_> = told.structures.iter().map(|structure| structure.name.as_str()).collect();
    assert_eq!(names, ["mesh_tree"], "the exact question searched its triangles");
    assert!(told.structures[0].first_tick == 2 && told.structures[0].build_time.is_some(), "{told:?}");

    bench.edit(vec![insert(shape(2, sphere(1.0), at(0.0, 500.0, 0.0)))]).await.unwrap();

    let loose = certificate(&mut bench, Some(0.5)).await;
    assert_eq!(loose.representation(), pb::Representation::OrientedBox);
    assert!(loose.outside == 0.0 && loose.inside > 0.0, "{loose:?}");
    let [lower, upper] = loose.interval.map(|interval| [interval.lower, interval.upper].map(Option::unwrap)).unwrap();
    assert!(lower <= 8.0 && 8.0 <= upper && upper - lower <= 0.5, "{loose:?}");
    let told = bench.geometries.get_geometry(get).await.unwrap().into_inner().geometry.unwrap();
    let rungs: Vec<_> = told.stand_ins.iter().map(|rung| rung.representation()).collect();
    assert_eq!(rungs, [pb::Representation::Sphere, pb::Representation::OrientedBox]);
    assert!(told.stand_ins.iter().all(|rung| rung.memory_bytes > 0 && rung.vertex_count > 0), "{told:?}");
    assert!(told.stand_ins.iter().all(|rung| rung.first_tick == 3 && rung.build_time.is_some()), "{told:?}");
    let built = bench.describe().await.built;
    let named =
        |name: &str| built.iter().find(|built| built.name == name).unwrap_or_else(|| panic!("{name}: {built:?}"));
    let (volumes, tree) = (named("ball_and_box"), named("mesh_tree"));
    assert_eq!((volumes.count, volumes.first_tick, tree.first_tick), (1, 3, 2));
    assert!(volumes.build_time == told.stand_ins[0].build_time && tree.build_time == told.structures[0].build_time);
}
