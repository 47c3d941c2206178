//! What a question is asked in: one version of a session's world, the terms it is asked on, and its deadline.

use std::{
    borrow::Cow,
    sync::{Arc, atomic::Ordering},
};

use collision::{
    accuracy::Accuracy,
    answer::Verdict,
    world::{Filter, Found, Meter, Notes, QuestionError, Snapshot, World},
};
use parking_lot::Mutex;
use prost::Message;
use tokio::sync::Semaphore;
use tonic::{Request, Response, Status};
use wire::v1::{self as pb, answer::Answer as Kind, question::Question as Asked};

use super::{
    Caller, Server,
    account::{Account, PAIRS_TOLD},
    answering::{Hint, answered},
    fitting,
    replay::{SHAPES, Touched},
};
use crate::{
    building::Workshop,
    compute::Weight,
    config::Settings,
    convert::{answer, question, trace::trace},
    deadline::Deadline,
    geometries::Geometries,
    problem::{Checked, Problem, Under},
    session::{Access, Session},
    token::Role,
    writer::Writer,
};

/// Steps that one question may take: some twenty seconds of work, so that what grazes without end is refused, not worked on for
/// minutes.
const QUESTION_STEPS: u64 = 1 << 28;

/// What applies to a question.
#[derive(Clone, Debug, Default)]
pub(super) struct Terms {
    pub(super) filter: Filter,
    pub(super) accuracy: Accuracy,
    explain: bool,
}

impl Terms {
    /// Whether questions tell what they do.
    pub(super) fn explains(&self) -> bool {
        self.explain
    }

    /// These terms where `own` says nothing else.
    pub(super) fn overridden_by(&self, own: Option<&pb::QueryOptions>) -> Checked<Cow<'_, Self>> {
        let Some(own) = own else { return Ok(Cow::Borrowed(self)) };
        let filter = match &own.filter {
            Some(filter) => question::filter(Some(filter)).under("options.filter")?,
            None => self.filter.clone(),
        };
        let accuracy = match &own.accuracy {
            Some(accuracy) => question::accuracy(Some(accuracy)).under("options.accuracy")?,
            None => self.accuracy,
        };
        Ok(Cow::Owned(Self { filter, accuracy, explain: self.explain || own.explain }))
    }
}

/// Whether an answer names the tick it was found on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Naming {
    /// It does.
    Tick,
    /// The batch around it does.
    Nothing,
}

/// Looks at the clock, each after some 100 µs of work, until a question that may not take long is interrupted.
const LOOKS_OF_SHORT: u32 = 16;

/// How long a question may take.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Patience {
    /// A few milliseconds: others wait for the thread. Then it is interrupted, whatever its deadline.
    Short,
    /// Until the deadline.
    Endless,
}

/// What a question is asked in.
#[derive(Clone, Debug)]
pub(super) struct Scene {
    pub(super) session: Arc<Session>,
    /// Where parts are made that questions need, if they are.
    pub(super) workshop: Option<Arc<Workshop>>,
    pub(super) snapshot: Arc<Snapshot>,
    pub(super) deadline: Deadline,
    pub(super) patience: Patience,
    /// What applies to each question that does not say otherwise.
    pub(super) shared: Terms,
    pub(super) naming: Naming,
    /// Where shapes that questions look at are noted, if they are.
    pub(super) touched: Option<Touched>,
}

impl Scene {
    /// That of a request, for its caller.
    ///
    /// # Errors
    /// Who may not read the session; a version that is not held.
    pub(super) async fn of(server: &Server, caller: &Caller, asked: &impl Asking) -> Checked<Self> {
        Self::enter(server, caller, asked.session(), asked.options()).await
    }

    /// That of a session, at the version that the options name.
    ///
    /// # Errors
    /// As [`Scene::of`].
    pub(super) async fn enter(
        server: &Server,
        caller: &Caller,
        session: &str,
        options: Option<&pb::QueryOptions>,
    ) -> Checked<Self> {
        let session = server.enter(caller, session, Role::Reader)?;
        let read_at = options.and_then(|options| options.read_at.as_ref());
        let read_at = question::read_at(read_at).under("options.read_at")?;
        Ok(Self {
            snapshot: session.pin(read_at, caller.deadline).await.under("options")?,
            session,
            workshop: Some(server.workshop.clone()),
            deadline: caller.deadline,
            patience: Patience::Endless,
            shared: Terms::default(),
            naming: Naming::Tick,
            touched: None,
        })
    }

    /// The newest version of a world by itself, without a server.
    pub(super) fn alone(world: World, geometries: Geometries) -> Self {
        let access = Access::Open(Mutex::default());
        let (settings, waiting) = (Settings::default(), Arc::new(Semaphore::new(1)));
        let parts = (Writer::of(world), geometries);
        let session = Arc::new(Session::new("alone".to_owned(), access, None, &settings, waiting, parts));
        Self {
            snapshot: session.newest(),
            session,
            workshop: None,
            deadline: Deadline::default(),
            patience: Patience::Endless,
            shared: Terms::default(),
            naming: Naming::Tick,
            touched: None,
        }
    }

    /// The same where all questions tell what they do, and where the shapes that they look at are noted.
    pub(super) fn explained(self) -> (Self, Touched) {
        let touched = Touched::default();
        let shared = Terms { explain: true, ..self.shared };
        (Self { shared, touched: Some(touched.clone()), ..self }, touched)
    }

    /// The same where no parts are made for questions.
    pub(super) fn without_workshop(&self) -> Self {
        Self { workshop: None, ..self.clone() }
    }

    /// Asks, with a meter that stops at the deadline; notes what is done if the terms say so. The call around it stands behind a
    /// fence: a panic is caught there.
    ///
    /// # Errors
    /// What the world refuses, the deadline.
    pub(super) fn ask<H>(
        &self,
        terms: &Terms,
        asked: impl FnOnce(&mut Meter<'_>) -> Result<Found<H>, QuestionError>,
    ) -> Checked<(Found<H>, Account)> {
        let (found, account) = self.ask_uncounted(terms, asked)?;
        self.count(1, u64::from(found.verdict == Verdict::Undecided));
        Ok((found, account))
    }

    /// The same for who counts.
    ///
    /// # Errors
    /// What the world refuses, the deadline.
    #[inline]
    pub(super) fn ask_uncounted<T>(
        &self,
        terms: &Terms,
        asked: impl FnOnce(&mut Meter<'_>) -> Result<T, QuestionError>,
    ) -> Checked<(T, Account)> {
        let mut looks_left = match self.patience {
            Patience::Short => LOOKS_OF_SHORT,
            Patience::Endless => u32::MAX,
        };
        let mut keep_going = || {
            looks_left = looks_left.saturating_sub(1);
            looks_left > 0 && self.deadline.is_ahead()
        };
        let most = if self.touched.is_some() { SHAPES } else { PAIRS_TOLD };
        let mut notes = terms.explain.then(|| Notes::new(most));
        let mut meter = Meter::new(&mut keep_going).with_limit(QUESTION_STEPS);
        if let Some(notes) = &mut notes {
            meter = meter.noting(notes);
        }
        let found = asked(&mut meter);
        let work = meter.work;
        if let (Some(touched), Some(notes)) = (&self.touched, &notes) {
            touched.add(notes);
        }
        let found = found.map_err(|error| self.refused(&error))?;
        Ok((found, Account::of(work, notes.as_ref())?))
    }

    /// Counts questions that were answered, and how many of them stayed undecided.
    pub(super) fn count(&self, question_count: u64, undecided_count: u64) {
        let counters = &self.session.counters;
        counters.questions.fetch_add(question_count, Ordering::Relaxed);
        if undecided_count > 0 {
            counters.undecided.fetch_add(undecided_count, Ordering::Relaxed);
        }
    }

    /// Tells those who watch what was asked and answered; if nobody does, that costs nothing.
    pub(super) fn tell(&self, told: impl FnOnce() -> (Asked, Checked<Kind>)) {
        self.session.traces.tell(|| {
            let (asked, answered) = told();
            trace(asked, answered)
        });
    }

    /// What is told of a question without an answer. Parts that it lacks are made from now on.
    fn refused(&self, error: &QuestionError) -> Problem {
        if let QuestionError::PartsMissing { with, wanted } = error {
            let asking = self.snapshot.asking();
            let progress = self.workshop.as_ref().map_or(0.0, |workshop| workshop.furnish(asking, wanted));
            return answer::parts_missing(*with, wanted.len(), progress);
        }
        answer::refused(error, self.snapshot.tick())
    }

    /// What an answer says about itself.
    pub(super) fn info(&self, terms: &Terms, account: Account) -> Option<pb::AnswerInfo> {
        let told = terms.explain.then(|| account.into_info());
        match self.naming {
            Naming::Tick => Some(pb::AnswerInfo {
                tick: self.snapshot.tick().get(),
                tick_fraction: self.snapshot.fraction(),
                ..told.unwrap_or_default()
            }),
            Naming::Nothing => told,
        }
    }
}

/// A request that asks one question of a session.
pub(super) trait Asking: Message + 'static {
    /// What it makes to do, as far as its kind tells.
    const WEIGHT: Weight = Weight::Light;
    /// Which session.
    fn session(&self) -> &str;
    /// What applies to it.
    fn options(&self) -> Option<&pb::QueryOptions>;
    /// What it is about, where that is one form.
    fn subject(&self) -> Option<&pb::Subject> {
        None
    }
}

macro_rules! asking {
    ($($request:ident $(about $subject:ident)? $(is $weight:ident)?),*) => {
        $(impl Asking for pb::$request {
            $(const WEIGHT: Weight = Weight::$weight;)?

            fn session(&self) -> &str {
                &self.session
            }

            fn options(&self) -> Option<&pb::QueryOptions> {
                self.options.as_deref()
            }

            $(fn subject(&self) -> Option<&pb::Subject> {
                self.$subject.as_ref()
            })?
        })*
    };
}

asking!(
    RaycastRequest,
    OverlapRequest about subject,
    PenetrationRequest about subject,
    TimeOfImpactRequest about subject,
    DistanceRequest about subject,
    MoveCharacterRequest about subject,
    DepenetrateRequest about subject,
    FirstTouchRequest is Heavy,
    ResolveRequest,
    PairsRequest is Heavy,
    BatchRequest,
    RaycastBatchRequest,
    OverlapBatchRequest,
    TimeOfImpactBatchRequest,
    DistanceBatchRequest,
    LineOfSightRequest
);

/// Answers a unary question.
///
/// # Errors
/// What is wrong with it.
pub(super) async fn unary<Q, A>(
    server: &Server,
    request: Request<Q>,
    answer: fn(&Q, &Scene) -> Checked<A>,
) -> Result<Response<A>, Status>
where
    Q: Asking + Clone + Into<Asked>,
    A: Message + Clone + Into<Kind> + 'static,
{
    let caller = Caller::of(&request);
    let asked = request.into_inner();
    let scene = Scene { patience: Patience::Short, ..Scene::of(server, &caller, &asked).await? };
    let answered = answered(&Hint::of_message(&asked), &asked, &scene, answer).await;
    scene.tell(|| (asked.into(), answered.clone().map(Into::into)));
    Ok(Response::new(fitting(answered?, "ask for fewer hits")?))
}
