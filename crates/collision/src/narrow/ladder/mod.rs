//! Questions that are content with less than the geometry: rung by rung, until an interval is narrow enough.
//!
//! # Method
//! Each form of a pair is replaced by what stands in for it on a rung, or stays itself where that is as cheap; the kernel for
//! two convex forms is asked, and its interval is widened by what the stand-ins may be off by. If that is as narrow as was
//! asked, or proves the verdict, it is the answer; else the next rung is asked, and at last the geometries themselves.
//!
//! | value | interval | proof |
//! |---|---|---|
//! | distance | `[d − Σout, d + Σin]`, the upper side where `d > 0` or both forms are convex | |
//! | overlap, one form concave | | `Miss` if `d > Σout` |
//! | first touch, one form concave | | none if stand-ins grown by `out` never touch |
//! | first touch, both concave | from that of stand-ins grown by `out` to a time at which the geometries overlap | |
//!
//! A concave geometry may have hollows, so what overlaps its stand-in may not touch it: no stand-in proves a
//! `Hit`. Convex forms tell whether they touch sooner than their stand-ins do.
//!
//! # Limits
//! Only a question that names an error may be answered so: see [`Accuracy::may_stand_in`]. Which rung answers follows from the
//! pair and the question, never from what is built. Rays are asked of the geometry, and so are depths: of large hulls a simplified one
//! was good enough for one in two to a tenth, and asking it first took a fifth more on the whole, measured with hulls of animals and
//! with coins.

mod distance;
mod impact;
mod overlap;

use std::borrow::Cow;

use glam::DVec3;

pub use self::distance::distance_on;
pub(super) use self::{distance::distance, impact::impact, overlap::overlap};
use super::{Placed, convex::PlacedConvex, place::Place};
use crate::{
    accuracy::Accuracy,
    answer::{Bound, Certificate, Model, Representation},
    math::{Norm, Pose},
    shape::{Convex, Form, MeshParts},
};

/// What came of climbing.
pub(super) enum Climb<T> {
    /// A rung was good enough.
    Answered(T),
    /// None is: the geometries themselves are to be asked.
    ToTheTop,
}

/// Of what reaches so far a rung is seldom nearer than this part of it: with less to spare, none is tried. Measured.
const WORTH_TRYING: f64 = 1.0 / 256.0;

/// Rungs that may prove that nothing is touched. A ball proves less than the boxes that every pair is judged by first.
const RUNGS_OF_TOUCH: [Representation; 2] = [Representation::OrientedBox, Representation::SimplifiedHull];

/// A box is slim if, turned as it is, it fills no more than one part in so many of the one along the axes that holds it: fewer than any
/// cube does, however it is turned.
const SLIM: f64 = 6.0;

/// A pair on a rung.
struct Stage<'a> {
    a: Side<'a>,
    b: Side<'a>,
    model: Model,
    /// Both geometries are.
    are_convex: bool,
}

/// One form of it.
struct Side<'a> {
    convex: Cow<'a, Convex>,
    place: Place,
    representation: Representation,
    outside: f64,
    inside: f64,
}

impl<'a> Side<'a> {
    /// What stands in for a form, or itself; `None` if it is not convex and nothing does.
    fn on(placed: &'a Placed<'a>, representation: Representation) -> Option<Self> {
        let coarser = || placed.geometry.stand_in(Representation::OrientedBox);
        let place = Place::of(placed.pose);
        let own = match placed.geometry.form() {
            Form::Convex(convex) => Some(convex),
            Form::Mesh(_) | Form::Compound(_) | Form::HeightField(_) | Form::HalfSpace(_) => None,
        };
        match placed.geometry.stand_in(representation).or_else(coarser) {
            Some(stand_in) => {
                let convex = stand_in.convex(own.map_or(0.0, |convex| convex.radius));
                Some(Self {
                    place: place.of_part(&Pose::at(stand_in.center()), convex.reach()),
                    convex,
                    representation: stand_in.representation(),
                    outside: stand_in.outside(),
                    inside: stand_in.inside(),
                })
            }
            None => own.map(|convex| Self {
                convex: Cow::Borrowed(convex),
                place,
                representation: Representation::Exact,
                outside: 0.0,
                inside: 0.0,
            }),
        }
    }

    fn placed(&self) -> PlacedConvex<'_> {
        PlacedConvex { convex: &self.convex, pose: &self.place.pose, blur: self.place.blur }
    }
}

impl<'a> Stage<'a> {
    /// The pair on a rung; `None` if there is no such stage, or it is the one before.
    fn on(a: &'a Placed<'a>, b: &'a Placed<'a>, representation: Representation) -> Option<Self> {
        let (side_a, side_b) = (Side::on(a, representation)?, Side::on(b, representation)?);
        let coarser = side_a.representation.min(side_b.representation);
        let is_new = [&side_a, &side_b].iter().any(|side| side.representation == representation);
        let outside = sum_up(side_a.outside, side_b.outside);
        let inside = sum_up(side_a.inside, side_b.inside);
        is_new.then(|| Self {
            model: Model { representation: coarser, outside, inside },
            are_convex: is_convex(a) && is_convex(b),
            a: side_a,
            b: side_b,
        })
    }

    /// What bounds of the distance of the stand-ins say of that of the geometries. Of concave ones that may touch they say nothing
    /// from above.
    fn widened(&self, found: Bound) -> Bound {
        let bound = self.model.widened(found);
        if found.lower > 0.0 || self.are_convex { bound } else { Bound { upper: f64::INFINITY, ..bound } }
    }

    fn certificate(&self, found: Certificate) -> Certificate {
        Certificate { model: self.model, ..found }
    }
}

/// A pair of which convex parts stand in for the meshes that bring some along.
struct ByParts<'a> {
    a: Placed<'a>,
    b: Placed<'a>,
    model: Model,
}

impl<'a> ByParts<'a> {
    /// `None` if neither brings parts.
    fn of(a: &Placed<'a>, b: &Placed<'a>) -> Option<Self> {
        let parts = [a, b].map(|placed| placed.geometry.parts());
        if parts.iter().all(Option::is_none) {
            return None;
        }
        let whole = |placed: &Placed<'a>, parts: Option<&'a MeshParts>| {
            parts.map_or(*placed, |parts| Placed { geometry: &parts.whole, ..*placed })
        };
        let errors = |parts: Option<&MeshParts>| parts.map_or([0.0; 2], |it| [it.outside.upper, it.inside.upper]);
        let ([out_a, in_a], [out_b, in_b]) = (errors(parts[0]), errors(parts[1]));
        let (outside, inside) = (sum_up(out_a, out_b), sum_up(in_a, in_b));
        let model = Model { representation: Representation::Decomposition, outside, inside };
        Some(Self { a: whole(a, parts[0]), b: whole(b, parts[1]), model })
    }

    /// As that of a stage. Of a closed mesh the parts' errors are those of the solid: only where the solids are apart are they as
    /// far apart as their surfaces.
    fn widened(&self, found: Bound) -> Bound {
        let bound = self.model.widened(found);
        if bound.lower > 0.0 { bound } else { Bound { upper: f64::INFINITY, ..bound } }
    }
}

impl Model {
    fn widened(&self, found: Bound) -> Bound {
        Bound { lower: difference_down(found.lower, self.outside), upper: sum_up(found.upper, self.inside) }
    }

    /// How far apart stand-ins are at least whose geometries are farther apart than `limit`.
    fn beyond(&self, limit: f64) -> f64 {
        sum_up(limit, self.outside)
    }

    /// The accuracy that is left for the kernel.
    fn left_of(&self, accuracy: &Accuracy) -> Accuracy {
        Accuracy {
            max_error: (accuracy.max_error - self.outside - self.inside).max(0.0),
            max_error_relative: accuracy.max_error_relative * 0.5,
            ..*accuracy
        }
    }
}

/// Whether a pair may be answered from a rung at all.
fn is_tried(a: &Placed<'_>, b: &Placed<'_>, accuracy: &Accuracy) -> bool {
    let stands = |placed: &Placed<'_>| placed.geometry.has_stand_ins();
    accuracy.may_stand_in() && (stands(a) || stands(b))
}

/// Whether what may be spent on a value of the pair, metres, leaves room for stand-ins.
fn is_worth_trying(a: &Placed<'_>, b: &Placed<'_>, allowed: f64) -> bool {
    let of_ladder = |placed: &Placed<'_>| if placed.geometry.has_stand_ins() { placed.geometry.reach() } else { 0.0 };
    allowed >= of_ladder(a).max(of_ladder(b)) * WORTH_TRYING
}

/// Which rungs are asked whether a pair touches. Of two concave forms both: they are dear. Whether a convex form touches a concave one, few
/// triangles tell as cheaply as stand-ins do, of which one in five proves anything, measured in halls and fields of rocks: it is the
/// box, and that where the one along the axes, which every pair is judged by first, says much less. Of two convex forms none.
fn rungs_of_touch(a: &Placed<'_>, b: &Placed<'_>) -> &'static [Representation] {
    match [is_convex(a), is_convex(b)] {
        [false, false] => &RUNGS_OF_TOUCH,
        [true, false] if has_slim_box(b) => &RUNGS_OF_TOUCH[..1],
        [false, true] if has_slim_box(a) => &RUNGS_OF_TOUCH[..1],
        _ => &[],
    }
}

/// Decides what is asked, proves nothing.
fn has_slim_box(placed: &Placed<'_>) -> bool {
    let bounds = placed.geometry.local_bounds();
    let own = bounds.max - bounds.min;
    let matrix = placed.pose.matrix();
    let along_axes = matrix.x_axis.abs() * own.x + matrix.y_axis.abs() * own.y + matrix.z_axis.abs() * own.z;
    along_axes.x * along_axes.y * along_axes.z > SLIM * (own.x * own.y * own.z)
}

/// The two are no farther apart than this, to within rounding. Tells what is not worth asking, proves
/// nothing.
fn farthest(a: &Placed<'_>, b: &Placed<'_>) -> f64 {
    (a.pose.position - b.pose.position).norm() + a.geometry.reach() + b.geometry.reach()
}

/// The same as the balls tell it, and how far apart these are; both 0 if they overlap.
fn farthest_by_balls(a: &Placed<'_>, b: &Placed<'_>) -> [f64; 2] {
    let [one, other] = [a, b].map(|placed| match placed.geometry.stand_in(Representation::Ball) {
        Some(ball) => (placed.pose.matrix() * ball.center(), ball.convex(0.0).radius, ball.inside()),
        None => (DVec3::ZERO, placed.geometry.reach(), 2.0 * placed.geometry.reach()),
    });
    let way = (a.pose.position - b.pose.position) + (one.0 - other.0);
    let gap = way.norm() - one.1 - other.1;
    if gap > 0.0 { [gap, gap + one.2 + other.2] } else { [0.0, f64::INFINITY] }
}

fn is_convex(placed: &Placed<'_>) -> bool {
    matches!(placed.geometry.form(), Form::Convex(_))
}

/// Rounded up; exact if one is 0.
fn sum_up(a: f64, b: f64) -> f64 {
    if a == 0.0 || b == 0.0 { a + b } else { (a + b).next_up() }
}

/// Rounded down; exact if nothing is taken away.
fn difference_down(a: f64, b: f64) -> f64 {
    if b == 0.0 { a } else { (a - b).next_down() }
}
