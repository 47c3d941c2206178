//! Starts servers on free ports, makes clients of them, and builds the messages that tests send most.

use calipers::{
    config::Settings,
    serve::{self, Running},
};
use tonic::{Code, Status, transport::Channel};
use tonic_types::StatusExt;
use wire::v1::{
    self as pb, edit::Op, geometry::Kind, geometry_service_client::GeometryServiceClient,
    query_service_client::QueryServiceClient, session_service_client::SessionServiceClient, subject::Form,
    world_service_client::WorldServiceClient,
};

/// A server and a client of each service in the same process.
pub(crate) struct Bench {
    pub(crate) server: Running,
    pub(crate) sessions: SessionServiceClient<Channel>,
    pub(crate) geometries: GeometryServiceClient<Channel>,
    pub(crate) worlds: WorldServiceClient<Channel>,
    pub(crate) questions: QueryServiceClient<Channel>,
}

/// Settings for a test: any free port.
pub(crate) fn settings() -> Settings {
    Settings { listen: "127.0.0.1:0".parse().expect("an address"), ..Settings::default() }
}

impl Bench {
    /// A server with the settings of [`settings`].
    pub(crate) async fn start() -> Self {
        Self::start_with(settings()).await
    }

    /// A server with these settings.
    pub(crate) async fn start_with(settings: Settings) -> Self {
        let server = serve::start(settings).await.expect("the server starts");
        let channel = server.connect_in_process();
        Self {
            sessions: SessionServiceClient::new(channel.clone()),
            geometries: GeometryServiceClient::new(channel.clone()),
            worlds: WorldServiceClient::new(channel.clone()),
            questions: QueryServiceClient::new(channel),
            server,
        }
    }

    /// Applies edits to the open session and returns the tick.
    pub(crate) async fn edit(&mut self, edits: Vec<pb::Edit>) -> Result<u64, Status> {
        let request = pb::EditRequest { edits, ..pb::EditRequest::default() };
        Ok(self.worlds.edit(request).await?.into_inner().tick)
    }

    /// A session with a token of its own.
    pub(crate) async fn create_session(&mut self, id: &str) -> pb::CreateSessionResponse {
        let request = pb::CreateSessionRequest { session: id.to_owned(), ..pb::CreateSessionRequest::default() };
        self.sessions.create_session(request).await.expect("a session").into_inner()
    }

    /// How the open world stands.
    pub(crate) async fn describe(&mut self) -> pb::DescribeWorldResponse {
        let request = pb::DescribeWorldRequest::default();
        self.worlds.describe_world(request).await.expect("a description").into_inner()
    }
}

/// The world of the README: a sphere of radius 1 at z = 5.
pub(crate) async fn readme_world() -> Bench {
    let mut bench = Bench::start().await;
    let tick = bench.edit(vec![insert(shape(1, sphere(1.0), at(0.0, 0.0, 5.0)))]).await.unwrap();
    assert_eq!(tick, 2);
    bench
}

/// A request with a token.
pub(crate) fn with_token<T>(token: &str, message: T) -> tonic::Request<T> {
    let mut request = tonic::Request::new(message);
    let bearer = format!("Bearer {token}").parse().expect("a token is ASCII");
    request.metadata_mut().insert("authorization", bearer);
    request
}

pub(crate) fn vec3(x: f64, y: f64, z: f64) -> pb::Vec3 {
    pb::Vec3 { x, y, z }
}

pub(crate) fn at(x: f64, y: f64, z: f64) -> pb::Pose {
    pb::Pose { position: Some(vec3(x, y, z)), rotation: None }
}

pub(crate) fn geometry(kind: Kind) -> pb::Geometry {
    pb::Geometry { kind: Some(kind), ..pb::Geometry::default() }
}

pub(crate) fn sphere(radius: f64) -> pb::Geometry {
    geometry(Kind::Sphere(pb::Sphere { radius }))
}

pub(crate) fn cuboid(x: f64, y: f64, z: f64) -> pb::Geometry {
    geometry(Kind::Box(pb::Cuboid { half_extents: Some(vec3(x, y, z)) }))
}

pub(crate) fn shape(id: u64, geometry: pb::Geometry, pose: pb::Pose) -> pb::Shape {
    pb::Shape { id, geometry: Some(geometry), pose: Some(pose), ..pb::Shape::default() }
}

pub(crate) fn insert(shape: pb::Shape) -> pb::Edit {
    pb::Edit { op: Some(Op::Insert(shape)) }
}

pub(crate) fn move_to(id: u64, pose: pb::Pose) -> pb::Edit {
    pb::Edit { op: Some(Op::Move(pb::Move { id, pose: Some(pose), ..pb::Move::default() })) }
}

pub(crate) fn remove(ids: &[u64]) -> pb::Edit {
    pb::Edit { op: Some(Op::Remove(pb::Remove { ids: ids.to_vec() })) }
}

pub(crate) fn subject(geometry: pb::Geometry, pose: pb::Pose) -> pb::Subject {
    pb::Subject { form: Some(Form::Geometry(geometry)), pose: Some(pose) }
}

pub(crate) fn subject_shape(id: u64) -> pb::Subject {
    pb::Subject { form: Some(Form::Id(id)), pose: None }
}

/// Asks for a session.
pub(crate) fn get(session: &str) -> pb::GetSessionRequest {
    pb::GetSessionRequest { session: session.to_owned() }
}

/// Puts a ball into a session's world.
pub(crate) fn edit(session: &str) -> pb::EditRequest {
    pb::EditRequest {
        session: session.to_owned(),
        edits: vec![insert(shape(1, sphere(1.0), at(0.0, 0.0, 5.0)))],
        ..pb::EditRequest::default()
    }
}

/// A ray in a session's world.
pub(crate) fn ray(session: &str) -> pb::RaycastRequest {
    pb::RaycastRequest { session: session.to_owned(), ..ray_along_z() }
}

/// A ray from the origin along z.
pub(crate) fn ray_along_z() -> pb::RaycastRequest {
    pb::RaycastRequest { direction: Some(vec3(0.0, 0.0, 1.0)), ..pb::RaycastRequest::default() }
}

pub(crate) fn read_at(at: pb::read_at::At) -> pb::QueryOptions {
    pb::QueryOptions { read_at: Some(pb::ReadAt { at: Some(at), tick_fraction: 0.0 }), ..pb::QueryOptions::default() }
}

/// Checks the code, the reason and the field of a refusal, and that its message says all of `parts`.
#[track_caller]
pub(crate) fn assert_refused(status: &Status, code: Code, reason: &str, field: &str, parts: &[&str]) {
    assert_eq!(status.code(), code, "{status}");
    let details = status.get_error_details();
    let info = details.error_info().expect("every refusal has an ErrorInfo");
    assert_eq!((info.domain.as_str(), info.reason.as_str()), ("calipers.v1", reason), "{status}");
    if !field.is_empty() {
        let violation = &details.bad_request().expect("a field is named").field_violations[0];
        assert_eq!(violation.field, field, "{status}");
        assert!(status.message().starts_with(field), "{status}");
    }
    for part in parts {
        assert!(status.message().contains(part), "{part:?} is missing in {status}");
    }
    assert!(has_remedy(status.message()), "what would have worked is missing in {status}");
}

/// What a message says that tells how to go on: an example, what must be, or what to do.
const REMEDIES: &[&str] = &[
    "such as",
    "must be",
    "must have",
    "must lie",
    "may have any",
    "or more",
    "one of",
    "begins with",
    "send",
    "ask",
    "leave",
    "name ",
    "choose",
    "use ",
    "Create",
    "GetGeometry",
    "allow",
    "try ",
    "remove",
    "keep",
    "commit more",
    "begin ",
    "read ",
    "make ",
    "insert",
    "register",
    "set it",
    "place ",
    "watch ",
    "end one",
    "give ",
    "need",
    "mend",
    "waits",
    "as in",
    "delete",
    "swap",
    "turn those",
];

/// Whether a refusal also says what would have worked.
pub(crate) fn has_remedy(message: &str) -> bool {
    // After what was found stands what would be right.
    let rest = message.split_once(['\u{3a}', ';', ',']).map_or(message, |(_, rest)| rest);
    REMEDIES.iter().any(|remedy| rest.contains(remedy))
}

/// A refusal of wrong input: reason, field, and what the message must say.
pub(crate) type Refusal = (&'static str, &'static str, &'static [&'static str]);

/// Checks a refusal of wrong input.
#[track_caller]
pub(crate) fn assert_invalid(status: &Status, (reason, field, parts): Refusal) {
    let code = match reason {
        "NOT_YET" => Code::Unimplemented,
        "GEOMETRY_NOT_FOUND" => Code::NotFound,
        _ => Code::InvalidArgument,
    };
    assert_refused(status, code, reason, field, parts);
}
