//! Distance, overlap, margin, depth and contacts of a pair at rest: each is an interval, and all hold the same truth.

use collision::{
    DVec3,
    accuracy::{Accuracy, Tier},
    answer::{Bound, Certificate, Method, Stop, Verdict, Work},
    narrow::{self, Contact, ContactPoint, Depth, Separation},
    shape::MeshMode,
};

use super::{Case, shown};
use crate::{law, support};

/// Widest interval of a pair of polytopes at the exact tier, and what witnesses may be off by, as a part of the extent.
const WIDTH: f64 = 1e-11;

/// Lengths whose squares leave the range of f64 count as nothing, metres.
const NOTHING: f64 = 1e-138;

pub(super) fn check(case: &Case) {
    let known = Known::ask(case);
    known.agree(case);
    for (question, certificate) in known.certificates() {
        is_sound(case, question, &certificate);
    }
    if let Some(found) = &known.distance {
        separation(case, found);
    }
    if let Some(found) = &known.depth {
        depth(case, found);
    }
    for contact in &known.contacts {
        self::contact(case, contact);
    }
    swapped(case, &known);
}

/// Everything that is known of a pair.
struct Known {
    distance: Option<Separation>,
    limited: Option<Separation>,
    overlap: Certificate,
    within: Option<Certificate>,
    depth: Option<Depth>,
    contacts: Vec<Contact>,
    can_have_contacts: bool,
}

impl Known {
    fn ask(case: &Case) -> Self {
        let (a, b, accuracy) = (case.a(), case.b(), &case.accuracy);
        let work = &mut Work::default();
        let contacts = narrow::penetration(a, b, case.max_gap, accuracy, work);
        Self {
            distance: narrow::distance(a, b, f64::INFINITY, accuracy, work),
            limited: narrow::distance(a, b, case.limit, accuracy, work),
            overlap: narrow::overlap(a, b, accuracy, work),
            within: narrow::within(a, b, case.margin, accuracy, work),
            depth: narrow::depth(a, b, case.max_gap, accuracy, work),
            can_have_contacts: contacts.is_ok(),
            contacts: contacts.map(|found| found.to_vec()).unwrap_or_default(),
        }
    }

    fn certificates(&self) -> Vec<(&'static str, Certificate)> {
        let mut found = vec![("overlap", self.overlap)];
        found.extend(self.distance.map(|found| ("distance", found.certificate)));
        found.extend(self.limited.map(|found| ("limited distance", found.certificate)));
        found.extend(self.within.map(|found| ("within", found)));
        found.extend(self.depth.map(|found| ("depth", found.certificate)));
        found.extend(self.contacts.iter().map(|found| ("penetration", found.certificate)));
        found
    }

    /// Intervals of the signed distance have a common value, and verdicts do not contradict them.
    fn agree(&self, case: &Case) {
        let Some(distance) = &self.distance else { panic!("BROKEN no limit but no distance\n{case}") };
        let is_convex = !case.is_concave();
        let gap = distance.certificate.bound;
        let mut intervals = vec![("distance", from_distance(gap)), ("overlap", self.overlap.bound)];
        intervals.extend(self.limited.map(|found| ("limited distance", from_distance(found.certificate.bound))));
        intervals.extend(self.within.map(|found| ("within", found.bound)));
        if is_convex {
            let turned = |bound: Bound| Bound::new(-bound.upper, -bound.lower);
            intervals.extend(self.depth.map(|found| ("depth", turned(found.certificate.bound))));
            intervals.extend(self.contacts.iter().map(|found| ("penetration", turned(found.certificate.bound))));
        }
        for (name, one) in &intervals {
            for (other_name, other) in &intervals {
                law!(
                    case,
                    one.lower <= other.upper + NOTHING,
                    "{name} {one:?} and {other_name} {other:?} have no common value"
                );
            }
        }
        let upper = intervals.iter().map(|(_, bound)| bound.upper).fold(f64::INFINITY, f64::min);
        let lower = intervals.iter().map(|(_, bound)| bound.lower).fold(f64::NEG_INFINITY, f64::max);
        let verdict = self.overlap.verdict;
        law!(case, !(verdict == Verdict::Hit && lower > 0.0), "overlap Hit, but {intervals:?}");
        law!(case, !(verdict == Verdict::Miss && upper < 0.0), "overlap Miss, but {intervals:?}");
        if let Some(within) = self.within {
            law!(case, !(within.verdict == Verdict::Hit && lower > case.margin), "within Hit, but {intervals:?}");
            law!(case, !(within.verdict == Verdict::Miss && upper < case.margin), "within Miss, but {intervals:?}");
        }
        let beyond = |limit: f64| upper > limit || lower > limit;
        law!(case, self.limited.is_some() || beyond(case.limit), "proved beyond the limit, but {intervals:?}");
        // Triangles that are felt from one side leave contacts out.
        let has_sides = case.has_mode(|mode| mode != MeshMode::TwoSided);
        if self.can_have_contacts && !has_sides && self.contacts.is_empty() {
            law!(case, beyond(case.max_gap), "no contact, but {intervals:?}");
        }
        if is_convex {
            law!(case, self.depth.is_some() || beyond(case.max_gap), "no depth, but {intervals:?}");
            law!(case, self.contacts.len() <= 1, "{} contacts of convex forms", self.contacts.len());
        }
    }
}

/// What an interval of the distance says of the signed one.
fn from_distance(bound: Bound) -> Bound {
    Bound::new(if bound.lower > 0.0 { bound.lower } else { f64::NEG_INFINITY }, bound.upper)
}

/// What holds for every answer: order, no NaN, bounded work, a verdict that the bound allows.
fn is_sound(case: &Case, question: &str, certificate: &Certificate) {
    let Certificate { verdict, bound, stop, iterations, .. } = *certificate;
    law!(case, bound.lower <= bound.upper || bound.upper.abs() < NOTHING, "{question}: {certificate:?}");
    let most = 4 * u64::from(case.accuracy.budget) + 2048;
    // A mesh counts those of all its triangles, separating axes are counted one by one and not by the budget.
    let is_counted = !case.is_concave() && certificate.method != Method::SeparatingAxes;
    law!(
        case,
        !is_counted || u64::from(iterations) <= most,
        "{question}: {iterations} iterations for {:?}",
        case.accuracy
    );
    let contains = |value: f64| bound.contains(value);
    match question {
        "overlap" => {
            law!(case, verdict != Verdict::Undecided || contains(0.0), "{question}: {certificate:?}");
            law!(case, verdict != Verdict::Hit || bound.lower <= 0.0, "{question}: {certificate:?}");
            law!(case, verdict != Verdict::Miss || bound.upper >= 0.0, "{question}: {certificate:?}");
        }
        // Of pieces it may be open whether they touch, and sure how deep they are along the normal of the surface if they do.
        "depth" | "penetration" => {
            let is_open = verdict == Verdict::Undecided && !case.is_concave();
            law!(case, !is_open || contains(0.0), "{question}: {certificate:?}");
        }
        "within" => law!(case, verdict != Verdict::Undecided || contains(case.margin), "{question}: {certificate:?}"),
        _ => law!(case, bound.lower >= 0.0, "{question}: {certificate:?}"),
    }
    let is_exact = case.accuracy.tier == Tier::Exact && case.accuracy.budget == 4096 && stop == Stop::Converged;
    let is_value = matches!(question, "distance" | "depth" | "penetration");
    // Lengths whose squares leave the range of f64 count as nothing.
    if is_exact && is_value && case.is_polytopes() && case.extent() > 1e-130 {
        law!(
            case,
            bound.width() <= WIDTH * case.extent(),
            "{question}: converged to {:e} of the extent: {certificate:?}",
            bound.width() / case.extent()
        );
    }
}

/// A placed convex form.
type Body<'a> = (&'a collision::shape::Convex, &'a collision::math::Pose);

/// The unit vector along one that has a length.
fn unit(vector: DVec3) -> Option<DVec3> {
    (vector.length() > 1e-130).then(|| vector.normalize())
}

fn is_unit(vector: DVec3) -> bool {
    (vector.length() - 1.0).abs() <= 1e-14
}

fn separation(case: &Case, found: &Separation) {
    let bound = found.certificate.bound;
    law!(case, bound.contains(found.distance), "distance: {found:?}");
    law!(case, found.point_on_a.is_finite() && found.point_on_b.is_finite(), "distance: {found:?}");
    law!(case, found.normal_b_to_a.is_none_or(is_unit), "distance: {found:?}");
    let has_normal = found.normal_b_to_a.is_some();
    let slack = 1e-12 * case.extent() + case.world_rounding() + NOTHING;
    // Whether matter holds a point may be open within rounding; there is no normal then.
    let least = if case.is_concave() { slack } else { NOTHING * case.extent() };
    law!(case, has_normal == (found.distance > 0.0) || found.distance < least, "distance: {found:?}");
    let apart = found.point_on_a.distance(found.point_on_b);
    law!(case, apart >= bound.lower - slack, "distance: the points are {apart} apart: {found:?}");
    if case.accuracy == Accuracy::of(Tier::Exact) && found.certificate.stop == Stop::Converged {
        // Between round forms a value that is right to the last digit leaves the place open to the root of that.
        let is_round = !case.is_polytopes() || [&case.a, &case.b].iter().any(|made| made.is_rounded());
        let slack = if is_round { slack + 1e-6 * case.extent() } else { slack };
        law!(case, apart <= bound.upper + slack, "distance: the points are {apart} apart: {found:?}");
    }
    let (Some(a), Some(b)) = (case.a.convex(), case.b.convex()) else { return };
    let (a, b) = ((a, &case.pose_a), (b, &case.pose_b));
    if let Some(normal) = found.normal_b_to_a {
        let gap = support::gap(a, b, normal);
        law!(case, gap <= bound.upper + slack, "distance: a plane proves {gap:?}: {found:?}");
    }
    for (body, point) in [(a, found.point_on_a), (b, found.point_on_b)] {
        is_in(case, "distance", body, point, slack);
    }
}

/// A point lies in a form, as far as planes along some directions tell.
fn is_in(case: &Case, what: &str, (convex, pose): Body<'_>, point: DVec3, slack: f64) {
    // Points carry no bound: they are where the value was found, which is right to more digits, and a spent budget leaves them
    // where the search was.
    if case.accuracy != Accuracy::of(Tier::Exact) {
        return;
    }
    let slack = slack + 1e-8 * case.extent();
    let from = point - pose.position;
    let directions = [DVec3::X, DVec3::Y, DVec3::Z, DVec3::ONE, DVec3::new(1.0, -1.0, 0.0), from];
    for direction in directions.into_iter().flat_map(|direction| [direction, -direction]) {
        let Some(direction) = unit(direction) else { continue };
        let height = support::height(convex, pose, direction);
        let out = from.dot(direction) - height;
        law!(
            case,
            out <= slack,
            "{what}: {} is {:e} of the extent outside along {}",
            shown(point),
            out / case.extent(),
            shown(direction)
        );
    }
}

fn depth(case: &Case, found: &Depth) {
    let bound = found.certificate.bound;
    law!(case, bound.contains(found.depth), "depth: {found:?}");
    law!(case, is_unit(found.normal_b_to_a), "depth: {found:?}");
    law!(case, found.point_on_a.is_finite() && found.point_on_b.is_finite(), "depth: {found:?}");
    let (Some(a), Some(b)) = (case.a.convex(), case.b.convex()) else { return };
    let (a, b) = ((a, &case.pose_a), (b, &case.pose_b));
    let slack = 1e-12 * case.extent() + NOTHING;
    // The width along any direction is at least the depth.
    let apart = unit(found.point_on_a - found.point_on_b).unwrap_or(DVec3::X);
    for normal in [found.normal_b_to_a, apart, DVec3::X, DVec3::Y, DVec3::Z, DVec3::NEG_X, DVec3::NEG_Y, DVec3::NEG_Z] {
        let width = -support::gap(a, b, normal);
        law!(case, width >= bound.lower - slack, "depth: {width:?} along {} parts them: {found:?}", shown(normal));
    }
    if found.depth > 0.0 {
        let width = -support::gap(a, b, found.normal_b_to_a);
        law!(case, width <= bound.upper + slack, "depth: {width:?} along its normal: {found:?}");
    }
    let slack = slack + case.world_rounding();
    is_in(case, "depth", a, found.point_on_a, slack);
    is_in(case, "depth", b, found.point_on_b, slack);
}

fn contact(case: &Case, found: &Contact) {
    let bound = found.certificate.bound;
    law!(case, bound.contains(found.depth), "contact: {found:?}");
    law!(case, is_unit(found.normal_b_to_a), "contact: {found:?}");
    law!(case, (1..=4).contains(&found.points.len()), "contact: {found:?}");
    for point in &found.points {
        let ContactPoint { point_on_a, point_on_b, depth, bound: of_point, .. } = *point;
        law!(case, point_on_a.is_finite() && point_on_b.is_finite(), "contact: {found:?}");
        law!(case, of_point.contains(depth), "contact: {found:?}");
        let slack = 1e-12 * case.extent();
        law!(case, of_point.lower <= bound.upper + slack, "a point deeper than its contact: {found:?}");
    }
}

fn swapped(case: &Case, there: &Known) {
    if case.is_twins() {
        return;
    }
    let back = Case {
        a: case.b.clone(),
        b: case.a.clone(),
        pose_a: case.pose_b,
        pose_b: case.pose_a,
        accuracy: case.accuracy,
        limit: case.limit,
        max_gap: case.max_gap,
        margin: case.margin,
    };
    let back = Known::ask(&back);
    // What a mesh costs may differ, and of two that are one and the same none is the first.
    let key = |found: &Certificate| (found.verdict, found.bound);
    let same = key(&there.overlap) == key(&back.overlap) && (case.is_concave() || there.overlap == back.overlap);
    law!(case, same, "overlap {:?}, swapped {:?}", there.overlap, back.overlap);
    law!(case, there.within == back.within, "within {:?}, swapped {:?}", there.within, back.within);
    for (one, other) in [(&there.distance, &back.distance), (&there.limited, &back.limited)] {
        let key = |found: &Separation| (found.distance, found.certificate.bound, found.certificate.verdict);
        let same = one.as_ref().map(key) == other.as_ref().map(key);
        law!(case, same, "distance {one:?}, swapped {other:?}");
        let ends = |found: &Separation| (found.point_on_a, found.point_on_b, found.normal_b_to_a);
        let turned =
            |found: &Separation| (found.point_on_b, found.point_on_a, found.normal_b_to_a.map(|normal| -normal));
        law!(case, one.as_ref().map(ends) == other.as_ref().map(turned), "distance {one:?}, swapped {other:?}");
    }
    let key = |found: &Depth| (found.depth, found.certificate, found.point_on_a, found.normal_b_to_a);
    let turned = |found: &Depth| (found.depth, found.certificate, found.point_on_b, -found.normal_b_to_a);
    let same = there.depth.as_ref().map(key) == back.depth.as_ref().map(turned);
    law!(case, same, "depth {:?}, swapped {:?}", there.depth, back.depth);
    let count = (there.contacts.len(), back.contacts.len());
    law!(case, count.0 == count.1, "contacts: {count:?}");
    // They are in the order of the pieces of the first, then of the second.
    let mut turned: Vec<&Contact> = back.contacts.iter().collect();
    turned.sort_by_key(|contact| (contact.feature_b, contact.feature_a));
    for (one, other) in there.contacts.iter().zip(turned) {
        let same = one.depth == other.depth
            && one.certificate == other.certificate
            && one.normal_b_to_a == -other.normal_b_to_a
            && one.points.len() == other.points.len()
            && one.points.iter().zip(&other.points).all(|(p, q)| p.point_on_a == q.point_on_b && p.depth == q.depth);
        law!(case, same, "contact {one:?}, swapped {other:?}");
    }
}
