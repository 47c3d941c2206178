//! What stands still: the ground, the floor, walls with doorways, and what is in the rooms.
//!
//! Furniture keeps to the quarters of a room: more than 1.2 m from its middle lines, which are the ways from doorway to
//! doorway.

use std::f64::consts::TAU;

use calipers_client::{Client, Error, geometry, proto, shape};

use super::Dice;
use super::floor_plan::{FloorPlan, Heading, ROOM, Room};
use super::ground::Slopes;

/// What the ids mean, for people.
pub(super) const ABOUT: &str = "\
The demo's level, in metres, y up: 60 x 40 m of rooms about the origin with their floor at y = 0, on 180 x 140 m of
uneven ground. Ids of shapes:
     1          ground, a triangle mesh          2000..  stairs and ramps
     2          floor                            3000..  columns
  1000..        walls and lintels                4000..  furniture and rocks
 10000..        walkers (capsules) in the rooms, keeping to the right
 11000..        carts (boxes) on the way round the house
 12000..        drones (spheres and boxes) above the ground
 13000..        balls (spheres) that ask the server where they bounce
 14000..        lifts (boxes) on the outer walls
Layers: 1 the level, 2 the ground, 4 what moves.";

/// Layers of the demo.
pub(super) const LAYER_LEVEL: u32 = 1;
const LAYER_GROUND: u32 = 2;
pub(super) const LAYER_MOVING: u32 = 4;
/// All layers.
pub(super) const LAYERS_ALL: u32 = u32::MAX;

const GROUND: u64 = 1;
const FLOOR: u64 = 2;
const WALLS: u64 = 1000;
const STEPS: u64 = 2000;
const COLUMN_IDS: u64 = 3000;
const FURNITURE: u64 = 4000;

const WALL_HEIGHT: f64 = 3.0;
const WALL_HALF_THICKNESS: f64 = 0.1;
const DOORWAY_WIDTH: f64 = 2.0;
const DOORWAY_HEIGHT: f64 = 2.2;
/// Half of the floor in x and z; it reaches 6 m beyond the outer walls.
pub(super) const FLOOR_HALF: [f64; 2] = [36.0, 26.0];
/// From a room's middle to the middle of a quarter, along x and along z.
const QUARTER: f64 = 3.0;
/// Rocks on the ground outside.
const ROCK_COUNT: usize = 40;

/// The ids of the geometries that are used many times.
struct Forms {
    column: String,
    rocks: Vec<String>,
}

/// Collects shapes under running numbers.
struct Site {
    forms: Forms,
    edits: Vec<proto::Edit>,
    next: [u64; 4],
}

/// What a running number is for.
#[derive(Clone, Copy)]
enum Series {
    Walls,
    Steps,
    Columns,
    Furniture,
}

/// The edits that put the level into a world. Its larger geometries are registered on the way.
///
/// # Errors
/// What the server refuses.
pub(super) async fn make(client: &Client, plan: &FloorPlan, dice: &mut Dice) -> Result<Vec<proto::Edit>, Error> {
    let slopes = Slopes::new(dice);
    let ground = client.register(slopes.mesh()).await?.geometry_id;
    let column = client.register(prism(12, 0.35, WALL_HEIGHT)).await?.geometry_id;
    let mut rocks = Vec::new();
    for _ in 0..4 {
        rocks.push(client.register(rock(dice)).await?.geometry_id);
    }
    let mut site =
        Site { forms: Forms { column, rocks }, edits: Vec::new(), next: [WALLS, STEPS, COLUMN_IDS, FURNITURE] };
    let ground = shape::of(GROUND, geometry::registered(ground)).layers(LAYER_GROUND, LAYERS_ALL).fixed();
    site.edits.push(ground.insert());
    let floor = shape::cuboid(FLOOR, [FLOOR_HALF[0], 0.25, FLOOR_HALF[1]]).at([0.0, -0.25, 0.0]).fixed();
    site.edits.push(floor.insert());
    for room in Room::all() {
        site.walls(plan, room);
        site.furnish(room, dice);
    }
    site.rocks(&slopes, dice);
    Ok(site.edits)
}

impl Site {
    fn put(&mut self, series: Series, form: proto::Geometry, at: [f64; 3], rotation: [f64; 4]) {
        let id = &mut self.next[series as usize];
        self.edits.push(shape::of(*id, form).at(at).rotated(rotation).layers(LAYER_LEVEL, LAYERS_ALL).fixed().insert());
        *id += 1;
    }

    fn put_box(&mut self, series: Series, half_extents: [f64; 3], at: [f64; 3]) {
        self.put(series, geometry::cuboid(half_extents), at, UNTURNED);
    }

    /// The walls to the east and south of a room, and the outer ones of the first column and row.
    fn walls(&mut self, plan: &FloorPlan, room: Room) {
        for heading in Heading::ALL {
            let is_outer = room.next(heading).is_none();
            if is_outer || matches!(heading, Heading::East | Heading::South) {
                // Two gates, at the ends of the second row.
                let is_gate = is_outer && room.row == 1 && matches!(heading, Heading::East | Heading::West);
                let wall = if is_gate {
                    Wall::Gate
                } else if plan.is_open(room, heading) {
                    Wall::Doorway
                } else {
                    Wall::Closed
                };
                self.wall(room, heading, wall);
            }
        }
    }

    /// One wall of a room.
    fn wall(&mut self, room: Room, heading: Heading, wall: Wall) {
        let [x, z] = room.middle();
        let [out_x, out_z] = heading.vector();
        let [along_x, along_z] = heading.right().vector();
        // A piece `shift` along the wall from its middle, `half_length` long to either side.
        let mut piece = |shift: f64, half_length: f64, bottom: f64, top: f64| {
            let half = |out: f64, along: f64| out.abs() * WALL_HALF_THICKNESS + along.abs() * half_length;
            self.put_box(
                Series::Walls,
                [half(out_x, along_x), 0.5 * (top - bottom), half(out_z, along_z)],
                [
                    x + 0.5 * ROOM * out_x + shift * along_x,
                    0.5 * (top + bottom),
                    z + 0.5 * ROOM * out_z + shift * along_z,
                ],
            );
        };
        match wall {
            Wall::Closed => piece(0.0, 0.5 * ROOM, 0.0, WALL_HEIGHT),
            Wall::Doorway | Wall::Gate => {
                let half_length = 0.25 * (ROOM - DOORWAY_WIDTH);
                let shift = 0.5 * DOORWAY_WIDTH + half_length;
                piece(-shift, half_length, 0.0, WALL_HEIGHT);
                piece(shift, half_length, 0.0, WALL_HEIGHT);
                piece(0.0, 0.5 * DOORWAY_WIDTH, DOORWAY_HEIGHT, WALL_HEIGHT);
                if let Wall::Gate = wall {
                    // Shut, so that no ball is lost to the open country.
                    piece(0.0, 0.5 * DOORWAY_WIDTH, 0.0, DOORWAY_HEIGHT);
                }
            }
        }
    }

    /// What stands in the four quarters of a room.
    fn furnish(&mut self, room: Room, dice: &mut Dice) {
        let [x, z] = room.middle();
        let has_columns = dice.below(4) == 0;
        for (sign_x, sign_z) in [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)] {
            let quarter = [x + sign_x * QUARTER, z + sign_z * QUARTER];
            if has_columns {
                let column = geometry::registered(self.forms.column.as_str());
                self.put(Series::Columns, column, [quarter[0], 0.5 * WALL_HEIGHT, quarter[1]], UNTURNED);
                continue;
            }
            match dice.below(8) {
                0 => self.stairs(quarter),
                1 => self.ramp(quarter),
                2 => {}
                _ => self.furniture(quarter, dice),
            }
        }
    }

    /// Ten steps up to the east.
    fn stairs(&mut self, [x, z]: [f64; 2]) {
        for step in 0..10 {
            let half_height = 0.1 * f64::from(step + 1);
            let along = 0.28 * (f64::from(step) - 4.5);
            self.put_box(Series::Steps, [0.14, half_height, 0.7], [x + along, half_height, z]);
        }
    }

    /// A slab that rises to the east by 20 degrees; its lower edge is in the floor.
    fn ramp(&mut self, [x, z]: [f64; 2]) {
        self.put(Series::Steps, geometry::cuboid([1.4, 0.1, 0.7]), [x, 0.45, z], about_z(20_f64.to_radians()));
    }

    fn furniture(&mut self, [x, z]: [f64; 2], dice: &mut Dice) {
        let [x, z] = [x + dice.between(-0.3, 0.3), z + dice.between(-0.3, 0.3)];
        let turned = about_y(dice.between(0.0, TAU));
        match dice.below(5) {
            0 | 1 => {
                let half = [dice.between(0.3, 0.9), dice.between(0.2, 0.7), dice.between(0.3, 0.9)];
                self.put(Series::Furniture, geometry::cuboid(half), [x, half[1], z], turned);
            }
            2 => {
                let upright = geometry::capsule(0.4, 0.3);
                self.put(Series::Furniture, upright, [x, 0.7, z], turned);
            }
            3 => {
                let lying = geometry::capsule(0.5, 0.3);
                self.put(Series::Furniture, lying, [x, 0.3, z], about_z(0.25 * TAU));
            }
            _ => {
                let rock = geometry::registered(self.forms.rocks[dice.below(self.forms.rocks.len())].as_str());
                self.put(Series::Furniture, rock, [x, 0.4, z], turned);
            }
        }
    }

    /// Rocks on the ground, in a ring about the floor.
    fn rocks(&mut self, slopes: &Slopes, dice: &mut Dice) {
        for _ in 0..ROCK_COUNT {
            let turn = dice.between(0.0, TAU);
            let out = dice.between(1.3, 1.9);
            let [east, south] = [turn.cos(), turn.sin()];
            // A ring in the form of the floor, so that its corners stay free as well.
            let out = out / east.abs().max(south.abs());
            let [x, z] = [FLOOR_HALF[0] * out * east, FLOOR_HALF[1] * out * south];
            let mut rock = geometry::registered(self.forms.rocks[dice.below(self.forms.rocks.len())].as_str());
            rock.scale = Some(dice.between(0.6, 2.5));
            self.put(Series::Furniture, rock, [x, slopes.height(x, z), z], about_y(dice.between(0.0, TAU)));
        }
    }
}

/// How a wall is built.
#[derive(Clone, Copy)]
enum Wall {
    Closed,
    Doorway,
    /// A doorway with its door shut.
    Gate,
}

/// No rotation.
const UNTURNED: [f64; 4] = [0.0, 0.0, 0.0, 1.0];

/// The rotation about the y axis by an angle.
pub(super) fn about_y(angle: f64) -> [f64; 4] {
    [0.0, (0.5 * angle).sin(), 0.0, (0.5 * angle).cos()]
}

fn about_z(angle: f64) -> [f64; 4] {
    [0.0, 0.0, (0.5 * angle).sin(), (0.5 * angle).cos()]
}

/// An upright column about the origin.
fn prism(side_count: u32, radius: f64, height: f64) -> proto::Geometry {
    let ring = |y: f64| {
        (0..side_count).map(move |side| {
            let turn = TAU * f64::from(side) / f64::from(side_count);
            [(radius * turn.cos()) as f32, y as f32, (radius * turn.sin()) as f32]
        })
    };
    geometry::hull(ring(-0.5 * height).chain(ring(0.5 * height)))
}

/// The hull of points between two spheres about the origin.
fn rock(dice: &mut Dice) -> proto::Geometry {
    let points = (0..16).map(|index| {
        // Rings of four, each turned against the last, so that no side is left empty.
        let rise = -0.75 + 0.5 * f64::from(index / 4) + dice.between(-0.2, 0.2);
        let turn = 0.25 * TAU * f64::from(index % 4) + dice.between(0.0, 1.2);
        let flat = (1.0 - rise * rise).max(0.0).sqrt();
        let radius = dice.between(0.5, 0.85);
        [flat * turn.cos(), rise, flat * turn.sin()].map(|component| (radius * component) as f32)
    });
    geometry::hull(points.collect::<Vec<_>>())
}

#[cfg(test)]
mod tests {
    use super::super::floor_plan::{COLUMNS, ROWS};
    use super::super::ground::GROUND_HALF;
    use super::*;

    #[test]
    fn the_extent_is_what_people_are_told() {
        assert_eq!([COLUMNS as f64 * ROOM, ROWS as f64 * ROOM], [60.0, 40.0]);
        assert_eq!(GROUND_HALF.map(|half| 2.0 * half), [180.0, 140.0]);
        assert!(ABOUT.contains("60 x 40 m") && ABOUT.contains("180 x 140 m"));
    }
}
