//! A concave form at a pose, which offers its pieces: by a box, along a path, and nearest first.
//!
//! # Method
//! All searches are those of a [`Tree`] in the form's own frame, of which each leaf is a piece. Boxes and paths of other
//! forms are taken into that frame and widened by what this may cost.

use std::{convert::Infallible, ops::ControlFlow};

use glam::DVec3;

use super::{Piece, Side};
use crate::{
    answer::{Feature, Work},
    broad::{ALL_LAYERS, Path, Tree},
    math::{Aabb, Pose},
    narrow::{Placed, convex::PlacedConvex},
    shape::{Convex, Core, Geometry, GeometryId, Mesh},
    tolerance,
};

/// A concave form at a pose.
#[derive(Clone, Copy)]
pub(super) struct Concave<'a> {
    whole: Placed<'a>,
    kind: Kind<'a>,
}

/// What it consists of.
#[derive(Clone, Copy)]
enum Kind<'a> {
    /// Triangles.
    Mesh(&'a Mesh),
}

/// How two concave forms are put in order.
type OrderKey = (usize, GeometryId, [u64; 7]);

impl<'a> Concave<'a> {
    pub(super) fn mesh(mesh: &'a Mesh, whole: Placed<'a>) -> Self {
        Self { whole, kind: Kind::Mesh(mesh) }
    }

    pub(super) fn geometry(&self) -> &'a Geometry {
        self.whole.geometry
    }

    pub(super) fn pose(&self) -> &Pose {
        &self.whole.pose
    }

    /// Whether some of its pieces are parts of a surface, which has no depth of its own.
    pub(super) fn has_surface(&self) -> bool {
        match self.kind {
            Kind::Mesh(_) => true,
        }
    }

    pub(super) fn order_key(&self) -> OrderKey {
        let count = match self.kind {
            Kind::Mesh(mesh) => mesh.triangles().len(),
        };
        let [x, y, z] = self.whole.pose.position.to_array();
        let [i, j, k, w] = self.whole.pose.rotation.to_array();
        (count, self.whole.geometry.id(), [x, y, z, i, j, k, w].map(f64::to_bits))
    }

    /// Visits the pieces whose boxes touch a box of its own frame (and maybe others), until the visitor breaks.
    pub(super) fn in_box(
        &self,
        query: Aabb,
        work: &mut Work,
        mut visit: impl FnMut(Side<'_>, &mut Work) -> ControlFlow<()>,
    ) {
        let each = |work: &mut Work, leaf| Ok::<_, Infallible>(self.with_piece(leaf, |piece| visit(piece, work)));
        let Ok(()) = match self.kind {
            Kind::Mesh(mesh) => mesh.tree().visit_box(query, ALL_LAYERS, work, each),
        };
    }

    /// Visits the pieces whose boxes are within `limit` metres of a box of its own frame (and maybe others), roughly
    /// the nearest first; the visitor returns the new limit.
    pub(super) fn nearest_to(
        &self,
        query: Aabb,
        limit: f64,
        work: &mut Work,
        mut visit: impl FnMut(Side<'_>, &mut Work) -> f64,
    ) {
        let each = |work: &mut Work, leaf| Ok::<_, Infallible>(self.with_piece(leaf, |piece| visit(piece, work)));
        let Ok(()) = match self.kind {
            Kind::Mesh(mesh) => mesh.tree().visit_nearest(query, limit, ALL_LAYERS, work, each),
        };
    }

    /// Visits the pieces that a path in its own frame may meet at a fraction of at most `limit`; the visitor returns the
    /// new limit.
    pub(super) fn along(
        &self,
        path: &Path,
        limit: f64,
        work: &mut Work,
        mut visit: impl FnMut(Side<'_>, &mut Work) -> f64,
    ) {
        if path.direction == DVec3::ZERO {
            let mover = Aabb::new(path.origin - path.reach, path.origin + path.reach);
            self.in_box(mover, work, |piece, work| {
                visit(piece, work);
                ControlFlow::Continue(())
            });
            return;
        }
        let each = |work: &mut Work, leaf| Ok::<_, Infallible>(self.with_piece(leaf, |piece| visit(piece, work)));
        let Ok(()) = match self.kind {
            Kind::Mesh(mesh) => mesh.tree().visit_ray(path, limit, ALL_LAYERS, work, each),
        };
    }

    /// The piece of a leaf of its tree.
    fn with_piece<Answer>(&self, leaf: u32, ask: impl FnOnce(Side<'_>) -> Answer) -> Answer {
        match self.kind {
            Kind::Mesh(mesh) => {
                let triangle = leaf as usize;
                let piece = Convex { core: Core::Triangle(mesh.corners(triangle)), radius: 0.0 };
                let placed = PlacedConvex { convex: &piece, pose: self.whole.pose };
                let feature = Feature { part: None, face: Some(mesh.sent_number(triangle)) };
                ask(Side::Convex(Piece { placed, feature }))
            }
        }
    }

    /// A box in its own frame that surely holds another form.
    pub(super) fn box_of(&self, other: &Side<'_>) -> Aabb {
        let to_local = self.whole.pose.unit_rotation().conjugate();
        let apart = other.pose().position - self.whole.pose.position;
        let relative = Pose::new(to_local * apart, to_local * other.pose().unit_rotation());
        // What the relative pose may be off by.
        let slack = tolerance::RELATIVE_POSE * (apart.length() + other.reach());
        other.bounds_at(&relative).inflated(slack)
    }

    /// A displacement in the world, in its own axes.
    pub(super) fn displacement_in(&self, world: DVec3) -> DVec3 {
        self.whole.pose.matrix().transpose() * world
    }
}
