//! Asks every question to two descriptions of one form: their intervals hold the same truth, so they must meet.

use collision::{
    DQuat, DVec3,
    accuracy::{Accuracy, Tier},
    answer::{Bound, Feature, Verdict, Work},
    math::Pose,
    narrow::{Faces, ImpactTouch, InitialTouch, Motion, Placed, Ray, distance, impact, overlap, penetration, raycast},
    shape::Geometry,
};
use glam::Vec3Swizzles as _;

use crate::whole::Numbers;

pub(crate) const EXACT: Accuracy = Accuracy::of(Tier::Exact);

pub(crate) fn at(geometry: &Geometry, pose: Pose) -> Placed<'_> {
    Placed { geometry, pose }
}

pub(crate) fn work() -> Work {
    Work::default()
}

pub(crate) fn rotation(numbers: &mut Numbers) -> DQuat {
    DQuat::from_xyzw(numbers.share(), numbers.share(), numbers.share(), numbers.share())
}

/// A convex form of about 0.3.
pub(crate) fn convex(numbers: &mut Numbers) -> Geometry {
    let half = (numbers.shares() * 0.3).abs() + 0.05;
    let form = match numbers.below(8) {
        0 => Geometry::sphere(half.x),
        1 => Geometry::capsule(half.x, half.y),
        2 => Geometry::cuboid(half),
        3 => Geometry::cuboid(half).and_then(|form| form.rounded(0.1)),
        4 => Geometry::cylinder(half.x, half.y),
        5 => Geometry::cone(half.x, half.y),
        6 => Geometry::ellipsoid(half),
        _ => Geometry::hull(&[half, -half, half.zxy(), -half.yzx(), DVec3::new(0.2, -half.x, half.y)]),
    };
    form.expect("a form")
}

/// What was asked so far, to see that the questions were neither all hits nor all misses.
#[derive(Debug, Default)]
pub(crate) struct Tally {
    pub(crate) asked: u32,
    pub(crate) overlaps: u32,
    pub(crate) impacts: u32,
    pub(crate) rays: u32,
    pub(crate) contacts: u32,
    pub(crate) open: u32,
    pub(crate) widest: f64,
}

impl Tally {
    /// Between 30 and 70 % of what was asked are hits, and few are open.
    pub(crate) fn assert_not_vacuous(&self, widest: f64) {
        let shares = [self.overlaps, self.impacts, self.rays].map(|count| f64::from(count) / f64::from(self.asked));
        assert!(shares.iter().all(|share| (0.3..=0.7).contains(share)), "{self:?} {shares:?}");
        assert!(self.open * 50 <= self.asked && self.contacts > 0, "{self:?}");
        assert!(self.widest <= widest, "{self:?}");
    }

    fn width(&mut self, bound: Bound) {
        self.widest = self.widest.max(bound.width());
    }
}

/// Two descriptions of one form, and what is asked of them.
pub(crate) struct Twins<'a> {
    pub(crate) one: Placed<'a>,
    pub(crate) other: Placed<'a>,
    pub(crate) asker: Placed<'a>,
}

fn meet(a: Bound, b: Bound) -> bool {
    a.lower <= b.upper && b.lower <= a.upper
}

impl Twins<'_> {
    /// Every question but rays; the asker goes and turns as said.
    pub(crate) fn check(&self, motion: &Motion, tally: &mut Tally, context: &dyn Fn() -> String) {
        self.check_contacts(tally, context);
        self.check_but_contacts(motion, tally, context);
    }

    /// Every question but rays and contacts.
    pub(crate) fn check_but_contacts(&self, motion: &Motion, tally: &mut Tally, context: &dyn Fn() -> String) {
        tally.asked += 1;
        self.check_overlap(tally, context);
        self.check_distance(tally, context);
        let linear = Motion { rotation_a: DVec3::ZERO, rotation_b: DVec3::ZERO, ..*motion };
        if self.check_impact(&linear, context) {
            tally.impacts += 1;
        }
        if motion.turns() {
            self.check_impact(motion, context);
        }
    }

    fn check_overlap(&self, tally: &mut Tally, context: &dyn Fn() -> String) {
        let [one, other] = [self.one, self.other].map(|form| overlap(self.asker, form, &EXACT, &mut work()));
        assert_eq!(one, overlap(self.one, self.asker, &EXACT, &mut work()), "{}", context());
        match [one.verdict, other.verdict] {
            [Verdict::Hit, Verdict::Miss] | [Verdict::Miss, Verdict::Hit] => panic!("{one:?} {other:?} {}", context()),
            [Verdict::Hit, Verdict::Hit] => tally.overlaps += 1,
            [Verdict::Miss, Verdict::Miss] => {}
            _ => tally.open += 1,
        }
    }

    fn check_distance(&self, tally: &mut Tally, context: &dyn Fn() -> String) {
        let ask = |a, b| distance(a, b, f64::INFINITY, &EXACT, &mut work()).expect("no limit");
        let [one, other] = [self.one, self.other].map(|form| ask(self.asker, form));
        let bounds = [one.certificate.bound, other.certificate.bound];
        assert!(meet(bounds[0], bounds[1]), "{one:?} {other:?} {}", context());
        bounds.into_iter().for_each(|bound| tally.width(bound));
        let back = ask(self.one, self.asker);
        assert_eq!(one.distance.to_bits(), back.distance.to_bits(), "{}", context());
        assert_eq!((one.point_on_a, one.feature_b), (back.point_on_b, back.feature_a), "{}", context());
        // The points are as far apart as they are said to be, and one of them is on the asker.
        let apart = (one.point_on_a - one.point_on_b).length();
        let far = one.point_on_a.length() + 1.0;
        assert!((apart - one.distance).abs() <= 1e-12 * far, "{one:?} {}", context());
        if bounds[0].lower > 0.0 {
            let short = distance(self.asker, self.one, bounds[0].lower * 0.999, &EXACT, &mut work());
            assert!(short.is_none(), "{short:?} {}", context());
        }
    }

    fn check_contacts(&self, tally: &mut Tally, context: &dyn Fn() -> String) {
        let ask = |a, b| penetration(a, b, 0.05, &EXACT, &mut work());
        let (Ok(one), Ok(other)) = (ask(self.asker, self.one), ask(self.asker, self.other)) else {
            return;
        };
        let depths = |found: &collision::narrow::Contacts| {
            let mut all: Vec<Bound> = found.iter().map(|contact| contact.certificate.bound).collect();
            all.sort_by(|a, b| a.upper.total_cmp(&b.upper));
            all
        };
        let pairs = depths(&one).into_iter().zip(depths(&other));
        assert_eq!(one.len(), other.len(), "{one:?} {other:?} {}", context());
        for (a, b) in pairs {
            assert!(meet(a, b), "{a:?} {b:?} {}", context());
            tally.contacts += 1;
        }
        let back = ask(self.one, self.asker).expect("as the other way round");
        let features = |list: &[(Feature, Feature)]| list.to_vec();
        let these: Vec<_> = one.iter().map(|contact| (contact.feature_b, contact.feature_a)).collect();
        let mut those: Vec<_> = back.iter().map(|contact| (contact.feature_a, contact.feature_b)).collect();
        those.sort();
        let mut sorted = features(&these);
        sorted.sort();
        assert_eq!(sorted, those, "{}", context());
    }

    /// Whether they touch.
    fn check_impact(&self, motion: &Motion, context: &dyn Fn() -> String) -> bool {
        let [one, other] = [self.one, self.other].map(|form| impact(self.asker, form, motion, &EXACT, &mut work()));
        let is_hit = |touch: &ImpactTouch| touch.certificate.verdict == Verdict::Hit;
        match (&one, &other) {
            (Some(one), Some(other)) => {
                let (a, b) = (one.certificate.bound, other.certificate.bound);
                assert!(meet(a, b), "{one:?} {other:?} {}", context());
            }
            (Some(touch), None) | (None, Some(touch)) => assert!(!is_hit(touch), "{touch:?} {}", context()),
            (None, None) => {}
        }
        let back = Motion {
            displacement_a: motion.displacement_b,
            displacement_b: motion.displacement_a,
            rotation_a: motion.rotation_b,
            rotation_b: motion.rotation_a,
            initial: motion.initial,
        };
        let swapped = impact(self.one, self.asker, &back, &EXACT, &mut work());
        let fraction = |touch: &Option<ImpactTouch>| touch.map(|touch| touch.fraction.to_bits());
        assert_eq!(fraction(&one), fraction(&swapped), "{}", context());
        one.is_some_and(|touch| is_hit(&touch))
    }

    /// A ray; the asker is not asked.
    pub(crate) fn check_ray(&self, ray: &Ray, tally: &mut Tally, context: &dyn Fn() -> String) {
        let [one, other] = [self.one, self.other].map(|form| raycast(ray, form, &EXACT, &mut work()));
        let text = || format!("{ray:?} {one:?} {other:?} {}", context());
        match (one.certain, other.certain) {
            (Some(a), Some(b)) => {
                assert!(meet(a.certificate.bound, b.certificate.bound), "{}", text());
                assert!(a.inside == b.inside, "{}", text());
                let on_ray = ray.origin + ray.direction.normalize() * a.distance;
                assert!((a.point - on_ray).length() <= 1e-12 * (on_ray.length() + a.distance + 1.0), "{}", text());
                tally.width(a.certificate.bound);
                tally.rays += 1;
            }
            (Some(_), None) => assert!(other.undecided.is_some(), "{}", text()),
            (None, Some(_)) => assert!(one.undecided.is_some(), "{}", text()),
            (None, None) => {}
        }
    }
}

/// A ray that meets a form of the size of 1 about a place in about every second case.
pub(crate) fn ray_towards(numbers: &mut Numbers, place: DVec3, spread: f64) -> Ray {
    let origin = place + numbers.shares() * 4.0;
    let direction = place + numbers.shares() * spread - origin;
    let hollow = numbers.below(3) == 0;
    Ray { origin, direction, min_distance: 0.0, max_distance: 1e12, hollow, faces: Faces::Both }
}

/// How the asker moves towards a form at `place`, and turns, if it does.
pub(crate) fn motion_towards(numbers: &mut Numbers, asker: DVec3, place: DVec3, spread: f64) -> Motion {
    let turns = |numbers: &mut Numbers| if numbers.below(2) == 0 { numbers.shares() * 2.0 } else { DVec3::ZERO };
    Motion {
        displacement_a: place + numbers.shares() * spread - asker,
        displacement_b: numbers.shares() * 0.3,
        rotation_a: turns(numbers),
        rotation_b: turns(numbers),
        initial: InitialTouch::Counts,
    }
}
