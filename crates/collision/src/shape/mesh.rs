//! Triangle meshes: what is kept of what was sent, and which triangles are neighbours.

use std::sync::{Arc, OnceLock};

use glam::DVec3;

use super::{
    adjacency::Adjacency,
    bounds::around,
    built::Structure,
    creases::Fans,
    equal::first_equal,
    islands::first_vertices,
    ladder::Ladder,
    lazy::Lazy,
    mode::MeshMode,
    parts::{MadeParts, MeshParts},
};
use crate::{
    broad::StaticTree,
    math::{Aabb, Ball, expansion::ExactVector},
};

/// Triangles, and which side of them is matter.
#[derive(Clone, Debug)]
pub struct Mesh {
    mode: MeshMode,
    vertices: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
    /// The number each triangle was sent with; empty if none was left out before it.
    sent_numbers: Vec<u32>,
    bounds: Aabb,
    /// Around that box.
    ball: Ball,
    triangles_sent: usize,
    merged_vertices: usize,
    adjacency: Lazy<Adjacency>,
    report: OnceLock<MeshReport>,
    fans: Lazy<Fans>,
    part_vertices: OnceLock<Vec<u32>>,
    tree: Lazy<StaticTree>,
    parts: Option<Arc<MeshParts>>,
    made: MadeParts,
    ladder: Ladder,
}

/// What was found in a mesh when it came.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MeshReport {
    /// Triangles as sent.
    pub triangles_sent: usize,
    /// Triangles without area, left out.
    pub degenerate: usize,
    /// Vertices that were equal to an earlier one.
    pub merged_vertices: usize,
    /// Edges with one triangle only.
    pub open_edges: usize,
    /// Edges with more than two.
    pub non_manifold_edges: usize,
    /// Triangles with the same three vertices as an earlier one, however wound; they are kept.
    pub duplicates: usize,
}

impl Mesh {
    /// Keeps the triangles with an area (decided exactly) and the vertices that they use, equal ones once. The numbers
    /// are finite and the indices name vertices, which the caller has checked.
    #[must_use]
    pub(super) fn new(vertices: &[DVec3], triangles: &[[u32; 3]], mode: MeshMode) -> Self {
        let numbers: Vec<u32> = (0..).take(triangles.len()).collect();
        Self { mode, ..Self::numbered(vertices, triangles, &numbers, triangles.len()) }
    }

    /// The same triangles, each vertex `scale` times as far from the local origin, rounded to nearest.
    #[must_use]
    pub(super) fn scaled(&self, scale: f64) -> Self {
        let vertices: Vec<DVec3> = self.vertices.iter().map(|&vertex| vertex * scale).collect();
        let numbers: Vec<u32> = (0..self.triangles.len()).map(|index| self.sent_number(index)).collect();
        Self { mode: self.mode, ..Self::numbered(&vertices, &self.triangles, &numbers, self.triangles_sent) }
    }

    fn numbered(vertices: &[DVec3], triangles: &[[u32; 3]], numbers: &[u32], triangles_sent: usize) -> Self {
        let (first_equal, merged_vertices) = first_equal(vertices);
        let mut kept_index = vec![u32::MAX; vertices.len()];
        let mut mesh = Self {
            mode: MeshMode::TwoSided,
            vertices: Vec::new(),
            triangles: Vec::with_capacity(triangles.len()),
            sent_numbers: Vec::new(),
            bounds: around(&[]),
            ball: around(&[]).ball(),
            triangles_sent,
            merged_vertices,
            adjacency: Lazy::default(),
            report: OnceLock::new(),
            fans: Lazy::default(),
            part_vertices: OnceLock::new(),
            tree: Lazy::default(),
            parts: None,
            made: MadeParts::default(),
            ladder: Ladder::default(),
        };
        for (triangle, &number) in triangles.iter().zip(numbers) {
            let [a, b, c] = *triangle;
            if !has_area(vertices[a as usize], vertices[b as usize], vertices[c as usize]) {
                continue;
            }
            let kept = triangle.map(|vertex| {
                let first = first_equal[vertex as usize] as usize;
                if kept_index[first] == u32::MAX {
                    kept_index[first] = u32::try_from(mesh.vertices.len()).unwrap_or(u32::MAX);
                    mesh.vertices.push(vertices[first] + DVec3::ZERO);
                }
                kept_index[first]
            });
            mesh.triangles.push(kept);
            mesh.sent_numbers.push(number);
        }
        if mesh.triangles.len() == triangles_sent {
            mesh.sent_numbers = Vec::new();
        }
        mesh.bounds = around(&mesh.vertices);
        mesh.ball = mesh.bounds.ball();
        mesh
    }

    /// The local box, exact.
    #[must_use]
    pub fn local_bounds(&self) -> Aabb {
        self.bounds
    }

    /// The same.
    pub(super) fn bounds(&self) -> Aabb {
        self.bounds
    }

    /// The ball around that box.
    pub(crate) fn ball(&self) -> Ball {
        self.ball
    }

    /// The same with convex parts.
    pub(super) fn with_parts(&self, parts: MeshParts) -> Self {
        Self { parts: Some(Arc::new(parts)), ..self.clone() }
    }

    /// The convex parts that it brings along.
    #[must_use]
    pub fn parts(&self) -> Option<&MeshParts> {
        self.parts.as_deref()
    }

    /// Which side of its triangles is matter.
    #[must_use]
    pub fn mode(&self) -> MeshMode {
        self.mode
    }

    /// The distinct vertices that triangles use, in order of first use.
    #[must_use]
    pub fn vertices(&self) -> &[DVec3] {
        &self.vertices
    }

    /// The kept triangles, by vertex.
    #[must_use]
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// The corners of a kept triangle, in the order sent.
    #[must_use]
    pub fn corners(&self, index: usize) -> [DVec3; 3] {
        let [a, b, c] = self.triangles[index];
        [self.vertices[a as usize], self.vertices[b as usize], self.vertices[c as usize]]
    }

    /// The number a kept triangle was sent with.
    #[must_use]
    pub fn sent_number(&self, index: usize) -> u32 {
        match self.sent_numbers.get(index) {
            Some(&number) => number,
            None => u32::try_from(index).unwrap_or(u32::MAX),
        }
    }

    /// How many triangles were sent, those without area among them.
    #[must_use]
    pub fn sent_count(&self) -> usize {
        self.triangles_sent
    }

    /// The kept triangle that was sent with a number; `None` if it was left out.
    #[must_use]
    pub fn kept_number(&self, sent_number: u32) -> Option<usize> {
        if self.sent_numbers.is_empty() {
            return usize::try_from(sent_number).ok().filter(|&index| index < self.triangles.len());
        }
        self.sent_numbers.binary_search(&sent_number).ok()
    }

    /// The box of a kept triangle, exact.
    #[must_use]
    pub fn triangle_bounds(&self, index: usize) -> Aabb {
        let [a, b, c] = self.corners(index);
        Aabb::new(a.min(b).min(c), a.max(b).max(c))
    }

    /// Which triangles are neighbours; built when first asked.
    #[must_use]
    pub fn adjacency(&self) -> &Adjacency {
        self.adjacency.get_or_build(|| Adjacency::new(self.vertices.len(), &self.triangles))
    }

    /// A vertex of each connected part; the parts are found when first asked.
    pub fn part_vertices(&self) -> impl Iterator<Item = DVec3> + '_ {
        let parts = self.part_vertices.get_or_init(|| first_vertices(self.vertices.len(), &self.triangles));
        parts.iter().map(|&vertex| self.vertices[vertex as usize])
    }

    /// The triangles at each vertex; built when a contact first needs them.
    pub(super) fn fans(&self) -> &Fans {
        self.fans.get_or_build(|| Fans::new(self.vertices.len(), &self.triangles))
    }

    /// The tree over the boxes of its triangles; built when a question first needs it. Leaves are kept triangles.
    #[must_use]
    pub fn tree(&self) -> &StaticTree {
        self.tree.get_or_build(|| {
            StaticTree::build_within(self.bounds, (0..self.triangles.len()).map(|index| self.triangle_bounds(index)))
        })
    }

    /// The tree, if a question has needed it.
    #[must_use]
    pub fn built_tree(&self) -> Option<&StaticTree> {
        self.tree.built()
    }

    /// What questions made it build, stand-ins and parts aside.
    pub(super) fn structures(&self) -> impl Iterator<Item = Structure> {
        let tree_bytes = self.built_tree().map_or(0, StaticTree::memory_bytes);
        let adjacency = Structure::of(
            "mesh_adjacency",
            self.adjacency_bytes() as u64,
            [self.adjacency.receipt(), self.fans.receipt()],
        );
        [Structure::of("mesh_tree", tree_bytes, [self.tree.receipt()]), adjacency].into_iter().flatten()
    }

    fn adjacency_bytes(&self) -> usize {
        self.adjacency.built().map_or(0, Adjacency::memory_bytes) + self.fans.built().map_or(0, Fans::memory_bytes)
    }

    /// The parts that questions had made of it.
    pub(super) fn made(&self) -> &MadeParts {
        &self.made
    }

    /// What may stand in for it.
    pub(super) fn ladder(&self) -> &Ladder {
        &self.ladder
    }

    /// What was found when it came. The first call finds all neighbours to count edges; it does not keep them, for most meshes are
    /// never asked anything that needs them.
    #[must_use]
    pub fn report(&self) -> MeshReport {
        *self.report.get_or_init(|| match self.adjacency.built() {
            Some(adjacency) => self.reported(adjacency),
            None => self.reported(&Adjacency::new(self.vertices.len(), &self.triangles)),
        })
    }

    fn reported(&self, adjacency: &Adjacency) -> MeshReport {
        MeshReport {
            triangles_sent: self.triangles_sent,
            degenerate: self.triangles_sent - self.triangles.len(),
            merged_vertices: self.merged_vertices,
            open_edges: adjacency.open_edges(),
            non_manifold_edges: adjacency.non_manifold_edges(),
            duplicates: adjacency.duplicate_triangles(),
        }
    }

    /// Bytes held now, what was built lazily included.
    #[must_use]
    pub fn memory_bytes(&self) -> u64 {
        let lists = size_of_val(self.vertices.as_slice())
            + size_of_val(self.triangles.as_slice())
            + size_of_val(self.sent_numbers.as_slice())
            + self.adjacency_bytes()
            + self.part_vertices.get().map_or(0, |parts| size_of_val(parts.as_slice()));
        let parts = self.parts().map_or(0, |parts| parts.whole.memory_bytes());
        let lazy = parts + self.made.memory_bytes() + self.ladder.memory_bytes();
        (size_of::<Self>() + lists) as u64 + lazy + self.tree.built().map_or(0, StaticTree::memory_bytes)
    }
}

/// Whether a triangle has an area that is not exactly 0.
fn has_area(a: DVec3, b: DVec3, c: DVec3) -> bool {
    let (along, across) = (b - a, c - a);
    let area = along.cross(across);
    let largest = along.abs().max_element() * across.abs().max_element();
    // A component of the rounded cross product is off by less than 6 roundings of 2·largest.
    if area.abs().max_element() > crate::tolerance::CROSS_PRODUCT * largest {
        return true;
    }
    let exact = ExactVector::difference(b, a).cross(&ExactVector::difference(c, a));
    !exact.is_zero()
}
