//! `CreateGeometry`, `GetGeometry`, `ListGeometries` and `DeleteGeometry`.

use collision::shape::GeometryId;
use prost::Message;
use tonic::{Request, Response, Status};
use wire::v1 as pb;

use super::{Caller, Server};
use crate::{
    compute::{self, Weight},
    convert::{
        geometry::{info_out, registrable},
        number::count,
    },
    geometries::{id_text, parse_id, uses},
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
    let info = compute::run(weight, "making a geometry", move || {
        let Some(form) = &sent.geometry else {
            let what = "is absent: say what to register, such as {\"sphere\": {\"radius\": 1}}";
            return Err(Problem::at("geometry", Reason::Missing, what));
        };
        register(&session, form)
    });
    Ok(Response::new(pb::CreateGeometryResponse { geometry: Some(info.await?) }))
}

/// Registers a geometry that came whole, and says what it is.
///
/// # Errors
/// As [`create`].
pub(super) fn register(session: &Session, form: &pb::Geometry) -> Checked<pb::GeometryInfo> {
    let geometry = registrable(form, &session.geometries).under("geometry")?;
    let newest = session.newest();
    let geometry = session.geometries.register(geometry, &newest)?;
    info_out(&geometry, uses(&newest, std::slice::from_ref(&geometry))[0])
}

/// Says how a geometry stands. All are ready at once, so `wait` never waits.
///
/// # Errors
/// There is no such geometry.
pub(super) fn get(
    server: &Server,
    request: Request<pb::GetGeometryRequest>,
) -> Result<Response<pb::GetGeometryResponse>, Status> {
    let caller = Caller::of(&request);
    let sent = request.into_inner();
    let session = server.enter(&caller, &sent.session, Role::Reader)?;
    let geometry = session.geometries.get(&sent.geometry_id)?;
    let shape_count = uses(&session.newest(), std::slice::from_ref(&geometry))[0];
    Ok(Response::new(pb::GetGeometryResponse { geometry: Some(info_out(&geometry, shape_count)?) }))
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
    let counts = uses(&session.newest(), page);
    let infos = page.iter().zip(counts).map(|(geometry, shape_count)| info_out(geometry, shape_count));
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
