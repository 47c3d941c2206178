//! Runs the built program.

use std::fs;
use std::io::{BufRead, BufReader, Lines, Read};
use std::path::PathBuf;
use std::process::{Child, ChildStdout, Command, Output, Stdio};
use std::sync::atomic::{AtomicU32, Ordering};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

/// What a command said and how it ended.
#[derive(Debug)]
pub(crate) struct Said {
    pub(crate) code: Option<i32>,
    pub(crate) out: String,
    pub(crate) err: String,
}

/// The program with these arguments, free of settings from this process's environment.
fn command(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_calipers"));
    for (name, _) in std::env::vars().filter(|(name, _)| name.starts_with("CALIPERS_")) {
        command.env_remove(name);
    }
    command.args(arguments);
    command
}

/// Runs a command to its end.
pub(crate) fn run(arguments: &[&str]) -> Said {
    Said::from(command(arguments).output().expect("the program can be run"))
}

/// Runs a command that goes on for ever, interrupts it after a while, and waits for its end.
pub(crate) fn run_interrupted(arguments: &[&str], after: Duration) -> Said {
    let mut command = command(arguments);
    command.stdout(Stdio::piped()).stderr(Stdio::piped());
    let child = command.spawn().expect("the program can be run");
    thread::sleep(after);
    signal(&child, "INT");
    Said::from(child.wait_with_output().expect("the program can be waited for"))
}

impl From<Output> for Said {
    fn from(Output { status, stdout, stderr }: Output) -> Self {
        let text = |bytes| String::from_utf8(bytes).expect("the program writes text");
        Self { code: status.code(), out: text(stdout), err: text(stderr) }
    }
}

/// Sends a signal, such as `INT`.
fn signal(child: &Child, name: &str) {
    // The shell's own kill, because not every system has one as a program.
    let line = format!("kill -{name} {}", child.id());
    assert!(Command::new("sh").args(["-c", &line]).status().expect("there is a shell").success());
}

/// Runs a command that must succeed, and returns what it printed.
pub(crate) fn run_well(arguments: &[&str]) -> String {
    let said = run(arguments);
    assert_eq!(said.code, Some(0), "{arguments:?}: {said:?}");
    said.out
}

/// A server of its own for a test; ended by force when it is dropped.
#[derive(Debug)]
pub(crate) struct Server {
    child: Child,
    address: String,
    /// The lines it printed on its first breath, up to the one that can be pasted.
    pub(crate) announced: String,
    log: Option<JoinHandle<String>>,
    /// Kept open, so that whatever it still prints finds a reader.
    _lines: Lines<BufReader<ChildStdout>>,
}

impl Server {
    /// Starts `calipers serve` on a free port, and waits until it says where it listens.
    pub(crate) fn start(arguments: &[&str]) -> Self {
        let arguments = [&["serve", "--listen", "127.0.0.1:0"], arguments].concat();
        let mut child =
            command(&arguments).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("the program can be run");
        let mut stderr = child.stderr.take().expect("standard error is piped");
        let log = thread::spawn(move || {
            let mut text = String::new();
            stderr.read_to_string(&mut text).expect("the program writes text");
            text
        });
        let mut lines = BufReader::new(child.stdout.take().expect("standard output is piped")).lines();
        let mut announced = String::new();
        let mut address = None;
        // The announcement ends with the line that asks the first ray.
        while !announced.contains("calipers.v1.QueryService/Raycast") {
            let line = lines.next().expect("the server announces itself").expect("the program writes text");
            if let Some((_, after)) = line.split_once(" listens on ") {
                address = Some(after.to_owned());
            }
            announced += &line;
            announced.push('\n');
        }
        let address = address.expect("the announcement says where it listens");
        Self { child, address, announced, log: Some(log), _lines: lines }
    }

    pub(crate) fn address(&self) -> &str {
        &self.address
    }

    /// Sends a signal, such as `INT`.
    pub(crate) fn signal(&self, name: &str) {
        signal(&self.child, name);
    }

    /// Waits for its end; returns its exit code and its log.
    pub(crate) fn wait(mut self, limit: Duration) -> (Option<i32>, String) {
        let deadline = Instant::now() + limit;
        let status = loop {
            match self.child.try_wait().expect("the program can be waited for") {
                Some(status) => break status,
                None => assert!(Instant::now() < deadline, "the server still runs after {limit:?}"),
            }
            thread::sleep(Duration::from_millis(5));
        };
        let log = self.log.take().expect("the log is read once").join().expect("the log is text");
        (status.code(), log)
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        // Both fail if it has ended, which is what is wanted.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// A file that is removed when it is dropped.
#[derive(Debug)]
pub(crate) struct Scratch(PathBuf);

impl Scratch {
    pub(crate) fn new(ending: &str, contents: impl AsRef<[u8]>) -> Self {
        static COUNT: AtomicU32 = AtomicU32::new(0);
        let number = COUNT.fetch_add(1, Ordering::Relaxed);
        let path = std::env::temp_dir().join(format!("calipers-test-{}-{number}{ending}", std::process::id()));
        fs::write(&path, contents).expect("the folder for temporary files is writable");
        Self(path)
    }

    pub(crate) fn path(&self) -> &str {
        self.0.to_str().expect("the folder for temporary files has a name of text")
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        // What is gone already needs no removing.
        let _ = fs::remove_file(&self.0);
    }
}
