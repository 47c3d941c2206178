//! The calls of `WorldService`, each handed to its own file.

use std::sync::Arc;

use tonic::{Request, Response, Status, Streaming};
use wire::v1 as pb;

use super::{Server, later};

/// `WorldService`.
#[derive(Clone, Debug)]
pub(super) struct Worlds(pub(super) Arc<Server>);

#[tonic::async_trait]
impl pb::world_service_server::WorldService for Worlds {
    async fn edit(&self, _request: Request<pb::EditRequest>) -> Result<Response<pb::EditResponse>, Status> {
        Err(Status::unimplemented("not served yet"))
    }

    type EditStreamStream = super::Answers<pb::EditStreamResponse>;

    async fn edit_stream(
        &self,
        _request: Request<Streaming<pb::EditStreamRequest>>,
    ) -> Result<Response<Self::EditStreamStream>, Status> {
        Err(Status::unimplemented("not served yet"))
    }

    async fn get_shape(
        &self,
        _request: Request<pb::GetShapeRequest>,
    ) -> Result<Response<pb::GetShapeResponse>, Status> {
        Err(Status::unimplemented("not served yet"))
    }

    async fn list_shapes(
        &self,
        _request: Request<pb::ListShapesRequest>,
    ) -> Result<Response<pb::ListShapesResponse>, Status> {
        Err(Status::unimplemented("not served yet"))
    }

    async fn describe_world(
        &self,
        _request: Request<pb::DescribeWorldRequest>,
    ) -> Result<Response<pb::DescribeWorldResponse>, Status> {
        Err(Status::unimplemented("not served yet"))
    }

    async fn update_world(
        &self,
        _request: Request<pb::UpdateWorldRequest>,
    ) -> Result<Response<pb::UpdateWorldResponse>, Status> {
        Err(later::UPDATE_WORLD.into())
    }

    type WatchOverlapsStream = super::Answers<pb::WatchOverlapsResponse>;

    async fn watch_overlaps(
        &self,
        _request: Request<pb::WatchOverlapsRequest>,
    ) -> Result<Response<Self::WatchOverlapsStream>, Status> {
        Err(later::WATCH_OVERLAPS.into())
    }

    type WatchWorldStream = super::Answers<pb::WatchWorldResponse>;

    async fn watch_world(
        &self,
        _request: Request<pb::WatchWorldRequest>,
    ) -> Result<Response<Self::WatchWorldStream>, Status> {
        Err(later::WATCH_WORLD.into())
    }

    type ExportWorldStream = super::Answers<pb::ExportWorldResponse>;

    async fn export_world(
        &self,
        _request: Request<pb::ExportWorldRequest>,
    ) -> Result<Response<Self::ExportWorldStream>, Status> {
        Err(later::EXPORT_WORLD.into())
    }

    async fn import_world(
        &self,
        _request: Request<Streaming<pb::ImportWorldRequest>>,
    ) -> Result<Response<pb::ImportWorldResponse>, Status> {
        Err(later::IMPORT_WORLD.into())
    }
}
