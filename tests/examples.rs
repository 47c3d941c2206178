//! The lines of README.md and docs/api.md, run as they stand: by the built binary and by real grpcurl.
//!
//! A line `grpcurl …` or `calipers …` in an `sh` block is run against a server of the document's own, in a folder that holds
//! the files it names; the comment above it says what comes back, and each word in backticks there must stand in the
//! output. Where grpcurl is not installed its lines are passed over and this says so, but on CI that is a failure.

use std::{
    fs,
    io::{BufRead, BufReader, Write},
    net::TcpListener,
    path::{Path, PathBuf},
    process::{Child, Command, Stdio},
    sync::mpsc,
    time::Duration,
};

use flate2::{Compression, write::GzEncoder};

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

/// The lines of a document's `sh` blocks that can be run, each with the words in backticks of the comments above it.
fn examples(document: &str) -> Vec<Example> {
    let text = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(document)).expect(document);
    let programs: &[&str] = if has_grpcurl() { &["grpcurl ", "calipers "] } else { &["calipers "] };
    let mut found = Vec::new();
    for block in text.split("```sh\n").skip(1).filter_map(|rest| rest.split("```").next()) {
        let mut expected = Vec::new();
        let joined = block.replace("\\\n", " ");
        for line in joined.lines() {
            if line.starts_with('#') {
                expected.extend(line.split('`').skip(1).step_by(2).map(str::to_owned));
            } else {
                if programs.iter().any(|program| line.starts_with(program)) {
                    found.push(Example { line: line.to_owned(), expected: expected.clone() });
                }
                expected.clear();
            }
        }
    }
    found
}

/// A folder with the files that the documents name: a level, and moves of a car and a ball.
fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    fs::create_dir_all(&folder).expect("a folder");
    let level = "v 0 0 0\nv 4 0 0\nv 0 0 4\nv 4 0 4\nf 1 3 2\nf 2 3 4\n";
    fs::write(folder.join("level.obj"), level).expect("a file");
    let file = fs::File::create(folder.join("moves.csv.gz")).expect("a file");
    let mut moves = GzEncoder::new(file, Compression::fast());
    let header = "frame,time,op,actor,kind,px,py,pz,qx,qy,qz,qw,vx,vy,vz,wx,wy,wz,sleep\n";
    let frames = "0,0.00,N,1,car,0,0,17,,,,,,,,,,,\n0,0.00,M,1,car,0,0,17,0,0,0,1,,,,,,,\n\
                  1,0.03,M,1,car,9,0,17,0,0,0,1,,,,,,,\n1,0.03,N,2,ball,0,0,93,,,,,,,,,,,\n\
                  2,0.06,M,2,ball,0,0,93,0,0,0,1,,,,,,,\n";
    moves.write_all(format!("{header}{frames}").as_bytes()).expect("written");
    moves.finish().expect("written");
    folder
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

fn run(example: &Example, port: u16, folder: &Path) {
    let address = format!("127.0.0.1:{port}");
    let line = example.line.replace("localhost:7070", &address);
    let programs = Path::new(env!("CARGO_BIN_EXE_calipers")).parent().expect("a folder").display();
    let path = format!("{programs}:{}", std::env::var("PATH").unwrap_or_default());
    let output = Command::new("sh")
        .args(["-c", &line])
        .current_dir(folder)
        .env("PATH", path)
        .env("CALIPERS_SERVER", &address)
        .output()
        .expect("sh runs");
    let said = format!("{}{}", String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    for word in &example.expected {
        assert!(said.contains(word.as_str()), "{line}\nshould say {word}, but says\n{said}");
    }
    let wants_failure = example.expected.iter().any(|word| word.starts_with("Code: "));
    assert_eq!(output.status.success(), !wants_failure, "{line}\n{said}");
}

fn run_all(document: &str, server: &Server) -> usize {
    let folder = folder(&document.replace(['/', '.'], "-"));
    let examples = examples(document);
    for example in &examples {
        assert!(!example.expected.is_empty(), "nothing is said of what comes back: {example:?}");
        run(example, server.port, &folder);
    }
    examples.len()
}

#[test]
fn the_readme_tells_the_truth() {
    let server = Server::start(&["serve", "--demo"]);
    assert!(run_all("README.md", &server) >= 5);
}

#[test]
fn every_example_of_the_api_page_runs() {
    let server = Server::start(&["serve", "--operator-token", "operator-secret"]);
    assert!(run_all("docs/api.md", &server) >= 40 || !has_grpcurl());
}
