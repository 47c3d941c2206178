//! Coverage: very many answers of every kind, to plain and to awkward questions, each held against the oracle's truth.
//!
//! # Map
//! `case` says which question a number stands for. Convex forms: `forms` makes them, `pairs` places two and says what is asked,
//! `ask` asks in both orders and warm, `judge` compares with [`crate::oracle::Truth`]; `rays` does all that for rays. Concave
//! forms: `whole` and `wholes` make them, `whole_pairs` and `whole_rays` ask and judge. `moves` sets any of them in motion,
//! `moves_first` knows the first touch, `moves_judge` judges it. `report` counts by question, form, extreme and accuracy and says what there is too little of,
//! `matrix` asks every kind at every extreme, also moved and scaled (`scaled`). `source` writes what failed as a test to paste, `state` keeps a long run, [`run`] does it all on some threads.
//!
//! # What is checked
//! * No interval misses the truth, with no slack beyond the oracle's own bounds (1e-27 of the pair for corners; for round
//!   cores apart what is proved on both sides). The depth of round cores that overlap is, for the oracle, the least width
//!   of very many directions, the answer's own normal among them: a lower bound of the depth above it is surely
//!   wrong; an upper bound more than 1e-15 of the pair below it is not the width along the normal it came with. (The bound
//!   of an overlap comes without a normal: 1e-5·s there.)
//! * Verdicts, `None` and limits say what is true; UNDECIDED only within 1e-11·s of touch, s being
//!   the greatest of both radii and the distance of the origins.
//! * An interval that says it is as narrow as was asked is so, and one that converged is, or is 1e-11·s narrow. What the budget of
//!   the exact tier ended says so and is counted as unfinished.
//! * No answer takes more iterations than its budget lets each search have.
//! * The returned normal of a depth has length 1 and the width along it does not exceed the upper bound (by 1e-13·s:
//!   normals carry no bound).
//! * Swapping the arguments swaps every byte of the answer.
//! * Warm questions, begun where another pose ended, are as true as cold ones.
//! * Rays: the first touch lies in an interval that was answered, HIT and nothing are true, and what is
//!   open is so within 1e-11·s of a graze or a limit. The truth is the stretch of the line inside the form
//!   ([`crate::oracle::stretch_inside`]), or the first of all pieces.
//! * First touches without turns lie in the interval, or there is none; with turns the oracle finds no overlap before the interval
//!   and finds one in it ([`crate::oracle::look_for_overlap`]).
//! * Concave forms are the union of their pieces: triangles, columns of matter, parts; what lies in a solid mesh touches it.

mod ask;
mod case;
mod forms;
mod judge;
mod matrix;
mod moves;
mod moves_first;
mod moves_judge;
mod outcome;
mod pairs;
mod rays;
mod report;
mod run;
mod scaled;
mod source;
mod state;
mod tally;
mod whole;
mod whole_pairs;
mod whole_rays;
mod wholes;

pub use ask::{Answers, Warmed};
pub use forms::Kind;
pub use judge::judge;
pub use matrix::Sweep;
pub use moves::MoveQuestion;
pub use outcome::{Answer, Asked, Fault, FaultKind, Outcome};
pub use pairs::{Question, question};
pub use rays::{RayQuestion, judge_ray, ray_question};
pub use report::{By, Labels, Report};
pub use run::{Failure, Settings, answers, examine, examine_ray, first_touch, run, touches};
pub use state::State;
pub use tally::{Tally, Widths};
pub use whole::{PlacedWhole, Whole};
pub use whole_pairs::WholeQuestion;
pub use whole_rays::WholeRay;
