//! Forms of any class, as they are sent, as pieces for the oracle and as Rust source.

use std::{fmt::Write, sync::Arc};

use collision::{
    answer::Feature,
    math::Pose,
    shape::{Form, Geometry, GeometryError, MeshMode, Part, Terrain},
};
use glam::{DQuat, DVec3};

use super::{ask::geometry as convex_geometry, source};
use crate::oracle::{Core, Piece, PlacedSolid, Solid, Truth, Union};

/// A form of any class.
#[derive(Clone, Debug)]
pub enum Whole {
    /// A convex form or a half space.
    Convex(Solid),
    /// Triangles.
    Mesh {
        /// Which side of them is matter.
        mode: MeshMode,
        /// Corners.
        vertices: Vec<DVec3>,
        /// Three for each triangle.
        triangles: Vec<[u32; 3]>,
    },
    /// A terrain.
    Field {
        /// Samples along x; as many rows as there are heights for.
        columns: usize,
        /// Row by row.
        heights: Vec<f32>,
        /// Between samples, and factor on heights.
        spacing: DVec3,
        /// Open cells.
        holes: Vec<u32>,
    },
    /// Several convex forms or meshes, with where each is.
    Compound(Vec<(Whole, DVec3, DQuat)>),
}

/// A form of any class at a pose.
#[derive(Clone, Debug)]
pub struct PlacedWhole {
    /// What.
    pub whole: Whole,
    /// Where its local origin is, metres.
    pub position: DVec3,
    /// How it is turned: a quaternion of any length but 0.
    pub rotation: DQuat,
}

impl From<PlacedSolid> for PlacedWhole {
    fn from(placed: PlacedSolid) -> Self {
        Self { whole: Whole::Convex(placed.solid), position: placed.position, rotation: placed.rotation }
    }
}

impl PlacedWhole {
    /// Its pose.
    #[must_use]
    pub fn pose(&self) -> Pose {
        Pose::new(self.position, self.rotation)
    }
}

impl Whole {
    /// The form, if it is convex or a half space.
    #[must_use]
    pub fn as_convex(&self) -> Option<&Solid> {
        match self {
            Self::Convex(solid) => Some(solid),
            Self::Mesh { .. } | Self::Field { .. } | Self::Compound(_) => None,
        }
    }

    /// Its class in reports.
    #[must_use]
    pub fn class(&self) -> &'static str {
        match self {
            Self::Convex(_) => "convex",
            Self::Mesh { mode: MeshMode::TwoSided, .. } => "mesh",
            Self::Mesh { mode: MeshMode::OneSided, .. } => "one_sided",
            Self::Mesh { mode: MeshMode::Solid, .. } => "solid",
            Self::Field { .. } => "height_field",
            Self::Compound(_) => "compound",
        }
    }

    /// Whether it has inner surfaces that count from one side only.
    #[must_use]
    pub fn is_one_sided(&self) -> bool {
        match self {
            Self::Mesh { mode, .. } => *mode == MeshMode::OneSided,
            Self::Compound(parts) => parts.iter().any(|(part, ..)| part.is_one_sided()),
            Self::Convex(_) | Self::Field { .. } => false,
        }
    }

    /// What it counts as in reports: its class, and of convex forms the kind.
    #[must_use]
    pub fn labels(&self) -> Vec<&'static str> {
        match self {
            Self::Convex(solid) => convex_labels(solid),
            _ => vec![self.class()],
        }
    }

    /// Which piece of [`Whole::union`] a contact is of. `None` if that cannot be told: of a terrain kernels ask the skin, though
    /// here it is columns.
    #[must_use]
    pub fn piece_of(&self, feature: Feature) -> Option<usize> {
        match self {
            Self::Convex(_) => Some(0),
            Self::Mesh { .. } => Some(feature.face? as usize),
            Self::Compound(parts) if parts.iter().all(|(part, ..)| matches!(part, Self::Convex(_))) => {
                Some(feature.part? as usize)
            }
            Self::Field { .. } | Self::Compound(_) => None,
        }
    }

    /// Whether contacts tell of it from all sides.
    #[must_use]
    pub fn is_felt_from_all_sides(&self) -> bool {
        matches!(self, Self::Convex(_))
            || matches!(self, Self::Compound(parts) if parts.iter().all(|(part, ..)| part.is_felt_from_all_sides()))
    }

    /// Whether all of its convex pieces have volume.
    #[must_use]
    pub fn has_volume(&self) -> bool {
        self.union().pieces.iter().all(|piece| {
            let solid = &piece.solid;
            let here = PlacedSolid { solid: solid.clone(), position: DVec3::ZERO, rotation: DQuat::IDENTITY };
            let is_bounded = !matches!(solid.core, Core::HalfSpace { .. });
            !is_bounded || Truth::of(&here, &here, &[]).nearest() < -THIN * solid.reach()
        })
    }

    /// How many convex pieces a kernel may look at, at most.
    #[must_use]
    pub fn piece_count(&self) -> u64 {
        match self {
            Self::Convex(_) => 1,
            Self::Mesh { triangles, .. } => triangles.len() as u64,
            // Two triangles on top, and each wall and the bottom two as well.
            Self::Field { heights, .. } => 12 * heights.len() as u64,
            Self::Compound(parts) => parts.iter().map(|(part, ..)| part.piece_count()).sum(),
        }
    }

    /// The greatest distance of a point from the local origin, to within some roundings.
    #[must_use]
    pub fn reach(&self) -> f64 {
        match self {
            Self::Convex(solid) => solid.reach(),
            Self::Mesh { vertices, .. } => vertices.iter().map(|vertex| vertex.length()).fold(0.0, f64::max),
            Self::Field { .. } => self.union().pieces.iter().map(|piece| piece.solid.reach()).fold(0.0, f64::max),
            Self::Compound(parts) => {
                parts.iter().map(|(part, position, _)| part.reach() + position.length()).fold(0.0, f64::max)
            }
        }
    }

    /// The crate's form.
    ///
    /// # Errors
    /// What the crate refuses.
    pub fn geometry(&self) -> Result<Geometry, GeometryError> {
        match self {
            Self::Convex(solid) => convex_geometry(solid),
            Self::Mesh { mode, vertices, triangles } => Geometry::mesh_as(*mode, vertices, triangles),
            Self::Field { columns, heights, spacing, holes } => Geometry::height_field(&Terrain {
                columns: *columns,
                rows: heights.len() / columns,
                heights,
                spacing: *spacing,
                holes,
            }),
            Self::Compound(parts) => {
                let part = |(whole, position, rotation): &(Self, DVec3, DQuat)| {
                    let geometry = Arc::new(whole.geometry()?);
                    Ok(Part { geometry, pose: Pose::new(*position, *rotation) })
                };
                Geometry::compound(parts.iter().map(part).collect::<Result<_, GeometryError>>()?)
            }
        }
    }

    /// Convex pieces: triangles, columns of matter, parts.
    #[must_use]
    pub fn union(&self) -> Union {
        match self {
            Self::Convex(solid) => Union::of(solid.clone()),
            Self::Mesh { mode, vertices, triangles } => {
                let corners = triangles.iter().map(|triangle| triangle.map(|index| vertices[index as usize]));
                let corners: Vec<[DVec3; 3]> = corners.collect();
                let pieces = corners.iter().map(|corners| flat_piece(corners.to_vec())).collect();
                let walls = if *mode == MeshMode::Solid { corners } else { Vec::new() };
                Union { pieces, walls }
            }
            Self::Field { columns, heights, spacing, holes } => {
                self.columns_of_matter(*columns, heights, *spacing, holes)
            }
            Self::Compound(parts) => {
                let pieces = parts.iter().flat_map(|(whole, position, rotation)| {
                    let inner = whole.union().pieces.into_iter();
                    inner.map(|piece| Piece { part: Some((*position, *rotation)), ..piece })
                });
                Union { pieces: pieces.collect(), walls: Vec::new() }
            }
        }
    }

    fn columns_of_matter(&self, columns: usize, heights: &[f32], spacing: DVec3, holes: &[u32]) -> Union {
        // How deep the matter goes is the form's own word: so much below its lowest sample.
        let floor = match self.geometry().as_ref().map(Geometry::form) {
            Ok(Form::HeightField(field)) => field.floor(),
            _ => 0.0,
        };
        let sample = |column: usize, row: usize| {
            let height = f64::from(heights[row * columns + column]) * spacing.y;
            DVec3::new(column as f64 * spacing.x, height, row as f64 * spacing.z)
        };
        let rows = heights.len() / columns;
        let mut union = Union::default();
        for cell in 0..(columns - 1) * (rows - 1) {
            if holes.iter().any(|&hole| hole as usize == cell) {
                continue;
            }
            let (column, row) = (cell % (columns - 1), cell / (columns - 1));
            let [a, b, c, d] = [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(x, z)| sample(column + x, row + z));
            for top in [[a, c, d], [a, d, b]] {
                let down = top.map(|corner| DVec3::new(corner.x, floor, corner.z));
                union.pieces.push(flat_piece(top.into_iter().chain(down).collect()));
            }
        }
        union
    }

    /// Rust source of an expression that makes the geometry.
    #[must_use]
    pub fn source(&self) -> String {
        let vectors = |list: &[DVec3]| list.iter().map(|&v| source::vector(v)).collect::<Vec<_>>().join(", ");
        match self {
            Self::Convex(solid) => format!("{}.unwrap()", source::form(solid)),
            Self::Mesh { mode, vertices, triangles } => {
                format!("Geometry::mesh_as(MeshMode::{mode:?}, &[{}], &{triangles:?}).unwrap()", vectors(vertices))
            }
            Self::Field { columns, heights, spacing, holes } => format!(
                "Geometry::height_field(&Terrain {{ columns: {columns}, rows: {}, heights: &{heights:?}, spacing: {}, holes: &{holes:?} }}).unwrap()",
                heights.len() / columns,
                source::vector(*spacing)
            ),
            Self::Compound(parts) => {
                let mut out = String::from("Geometry::compound(vec![");
                for (whole, position, rotation) in parts {
                    let pose = source::pose(*position, *rotation);
                    let _ = write!(out, "Part {{ geometry: Arc::new({}), pose: {pose} }}, ", whole.source());
                }
                out + "]).unwrap()"
            }
        }
    }
}

/// What a convex form counts as in reports.
pub(super) fn convex_labels(solid: &Solid) -> Vec<&'static str> {
    let kind = match &solid.core {
        Core::Point if solid.radius == 0.0 => "point",
        Core::Point => "sphere",
        Core::Segment { .. } => "capsule",
        Core::Cuboid { .. } => "box",
        Core::Hull(points) if points.len() > LARGE => "large_hull",
        Core::Hull(_) => "hull",
        Core::Cylinder { .. } => "cylinder",
        Core::Cone { .. } => "cone",
        Core::Ellipsoid { .. } => "ellipsoid",
        Core::HalfSpace { .. } => "half_space",
    };
    let is_rounded = solid.radius > 0.0 && !matches!(solid.core, Core::Point | Core::Segment { .. });
    if is_rounded { vec![kind, "rounded"] } else { vec![kind] }
}

/// What is as thin as this part of its size may be a sheet.
const THIN: f64 = 1e-9;

/// Corners from which on stand-ins are made.
const LARGE: usize = 500;

fn flat_piece(corners: Vec<DVec3>) -> Piece {
    Piece { solid: Solid { core: Core::Hull(corners), radius: 0.0 }, part: None }
}
