//! Laws of the static tree and of the searches: nothing that qualifies is left out, whatever the boxes.

use std::{collections::BTreeSet, ops::ControlFlow};

use collision::{
    DVec3,
    answer::Work,
    broad::{ALL_LAYERS, Line, Path, StaticTree, Tree, distance_at_least},
    math::Aabb,
};

use crate::random::Random;

const SCALES: [f64; 5] = [1e-6, 1e-2, 1.0, 1e3, 1e9];

fn boxes_of(random: &mut Random, count: usize, scale: f64) -> Vec<Aabb> {
    (0..count)
        .map(|_| {
            let center = random.vector() * scale;
            let half = random.vector().abs() * scale * 0.1;
            Aabb::new(center - half, center + half)
        })
        .collect()
}

fn found_by_box(tree: &impl Tree, query: Aabb) -> Vec<u32> {
    let mut found = Vec::new();
    let Ok(()) = tree.visit_box(query, ALL_LAYERS, &mut Work::default(), |_, leaf| {
        found.push(leaf);
        Ok(ControlFlow::Continue(()))
    });
    found
}

fn found_by_ray(tree: &impl Tree, path: &Path, limit: f64) -> BTreeSet<u32> {
    let mut found = BTreeSet::new();
    let Ok(()) = tree.visit_ray(&Line::new(path), limit, ALL_LAYERS, &mut Work::default(), |_, leaf| {
        found.insert(leaf);
        Ok(limit)
    });
    found
}

#[test]
fn a_box_search_offers_every_box_that_touches_and_each_once() {
    let mut random = Random::new(1);
    let (mut hits, mut tests) = (0, 0);
    for scale in SCALES {
        for count in [0, 1, 2, 5, 33, 400] {
            let boxes = boxes_of(&mut random, count, scale);
            let tree = StaticTree::build(&boxes);
            assert_eq!(tree.len(), count);
            for query in boxes_of(&mut random, 40, scale * 1.5) {
                let query = query.inflated(scale * 0.6);
                let found = found_by_box(&tree, query);
                let distinct: BTreeSet<u32> = found.iter().copied().collect();
                assert_eq!(found.len(), distinct.len(), "a leaf was offered twice");
                for (index, bounds) in boxes.iter().enumerate() {
                    tests += 1;
                    if bounds.intersects(query) {
                        hits += 1;
                        assert!(distinct.contains(&(index as u32)), "box {index} of {count} is missing");
                    }
                }
            }
        }
    }
    assert!(hits * 50 > tests && hits * 2 < tests, "vacuous: {hits} of {tests}");
}

#[test]
fn a_search_that_touches_little_visits_little() {
    let mut random = Random::new(2);
    let boxes = boxes_of(&mut random, 20_000, 1000.0);
    let small: Vec<Aabb> = boxes.iter().map(|b| Aabb::new(b.center() - 1.0, b.center() + 1.0)).collect();
    let tree = StaticTree::build(&small);
    let mut work = Work::default();
    let Ok(()) = tree.visit_box(small[77], ALL_LAYERS, &mut work, |_, _| Ok(ControlFlow::Continue(())));
    assert!(work.nodes_visited < 100, "{} nodes for one small box", work.nodes_visited);
    let mut work = Work::default();
    let Ok(()) = tree.visit_nearest(small[77], f64::INFINITY, ALL_LAYERS, &mut work, |_, leaf| {
        Ok(small[leaf as usize].distance_sq(small[77]).sqrt())
    });
    assert!(work.nodes_visited < 100, "{} nodes for the nearest", work.nodes_visited);
}

/// Points of boxes that are representable exactly: a path from there through them must meet the box, however it grazes.
#[test]
fn a_path_through_a_point_of_a_box_meets_it() {
    let mut random = Random::new(3);
    for scale in SCALES {
        let boxes = boxes_of(&mut random, 200, scale);
        let tree = StaticTree::build(&boxes);
        for (index, bounds) in boxes.iter().enumerate() {
            for _ in 0..50 {
                let pick = |a: f64, b: f64, random: &mut Random| if random.unit() < 0.5 { a } else { b };
                let target = DVec3::new(
                    pick(bounds.min.x, bounds.max.x, &mut random),
                    pick(bounds.min.y, bounds.max.y, &mut random),
                    pick(bounds.min.z, bounds.max.z, &mut random),
                );
                let mut origin = random.vector() * scale * 3.0;
                if random.unit() < 0.5 {
                    // In the plane of a wall: 0 · ∞.
                    origin.x = target.x;
                }
                if random.unit() < 0.3 {
                    origin.y = target.y;
                }
                let direction = target - origin;
                if direction == DVec3::ZERO {
                    continue;
                }
                let path = Path { origin, direction, reach: DVec3::ZERO };
                let found = found_by_ray(&tree, &path, 1.0 + 1e-12);
                assert!(found.contains(&(index as u32)), "{path:?} lost corner {target} of box {index}");
            }
        }
    }
}

#[test]
fn a_swept_box_meets_what_it_overlaps_on_its_way() {
    let mut random = Random::new(4);
    let boxes = boxes_of(&mut random, 300, 10.0);
    let tree = StaticTree::build(&boxes);
    let (mut hits, mut tests) = (0, 0);
    for _ in 0..300 {
        let path = Path {
            origin: random.vector() * 15.0,
            direction: random.vector() * 20.0,
            reach: random.vector().abs() * 6.0,
        };
        let found = found_by_ray(&tree, &path, 1.0);
        for (index, bounds) in boxes.iter().enumerate() {
            let meets = (0..=64).any(|step| {
                let center = path.origin + path.direction * (f64::from(step) / 64.0);
                bounds.intersects(Aabb::new(center - path.reach, center + path.reach))
            });
            tests += 1;
            hits += usize::from(meets);
            assert!(!meets || found.contains(&(index as u32)), "{path:?} lost box {index}");
        }
    }
    assert!(hits * 50 > tests && hits * 2 < tests, "vacuous: {hits} of {tests}");
}

#[test]
fn a_limit_that_shrinks_still_finds_the_first_and_the_nearest() {
    let mut random = Random::new(5);
    for scale in SCALES {
        let boxes = boxes_of(&mut random, 500, scale);
        let tree = StaticTree::build(&boxes);
        for query in boxes_of(&mut random, 100, scale * 2.0) {
            let mut best = f64::INFINITY;
            let Ok(()) = tree.visit_nearest(query, f64::INFINITY, ALL_LAYERS, &mut Work::default(), |_, leaf| {
                let distance = boxes[leaf as usize].distance_sq(query).sqrt();
                best = best.min(distance);
                Ok(best)
            });
            let brute = boxes.iter().map(|b| b.distance_sq(query).sqrt()).fold(f64::INFINITY, f64::min);
            assert_eq!(best, brute);
        }
    }
}

#[test]
fn equal_boxes_and_long_rows_make_shallow_trees() {
    let equal = vec![Aabb::new(DVec3::ZERO, DVec3::ONE); 10_000];
    assert!(StaticTree::build(&equal).depth() <= 16);
    // Each centre twice as far as the one before: bins of equal width peel off one at a time.
    let row: Vec<Aabb> = (0..900).map(|i| Aabb::new(DVec3::ZERO, DVec3::X * f64::powi(2.0, i / 10 - 40))).collect();
    assert!(StaticTree::build(&row).depth() <= 80);
    assert_eq!(found_by_box(&StaticTree::build(&row), Aabb::new(DVec3::ZERO, DVec3::ZERO)).len(), 900);
    let points: Vec<Aabb> = (0..4096).map(|i| Aabb::new(DVec3::X * f64::from(i), DVec3::X * f64::from(i))).collect();
    assert!(StaticTree::build(&points).depth() <= 13, "boxes without area are halved evenly");
}

/// The wall is a denormal away and the direction's inverse overflows: only the slack keeps the box.
#[test]
fn a_direction_with_an_inverse_that_overflows_loses_nothing() {
    let tree = StaticTree::build(&[Aabb::new(DVec3::new(0.0, 0.9, 0.0), DVec3::new(0.0, 1.1, 0.0))]);
    let path =
        Path { origin: DVec3::new(1e-310, 0.0, 0.0), direction: DVec3::new(-1e-310, 1.0, 0.0), reach: DVec3::ZERO };
    assert_eq!(found_by_ray(&tree, &path, 2.0).len(), 1);
}

/// A bound is a double `m · 2^e`: it is compared with the root of a whole number exactly, by squaring whole numbers.
#[test]
fn the_bound_of_a_distance_is_never_above_it() {
    let mut random = Random::new(6);
    let mut close = 0;
    for _ in 0..10_000 {
        let gap = (random.vector().abs() * f64::powi(2.0, 24)).floor() + 1.0;
        let bound = distance_at_least(Aabb::new(DVec3::ZERO, DVec3::ZERO), Aabb::new(gap, gap + 1.0));
        let whole = |v: f64| v as u128;
        let square = whole(gap.x).pow(2) + whole(gap.y).pow(2) + whole(gap.z).pow(2);
        // Bounds of 2^16 and more are whole multiples of 2^-36; below 2^25, their squares fit.
        let shifted = whole(bound * f64::powi(2.0, 36));
        assert!(shifted.pow(2) <= square << 72, "{bound} is above the root of {square}");
        close += usize::from(bound * (1.0 + 1e-14) > (square as f64).sqrt());
    }
    assert_eq!(close, 10_000, "the bounds are close");
}
