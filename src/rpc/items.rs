//! The items of a call with columns: many questions of one kind on one version, which fail or succeed together.

use collision::{
    accuracy::Accuracy,
    world::{Filter, Found, Meter, QuestionError, ShapeId, Snapshot},
};
use wire::v1 as pb;

use super::{
    account::Account,
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
    account: Account,
}

impl<'a> Items<'a> {
    /// Those of a request.
    ///
    /// # Errors
    /// What is wrong with its options.
    pub(super) fn of(sent: &impl Asking, scene: &'a Scene) -> Checked<Self> {
        let terms = scene.shared.overridden_by(sent.options())?;
        Ok(Self { scene, terms, turns: Turns::at_work(scene.deadline), account: Account::default() })
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
        let Self { scene, terms, .. } = self;
        let excluded_count = terms.filter.exclude_ids.len();
        terms.filter.exclude_ids.extend(ignored);
        let answered = scene.ask(terms, |meter| asked(&scene.snapshot, &terms.filter, &terms.accuracy, meter));
        terms.filter.exclude_ids.truncate(excluded_count);
        let (found, account) = answered.map_err(|problem| match problem.is(Reason::Deadline) {
            true => problem,
            false => problem.of_item(index),
        })?;
        self.account.add(account, index);
        Ok(found)
    }

    /// What the answer says about itself.
    pub(super) fn info(self) -> Option<pb::AnswerInfo> {
        self.scene.info(&self.terms, self.account)
    }
}
