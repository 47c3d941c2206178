//! See `src/worlds.rs` for the laws.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| calipers_fuzz::worlds::check(bytes));
