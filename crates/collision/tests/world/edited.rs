//! Random edits and questions, of all sizes and at all distances, against a plain list: see `model`.

use crate::{
    model::{Tally, check},
    random::Random,
};

#[test]
fn a_world_answers_as_a_list_does_whatever_it_goes_through() {
    let mut random = Random::new(77);
    let mut all = Tally::default();
    for _ in 0..400 {
        let bytes: Vec<u8> = (0..6000).map(|_| (random.bits() >> 20) as u8).collect();
        let tally = check(&bytes);
        all.ticks += tally.ticks;
        all.asked += tally.asked;
        all.errors += tally.errors;
        all.hits = [0, 1, 2, 3, 4].map(|kind| all.hits[kind] + tally.hits[kind]);
    }
    let Tally { ticks, asked, errors, hits } = all;
    assert!(ticks > 5000 && asked > 10_000 && errors * 2 < asked, "vacuous: {all:?}");
    assert!(hits.iter().all(|&hits| hits * 4 > asked / 5), "vacuous: {all:?}");
}
