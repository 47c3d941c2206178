//! The calls of `GeometryService`, each handed to its own file.

use std::sync::Arc;

use tonic::{Request, Response, Status, Streaming};
use wire::v1 as pb;

use super::{Server, download, geometry, upload};

/// `GeometryService`.
#[derive(Clone, Debug)]
pub(super) struct Geometries(pub(super) Arc<Server>);

#[tonic::async_trait]
impl pb::geometry_service_server::GeometryService for Geometries {
    async fn create_geometry(
        &self,
        request: Request<pb::CreateGeometryRequest>,
    ) -> Result<Response<pb::CreateGeometryResponse>, Status> {
        geometry::create(&self.0, request).await
    }

    async fn upload_geometry(
        &self,
        request: Request<Streaming<pb::UploadGeometryRequest>>,
    ) -> Result<Response<pb::UploadGeometryResponse>, Status> {
        upload::answer(&self.0, request).await
    }

    async fn get_geometry(
        &self,
        request: Request<pb::GetGeometryRequest>,
    ) -> Result<Response<pb::GetGeometryResponse>, Status> {
        geometry::get(&self.0, request).await
    }

    type DownloadGeometryStream = super::Answers<pb::DownloadGeometryResponse>;

    async fn download_geometry(
        &self,
        request: Request<pb::DownloadGeometryRequest>,
    ) -> Result<Response<Self::DownloadGeometryStream>, Status> {
        download::answer(&self.0, request)
    }

    async fn list_geometries(
        &self,
        request: Request<pb::ListGeometriesRequest>,
    ) -> Result<Response<pb::ListGeometriesResponse>, Status> {
        geometry::list(&self.0, request)
    }

    async fn delete_geometry(
        &self,
        request: Request<pb::DeleteGeometryRequest>,
    ) -> Result<Response<pb::DeleteGeometryResponse>, Status> {
        geometry::delete(&self.0, request)
    }
}
