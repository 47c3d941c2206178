//! Laws of worlds: their edits, their versions and the answers to questions.

mod bullets;
mod character;
mod content;
mod depenetrate;
mod determinism;
mod edited;
mod edits;
mod filters;
mod first_touch;
mod half_spaces;
mod history;
mod history_bounds;
mod history_readers;
mod laziness;
mod model;
mod notes;
mod pair_changes;
mod pairs;
mod pierce;
mod questions;
#[path = "../broad/random.rs"]
mod random;
mod rays;
mod readers;
mod resolve;
mod retold;
mod scene;
mod sight;
mod traffic;
mod view;
mod watch;
mod watch_model;
