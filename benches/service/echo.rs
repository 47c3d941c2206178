//! A server that says the same answer to every question: what the wire alone costs.

use std::pin::Pin;

use tokio::sync::mpsc;
use tokio_stream::{Stream, wrappers::ReceiverStream};
use tonic::{Request, Response, Status, Streaming};
use wire::v1::{
    self as pb, answer::Answer as Kind, query_service_server::QueryService, query_stream_request::Request as Asked,
    query_stream_response::Response as Answered,
};

/// Answers that wait for their reader, as in the real server.
const UNREAD_ANSWERS: usize = 256;

type Answers<T> = Pin<Box<dyn Stream<Item = Result<T, Status>> + Send>>;

/// The questions that the bench asks, answered with one hit each.
#[derive(Debug)]
pub(crate) struct Echo;

/// A hit with everything that a usual one has.
fn ray() -> pb::RaycastResponse {
    let vector = Some(pb::Vec3 { x: 1.25, y: -2.5, z: 0.75 });
    pb::RaycastResponse {
        verdict: pb::Verdict::Hit.into(),
        hits: vec![pb::RayHit {
            id: 77,
            distance: Some(4.5),
            point: vector,
            normal: vector,
            certificate: Some(pb::Certificate {
                verdict: pb::Verdict::Hit.into(),
                interval: Some(pb::Interval { lower: Some(4.5), upper: Some(4.5) }),
                method: pb::Method::ClosedForm.into(),
                stop: pb::Stop::Converged.into(),
                iterations: 1,
                ..pb::Certificate::default()
            }),
            ..pb::RayHit::default()
        }],
        truncated: false,
        info: Some(pb::AnswerInfo { tick: 2, ..pb::AnswerInfo::default() }),
    }
}

fn batch(request: &pb::BatchRequest) -> pb::BatchResponse {
    let answer = pb::Answer { answer: Some(Kind::Raycast(pb::RaycastResponse { info: None, ..ray() })) };
    pb::BatchResponse { answers: vec![answer; request.questions.len()], info: ray().info }
}

fn rays(request: &pb::RaycastBatchRequest) -> pb::RaycastBatchResponse {
    let n = request.directions.len() / 3;
    let hits = pb::HitColumns {
        verdicts: vec![pb::Verdict::Hit.into(); n],
        ids: vec![77; n],
        values: vec![4.5; n],
        ..pb::HitColumns::default()
    };
    pb::RaycastBatchResponse { hits: Some(hits), info: ray().info }
}

fn not_asked<T>() -> Result<Response<T>, Status> {
    Err(Status::unimplemented("the bench does not ask this"))
}

#[tonic::async_trait]
impl QueryService for Echo {
    async fn raycast(&self, _: Request<pb::RaycastRequest>) -> Result<Response<pb::RaycastResponse>, Status> {
        Ok(Response::new(ray()))
    }

    async fn batch(&self, request: Request<pb::BatchRequest>) -> Result<Response<pb::BatchResponse>, Status> {
        Ok(Response::new(batch(request.get_ref())))
    }

    async fn raycast_batch(
        &self,
        request: Request<pb::RaycastBatchRequest>,
    ) -> Result<Response<pb::RaycastBatchResponse>, Status> {
        Ok(Response::new(rays(request.get_ref())))
    }

    type QueryStreamStream = Answers<pb::QueryStreamResponse>;

    async fn query_stream(
        &self,
        request: Request<Streaming<pb::QueryStreamRequest>>,
    ) -> Result<Response<Self::QueryStreamStream>, Status> {
        let mut messages = request.into_inner();
        let (answers, unread) = mpsc::channel(UNREAD_ANSWERS);
        tokio::spawn(async move {
            while let Ok(Some(message)) = messages.message().await {
                let response = match message.request {
                    Some(Asked::RaycastBatch(request)) => rays(&request).into(),
                    Some(Asked::Batch(request)) => batch(&request).into(),
                    _ => Answered::Answer(pb::Answer { answer: Some(Kind::Raycast(ray())) }),
                };
                let answer = pb::QueryStreamResponse { request_id: message.request_id, response: Some(response) };
                if answers.send(Ok(answer)).await.is_err() {
                    return;
                }
            }
        });
        Ok(Response::new(Box::pin(ReceiverStream::new(unread))))
    }

    async fn overlap(&self, _: Request<pb::OverlapRequest>) -> Result<Response<pb::OverlapResponse>, Status> {
        not_asked()
    }

    async fn penetration(
        &self,
        _: Request<pb::PenetrationRequest>,
    ) -> Result<Response<pb::PenetrationResponse>, Status> {
        not_asked()
    }

    async fn time_of_impact(
        &self,
        _: Request<pb::TimeOfImpactRequest>,
    ) -> Result<Response<pb::TimeOfImpactResponse>, Status> {
        not_asked()
    }

    async fn distance(&self, _: Request<pb::DistanceRequest>) -> Result<Response<pb::DistanceResponse>, Status> {
        not_asked()
    }

    async fn move_character(
        &self,
        _: Request<pb::MoveCharacterRequest>,
    ) -> Result<Response<pb::MoveCharacterResponse>, Status> {
        not_asked()
    }

    async fn depenetrate(
        &self,
        _: Request<pb::DepenetrateRequest>,
    ) -> Result<Response<pb::DepenetrateResponse>, Status> {
        not_asked()
    }

    async fn first_touch(&self, _: Request<pb::FirstTouchRequest>) -> Result<Response<pb::FirstTouchResponse>, Status> {
        not_asked()
    }

    async fn resolve(&self, _: Request<pb::ResolveRequest>) -> Result<Response<pb::ResolveResponse>, Status> {
        not_asked()
    }

    type PairsStream = Answers<pb::PairsResponse>;

    async fn pairs(&self, _: Request<pb::PairsRequest>) -> Result<Response<Self::PairsStream>, Status> {
        not_asked()
    }

    async fn overlap_batch(
        &self,
        _: Request<pb::OverlapBatchRequest>,
    ) -> Result<Response<pb::OverlapBatchResponse>, Status> {
        not_asked()
    }

    async fn time_of_impact_batch(
        &self,
        _: Request<pb::TimeOfImpactBatchRequest>,
    ) -> Result<Response<pb::TimeOfImpactBatchResponse>, Status> {
        not_asked()
    }

    async fn distance_batch(
        &self,
        _: Request<pb::DistanceBatchRequest>,
    ) -> Result<Response<pb::DistanceBatchResponse>, Status> {
        not_asked()
    }

    async fn line_of_sight(
        &self,
        _: Request<pb::LineOfSightRequest>,
    ) -> Result<Response<pb::LineOfSightResponse>, Status> {
        not_asked()
    }
}
