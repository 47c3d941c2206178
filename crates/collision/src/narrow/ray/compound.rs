//! Rays against compounds: the first of what the ray touches of the parts.
//!
//! # Method
//! The tree over the parts offers those whose boxes the ray meets, nearest first. Each part answers by its own formula, where
//! it is to within its blur; certain touches bound, open ones only widen.

use std::convert::Infallible;

use smallvec::SmallVec;

use super::{
    Aim, Ray, RayTouch, RayTouches,
    frame::{LocalRay, Spot, Target},
    height_field, mesh, touches as touches_of_convex,
};
use crate::{
    accuracy::Accuracy,
    answer::{Bound, Verdict, Work},
    broad::{ALL_LAYERS, Line, Tree},
    math::{Norm, Pose, exact::exact_difference},
    narrow::place::Place,
    shape::{Compound, Form, Geometry},
    tolerance::LENGTH_WIDENING,
};

/// What a ray touches of a compound.
pub(super) fn touches(
    ray: &Ray,
    (compound, geometry): (&Compound, &Geometry),
    pose: &Pose,
    accuracy: &Accuracy,
    work: &mut Work,
) -> RayTouches {
    // Seen from where the compound is; what the ray's origin loses by that counts as if the compound were not just there.
    let (origin, lost) = exact_difference(ray.origin, pose.position);
    let at_home = Place::seen_from(pose, pose.position);
    let place = Place { blur: lost.norm() * LENGTH_WIDENING, ..at_home };
    let ray = Ray { origin, ..*ray };
    let cast = Cast { aim: Aim::new(&ray), accuracy };
    let mut found = Found { certain: SmallVec::new(), undecided: SmallVec::new(), limit: f64::INFINITY };
    cast.search((compound, geometry), &place, 0, &mut found, work);
    let in_world = |touch: RayTouch| RayTouch { point: touch.point + pose.position, ..touch };
    let RayTouches { certain, undecided } = found.merged();
    RayTouches { certain: certain.map(in_world), undecided: undecided.map(in_world) }
}

/// What is asked of each part.
struct Cast<'a> {
    aim: Aim<'a>,
    accuracy: &'a Accuracy,
}

impl Cast<'_> {
    /// Asks the parts of a compound, whose first leaf has this number.
    fn search(
        &self,
        (compound, geometry): (&Compound, &Geometry),
        place: &Place,
        first_leaf: u32,
        found: &mut Found,
        work: &mut Work,
    ) {
        let center = Target::about_center(geometry, place.blur);
        let local = LocalRay::new(&self.aim, &place.pose, center);
        let Some(stretch) = local.stretch(center.radius) else {
            return;
        };
        let length = stretch.length.min(stretch.limit(found.limit));
        let Ok(()) = compound.tree().visit_ray(&Line::new(&stretch.path), length, ALL_LAYERS, work, |work, leaf| {
            let part = &compound.parts()[leaf as usize];
            let place = place.of_part(&part.pose, part.geometry.reach());
            let spot = Spot { pose: &place.pose, blur: place.blur };
            let number = first_leaf + compound.first_leaf(leaf as usize);
            match part.geometry.form() {
                Form::Compound(inner) => self.search((inner, &part.geometry), &place, number, found, work),
                Form::HeightField(field) => {
                    found.offer(height_field::touches(&self.aim, (field, &part.geometry), spot, work), number);
                }
                Form::Mesh(mesh) => {
                    found.offer(mesh::touches(&self.aim, (mesh.as_ref(), &part.geometry), spot, work), number);
                }
                Form::Convex(convex) => {
                    let touches = touches_of_convex(&self.aim, (convex, &part.geometry), spot, self.accuracy, work);
                    found.offer(touches, number);
                }
                Form::HalfSpace(_) => unreachable!("a compound has no half space for a part"),
            }
            Ok::<f64, Infallible>(stretch.limit(found.limit))
        });
    }
}

/// All that may be the first touch.
struct Found {
    certain: SmallVec<[RayTouch; 4]>,
    undecided: SmallVec<[RayTouch; 4]>,
    /// A certain touch is not farther than this.
    limit: f64,
}

impl Found {
    fn offer(&mut self, touches: RayTouches, part: u32) {
        let of_part = |mut touch: RayTouch| {
            touch.feature.part = Some(part);
            touch
        };
        if let Some(touch) = touches.certain.map(of_part) {
            self.limit = self.limit.min(touch.certificate.bound.upper);
            self.certain.push(touch);
        }
        self.undecided.extend(touches.undecided.map(of_part));
        let limit = self.limit;
        for list in [&mut self.certain, &mut self.undecided] {
            list.retain(|touch| touch.certificate.bound.lower <= limit);
        }
    }

    fn merged(&self) -> RayTouches {
        RayTouches { certain: first_of(&self.certain), undecided: first_of(&self.undecided) }
    }
}

/// The first by its best value; where others cannot be told from it, that of the least part.
fn first_of(touches: &[RayTouch]) -> Option<RayTouch> {
    let first =
        touches.iter().min_by(|a, b| a.distance.total_cmp(&b.distance).then_with(|| a.feature.cmp(&b.feature)))?;
    let is_same = |other: &&RayTouch| {
        other.certificate.bound.contains(first.distance) && first.certificate.bound.contains(other.distance)
    };
    let mut winner = *touches.iter().filter(is_same).min_by_key(|touch| touch.feature)?;
    let lower = touches.iter().map(|touch| touch.certificate.bound.lower).fold(f64::INFINITY, f64::min);
    let uppers = touches.iter().map(|touch| touch.certificate.bound.upper);
    let upper = match winner.certificate.verdict {
        Verdict::Hit => uppers.fold(f64::INFINITY, f64::min),
        Verdict::Undecided | Verdict::Miss => uppers.fold(f64::NEG_INFINITY, f64::max),
    };
    winner.certificate.bound = Bound::new(lower, upper);
    winner.distance = winner.distance.clamp(lower, upper);
    Some(winner)
}
