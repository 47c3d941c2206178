//! Supports of hulls: the walk over the edges ends at an exactly highest corner, wherever it begins.

use std::cmp::Ordering;

use collision::{DVec3, math::expansion::ExactVector, shape::Hull};

use crate::random::Noise;

/// The sign of `(w - v) · direction`, exactly.
fn compare(hull: &Hull, direction: DVec3, w: u32, v: u32) -> Ordering {
    let [to, from] = [w, v].map(|vertex| hull.vertices()[vertex as usize]);
    let along = ExactVector::difference(direction, DVec3::ZERO);
    ExactVector::difference(to, from).dot(&along).sign()
}

/// Panics unless walks from `starts` end at one corner, which no vertex exceeds and which is the first of its height.
fn assert_climbs_to_the_top(hull: &Hull, direction: DVec3, starts: impl IntoIterator<Item = u32>) {
    let top = hull.climb(direction, hull.support_start(direction));
    for start in starts {
        assert_eq!(hull.climb(direction, start), top, "from {start} along {direction}");
    }
    let mut corners: Vec<u32> = hull.topology().edges.iter().flat_map(|edge| [edge.start, edge.end]).collect();
    corners.sort_unstable();
    for vertex in 0..hull.vertices().len() as u32 {
        let than_top = compare(hull, direction, vertex, top);
        assert_ne!(than_top, Ordering::Greater, "{vertex} is above {top} along {direction}");
        let is_tied_before = than_top == Ordering::Equal && vertex < top && corners.binary_search(&vertex).is_ok();
        assert!(!is_tied_before, "{vertex} is as high as {top} and comes first, along {direction}");
    }
    let rounded = |vertex: u32| hull.vertices()[vertex as usize].dot(direction);
    let blur = 3.0 * f64::EPSILON * hull.reach() * direction.length();
    assert!((rounded(hull.farthest(direction)) - rounded(top)).abs() <= blur);
}

fn grid_direction(i: i32) -> DVec3 {
    DVec3::new(f64::from(i % 3 - 1), f64::from(i / 3 % 3 - 1), f64::from(i / 9 - 1))
}

#[test]
fn a_walk_ends_at_the_exactly_highest_corner_from_every_start() {
    let mut noise = Noise(11);
    for count in [1, 2, 3, 4, 8, 33, 100] {
        for flatness in [DVec3::ONE, DVec3::new(1.0, 1e-9, 1.0), DVec3::new(1.0, 0.0, 1.0), DVec3::X] {
            let points: Vec<DVec3> = (0..count).map(|_| noise.vector().normalize() * flatness).collect();
            let hull = Hull::new(&points);
            let starts = || 0..hull.vertices().len() as u32;
            for i in (0..27).filter(|&i| i != 13) {
                assert_climbs_to_the_top(&hull, grid_direction(i), starts());
                assert_climbs_to_the_top(&hull, grid_direction(i) + noise.vector() * 1e-15, starts());
                assert_climbs_to_the_top(&hull, noise.vector() * 1e-12, starts());
            }
        }
    }
}

#[test]
fn equal_heights_of_grids_and_prisms_are_settled_by_index() {
    let grid: Vec<DVec3> =
        (0..125).map(|i| grid_direction(0) + DVec3::from([i % 5, i / 5 % 5, i / 25].map(f64::from))).collect();
    let prism: Vec<DVec3> = (0..64)
        .map(|i| {
            let (sine, cosine) = (f64::from(i / 2) * std::f64::consts::TAU / 32.0).sin_cos();
            DVec3::new(cosine, f64::from(i % 2), sine)
        })
        .collect();
    for hull in [Hull::new(&grid), Hull::new(&prism)] {
        for i in (0..27).filter(|&i| i != 13) {
            assert_climbs_to_the_top(&hull, grid_direction(i), 0..hull.vertices().len() as u32);
        }
    }
}

/// Where outlines bend by an angle of about the root of the rounding, comparing rounded heights would end 1e-8 too low.
#[test]
fn a_bend_of_hardly_an_angle_holds_no_walk_up() {
    let mut noise = Noise(5);
    let mut held = 0;
    for _ in 0..200 {
        let bend = 10.0_f64.powf(noise.between(-12.0, -5.0));
        let lean = 10.0_f64.powf(noise.between(-12.0, -5.0));
        let outline = [(-1.0, -bend), (0.0, 0.0), (1.0, -bend), (0.1, -1.0)];
        let points: Vec<DVec3> =
            (0..8).map(|i| DVec3::new(outline[i / 2].0, outline[i / 2].1, (i % 2) as f64)).collect();
        let hull = Hull::new(&points);
        let direction = DVec3::new(0.0, -lean, 1.0);
        let [left, middle, right, far] = [1, 3, 5, 7].map(|vertex: usize| points[vertex].dot(direction));
        held += usize::from(middle == left && middle == right && middle < far);
        assert_climbs_to_the_top(&hull, direction, 0..8);
    }
    assert!(held > 20, "the bend must look like the top now and then: {held}");
}

#[test]
fn nearly_equal_corners_hold_no_walk_up() {
    let mut noise = Noise(3);
    for _ in 0..20 {
        let mut points: Vec<DVec3> = (0..12).map(|_| noise.vector()).collect();
        for i in 0..36 {
            points.push(points[i % 12] + noise.vector() * 4e-16);
        }
        let hull = Hull::new(&points);
        for _ in 0..20 {
            assert_climbs_to_the_top(&hull, noise.vector(), 0..hull.vertices().len() as u32);
        }
    }
}

#[test]
fn numbers_beyond_exact_sums_and_no_numbers_end_a_walk_too() {
    let tiny: Vec<DVec3> = (0..27).map(|i| grid_direction(i) * 1e-200).collect();
    let hull = Hull::new(&tiny);
    for direction in [DVec3::X, DVec3::ONE, DVec3::X * 1e-200, DVec3::ZERO, DVec3::NAN, DVec3::splat(f64::INFINITY)] {
        for start in 0..27 {
            let found = hull.climb(direction, start);
            let height = |vertex: u32| tiny[vertex as usize].dot(direction);
            let is_below = height(found) < height(hull.farthest(direction));
            assert!(!is_below, "{found} along {direction}");
        }
    }
}

#[test]
fn a_support_is_the_same_at_every_scale_and_its_structures_are_counted() {
    let mut noise = Noise(17);
    let points: Vec<DVec3> = (0..300).map(|_| noise.vector().normalize()).collect();
    let hull = Hull::new(&points);
    let before = hull.memory_bytes();
    let large: Vec<DVec3> = points.iter().map(|&point| point * 1024.0).collect();
    let large = Hull::new(&large);
    for _ in 0..200 {
        let direction = noise.vector();
        let found = hull.support(direction);
        assert_eq!(found, large.support(direction * 0.125));
        assert_eq!(found, hull.farthest(direction), "heights here are far apart");
    }
    assert!(hull.memory_bytes() > before);
    assert_eq!(large.reach(), 1024.0 * hull.reach());
    assert_eq!(large.center(), hull.center() * 1024.0);
}
