//! What bullets touched on their ways through a tick.
//!
//! # Method
//! All shapes that travelled in the tick move at once: each from its pose in the version before to its pose in this one,
//! position linearly, rotation by constant angular velocity along the shorter arc. What was inserted or teleported in the
//! tick stands where it is in this version, what was removed is not there. A bullet's path asks the trees of this version
//! for what stands, and the boxes of the whole ways of those that travelled. What may be touched is taken in the order of
//! the lower bounds that the boxes prove, so that a bullet through a crowd tests only the shapes of its first touches.
//!
//! # Limits
//! [`BULLET_HITS_MAX`] hits for a bullet and [`SWEEP_HITS_MAX`] for a tick are listed. Beyond [`SWEEP_STEPS_MAX`] steps in a
//! tick, what the boxes do not exclude is listed as undecided without a test. Beyond [`SWEEP_CANDIDATES_MAX`] shapes near
//! the ways in a tick, the bullets that are left, of the highest ids, are not swept, and the report says that it is cut.

use std::ops::ControlFlow;

use glam::DVec3;

use super::{
    Impact, Meter, QuestionError, ShapeId, Snapshot,
    hits::{Best, raise},
    impact::{sweep, turning_bounds},
    pairs::want_each_other,
    search::{Side, outward},
    tracks::Tracks,
};
use crate::{
    accuracy::Accuracy,
    answer::{Bound, Certificate, Feature, Method, Model, Stop, Verdict, Work},
    broad::{ALL_LAYERS, Line, Path, StaticTree, Tree},
    math::{Aabb, Pose},
    narrow::{self, ImpactTouch, InitialTouch, Motion},
};

/// Hits of one bullet that are listed: the first ones.
pub const BULLET_HITS_MAX: usize = 64;

/// Hits of one tick that are listed: those of the bullets with the lowest ids.
pub const SWEEP_HITS_MAX: usize = 1 << 14;

/// Pairs of convex pieces and iterations that the sweeps of one tick may take before the boxes alone must do.
pub const SWEEP_STEPS_MAX: u64 = 1 << 22;

/// Shapes near the ways of all bullets of one tick.
pub const SWEEP_CANDIDATES_MAX: usize = 1 << 20;

/// From so many bullets on, a tree over the ways of the shapes that travelled is built; fewer look at all of them.
const BULLETS_WORTH_A_TREE: usize = 64;

/// What a bullet touched first with one shape, or may have touched.
#[derive(Clone, Debug)]
pub struct SweepHit {
    /// The bullet.
    pub bullet: ShapeId,
    /// The other shape, and when and where; the fraction is that of the tick, and the normal points to the bullet.
    pub impact: Impact,
}

/// What the sweeps of a tick found.
#[derive(Clone, Debug, Default)]
pub struct Swept {
    /// By bullet, then fraction, then the other's id; certain and undecided ones.
    pub hits: Vec<SweepHit>,
    /// A limit cut the list: see [`BULLET_HITS_MAX`], [`SWEEP_HITS_MAX`], [`SWEEP_CANDIDATES_MAX`].
    pub truncated: bool,
    /// What the sweeps cost; nothing in a tick in which no bullet travelled.
    pub work: Work,
}

impl Tracks {
    /// Sweeps what is to be swept between two versions.
    pub(super) fn sweep(&self, old: &Snapshot, new: &Snapshot) -> Swept {
        let bullets = self.swept(old, new);
        if bullets.is_empty() {
            return Swept::default();
        }
        let _asking = new.asking().now();
        let moving: Vec<Moving<'_>> = new
            .changed_since(old)
            .into_iter()
            .filter(|&id| self.travelled(id, old, new))
            .filter_map(|id| Moving::between(old, new, id))
            .collect();
        let ways = (bullets.len() >= BULLETS_WORTH_A_TREE).then(|| {
            let boxes: Vec<Aabb> = moving.iter().map(|moving| moving.way).collect();
            StaticTree::build(&boxes)
        });
        let tick = Traffic { new, moving, ways };
        let mut swept = Swept::default();
        let mut candidates = Vec::new();
        let mut candidate_count = 0;
        for bullet in bullets.iter().filter_map(|&id| Moving::between(old, new, id)) {
            tick.candidates(&bullet, &mut candidates, &mut swept.work);
            candidate_count += candidates.len();
            if candidate_count > SWEEP_CANDIDATES_MAX || swept.hits.len() == SWEEP_HITS_MAX {
                swept.truncated = true;
                return swept;
            }
            tick.take(&bullet, &candidates, &mut swept);
        }
        swept
    }
}

/// A form on its way through the tick.
pub(super) struct Moving<'a> {
    id: ShapeId,
    /// At the start.
    pub(super) side: Side<'a>,
    pub(super) displacement: DVec3,
    pub(super) rotation: DVec3,
    /// Holds it all the time while it turns at the start.
    turning: Aabb,
    /// Holds all of its way.
    pub(super) way: Aabb,
}

impl<'a> Moving<'a> {
    /// `None` if it is not in both.
    fn between(old: &'a Snapshot, new: &'a Snapshot, id: ShapeId) -> Option<Self> {
        let (before, after) = (old.state().get(id)?, new.state().get(id)?);
        Some(Self::travelling(Side::of(before), &after.shape().pose, id))
    }

    /// From where `side` is to the pose `end`.
    pub(super) fn travelling(side: Side<'a>, end: &Pose, id: ShapeId) -> Self {
        let start = side.placed.pose;
        let rotation = start.rotation_vector_to(end);
        let displacement = end.position - start.position;
        let turning = turning_bounds(&side, rotation);
        let there = outward(Aabb::new(turning.min + displacement, turning.max + displacement), 0.0);
        Self { id, side, displacement, rotation, turning, way: turning.union(there) }
    }

    /// Where `side` is.
    pub(super) fn standing(side: Side<'a>, id: ShapeId) -> Self {
        let bounds = side.bounds;
        Self { id, side, displacement: DVec3::ZERO, rotation: DVec3::ZERO, turning: bounds, way: bounds }
    }

    /// Whether it stays where it is.
    pub(super) fn stands(&self) -> bool {
        self.displacement == DVec3::ZERO && self.rotation == DVec3::ZERO
    }

    /// The path of its box through a world that stands.
    pub(super) fn path(&self) -> Path {
        sweep(self.turning, self.displacement, DVec3::ZERO)
    }

    /// The path of this shape's box, as seen by another.
    fn path_past(&self, other: &Self) -> Path {
        sweep(self.turning, self.displacement, other.displacement)
    }

    /// A fraction before which the boxes prove that the two do not touch; `None` if they never do. Of two that move the one
    /// with the lower id is taken as the mover, so that both see the same.
    pub(super) fn entry(&self, other: &Self) -> Option<f64> {
        let is_first = other.stands() || !self.stands() && self.id < other.id;
        let (first, second) = if is_first { (self, other) } else { (other, self) };
        first.path_past(second).entry(&second.turning, 1.0)
    }

    fn wants(&self, other: &Side<'_>) -> bool {
        let both = self.side.shape.zip(other.shape);
        both.is_some_and(|(own, other)| own.id != other.id && want_each_other(own, other))
    }
}

/// A shape that a bullet may touch.
#[derive(Clone, Copy, Debug)]
struct Candidate {
    /// A fraction before which it is not touched.
    least: f64,
    id: ShapeId,
    /// Its index among those that travelled; `None` if it stands.
    moving: Option<usize>,
}

/// All that goes on in a tick.
struct Traffic<'a> {
    new: &'a Snapshot,
    /// The shapes that travelled, by id.
    moving: Vec<Moving<'a>>,
    /// Over their ways, if it is worth it.
    ways: Option<StaticTree>,
}

impl Traffic<'_> {
    /// What a bullet may touch, in the order of the lower bounds.
    fn candidates(&self, bullet: &Moving<'_>, found: &mut Vec<Candidate>, work: &mut Work) {
        found.clear();
        let mut offer = |index: usize| {
            let other = &self.moving[index];
            if bullet.wants(&other.side) && bullet.way.intersects(other.way) {
                let least = bullet.entry(other);
                found.extend(least.map(|least| Candidate { least, id: other.id, moving: Some(index) }));
            }
        };
        match &self.ways {
            None => (0..self.moving.len()).for_each(offer),
            Some(ways) => {
                let Ok(()) = ways.visit_box(bullet.way, ALL_LAYERS, work, |_, leaf| {
                    offer(leaf as usize);
                    Ok::<_, std::convert::Infallible>(ControlFlow::Continue(()))
                });
            }
        }
        self.standing_near(bullet, found, work);
        found.sort_unstable_by(|a, b| a.least.total_cmp(&b.least).then_with(|| a.id.cmp(&b.id)));
    }

    fn standing_near(&self, bullet: &Moving<'_>, found: &mut Vec<Candidate>, work: &mut Work) {
        let mut go_on = || true;
        let mut meter = Meter::new(&mut go_on);
        let path = bullet.path();
        let layers = bullet.side.shape.map_or(ALL_LAYERS, |shape| shape.collides_with);
        let visited = self.new.along(&Line::new(&path), 1.0, layers, &mut meter, |_, side| {
            let travelled = |id: ShapeId| self.moving.binary_search_by_key(&id, |moving| moving.id).is_ok();
            if let Some(id) = side.id().filter(|&id| bullet.wants(&side) && !travelled(id)) {
                let least = bullet.entry(&Moving::standing(side, id));
                found.extend(least.map(|least| Candidate { least, id, moving: None }));
            }
            Ok(1.0)
        });
        debug_assert_ne!(visited, Err(QuestionError::Interrupted), "this meter never interrupts");
        *work += meter.work;
    }

    /// Tests the candidates of a bullet and lists its first hits.
    fn take(&self, bullet: &Moving<'_>, candidates: &[Candidate], swept: &mut Swept) {
        let mut first = Best::new(BULLET_HITS_MAX + 1);
        for candidate in candidates {
            if candidate.least > first.limit() {
                // Nor has any after it a place in the list.
                break;
            }
            let standing = || {
                let entry = self.new.state().get(candidate.id)?;
                Some(Moving::standing(Side::of(entry), candidate.id))
            };
            match candidate.moving {
                Some(index) => ask(bullet, &self.moving[index], candidate.least, &mut swept.work),
                None => standing().and_then(|other| ask(bullet, &other, candidate.least, &mut swept.work)),
            }
            .into_iter()
            .for_each(|impact| first.add(impact));
        }
        let hits = first.into_sorted();
        let room = SWEEP_HITS_MAX - swept.hits.len();
        let most = room.min(BULLET_HITS_MAX);
        swept.truncated |= hits.len() > most;
        swept.hits.extend(hits.into_iter().take(most).map(|impact| SweepHit { bullet: bullet.id, impact }));
    }
}

/// The first touch of a bullet and another shape; `None` if it is proved that there is none.
fn ask(bullet: &Moving<'_>, other: &Moving<'_>, least: f64, work: &mut Work) -> Option<Impact> {
    let touch = if work.shapes_tested + work.pairs_tested + work.iterations > SWEEP_STEPS_MAX {
        untested(bullet, least)
    } else {
        work.shapes_tested += 1;
        let motion = Motion {
            displacement_a: bullet.displacement,
            displacement_b: other.displacement,
            rotation_a: bullet.rotation,
            rotation_b: other.rotation,
            initial: InitialTouch::Counts,
        };
        let (a, b) = (bullet.side.placed, other.side.placed);
        let mut touch = narrow::impact(a, b, &motion, &Accuracy::default(), work)?;
        raise(&mut touch.fraction, &mut touch.certificate, least);
        touch
    };
    Some(Impact { id: other.side.id(), user_data: other.side.user_data(), pierced: false, touch })
}

/// All that the boxes say of a touch: where the bullet's box is when it may first be.
fn untested(bullet: &Moving<'_>, least: f64) -> ImpactTouch {
    ImpactTouch {
        fraction: least,
        point: bullet.side.bounds.center() + bullet.displacement * least,
        normal_b_to_a: None,
        initial: false,
        feature_b: Feature::default(),
        certificate: Certificate {
            verdict: Verdict::Undecided,
            bound: Bound::new(least, 1.0),
            model: Model::EXACT,
            method: Method::Bounds,
            stop: Stop::Budget,
            iterations: 0,
        },
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::{
        shape::Geometry,
        world::{Edit, EditRule, Shape, Time, World},
    };

    #[test]
    fn beyond_the_budget_the_boxes_say_what_they_know() {
        let ball = Arc::new(Geometry::sphere(1.0).expect("a sphere"));
        let [first, second] = [1, 2].map(|number| ShapeId::new(number).expect("not 0"));
        let mut world = World::new(Time(0));
        let mut apply = |edits| {
            world.apply(edits, Time(0), EditRule::AllOrNothing).expect("a tick");
            world.newest()
        };
        let at = |id, x| Edit::Insert(Shape::new(id, Arc::clone(&ball), Pose::at(DVec3::X * x)));
        let old = apply(vec![at(first, 0.0), at(second, 7.0)]);
        let new = apply(vec![at(first, 10.0)]);
        let [bullet, other] = [first, second].map(|id| Moving::between(&old, &new, id).expect("in both"));
        let least = bullet.entry(&other).expect("its box is in the way");
        let mut work = Work { iterations: SWEEP_STEPS_MAX + 1, ..Work::default() };
        let touch = ask(&bullet, &other, least, &mut work).expect("not excluded").touch;
        assert_eq!((touch.certificate.verdict, touch.certificate.stop), (Verdict::Undecided, Stop::Budget));
        assert!(touch.certificate.bound.contains(0.5) && (touch.fraction - 0.5).abs() < 1e-12, "{touch:?}");
        let tested = ask(&bullet, &other, least, &mut Work::default()).expect("it touches").touch;
        assert_eq!((tested.fraction, tested.certificate.verdict), (0.5, Verdict::Hit));
    }
}
