//! The lines of README.md and docs/api.md, run as they stand: by the built binary and by real grpcurl.
//!
//! A line `grpcurl …` in an `sh` block is run against a server of the block's own; the comment above it says what comes
//! back, and each word in backticks there must stand in the output. Where grpcurl is not installed this says so and passes,
//! but not on CI.

use std::{
    fs,
    io::{BufRead, BufReader},
    net::TcpListener,
    path::Path,
    process::{Child, Command, Stdio},
    sync::mpsc,
    time::Duration,
};

/// A running `calipers serve`, killed when dropped.
struct Server {
    process: Child,
    port: u16,
}

impl Server {
    /// Starts the built binary and waits until it says that it listens.
    fn start(arguments: &[&str]) -> Self {
        let port =
            TcpListener::bind("127.0.0.1:0").and_then(|listener| listener.local_addr()).expect("a free port").port();
        let mut process = Command::new(env!("CARGO_BIN_EXE_calipers"))
            .args(arguments)
            .args(["--listen", &format!("127.0.0.1:{port}")])
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .expect("the built binary runs");
        let output = BufReader::new(process.stdout.take().expect("piped"));
        let (tell, told) = mpsc::channel();
        std::thread::spawn(move || {
            for line in output.lines().map_while(Result::ok) {
                if line.contains("grpcurl") {
                    let _ = tell.send(());
                }
            }
        });
        let server = Self { process, port };
        told.recv_timeout(Duration::from_secs(60)).expect("it prints a grpcurl line within a minute");
        server
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

/// A line to run and what its output must hold.
#[derive(Debug)]
struct Example {
    line: String,
    expected: Vec<String>,
}

/// The grpcurl lines of a document's `sh` blocks, each with the words in backticks of the comments above it.
fn examples(document: &str) -> Vec<Example> {
    let text = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(document)).expect(document);
    let mut found = Vec::new();
    for block in text.split("```sh\n").skip(1).filter_map(|rest| rest.split("```").next()) {
        let mut expected = Vec::new();
        let joined = block.replace("\\\n", " ");
        for line in joined.lines() {
            if line.starts_with('#') {
                expected.extend(line.split('`').skip(1).step_by(2).map(str::to_owned));
            } else {
                if line.starts_with("grpcurl ") {
                    found.push(Example { line: line.to_owned(), expected: expected.clone() });
                }
                expected.clear();
            }
        }
    }
    assert!(!found.is_empty(), "{document} has no grpcurl line");
    found
}

fn has_grpcurl() -> bool {
    let found = Command::new("grpcurl").arg("--version").output().is_ok();
    let is_ci = std::env::var("CI").is_ok_and(|value| value == "true");
    assert!(found || !is_ci, "grpcurl is not installed, and CI must have it");
    if !found {
        eprintln!("grpcurl is not installed: the documents' lines were not run");
    }
    found
}

fn run(example: &Example, port: u16) {
    let line = example.line.replace("localhost:7070", &format!("127.0.0.1:{port}"));
    let output = Command::new("sh").args(["-c", &line]).output().expect("sh runs");
    let said = format!("{}{}", String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    for word in &example.expected {
        assert!(said.contains(word.as_str()), "{line}\nshould say {word}, but says\n{said}");
    }
    let wants_failure = example.expected.iter().any(|word| word.starts_with("Code: "));
    assert_eq!(output.status.success(), !wants_failure, "{line}\n{said}");
}

#[test]
fn the_readme_tells_the_truth() {
    if !has_grpcurl() {
        return;
    }
    let server = Server::start(&["serve", "--demo"]);
    for example in examples("README.md") {
        assert!(!example.expected.is_empty(), "nothing is said of what comes back: {example:?}");
        run(&example, server.port);
    }
}

#[test]
fn every_example_of_the_api_page_runs() {
    if !has_grpcurl() {
        return;
    }
    let server = Server::start(&["serve", "--operator-token", "operator-secret"]);
    for example in examples("docs/api.md") {
        assert!(!example.expected.is_empty(), "nothing is said of what comes back: {example:?}");
        run(&example, server.port);
    }
}
