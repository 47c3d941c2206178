//! `TimeOfImpactBatch`: one geometry on many ways, as columns.

use collision::{
    DVec3,
    narrow::InitialTouch,
    world::{HitMode, Subject, TimeOfImpact},
};
use wire::v1::{self as pb, answer::Answer as Kind};

use super::{items::Items, scene::Scene};
use crate::{
    convert::{answer, hit_columns::Hits, places::Ways, trace},
    problem::Checked,
};

/// Answers it on the scene's version.
///
/// # Errors
/// A wrong column or item, the deadline.
pub(super) async fn answer(
    sent: &pb::TimeOfImpactBatchRequest,
    scene: &Scene,
) -> Checked<pb::TimeOfImpactBatchResponse> {
    let ways = Ways::new(sent, &scene.session.geometries)?;
    let mut items = Items::of(sent, scene)?;
    let mut hits = Hits::new(sent.want.as_ref(), ways.frame_origin(), ways.len());
    let each = items.each(ways.len(), |turn, index| {
        let (start, end) = ways.item(index)?;
        let question = TimeOfImpact {
            subject: Subject::Geometry { geometry: ways.geometry(), pose: start },
            displacement: end.position - start.position,
            rotation: start.rotation_vector_to(&end),
            against: None,
            against_displacement: DVec3::ZERO,
            against_rotation: DVec3::ZERO,
            initial: if sent.ignore_initial { InitialTouch::IsIgnored } else { InitialTouch::Counts },
            mode: HitMode::Closest,
        };
        let found = turn.ask(index, None, |world, filter, accuracy, meter| {
            world.time_of_impact(&question, filter, accuracy, meter)
        })?;
        if index == 0 {
            let asked = || trace::time_of_impact(sent, &start, &end);
            scene.tell(|| (asked(), answer::time_of_impact(&found).map(Kind::from)));
        }
        hits.add(&found, 1.0)
    });
    each.await?;
    Ok(pb::TimeOfImpactBatchResponse { hits: Some(hits.finish()), info: items.info() })
}
