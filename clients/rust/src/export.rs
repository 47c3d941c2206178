//! Worlds in pieces: out of one session, into another, or into a file in between.

use tokio_stream::{Stream, StreamExt};
use tonic::{Request, Streaming};

use crate::Error;
use crate::client::Client;
use crate::proto;

impl Client {
    /// One tick of the world, complete in itself, in pieces of about a MiB: the newest, or the one that is named. The client's
    /// deadline does not hold for it.
    ///
    /// # Errors
    /// The tick is not held; who may not read the session.
    pub async fn export_world(
        &self,
        read_at: Option<proto::ReadAt>,
    ) -> Result<Streaming<proto::ExportWorldResponse>, Error> {
        let request = proto::ExportWorldRequest { session: self.session().to_owned(), read_at };
        Ok(self.world().export_world(Request::new(request)).await?.into_inner())
    }

    /// Fills the session's world, which must be empty, from the pieces of an export, all or nothing. The client's deadline does not
    /// hold for it.
    ///
    /// ```no_run
    /// # async fn example(from: calipers_client::Client, to: calipers_client::Client) -> Result<(), calipers_client::Error> {
    /// use tokio_stream::StreamExt;
    /// let pieces = from.export_world(None).await?;
    /// // A stream that breaks ends before its last piece, and the import with it.
    /// let whole = pieces.map_while(|response| response.ok()?.piece);
    /// let imported = to.import_world(whole).await?;
    /// println!("{} shapes at tick {}", imported.shape_count, imported.tick);
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    /// What the server says is wrong: a world that is not empty, pieces that are damaged or missing, a quota.
    pub async fn import_world(
        &self,
        pieces: impl Stream<Item = proto::WorldPiece> + Send + 'static,
    ) -> Result<proto::ImportWorldResponse, Error> {
        let mut session = self.session().to_owned();
        // The first message names the session.
        let messages = pieces
            .map(move |piece| proto::ImportWorldRequest { session: std::mem::take(&mut session), piece: Some(piece) });
        Ok(self.world().import_world(Request::new(messages)).await?.into_inner())
    }
}
