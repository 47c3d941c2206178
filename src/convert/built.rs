//! What questions made geometries build, and what that took.

use std::time::Duration;

use collision::{
    answer::Representation,
    shape::{Form, Geometry, StandIn},
};
use wire::v1 as pb;

use super::{answer::representation, geometry::counts, number::duration, place::number_out};
use crate::problem::Checked;

/// What building something took, if that is kept.
pub(crate) fn build_time_out(build_ns: Option<u64>) -> Option<prost_types::Duration> {
    build_ns.map(|nanoseconds| duration(Duration::from_nanos(nanoseconds)))
}

/// What stands in for a geometry, from coarse to fine; convex parts that questions had made last.
///
/// # Errors
/// A number is not finite, which is a fault of the server.
pub(super) fn stand_ins_out(geometry: &Geometry) -> Checked<Vec<pb::StandIn>> {
    let mut known = geometry.stand_ins_built().map(stand_in_out).collect::<Checked<Vec<_>>>()?;
    if let Form::Mesh(mesh) = geometry.form() {
        for parts in mesh.all_made_parts() {
            known.push(pb::StandIn {
                representation: representation(Representation::Decomposition).into(),
                outside: number_out(parts.outside.upper)?,
                inside: number_out(parts.inside.upper)?,
                vertex_count: u32::try_from(counts(&parts.whole).vertex_count).unwrap_or(u32::MAX),
                memory_bytes: parts.whole.memory_bytes(),
                build_time: build_time_out(parts.receipt.build_ns),
                first_tick: parts.receipt.first_tick.unwrap_or(0),
            });
        }
    }
    Ok(known)
}

fn stand_in_out(stand_in: &StandIn) -> Checked<pb::StandIn> {
    Ok(pb::StandIn {
        representation: representation(stand_in.representation()).into(),
        outside: number_out(stand_in.outside())?,
        inside: number_out(stand_in.inside())?,
        vertex_count: u32::try_from(stand_in.vertex_count()).unwrap_or(u32::MAX),
        memory_bytes: stand_in.memory_bytes(),
        build_time: build_time_out(stand_in.receipt().build_ns),
        first_tick: stand_in.receipt().first_tick.unwrap_or(0),
    })
}

/// What else a geometry built for itself.
pub(super) fn structures_out(geometry: &Geometry) -> Vec<pb::GeometryStructure> {
    let built = geometry.structures_built().into_iter().map(|structure| pb::GeometryStructure {
        name: structure.name.to_owned(),
        memory_bytes: structure.memory_bytes,
        build_time: build_time_out(structure.receipt.build_ns),
        first_tick: structure.receipt.first_tick.unwrap_or(0),
    });
    built.collect()
}
