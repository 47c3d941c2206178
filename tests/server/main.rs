//! The server, asked by a client in the same process or over a real socket: one file for each family of calls.

mod harness;
mod port;
mod questions;
