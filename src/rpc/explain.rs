//! `Explain`: a question answered together with all that its answer depends on, so that it can be asked again elsewhere.
//!
//! # Method
//! An answer follows from the shapes that the question looks at and those that it names: what the trees and the filter let it
//! pass over could have had no part in it. So these shapes, where they were, are enough to ask again.

use std::{
    collections::BTreeSet,
    sync::{Arc, atomic::AtomicU64, atomic::Ordering},
};

use collision::{
    shape::Geometry,
    world::{Means, Notes, Settings as WorldSettings, Shape, ShapeId, Tick, Time, World},
};
use parking_lot::Mutex;
use tokio::sync::Semaphore;
use tokio_util::sync::CancellationToken;
use tonic::{Request, Response, Status};
use wire::v1::{self as pb, answer::Answer as Kind, geometry::Kind as Form, question::Question as Asked, subject};

use super::{Caller, MESSAGE_BYTES, Server, fitting, question, scene::Scene};
use crate::{
    building::Building,
    compute::{self, Weight},
    config::Settings,
    convert::{
        archive::{self, Intake, named_by_id},
        item, shape,
    },
    geometries::{Geometries, Quotas},
    problem::{Checked, Problem, Reason, Under},
    session::{Access, Session},
    token::Role,
    writer::Writer,
};

/// Layout of what is kept.
pub(crate) const FORMAT: u32 = 1;
/// Most shapes that are kept.
pub(super) const SHAPES: usize = 16_384;
/// What a caller can do about what is too large to keep.
const SMALLER: &str = "its geometries are large: ask about fewer shapes, or keep the world by ExportWorld";

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
        self.ids.lock().extend(notes.list.iter().filter_map(|note| note.id));
    }
}

/// Answers a question and returns what it depends on.
///
/// # Errors
/// There is no question; who may not read the session; a version that is not held; the deadline; it is too large.
pub(super) async fn answer(
    server: &Server,
    request: Request<pb::ExplainRequest>,
) -> Result<Response<pb::ExplainResponse>, Status> {
    let caller = Caller::of(&request);
    let pb::ExplainRequest { session, question, item } = request.into_inner();
    let entered = server.enter(&caller, &session, Role::Reader)?;
    let question = match (question, item) {
        (Some(question), None) => question,
        (None, Some(item)) => pb::Question { question: Some(item::asked(&item, &entered.geometries).under("item")?) },
        (Some(_), Some(_)) => {
            let what = "goes without question: leave one of the two out";
            return Err(Problem::at("item", Reason::OutOfLimits, what).into());
        }
        (None, None) => {
            let what = "is absent: send one, such as {\"raycast\": {\"direction\": {\"z\": 1}}}, or an item";
            return Err(Problem::at("question", Reason::Missing, what).into());
        }
    };
    let heading = question::heading(&question).under("question")?;
    if !heading.session.is_empty() {
        let what =
            "must be left out: the session beside the question holds, as in {\"session\": \"arena\", \"question\": {}}";
        let refused: Checked<()> = Err(Problem::at("session", Reason::OutOfLimits, what));
        refused.under(heading.name).under("question")?;
    }
    if matches!(question.question, Some(Asked::FirstTouch(_))) {
        let what = "depends on many ticks, and a replay holds one: ask FirstTouch, and explain the time_of_impact of what it names, \
                    with its tick as options.read_at";
        return Err(Problem::at("question.first_touch", Reason::OutOfLimits, what).into());
    }
    let scene = Scene::enter(server, &caller, &session, heading.options).await;
    let scene = scene.under(heading.name).under("question")?;
    let replay = compute::run(Weight::Heavy, "explaining a question", move || replay(question, scene)).await?;
    Ok(Response::new(fitting(pb::ExplainResponse { replay: Some(replay) }, SMALLER)?))
}

fn replay(question: pb::Question, scene: Scene) -> Checked<pb::Replay> {
    let (scene, touched) = scene.explained();
    let answer = match question::answer(&question, &scene) {
        Err(problem) if problem.is(Reason::Deadline) => return Err(problem),
        answer => answered(answer),
    };
    let named: Vec<&pb::Subject> = subjects(&question).collect();
    let mut ids = touched.ids.lock().clone();
    ids.extend(named.iter().filter_map(|subject| match subject.form {
        Some(subject::Form::Id(id)) => ShapeId::new(id),
        Some(subject::Form::Geometry(_)) | None => None,
    }));
    let mut left_out_count = touched.left_out_count.load(Ordering::Relaxed);
    left_out_count += ids.len().saturating_sub(SHAPES) as u64;
    let snapshot = &scene.snapshot;
    let shapes: Vec<Shape> =
        ids.iter().take(SHAPES).filter_map(|&id| snapshot.shape(id)).map(|shape| shape.into_owned()).collect();
    let mut named_geometries = Vec::new();
    for subject in named {
        if let Some(subject::Form::Geometry(geometry)) = &subject.form {
            each_id(geometry, &mut |id| named_geometries.extend(scene.session.geometries.get(id).ok()));
        }
    }
    Ok(pb::Replay {
        format: FORMAT,
        program: env!("CARGO_PKG_VERSION").to_owned(),
        tick: snapshot.tick().get(),
        tick_fraction: snapshot.fraction(),
        geometries: pieces(shapes.iter().map(|shape| &shape.geometry).chain(&named_geometries))?,
        shapes: shapes.iter().map(shape::shape_out).collect(),
        shapes_left_out: left_out_count,
        answer: Some(answer),
        question: Some(question),
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

/// What a question is about, and against.
fn subjects(question: &pb::Question) -> impl Iterator<Item = &pb::Subject> {
    let [subject, against] = match &question.question {
        Some(Asked::FirstTouch(_)) | None => [None, None],
        Some(Asked::Raycast(it)) => [None, it.against.as_deref()],
        Some(Asked::Overlap(it)) => [it.subject.as_ref(), it.against.as_deref()],
        Some(Asked::Penetration(it)) => [it.subject.as_ref(), it.against.as_deref()],
        Some(Asked::TimeOfImpact(it)) => [it.subject.as_ref(), it.against.as_deref()],
        Some(Asked::Distance(it)) => [it.subject.as_ref(), it.against.as_deref()],
        Some(Asked::MoveCharacter(it)) => [it.subject.as_ref(), None],
        Some(Asked::Depenetrate(it)) => [it.subject.as_ref(), it.against.as_deref()],
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
    let Some(tick) = Tick::new(kept.tick) else {
        return Err(Problem::at("tick", Reason::OutOfLimits, "is 0: ticks begin at 1"));
    };
    let geometries = Geometries::new(Quotas::NONE);
    let cut = |building: &Building| building.cut(&CancellationToken::new());
    let mut intake = Intake::default();
    for (index, piece) in kept.geometries.iter().enumerate() {
        intake.take(piece.clone(), &geometries, &cut).under_item("geometries", index)?;
    }
    intake.end(&geometries, &cut)?;
    let shapes = kept.shapes.iter().enumerate();
    let shapes = shapes.map(|(index, sent)| shape::shape(sent, &geometries).under_item("shapes", index));
    let shapes: Vec<Shape> = shapes.collect::<Checked<_>>()?;
    let world = World::holding(shapes, tick, Time(0), WorldSettings::default(), Means::default());
    let access = Access::Open(Mutex::default());
    let (settings, waiting) = (Settings::default(), Arc::new(Semaphore::new(1)));
    let parts = (Writer::of(world), geometries);
    let session = Arc::new(Session::new("replay".to_owned(), access, None, &settings, waiting, parts));
    let (scene, _) = Scene::of_newest(session).explained();
    Ok(answered(question::answer(question, &scene)))
}
