//! What the adversarial search found is still answered rightly, and the search climbs.

use std::path::Path;

use yardstick::attack::{Climb, Find, climb};

fn kept() -> Vec<Find> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("attacks.json");
    serde_json::from_slice(&std::fs::read(path).expect("the finds")).expect("finds")
}

#[test]
fn the_worst_finds_are_answered_rightly() {
    let finds = kept();
    for find in &finds {
        let again = find.measured().expect("a question");
        assert!(again.ratio <= 1.0, "was {}: {again:?}", find.ratio);
    }
    for sort in [(2, true), (1, false), (2, false)] {
        assert!(finds.iter().filter(|find| find.sort() == sort).count() >= 8, "{sort:?}");
    }
}

#[test]
fn the_search_climbs_and_is_named_by_its_seed() {
    let search = |steps: u64| climb(&Climb { seed: 7, starts: 12, steps, keep: 4 });
    let (before, after) = (search(0), search(20));
    assert_eq!(after, search(20));
    let sum = |finds: &[Find]| finds.iter().map(|find| find.ratio).sum::<f64>();
    assert!(sum(&after) > sum(&before) && after.iter().all(|find| find.ratio <= 1.0), "{after:?}");
}
