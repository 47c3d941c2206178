//! What does a ray hit?

use glam::DVec3;

use super::{
    Filter, Found, HitMode, Meter, QuestionError, ShapeId, Snapshot, Subject,
    filter::Sieve,
    hits::{Gathered, Hit, raise},
    notes::Note,
    search::Side,
};
use crate::{
    accuracy::Accuracy,
    answer::Certificate,
    broad::{Line, Path},
    math::{Aabb, Norm},
    narrow::{self, Aim, Ray, RayTouch},
    tolerance,
};

/// What does a ray hit?
#[derive(Clone, Debug)]
pub struct Raycast {
    /// The ray.
    pub ray: Ray,
    /// Which hits to return.
    pub mode: HitMode,
}

/// Where a ray hits a shape.
#[derive(Clone, Debug)]
pub struct RayHit {
    /// The shape; `None` if it is a geometry given in `against`.
    pub id: Option<ShapeId>,
    /// The shape's.
    pub user_data: u64,
    /// It blocks nothing: see [`HitMode::Pierce`].
    pub pierced: bool,
    /// Where, and what that is worth.
    pub touch: RayTouch,
}

impl Hit for RayHit {
    fn value(&self) -> f64 {
        self.touch.distance
    }

    fn id(&self) -> Option<ShapeId> {
        self.id
    }

    fn certificate(&self) -> &Certificate {
        &self.touch.certificate
    }

    fn certificate_mut(&mut self) -> &mut Certificate {
        &mut self.touch.certificate
    }

    fn is_pierced(&self) -> bool {
        self.pierced
    }
}

/// A ray as a path of the trees, which count multiples of the direction where the ray counts metres.
pub(super) struct Track {
    pub(super) line: Line,
    /// Length of the path's direction.
    length: f64,
}

impl Track {
    pub(super) fn new(ray: &Ray) -> Self {
        let direction = ray.direction * power_of_two_towards_one(ray.direction.abs().max_element());
        let path = Path { origin: ray.origin, direction, reach: DVec3::ZERO };
        Self { line: Line::new(&path), length: direction.norm() }
    }

    /// The `t` of a distance, so much too large that no box is lost by it.
    pub(super) fn limit(&self, distance: f64) -> f64 {
        distance / self.length * tolerance::LIMIT_WIDENING
    }

    /// Metres before which the ray does not enter the box of a shape; `None` if it does not up to `limit`.
    fn entry(&self, bounds: Aabb, limit: f64) -> Option<f64> {
        let t = self.line.entry(&bounds, self.limit(limit))?;
        let distance = t * self.length * tolerance::SLAB_NARROWING;
        (distance <= limit).then_some(distance)
    }
}

/// What brings a number to where its square neither overflows nor vanishes, without changing a digit of it.
fn power_of_two_towards_one(value: f64) -> f64 {
    if value > f64::powi(2.0, 400) {
        f64::powi(2.0, -800)
    } else if value < f64::powi(2.0, -400) {
        f64::powi(2.0, 800)
    } else {
        1.0
    }
}

impl Raycast {
    /// What the ray hits of one side, which it does not enter before `least` metres.
    #[inline]
    fn look(
        &self,
        aim: &Aim,
        other: &Side<'_>,
        least: f64,
        accuracy: &Accuracy,
        meter: &mut Meter<'_>,
        gathered: &mut Gathered<RayHit>,
    ) {
        let touches = narrow::raycast_of(
            aim,
            (other.placed.geometry, &other.placed.pose),
            other.simple,
            accuracy,
            &mut meter.work,
        );
        meter.note(|| {
            let first = touches.certain.or(touches.undecided);
            Note::of_ray(&self.ray, other, first.map(|touch| touch.certificate), accuracy)
        });
        let hit = |mut touch: RayTouch| {
            raise(&mut touch.distance, &mut touch.certificate, least);
            RayHit { id: other.id(), user_data: other.user_data(), pierced: self.mode.pierces(other), touch }
        };
        // Most shapes are missed, and what is moved is large.
        if touches.certain.is_some() || touches.undecided.is_some() {
            gathered.add(touches.certain.map(hit), touches.undecided.map(hit));
        }
    }
}

/// A ray on its way through a world, and what it has hit so far.
pub(super) struct Cast<'a> {
    question: &'a Raycast,
    aim: Aim<'a>,
    gathered: Gathered<RayHit>,
}

impl<'a> Cast<'a> {
    pub(super) fn new(question: &'a Raycast) -> Self {
        Self { question, aim: Aim::new(&question.ray), gathered: Gathered::new(question.mode) }
    }

    /// What it hits of one side, if it may; where it ends then, as the trees count.
    #[inline]
    pub(super) fn meet(
        &mut self,
        track: &Track,
        other: &Side<'_>,
        sieve: &Sieve<'_>,
        accuracy: &Accuracy,
        meter: &mut Meter<'_>,
    ) -> Result<f64, QuestionError> {
        let limit = self.gathered.limit().min(self.question.ray.max_distance);
        if let Some(least) = track.entry(other.bounds, limit)
            && sieve.passes(other)
        {
            meter.look()?;
            self.question.look(&self.aim, other, least, accuracy, meter, &mut self.gathered);
        }
        Ok(track.limit(self.gathered.limit()))
    }

    /// What it hit.
    pub(super) fn finish(self) -> Found<RayHit> {
        self.gathered.finish()
    }
}

impl Snapshot {
    /// What a ray hits of one shape or geometry alone, whatever a filter would say of it.
    ///
    /// # Errors
    /// A shape that is not there, [`QuestionError::Interrupted`].
    pub fn raycast_against(
        &self,
        question: &Raycast,
        against: &Subject,
        accuracy: &Accuracy,
        meter: &mut Meter<'_>,
    ) -> Result<Found<RayHit>, QuestionError> {
        let _asking = self.asking().now();
        let mut gathered = Gathered::new(question.mode);
        let other = self.other(against)?;
        if let Some(least) = Track::new(&question.ray).entry(other.bounds, question.ray.max_distance) {
            meter.look()?;
            question.look(&Aim::new(&question.ray), &other, least, accuracy, meter, &mut gathered);
        }
        Ok(gathered.finish())
    }

    /// What a ray hits.
    ///
    /// # Errors
    /// [`QuestionError::Interrupted`].
    pub fn raycast(
        &self,
        question: &Raycast,
        filter: &Filter,
        accuracy: &Accuracy,
        meter: &mut Meter<'_>,
    ) -> Result<Found<RayHit>, QuestionError> {
        self.cast(question, &Sieve::new(filter, None), accuracy, meter)
    }

    /// What a ray hits of what a sieve lets through.
    pub(super) fn cast(
        &self,
        question: &Raycast,
        sieve: &Sieve<'_>,
        accuracy: &Accuracy,
        meter: &mut Meter<'_>,
    ) -> Result<Found<RayHit>, QuestionError> {
        let _asking = self.asking().now();
        let (track, mut cast) = (Track::new(&question.ray), Cast::new(question));
        self.along(&track.line, track.limit(question.ray.max_distance), sieve.layers_seen(), meter, |meter, other| {
            cast.meet(&track, &other, sieve, accuracy, meter)
        })?;
        Ok(cast.finish())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        answer::Work,
        broad::{ALL_LAYERS, StaticTree, Tree},
        narrow::Faces,
    };

    /// The lower bound of a box, taken as the limit of a search, must not exclude the box from the search.
    #[test]
    fn what_ends_at_the_limit_is_still_offered() {
        let mut state = 1_u64;
        let mut number = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        for _ in 0..10_000 {
            let corner = DVec3::new(number(), number(), number()) * 10.0 + 1.0;
            let direction = corner + DVec3::new(number(), number(), number());
            let bounds = Aabb::new(corner, corner + 1.0);
            let track = Track::new(&Ray {
                origin: DVec3::ZERO,
                direction: direction * f64::powi(2.0, (number() * 1000.0) as i32 - 500),
                min_distance: 0.0,
                max_distance: 4e12,
                hollow: false,
                faces: Faces::Both,
            });
            let least = track.entry(bounds, 4e12).expect("it goes through");
            let mut offered = false;
            let tree = StaticTree::build(&[bounds]);
            let Ok(()) = tree.visit_ray(&track.line, track.limit(least), ALL_LAYERS, &mut Work::default(), |_, _| {
                offered = true;
                Ok(f64::INFINITY)
            });
            assert!(offered, "{bounds:?} begins at {least}");
            assert!(least <= corner.length() + 2.0 && least > 0.0);
        }
    }
}
