//! Walkers go from room to room through the doorways, keeping to the right of the middle line.

use std::collections::VecDeque;

use super::Dice;
use super::floor_plan::{FloorPlan, Heading, Room};
use super::level::about_y;

/// From the middle line to the walker; with its radius of 0.3 m it keeps clear of a doorway 2 m wide.
const LANE: f64 = 0.45;
/// Height of a walker's middle, so that it stands on the floor.
const MIDDLE: f64 = 0.86;

/// One that walks.
#[derive(Clone, Debug)]
pub(super) struct Walker {
    /// x and z.
    at: [f64; 2],
    heading: Heading,
    /// The room it is on its way to.
    goal: Room,
    /// Where it goes straight to, one after the other.
    corners: VecDeque<[f64; 2]>,
    /// Metres a second.
    speed: f64,
}

impl Walker {
    /// One that begins in a room, somewhere on the way into the next.
    pub(super) fn new(plan: &FloorPlan, room: Room, dice: &mut Dice) -> Self {
        let heading = dice.pick(&plan.ways(room));
        let mut walker = Self {
            at: beside(room.middle(), &[heading]),
            heading,
            goal: room.next(heading).unwrap_or(room),
            corners: VecDeque::new(),
            speed: dice.between(0.8, 1.8),
        };
        let seconds = dice.between(0.0, 5.0);
        walker.step(plan, dice, seconds);
        walker
    }

    /// Where it is, and how it is turned.
    pub(super) fn place(&self) -> ([f64; 3], [f64; 4]) {
        let [x, z] = self.at;
        let angle = match self.heading {
            Heading::East => 0.0_f64,
            Heading::South => -90.0,
            Heading::West => 180.0,
            Heading::North => 90.0,
        };
        ([x, MIDDLE, z], about_y(angle.to_radians()))
    }

    /// Goes on by some seconds.
    pub(super) fn step(&mut self, plan: &FloorPlan, dice: &mut Dice, seconds: f64) {
        let mut left = self.speed * seconds;
        // Every turn of this loop but the last uses up a corner; a step crosses few of them.
        while left > 0.0 {
            let Some(&[x, z]) = self.corners.front() else {
                self.choose(plan, dice);
                continue;
            };
            let [to_x, to_z] = [x - self.at[0], z - self.at[1]];
            let distance = to_x.hypot(to_z);
            if distance <= left {
                self.at = [x, z];
                self.corners.pop_front();
                left -= distance;
            } else {
                let share = left / distance;
                self.at = [self.at[0] + share * to_x, self.at[1] + share * to_z];
                left = 0.0;
            }
        }
    }

    /// Chooses where to go from the room ahead, and so where to turn in it: back only where there is no other way.
    fn choose(&mut self, plan: &FloorPlan, dice: &mut Dice) {
        let room = self.goal;
        let mut ways = plan.ways(room);
        if ways.len() > 1 {
            ways.retain(|way| *way != self.heading.back());
        }
        let next = dice.pick(&ways);
        let middle = room.middle();
        if next == self.heading {
            self.corners.push_back(beside(middle, &[next]));
        } else if next == self.heading.back() {
            self.corners.push_back(beside(middle, &[self.heading]));
            self.corners.push_back(beside(middle, &[next]));
        } else {
            self.corners.push_back(beside(middle, &[self.heading, next]));
        }
        self.heading = next;
        self.goal = room.next(next).unwrap_or(room);
    }
}

/// The point to the right of a room's middle, for one who goes in these directions.
fn beside([x, z]: [f64; 2], headings: &[Heading]) -> [f64; 2] {
    headings.iter().fold([x, z], |[x, z], heading| {
        let [right_x, right_z] = heading.right().vector();
        [x + LANE * right_x, z + LANE * right_z]
    })
}

#[cfg(test)]
mod tests {
    use super::super::floor_plan::ROOM;
    use super::*;

    #[test]
    fn walkers_cross_walls_in_doorways_alone() {
        let mut dice = Dice::new(9);
        let plan = FloorPlan::new(&mut dice);
        let mut crossing_count = 0;
        for room in Room::all() {
            let mut walker = Walker::new(&plan, room, &mut dice);
            for _ in 0..3000 {
                let before = walker.at;
                walker.step(&plan, &mut dice, 1.0 / 30.0);
                let step = (walker.at[0] - before[0]).hypot(walker.at[1] - before[1]);
                assert!(step < 0.07, "a walker leapt {step} m");
                for (axis, other) in [(0, 1), (1, 0)] {
                    // Walls stand at the multiples of a room's width, in x and in z, and doorways in their middles.
                    let cell = |at: [f64; 2]| (at[axis] / ROOM).floor();
                    if cell(before) != cell(walker.at) {
                        let from_middle = (walker.at[other] / ROOM).rem_euclid(1.0) * ROOM - 0.5 * ROOM;
                        assert!(from_middle.abs() < 0.46, "{from_middle} m from the middle of a doorway");
                        crossing_count += 1;
                    }
                }
            }
        }
        assert!(crossing_count > 100, "only {crossing_count} doorways were passed");
    }
}
