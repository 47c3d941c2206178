//! Sends a geometry of any size in chunks.

use tokio::sync::mpsc;
use tokio_stream::wrappers::ReceiverStream;
use tonic::{Request, Status};

use crate::Error;
use crate::client::Client;
use crate::proto::{self, geometry::Kind, geometry_piece::Piece};

/// Numbers of a chunk: 1 MiB.
const NUMBERS: usize = 1 << 18;
/// Chunks that wait for the network.
const UNSENT_CHUNKS: usize = 2;

/// How far an upload is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Uploaded {
    /// Bytes handed to the network.
    pub sent_bytes: u64,
    /// Bytes of all numbers.
    pub total_bytes: u64,
}

impl Client {
    /// Registers a hull, a mesh or a height field of any size, in chunks of 1 MiB, and says its id. `watch` hears of each
    /// chunk. The client's deadline does not count.
    ///
    /// ```no_run
    /// # async fn example(client: calipers_client::Client) -> Result<(), calipers_client::Error> {
    /// let level = calipers_client::geometry::mesh([[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], [[0, 1, 2]]);
    /// let info = client.upload(level, |so_far| println!("{} bytes", so_far.sent_bytes)).await?;
    /// println!("{} triangles as {}", info.face_count, info.geometry_id);
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    /// What the server says is wrong with it.
    pub async fn upload(
        &self,
        mut geometry: proto::Geometry,
        mut watch: impl FnMut(Uploaded),
    ) -> Result<proto::GeometryInfo, Error> {
        let (values, indices) = lists_of(&mut geometry);
        let total_bytes = 4 * (values.len() + indices.len()) as u64;
        let header = proto::GeometryHeader {
            geometry: Some(geometry),
            value_count: values.len() as u64,
            index_count: indices.len() as u64,
        };
        let (pieces, unsent) = mpsc::channel(UNSENT_CHUNKS);
        let session = self.session().to_owned();
        let send = async move {
            let values = values.chunks(NUMBERS).map(|part| (part, [].as_slice()));
            let indices = indices.chunks(NUMBERS).map(|part| ([].as_slice(), part));
            // A server that refuses takes no more; why is in its answer.
            let mut is_taken = pieces.send(piece(&session, Piece::Header(header))).await.is_ok();
            let mut sent_bytes = 0;
            for (values, indices) in values.chain(indices) {
                let chunk = proto::GeometryChunk { values: values.to_vec(), indices: indices.to_vec() };
                is_taken = is_taken && pieces.send(piece("", Piece::Chunk(chunk))).await.is_ok();
                if !is_taken {
                    return;
                }
                sent_bytes += 4 * (values.len() + indices.len()) as u64;
                watch(Uploaded { sent_bytes, total_bytes });
            }
        };
        let mut geometries = self.geometries();
        let answer = geometries.upload_geometry(Request::new(ReceiverStream::new(unsent)));
        let (answer, ()) = tokio::join!(answer, send);
        let info = answer?.into_inner().geometry;
        info.ok_or_else(|| Status::internal("the server registered a geometry and did not say which").into())
    }
}

/// Takes the long lists out of a geometry.
fn lists_of(geometry: &mut proto::Geometry) -> (Vec<f32>, Vec<u32>) {
    match &mut geometry.kind {
        Some(Kind::Hull(hull)) => (std::mem::take(&mut hull.points), Vec::new()),
        Some(Kind::Mesh(mesh)) => (std::mem::take(&mut mesh.vertices), std::mem::take(&mut mesh.indices)),
        Some(Kind::HeightField(field)) => (std::mem::take(&mut field.heights), std::mem::take(&mut field.holes)),
        Some(_) | None => (Vec::new(), Vec::new()),
    }
}

fn piece(session: &str, piece: Piece) -> proto::UploadGeometryRequest {
    let piece = Some(proto::GeometryPiece { piece: Some(piece) });
    proto::UploadGeometryRequest { session: session.to_owned(), piece }
}
