//! The items of a call with columns: many questions of one kind on one version, which fail or succeed together.

use collision::{
    accuracy::Accuracy,
    answer::Work,
    world::{Filter, Found, Meter, QuestionError, ShapeId, Snapshot},
};
use wire::v1 as pb;

use super::{
    scene::{Asking, Scene, Terms},
    turns::Turns,
};
use crate::problem::{Checked, Reason};

/// The items of a call, asked one after the other.
#[derive(Debug)]
pub(super) struct Items<'a> {
    scene: &'a Scene,
    terms: Terms,
    turns: Turns,
    work: Work,
}

impl<'a> Items<'a> {
    /// Those of a request.
    ///
    /// # Errors
    /// What is wrong with its options.
    pub(super) fn of(sent: &impl Asking, scene: &'a Scene) -> Checked<Self> {
        let terms = scene.shared.overridden_by(sent.options())?;
        Ok(Self { scene, terms, turns: Turns::at_work(scene.deadline), work: Work::default() })
    }

    /// Asks about item `index`, for one that does not see the shapes `ignored`; before that, others get their turn if it is time.
    ///
    /// # Errors
    /// The deadline, a question that takes too long: both with the item's number.
    pub(super) async fn ask<H>(
        &mut self,
        index: usize,
        ignored: impl IntoIterator<Item = ShapeId>,
        asked: impl FnOnce(&Snapshot, &Filter, &Accuracy, &mut Meter<'_>) -> Result<Found<H>, QuestionError>,
    ) -> Checked<Found<H>> {
        self.turns.next().await?;
        let Self { scene, terms: Terms { filter, accuracy, .. }, .. } = self;
        let excluded_count = filter.exclude_ids.len();
        filter.exclude_ids.extend(ignored);
        let answered = scene.ask(|meter| asked(&scene.snapshot, filter, accuracy, meter));
        filter.exclude_ids.truncate(excluded_count);
        let (found, work) = answered.map_err(|problem| match problem.is(Reason::Deadline) {
            true => problem,
            false => problem.of_item(index),
        })?;
        self.work += work;
        Ok(found)
    }

    /// What the answer says about itself.
    pub(super) fn info(&self) -> Option<pb::AnswerInfo> {
        self.scene.info(&self.terms, &self.work)
    }
}
