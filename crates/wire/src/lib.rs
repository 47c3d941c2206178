//! Messages and stubs of the Calipers API, generated at build time from `proto/calipers/v1`.
//!
//! The `.proto` files are the documentation of every field, with units and ranges; this crate adds nothing to them and
//! knows nothing of collision.

/// The API, version 1.
#[allow(
    missing_docs,
    clippy::all,
    rustdoc::broken_intra_doc_links,
    reason = "generated: the .proto files carry the documentation"
)]
pub mod v1 {
    tonic::include_proto!("calipers.v1");

    /// The compiled `.proto` files, for server reflection.
    pub const FILE_DESCRIPTOR_SET: &[u8] = include_bytes!(concat!(env!("OUT_DIR"), "/calipers.bin"));
}
