//! `ForkSession`: a session whose world begins as a copy of another's, to try something out.

use std::sync::Arc;

use tonic::{Request, Response, Status};
use wire::v1 as pb;

use super::{Caller, Server, create_session::lease, session::session_out};
use crate::{
    compute::{self, Weight},
    convert::question::read_at,
    geometries::Known,
    problem::{Checked, Problem, Reason, Under},
    retry::RetryKey,
    session::{ReadAt, Session},
    token::Role,
};

/// Makes the copy.
///
/// # Errors
/// What is wrong with the request; the caller is not the owner; the id is taken; a tick that is not held.
pub(super) async fn answer(
    server: &Server,
    request: Request<pb::ForkSessionRequest>,
) -> Result<Response<pb::ForkSessionResponse>, Status> {
    let caller = Caller::of(&request);
    let sent = request.into_inner();
    let session = server.enter(&caller, &sent.session, Role::Owner)?;
    let lease = lease(sent.lease.as_ref())?;
    let read_at = read_at(sent.read_at.as_ref()).under("read_at")?;
    check_exact(read_at)?;
    let retry = RetryKey::of(&sent.request_id, &sent)?;
    let snapshot = session.pin(read_at, caller.deadline).await?;
    if snapshot.fraction() > 0.0 {
        let what = "lies between two ticks, and a copy begins at one: name a tick";
        return Err(Problem::at("read_at.time", Reason::OutOfLimits, what).into());
    }
    let weight = if snapshot.tick() == session.newest().tick() { Weight::Light } else { Weight::Heavy };
    let (registry, origin) = (server.registry.clone(), session.clone());
    let copying = move || registry.fork(&sent.fork, lease, retry, (&origin, &snapshot));
    let created = compute::run(weight, "copying a world", copying).await?;
    carry_on(server, &session, &created.session);
    Ok(Response::new(pb::ForkSessionResponse { session: Some(session_out(&created.session)), token: created.token }))
}

/// What is in work for the origin is in work for its copy too, which may delete it or outlive the origin. It is cut once: the second
/// finds what the first has made. What there is no room for stays behind.
fn carry_on(server: &Server, origin: &Session, copy: &Arc<Session>) {
    for building in origin.geometries.in_work() {
        let again = Arc::new(building.again(&copy.ended));
        if let Ok(Known::InWork(known)) = copy.geometries.begin(&again, &copy.newest())
            && Arc::ptr_eq(&known, &again)
        {
            server.workshop.start(copy.clone(), again);
        }
    }
}

/// A copy begins at a tick, not between two.
fn check_exact(read_at: ReadAt) -> Checked<()> {
    match read_at {
        ReadAt::Tick(_, fraction) if fraction > 0.0 => {
            let what = format!("is {fraction}: a copy begins at a tick, so leave it out");
            Err(Problem::at("read_at.tick_fraction", Reason::OutOfLimits, what))
        }
        ReadAt::Newest | ReadAt::Tick(..) | ReadAt::MinTick(_) | ReadAt::Time(_) => Ok(()),
    }
}
