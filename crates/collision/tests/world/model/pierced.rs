//! What pierces: all up to the first certain blocker, as the list of all hits has it.

use collision::{
    answer::Verdict,
    world::{Means, Settings, Shape, ShapeId, Snapshot, World},
};

use super::brute::{Brute, Hit};

/// The same shapes where none is a sensor: the list of all impacts has no sensors, and what pierces goes through them.
pub(super) fn without_sensors(brute: &Brute, version: &Snapshot) -> std::sync::Arc<Snapshot> {
    let shapes = brute.shapes.values().map(|shape| Shape { sensor: false, ..shape.clone() });
    World::holding(shapes, version.tick(), version.time(), Settings::default(), Means::default()).newest()
}

/// The answer to a question that pierces.
pub(super) struct Answer<'a> {
    pub(super) found: &'a [Hit],
    pub(super) truncated: bool,
    pub(super) verdict: Verdict,
    /// Hits asked for besides the blocker.
    pub(super) most: usize,
}

/// `all` are the hits of the same question in the mode that lists all; `is_pierced` tells what blocks nothing.
pub(super) fn judge(answer: &Answer<'_>, all: &[Hit], is_pierced: impl Fn(ShapeId) -> bool, what: &str) {
    let Answer { found, truncated, verdict, most } = *answer;
    let all: Vec<Hit> = all.iter().map(|hit| Hit { pierced: is_pierced(hit.id), ..*hit }).collect();
    let is_blocker = |hit: &Hit| hit.certificate.verdict == Verdict::Hit && !hit.pierced;
    let key = |hit: &Hit| (hit.value.to_bits(), hit.id, hit.certificate.verdict, hit.pierced);
    let blocker = all.iter().find(|hit| is_blocker(hit));
    let limit = all.iter().filter(|hit| is_blocker(hit)).map(|hit| hit.certificate.bound.upper);
    let limit = limit.fold(f64::INFINITY, f64::min);
    let expected = match (blocker, all.iter().any(|hit| !hit.pierced)) {
        (Some(_), _) => Verdict::Hit,
        (None, true) => Verdict::Undecided,
        (None, false) => Verdict::Miss,
    };
    assert_eq!(verdict, expected, "{what}");
    let last = found.last().filter(|hit| is_blocker(hit));
    assert_eq!(last.map(key), blocker.map(key), "the blocker, whatever is left out: {what}");
    let is_before = |hit: &&Hit| !is_blocker(hit) && hit.certificate.bound.lower <= limit;
    let before: Vec<_> = all.iter().filter(is_before).map(key).collect();
    let own: Vec<_> = found[..found.len() - usize::from(last.is_some())].iter().map(key).collect();
    for hit in &own {
        // What may block before it surely does is told besides; the list of all has one hit of each shape.
        let is_told = |other: &Hit| other.id == hit.1 && is_blocker(other) && hit.2 == Verdict::Undecided;
        assert!(before.contains(hit) || all.iter().any(is_told), "{hit:?} is not before the blocker: {what}");
    }
    assert!(own.len() <= most, "{} where {most} were asked: {what}", own.len());
    if truncated {
        assert_eq!(own.len(), most, "what is left out had no place: {what}");
    } else {
        assert!(before.iter().all(|hit| own.contains(hit)), "{before:?} come before {own:?}: {what}");
    }
}
