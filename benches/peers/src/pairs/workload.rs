//! The pairs that are asked about: the same for every engine, in numbers that f32 holds exactly.

use std::iter;

use collision::{
    DVec3,
    accuracy::{Accuracy, Tier},
    answer::{Verdict, Work},
    math::Pose,
    narrow::{self, Placed},
    shape::Geometry,
};

use super::rows::Pairing;
use crate::{
    dice::Dice,
    forms::{Form, Place, geometry, pose, single, vector},
};

/// How many shapes of each kind there are.
const SHAPES: usize = 256;
/// Coordinates of the places, metres.
const PLACE: f64 = 10.0;
/// How far beyond first contact, in or out, a pair near contact is at most, metres.
const NEAR: f64 = 0.2;
/// How far beside the other shape's middle a crossing may aim, as a multiple of where the two touch there: about two
/// thirds hit.
const AIM: f64 = 1.6;
/// The least and the greatest turn of a crossing, degrees.
const TURN_DEG: [f64; 2] = [11.0, 61.0];
/// Halvings when contact is sought: 2 m to a twentieth of a millimetre.
const HALVINGS: u32 = 16;

/// A shape of [`Workload::forms`] at a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Placement {
    pub(crate) form: usize,
    pub(crate) place: Place,
}

/// `a` stands, `b` crosses its way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Crossing {
    pub(crate) a: Placement,
    pub(crate) b: Placement,
    /// How far `b` goes, metres.
    pub(crate) displacement: [f32; 3],
    /// How `b` turns if it does, a rotation vector in world axes, radians.
    pub(crate) turn: [f32; 3],
    /// How far the fastest point of `b` goes without the turn, metres.
    pub(crate) way: f64,
    /// The same with the turn: its greatest speed is that of the way and that of the turn together.
    pub(crate) way_turning: f64,
}

/// All pairs of a pairing.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Workload {
    /// The shapes: those of `a` first, then those of `b` if they are of another kind.
    pub(crate) forms: Vec<Form>,
    /// Within [`NEAR`] of contact, in and out in turn.
    pub(crate) near: Vec<[Placement; 2]>,
    /// Apart at the start.
    pub(crate) crossings: Vec<Crossing>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Cuboid,
    Ball,
    Capsule,
    Hull(usize),
}

fn kinds(pairing: Pairing) -> [Kind; 2] {
    match pairing {
        Pairing::BoxBox => [Kind::Cuboid; 2],
        Pairing::CapsuleBox => [Kind::Capsule, Kind::Cuboid],
        Pairing::SphereHull32 => [Kind::Ball, Kind::Hull(32)],
        Pairing::Hull8 => [Kind::Hull(8); 2],
        Pairing::Hull32 => [Kind::Hull(32); 2],
        Pairing::Hull128 => [Kind::Hull(128); 2],
    }
}

fn form(kind: Kind, dice: &mut Dice) -> Form {
    match kind {
        Kind::Cuboid => Form::Cuboid([(); 3].map(|()| dice.within(0.1, 1.0) as f32)),
        Kind::Ball => Form::Ball(dice.within(0.1, 1.0) as f32),
        Kind::Capsule => {
            Form::Capsule { half_height: dice.within(0.1, 0.7) as f32, radius: dice.within(0.1, 0.5) as f32 }
        }
        Kind::Hull(count) => {
            let radius = dice.within(0.3, 1.0);
            Form::Hull((0..count).map(|_| single(dice.direction() * radius)).collect())
        }
    }
}

impl Workload {
    /// `count` pairs near contact and as many crossings; the same for the same arguments.
    pub(crate) fn new(pairing: Pairing, count: usize) -> Self {
        let [kind_a, kind_b] = kinds(pairing);
        let dice = &mut Dice::new(pairing as u64 + 1);
        let mut forms: Vec<Form> = iter::repeat_with(|| form(kind_a, dice)).take(SHAPES).collect();
        if kind_b != kind_a {
            forms.extend(iter::repeat_with(|| form(kind_b, dice)).take(SHAPES));
        }
        let geometries: Vec<Geometry> = forms.iter().map(geometry).collect();
        let near = (0..count).map(|number| near(&geometries, dice, number.is_multiple_of(2))).collect();
        let crossings = (0..count).map(|_| crossing(&forms, &geometries, dice)).collect();
        Self { forms, near, crossings }
    }
}

/// Which shapes, and how they lie.
fn draw(geometries: &[Geometry], dice: &mut Dice) -> [Placement; 2] {
    let forms = [dice.index(SHAPES), geometries.len() - SHAPES + dice.index(SHAPES)];
    let position = single(dice.point(PLACE));
    forms.map(|form| {
        let rotation = dice.rotation().to_array().map(|part| part as f32);
        Placement { form, place: Place { position, rotation } }
    })
}

fn moved(Placement { form, place }: Placement, way: DVec3) -> Placement {
    let position = single(vector(place.position) + way);
    Placement { form, place: Place { position, ..place } }
}

fn near(geometries: &[Geometry], dice: &mut Dice, is_inside: bool) -> [Placement; 2] {
    loop {
        let [a, b] = draw(geometries, dice);
        let direction = dice.direction();
        let beyond = dice.within(0.0, NEAR);
        let Some(contact) = contact_distance(geometries, [a, b], direction) else { continue };
        let distance = if is_inside { (contact - beyond).max(0.0) } else { contact + beyond };
        return [a, moved(b, direction * distance)];
    }
}

fn crossing(forms: &[Form], geometries: &[Geometry], dice: &mut Dice) -> Crossing {
    loop {
        let [a, b] = draw(geometries, dice);
        let direction = dice.direction();
        let aside = direction.cross(dice.direction());
        let aim = dice.within(0.0, AIM);
        let axis = dice.direction();
        let angle = dice.within(TURN_DEG[0], TURN_DEG[1]).to_radians();
        let Some(aside) = aside.try_normalize() else { continue };
        let Some(contact) = contact_distance(geometries, [a, b], aside) else { continue };
        // Twice the sum of both radii is four mean radii.
        let half_way = 2.0 * (geometries[a.form].reach() + geometries[b.form].reach());
        let displacement = single(direction * (2.0 * half_way));
        let turn = single(axis * angle);
        let way = vector(displacement).length();
        let spin = vector(turn).length() * reach_from_axis(&forms[b.form], pose(&b.place), axis);
        let b = moved(b, aside * (aim * contact) - direction * half_way);
        return Crossing { a, b, displacement, turn, way, way_turning: way + spin };
    }
}

/// How far a form at a pose reaches from an axis (a unit vector) through its own origin.
fn reach_from_axis(form: &Form, pose: Pose, axis: DVec3) -> f64 {
    let axis = pose.unit_rotation().conjugate() * axis;
    let farthest = |points: &[[f32; 3]]| {
        points.iter().map(|&point| axis.cross(vector(point)).length()).max_by(f64::total_cmp).unwrap_or(0.0)
    };
    match form {
        Form::Cuboid([x, y, z]) => farthest(&[[*x, *y, *z], [-x, *y, *z], [*x, -y, *z], [*x, *y, -z]]),
        Form::Ball(radius) => f64::from(*radius),
        Form::Capsule { half_height, radius } => farthest(&[[0.0, *half_height, 0.0]]) + f64::from(*radius),
        Form::Hull(points) => farthest(points),
    }
}

/// How far `b` goes from `a`'s own place before the two come apart; `None` if they do not overlap there. Halved by
/// verdicts alone, so that a more exact kernel does not change the pairs.
fn contact_distance(geometries: &[Geometry], pair: [Placement; 2], direction: DVec3) -> Option<f64> {
    let [a, b] = pair.map(|place| Placed { geometry: &geometries[place.form], pose: pose(&place.place) });
    let accuracy = Accuracy::of(Tier::Standard);
    let touches_at = |distance: f64| {
        let pose = Pose::new(b.pose.position + direction * distance, b.pose.rotation);
        narrow::overlap(a, Placed { pose, ..b }, &accuracy, &mut Work::default()).verdict == Verdict::Hit
    };
    if !touches_at(0.0) {
        return None;
    }
    let (mut inside, mut outside) = (0.0, a.geometry.reach() + b.geometry.reach());
    for _ in 0..HALVINGS {
        let middle = 0.5 * (inside + outside);
        if touches_at(middle) {
            inside = middle;
        } else {
            outside = middle;
        }
    }
    Some(inside)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pairs::rows::PAIRINGS;

    #[test]
    fn a_workload_is_the_same_each_time() {
        let first = Workload::new(Pairing::CapsuleBox, 100);
        assert_eq!(first, Workload::new(Pairing::CapsuleBox, 100));
        assert_eq!(first.forms.len(), 512);
        assert_ne!(first.near[0], first.near[2]);
    }

    #[test]
    fn crossings_start_apart() {
        for pairing in PAIRINGS {
            let workload = Workload::new(pairing, 400);
            let geometries: Vec<Geometry> = workload.forms.iter().map(geometry).collect();
            for crossing in &workload.crossings {
                let placed = |place: &Placement| Placed { geometry: &geometries[place.form], pose: pose(&place.place) };
                let [a, b] = [placed(&crossing.a), placed(&crossing.b)];
                let certificate = narrow::overlap(a, b, &Accuracy::default(), &mut Work::default());
                assert_eq!(certificate.verdict, Verdict::Miss, "{pairing:?}");
            }
        }
    }
}
