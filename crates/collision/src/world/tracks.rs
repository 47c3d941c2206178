//! What a batch of edits tells of how shapes came to their poses: which were moved, and which did not travel.
//!
//! # Method
//! The poses before are those of the version before, which is there anyway: nothing is kept for them. Only what the two
//! versions do not tell is noted, and only in worlds where a sweep may be asked: that a shape was put where it is, by an
//! insert or a teleport, and that it was moved at all, be it to the same place.

use std::collections::HashSet;

use super::{Edit, ShapeId, Snapshot, history::Passage, state::State};
use crate::shape::Form;

/// Which moves are swept.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum SweepRule {
    /// Those of bullets.
    #[default]
    Bullets,
    /// Those of bullets, and of shapes that go farther in one tick than this share, at least 0, of the least extent of their
    /// canonical box; of half spaces, which have no size, never. Each move pays for the comparison then.
    FasterThan(f64),
}

/// What is noted while a batch is applied.
#[derive(Debug)]
pub(super) struct Tracks {
    rule: SweepRule,
    /// Moved, but not by teleport; may hold ids several times.
    moved: Vec<ShapeId>,
    /// Put where they are in this tick, so that they did not travel.
    jumped: HashSet<ShapeId>,
}

impl Tracks {
    /// `None` if nothing can be swept in the tick after this state: a bullet that comes in this tick does not travel in it.
    pub(super) fn after(state: &State, rule: SweepRule) -> Option<Self> {
        let is_needed = state.bullet_count > 0 || rule != SweepRule::Bullets;
        is_needed.then(|| Self { rule, moved: Vec::new(), jumped: HashSet::new() })
    }

    /// What is known of a tick that is over.
    pub(super) fn of(passage: &Passage) -> Self {
        let jumped = passage.changed.iter().copied().filter(|&id| !passage.travelled(id)).collect();
        Self { rule: SweepRule::Bullets, moved: passage.travelled.clone(), jumped }
    }

    /// Notes an edit that is about to be applied to this state.
    pub(super) fn note(&mut self, edit: &Edit, state: &State) {
        match edit {
            Edit::Insert(shape) => {
                self.jumped.insert(shape.id);
            }
            Edit::Move { id, teleport: true, .. } => {
                self.jumped.insert(*id);
            }
            Edit::Move { id, teleport: false, .. } => {
                let is_bullet = state.get(*id).is_some_and(|entry| entry.shape().bullet);
                if is_bullet || self.rule != SweepRule::Bullets {
                    self.moved.push(*id);
                }
            }
            Edit::Remove(_) | Edit::Clear => {}
        }
    }

    /// The shapes whose moves are swept, by id.
    pub(super) fn swept(&self, old: &Snapshot, new: &Snapshot) -> Vec<ShapeId> {
        let mut swept = self.moved.clone();
        swept.sort_unstable();
        swept.dedup();
        swept.retain(|&id| self.travelled(id, old, new) && self.is_swept(id, old, new));
        swept
    }

    /// Whether a shape is in both versions and was never put where it is between them.
    pub(super) fn travelled(&self, id: ShapeId, old: &Snapshot, new: &Snapshot) -> bool {
        !self.jumped.contains(&id) && old.state().get(id).is_some() && new.state().get(id).is_some()
    }

    fn is_swept(&self, id: ShapeId, old: &Snapshot, new: &Snapshot) -> bool {
        let (Some(before), Some(after)) = (old.state().get(id), new.state().get(id)) else {
            return false;
        };
        match self.rule {
            _ if after.shape().bullet => true,
            SweepRule::Bullets => false,
            SweepRule::FasterThan(share) => {
                let way = after.shape().pose.position.distance(before.shape().pose.position);
                let size = (before.bounds.max - before.bounds.min).min_element();
                !matches!(before.shape().geometry.form(), Form::HalfSpace(_)) && way > share * size
            }
        }
    }
}
