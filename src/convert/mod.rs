//! Wire messages to checked values of the domain, and its answers back to wire messages.
//!
//! Nothing that comes out of here towards the domain is out of limits, and nothing that goes out to a client is NaN,
//! infinite or a negative zero. Each function names fields relative to the message it is given; who holds that message
//! puts its own name before them.

pub(crate) mod account;
pub(crate) mod answer;
pub(crate) mod archive;
pub(crate) mod built;
pub(crate) mod character;
pub(crate) mod columns;
mod compound;
pub(crate) mod depenetrate;
pub(crate) mod edit;
pub(crate) mod first_touch;
pub(crate) mod geometry;
mod height_field;
pub(crate) mod hit_columns;
pub(crate) mod item;
pub(crate) mod lists;
pub(crate) mod number;
pub(crate) mod parts;
pub(crate) mod place;
pub(crate) mod places;
pub(crate) mod question;
pub(crate) mod rays;
pub(crate) mod resolve;
pub(crate) mod settings;
pub(crate) mod shape;
pub(crate) mod sight;
pub(crate) mod tick;
pub(crate) mod trace;
pub(crate) mod view;
pub(crate) mod watch;
