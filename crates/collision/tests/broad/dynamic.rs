//! Laws of the dynamic tree: sound after every edit, complete in every search, shared by its clones.

use std::{
    collections::{BTreeMap, BTreeSet},
    ops::ControlFlow,
};

use collision::{
    DVec3,
    answer::Work,
    broad::{ALL_LAYERS, DynamicTree, Line, Path, Refit, StaticTree, Tree},
    math::Aabb,
};

use crate::random::Random;

fn found_by_box(tree: &impl Tree, query: Aabb) -> BTreeSet<u32> {
    let mut found = BTreeSet::new();
    let Ok(()) = tree.visit_box(query, ALL_LAYERS, &mut Work::default(), |_, leaf| {
        assert!(found.insert(leaf), "leaf {leaf} was offered twice");
        Ok(ControlFlow::Continue(()))
    });
    found
}

fn found_by_ray(tree: &impl Tree, path: &Path) -> BTreeSet<u32> {
    let mut found = BTreeSet::new();
    let Ok(()) = tree.visit_ray(&Line::new(path), 1.0, ALL_LAYERS, &mut Work::default(), |_, leaf| {
        found.insert(leaf);
        Ok(1.0)
    });
    found
}

fn random_box(random: &mut Random) -> Aabb {
    let center = random.vector() * 10.0;
    let half = random.vector().abs();
    Aabb::new(center - half, center + half)
}

/// The model: which leaf has which box.
type Model = BTreeMap<u32, Aabb>;

fn random_edit(tree: &mut DynamicTree, model: &mut Model, random: &mut Random, next: &mut u32) -> Option<Refit> {
    let margin = if random.unit() < 0.5 { 0.0 } else { 0.3 };
    let pick = model.keys().nth((random.unit() * model.len() as f64) as usize).copied();
    match (pick, random.unit()) {
        (Some(leaf), 0.0..0.2) => {
            model.remove(&leaf).expect("picked");
            tree.remove(leaf);
            None
        }
        (Some(leaf), 0.2..0.6) => {
            let step = random.vector() * if random.unit() < 0.7 { 0.4 } else { 8.0 };
            let bounds = model.get_mut(&leaf).expect("picked");
            *bounds = Aabb::new(bounds.min + step, bounds.max + step);
            Some(tree.update(leaf, *bounds, margin))
        }
        _ => {
            let bounds = random_box(random);
            model.insert(*next, bounds);
            tree.insert(*next, bounds, margin, ALL_LAYERS);
            *next += 1;
            None
        }
    }
}

fn assert_complete(tree: &DynamicTree, model: &Model, random: &mut Random) {
    let query = random_box(random).inflated(2.0);
    let found = found_by_box(tree, query);
    let path = Path { origin: random.vector() * 12.0, direction: random.vector() * 20.0, reach: DVec3::ZERO };
    let on_path = found_by_ray(tree, &path);
    let mut nearest = f64::INFINITY;
    let Ok(()) = tree.visit_nearest(query, f64::INFINITY, ALL_LAYERS, &mut Work::default(), |_, leaf| {
        nearest = nearest.min(model[&leaf].distance_sq(query));
        Ok(nearest.sqrt())
    });
    let mut brute_nearest = f64::INFINITY;
    for (leaf, &bounds) in model {
        assert!(tree.fat_bounds(*leaf).contains(bounds), "leaf {leaf} left its fat box");
        assert!(!bounds.intersects(query) || found.contains(leaf), "leaf {leaf} is missing");
        let is_on_path = (0..=32).any(|step| {
            let point = path.origin + path.direction * (f64::from(step) / 32.0);
            bounds.contains(Aabb::new(point, point))
        });
        assert!(!is_on_path || on_path.contains(leaf), "leaf {leaf} is missing on {path:?}");
        brute_nearest = brute_nearest.min(bounds.distance_sq(query));
    }
    assert_eq!(nearest, brute_nearest);
}

#[test]
fn random_edits_keep_it_sound_and_complete_and_its_clones_as_they_were() {
    let mut kinds = [0; 3];
    for seed in 1..=8 {
        let mut random = Random::new(seed);
        let (mut tree, mut model, mut next) = (DynamicTree::default(), Model::new(), 0);
        let mut kept: Option<(DynamicTree, Model)> = None;
        for edit in 0..1500 {
            if let Some(refit) = random_edit(&mut tree, &mut model, &mut random, &mut next) {
                kinds[refit as usize] += 1;
            }
            if random.unit() < 0.7 {
                tree.settle();
            }
            tree.assert_sound();
            assert_eq!(tree.len(), model.len());
            if edit % 10 == 0 {
                assert_complete(&tree, &model, &mut random);
            }
            if edit % 100 == 50 {
                if let Some((tree, model)) = &kept {
                    tree.assert_sound();
                    assert_complete(tree, model, &mut random);
                }
                kept = Some((tree.clone(), model.clone()));
            }
        }
        for leaf in std::mem::take(&mut model).into_keys() {
            tree.remove(leaf);
            tree.assert_sound();
        }
        assert!(tree.is_empty() && tree.bounds().is_none() && tree.depth() == 0);
    }
    assert!(kinds.iter().all(|&count| count > 100), "each kind of refit happens: {kinds:?}");
}

/// Boxes for which the surface-area heuristic alone makes a chain or does not care.
#[test]
fn no_order_of_boxes_makes_it_deep() {
    let count = 4096_u32;
    let nested = |i: u32| Aabb::new(DVec3::splat(-1.0 - f64::from(i)), DVec3::splat(1.0 + f64::from(i)));
    let equal = |_: u32| Aabb::new(DVec3::ZERO, DVec3::ONE);
    let point = |_: u32| Aabb::new(DVec3::ONE, DVec3::ONE);
    let row = |i: u32| Aabb::new(DVec3::X * f64::from(i), DVec3::X * f64::from(i) + 1.0);
    let doubling = |i: u32| Aabb::new(DVec3::X * f64::from(i).exp2().min(1e12), DVec3::X * 1e12);
    type Make<'a> = &'a dyn Fn(u32) -> Aabb;
    let families: [Make<'_>; 5] = [&nested, &equal, &point, &row, &doubling];
    for (family, make) in families.into_iter().enumerate() {
        for reversed in [false, true] {
            let mut tree = DynamicTree::default();
            for i in 0..count {
                tree.insert(i, make(if reversed { count - 1 - i } else { i }), 0.0, ALL_LAYERS);
                tree.settle();
            }
            tree.assert_sound();
            assert!(tree.depth() <= 28, "family {family} has {} levels", tree.depth());
            for leaf in (0..count).step_by(2) {
                tree.remove(leaf);
            }
            tree.assert_sound();
        }
    }
}

#[test]
fn it_is_about_as_good_as_a_fresh_tree_after_many_moves() {
    let mut random = Random::new(11);
    let mut tree = DynamicTree::default();
    let mut boxes: Vec<Aabb> = (0..5000)
        .map(|_| {
            let center = random.vector() * 100.0;
            Aabb::new(center - 1.0, center + 1.0)
        })
        .collect();
    for (leaf, bounds) in (0..).zip(&boxes) {
        tree.insert(leaf, *bounds, 0.0, ALL_LAYERS);
    }
    tree.settle();
    for _ in 0..40 {
        for (leaf, bounds) in (0..).zip(&mut boxes) {
            let step = random.vector();
            *bounds = Aabb::new(bounds.min + step, bounds.max + step);
            tree.update(leaf, *bounds, 0.2);
        }
        tree.settle();
    }
    tree.assert_sound();
    let fresh = StaticTree::build(&boxes);
    let (mut moved_work, mut fresh_work) = (Work::default(), Work::default());
    for bounds in &boxes {
        let Ok(()) = tree.visit_box(*bounds, ALL_LAYERS, &mut moved_work, |_, _| Ok(ControlFlow::Continue(())));
        let Ok(()) = fresh.visit_box(*bounds, ALL_LAYERS, &mut fresh_work, |_, _| Ok(ControlFlow::Continue(())));
    }
    let ratio = moved_work.nodes_visited as f64 / fresh_work.nodes_visited as f64;
    assert!(ratio < 2.0, "{ratio:.2} times the visits of a fresh tree, {} levels", tree.depth());
    let cost = tree.area_sum() / fresh.area_sum();
    assert!((0.5..2.0).contains(&cost), "{cost:.2} times the cost of a fresh tree");
}

/// Far moves, each a new place: a tree that let leaves stay where they were would become worse with each tick.
#[test]
fn far_moves_do_not_spoil_it_tick_by_tick() {
    let mut random = Random::new(12);
    let place = |random: &mut Random| {
        let center = random.vector() * 60.0;
        Aabb::new(center - 0.7, center + 0.7)
    };
    let mut tree = DynamicTree::default();
    let mut boxes: Vec<Aabb> = (0..4000).map(|_| place(&mut random)).collect();
    for (leaf, bounds) in (0..).zip(&boxes) {
        tree.insert(leaf, *bounds, 0.0, ALL_LAYERS);
    }
    tree.settle();
    let mut costs = Vec::new();
    for _ in 0..30 {
        for _ in 0..400 {
            let leaf = (random.unit() * boxes.len() as f64) as u32;
            boxes[leaf as usize] = place(&mut random);
            tree.update(leaf, boxes[leaf as usize], 0.0);
        }
        tree.settle();
        tree.assert_sound();
        costs.push(tree.area_sum() / StaticTree::build(&boxes).area_sum());
    }
    assert!(costs.iter().all(|&cost| cost < 1.4), "costs over those of fresh trees: {costs:.2?}");
}

#[test]
fn to_read_ahead_changes_nothing_and_takes_any_numbers() {
    let mut random = Random::new(3);
    let mut tree = DynamicTree::default();
    tree.read_ahead(0..100);
    for leaf in 0..20_000 {
        tree.insert(leaf, random_box(&mut random), 0.0, ALL_LAYERS);
    }
    tree.read_ahead(0..100);
    tree.settle();
    (0..64).for_each(|leaf| tree.remove(leaf));
    tree.insert(20_000, random_box(&mut random), 0.0, ALL_LAYERS);
    let (area, bytes) = (tree.area_sum(), tree.memory_bytes());
    for count in [0, 1, 31, 32, 33, 1000] {
        tree.read_ahead((0..count).map(|at| at * 30));
    }
    tree.read_ahead(19_990..20_100);
    assert_eq!((tree.area_sum(), tree.memory_bytes(), tree.len()), (area, bytes, 19_937));
    tree.assert_sound();
}
