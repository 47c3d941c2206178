//! Messages and stubs of the Calipers API, generated at build time from `proto/calipers/v1`, but for those with long lists of
//! numbers, which copy them as a whole.
//!
//! The `.proto` files are the documentation of every field, with units and ranges; this crate adds nothing to them and
//! knows nothing of collision.

pub mod codec;
mod columns;
mod kinds;
mod variants;

/// The API, version 1.
#[allow(
    missing_docs,
    clippy::all,
    rustdoc::broken_intra_doc_links,
    reason = "generated: the .proto files carry the documentation"
)]
pub mod v1 {
    tonic::include_proto!("calipers.v1");

    pub use crate::columns::*;

    /// The compiled `.proto` files, for server reflection.
    pub const FILE_DESCRIPTOR_SET: &[u8] = include_bytes!(concat!(env!("OUT_DIR"), "/calipers.bin"));
}

/// The same messages, all of them generated.
#[cfg(test)]
#[allow(missing_docs, dead_code, clippy::all, rustdoc::broken_intra_doc_links, reason = "generated")]
mod reference {
    include!(concat!(env!("OUT_DIR"), "/reference/calipers.v1.rs"));
}
