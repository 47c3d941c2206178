//! `bench` and `tune`: what accuracy costs, told without a server.

use crate::binary::{Scratch, Server, run, run_well};

/// A square pyramid.
const PYRAMID: &str =
    "v -1 0 -1\nv 1 0 -1\nv 1 0 1\nv -1 0 1\nv 0 3 0\nf 1 2 3 4\nf 1 5 2\nf 2 5 3\nf 3 5 4\nf 4 5 1\n";

#[test]
fn a_bench_tells_every_setting_and_writes_what_it_is_asked_for() {
    let (csv, page) = (Scratch::new(".csv", ""), Scratch::new(".html", ""));
    let of_scene = ["bench", "--scene", "arena", "--question", "distance", "--count", "5"];
    let said = run_well(&[&of_scene[..], &["--csv", csv.path(), "--html", page.path()]].concat());
    assert!(
        said.contains("arena, distance: 5 questions")
            && said.contains("the oracle judged") | said.contains("oracle judged")
    );
    for knob in ["tier", "max_error ", "max_error_relative", "budget", "no stand-ins", "tree", "margin"] {
        assert!(said.contains(&format!("\n  {knob}")), "{knob}: {said}");
    }
    assert!(std::fs::read_to_string(csv.path()).expect("it was written").lines().count() > 30);
    assert!(std::fs::read_to_string(page.path()).expect("it was written").contains("<svg"));
}

#[test]
fn a_file_is_tuned_for_and_the_field_is_json_of_the_api() {
    let file = Scratch::new(".obj", PYRAMID);
    let tuned = || run_well(&["tune", file.path(), "--max-error", "1e-3", "--count", "10", "--question", "distance"]);
    let said = tuned();
    let of =
        |said: &str| said.lines().find_map(|line| line.split_once("in DistanceRequest: ")).map(|it| it.1.to_owned());
    let field = of(&said).expect("a field to send");
    let sent: serde_json::Value = serde_json::from_str(&field).expect("it is JSON");
    let accuracy = sent["options"]["accuracy"].as_object().expect("an object");
    let known = ["tier", "maxError", "maxErrorRelative", "budget"];
    assert!(!accuracy.is_empty() && accuracy.keys().all(|key| known.contains(&key.as_str())), "{field}");
    assert_eq!(Some(field), of(&tuned()), "the same each time");
}

#[test]
fn a_world_of_a_server_is_measured_from_its_export() {
    let server = Server::start(&["--demo"]);
    let file = Scratch::new(".world", "");
    run_well(&["export", file.path(), "--server", server.address()]);
    let said = run_well(&["bench", file.path(), "--question", "overlap", "--count", "3"]);
    assert!(said.contains(", overlap: 3 questions") && said.contains("\n  tier"), "{said}");
    let said = run_well(&["tune", file.path(), "--max-error", "1e-2", "--count", "3", "--question", "raycast"]);
    assert!(said.contains("in RaycastRequest: "), "{said}");
    let torn = std::fs::read(file.path()).expect("it was written");
    for wrong in [&torn[..torn.len() - 1], b"not an export at all", b""] {
        let said = run(&["bench", Scratch::new(".world", wrong).path()]);
        assert!(said.code == Some(1) && said.err.contains("is no whole export"), "{said:?}");
    }
}

#[test]
fn what_cannot_be_measured_is_told() {
    let nothing = run(&["tune", "--max-error", "1e-3"]);
    assert!(nothing.code == Some(1) && nothing.err.contains("--scene NAME"), "{nothing:?}");
    let negative = run(&["tune", "--scene", "arena", "--max-error", "0"]);
    assert!(negative.code == Some(1) && negative.err.contains("above 0"), "{negative:?}");
    let trace = run(&["bench", "moves.csv.gz"]);
    assert!(trace.code == Some(1) && trace.err.contains("calipers play moves.csv.gz --kind"), "{trace:?}");
    let unknown = run(&["bench", "--scene", "moon"]);
    assert!(unknown.code == Some(2) && unknown.err.contains("arena, debris"), "{unknown:?}");
}
