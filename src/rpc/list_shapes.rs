//! `ListShapes` and `GetShape`: what a version of the world holds.
//!
//! A page token is the tick of the first page, the last shape that was listed, and the fraction between two ticks.

use collision::world::{ShapeId, Snapshot, Tick};
use prost::Message;
use tonic::{Request, Response, Status};
use wire::v1 as pb;

use super::{Caller, Server};
use crate::{
    convert::{
        number::{count, shape_id},
        place::aabb,
        question::{read_at, shape_not_found},
        shape::shape_out,
    },
    problem::{Checked, Problem, Reason, Under, quoted},
    token::Role,
};

/// A page ends before it outgrows a message.
const PAGE_BYTES: usize = 3 * 1024 * 1024;

/// Lists a page of shapes.
///
/// # Errors
/// What is wrong with the request; a tick that is no longer held.
pub(super) async fn list(
    server: &Server,
    request: Request<pb::ListShapesRequest>,
) -> Result<Response<pb::ListShapesResponse>, Status> {
    let caller = Caller::of(&request);
    let sent = request.into_inner();
    let session = server.enter(&caller, &sent.session, Role::Reader)?;
    let most = count("page_size", sent.page_size, 1000, 10_000)?;
    let bounds = sent.bounds.as_ref().map(aabb).transpose().under("bounds")?;
    let (snapshot, after) = match parse_token(&sent.page_token)? {
        Some((tick, fraction, after)) => (session.paged(tick, fraction)?, Some(after)),
        None => (session.pin(read_at(sent.read_at.as_ref()).under("read_at")?, caller.deadline).await?, None),
    };
    // One more than asked tells whether there is a next page.
    let found = snapshot.shapes_after(after, most + 1, bounds);
    let mut shapes = Vec::with_capacity(found.len().min(most));
    let mut bytes = 0;
    for shape in found.iter().take(most) {
        let shape = shape_out(shape);
        bytes += shape.encoded_len();
        if bytes > PAGE_BYTES {
            break;
        }
        shapes.push(shape);
    }
    let next_page_token = match shapes.last() {
        Some(last) if shapes.len() < found.len() => {
            session.keep_for_paging(&snapshot);
            token(&snapshot, last.id)
        }
        Some(_) | None => String::new(),
    };
    Ok(Response::new(pb::ListShapesResponse { shapes, next_page_token, info: Some(info(&snapshot)) }))
}

/// Says where a shape is.
///
/// # Errors
/// What is wrong with the request; there is no such shape.
pub(super) async fn get(
    server: &Server,
    request: Request<pb::GetShapeRequest>,
) -> Result<Response<pb::GetShapeResponse>, Status> {
    let caller = Caller::of(&request);
    let sent = request.into_inner();
    let session = server.enter(&caller, &sent.session, Role::Reader)?;
    let id = shape_id("id", sent.id)?;
    let read_at = read_at(sent.read_at.as_ref()).under("read_at")?;
    let snapshot = session.pin(read_at, caller.deadline).await?;
    let Some(shape) = snapshot.shape(id) else {
        return Err(shape_not_found("id", sent.id, snapshot.tick()).into());
    };
    Ok(Response::new(pb::GetShapeResponse { shape: Some(shape_out(&shape)), info: Some(info(&snapshot)) }))
}

fn info(snapshot: &Snapshot) -> pb::AnswerInfo {
    pb::AnswerInfo { tick: snapshot.tick().get(), tick_fraction: snapshot.fraction(), ..pb::AnswerInfo::default() }
}

/// The tick, the last shape and, if there is one, the fraction as bits, which reads back as the same.
fn token(snapshot: &Snapshot, last: u64) -> String {
    let tick = snapshot.tick();
    match snapshot.fraction() {
        fraction if fraction > 0.0 => format!("{tick}-{last}-{:x}", fraction.to_bits()),
        _ => format!("{tick}-{last}"),
    }
}

fn parse_token(token: &str) -> Checked<Option<(Tick, f64, ShapeId)>> {
    if token.is_empty() {
        return Ok(None);
    }
    let parsed = token.split_once('-').and_then(|(tick, rest)| {
        let (after, fraction) = match rest.split_once('-') {
            Some((after, bits)) => (after, f64::from_bits(u64::from_str_radix(bits, 16).ok()?)),
            None => (rest, 0.0),
        };
        Some((tick.parse().ok()?, fraction, after.parse().ok()?))
    });
    parsed.map(Some).ok_or_else(|| {
        let what = format!("is {}, which no response gave: leave it empty to begin", quoted(token));
        Problem::at("page_token", Reason::OutOfLimits, what)
    })
}
