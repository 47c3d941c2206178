//! See `src/rays.rs` for the laws.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| calipers_fuzz::rays::check(bytes));
