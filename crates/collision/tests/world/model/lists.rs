//! What modes list, and what the list of all hits has to do with the kernels' touches.

use std::collections::BTreeMap;

use collision::{
    answer::Verdict,
    world::{HitMode, ShapeId},
};

use super::brute::{Hit, Touch};

/// What the modes that list hits in order leave out.
pub(super) fn judge_list(
    mode: HitMode,
    found: &[Hit],
    truncated: bool,
    all: &[Hit],
    kernel: &BTreeMap<ShapeId, [Option<Touch>; 2]>,
    what: &str,
) {
    let key = |hit: &Hit| (hit.value.to_bits(), hit.id, hit.certificate.verdict);
    let keys = |hits: &[Hit]| -> Vec<_> { hits.iter().map(key).collect() };
    let is_certain = |hit: &&Hit| hit.certificate.verdict == Verdict::Hit;
    match mode {
        HitMode::All(most) => {
            assert_eq!(keys(found), keys(&all[..all.len().min(most)]), "{what}");
            assert_eq!(truncated, all.len() > most, "{what}");
        }
        HitMode::Closest => {
            let closest = all.iter().find(is_certain);
            assert_eq!(found.iter().find(is_certain).map(key), closest.map(key), "{what}");
            let limit =
                all.iter().filter(is_certain).map(|hit| hit.certificate.bound.upper).fold(f64::INFINITY, f64::min);
            let open = all.iter().filter(|hit| !is_certain(hit) && hit.certificate.bound.lower < limit);
            for open in open {
                assert!(found.iter().any(|hit| key(hit) == key(open)), "{open:?} may come first: {found:?} {what}");
            }
            for open in found.iter().filter(|hit| !is_certain(hit)) {
                assert!(open.certificate.bound.lower < limit, "{open:?} comes after {limit}: {what}");
            }
        }
        HitMode::Any => match found.iter().find(is_certain) {
            Some(hit) => assert!(kernel[&hit.id][0].is_some() && found.len() == 1, "{what}"),
            None => assert_eq!(keys(found), keys(all), "{what}"),
        },
        HitMode::Pierce { .. } => panic!("it lists no hits behind a blocker: pierced.rs"),
    }
}

pub(super) fn judge_all(all: &[Hit], kernel: &BTreeMap<ShapeId, [Option<Touch>; 2]>, what: &str) {
    let in_order = |pair: &[Hit]| pair[0].value.total_cmp(&pair[1].value).then(pair[0].id.cmp(&pair[1].id)).is_lt();
    assert!(all.windows(2).all(in_order), "order: {all:?} {what}");
    for hit in all {
        let [certain, undecided] = kernel.get(&hit.id).unwrap_or_else(|| panic!("{} is not seen: {what}", hit.id));
        let touch = if hit.certificate.verdict == Verdict::Hit { certain } else { undecided };
        let (value, certificate) = touch.unwrap_or_else(|| panic!("the kernel does not find {hit:?}: {what}"));
        let bound = hit.certificate.bound;
        assert!(bound.contains(hit.value), "{hit:?}: {what}");
        assert!(bound.lower >= certificate.bound.lower, "{hit:?}: {what}");
        // Where its box begins beyond all that an open touch may be, there is none: the interval shrinks to that place.
        let is_beyond = hit.certificate.verdict == Verdict::Undecided && bound.lower == bound.upper;
        assert!(bound.upper == certificate.bound.upper || is_beyond, "{hit:?}, {certificate:?}: {what}");
        assert!(hit.value == value || hit.value == bound.lower, "{hit:?}, the kernel says {value}: {what}");
    }
    for (id, [certain, _]) in kernel {
        let is_there = all.iter().any(|hit| hit.id == *id && hit.certificate.verdict == Verdict::Hit);
        assert!(certain.is_none() || is_there, "{id} is missing: {certain:?} {what}");
    }
}
