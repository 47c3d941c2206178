//! The calls of the API, one method for each RPC that names the client's session.

use tonic::Status;

use crate::Error;
use crate::client::Client;
use crate::proto;

/// Writes the calls that name the client's session.
macro_rules! calls_of_the_session {
    ($($(#[$doc:meta])* $name:ident = $stub:ident.$rpc:ident($request:ident) -> $response:ident;)*) => {
        impl Client {
            $($(#[$doc])*
            pub async fn $name(&self, mut request: proto::$request) -> Result<proto::$response, Error> {
                if request.session.is_empty() {
                    request.session.clone_from(&self.session);
                }
                Ok(self.$stub().$rpc(self.request(request)).await?.into_inner())
            })*
        }
    };
}

/// Writes the single questions, which go as calls or onto the stream.
macro_rules! questions_of_the_session {
    ($($(#[$doc:meta])* $name:ident($request:ident) -> $response:ident as $kind:ident;)*) => {
        impl Client {
            $($(#[$doc])*
            pub async fn $name(&self, mut request: proto::$request) -> Result<proto::$response, Error> {
                if request.session.is_empty() {
                    request.session.clone_from(&self.session);
                }
                let Some(pipeline) = &self.pipeline else {
                    return Ok(self.questions().$name(self.request(request)).await?.into_inner());
                };
                let asked = pipeline.ask(|| self.questions(), request.into());
                let answered = match self.deadline {
                    Some(deadline) => tokio::time::timeout(deadline, asked).await.map_err(|_| overdue())?,
                    None => asked.await,
                };
                match answered? {
                    proto::answer::Answer::$kind(answer) => Ok(*Box::from(answer)),
                    _ => Err(Status::internal("the server answered another kind of question").into()),
                }
            })*
        }
    };
}

questions_of_the_session! {
    /// What does a ray hit?
    raycast(RaycastRequest) -> RaycastResponse as Raycast;
    /// Which shapes touch the subject?
    overlap(OverlapRequest) -> OverlapResponse as Overlap;
    /// How deep do shapes and the subject overlap, and where do they touch?
    penetration(PenetrationRequest) -> PenetrationResponse as Penetration;
    /// What does the moving subject touch first, and when?
    time_of_impact(TimeOfImpactRequest) -> TimeOfImpactResponse as TimeOfImpact;
    /// Which shapes are nearest to the subject, and how near?
    distance(DistanceRequest) -> DistanceResponse as Distance;
    /// How far does a character get that slides along what it meets?
    move_character(MoveCharacterRequest) -> MoveCharacterResponse as MoveCharacter;
    /// Which way out of everything that it overlaps does the subject have?
    depenetrate(DepenetrateRequest) -> DepenetrateResponse as Depenetrate;
    /// When, in the past that is held, did the subject touch something first?
    first_touch(FirstTouchRequest) -> FirstTouchResponse as FirstTouch;
}

fn overdue() -> Status {
    Status::deadline_exceeded("the client's deadline passed before the answer came")
}

calls_of_the_session! {
    /// Questions of any kinds, answered on one tick.
    batch = questions.batch(BatchRequest) -> BatchResponse;
    /// How would bodies in contact bounce and be pushed apart?
    resolve = questions.resolve(ResolveRequest) -> ResolveResponse;
    /// Many rays, as columns.
    raycast_batch = questions.raycast_batch(RaycastBatchRequest) -> RaycastBatchResponse;
    /// One geometry at many places: what touches it?
    overlap_batch = questions.overlap_batch(OverlapBatchRequest) -> OverlapBatchResponse;
    /// One geometry on many ways: what does it touch first?
    time_of_impact_batch = questions.time_of_impact_batch(TimeOfImpactBatchRequest) -> TimeOfImpactBatchResponse;
    /// One geometry at many places: what is nearest?
    distance_batch = questions.distance_batch(DistanceBatchRequest) -> DistanceBatchResponse;
    /// Which points of targets do observers see?
    line_of_sight = questions.line_of_sight(LineOfSightRequest) -> LineOfSightResponse;
    /// Applies edits as one tick, with everything that the request can say.
    edit_with = world.edit(EditRequest) -> EditResponse;
    /// Says where a shape is, or was.
    get_shape = world.get_shape(GetShapeRequest) -> GetShapeResponse;
    /// Lists shapes, by id, a page at a time.
    list_shapes = world.list_shapes(ListShapesRequest) -> ListShapesResponse;
    /// Says what the world holds, what was built for it, and what that costs.
    describe_world = world.describe_world(DescribeWorldRequest) -> DescribeWorldResponse;
    /// Answers a question and returns all that the answer depends on, to be kept in a file for `calipers explain`.
    explain = world.explain(ExplainRequest) -> ExplainResponse;
    /// Changes settings of the world; those left out stay.
    update_world = world.update_world(UpdateWorldRequest) -> UpdateWorldResponse;
    /// Registers a geometry that fits into one message.
    create_geometry = geometries.create_geometry(CreateGeometryRequest) -> CreateGeometryResponse;
    /// Says how a geometry stands.
    get_geometry = geometries.get_geometry(GetGeometryRequest) -> GetGeometryResponse;
    /// Lists geometries, by id, a page at a time.
    list_geometries = geometries.list_geometries(ListGeometriesRequest) -> ListGeometriesResponse;
    /// Forgets a geometry; shapes that use it keep it.
    delete_geometry = geometries.delete_geometry(DeleteGeometryRequest) -> DeleteGeometryResponse;
    /// Makes a session whose world begins as a copy of this one's; [`fork`](Client::fork) returns a client of it.
    fork_session = sessions.fork_session(ForkSessionRequest) -> ForkSessionResponse;
    /// Makes one more token for the session.
    create_token = sessions.create_token(CreateTokenRequest) -> CreateTokenResponse;
    /// Says how the session stands.
    get_session = sessions.get_session(GetSessionRequest) -> GetSessionResponse;
    /// Renews the session's lease, and can change its length.
    renew_session = sessions.renew_session(RenewSessionRequest) -> RenewSessionResponse;
    /// Ends the session, its streams, and all it owns.
    delete_session = sessions.delete_session(DeleteSessionRequest) -> DeleteSessionResponse;
}

impl Client {
    /// Makes a session with an empty world; an empty id lets the server choose. The client's own session plays no part.
    /// [`open_session`](Self::open_session) returns a client of it.
    pub async fn create_session(
        &self,
        request: proto::CreateSessionRequest,
    ) -> Result<proto::CreateSessionResponse, Error> {
        Ok(self.sessions().create_session(self.request(request)).await?.into_inner())
    }

    /// Lists the server's sessions, by id; needs the operator's token.
    pub async fn list_sessions(
        &self,
        request: proto::ListSessionsRequest,
    ) -> Result<proto::ListSessionsResponse, Error> {
        Ok(self.sessions().list_sessions(self.request(request)).await?.into_inner())
    }
}
