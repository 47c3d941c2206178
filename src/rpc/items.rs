//! The items of a call with columns: many questions of one kind on one version, which fail or succeed together.
//!
//! # Method
//! Items are asked turn by turn. What is there for the sake of others is done once a turn, not once an item: the fence, the look at
//! the clock, the counters of the session. A turn ends where its steps say that a look at the clock is due.

use collision::{
    accuracy::Accuracy,
    answer::Verdict,
    world::{Filter, Found, Meter, QuestionError, ShapeId, Snapshot},
};
use wire::v1 as pb;

use super::{
    account::Account,
    scene::{Asking, Scene, Terms},
    turns::Turns,
};
use crate::{
    fence::fenced,
    problem::{Checked, Reason},
};

/// Steps between two looks at the clock: some ten microseconds of work, of which the look is less than a hundredth.
const STEPS_BETWEEN_LOOKS: u64 = 256;

/// The items of a call.
#[derive(Debug)]
pub(super) struct Items<'a> {
    turns: Turns,
    turn: Turn<'a>,
}

/// Where items are asked, one after the other.
#[derive(Debug)]
pub(super) struct Turn<'a> {
    scene: &'a Scene,
    terms: Terms,
    account: Account,
    steps: u64,
    question_count: u64,
    undecided_count: u64,
}

impl<'a> Items<'a> {
    /// Those of a request.
    ///
    /// # Errors
    /// What is wrong with its options.
    pub(super) fn of(sent: &impl Asking, scene: &'a Scene) -> Checked<Self> {
        let terms = scene.shared.overridden_by(sent.options())?.into_owned();
        let account = Account::default();
        let turn = Turn { scene, terms, account, steps: 0, question_count: 0, undecided_count: 0 };
        Ok(Self { turns: Turns::begun(scene.deadline), turn })
    }

    /// Does `item` for each number below `count`, in order; in between, others get their turn when it is time.
    ///
    /// # Errors
    /// The deadline, the item's own, a panic in it.
    pub(super) async fn each(
        &mut self,
        count: usize,
        mut item: impl FnMut(&mut Turn<'a>, usize) -> Checked<()>,
    ) -> Checked<()> {
        let mut next = 0;
        while next < count {
            self.turns.next().await?;
            let turn = &mut self.turn;
            let done = fenced("answering a question", || {
                while next < count && turn.steps < STEPS_BETWEEN_LOOKS {
                    item(turn, next)?;
                    next += 1;
                }
                Ok(())
            });
            turn.end();
            done.map_err(|panic| panic.of_item(next))??;
        }
        Ok(())
    }

    /// What the answer says about itself.
    pub(super) fn info(self) -> Option<pb::AnswerInfo> {
        self.turn.scene.info(&self.turn.terms, self.turn.account)
    }
}

impl Turn<'_> {
    /// Asks about item `index`, for one that does not see the shapes `ignored`.
    ///
    /// # Errors
    /// The deadline, a question that takes too long: the latter with the item's number.
    #[inline]
    pub(super) fn ask<H>(
        &mut self,
        index: usize,
        ignored: impl IntoIterator<Item = ShapeId>,
        asked: impl FnOnce(&Snapshot, &Filter, &Accuracy, &mut Meter<'_>) -> Result<Found<H>, QuestionError>,
    ) -> Checked<Found<H>> {
        let Self { scene, terms, .. } = self;
        let excluded_count = terms.filter.exclude_ids.len();
        terms.filter.exclude_ids.extend(ignored);
        let answered =
            scene.ask_uncounted(terms, |meter| asked(&scene.snapshot, &terms.filter, &terms.accuracy, meter));
        terms.filter.exclude_ids.truncate(excluded_count);
        let (found, account) = answered.map_err(|problem| match problem.is(Reason::Deadline) {
            true => problem,
            false => problem.of_item(index),
        })?;
        // At least one, so that each turn ends.
        self.steps += 1 + account.work().steps();
        self.question_count += 1;
        self.undecided_count += u64::from(found.verdict == Verdict::Undecided);
        self.account.add(account, index);
        Ok(found)
    }

    /// Ends a turn: what was counted is counted in the session.
    fn end(&mut self) {
        self.scene.count(self.question_count, self.undecided_count);
        (self.steps, self.question_count, self.undecided_count) = (0, 0, 0);
    }
}
