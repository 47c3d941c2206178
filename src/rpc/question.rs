//! A question of any kind, as batches and streams have them.

use wire::v1::{self as pb, answer::Answer as Kind, question::Question as Asked};

use super::{
    answering::{Hint, answered},
    depenetrate, distance, first_touch, move_character, overlap, pairs, penetration, raycast, resolve,
    scene::{Asking, Scene},
    time_of_impact,
};
use crate::problem::{Checked, Problem, Reason, Under};

/// What a question says of itself before it asks.
#[derive(Clone, Copy, Debug)]
pub(super) struct Heading<'a> {
    /// The field that it is in.
    pub(super) name: &'static str,
    /// Its session.
    pub(super) session: &'a str,
    /// What applies to it.
    pub(super) options: Option<&'a pb::QueryOptions>,
    /// What tells how long it takes.
    hint: Hint<'a>,
}

/// The heading of a question.
///
/// # Errors
/// It asks nothing.
pub(super) fn heading(sent: &pb::Question) -> Checked<Heading<'_>> {
    fn of<'a>(name: &'static str, sent: &'a impl Asking) -> Checked<Heading<'a>> {
        Ok(Heading { name, session: sent.session(), options: sent.options(), hint: Hint::of(sent) })
    }
    match &sent.question {
        None => Err(no_question()),
        Some(Asked::Raycast(sent)) => of("raycast", sent),
        Some(Asked::Overlap(sent)) => of("overlap", &**sent),
        Some(Asked::Penetration(sent)) => of("penetration", &**sent),
        Some(Asked::TimeOfImpact(sent)) => of("time_of_impact", &**sent),
        Some(Asked::Distance(sent)) => of("distance", &**sent),
        Some(Asked::MoveCharacter(sent)) => of("move_character", &**sent),
        Some(Asked::Depenetrate(sent)) => of("depenetrate", &**sent),
        Some(Asked::FirstTouch(sent)) => of("first_touch", &**sent),
        Some(Asked::Resolve(sent)) => of("resolve", &**sent),
        Some(Asked::Pairs(sent)) => of("pairs", &**sent),
    }
}

fn no_question() -> Problem {
    let what = "is absent: it is one of raycast, overlap, penetration, time_of_impact, distance, move_character, \
                depenetrate, first_touch, resolve, pairs, such as {\"raycast\": {\"direction\": {\"z\": 1}}}";
    Problem::at("question", Reason::Missing, what)
}

/// Answers it on the scene's version, behind the fence, where its weight says.
///
/// # Errors
/// As [`answer`], or it panicked.
pub(super) async fn answer_anywhere(heading: &Heading<'_>, sent: &pb::Question, scene: &Scene) -> Checked<Kind> {
    let answered = answered(&heading.hint, sent, scene, answer).await;
    if let Some(asked) = &sent.question {
        scene.tell(|| (asked.clone(), answered.clone()));
    }
    answered
}

/// Answers it on the scene's version.
///
/// # Errors
/// What is wrong with the question, the deadline.
pub(super) fn answer(sent: &pb::Question, scene: &Scene) -> Checked<Kind> {
    let (name, answered) = match &sent.question {
        Some(Asked::Raycast(sent)) => ("raycast", raycast::answer(sent, scene).map(Kind::from)),
        Some(Asked::Overlap(sent)) => ("overlap", overlap::answer(sent, scene).map(Kind::from)),
        Some(Asked::Penetration(sent)) => ("penetration", penetration::answer(sent, scene).map(Kind::from)),
        Some(Asked::TimeOfImpact(sent)) => ("time_of_impact", time_of_impact::answer(sent, scene).map(Kind::from)),
        Some(Asked::Distance(sent)) => ("distance", distance::answer(sent, scene).map(Kind::from)),
        Some(Asked::MoveCharacter(sent)) => ("move_character", move_character::answer(sent, scene).map(Kind::from)),
        Some(Asked::Depenetrate(sent)) => ("depenetrate", depenetrate::answer(sent, scene).map(Kind::from)),
        Some(Asked::FirstTouch(sent)) => ("first_touch", first_touch::answer(sent, scene).map(Kind::from)),
        Some(Asked::Resolve(sent)) => ("resolve", resolve::answer(sent, scene).map(Kind::from)),
        Some(Asked::Pairs(sent)) => ("pairs", pairs::answer(sent, scene).map(Kind::from)),
        None => return Err(no_question()),
    };
    answered.under(name)
}
