//! A concave form at a pose, which offers its pieces: by a box, along a path, and nearest first.
//!
//! # Method
//! All searches are those of a [`Tree`] in the form's own frame, of which each leaf is a piece. Boxes and paths of other
//! forms are taken into that frame and widened by what this may cost.

use std::{convert::Infallible, ops::ControlFlow};

use glam::DVec3;

use super::{Facet, Piece, Side, stand_in::StandIns};
use crate::{
    answer::{Feature, Work},
    broad::{ALL_LAYERS, Line, Path, Tree},
    math::{Aabb, Norm, Pose},
    narrow::{half_space::Body, place::Place},
    shape::{Compound, Convex, Core, Form, Geometry, HeightField, Mesh, MeshParts, Standing},
    tolerance,
};

/// A concave form at a place.
#[derive(Clone, Copy)]
pub(super) struct Concave<'a> {
    kind: Kind<'a>,
    geometry: &'a Geometry,
    place: Place,
    /// The number of its first leaf in the compound that it is part of.
    part: Option<u32>,
}

/// What it consists of.
#[derive(Clone, Copy)]
enum Kind<'a> {
    /// Triangles.
    Mesh(&'a Mesh),
    /// Other geometries.
    Compound(&'a Compound),
    /// The convex parts that stand in for a mesh.
    Parts(&'a Compound),
    /// The skin of a body.
    Field(&'a HeightField),
}

impl<'a> Concave<'a> {
    pub(super) fn mesh(mesh: &'a Mesh, geometry: &'a Geometry, place: Place, part: Option<u32>) -> Self {
        Self { kind: Kind::Mesh(mesh), geometry, place, part }
    }

    pub(super) fn compound(compound: &'a Compound, geometry: &'a Geometry, place: Place, part: Option<u32>) -> Self {
        Self { kind: Kind::Compound(compound), geometry, place, part }
    }

    pub(super) fn height_field(
        field: &'a HeightField,
        geometry: &'a Geometry,
        place: Place,
        part: Option<u32>,
    ) -> Self {
        Self { kind: Kind::Field(field), geometry, place, part }
    }

    pub(super) fn geometry(&self) -> &'a Geometry {
        self.geometry
    }

    pub(super) fn place(&self) -> &Place {
        &self.place
    }

    /// Which of two is taken apart first: what has an inside is asked about pieces of the other.
    pub(super) fn rank(&self) -> u8 {
        match self.kind {
            Kind::Compound(_) | Kind::Parts(_) => 0,
            Kind::Mesh(_) => 1,
            Kind::Field(_) => 2,
        }
    }

    /// Whether something may lie in it and touch none of its pieces.
    pub(super) fn has_inside(&self) -> bool {
        matches!(self.kind, Kind::Field(_))
    }

    /// How a point of another form, in that form's own frame, stands to what is inside of this one, and in which cell; `None`
    /// if it is outside.
    pub(super) fn standing_of(&self, other: &Side<'_>, local: DVec3) -> Option<(Standing, Option<u32>)> {
        let Kind::Field(field) = self.kind else { return None };
        let (relative, slack) = self.relative(other);
        match field.standing(relative.transform_point(local), slack) {
            Standing::Outside => None,
            Standing::Inside(leaf) => Some((Standing::Inside(leaf), Some(HeightField::cell_of(leaf) as u32))),
            Standing::Open(beyond) => Some((Standing::Open(beyond), None)),
        }
    }

    /// What a half space is asked against; `None` for a compound.
    pub(super) fn body(&self) -> Option<Body<'a>> {
        match self.kind {
            Kind::Mesh(mesh) => Some(Body::Mesh(mesh)),
            Kind::Field(field) => Some(Body::Field(field)),
            Kind::Compound(_) | Kind::Parts(_) => None,
        }
    }

    /// Which part it is.
    pub(super) fn feature(&self) -> Feature {
        Feature { part: self.part, face: None }
    }

    /// The mesh, if it is one.
    pub(super) fn as_mesh(&self) -> Option<&'a Mesh> {
        match self.kind {
            Kind::Mesh(mesh) => Some(mesh),
            Kind::Compound(_) | Kind::Parts(_) | Kind::Field(_) => None,
        }
    }

    /// The convex parts that stand in for it, if it is a mesh of which some do; else itself.
    pub(super) fn or_parts(&self, stand_ins: StandIns<'_>) -> Self {
        match self.as_mesh().and_then(|mesh| stand_ins.of(mesh)) {
            Some(MeshParts { whole, .. }) => match whole.form() {
                Form::Compound(compound) => Self { kind: Kind::Parts(compound), geometry: whole, ..*self },
                Form::Convex(_) | Form::Mesh(_) | Form::HeightField(_) | Form::HalfSpace(_) => *self,
            },
            None => *self,
        }
    }

    /// Whether it goes before another: what is taken apart first, then what has fewer pieces, then by content and pose.
    pub(super) fn goes_before(&self, other: &Self) -> bool {
        let pose = |form: &Self| {
            let [x, y, z] = form.place.pose.position.to_array();
            let [i, j, k, w] = form.place.pose.rotation.to_array();
            [x, y, z, i, j, k, w].map(f64::to_bits)
        };
        let by_size = (self.rank(), self.piece_count()).cmp(&(other.rank(), other.piece_count()));
        // The hash of a content takes a pass over it when it is first asked for.
        let by_content = || self.geometry.id().cmp(&other.geometry.id());
        by_size.then_with(by_content).then_with(|| pose(self).cmp(&pose(other))).is_lt()
    }

    fn piece_count(&self) -> usize {
        match self.kind {
            Kind::Mesh(mesh) => mesh.triangles().len(),
            Kind::Compound(compound) | Kind::Parts(compound) => compound.parts().len(),
            Kind::Field(field) => field.cell_count(),
        }
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
            Kind::Compound(compound) | Kind::Parts(compound) => {
                compound.tree().visit_box(query, ALL_LAYERS, work, each)
            }
            Kind::Field(field) => field.visit_box(query, ALL_LAYERS, work, each),
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
            Kind::Compound(compound) | Kind::Parts(compound) => {
                compound.tree().visit_nearest(query, limit, ALL_LAYERS, work, each)
            }
            Kind::Field(field) => field.visit_nearest(query, limit, ALL_LAYERS, work, each),
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
        let line = Line::new(path);
        let Ok(()) = match self.kind {
            Kind::Mesh(mesh) => mesh.tree().visit_ray(&line, limit, ALL_LAYERS, work, each),
            Kind::Compound(compound) | Kind::Parts(compound) => {
                compound.tree().visit_ray(&line, limit, ALL_LAYERS, work, each)
            }
            Kind::Field(field) => field.visit_ray(&line, limit, ALL_LAYERS, work, each),
        };
    }

    /// The piece of a leaf of its tree.
    pub(super) fn with_piece<Answer>(&self, leaf: u32, ask: impl FnOnce(Side<'_>) -> Answer) -> Answer {
        let index = leaf as usize;
        match self.kind {
            Kind::Mesh(mesh) => {
                let convex = &Convex { core: Core::Triangle(mesh.corners(index)), radius: 0.0 };
                let feature = Feature { part: self.part, face: Some(mesh.sent_number(index)) };
                let facet = Some(Facet { mesh, triangle: index });
                ask(Side::Convex(Piece { convex, place: self.place, feature, skin: false, facet, is_of_parts: false }))
            }
            Kind::Field(field) => {
                let convex = &Convex { core: Core::Triangle(field.corners(index)), radius: 0.0 };
                let feature = Feature { part: self.part, face: Some(HeightField::cell_of(index) as u32) };
                ask(Side::Convex(Piece {
                    convex,
                    place: self.place,
                    feature,
                    skin: true,
                    facet: None,
                    is_of_parts: false,
                }))
            }
            Kind::Compound(compound) => {
                let part = &compound.parts()[index];
                let place = self.place.of_part(&part.pose, part.geometry.reach());
                let number = self.part.unwrap_or(0) + compound.first_leaf(index);
                ask(Side::of(&part.geometry, place, Some(number)))
            }
            Kind::Parts(compound) => {
                let part = &compound.parts()[index];
                let place = self.place.of_part(&part.pose, part.geometry.reach());
                // In a compound they are all the one part that the mesh is.
                let number = self.part.unwrap_or(compound.first_leaf(index));
                match Side::of(&part.geometry, place, Some(number)) {
                    Side::Convex(piece) => ask(Side::Convex(Piece { is_of_parts: true, ..piece })),
                    other => ask(other),
                }
            }
        }
    }

    /// A box in its own frame that surely holds another form.
    pub(super) fn box_of(&self, other: &Side<'_>) -> Aabb {
        let (relative, slack) = self.relative(other);
        other.bounds_at(&relative).inflated(slack)
    }

    /// Where another form is in its own frame, and how far any point of that may be from there.
    fn relative(&self, other: &Side<'_>) -> (Pose, f64) {
        let (own, place) = (&self.place, other.place());
        let to_local = own.pose.unit_rotation().conjugate();
        let apart = place.pose.position - own.pose.position;
        let relative = Pose::new(to_local * apart, to_local * place.pose.unit_rotation());
        let slack = tolerance::RELATIVE_POSE * (apart.norm() + other.reach());
        (relative, slack + own.blur + place.blur)
    }

    /// A displacement in the world, in its own axes.
    pub(super) fn displacement_in(&self, world: DVec3) -> DVec3 {
        let pose = &self.place.pose;
        if pose.rotation.xyz() == DVec3::ZERO { world } else { pose.matrix().transpose() * world }
    }
}
