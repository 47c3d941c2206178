//! Which shapes are in which regions.
//!
//! # Method
//! Two trees lie over the regions: one over those that stay, built once, and one over the ways of those that follow shapes,
//! built for each step in which something changed. The shapes that changed ask both with the boxes of their ways; the regions
//! that moved ask the trees of the world for the shapes that did not change. What was in a region and is not found so has
//! left, and is looked at too.

use std::{
    collections::{BTreeMap, BTreeSet, HashSet},
    ops::ControlFlow,
};

use smallvec::SmallVec;

use super::{
    Change, REGIONS_MAX, Region, RegionId, Step,
    judge::{Body, Hold, Outcome, Outcomes, Terms},
};
use crate::{
    broad::{ALL_LAYERS, StaticTree, Tree},
    math::{Aabb, Pose},
    narrow::Placed,
    world::{Filter, Meter, PAIRS_MAX, QuestionError, ShapeId, filter::Sieve, outline::Outline, search::Side},
};

/// The regions of a watcher and what is in them.
#[derive(Debug)]
pub(super) struct Regions {
    filter: Filter,
    /// By id.
    regions: Vec<Region>,
    /// Over the boxes of those that stay.
    tree: StaticTree,
    /// The region and the box of each leaf.
    staying: Vec<(u32, Aabb)>,
    /// Those that follow shapes.
    following: Vec<u32>,
    inside: BTreeMap<(u32, ShapeId), Hold>,
    /// The same, so that the regions of a shape lie together.
    of_shape: BTreeSet<(ShapeId, u32)>,
    /// How many are kept without a proof.
    kept_count: usize,
}

/// A region that follows a shape, in a step.
struct Follower<'a> {
    region: u32,
    /// `None` while it is empty because that shape is gone.
    body: Option<Body<'a>>,
    /// Whether it may be elsewhere than before.
    moved: bool,
}

impl Regions {
    /// # Panics
    /// If there are too many, or two of one id.
    pub(super) fn new(mut regions: Vec<Region>, filter: Filter) -> Self {
        assert!(regions.len() <= REGIONS_MAX, "at most {REGIONS_MAX} regions");
        regions.sort_by_key(|region| region.id);
        assert!(regions.is_sorted_by(|a, b| a.id < b.id), "region ids are unique");
        let numbered = || (0..).zip(&regions);
        let staying: Vec<(u32, Aabb)> = numbered()
            .filter(|(_, region)| region.follow.is_none())
            .map(|(index, region)| (index, region.geometry.bounds(&region.pose)))
            .collect();
        let boxes: Vec<Aabb> = staying.iter().map(|(_, bounds)| *bounds).collect();
        Self {
            filter,
            tree: StaticTree::build(&boxes),
            staying,
            following: numbered().filter(|(_, region)| region.follow.is_some()).map(|(index, _)| index).collect(),
            inside: BTreeMap::new(),
            of_shape: BTreeSet::new(),
            kept_count: 0,
            regions,
        }
    }

    /// What becomes of all that the step may have changed.
    pub(super) fn look(
        &self,
        step: &Step<'_>,
        terms: &Terms,
        meter: &mut Meter<'_>,
    ) -> Result<Outcomes<u32>, QuestionError> {
        let is_first = step.old.is_none();
        if self.regions.is_empty() || !is_first && step.passage.changed.is_empty() {
            return Ok(Outcomes::default());
        }
        let mut look = Look::new(self, step, terms);
        if is_first {
            for &(region, bounds) in &self.staying {
                let body = self.staying_body(region, bounds);
                look.region(region, Some(&body), meter)?;
            }
        }
        for &id in &step.passage.changed {
            look.shape(id, meter)?;
        }
        let followers = std::mem::take(&mut look.followers);
        for follower in followers.iter().filter(|follower| follower.moved) {
            look.region(follower.region, follower.body.as_ref(), meter)?;
        }
        let outcomes = look.outcomes;
        let grown = outcomes.values().filter(|outcome| outcome.change == Some(Change::Came)).count();
        if self.inside.len() + grown > PAIRS_MAX { Err(QuestionError::TooManyPairs) } else { Ok(outcomes) }
    }

    /// Takes what was found for true, and says what changed.
    pub(super) fn take(&mut self, outcomes: Outcomes<u32>) -> BTreeMap<(RegionId, ShapeId), Change> {
        let mut changes = BTreeMap::new();
        for ((region, id), Outcome { hold, change }) in outcomes {
            let was = match hold {
                Some(hold) => self.inside.insert((region, id), hold),
                None => self.inside.remove(&(region, id)),
            };
            self.kept_count += usize::from(hold == Some(Hold::Kept));
            self.kept_count -= usize::from(was == Some(Hold::Kept));
            match (was, hold) {
                (None, Some(_)) => self.of_shape.insert((id, region)),
                (Some(_), None) => self.of_shape.remove(&(id, region)),
                (None, None) | (Some(_), Some(_)) => false,
            };
            changes.extend(change.map(|change| ((self.regions[region as usize].id, id), change)));
        }
        changes
    }

    /// All that is in regions.
    pub(super) fn all(&self) -> BTreeMap<(RegionId, ShapeId), Change> {
        let id = |region: u32| self.regions[region as usize].id;
        self.inside.keys().map(|&(region, shape)| ((id(region), shape), Change::Came)).collect()
    }

    /// Whether all that is in regions is proved to be.
    pub(super) fn is_proved(&self) -> bool {
        self.kept_count == 0
    }

    fn staying_body(&self, region: u32, bounds: Aabb) -> Body<'_> {
        let Region { id, geometry, pose, .. } = &self.regions[region as usize];
        let placed = Placed { geometry, pose: *pose };
        Body::standing(Side { placed, simple: None, shape: None, bounds }, *id)
    }
}

/// One step of all regions.
struct Look<'a> {
    regions: &'a Regions,
    step: &'a Step<'a>,
    terms: &'a Terms,
    sieve: Sieve<'a>,
    followers: Vec<Follower<'a>>,
    /// Over the ways of the followers that are there.
    tree: StaticTree,
    /// The follower of each leaf.
    leaves: Vec<usize>,
    outcomes: Outcomes<u32>,
}

impl<'a> Look<'a> {
    fn new(regions: &'a Regions, step: &'a Step<'a>, terms: &'a Terms) -> Self {
        let followers: Vec<_> = regions.following.iter().filter_map(|&index| follower(regions, step, index)).collect();
        let there =
            || followers.iter().enumerate().filter_map(|(index, follower)| Some((index, follower.body.as_ref()?)));
        let boxes: Vec<Aabb> = there().map(|(_, body)| body.way.way).collect();
        Self {
            tree: StaticTree::build(&boxes),
            leaves: there().map(|(index, _)| index).collect(),
            regions,
            step,
            terms,
            sieve: Sieve::new(&regions.filter, None),
            followers,
            outcomes: Outcomes::default(),
        }
    }

    /// Looks at a shape that changed: at all regions on its way, and at those that it was in.
    fn shape(&mut self, id: ShapeId, meter: &mut Meter<'_>) -> Result<(), QuestionError> {
        let end = self.step.new.find(id).filter(|end| self.sieve.passes(end));
        let body = end.map(|end| self.step.body(end, id));
        // Which region, and where it is among those of its kind.
        let mut near: SmallVec<[(u32, Place); 16]> = SmallVec::new();
        if let Some(body) = &body {
            let (regions, followers, leaves) = (self.regions, &self.followers, &self.leaves);
            regions.tree.visit_box(body.way.way, ALL_LAYERS, meter, |_, leaf| {
                near.push((regions.staying[leaf as usize].0, Place::Staying(leaf as usize)));
                Ok(ControlFlow::Continue(()))
            })?;
            self.tree.visit_box(body.way.way, ALL_LAYERS, meter, |_, leaf| {
                let index = leaves[leaf as usize];
                near.push((followers[index].region, Place::Following(index)));
                Ok(ControlFlow::Continue(()))
            })?;
        }
        for &(_, region) in self.regions.of_shape.range((id, 0)..=(id, u32::MAX)) {
            near.push((region, self.place(region)));
        }
        near.sort_unstable_by_key(|(region, _)| *region);
        near.dedup_by_key(|(region, _)| *region);
        for &(region, place) in &near {
            let outcome = self.judge(region, place, (id, body.as_ref()), meter)?;
            self.note(region, id, outcome)?;
        }
        Ok(())
    }

    /// Keeps what says something.
    fn note(&mut self, region: u32, id: ShapeId, outcome: Outcome) -> Result<(), QuestionError> {
        if outcome != Outcome::NOTHING {
            self.outcomes.insert((region, id), outcome);
        }
        if self.outcomes.len() > PAIRS_MAX { Err(QuestionError::TooManyPairs) } else { Ok(()) }
    }

    fn judge(
        &self,
        region: u32,
        place: Place,
        (id, shape): (ShapeId, Option<&Body<'_>>),
        meter: &mut Meter<'_>,
    ) -> Result<Outcome, QuestionError> {
        let was = self.regions.inside.get(&(region, id)).copied();
        let is_own = self.regions.regions[region as usize].follow == Some(id);
        let Some(shape) = shape.filter(|_| !is_own) else { return Ok(Outcome::gone(was)) };
        match place {
            Place::Staying(leaf) => {
                let body = self.regions.staying_body(region, self.regions.staying[leaf].1);
                self.terms.judge(was, &body, shape, meter)
            }
            Place::Following(index) => match &self.followers[index].body {
                Some(body) => self.terms.judge(was, body, shape, meter),
                None => Ok(Outcome::gone(was)),
            },
        }
    }

    /// Where a region is among those of its kind.
    fn place(&self, region: u32) -> Place {
        match self.regions.staying.binary_search_by_key(&region, |(index, _)| *index) {
            Ok(leaf) => Place::Staying(leaf),
            Err(_) => Place::Following(self.regions.following.partition_point(|index| *index < region)),
        }
    }

    /// Looks at a region that moved: at all shapes on its way that did not change, and at those that were in it.
    fn region(&mut self, region: u32, body: Option<&Body<'_>>, meter: &mut Meter<'_>) -> Result<(), QuestionError> {
        let (regions, step, terms) = (self.regions, self.step, self.terms);
        let Region { follow, .. } = regions.regions[region as usize];
        let was = |id: ShapeId| regions.inside.get(&(region, id)).copied();
        let mut found: Vec<(ShapeId, Outcome)> = Vec::new();
        if let Some(body) = body {
            let outline = if body.way.stands() { body.outline } else { Outline::of_box(body.way.way) };
            step.new.seen_near(&outline, None, &regions.filter, meter, |meter, side| {
                let Some(id) = side.id().filter(|&id| !step.passage.changed(id) && follow != Some(id)) else {
                    return Ok(());
                };
                found.push((id, terms.judge(was(id), body, &Body::standing(side, id), meter)?));
                Ok(())
            })?;
        }
        let seen: HashSet<ShapeId> = found.iter().map(|(id, _)| *id).collect();
        for (&(_, id), &hold) in regions.inside.range((region, ShapeId::MIN)..=(region, ShapeId::MAX)) {
            if seen.contains(&id) || step.passage.changed(id) {
                continue;
            }
            let side = step.new.find(id);
            let outcome = match (body, side) {
                (Some(body), Some(side)) => terms.judge(Some(hold), body, &Body::standing(side, id), meter)?,
                _ => Outcome::gone(Some(hold)),
            };
            found.push((id, outcome));
        }
        found.into_iter().try_for_each(|(id, outcome)| self.note(region, id, outcome))
    }
}

/// Where a region is among those of its kind.
#[derive(Clone, Copy, Debug)]
enum Place {
    Staying(usize),
    Following(usize),
}

/// A region that follows a shape, in this step; `None` for one that stays.
fn follower<'a>(regions: &'a Regions, step: &Step<'a>, index: u32) -> Option<Follower<'a>> {
    let Region { id, geometry, pose, follow } = &regions.regions[index as usize];
    let follow = (*follow)?;
    let at = |leader: Pose| Side::at(geometry, carried(&leader, pose), None);
    let [before, after] = step.poses(follow);
    let body = after.map(|after| match before.filter(|_| step.passage.travelled(follow)) {
        Some(before) => Body::travelling(at(before), at(after), *id),
        None => Body::standing(at(after), *id),
    });
    Some(Follower { region: index, body, moved: step.old.is_none() || step.passage.changed(follow) })
}

/// The pose in the world of what has a pose relative to `leader`.
fn carried(leader: &Pose, pose: &Pose) -> Pose {
    Pose::new(leader.transform_point(pose.position), leader.unit_rotation() * pose.unit_rotation())
}
