//! Goes through a folder: reads each set, asks it, and prints what came of it.

use std::{
    collections::HashMap,
    io::{self, Write},
    path::Path,
    sync::Arc,
    time::{Duration, Instant},
};

use super::{Asker, Case, Known, Mismatch, Question, Reply, SetReport, print_set, special};
use crate::sets::{
    Folder, HullTable, SetError, SetFile, SetKind, TriangleMesh, aabb, casts, meshes, motion, pairs, rays, read_obj,
    stream, toi,
};

/// What came of a folder.
#[derive(Debug, Default)]
pub struct Conclusion {
    /// Records that were judged.
    pub record_count: usize,
    /// Files that are not understood.
    pub strange: Vec<String>,
    /// Where the reports are not as the list of known shortfalls says.
    pub mismatches: Vec<Mismatch>,
}

impl Conclusion {
    /// 0 if all is as it should be, 1 on any shortfall that is not known (or no longer true), 2 if nothing was read or
    /// something was not understood.
    #[must_use]
    pub fn exit_code(&self) -> u8 {
        if self.record_count == 0 || !self.strange.is_empty() { 2 } else { u8::from(!self.mismatches.is_empty()) }
    }
}

/// How a check reports while it goes.
pub struct Reporting<'a> {
    /// Where tables go.
    pub out: &'a mut dyn Write,
    /// Called before each set with how many are done, how many there are, and its name.
    pub progress: &'a mut dyn FnMut(usize, usize, &str),
    /// Faulty records to show for each category.
    pub examples_max: usize,
}

/// Asks every set of a folder.
///
/// # Errors
/// The tables cannot be written.
pub fn check_folder(
    root: &Path,
    asker: &mut dyn Asker,
    known: &Known,
    reporting: &mut Reporting<'_>,
) -> io::Result<Conclusion> {
    let mut conclusion = Conclusion::default();
    let folder = match Folder::open(root) {
        Ok(folder) => folder,
        Err(error) => {
            conclusion.strange.push(error.to_string());
            return Ok(conclusion);
        }
    };
    conclusion.strange.extend(folder.strange.iter().map(ToString::to_string));
    let mut run = Run { folder: &folder, hulls: None, meshes: HashMap::new() };
    for (index, set) in folder.sets.iter().enumerate() {
        (reporting.progress)(index, folder.sets.len(), &set.name);
        match run.check(set, asker, reporting.examples_max) {
            Ok(report) => {
                conclusion.record_count += report.categories.values().map(|category| category.count).sum::<usize>();
                conclusion.mismatches.extend(known.compare(&report));
                print_set(reporting.out, &report)?;
                print_known(reporting.out, known, &report)?;
            }
            Err(error) => conclusion.strange.push(error.to_string()),
        }
    }
    Ok(conclusion)
}

fn print_known(out: &mut dyn Write, known: &Known, report: &SetReport) -> io::Result<()> {
    for name in report.categories.keys() {
        if let Some(entry) = known.entry(&report.name, name) {
            writeln!(out, "  known: {name}: {} ({})", entry.reason, entry.part)?;
        }
    }
    Ok(())
}

/// Questions that are asked in one go: enough that a call's own cost does not count.
const BATCH: usize = 256;

struct Run<'a> {
    folder: &'a Folder,
    hulls: Option<HullTable>,
    meshes: HashMap<String, Arc<TriangleMesh>>,
}

impl Run<'_> {
    fn check(&mut self, set: &SetFile, asker: &mut dyn Asker, examples_max: usize) -> Result<SetReport, SetError> {
        let mut report = SetReport { name: set.name.clone(), ..SetReport::default() };
        let mut judge = Judging { report: &mut report, asker, examples_max };
        match &set.kind {
            SetKind::Pairs => judge.cases(&pairs::read(&set.path, self.hulls()?)?),
            SetKind::Toi => judge.cases(&toi::read(&set.path, self.hulls()?)?),
            SetKind::Rays { mesh } => judge.cases(&rays::read(&set.path, &self.mesh(mesh)?)?),
            SetKind::SphereCast { mesh } => judge.cases(&casts::read_sphere_casts(&set.path, &self.mesh(mesh)?)?),
            SetKind::CapsuleMesh { mesh } => judge.cases(&casts::read_capsules(&set.path, &self.mesh(mesh)?)?),
            SetKind::MeshMesh { fixed, placed } => {
                let (fixed, placed) = (self.mesh(fixed)?, self.mesh(placed)?);
                judge.cases(&meshes::read(&set.path, &fixed, &placed)?);
            }
            SetKind::Motion { stem } => judge.cases(&motion::read(&set.path, self.folder, stem)?),
            SetKind::Stream { stem } => judge.stream(&stream::read(&set.path, self.folder, stem)?),
            SetKind::Aabb { stem } => judge.boxes(&aabb::read(&set.path, self.folder, stem)?),
        }
        Ok(report)
    }

    fn hulls(&mut self) -> Result<&HullTable, SetError> {
        if self.hulls.is_none() {
            let path = self.folder.hulls_path();
            self.hulls = Some(path.map_or_else(|| Ok(HullTable::default()), |path| HullTable::read(&path))?);
        }
        Ok(self.hulls.get_or_insert_default())
    }

    fn mesh(&mut self, name: &str) -> Result<Arc<TriangleMesh>, SetError> {
        if let Some(mesh) = self.meshes.get(name) {
            return Ok(Arc::clone(mesh));
        }
        let mesh = Arc::new(read_obj(&self.folder.mesh_path(name))?);
        self.meshes.insert(name.to_owned(), Arc::clone(&mesh));
        Ok(mesh)
    }
}

struct Judging<'a> {
    report: &'a mut SetReport,
    asker: &'a mut dyn Asker,
    examples_max: usize,
}

impl Judging<'_> {
    /// Asks records in batches and judges each. A batch's time is shared out evenly over its questions.
    fn cases<C: Case>(&mut self, cases: &[C]) {
        let mut rest = cases;
        while !rest.is_empty() {
            let (batch, questions) = take_batch(rest);
            rest = &rest[batch.len()..];
            let all: Vec<Question> = questions.iter().flatten().cloned().collect();
            let start = Instant::now();
            let replies = self.asker.ask(&all);
            let each = start.elapsed() / u32::try_from(all.len().max(1)).unwrap_or(u32::MAX);
            let mut replies: &[Reply] = &replies;
            for (case, asked) in batch.iter().zip(&questions) {
                let count = asked.len();
                let (own, others) = replies.split_at(count);
                replies = others;
                let time = each * u32::try_from(count).unwrap_or(u32::MAX);
                self.add(case.category(), case.index(), case.judge(own), time);
            }
        }
    }

    fn stream(&mut self, frames: &[stream::Frame]) {
        match special::play(self.asker, frames) {
            Ok(outcomes) => {
                for (frame, outcome, time) in outcomes {
                    self.add("frame", frame, outcome, time);
                }
            }
            Err(reason) => {
                let mut outcome = super::Outcome::default();
                outcome.fault(super::FaultKind::Unanswered, reason);
                self.add("frame", 0, outcome, Duration::ZERO);
            }
        }
    }

    fn boxes(&mut self, set: &aabb::BoxSet) {
        let start = Instant::now();
        let found = self.asker.overlapping_boxes(set);
        let time = start.elapsed();
        match found {
            Ok(None) => self.report.note = Some("asked in crate mode only".to_owned()),
            Ok(Some(tally)) => self.add("pairs", 0, special::judge_boxes(set, Ok(tally)), time),
            Err(reason) => self.add("pairs", 0, special::judge_boxes(set, Err(reason)), time),
        }
    }

    fn add(&mut self, category: &str, index: u64, outcome: super::Outcome, time: Duration) {
        let report = self.report.categories.entry(category.to_owned()).or_default();
        report.add(index, outcome, time, self.examples_max);
    }
}

/// The next records of one category, up to a batch, and their questions.
fn take_batch<C: Case>(cases: &[C]) -> (&[C], Vec<Vec<Question>>) {
    let category = cases[0].category();
    let same = cases.iter().take_while(|case| case.category() == category).count();
    let batch = &cases[..same.min(BATCH)];
    (batch, batch.iter().map(Case::questions).collect())
}
