//! Laws of convex parts.

use std::ops::ControlFlow;

use collision::{
    DVec3,
    answer::Stop,
    decompose::{Cancelled, Decomposition, Options, decompose, measure},
    shape::Geometry,
};

use crate::{
    cubes::{Cubes, Noise},
    sampled::{assert_certified, diagonal, hull_of, mesh_of, parts_of},
};

/// Cubes on a grid, bent a little so that nothing is in line.
fn bent_cubes(noise: &mut Noise) -> Geometry {
    let Cubes(mut cubes) = Cubes::random(noise);
    // Three to a side are enough.
    for (index, is_filled) in cubes.iter_mut().enumerate() {
        *is_filled &= index % 4 < 3 && index / 4 % 4 < 3 && index < 48;
    }
    let (vertices, triangles) = Cubes(cubes).surface();
    let bend = |v: DVec3| v + DVec3::new(0.03 * v.y * v.z, 0.02 * v.x * v.x, -0.04 * v.x * v.y);
    let vertices: Vec<DVec3> = vertices.into_iter().map(bend).collect();
    Geometry::mesh(&vertices, &triangles).expect("a mesh")
}

fn soup(noise: &mut Noise) -> Geometry {
    let points: Vec<DVec3> = (0..30).map(|_| noise.vector()).collect();
    let triangles: Vec<[u32; 3]> = (0..20).map(|first| [first, first + 3, first + 10]).collect();
    Geometry::mesh(&points, &triangles).expect("a soup")
}

/// An L of three cubes, closed, without the faces between them.
fn l_shape() -> Geometry {
    let mut cubes = vec![false; 64];
    [0, 1, 4].into_iter().for_each(|cell| cubes[cell] = true);
    let (vertices, triangles) = Cubes(cubes).surface();
    Geometry::mesh(&vertices, &triangles).expect("a mesh")
}

/// The surface of a hull of random points.
fn convex(noise: &mut Noise) -> Geometry {
    let points: Vec<DVec3> = (0..60).map(|_| noise.vector() * DVec3::new(1.0, 2.0, 0.5)).collect();
    let hull = collision::shape::Hull::new(&points);
    let triangles: Vec<[u32; 3]> = hull
        .topology()
        .faces
        .iter()
        .flat_map(|face| {
            (2..face.vertices.len()).map(|at| [face.vertices[0], face.vertices[at - 1], face.vertices[at]])
        })
        .collect();
    Geometry::mesh(&points, &triangles).expect("a mesh")
}

fn bits(found: &Decomposition) -> Vec<u64> {
    let mut bits = Vec::new();
    for part in &found.parts {
        bits.extend(hull_of(part).vertices().iter().flat_map(|vertex| vertex.to_array()).map(f64::to_bits));
        bits.extend([part.volume, part.inside.lower, part.inside.upper].map(f64::to_bits));
    }
    bits.push(found.steps);
    bits
}

#[test]
fn what_is_certified_is_not_exceeded() {
    let mut noise = Noise(0x5EED_0001);
    let (mut seen, mut exact) = (0, 0);
    for round in 0..12 {
        let geometry = if round % 3 == 0 { soup(&mut noise) } else { bent_cubes(&mut noise) };
        for (max_parts, share) in [(1, 0.01), (4, 0.05), (32, 0.05)] {
            let options = Options { max_parts, max_error: share * diagonal(&geometry), ..Options::default() };
            let found = parts_of(&geometry, &options);
            assert!((1..=max_parts as usize).contains(&found.parts.len()));
            assert_eq!(
                found.stop == Stop::Tolerance,
                found.errors.inside.upper <= options.max_error,
                "{:?}",
                found.errors
            );
            // What has a volume is always cut by a plane, wherever it lies within the mesh.
            assert!(found.stop != Stop::Converged || !mesh_of(&geometry).is_closed());
            let shown = assert_certified(&geometry, &found, &mut noise, 60);
            seen += u32::from(shown.inside > 0.5 * found.errors.inside.lower);
            exact += u32::from(found.stop == Stop::Tolerance);
        }
    }
    // Samples come near what is certified, and what is asked is reached now and then.
    assert!(seen > 24 && (6..30).contains(&exact), "{seen} {exact}");
}

/// Pieces deep in a block with cavities have no surface of their own, or none on one side of a cut: they are cut all the same.
#[test]
fn what_lies_wholly_within_is_cut_as_well() {
    let mut noise = Noise(0x0B0E);
    for _ in 0..6 {
        let is_inner = |index: usize| [index % 4, index / 4 % 4, index / 16].iter().all(|at| (1..3).contains(at));
        let mut cubes: Vec<bool> = (0..64).map(|index| !is_inner(index) || noise.below(2) == 0).collect();
        cubes[21] = false;
        let (vertices, triangles) = Cubes(cubes).surface();
        // Cavities shrink towards the middle of the block, so that much lies between them and the outside.
        let is_outer = |vertex: DVec3| (vertex - 2.0).abs().max_element() > 1.5;
        let moved = |v: DVec3| if is_outer(v) { v } else { 2.0 + (v - 2.0) * DVec3::new(0.5, 0.3, 0.4) };
        let vertices: Vec<DVec3> = vertices.into_iter().map(moved).collect();
        let geometry = Geometry::mesh(&vertices, &triangles).expect("a mesh");
        let options = Options { max_parts: 256, max_error: 0.01 * diagonal(&geometry), ..Options::default() };
        let found = parts_of(&geometry, &options);
        assert_ne!(found.stop, Stop::Converged, "{:?}", found.errors);
        assert_certified(&geometry, &found, &mut noise, 20);
    }
}

#[test]
fn a_convex_mesh_is_one_exact_part() {
    let mut noise = Noise(31);
    for _ in 0..20 {
        let geometry = convex(&mut noise);
        let found = parts_of(&geometry, &Options::default());
        assert_eq!((found.parts.len(), found.stop), (1, Stop::Tolerance));
        assert!(found.errors.inside.upper < 1e-10 * diagonal(&geometry), "{:?}", found.errors);
        assert_eq!(found.errors.outside.upper, 0.0);
        assert!(found.volume_excess.expect("closed").abs() < 1e-12);
    }
}

#[test]
fn an_l_is_two_exact_parts() {
    for scale in [1.0, 0.3, 1e5, 1e-5] {
        for (offset, tilt) in [(DVec3::ZERO, 0.0), (DVec3::new(7.0, -3.0, 11.0), 0.6)] {
            let geometry = l_shape();
            let (sine, cosine) = (tilt, f64::sqrt(1.0 - tilt * tilt));
            let turned = |v: DVec3| DVec3::new(cosine * v.x - sine * v.y, sine * v.x + cosine * v.y, v.z);
            let moved = |&v: &DVec3| (turned(v) + offset) * scale;
            let vertices: Vec<DVec3> = mesh_of(&geometry).vertices().iter().map(moved).collect();
            let geometry = Geometry::mesh(&vertices, mesh_of(&geometry).triangles()).expect("a mesh");
            let found = parts_of(&geometry, &Options::default());
            assert_eq!((found.parts.len(), found.stop), (2, Stop::Tolerance));
            assert!(found.errors.inside.upper < 1e-10 * geometry.reach(), "{:?}", found.errors);
            assert!(found.volume_excess.expect("closed").abs() < 1e-12);
            let is_plain = scale == 1.0 && tilt == 0.0;
            assert!(!is_plain || found.parts.iter().all(|part| hull_of(part).vertices().len() == 8));
        }
    }
}

#[test]
fn the_same_mesh_gives_the_same_bits() {
    let mut noise = Noise(5);
    for _ in 0..2 {
        let geometry = bent_cubes(&mut noise);
        let again = Geometry::mesh(mesh_of(&geometry).vertices(), mesh_of(&geometry).triangles()).expect("a mesh");
        let options = Options { max_parts: 16, max_error: 0.04 * diagonal(&geometry), ..Options::default() };
        let first = parts_of(&geometry, &options);
        assert_eq!(bits(&first), bits(&parts_of(&geometry, &options)));
        assert_eq!(bits(&first), bits(&parts_of(&again, &options)));
    }
}

/// However often it is told of, and whatever is asked of the clock: steps alone end it.
#[test]
fn the_same_steps_give_the_same_bits_and_are_part_of_the_id() {
    let mut noise = Noise(0xB0D6E7);
    let geometry = bent_cubes(&mut noise);
    let options = Options { max_parts: 64, max_error: 0.02 * diagonal(&geometry), ..Options::default() };
    let whole = parts_of(&geometry, &options).steps;
    let mut ids = Vec::new();
    for budget in [1, whole / 4, whole / 2, Options::BUDGET_USUAL] {
        let options = Options { budget, ..options };
        let first = parts_of(&geometry, &options);
        let mut pauses = 0;
        let slowly = decompose(mesh_of(&geometry), &options, &mut |progress| {
            assert!(progress.max_steps == budget && progress.steps <= budget + 20_000, "{progress:?}");
            pauses += 1;
            std::thread::yield_now();
            ControlFlow::Continue(())
        });
        assert!(pauses > 0);
        assert_eq!(bits(&first), bits(&slowly.expect("nobody calls it off")), "{budget}");
        assert_eq!(first.stop == Stop::Budget, budget < whole, "{budget}");
        let steps = first.steps;
        let attached = first.attached(&geometry, &options).expect("a mesh");
        assert_eq!(attached.id(), geometry.id_with_parts(&options.asked()));
        assert!(attached.parts().is_some_and(|parts| parts.asked.max_steps == budget && parts.steps == steps));
        ids.push(attached.id());
    }
    ids.sort_unstable();
    ids.dedup();
    assert_eq!(ids.len(), 4, "other parts are another geometry");
}

#[test]
fn more_parts_are_never_farther_off_than_asked() {
    let mut noise = Noise(0xABCD);
    let mut nearer = 0;
    for round in 0..4 {
        let geometry = if round % 4 == 0 { soup(&mut noise) } else { bent_cubes(&mut noise) };
        let max_error = 0.05 * diagonal(&geometry);
        let mut before = f64::INFINITY;
        for max_parts in [1, 2, 3, 5, 8, 13, 21, 34] {
            let found = parts_of(&geometry, &Options { max_parts, max_error, ..Options::default() });
            let error = found.errors.inside.upper.max(max_error);
            assert!(error <= before, "{max_parts}: {error} after {before}");
            nearer += u32::from(error < before);
            before = error;
        }
    }
    assert!(nearer > 12, "{nearer}");
}

#[test]
fn a_scale_of_two_scales_the_parts() {
    let mut noise = Noise(99);
    for _ in 0..2 {
        let geometry = bent_cubes(&mut noise);
        let options = Options { max_parts: 12, max_error: 0.04 * diagonal(&geometry), ..Options::default() };
        let found = parts_of(&geometry, &options);
        for power in [-20, 12] {
            let scale = 2f64.powi(power);
            let options = Options { max_error: scale * options.max_error, ..options };
            let scaled = parts_of(&geometry.clone().scaled(scale).expect("within limits"), &options);
            assert_eq!(scaled.parts.len(), found.parts.len());
            let ratio = scaled.errors.inside.upper / scale / found.errors.inside.upper;
            assert!((ratio - 1.0).abs() < 1e-9, "{ratio}");
        }
    }
}

#[test]
fn it_stops_when_it_is_told_to() {
    let geometry = bent_cubes(&mut Noise(12));
    let options = Options::default();
    let mut calls = 0;
    decompose(mesh_of(&geometry), &options, &mut |_| {
        calls += 1;
        ControlFlow::Continue(())
    })
    .expect("nobody calls it off");
    assert!(calls > 8, "{calls}");
    for last in [1, 2, calls / 2, calls] {
        let mut called = 0;
        let found = decompose(mesh_of(&geometry), &options, &mut |_| {
            called += 1;
            if called == last { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        });
        assert_eq!((found.err(), called), (Some(Cancelled), last));
    }
}

#[test]
fn a_budget_ends_it_and_what_is_certified_holds() {
    let mut noise = Noise(4);
    let geometry = bent_cubes(&mut noise);
    let options = Options { max_parts: 64, max_error: 0.02 * diagonal(&geometry), ..Options::default() };
    let whole = parts_of(&geometry, &options).steps;
    let mut counts = Vec::new();
    for budget in [0, 1, 1000, whole / 8, whole / 3, whole / 2, whole] {
        let found = parts_of(&geometry, &Options { budget, ..options });
        // The step under way is finished: a hull, a search in a tree.
        assert!(found.steps <= budget + 20_000, "{budget}: {}", found.steps);
        assert_certified(&geometry, &found, &mut noise, 60);
        counts.push(found.parts.len());
    }
    assert!(counts[0] == 1 && counts.is_sorted() && counts[6] > 4, "{counts:?}");
}

#[test]
fn what_is_asked_too_fine_still_ends() {
    let mut noise = Noise(8);
    let geometry = bent_cubes(&mut noise);
    let options = Options { max_parts: 8, max_error: 1e-300, budget: 1_000_000 };
    let found = parts_of(&geometry, &options);
    assert_eq!(found.stop, Stop::Budget);
    assert_certified(&geometry, &found, &mut noise, 60);
    let tiny = Geometry::mesh(&[DVec3::ZERO, DVec3::X * 1e-140, DVec3::Y * 1e-140], &[[0, 1, 2]]).expect("a mesh");
    let found = parts_of(&tiny, &Options::default());
    assert!(found.parts.len() == 1 && found.errors.inside.upper < 1e-139, "{:?}", found.errors);
}

#[test]
fn far_from_the_origin_rounding_is_accounted_for() {
    let mut noise = Noise(21);
    for offset in [1e6, 1e9, 1e12] {
        let geometry = bent_cubes(&mut noise);
        let moved = |&v: &DVec3| (v + offset).clamp(DVec3::splat(-1e12), DVec3::splat(1e12));
        let vertices: Vec<DVec3> = mesh_of(&geometry).vertices().iter().map(moved).collect();
        let Ok(geometry) = Geometry::mesh(&vertices, mesh_of(&geometry).triangles()) else { continue };
        let found = parts_of(&geometry, &Options { max_parts: 16, ..Options::default() });
        assert_certified(&geometry, &found, &mut noise, 60);
    }
}

/// Parts of elsewhere are measured both ways: those of a mesh's own decomposition as it was certified, and a mesh's box as far as
/// its corners stand off.
#[test]
fn parts_from_elsewhere_are_measured() {
    let mut noise = Noise(3);
    let go_on = &mut |_| ControlFlow::Continue(());
    for _ in 0..4 {
        let geometry = bent_cubes(&mut noise);
        let width = 0.01 * diagonal(&geometry);
        let found = parts_of(&geometry, &Options { max_parts: 8, ..Options::default() });
        let parts: Vec<Geometry> = found.parts.iter().map(|part| part.geometry.clone()).collect();
        let errors = measure(mesh_of(&geometry), &parts, width, u64::MAX, go_on).expect("nobody calls it off");
        assert!(errors.outside.lower <= found.errors.outside.upper && errors.outside.upper <= width * 1.01);
        assert!(errors.inside.lower <= found.errors.inside.upper && found.errors.inside.lower <= errors.inside.upper);
        let fewer = measure(mesh_of(&geometry), &parts[1..], width, u64::MAX, go_on).expect("nobody calls it off");
        assert!(fewer.outside.lower > 0.0, "what the first part held sticks out");
    }
}
