//! What questions made a geometry build for itself, beside what stands in for it.

use super::{Convex, Core, Form, Geometry, lazy::Receipt};

/// Something that questions made a geometry build for itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Structure {
    /// `mesh_tree`, `mesh_adjacency` (which triangles meet at edges and corners), `compound_tree`, `height_pyramid` or
    /// `hull_adjacency` (faces, edges, and what finds them).
    pub name: &'static str,
    /// What it holds, bytes.
    pub memory_bytes: u64,
    /// What building it took, and when it was first needed.
    pub receipt: Receipt,
}

impl Structure {
    /// What is built in several steps, one by one; `None` before the first is.
    pub(super) fn of<const N: usize>(
        name: &'static str,
        memory_bytes: u64,
        receipts: [Option<Receipt>; N],
    ) -> Option<Self> {
        let receipt = receipts.into_iter().flatten().reduce(Receipt::and)?;
        Some(Self { name, memory_bytes, receipt })
    }
}

impl Geometry {
    /// What questions made it build for itself so far: not what stands in for it ([`Geometry::stand_ins_built`]), nor what the
    /// parts of a compound built.
    #[must_use]
    pub fn structures_built(&self) -> Vec<Structure> {
        match self.form() {
            Form::Mesh(mesh) => mesh.structures().collect(),
            Form::Compound(compound) => Vec::from_iter(compound.structure()),
            Form::HeightField(field) => Vec::from_iter(field.structure()),
            Form::Convex(Convex { core: Core::Hull(hull), .. }) => Vec::from_iter(hull.structure()),
            Form::Convex(_) | Form::HalfSpace(_) => Vec::new(),
        }
    }
}
