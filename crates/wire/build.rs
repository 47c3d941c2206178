//! Compiles `proto/` with protox, so that a build needs no `protoc`, and keeps the descriptors for reflection.

use std::{env, error::Error, fs, path::PathBuf};

use prost::Message;

const PROTO_ROOT: &str = "../../proto";
const PROTO_FILES: [&str; 5] = [
    "calipers/v1/types.proto",
    "calipers/v1/geometry.proto",
    "calipers/v1/world.proto",
    "calipers/v1/query.proto",
    "calipers/v1/session.proto",
];

/// The messages that are written out in `src/columns.rs`.
const COLUMN_MESSAGES: [&str; 17] = [
    "PoseColumns",
    "PairColumns",
    "ConvexHull",
    "TriangleMesh",
    "HeightField",
    "GeometryChunk",
    "Remove",
    "InsertColumns",
    "MoveColumns",
    "PairsResponse",
    "HitColumns",
    "RaycastBatchRequest",
    "OverlapBatchRequest",
    "OverlapBatchResponse",
    "DistanceBatchRequest",
    "LineOfSightRequest",
    "LineOfSightResponse",
];

/// Fields that stand in boxes, because most messages do without them: what is read, moved and kept by the thousand stays small.
const BOXED: [&str; 32] = [
    "options",
    "against",
    ".calipers.v1.Question.question.overlap",
    ".calipers.v1.Question.question.penetration",
    ".calipers.v1.Question.question.time_of_impact",
    ".calipers.v1.Question.question.distance",
    ".calipers.v1.Question.question.move_character",
    ".calipers.v1.Question.question.depenetrate",
    ".calipers.v1.Question.question.first_touch",
    ".calipers.v1.Question.question.resolve",
    ".calipers.v1.Question.question.pairs",
    ".calipers.v1.Answer.answer.move_character",
    ".calipers.v1.Answer.answer.depenetrate",
    ".calipers.v1.Answer.answer.resolve",
    ".calipers.v1.Answer.answer.pairs",
    ".calipers.v1.ExplainRequest.item",
    ".calipers.v1.ColumnItem.call.raycast_batch",
    ".calipers.v1.ColumnItem.call.overlap_batch",
    ".calipers.v1.ColumnItem.call.time_of_impact_batch",
    ".calipers.v1.ColumnItem.call.distance_batch",
    ".calipers.v1.ColumnItem.call.line_of_sight",
    ".calipers.v1.QueryStreamRequest.request.batch",
    ".calipers.v1.QueryStreamRequest.request.raycast_batch",
    ".calipers.v1.QueryStreamRequest.request.overlap_batch",
    ".calipers.v1.QueryStreamRequest.request.time_of_impact_batch",
    ".calipers.v1.QueryStreamRequest.request.distance_batch",
    ".calipers.v1.QueryStreamRequest.request.line_of_sight",
    ".calipers.v1.QueryStreamResponse.response.raycast_batch",
    ".calipers.v1.QueryStreamResponse.response.overlap_batch",
    ".calipers.v1.QueryStreamResponse.response.time_of_impact_batch",
    ".calipers.v1.QueryStreamResponse.response.distance_batch",
    ".calipers.v1.QueryStreamResponse.response.line_of_sight",
];

fn main() -> Result<(), Box<dyn Error>> {
    println!("cargo::rerun-if-changed={PROTO_ROOT}");
    let descriptors = protox::compile(PROTO_FILES, [PROTO_ROOT])?;
    let out_dir = PathBuf::from(env::var("OUT_DIR")?);
    fs::write(out_dir.join("calipers.bin"), descriptors.encode_to_vec())?;
    // What the tests hold the messages with columns against: the same ones as prost writes them.
    let reference = out_dir.join("reference");
    fs::create_dir_all(&reference)?;
    let messages = tonic_prost_build::configure().build_client(false).build_server(false).out_dir(reference);
    messages.compile_fds(descriptors.clone())?;
    let mut config = tonic_prost_build::configure().codec_path("crate::codec::ExactCodec");
    for name in COLUMN_MESSAGES {
        config = config.extern_path(format!(".calipers.v1.{name}"), format!("crate::columns::{name}"));
    }
    for field in BOXED {
        config = config.boxed(field);
    }
    config.compile_fds(descriptors)?;
    Ok(())
}
