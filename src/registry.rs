//! All sessions of a server: found by name and entered by token, made, listed, ended.

use std::{
    collections::BTreeMap,
    ops::Bound::{Excluded, Unbounded},
    sync::{Arc, LazyLock},
    time::{Duration, Instant},
};

use collision::world::{Means, Settings as WorldSettings, Snapshot};
use parking_lot::{Mutex, RwLock};
use tokio::sync::Semaphore;

use crate::{
    config::Settings,
    geometries::{Geometries, Quotas},
    problem::{Checked, Problem, Reason, quoted},
    retry::{RetryCache, RetryKey},
    session::{Access, Session},
    token::{Role, TokenHash, Tokens, random_hex},
    writer::Writer,
};

/// The session that an empty name means.
pub(crate) const DEFAULT: &str = "default";
/// Settings of a world whose creator names none.
pub(crate) const DEFAULT_SETTINGS: WorldSettings = WorldSettings { history_ticks: 64, margin: None };
/// The history, and what questions to it had built, may each hold this part of what a session may hold, on top of that.
const HISTORY_SHARE: u64 = 8;
/// How often leases are looked at.
const SWEEP_EVERY: Duration = Duration::from_millis(250);
/// Of how many looks at the leases one tidies the sessions as well: every 10 s.
const TIDY_OF: u32 = 40;
/// How often an id is chosen anew because it was taken; at 64 random bits once is already improbable.
const CHOICES: usize = 8;

/// All sessions.
#[derive(Debug)]
pub(crate) struct Registry {
    settings: Settings,
    operator: Option<TokenHash>,
    sessions: RwLock<BTreeMap<String, Arc<Session>>>,
    /// Sessions made, for retries. For five minutes this holds what the first answer held, token included.
    created: Mutex<RetryCache<Created>>,
    /// Places for calls of all sessions that wait for a tick: half of those in flight, so that others get through.
    waiting: Arc<Semaphore>,
}

/// A session that was made, and its owner's token.
#[derive(Clone, Debug)]
pub(crate) struct Created {
    pub(crate) session: Arc<Session>,
    pub(crate) token: String,
}

impl Registry {
    /// The registry of a new server, with the open session if the settings want it.
    ///
    /// # Errors
    /// The open session's world cannot be made.
    pub(crate) fn new(settings: Settings) -> Checked<Self> {
        let registry = Self {
            operator: settings.operator_token.as_deref().map(TokenHash::of),
            sessions: RwLock::default(),
            created: Mutex::default(),
            waiting: Arc::new(Semaphore::new((settings.max_in_flight / 2).clamp(1, Semaphore::MAX_PERMITS))),
            settings,
        };
        if registry.settings.has_default_session() {
            registry.sessions.write().insert(DEFAULT.to_owned(), registry.open_session()?);
        }
        Ok(registry)
    }

    /// The session of a name, for a caller who may do at least what `least` may. Renews its lease.
    ///
    /// # Errors
    /// There is no such session, no token, a wrong one, or one that allows too little.
    pub(crate) fn enter(&self, name: &str, token: Option<&str>, least: Role) -> Checked<(Arc<Session>, Role)> {
        let session = self.find(name)?;
        let role = session.role_of(token)?;
        if role < least {
            let what = format!(
                "the token's role is {}, and this call needs {}: send a token of that role, which CreateToken makes",
                role.name(),
                least.name()
            );
            return Err(Problem::new(Reason::RoleTooLow, what));
        }
        session.lease.renew(None);
        Ok((session, role))
    }

    /// Checks that a caller is the operator.
    ///
    /// # Errors
    /// No token, or another one; this server has no operator's token.
    pub(crate) fn check_operator(&self, token: Option<&str>) -> Checked<()> {
        match (self.operator, token) {
            (None, _) => Err(Problem::new(
                Reason::RoleTooLow,
                "this server has no operator's token: start it with operator_token to allow this call",
            )),
            (Some(_), None) => Err(Problem::new(
                Reason::NoToken,
                "this call needs the operator's token, as `authorization: Bearer TOKEN`",
            )),
            (Some(operator), Some(token)) if operator == TokenHash::of(token) => Ok(()),
            (Some(_), Some(_)) => Err(Problem::new(
                Reason::RoleTooLow,
                "the token is not the operator's: send the one that the server was started with, as operator_token",
            )),
        }
    }

    /// Makes a session with an empty world; the same one again if `retry` was seen before.
    ///
    /// # Errors
    /// The id is taken or not well formed, there are too many sessions.
    pub(crate) fn create(
        &self,
        wish: &str,
        lease: Option<Duration>,
        retry: Option<RetryKey>,
        settings: WorldSettings,
    ) -> Checked<Created> {
        self.make("session", wish, lease, retry, || self.empty(settings))
    }

    /// Makes a session whose world begins as a copy of a snapshot of another's; the same one again if `retry` was seen
    /// before.
    ///
    /// # Errors
    /// The id is taken or not well formed, there are too many sessions.
    pub(crate) fn fork(
        &self,
        wish: &str,
        lease: Option<Duration>,
        retry: Option<RetryKey>,
        (origin, snapshot): (&Session, &Snapshot),
    ) -> Checked<Created> {
        self.make("fork", wish, lease, retry, || Ok((Writer::fork(snapshot)?, origin.geometries.fork())))
    }

    fn make(
        &self,
        field: &'static str,
        wish: &str,
        lease: Option<Duration>,
        retry: Option<RetryKey>,
        world: impl FnOnce() -> Checked<(Writer, Geometries)>,
    ) -> Checked<Created> {
        let now = Instant::now();
        // Held throughout, so that a retry which comes while the first is under way waits for its answer.
        let mut created = self.created.lock();
        if let Some(first) = created.find(retry.as_ref(), now)? {
            return Ok(first);
        }
        let id = if wish.is_empty() { self.choose_id()? } else { checked_id(field, wish)? };
        let mut tokens = Tokens::default();
        let token = tokens.create(Role::Owner)?;
        let lease = lease.unwrap_or(self.settings.default_lease);
        let access = Access::ByToken(Mutex::new(tokens));
        let session = self.session(id.clone(), access, Some(lease), world()?);
        let mut sessions = self.sessions.write();
        if sessions.contains_key(&id) {
            let what = format!("is {id:?}, which is taken: choose another id, or leave it empty");
            return Err(Problem::at(field, Reason::SessionExists, what));
        }
        let limit = self.settings.max_sessions;
        if sessions.len() >= limit {
            let what = format!("the server has {limit} sessions, which is the most it may have: delete one first");
            return Err(Problem::new(Reason::QuotaExceeded, what).with("quota", "max_sessions").with("limit", limit));
        }
        sessions.insert(id, session.clone());
        let answer = Created { session, token };
        created.keep(retry, &answer, now);
        tracing::info!(session = answer.session.id, "session created");
        Ok(answer)
    }

    /// Ends a session that `enter` gave. The open session begins anew, at tick 1.
    ///
    /// # Errors
    /// The open session's new world cannot be made.
    pub(crate) fn end(&self, session: &Arc<Session>) -> Checked<()> {
        let renewed = match self.is_open(session) {
            true => Some(self.open_session()?),
            false => None,
        };
        let mut sessions = self.sessions.write();
        // Somebody may have ended it, and made another of that name, meanwhile.
        if sessions.get(&session.id).is_some_and(|held| Arc::ptr_eq(held, session)) {
            sessions.remove(&session.id);
            sessions.extend(renewed.map(|renewed| (session.id.clone(), renewed)));
        }
        drop(sessions);
        session.ended.cancel();
        tracing::info!(session = session.id, "session ended");
        Ok(())
    }

    /// Sessions after `after`, by id, at most `most`.
    pub(crate) fn after(&self, after: &str, most: usize) -> Vec<Arc<Session>> {
        let sessions = self.sessions.read();
        let from = if after.is_empty() { Unbounded } else { Excluded(after) };
        let range = sessions.range::<str, _>((from, Unbounded));
        range.take(most).map(|(_, session)| session.clone()).collect()
    }

    /// Ends sessions whose lease is over, for as long as the server lives.
    pub(crate) async fn sweep_leases(&self) {
        let mut every = tokio::time::interval(SWEEP_EVERY);
        every.set_missed_tick_behavior(tokio::time::MissedTickBehavior::Delay);
        for look in (0..TIDY_OF).cycle() {
            every.tick().await;
            let sessions: Vec<_> = self.sessions.read().values().cloned().collect();
            for session in sessions {
                if look == 0 {
                    session.sweep();
                }
                if session.lease.is_over()
                    && let Err(problem) = self.end(&session)
                {
                    tracing::error!(session = session.id, ?problem, "a session could not be ended");
                }
            }
        }
    }

    fn find(&self, name: &str) -> Checked<Arc<Session>> {
        let wanted = if name.is_empty() { DEFAULT } else { name };
        let found = self.sessions.read().get(wanted).filter(|session| !session.lease.is_over()).cloned();
        found.ok_or_else(|| {
            let what = if name.is_empty() {
                "is empty, which means \"default\", and this server has no such session: name the one that CreateSession \
                 gave"
                    .to_owned()
            } else {
                format!("is {}: there is no such session; it may have ended with its lease; CreateSession makes one", quoted(name))
            };
            Problem::at("session", Reason::SessionNotFound, what)
        })
    }

    fn open_session(&self) -> Checked<Arc<Session>> {
        let access = Access::Open(Mutex::default());
        Ok(self.session(DEFAULT.to_owned(), access, None, self.empty(DEFAULT_SETTINGS)?))
    }

    /// An empty world, and no geometries.
    fn empty(&self, settings: WorldSettings) -> Checked<(Writer, Geometries)> {
        let bytes = self.settings.session_memory_bytes;
        let quotas = Quotas { bytes, decompose_steps: self.settings.decompose_steps };
        let (history_bytes, past_bytes) = (bytes / HISTORY_SHARE, bytes / HISTORY_SHARE);
        let means = Means { history_bytes, past_bytes, clock: Some(nanoseconds) };
        Ok((Writer::new(settings, means)?, Geometries::new(quotas)))
    }

    fn session(
        &self,
        id: String,
        access: Access,
        lease: Option<Duration>,
        world: (Writer, Geometries),
    ) -> Arc<Session> {
        Arc::new(Session::new(id, access, lease, &self.settings, self.waiting.clone(), world))
    }

    fn is_open(&self, session: &Session) -> bool {
        session.id == DEFAULT && self.settings.has_default_session()
    }

    fn choose_id(&self) -> Checked<String> {
        for _ in 0..CHOICES {
            let id = format!("s-{}", random_hex(8)?);
            if !self.sessions.read().contains_key(&id) {
                return Ok(id);
            }
        }
        Err(Problem::new(Reason::Internal, "no free session id was found"))
    }
}

/// Nanoseconds since the first call: what building something takes is told from it.
fn nanoseconds() -> i64 {
    static BEGIN: LazyLock<Instant> = LazyLock::new(Instant::now);
    i64::try_from(BEGIN.elapsed().as_nanos()).unwrap_or(i64::MAX)
}

/// A wished id, if it is well formed.
fn checked_id(field: &'static str, wish: &str) -> Checked<String> {
    let mut bytes = wish.bytes();
    let well_formed = bytes.next().is_some_and(|first| first.is_ascii_lowercase())
        && bytes.all(|byte| byte.is_ascii_lowercase() || byte.is_ascii_digit() || byte == b'-')
        && wish.len() <= 63;
    if well_formed {
        return Ok(wish.to_owned());
    }
    let wish = quoted(wish);
    let what = format!("is {wish}: an id is a letter a-z and up to 62 of a-z, 0-9 and -, such as \"arena-7\"");
    Err(Problem::at(field, Reason::OutOfLimits, what))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ids_are_a_letter_and_up_to_62_more() {
        for good in ["a", "arena-7", &"x".repeat(63)] {
            assert_eq!(checked_id("session", good).unwrap(), good);
        }
        for bad in ["7up", "-a", "A", "a_b", "ä", &"x".repeat(64)] {
            let status = tonic::Status::from(checked_id("session", bad).unwrap_err());
            assert!(status.message().contains("arena-7"), "{status}");
        }
    }
}
