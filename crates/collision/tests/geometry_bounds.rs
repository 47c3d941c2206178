//! Boxes surely hold their shapes, and are not much larger: compared with exact rational rotations.

use collision::{
    DQuat, DVec3,
    math::{Pose, expansion::Expansion},
    shape::{Geometry, Limits},
};

/// A small repeatable sequence of whole numbers.
struct Numbers(u64);

impl Numbers {
    fn within(&mut self, limit: i64) -> i64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as i64 % (limit + 1) - limit / 2
    }
}

/// `|q|²·(rotated v)` for whole numbers, exactly.
fn rotated(q: [i64; 4], v: [i64; 3]) -> [i64; 3] {
    let [x, y, z, w] = q;
    let (xx, yy, zz, ww) = (x * x, y * y, z * z, w * w);
    [
        v[0] * (ww + xx - yy - zz) + v[1] * 2 * (x * y - w * z) + v[2] * 2 * (x * z + w * y),
        v[0] * 2 * (x * y + w * z) + v[1] * (ww - xx + yy - zz) + v[2] * 2 * (y * z - w * x),
        v[0] * 2 * (x * z - w * y) + v[1] * 2 * (y * z + w * x) + v[2] * (ww - xx - yy + zz),
    ]
}

/// Exactly `(value - position)·den - num`, as a sign and an estimate.
fn excess(value: f64, position: f64, den: i64, num: i64) -> f64 {
    let scale = Expansion::difference(den as f64, 0.0);
    let mut exact = Expansion::default();
    exact.add_product(&Expansion::difference(value, position), &scale);
    exact.add(-(num as f64));
    exact.estimate()
}

#[test]
fn boxes_of_turned_forms_hold_every_corner_and_are_tight() {
    let mut numbers = Numbers(7);
    for round in 0..2_000 {
        let q = [0; 4].map(|_| numbers.within(9));
        let norm: i64 = q.iter().map(|c| c * c).sum();
        if norm == 0 {
            continue;
        }
        let half = [0; 3].map(|_| numbers.within(1000).abs() + 1);
        let position = DVec3::from_array([0; 3].map(|_| numbers.within(1 << 20) as f64 * 0.3));
        let position = if round % 2 == 0 { position } else { DVec3::ZERO };
        let [x, y, z, w] = q.map(|c| c as f64);
        let pose = Pose::new(position, DQuat::from_xyzw(x, y, z, w));
        let corners: Vec<[i64; 3]> = (0..8)
            .map(|bits| [0, 1, 2].map(|axis| if bits >> axis & 1 == 0 { -half[axis] } else { half[axis] }))
            .collect();
        let points: Vec<DVec3> = corners.iter().map(|c| DVec3::from_array(c.map(|c| c as f64))).collect();
        let exact: Vec<[i64; 3]> = corners.iter().map(|&corner| rotated(q, corner)).collect();
        let triangles: Vec<[u32; 3]> = (0..6).map(|first| [first, first + 1, first + 2]).collect();
        for geometry in [
            Geometry::cuboid(points[7]).expect("a box"),
            Geometry::hull(&points).expect("a hull"),
            Geometry::mesh(&points, &triangles).expect("a mesh"),
        ] {
            let bounds = geometry.bounds(&pose);
            let slack = 1e-13 * norm as f64 * (geometry.reach() + position.length());
            for axis in 0..3 {
                let least = exact.iter().map(|c| c[axis]).min().expect("eight");
                let most = exact.iter().map(|c| c[axis]).max().expect("eight");
                let below = excess(bounds.min[axis], position[axis], norm, least);
                let above = excess(bounds.max[axis], position[axis], norm, most);
                assert!(below <= 0.0 && above >= 0.0, "{geometry:?} at {pose:?} sticks out: {below} {above}");
                assert!(below >= -slack && above <= slack, "{geometry:?} at {pose:?} is wide: {below} {above}");
            }
        }
    }
}

#[test]
fn boxes_of_unturned_forms_are_the_nearest_that_hold_them() {
    let cube = Geometry::cuboid(DVec3::splat(0.5)).expect("a box");
    let turned_by_nothing = Pose::new(DVec3::new(1e9, 0.1, -3.0), DQuat::from_xyzw(0.0, 0.0, 0.0, -7.0));
    let bounds = cube.bounds(&turned_by_nothing);
    assert_eq!(bounds.min, DVec3::new(1e9 - 0.5, -0.4, -3.5));
    assert_eq!((bounds.max.x, bounds.max.z), (1e9 + 0.5, -2.5));
    assert!((0.6..=0.6_f64.next_up()).contains(&bounds.max.y));
    let ball = Geometry::sphere(0.1).expect("a ball").bounds(&Pose::at(DVec3::splat(1e9)));
    assert!(excess(ball.max.x, 1e9, 1, 0) >= 0.1 && excess(ball.min.x, 1e9, 1, 0) <= -0.1);
}

#[test]
fn reach_is_not_below_the_exact_one() {
    let mut numbers = Numbers(3);
    for _ in 0..1_000 {
        let point = DVec3::from_array([0; 3].map(|_| numbers.within(1 << 20) as f64));
        if point == DVec3::ZERO {
            continue;
        }
        let reach = Geometry::hull(&[point]).expect("a point").reach();
        let square = |value: f64| (value as i128) * (value as i128);
        let exact = square(point.x) + square(point.y) + square(point.z);
        let reached = Expansion::difference(reach, 0.0);
        let mut excess = Expansion::default();
        excess.add_product(&reached, &reached);
        excess.add(-(exact as f64));
        assert!(excess.estimate() >= 0.0 && reach <= (exact as f64).sqrt() * (1.0 + 1e-14), "{point}");
    }
}

#[test]
fn the_box_of_a_half_space_ends_at_its_plane_if_that_is_along_the_axes() {
    let most = Limits::HALF_SPACE_BOX;
    let floor = Geometry::half_space(DVec3::Y * 0.3, 0.1).expect("a half space");
    let bounds = floor.bounds(&Pose::at(DVec3::new(5.0, 0.2, 1e12)));
    assert_eq!((bounds.min, bounds.max.x, bounds.max.z), (DVec3::splat(-most), most, most));
    assert!(excess(bounds.max.y, 0.2, 1, 0) >= 0.1 && bounds.max.y <= 0.3_f64.next_up());
    let wall = Geometry::half_space(DVec3::NEG_X, 2.0).expect("a half space").bounds(&Pose::at(DVec3::X));
    assert_eq!((wall.min.x, wall.max), (-1.0, DVec3::splat(most)));
    let whole = [DVec3::splat(-most), DVec3::splat(most)];
    let slope = Geometry::half_space(DVec3::new(1e-9, 1.0, 0.0), 0.0).expect("a half space");
    let turned = floor.bounds(&Pose::new(DVec3::ZERO, DQuat::from_rotation_y(0.1)));
    for bounds in [slope.bounds(&Pose::IDENTITY), turned] {
        assert_eq!([bounds.min, bounds.max], whole);
    }
    assert!(floor.reach().is_finite() && floor.reach() >= most);
}
