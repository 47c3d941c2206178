//! `explain`: what was kept in a file is told and asked again, whatever it was written by, and what is damaged is told apart.

use std::process::Command;

use calipers_client::{Client, ask, proto, shape};
use prost::Message;

use crate::binary::{Scratch, Server, run, run_well};

/// A world of two shapes, and what Explain answers to a ray that meets one of them.
async fn explained(server: &Server) -> proto::ExplainResponse {
    let client = Client::connect(&format!("http://{}", server.address())).await.expect("it listens");
    let balls =
        [shape::sphere(1, 1.0).at([0.0, 0.0, 5.0]).insert(), shape::sphere(2, 1.0).at([0.0, 50.0, 0.0]).insert()];
    client.edit(balls).await.expect("a tick");
    let ray = proto::question::Question::Raycast(ask::ray([0.0; 3], [0.0, 0.0, 1.0]));
    let question = Some(proto::Question { question: Some(ray) });
    client.explain(proto::ExplainRequest { question, ..Default::default() }).await.expect("an answer")
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn bytes_of_the_answer_and_of_the_replay_are_told_and_come_out_the_same() {
    let server = Server::start(&[]);
    let response = explained(&server).await;
    let replay = response.replay.clone().expect("a replay");
    for bytes in [response.encode_to_vec(), replay.encode_to_vec()] {
        let file = Scratch::new(".bin", bytes);
        let said = run_well(&["explain", file.path()]);
        for part in [
            "\"direction\":{\"z\":1.0}}",
            "at tick 2; answered by calipers",
            "it depends on 1 shape:",
            "shape 1: a sphere of radius 1 at (0, 0, 5)",
            "shape 1: hit, between 3.99999999999",
            "answer: hit",
            "shape 1 at 4, hit, between 3.99999999999",
            "asked again: the same answer, byte for byte",
        ] {
            assert!(said.contains(part), "{part:?} is missing in\n{said}");
        }
    }
    // Another world answers otherwise, and that is a failure.
    let mut other = replay;
    other.shapes[0].pose = Some(proto::Pose { position: Some(proto::Vec3 { x: 0.0, y: 0.0, z: 5.5 }), rotation: None });
    let file = Scratch::new(".bin", other.encode_to_vec());
    let said = run(&["explain", file.path()]);
    assert!(said.code == Some(1) && said.err.contains("asked again, the answer is another"), "{said:?}");
    assert!(said.out.contains("hit, between 4.49999999999"), "{said:?}");
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn the_output_of_grpcurl_is_taken_as_it_is() {
    if Command::new("grpcurl").arg("-version").output().is_err() {
        let is_ci = std::env::var("CI").is_ok_and(|ci| ci == "true");
        assert!(!is_ci, "grpcurl is not installed, and CI=true wants every test");
        eprintln!("skipped: grpcurl is not installed");
        return;
    }
    let server = Server::start(&[]);
    explained(&server).await;
    let request = "{\"question\":{\"distance\":{\"subject\":{\"geometry\":{\"box\":{\"halfExtents\":{\"x\":1,\"y\":2,\"z\":0.3}}}}}}}";
    let call = ["-plaintext", "-d", request, server.address(), "calipers.v1.WorldService/Explain"];
    let output = Command::new("grpcurl").args(call).output().expect("grpcurl runs").stdout;
    let said = run_well(&["explain", Scratch::new(".json", &output).path()]);
    assert!(said.contains("asked again: the same answer, byte for byte"), "{said}");
    // Numbers of 17 digits are read as they were written.
    for number in 1..40 {
        let radius = 1.0 / f64::from(number);
        let subject = format!(
            "{{\"geometry\":{{\"sphere\":{{\"radius\":{radius}}}}},\"pose\":{{\"position\":{{\"x\":{radius},\"y\":-0.1}}}}}}"
        );
        let request = format!("{{\"question\":{{\"distance\":{{\"subject\":{subject},\"maxHits\":2}}}}}}");
        let call = ["-plaintext", "-d", &request, server.address(), "calipers.v1.WorldService/Explain"];
        let output = Command::new("grpcurl").args(call).output().expect("grpcurl runs").stdout;
        run_well(&["explain", Scratch::new(".json", output).path()]);
    }
    // The replay alone, too.
    let answer: serde_json::Value = serde_json::from_slice(&output).expect("JSON");
    let said = run_well(&["explain", Scratch::new(".json", answer["replay"].to_string()).path()]);
    assert!(said.contains("distance {"), "{said}");
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn damaged_files_are_told_apart() {
    let server = Server::start(&[]);
    let bytes = explained(&server).await.encode_to_vec();
    let refused = |contents: &[u8], part: &str| {
        let file = Scratch::new(".x", contents);
        let said = run(&["explain", file.path()]);
        assert!(said.code == Some(1) && said.err.contains(part) && said.err.contains(file.path()), "{part}: {said:?}");
    };
    refused(b"", "it is empty");
    refused(&bytes[..bytes.len() / 2], "nor whole protobuf bytes");
    refused(b"hello", "nor whole protobuf bytes");
    refused(b"{\"replay\": {\"format\": 1", "the JSON ends or errs");
    refused(b"{\"replay\": {\"format\": 1, \"shaped\": []}}", "shaped");
    refused(b"{\"replay\": {\"format\": 1}}", "holds no question");
    refused(b"{\"replay\": {\"format\": 9, \"program\": \"7.0\", \"question\": {\"raycast\": {}}}}", "layout 9");
    let missing = run(&["explain", "no-such-file"]);
    assert!(missing.code == Some(1) && missing.err.contains("no-such-file cannot be read"), "{missing:?}");
    let help = run_well(&["explain", "--help"]);
    assert!(help.contains("WorldService/Explain > ray.json") && help.contains("byte for byte"), "{help}");
}
