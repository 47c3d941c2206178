//! `RaycastBatch`: many rays, as columns.

use wire::v1::{self as pb, answer::Answer as Kind};

use super::{items::Items, raycast::TOGETHER, scene::Scene};
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
    let mut asked = Vec::with_capacity(TOGETHER.min(rays.len()));
    let each = items.each_group(rays.len(), TOGETHER, |turn, group| {
        asked.clear();
        for index in group.clone() {
            asked.push(rays.item(index)?);
        }
        let found = turn.ask_rays(group.start, &asked)?;
        if group.start == 0
            && let (Some((question, ignored)), Some(found)) = (asked.first(), found.first())
        {
            scene.tell(|| (trace::ray(sent, &question.ray, *ignored), answer::raycast(found).map(Kind::from)));
        }
        asked.iter().zip(&found).try_for_each(|((question, _), found)| hits.add(found, question.ray.max_distance))
    });
    each.await?;
    Ok(pb::RaycastBatchResponse { hits: Some(hits.finish()), info: items.info() })
}
