//! What a question is asked in: one version of a session's world, the terms it is asked on, and its deadline.

use std::{
    borrow::Cow,
    sync::{Arc, atomic::Ordering},
};

use collision::{
    accuracy::Accuracy,
    answer::Verdict,
    world::{Filter, Found, Meter, Notes, QuestionError, Snapshot},
};
use prost::Message;
use tonic::{Request, Response, Status};
use wire::v1::{self as pb, answer::Answer as Kind, question::Question as Asked};

use super::{
    Caller, Server,
    account::{Account, PAIRS_TOLD},
    fitting,
    replay::{SHAPES, Touched},
};
use crate::{
    building::Workshop,
    compute::{self, Weight},
    convert::{answer, question, trace::trace},
    deadline::Deadline,
    problem::{Checked, Problem, Under},
    session::Session,
    token::Role,
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

/// What a question is asked in.
#[derive(Clone, Debug)]
pub(super) struct Scene {
    pub(super) session: Arc<Session>,
    /// Where parts are made that questions need, if they are.
    pub(super) workshop: Option<Arc<Workshop>>,
    pub(super) snapshot: Arc<Snapshot>,
    pub(super) deadline: Deadline,
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
            shared: Terms::default(),
            naming: Naming::Tick,
            touched: None,
        })
    }

    /// The newest version of a session's world, for whoever holds the session.
    pub(super) fn of_newest(session: Arc<Session>) -> Self {
        Self {
            snapshot: session.newest(),
            session,
            workshop: None,
            deadline: Deadline::default(),
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
    pub(super) fn ask_uncounted<H>(
        &self,
        terms: &Terms,
        asked: impl FnOnce(&mut Meter<'_>) -> Result<Found<H>, QuestionError>,
    ) -> Checked<(Found<H>, Account)> {
        let mut keep_going = || self.deadline.is_ahead();
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
    /// Which session.
    fn session(&self) -> &str;
    /// What applies to it.
    fn options(&self) -> Option<&pb::QueryOptions>;
}

macro_rules! asking {
    ($($request:ident),*) => {
        $(impl Asking for pb::$request {
            fn session(&self) -> &str {
                &self.session
            }

            fn options(&self) -> Option<&pb::QueryOptions> {
                self.options.as_deref()
            }
        })*
    };
}

asking!(
    RaycastRequest,
    OverlapRequest,
    PenetrationRequest,
    TimeOfImpactRequest,
    DistanceRequest,
    MoveCharacterRequest,
    DepenetrateRequest,
    FirstTouchRequest,
    ResolveRequest,
    PairsRequest,
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
    Q: Asking + Into<Asked>,
    A: Message + Clone + Into<Kind> + 'static,
{
    let caller = Caller::of(&request);
    let asked = request.into_inner();
    let scene = Scene::of(server, &caller, &asked).await?;
    let weight = Weight::of_message(asked.encoded_len());
    let answered = compute::run(weight, "answering a question", move || {
        let answered = answer(&asked, &scene);
        scene.tell(|| (asked.into(), answered.clone().map(Into::into)));
        answered
    })
    .await?;
    Ok(Response::new(fitting(answered, "ask for fewer hits")?))
}
