//! Reading a world back: shapes one by one and page by page, and its description.

use tonic::Code;
use wire::v1::{self as pb, read_at::At};

use crate::harness::{Bench, assert_refused, at, cuboid, insert, ray_along_z, remove, shape, sphere, vec3};

#[tokio::test]
async fn shapes_are_listed_by_id_and_pages_keep_their_tick() {
    let mut bench = Bench::start().await;
    let row = (1..=7).map(|id| insert(shape(id, sphere(0.25), at(id as f64, 0.0, 0.0)))).collect();
    bench.edit(row).await.unwrap();
    let mut request = pb::ListShapesRequest { page_size: 3, ..pb::ListShapesRequest::default() };
    let mut ids = Vec::new();
    loop {
        let page = bench.worlds.list_shapes(request.clone()).await.unwrap().into_inner();
        assert_eq!(page.info.unwrap().tick, 2);
        ids.extend(page.shapes.iter().map(|shape| shape.id));
        request.page_token = page.next_page_token;
        if request.page_token.is_empty() {
            break;
        }
        bench.edit(vec![remove(&[5, 6])]).await.unwrap();
    }
    assert_eq!(ids, [1, 2, 3, 4, 5, 6, 7]);
    let within = pb::ListShapesRequest {
        bounds: Some(pb::Aabb { min: Some(vec3(1.5, -1.0, -1.0)), max: Some(vec3(3.5, 1.0, 1.0)) }),
        ..pb::ListShapesRequest::default()
    };
    let page = bench.worlds.list_shapes(within).await.unwrap().into_inner();
    assert_eq!(page.shapes.iter().map(|shape| shape.id).collect::<Vec<_>>(), [2, 3]);
    for wrong in ["nonsense", "1-", "0-1", "1-0"] {
        request.page_token = wrong.to_owned();
        let status = bench.worlds.list_shapes(request.clone()).await.unwrap_err();
        assert_refused(&status, Code::InvalidArgument, "OUT_OF_LIMITS", "page_token", &["leave it empty"]);
    }
    request.page_token = "1-1".to_owned();
    let status = bench.worlds.list_shapes(request).await.unwrap_err();
    assert_refused(&status, Code::OutOfRange, "TICK_NOT_HELD", "page_token", &["begin again"]);
}

#[tokio::test]
async fn a_shape_is_read_at_the_version_asked_for() {
    let mut bench = Bench::start().await;
    bench.edit(vec![insert(shape(1, sphere(1.0), at(0.0, 0.0, 5.0)))]).await.unwrap();
    let request = pb::GetShapeRequest {
        id: 1,
        read_at: Some(pb::ReadAt { at: Some(At::Tick(3)), tick_fraction: 0.0 }),
        ..pb::GetShapeRequest::default()
    };
    let status = bench.worlds.get_shape(request).await.unwrap_err();
    assert_refused(&status, Code::OutOfRange, "TICK_NOT_HELD", "read_at.tick", &["oldest is 1, newest 2"]);
}

#[tokio::test]
async fn a_description_tells_what_is_there_and_what_is_in_force() {
    let mut bench = Bench::start().await;
    let empty = bench.describe().await;
    assert_eq!((empty.tick, empty.oldest_tick, empty.shape_count), (1, 1, 0));
    assert!(empty.bounds.is_none());
    assert_eq!(empty.settings.unwrap().history_ticks, Some(64));
    assert!(empty.built.is_empty(), "nothing was needed yet");
    let ground =
        pb::Shape { mobility: pb::Mobility::Static.into(), ..shape(1, cuboid(8.0, 1.0, 8.0), at(0.0, -1.0, 0.0)) };
    bench.edit(vec![insert(ground), insert(shape(2, sphere(1.0), at(0.0, 1.0, 0.0)))]).await.unwrap();
    bench.questions.raycast(ray_along_z()).await.unwrap();
    let description = bench.describe().await;
    assert_eq!((description.shape_count, description.static_count), (2, 1));
    assert_eq!((description.question_count, description.edit_count), (1, 2));
    assert!(description.memory_bytes > 0 && description.coordinate_step > 0.0);
    assert!(description.bounds.unwrap().max.unwrap().x >= 8.0);
    let built = |description: &pb::DescribeWorldResponse| {
        description.built.iter().map(|built| (built.name.clone(), built.first_tick)).collect::<Vec<_>>()
    };
    let names = ["dynamic_tree", "static_tree", "history"].map(|name| (name.to_owned(), 2));
    assert_eq!(built(&description), names);
    assert!(description.built[1].build_time.is_some() && description.built[0].build_time.is_none());
    let past = pb::RaycastRequest { options: Some(Box::new(crate::harness::read_at(At::Tick(1)))), ..ray_along_z() };
    bench.questions.raycast(past).await.unwrap();
    let description = bench.describe().await;
    assert_eq!((description.oldest_tick, built(&description)[3].clone()), (1, ("past_trees".to_owned(), 2)));
}
