//! A world is a sequence of immutable versions: [`World`] is the one writer, [`Snapshot`] a version that any number of
//! readers question without waiting.

mod edit;
mod filter;
mod question;
mod snapshot;

pub use edit::{Edit, EditError, EditFault, EditReport, EditRule, World};
pub use filter::Filter;
pub use question::{
    Contact, Distance, Found, HitMode, Impact, Meter, Neighbor, Overlap, OverlapHit, Penetration, QuestionError,
    RayHit, Raycast, Subject, TimeOfImpact,
};
pub use snapshot::{BuiltStructure, Description, Mobility, Shape, ShapeId, Snapshot, Tick, Time};
