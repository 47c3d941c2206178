//! What accuracy costs: questions over scenes, asked at every setting, with the time, the work and the true error of each.
//!
//! # Method
//! Questions of a kind are drawn from a seed and asked of a world ([`Kind`]). What is true of each is told by the exact tier, at the
//! largest budget; as many of those answers as the oracle can judge in time are audited by it, and a report says how many. Then each setting
//! ([`Setting`]) asks all of them: an answer must hold the truth in its interval, its error is how far its value is from the truth,
//! and its time the least of several turns in which all settings take part, so that what slows the machine slows all of them.
//!
//! # Map
//! `questions` draws, `settings` lists what is tried, `stages` makes the worlds that some settings need, `ask` asks, `audit` holds the exact
//! answers to the oracle, `judge` compares, `run` does all that; `rows` writes tables, `plot` and `page` draw, `tune` recommends, `needed` tells
//! what a scene had built; `document` writes all of it, with `trades`.
//!
//! # Limits
//! Times are processor times of one thread of this machine, now: compare them within one report only. Counts and errors are the same everywhere.

mod ask;
mod audit;
mod clock;
mod document;
mod judge;
mod needed;
mod page;
mod plot;
mod questions;
mod rows;
mod run;
mod settings;
mod stages;
mod trades;
mod tune;

pub use document::{DocumentError, document};
pub use needed::{Needed, needed};
pub use page::page;
pub use plot::svg;
pub use questions::Kind;
pub use rows::{Row, csv, table};
pub use run::{Audited, Lie, Options, Report, run};
pub use settings::{Knob, Setting, Stage};
pub use tune::{Advice, advise};
