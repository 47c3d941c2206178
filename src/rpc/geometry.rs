//! `CreateGeometry`, `GetGeometry`, `ListGeometries` and `DeleteGeometry`.

use std::sync::Arc;

use collision::shape::{Geometry, GeometryId};
use prost::Message;
use tonic::{Request, Response, Status};
use wire::v1 as pb;

use super::{Caller, Server};
use crate::{
    building::Building,
    compute::{self, Weight},
    convert::{
        geometry::info_out,
        number::count,
        parts::{ToRegister, building_out, to_register},
    },
    deadline::Deadline,
    geometries::{Known, id_text, parse_id, uses},
    problem::{Checked, Problem, Reason, Under, quoted},
    session::Session,
    token::Role,
};

/// Registers a geometry.
///
/// # Errors
/// What is wrong with it; the memory quota.
pub(super) async fn create(
    server: &Server,
    request: Request<pb::CreateGeometryRequest>,
) -> Result<Response<pb::CreateGeometryResponse>, Status> {
    let caller = Caller::of(&request);
    let sent = request.into_inner();
    let session = server.enter(&caller, &sent.session, Role::Writer)?;
    let weight = Weight::of_message(sent.encoded_len());
    let registering = session.clone();
    let registered = compute::run(weight, "making a geometry", move || {
        let Some(form) = &sent.geometry else {
            let what = "is absent: say what to register, such as {\"sphere\": {\"radius\": 1}}";
            return Err(Problem::at("geometry", Reason::Missing, what));
        };
        register(&registering, form)
    });
    let info = registered.await?.started(server, session);
    Ok(Response::new(pb::CreateGeometryResponse { geometry: Some(info) }))
}

/// What has become of a geometry that came.
#[derive(Debug)]
pub(super) struct Registered {
    info: pb::GeometryInfo,
    /// A mesh that is to be cut now.
    to_cut: Option<Arc<Building>>,
}

impl Registered {
    /// What is said of it, once what is to be cut waits for its turn.
    pub(super) fn started(self, server: &Server, session: Arc<Session>) -> pb::GeometryInfo {
        if let Some(building) = self.to_cut {
            server.workshop.start(session, building);
        }
        self.info
    }
}

/// Registers a geometry that came whole, and says what it is.
///
/// # Errors
/// As [`create`].
pub(super) fn register(session: &Session, form: &pb::Geometry) -> Checked<Registered> {
    let newest = session.newest();
    let asking = newest.asking();
    let (mesh, options) = match asking.during(|| to_register(form, &session.geometries)).under("geometry")? {
        ToRegister::Whole(geometry) => {
            let geometry = session.geometries.register(geometry, &newest)?;
            return Ok(Registered { info: ready_out(session, &geometry)?, to_cut: None });
        }
        ToRegister::ToCut(mesh, options) => (mesh, options),
    };
    let building = Arc::new(Building::new(mesh, options, asking, &session.ended));
    match session.geometries.begin(&building, &newest)? {
        Known::Ready(geometry) => Ok(Registered { info: ready_out(session, &geometry)?, to_cut: None }),
        Known::InWork(known) => {
            let is_new = Arc::ptr_eq(&known, &building);
            Ok(Registered { info: building_out(&known)?, to_cut: is_new.then_some(building) })
        }
    }
}

fn ready_out(session: &Session, geometry: &Arc<Geometry>) -> Checked<pb::GeometryInfo> {
    info_out(geometry, uses(&session.newest(), std::slice::from_ref(geometry))[0])
}

/// Says how a geometry stands; where that is asked, once it is no longer in work.
///
/// # Errors
/// There is no such geometry; the deadline, the session or the server ends before it is ready.
pub(super) async fn get(
    server: &Server,
    request: Request<pb::GetGeometryRequest>,
) -> Result<Response<pb::GetGeometryResponse>, Status> {
    let caller = Caller::of(&request);
    let sent = request.into_inner();
    let session = server.enter(&caller, &sent.session, Role::Reader)?;
    let mut known = session.geometries.known(&sent.geometry_id)?;
    if let (Known::InWork(building), true) = (&known, sent.wait) {
        tokio::select! {
            biased;
            () = building.settled() => {}
            () = server.drain.cancelled() => return Err(Problem::new(Reason::Stopping, "the server is stopping: ask again elsewhere, or later").into()),
            () = session.ended.cancelled() => return Err(session.ended_problem().into()),
            () = caller.deadline.passed() => return Err(Deadline::problem().into()),
        }
        known = session.geometries.known(&sent.geometry_id)?;
    }
    let info = match &known {
        Known::Ready(geometry) => ready_out(&session, geometry)?,
        Known::InWork(building) => building_out(building)?,
    };
    Ok(Response::new(pb::GetGeometryResponse { geometry: Some(info) }))
}

/// Lists registered geometries; a page token is the last id of the page before.
///
/// # Errors
/// What is wrong with the request.
pub(super) fn list(
    server: &Server,
    request: Request<pb::ListGeometriesRequest>,
) -> Result<Response<pb::ListGeometriesResponse>, Status> {
    let caller = Caller::of(&request);
    let sent = request.into_inner();
    let session = server.enter(&caller, &sent.session, Role::Reader)?;
    let most = count("page_size", sent.page_size, 100, 1000)?;
    let found = session.geometries.after(parse_token(&sent.page_token)?, most + 1);
    let next_page_token = match found.get(..most) {
        Some([.., last]) if found.len() > most => id_text(last.id()),
        Some(_) | None => String::new(),
    };
    let page = &found[..found.len().min(most)];
    let ready = page.iter().filter_map(|known| match known {
        Known::Ready(geometry) => Some(geometry.clone()),
        Known::InWork(_) => None,
    });
    let mut counts = uses(&session.newest(), &ready.collect::<Vec<_>>()).into_iter();
    let infos = page.iter().map(|known| match known {
        Known::Ready(geometry) => info_out(geometry, counts.next().unwrap_or(0)),
        Known::InWork(building) => building_out(building),
    });
    Ok(Response::new(pb::ListGeometriesResponse { geometries: infos.collect::<Checked<_>>()?, next_page_token }))
}

/// Forgets a geometry; one that is gone is not an error.
///
/// # Errors
/// There is no such session.
pub(super) fn delete(
    server: &Server,
    request: Request<pb::DeleteGeometryRequest>,
) -> Result<Response<pb::DeleteGeometryResponse>, Status> {
    let caller = Caller::of(&request);
    let sent = request.into_inner();
    let session = server.enter(&caller, &sent.session, Role::Writer)?;
    session.geometries.forget(&sent.geometry_id);
    Ok(Response::new(pb::DeleteGeometryResponse {}))
}

fn parse_token(token: &str) -> Checked<Option<GeometryId>> {
    if token.is_empty() {
        return Ok(None);
    }
    parse_id(token).map(Some).ok_or_else(|| {
        let what = format!("is {}, which no response gave: leave it empty to begin", quoted(token));
        Problem::at("page_token", Reason::OutOfLimits, what)
    })
}
