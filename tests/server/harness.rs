//! Starts servers on free ports and makes clients of them.

use calipers::{
    config::Settings,
    serve::{self, Running},
};

/// Settings for a test: any free port.
pub(crate) fn settings() -> Settings {
    Settings {
        listen: "127.0.0.1:0".parse().expect("an address"),
        ..Settings::default()
    }
}

/// A server with these settings.
pub(crate) async fn start_with(settings: Settings) -> Running {
    serve::start(settings).await.expect("the server starts")
}

/// A server with the settings of [`settings`].
pub(crate) async fn start() -> Running {
    start_with(settings()).await
}
