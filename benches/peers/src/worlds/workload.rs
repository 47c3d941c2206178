//! The worlds and what happens in them: the same for every engine, in numbers that f32 holds exactly.

use std::{f64::consts::PI, iter};

use collision::{DVec3, math::Aabb};

use crate::{
    dice::Dice,
    forms::{Form, Place, geometry, pose, single, vector},
};

/// Volume of the cube that the shapes are in, as a multiple of the sum of theirs.
const ROOM: f64 = 20.0;
/// One in so many moves in a tick.
pub(crate) const MOVER_EVERY: usize = 10;
/// Shapes that go and come back in a round.
pub(crate) const REPLACED: usize = 1000;
/// How far shapes that move far go, metres.
const FAR: f64 = 10.0;
/// How far shapes that move a little go, metres.
const NEAR: f64 = 0.1;
/// Questions of each kind.
const QUESTIONS: usize = 10_000;
/// Half extent of the boxes that are asked about, metres.
const CUBOID: f32 = 2.5;

/// A ray or the way of a ball.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Line {
    pub(crate) origin: [f32; 3],
    /// A unit vector, but for the rounding to f32.
    pub(crate) direction: [f32; 3],
}

/// A box whose corners f32 holds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Bounds {
    pub(crate) min: [f32; 3],
    pub(crate) max: [f32; 3],
}

impl Bounds {
    /// The least that holds a box.
    fn around(bounds: Aabb) -> Self {
        let low = |value: f64| if f64::from(value as f32) > value { (value as f32).next_down() } else { value as f32 };
        let high = |value: f64| if f64::from(value as f32) < value { (value as f32).next_up() } else { value as f32 };
        Self { min: bounds.min.to_array().map(low), max: bounds.max.to_array().map(high) }
    }

    pub(crate) fn to_f64(self) -> Aabb {
        Aabb::new(vector(self.min), vector(self.max))
    }

    fn moved(self, way: DVec3) -> Self {
        let bounds = self.to_f64();
        Self::around(Aabb::new(bounds.min + way, bounds.max + way))
    }
}

/// A shape of a world has a new box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Change {
    pub(crate) shape: u32,
    pub(crate) bounds: Bounds,
}

/// How the shapes of a round change.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Step {
    Near,
    Far,
    /// To anywhere in the cube.
    Anywhere,
}

/// A world, and what it is asked.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Workload {
    /// Of each shape.
    pub(crate) forms: Vec<Form>,
    pub(crate) places: Vec<Place>,
    /// The box of each shape, which is what trees get.
    pub(crate) boxes: Vec<Bounds>,
    /// A tenth of the shapes and where each goes that moves far.
    pub(crate) far_moves: Vec<(u32, Place)>,
    pub(crate) rays: Vec<Line>,
    /// Middles of balls.
    pub(crate) balls: Vec<[f32; 3]>,
    /// Of half extent [`CUBOID`].
    pub(crate) cuboids: Vec<Place>,
    /// Ways that a ball may take, in a random order; some begin where it has no room.
    pub(crate) ways: Vec<Line>,
    /// Half the width of the cube around the origin, metres.
    half_width: f64,
}

/// Kinds in turn.
fn form(number: usize, dice: &mut Dice) -> Form {
    match number % 4 {
        0 | 1 => Form::Cuboid([(); 3].map(|()| dice.within(0.1, 1.0) as f32)),
        2 => Form::Ball(dice.within(0.1, 1.0) as f32),
        _ => Form::Capsule { half_height: dice.within(0.1, 0.5) as f32, radius: dice.within(0.1, 0.5) as f32 },
    }
}

fn volume(form: &Form) -> f64 {
    let ball = |radius: f64| 4.0 / 3.0 * PI * radius.powi(3);
    match form {
        Form::Cuboid(half_extents) => 8.0 * half_extents.iter().copied().map(f64::from).product::<f64>(),
        Form::Ball(radius) => ball(f64::from(*radius)),
        Form::Capsule { half_height, radius } => {
            let (half_height, radius) = (f64::from(*half_height), f64::from(*radius));
            ball(radius) + 2.0 * half_height * PI * radius * radius
        }
        Form::Hull(_) => unreachable!("there is no hull in a world"),
    }
}

fn place(dice: &mut Dice, half_width: f64) -> Place {
    Place { position: single(dice.point(half_width)), rotation: dice.rotation().to_array().map(|part| part as f32) }
}

fn line(dice: &mut Dice, half_width: f64) -> Line {
    Line { origin: single(dice.point(half_width)), direction: single(dice.direction()) }
}

/// `count` different numbers below `below`.
fn pick(dice: &mut Dice, count: usize, below: usize) -> Vec<u32> {
    let mut numbers: Vec<u32> = (0..below as u32).collect();
    for at in 0..count {
        numbers.swap(at, at + dice.index(below - at));
    }
    numbers.truncate(count);
    numbers
}

impl Workload {
    /// A world of `count` shapes; the same for the same number.
    pub(crate) fn new(count: usize) -> Self {
        let dice = &mut Dice::new(count as u64);
        let forms: Vec<Form> = (0..count).map(|number| form(number, dice)).collect();
        let half_width = 0.5 * (ROOM * forms.iter().map(volume).sum::<f64>()).cbrt();
        let places: Vec<Place> = iter::repeat_with(|| place(dice, half_width)).take(count).collect();
        let boxes = forms.iter().zip(&places).map(|(form, place)| Bounds::around(geometry(form).bounds(&pose(place))));
        let boxes = boxes.collect();
        let far_moves = pick(dice, count / MOVER_EVERY, count).into_iter().map(|shape| {
            let place = places[shape as usize];
            (shape, Place { position: single(vector(place.position) + dice.direction() * FAR), ..place })
        });
        let far_moves = far_moves.collect();
        Self {
            far_moves,
            rays: iter::repeat_with(|| line(dice, half_width)).take(QUESTIONS).collect(),
            balls: iter::repeat_with(|| single(dice.point(half_width))).take(QUESTIONS).collect(),
            cuboids: iter::repeat_with(|| place(dice, half_width)).take(QUESTIONS).collect(),
            ways: iter::repeat_with(|| line(dice, half_width)).take(2 * QUESTIONS).collect(),
            forms,
            places,
            boxes,
            half_width,
        }
    }

    /// The form of the boxes that are asked about.
    pub(crate) fn cuboid() -> Form {
        Form::Cuboid([CUBOID; 3])
    }

    /// The first ways of [`Workload::ways`] that begin where there is room.
    pub(crate) fn free_ways(&self, is_free: impl Fn(&[f32; 3]) -> bool) -> Vec<Line> {
        self.ways.iter().filter(|way| is_free(&way.origin)).take(QUESTIONS).copied().collect()
    }

    /// What changes in one round: shapes picked at random, and their new boxes. `boxes` are those of before, and are
    /// brought up to date. The same for the same boxes and round.
    pub(crate) fn round(&self, step: Step, round: u64, boxes: &mut [Bounds]) -> Vec<Change> {
        let count = match step {
            Step::Near | Step::Far => boxes.len() / MOVER_EVERY,
            Step::Anywhere => REPLACED,
        };
        let dice = &mut Dice::new(((round + 1) << 8) + step as u64);
        let picked = pick(dice, count, boxes.len());
        let change = |shape: u32| {
            let old = &mut boxes[shape as usize];
            let way = match step {
                Step::Near => dice.direction() * NEAR,
                Step::Far => dice.direction() * FAR,
                Step::Anywhere => dice.point(self.half_width) - old.to_f64().center(),
            };
            *old = old.moved(way);
            Change { shape, bounds: *old }
        };
        picked.into_iter().map(change).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_world_is_the_same_each_time_and_five_hundredths_of_its_cube_are_filled() {
        let workload = Workload::new(1000);
        assert_eq!(workload, Workload::new(1000));
        let volumes: f64 = workload.forms.iter().map(volume).sum();
        let share = volumes / (2.0 * workload.half_width).powi(3);
        assert!((share - 0.05).abs() < 1e-9, "{share}");
        assert_eq!(workload.far_moves.len(), 100);
    }

    #[test]
    fn a_round_changes_each_of_its_shapes_once_by_its_step() {
        let workload = Workload::new(1000);
        for (step, most, count) in [(Step::Near, 0.11, 100), (Step::Far, 10.1, 100), (Step::Anywhere, 1e3, 1000)] {
            let mut boxes = workload.boxes.clone();
            let changes = workload.round(step, 3, &mut boxes);
            assert_eq!(changes.len(), count);
            let mut shapes: Vec<u32> = changes.iter().map(|change| change.shape).collect();
            shapes.sort_unstable();
            shapes.dedup();
            assert_eq!(shapes.len(), count, "each once");
            for Change { shape, bounds } in changes {
                let (old, new) = (workload.boxes[shape as usize].to_f64(), bounds.to_f64());
                assert_eq!(boxes[shape as usize], bounds);
                let way = (new.center() - old.center()).length();
                assert!(way <= most, "{step:?}: {way}");
                let growth = (new.max - new.min) - (old.max - old.min);
                assert!(growth.abs().max_element() < 1e-4, "as large as before");
            }
        }
    }
}
