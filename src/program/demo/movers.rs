//! What moves, and how: each kind has a way of its own, and none of them goes through a wall.

use std::f64::consts::TAU;

use calipers_client::{Client, Error, edit, geometry, proto, shape};

use super::Dice;
use super::balls::Balls;
use super::floor_plan::{FloorPlan, Room};
use super::level::{LAYER_MOVING, LAYERS_ALL, about_y};
use super::walker::Walker;

const WALKERS: u64 = 10_000;
const CARTS: u64 = 11_000;
const DRONES: u64 = 12_000;
const BALLS: u64 = 13_000;
const LIFTS: u64 = 14_000;

const WALKER_COUNT: usize = 160;
const CART_COUNT: usize = 24;
const DRONE_COUNT: usize = 80;
const BALL_COUNT: usize = 48;

/// The carts' way: half of it along x and z, and the radius of its corners.
const CIRCUIT_HALF: [f64; 2] = [34.0, 24.0];
const CIRCUIT_CORNER: f64 = 2.0;

/// Everything that moves.
#[derive(Debug)]
pub(super) struct Movers {
    plan: FloorPlan,
    dice: Dice,
    walkers: Vec<Walker>,
    balls: Balls,
    drones: Vec<Drone>,
    /// Seconds since the demo began.
    time: f64,
}

/// Circles above the ground.
#[derive(Clone, Copy, Debug)]
struct Drone {
    middle: [f64; 3],
    radius: f64,
    /// Radians a second on its circle, and about itself.
    turn_rate: f64,
    spin_rate: f64,
    phase: f64,
}

/// Where something is and how it is turned.
type Place = ([f64; 3], [f64; 4]);

impl Movers {
    pub(super) fn new(plan: &FloorPlan, dice: &mut Dice) -> Self {
        let rooms: Vec<Room> = Room::all().collect();
        let walkers = (0..WALKER_COUNT).map(|index| Walker::new(plan, rooms[index % rooms.len()], dice)).collect();
        let balls = Balls::new((0..BALL_COUNT).map(|index| rooms[index % rooms.len()]), dice);
        let drones = (0..DRONE_COUNT).map(|_| Drone::new(dice)).collect();
        Self { plan: plan.clone(), dice: dice.clone(), walkers, balls, drones, time: 0.0 }
    }

    /// The edits that put everything where it begins.
    pub(super) fn inserts(&self) -> Vec<proto::Edit> {
        let insert = |(id, (at, rotation)): (u64, Place)| {
            shape::of(id, form(id)).at(at).rotated(rotation).layers(LAYER_MOVING, LAYERS_ALL).insert()
        };
        self.places().map(insert).collect()
    }

    /// Goes on by some seconds, and says what moved where.
    ///
    /// # Errors
    /// The balls' questions can fail.
    pub(super) async fn step(&mut self, client: &Client, seconds: f64) -> Result<Vec<proto::Edit>, Error> {
        self.time += seconds;
        for walker in &mut self.walkers {
            walker.step(&self.plan, &mut self.dice, seconds);
        }
        self.balls.step(client, seconds).await?;
        Ok(self.places().map(|(id, (at, rotation))| edit::move_and_turn(id, at, rotation)).collect())
    }

    /// Where everything is.
    fn places(&self) -> impl Iterator<Item = (u64, Place)> {
        let carts = (0..CART_COUNT).map(|index| self.cart(index));
        let drones = self.drones.iter().map(|drone| drone.place(self.time));
        let lifts = (0..4).map(|index| self.lift(index));
        (WALKERS..)
            .zip(self.walkers.iter().map(Walker::place))
            .chain((CARTS..).zip(carts))
            .chain((DRONES..).zip(drones))
            .chain((BALLS..).zip(self.balls.places()))
            .chain((LIFTS..).zip(lifts))
    }

    /// All carts go at the same pace, evenly spread.
    fn cart(&self, index: usize) -> Place {
        let share = (index as f64 / CART_COUNT as f64 + self.time / 90.0).fract();
        let ([x, z], angle) = on_circuit(share);
        ([x, 0.5, z], about_y(angle))
    }

    /// Up and down on an outer wall.
    fn lift(&self, index: usize) -> Place {
        let side = if index < 2 { 1.0 } else { -1.0 };
        let along = if index.is_multiple_of(2) { 12.0 } else { -12.0 };
        let height = 1.6 + 1.4 * (TAU * (self.time / 8.0 + 0.25 * index as f64)).sin();
        ([side * 31.2, height, along], about_y(0.0))
    }
}

/// The form of a mover, by its number.
fn form(id: u64) -> proto::Geometry {
    match id {
        WALKERS..CARTS => geometry::capsule(0.55, 0.3),
        CARTS..DRONES => geometry::cuboid([0.9, 0.4, 0.5]),
        DRONES..BALLS if id.is_multiple_of(2) => geometry::sphere(0.35),
        DRONES..BALLS => geometry::cuboid([0.5, 0.1, 0.5]),
        BALLS..LIFTS => Balls::form(),
        _ => geometry::cuboid([1.0, 0.1, 1.0]),
    }
}

/// The point of the carts' way, and the angle they face, at a share of it from 0 to 1.
fn on_circuit(share: f64) -> ([f64; 2], f64) {
    let straight = CIRCUIT_HALF.map(|half| 2.0 * (half - CIRCUIT_CORNER));
    let arc = 0.25 * TAU * CIRCUIT_CORNER;
    let mut left = share * 2.0 * (straight[0] + straight[1] + 2.0 * arc);
    // Four times a straight and the corner after it; `angle` is that of the straight, its direction in x and z being
    // (cos, -sin) as the rotation about y has it.
    let mut at = [-0.5 * straight[0], -CIRCUIT_HALF[1]];
    let mut angle = 0.0_f64;
    for side in 0..4 {
        let length = straight[side % 2];
        let gone = left.min(length);
        at = [at[0] + gone * angle.cos(), at[1] - gone * angle.sin()];
        left -= gone;
        let turn = left.min(arc) / CIRCUIT_CORNER;
        let turned = angle - turn;
        let shift = |of: f64, to: f64| CIRCUIT_CORNER * (of - to);
        at = [at[0] + shift(angle.sin(), turned.sin()), at[1] + shift(angle.cos(), turned.cos())];
        left -= turn * CIRCUIT_CORNER;
        angle = turned;
        if left <= 0.0 {
            break;
        }
    }
    (at, angle)
}

impl Drone {
    fn new(dice: &mut Dice) -> Self {
        let turn = dice.between(0.0, TAU);
        let out = dice.between(0.85, 1.15);
        let fast = dice.pick(&[-1.0, 1.0]);
        Self {
            middle: [62.0 * out * turn.cos(), dice.between(6.0, 14.0), 50.0 * out * turn.sin()],
            radius: dice.between(2.0, 6.0),
            turn_rate: fast * dice.between(0.3, 1.2),
            spin_rate: dice.between(-3.0, 3.0),
            phase: dice.between(0.0, TAU),
        }
    }

    fn place(&self, time: f64) -> Place {
        let turn = self.phase + self.turn_rate * time;
        let [x, y, z] = self.middle;
        let at = [x + self.radius * turn.cos(), y + 0.5 * (0.7 * turn).sin(), z + self.radius * turn.sin()];
        (at, about_y((self.spin_rate * time) % TAU))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_few_hundred_shapes_move_under_numbers_of_their_own() {
        let mut dice = Dice::new(1);
        let plan = FloorPlan::new(&mut dice);
        let movers = Movers::new(&plan, &mut dice);
        let mut ids: Vec<u64> = movers.places().map(|(id, _)| id).collect();
        assert_eq!(ids.len(), WALKER_COUNT + CART_COUNT + DRONE_COUNT + BALL_COUNT + 4);
        ids.dedup();
        assert_eq!(ids.len(), movers.inserts().len());
    }

    #[test]
    fn the_circuit_is_closed_and_without_leaps() {
        let ([mut x, mut z], _) = on_circuit(0.999_75);
        for index in 0..4000 {
            let ([next_x, next_z], angle) = on_circuit(f64::from(index) / 4000.0);
            let step = (next_x - x).hypot(next_z - z);
            assert!(step < 0.07, "{step} m at step {index}");
            // Ahead is where it goes.
            let ahead = (next_x - x) * angle.cos() - (next_z - z) * angle.sin();
            assert!(ahead > 0.9 * step, "step {index}");
            assert!(next_x.abs() <= CIRCUIT_HALF[0] + 1e-9 && next_z.abs() <= CIRCUIT_HALF[1] + 1e-9);
            [x, z] = [next_x, next_z];
        }
    }
}
