//! The worlds that settings ask: the scene as it is, and others that hold the same in another way.

use std::{collections::HashMap, ops::ControlFlow, sync::Arc};

use collision::{
    decompose::{self, decompose},
    math::Pose,
    shape::{Convex, Core, Form, Geometry, GeometryId},
    world::{Edit, EditRule, Means, Mobility, Settings, ShapeId, Snapshot, Time},
};

use super::{
    Kind, Stage,
    ask::{ask, exact},
    clock::clock,
    questions::questions,
};
use crate::{
    scene::Random,
    scenes::{Item, Scene},
};

/// A world to ask.
pub(super) struct Staged {
    pub(super) snapshot: Arc<Snapshot>,
    /// How far the form sent may lie outside of the one asked, metres, where that is known to the user alone.
    pub(super) outside: HashMap<ShapeId, f64>,
    /// What making it cost.
    pub(super) note: String,
}

/// Ticks of moves to and fro.
const TICKS: u32 = 16;

/// Steps of a decomposition: about a second.
const PARTS_BUDGET: u64 = 1 << 23;

impl Staged {
    pub(super) fn new(scene: &Scene, stage: Stage) -> Self {
        match stage {
            Stage::Plain => Self::of(scene, String::new()),
            Stage::OneByOne => Self::of_mobility(scene, Mobility::Dynamic),
            Stage::AllStatic => Self::of_mobility(scene, Mobility::Static),
            Stage::Moved(margin) => Self::moved(scene, margin),
            Stage::Hulls(count) => Self::of_hulls(scene, count),
            Stage::Parts(part) => Self::of_parts(scene, part),
        }
    }

    fn of(scene: &Scene, note: String) -> Self {
        Self { snapshot: scene.world().newest(), outside: HashMap::new(), note }
    }

    fn of_mobility(scene: &Scene, mobility: Mobility) -> Self {
        let items = scene.items.iter().map(|item| Item { mobility, ..item.clone() });
        let begin = clock();
        let made = Self::of(&Scene { items: items.collect(), ..scene.clone() }, String::new());
        // The static tree is built when it is first asked.
        for question in questions(scene, Kind::Raycast, 1, 1) {
            drop(ask(&made.snapshot, &question, &exact()));
        }
        let each = (clock() - begin).as_secs_f64() * 1e9 / scene.items.len() as f64;
        Self { note: format!("{each:.0} ns a shape"), ..made }
    }

    /// What moves goes a tenth of a size each tick, and at the end is where it began.
    fn moved(scene: &Scene, margin: Option<f64>) -> Self {
        let mut world = scene.world_with(Settings { margin, ..Settings::default() }, Means::default());
        let mut random = Random::new(1);
        let moving = || scene.items.iter().enumerate().filter(|(_, item)| item.mobility != Mobility::Static);
        let mut poses: Vec<Pose> = moving().map(|(_, item)| item.pose).collect();
        let (mut seconds, mut moves) = (0.0, 0);
        for tick in 1..=TICKS {
            let edits: Vec<Edit> = moving()
                .zip(&mut poses)
                .map(|((index, item), pose)| {
                    let step = random.direction() * (0.1 * scene.size);
                    pose.position = if tick == TICKS { item.pose.position } else { pose.position + step };
                    Edit::Move {
                        id: Scene::id(index),
                        position: Some(pose.position),
                        rotation: None,
                        velocity: None,
                        angular_velocity: None,
                        teleport: false,
                    }
                })
                .collect();
            moves += edits.len();
            let begin = clock();
            let applied = world.apply(edits, Time(0), EditRule::AllOrNothing);
            seconds += (clock() - begin).as_secs_f64();
            assert!(applied.is_ok(), "only moves of what is there");
        }
        let note = format!("{:.0} ns a move", seconds * 1e9 / moves.max(1) as f64);
        Self { snapshot: world.newest(), outside: HashMap::new(), note }
    }

    fn of_hulls(scene: &Scene, count: usize) -> Self {
        let mut made: HashMap<GeometryId, Option<(Arc<Geometry>, f64)>> = HashMap::new();
        let begin = clock();
        let mut outside = HashMap::new();
        let mut items = scene.items.clone();
        for (index, item) in items.iter_mut().enumerate() {
            let simpler = made.entry(item.geometry.id()).or_insert_with(|| simplified(&item.geometry, count));
            if let Some((geometry, off)) = simpler {
                item.geometry = geometry.clone();
                outside.insert(Scene::id(index), *off);
            }
        }
        let note = format!("{:.1} ms to make", (clock() - begin).as_secs_f64() * 1e3);
        Self { outside, ..Self::of(&Scene { items, ..scene.clone() }, note) }
    }

    fn of_parts(scene: &Scene, part: f64) -> Self {
        let mut made: HashMap<GeometryId, Option<Arc<Geometry>>> = HashMap::new();
        let begin = clock();
        let mut items = scene.items.clone();
        for item in &mut items {
            let with = made.entry(item.geometry.id()).or_insert_with(|| with_parts(&item.geometry, part));
            if let Some(geometry) = with {
                item.geometry = geometry.clone();
            }
        }
        let count: u32 = made.values().flatten().filter_map(|form| form.parts()).map(|parts| parts.part_count).sum();
        let note = format!("{:.0} ms for {count} parts", (clock() - begin).as_secs_f64() * 1e3);
        Self::of(&Scene { items, ..scene.clone() }, note)
    }
}

fn simplified(geometry: &Geometry, count: usize) -> Option<(Arc<Geometry>, f64)> {
    let Form::Convex(Convex { core: Core::Hull(hull), radius }) = geometry.form() else { return None };
    if *radius > 0.0 || hull.vertices().len() <= count {
        return None;
    }
    let simpler = hull.simplified(count, 0.0);
    Some((Arc::new(Geometry::hull(simpler.hull.vertices()).ok()?), simpler.outside))
}

fn with_parts(geometry: &Geometry, part: f64) -> Option<Arc<Geometry>> {
    let Form::Mesh(mesh) = geometry.form() else { return None };
    let bounds = geometry.local_bounds();
    let max_error = part * (bounds.max - bounds.min).length();
    let options = decompose::Options { max_error, budget: PARTS_BUDGET, ..decompose::Options::default() };
    let parts = decompose(mesh, &options, &mut |_| ControlFlow::Continue(())).ok()?;
    parts.attached(geometry, &options).ok().map(Arc::new)
}
