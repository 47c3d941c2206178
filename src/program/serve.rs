//! `serve`: runs the server until it is interrupted.

use std::io::Write;
use std::net::{IpAddr, Ipv4Addr, Ipv6Addr, SocketAddr};

use calipers::config::{SettingArgs, Settings};
use calipers::{observe, serve};
use clap::Args;
use tokio::signal::unix::{Signal, SignalKind, signal};

use super::{Failure, demo};

/// Runs the server until it is interrupted.
#[derive(Debug, Args)]
#[command(
    after_help = "Settings come from flags, then the environment, then the file that --config names, then the defaults. \
                  SIGINT (Ctrl-C) and SIGTERM stop the server cleanly; a second one stops it at once."
)]
pub(crate) struct Serve {
    /// Also makes a level with a few hundred moving shapes, to try things on
    #[arg(long)]
    demo: bool,
    /// With --demo: the number the level is made from; the same number makes the same level
    #[arg(long, value_name = "NUMBER", default_value_t = 1, requires = "demo")]
    seed: u64,
    #[command(flatten)]
    settings: SettingArgs,
}

impl Serve {
    pub(crate) async fn run(self, out: &mut impl Write) -> Result<(), Failure> {
        let settings = Settings::load(self.settings)?;
        observe::start(&settings)?;
        // Before anything is announced, so that whoever read the announcement may interrupt.
        let mut stops = Stops::listen()?;
        let running = serve::start(settings.clone()).await?;
        let address = running.local_addr();
        let show = if self.demo { Some(demo::start(&running, &settings, self.seed).await?) } else { None };
        let told = match &show {
            Some(show) => show.about(reachable(address)),
            None => first_steps(reachable(address), &settings),
        };
        let version = env!("CARGO_PKG_VERSION");
        if let Err(error) = writeln!(out, "calipers {version} listens on {address}\n{told}") {
            // A server serves on, whether or not somebody reads this.
            tracing::warn!(%error, "standard output cannot be written to");
        }
        tokio::select! {
            () = stops.next() => {}
            () = running.stopped() => return Err(Failure::new("the server ended by itself; its log says why")),
        }
        if let Some(show) = show {
            show.stop().await;
        }
        tokio::select! {
            () = running.stop() => Ok(()),
            () = stops.next() => Err(Failure::new("stopped at once by a second signal; open calls were cut off")),
        }
    }
}

/// A server that listens everywhere is reached here under this machine's own address.
fn reachable(address: SocketAddr) -> SocketAddr {
    if !address.ip().is_unspecified() {
        return address;
    }
    let here = match address {
        SocketAddr::V4(_) => IpAddr::from(Ipv4Addr::LOCALHOST),
        SocketAddr::V6(_) => IpAddr::from(Ipv6Addr::LOCALHOST),
    };
    SocketAddr::new(here, address.port())
}

/// Lines that can be pasted.
fn first_steps(address: SocketAddr, settings: &Settings) -> String {
    if !settings.has_default_session() {
        return format!(
            "There is no open session here; make one:\n  grpcurl -plaintext -d '{{\"session\":\"mine\"}}' {address} \
             calipers.v1.SessionService/CreateSession"
        );
    }
    let insert = r#"{"edits":[{"insert":{"id":1,"geometry":{"sphere":{"radius":1}},"pose":{"position":{"z":5}}}}]}"#;
    format!(
        "Insert a sphere, and ask a ray for it:\n  grpcurl -plaintext -d '{insert}' {address} \
         calipers.v1.WorldService/Edit\n  grpcurl -plaintext -d '{{\"direction\":{{\"z\":1}}}}' {address} \
         calipers.v1.QueryService/Raycast"
    )
}

/// The signals that ask the program to stop.
#[derive(Debug)]
struct Stops {
    interrupt: Signal,
    terminate: Signal,
}

impl Stops {
    fn listen() -> Result<Self, Failure> {
        Ok(Self { interrupt: signal(SignalKind::interrupt())?, terminate: signal(SignalKind::terminate())? })
    }

    /// The next of them.
    async fn next(&mut self) {
        tokio::select! {
            _ = self.interrupt.recv() => tracing::info!("SIGINT"),
            _ = self.terminate.recv() => tracing::info!("SIGTERM"),
        }
    }
}
