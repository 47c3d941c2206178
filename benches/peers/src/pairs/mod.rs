//! Part B: one question to one pair of convex shapes, near contact.

mod dice;
mod errors;
mod ours;
mod parry;
mod workload;

use std::io;

pub(crate) use errors::Errors;

use crate::{
    report::Outcome,
    rows::{Pairing, Row},
    timing,
};
use workload::Workload;

/// Measures rows of one pairing on `count` pairs, and hands over each as it is done.
pub(crate) fn measure(
    pairing: Pairing,
    rows: &[&Row],
    count: usize,
    mut done: impl FnMut(Outcome) -> io::Result<()>,
) -> io::Result<()> {
    if rows.is_empty() {
        return Ok(());
    }
    let workload = Workload::new(pairing, count);
    let geometries: Vec<_> = workload.forms.iter().map(ours::geometry).collect();
    let shapes: Vec<_> = workload.forms.iter().map(parry::shape).collect();
    let mut ours = ours::Side::new(&geometries, &workload);
    let mut parry = parry::Side::new(&shapes, &workload);
    for &row in rows {
        ours.warm_up(row.operation);
        parry.warm_up(row.operation);
        let errors = Errors::between(&ours.proofs(row.operation), &parry.values(row.operation));
        let times = timing::compare(
            count,
            |operations| ours.time(row.operation, operations),
            |operations| parry.time(row.operation, operations),
        );
        done(Outcome { row: row.clone(), times, errors })?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rows::{Operation, PAIRINGS};

    #[test]
    fn half_of_the_near_pairs_overlap_and_two_thirds_of_the_crossings_hit() {
        for pairing in PAIRINGS {
            let workload = Workload::new(pairing, 500);
            let geometries: Vec<_> = workload.forms.iter().map(ours::geometry).collect();
            let shapes: Vec<_> = workload.forms.iter().map(parry::shape).collect();
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
