//! The messages that are one of several kinds, from each kind: whether it stands in a box there is for nobody to know.

use crate::v1::{self as pb, answer::Answer, query_stream_request, query_stream_response, question::Question};

macro_rules! one_of {
    ($whole:ty: $($kind:ident $message:ident),*) => {
        $(impl From<pb::$message> for $whole {
            fn from(message: pb::$message) -> Self {
                Self::$kind(message.into())
            }
        })*
    };
}

one_of!(
    Question:
    Raycast RaycastRequest,
    Overlap OverlapRequest,
    Penetration PenetrationRequest,
    TimeOfImpact TimeOfImpactRequest,
    Distance DistanceRequest,
    MoveCharacter MoveCharacterRequest,
    Depenetrate DepenetrateRequest,
    FirstTouch FirstTouchRequest,
    Resolve ResolveRequest,
    Pairs PairsRequest
);

one_of!(
    Answer:
    Raycast RaycastResponse,
    Overlap OverlapResponse,
    Penetration PenetrationResponse,
    TimeOfImpact TimeOfImpactResponse,
    Distance DistanceResponse,
    MoveCharacter MoveCharacterResponse,
    Depenetrate DepenetrateResponse,
    FirstTouch FirstTouchResponse,
    Resolve ResolveResponse,
    Pairs PairsResponse,
    Problem Problem
);

one_of!(
    query_stream_request::Request:
    Question Question,
    Batch BatchRequest,
    RaycastBatch RaycastBatchRequest,
    OverlapBatch OverlapBatchRequest,
    TimeOfImpactBatch TimeOfImpactBatchRequest,
    DistanceBatch DistanceBatchRequest,
    LineOfSight LineOfSightRequest
);

one_of!(
    query_stream_response::Response:
    Answer Answer,
    Batch BatchResponse,
    RaycastBatch RaycastBatchResponse,
    OverlapBatch OverlapBatchResponse,
    TimeOfImpactBatch TimeOfImpactBatchResponse,
    DistanceBatch DistanceBatchResponse,
    LineOfSight LineOfSightResponse,
    Problem Problem
);
