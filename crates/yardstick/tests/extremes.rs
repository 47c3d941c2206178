//! Every kind of form at every extreme: no NaN, bounded work, the truth inside, both orders alike, the same elsewhere, and scaled bit by
//! bit.
//!
//! `CALIPERS_EXTREMES=N` asks all pairs of kinds N questions for each extreme; without it some of them one.

use yardstick::coverage::Sweep;

/// Questions for each cell, and of how many cells one is asked.
fn size() -> (u64, usize) {
    match std::env::var("CALIPERS_EXTREMES").ok().and_then(|count| count.parse().ok()) {
        Some(count) => (count, 1),
        None => (1, 7),
    }
}

#[track_caller]
fn expect(sweep: &Sweep, cells_min: usize) {
    assert!(sweep.faults.is_empty(), "{} of {}:\n{}", sweep.faults.len(), sweep.answers, sweep.faults.join("\n"));
    let (asked, enough) = (sweep.cells, sweep.answers >= 2 * sweep.cells * 9 / 10 && sweep.scaled >= sweep.cells);
    assert!(asked >= cells_min && enough, "{asked} cells, {} answers, {} scaled", sweep.answers, sweep.scaled);
}

#[test]
fn pairs_of_convex_forms() {
    let (questions, stride) = size();
    let mut sweep = Sweep::default();
    sweep.pairs(questions, stride);
    expect(&sweep, 970 / stride);
}

#[test]
fn convex_forms_in_motion() {
    let (questions, stride) = size();
    let mut sweep = Sweep::default();
    sweep.moves(questions, stride);
    expect(&sweep, 700 / stride);
}

#[test]
fn concave_forms() {
    let (questions, stride) = size();
    let mut sweep = Sweep::default();
    sweep.wholes(questions, stride);
    expect(&sweep, 520 / stride);
}
