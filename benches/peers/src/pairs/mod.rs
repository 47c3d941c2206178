//! Part B: one question to one pair of convex shapes, near contact.

mod ours;
mod parry;
mod rows;
mod workload;

use std::io;

pub(crate) use rows::{Question, rows};

use crate::{
    errors::Errors,
    forms::{geometry, parry_shape},
    report::Outcome,
    rows::{Row, Task},
    timing,
};
use rows::{Operation, PAIRINGS, Pairing};
use workload::Workload;

/// Measures those of the rows that are of part B on `count` pairs, and hands over each as it is done.
pub(crate) fn measure(rows: &[Row], count: usize, mut done: impl FnMut(Outcome) -> io::Result<()>) -> io::Result<()> {
    for pairing in PAIRINGS {
        let rows = rows.iter().filter_map(|row| match row.task {
            Task::Pair(question) if question.pairing == pairing => Some((row, question.operation)),
            _ => None,
        });
        measure_pairing(pairing, &rows.collect::<Vec<_>>(), count, &mut done)?;
    }
    Ok(())
}

fn measure_pairing(
    pairing: Pairing,
    rows: &[(&Row, Operation)],
    count: usize,
    done: &mut impl FnMut(Outcome) -> io::Result<()>,
) -> io::Result<()> {
    if rows.is_empty() {
        return Ok(());
    }
    let workload = Workload::new(pairing, count);
    let geometries: Vec<_> = workload.forms.iter().map(geometry).collect();
    let shapes: Vec<_> = workload.forms.iter().map(parry_shape).collect();
    let mut ours = ours::Side::new(&geometries, &workload);
    let mut parry = parry::Side::new(&shapes, &workload);
    for &(row, operation) in rows {
        ours.warm_up(operation);
        parry.warm_up(operation);
        let errors = Errors::between(&ours.proofs(operation), &parry.values(operation));
        let times = timing::compare(
            count,
            |operations| ours.time(operation, operations),
            |operations| parry.time(operation, operations),
        );
        done(Outcome { row: row.clone(), times, errors })?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_of_the_near_pairs_overlap_and_two_thirds_of_the_crossings_hit() {
        for pairing in PAIRINGS {
            let workload = Workload::new(pairing, 500);
            let geometries: Vec<_> = workload.forms.iter().map(geometry).collect();
            let shapes: Vec<_> = workload.forms.iter().map(parry_shape).collect();
            let mut ours = ours::Side::new(&geometries, &workload);
            let mut parry = parry::Side::new(&shapes, &workload);
            let crossings = 0.55..0.8;
            for (operation, shares, most) in [
                (Operation::Overlap, 0.4..0.6, 0.0),
                (Operation::Impact, crossings.clone(), 1e-9),
                (Operation::ImpactRotating, crossings, 0.005),
            ] {
                let errors = Errors::between(&ours.proofs(operation), &parry.values(operation));
                assert!(shares.contains(&errors.hit_share), "{pairing:?} {operation:?}: {}", errors.hit_share);
                assert!(errors.max_error <= most, "{pairing:?} {operation:?}: {}", errors.max_error);
                assert!(errors.peer_wrong_count < 10, "{pairing:?} {operation:?}: {}", errors.peer_wrong_count);
            }
        }
    }
}
