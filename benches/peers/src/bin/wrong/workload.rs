//! Pairs near contact, at a size, an offset and an aspect.

use collision::{
    DQuat, DVec3,
    accuracy::{Accuracy, Tier},
    answer::{Bound, Verdict, Work},
    math::Pose,
    narrow::{self, Placed},
    shape::Geometry,
};

use crate::ask::Form;

/// Where pairs are extreme.
pub(crate) struct Extreme {
    pub(crate) name: &'static str,
    /// Metres.
    size: f64,
    /// From the origin, metres.
    offset: f64,
    /// How many times as long as wide.
    aspect: f64,
}

const fn extreme(name: &'static str, size: f64, offset: f64, aspect: f64) -> Extreme {
    Extreme { name, size, offset, aspect }
}

pub(crate) const EXTREMES: [Extreme; 11] = [
    extreme("1 m, at the origin", 1.0, 0.0, 1.0),
    extreme("1 µm", 1e-6, 0.0, 1.0),
    extreme("1 mm", 1e-3, 0.0, 1.0),
    extreme("1 km", 1e3, 0.0, 1.0),
    extreme("1,000 km", 1e6, 0.0, 1.0),
    extreme("1 m, 1 km off", 1.0, 1e3, 1.0),
    extreme("1 m, 1,000 km off", 1.0, 1e6, 1.0),
    extreme("1 m, 1e9 m off", 1.0, 1e9, 1.0),
    extreme("1 m, aspect 100", 1.0, 0.0, 1e2),
    extreme("1 m, aspect 1e4", 1.0, 0.0, 1e4),
    extreme("1 m, aspect 1e6", 1.0, 0.0, 1e6),
];

/// Two placed forms, and what is true of them.
pub(crate) struct Pair {
    pub(crate) forms: [Form; 2],
    pub(crate) poses: [Pose; 2],
    /// Of the signed distance, metres: minus the depth where they overlap.
    pub(crate) truth: Bound,
    /// The extent of the pair, metres.
    pub(crate) size: f64,
}

/// Random numbers (splitmix64): the same on every machine.
struct Dice(u64);

impl Dice {
    fn within(&mut self, low: f64, high: f64) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mixed = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        low + (high - low) * (((mixed ^ (mixed >> 31)) >> 11) as f64 / (1_u64 << 53) as f64)
    }

    fn direction(&mut self) -> DVec3 {
        loop {
            let mut part = || self.within(-1.0, 1.0);
            let point = DVec3::new(part(), part(), part());
            if (0.01..=1.0).contains(&point.length_squared()) {
                return point.normalize();
            }
        }
    }

    fn rotation(&mut self) -> DQuat {
        let (axis, angle) = (self.direction(), self.within(0.0, std::f64::consts::TAU));
        DQuat::from_axis_angle(axis, angle)
    }
}

impl Extreme {
    fn form(&self, dice: &mut Dice, kind: usize) -> Form {
        let long = self.size * dice.within(0.3, 1.0);
        let wide = long / self.aspect;
        match kind {
            0 => Form::Cuboid(DVec3::new(wide, long, wide * dice.within(0.5, 1.0))),
            1 => Form::Capsule { half_height: long, radius: 0.5 * wide },
            2 => {
                let squash = DVec3::new(wide, long, wide);
                Form::Hull((0..16).map(|_| dice.direction() * squash).collect())
            }
            _ => Form::Cylinder { half_height: long, radius: 0.5 * wide },
        }
    }
}

/// The kinds of both forms, in turns.
const KINDS: [[usize; 2]; 4] = [[0, 0], [1, 0], [2, 2], [3, 0]];

/// Pairs whose truth is known to rounding.
pub(crate) fn pairs(extreme: &Extreme, count: usize) -> Vec<Pair> {
    let mut dice = Dice(7);
    (0..count).filter_map(|number| pair(extreme, &mut dice, number)).collect()
}

fn pair(extreme: &Extreme, dice: &mut Dice, number: usize) -> Option<Pair> {
    let forms = KINDS[number % KINDS.len()].map(|kind| extreme.form(dice, kind));
    let geometries = [forms[0].geometry()?, forms[1].geometry()?];
    let middle = dice.direction() * extreme.offset;
    let rotations = [dice.rotation(), dice.rotation()];
    let (along, share) = (dice.direction(), dice.within(0.0, 0.1));
    let size = geometries[0].reach() + geometries[1].reach();
    let at = |far: f64| [Pose::new(middle, rotations[0]), Pose::new(middle + along * far, rotations[1])];
    let touches = |far: f64| {
        let [a, b] = placed(&geometries, at(far));
        narrow::overlap(a, b, &Accuracy::default(), &mut Work::default()).verdict == Verdict::Hit
    };
    let (mut inside, mut outside) = (0.0, size);
    for _ in 0..40 {
        let half = 0.5 * (inside + outside);
        if touches(half) { inside = half } else { outside = half }
    }
    let aside = share * size / extreme.aspect.sqrt();
    let far = if number / KINDS.len() % 2 == 0 { (inside - aside).max(0.0) } else { inside + aside };
    let poses = at(far);
    Some(Pair { truth: truth(&geometries, poses)?, forms, poses, size })
}

fn placed(geometries: &[Geometry; 2], poses: [Pose; 2]) -> [Placed<'_>; 2] {
    [0, 1].map(|side| Placed { geometry: &geometries[side], pose: poses[side] })
}

fn truth(geometries: &[Geometry; 2], poses: [Pose; 2]) -> Option<Bound> {
    let ([a, b], accuracy, work) = (placed(geometries, poses), Accuracy::of(Tier::Exact), &mut Work::default());
    let apart = narrow::distance(a, b, f64::MAX, &accuracy, work)?.certificate.bound;
    if apart.lower > 0.0 {
        return Some(apart);
    }
    let depth = narrow::depth(a, b, 0.0, &accuracy, work)?.certificate.bound;
    Some(Bound::new(-depth.upper, -depth.lower))
}
