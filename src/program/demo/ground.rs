//! The ground outside the house: a mesh of triangles over waves.

use std::f64::consts::TAU;

use calipers_client::{geometry, proto};

use super::Dice;
use super::level::FLOOR_HALF;

/// Half of the ground in x and z, and the width of its cells.
pub(super) const GROUND_HALF: [f64; 2] = [90.0, 70.0];
const GROUND_CELL: f64 = 2.0;
/// The heights of the ground: waves that grow with the distance from the floor.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slopes {
    phases: [f64; 6],
}

impl Slopes {
    pub(super) fn new(dice: &mut Dice) -> Self {
        Self { phases: std::array::from_fn(|_| dice.between(0.0, TAU)) }
    }

    /// Below the floor the ground is 0.6 m down; outside it rises and falls by 3 m at most.
    pub(super) fn height(&self, x: f64, z: f64) -> f64 {
        let outside = (x.abs() - FLOOR_HALF[0]).max(z.abs() - FLOOR_HALF[1]);
        let share = ((outside - 1.0) / 10.0).clamp(0.0, 1.0);
        let [a, b, c, d, e, f] = self.phases;
        let waves = 1.6 * (0.08 * x + a).sin() * (0.07 * z + b).cos()
            + 0.8 * (0.21 * x + 0.13 * z + c).sin()
            + 0.4 * (0.33 * z - 0.41 * x + d).sin()
            + 0.2 * (0.9 * x + e).sin() * (0.8 * z + f).sin();
        share * waves - 0.6 * (1.0 - share)
    }

    /// Its triangles, wound so that the upper side is the outer one.
    pub(super) fn mesh(&self) -> proto::Geometry {
        let cell_count = GROUND_HALF.map(|half| (2.0 * half / GROUND_CELL).round() as u32);
        let along = |index: u32, axis: usize| f64::from(index) * GROUND_CELL - GROUND_HALF[axis];
        let vertices = (0..=cell_count[1]).flat_map(|row| {
            (0..=cell_count[0]).map(move |column| {
                let [x, z] = [along(column, 0), along(row, 1)];
                [x, self.height(x, z), z].map(|component| component as f32)
            })
        });
        let stride = cell_count[0] + 1;
        let triangles = (0..cell_count[1]).flat_map(|row| {
            (0..cell_count[0]).flat_map(move |column| {
                let corner = row * stride + column;
                // Counter-clockwise seen from above, so that the upper side is the outer one.
                [[corner, corner + stride, corner + 1], [corner + 1, corner + stride, corner + stride + 1]]
            })
        });
        geometry::mesh(vertices, triangles)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ground_stays_below_the_floor_and_within_its_heights() {
        for seed in 0..5 {
            let slopes = Slopes::new(&mut Dice::new(seed));
            for x in -90..=90 {
                for z in -70..=70 {
                    let (x, z) = (f64::from(x), f64::from(z));
                    let height = slopes.height(x, z);
                    let is_below_floor = x.abs() <= FLOOR_HALF[0] && z.abs() <= FLOOR_HALF[1];
                    assert!(height.abs() <= 3.0 && (!is_below_floor || height < -0.5), "{height} at {x}, {z}");
                }
            }
        }
    }

    #[test]
    fn the_mesh_names_only_vertices_that_it_has() {
        let Some(proto::geometry::Kind::Mesh(mesh)) = Slopes::new(&mut Dice::new(1)).mesh().kind else {
            panic!("the ground is a mesh");
        };
        assert_eq!((mesh.vertices.len() / 3, mesh.indices.len() / 3), (91 * 71, 2 * 90 * 70));
        assert_eq!(mesh.indices.iter().max().copied(), Some(91 * 71 - 1));
    }
}
