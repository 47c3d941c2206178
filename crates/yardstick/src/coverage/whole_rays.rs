//! Rays at concave forms.

use collision::{
    accuracy::{Accuracy, Tier},
    answer::{Bound, Work},
    narrow::{Faces, Placed, Ray, RayTouches, raycast},
    shape::MeshMode,
};
use glam::DVec3;

use super::{
    forms::power_of_ten,
    outcome::{Answer, Asked, FaultKind, Outcome},
    report::Labels,
    source,
    whole::{PlacedWhole, Whole},
    wholes::{Class, place_of, whole},
};
use crate::{
    oracle::{length, stretch_inside_part},
    scene::Random,
};

/// A ray and a concave target.
#[derive(Clone, Debug)]
pub struct WholeRay {
    /// What is hard about it.
    pub category: &'static str,
    /// What it is cast at.
    pub target: PlacedWhole,
    /// The ray; bodies are full for it.
    pub ray: Ray,
}

/// The question that a seed and a class name.
pub(super) fn whole_ray(seed: u64, class: Class) -> WholeRay {
    let mut random = Random::new(seed);
    let random = &mut random;
    let category = ["generic", "far_offset", "tiny", "huge", "distant"][(random.bits() % 5) as usize];
    let size = match category {
        "tiny" => power_of_ten(random, -7.5, -6.0),
        "huge" => power_of_ten(random, 6.0, 8.0),
        _ => power_of_ten(random, -3.0, 3.0),
    };
    let offset = if category == "far_offset" { power_of_ten(random, 3.0, 9.0) } else { 0.0 };
    let position = random.direction() * size + random.direction() * offset;
    let target = PlacedWhole { whole: whole(random, class, size), position, rotation: random.rotation() };
    let far = if category == "distant" { power_of_ten(random, 1.0, 6.0) } else { random.uniform(0.0, 3.0) };
    let origin = position + random.direction() * (size * far).min(1e11);
    let aim = position + target.rotation * aim(random, &target.whole, size);
    let direction = (aim - origin) * power_of_ten(random, -3.0, 3.0);
    let max_distance = if random.one_in(6) { size * random.uniform(0.1, 3.0) } else { 4e12 };
    let ray = Ray { origin, direction, min_distance: 0.0, max_distance, hollow: false, faces: Faces::Both };
    WholeRay { category, target, ray }
}

/// A place near the form, a corner or an edge of it among them.
fn aim(random: &mut Random, whole: &Whole, size: f64) -> DVec3 {
    let Whole::Mesh { vertices, triangles, .. } = whole else { return random.direction() * (size * 0.8) };
    let corners = triangles[(random.bits() % triangles.len() as u64) as usize].map(|index| vertices[index as usize]);
    match random.bits() % 4 {
        0 => corners[0],
        1 => corners[0].lerp(corners[1], random.uniform(0.0, 1.0)),
        _ => (corners[0] + corners[1] * random.uniform(0.0, 1.0) + corners[2]) / 2.5,
    }
}

impl WholeRay {
    /// What its answers are counted as.
    pub(super) fn labels(&self) -> Labels {
        let class = self.target.whole.class();
        let forms = self.target.whole.labels();
        Labels { class, forms, extremes: vec![self.category], accuracy: "exact" }
    }

    /// A test to paste.
    pub(super) fn source(&self, name: &str) -> String {
        let target = &self.target;
        format!(
            "#[test]\nfn {name}() {{\n    let target = {};\n    let target = Placed {{ geometry: &target, pose: {} }};\n{}    \
             panic!(\"{{:?}}\", raycast(&ray, target, &Accuracy::of(Tier::Exact), &mut Work::default()));\n}}\n",
            target.whole.source(),
            source::pose(target.position, target.rotation),
            source::ray(&self.ray)
        )
    }
}

/// Asks and judges; `None` if the crate refuses the form.
pub(super) fn examine(question: &WholeRay) -> Option<Outcome> {
    let geometry = question.target.whole.geometry().ok()?;
    let target = Placed { geometry: &geometry, pose: question.target.pose() };
    let mut work = Work::default();
    let found = raycast(&question.ray, target, &Accuracy::of(Tier::Exact), &mut work);
    Some(judge(question, &found))
}

/// A ray this near to the plane of a triangle may pass it by.
const IN_PLANE: f64 = 1e-9;

/// Bounds of the way to the first touch of a piece that counts: `Ok(None)` if there is none, an error if that is a matter
/// of rounding.
fn first_touch(question: &WholeRay) -> Result<Option<[f64; 2]>, ()> {
    let (ray, target) = (&question.ray, &question.target);
    let (place, union) = (place_of(target), target.whole.union());
    if union.winds_around(&place, ray.origin) {
        return Ok(Some([0.0, 0.0]));
    }
    let mut first: Option<[f64; 2]> = None;
    for (index, piece) in union.pieces.iter().enumerate() {
        let Some(inside) = stretch_inside_part(&piece.solid, &piece.place(&place), ray.origin, ray.direction) else {
            continue;
        };
        let enter = inside.enter.map(|way| way.max(ray.min_distance));
        if inside.leave[1] < ray.min_distance || inside.enter[0] > ray.max_distance {
            continue;
        }
        if inside.leave[0] < ray.min_distance || inside.enter[1] > ray.max_distance {
            return Err(());
        }
        if let Whole::Mesh { mode, vertices, triangles } = &target.whole {
            let [a, b, c] = triangles[index].map(|corner| vertices[corner as usize]);
            let normal = target.rotation * (b - a).cross(c - a).normalize_or_zero();
            let cosine = normal.dot(ray.direction.normalize_or_zero());
            if cosine.abs() < IN_PLANE {
                return Err(());
            }
            if *mode == MeshMode::OneSided && cosine > 0.0 {
                continue;
            }
        }
        first = match first {
            Some(known) if known[0] <= enter[0] => Some([known[0], known[1].min(enter[1])]),
            Some(known) => Some([enter[0], known[1].min(enter[1])]),
            None => Some(enter),
        };
    }
    Ok(first)
}

fn judge(question: &WholeRay, found: &RayTouches) -> Outcome {
    let mut answer = Answer::to(Asked::Ray);
    answer.is_undecided = found.undecided.is_some();
    let reach = question.target.whole.reach();
    let s = (2.0 * reach + length(question.ray.origin - question.target.position)).max(1e-9);
    answer.width = found.certain.as_ref().map(|touch| touch.certificate.bound.width() / s);
    let said: Vec<_> = found.certain.iter().chain(&found.undecided).collect();
    for touch in &said {
        let bound = touch.certificate.bound;
        if !(bound.lower <= touch.distance && touch.distance <= bound.upper && touch.distance.is_finite()) {
            answer.fault(FaultKind::Form, format!("{touch:?}"));
        }
    }
    let Ok(first) = first_touch(question) else { return Outcome::of(answer) };
    let holds = |bound: Bound, [low, high]: [f64; 2]| bound.lower <= high && low <= bound.upper;
    match (first, &found.certain) {
        (None, Some(certain)) => answer.fault(FaultKind::Verdict, format!("touches nothing, answered {certain:?}")),
        (Some(way), certain) => {
            if said.is_empty() {
                answer.fault(FaultKind::Verdict, format!("touches at {way:?}, answered none"));
            } else if !said.iter().any(|touch| holds(touch.certificate.bound, way)) {
                answer.fault(FaultKind::Bound, format!("touches at {way:?}, answered {said:?}"));
            } else if certain.is_some_and(|certain| certain.certificate.bound.upper < way[0]) {
                answer.fault(FaultKind::Bound, format!("touches at {way:?}, certain is {certain:?}"));
            }
        }
        (None, None) => {}
    }
    Outcome { overlaps: first.is_some(), ..Outcome::of(answer) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_touch_that_is_moved_or_left_out_is_found() {
        let mut found = 0;
        for seed in 0..60 {
            let question = whole_ray(seed, Class::Solid);
            let geometry = question.target.whole.geometry().expect("a solid");
            let target = Placed { geometry: &geometry, pose: question.target.pose() };
            let touches = raycast(&question.ray, target, &Accuracy::of(Tier::Exact), &mut Work::default());
            assert!(judge(&question, &touches).faults().next().is_none(), "{seed}");
            let Some(certain) = touches.certain.filter(|certain| certain.distance > 0.0) else { continue };
            found += 1;
            let Bound { lower, upper } = certain.certificate.bound;
            for by in [1e-6 * upper, -1e-6 * upper] {
                let mut moved = certain;
                (moved.distance, moved.certificate.bound) = (certain.distance + by, Bound::new(lower + by, upper + by));
                let moved = RayTouches { certain: Some(moved), undecided: None };
                assert!(judge(&question, &moved).faults().next().is_some(), "{seed} {by}");
            }
            assert!(judge(&question, &RayTouches::default()).faults().next().is_some(), "{seed}");
        }
        assert!(found > 20, "{found}");
    }
}
