//! The calls of `GeometryService`, each handed to its own file.

use std::sync::Arc;

use tonic::{Request, Response, Status, Streaming};
use wire::v1 as pb;

use super::{Server, later};

/// `GeometryService`.
#[derive(Clone, Debug)]
pub(super) struct Geometries(pub(super) Arc<Server>);

#[tonic::async_trait]
impl pb::geometry_service_server::GeometryService for Geometries {
    async fn create_geometry(
        &self,
        _request: Request<pb::CreateGeometryRequest>,
    ) -> Result<Response<pb::CreateGeometryResponse>, Status> {
        Err(Status::unimplemented("not served yet"))
    }

    async fn upload_geometry(
        &self,
        _request: Request<Streaming<pb::UploadGeometryRequest>>,
    ) -> Result<Response<pb::UploadGeometryResponse>, Status> {
        Err(later::UPLOAD_GEOMETRY.into())
    }

    async fn get_geometry(
        &self,
        _request: Request<pb::GetGeometryRequest>,
    ) -> Result<Response<pb::GetGeometryResponse>, Status> {
        Err(Status::unimplemented("not served yet"))
    }

    type DownloadGeometryStream = super::Answers<pb::DownloadGeometryResponse>;

    async fn download_geometry(
        &self,
        _request: Request<pb::DownloadGeometryRequest>,
    ) -> Result<Response<Self::DownloadGeometryStream>, Status> {
        Err(later::DOWNLOAD_GEOMETRY.into())
    }

    async fn list_geometries(
        &self,
        _request: Request<pb::ListGeometriesRequest>,
    ) -> Result<Response<pb::ListGeometriesResponse>, Status> {
        Err(Status::unimplemented("not served yet"))
    }

    async fn delete_geometry(
        &self,
        _request: Request<pb::DeleteGeometryRequest>,
    ) -> Result<Response<pb::DeleteGeometryResponse>, Status> {
        Err(Status::unimplemented("not served yet"))
    }
}
