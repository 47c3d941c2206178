//! Servers as processes of their own, so that their processor time can be told from the client's.

use std::io::{BufRead, BufReader, Write, stdin, stdout};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

use calipers::{config::Settings, serve};
use calipers_client::Client;
use rustix::time::{ClockId, clock_gettime};
use tokio_stream::wrappers::TcpListenerStream;
use wire::v1::query_service_server::QueryServiceServer;

use crate::Failure;
use crate::echo::Echo;

/// What a child serves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// The same answer to everything.
    Echo,
    /// The real server.
    Real,
}

impl Kind {
    pub(crate) fn flag(self) -> &'static str {
        match self {
            Self::Echo => "--serve-echo",
            Self::Real => "--serve-real",
        }
    }
}

/// A server in a process of its own, which ends when this is dropped.
#[derive(Debug)]
pub(crate) struct Server {
    child: Child,
    pipes: Mutex<Pipes>,
    address: String,
}

/// A line to the child asks for its processor time, a line from it tells it.
#[derive(Debug)]
struct Pipes {
    questions: Option<ChildStdin>,
    answers: BufReader<ChildStdout>,
}

impl Server {
    /// Starts one on a free port.
    pub(crate) fn start(kind: Kind) -> Result<Self, Failure> {
        let mut command = Command::new(std::env::current_exe()?);
        let mut child = command.arg(kind.flag()).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn()?;
        let questions = child.stdin.take();
        let mut answers = BufReader::new(child.stdout.take().ok_or("the child has no output")?);
        let mut address = String::new();
        answers.read_line(&mut address)?;
        let pipes = Mutex::new(Pipes { questions, answers });
        Ok(Self { child, pipes, address: address.trim().to_owned() })
    }

    /// A client of it.
    pub(crate) async fn client(&self) -> Result<Client, Failure> {
        Ok(Client::connect(&self.address).await?)
    }

    /// Processor time that it has taken, of all its threads, those that have ended included.
    pub(crate) fn cpu(&self) -> Result<Duration, Failure> {
        let mut pipes = self.pipes.lock().unwrap_or_else(PoisonError::into_inner);
        writeln!(pipes.questions.as_mut().ok_or("the child has no input")?)?;
        let mut nanoseconds = String::new();
        pipes.answers.read_line(&mut nanoseconds)?;
        Ok(Duration::from_nanos(nanoseconds.trim().parse()?))
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        // The child ends when its input does; one that hangs is not worth an error here.
        self.pipes.get_mut().unwrap_or_else(PoisonError::into_inner).questions = None;
        let _ = self.child.wait();
    }
}

/// What a child does: it serves until its input ends.
pub(crate) async fn serve(kind: Kind) -> Result<(), Failure> {
    let ended = tokio::task::spawn_blocking(|| stdin().lock().lines().try_for_each(|_| tell_cpu()));
    match kind {
        Kind::Echo => {
            let listener = tokio::net::TcpListener::bind("127.0.0.1:0").await?;
            say(&listener.local_addr()?.to_string())?;
            let incoming = TcpListenerStream::new(listener);
            let incoming = tokio_stream::StreamExt::map(incoming, |stream| {
                let stream = stream?;
                stream.set_nodelay(true)?;
                Ok::<_, std::io::Error>(stream)
            });
            let served = tonic::transport::Server::builder()
                .add_service(QueryServiceServer::new(Echo))
                .serve_with_incoming_shutdown(incoming, async {
                    let _ = ended.await;
                });
            served.await?;
        }
        Kind::Real => {
            let settings = Settings { listen: "127.0.0.1:0".parse()?, ..Settings::default() };
            let running = serve::start(settings).await?;
            say(&running.local_addr().to_string())?;
            let _ = ended.await;
            running.stop().await;
        }
    }
    Ok(())
}

fn tell_cpu() -> Result<(), Failure> {
    let taken = clock_gettime(ClockId::ProcessCPUTime);
    say(&(i128::from(taken.tv_sec) * 1_000_000_000 + i128::from(taken.tv_nsec)).to_string())
}

fn say(line: &str) -> Result<(), Failure> {
    let mut out = stdout();
    writeln!(out, "{line}")?;
    Ok(out.flush()?)
}
