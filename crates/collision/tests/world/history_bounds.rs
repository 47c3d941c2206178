//! How far back a world can be asked, what it says beyond, and what its history may hold.

use collision::{
    DVec3,
    math::Pose,
    world::{Edit, EditRule, HistoryError, Means, Moment, Settings, Tick, Time, World},
};

use crate::{
    history::{random_tick, world_with_history},
    random::Random,
    scene::{Frame, id, random_geometry, shape},
};

fn tick(number: u64) -> Tick {
    Tick::new(number).expect("not 0")
}

fn empty_ticks(world: &mut World, times: impl IntoIterator<Item = i64>) {
    for time in times {
        world.apply(Vec::new(), Time(time), EditRule::AllOrNothing).expect("a tick");
    }
}

#[test]
fn so_many_ticks_are_held_and_the_error_names_the_oldest() {
    let mut world = world_with_history(5);
    empty_ticks(&mut world, (1..20).map(|number| number * 100));
    let newest = world.newest();
    assert_eq!((newest.tick(), newest.oldest_tick()), (tick(20), tick(15)));
    let (oldest, newest_tick) = (tick(15), tick(20));
    let at = |moment| newest.at(moment).map(|past| (past.tick().get(), past.fraction()));
    assert_eq!(at(Moment::Tick(tick(15))), Ok((15, 0.0)));
    assert_eq!(at(Moment::Between(tick(19), 0.5)), Ok((19, 0.5)));
    assert_eq!(at(Moment::Tick(tick(20))), Ok((20, 0.0)));
    let gone = HistoryError::Gone { asked: tick(14), oldest, newest: newest_tick };
    assert_eq!(at(Moment::Tick(tick(14))), Err(gone));
    assert_eq!(at(Moment::Between(tick(14), 0.9)), Err(gone));
    assert_eq!(gone.to_string(), "tick 14 is no longer held: the oldest is 15, the newest 20");
    let not_made = HistoryError::NotMade { asked: tick(21), oldest, newest: newest_tick };
    assert_eq!(at(Moment::Tick(tick(21))), Err(not_made));
    assert_eq!(at(Moment::Between(tick(20), 0.1)), Err(HistoryError::NothingAfter { oldest, newest: newest_tick }));
    assert_eq!(at(Moment::Between(tick(18), 1.0)), Err(HistoryError::Fraction(1.0)));
    assert!(at(Moment::Between(tick(18), f64::NAN)).is_err());
    assert_eq!(at(Moment::Time(Time(1399))), Err(HistoryError::TimeGone { oldest, newest: newest_tick }));
    assert_eq!(at(Moment::Time(Time(1400))), Ok((15, 0.0)));
    assert_eq!(at(Moment::Time(Time(1725))), Ok((18, 0.25)));
    assert_eq!(at(Moment::Time(Time(1900))), Ok((20, 0.0)));
    assert_eq!(at(Moment::Time(Time(i64::MAX))), Ok((20, 0.0)), "nothing is extrapolated");
    let past = newest.at(Moment::Tick(tick(16))).expect("it is held");
    assert_eq!(past.at(Moment::Tick(tick(14))).map(|past| past.tick()), Err(gone), "a past moment knows no more");
    assert_eq!(past.at(Moment::Tick(tick(20))).map(|past| past.tick()), Ok(tick(20)));
}

#[test]
fn of_ticks_of_one_time_the_last_is_meant() {
    let mut world = world_with_history(64);
    empty_ticks(&mut world, [10, 10, 10, 30, 30, 50]);
    let at = |time| world.newest().at(Moment::Time(Time(time))).map(|past| (past.tick().get(), past.fraction()));
    // Tick 1 is of time 0, ticks 2 to 4 of 10, 5 and 6 of 30, 7 of 50.
    assert_eq!(at(0), Ok((1, 0.0)));
    assert_eq!(at(5), Ok((1, 0.5)));
    assert_eq!(at(10), Ok((4, 0.0)));
    assert_eq!(at(15), Ok((4, 0.25)));
    assert_eq!(at(30), Ok((6, 0.0)));
    assert_eq!(at(49), Ok((6, 0.95)));
    assert!(at(-1).is_err());
}

#[test]
fn a_changed_setting_holds_at_once_for_less_and_from_then_on_for_more() {
    let mut world = world_with_history(10);
    let set = |world: &mut World, ticks| world.set(Settings { history_ticks: ticks, ..Settings::default() });
    empty_ticks(&mut world, 1..=20);
    set(&mut world, 4);
    assert_eq!((world.newest().tick(), world.newest().oldest_tick()), (tick(21), tick(17)));
    set(&mut world, 8);
    assert_eq!(world.newest().oldest_tick(), tick(17));
    empty_ticks(&mut world, 30..40);
    assert_eq!((world.newest().tick(), world.newest().oldest_tick()), (tick(31), tick(23)));
    assert_eq!(world.newest().at(Moment::Tick(tick(23))).map(|past| past.time()), Ok(Time(31)));
    set(&mut world, 0);
    assert_eq!(world.newest().oldest_tick(), tick(31));
    empty_ticks(&mut world, 50..60);
    assert_eq!(world.newest().oldest_tick(), world.newest().tick());
}

/// What the description says that a structure holds; 0 if it is not there.
fn bytes(world: &World, name: &str) -> u64 {
    let description = world.newest().describe();
    description.built.iter().find(|built| built.name == name).map_or(0, |built| built.memory_bytes)
}

#[test]
fn the_history_holds_no_more_than_it_may_and_the_oldest_goes_first() {
    let mut random = Random::new(41);
    let means = Means { history_bytes: 40_000, past_bytes: 100_000, clock: None };
    let mut world = World::with(Time(0), Settings { history_ticks: 1000, margin: None }, means);
    let (mut least_ticks, mut most_bytes) = (u64::MAX, 0);
    for number in 1..=600 {
        world.apply(random_tick(&mut random, Frame::UNIT), Time(number), EditRule::LeaveOutWrong).expect("a tick");
        let newest = world.newest();
        // 1,000 places take 8 bytes each.
        most_bytes = most_bytes.max(bytes(&world, "history"));
        if number > 300 {
            least_ticks = least_ticks.min(newest.tick().get() - newest.oldest_tick().get());
            let span = newest.tick().get() - newest.oldest_tick().get();
            let asked = newest.oldest_tick().saturating_add(random.bits() % (span + 1));
            assert_eq!(newest.at(Moment::Tick(asked)).map(|past| past.tick()), Ok(asked));
        }
    }
    assert!(most_bytes < 40_000 + 10_000, "{most_bytes}");
    assert!(least_ticks > 2 && most_bytes > 30_000, "vacuous: {least_ticks} ticks, {most_bytes} bytes");
}

/// However many moments are asked, what was built for them stays within its bound: here that of one span and more.
#[test]
fn what_questions_to_the_past_had_built_is_let_go() {
    let mut random = Random::new(42);
    let means = Means { past_bytes: 400_000, ..Means::default() };
    let mut world = World::with(Time(0), Settings { history_ticks: 400, margin: None }, means);
    let shapes = |random: &mut Random| {
        let shapes = (1..=300).map(|number| {
            let position = random.vector() * 20.0;
            Edit::Insert(shape(number, random_geometry(random, Frame::UNIT), Pose::at(position)))
        });
        shapes.collect::<Vec<_>>()
    };
    world.apply(shapes(&mut random), Time(0), EditRule::AllOrNothing).expect("a tick");
    let (mut most, mut most_count) = (0, 0);
    for number in 1..=400 {
        let moves = (1..=300).step_by(3).map(|number| Edit::Move {
            id: id(number),
            position: Some(random.vector() * 20.0),
            rotation: None,
            velocity: None,
            angular_velocity: None,
            teleport: false,
        });
        world.apply(moves.collect(), Time(number), EditRule::AllOrNothing).expect("a tick");
        let newest = world.newest();
        let asked = newest.oldest_tick().saturating_add(random.bits() % newest.tick().get());
        newest.at(Moment::Tick(asked.min(newest.tick()))).expect("it is held");
        let description = newest.describe();
        if let Some(past) = description.built.iter().find(|built| built.name == "past_trees") {
            (most, most_count) = (most.max(past.memory_bytes), most_count.max(past.count));
        }
    }
    assert!(most < 800_000 && most > 200_000 && most_count > 1, "{most} bytes, {most_count} spans");
    let nothing = |world: &World| bytes(world, "past_trees");
    assert!(nothing(&world) > 0);
    empty_ticks(&mut world, 500..900);
    assert_eq!(nothing(&world), 0, "all that was asked is no longer held");
}

/// A history so long that it holds whole versions: the walk from one of them finds the same.
#[test]
fn a_long_history_is_right_at_each_of_its_ends() {
    let mut random = Random::new(43);
    let mut world = world_with_history(3000);
    let place = |number: i64| DVec3::new(number as f64, 0.0, 0.0);
    let insert = shape(1, random_geometry(&mut random, Frame::UNIT), Pose::IDENTITY);
    world.apply(vec![Edit::Insert(insert)], Time(1), EditRule::AllOrNothing).expect("a tick");
    for number in 2..=3000 {
        let mut edits = random_tick(&mut random, Frame::UNIT);
        edits.retain(|edit| match edit {
            Edit::Move { id: other, .. } | Edit::Remove(other) => *other != id(1),
            Edit::Insert(shape) => shape.id != id(1),
            Edit::Clear => false,
        });
        edits.push(Edit::Move {
            id: id(1),
            position: Some(place(number)),
            rotation: None,
            velocity: None,
            angular_velocity: None,
            teleport: false,
        });
        world.apply(edits, Time(number), EditRule::LeaveOutWrong).expect("a tick");
    }
    let newest = world.newest();
    assert_eq!(newest.oldest_tick(), tick(1));
    for number in [2, 3, 100, 997, 1500, 2200, 2990, 2999] {
        let past = newest.at(Moment::Between(tick(number as u64 + 1), 0.5)).expect("it is held");
        let position = past.shape(id(1)).expect("it is there").pose.position;
        assert_eq!(position, place(number) + DVec3::X * 0.5);
        assert_eq!(past.time(), Time(number));
    }
}
