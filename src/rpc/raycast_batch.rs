//! `RaycastBatch`: many rays, as columns.

use wire::v1::{self as pb, answer::Answer as Kind};

use super::{items::Items, scene::Scene};
use crate::{
    convert::{answer, hit_columns::Hits, rays::Rays, trace},
    problem::Checked,
};

/// Answers it on the scene's version.
///
/// # Errors
/// A wrong column or item, the deadline.
pub(super) async fn answer(sent: &pb::RaycastBatchRequest, scene: &Scene) -> Checked<pb::RaycastBatchResponse> {
    let rays = Rays::new(sent)?;
    let mut items = Items::of(sent, scene)?;
    let mut hits = Hits::new(sent.want.as_ref(), rays.frame_origin(), rays.len());
    let each = items.each(rays.len(), |turn, index| {
        let (question, ignored) = rays.item(index)?;
        let found = turn
            .ask(index, ignored, |world, filter, accuracy, meter| world.raycast(&question, filter, accuracy, meter))?;
        if index == 0 {
            scene.tell(|| (trace::ray(sent, &question.ray, ignored), answer::raycast(&found).map(Kind::from)));
        }
        hits.add(&found, question.ray.max_distance)
    });
    each.await?;
    Ok(pb::RaycastBatchResponse { hits: Some(hits.finish()), info: items.info() })
}
