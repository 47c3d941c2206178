//! Why a call failed: one value that becomes a gRPC status with details, or one item's problem in a batch.

use std::collections::HashMap;

use tonic::{Code, Status};
use tonic_types::{ErrorDetails, FieldViolation, StatusExt};

/// How much of a caller's own text stands in a message.
const QUOTED_CHARS: usize = 80;

/// The domain of every error's reason.
const DOMAIN: &str = "calipers.v1";

/// What a program may look at; listed in `types.proto`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Reason {
    NotFinite,
    OutOfLimits,
    Missing,
    ColumnLength,
    TooManyItems,
    BadGeometry,
    MeshNotClosed,
    SessionNotFound,
    SessionExists,
    ShapeNotFound,
    GeometryNotFound,
    GeometryNotReady,
    TickNotHeld,
    TickChanged,
    NeedsDecomposition,
    UploadIncomplete,
    WorldNotEmpty,
    ExportDamaged,
    DurabilityNotOffered,
    SequenceGap,
    WriterReplaced,
    QuotaExceeded,
    Overloaded,
    Deadline,
    NoToken,
    RoleTooLow,
    NotYet,
    Stopping,
    WorldQuarantined,
    Internal,
}

impl Reason {
    /// Its gRPC code and its name on the wire.
    fn code_and_name(self) -> (Code, &'static str) {
        match self {
            Self::NotFinite => (Code::InvalidArgument, "NOT_FINITE"),
            Self::OutOfLimits => (Code::InvalidArgument, "OUT_OF_LIMITS"),
            Self::Missing => (Code::InvalidArgument, "MISSING"),
            Self::ColumnLength => (Code::InvalidArgument, "COLUMN_LENGTH"),
            Self::TooManyItems => (Code::InvalidArgument, "TOO_MANY_ITEMS"),
            Self::BadGeometry => (Code::InvalidArgument, "BAD_GEOMETRY"),
            Self::MeshNotClosed => (Code::InvalidArgument, "MESH_NOT_CLOSED"),
            Self::SessionNotFound => (Code::NotFound, "SESSION_NOT_FOUND"),
            Self::SessionExists => (Code::AlreadyExists, "SESSION_EXISTS"),
            Self::ShapeNotFound => (Code::NotFound, "SHAPE_NOT_FOUND"),
            Self::GeometryNotFound => (Code::NotFound, "GEOMETRY_NOT_FOUND"),
            Self::GeometryNotReady => (Code::FailedPrecondition, "GEOMETRY_NOT_READY"),
            Self::TickNotHeld => (Code::OutOfRange, "TICK_NOT_HELD"),
            Self::TickChanged => (Code::Aborted, "TICK_CHANGED"),
            Self::NeedsDecomposition => (Code::FailedPrecondition, "NEEDS_DECOMPOSITION"),
            Self::UploadIncomplete => (Code::FailedPrecondition, "UPLOAD_INCOMPLETE"),
            Self::WorldNotEmpty => (Code::FailedPrecondition, "WORLD_NOT_EMPTY"),
            Self::ExportDamaged => (Code::DataLoss, "EXPORT_DAMAGED"),
            Self::DurabilityNotOffered => (Code::FailedPrecondition, "DURABILITY_NOT_OFFERED"),
            Self::SequenceGap => (Code::Aborted, "SEQUENCE_GAP"),
            Self::WriterReplaced => (Code::Aborted, "WRITER_REPLACED"),
            Self::QuotaExceeded => (Code::ResourceExhausted, "QUOTA_EXCEEDED"),
            Self::Overloaded => (Code::ResourceExhausted, "OVERLOADED"),
            Self::Deadline => (Code::DeadlineExceeded, "DEADLINE"),
            Self::NoToken => (Code::Unauthenticated, "NO_TOKEN"),
            Self::RoleTooLow => (Code::PermissionDenied, "ROLE_TOO_LOW"),
            Self::NotYet => (Code::Unimplemented, "NOT_YET"),
            Self::Stopping => (Code::Unavailable, "STOPPING"),
            Self::WorldQuarantined => (Code::Internal, "WORLD_QUARANTINED"),
            Self::Internal => (Code::Internal, "INTERNAL"),
        }
    }
}

/// Why a call, or one item of it, failed. The field is completed from the inside out by [`Problem::under`]. In a box, as it is rare
/// and each number that is checked would carry room for it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Problem(Box<Inside>);

#[derive(Clone, Debug, PartialEq)]
struct Inside {
    reason: Reason,
    /// Where, such as `edits[3].insert.pose.position.x`; empty where no field is to blame.
    field: String,
    /// The rest of the sentence, which begins with the field if there is one; or a sentence after a colon.
    what: String,
    /// The shape concerned; 0 if none.
    shape_id: u64,
    /// More for programs, by name.
    more: Vec<(&'static str, String)>,
}

/// What most of the server's functions return.
pub(crate) type Checked<T> = Result<T, Problem>;

impl Problem {
    /// A problem that no field is to blame for; `what` is a whole sentence.
    pub(crate) fn new(reason: Reason, what: impl Into<String>) -> Self {
        Self::at("", reason, what)
    }

    /// A problem of a field; `what` goes on after its name.
    pub(crate) fn at(field: impl Into<String>, reason: Reason, what: impl Into<String>) -> Self {
        Self(Box::new(Inside { reason, field: field.into(), what: what.into(), shape_id: 0, more: Vec::new() }))
    }

    /// Whether it is of this kind.
    pub(crate) fn is(&self, reason: Reason) -> bool {
        self.0.reason == reason
    }

    /// The same, of another field.
    pub(crate) fn at_field(mut self, field: String) -> Self {
        self.0.field = field;
        self
    }

    /// The same, with the shape concerned.
    pub(crate) fn with_shape(mut self, id: u64) -> Self {
        self.0.shape_id = id;
        self
    }

    /// The same, with one more value for programs.
    pub(crate) fn with(mut self, name: &'static str, value: impl ToString) -> Self {
        self.0.more.push((name, value.to_string()));
        self
    }

    /// The same, of an item of a call whose items have no fields of their own.
    pub(crate) fn of_item(mut self, index: usize) -> Self {
        if self.0.field.is_empty() {
            self.0.what = format!("item {index}: {}", self.0.what);
        }
        self.with("item", index)
    }

    /// The same, seen from the message that holds `outer`. A problem without a field stays as it is.
    pub(crate) fn under(mut self, outer: &str) -> Self {
        if !self.0.field.is_empty() && !outer.is_empty() {
            self.0.field = format!("{outer}.{}", self.0.field);
        }
        self
    }

    /// The whole sentence.
    fn message(&self) -> String {
        if self.0.field.is_empty() {
            self.0.what.clone()
        } else if self.0.what.starts_with(':') {
            format!("{}{}", self.0.field, self.0.what)
        } else {
            format!("{} {}", self.0.field, self.0.what)
        }
    }

    /// As one item's problem in a batch or stream; the stream adds its sequence.
    pub(crate) fn into_wire(self) -> wire::v1::Problem {
        let (code, name) = self.0.reason.code_and_name();
        wire::v1::Problem {
            code: code as i32,
            reason: name.to_owned(),
            message: self.message(),
            field: self.0.field,
            shape_id: self.0.shape_id,
            sequence: 0,
        }
    }
}

impl std::fmt::Display for Problem {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.message())
    }
}

impl From<Problem> for Status {
    fn from(problem: Problem) -> Self {
        let (code, name) = problem.0.reason.code_and_name();
        let message = problem.message();
        let mut more: HashMap<String, String> =
            problem.0.more.into_iter().map(|(name, value)| (name.to_owned(), value)).collect();
        if problem.0.shape_id != 0 {
            more.insert("shape_id".to_owned(), problem.0.shape_id.to_string());
        }
        let mut details = ErrorDetails::new();
        details.set_error_info(name, DOMAIN, more);
        if !problem.0.field.is_empty() {
            details.set_bad_request(vec![FieldViolation::new(problem.0.field, message.clone())]);
        }
        Status::with_error_details(code, message, details)
    }
}

/// A caller's own text as it stands in a message: in quotes, and cut where it is long, because messages travel in headers.
pub(crate) fn quoted(text: &str) -> String {
    match text.char_indices().nth(QUOTED_CHARS) {
        None => format!("{text:?}"),
        Some((end, _)) => format!("{:?}…", &text[..end]),
    }
}

/// Puts the name of the message that holds a field before that field's name.
pub(crate) trait Under {
    /// See [`Problem::under`].
    fn under(self, outer: &str) -> Self;
    /// As [`Under::under`], for item `index` of a list.
    fn under_item(self, list: &str, index: usize) -> Self;
}

impl<T> Under for Checked<T> {
    fn under(self, outer: &str) -> Self {
        self.map_err(|problem| problem.under(outer))
    }

    fn under_item(self, list: &str, index: usize) -> Self {
        self.map_err(|problem| problem.under(&format!("{list}[{index}]")))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_texts_are_cut_between_characters() {
        assert_eq!(quoted("short"), "\"short\"");
        let cut = quoted(&"é".repeat(1000));
        assert_eq!(cut.chars().count(), QUOTED_CHARS + 3);
        assert!(cut.ends_with("\"…"), "{cut}");
    }

    #[test]
    fn the_field_grows_from_the_inside_out_and_stands_in_message_and_details() {
        let inner: Checked<()> = Err(Problem::at("x", Reason::NotFinite, "is NaN: it must be a finite number"));
        let outer = inner.under("insert.pose.position").under_item("edits", 3);
        let status = Status::from(outer.unwrap_err());
        assert_eq!(status.code(), Code::InvalidArgument);
        assert_eq!(status.message(), "edits[3].insert.pose.position.x is NaN: it must be a finite number");
        let details = status.get_error_details();
        let violation = &details.bad_request().unwrap().field_violations[0];
        assert_eq!(violation.field, "edits[3].insert.pose.position.x");
        assert_eq!(details.error_info().unwrap().reason, "NOT_FINITE");
        assert_eq!(details.error_info().unwrap().domain, "calipers.v1");
    }
}
