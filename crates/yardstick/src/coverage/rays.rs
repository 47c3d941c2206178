//! Random rays at one form, and what is true of them.

use collision::{
    accuracy::{Accuracy, Tier},
    answer::Work,
    math::Pose,
    narrow::{Faces, Placed, Ray, RayTouch, RayTouches, raycast},
};
use glam::{DQuat, DVec3};

use super::{
    ask::geometry,
    forms::{Kind, Style, form, power_of_ten},
    outcome::{Answer, Asked, FaultKind, Outcome},
};
use crate::{
    oracle::{Core, Inside, PlacedSolid, Solid, Truth, length, stretch_inside},
    scene::Random,
};

/// A ray and its target.
#[derive(Clone, Debug)]
pub struct RayQuestion {
    /// What is hard about it.
    pub category: &'static str,
    /// What it is cast at.
    pub target: PlacedSolid,
    /// The ray.
    pub ray: Ray,
}

const CATEGORIES: [&str; 7] = ["generic", "distant", "deep_inside", "grazing", "coplanar", "far_offset", "awkward"];

/// The question that a seed and a kind name.
#[must_use]
pub fn ray_question(seed: u64, kind: Kind) -> RayQuestion {
    let mut random = Random::new(seed);
    let random = &mut random;
    let category = CATEGORIES[(random.bits() % CATEGORIES.len() as u64) as usize];
    let size = if random.one_in(2) { 1.0 } else { power_of_ten(random, -6.0, 6.0) };
    let style = match category {
        "coplanar" => Style::Dyadic,
        "awkward" if random.one_in(2) => Style::Denormal,
        "awkward" => Style::Stretched,
        _ => Style::Plain,
    };
    let size = if style == Style::Dyadic { 2f64.powf(size.log2().round()) } else { size };
    let solid = form(random, kind, style, size);
    let mut target = PlacedSolid { solid, position: random.direction() * size, rotation: random.rotation() };
    let reach = target.solid.reach().max(1e-9);
    let (origin, direction) = match category {
        "grazing" => grazing(random, &target, reach),
        "coplanar" => {
            target.position = (target.position * (8.0 / size)).round() * (size / 8.0);
            target.rotation = DQuat::IDENTITY;
            let axis = [DVec3::X, DVec3::Y, DVec3::NEG_Z][(random.bits() % 3) as usize];
            let beside = (random.direction() * 8.0).round() * (size / 8.0);
            (target.position + beside - axis * (4.0 * size), axis)
        }
        _ => {
            let far = match category {
                "deep_inside" => random.uniform(0.0, 0.5),
                "distant" => power_of_ten(random, 1.0, 9.0),
                _ => random.uniform(0.5, 4.0),
            };
            let origin = target.position + random.direction() * (reach * far).min(1e11);
            let aim = target.position + random.direction() * (reach * random.uniform(0.0, 1.1));
            (origin, aim - origin)
        }
    };
    let offset = if category == "far_offset" { power_of_ten(random, 3.0, 9.0) } else { 0.0 };
    let offset = random.direction() * offset;
    target.position += offset;
    let direction = if direction == DVec3::ZERO { random.direction() } else { direction };
    let stretch = if random.one_in(8) { 1e-120 } else { power_of_ten(random, -3.0, 3.0) };
    let ray = limited(random, origin + offset, direction * stretch, reach);
    let category = match (category, style) {
        ("awkward", Style::Denormal) => "denormal",
        ("awkward", _) => "aspect",
        _ => category,
    };
    RayQuestion { category, target, ray }
}

fn limited(random: &mut Random, origin: DVec3, direction: DVec3, reach: f64) -> Ray {
    let min_distance = if random.one_in(8) { reach * random.uniform(0.0, 2.0) } else { 0.0 };
    let max_distance = if random.one_in(8) { min_distance + reach * random.uniform(0.0, 3.0) } else { 4e12 };
    let faces = [Faces::Both, Faces::Both, Faces::Front, Faces::Back][(random.bits() % 4) as usize];
    Ray { origin, direction, min_distance, max_distance, hollow: random.one_in(3), faces }
}

/// A ray that passes at the height of the highest point along a direction across it, or a little above or below.
fn grazing(random: &mut Random, target: &PlacedSolid, reach: f64) -> (DVec3, DVec3) {
    let up = random.direction();
    let along = up.cross(random.direction()).normalize_or(up.any_orthonormal_vector());
    let middle = PlacedSolid { solid: Solid { core: Core::Point, radius: 0.0 }, ..target.clone() };
    let height = -Truth::of(target, &middle, &[]).gap_along(up);
    let off = power_of_ten(random, -17.0, -1.0) * if random.one_in(2) { 1.0 } else { -1.0 };
    (target.position + up * (height * (1.0 + off)) - along * (3.0 * reach), along)
}

/// What the kernel says; `None` if the form is refused.
pub(super) fn cast(question: &RayQuestion) -> Option<RayTouches> {
    let geometry = geometry(&question.target.solid).ok()?;
    let pose = Pose::new(question.target.position, question.target.rotation);
    let target = Placed { geometry: &geometry, pose };
    Some(raycast(&question.ray, target, &Accuracy::of(Tier::Exact), &mut Work::default()))
}

/// What is true of a ray.
enum Expected {
    Nothing,
    /// Bounds of the way, and the cosine of incidence; `None` if it begins inside.
    Touch([f64; 2], Option<f64>),
    /// Within rounding of a limit.
    Open,
}

fn expected(ray: &Ray, stretch: Option<&Inside>) -> Expected {
    let Some(stretch) = stretch else { return Expected::Nothing };
    let (min, max) = (ray.min_distance, ray.max_distance);
    let [enter, leave] = [(stretch.enter, stretch.cosines[0]), (stretch.leave, stretch.cosines[1])];
    if ray.faces == Faces::Both && !ray.hollow {
        return if stretch.leave[1] < min || stretch.enter[0] > max {
            Expected::Nothing
        } else if stretch.leave[0] < min || stretch.enter[1] > max {
            Expected::Open
        } else {
            let begins_outside = stretch.enter[0] >= min;
            Expected::Touch(stretch.enter.map(|way| way.max(min)), begins_outside.then_some(stretch.cosines[0]))
        };
    }
    let walls = match ray.faces {
        Faces::Both => vec![enter, leave],
        Faces::Front => vec![enter],
        Faces::Back => vec![leave],
    };
    for (bounds, cosine) in walls {
        if bounds[0] >= min && bounds[1] <= max {
            return Expected::Touch(bounds, Some(cosine));
        }
        if bounds[1] >= min && bounds[0] <= max {
            return Expected::Open;
        }
    }
    Expected::Nothing
}

/// Errors are relative to the size of the form and the way to it, and to at least this, metres.
const SCALE_MIN: f64 = 1e-9;

/// Touches may stay open within this part of s of a graze or a limit.
const OPEN: f64 = 1e-11;

/// Widest interval to accept, as a part of s over the cosine of incidence, where that is not small.
const WIDE: f64 = 1e-12;
const COSINE_MIN: f64 = 1e-2;

/// Judges what the kernel says of a ray.
#[must_use]
pub fn judge_ray(question: &RayQuestion, answer: &RayTouches) -> Outcome {
    let (ray, target) = (&question.ray, &question.target);
    let s = (2.0 * target.solid.reach() + length(ray.origin - target.position)).max(SCALE_MIN);
    let stretch = stretch_inside(target, ray.origin, ray.direction);
    let mut judged = Answer::to(Asked::Ray);
    let mut fault = |kind: FaultKind, what: String| judged.fault(kind, format!("{what}; truth {stretch:?}, s {s:e}"));
    let said: Vec<&RayTouch> = answer.certain.iter().chain(&answer.undecided).collect();
    for touch in &said {
        let bound = touch.certificate.bound;
        if !(bound.lower <= touch.distance && touch.distance <= bound.upper && touch.distance.is_finite()) {
            fault(FaultKind::Form, format!("ray {:e} in [{:e}, {:e}]", touch.distance, bound.lower, bound.upper));
        }
    }
    let bounds: Vec<_> = said.iter().map(|touch| touch.certificate.bound).collect();
    match expected(ray, stretch.as_ref()) {
        Expected::Nothing if answer.certain.is_some() => fault(FaultKind::Verdict, format!("ray: HIT {bounds:?}")),
        Expected::Touch([low, high], cosine) => {
            let holds = |bound: &&collision::answer::Bound| bound.lower <= high && low <= bound.upper;
            let near_limit = (low - ray.min_distance).min(ray.max_distance - high) <= OPEN * s;
            let deep = stretch.is_some_and(|stretch| stretch.middle_depth > OPEN * s) && !near_limit;
            if bounds.is_empty() {
                fault(FaultKind::Verdict, format!("ray: MISS of [{low:e}, {high:e}]"));
            } else if bounds.iter().find(holds).is_none() {
                fault(FaultKind::Bound, format!("ray: {bounds:?} is not [{low:e}, {high:e}]"));
            } else if answer.certain.is_none() && deep {
                fault(FaultKind::Undecided, format!("ray: {bounds:?}"));
            } else if let (Some(touch), Some(cosine)) = (&answer.certain, cosine) {
                let width = touch.certificate.bound.width() / s;
                if deep && cosine >= COSINE_MIN && width > WIDE / cosine {
                    fault(FaultKind::Width, format!("ray: {width:e} s wide at cosine {cosine:e}: {bounds:?}"));
                }
            }
        }
        Expected::Nothing | Expected::Open => {}
    }
    judged.is_undecided = answer.undecided.is_some();
    judged.width = answer.certain.as_ref().map(|touch| touch.certificate.bound.width() / s);
    Outcome { overlaps: stretch.is_some(), ..Outcome::of(judged) }
}
