//! Convex parts of a mesh, with a proof of how far parts and mesh are apart.
//!
//! # Method
//! The mesh begins as one part: its hull. The part that reaches farthest beyond the mesh is cut in two by a plane (`cut.rs`), again
//! and again; two parts that are near enough to the mesh become one where their common hull is as well. It ends when all parts
//! are near enough, or there would be too many.
//!
//! ```text
//!   +----+ . . .          +----+             +----+
//!   |    |      .         |    |             |    |
//!   |    |       .        |    |             |    |      two parts that
//!   |    +--------+       |    +--------+    |    |---------+   are exact
//!   |             |       |    |        |    |    |         |
//!   +-------------+       +----+--------+    +----+---------+
//!    one part, far         cut along the
//!    from the mesh         bottom of the hollow
//! ```
//!
//! The parts cover surface and volume by construction (`piece.rs`). How far they reach beyond is a maximum by branch and bound
//! (`farthest.rs`), not a sample.
//!
//! # Source
//! Ours, after Mamou, "Volumetric hierarchical approximate convex decomposition" (2016), and Wei, Liu, Ling, Su,
//! "Approximate convex decomposition for 3D meshes with collision-aware concavity and tree search" (2022): best planes and merging
//! are theirs; it works on triangles, not on voxels, and each decision is by the certified error itself.
//!
//! # Limits
//! Greedy: not the fewest parts. The parts of an open mesh are near its surface, not its would-be inside. Nothing here is random.

mod beyond_mesh;
mod beyond_parts;
mod cell;
mod cut;
mod farthest;
mod grow;
mod join;
mod meter;
mod piece;
mod split;

use std::ops::ControlFlow;

use self::{
    beyond_mesh::Subject,
    beyond_parts::Parts,
    cell::{Simplex, simplices},
    farthest::{Goal, farthest},
    grow::Growth,
    meter::Meter,
};
use crate::{
    answer::{Bound, Stop},
    shape::{Convex, Core, Fineness, Form, Geometry, GeometryError, Mesh, MeshParts, PartsAsked, Receipt, receipted},
    tolerance::CUT_OUTSIDE,
};

/// What is asked of a decomposition.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// At most this many parts; 0 means 32.
    pub max_parts: u32,
    /// Parts need not be nearer to the mesh than this, metres; 0 (or less, or NaN) means 1 % of the diagonal of its box. Less
    /// than 2⁻²⁴ of that, or than 2⁻⁴² of its farthest coordinate, counts as that.
    pub max_error: f64,
    /// At most about this many steps: nodes of trees, simplices, triangles and points looked at, some 100 ns each. What is not
    /// finished by then is left out; the errors hold all the same.
    pub budget: u64,
}

impl Options {
    /// Steps where nothing is said: minutes.
    pub const BUDGET_USUAL: u64 = PartsAsked::STEPS_USUAL;

    /// Parts at most that are made for a question.
    const PARTS_FOR_QUESTIONS: u32 = 256;

    /// What is asked of the parts that questions of some fineness need of a mesh.
    #[must_use]
    pub fn for_questions(mesh: &Mesh, step: Fineness) -> Self {
        Self { max_parts: Self::PARTS_FOR_QUESTIONS, max_error: step.max_error(mesh), ..Self::default() }
    }
}

impl Default for Options {
    fn default() -> Self {
        Self { max_parts: 0, max_error: 0.0, budget: Self::BUDGET_USUAL }
    }
}

/// How a decomposition stands, as its caller is told every few thousand steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress {
    /// Parts so far.
    pub part_count: u32,
    /// Those of them that are near enough to the mesh.
    pub done_count: u32,
    /// How many there may be.
    pub max_parts: u32,
    /// How far parts reach beyond the mesh at most, metres, as far as that is known.
    pub inside_upper: f64,
    /// Steps so far.
    pub steps: u64,
    /// How many there may be.
    pub max_steps: u64,
}

/// The caller's function said to stop.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the decomposition was called off")]
pub struct Cancelled;

/// How far parts and mesh are apart at most, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Errors {
    /// The greatest distance of a point of the mesh from the nearest part.
    pub outside: Bound,
    /// The greatest distance of a point of a part from the mesh: from the solid if it is closed, else from the surface.
    pub inside: Bound,
}

/// A convex part.
#[derive(Clone, Debug)]
pub struct Part {
    /// A hull, in the mesh's frame, whose points are its corners.
    pub geometry: Geometry,
    /// Cubic metres, to within rounding; 0 if it is flat.
    pub volume: f64,
    /// How far it reaches beyond the mesh at most, metres.
    pub inside: Bound,
}

/// The convex parts of a mesh.
#[derive(Clone, Debug)]
pub struct Decomposition {
    /// At least one.
    pub parts: Vec<Part>,
    /// What they are worth. Of a closed mesh `outside` holds for all of the solid.
    pub errors: Errors,
    /// The volumes of the parts beyond that of the mesh, as a part of it; below 0 only for meshes that run through themselves.
    /// `None` for meshes that are not closed, or that enclose nothing.
    pub volume_excess: Option<f64>,
    /// `Tolerance` if all parts are within `max_error`, `Budget` if the number of parts or steps ended it, `Converged` if no cut
    /// brings more.
    pub stop: Stop,
    /// Steps it took.
    pub steps: u64,
    /// What it took otherwise, and when it was asked for.
    pub receipt: Receipt,
}

/// Cuts a mesh into convex parts. The same mesh and options give the same parts, bit by bit; a larger `max_parts` goes on
/// where a smaller one ended, so it never has parts farther from the mesh, beyond `max_error`.
///
/// `progress` is called every few thousand steps and may call it off. It is not quick: a few thousand triangles to 1 % take about a
/// second.
///
/// # Errors
/// [`Cancelled`] if `progress` said so.
///
/// ```
/// use std::ops::ControlFlow;
/// use collision::{DVec3, decompose::{Options, decompose}, shape::{Form, Geometry}};
/// let corners = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
/// let geometry = Geometry::mesh(&corners, &[[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]).unwrap();
/// let Form::Mesh(mesh) = geometry.form() else { panic!("a mesh") };
/// let found = decompose(mesh, &Options::default(), &mut |_| ControlFlow::Continue(())).unwrap();
/// assert_eq!(found.parts.len(), 1);
/// assert!(found.errors.inside.upper < 1e-9 && found.errors.outside.upper == 0.0);
/// assert!(found.volume_excess.unwrap().abs() < 1e-12);
/// ```
pub fn decompose(
    mesh: &Mesh,
    options: &Options,
    progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
) -> Result<Decomposition, Cancelled> {
    let (made, receipt) = receipted(|| cut(mesh, options, progress));
    made.map(|made| Decomposition { receipt, ..made })
}

fn cut(
    mesh: &Mesh,
    options: &Options,
    progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
) -> Result<Decomposition, Cancelled> {
    let subject = Subject::new(mesh);
    let growth = Growth::new(&subject, options, progress).run()?;
    let parts: Vec<Part> = growth.parts.iter().map(|part| part.finished()).collect();
    let volume = mesh.volume().map(f64::abs).filter(|&volume| volume > 0.0);
    let inside = parts.iter().map(|part| part.inside);
    Ok(Decomposition {
        errors: Errors {
            outside: Bound::new(0.0, growth.cut_count as f64 * CUT_OUTSIDE * subject.farthest),
            inside: inside
                .reduce(|a, b| Bound::new(a.lower.max(b.lower), a.upper.max(b.upper)))
                .unwrap_or(Bound::UNBOUNDED),
        },
        volume_excess: volume.map(|volume| parts.iter().map(|part| part.volume).sum::<f64>() / volume - 1.0),
        parts,
        stop: growth.stop,
        steps: growth.meter.work.steps(),
        receipt: Receipt::default(),
    })
}

/// Makes the parts of a mesh that questions of some fineness need, and has the mesh keep them; nothing if it does already.
///
/// # Errors
/// [`Cancelled`] if `progress` said so.
pub fn furnish(
    mesh: &Mesh,
    step: Fineness,
    progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
) -> Result<(), Cancelled> {
    if mesh.made_parts(step).is_some() {
        return Ok(());
    }
    let options = Options::for_questions(mesh, step);
    let made = decompose(mesh, &options, progress)?;
    let parts = made.into_parts(&options).expect("there is a part, and not too many for a compound");
    mesh.keep_parts(step, parts);
    Ok(())
}

impl Options {
    /// What is asked of the parts, with the usual number where none is said.
    #[must_use]
    pub fn asked(&self) -> PartsAsked {
        PartsAsked {
            max_parts: grow::parts_most(self.max_parts),
            max_error: self.max_error.max(0.0),
            max_steps: self.budget,
        }
    }
}

impl Decomposition {
    /// The mesh with these parts, which were made of it as `options` ask.
    ///
    /// # Errors
    /// `geometry` is no mesh.
    pub fn attached(self, geometry: &Geometry, options: &Options) -> Result<Geometry, GeometryError> {
        geometry.with_parts(self.into_parts(options)?)
    }

    fn into_parts(self, options: &Options) -> Result<MeshParts, GeometryError> {
        let part_count = u32::try_from(self.parts.len()).unwrap_or(u32::MAX);
        Ok(MeshParts {
            asked: options.asked(),
            whole: Geometry::of_hulls(self.parts.into_iter().map(|part| part.geometry))?,
            part_count,
            outside: self.errors.outside,
            inside: self.errors.inside,
            volume_excess: self.volume_excess,
            stop: self.stop,
            steps: self.steps,
            receipt: self.receipt,
        })
    }
}

/// How far convex parts from elsewhere and a mesh are apart at most: to within `width` metres or a sixteenth, or as far as `budget` steps
/// go. `outside` is that of the surface only.
///
/// # Errors
/// [`Cancelled`] if `progress` said so.
///
/// # Panics
/// If there are no parts, or one is no hull.
pub fn measure(
    mesh: &Mesh,
    parts: &[Geometry],
    width: f64,
    budget: u64,
    progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
) -> Result<Errors, Cancelled> {
    let subject = Subject::new(mesh);
    let count = u32::try_from(parts.len()).unwrap_or(u32::MAX);
    let state = Progress {
        part_count: count,
        done_count: 0,
        max_parts: count,
        inside_upper: f64::INFINITY,
        steps: 0,
        max_steps: budget,
    };
    let meter = &mut Meter::new(budget, state, progress);
    let goal = Goal { enough: width, share: SHARE, hopeless: f64::INFINITY };
    let hulls = parts.iter().filter_map(|part| match part.form() {
        Form::Convex(Convex { core: Core::Hull(hull), .. }) => Some(hull),
        Form::Convex(_) | Form::Mesh(_) | Form::HeightField(_) | Form::HalfSpace(_) | Form::Compound(_) => None,
    });
    assert!(!parts.is_empty() && hulls.clone().count() == parts.len(), "at least one part, and hulls only");
    let known = hulls.clone().map(|hull| subject.surely_within(hull.vertices())).fold(0.0, f64::max);
    if !subject.is_measurable() {
        return Ok(Errors { outside: Bound::new(0.0, f64::INFINITY), inside: Bound::new(0.0, known) });
    }
    let inside = farthest(&subject, hulls.flat_map(|hull| simplices(hull)), known, goal, meter)?.bound;
    let field = Parts::new(parts);
    let triangles = (0..mesh.triangles().len()).map(|index| Simplex::of(&mesh.corners(index)));
    let outside = farthest(&field, triangles, f64::INFINITY, goal, meter)?.bound;
    Ok(Errors { outside, inside })
}

/// To which part of itself an error is known where it is beyond what was asked.
const SHARE: f64 = 1.0 / 16.0;
