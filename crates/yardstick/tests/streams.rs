//! The recorded streams of moves, played through a world at full speed: after every frame the world finds what the kernels
//! find pair by pair in a plain list of actors, bit by bit, and both find what the reference expects.

use std::{
    collections::{BTreeMap, BTreeSet},
    num::NonZeroU64,
    path::{Path, PathBuf},
    sync::Arc,
};

use collision::{
    accuracy::{Accuracy, Tier},
    answer::Work,
    broad::distance_at_least,
    math::Pose,
    narrow::{self, Placed},
    shape::Geometry,
    world::{Distance, Edit, EditRule, Filter, Meter, Shape, ShapeId, Subject, Time, World},
};
use glam::DVec3;
use yardstick::sets::{
    Folder, SetKind,
    stream::{self, ActorKind, Change, Frame},
};

const EXACT: Accuracy = Accuracy::of(Tier::Exact);
/// Pairs nearer than this are expected.
const CLOSE: f64 = 100.0;
/// The reference has six decimals; the kernels' rounding at these distances is far below.
const DECIMALS: f64 = 2e-6;

/// The actors by number: what they are and where.
type Model = BTreeMap<u64, (ActorKind, Pose)>;

/// The form of each kind, as the format says.
struct Forms {
    car: Arc<Geometry>,
    ball: Arc<Geometry>,
}

impl Forms {
    fn new() -> Self {
        let car = Geometry::cuboid(DVec3::new(59.0, 42.0, 18.0)).expect("a box");
        let ball = Geometry::sphere(91.25).expect("a sphere");
        Self { car: Arc::new(car), ball: Arc::new(ball) }
    }

    fn of(&self, kind: ActorKind) -> &Arc<Geometry> {
        match kind {
            ActorKind::Car => &self.car,
            ActorKind::Ball => &self.ball,
        }
    }

    fn placed(&self, &(kind, pose): &(ActorKind, Pose)) -> Placed<'_> {
        Placed { geometry: self.of(kind), pose }
    }
}

fn id(actor: u64) -> ShapeId {
    NonZeroU64::MIN.saturating_add(actor)
}

/// The edit that a change is, the model being as it was before.
fn edit(change: &Change, model: &Model, forms: &Forms) -> Edit {
    match *change {
        Change::Remove { actor } => Edit::Remove(id(actor)),
        Change::Move { actor, kind, pose } => {
            let pose = Pose::new(pose.position, pose.rotation);
            if model.get(&actor).is_some_and(|known| known.0 == kind) {
                return Edit::Move {
                    id: id(actor),
                    position: Some(pose.position),
                    rotation: Some(pose.rotation),
                    velocity: None,
                    angular_velocity: None,
                    teleport: false,
                };
            }
            let geometry = Arc::clone(forms.of(kind));
            Edit::Insert(Shape { user_data: actor, ..Shape::new(id(actor), geometry, pose) })
        }
    }
}

/// What is near an actor, nearest first, by asking the kernel about all others.
fn near_in_model(model: &Model, actor: u64, forms: &Forms) -> Vec<(f64, u64)> {
    let subject = forms.placed(&model[&actor]);
    let mut near = Vec::new();
    for (&other, placed) in model.iter().filter(|(other, _)| **other != actor) {
        let placed = forms.placed(placed);
        let separation = narrow::distance(subject, placed, CLOSE, &EXACT, &mut Work::default());
        let bounds = |placed: Placed<'_>| placed.geometry.bounds(&placed.pose);
        let least = distance_at_least(bounds(subject), bounds(placed));
        // A lower bound is raised to what the boxes prove.
        let value = separation.filter(|_| least <= CLOSE).map(|separation| {
            if separation.certificate.bound.lower < least {
                separation.distance.max(least)
            } else {
                separation.distance
            }
        });
        near.extend(value.map(|value| (value, other)));
    }
    near.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    near
}

fn near_in_world(world: &World, actor: u64) -> Vec<(f64, u64)> {
    let question = Distance {
        subject: Subject::Shape { id: id(actor), pose: None },
        against: None,
        max_distance: CLOSE,
        max_hits: usize::MAX,
    };
    let found = world.newest().distance(&question, &Filter::default(), &EXACT, &mut Meter::new(&mut || true));
    found.expect("it is there").hits.iter().map(|hit| (hit.separation.distance, hit.user_data)).collect()
}

/// The pairs of the model that are close, with their signed distances, against those that are expected.
fn compare(frame: &Frame, model: &Model, near: &BTreeMap<(u64, u64), f64>, forms: &Forms) {
    let expected: BTreeMap<(u64, u64), f64> =
        frame.close_pairs.iter().map(|&(a, b, d)| ((a.min(b), a.max(b)), d)).collect();
    let both: BTreeSet<&(u64, u64)> = expected.keys().chain(near.keys()).collect();
    for pair in both {
        let what = || format!("frame {}, {pair:?}", frame.number);
        match (expected.get(pair), near.get(pair)) {
            (Some(expected), Some(&found)) => {
                let [a, b] = [pair.0, pair.1].map(|actor| forms.placed(&model[&actor]));
                let depth = narrow::depth(a, b, 0.0, &EXACT, &mut Work::default());
                let found = if found > 0.0 { found } else { -depth.expect("they overlap").depth };
                assert!((found - expected).abs() <= DECIMALS, "{}: {found}, expected {expected}", what());
            }
            (Some(distance), None) | (None, Some(distance)) => {
                assert!(*distance > CLOSE - DECIMALS, "{}: {distance} on one side only", what());
            }
            (None, None) => unreachable!("one of them names it"),
        }
    }
}

/// How many frames and pairs were compared.
fn play(frames: &[Frame]) -> (usize, usize) {
    let forms = Forms::new();
    let (mut world, mut model, mut pair_count) = (World::new(Time(0)), Model::new(), 0);
    for frame in frames {
        let mut edits = Vec::with_capacity(frame.changes.len());
        for change in &frame.changes {
            edits.push(edit(change, &model, &forms));
            match *change {
                Change::Move { actor, kind, pose } => {
                    model.insert(actor, (kind, Pose::new(pose.position, pose.rotation)));
                }
                Change::Remove { actor } => {
                    model.remove(&actor);
                }
            }
        }
        world.apply(edits, Time(0), EditRule::AllOrNothing).expect("moves are of what is there");
        world.newest().assert_sound();
        let mut pairs = BTreeMap::new();
        for &actor in model.keys() {
            let near = near_in_model(&model, actor, &forms);
            assert_eq!(near_in_world(&world, actor), near, "frame {}, actor {actor}", frame.number);
            pairs.extend(near.into_iter().map(|(distance, other)| ((actor.min(other), actor.max(other)), distance)));
        }
        compare(frame, &model, &pairs, &forms);
        pair_count += pairs.len();
    }
    (frames.len(), pair_count)
}

#[test]
fn a_world_follows_the_recorded_streams_frame_by_frame() {
    let root = std::env::var_os("CALIPERS_DATA")
        .map_or_else(|| PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data"), PathBuf::from);
    let root: &Path = &root;
    if !root.is_dir() {
        return;
    }
    let folder = Folder::open(root).expect("a folder of sets");
    let mut played = 0;
    for set in &folder.sets {
        if let SetKind::Stream { stem } = &set.kind {
            let (frames, pairs) = play(&stream::read(&set.path, &folder, stem).expect("a stream"));
            assert!(frames > 100 && pairs > 50, "vacuous: {frames} frames, {pairs} pairs in {stem}");
            played += 1;
        }
    }
    assert!(played > 0, "there are streams");
}
