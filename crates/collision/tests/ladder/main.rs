//! What stands in for a geometry: how far off it is, which questions it answers, and when it is built.

mod climb;
mod forms;
mod impacts;
mod lazy;
mod rungs;
