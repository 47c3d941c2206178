//! The conformance runner: asks every set of a folder, compares each answer with what is true, and reports.

mod ask;
mod crate_asker;
mod judge;
mod known;
mod report;
mod run;
mod server_asker;
mod server_stage;
mod special;
pub mod tolerance;

pub use ask::{
    Answer, Asker, Claim, ContactAnswer, ImpactAnswer, Near, Neighbors, PairTally, Question, RayAnswer, Reply, Stage,
    Verdict,
};
pub use crate_asker::CrateAsker;
use judge::Limit;
pub use judge::{Case, Fault, FaultKind, Outcome};
pub use known::{Known, KnownError, Listed, Mismatch};
pub use report::{CategoryReport, SetReport, print_set};
pub use run::{Conclusion, Reporting, check_folder};
pub use server_asker::ServerAsker;
