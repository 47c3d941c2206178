//! Questions and answers as the runner knows them, whoever is asked: the crate in this process or a server.

use glam::DVec3;

use crate::sets::{Placed, aabb::BoxSet, stream::Change, toi::Motion};

/// A question that names everything it is about.
#[derive(Clone, Debug)]
pub enum Question {
    /// How far apart are they?
    Distance {
        /// The subject.
        a: Placed,
        /// Against what.
        b: Placed,
    },
    /// Do they touch?
    Overlap {
        /// The subject.
        a: Placed,
        /// Against what.
        b: Placed,
    },
    /// How deep do they overlap?
    Penetration {
        /// The subject.
        a: Placed,
        /// Against what.
        b: Placed,
        /// Contacts with a gap up to this are wanted too, metres.
        max_gap: f64,
    },
    /// When do they first touch?
    Impact {
        /// The subject at the start.
        a: Placed,
        /// How it moves.
        motion_a: Motion,
        /// Against what, at the start.
        b: Placed,
        /// How that moves.
        motion_b: Motion,
    },
    /// What does a ray meet first?
    Raycast {
        /// Where it begins.
        origin: DVec3,
        /// Where it goes, of any length.
        direction: DVec3,
        /// How far, metres; may be infinite.
        max_distance: f64,
        /// What it may meet.
        target: Placed,
    },
}

/// What is proved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// It touches.
    Hit,
    /// It does not.
    Miss,
    /// Neither.
    Undecided,
}

/// A verdict and the interval that is said to hold the true value; open sides are infinite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Claim {
    /// What is proved of this item.
    pub verdict: Verdict,
    /// The true value is said not to be below this.
    pub lower: f64,
    /// The true value is said not to be above this.
    pub upper: f64,
}

impl Claim {
    /// Whether the interval, widened by `slack` on both sides, holds `truth`.
    #[must_use]
    pub fn holds(&self, truth: f64, slack: f64) -> bool {
        self.lower - slack <= truth && truth <= self.upper + slack
    }
}

/// The nearest points of two forms.
#[derive(Clone, Copy, Debug)]
pub struct Near {
    /// Metres.
    pub distance: f64,
    /// On the subject, world frame.
    pub point_on_a: DVec3,
    /// On the other, world frame.
    pub point_on_b: DVec3,
    /// From the other to the subject; may be absent at distance 0.
    pub normal_b_to_a: Option<DVec3>,
    /// What the distance is worth.
    pub claim: Claim,
}

/// A contact.
#[derive(Clone, Copy, Debug)]
pub struct ContactAnswer {
    /// From the other to the subject.
    pub normal_b_to_a: DVec3,
    /// Metres; negative is a gap.
    pub depth: f64,
    /// Face of the other.
    pub face_of_b: Option<u32>,
    /// What the depth is worth.
    pub claim: Claim,
}

/// A first touch.
#[derive(Clone, Copy, Debug)]
pub struct ImpactAnswer {
    /// 0 to 1.
    pub fraction: f64,
    /// They touch at the start.
    pub initial: bool,
    /// From the other to the subject.
    pub normal_b_to_a: Option<DVec3>,
    /// What the fraction is worth.
    pub claim: Claim,
}

/// Where a ray meets something.
#[derive(Clone, Copy, Debug)]
pub struct RayAnswer {
    /// Metres along the ray.
    pub distance: f64,
    /// Which triangle.
    pub face: Option<u32>,
    /// What the distance is worth.
    pub claim: Claim,
}

/// An answer of the same kind as the question; lists are in the order of the answer.
#[derive(Clone, Debug)]
pub enum Answer {
    /// Of a distance.
    Distance(Verdict, Vec<Near>),
    /// Of an overlap: bounds of the signed distance, if something is said of it.
    Overlap(Verdict, Option<Claim>),
    /// Of a penetration.
    Penetration(Verdict, Vec<ContactAnswer>),
    /// Of an impact.
    Impact(Verdict, Vec<ImpactAnswer>),
    /// Of a ray.
    Ray(Verdict, Vec<RayAnswer>),
}

impl Answer {
    /// What the answer as a whole says.
    #[must_use]
    pub fn verdict(&self) -> Verdict {
        match self {
            Self::Distance(verdict, _)
            | Self::Overlap(verdict, _)
            | Self::Penetration(verdict, _)
            | Self::Impact(verdict, _)
            | Self::Ray(verdict, _) => *verdict,
        }
    }
}

/// An answer, or why there is none.
pub type Reply = Result<Answer, String>;

/// The overlapping pairs of a set of boxes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PairTally {
    /// How many.
    pub count: u64,
    /// The sum of [`crate::sets::aabb::pair_hash`] over them.
    pub hash: u64,
}

/// Whoever answers.
pub trait Asker {
    /// Answers questions in the exact tier, one reply for each, in order.
    fn ask(&mut self, questions: &[Question]) -> Vec<Reply>;

    /// An empty world in which a stream can be played.
    ///
    /// # Errors
    /// Why there is none.
    fn stage(&mut self) -> Result<Box<dyn Stage + '_>, String>;

    /// The overlapping pairs of boxes; `None` if this asker has no way to ask that.
    ///
    /// # Errors
    /// Why there is no answer.
    fn overlapping_boxes(&mut self, set: &BoxSet) -> Result<Option<PairTally>, String>;
}

/// What is near an actor: the other actor, and how far that is.
pub type Neighbors = Result<Vec<(u64, Near)>, String>;

/// A world in which a stream is played.
pub trait Stage {
    /// Makes the changes, all in one tick.
    ///
    /// # Errors
    /// Why they could not be made.
    fn tick(&mut self, changes: &[Change]) -> Result<(), String>;

    /// For each of the actors, all others that are within `limit` metres, as the world is now.
    fn neighbors(&mut self, actors: &[u64], limit: f64) -> Vec<Neighbors>;

    /// Contacts of one actor with all others: the other actor, and the contact.
    ///
    /// # Errors
    /// Why there is no answer.
    fn contacts(&mut self, actor: u64) -> Result<Vec<(u64, ContactAnswer)>, String>;
}
