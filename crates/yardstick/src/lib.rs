//! How right Calipers is: named scenes, readers of the query sets, a slow and obvious oracle, and the runner that
//! compares the crate's or a running server's answers with those of an independent reference.
//!
//! # Map
//! [`sets`] reads a folder of query sets; [`oracle`] knows what is true, slowly;
//! [`check`] asks, compares and reports; [`coverage`] does so for random questions of every kind;
//! [`attack`] climbs towards the ends of intervals; [`ladder`] measures what stands in for geometries; [`scene`] makes worlds
//! for benches, [`scenes`] has the named ones; [`measure`] measures what accuracy costs on them.
//!
//! # Never
//! The oracle never knows the kernels; nothing here knows the server's insides.

pub mod attack;
pub mod check;
pub mod coverage;
pub mod ladder;
pub mod measure;
pub mod oracle;
pub mod scene;
pub mod scenes;
pub mod sets;
