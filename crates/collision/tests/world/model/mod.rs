//! A world and a plain list of shapes go through the same edits and are asked the same questions: the list asks the kernels
//! about one shape after the other. What happens is read from bytes, so that tests can draw it and a fuzzer can shape it.

mod brute;
mod check;
mod concave;
mod lists;
mod pierced;
mod script;

use std::sync::Arc;

use collision::world::{EditRule, Filter, Snapshot, Time, World};

pub(crate) use brute::Tally;
use brute::{Brute, debug};
use script::{Question, Script, Step};

/// Asks again what was asked of so many old versions.
const OLD_VERSIONS: usize = 4;

/// A version, a question and what was answered.
type Memory = (Arc<Snapshot>, Question, Filter, String);

/// Plays what the bytes say.
///
/// # Panics
/// If a law is broken.
pub(crate) fn check(bytes: &[u8]) -> Tally {
    let mut world = World::new(Time(0));
    let mut brute = Brute::default();
    let mut tally = Tally::default();
    let mut memories: Vec<Memory> = Vec::new();
    for step in Script::new(bytes) {
        match step {
            Step::Tick(edits) => {
                let faults = edits.iter().filter(|edit| brute.apply(edit).is_err()).count();
                let report = world.apply(edits, Time(0), EditRule::LeaveOutWrong).expect("time stands still");
                assert_eq!(report.faults.len(), faults, "moves of what is not there");
                check::assert_same_shapes(&world.newest(), &brute);
                tally.ticks += 1;
            }
            Step::Ask(asked) => {
                let (question, filter) = *asked;
                let newest = world.newest();
                let answer = brute.judge(&newest, &question, &filter, &mut tally);
                if memories.len() < OLD_VERSIONS {
                    memories.push((newest, question, filter, answer));
                } else if tally.asked.is_multiple_of(7) {
                    memories[tally.asked % OLD_VERSIONS] = (newest, question, filter, answer);
                }
            }
        }
    }
    for (version, question, filter, answer) in memories {
        assert_eq!(debug(&version, &question, &filter), answer, "version {} answers as it did", version.tick());
    }
    tally
}

/// What the bytes say, for a report.
#[allow(dead_code, reason = "only the fuzzer reports")]
pub(crate) fn describe(bytes: &[u8]) -> String {
    Script::new(bytes).map(|step| format!("{step:?}\n")).collect()
}
