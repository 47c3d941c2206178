//! What samples say of parts and mesh: never more than what is certified.

use collision::{
    DVec3,
    accuracy::{Accuracy, Tier},
    answer::Work,
    decompose::{Decomposition, Options, Part, decompose},
    math::Pose,
    narrow::{Placed, distance},
    shape::{Containment, Convex, Core, Form, Geometry, Hull, Mesh},
};

use std::ops::ControlFlow;

use crate::cubes::Noise;

pub(crate) fn mesh_of(geometry: &Geometry) -> &Mesh {
    let Form::Mesh(mesh) = geometry.form() else { panic!("a mesh") };
    mesh
}

pub(crate) fn hull_of(part: &Part) -> &Hull {
    let Form::Convex(Convex { core: Core::Hull(hull), .. }) = part.geometry.form() else { panic!("a hull") };
    hull
}

pub(crate) fn parts_of(geometry: &Geometry, options: &Options) -> Decomposition {
    decompose(mesh_of(geometry), options, &mut |_| ControlFlow::Continue(())).expect("nobody calls it off")
}

pub(crate) fn diagonal(geometry: &Geometry) -> f64 {
    let bounds = geometry.local_bounds();
    (bounds.max - bounds.min).length()
}

/// A lower bound of the distance of a point from a geometry.
fn gap(point: DVec3, geometry: &Geometry) -> f64 {
    let here = Geometry::point();
    let here = Placed { geometry: &here, pose: Pose::at(point) };
    let there = Placed { geometry, pose: Pose::IDENTITY };
    let found = distance(here, there, f64::INFINITY, &Accuracy::of(Tier::Exact), &mut Work::default());
    found.expect("no limit").certificate.bound.lower
}

/// Distances that samples have shown.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Shown {
    pub(crate) inside: f64,
    pub(crate) outside: f64,
}

/// Samples parts, surface and, if it is closed, the solid; asserts what is certified, and returns what was seen.
pub(crate) fn assert_certified(geometry: &Geometry, found: &Decomposition, noise: &mut Noise, samples: u32) -> Shown {
    let (mesh, mut shown) = (mesh_of(geometry), Shown::default());
    let is_in_solid = |point| mesh.contains(point, &mut Work::default()) == Containment::Inside;
    let to_parts =
        |point: DVec3| found.parts.iter().map(|part| gap(point, &part.geometry)).fold(f64::INFINITY, f64::min);
    for part in &found.parts {
        let vertices = hull_of(part).vertices();
        for _ in 0..samples {
            let pick = [0; 4].map(|_| vertices[noise.below(vertices.len() as u64) as usize]);
            let weights = [0; 4].map(|_| noise.share());
            let point = (0..4).map(|i| pick[i] * weights[i]).sum::<DVec3>() / weights.iter().sum::<f64>();
            let beyond = if is_in_solid(point) { 0.0 } else { gap(point, geometry) };
            assert!(beyond <= part.inside.upper, "{point} lies {beyond} beyond, {:?}", part.inside);
            assert!(part.inside.upper <= found.errors.inside.upper && part.inside.lower <= part.inside.upper);
            shown.inside = shown.inside.max(beyond);
        }
    }
    for _ in 0..samples {
        let [a, b, c] = mesh.corners(noise.below(mesh.triangles().len() as u64) as usize);
        let (u, v) = (noise.share(), noise.share());
        let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
        for point in [a, a + (b - a) * u + (c - a) * v] {
            shown.outside = shown.outside.max(to_parts(point));
        }
        let bounds = geometry.local_bounds();
        let point = bounds.center() + (bounds.max - bounds.min) * 0.5 * noise.vector();
        if is_in_solid(point) {
            shown.outside = shown.outside.max(to_parts(point));
        }
    }
    // Points of triangles are themselves off by a few roundings.
    let slack = 1e-15 * geometry.reach();
    assert!(shown.outside <= found.errors.outside.upper + slack, "{shown:?} {:?}", found.errors);
    shown
}
