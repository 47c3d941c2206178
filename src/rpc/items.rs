//! The items of a call with columns: many questions of one kind on one version, which fail or succeed together.
//!
//! # Method
//! Items are asked turn by turn. What is there for the sake of others is done once a turn, not once an item: the fence, the look at
//! the clock, the counters of the session. A turn ends where its steps say that a look at the clock is due.

use std::ops::Range;

use collision::{
    accuracy::Accuracy,
    answer::Verdict,
    world::{Filter, Found, Meter, QuestionError, RayHit, Raycast, ShapeId, Snapshot},
};
use wire::v1 as pb;

use super::{
    account::Account,
    answering::ANSWERING,
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
        self.each_group(count, 1, |turn, group| item(turn, group.start)).await
    }

    /// The same, so many numbers at a time.
    ///
    /// # Errors
    /// As [`Items::each`].
    pub(super) async fn each_group(
        &mut self,
        count: usize,
        size: usize,
        mut group: impl FnMut(&mut Turn<'a>, Range<usize>) -> Checked<()>,
    ) -> Checked<()> {
        let mut next = 0;
        while next < count {
            self.turns.next().await?;
            let turn = &mut self.turn;
            let done = fenced(ANSWERING, || {
                while next < count && turn.steps < STEPS_BETWEEN_LOOKS {
                    let end = count.min(next + size);
                    group(turn, next..end)?;
                    next = end;
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

    /// Asks about several rays, the first of which is item `first`, and the shape that each does not see besides.
    ///
    /// # Errors
    /// As [`Turn::ask`].
    pub(super) fn ask_rays(
        &mut self,
        first: usize,
        rays: &[(Raycast, Option<ShapeId>)],
    ) -> Checked<Vec<Found<RayHit>>> {
        if let Some(found) = self.ask_rays_together(rays)? {
            return Ok(found);
        }
        let mut ask = |(index, (question, ignored)): (usize, &(Raycast, Option<ShapeId>))| {
            self.ask(index, *ignored, |world, filter, accuracy, meter| world.raycast(question, filter, accuracy, meter))
        };
        (first..).zip(rays).map(&mut ask).collect()
    }

    /// `None` where each is to be asked by itself, because it is to tell what it does, or what is wrong with it.
    fn ask_rays_together(&mut self, rays: &[(Raycast, Option<ShapeId>)]) -> Checked<Option<Vec<Found<RayHit>>>> {
        let Self { scene, terms, .. } = self;
        if terms.explains() {
            return Ok(None);
        }
        let asked =
            scene.ask_uncounted(terms, |meter| scene.snapshot.raycasts(rays, &terms.filter, &terms.accuracy, meter));
        let (found, account) = match asked {
            Ok(asked) => asked,
            Err(problem) if problem.is(Reason::Deadline) => return Err(problem),
            Err(_) => return Ok(None),
        };
        self.steps += 1 + account.work().steps();
        self.question_count += found.len() as u64;
        self.undecided_count += found.iter().filter(|found| found.verdict == Verdict::Undecided).count() as u64;
        self.account.add(account, 0);
        Ok(Some(found))
    }

    /// Ends a turn: what was counted is counted in the session.
    fn end(&mut self) {
        self.scene.count(self.question_count, self.undecided_count);
        (self.steps, self.question_count, self.undecided_count) = (0, 0, 0);
    }
}
