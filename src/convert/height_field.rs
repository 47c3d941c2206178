//! Height fields: wire to checked geometries, and back.

use collision::{
    DVec3,
    shape::{Geometry, HeightField, Terrain},
};
use wire::v1 as pb;

use super::geometry::made;
use crate::problem::Checked;

/// A terrain.
///
/// # Errors
/// What is wrong with it.
pub(super) fn read(sent: &pb::HeightField) -> Checked<Geometry> {
    let spacing = sent.spacing.map_or(DVec3::ONE, |sent| DVec3::new(sent.x, sent.y, sent.z));
    let [columns, rows] = [sent.columns, sent.rows].map(|count| count as usize);
    let terrain = Terrain { columns, rows, heights: &sent.heights, spacing, holes: &sent.holes };
    made("", Geometry::height_field(&terrain))
}

/// The same with its lists left empty.
pub(super) fn header_out(field: &HeightField) -> pb::HeightField {
    let DVec3 { x, y, z } = field.spacing();
    pb::HeightField {
        columns: u32::try_from(field.columns()).unwrap_or(u32::MAX),
        rows: u32::try_from(field.rows()).unwrap_or(u32::MAX),
        spacing: Some(pb::Vec3 { x, y, z }),
        heights: Vec::new(),
        holes: Vec::new(),
    }
}
