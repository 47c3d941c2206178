//! What is watched: wire to checked regions and pairs; what changed, back.

use std::{collections::HashMap, num::NonZeroU64};

use collision::{
    math::Pose,
    world::{Change, Changes, REGIONS_MAX, Region, Watch, WatchedPairs},
};
use wire::v1 as pb;

use super::{
    geometry::of_question,
    number::{FROM_ZERO_TO_REACH, REACH, at_most, shape_id, within},
    place::pose,
    question::{accuracy, filter},
};
use crate::{
    geometries::Geometries,
    problem::{Checked, Problem, Reason, Under},
};

/// Shapes whose pairs can be named.
const PAIR_IDS: usize = 65_536;

/// What is to be watched.
///
/// # Errors
/// What is wrong with it.
pub(crate) fn watch(sent: &pb::WatchOverlapsRequest, known: &Geometries) -> Checked<Watch> {
    at_most("regions", sent.regions.len(), REGIONS_MAX)?;
    let mut regions: Vec<Region> = Vec::with_capacity(sent.regions.len());
    let mut places = HashMap::with_capacity(sent.regions.len());
    for (index, region) in sent.regions.iter().enumerate() {
        let region = self::region(region, known).under_item("regions", index)?;
        if let Some(first) = places.insert(region.id, index) {
            let what = format!(
                "is {}, as that of regions[{first}]: ids of regions are unique in a call, so choose another",
                region.id
            );
            return Err(Problem::at(format!("regions[{index}].id"), Reason::OutOfLimits, what));
        }
        regions.push(region);
    }
    let pairs = watched_pairs(sent)?;
    if regions.is_empty() && pairs == WatchedPairs::Nothing {
        let what = "is empty, and pairs is not set: there would be nothing to report, so set one of the two";
        return Err(Problem::at("regions", Reason::Missing, what));
    }
    Ok(Watch {
        regions,
        filter: filter(sent.filter.as_ref()).under("filter")?,
        pairs,
        accuracy: accuracy(sent.accuracy.as_ref()).under("accuracy")?,
        hysteresis: within("hysteresis", sent.hysteresis, 0.0..=REACH, FROM_ZERO_TO_REACH)?,
    })
}

fn region(sent: &pb::Region, known: &Geometries) -> Checked<Region> {
    let Some(id) = NonZeroU64::new(sent.id) else {
        return Err(Problem::at("id", Reason::OutOfLimits, "is 0: ids of regions are 1 or more"));
    };
    let Some(form) = &sent.geometry else {
        let what = "is absent: a region needs one, such as {\"sphere\": {\"radius\": 1}}";
        return Err(Problem::at("geometry", Reason::Missing, what));
    };
    Ok(Region {
        id,
        geometry: of_question(form, known).under("geometry")?,
        pose: pose(sent.pose.as_ref(), Pose::IDENTITY).under("pose")?,
        follow: NonZeroU64::new(sent.follow_id),
    })
}

fn watched_pairs(sent: &pb::WatchOverlapsRequest) -> Checked<WatchedPairs> {
    at_most("pair_ids", sent.pair_ids.len(), PAIR_IDS)?;
    if !sent.pairs {
        return match sent.pair_ids.len() {
            0 => Ok(WatchedPairs::Nothing),
            count => {
                let what = format!("has {count} items, but pairs is not set: set it, or leave pair_ids out");
                Err(Problem::at("pair_ids", Reason::OutOfLimits, what))
            }
        };
    }
    if sent.pair_ids.is_empty() {
        return Ok(WatchedPairs::All);
    }
    let checked = |(index, &id): (usize, &u64)| {
        shape_id("", id).map_err(|problem| problem.at_field(format!("pair_ids[{index}]")))
    };
    Ok(WatchedPairs::Of(sent.pair_ids.iter().enumerate().map(checked).collect::<Checked<_>>()?))
}

/// Which list of a message.
#[derive(Clone, Copy, Debug)]
enum List {
    Entered,
    Left,
    Began,
    Ended,
}

/// What one or several messages tell, in the order of their lists.
#[derive(Debug, Default)]
pub(crate) struct Told {
    rows: Vec<(List, u64, u64)>,
    begin: usize,
}

impl Told {
    /// What changed. What came and went stands in both lists.
    pub(crate) fn of(changes: &Changes) -> Self {
        let mut rows = Vec::with_capacity(changes.len());
        let began = |change: &Change| *change != Change::Went;
        let ended = |change: &Change| *change != Change::Came;
        let regions = |list, is_in: fn(&Change) -> bool| {
            let some = changes.regions.iter().filter(move |(_, change)| is_in(change));
            some.map(move |((region, shape), _)| (list, region.get(), shape.get()))
        };
        let pairs = |list, is_in: fn(&Change) -> bool| {
            let some = changes.pairs.iter().filter(move |(_, change)| is_in(change));
            some.map(move |((a, b), _)| (list, a.get(), b.get()))
        };
        rows.extend(regions(List::Entered, began).chain(regions(List::Left, ended)));
        rows.extend(pairs(List::Began, began).chain(pairs(List::Ended, ended)));
        Self { rows, begin: 0 }
    }

    /// The lists of the next message, of at most so many rows in all, and whether more follow.
    pub(crate) fn next(&mut self, row_count_max: usize) -> pb::WatchOverlapsResponse {
        let end = self.rows.len().min(self.begin + row_count_max);
        let mut response = pb::WatchOverlapsResponse::default();
        for &(list, a, b) in &self.rows[self.begin..end] {
            let columns = match list {
                List::Entered => &mut response.entered,
                List::Left => &mut response.left,
                List::Began => &mut response.began,
                List::Ended => &mut response.ended,
            };
            let columns = columns.get_or_insert_default();
            columns.a.push(a);
            columns.b.push(b);
        }
        self.begin = end;
        response.more = end < self.rows.len();
        response
    }
}
