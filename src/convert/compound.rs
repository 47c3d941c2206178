//! Compounds: wire to checked geometries.

use std::{collections::HashMap, sync::Arc};

use collision::{
    math::Pose,
    shape::{Geometry, GeometryId, Limits, Part},
};
use wire::v1 as pb;

use super::{
    geometry::{made, part_of},
    place,
};
use crate::{
    geometries::Geometries,
    problem::{Checked, Problem, Reason, Under},
};

/// A compound that is in `level` others; parts that are equal are kept once.
///
/// # Errors
/// What is wrong with it or with a part; too deep.
pub(super) fn read(sent: &pb::Compound, known: &Geometries, level: u32) -> Checked<Geometry> {
    if level >= Limits::COMPOUND_DEPTH {
        let what =
            "are in too many compounds: these may hold compounds, 4 deep in all, so place inner parts in the outer one";
        return Err(Problem::at("parts", Reason::BadGeometry, what));
    }
    if sent.parts.len() > Limits::COMPOUND_PARTS {
        let what = format!("has {} items: at most {} are allowed", sent.parts.len(), Limits::COMPOUND_PARTS);
        return Err(Problem::at("parts", Reason::TooManyItems, what));
    }
    let mut same: HashMap<GeometryId, Arc<Geometry>> = HashMap::new();
    let mut parts = Vec::with_capacity(sent.parts.len());
    for (index, part) in sent.parts.iter().enumerate() {
        let made = read_part(part, known, level).under_item("parts", index)?;
        let geometry = same.entry(made.geometry.id()).or_insert(made.geometry).clone();
        parts.push(Part { geometry, pose: made.pose });
    }
    made("", Geometry::compound(parts))
}

fn read_part(sent: &pb::CompoundPart, known: &Geometries, level: u32) -> Checked<Part> {
    let Some(geometry) = &sent.geometry else {
        let what = "is absent: each part needs a form, such as {\"sphere\": {\"radius\": 1}}";
        return Err(Problem::at("geometry", Reason::Missing, what));
    };
    let geometry = part_of(geometry, known, level + 1).under("geometry")?;
    let pose = place::pose(sent.pose.as_ref(), Pose::IDENTITY).under("pose")?;
    Ok(Part { geometry, pose })
}
