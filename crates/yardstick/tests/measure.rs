//! What is measured holds the truth, is the same each time, and is drawn without help from elsewhere.

use collision::accuracy::{Accuracy, Tier};
use yardstick::{
    measure::{self, Kind, Knob, Options, Row},
    scenes::{Name, Scene},
};

fn few(kinds: &[Kind], count: usize) -> Options {
    Options { kinds: kinds.to_vec(), count, turns: 0, ..Options::default() }
}

#[test]
fn every_answer_on_every_scene_holds_the_truth_at_every_setting() {
    for name in Name::ALL {
        let scene = Scene::named(name, 5);
        // Meshes against meshes take long without optimisation.
        let kinds: &[Kind] = if name == Name::Debris { &Kind::ALL[..4] } else { &Kind::ALL };
        let report = measure::run(&scene, &few(kinds, 3), &mut |_, _, _| {});
        assert!(report.lies.is_empty(), "{}: {:?}", name.text(), report.lies);
        assert!(report.rows.iter().all(|row| row.held == row.count), "{}", name.text());
        let asked: usize = report.audited.iter().map(|audited| audited.answers).sum();
        let judged: usize = report.audited.iter().map(|audited| audited.judged).sum();
        assert!(asked >= 8, "{} asks of empty space: {asked} answers", name.text());
        assert!(judged > 0 || name == Name::Debris, "{}: the oracle judged nothing", name.text());
    }
}

#[test]
fn a_tighter_tolerance_is_never_farther_off_than_it_allows() {
    let report = measure::run(
        &Scene::named(Name::Coins, 1),
        &few(&[Kind::Distance, Kind::TurningImpact], 12),
        &mut |_, _, _| {},
    );
    let tolerances = report.rows.iter().filter(|row| row.knob == Knob::MaxError);
    let mut some_error = 0.0_f64;
    for row in tolerances {
        let allowed: f64 = row.label.trim_end_matches(" m").parse().expect("a number of metres");
        // Below what rounding allows intervals are as wide as that.
        assert!(row.error[2] <= allowed.max(1e-12), "{}: {:e}", row.label, row.error[2]);
        some_error = some_error.max(row.error[2]);
    }
    assert!(some_error > 1e-6, "nothing was traded: {some_error:e}");
}

#[test]
fn advice_is_the_same_each_time_and_is_good_enough() {
    let scene = Scene::named(Name::Coins, 1);
    let advised = || {
        let advice = measure::advise(&scene, 1e-4, &few(&Kind::ALL, 10), &mut |_, _, _| {}).expect("no answer lies");
        let told = |row: &Row| (row.request.clone(), row.work[3], row.error[2]);
        advice.iter().map(|one| (one.kind, told(&one.chosen), one.proved.as_ref().map(told))).collect::<Vec<_>>()
    };
    let first = advised();
    assert_eq!(first, advised());
    assert_eq!(first.len(), Kind::ALL.len());
    for (kind, (request, steps, error), _) in &first {
        assert!(*kind == Kind::Overlap || *error <= 1e-4, "{kind:?}: {request} is off by {error:e}");
        assert!(*steps > 0.0);
    }
    let (_, chosen, _) = first.iter().find(|(kind, ..)| *kind == Kind::TurningImpact).expect("it is asked");
    assert!(chosen.0 != r#"{"tier":"TIER_EXACT"}"#, "an error of 0.1 mm saves work where things turn");
}

#[test]
fn a_page_has_every_setting_and_needs_nothing_from_elsewhere() {
    let report = measure::run(&Scene::named(Name::Arena, 1), &few(&[Kind::Raycast], 4), &mut |_, _, _| {});
    let page = measure::page(std::slice::from_ref(&report));
    for outside in ["src=", "href=", "@import", "url(", "fetch("] {
        assert!(!page.contains(outside), "{outside}");
    }
    let drawn = page.matches("<title>").count() - 1;
    assert_eq!(drawn, report.rows.len());
    let mut csv = Vec::new();
    measure::csv(&report.rows, &mut csv).expect("memory takes it");
    let csv = String::from_utf8(csv).expect("text");
    assert_eq!(csv.lines().count(), report.rows.len() + 1);
    let wide = csv.lines().next().map_or(0, |names| names.split(',').count());
    assert!(wide == 23 && csv.contains(r#""{""maxError"":1e-3}""#), "{csv}");
}

#[test]
fn the_document_promises_what_the_tiers_are() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/accuracy.md");
    let document = std::fs::read_to_string(path).expect("docs/accuracy.md is there");
    for (name, tier) in [("FAST", Tier::Fast), ("STANDARD", Tier::Standard), ("EXACT", Tier::Exact)] {
        let row = document.lines().find(|line| line.starts_with(&format!("| {name} |"))).expect("a row for each tier");
        let cells: Vec<&str> = row.split('|').map(str::trim).collect();
        let Accuracy { max_error_relative, budget, .. } = Accuracy::of(tier);
        assert_eq!(cells[2].parse(), Ok(max_error_relative), "{row}");
        assert_eq!(cells[3].parse(), Ok(budget), "{row}");
        assert_eq!(cells[4] == "may answer", Accuracy::of(tier).may_stand_in(), "{row}");
    }
    let plots = document.lines().filter_map(|line| line.split_once("](accuracy/")?.1.split_once(')')).map(|it| it.0);
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/accuracy/");
    let missing: Vec<&str> =
        plots.clone().filter(|plot| !std::path::Path::new(&format!("{folder}{plot}")).is_file()).collect();
    assert!(plots.count() >= 6 && missing.is_empty(), "{missing:?}");
}
