//! Servers as processes of their own, so that their processor time can be told from the client's.

use std::io::{BufRead, BufReader, Write, stdin, stdout};
use std::process::{Child, Command, Stdio};
use std::time::Duration;

use calipers::{config::Settings, serve};
use calipers_client::Client;
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
    address: String,
}

impl Server {
    /// Starts one on a free port.
    pub(crate) fn start(kind: Kind) -> Result<Self, Failure> {
        let mut command = Command::new(std::env::current_exe()?);
        let mut child = command.arg(kind.flag()).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn()?;
        let mut address = String::new();
        let out = child.stdout.take().ok_or("the child has no output")?;
        BufReader::new(out).read_line(&mut address)?;
        Ok(Self { child, address: address.trim().to_owned() })
    }

    /// A client of it.
    pub(crate) async fn client(&self) -> Result<Client, Failure> {
        Ok(Client::connect(&self.address).await?)
    }

    /// Processor time that it has taken, of all its threads.
    pub(crate) fn cpu(&self) -> Result<Duration, Failure> {
        let mut nanoseconds = 0;
        for task in std::fs::read_dir(format!("/proc/{}/task", self.child.id()))? {
            let line = std::fs::read_to_string(task?.path().join("schedstat"))?;
            nanoseconds += line.split(' ').next().unwrap_or("0").parse::<u64>()?;
        }
        Ok(Duration::from_nanos(nanoseconds))
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        // The child ends when its input does; one that hangs is not worth an error here.
        drop(self.child.stdin.take());
        let _ = self.child.wait();
    }
}

/// What a child does: it serves until its input ends.
pub(crate) async fn serve(kind: Kind) -> Result<(), Failure> {
    let ended = tokio::task::spawn_blocking(|| stdin().lock().lines().count());
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

fn say(address: &str) -> Result<(), Failure> {
    let mut out = stdout();
    writeln!(out, "{address}")?;
    Ok(out.flush()?)
}
