//! Both trees find exactly the overlapping pairs of the shared sets of boxes (`aabb/` in the data's FORMAT.md).

use std::{
    ops::ControlFlow,
    path::{Path, PathBuf},
};

use collision::{
    DVec3,
    answer::Work,
    broad::{ALL_LAYERS, DynamicTree, StaticTree, Tree},
    math::Aabb,
};

/// The folder of shared data; `None`, said plainly, where it is absent.
fn data() -> Option<PathBuf> {
    let workspace = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let folder = std::env::var_os("CALIPERS_DATA").map_or_else(|| PathBuf::from("../shared/data"), PathBuf::from);
    let folder = workspace.join(folder);
    if folder.join("aabb").is_dir() {
        return Some(folder);
    }
    let is_ci = std::env::var_os("CI").is_some_and(|value| value == "true");
    assert!(!(is_ci && workspace.join("../shared").exists()), "there is no {}", folder.display());
    eprintln!("passed over: there is no shared data in {}", folder.display());
    None
}

fn boxes(file: &Path) -> Vec<Aabb> {
    let bytes = std::fs::read(file).expect("a readable file");
    assert_eq!(bytes.len() % 24, 0, "six floats a box");
    let corner = |bytes: &[u8], at: usize| {
        let float = |at: usize| f64::from(f32::from_le_bytes(bytes[at..at + 4].try_into().expect("four bytes")));
        DVec3::new(float(at), float(at + 4), float(at + 8))
    };
    bytes.chunks_exact(24).map(|bytes| Aabb::new(corner(bytes, 0), corner(bytes, 12))).collect()
}

/// Number of pairs i < j, and the order-free hash of FORMAT.md.
fn pairs(tree: &impl Tree, boxes: &[Aabb]) -> (u64, u64) {
    let (mut count, mut hash) = (0, 0_u64);
    for (i, bounds) in (0_u64..).zip(boxes) {
        let Ok(()) = tree.visit_box(*bounds, ALL_LAYERS, &mut Work::default(), |_, leaf| {
            let j = u64::from(leaf);
            if i < j && boxes[leaf as usize].intersects(*bounds) {
                count += 1;
                let mut x = i.wrapping_mul(0x9E37_79B9_7F4A_7C15).wrapping_add(j.wrapping_mul(0xC2B2_AE3D_27D4_EB4F));
                x ^= x >> 29;
                x = x.wrapping_mul(0xBF58_476D_1CE4_E5B9);
                x ^= x >> 32;
                hash = hash.wrapping_add(x);
            }
            Ok(ControlFlow::Continue(()))
        });
    }
    (count, hash)
}

#[test]
fn both_trees_find_the_pairs_of_the_shared_sets() {
    let Some(data) = data() else {
        return;
    };
    for (name, count, hash) in
        [("box3d_bounds01", 650, 12_634_663_155_596_862_532), ("bullet_gpu_32006", 12, 15_907_769_130_623_324_597)]
    {
        let boxes = boxes(&data.join(format!("aabb/{name}.f32")));
        assert_eq!(pairs(&StaticTree::build(&boxes), &boxes), (count, hash), "static tree, {name}");
        let mut tree = DynamicTree::default();
        let margin = boxes[0].half_area().sqrt();
        for (leaf, bounds) in (0..).zip(&boxes) {
            tree.insert(leaf, *bounds, margin, ALL_LAYERS);
        }
        tree.settle();
        tree.assert_sound();
        assert_eq!(pairs(&tree, &boxes), (count, hash), "dynamic tree, {name}");
    }
}
