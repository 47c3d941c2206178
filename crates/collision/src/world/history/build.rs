//! How a span is made of a later state and the records up to there.
//!
//! # Method
//! The records are walked back from the later state, which costs what changed meanwhile. Before the walk comes to the span,
//! each slot that changed only keeps what it held; within the span each change begins a stretch of the slot's story. The
//! walk is kept short by whole versions among the records: one is kept whenever the records since the last hold twice as
//! much memory as it would. So it never goes over much more than two changes for each shape, however long the history is,
//! and the versions take a third of its memory at most; a history shorter than that has none.

use std::sync::OnceLock;

use super::{
    super::{Shape, Tick, edit::Motion, state::State, store::Slot},
    History, Record,
    span::{Rest, Span},
    track::{Arrival, Origin, Placement, Track},
};
use crate::broad::StaticTree;

/// No stretch.
const NONE: u32 = u32::MAX;

/// What a slot held.
#[derive(Clone, Copy, Debug)]
struct Held {
    origin: Origin,
    placement: Placement,
}

/// A time without change in the story of a slot.
#[derive(Clone, Copy, Debug)]
struct Stretch {
    /// Ticks after the first of the span.
    from: u8,
    held: Option<Held>,
    /// How it came from the stretch before; `None` if it is another shape.
    arrival: Option<Arrival>,
    next: u32,
}

/// A slot that changed, at the time that the walk has come to.
#[derive(Debug)]
struct Story {
    slot: Slot,
    held: Option<Held>,
    /// What came then, within the span.
    next: u32,
}

struct Walk<'a> {
    base: &'a State,
    /// By slot: one more than the index of its story, or 0.
    places: Vec<u32>,
    stories: Vec<Story>,
    stretches: Vec<Stretch>,
    own: Vec<Shape>,
}

/// The span from `first` to `last`, whose records up to `newest` are all in `history`.
///
/// # Panics
/// If one of them is not.
pub(super) fn build(newest: (&State, Tick), history: &History, first: Tick, last: Tick) -> Span {
    let record = |tick: u64| Tick::new(tick).and_then(|tick| history.record(tick)).expect("what led to a held tick");
    let keyframe = (last.get()..newest.1.get()).find_map(|tick| {
        let tick = Tick::new(tick).filter(|tick| *tick > first)?;
        record(tick.get()).keyframe.as_ref().map(|state| (&**state, tick))
    });
    let (base, base_tick) = keyframe.unwrap_or(newest);
    let mut walk = Walk { base, places: Vec::new(), stories: Vec::new(), stretches: Vec::new(), own: Vec::new() };
    for tick in (first.get() + 1..=base_tick.get()).rev() {
        let within = (tick <= last.get()).then(|| (tick - first.get()) as u8);
        walk.undo(record(tick), within);
    }
    walk.finish(first, (last.get() - first.get()) as u8)
}

impl Walk<'_> {
    /// Goes back over one record; `within` is its tick, if that is of the span.
    fn undo(&mut self, record: &Record, within: Option<u8>) {
        for (slot, was) in &*record.replaced {
            let place = self.place(*slot);
            self.part(place, within, None);
            // Before the span is reached, nobody else names a shape that is undone once more.
            let known = self.stories[place].held.map(|held| held.origin);
            self.stories[place].held = was.as_ref().map(|shape| {
                let index = match known {
                    Some(Origin::Own(index)) if within.is_none() => {
                        self.own[index as usize] = (**shape).clone();
                        index
                    }
                    _ => {
                        self.own.push((**shape).clone());
                        (self.own.len() - 1) as u32
                    }
                };
                Held { origin: Origin::Own(index), placement: Placement::of(shape) }
            });
        }
        for moved in &*record.moved {
            let place = self.place(moved.slot);
            let arrival = match moved.motion {
                Motion::Travelled => Arrival::Went,
                Motion::Teleported => Arrival::Jumped,
            };
            self.part(place, within, Some(arrival));
            if let Some(held) = &mut self.stories[place].held {
                held.placement.pose = moved.pose;
            }
        }
        for sped in &*record.sped {
            let place = self.place(sped.slot);
            if let Some(held) = &mut self.stories[place].held {
                held.placement.velocity = sped.velocity;
                held.placement.angular_velocity = sped.angular_velocity;
            }
        }
    }

    /// The index of the story of a slot; one that begins here begins with what the base holds.
    fn place(&mut self, slot: Slot) -> usize {
        let at = slot.0 as usize;
        if at >= self.places.len() {
            self.places.resize((at + 1).max(self.base.shapes.slot_count()), 0);
        }
        if self.places[at] == 0 {
            let held = self
                .base
                .shapes
                .get(slot)
                .map(|entry| Held { origin: Origin::Base(slot), placement: Placement::of(entry.shape()) });
            self.stories.push(Story { slot, held, next: NONE });
            self.places[at] = self.stories.len() as u32;
        }
        self.places[at] as usize - 1
    }

    /// What a slot holds now is what it held from this tick on.
    fn part(&mut self, place: usize, within: Option<u8>, arrival: Option<Arrival>) {
        let Some(from) = within else { return };
        let story = &mut self.stories[place];
        self.stretches.push(Stretch { from, held: story.held, arrival, next: story.next });
        story.next = (self.stretches.len() - 1) as u32;
    }

    fn finish(mut self, first: Tick, ticks: u8) -> Span {
        let mut span = Span {
            base: self.base.clone(),
            first,
            rest: Rest::InBothTrees,
            overridden: vec![0; self.places.len().div_ceil(64)],
            tracks: Vec::with_capacity(self.stories.len()),
            placements: Vec::with_capacity(self.stories.len() + self.stretches.len()),
            own: std::mem::take(&mut self.own),
            tree: StaticTree::default(),
            by_id: OnceLock::new(),
        };
        let mut moving = 0;
        for story in &self.stories {
            let slot = story.slot;
            span.overridden[slot.0 as usize / 64] |= 1 << (slot.0 % 64);
            moving += usize::from(span.base.is_moving(slot));
            self.tell(story, ticks, &mut span);
        }
        if moving * 2 > span.base.moving.len() {
            span.rest = Rest::InStaticTree;
            add_still(&mut span, ticks);
        }
        let boxes = span.tracks.iter().map(|track| (span.bounds(track), span.layers(track)));
        span.tree = StaticTree::build_on_layers(boxes);
        span
    }

    /// The tracks of a slot, one for each shape that it held.
    fn tell(&self, story: &Story, ticks: u8, span: &mut Span) {
        let begin = Stretch { from: 0, held: story.held, arrival: None, next: story.next };
        let mut track: Option<Track> = None;
        let mut stretch = &begin;
        loop {
            let next = self.stretches.get(stretch.next as usize);
            match (stretch.held, stretch.arrival, &mut track) {
                (Some(Held { placement, .. }), Some(arrival), Some(track)) => {
                    track.go(stretch.from, arrival, placement, &mut span.placements);
                }
                (Some(Held { origin, placement }), _, track) => {
                    span.tracks.extend(track.take());
                    *track = Some(Track::new(origin, stretch.from, placement, &mut span.placements));
                }
                (None, _, track) => span.tracks.extend(track.take()),
            }
            if let Some(track) = &mut track {
                track.last = next.map_or(ticks, |next| next.from - 1);
            }
            match next {
                Some(next) => stretch = next,
                None => break,
            }
        }
        span.tracks.extend(track);
    }
}

/// Puts the moving shapes that did not change into the span's own tree.
fn add_still(span: &mut Span, ticks: u8) {
    let still = span.base.moving_slots().filter(|&slot| !span.is_overridden(slot));
    let tracks: Vec<Track> = still.map(|slot| Track::still(slot, ticks)).collect();
    span.tracks.extend(tracks);
}
