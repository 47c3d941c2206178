//! The normals that straight features have exactly.
//!
//! # Method
//! Beside a round core a search draws near to a normal and never reaches it: its vertices lie closer and closer together, and
//! what they span leans by a rounding over that distance. Where an edge or a flat face takes part, a normal that leans by
//! little loses as much over the whole length of the edge. But which features take part is known by then, and their own
//! directions are exact: the way is made to stand on each of them, and on each two.
//!
//! # Limits
//! Guesses, of which the caller proves what it can. Rims and the surfaces of ellipsoids bend, so a normal that leans on them
//! costs the square of that only.

use glam::DVec3;
use smallvec::{SmallVec, smallvec};

use super::{body::Body, frame::Pair};
use crate::{
    math::{Norm, exact},
    shape::{Core, Hull},
    tolerance::EDGE_TILT,
};

/// What is straight about a core where it looks along a direction, as unit vectors in the pair's frame.
#[derive(Default)]
struct Straight {
    /// Outward normals.
    faces: SmallVec<[DVec3; 2]>,
    edges: SmallVec<[DVec3; 2]>,
}

/// Unit vectors near `toward`, which leads from `b` to `a`, that stand on faces, edges and pairs of edges of the two cores.
pub(super) fn normals(pair: &Pair<'_>, toward: DVec3) -> SmallVec<[DVec3; 16]> {
    let (a, b) = (straight(&pair.a, -toward), straight(&pair.b, toward));
    let mut normals: SmallVec<[DVec3; 16]> = a.faces.iter().map(|&outward| -outward).chain(b.faces).collect();
    let on_edge = |&edge: &DVec3| {
        let once = toward - edge * edge.dot(toward);
        (once - edge * edge.dot(once)).try_unit()
    };
    for edge in a.edges.iter().chain(&b.edges) {
        let Some(n) = on_edge(edge) else { continue };
        normals.extend([n, n + *edge * EDGE_TILT, n - *edge * EDGE_TILT]);
    }
    for on_a in &a.edges {
        let on_both = |on_b: &DVec3| {
            let across = exact::cross(*on_a, *on_b).try_unit()?;
            Some(across * across.dot(toward).signum())
        };
        normals.extend(b.edges.iter().filter_map(on_both));
    }
    normals
}

fn straight(body: &Body<'_>, outward: DVec3) -> Straight {
    let local = body.to_local(outward);
    let Straight { mut faces, mut edges } = match body.core {
        Core::Point | Core::Ellipsoid { .. } => Straight::default(),
        Core::Segment { .. } => Straight { edges: smallvec![DVec3::Y], ..Straight::default() },
        Core::Cuboid { .. } => cuboid(local),
        Core::Hull(hull) => of_hull(hull, local),
        Core::Triangle(corners) => triangle(corners, local),
        Core::Cylinder { .. } => Straight { faces: smallvec![DVec3::Y * local.y.signum()], edges: smallvec![DVec3::Y] },
        Core::Cone { half_height, radius } => cone(*half_height, *radius, local),
    };
    for direction in faces.iter_mut().chain(&mut edges) {
        *direction = body.turn(*direction);
    }
    Straight { faces, edges }
}

fn cuboid(outward: DVec3) -> Straight {
    let size = outward.abs();
    let axis = |wanted: f64| size.to_array().iter().position(|&part| part == wanted).unwrap_or(0);
    let [across, along] = [size.max_element(), size.min_element()].map(axis);
    Straight { faces: smallvec![DVec3::AXES[across] * outward[across].signum()], edges: smallvec![DVec3::AXES[along]] }
}

/// The base, the slant that looks along the direction, and the line down it.
fn cone(half_height: f64, radius: f64, outward: DVec3) -> Straight {
    let mut straight = Straight { faces: smallvec![DVec3::NEG_Y], edges: SmallVec::new() };
    if let Some(side) = DVec3::new(outward.x, 0.0, outward.z).try_unit() {
        straight.faces.extend((side * (2.0 * half_height) + DVec3::Y * radius).try_unit());
        straight.edges.extend((DVec3::Y * (2.0 * half_height) - side * radius).try_unit());
    }
    straight
}

/// The face that looks along the direction most, and the edge from the farthest corner that lies across it most.
fn of_hull(hull: &Hull, outward: DVec3) -> Straight {
    let farthest = hull.support(outward);
    let vertices = hull.vertices();
    let edges = hull.topology().edges.iter().filter(|edge| edge.start == farthest || edge.end == farthest);
    let along = edges.filter_map(|edge| (vertices[edge.end as usize] - vertices[edge.start as usize]).try_unit());
    Straight {
        faces: hull.facing(outward).map(|face| face.normal).into_iter().collect(),
        edges: most_across(along, outward).into_iter().collect(),
    }
}

fn triangle(&[a, b, c]: &[DVec3; 3], outward: DVec3) -> Straight {
    let normal = exact::cross(b - a, c - a).try_unit().map(|normal| normal * normal.dot(outward).signum());
    let along = [b - a, c - b, a - c].into_iter().filter_map(Norm::try_unit);
    Straight { faces: normal.into_iter().collect(), edges: most_across(along, outward).into_iter().collect() }
}

fn most_across(along: impl Iterator<Item = DVec3>, direction: DVec3) -> Option<DVec3> {
    along.min_by(|u, v| u.dot(direction).abs().total_cmp(&v.dot(direction).abs()))
}
