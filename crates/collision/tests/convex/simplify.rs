//! Simplified hulls: what is left out lies within the distance stated, which is the true one to within rounding.

use std::{
    cmp::Ordering,
    fs,
    path::{Path, PathBuf},
};

use collision::{
    DQuat, DVec3,
    accuracy::{Accuracy, Tier},
    answer::Work,
    math::{
        Pose,
        expansion::{ExactVector, Expansion},
    },
    narrow::{Placed, distance},
    shape::{Geometry, Hull, Simplified, Span},
};

use crate::random::Noise;

/// The bounds of the greatest distance of a vertex of `hull` from the simplified one, by the kernel for distances.
fn true_outside(hull: &Hull, simplified: &Simplified) -> [f64; 2] {
    let rest = Pose::new(DVec3::ZERO, DQuat::IDENTITY);
    let kept = Geometry::hull(simplified.hull.vertices()).expect("vertices within limits");
    let kept = Placed { geometry: &kept, pose: rest };
    let point = Geometry::point();
    let mut most = [0.0_f64; 2];
    for &vertex in hull.vertices() {
        let point = Placed { geometry: &point, pose: Pose::new(vertex, DQuat::IDENTITY) };
        let accuracy = Accuracy::of(Tier::Exact);
        let found = distance(point, kept, f64::INFINITY, &accuracy, &mut Work::default()).expect("no limit");
        most = [most[0].max(found.certificate.bound.lower), most[1].max(found.certificate.bound.upper)];
    }
    most
}

/// Checks the laws for budgets up to the number of vertices and returns how many budgets left something out.
fn assert_laws(points: &[DVec3]) -> usize {
    let hull = Hull::new(points);
    let count = hull.vertices().len();
    let mut before = f64::INFINITY;
    let mut shortened = 0;
    for budget in [1, 2, 3, 4, 5, 6, 8, 12, 16, 32, 64].into_iter().filter(|&budget| budget < count).chain([count]) {
        let simplified = hull.simplified(budget, 0.0);
        let kept = simplified.hull.vertices();
        assert!((1..=budget).contains(&kept.len()));
        assert!(kept.iter().all(|vertex| hull.vertices().contains(vertex)), "a vertex of its own");
        let [lower, upper] = true_outside(&hull, &simplified);
        let slack = 1e-13 * hull.reach();
        assert!(simplified.outside >= lower, "{budget}: {} is below {lower}", simplified.outside);
        assert!(simplified.outside <= upper + slack, "{budget}: {} is above {upper}", simplified.outside);
        assert!(simplified.outside <= before, "{budget}: {} is more than {before}", simplified.outside);
        assert_eq!(simplified.inside, 0.0);
        before = simplified.outside;
        shortened += usize::from(simplified.outside > slack);
    }
    let whole = hull.simplified(count, 0.0);
    assert_eq!((whole.hull.vertices(), whole.outside), (hull.vertices(), 0.0));
    assert_eq!(before, 0.0);
    shortened
}

#[test]
fn what_is_left_out_lies_within_the_distance_stated() {
    let mut noise = Noise(41);
    let mut shortened = 0;
    for flatness in [DVec3::ONE, DVec3::new(1.0, 1e-3, 1.0), DVec3::new(1.0, 1e-16, 1.0), DVec3::new(1e-7, 1.0, 1e-7)] {
        for count in [1, 2, 3, 4, 5, 20, 100] {
            for scale in [1e-6, 1e6] {
                let points: Vec<DVec3> = (0..count).map(|_| noise.vector().normalize() * flatness * scale).collect();
                shortened += assert_laws(&points);
                let off: Vec<DVec3> = points.iter().map(|&point| point + DVec3::new(3.0, -7.0, 11.0) * scale).collect();
                shortened += assert_laws(&off);
            }
        }
    }
    assert!(shortened > 300, "most budgets leave something out: {shortened}");
}

#[test]
fn flat_straight_and_single_points_are_simplified_too() {
    let mut noise = Noise(43);
    let point = Hull::new(&[DVec3::ONE, DVec3::ONE]).simplified(1, 0.0);
    assert_eq!((point.hull.vertices().len(), point.outside), (1, 0.0));
    let line: Vec<DVec3> = (0..9).map(|i| DVec3::new(1.0, 2.0, -3.0) * f64::from(i * 4 % 9)).collect();
    assert_eq!(assert_laws(&line), 1);
    let line = Hull::new(&line).simplified(2, 0.0);
    assert_eq!((line.hull.topology().span, line.outside), (Span::Segment, 0.0));
    let turn = DQuat::from_axis_angle(DVec3::new(0.6, 0.0, 0.8), 0.7);
    for plane in [DVec3::new(1.0, 0.0, 1.0), DVec3::new(0.0, 1.0, 1.0)] {
        let disc: Vec<DVec3> = (0..60).map(|_| (noise.vector() * plane).normalize()).collect();
        assert!(assert_laws(&disc) > 8);
        let turned: Vec<DVec3> = disc.iter().map(|&point| turn * point).collect();
        assert!(assert_laws(&turned) > 8);
    }
    // A plate: the fourth vertex is the one that a tetrahedron's sides miss most, not the one off the plane.
    let plate: Vec<DVec3> =
        (0..8).map(|i| DVec3::from([i & 1, i >> 1 & 1, i >> 2].map(f64::from)) * DVec3::new(1.0, 1.0, 0.01)).collect();
    assert!((Hull::new(&plate).simplified(4, 0.0).outside - 0.01).abs() < 1e-4);
    assert_eq!(Hull::new(&plate).simplified(8, 0.0).outside, 0.0);
}

#[test]
fn inner_points_and_points_on_edges_are_none_of_the_corners() {
    let grid: Vec<DVec3> = (0..125).map(|i| DVec3::from([i % 5, i / 5 % 5, i / 25].map(f64::from)) - 2.0).collect();
    let simplified = Hull::new(&grid).simplified(8, 0.0);
    assert_eq!((simplified.hull.vertices().len(), simplified.outside), (8, 0.0));
    assert_laws(&grid);
}

#[test]
fn a_largest_error_ends_it_early() {
    let mut noise = Noise(47);
    let points: Vec<DVec3> = (0..200).map(|_| noise.vector().normalize()).collect();
    let hull = Hull::new(&points);
    for max_error in [1.0, 0.3, 0.1, 0.03] {
        let enough = hull.simplified(usize::MAX, max_error);
        let kept = enough.hull.vertices().len();
        assert!(enough.outside <= max_error && kept < 200);
        assert!(hull.simplified(kept - 1, 0.0).outside > max_error, "fewer would do");
        assert_eq!(hull.simplified(kept, 0.0).outside, enough.outside);
        assert_eq!(hull.simplified(4, max_error).hull.vertices().len(), 4.min(kept));
    }
    assert_eq!(hull.simplified(50, f64::NAN).outside, hull.simplified(50, 0.0).outside);
    assert_eq!(hull.simplified(0, 0.0).hull.vertices().len(), 1);
}

#[test]
fn scaling_by_a_power_of_two_scales_the_distance() {
    let mut noise = Noise(53);
    let points: Vec<DVec3> = (0..50).map(|_| noise.vector()).collect();
    for exponent in [-990, -300, -20, 39] {
        let scale = 2.0_f64.powi(exponent);
        let scaled: Vec<DVec3> = points.iter().map(|&point| point * scale).collect();
        for budget in [1, 2, 3, 7, 20] {
            let [once, again] = [&points, &scaled].map(|points| Hull::new(points).simplified(budget, 0.0));
            assert_eq!(once.outside * scale, again.outside);
            let kept: Vec<DVec3> = once.hull.vertices().iter().map(|&vertex| vertex * scale).collect();
            assert_eq!(kept, again.hull.vertices());
        }
    }
    // What counts as 0 for signs still counts in the distance.
    let thin = Hull::new(&[DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::new(0.3, 0.3, 1e-200)]);
    assert!(thin.simplified(3, 0.0).outside >= 1e-200);
    let least = Hull::new(&[DVec3::ZERO, DVec3::X * f64::from_bits(1)]);
    assert!(least.simplified(1, 0.0).outside >= f64::from_bits(1));
}

#[test]
fn hulls_of_the_data_keep_the_laws() {
    let workspace = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let folder = std::env::var_os("CALIPERS_DATA").map_or_else(|| PathBuf::from("../shared/data"), PathBuf::from);
    let folder = workspace.join(folder);
    let mut shortened = 0;
    for name in ["hulls.jsonl", "hulls_hzd.jsonl", "hulls_hzd_flat.jsonl"] {
        let Ok(text) = fs::read_to_string(folder.join(name)) else { continue };
        // Each third: all of them take seconds.
        for line in text.lines().step_by(3) {
            let hull: serde_json::Value = serde_json::from_str(line).expect("a line of JSON");
            let points: Vec<[f64; 3]> = serde_json::from_value(hull["v"].clone()).expect("points");
            let points: Vec<DVec3> = points.into_iter().map(DVec3::from).collect();
            shortened += assert_laws(&points);
        }
    }
    assert!(shortened == 0 || shortened > 500, "{shortened}");
}

/// Exact: the distance of a thin triangle's third corner from its longest edge, squared, is a fraction of whole numbers.
#[test]
fn the_distance_stated_is_never_below_the_true_one() {
    let mut noise = Noise(59);
    let mut measured = 0;
    for _ in 0..2000 {
        let whole = |vector: DVec3, size: f64| (vector * size).round();
        let (a, along) = (whole(noise.vector(), 1e6), whole(noise.vector(), 1e7));
        let thin = 10.0_f64.powf(noise.between(1.0, 6.0));
        let corners = [a, a + along, a + whole(along * noise.between(0.3, 0.7), 1.0) + whole(noise.vector(), thin)];
        let simplified = Hull::new(&corners).simplified(2, 0.0);
        if simplified.hull.vertices() != &corners[..2] {
            continue;
        }
        let [edge, side] = [ExactVector::difference(corners[1], a), ExactVector::difference(corners[2], a)];
        let across = edge.cross(&side);
        let stated = Expansion::difference(simplified.outside, 0.0);
        let mut excess = Expansion::default();
        let mut stated_squared = Expansion::default();
        stated_squared.add_product(&stated, &stated);
        excess.add_product(&stated_squared, &edge.dot(&edge));
        excess.add_product(&across.dot(&across).negated(), &Expansion::difference(1.0, 0.0));
        assert_ne!(excess.sign(), Ordering::Less, "{corners:?}: {} is too short", simplified.outside);
        measured += 1;
    }
    assert!(measured > 1000, "{measured}");
}
