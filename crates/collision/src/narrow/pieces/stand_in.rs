//! Which convex parts stand in for the meshes of a pair.
//!
//! # Method
//! Those that meshes bring along, where they do and that is enough; else those that were made for questions that name an error, of all
//! meshes of the pair that bring none. Which it is follows from the pair and the question, never from what is built: while parts that
//! a question needs are not made, it has no answer.

use std::sync::Arc;

use crate::{
    accuracy::Accuracy,
    shape::{Fineness, Form, Geometry, Mesh, MeshParts},
};

/// Which parts stand in for meshes.
#[derive(Clone, Copy, Debug)]
pub(super) enum StandIns<'q> {
    /// None: meshes are surfaces.
    Nothing,
    /// Those that meshes bring along.
    Brought,
    /// Those, and of the other meshes those that are made for this accuracy.
    Made(&'q Accuracy),
}

/// What meshes a geometry has, and what stands in for them.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Census {
    /// Nothing stands in for some of them.
    pub(super) has_surface: bool,
    /// Something stands in for some of them.
    pub(super) has_parts: bool,
    /// How far the meshes are outside of their parts at most, metres.
    pub(super) outside: f64,
    /// How far the parts reach beyond their meshes at most, metres.
    pub(super) inside: f64,
}

impl StandIns<'_> {
    /// What stands in for a mesh.
    pub(super) fn of<'a>(&self, mesh: &'a Mesh) -> Option<&'a MeshParts> {
        match self {
            Self::Nothing => None,
            Self::Brought => mesh.parts(),
            Self::Made(accuracy) => mesh.parts().or_else(|| mesh.made_parts(fineness(mesh, accuracy))),
        }
    }

    /// What a geometry consists of then.
    pub(super) fn census(&self, geometry: &Geometry) -> Census {
        match geometry.form() {
            Form::Convex(_) | Form::HeightField(_) | Form::HalfSpace(_) => Census::default(),
            Form::Mesh(mesh) => match self.of(mesh) {
                None => Census { has_surface: true, ..Census::default() },
                Some(parts) => Census {
                    has_surface: false,
                    has_parts: true,
                    outside: parts.outside.upper,
                    inside: parts.inside.upper,
                },
            },
            Form::Compound(compound) if !compound.has_surface() => Census::default(),
            Form::Compound(compound) => {
                let all = compound.parts().iter().map(|part| self.census(&part.geometry));
                all.fold(Census::default(), Census::with)
            }
        }
    }
}

impl Census {
    fn with(self, other: Self) -> Self {
        Self {
            has_surface: self.has_surface || other.has_surface,
            has_parts: self.has_parts || other.has_parts,
            outside: self.outside.max(other.outside),
            inside: self.inside.max(other.inside),
        }
    }
}

/// Convex parts of a mesh that a question needs and that are not made yet.
#[derive(Clone, Debug)]
pub struct PartsWanted {
    /// Of which mesh.
    pub mesh: Arc<Mesh>,
    /// How near to it.
    pub fineness: Fineness,
}

impl PartialEq for PartsWanted {
    /// Of the very same mesh, not one that is equal.
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.mesh, &other.mesh) && self.fineness == other.fineness
    }
}

/// The parts that contacts of two geometries need at an accuracy and that are not made yet, each once: none if the accuracy names no
/// error ([`Accuracy::may_stand_in`]), for then there are none that could be made.
#[must_use]
pub fn parts_wanted(geometries: [&Geometry; 2], accuracy: &Accuracy) -> Vec<PartsWanted> {
    let mut wanted = Vec::new();
    if accuracy.may_stand_in() {
        geometries.into_iter().for_each(|geometry| want(geometry, accuracy, &mut wanted));
    }
    wanted
}

/// Compounds are few deep.
fn want(geometry: &Geometry, accuracy: &Accuracy, wanted: &mut Vec<PartsWanted>) {
    match geometry.form() {
        Form::Mesh(mesh) if StandIns::Made(accuracy).of(mesh).is_none() => {
            let own = PartsWanted { mesh: mesh.clone(), fineness: fineness(mesh, accuracy) };
            if !wanted.contains(&own) {
                wanted.push(own);
            }
        }
        Form::Compound(compound) if compound.has_surface() => {
            compound.parts().iter().for_each(|part| want(&part.geometry, accuracy, wanted));
        }
        Form::Mesh(_) | Form::Compound(_) | Form::Convex(_) | Form::HeightField(_) | Form::HalfSpace(_) => {}
    }
}

/// How fine the parts of a mesh are that questions of an accuracy need: half of what is allowed is for the other form's. An error
/// relative to a depth, which is not known yet, counts as one relative to the mesh.
fn fineness(mesh: &Mesh, accuracy: &Accuracy) -> Fineness {
    let bounds = mesh.local_bounds();
    let relative = accuracy.max_error_relative * (bounds.max - bounds.min).max_element();
    Fineness::within(0.5 * accuracy.max_error.max(relative), mesh)
}
