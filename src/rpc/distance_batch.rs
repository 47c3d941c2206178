//! `DistanceBatch`: what is nearest to one geometry at many places, as columns.

use collision::world::{Distance, Subject};
use wire::v1::{self as pb, answer::Answer as Kind};

use super::{items::Items, scene::Scene};
use crate::{
    convert::{answer, columns::Distances, hit_columns::Hits, places::Places, trace},
    problem::Checked,
};

/// Answers it on the scene's version.
///
/// # Errors
/// A wrong column or item, the deadline.
pub(super) async fn answer(sent: &pb::DistanceBatchRequest, scene: &Scene) -> Checked<pb::DistanceBatchResponse> {
    let (geometry, poses, known) = (sent.geometry.as_ref(), sent.poses.as_ref(), &scene.session.geometries);
    let mut places = Places::new(geometry, poses, &[], sent.max_distances.len(), known)?;
    let max_distances = Distances::new("max_distances", &sent.max_distances, places.len())?;
    let mut items = Items::of(sent, scene)?;
    let mut hits = Hits::new(sent.want.as_ref(), places.frame_origin(), places.len());
    let each = items.each(places.len(), |turn, index| {
        let (geometry, pose) = places.item(index)?;
        let max_distance = max_distances.item(index)?;
        let question =
            Distance { subject: Subject::Geometry { geometry, pose }, against: None, max_distance, max_hits: 1 };
        let found =
            turn.ask(index, None, |world, filter, accuracy, meter| world.distance(&question, filter, accuracy, meter))?;
        if index == 0 {
            scene.tell(|| (trace::distance(sent, &pose, max_distance), answer::distance(&found).map(Kind::from)));
        }
        hits.add(&found, max_distance)
    });
    each.await?;
    Ok(pb::DistanceBatchResponse { hits: Some(hits.finish()), info: items.info() })
}
