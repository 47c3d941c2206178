//! The ball and the box around a geometry.
//!
//! # Method
//! The box is the local one. Both are about its middle `c`; the ball reaches to the farthest vertex, or else to the corners.
//! A ray from `c` leaves the box at a distance between its least half edge `h` and its half diagonal `R`, so no point of the
//! ball's surface is farther from the surface of the box than `max(r − h, R − r)`, and what the box is off by comes on top.

use glam::DVec3;

use super::{StandIn, beyond, landmarks};
use crate::{
    answer::Representation,
    math::Aabb,
    shape::{Convex, Core, Form, Geometry, Hull, bounds::length_up, lazy::Receipt},
    tolerance::LENGTH_WIDENING,
};

/// Both, the ball first.
pub(super) fn around(geometry: &Geometry) -> [StandIn; 2] {
    let bounds = core_bounds(geometry);
    let center = bounds.center();
    let half_extents = (bounds.max - center).max(center - bounds.min).map(widened);
    let diagonal = length_up(half_extents);
    let radius = match geometry.form() {
        Form::Mesh(mesh) => farthest(mesh.vertices(), center),
        Form::Convex(Convex { core: Core::Hull(hull), .. }) => farthest(hull.vertices(), center),
        _ => diagonal,
    };
    let corners = corners(center, half_extents);
    let inside = match geometry.form() {
        Form::Convex(Convex { core: Core::Hull(hull), .. }) => beyond::beyond_hull(&corners, hull),
        _ => beyond::beyond_landmarks(&sides(&corners), &landmarks::of(geometry), geometry.reach()),
    };
    let ball_beyond_box = (radius - half_extents.min_element()).max(diagonal - radius) * LENGTH_WIDENING;
    let stand_in = |representation, convex, inside| {
        let receipt = Receipt::default();
        StandIn { representation, convex, center, outside: 0.0, inside, receipt }
    };
    [
        stand_in(
            Representation::Ball,
            Convex { core: Core::Point, radius },
            (inside + ball_beyond_box) * LENGTH_WIDENING,
        ),
        stand_in(Representation::OrientedBox, Convex { core: Core::Cuboid { half_extents }, radius: 0.0 }, inside),
    ]
}

/// The triangles of a small hull's surface; of a flat one both sides, of fewer dimensions what there is.
pub(super) fn faces(hull: &Hull) -> Vec<[DVec3; 3]> {
    let topology = hull.topology();
    let vertex = |index: u32| hull.vertices()[index as usize];
    let fans = topology.faces.iter().flat_map(|face| {
        let first = face.vertices[0];
        face.vertices.windows(2).skip(1).map(move |pair| [first, pair[0], pair[1]].map(vertex))
    });
    let fans: Vec<[DVec3; 3]> = fans.collect();
    if !fans.is_empty() {
        return fans;
    }
    let edges = topology.edges.iter().map(|edge| [edge.start, edge.end, edge.end].map(vertex));
    edges.chain([[vertex(0); 3]]).collect()
}

/// The box of a form, of a rounded one that of its core.
fn core_bounds(geometry: &Geometry) -> Aabb {
    match geometry.form() {
        Form::Convex(Convex { core: Core::Hull(hull), .. }) => hull.bounds(),
        _ => geometry.local_bounds(),
    }
}

fn farthest(points: &[DVec3], center: DVec3) -> f64 {
    // The differences are rounded, as the lengths are.
    widened(points.iter().map(|&point| length_up(point - center)).fold(0.0, f64::max) * LENGTH_WIDENING)
}

/// Larger by more than a rounding, so that half of a rounded extent is no less than the exact one.
fn widened(length: f64) -> f64 {
    length.next_up().next_up()
}

/// The corner `i` is on the upper side of an axis if its bit is set.
fn corners(center: DVec3, half_extents: DVec3) -> [DVec3; 8] {
    std::array::from_fn(|corner| {
        let side = |axis: usize| if corner >> axis & 1 == 1 { half_extents[axis] } else { -half_extents[axis] };
        center + DVec3::new(side(0), side(1), side(2))
    })
}

/// Two triangles for each side of a box.
fn sides(corners: &[DVec3; 8]) -> Vec<[DVec3; 3]> {
    const SIDES: [[usize; 4]; 6] = [[0, 2, 6, 4], [1, 3, 7, 5], [0, 1, 5, 4], [2, 3, 7, 6], [0, 1, 3, 2], [4, 5, 7, 6]];
    SIDES.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).map(|side| side.map(|at| corners[at])).collect()
}
