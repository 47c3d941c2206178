//! The program as people use it: the built binary, its output, its exit codes.

mod arguments;
mod binary;
mod carry;
mod demo;
mod explain;
mod load;
#[cfg(feature = "measure")]
mod measure;
mod play;
mod resume;
mod stop;
