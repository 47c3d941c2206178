//! What the fuzz targets do with bytes: forms, poses and questions with a taste for extremes, and the laws that every
//! answer obeys. A law that is broken panics with the numbers as code, to be pasted into a test.

mod concave;
pub mod forms;
pub mod hulls;
pub mod numbers;
pub mod pairs;
pub mod rays;
pub mod support;
pub mod worlds;

/// Whether a law is one that the variable KNOWN_BROKEN names, as in `src/rays.rs:131,src/hulls.rs:149`: it is passed over, so
/// that a search goes on to what is not known yet.
#[must_use]
pub fn is_known(file: &str, line: u32) -> bool {
    let law = format!("{file}:{line}");
    std::env::var("KNOWN_BROKEN").is_ok_and(|known| known.split(',').any(|name| name == law))
}

/// Panics with what a case was, as code, if a law does not hold.
#[macro_export]
macro_rules! law {
    ($case:expr, $holds:expr, $($what:tt)+) => {{
        let holds: bool = $holds;
        if !holds && !$crate::is_known(file!(), line!()) {
            panic!("BROKEN {}:{} {}\n{}", file!(), line!(), format_args!($($what)+), $case);
        }
    }};
}
