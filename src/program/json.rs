//! Answers as JSON for programs.
//!
//! The fields have the names of the `.proto` files; numbers are numbers, and nothing that is there is left out because
//! it is zero.

use calipers_client::proto;
use serde_json::{Value, json};

/// A ray's answer as JSON.
pub(crate) fn raycast(answer: &proto::RaycastResponse) -> Value {
    let hits = answer.hits.iter().map(|hit| {
        json!({
            "id": hit.id,
            "distance": hit.distance,
            "point": vector(hit.point),
            "normal": vector(hit.normal),
            "inside": hit.inside,
            "face": hit.feature.and_then(|feature| feature.face),
            "barycentric": vector(hit.barycentric),
            "user_data": hit.user_data,
            "certificate": certificate(hit.certificate.as_ref()),
        })
    });
    json!({
        "verdict": answer.verdict().as_str_name(),
        "hits": hits.collect::<Vec<_>>(),
        "truncated": answer.truncated,
        "tick": tick_of(answer.info.as_ref()),
    })
}

/// An overlap's answer as JSON.
pub(crate) fn overlap(answer: &proto::OverlapResponse) -> Value {
    let hits = answer.hits.iter().map(|hit| {
        json!({
            "id": hit.id,
            "user_data": hit.user_data,
            "certificate": certificate(hit.certificate.as_ref()),
        })
    });
    json!({
        "verdict": answer.verdict().as_str_name(),
        "hits": hits.collect::<Vec<_>>(),
        "truncated": answer.truncated,
        "tick": tick_of(answer.info.as_ref()),
    })
}

/// A world as JSON.
pub(crate) fn world(world: &proto::DescribeWorldResponse) -> Value {
    let built = world.built.iter().map(|built| {
        json!({
            "name": built.name,
            "count": built.count,
            "memory_bytes": built.memory_bytes,
            "build_time_seconds": built.build_time.as_ref().map(seconds),
            "first_tick": built.first_tick,
        })
    });
    json!({
        "tick": world.tick,
        "oldest_tick": world.oldest_tick,
        "shape_count": world.shape_count,
        "static_count": world.static_count,
        "bounds": world.bounds.as_ref().map(|bounds| json!({
            "min": vector(bounds.min),
            "max": vector(bounds.max),
        })),
        "coordinate_step": world.coordinate_step,
        "tree_cost": world.tree_cost,
        "tree_depth": world.tree_depth,
        "built": built.collect::<Vec<_>>(),
        "memory_bytes": world.memory_bytes,
        "question_count": world.question_count,
        "undecided_count": world.undecided_count,
        "edit_count": world.edit_count,
        "last_commit_seconds": world.last_commit.as_ref().map(seconds),
    })
}

fn tick_of(info: Option<&proto::AnswerInfo>) -> u64 {
    info.map_or(0, |info| info.tick)
}

fn vector(value: Option<proto::Vec3>) -> Value {
    value.map_or(Value::Null, |proto::Vec3 { x, y, z }| json!([x, y, z]))
}

fn certificate(value: Option<&proto::Certificate>) -> Value {
    let Some(certificate) = value else { return Value::Null };
    json!({
        "verdict": certificate.verdict().as_str_name(),
        "lower": certificate.interval.as_ref().and_then(|interval| interval.lower),
        "upper": certificate.interval.as_ref().and_then(|interval| interval.upper),
        "representation": certificate.representation().as_str_name(),
        "outside": certificate.outside,
        "inside": certificate.inside,
        "method": certificate.method().as_str_name(),
        "stop": certificate.stop().as_str_name(),
        "iterations": certificate.iterations,
    })
}

fn seconds(time: &prost_types::Duration) -> f64 {
    time.seconds as f64 + f64::from(time.nanos) * 1e-9
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hit_at_distance_zero_is_printed() {
        let hit = proto::RayHit { id: 3, distance: Some(0.0), inside: true, ..Default::default() };
        let answer = proto::RaycastResponse { hits: vec![hit], ..Default::default() };
        assert_eq!(raycast(&answer)["hits"][0]["distance"], json!(0.0));
    }
}
