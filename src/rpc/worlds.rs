//! The calls of `WorldService`, each handed to its own file.

use std::sync::Arc;

use tonic::{Request, Response, Status, Streaming};
use wire::v1 as pb;

use super::{
    Server, describe_world, edit, edit_stream, explain, export_world, import_world, list_shapes, update_world,
    watch_overlaps, watch_world,
};

/// `WorldService`.
#[derive(Clone, Debug)]
pub(super) struct Worlds(pub(super) Arc<Server>);

#[tonic::async_trait]
impl pb::world_service_server::WorldService for Worlds {
    async fn edit(&self, request: Request<pb::EditRequest>) -> Result<Response<pb::EditResponse>, Status> {
        edit::answer(&self.0, request).await
    }

    type EditStreamStream = super::Answers<pb::EditStreamResponse>;

    async fn edit_stream(
        &self,
        request: Request<Streaming<pb::EditStreamRequest>>,
    ) -> Result<Response<Self::EditStreamStream>, Status> {
        Ok(Response::new(edit_stream::open(self.0.clone(), request)))
    }

    async fn get_shape(&self, request: Request<pb::GetShapeRequest>) -> Result<Response<pb::GetShapeResponse>, Status> {
        list_shapes::get(&self.0, request).await
    }

    async fn list_shapes(
        &self,
        request: Request<pb::ListShapesRequest>,
    ) -> Result<Response<pb::ListShapesResponse>, Status> {
        list_shapes::list(&self.0, request).await
    }

    async fn describe_world(
        &self,
        request: Request<pb::DescribeWorldRequest>,
    ) -> Result<Response<pb::DescribeWorldResponse>, Status> {
        describe_world::answer(&self.0, request).await
    }

    async fn update_world(
        &self,
        request: Request<pb::UpdateWorldRequest>,
    ) -> Result<Response<pb::UpdateWorldResponse>, Status> {
        update_world::answer(&self.0, request).await
    }

    type WatchOverlapsStream = super::Answers<pb::WatchOverlapsResponse>;

    async fn watch_overlaps(
        &self,
        request: Request<pb::WatchOverlapsRequest>,
    ) -> Result<Response<Self::WatchOverlapsStream>, Status> {
        watch_overlaps::open(self.0.clone(), request).await
    }

    type WatchWorldStream = super::Answers<pb::WatchWorldResponse>;

    async fn watch_world(
        &self,
        request: Request<pb::WatchWorldRequest>,
    ) -> Result<Response<Self::WatchWorldStream>, Status> {
        watch_world::open(&self.0, request)
    }

    async fn explain(&self, request: Request<pb::ExplainRequest>) -> Result<Response<pb::ExplainResponse>, Status> {
        explain::answer(&self.0, request).await
    }

    type ExportWorldStream = super::Answers<pb::ExportWorldResponse>;

    async fn export_world(
        &self,
        request: Request<pb::ExportWorldRequest>,
    ) -> Result<Response<Self::ExportWorldStream>, Status> {
        export_world::open(&self.0, request).await
    }

    async fn import_world(
        &self,
        request: Request<Streaming<pb::ImportWorldRequest>>,
    ) -> Result<Response<pb::ImportWorldResponse>, Status> {
        import_world::answer(&self.0, request).await
    }
}
