//! Which way the surface of a mesh looks where its triangles meet: the normals that an edge or a corner has.
//!
//! # Method
//! A direction is a normal of the surface at an edge or a corner if no triangle there rises along it: then a plane across it
//! touches the surface there and no nearer. On an edge in a flat floor, or in a valley, that is the direction of the faces or none;
//! on a ridge it is all directions between those of the two faces. An edge or a corner that is touched from another
//! direction is not what is touched: the surface goes on towards the other form beyond it.
//!
//! # Source
//! Jolt Physics, `ActiveEdges.h` (active edges, and a triangle's normal in place of that of an inactive one); Bullet,
//! `btInternalEdgeUtility` (the range of normals of an edge). Corners are ours: they have all edges around them asked.
//!
//! # Limits
//! Triangles are neighbours if they share vertices: along a seam whose vertices differ, or where a vertex lies on the
//! side of another triangle, the surface counts as ending. Where more than 128 triangles meet in a corner, any direction counts
//! as a normal of it; of an edge of more than 128 triangles, the others are not looked at.

use glam::DVec3;
use smallvec::SmallVec;

use super::{Mesh, topology::index_u32};
use crate::{
    math::{Norm, expansion::triangle_cross, try_unit},
    tolerance::SURFACE_LEAN,
};

/// Most triangles at a corner or an edge that are looked at: a bound of the work of each contact there.
const FAN_MAX: usize = 128;

/// Directions, unit vectors.
pub type Normals = SmallVec<[DVec3; 4]>;

/// Where a triangle of a mesh reaches farthest along a direction.
enum Reach {
    /// All of it does.
    Face,
    /// The side from a corner to the next.
    Side(usize),
    /// A corner.
    Corner(usize),
}

/// The triangles at each vertex.
#[derive(Clone, Debug)]
pub(super) struct Fans {
    /// Where the triangles of each vertex begin in `triangles`, and where the last ones end.
    first: Vec<u32>,
    triangles: Vec<u32>,
}

impl Fans {
    pub(super) fn new(vertex_count: usize, triangles: &[[u32; 3]]) -> Self {
        let mut first = vec![0; vertex_count + 1];
        for &vertex in triangles.as_flattened() {
            first[vertex as usize + 1] += 1;
        }
        for vertex in 0..vertex_count {
            first[vertex + 1] += first[vertex];
        }
        let mut next = first.clone();
        let mut at = vec![0; 3 * triangles.len()];
        for (index, triangle) in triangles.iter().enumerate() {
            for &vertex in triangle {
                at[next[vertex as usize] as usize] = index_u32(index);
                next[vertex as usize] += 1;
            }
        }
        Self { first, triangles: at }
    }

    fn of(&self, vertex: u32) -> &[u32] {
        let vertex = vertex as usize;
        &self.triangles[self.first[vertex] as usize..self.first[vertex + 1] as usize]
    }

    pub(super) fn memory_bytes(&self) -> usize {
        size_of_val(self.first.as_slice()) + size_of_val(self.triangles.as_slice())
    }
}

impl Mesh {
    /// The unit normal of the front of a kept triangle, in the mesh's frame.
    #[must_use]
    pub fn normal(&self, triangle: usize) -> DVec3 {
        try_unit(triangle_cross(self.corners(triangle))).unwrap_or(DVec3::Y)
    }

    /// Whether a direction (a unit vector in the mesh's frame) is a normal of the surface where a triangle reaches farthest along
    /// it, be it a face, an edge or a corner. The first call about a corner lists the triangles of each vertex.
    ///
    /// ```
    /// use collision::{DVec3, shape::{Form, Geometry}};
    /// // A roof whose ridge goes along z, and a third triangle that goes on flat from the first.
    /// let corners = [[0., 1., 0.], [0., 1., 1.], [1., 0., 0.], [-1., 0., 0.], [1., 0., 1.]].map(DVec3::from_array);
    /// let geometry = Geometry::mesh(&corners, &[[0, 1, 2], [1, 0, 3], [1, 4, 2]]).unwrap();
    /// let Form::Mesh(mesh) = geometry.form() else { panic!("a mesh") };
    /// assert!(mesh.looks_along(0, DVec3::Y), "between the two sides of the roof");
    /// assert!(!mesh.looks_along(0, DVec3::new(0.8, 0.0, 0.6)), "across the flat edge");
    /// ```
    #[must_use]
    pub fn looks_along(&self, triangle: usize, direction: DVec3) -> bool {
        let reach = self.reach_along(triangle, direction);
        self.rises(triangle, &reach).iter().all(|&rise| rise.dot(direction) <= SURFACE_LEAN)
    }

    /// The normals of the faces that meet where a triangle reaches farthest along a direction, as far as they are normals of
    /// the surface there: the triangle's own first, whatever its neighbours are. With `sides` both, also those of the backs.
    #[must_use]
    pub fn normals_beside(&self, triangle: usize, direction: DVec3, sides: Sides) -> Normals {
        let own = self.normal(triangle);
        let mut normals = Normals::new();
        let mut add = |normal: DVec3, is_normal: &dyn Fn(DVec3) -> bool| {
            for side in sides.of(normal) {
                if is_normal(side) && normals.iter().all(|&known| (known - side).norm() > SURFACE_LEAN) {
                    normals.push(side);
                }
            }
        };
        add(own, &|_| true);
        let reach = self.reach_along(triangle, direction);
        let rises = self.rises(triangle, &reach);
        let is_normal = |normal: DVec3| rises.iter().all(|rise| rise.dot(normal) <= SURFACE_LEAN);
        match reach {
            Reach::Face => {}
            Reach::Side(k) => {
                self.adjacency()
                    .across(triangle, k)
                    .take(FAN_MAX)
                    .for_each(|(other, _)| add(self.normal(other), &is_normal));
            }
            Reach::Corner(k) => {
                let fan = self.fans().of(self.triangles()[triangle][k]);
                if fan.len() <= FAN_MAX {
                    fan.iter().for_each(|&other| add(self.normal(other as usize), &is_normal));
                }
            }
        }
        normals
    }

    fn reach_along(&self, triangle: usize, direction: DVec3) -> Reach {
        let corners = self.corners(triangle);
        let above = |k: usize, other: usize| direction.dot(corners[k] - corners[other]);
        let top = if above(1, 0) > 0.0 { 1 } else { 0 };
        let top = if above(2, top) > 0.0 { 2 } else { top };
        let is_level = |k: usize| above(top, k) <= SURFACE_LEAN * (corners[top] - corners[k]).norm();
        let (next, last) = ((top + 1) % 3, (top + 2) % 3);
        match (is_level(next), is_level(last)) {
            (true, true) => Reach::Face,
            (true, false) => Reach::Side(top),
            (false, true) => Reach::Side(last),
            (false, false) => Reach::Corner(top),
        }
    }

    /// Unit vectors along which the surface leaves an edge (across it) or a corner (along all edges there); none for a face.
    fn rises(&self, triangle: usize, reach: &Reach) -> SmallVec<[DVec3; 16]> {
        match *reach {
            Reach::Face => SmallVec::new(),
            Reach::Side(k) => {
                let corners = self.corners(triangle);
                let (from, edge) = (corners[k], corners[(k + 1) % 3] - corners[k]);
                let beside = |other: usize, side: usize| {
                    let apex = self.corners(other)[(side + 2) % 3] - from;
                    // Along the edge nothing rises, and a sliver is mostly along it.
                    try_unit(edge.cross(apex).cross(edge))
                };
                let others = self.adjacency().across(triangle, k).take(FAN_MAX);
                std::iter::once((triangle, k)).chain(others).filter_map(|(other, side)| beside(other, side)).collect()
            }
            Reach::Corner(k) => {
                let vertex = self.triangles()[triangle][k];
                let at = self.vertices()[vertex as usize];
                let fan = Some(self.fans().of(vertex)).filter(|fan| fan.len() <= FAN_MAX).unwrap_or_default();
                let ends = fan.iter().flat_map(|&other| self.triangles()[other as usize]);
                let ends = ends.filter(|&end| end != vertex);
                ends.filter_map(|end| try_unit(self.vertices()[end as usize] - at)).collect()
            }
        }
    }
}

/// Which sides of a surface are felt.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sides {
    /// The fronts.
    Front,
    /// The fronts and the backs.
    Both,
}

impl Sides {
    fn of(self, normal: DVec3) -> SmallVec<[DVec3; 2]> {
        match self {
            Self::Front => SmallVec::from_slice(&[normal]),
            Self::Both => SmallVec::from_slice(&[normal, DVec3::ZERO - normal]),
        }
    }
}
