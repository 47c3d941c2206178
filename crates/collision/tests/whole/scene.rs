//! Rays at forms in whole numbers, and a count of how the answers compare with the truth.

use collision::{
    DQuat,
    accuracy::Accuracy,
    answer::{Verdict, Work},
    math::Pose,
    narrow::{Faces, Placed, Ray, RayTouches, raycast},
    shape::Geometry,
};

use super::{Numbers, V3, to_f64};

/// A scene in whole numbers: a form at `position`, turned by `rotation`.
pub(crate) struct Scene {
    pub(crate) position: V3,
    pub(crate) rotation: [i128; 4],
    pub(crate) origin: V3,
    pub(crate) direction: V3,
    /// Power of two on every length.
    pub(crate) scale: f64,
}

impl Scene {
    pub(crate) fn pose(&self) -> Pose {
        let [x, y, z, w] = self.rotation.map(|part| part as f64);
        Pose::new(to_f64(self.position) * self.scale, DQuat::from_xyzw(x, y, z, w))
    }

    pub(crate) fn ray(&self, hollow: bool) -> Ray {
        Ray {
            origin: to_f64(self.origin) * self.scale,
            direction: to_f64(self.direction),
            min_distance: 0.0,
            max_distance: 1e18,
            hollow,
            faces: Faces::Both,
        }
    }

    pub(crate) fn cast(&self, geometry: &Geometry, hollow: bool) -> RayTouches {
        let target = Placed { geometry, pose: self.pose() };
        raycast(&self.ray(hollow), target, &Accuracy::default(), &mut Work::default())
    }

    /// Metres, for a multiple of the direction.
    pub(crate) fn metres(&self, t: f64) -> f64 {
        t * to_f64(self.direction).length() * self.scale
    }

    /// The size of the numbers that take part.
    pub(crate) fn size(&self, reach: f64) -> f64 {
        (to_f64(self.origin) - to_f64(self.position)).length() * self.scale + reach * self.scale
    }

    /// Random, near or far, small or large, turned or not, aimed within about `spread` of the form.
    pub(crate) fn random(numbers: &mut Numbers, spread: i128) -> Self {
        let far = [1, 1, 1 << 10, 1 << 25][numbers.below(4) as usize];
        let position = numbers.vector(far << 4);
        let times = [1, 1, 64, 1 << 14][numbers.below(4) as usize];
        let away = numbers.vector(40 * spread * times);
        let aim = numbers.vector(spread);
        let rotation = if numbers.below(3) == 0 { [0, 0, 0, 3] } else { [0; 4].map(|_| numbers.within(9)) };
        let rotation = if rotation == [0; 4] { [1, 2, 3, 4] } else { rotation };
        let direction = [0, 1, 2].map(|axis| aim[axis] - away[axis]);
        Self {
            position,
            rotation,
            origin: [0, 1, 2].map(|axis| position[axis] + away[axis]),
            direction: if direction == [0; 3] { [1, 0, 0] } else { direction },
            scale: 2.0_f64.powi([0, 0, -20, 16][numbers.below(4) as usize]),
        }
    }
}

/// Counts answers, so that a test shows that it saw enough of each kind.
#[derive(Default)]
pub(crate) struct Tally {
    hits: u32,
    misses: u32,
    undecided: u32,
}

impl Tally {
    /// Compares an answer with the truth: a distance in metres, or none.
    pub(crate) fn take(&mut self, scene: &Scene, touches: RayTouches, truth: Option<f64>, reach: f64) {
        let context = || format!("{:?} at {:?}: truth {truth:?}, {touches:?}", scene.ray(false), scene.pose());
        match (touches.certain, truth) {
            (Some(touch), Some(truth)) => {
                self.hits += 1;
                assert_eq!(touch.certificate.verdict, Verdict::Hit);
                let slack = 4e-16 * truth;
                let bound = touch.certificate.bound;
                assert!(bound.lower - slack <= truth && truth <= bound.upper + slack, "{}", context());
                assert!(bound.contains(touch.distance), "{}", context());
            }
            (Some(_), None) => panic!("a hit that is none: {}", context()),
            (None, truth) => match (touches.undecided, truth) {
                (None, None) => self.misses += 1,
                (None, Some(_)) => panic!("missed: {}", context()),
                (Some(touch), truth) => {
                    self.undecided += 1;
                    assert_eq!(touch.certificate.verdict, Verdict::Undecided);
                    let holds = |truth| touch.certificate.bound.contains(truth);
                    assert!(truth.is_none_or(holds), "{}", context());
                }
            },
        }
        assert!(touches.certain.is_none_or(|touch| touch.point.is_finite()), "{}", context());
        let surface = touches.certain.map_or(0.0, |touch| {
            let ray = scene.ray(false);
            (ray.origin + ray.direction.normalize() * touch.distance - touch.point).length()
        });
        let size = scene.size(reach) + scene.pose().position.length();
        assert!(surface <= 1e-13 * size, "the point is off by {surface}: {}", context());
    }

    pub(crate) fn is_not_vacuous(&self) {
        let Self { hits, misses, undecided } = *self;
        let share = f64::from(hits) / f64::from(hits + misses + undecided);
        assert!((0.3..0.7).contains(&share), "{hits} hits, {misses} misses");
        assert!(undecided * 500 < hits, "{undecided} undecided of {hits} hits");
    }
}
