//! Laws of the trees of boxes.

mod data;
mod dynamic;
mod fixed;
mod random;
