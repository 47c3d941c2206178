//! `CreateSession`: a session with an empty world, and its owner's token.

use std::time::Duration;

use tonic::{Request, Response, Status};
use wire::v1 as pb;

use super::{Server, session::session_out};
use crate::{
    config::LEASE_RANGE,
    convert::settings::changed,
    problem::{Checked, Problem, Reason, Under},
    registry::DEFAULT_SETTINGS,
    retry::RetryKey,
};

/// Makes a session.
///
/// # Errors
/// What is wrong with the request; the id is taken; there are too many sessions.
pub(super) fn answer(
    server: &Server,
    request: Request<pb::CreateSessionRequest>,
) -> Result<Response<pb::CreateSessionResponse>, Status> {
    let sent = request.into_inner();
    let lease = lease(sent.lease.as_ref())?;
    let settings = changed(DEFAULT_SETTINGS, sent.settings.as_ref()).under("settings")?;
    let retry = RetryKey::of(&sent.request_id, &sent)?;
    let created = server.registry.create(&sent.session, lease, retry, settings)?;
    Ok(Response::new(pb::CreateSessionResponse { session: Some(session_out(&created.session)), token: created.token }))
}

/// A lease, if one is named.
///
/// # Errors
/// It is out of range.
pub(super) fn lease(sent: Option<&prost_types::Duration>) -> Checked<Option<Duration>> {
    let Some(sent) = sent else { return Ok(None) };
    let length = Duration::try_from(*sent).ok();
    let (shortest, longest) = LEASE_RANGE;
    match length {
        Some(length) if length >= shortest && length <= longest => Ok(Some(length)),
        Some(_) | None => {
            let what = format!("is {sent}: it must be 1 second to 30 days");
            Err(Problem::at("lease", Reason::OutOfLimits, what))
        }
    }
}
