//! Meshes in their modes, height fields and nested compounds from bytes.

use std::sync::Arc;

use collision::{
    DVec3,
    shape::{Convex, Core, Form, Geometry, MeshMode, Part, Terrain},
};

use crate::{
    forms::{Constructed, convex_or_mesh, points, points_code},
    numbers::{Numbers, pose_code, vector_code},
};

/// A mesh: fans, strips and soups; where a body is wanted, mostly the faces of a hull, which it may be.
pub(crate) fn mesh(numbers: &mut Numbers<'_>) -> Constructed {
    let mode = [MeshMode::TwoSided, MeshMode::TwoSided, MeshMode::OneSided, MeshMode::Solid][numbers.below(4)];
    let mut vertices = points(numbers, 12);
    let triangles: Vec<[u32; 3]> = match numbers.below(if mode == MeshMode::Solid { 12 } else { 4 }) {
        0 => (2..vertices.len() as u32).map(|last| [0, last - 1, last]).collect(),
        1 => (2..vertices.len() as u32).map(|last| [last - 2, last - 1, last]).collect(),
        2 => {
            let count = 1 + numbers.below(16);
            let mut corner = || numbers.below(vertices.len().min(256)) as u32;
            (0..count).map(|_| [corner(), corner(), corner()]).collect()
        }
        _ => faces_of_hull(&mut vertices),
    };
    let code = format!("Geometry::mesh_as(MeshMode::{mode:?}, &{}, &{triangles:?})", points_code(&vertices));
    (Geometry::mesh_as(mode, &vertices, &triangles), code)
}

/// The triangles of the hull of points, which become its vertices.
fn faces_of_hull(points: &mut Vec<DVec3>) -> Vec<[u32; 3]> {
    let Ok(geometry) = Geometry::hull(points) else { return Vec::new() };
    let Form::Convex(Convex { core: Core::Hull(hull), .. }) = geometry.form() else { return Vec::new() };
    *points = hull.vertices().to_vec();
    let fan = |face: &collision::shape::Face| {
        let corners = face.vertices.clone();
        (2..corners.len()).map(move |at| [corners[0], corners[at - 1], corners[at]]).collect::<Vec<_>>()
    };
    hull.topology().faces.iter().flat_map(fan).collect()
}

/// A terrain of few samples, with holes.
pub(crate) fn height_field(numbers: &mut Numbers<'_>) -> Constructed {
    let (columns, rows) = (2 + numbers.below(6), 2 + numbers.below(6));
    let heights: Vec<f32> = match numbers.below(3) {
        0 => (0..columns * rows).map(|_| f32::from(numbers.byte() as i8) / 16.0).collect(),
        1 => vec![f32::from(numbers.byte() as i8) / 8.0; columns * rows],
        _ => (0..columns * rows).map(|_| numbers.number() as f32).collect(),
    };
    let spacing = DVec3::new(numbers.size(), numbers.size(), numbers.size());
    let cells = (columns - 1) * (rows - 1);
    let holes: Vec<u32> = (0..numbers.below(4)).map(|_| numbers.below(cells) as u32).collect();
    let terrain = Terrain { columns, rows, heights: &heights, spacing, holes: &holes };
    let code = format!(
        "Geometry::height_field(&Terrain {{ columns: {columns}, rows: {rows}, heights: &{heights:?}, spacing: {}, holes: &{holes:?} }})",
        vector_code(spacing)
    );
    (Geometry::height_field(&terrain), code)
}

/// Up to four parts, at most so deep, the same form twice among them.
pub(crate) fn compound(numbers: &mut Numbers<'_>, depth: u32) -> Constructed {
    let mut parts: Vec<Part> = Vec::new();
    let mut codes: Vec<String> = Vec::new();
    for _ in 0..1 + numbers.below(4) {
        let (geometry, code) = match numbers.below(24) {
            0..4 if depth > 1 => compound(numbers, depth - 1),
            4 | 5 => height_field(numbers),
            kind => convex_or_mesh(numbers, kind - kind.min(6)),
        };
        let geometry = match geometry {
            Ok(geometry) => Arc::new(geometry),
            Err(error) => return (Err(error), String::new()),
        };
        for _ in 0..1 + usize::from(numbers.below(6) == 0) {
            let pose = numbers.pose();
            codes.push(format!("Part {{ geometry: Arc::new({code}.unwrap()), pose: {} }}", pose_code(&pose)));
            parts.push(Part { geometry: geometry.clone(), pose });
        }
    }
    (Geometry::compound(parts), format!("Geometry::compound(vec![{}])", codes.join(", ")))
}
