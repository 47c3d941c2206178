//! Asks a world, and reads what all answers have in common.

use std::hint::black_box;

use collision::{
    DVec3,
    accuracy::{Accuracy, Tier},
    answer::{Bound, Certificate, Feature, Representation, Verdict, Work},
    world::{Filter, HitMode, Meter, QuestionError, ShapeId, Snapshot, Subject},
};

use super::{
    clock::clock,
    questions::{HITS_MAX, Question},
};

/// One item of an answer; lengths in metres.
#[derive(Clone, Copy, Debug)]
pub(super) struct Found {
    pub(super) id: ShapeId,
    /// Where on the subject and on the shape.
    pub(super) features: [Feature; 2],
    pub(super) verdict: Verdict,
    pub(super) bound: Bound,
    /// Within the bound; of an overlap nothing but 0.
    pub(super) value: f64,
    /// Of a contact.
    pub(super) normal: Option<DVec3>,
    pub(super) stood_in: bool,
}

/// An answer.
#[derive(Clone, Debug)]
pub(super) struct Answer {
    pub(super) verdict: Verdict,
    pub(super) found: Vec<Found>,
    pub(super) work: Work,
}

impl Answer {
    /// The item that answers a question for one: the certain one, or the first of those that may be.
    pub(super) fn main(&self) -> Option<&Found> {
        self.found.iter().find(|found| found.verdict == Verdict::Hit).or(self.found.first())
    }
}

/// The exact tier with as much budget as a request may have.
pub(super) fn exact() -> Accuracy {
    Accuracy { budget: 1 << 16, ..Accuracy::of(Tier::Exact) }
}

fn item(
    id: Option<ShapeId>,
    features: [Feature; 2],
    value: f64,
    unit: f64,
    certificate: &Certificate,
) -> Option<Found> {
    let Bound { lower, upper } = certificate.bound;
    Some(Found {
        id: id?,
        features,
        verdict: certificate.verdict,
        bound: Bound::new(lower * unit, upper * unit),
        value: value * unit,
        normal: None,
        stood_in: certificate.model.representation != Representation::Exact,
    })
}

/// What a world says; an error is a refusal, such as of a depth between two meshes.
pub(super) fn ask(snapshot: &Snapshot, question: &Question, accuracy: &Accuracy) -> Result<Answer, QuestionError> {
    let mut go_on = || true;
    let mut meter = Meter::new(&mut go_on);
    let filter = Filter::default();
    let nowhere = Feature::default();
    let (verdict, found) = match question {
        Question::Raycast(question) => {
            let answer = snapshot.raycast(question, &filter, accuracy, &mut meter)?;
            let items = answer
                .hits
                .iter()
                .filter_map(|hit| item(hit.id, [nowhere; 2], hit.touch.distance, 1.0, &hit.touch.certificate));
            (answer.verdict, items.collect())
        }
        Question::Overlap(question) => {
            let answer = snapshot.overlap(question, &filter, accuracy, &mut meter)?;
            let items = answer.hits.iter().filter_map(|hit| item(hit.id, [nowhere; 2], 0.0, 1.0, &hit.certificate));
            (answer.verdict, items.collect())
        }
        Question::Distance(question) => {
            let answer = snapshot.distance(question, &filter, accuracy, &mut meter)?;
            let items = answer.hits.iter().filter_map(|hit| {
                item(hit.id, [nowhere; 2], hit.separation.distance, 1.0, &hit.separation.certificate)
            });
            (answer.verdict, items.collect())
        }
        Question::Penetration(question) => {
            let answer = snapshot.penetration(question, &filter, accuracy, &mut meter)?;
            let items = answer.hits.iter().filter_map(|hit| {
                let features = [hit.subject_feature, hit.feature];
                let found = item(hit.id, features, hit.depth, 1.0, &hit.certificate)?;
                Some(Found { normal: Some(hit.normal), ..found })
            });
            (answer.verdict, items.collect())
        }
        Question::Impact(question, way) => {
            let answer = snapshot.time_of_impact(question, &filter, accuracy, &mut meter)?;
            let items = answer
                .hits
                .iter()
                .filter_map(|hit| item(hit.id, [nowhere; 2], hit.touch.fraction, *way, &hit.touch.certificate));
            (answer.verdict, items.collect())
        }
    };
    Ok(Answer { verdict, found, work: meter.work })
}

/// What is true of the subject and one shape alone; `None` if they do not meet.
pub(super) fn ask_about(snapshot: &Snapshot, question: &Question, id: ShapeId) -> Option<Found> {
    let against = Some(Subject::Shape { id, pose: None });
    let question = match question.clone() {
        Question::Raycast(mut question) => {
            question.mode = HitMode::All(HITS_MAX);
            Question::Raycast(question)
        }
        Question::Overlap(question) => Question::Overlap(collision::world::Overlap { against, ..question }),
        Question::Distance(question) => Question::Distance(collision::world::Distance { against, ..question }),
        Question::Penetration(question) => Question::Penetration(collision::world::Penetration { against, ..question }),
        Question::Impact(question, way) => {
            Question::Impact(collision::world::TimeOfImpact { against, ..question }, way)
        }
    };
    let answer = ask(snapshot, &question, &exact()).ok()?;
    answer.found.into_iter().find(|found| found.id == id)
}

/// Nanoseconds of a question: several times over if it is a short one, so that reading the clock is no part of it.
pub(super) fn time(snapshot: &Snapshot, question: &Question, accuracy: &Accuracy, repeats: u32) -> f64 {
    let begin = clock();
    for _ in 0..repeats {
        let _ = black_box(answer_only(snapshot, question, accuracy));
    }
    (clock() - begin).as_secs_f64() * 1e9 / f64::from(repeats)
}

/// The question alone, without reading its answer.
fn answer_only(snapshot: &Snapshot, question: &Question, accuracy: &Accuracy) -> Result<Verdict, QuestionError> {
    let mut go_on = || true;
    let (meter, filter) = (&mut Meter::new(&mut go_on), Filter::default());
    Ok(match question {
        Question::Raycast(question) => black_box(snapshot.raycast(question, &filter, accuracy, meter)?).verdict,
        Question::Overlap(question) => black_box(snapshot.overlap(question, &filter, accuracy, meter)?).verdict,
        Question::Distance(question) => black_box(snapshot.distance(question, &filter, accuracy, meter)?).verdict,
        Question::Penetration(question) => black_box(snapshot.penetration(question, &filter, accuracy, meter)?).verdict,
        Question::Impact(question, _) => {
            black_box(snapshot.time_of_impact(question, &filter, accuracy, meter)?).verdict
        }
    })
}
