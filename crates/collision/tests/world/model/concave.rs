//! Meshes in their modes, terrains and compounds in compounds.

use std::sync::Arc;

use collision::{
    DVec3,
    math::Pose,
    shape::{Geometry, GeometryError, MeshMode, Part, Terrain},
};

use super::script::Script;

/// A tent of four walls and a floor, as a surface of either kind or as a body.
pub(super) fn tent(script: &mut Script<'_>, sizes: DVec3) -> Result<Geometry, GeometryError> {
    let mode = [MeshMode::TwoSided, MeshMode::OneSided, MeshMode::Solid][script.below(3)];
    let corners = [DVec3::Y, DVec3::X, DVec3::Z, DVec3::NEG_X, DVec3::NEG_Z].map(|corner| corner * sizes);
    let walls = [[0, 2, 1], [0, 3, 2], [0, 4, 3], [0, 1, 4], [1, 2, 3], [1, 3, 4]];
    Geometry::mesh_as(mode, &corners, &walls)
}

/// Four cells, one of which may be open.
pub(super) fn terrain(script: &mut Script<'_>, sizes: DVec3) -> Result<Geometry, GeometryError> {
    let heights: [f32; 9] = std::array::from_fn(|_| script.below(5) as f32 * 0.5);
    let holes: Vec<u32> = script.one_in(2).map(|()| script.below(4) as u32).into_iter().collect();
    Geometry::height_field(&Terrain { columns: 3, rows: 3, heights: &heights, spacing: sizes, holes: &holes })
}

/// Two or three forms beside each other, which may be such again.
pub(super) fn cluster(script: &mut Script<'_>, sizes: DVec3, depth: u32) -> Result<Geometry, GeometryError> {
    let mut parts = Vec::new();
    for _ in 0..2 + script.below(2) {
        let geometry = match script.below(6) {
            0 | 1 if depth > 1 => cluster(script, sizes * 0.5, depth - 1),
            0 | 1 => Geometry::sphere(sizes.x),
            2 => Geometry::cuboid(sizes),
            3 => Geometry::capsule(sizes.x, sizes.y),
            4 => tent(script, sizes),
            _ => terrain(script, sizes),
        };
        let pose = Pose::new(script.shares() * sizes * 2.0, script.rotation());
        parts.push(Part { geometry: Arc::new(geometry?), pose });
    }
    Geometry::compound(parts)
}
