//! The lines of `proto/README.md`, "By hand", run by grpcurl itself against a server on a real socket.

use std::process::{Command, Output};

use serde_json::Value;

use crate::harness::Bench;

const README: &str = include_str!("../../proto/README.md");

/// What a line must give: a place in the answer and its value, or the gRPC code of a refusal.
enum Expected {
    Number(&'static str, f64),
    Text(&'static str, &'static str),
    Refusal(&'static str),
}

/// In the order of the lines.
const EXPECTED: [&[Expected]; 11] = [
    &[Expected::Text("/tick", "2"), Expected::Text("/changedCount", "1")],
    &[Expected::Text("/verdict", "VERDICT_HIT"), Expected::Number("/hits/0/distance", 4.0)],
    &[Expected::Text("/verdict", "VERDICT_HIT"), Expected::Text("/hits/0/id", "1")],
    &[Expected::Number("/contacts/0/depth", 0.5), Expected::Number("/contacts/0/normal/z", -1.0)],
    &[Expected::Number("/hits/0/fraction", 0.35)],
    &[Expected::Text("/verdict", "VERDICT_MISS"), Expected::Number("/info/tickFraction", 0.5)],
    // It goes on until grpcurl's own time is over.
    &[Expected::Text("/entered/b/0", "1"), Expected::Refusal("DeadlineExceeded")],
    &[Expected::Text("/info/tick", "2")],
    &[Expected::Text("/tick", "3")],
    &[Expected::Text("/sweepHits/0/impact/id", "1"), Expected::Number("/sweepHits/0/impact/fraction", 0.475)],
    &[Expected::Text("/tick", "4"), Expected::Text("/shapeCount", "2")],
];

/// Call and request of each `g` line.
fn lines() -> Vec<(&'static str, &'static str)> {
    let lines = README.lines().filter_map(|line| line.strip_prefix("g "));
    let lines = lines.filter_map(|line| line.split_once(" '"));
    lines.map(|(call, request)| (call, request.trim_end_matches('\''))).collect()
}

/// Whether grpcurl is there; its absence is a failure where the tests are to be complete.
fn has_grpcurl() -> bool {
    let found = Command::new("grpcurl").arg("-version").output().is_ok();
    let is_ci = std::env::var("CI").is_ok_and(|ci| ci == "true");
    assert!(found || !is_ci, "grpcurl is not installed, and CI=true wants every test");
    found
}

fn grpcurl(arguments: &[&str]) -> Output {
    Command::new("grpcurl").args(arguments).output().expect("grpcurl runs")
}

fn check(call: &str, output: &Output, expected: &Expected) {
    let (told, failed) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    let at = |place: &str| {
        let answer: Value = serde_json::from_str(&told).unwrap_or_else(|_| panic!("{call}: {told}{failed}"));
        answer.pointer(place).cloned().unwrap_or_else(|| panic!("{call}: no {place} in {told}"))
    };
    match expected {
        Expected::Number(place, value) => {
            let found = at(place).as_f64().expect("a number");
            assert!((found - value).abs() < 1e-9, "{call}: {place} is {found}");
        }
        Expected::Text(place, value) => assert_eq!(at(place).as_str(), Some(*value), "{call}"),
        Expected::Refusal(code) => assert!(failed.contains(&format!("Code: {code}")), "{call}: {told}{failed}"),
    }
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn the_lines_of_the_readme_give_what_it_says() {
    if !has_grpcurl() {
        eprintln!("skipped: grpcurl is not installed");
        return;
    }
    let bench = Bench::start().await;
    let address = bench.server.local_addr().to_string();
    let lines = lines();
    assert_eq!(lines.len(), EXPECTED.len(), "{lines:?}");
    for ((call, request), all_expected) in lines.into_iter().zip(EXPECTED) {
        let method = format!("calipers.v1.{call}");
        let output = grpcurl(&["-plaintext", "-max-time", "5", "-d", request, &address, &method]);
        for expected in all_expected {
            check(call, &output, expected);
        }
    }
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn grpcurl_can_print_the_details_of_an_error() {
    if !has_grpcurl() {
        eprintln!("skipped: grpcurl is not installed");
        return;
    }
    let bench = Bench::start().await;
    let address = bench.server.local_addr().to_string();
    let output = grpcurl(&["-plaintext", "-d", "{}", &address, "calipers.v1.QueryService/Raycast"]);
    let failed = String::from_utf8_lossy(&output.stderr);
    for part in ["Code: InvalidArgument", "direction is absent", "\"reason\"", "\"MISSING\"", "\"field\""] {
        assert!(failed.contains(part), "{part} is missing in {failed}");
    }
}
