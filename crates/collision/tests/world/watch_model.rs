//! What a watcher must say, from a list of all regions and shapes: each is asked at each tick.

use std::{
    collections::{BTreeMap, BTreeSet},
    sync::Arc,
};

use collision::{
    DQuat, DVec3,
    accuracy::Accuracy,
    answer::{Verdict, Work},
    math::Pose,
    narrow::{Motion, Placed, distance, impact, overlap},
    shape::Form,
    world::{
        Change, Changes, Edit, EditRule, Filter, Meter, Mobility, Overlap, Region, Shape, ShapeId, Snapshot, Subject,
        Swept, Time, Watch, WatchedPairs, World,
    },
};

use crate::scene::id;

/// Shapes are numbered up to this.
pub(crate) const SHAPES: u64 = 60;

/// A tick that was made.
pub(crate) struct Tick {
    pub(crate) old: Option<Arc<Snapshot>>,
    pub(crate) new: Arc<Snapshot>,
    /// What went from where it was to where it is.
    pub(crate) travelled: BTreeSet<ShapeId>,
    /// What was put where it is.
    pub(crate) put: BTreeSet<ShapeId>,
    pub(crate) swept: Swept,
}

/// Makes a tick of these edits; wrong ones are left out.
pub(crate) fn apply(world: &mut World, edits: Vec<Edit>) -> Tick {
    let old = world.newest();
    let report = world.apply(edits.clone(), Time(0), EditRule::LeaveOutWrong).expect("a tick");
    let [travelled, put] = travelled(&edits, &old, &world.newest());
    Tick { old: Some(old), new: world.newest(), travelled, put, swept: report.swept }
}

/// The shapes that went from where they were to where they are in a tick of these edits, and those that were put there.
fn travelled(edits: &[Edit], old: &Snapshot, new: &Snapshot) -> [BTreeSet<ShapeId>; 2] {
    let mut moving = BTreeSet::new();
    let mut put = BTreeSet::new();
    for edit in edits {
        match edit {
            Edit::Insert(shape) => put.insert(shape.id),
            Edit::Remove(id) | Edit::Move { id, teleport: true, .. } => put.insert(*id),
            Edit::Move { id, teleport: false, .. } => moving.insert(*id),
            Edit::Clear => {
                put.extend((1..=SHAPES).map(id));
                false
            }
        };
    }
    moving.retain(|id| !put.contains(id) && old.contains(*id) && new.contains(*id));
    [moving, put]
}

impl Tick {
    pub(crate) fn first(new: Arc<Snapshot>) -> Self {
        Self { old: None, new, travelled: BTreeSet::new(), put: BTreeSet::new(), swept: Swept::default() }
    }
}

impl Tick {
    fn is_elsewhere(&self, id: ShapeId) -> bool {
        let pose = |version: &Snapshot| version.shape(id).map(|shape| shape.pose);
        self.put.contains(&id) || self.old.as_deref().and_then(pose) != pose(&self.new)
    }
}

/// What was told of one overlap since the list was copied.
#[derive(Clone, Copy, Debug, Default)]
struct Told {
    /// Proved, or kept.
    now: Option<bool>,
    was: bool,
    changed: bool,
}

impl Told {
    fn change(&self) -> Option<Change> {
        match (self.was, self.now.is_some()) {
            (false, true) => Some(Change::Came),
            (true, false) => Some(Change::Went),
            (false, false) | (true, true) => self.changed.then_some(Change::CameAndWent),
        }
    }
}

type List = BTreeMap<(ShapeId, ShapeId), Told>;

/// A list of all overlaps. A copy begins anew to note what was told since.
#[derive(Debug)]
pub(crate) struct Model {
    watch: Watch,
    regions: List,
    pairs: List,
    undecided: usize,
}

impl Clone for Model {
    fn clone(&self) -> Self {
        let anew = |list: &List| {
            list.iter()
                .filter(|(_, told)| told.now.is_some())
                .map(|(key, told)| (*key, Told { was: true, changed: false, ..*told }))
                .collect()
        };
        Self { watch: self.watch.clone(), regions: anew(&self.regions), pairs: anew(&self.pairs), undecided: 0 }
    }
}

impl Model {
    pub(crate) fn new(watch: Watch) -> Self {
        Self { watch, regions: List::new(), pairs: List::new(), undecided: 0 }
    }

    /// Takes a tick, and says what changed in it.
    pub(crate) fn step(&mut self, tick: &Tick) -> Changes {
        let mut changes = Changes::default();
        let new: Vec<Shape> = tick.new.shapes_after(None, usize::MAX, None).into_iter().cloned().collect();
        for region in self.watch.regions.clone() {
            let mut seen = BTreeSet::new();
            if let Some(place) = place(&region, &tick.new) {
                for shape in &new {
                    if region.follow != Some(shape.id) && passes(&self.watch.filter, shape) {
                        seen.insert(shape.id);
                        let told = self.region_and_shape(&region, place, shape, tick);
                        changes.regions.extend(told.map(|change| ((region.id, shape.id), change)));
                    }
                }
            }
            for (&(_, id), told) in self.regions.range_mut((region.id, ShapeId::MIN)..=(region.id, ShapeId::MAX)) {
                if !seen.contains(&id) && told.now.take().is_some() {
                    told.changed = true;
                    changes.regions.insert((region.id, id), Change::Went);
                }
            }
        }
        self.step_pairs(tick, &new, &mut changes);
        changes
    }

    fn region_and_shape(&mut self, region: &Region, place: Pose, shape: &Shape, tick: &Tick) -> Option<Change> {
        let before = match &tick.old {
            Some(old) if region.follow.is_some_and(|id| tick.travelled.contains(&id)) => self::place(region, old),
            _ => None,
        };
        let start = tick.old.as_ref().filter(|_| tick.travelled.contains(&shape.id));
        let start = start.and_then(|old| old.shape(shape.id)).map(|shape| shape.pose);
        let ends = [
            Placed { geometry: &region.geometry, pose: place },
            Placed { geometry: &shape.geometry, pose: shape.pose },
        ];
        let starts = [before.unwrap_or(place), start.unwrap_or(shape.pose)];
        let told = self.regions.entry((region.id, shape.id)).or_default();
        let reach = ends.iter().map(|end| end.geometry.reach()).sum::<f64>() + self.watch.hysteresis;
        let ways: f64 = [0, 1].iter().map(|&side| starts[side].position.distance(ends[side].pose.position)).sum();
        if told.now.is_none() && starts[0].position.distance(starts[1].position) > reach + ways {
            return None;
        }
        let verdict = verdict(ends, shape.id, &tick.new, &self.watch.accuracy);
        self.undecided += usize::from(verdict == Verdict::Undecided);
        let has_met = || {
            let motion = Motion {
                displacement_a: ends[0].pose.position - starts[0].position,
                displacement_b: ends[1].pose.position - starts[1].position,
                rotation_a: starts[0].rotation_vector_to(&ends[0].pose),
                rotation_b: starts[1].rotation_vector_to(&ends[1].pose),
                ..Motion::default()
            };
            let [a, b] = [0, 1].map(|side| Placed { pose: starts[side], ..ends[side] });
            let touch = impact(a, b, &motion, &self.watch.accuracy, &mut Work::default());
            touch.is_some_and(|touch| touch.certificate.verdict == Verdict::Hit)
        };
        let travels = before.is_some() || start.is_some();
        let met = travels && told.now.is_none() && verdict != Verdict::Hit && has_met();
        settle(told, met, verdict, ends, &self.watch)
    }

    fn step_pairs(&mut self, tick: &Tick, new: &[Shape], changes: &mut Changes) {
        let only: Option<BTreeSet<ShapeId>> = match &self.watch.pairs {
            WatchedPairs::Nothing => return,
            WatchedPairs::All => None,
            WatchedPairs::Of(ids) => Some(ids.iter().copied().collect()),
        };
        let mut go_on = || true;
        let found = tick.new.pairs(&Filter::default(), &self.watch.accuracy, &mut Meter::new(&mut go_on));
        let found: BTreeMap<_, _> =
            found.expect("pairs").iter().map(|pair| ((pair.a, pair.b), pair.certificate.verdict)).collect();
        let hits = tick.swept.hits.iter().filter(|hit| hit.impact.touch.certificate.verdict == Verdict::Hit);
        // Two that stayed where they were did not meet, whatever a sweep proves of them.
        let met = hits.filter_map(|hit| Some((hit.bullet, hit.impact.id?)));
        let met: BTreeSet<_> = met.filter(|(a, b)| tick.is_elsewhere(*a) || tick.is_elsewhere(*b)).collect();
        let known: Vec<_> = self.pairs.keys().copied().collect();
        let by_id: BTreeMap<_, _> = new.iter().map(|shape| (shape.id, shape)).collect();
        let swept = met.iter().map(|&(a, b)| (a.min(b), a.max(b)));
        let keys: BTreeSet<_> = found.keys().copied().chain(known).chain(swept).collect();
        for (a, b) in keys {
            if only.as_ref().is_some_and(|only| !only.contains(&a) && !only.contains(&b)) {
                continue;
            }
            let told = self.pairs.entry((a, b)).or_default();
            let both = by_id.get(&a).zip(by_id.get(&b)).filter(|(a, b)| want_each_other(a, b));
            let change = match both {
                Some((first, second)) => {
                    let verdict = found.get(&(a, b)).copied().unwrap_or(Verdict::Miss);
                    let ends = [first, second].map(|shape| Placed { geometry: &shape.geometry, pose: shape.pose });
                    let met = told.now.is_none() && (met.contains(&(a, b)) || met.contains(&(b, a)));
                    settle(told, met && verdict != Verdict::Hit, verdict, ends, &self.watch)
                }
                None => told.now.take().map(|_| Change::Went),
            };
            told.changed |= change.is_some();
            changes.pairs.extend(change.map(|change| ((a, b), change)));
        }
    }

    /// All that overlaps.
    pub(crate) fn all(&self) -> Changes {
        let on = |list: &List| {
            let on = list.iter().filter(|(_, told)| told.now.is_some());
            on.map(|(key, _)| (*key, Change::Came)).collect()
        };
        Changes { regions: on(&self.regions), pairs: on(&self.pairs) }
    }

    /// What was told since the copy.
    pub(crate) fn merged(&self) -> Changes {
        let changed = |list: &List| list.iter().filter_map(|(key, told)| Some((*key, told.change()?))).collect();
        Changes { regions: changed(&self.regions), pairs: changed(&self.pairs) }
    }

    /// Overlaps that are said to be, but not proved.
    pub(crate) fn kept_count(&self) -> usize {
        self.regions.values().chain(self.pairs.values()).filter(|told| told.now == Some(false)).count()
    }

    /// How often a region and a shape were undecided.
    pub(crate) fn undecided_count(&self) -> usize {
        self.undecided
    }
}

/// How many went.
pub(crate) fn went(changes: &Changes) -> usize {
    changes.regions.values().chain(changes.pairs.values()).filter(|change| **change == Change::Went).count()
}

fn settle(told: &mut Told, met: bool, verdict: Verdict, [a, b]: [Placed<'_>; 2], watch: &Watch) -> Option<Change> {
    let was = told.now.is_some();
    let is_far =
        || watch.hysteresis <= 0.0 || distance(a, b, watch.hysteresis, &watch.accuracy, &mut Work::default()).is_none();
    told.now = match verdict {
        Verdict::Hit => Some(true),
        Verdict::Undecided => (was || met).then_some(false),
        Verdict::Miss => ((was || met) && !is_far()).then_some(false),
    };
    let change = match (was, told.now.is_some()) {
        (false, true) => Some(Change::Came),
        (true, false) => Some(Change::Went),
        (false, false) if met => Some(Change::CameAndWent),
        _ => None,
    };
    told.changed |= change.is_some();
    change
}

/// As the question says, which asks boxes first; no question is about half spaces.
fn verdict(ends: [Placed<'_>; 2], id: ShapeId, new: &Snapshot, accuracy: &Accuracy) -> Verdict {
    let [Placed { geometry, pose }, shape] = ends;
    if matches!(geometry.form(), Form::HalfSpace(_)) {
        return overlap(ends[0], shape, accuracy, &mut Work::default()).verdict;
    }
    let question = Overlap {
        subject: Subject::Geometry { geometry: Arc::new(geometry.clone()), pose },
        against: Some(Subject::Shape { id, pose: None }),
        max_hits: 1,
    };
    let mut go_on = || true;
    let found = new.overlap(&question, &Filter::default(), accuracy, &mut Meter::new(&mut go_on));
    found.expect("an answer").verdict
}

/// Where a region is; `None` while the shape that it follows is gone.
fn place(region: &Region, version: &Snapshot) -> Option<Pose> {
    let Some(follow) = region.follow else { return Some(region.pose) };
    let leader = version.shape(follow)?.pose;
    let turn: DQuat = leader.unit_rotation();
    let offset: DVec3 = leader.transform_point(region.pose.position);
    Some(Pose::new(offset, turn * region.pose.unit_rotation()))
}

fn passes(filter: &Filter, shape: &Shape) -> bool {
    let (layers, wanted) = (filter.layers.unwrap_or(u32::MAX), filter.collides_with.unwrap_or(u32::MAX));
    shape.layers & wanted != 0
        && shape.collides_with & layers != 0
        && !filter.exclude_ids.contains(&shape.id)
        && !(filter.exclude_sensors && shape.sensor)
        && !(filter.exclude_static && shape.mobility == Mobility::Static)
        && !(shape.group != 0 && filter.exclude_groups.contains(&shape.group))
}

fn want_each_other(a: &Shape, b: &Shape) -> bool {
    let stand = a.mobility == Mobility::Static && b.mobility == Mobility::Static;
    let are_one = a.group != 0 && a.group == b.group;
    a.layers & b.collides_with != 0 && b.layers & a.collides_with != 0 && !stand && !are_one
}
