//! Asks all questions at all settings.

use collision::{answer::Verdict, world::ShapeId};

use super::{
    Kind, Knob, Row, Setting, Stage,
    ask::{Answer, Found, ask, ask_about, exact, time},
    audit::{audit, depths_along},
    clock::clock,
    judge::{Judged, Truth},
    questions::{Question, questions},
    rows::Measured,
    stages::Staged,
};
use crate::scenes::Scene;

/// What to measure.
#[derive(Clone, Debug)]
pub struct Options {
    /// Which kinds of questions.
    pub kinds: Vec<Kind>,
    /// How many of each.
    pub count: usize,
    /// Names the questions.
    pub seed: u64,
    /// Only the question of this number.
    pub only: Option<usize>,
    /// Only these knobs; all if empty.
    pub knobs: Vec<Knob>,
    /// How often each is timed: the least time counts. 0 leaves times out.
    pub turns: usize,
}

impl Default for Options {
    fn default() -> Self {
        Self { kinds: Kind::ALL.to_vec(), count: 100, seed: 1, only: None, knobs: Vec::new(), turns: 3 }
    }
}

/// An answer that does not hold the truth.
#[derive(Clone, Debug)]
pub struct Lie {
    /// Of which kind.
    pub kind: Kind,
    /// Which question.
    pub number: usize,
    /// At which setting: as `QueryOptions.accuracy` says it.
    pub request: String,
    /// What was said, and what is true.
    pub sentence: String,
}

/// How many exact answers of a kind the oracle was asked about.
#[derive(Clone, Copy, Debug)]
pub struct Audited {
    /// Of which kind.
    pub kind: Kind,
    /// Exact answers.
    pub answers: usize,
    /// Those of them that the oracle judged, each true unless there is a [`Lie`] about it.
    pub judged: usize,
}

/// What was measured on a scene.
#[derive(Clone, Debug)]
pub struct Report {
    /// The scene's name.
    pub scene: String,
    /// A row for each kind and setting.
    pub rows: Vec<Row>,
    /// Where the truth is from.
    pub audited: Vec<Audited>,
    /// What was wrong.
    pub lies: Vec<Lie>,
}

/// Exact answers of a kind that the oracle judges at most.
const AUDITS_MAX: usize = 40;

/// A question is repeated until it has taken about this long, ns, so that reading the clock does not count.
const LONG_ENOUGH: f64 = 10_000.0;

/// All turns of a kind end after this much, seconds; one is always whole.
const TURNS_SECONDS: f64 = 5.0;

/// So many times at most.
const REPEATS_MAX: u32 = 32;

/// What was asked, and what is true.
struct Asked {
    number: usize,
    question: Question,
    exact: Answer,
}

/// Measures a scene. `progress` is told how many rows of how many are done, and what is measured.
pub fn run(scene: &Scene, options: &Options, progress: &mut dyn FnMut(usize, usize, &str)) -> Report {
    let is_wanted = |setting: &Setting| options.knobs.is_empty() || options.knobs.contains(&setting.knob);
    run_with(scene, options, &|kind| Setting::all(scene, kind).into_iter().filter(is_wanted).collect(), progress)
}

/// The same, at settings of the caller's own.
pub(super) fn run_with(
    scene: &Scene,
    options: &Options,
    settings: &dyn Fn(Kind) -> Vec<Setting>,
    progress: &mut dyn FnMut(usize, usize, &str),
) -> Report {
    let mut report = Report { scene: scene.name.clone(), rows: Vec::new(), audited: Vec::new(), lies: Vec::new() };
    let settings: Vec<(Kind, Vec<Setting>)> = options.kinds.iter().map(|&kind| (kind, settings(kind))).collect();
    let all: usize = settings.iter().map(|(_, settings)| settings.len()).sum();
    let mut stages: Vec<(Stage, Staged)> = vec![(Stage::Plain, Staged::new(scene, Stage::Plain))];
    for (kind, settings) in settings {
        progress(report.rows.len(), all, &format!("{} {}: the truth", scene.name, kind.text()));
        let asked = truths(scene, &stages[0].1, kind, options);
        report.audit(scene, kind, &asked);
        for setting in &settings {
            if !stages.iter().any(|(stage, _)| *stage == setting.stage) {
                stages.push((setting.stage, Staged::new(scene, setting.stage)));
            }
        }
        let staged =
            |setting: &Setting| &stages.iter().find(|(stage, _)| *stage == setting.stage).unwrap_or(&stages[0]).1;
        let asks: Vec<(&Setting, &Staged)> = settings.iter().map(|setting| (setting, staged(setting))).collect();
        let mut measured: Vec<Measured> = Vec::new();
        for (done, &ask) in asks.iter().enumerate() {
            progress(report.rows.len() + done, all, &format!("{} {}: {}", scene.name, kind.text(), ask.0.knob.text()));
            measured.push(report.judge((scene, kind), ask, &stages[0].1, &asked));
        }
        let begin = clock();
        for turn in 0..options.turns {
            if turn > 0 && (clock() - begin).as_secs_f64() > TURNS_SECONDS {
                break;
            }
            progress(
                report.rows.len() + asks.len(),
                all,
                &format!("{} {}: turn {}", scene.name, kind.text(), turn + 1),
            );
            asks.iter().zip(&mut measured).for_each(|(&ask, measured)| spend(ask, &asked, measured));
        }
        let rows = asks
            .iter()
            .zip(&measured)
            .map(|((setting, staged), measured)| Row::new(&scene.name, kind, setting, measured, &staged.note));
        report.rows.extend(rows);
    }
    report
}

/// The questions that have an exact answer, with that.
fn truths(scene: &Scene, plain: &Staged, kind: Kind, options: &Options) -> Vec<Asked> {
    let drawn = questions(scene, kind, options.count, options.seed).into_iter().enumerate();
    drawn
        .filter(|(number, _)| options.only.is_none_or(|only| only == *number))
        .filter_map(|(number, question)| {
            let exact = ask(&plain.snapshot, &question, &exact()).ok()?;
            Some(Asked { number, question, exact })
        })
        .collect()
}

/// One turn: each question's time is the least of all turns.
fn spend((setting, staged): (&Setting, &Staged), asked: &[Asked], measured: &mut Measured) {
    for (asked, least) in asked.iter().zip(&mut measured.times) {
        let repeats = (LONG_ENOUGH / *least).clamp(1.0, f64::from(REPEATS_MAX)) as u32;
        *least = least.min(time(&staged.snapshot, &asked.question, &setting.accuracy, repeats));
    }
}

impl Report {
    fn audit(&mut self, scene: &Scene, kind: Kind, asked: &[Asked]) {
        let mut judged = 0;
        for one in asked {
            if judged == AUDITS_MAX {
                break;
            }
            let Some(found) = audit(scene, &one.question, &one.exact) else { continue };
            judged += 1;
            if let Err(sentence) = found {
                self.lie(kind, one, r#"{"tier":"TIER_EXACT","budget":65536}"#, sentence);
            }
        }
        let answers = asked.iter().filter(|asked| asked.exact.verdict == Verdict::Hit).count();
        self.audited.push(Audited { kind, answers, judged });
    }

    fn judge(
        &mut self,
        (scene, kind): (&Scene, Kind),
        (setting, staged): (&Setting, &Staged),
        plain: &Staged,
        asked: &[Asked],
    ) -> Measured {
        let mut measured = Measured::default();
        for one in asked {
            let answer = ask(&staged.snapshot, &one.question, &setting.accuracy);
            let about = |id: ShapeId| ask_about(&plain.snapshot, &one.question, id);
            let along = |contact: &Found| depths_along(scene, &one.question, contact);
            let truth = Truth { kind, exact: &one.exact, about: &about, along: &along };
            let judged = match &answer {
                Ok(answer) => truth.judge(answer, &staged.outside),
                Err(error) => Err(error.to_string()),
            };
            measured.held += usize::from(judged.is_ok());
            let judged = judged.unwrap_or_else(|sentence| {
                self.lie(kind, one, &setting.request, sentence);
                Judged::default()
            });
            measured.judged.push(judged);
            measured.work += answer.map(|answer| answer.work).unwrap_or_default();
            measured.times.push(f64::INFINITY);
        }
        measured
    }

    fn lie(&mut self, kind: Kind, asked: &Asked, request: &str, sentence: String) {
        let sentence = format!("{sentence}\n  the question: {}", asked.question.told());
        self.lies.push(Lie { kind, number: asked.number, request: request.to_owned(), sentence });
    }
}
