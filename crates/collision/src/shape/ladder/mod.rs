//! What may stand in for a geometry where a question is content with less, and how far off that is.
//!
//! ```text
//!   ball        box         hull of few     (parts)      the geometry
//!    .--.      .----.        /--\
//!   ( /\ )     | /\ |       /    \                           /\
//!   ( \/ )     | \/ |       \    /                           \/
//!    '--'      '----'        \--/
//!   coarse  →                                    →  exact
//! ```
//!
//! # Method
//! Every rung is a convex form in the geometry's own frame with two lengths that are proved, not sampled: no point of the
//! geometry is farther than `outside` from it, and no point of its surface farther than `inside` from the geometry. Each is
//! built when a question first needs it, once, and is shared by all that share the geometry's content.
//!
//! # Limits
//! Forms whose own kernel costs no more than a stand-in have none: all but meshes, compounds and large hulls. Nor has a height
//! field, which is the ground that most things stand on, within any ball and box. The convex parts that a mesh brings along
//! are a rung too, but no question makes them: see [`Geometry::parts`].

mod beyond;
mod landmarks;
mod volumes;

use std::{
    borrow::Cow,
    sync::{Arc, OnceLock},
};

use glam::DVec3;

use super::{
    Convex, Core, Form, Geometry, Hull,
    lazy::{Receipt, receipted},
    simplify::Simplified,
};
use crate::answer::Representation;

/// Vertices of a simplified hull: few enough to look at all of them for a support, which costs half of what a large hull does.
pub const SIMPLIFIED_VERTICES: usize = 32;

/// A convex form that stands in for a geometry, in the geometry's frame.
#[derive(Debug)]
pub struct StandIn {
    representation: Representation,
    convex: Convex,
    center: DVec3,
    outside: f64,
    inside: f64,
    receipt: Receipt,
}

impl StandIn {
    /// Which rung it is.
    #[must_use]
    pub fn representation(&self) -> Representation {
        self.representation
    }

    /// The form, about its own origin, with a radius around it as large as that of the geometry.
    #[must_use]
    pub fn convex(&self, radius: f64) -> Cow<'_, Convex> {
        if radius == 0.0 {
            return Cow::Borrowed(&self.convex);
        }
        // A sum that was rounded down would leave points outside.
        let radius = if self.convex.radius == 0.0 { radius } else { (self.convex.radius + radius).next_up() };
        Cow::Owned(Convex { core: self.convex.core.clone(), radius })
    }

    /// Where that origin is in the geometry's frame.
    #[must_use]
    pub fn center(&self) -> DVec3 {
        self.center
    }

    /// No point of the geometry is farther from the form than this, metres.
    #[must_use]
    pub fn outside(&self) -> f64 {
        self.outside
    }

    /// No point of the form's surface is farther from the geometry than this, metres; of a convex geometry, no point of the
    /// form at all. 0 where the form is a part of the geometry.
    #[must_use]
    pub fn inside(&self) -> f64 {
        self.inside
    }

    /// How many vertices a kernel looks at.
    #[must_use]
    pub fn vertex_count(&self) -> usize {
        match &self.convex.core {
            Core::Hull(hull) => hull.vertices().len(),
            Core::Cuboid { .. } => 8,
            _ => 1,
        }
    }

    /// What building it took, and when it was first needed. Ball and box are built together: either says what both took.
    #[must_use]
    pub fn receipt(&self) -> Receipt {
        self.receipt
    }

    /// Bytes it holds in memory now.
    #[must_use]
    pub fn memory_bytes(&self) -> u64 {
        let hull = if let Core::Hull(hull) = &self.convex.core { hull.memory_bytes() } else { 0 };
        size_of::<Self>() as u64 + hull
    }
}

/// The rungs of one geometry, each built when it is first needed.
#[derive(Clone, Debug, Default)]
pub(super) struct Ladder {
    /// The ball and the box, which are measured in one pass.
    volumes: OnceLock<Arc<[StandIn; 2]>>,
    hull: OnceLock<Arc<StandIn>>,
}

impl Ladder {
    pub(super) fn memory_bytes(&self) -> u64 {
        self.built().map(StandIn::memory_bytes).sum()
    }

    fn volumes(&self, geometry: &Geometry) -> &[StandIn; 2] {
        self.volumes.get_or_init(|| {
            let (volumes, receipt) = receipted(|| volumes::around(geometry));
            Arc::new(volumes.map(|volume| StandIn { receipt, ..volume }))
        })
    }

    fn built(&self) -> impl Iterator<Item = &StandIn> {
        let volumes = self.volumes.get().into_iter().flat_map(|volumes| volumes.iter());
        volumes.chain(self.hull.get().map(Arc::as_ref))
    }
}

impl Geometry {
    /// What stands in for it on a rung: of several that may, the same for every question. `None` if it has no such rung; then the
    /// next finer one is to be asked. The first call builds it: a pass over the vertices for ball and box together, a pass for
    /// each vertex kept for a simplified hull.
    ///
    /// Of a rounded hull it is that of its core: see [`StandIn::convex`].
    ///
    /// ```
    /// use collision::{DVec3, answer::Representation, shape::Geometry};
    /// let spiral = |i: i32| DVec3::new((f64::from(i) * 0.7).cos(), f64::from(i) * 0.003, (f64::from(i) * 0.7).sin());
    /// let points: Vec<DVec3> = (-300..300).map(spiral).collect();
    /// let hull = Geometry::hull(&points)?;
    /// let few = hull.stand_in(Representation::SimplifiedHull).expect("a large hull has one");
    /// assert!(few.inside() == 0.0 && few.outside() < 0.2 && few.vertex_count() <= 32);
    /// assert!(Geometry::sphere(1.0)?.stand_in(Representation::Ball).is_none());
    /// # Ok::<(), collision::shape::GeometryError>(())
    /// ```
    #[must_use]
    pub fn stand_in(&self, representation: Representation) -> Option<&StandIn> {
        let ladder = self.ladder()?;
        match representation {
            Representation::Ball => Some(&ladder.volumes(self)[0]),
            Representation::OrientedBox => Some(&ladder.volumes(self)[1]),
            Representation::SimplifiedHull => {
                let points = self.hull_points()?;
                Some(ladder.hull.get_or_init(|| {
                    let (hull, receipt) = receipted(|| self.simplified(points));
                    Arc::new(StandIn { receipt, ..hull })
                }))
            }
            Representation::Decomposition | Representation::Exact => None,
        }
    }

    /// The rungs that questions have needed so far, from coarse to fine.
    pub fn stand_ins_built(&self) -> impl Iterator<Item = &StandIn> {
        self.ladder().into_iter().flat_map(Ladder::built)
    }

    /// Whether anything may stand in for it.
    #[must_use]
    pub(crate) fn has_stand_ins(&self) -> bool {
        self.ladder().is_some()
    }

    fn ladder(&self) -> Option<&Ladder> {
        match self.form() {
            Form::Mesh(mesh) => Some(mesh.ladder()),
            Form::Compound(compound) => Some(compound.ladder()),
            Form::Convex(Convex { core: Core::Hull(hull), .. }) => hull.ladder(),
            Form::Convex(_) | Form::HeightField(_) | Form::HalfSpace(_) => None,
        }
    }

    /// The points whose hull it lies in, if it has many; a radius around them aside.
    fn hull_points(&self) -> Option<&[DVec3]> {
        match self.form() {
            Form::Mesh(mesh) => Some(mesh.vertices()),
            Form::Convex(Convex { core: Core::Hull(hull), .. }) => Some(hull.vertices()),
            Form::Convex(_) | Form::HalfSpace(_) | Form::HeightField(_) | Form::Compound(_) => None,
        }
    }

    fn simplified(&self, points: &[DVec3]) -> StandIn {
        let Simplified { hull, outside, inside } = Hull::spanned_by(points, SIMPLIFIED_VERTICES);
        let inside = match self.form() {
            Form::Convex(_) => inside,
            _ => beyond::beyond_landmarks(&volumes::faces(&hull), &landmarks::of(self), self.reach()),
        };
        StandIn {
            representation: Representation::SimplifiedHull,
            convex: Convex { core: Core::Hull(Arc::new(hull)), radius: 0.0 },
            center: DVec3::ZERO,
            outside,
            inside,
            receipt: Receipt::default(),
        }
    }
}
