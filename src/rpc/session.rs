//! `GetSession`, `RenewSession`, `ListSessions`, `DeleteSession` and `CreateToken`.

use tonic::{Request, Response, Status};
use wire::v1 as pb;

use super::{Caller, Server, create_session::lease};
use crate::{
    convert::number::{count, duration, unknown_enum},
    problem::{Checked, Problem, Reason},
    session::Session,
    token::Role,
};

/// Says how a session stands.
///
/// # Errors
/// There is no such session.
pub(super) fn get(
    server: &Server,
    request: Request<pb::GetSessionRequest>,
) -> Result<Response<pb::GetSessionResponse>, Status> {
    let caller = Caller::of(&request);
    let session = server.enter(&caller, &request.into_inner().session, Role::Owner)?;
    Ok(Response::new(pb::GetSessionResponse { session: Some(session_out(&session)) }))
}

/// Renews a lease.
///
/// # Errors
/// There is no such session; a lease out of range, or one for the open session, which has none.
pub(super) fn renew(
    server: &Server,
    request: Request<pb::RenewSessionRequest>,
) -> Result<Response<pb::RenewSessionResponse>, Status> {
    let caller = Caller::of(&request);
    let sent = request.into_inner();
    let lease = lease(sent.lease.as_ref())?;
    let session = server.enter(&caller, &sent.session, Role::Owner)?;
    if lease.is_some() && session.lease.length().is_none() {
        let what = "cannot be set: this session lives as long as the server, so leave it out";
        return Err(Problem::at("lease", Reason::OutOfLimits, what).into());
    }
    session.lease.renew(lease);
    Ok(Response::new(pb::RenewSessionResponse { session: Some(session_out(&session)) }))
}

/// Lists sessions; a page token is the last id of the page before.
///
/// # Errors
/// The caller is not the operator.
pub(super) fn list(
    server: &Server,
    request: Request<pb::ListSessionsRequest>,
) -> Result<Response<pb::ListSessionsResponse>, Status> {
    let caller = Caller::of(&request);
    server.registry.check_operator(caller.token.as_deref())?;
    let sent = request.into_inner();
    let most = count("page_size", sent.page_size, 100, 1000)?;
    let found = server.registry.after(&sent.page_token, most + 1);
    let next_page_token = match found.get(..most) {
        Some([.., last]) if found.len() > most => last.id.clone(),
        Some(_) | None => String::new(),
    };
    Ok(Response::new(pb::ListSessionsResponse {
        sessions: found.iter().take(most).map(|session| session_out(session)).collect(),
        next_page_token,
    }))
}

/// Ends a session; one that is gone is not an error.
///
/// # Errors
/// The caller is not its owner.
pub(super) fn delete(
    server: &Server,
    request: Request<pb::DeleteSessionRequest>,
) -> Result<Response<pb::DeleteSessionResponse>, Status> {
    let caller = Caller::of(&request);
    match server.enter(&caller, &request.into_inner().session, Role::Owner) {
        Ok(session) => server.registry.end(&session)?,
        Err(problem) if problem.is(Reason::SessionNotFound) => {}
        Err(problem) => return Err(problem.into()),
    }
    Ok(Response::new(pb::DeleteSessionResponse {}))
}

/// Makes a token with the caller's rights or fewer.
///
/// # Errors
/// The role is above the caller's.
pub(super) fn create_token(
    server: &Server,
    request: Request<pb::CreateTokenRequest>,
) -> Result<Response<pb::CreateTokenResponse>, Status> {
    let caller = Caller::of(&request);
    let sent = request.into_inner();
    let token = caller.token.as_deref();
    let (session, own) = server.registry.enter(&sent.session, token, Role::Reader)?;
    let role = role(sent.role, own)?;
    if role > own {
        let what = format!("is {}, and the caller's own is {}: ask for that or less", role.name(), own.name());
        return Err(Problem::at("role", Reason::RoleTooLow, what).into());
    }
    Ok(Response::new(pb::CreateTokenResponse { token: session.create_token(role)? }))
}

/// A session as it is sent.
pub(super) fn session_out(session: &Session) -> pb::Session {
    let newest = session.newest();
    pb::Session {
        session: session.id.clone(),
        create_time: Some(session.created.into()),
        expire_time: session.lease.expires_at().map(Into::into),
        lease: session.lease.length().map(duration),
        tick: newest.tick().get(),
        memory_bytes: session.memory_bytes(),
    }
}

fn role(sent: i32, own: Role) -> Checked<Role> {
    match pb::Role::try_from(sent) {
        Ok(pb::Role::Unspecified) => Ok(own),
        Ok(pb::Role::Reader) => Ok(Role::Reader),
        Ok(pb::Role::Writer) => Ok(Role::Writer),
        Ok(pb::Role::Owner) => Ok(Role::Owner),
        Err(_) => Err(unknown_enum("role", sent, "ROLE_READER (1), ROLE_WRITER (2), ROLE_OWNER (3)")),
    }
}
