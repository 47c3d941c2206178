//! `LineOfSight`: which points of targets observers see, as columns.

use collision::{
    answer::Verdict,
    world::{Found, Seen, SeenCount},
};
use wire::v1 as pb;

use super::{
    items::{Items, Turn},
    scene::Scene,
};
use crate::{
    convert::sight::{SeenColumns, Watched},
    problem::Checked,
};

/// Answers it on the scene's version.
///
/// # Errors
/// A wrong column or item, the deadline.
pub(super) async fn answer(sent: &pb::LineOfSightRequest, scene: &Scene) -> Checked<pb::LineOfSightResponse> {
    let watched = Watched::new(sent)?;
    let mut items = Items::of(sent, scene)?;
    let mut columns = SeenColumns::new(watched.eye_count() * watched.target_count());
    let enough = if sent.enough == 0 { u32::MAX } else { sent.enough };
    for eye in 0..watched.eye_count() {
        for target in 0..watched.target_count() {
            let mut count = SeenCount::default();
            let points = watched.points_of(target);
            let each = items.each(points.len(), |turn, index| {
                let is_open = count.visible < enough;
                let looked = is_open.then(|| look(&watched, (eye, target, points.start + index), turn));
                let seen = looked.transpose()?;
                seen.into_iter().for_each(|seen| count.add(seen));
                if sent.want_points {
                    columns.add_point(seen);
                }
                Ok(())
            });
            each.await?;
            columns.add(count);
        }
    }
    Ok(columns.finish(items.info()))
}

/// Whether an observer sees a point of a target.
fn look(watched: &Watched<'_>, (eye, target, point): (usize, usize, usize), turn: &mut Turn<'_>) -> Checked<Seen> {
    let sight = watched.sight(eye, point)?;
    let index = eye * watched.point_count() + point;
    let found = turn.ask(index, watched.own(eye, target), |world, filter, accuracy, meter| {
        let seen = world.sight(&sight, filter, accuracy, meter)?;
        let verdict = match seen {
            Seen::Hidden => Verdict::Hit,
            Seen::Visible | Seen::Beyond => Verdict::Miss,
            Seen::Undecided => Verdict::Undecided,
        };
        Ok(Found { verdict, hits: vec![seen], truncated: false })
    });
    Ok(found?.hits[0])
}
