//! Ticks retold as edits: a world that begins at an old tick and applies them is the same at each tick, and on the way between them.

use std::{collections::BTreeSet, sync::Arc};

use collision::{
    accuracy::Accuracy,
    answer::Verdict,
    world::{
        Edit, EditRule, Filter, FirstTouch, Means, Meter, Moment, QuestionError, Settings, Shape, ShapeId, Snapshot,
        Subject, Tick, Time, World,
    },
};

use crate::{
    history::{SHAPES, random_tick, world_with_history},
    random::Random,
    scene::{Frame, id, random_shapes},
};

const TICKS: u32 = 24;

fn then(newest: &Arc<Snapshot>, tick: Tick) -> Arc<Snapshot> {
    newest.at(Moment::Tick(tick)).expect("held")
}

/// What was there at a tick of some shapes.
fn shapes<'a>(then: &'a Snapshot, ids: &'a BTreeSet<ShapeId>) -> impl Iterator<Item = Shape> + 'a {
    ids.iter().filter_map(|&id| then.shape(id)).map(|shape| shape.into_owned())
}

fn told(found: Result<collision::world::Found<collision::world::PastTouch>, QuestionError>) -> (String, bool) {
    let is_hit =
        found.as_ref().is_ok_and(|found| found.verdict == Verdict::Hit && found.hits[0].impact.touch.fraction > 0.0);
    (format!("{found:?}"), is_hit)
}

#[test]
fn ticks_that_are_applied_as_they_are_retold_are_the_same_and_so_is_the_way_between_them() {
    let mut random = Random::new(77);
    let (mut touched, mut asked, mut travelled, mut put) = (0, 0, 0, 0);
    for _ in 0..6 {
        let mut world = world_with_history(2 * TICKS);
        let first = random_shapes(&mut random, Frame::UNIT, SHAPES).into_iter().map(Edit::Insert).collect();
        world.apply(first, Time(1), EditRule::AllOrNothing).expect("a tick");
        for number in 2..=TICKS {
            world
                .apply(random_tick(&mut random, Frame::UNIT), Time(number.into()), EditRule::LeaveOutWrong)
                .expect("a tick");
        }
        let newest = world.newest();
        // Half of the shapes: the others are nobody's to ask about.
        let ids: BTreeSet<ShapeId> = (1..=SHAPES).filter(|number| number % 2 == 0).map(id).collect();
        let from = Tick::new(5).expect("a tick");
        let settings = Settings { history_ticks: TICKS, ..Settings::default() };
        let began = shapes(&then(&newest, from), &ids).collect::<Vec<_>>();
        let mut retold = World::holding(began, from, Time(0), settings, Means::default());
        while retold.newest().tick() < newest.tick() {
            let tick = retold.newest().tick();
            let (before, after) = (then(&newest, tick), then(&newest, tick.saturating_add(1)));
            let edits = after.edits_from(&before, ids.iter().copied());
            travelled += edits.iter().filter(|edit| matches!(edit, Edit::Move { .. })).count();
            put += edits.iter().filter(|edit| matches!(edit, Edit::Insert(_))).count();
            retold.apply(edits, Time(0), EditRule::AllOrNothing).expect("no move of what is not there");
            let expected = World::holding(shapes(&after, &ids), from, Time(0), settings, Means::default());
            assert_eq!(retold.newest().content_hash(), expected.newest().content_hash(), "at {tick}");
        }
        let at_once = newest.edits_from(&then(&newest, from), ids.iter().copied());
        assert!(at_once.iter().all(|edit| !matches!(edit, Edit::Move { .. })), "of no way is anything known");
        let mut jumped = World::holding(shapes(&then(&newest, from), &ids), from, Time(0), settings, Means::default());
        jumped.apply(at_once, Time(0), EditRule::AllOrNothing).expect("a tick");
        assert_eq!(jumped.newest().content_hash(), retold.newest().content_hash());

        let others: Vec<ShapeId> = (1..=SHAPES).map(id).filter(|id| !ids.contains(id)).collect();
        let filter = Filter { exclude_ids: others, ..Filter::default() };
        for &subject in &ids {
            let subject = Subject::Shape { id: subject, pose: None };
            let question = FirstTouch { subject, against: None, from, to: newest.tick() };
            let ask = |world: &Arc<Snapshot>| {
                told(world.first_touch(&question, &filter, &Accuracy::default(), &mut Meter::new(&mut || true)))
            };
            let (expected, is_on_the_way) = ask(&newest);
            assert_eq!(ask(&retold.newest()).0, expected, "{question:?}");
            touched += usize::from(is_on_the_way);
            asked += 1;
        }
    }
    assert!(touched * 10 > asked, "vacuous: {touched} of {asked} touched on the way");
    assert!(travelled > 150 && put > 100, "vacuous: {travelled} moved, {put} put");
}
