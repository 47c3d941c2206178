//! Concave forms: compounds, and that two ways to say the same give the same answers.

mod agree;
mod compounds;
mod exact;
mod extremes;
mod fields;
mod found;
mod one_sided;
mod terrain;
#[path = "../whole/mod.rs"]
mod whole;
