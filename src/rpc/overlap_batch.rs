//! `OverlapBatch`: one geometry at many places, as columns.

use collision::world::{Overlap, Subject};
use wire::v1::{self as pb, answer::Answer as Kind};

use super::{items::Items, scene::Scene};
use crate::{
    convert::{answer, hit_columns::Touching, number::count, places::Places, trace},
    problem::Checked,
};

/// Answers it on the scene's version.
///
/// # Errors
/// A wrong column or item, the deadline.
pub(super) async fn answer(sent: &pb::OverlapBatchRequest, scene: &Scene) -> Checked<pb::OverlapBatchResponse> {
    let geometries = &scene.session.geometries;
    let mut places = Places::new(sent.geometry.as_ref(), sent.poses.as_ref(), &sent.scales, 0, geometries)?;
    let max_hits = count("max_hits_each", sent.max_hits_each, 32, 65_536)?;
    let mut items = Items::of(sent, scene)?;
    let mut touching = Touching::new(places.len());
    let each = items.each(places.len(), |turn, index| {
        let (geometry, pose) = places.item(index)?;
        let question = Overlap { subject: Subject::Geometry { geometry, pose }, against: None, max_hits };
        let found =
            turn.ask(index, None, |world, filter, accuracy, meter| world.overlap(&question, filter, accuracy, meter))?;
        if index == 0 {
            scene.tell(|| (trace::overlap(sent, index, &pose), answer::overlap(&found).map(Kind::from)));
        }
        touching.add(&found);
        Ok(())
    });
    each.await?;
    Ok(pb::OverlapBatchResponse { info: items.info(), ..touching.finish() })
}
