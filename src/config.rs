//! What can be set about a server, and where a setting comes from.
//!
//! Later layers win: the defaults below, an optional TOML file, the environment (`CALIPERS_…`), the flags.

use std::{
    fs, io,
    net::{Ipv4Addr, SocketAddr},
    path::PathBuf,
    time::Duration,
};

use clap::{Args, ValueEnum};
use collision::shape::PartsAsked;
use serde::Deserialize;

/// The shortest and the longest lease of a session.
pub const LEASE_RANGE: (Duration, Duration) = (Duration::from_secs(1), Duration::from_secs(30 * 24 * 3600));

/// Everything that can be set about a server.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// Address and port to listen on; port 0 takes any free one. Default `127.0.0.1:7070`.
    pub listen: SocketAddr,
    /// Allows listening beyond loopback without TLS. Default: refused.
    pub insecure: Insecure,
    /// The operator's token, which `ListSessions` needs. Default: none, so that nobody may list.
    pub operator_token: Option<String>,
    /// Whether there is an open session `default`, which needs neither token nor lease. Default: on loopback only.
    pub default_session: DefaultSession,
    /// Most sessions at a time. Default 1,024.
    pub max_sessions: usize,
    /// Lease of a session that names none, 1 s to 30 days. Default 1 h.
    pub default_lease: Duration,
    /// Memory that one session's geometries and world may hold, bytes. Its history may take an eighth of that on top, and
    /// what questions to the past had built as much. Default 4 GiB.
    pub session_memory_bytes: u64,
    /// Shapes that one session may hold. Default 1,000,000.
    pub session_shapes: usize,
    /// Steps that cutting one mesh into convex parts may take where a request asks for them, some 100 ns each; at least 1. One worker
    /// cuts for all sessions, so this is how long others may have to wait. Parts that questions need always may take 2³². Default 2³².
    pub decompose_steps: u64,
    /// Unary calls that are worked on at a time, of all clients together; more wait shortly and are then refused.
    /// Default 512.
    pub max_in_flight: usize,
    /// How log lines are written. Default: for people on a terminal, JSON otherwise.
    pub log_format: LogFormat,
    /// Which log lines are written: a level, or `target=level`, several by commas. Default `info`.
    pub log_filter: String,
    /// How long a stop waits for calls and streams to end. Default 30 s.
    pub drain_limit: Duration,
}

/// Whether a server may listen beyond loopback without TLS.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Insecure {
    /// It may not.
    #[default]
    Refused,
    /// It may: tokens and worlds then cross the network in the clear.
    Allowed,
}

/// Whether there is an open session `default`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum DefaultSession {
    /// On loopback only.
    #[default]
    Auto,
    /// Always, for everyone who reaches the port.
    On,
    /// Never.
    Off,
}

/// How log lines are written.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum LogFormat {
    /// For people on a terminal, JSON otherwise.
    #[default]
    Auto,
    /// For people.
    Human,
    /// One JSON object a line.
    Json,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            listen: SocketAddr::from((Ipv4Addr::LOCALHOST, 7070)),
            insecure: Insecure::default(),
            operator_token: None,
            default_session: DefaultSession::default(),
            max_sessions: 1024,
            default_lease: Duration::from_secs(3600),
            session_memory_bytes: 4 << 30,
            session_shapes: 1_000_000,
            decompose_steps: PartsAsked::STEPS_USUAL,
            max_in_flight: 512,
            log_format: LogFormat::default(),
            log_filter: "info".to_owned(),
            drain_limit: Duration::from_secs(30),
        }
    }
}

/// The settings as flags and environment variables, and where the TOML file is. What is absent is left to lower layers.
#[derive(Clone, Debug, Default, Args)]
pub struct SettingArgs {
    /// TOML file with settings, named as the flags with underscores (`max_sessions = 8`)
    #[arg(long, env = "CALIPERS_CONFIG", value_name = "FILE")]
    pub config: Option<PathBuf>,
    /// The settings given as flags or by the environment.
    #[command(flatten)]
    pub layer: Layer,
}

/// One layer of settings: what it leaves out is left to the layers below. Its comments are the program's help.
#[derive(Clone, Debug, Default, Args, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Layer {
    /// Address and port to listen on; port 0 takes any free one [default: 127.0.0.1:7070]
    #[arg(long, env = "CALIPERS_LISTEN", value_name = "ADDR:PORT")]
    pub listen: Option<SocketAddr>,
    /// Listen beyond loopback although there is no TLS: tokens and worlds then cross the network in the clear
    #[arg(long, env = "CALIPERS_INSECURE", num_args = 0..=1, default_missing_value = "true", value_name = "BOOL")]
    pub insecure: Option<bool>,
    /// The operator's token, which ListSessions needs [default: none, so that nobody may list]
    #[arg(long, env = "CALIPERS_OPERATOR_TOKEN", hide_env_values = true, value_name = "TOKEN")]
    pub operator_token: Option<String>,
    /// Whether there is an open session "default" without token or lease [default: auto, on loopback only]
    #[arg(long, env = "CALIPERS_DEFAULT_SESSION", value_name = "WHEN")]
    pub default_session: Option<DefaultSession>,
    /// Most sessions at a time [default: 1024]
    #[arg(long, env = "CALIPERS_MAX_SESSIONS", value_name = "COUNT")]
    pub max_sessions: Option<usize>,
    /// Lease of a session that names none, in seconds, 1 to 2592000 [default: 3600]
    #[arg(long, env = "CALIPERS_DEFAULT_LEASE_S", value_name = "SECONDS")]
    pub default_lease_s: Option<u64>,
    /// Memory that one session may hold, in bytes [default: 4294967296]
    #[arg(long, env = "CALIPERS_SESSION_MEMORY_BYTES", value_name = "BYTES")]
    pub session_memory_bytes: Option<u64>,
    /// Shapes that one session may hold [default: 1000000]
    #[arg(long, env = "CALIPERS_SESSION_SHAPES", value_name = "COUNT")]
    pub session_shapes: Option<usize>,
    /// Steps that cutting one mesh into convex parts may take, some 100 ns each [default: 4294967296]
    #[arg(long, env = "CALIPERS_DECOMPOSE_STEPS", value_name = "COUNT")]
    pub decompose_steps: Option<u64>,
    /// Unary calls that are worked on at a time, of all clients together [default: 512]
    #[arg(long, env = "CALIPERS_MAX_IN_FLIGHT", value_name = "COUNT")]
    pub max_in_flight: Option<usize>,
    /// How log lines are written [default: auto, for people on a terminal, JSON otherwise]
    #[arg(long, env = "CALIPERS_LOG_FORMAT", value_name = "FORMAT")]
    pub log_format: Option<LogFormat>,
    /// Which log lines are written: a level, or TARGET=LEVEL, several by commas [default: info]
    #[arg(long, env = "CALIPERS_LOG_FILTER", value_name = "FILTER")]
    pub log_filter: Option<String>,
    /// How long a stop waits for calls and streams to end, in seconds, 0 to 30 [default: 30]
    #[arg(long, env = "CALIPERS_DRAIN_LIMIT_S", value_name = "SECONDS")]
    pub drain_limit_s: Option<u64>,
}

/// Why settings are refused.
#[derive(Debug, thiserror::Error)]
pub enum ConfigError {
    /// The file cannot be read.
    #[error("the settings file {} cannot be read: {source}", path.display())]
    Read {
        /// Which file.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// The file is not TOML, or names no setting.
    #[error("the settings file {} is wrong: {source}", path.display())]
    Parse {
        /// Which file.
        path: PathBuf,
        /// Where and why.
        source: Box<toml::de::Error>,
    },
    /// A value is outside its range.
    #[error("{setting} is {found}: it must be {allowed}")]
    OutOfRange {
        /// Which setting.
        setting: &'static str,
        /// What was found.
        found: String,
        /// What would be right.
        allowed: &'static str,
    },
    /// Listening beyond loopback without TLS.
    #[error(
        "listening on {0} would let others on the network reach this server without TLS; listen on 127.0.0.1, or add \
         --insecure (CALIPERS_INSECURE=true) if that network is trusted"
    )]
    NotLoopback(SocketAddr),
}

impl Settings {
    /// Settings from all layers: flags and environment (in `args`), the file they name, the defaults.
    ///
    /// # Errors
    /// A file that cannot be read or understood, a value outside its range, an address beyond loopback without
    /// `insecure`.
    pub fn load(args: SettingArgs) -> Result<Self, ConfigError> {
        let mut settings = Self::default();
        if let Some(path) = args.config {
            settings.take(read_layer(path)?);
        }
        settings.take(args.layer);
        settings.check()?;
        Ok(settings)
    }

    /// Checks ranges and that nobody is exposed by mistake.
    ///
    /// # Errors
    /// A value outside its range, an address beyond loopback without `insecure`.
    pub fn check(&self) -> Result<(), ConfigError> {
        for (setting, found) in [
            ("max_sessions", self.max_sessions),
            ("session_shapes", self.session_shapes),
            ("max_in_flight", self.max_in_flight),
        ] {
            if found == 0 {
                return Err(out_of_range(setting, found, "at least 1"));
            }
        }
        if self.decompose_steps == 0 {
            return Err(out_of_range("decompose_steps", 0, "at least 1"));
        }
        let (shortest, longest) = LEASE_RANGE;
        if self.default_lease < shortest || self.default_lease > longest {
            let found = self.default_lease.as_secs();
            return Err(out_of_range("default_lease_s", found, "1 to 2592000 (30 days)"));
        }
        if self.drain_limit > Duration::from_secs(30) {
            return Err(out_of_range("drain_limit_s", self.drain_limit.as_secs(), "0 to 30"));
        }
        if !self.listen.ip().is_loopback() && self.insecure == Insecure::Refused {
            return Err(ConfigError::NotLoopback(self.listen));
        }
        Ok(())
    }

    /// Whether this server has the open session `default`.
    #[must_use]
    pub fn has_default_session(&self) -> bool {
        match self.default_session {
            DefaultSession::Auto => self.listen.ip().is_loopback(),
            DefaultSession::On => true,
            DefaultSession::Off => false,
        }
    }

    fn take(&mut self, layer: Layer) {
        replace(&mut self.listen, layer.listen);
        replace(
            &mut self.insecure,
            layer.insecure.map(|allowed| if allowed { Insecure::Allowed } else { Insecure::Refused }),
        );
        if layer.operator_token.is_some() {
            self.operator_token = layer.operator_token;
        }
        replace(&mut self.default_session, layer.default_session);
        replace(&mut self.max_sessions, layer.max_sessions);
        replace(&mut self.default_lease, layer.default_lease_s.map(Duration::from_secs));
        replace(&mut self.session_memory_bytes, layer.session_memory_bytes);
        replace(&mut self.session_shapes, layer.session_shapes);
        replace(&mut self.decompose_steps, layer.decompose_steps);
        replace(&mut self.max_in_flight, layer.max_in_flight);
        replace(&mut self.log_format, layer.log_format);
        replace(&mut self.log_filter, layer.log_filter);
        replace(&mut self.drain_limit, layer.drain_limit_s.map(Duration::from_secs));
    }
}

fn replace<T>(setting: &mut T, given: Option<T>) {
    if let Some(value) = given {
        *setting = value;
    }
}

fn out_of_range(setting: &'static str, found: impl ToString, allowed: &'static str) -> ConfigError {
    ConfigError::OutOfRange { setting, found: found.to_string(), allowed }
}

fn read_layer(path: PathBuf) -> Result<Layer, ConfigError> {
    match fs::read_to_string(&path) {
        Ok(text) => toml::from_str(&text).map_err(|source| ConfigError::Parse { path, source: Box::new(source) }),
        Err(source) => Err(ConfigError::Read { path, source }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn flags_win_over_the_file_and_the_file_over_defaults() {
        let path = std::env::temp_dir().join(format!("calipers-settings-{}.toml", std::process::id()));
        fs::write(&path, "max_sessions = 7\nsession_shapes = 9\ndefault_session = \"off\"\n").unwrap();
        let settings = Settings::load(SettingArgs {
            config: Some(path.clone()),
            layer: Layer { max_sessions: Some(3), ..Layer::default() },
        })
        .unwrap();
        fs::remove_file(path).unwrap();
        assert_eq!(settings.max_sessions, 3);
        assert_eq!(settings.session_shapes, 9);
        assert!(!settings.has_default_session());
        assert_eq!(settings.max_in_flight, Settings::default().max_in_flight);
    }

    #[test]
    fn a_misspelt_setting_in_the_file_is_refused_by_name() {
        let path = std::env::temp_dir().join(format!("calipers-misspelt-{}.toml", std::process::id()));
        fs::write(&path, "max_session = 7\n").unwrap();
        let args = SettingArgs { config: Some(path.clone()), ..SettingArgs::default() };
        let message = Settings::load(args).unwrap_err().to_string();
        fs::remove_file(path).unwrap();
        assert!(message.contains("max_session"), "{message}");
    }

    #[test]
    fn beyond_loopback_needs_insecure() {
        let mut settings = Settings { listen: "0.0.0.0:7070".parse().unwrap(), ..Settings::default() };
        let message = settings.check().unwrap_err().to_string();
        assert!(message.contains("--insecure"), "{message}");
        settings.insecure = Insecure::Allowed;
        settings.check().unwrap();
        assert!(!settings.has_default_session(), "an open session is for loopback only unless asked for");
    }

    #[test]
    fn a_lease_beyond_the_range_is_refused() {
        let layer = Layer { default_lease_s: Some(0), ..Layer::default() };
        let message = Settings::load(SettingArgs { config: None, layer }).unwrap_err().to_string();
        assert!(message.contains("default_lease_s is 0"), "{message}");
    }
}
