//! What can go wrong for a client, and what the server said about it.

use std::time::Duration;

use tonic::{Code, Status};
use tonic_types::StatusExt;

/// Why a call, a connection or a stream of edits failed.
#[derive(Clone, Debug, thiserror::Error)]
pub enum Error {
    /// The address is not one that can be connected to.
    #[error("{address:?} is not an address to connect to ({reason}); one that would work: http://127.0.0.1:7070")]
    Address {
        /// The address as it was given.
        address: String,
        /// What is wrong with it.
        reason: String,
    },
    /// Nothing answers at the address.
    #[error("no Calipers server answers at {address}: {reason}")]
    Connect {
        /// Where nothing answers.
        address: String,
        /// What the transport says.
        reason: String,
    },
    /// The token cannot be sent: it holds characters that metadata does not allow.
    #[error("the token holds characters that cannot be sent; use it exactly as CreateSession returned it")]
    Token,
    /// The server refused the call, or the connection broke.
    #[error("{}: {}", code_name(.0.code()), .0.message())]
    Status(Box<Status>),
    /// The window is full of messages of one tick that is not committed, so no acknowledgement can ever come.
    #[error(
        "{window} messages were sent since the last commit, which is all the server's window holds; commit more often"
    )]
    WindowFull {
        /// How many messages the server allows to be unacknowledged.
        window: u32,
    },
    /// The server no longer knows this writer: it holds less than was acknowledged before, so nothing can be resumed.
    #[error(
        "the server knows this writer up to message {known}, but {acked} was acknowledged: its world was lost; build it again"
    )]
    Forgotten {
        /// Up to which message the server knows the writer now.
        known: u64,
        /// Up to which message it had acknowledged.
        acked: u64,
    },
    /// The stream broke and could not be taken up again.
    #[error("the stream broke and could not be resumed within {} s: {last}", waited.as_secs_f64())]
    GaveUp {
        /// How long it was tried.
        waited: Duration,
        /// Why the last attempt failed.
        last: Box<Error>,
    },
    /// The writer's task is gone, as happens when its runtime shuts down.
    #[error("the edit stream was closed")]
    Closed,
}

impl Error {
    /// The gRPC code, if the server or the transport gave one.
    pub fn code(&self) -> Option<Code> {
        match self {
            Self::Status(status) => Some(status.code()),
            Self::GaveUp { last, .. } => last.code(),
            _ => None,
        }
    }

    /// The reason for programs, such as `SHAPE_NOT_FOUND`, if the server gave one.
    pub fn reason(&self) -> Option<String> {
        match self {
            Self::Status(status) => status.get_details_error_info().map(|info| info.reason),
            Self::GaveUp { last, .. } => last.reason(),
            _ => None,
        }
    }

    /// True if the same call may work a moment later on a new connection: the transport broke, or the server is going
    /// down. The request itself was not found wrong.
    pub fn is_passing(&self) -> bool {
        match self {
            Self::Connect { .. } => true,
            Self::Status(status) => {
                matches!(status.code(), Code::Unavailable | Code::Unknown | Code::Cancelled | Code::Internal)
            }
            _ => false,
        }
    }
}

impl From<Status> for Error {
    fn from(status: Status) -> Self {
        Self::Status(Box::new(status))
    }
}

/// The code as the API's documentation writes it.
fn code_name(code: Code) -> &'static str {
    match code {
        Code::Ok => "OK",
        Code::Cancelled => "CANCELLED",
        Code::Unknown => "UNKNOWN",
        Code::InvalidArgument => "INVALID_ARGUMENT",
        Code::DeadlineExceeded => "DEADLINE_EXCEEDED",
        Code::NotFound => "NOT_FOUND",
        Code::AlreadyExists => "ALREADY_EXISTS",
        Code::PermissionDenied => "PERMISSION_DENIED",
        Code::ResourceExhausted => "RESOURCE_EXHAUSTED",
        Code::FailedPrecondition => "FAILED_PRECONDITION",
        Code::Aborted => "ABORTED",
        Code::OutOfRange => "OUT_OF_RANGE",
        Code::Unimplemented => "UNIMPLEMENTED",
        Code::Internal => "INTERNAL",
        Code::Unavailable => "UNAVAILABLE",
        Code::DataLoss => "DATA_LOSS",
        Code::Unauthenticated => "UNAUTHENTICATED",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_status_reads_as_code_and_sentence() {
        let error = Error::from(Status::not_found("shape 7 is not in the world"));
        assert_eq!(error.to_string(), "NOT_FOUND: shape 7 is not in the world");
        assert_eq!(error.code(), Some(Code::NotFound));
    }

    #[test]
    fn only_a_broken_transport_is_passing() {
        assert!(Error::from(Status::unavailable("")).is_passing());
        for status in
            [Status::invalid_argument(""), Status::aborted(""), Status::not_found(""), Status::unauthenticated("")]
        {
            assert!(!Error::from(status).is_passing());
        }
    }
}
