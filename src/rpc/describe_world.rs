//! `DescribeWorld`: what the world holds, what was built for it, and what that costs.

use std::{sync::atomic::Ordering, time::Duration};

use collision::{math::Aabb, world::Tick};
use tonic::{Request, Response, Status};
use wire::v1 as pb;

use super::{Caller, Server};
use crate::{
    compute::{self, Weight},
    convert::{
        built::build_time_out,
        number::{duration, timestamp},
        place::{aabb_out, number_out},
        settings::settings_out,
    },
    token::Role,
};

/// Worlds of more shapes are described on another thread: it is a pass over all of them, about 3 µs each.
const DESCRIBED_AT_ONCE: usize = 64;

/// Describes the newest version.
///
/// # Errors
/// There is no such session.
pub(super) async fn answer(
    server: &Server,
    request: Request<pb::DescribeWorldRequest>,
) -> Result<Response<pb::DescribeWorldResponse>, Status> {
    let caller = Caller::of(&request);
    let session = server.enter(&caller, &request.into_inner().session, Role::Reader)?;
    let snapshot = session.newest();
    let weight = if snapshot.len() > DESCRIBED_AT_ONCE { Weight::Heavy } else { Weight::Light };
    let description = compute::run(weight, "describing a world", move || Ok(snapshot.describe())).await?;
    let built = description.built.iter().map(|built| pb::BuiltStructure {
        name: built.name.to_owned(),
        count: built.count,
        memory_bytes: built.memory_bytes,
        build_time: build_time_out(built.build_ns),
        first_tick: built.first_tick.map_or(0, Tick::get),
    });
    let counters = &session.counters;
    Ok(Response::new(pb::DescribeWorldResponse {
        settings: Some(settings_out(description.settings)),
        tick: description.tick.get(),
        oldest_tick: description.oldest_tick.get(),
        time: Some(timestamp(description.time)),
        shape_count: description.shape_count,
        static_count: description.static_count,
        bounds: description.bounds.map(aabb_out).transpose()?,
        coordinate_step: description.bounds.map_or(0.0, coordinate_step),
        tree_cost: number_out(description.tree_cost)?,
        tree_depth: description.tree_depth,
        built: built.collect(),
        memory_bytes: description.memory_bytes,
        question_count: counters.questions.load(Ordering::Relaxed),
        undecided_count: counters.undecided.load(Ordering::Relaxed),
        edit_count: counters.edits.load(Ordering::Relaxed),
        last_commit: Some(duration(Duration::from_nanos(counters.last_commit_ns.load(Ordering::Relaxed)))),
    }))
}

/// Distance between neighbouring doubles at the farthest coordinate.
fn coordinate_step(bounds: Aabb) -> f64 {
    let farthest = bounds.min.abs().max(bounds.max.abs()).max_element();
    farthest.next_up() - farthest
}

#[cfg(test)]
mod tests {
    use collision::DVec3;

    use super::*;

    #[test]
    fn the_step_is_that_of_the_farthest_coordinate_on_either_side() {
        let bounds = Aabb::new(DVec3::new(-4.0, 0.0, 0.0), DVec3::new(1.0, 2.0, 3.0));
        assert_eq!(coordinate_step(bounds), 4.0 * f64::EPSILON);
    }
}
