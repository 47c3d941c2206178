//! The fence that a panic does not pass: it becomes one INTERNAL answer with an id that stands in the log as well.

use std::{
    any::Any,
    panic::{AssertUnwindSafe, catch_unwind},
};

use futures_util::FutureExt;

use crate::{
    problem::{Checked, Problem, Reason},
    token::random_hex,
};

/// Runs `work`; a panic in it becomes a problem. What `work` may have left half done must not be used afterwards.
///
/// # Errors
/// `work` panicked.
pub(crate) fn fenced<T>(doing: &'static str, work: impl FnOnce() -> T) -> Checked<T> {
    catch_unwind(AssertUnwindSafe(work)).map_err(|panic| caught(doing, panic.as_ref()))
}

/// Awaits `work`; a panic in it becomes a problem. What `work` may have left half done must not be used afterwards.
///
/// # Errors
/// `work` panicked.
pub(crate) async fn fenced_async<T>(doing: &'static str, work: impl Future<Output = T>) -> Checked<T> {
    AssertUnwindSafe(work).catch_unwind().await.map_err(|panic| caught(doing, panic.as_ref()))
}

/// What a caller is told about a panic that was caught while `doing`.
pub(crate) fn caught(doing: &'static str, panic: &(dyn Any + Send)) -> Problem {
    let text = panic
        .downcast_ref::<&str>()
        .copied()
        .or_else(|| panic.downcast_ref::<String>().map(String::as_str))
        .unwrap_or("no message");
    let id = random_hex(8).unwrap_or_else(|_| "0000000000000000".to_owned());
    tracing::error!(id, doing, panic = text, "a panic was caught");
    let what = format!("the server failed while {doing}; this is a fault of the server, its log has more under {id}");
    Problem::new(Reason::Internal, what).with("id", id)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_becomes_a_problem_with_an_id_and_does_not_show_its_text() {
        let problem = fenced("testing", || -> u32 { panic!("secret") }).unwrap_err();
        let status = tonic::Status::from(problem);
        assert_eq!(status.code(), tonic::Code::Internal);
        assert!(status.message().contains("while testing"), "{status}");
        assert!(!status.message().contains("secret"), "{status}");
        assert_eq!(fenced("testing", || 3).unwrap(), 3);
    }
}
