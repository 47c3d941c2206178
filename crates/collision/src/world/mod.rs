//! A world is a sequence of immutable versions: [`World`] is the one writer, [`Snapshot`] a version that any number of
//! readers question without waiting.

mod batch;
mod changed;
mod character;
mod check;
mod content;
mod describe;
mod directory;
mod distance;
mod edit;
mod filter;
mod history;
mod hits;
mod impact;
mod ledger;
mod outline;
mod overlap;
mod pairs;
mod penetration;
mod question;
mod raycast;
mod search;
mod settings;
mod snapshot;
mod state;
mod store;
mod sweeps;
mod tracks;

pub use character::{MoveCharacter, MovedCharacter};
pub use describe::{BuiltStructure, Description};
pub use distance::{Distance, Neighbor};
pub use edit::{Edit, EditError, EditFault, EditReport, EditRule, World};
pub use filter::Filter;
pub use history::{HistoryError, Moment};
pub use impact::{Impact, TimeOfImpact};
pub use ledger::Clock;
pub use overlap::{Overlap, OverlapHit};
pub use pairs::{PAIRS_MAX, Pair, PairChanges, PairKeeper, Persisted, STEPS_MAX};
pub use penetration::{Contact, Penetration};
pub use question::{Found, HitMode, Meter, QuestionError, Subject};
pub use raycast::{RayHit, Raycast};
pub use settings::{Means, Settings};
pub use snapshot::{Mobility, Shape, ShapeId, Snapshot, Tick, Time};
pub use sweeps::{BULLET_HITS_MAX, SWEEP_CANDIDATES_MAX, SWEEP_HITS_MAX, SWEEP_STEPS_MAX, SweepHit, Swept};
pub use tracks::SweepRule;
