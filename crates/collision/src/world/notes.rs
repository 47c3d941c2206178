//! What a question did with each pair of shapes that it looked at, for those who want to know why an answer is what it is.
//!
//! # Method
//! The meter of a question counts all work; where notes are taken, what the counters show before and after a pair is what
//! that pair took. Of a pair that is proved apart most kernels return no value: how far apart it is is measured afterwards, on
//! no account.
//!
//! # Limits
//! Notes are in the order in which the trees offered shapes, which may differ with what was edited before; answers do not.

use super::{ShapeId, passing, search::Side};
use crate::{
    accuracy::Accuracy,
    answer::{Certificate, Verdict, Work},
    narrow::{Motion, Ray},
};

/// What a question did with one pair.
#[derive(Clone, Debug)]
pub struct Note {
    /// Who asked; `None` for a ray and for a form that is not in the world.
    pub subject: Option<ShapeId>,
    /// The shape that was looked at; `None` for a form that is not in the world.
    pub id: Option<ShapeId>,
    /// What is proved of the two.
    pub verdict: Verdict,
    /// What the value is worth that was found: of contacts that of the deepest. Of two that are proved farther apart than was
    /// asked, bounds of how far apart they are, metres (of a depth: below 0); of a ray or a motion that passes by, of how near to the
    /// shape. `None` where there is no value: a pair that is refused.
    pub certificate: Option<Certificate>,
    /// What it took: nodes of the trees in the two geometries, pairs of their pieces, iterations.
    pub work: Work,
}

impl Note {
    /// What came of a pair; the work is filled in by the meter.
    pub(super) fn of(sides: [Option<ShapeId>; 2], certificate: Option<Certificate>) -> Self {
        let [subject, id] = sides;
        let verdict = certificate.map_or(Verdict::Miss, |certificate| certificate.verdict);
        Self { subject, id, verdict, certificate, work: Work::default() }
    }

    /// The same of a pair whose value is a distance: one that is proved farther apart than was asked is measured.
    pub(super) fn of_gap(
        subject: &Side<'_>,
        other: &Side<'_>,
        found: Option<Certificate>,
        accuracy: &Accuracy,
    ) -> Self {
        let apart = || passing::apart(subject.placed, other.operand(), 0.0, accuracy);
        Self::of_or([subject.id(), other.id()], found, apart)
    }

    /// The same of a ray: one that passes by is measured as far as it is beside the shape.
    pub(super) fn of_ray(ray: &Ray, other: &Side<'_>, found: Option<Certificate>, accuracy: &Accuracy) -> Self {
        Self::of_or([None, other.id()], found, || passing::of_ray(ray, other, accuracy))
    }

    /// The same of a motion up to the time `until`: one that passes by is measured where it is nearest.
    pub(super) fn of_motion(
        (subject, other): (&Side<'_>, &Side<'_>),
        (motion, until): (&Motion, f64),
        found: Option<Certificate>,
        accuracy: &Accuracy,
    ) -> Self {
        let passing = || passing::of_motion(subject, other, (motion, until), accuracy);
        Self::of_or([subject.id(), other.id()], found, passing)
    }

    /// The same where a pair without a value is measured.
    fn of_or(
        sides: [Option<ShapeId>; 2],
        found: Option<Certificate>,
        measured: impl FnOnce() -> Option<Certificate>,
    ) -> Self {
        let note = Self::of(sides, found);
        if found.is_some() { note } else { Self { certificate: measured(), ..note } }
    }
}

/// Notes of a question, so many at most.
#[derive(Clone, Debug)]
pub struct Notes {
    /// The first of them, in the order of the work.
    pub list: Vec<Note>,
    /// How many more pairs were looked at.
    pub left_out_count: u64,
    most: usize,
    /// What was counted when the pair at work began.
    before: Work,
}

impl Notes {
    /// None yet, and at most `most`.
    #[must_use]
    pub fn new(most: usize) -> Self {
        Self { list: Vec::new(), left_out_count: 0, most, before: Work::default() }
    }

    /// A pair is looked at from here on.
    pub(super) fn begin(&mut self, counted: &Work) {
        self.before = *counted;
    }

    /// It was looked at up to here.
    pub(super) fn end(&mut self, note: Note, counted: &Work) {
        if self.list.len() >= self.most {
            self.left_out_count += 1;
            return;
        }
        self.list.push(Note { work: counted.since(&self.before), ..note });
    }
}
