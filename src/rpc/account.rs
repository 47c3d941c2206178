//! What a question did, for those who ask it to explain itself; for all others nothing is noted.

use collision::{
    answer::Work,
    world::{Note, Notes},
};
use wire::v1 as pb;

use crate::{
    convert::{account::pair, answer},
    problem::Checked,
};

/// Pairs that an answer tells of.
pub(super) const PAIRS_TOLD: usize = 256;

/// What a question did, or those of a batch.
#[derive(Clone, Debug, Default)]
pub(super) struct Account {
    work: Work,
    pairs: Vec<pb::PairAccount>,
    pairs_left_out: u64,
}

impl Account {
    /// What a question did that noted this.
    ///
    /// # Errors
    /// A number is not finite, which is a fault of the server.
    pub(super) fn of(work: Work, notes: Option<&Notes>) -> Checked<Self> {
        let (told, left_out): (&[Note], u64) = match notes {
            Some(notes) => {
                let (told, more) = notes.list.split_at(notes.list.len().min(PAIRS_TOLD));
                (told, notes.left_out_count + more.len() as u64)
            }
            None => (&[], 0),
        };
        let pairs = told.iter().map(|note| pair(note, 0)).collect::<Checked<_>>()?;
        Ok(Self { work, pairs, pairs_left_out: left_out })
    }

    /// What was spent.
    pub(super) fn work(&self) -> &Work {
        &self.work
    }

    /// Also what item `index` of a batch did.
    pub(super) fn add(&mut self, item: Self, index: usize) {
        self.work += item.work;
        let room = PAIRS_TOLD - self.pairs.len();
        self.pairs_left_out += item.pairs_left_out + item.pairs.len().saturating_sub(room) as u64;
        // A batch has no more items than fit.
        let index = u32::try_from(index).unwrap_or(u32::MAX);
        self.pairs.extend(item.pairs.into_iter().take(room).map(|pair| pb::PairAccount { item: index, ..pair }));
    }

    /// As an answer says it, which may name what was read.
    pub(super) fn into_info(self) -> pb::AnswerInfo {
        let Self { work, pairs, pairs_left_out } = self;
        pb::AnswerInfo { work: Some(answer::work(&work)), pairs, pairs_left_out, ..pb::AnswerInfo::default() }
    }
}
