//! The calls of `QueryService`, each handed to its own file.

use std::sync::Arc;

use tonic::{Request, Response, Status, Streaming};
use wire::v1 as pb;

use super::{
    Caller, Server, batch, depenetrate, distance, distance_batch, first_touch, fitting, line_of_sight, move_character,
    overlap, overlap_batch, pairs, penetration, query_stream, raycast, raycast_batch, resolve,
    scene::{Asking, Scene, unary},
    time_of_impact, time_of_impact_batch,
};

/// What a caller can do about an answer that is too large.
const FEWER: &str = "ask for fewer columns, or in several calls";

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
        request: Request<pb::MoveCharacterRequest>,
    ) -> Result<Response<pb::MoveCharacterResponse>, Status> {
        unary(&self.0, request, move_character::answer).await
    }

    async fn depenetrate(
        &self,
        request: Request<pb::DepenetrateRequest>,
    ) -> Result<Response<pb::DepenetrateResponse>, Status> {
        unary(&self.0, request, depenetrate::answer).await
    }

    async fn first_touch(
        &self,
        request: Request<pb::FirstTouchRequest>,
    ) -> Result<Response<pb::FirstTouchResponse>, Status> {
        unary(&self.0, request, first_touch::answer).await
    }

    async fn resolve(&self, request: Request<pb::ResolveRequest>) -> Result<Response<pb::ResolveResponse>, Status> {
        unary(&self.0, request, resolve::answer).await
    }

    type PairsStream = super::Answers<pb::PairsResponse>;

    async fn pairs(&self, request: Request<pb::PairsRequest>) -> Result<Response<Self::PairsStream>, Status> {
        pairs::call(&self.0, request).await
    }

    async fn batch(&self, request: Request<pb::BatchRequest>) -> Result<Response<pb::BatchResponse>, Status> {
        let (sent, scene) = enter(&self.0, request).await?;
        let answer = batch::answer(&sent, &scene).await?;
        Ok(Response::new(fitting(answer, "ask for fewer hits, or in several batches")?))
    }

    async fn raycast_batch(
        &self,
        request: Request<pb::RaycastBatchRequest>,
    ) -> Result<Response<pb::RaycastBatchResponse>, Status> {
        let (sent, scene) = enter(&self.0, request).await?;
        Ok(Response::new(fitting(raycast_batch::answer(&sent, &scene).await?, FEWER)?))
    }

    async fn overlap_batch(
        &self,
        request: Request<pb::OverlapBatchRequest>,
    ) -> Result<Response<pb::OverlapBatchResponse>, Status> {
        let (sent, scene) = enter(&self.0, request).await?;
        Ok(Response::new(fitting(overlap_batch::answer(&sent, &scene).await?, FEWER)?))
    }

    async fn time_of_impact_batch(
        &self,
        request: Request<pb::TimeOfImpactBatchRequest>,
    ) -> Result<Response<pb::TimeOfImpactBatchResponse>, Status> {
        let (sent, scene) = enter(&self.0, request).await?;
        Ok(Response::new(fitting(time_of_impact_batch::answer(&sent, &scene).await?, FEWER)?))
    }

    async fn distance_batch(
        &self,
        request: Request<pb::DistanceBatchRequest>,
    ) -> Result<Response<pb::DistanceBatchResponse>, Status> {
        let (sent, scene) = enter(&self.0, request).await?;
        Ok(Response::new(fitting(distance_batch::answer(&sent, &scene).await?, FEWER)?))
    }

    async fn line_of_sight(
        &self,
        request: Request<pb::LineOfSightRequest>,
    ) -> Result<Response<pb::LineOfSightResponse>, Status> {
        let (sent, scene) = enter(&self.0, request).await?;
        Ok(Response::new(fitting(line_of_sight::answer(&sent, &scene).await?, "ask in several calls")?))
    }

    type QueryStreamStream = super::Answers<pb::QueryStreamResponse>;

    async fn query_stream(
        &self,
        request: Request<Streaming<pb::QueryStreamRequest>>,
    ) -> Result<Response<Self::QueryStreamStream>, Status> {
        Ok(Response::new(query_stream::open(self.0.clone(), request)))
    }
}

/// A request with columns or many questions, and what it is asked in.
async fn enter<Q: Asking>(server: &Server, request: Request<Q>) -> Result<(Q, Scene), Status> {
    let caller = Caller::of(&request);
    let sent = request.into_inner();
    let scene = Scene::of(server, &caller, &sent).await?;
    Ok((sent, scene))
}
