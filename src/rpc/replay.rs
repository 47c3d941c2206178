//! Replays: a question together with all that its answer depends on, so that it can be asked again elsewhere.
//!
//! # Method
//! An answer follows from the shapes that the question looks at and those that it names: what the trees and the filter let it
//! pass over could have had no part in it. So these shapes, where they were, are enough to ask again; of a question about several
//! ticks, where they were at the first, and what became of them since.

use std::{
    collections::BTreeSet,
    sync::{Arc, atomic::AtomicU64, atomic::Ordering},
};

use collision::{
    shape::Geometry,
    world::{Means, Notes, Settings as WorldSettings, Shape, ShapeId, Tick, Time, World},
};
use parking_lot::Mutex;
use tokio_util::sync::CancellationToken;
use wire::v1::{self as pb, answer::Answer as Kind, geometry::Kind as Form, question::Question as Asked, subject};

use super::{MESSAGE_BYTES, question, reading::Reading, scene::Scene};
use crate::{
    building::Building,
    convert::{
        archive::{self, Intake, named_by_id},
        edit, shape, tick,
    },
    geometries::{Geometries, Quotas},
    problem::{Checked, Problem, Reason, Under},
};

/// Newest layout of what is kept; without ticks it is as the first.
pub(crate) const FORMAT: u32 = 2;
/// Most shapes that are kept.
pub(super) const SHAPES: usize = 16_384;
/// What a caller can do about what is too large to keep.
pub(super) const SMALLER: &str =
    "its geometries are large, or its ticks many: ask about fewer shapes or ticks, or keep the world by ExportWorld";

/// The shapes that a question looked at.
#[derive(Clone, Debug, Default)]
pub(super) struct Touched {
    ids: Arc<Mutex<BTreeSet<ShapeId>>>,
    left_out_count: Arc<AtomicU64>,
}

impl Touched {
    /// Adds those of notes.
    pub(super) fn add(&self, notes: &Notes) {
        self.left_out_count.fetch_add(notes.left_out_count, Ordering::Relaxed);
        self.ids.lock().extend(notes.list.iter().flat_map(|note| note.subject.into_iter().chain(note.id)));
    }
}

/// Answers a question and keeps it.
///
/// # Errors
/// A tick that is not held, the deadline; what its answer depends on is too large.
pub(super) fn keep(question: pb::Question, scene: Scene) -> Checked<pb::Replay> {
    let (scene, touched) = scene.explained();
    let reading = Reading::of(&question, &scene).under("question")?;
    let answer = question::answer(&question, &scene);
    if let Some(asked) = &question.question {
        scene.tell(|| (asked.clone(), answer.clone()));
    }
    let answer = match answer {
        Err(problem) if problem.is(Reason::Deadline) => return Err(problem),
        answer => answered(answer),
    };
    let named = Named::by(&question, &scene.session.geometries);
    let mut ids = touched.ids.lock().clone();
    ids.extend(named.ids);
    let left_out_count = touched.left_out_count.load(Ordering::Relaxed) + ids.len().saturating_sub(SHAPES) as u64;
    ids = ids.into_iter().take(SHAPES).collect();
    let earliest = reading.earliest(&scene.snapshot);
    let shapes: Vec<Shape> = ids.iter().filter_map(|&id| earliest.shape(id)).map(|shape| shape.into_owned()).collect();
    let ticks = reading.ticks(&scene.snapshot, &ids)?;
    let geometries = shapes.iter().map(|shape| &shape.geometry).chain(&named.geometries);
    Ok(pb::Replay {
        format: if ticks.is_empty() { 1 } else { FORMAT },
        program: env!("CARGO_PKG_VERSION").to_owned(),
        tick: scene.snapshot.tick().get(),
        tick_fraction: scene.snapshot.fraction(),
        geometries: pieces(geometries.chain(ticks.iter().flatten().filter_map(tick::geometry)))?,
        shapes: shapes.iter().map(shape::shape_out).collect(),
        shapes_left_out: left_out_count,
        answer: Some(answer),
        question: Some(question),
        earliest_tick: if ticks.is_empty() { 0 } else { earliest.tick().get() },
        ticks: ticks.iter().map(|edits| tick::tick_out(edits)).collect(),
    })
}

/// The pieces of all geometries, unless they are surely too large for a message.
fn pieces<'a>(geometries: impl Iterator<Item = &'a Arc<Geometry>>) -> Checked<Vec<pb::GeometryPiece>> {
    let geometries = named_by_id(geometries);
    let bytes: u64 = geometries.iter().map(|geometry| archive::least_bytes(geometry)).sum();
    if bytes > MESSAGE_BYTES as u64 {
        let what =
            format!("the replay would have more than {bytes} bytes, and a message may have {MESSAGE_BYTES}: {SMALLER}");
        let problem = Problem::new(Reason::QuotaExceeded, what);
        return Err(problem.with("quota", "message_bytes").with("limit", MESSAGE_BYTES));
    }
    Ok(geometries.iter().flat_map(archive::pieces).collect())
}

fn answered(answer: Checked<Kind>) -> pb::Answer {
    let kind = answer.unwrap_or_else(|problem| Kind::Problem(problem.into_wire()));
    pb::Answer { answer: Some(kind) }
}

/// What a question names.
#[derive(Debug, Default)]
struct Named {
    ids: Vec<ShapeId>,
    geometries: Vec<Arc<Geometry>>,
}

impl Named {
    fn by(question: &pb::Question, known: &Geometries) -> Self {
        let mut named = Self::default();
        for subject in subjects(question) {
            match &subject.form {
                Some(subject::Form::Id(id)) => named.ids.extend(ShapeId::new(*id)),
                Some(subject::Form::Geometry(geometry)) => {
                    each_id(geometry, &mut |id| named.geometries.extend(known.get(id).ok()));
                }
                None => {}
            }
        }
        if let Some(Asked::Resolve(it)) = &question.question {
            named.ids.extend(it.bodies.iter().filter_map(|body| ShapeId::new(body.id)));
        }
        named
    }
}

/// What a question is about, and against.
fn subjects(question: &pb::Question) -> impl Iterator<Item = &pb::Subject> {
    let [subject, against] = match &question.question {
        Some(Asked::Resolve(_) | Asked::Pairs(_)) | None => [None, None],
        Some(Asked::Raycast(it)) => [None, it.against.as_deref()],
        Some(Asked::Overlap(it)) => [it.subject.as_ref(), it.against.as_deref()],
        Some(Asked::Penetration(it)) => [it.subject.as_ref(), it.against.as_deref()],
        Some(Asked::TimeOfImpact(it)) => [it.subject.as_ref(), it.against.as_deref()],
        Some(Asked::Distance(it)) => [it.subject.as_ref(), it.against.as_deref()],
        Some(Asked::MoveCharacter(it)) => [it.subject.as_ref(), None],
        Some(Asked::Depenetrate(it)) => [it.subject.as_ref(), it.against.as_deref()],
        Some(Asked::FirstTouch(it)) => [it.subject.as_ref(), it.against.as_deref()],
    };
    subject.into_iter().chain(against)
}

/// Shows the ids of geometries that a geometry names; no deeper than messages are nested.
fn each_id(geometry: &pb::Geometry, show: &mut impl FnMut(&str)) {
    match &geometry.kind {
        Some(Form::GeometryId(id)) => show(id),
        Some(Form::Compound(compound)) => {
            compound.parts.iter().filter_map(|part| part.geometry.as_ref()).for_each(|part| each_id(part, show));
        }
        Some(_) | None => {}
    }
}

/// Asks what was kept again.
///
/// # Errors
/// What was kept is not whole.
pub(crate) fn ask_again(kept: &pb::Replay) -> Checked<pb::Answer> {
    let Some(question) = &kept.question else {
        return Err(Problem::at("question", Reason::Missing, "is absent: nothing was asked"));
    };
    let geometries = Geometries::new(Quotas::NONE);
    let cut = |building: &Building| building.cut(&CancellationToken::new());
    let mut intake = Intake::default();
    for (index, piece) in kept.geometries.iter().enumerate() {
        intake.take(piece.clone(), &geometries, &cut).under_item("geometries", index)?;
    }
    intake.end(&geometries, &cut)?;
    let world = world(kept, &geometries)?;
    let (scene, _) = Scene::alone(world, geometries).explained();
    Ok(answered(question::answer(question, &scene)))
}

/// The shapes that were kept, as they went.
fn world(kept: &pb::Replay, geometries: &Geometries) -> Checked<World> {
    let (name, earliest) =
        if kept.ticks.is_empty() { ("tick", kept.tick) } else { ("earliest_tick", kept.earliest_tick) };
    let Some(earliest) = Tick::new(earliest) else {
        return Err(Problem::at(name, Reason::OutOfLimits, "is 0: ticks begin at 1"));
    };
    let shapes = kept.shapes.iter().enumerate();
    let shapes = shapes.map(|(index, sent)| shape::shape(sent, geometries).under_item("shapes", index));
    let shapes: Vec<Shape> = shapes.collect::<Checked<_>>()?;
    let history_ticks = u32::try_from(kept.ticks.len()).unwrap_or(u32::MAX);
    if history_ticks > WorldSettings::HISTORY_TICKS_MAX {
        let what = format!("are {history_ticks}: a world holds at most {}", WorldSettings::HISTORY_TICKS_MAX);
        return Err(Problem::at("ticks", Reason::TooManyItems, what));
    }
    let settings = WorldSettings { history_ticks, ..WorldSettings::default() };
    let means = Means { history_bytes: u64::MAX, ..Means::default() };
    let mut world = World::holding(shapes, earliest, Time(0), settings, means);
    for (index, sent) in kept.ticks.iter().enumerate() {
        edit::apply_whole(&sent.edits, geometries, &mut world).under_item("ticks", index)?;
    }
    Ok(world)
}
