//! First touches of a pair in motion, turning or not.

use collision::{
    DQuat, DVec3,
    answer::{Bound, Verdict, Work},
    math::Pose,
    narrow::{self, ImpactTouch, InitialTouch, Motion, Placed},
    shape::MeshMode,
};

use super::Case;
use crate::{
    law,
    numbers::{Numbers, vector_code, vector_within},
};

pub(super) fn check(case: &Case, numbers: &mut Numbers<'_>) {
    let between = case.pose_b.position - case.pose_a.position;
    let displacement_a = match numbers.below(5) {
        0 => numbers.vector(),
        1 => DVec3::ZERO,
        2 => vector_within(between),
        3 => vector_within(between * (f64::from(numbers.byte()) / 64.0) + numbers.direction() * 0.1 * case.extent()),
        _ => numbers.direction() * numbers.number(),
    };
    let displacement_b = if numbers.below(3) == 0 { numbers.vector() } else { DVec3::ZERO };
    let initial = if numbers.below(4) == 0 { InitialTouch::IsIgnored } else { InitialTouch::Counts };
    let mut turn = || match numbers.below(6) {
        0 => numbers.direction(),
        1 => numbers.direction() * f64::from(numbers.byte()) / 16.0,
        2 => numbers.vector() / case.extent().max(1e-9),
        _ => DVec3::ZERO,
    };
    let short = |turn: DVec3| if turn.length() <= 16.0 { turn } else { DVec3::ZERO };
    let (rotation_a, rotation_b) = (short(turn()), short(turn()));
    let motion = Motion { displacement_a, displacement_b, rotation_a, rotation_b, initial };
    let moving = Moving { case, motion };
    let found = narrow::impact(case.a(), case.b(), &motion, &case.accuracy, &mut Work::default());
    moving.is_sound(found.as_ref());
    moving.way_is_free(found.as_ref());
    moving.is_symmetric(found.as_ref());
}

struct Moving<'a> {
    case: &'a Case,
    motion: Motion,
}

impl std::fmt::Display for Moving<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Motion { displacement_a, displacement_b, rotation_a, rotation_b, initial } = self.motion;
        let (a, b) = (vector_code(displacement_a), vector_code(displacement_b));
        let turns = format!("rotation_a: {}, rotation_b: {}", vector_code(rotation_a), vector_code(rotation_b));
        let initial = format!("InitialTouch::{initial:?}");
        write!(f, "{}", self.case)?;
        writeln!(
            f,
            "    let motion = Motion {{ displacement_a: {a}, displacement_b: {b}, {turns}, initial: {initial} }};"
        )
    }
}

impl Moving<'_> {
    /// What a touch by rounding alone may amount to, metres.
    fn slack(&self) -> f64 {
        let way = self.motion.displacement_a.length() + self.motion.displacement_b.length();
        let turn = self.motion.rotation_a.length() + self.motion.rotation_b.length();
        1e-12 * (self.case.extent() * (1.0 + turn) + way) + self.case.world_rounding()
    }

    fn is_sound(&self, found: Option<&ImpactTouch>) {
        let Some(found) = found else { return };
        let bound = found.certificate.bound;
        law!(self, bound.contains(found.fraction), "impact: {found:?}");
        law!(self, bound.lower >= 0.0 && bound.upper <= 1.0, "impact: {found:?}");
        law!(self, found.certificate.verdict != Verdict::Miss, "impact: {found:?}");
        law!(self, found.point.is_finite(), "impact: {found:?}");
        let is_unit = |normal: DVec3| (normal.length() - 1.0).abs() <= 1e-14;
        law!(self, found.normal_b_to_a.is_none_or(is_unit), "impact: {found:?}");
        law!(self, !found.initial || bound.lower == 0.0, "impact: {found:?}");
        let most = 64 * u64::from(self.case.accuracy.budget) + 65_536;
        let iterations = u64::from(found.certificate.iterations);
        law!(self, self.case.is_concave() || iterations <= most, "impact: {iterations} iterations: {found:?}");
        if found.certificate.verdict == Verdict::Hit {
            // At the end of the interval the two surely touch, but for the rounding of the poses there.
            let gap = self.distance_at(bound.upper);
            law!(self, gap <= self.slack(), "impact: {gap:?} m apart when they touch: {found:?}");
        }
    }

    /// Before the interval, or all the way, nothing is deeper in the other than rounding.
    fn way_is_free(&self, found: Option<&ImpactTouch>) {
        // What comes through the back of a surface that is felt from one side is passed over, and is in it then.
        let is_passed_over = self.case.has_mode(|mode| mode == MeshMode::OneSided);
        if self.motion.initial == InitialTouch::IsIgnored || is_passed_over {
            return;
        }
        let end = found.map_or(1.0, |found| found.certificate.bound.lower);
        for step in 0..=4 {
            let time = end * f64::from(step) / 4.0;
            let is_before = found.is_none() || time < end;
            if !is_before {
                continue;
            }
            let depth = self.depth_at(time);
            law!(self, depth <= self.slack(), "impact: {depth:?} m deep at {time:?}: {found:?}");
        }
    }

    fn at(&self, time: f64) -> (Placed<'_>, Placed<'_>) {
        let moved = |pose: &Pose, way: DVec3, turn: DVec3| {
            let position = pose.position + way * time;
            let rotation = match turn {
                DVec3::ZERO => pose.rotation,
                turn => DQuat::from_scaled_axis(turn * time) * pose.unit_rotation(),
            };
            Pose::new(position, rotation)
        };
        let Motion { displacement_a, displacement_b, rotation_a, rotation_b, .. } = self.motion;
        let a = self.case.a.at(moved(&self.case.pose_a, displacement_a, rotation_a));
        (a, self.case.b.at(moved(&self.case.pose_b, displacement_b, rotation_b)))
    }

    fn distance_at(&self, time: f64) -> f64 {
        let (a, b) = self.at(time);
        let found = narrow::distance(a, b, f64::INFINITY, &self.case.accuracy, &mut Work::default());
        found.map_or(f64::INFINITY, |found| found.certificate.bound.lower)
    }

    /// How deep the two surely are in each other; less than 0 is no proof of it.
    fn depth_at(&self, time: f64) -> f64 {
        let (a, b) = self.at(time);
        let found = narrow::penetration(a, b, 0.0, &self.case.accuracy, &mut Work::default());
        let depths = found.iter().flatten().map(|contact| contact.certificate.bound.lower);
        depths.fold(f64::NEG_INFINITY, f64::max)
    }

    fn is_symmetric(&self, found: Option<&ImpactTouch>) {
        let Motion { displacement_a, displacement_b, rotation_a, rotation_b, initial } = self.motion;
        let motion = Motion {
            displacement_a: displacement_b,
            displacement_b: displacement_a,
            rotation_a: rotation_b,
            rotation_b: rotation_a,
            initial,
        };
        let (a, b) = (self.case.b(), self.case.a());
        let back = narrow::impact(a, b, &motion, &self.case.accuracy, &mut Work::default());
        let key = |found: &ImpactTouch| (found.fraction, found.certificate.bound, found.certificate.verdict);
        if self.case.is_concave() {
            // Of which mesh the triangles are looked through first decides what is left open, never what is proved.
            let free = Bound::new(1.0f64.next_up(), f64::INFINITY);
            let bounds = [found, back.as_ref()].map(|touch| touch.map_or(free, |touch| touch.certificate.bound));
            let is_hit =
                |touch: Option<&ImpactTouch>| touch.is_some_and(|touch| touch.certificate.verdict == Verdict::Hit);
            let meet = bounds[0].lower <= bounds[1].upper && bounds[1].lower <= bounds[0].upper;
            let is_proved = is_hit(found) || is_hit(back.as_ref());
            law!(self, !is_proved || meet, "impact {found:?}, swapped {back:?}");
            return;
        }
        law!(self, found.map(key) == back.as_ref().map(key), "impact {found:?}, swapped {back:?}");
        if self.case.is_twins() {
            return;
        }
        let normals = (found.map(|found| found.normal_b_to_a), back.map(|back| back.normal_b_to_a.map(|n| -n)));
        law!(self, normals.0 == normals.1, "impact: normals {normals:?}");
    }
}
