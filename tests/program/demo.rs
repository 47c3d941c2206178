//! `serve --demo`: what it announces is true, things move, and nothing goes through a wall.

use std::collections::BTreeMap;
use std::time::Duration;

use calipers_client::{Client, ask, proto};
use proto::{answer::Answer, question::Question};
use serde_json::Value;

use crate::binary::{Server, run_well};

/// The level's layer, as the announcement says.
const LAYER_LEVEL: u32 = 1;

fn describe(server: &Server, more: &[&str]) -> Value {
    let arguments = [&["describe", "--json", "--server", server.address()], more].concat();
    serde_json::from_str(&run_well(&arguments)).expect("it is JSON")
}

/// What moves, by the ids that the announcement gives, and where it is.
async fn movers(client: &Client) -> BTreeMap<u64, Option<proto::Pose>> {
    let request = proto::ListShapesRequest { page_size: 10_000, ..Default::default() };
    let listed = client.list_shapes(request).await.expect("shapes are listed");
    let moving = listed.shapes.into_iter().filter(|shape| shape.id >= 10_000);
    moving.map(|shape| (shape.id, shape.pose)).collect()
}

#[test]
fn the_announced_line_surely_hits() {
    let server = Server::start(&["--demo"]);
    assert!(server.announced.contains("grpcurl -plaintext"), "{}", server.announced);
    let ray = ["raycast", "5,20,5", "0,-1,0", "--server", server.address()];
    // The same ray as in the line that can be pasted.
    assert!(server.announced.contains(r#""origin":{"x":5,"y":20,"z":5},"direction":{"y":-1}"#));
    for _ in 0..5 {
        let answer = run_well(&ray);
        assert!(answer.starts_with("hit"), "{answer}");
    }
    let answer = run_well(&[&ray[..], &["--json", "--all"]].concat());
    let answer: Value = serde_json::from_str(&answer).expect("it is JSON");
    let ids: Vec<_> =
        answer["hits"].as_array().expect("hits are a list").iter().map(|hit| hit["id"].as_u64()).collect();
    // The floor and the ground below it, whoever walks there.
    assert!(ids.ends_with(&[Some(2), Some(1)]), "{ids:?}");
}

#[test]
fn people_get_answers_that_read_well() {
    let server = Server::start(&["--demo"]);
    let of = |arguments: &[&str]| run_well(&[arguments, &["--server", server.address()]].concat());
    assert!(of(&["raycast", "0,50,0", "0,1,0"]).starts_with("miss: the way is proved free"));
    // In the middle of the wall between the third and the fourth room, beside the doorway.
    let inside = of(&["raycast", "0,1,2", "1,0,0"]);
    assert!(inside.contains("at 0 m") && inside.contains("the ray begins inside"), "{inside}");
    assert!(of(&["raycast", "5,20,5", "0,-1,0", "--max", "1"]).starts_with("miss"));
    let floor = of(&["overlap", "box:0.1,0.1,0.1", "--at", "33,-0.1,-22"]);
    assert!(floor.starts_with("hit: ") && floor.contains("shape 2\n"), "{floor}");
    assert!(of(&["overlap", "sphere:1", "--at", "0,-30,0"]).starts_with("miss: nothing touches it"));
    let world = of(&["describe"]);
    assert!(world.contains("of them static") && world.contains("between (-90, "), "{world}");
}

#[test]
fn the_same_seed_makes_the_same_level() {
    let hits = |seed: &str| {
        let server = Server::start(&["--demo", "--seed", seed]);
        let ray = ["raycast", "-90,0.3,-70", "9,0,7", "--all", "--json", "--server", server.address()];
        let answer: Value = serde_json::from_str(&run_well(&ray)).expect("it is JSON");
        let is_level = |hit: &&Value| hit["id"].as_u64().is_some_and(|id| id < 10_000);
        let hits = answer["hits"].as_array().expect("hits are a list").iter().filter(is_level).cloned();
        hits.collect::<Vec<_>>()
    };
    let first = hits("5");
    assert!(first.len() > 5, "{first:?}");
    assert_eq!(first, hits("5"));
    assert_ne!(first, hits("6"));
}

#[tokio::test(flavor = "multi_thread")]
async fn shapes_move_and_nothing_goes_through_a_wall() {
    let server = Server::start(&["--demo"]);
    let client = Client::connect(server.address()).await.expect("the server listens");
    let begin = movers(&client).await;
    assert!(begin.len() >= 300, "only {} shapes move", begin.len());
    let mut options = ask::exactly();
    options.filter = Some(proto::Filter { collides_with: Some(LAYER_LEVEL), ..Default::default() });
    let mut ticks = Vec::new();
    for round in 0..20 {
        let question = |id: &u64| Question::Overlap(Box::new(ask::overlap(ask::shape(*id))));
        let mut batch = ask::batch(begin.keys().map(question));
        batch.options = Some(options.clone());
        let answer = client.batch(batch).await.expect("the batch is answered");
        ticks.push(answer.info.expect("the answer names its tick").tick);
        for (id, answer) in begin.keys().zip(answer.answers) {
            let Some(Answer::Overlap(answer)) = answer.answer else { panic!("{id} in round {round}: {answer:?}") };
            let touched: Vec<u64> = answer.hits.iter().map(|hit| hit.id).collect();
            assert_eq!(answer.verdict(), proto::Verdict::Miss, "{id} touches {touched:?} in round {round}");
        }
        tokio::time::sleep(Duration::from_millis(150)).await;
    }
    assert!(ticks.is_sorted() && ticks[19] > ticks[0] + 10, "ticks do not go on: {ticks:?}");
    let end = movers(&client).await;
    let still: Vec<_> = begin.iter().filter(|(id, pose)| end.get(id) == Some(pose)).collect();
    assert!(still.is_empty(), "{still:?} never moved");
}

#[test]
fn without_an_open_session_it_makes_one_and_tells_the_token() {
    let server = Server::start(&["--demo", "--default-session", "off"]);
    let (_, after) = server.announced.split_once("Bearer ").expect("the token is announced");
    let token = after.split('\'').next().expect("the token ends with a quote");
    assert!(describe(&server, &["--session", "demo", "--token", token])["shape_count"].as_u64() > Some(500));
}
