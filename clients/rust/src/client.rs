//! The client: one connection, one session, one call for each RPC.

use std::time::Duration;

use tonic::metadata::{Ascii, MetadataValue};
use tonic::service::{Interceptor, interceptor::InterceptedService};
use tonic::transport::{Channel, Endpoint};
use tonic::{Request, Status, Streaming};

use crate::Error;
use crate::pipeline::Pipeline;
use crate::proto::{
    self, geometry_service_client::GeometryServiceClient, query_service_client::QueryServiceClient,
    session_service_client::SessionServiceClient, world_service_client::WorldServiceClient,
};

/// Longest time to wait for a connection.
const CONNECT_WAIT: Duration = Duration::from_secs(5);
/// Bytes in flight before one stream waits for its reader: large batches gain 10 to 15 % over HTTP/2's 64 KiB.
const STREAM_WINDOW: u32 = 4 << 20;
/// Bytes in flight before the connection waits.
const CONNECTION_WINDOW: u32 = 16 << 20;
/// Largest answer that is read. The server's own limit is 4 MiB a message; this is only a fence.
const MAX_ANSWER_BYTES: usize = 16 << 20;

/// A client of one session.
///
/// Cloning is cheap, clones share the connection, and calls take `&self`: many may be under way at once. Where a
/// request leaves its session empty, the client's is filled in.
///
/// # Errors
///
/// Every call returns [`Error::Status`] with what the server or the transport said.
#[derive(Clone, Debug)]
pub struct Client {
    channel: Channel,
    pub(crate) session: String,
    bearer: Bearer,
    pub(crate) deadline: Option<Duration>,
    /// Where questions go, if not as calls of their own.
    pub(crate) pipeline: Option<Pipeline>,
}

/// A channel that adds the client's token to every call; what the raw stubs run on.
pub type Secured = InterceptedService<Channel, Bearer>;

/// Adds `authorization: Bearer TOKEN`, if there is a token.
#[derive(Clone, Debug, Default)]
pub struct Bearer {
    authorization: Option<MetadataValue<Ascii>>,
}

impl Interceptor for Bearer {
    fn call(&mut self, mut request: Request<()>) -> Result<Request<()>, Status> {
        if let Some(value) = &self.authorization {
            request.metadata_mut().insert("authorization", value.clone());
        }
        Ok(request)
    }
}

impl Client {
    /// Connects to a server, as `http://127.0.0.1:7070`; the `http://` may be left out.
    ///
    /// Small calls go out at once (TCP_NODELAY). Should the connection break later, the next call opens a new one.
    ///
    /// # Errors
    ///
    /// [`Error::Address`] if it cannot be understood; [`Error::Connect`] if nothing answers within 5 seconds.
    pub async fn connect(address: &str) -> Result<Self, Error> {
        let endpoint = Self::endpoint(address)?;
        let channel = endpoint
            .connect()
            .await
            .map_err(|error| Error::Connect { address: address.to_owned(), reason: innermost(&error) })?;
        Ok(Self::from_channel(channel))
    }

    /// The endpoint that [`connect`](Self::connect) uses, for those who want to change it and then call
    /// [`from_channel`](Self::from_channel).
    ///
    /// # Errors
    ///
    /// [`Error::Address`] if the address cannot be understood.
    pub fn endpoint(address: &str) -> Result<Endpoint, Error> {
        let refuse = |reason: String| Error::Address { address: address.to_owned(), reason };
        let url = if address.contains("://") { address.to_owned() } else { format!("http://{address}") };
        if url.starts_with("https://") {
            return Err(refuse("this client speaks no TLS yet".to_owned()));
        }
        let endpoint = Endpoint::from_shared(url).map_err(|error| refuse(innermost(&error)))?;
        if endpoint.uri().authority().is_none() {
            return Err(refuse("it names no host".to_owned()));
        }
        Ok(endpoint
            .tcp_nodelay(true)
            .connect_timeout(CONNECT_WAIT)
            .initial_stream_window_size(STREAM_WINDOW)
            .initial_connection_window_size(CONNECTION_WINDOW))
    }

    /// A client on a channel that is already there, such as one to a server in the same process.
    pub fn from_channel(channel: Channel) -> Self {
        Self { channel, session: String::new(), bearer: Bearer::default(), deadline: None, pipeline: None }
    }

    /// The same connection, for another session; empty means `default`.
    #[must_use]
    pub fn with_session(mut self, session: impl Into<String>) -> Self {
        self.session = session.into();
        self
    }

    /// The same connection, with the right that this token gives.
    ///
    /// # Errors
    ///
    /// [`Error::Token`] if it holds characters that metadata cannot carry.
    pub fn with_token(mut self, token: &str) -> Result<Self, Error> {
        let mut value: MetadataValue<Ascii> = format!("Bearer {token}").parse().map_err(|_| Error::Token)?;
        value.set_sensitive(true);
        self.bearer.authorization = Some(value);
        // Rights are those of a whole stream.
        self.pipeline = self.pipeline.map(|_| Pipeline::default());
        Ok(self)
    }

    /// The same connection, where each call is given up after this long. Streams have no deadline.
    #[must_use]
    pub fn with_deadline(mut self, deadline: Duration) -> Self {
        self.deadline = Some(deadline);
        self
    }

    /// The same connection, where single questions of this client and its clones share one stream: what many tasks ask at
    /// once is then several times cheaper, for the server too. A question alone costs about what a call costs.
    ///
    /// ```no_run
    /// # async fn example(client: calipers_client::Client) -> Result<(), calipers_client::Error> {
    /// use calipers_client::ask;
    ///
    /// let client = client.pipelined();
    /// let rays = (0..1000).map(|number| {
    ///     let client = client.clone();
    ///     tokio::spawn(async move { client.raycast(ask::ray([0.0; 3], [1.0, f64::from(number), 0.0])).await })
    /// });
    /// for ray in rays.collect::<Vec<_>>() {
    ///     println!("{} hits", ray.await.expect("no panic")?.hits.len());
    /// }
    /// # Ok(())
    /// # }
    /// ```
    #[must_use]
    pub fn pipelined(mut self) -> Self {
        self.pipeline = Some(Pipeline::default());
        self
    }

    /// The session whose world this client asks about; empty means `default`.
    pub fn session(&self) -> &str {
        &self.session
    }

    /// The raw stub of the sessions.
    pub fn sessions(&self) -> SessionServiceClient<Secured> {
        SessionServiceClient::with_interceptor(self.channel.clone(), self.bearer.clone())
            .max_decoding_message_size(MAX_ANSWER_BYTES)
    }

    /// The raw stub of the geometries.
    pub fn geometries(&self) -> GeometryServiceClient<Secured> {
        GeometryServiceClient::with_interceptor(self.channel.clone(), self.bearer.clone())
            .max_decoding_message_size(MAX_ANSWER_BYTES)
    }

    /// The raw stub of the world.
    pub fn world(&self) -> WorldServiceClient<Secured> {
        WorldServiceClient::with_interceptor(self.channel.clone(), self.bearer.clone())
            .max_decoding_message_size(MAX_ANSWER_BYTES)
    }

    /// The raw stub of the questions.
    pub fn questions(&self) -> QueryServiceClient<Secured> {
        QueryServiceClient::with_interceptor(self.channel.clone(), self.bearer.clone())
            .max_decoding_message_size(MAX_ANSWER_BYTES)
    }

    /// A request that carries the client's deadline.
    pub(crate) fn request<T>(&self, message: T) -> Request<T> {
        let mut request = Request::new(message);
        if let Some(deadline) = self.deadline {
            request.set_timeout(deadline);
        }
        request
    }

    /// Applies edits as one tick, all or nothing, and says which tick.
    ///
    /// ```no_run
    /// # async fn example(client: calipers_client::Client) -> Result<(), calipers_client::Error> {
    /// use calipers_client::{edit, shape};
    ///
    /// let done = client.edit([shape::sphere(1, 0.5).insert(), edit::remove([2])]).await?;
    /// println!("seen from tick {}", done.tick);
    /// # Ok(())
    /// # }
    /// ```
    pub async fn edit(&self, edits: impl IntoIterator<Item = proto::Edit>) -> Result<proto::EditResponse, Error> {
        let edits = edits.into_iter().collect();
        self.edit_with(proto::EditRequest { edits, ..proto::EditRequest::default() }).await
    }

    /// Says where a shape is at the newest tick.
    pub async fn shape(&self, id: u64) -> Result<proto::GetShapeResponse, Error> {
        self.get_shape(proto::GetShapeRequest { id, ..proto::GetShapeRequest::default() }).await
    }

    /// All pairs of shapes that overlap, ascending, in as many messages of one tick as it takes.
    ///
    /// ```no_run
    /// # async fn example(client: calipers_client::Client) -> Result<(), calipers_client::Error> {
    /// let mut parts = client.pairs(calipers_client::proto::PairsRequest::default()).await?;
    /// while let Some(part) = parts.message().await? {
    ///     let pairs = part.pairs.unwrap_or_default();
    ///     for (a, b) in pairs.a.iter().zip(&pairs.b) {
    ///         println!("{a} and {b}");
    ///     }
    /// }
    /// # Ok(())
    /// # }
    /// ```
    pub async fn pairs(&self, mut request: proto::PairsRequest) -> Result<Streaming<proto::PairsResponse>, Error> {
        if request.session.is_empty() {
            request.session.clone_from(&self.session);
        }
        Ok(self.questions().pairs(self.request(request)).await?.into_inner())
    }

    /// What enters and leaves regions, and which shapes begin and cease to overlap, from now on, until the stream is dropped.
    /// The client's deadline does not hold for it.
    ///
    /// ```no_run
    /// # async fn example(client: calipers_client::Client) -> Result<(), calipers_client::Error> {
    /// use calipers_client::proto::{Region, WatchOverlapsRequest};
    /// let gate = Region { id: 1, geometry: Some(calipers_client::geometry::sphere(2.0)), ..Region::default() };
    /// let request = WatchOverlapsRequest { regions: vec![gate], ..WatchOverlapsRequest::default() };
    /// let mut messages = client.watch_overlaps(request).await?;
    /// while let Some(message) = messages.message().await? {
    ///     println!("{:?} came in by tick {:?}", message.entered, message.info);
    /// }
    /// # Ok(())
    /// # }
    /// ```
    pub async fn watch_overlaps(
        &self,
        mut request: proto::WatchOverlapsRequest,
    ) -> Result<Streaming<proto::WatchOverlapsResponse>, Error> {
        if request.session.is_empty() {
            request.session.clone_from(&self.session);
        }
        Ok(self.world().watch_overlaps(Request::new(request)).await?.into_inner())
    }

    /// What a viewer draws: first all shapes, then what changes, merged to the rate that is asked, until the stream is dropped.
    /// The client's deadline does not hold for it.
    pub async fn watch_world(
        &self,
        mut request: proto::WatchWorldRequest,
    ) -> Result<Streaming<proto::WatchWorldResponse>, Error> {
        if request.session.is_empty() {
            request.session.clone_from(&self.session);
        }
        Ok(self.world().watch_world(Request::new(request)).await?.into_inner())
    }

    /// Registers a geometry that fits into one message, and says its id. Repeating it returns the same id.
    pub async fn register(&self, geometry: proto::Geometry) -> Result<proto::GeometryInfo, Error> {
        let request =
            proto::CreateGeometryRequest { geometry: Some(geometry), ..proto::CreateGeometryRequest::default() };
        let response = self.create_geometry(request).await?;
        response
            .geometry
            .ok_or_else(|| Status::internal("the server registered a geometry and did not say which").into())
    }

    /// Makes a session, and a client of it that carries its owner's token.
    ///
    /// ```no_run
    /// # async fn example(client: calipers_client::Client) -> Result<(), calipers_client::Error> {
    /// let arena = client.open_session(calipers_client::proto::CreateSessionRequest::default()).await?;
    /// println!("{}", arena.session());
    /// # Ok(())
    /// # }
    /// ```
    pub async fn open_session(&self, request: proto::CreateSessionRequest) -> Result<Self, Error> {
        let response = self.create_session(request).await?;
        self.of_session(response.session, &response.token)
    }

    /// Makes a session whose world begins as a copy of this client's, and a client of it that carries its owner's token: try
    /// something out there, then delete it.
    ///
    /// ```no_run
    /// # async fn example(client: calipers_client::Client) -> Result<(), calipers_client::Error> {
    /// use calipers_client::{proto, shape};
    ///
    /// let what_if = client.fork(proto::ForkSessionRequest::default()).await?;
    /// what_if.edit([shape::sphere(9, 0.5).insert()]).await?;
    /// what_if.delete_session(proto::DeleteSessionRequest::default()).await?;
    /// # Ok(())
    /// # }
    /// ```
    pub async fn fork(&self, request: proto::ForkSessionRequest) -> Result<Self, Error> {
        let response = self.fork_session(request).await?;
        self.of_session(response.session, &response.token)
    }

    fn of_session(&self, session: Option<proto::Session>, token: &str) -> Result<Self, Error> {
        self.clone().with_session(session.unwrap_or_default().session).with_token(token)
    }
}

/// The innermost cause: the transport's own message is often no more than "transport error".
fn innermost(error: &dyn std::error::Error) -> String {
    let mut cause = error;
    while let Some(source) = cause.source() {
        cause = source;
    }
    cause.to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_address_needs_no_scheme() {
        assert_eq!(Client::endpoint("127.0.0.1:7070").unwrap().uri().to_string(), "http://127.0.0.1:7070/");
    }

    #[test]
    fn a_wrong_address_is_told_with_one_that_works() {
        for address in ["", "http://", "not an address", "https://127.0.0.1:7070"] {
            let said = Client::endpoint(address).unwrap_err().to_string();
            assert!(said.contains("http://127.0.0.1:7070"), "{said}");
        }
    }

    #[tokio::test]
    async fn nothing_listening_is_told_with_the_address() {
        let free = std::net::TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap();
        let said = Client::connect(&free.to_string()).await.unwrap_err().to_string();
        assert!(said.contains(&free.to_string()) && said.contains("refused"), "{said}");
    }

    #[tokio::test]
    async fn a_token_that_cannot_be_sent_is_refused_at_once() {
        let client = Client::from_channel(Channel::from_static("http://127.0.0.1:1").connect_lazy());
        assert!(matches!(client.clone().with_token("line\nbreak"), Err(Error::Token)));
        assert!(client.with_token("abc").is_ok());
    }
}
