//! Many rays at a time.
//!
//! # Method
//! In a world larger than the caches a ray waits for each node and each shape in turn, which takes longer than all it does with them. So
//! several rays go side by side, a step each in turn: what all of them look at next is asked for first, and is on its way at once. Each goes
//! the way that it goes by itself, so that answers and what is counted are the same.
//!
//! # Limits
//! Rays into the past, and those in worlds of several cells, are asked one by one.

use super::{
    Filter, Found, Meter, QuestionError, RayHit, Raycast, ShapeId, Snapshot,
    filter::Sieve,
    raycast::{Cast, Track},
    search::{Side, Trees},
    state::Fixed,
    store::{Slot, Store},
};
use crate::{
    accuracy::Accuracy,
    broad::{DynamicTree, Line, Step, Toll, Walk, Walked},
};

/// Rays that go side by side.
const SIDE_BY_SIDE: usize = 12;
/// Shapes of a world from which on it pays: those of smaller ones are in the caches.
const SHAPES_MIN: usize = 65_536;

impl Snapshot {
    /// What each of several rays hits, where each may leave out one more shape than the filter does: as [`Snapshot::raycast`] answers each,
    /// and faster in large worlds.
    ///
    /// # Errors
    /// [`QuestionError::Interrupted`]; [`QuestionError::TooLong`] of all together.
    pub fn raycasts(
        &self,
        questions: &[(Raycast, Option<ShapeId>)],
        filter: &Filter,
        accuracy: &Accuracy,
        meter: &mut Meter<'_>,
    ) -> Result<Vec<Found<RayHit>>, QuestionError> {
        let _asking = self.asking().now();
        if let Some(party) = Party::through(self.trees(), filter, accuracy) {
            return party.ask(questions, meter);
        }
        let mut filter = filter.clone();
        let ask = |(question, unseen): &(Raycast, Option<ShapeId>)| {
            let count = filter.exclude_ids.len();
            filter.exclude_ids.extend(*unseen);
            let found = self.raycast(question, &filter, accuracy, meter);
            filter.exclude_ids.truncate(count);
            found
        };
        questions.iter().map(ask).collect()
    }
}

/// A tree that rays go through.
#[derive(Clone, Copy)]
enum In<'a> {
    Fixed(&'a Fixed),
    Moving(&'a DynamicTree),
}

impl In<'_> {
    fn begin(self, walk: &mut Walk, line: &Line, limit: f64, layers: u32) {
        match self {
            Self::Fixed(fixed) => fixed.tree.begin(walk, line, limit, layers),
            Self::Moving(tree) => tree.begin(walk, line, limit, layers),
        }
    }

    fn visit_listed<E>(
        self,
        line: &Line,
        limit: f64,
        layers: u32,
        mut visit: impl FnMut(Slot) -> Result<f64, E>,
    ) -> Result<f64, E> {
        match self {
            Self::Fixed(fixed) => fixed.tree.visit_listed(line, limit, layers, |leaf| visit(fixed.slot(leaf))),
            Self::Moving(tree) => tree.visit_listed(line, limit, layers, |leaf| visit(Slot(leaf))),
        }
    }

    #[inline]
    fn enter(self, walk: &mut Walk, node: u32) {
        match self {
            Self::Fixed(fixed) => fixed.tree.enter(walk, node),
            Self::Moving(tree) => tree.enter(walk, node),
        }
    }

    #[inline]
    fn prefetch(self, node: u32) {
        match self {
            Self::Fixed(fixed) => fixed.tree.prefetch(node),
            Self::Moving(tree) => tree.prefetch(node),
        }
    }

    #[inline]
    fn slot(self, leaf: u32) -> Slot {
        match self {
            Self::Fixed(fixed) => fixed.slot(leaf),
            Self::Moving(_) => Slot(leaf),
        }
    }
}

/// Rays that go side by side.
struct Party<'a> {
    shapes: &'a Store,
    /// Gone through first.
    fixed: Option<&'a Fixed>,
    moving: &'a DynamicTree,
    sieve: Sieve<'a>,
    accuracy: &'a Accuracy,
}

/// One of them.
struct Lane<'a> {
    number: usize,
    unseen: Option<ShapeId>,
    track: Track,
    cast: Cast<'a>,
    /// Where it ends, as the trees count.
    limit: f64,
    tree: In<'a>,
    step: Step,
}

impl<'a> Party<'a> {
    /// `None` where rays are to be asked one by one.
    fn through(trees: Trees<'a>, filter: &'a Filter, accuracy: &'a Accuracy) -> Option<Self> {
        let Trees { state, past: None, fixed, moving: Some(moving) } = trees else { return None };
        let is_walked = moving.is_walked() && fixed.is_none_or(|fixed| fixed.tree.is_walked());
        let is_large = state.shapes.len() >= SHAPES_MIN;
        (is_large && is_walked).then(|| {
            let sieve = Sieve::new(filter, None);
            Self { shapes: &state.shapes, fixed, moving, sieve, accuracy }
        })
    }

    fn ask(
        &self,
        questions: &'a [(Raycast, Option<ShapeId>)],
        meter: &mut Meter<'_>,
    ) -> Result<Vec<Found<RayHit>>, QuestionError> {
        let mut found: Vec<Option<Found<RayHit>>> = questions.iter().map(|_| None).collect();
        let mut walks: [Walk; SIDE_BY_SIDE] = Default::default();
        let mut lanes: [Option<Lane<'a>>; SIDE_BY_SIDE] = Default::default();
        let mut waiting = questions.iter().enumerate();
        loop {
            let mut is_any = false;
            for (lane, walk) in lanes.iter_mut().zip(&mut walks) {
                // Whose way is at its end makes room for the next.
                while !self.goes_on(lane, walk, meter)? {
                    if let Some(Lane { number, cast, .. }) = lane.take() {
                        found[number] = Some(cast.finish());
                    }
                    let Some((number, (question, unseen))) = waiting.next() else { break };
                    *lane = Some(self.begin(number, (question, *unseen), walk, meter)?);
                }
                if let Some(lane) = lane {
                    is_any = true;
                    self.prefetch(lane);
                }
            }
            if !is_any {
                return Ok(found.into_iter().flatten().collect());
            }
            for (lane, walk) in lanes.iter_mut().zip(&mut walks) {
                let Some(lane) = lane else { continue };
                match lane.step {
                    Step::Node(node) => {
                        meter.pay()?;
                        lane.tree.enter(walk, node);
                    }
                    Step::Leaf(leaf) => walk.narrow(self.meet(lane, lane.tree.slot(leaf), meter)?),
                }
            }
        }
    }

    /// A ray at the beginning of its way.
    fn begin(
        &self,
        number: usize,
        (question, unseen): (&'a Raycast, Option<ShapeId>),
        walk: &mut Walk,
        meter: &mut Meter<'_>,
    ) -> Result<Lane<'a>, QuestionError> {
        let tree = self.fixed.map_or(In::Moving(self.moving), In::Fixed);
        let (track, cast) = (Track::new(&question.ray), Cast::new(question));
        let limit = track.limit(question.ray.max_distance);
        let mut lane = Lane { number, unseen, track, cast, limit, tree, step: Step::Leaf(0) };
        self.enter_tree(&mut lane, walk, meter)?;
        Ok(lane)
    }

    /// Begins the way of a lane through the tree that it is in now.
    fn enter_tree(&self, lane: &mut Lane<'a>, walk: &mut Walk, meter: &mut Meter<'_>) -> Result<(), QuestionError> {
        let (tree, line, limit, layers) = (lane.tree, lane.track.line, lane.limit, self.sieve.layers_seen());
        tree.visit_listed(&line, limit, layers, |slot| self.meet(lane, slot, meter))?;
        tree.begin(walk, &line, lane.limit, layers);
        Ok(())
    }

    /// Whether a lane has a next step, which it has at hand then.
    fn goes_on(
        &self,
        lane: &mut Option<Lane<'a>>,
        walk: &mut Walk,
        meter: &mut Meter<'_>,
    ) -> Result<bool, QuestionError> {
        let Some(lane) = lane else { return Ok(false) };
        loop {
            if let Some(step) = walk.next_step() {
                lane.step = step;
                return Ok(true);
            }
            let In::Fixed(_) = lane.tree else { return Ok(false) };
            lane.tree = In::Moving(self.moving);
            self.enter_tree(lane, walk, meter)?;
        }
    }

    /// Asks for the memory that the next step of a lane wants.
    fn prefetch(&self, lane: &Lane<'a>) {
        match lane.step {
            Step::Node(node) => lane.tree.prefetch(node),
            Step::Leaf(leaf) => self.shapes.prefetch(lane.tree.slot(leaf)),
        }
    }

    /// What a lane hits of the shape in a slot; where it ends then.
    fn meet(&self, lane: &mut Lane<'a>, slot: Slot, meter: &mut Meter<'_>) -> Result<f64, QuestionError> {
        let side = Side::of(self.shapes.entry(slot));
        if lane.unseen.is_none() || side.id() != lane.unseen {
            let end = lane.cast.meet(&lane.track, &side, &self.sieve, self.accuracy, meter)?;
            lane.limit = lane.limit.min(end);
        }
        Ok(lane.limit)
    }
}
