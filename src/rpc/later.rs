//! What the API names and this version does not do yet: each says what it will do and what to use meanwhile.

use tonic::Status;

use crate::problem::{Problem, Reason};

/// A call that a later version will answer.
#[derive(Clone, Copy, Debug)]
pub(super) struct Later {
    call: &'static str,
    will: &'static str,
    meanwhile: &'static str,
}

impl From<Later> for Problem {
    fn from(later: Later) -> Self {
        let Later { call, will, meanwhile } = later;
        let what = format!("{call} is not served yet: it will {will}; meanwhile {meanwhile}");
        Self::new(Reason::NotYet, what)
    }
}

impl From<Later> for Status {
    fn from(later: Later) -> Self {
        Problem::from(later).into()
    }
}

macro_rules! later {
    ($($name:ident = $call:literal will $will:literal meanwhile $meanwhile:literal;)*) => {
        $(pub(super) const $name: Later = Later { call: $call, will: $will, meanwhile: $meanwhile };)*
    };
}

later! {
    EXPORT_WORLD = "ExportWorld"
        will "send one tick of a world, complete in itself"
        meanwhile "read ListShapes, page by page, which keeps to one tick";
    IMPORT_WORLD = "ImportWorld"
        will "fill an empty world from an export"
        meanwhile "insert the shapes with Edit or EditStream";
}
