//! What the fuzz targets do with bytes: forms, poses and questions with a taste for extremes, and the laws that every
//! answer obeys. A law that is broken panics with the numbers as code, to be pasted into a test.

pub mod forms;
pub mod hulls;
pub mod numbers;
pub mod pairs;
pub mod rays;
pub mod support;

/// Panics with what a case was, as code, if a law does not hold.
#[macro_export]
macro_rules! law {
    ($case:expr, $holds:expr, $($what:tt)+) => {
        if !$holds {
            panic!("BROKEN {}\n{}", format_args!($($what)+), $case);
        }
    };
}
