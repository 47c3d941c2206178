//! Reads a replay from a file: as protobuf bytes or as JSON, alone or as the answer of a call holds it.

use std::path::Path;

use calipers_client::proto;
use prost::Message;
use prost_reflect::{DescriptorPool, DynamicMessage};

use super::Failure;

/// The name of the message that a file holds.
const REPLAY: &str = "calipers.v1.Replay";
/// The name of the message that a call answers with, which holds it.
const RESPONSE: &str = "calipers.v1.ExplainResponse";

/// Tag of the layout, the first field of a replay, on the wire; the first of an answer, a message, has another.
const FIRST_BYTE: u8 = 0x08;

/// The replay in a file.
///
/// # Errors
/// It cannot be read, or holds no replay.
pub(crate) fn read(path: &Path) -> Result<proto::Replay, Failure> {
    let name = path.display();
    let bytes = std::fs::read(path).map_err(|error| Failure::new(format!("{name} cannot be read: {error}")))?;
    let replay = parse(&bytes).map_err(|why| Failure::new(format!("{name} holds no replay: {why}")))?;
    match replay.question {
        Some(_) => Ok(replay),
        None => Err(Failure::new(format!("{name} holds no question; it should be what WorldService/Explain answers"))),
    }
}

fn parse(bytes: &[u8]) -> Result<proto::Replay, String> {
    match bytes.iter().find(|byte| !byte.is_ascii_whitespace()) {
        None => Err("it is empty".to_owned()),
        Some(b'{') => from_json(bytes),
        Some(_) => from_bytes(bytes),
    }
}

fn from_bytes(bytes: &[u8]) -> Result<proto::Replay, String> {
    let damaged = |error: prost::DecodeError| format!("neither JSON nor whole protobuf bytes ({error})");
    if bytes[0] == FIRST_BYTE {
        return proto::Replay::decode(bytes).map_err(damaged);
    }
    let response = proto::ExplainResponse::decode(bytes).map_err(damaged)?;
    response.replay.ok_or_else(|| "the answer is empty".to_owned())
}

fn from_json(bytes: &[u8]) -> Result<proto::Replay, String> {
    let value: serde_json::Value =
        serde_json::from_slice(bytes).map_err(|error| format!("the JSON ends or errs: {error}"))?;
    let name = if value.get("replay").is_some() { RESPONSE } else { REPLAY };
    let descriptor = pool()?.get_message_by_name(name).ok_or_else(|| format!("{name} is unknown"))?;
    let message = DynamicMessage::deserialize(descriptor, value).map_err(|error| format!("{name}: {error}"))?;
    from_bytes(&message.encode_to_vec())
}

/// A message as JSON, as grpcurl would print it on one line.
pub(crate) fn to_json(name: &str, message: &impl Message) -> String {
    let found = pool().ok().and_then(|pool| pool.get_message_by_name(&format!("calipers.v1.{name}")));
    let decoded = found.and_then(|found| DynamicMessage::decode(found, message.encode_to_vec().as_slice()).ok());
    decoded.and_then(|decoded| serde_json::to_string(&decoded).ok()).unwrap_or_default()
}

fn pool() -> Result<DescriptorPool, String> {
    DescriptorPool::decode(proto::FILE_DESCRIPTOR_SET).map_err(|error| error.to_string())
}
