//! Which server, session and right a command uses.

use std::time::Duration;

use calipers_client::Client;
use clap::Args;

use super::Failure;

/// Where a command goes.
#[derive(Debug, Args)]
pub(crate) struct Target {
    /// The server
    #[arg(long, env = "CALIPERS_SERVER", value_name = "ADDR:PORT", default_value = "127.0.0.1:7070")]
    server: String,
    /// The session whose world is meant
    #[arg(long, env = "CALIPERS_SESSION", value_name = "ID", default_value = "default")]
    session: String,
    /// The token that gives a right to it; the session "default" of a server on loopback needs none
    #[arg(long, env = "CALIPERS_TOKEN", value_name = "TOKEN", hide_env_values = true)]
    token: Option<String>,
}

impl Target {
    /// A client whose calls are given up after `deadline`.
    pub(crate) async fn connect(&self, deadline: Duration) -> Result<Client, Failure> {
        let client = Client::connect(&self.server).await?.with_session(self.session.as_str()).with_deadline(deadline);
        match &self.token {
            Some(token) => Ok(client.with_token(token)?),
            None => Ok(client),
        }
    }
}
