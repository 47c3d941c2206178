//! The server, asked by a client in the same process or over a real socket: one file for each family of calls.

mod bad_edits;
mod bad_geometries;
mod bad_questions;
mod batch;
mod bullets;
mod by_hand;
mod characters;
mod columns;
mod compounds;
mod edit_stream;
mod edits;
mod forks;
mod forms;
mod geometries;
mod harness;
mod later;
mod pairs;
mod port;
mod query_stream;
mod questions;
mod reading;
mod resolve;
mod sessions;
mod tokens;
mod uploads;
mod versions;
