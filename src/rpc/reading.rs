//! Which ticks a question reads besides the version that it is asked on.

use std::{collections::BTreeSet, sync::Arc};

use collision::world::{Edit, ShapeId, Snapshot, Tick};
use wire::v1::{self as pb, question::Question as Asked};

use super::{pairs, scene::Scene};
use crate::{
    convert::first_touch,
    past,
    problem::{Checked, Under},
};

/// What a question reads besides its version.
#[derive(Debug)]
pub(super) enum Reading {
    /// Nothing.
    Nothing,
    /// An earlier version.
    Since(Arc<Snapshot>),
    /// All ticks from an earlier version to a tick, and how all went from each to the next.
    Way(Arc<Snapshot>, Tick),
}

impl Reading {
    /// That of a question.
    ///
    /// # Errors
    /// A tick that is not held; what is wrong with a question about ticks.
    pub(super) fn of(question: &pb::Question, scene: &Scene) -> Checked<Self> {
        let world = &scene.snapshot;
        match &question.question {
            Some(Asked::FirstTouch(sent)) => {
                let asked = first_touch::first_touch(sent, &scene.session.geometries, world).under("first_touch")?;
                Ok(Self::Way(past::at_tick(world, asked.from)?, asked.to))
            }
            Some(Asked::Pairs(sent)) => Ok(match pairs::since(sent, world).under("pairs")? {
                Some(old) => Self::Since(old),
                None => Self::Nothing,
            }),
            _ => Ok(Self::Nothing),
        }
    }

    /// The earliest version that is read.
    pub(super) fn earliest<'a>(&'a self, world: &'a Arc<Snapshot>) -> &'a Arc<Snapshot> {
        match self {
            Self::Nothing => world,
            Self::Since(old) | Self::Way(old, _) => old,
        }
    }

    /// What became of these shapes from the earliest version on, tick by tick up to the version that the question is asked on.
    /// Nothing is told of ticks that are not read; of an earlier version alone the last tick tells all.
    ///
    /// # Errors
    /// A tick that is not held.
    pub(super) fn ticks(&self, world: &Arc<Snapshot>, ids: &BTreeSet<ShapeId>) -> Checked<Vec<Vec<Edit>>> {
        match self {
            Self::Nothing => Ok(Vec::new()),
            Self::Since(old) => {
                let is_on = world.fraction() > 0.0;
                let mut ticks = vec![Vec::new(); (world.tick().get() - old.tick().get()) as usize + usize::from(is_on)];
                if let Some(last) = ticks.last_mut() {
                    *last = world.edits_from(old, ids.iter().copied());
                }
                Ok(ticks)
            }
            Self::Way(from, to) => {
                let mut before = from.clone();
                let mut ticks = Vec::new();
                while before.tick() < *to {
                    let after = past::at_tick(world, before.tick().saturating_add(1))?;
                    ticks.push(after.edits_from(&before, ids.iter().copied()));
                    before = after;
                }
                ticks.resize((world.tick().get() - from.tick().get()) as usize, Vec::new());
                Ok(ticks)
            }
        }
    }
}
