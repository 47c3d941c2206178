//! The calls of `QueryService`, each handed to its own file.

use std::sync::Arc;

use tonic::{Request, Response, Status, Streaming};
use wire::v1 as pb;

use super::{Server, batch, distance, later, overlap, pairs, penetration, raycast, scene::unary, time_of_impact};

/// `QueryService`.
#[derive(Clone, Debug)]
pub(super) struct Questions(pub(super) Arc<Server>);

#[tonic::async_trait]
impl pb::query_service_server::QueryService for Questions {
    async fn raycast(&self, request: Request<pb::RaycastRequest>) -> Result<Response<pb::RaycastResponse>, Status> {
        unary(&self.0, request, raycast::answer).await
    }

    async fn overlap(&self, request: Request<pb::OverlapRequest>) -> Result<Response<pb::OverlapResponse>, Status> {
        unary(&self.0, request, overlap::answer).await
    }

    async fn penetration(
        &self,
        request: Request<pb::PenetrationRequest>,
    ) -> Result<Response<pb::PenetrationResponse>, Status> {
        unary(&self.0, request, penetration::answer).await
    }

    async fn time_of_impact(
        &self,
        request: Request<pb::TimeOfImpactRequest>,
    ) -> Result<Response<pb::TimeOfImpactResponse>, Status> {
        unary(&self.0, request, time_of_impact::answer).await
    }

    async fn distance(&self, request: Request<pb::DistanceRequest>) -> Result<Response<pb::DistanceResponse>, Status> {
        unary(&self.0, request, distance::answer).await
    }

    async fn move_character(
        &self,
        _request: Request<pb::MoveCharacterRequest>,
    ) -> Result<Response<pb::MoveCharacterResponse>, Status> {
        Err(later::MOVE_CHARACTER.into())
    }

    async fn resolve(&self, _request: Request<pb::ResolveRequest>) -> Result<Response<pb::ResolveResponse>, Status> {
        Err(later::RESOLVE.into())
    }

    type PairsStream = super::Answers<pb::PairsResponse>;

    async fn pairs(&self, request: Request<pb::PairsRequest>) -> Result<Response<Self::PairsStream>, Status> {
        pairs::answer(&self.0, request).await
    }

    async fn batch(&self, request: Request<pb::BatchRequest>) -> Result<Response<pb::BatchResponse>, Status> {
        batch::answer(&self.0, request).await
    }

    async fn raycast_batch(
        &self,
        _request: Request<pb::RaycastBatchRequest>,
    ) -> Result<Response<pb::RaycastBatchResponse>, Status> {
        Err(later::RAYCAST_BATCH.into())
    }

    async fn overlap_batch(
        &self,
        _request: Request<pb::OverlapBatchRequest>,
    ) -> Result<Response<pb::OverlapBatchResponse>, Status> {
        Err(later::OVERLAP_BATCH.into())
    }

    async fn time_of_impact_batch(
        &self,
        _request: Request<pb::TimeOfImpactBatchRequest>,
    ) -> Result<Response<pb::TimeOfImpactBatchResponse>, Status> {
        Err(later::TIME_OF_IMPACT_BATCH.into())
    }

    async fn distance_batch(
        &self,
        _request: Request<pb::DistanceBatchRequest>,
    ) -> Result<Response<pb::DistanceBatchResponse>, Status> {
        Err(later::DISTANCE_BATCH.into())
    }

    type QueryStreamStream = super::Answers<pb::QueryStreamResponse>;

    async fn query_stream(
        &self,
        _request: Request<Streaming<pb::QueryStreamRequest>>,
    ) -> Result<Response<Self::QueryStreamStream>, Status> {
        Err(later::QUERY_STREAM.into())
    }
}
