//! Coverage: random and adversarial pairs of convex forms, each answer of the kernels held against the oracle's truth.
//!
//! # Map
//! `forms` makes forms, `pairs` places two of them and says what is asked, `ask` asks the kernels in both orders,
//! `judge` compares with [`crate::oracle::Truth`], `report` counts by kinds, `source` writes what failed as a test
//! to paste, [`run`] does it all on some threads.
//!
//! # What is checked
//! * No interval misses the truth, with no slack beyond the oracle's own bounds (1e-27 of the pair for corners; for round
//!   cores apart what is proved on both sides). The depth of round cores that overlap is, for the oracle, the least width
//!   of very many directions, the answer's own normal among them: a lower bound of the depth above it is surely
//!   wrong; an upper bound more than 1e-15 of the pair below it is not the width along the normal it came with. (The bound
//!   of an overlap comes without a normal: 1e-5·s there.)
//! * Verdicts, `None` and limits say what is true; UNDECIDED only within 1e-11·s of touch, s being
//!   the greatest of both radii and the distance of the origins.
//! * An interval is as narrow as was asked, or, converged, 1e-12·s.
//! * The returned normal of a depth has length 1 and the width along it does not exceed the upper bound (by 1e-13·s:
//!   normals carry no bound).
//! * Swapping the arguments swaps every byte of the answer.
//! * Rays at one form (`rays`): the first touch lies in an interval that was answered, HIT and nothing are true, and what is
//!   open is so within 1e-11·s of a graze or a limit. The truth is the stretch of the line inside the form
//!   ([`crate::oracle::stretch_inside`]).

mod ask;
mod forms;
mod judge;
mod pairs;
mod rays;
mod report;
mod run;
mod source;

pub use ask::Answers;
pub use forms::Kind;
pub use judge::{Fault, FaultKind, Outcome, judge};
pub use pairs::{Question, question};
pub use rays::{RayQuestion, judge_ray, ray_question};
pub use report::{KindReport, Report, Row};
pub use run::{Failure, Settings, examine, examine_ray, run};
