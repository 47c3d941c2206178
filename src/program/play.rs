//! `play`: drives a world from a recorded trace of moves, one tick for each frame.

use std::collections::{HashMap, HashSet};
use std::io::Write;
use std::path::PathBuf;
use std::str::FromStr;
use std::time::{Duration, Instant};

use calipers_client::{EditWriter, edit, proto, shape};
use clap::Args;
use indicatif::{ProgressBar, ProgressStyle};

use super::Failure;
use super::input::Form;
use super::target::Target;
use super::trace::{Event, Frame, Row, Trace};

/// Calls beside the stream are given up after this.
const DEADLINE: Duration = Duration::from_secs(10);

/// Drives a world from a recorded trace of moves.
#[derive(Debug, Args)]
#[command(
    after_help = "A trace is a csv file (or csv.gz) with the columns frame, time, op, actor, kind, px, py, pz, qx, qy, \
                  qz, qw; op is N (appears), M (moves) or D (gone). An actor is the shape of its number. Kinds that are \
                  not given, and rows without a rotation, are passed over.\n\n\
                  Example: calipers play match.csv.gz --kind car=box:59,42,18 --kind ball=sphere:91.25 --speed max"
)]
pub(crate) struct Play {
    /// The trace
    #[arg(value_name = "TRACE.csv[.gz]")]
    file: PathBuf,
    /// The form of a kind of actors: NAME=sphere:RADIUS, NAME=box:HX,HY,HZ, NAME=capsule:HALF_HEIGHT,RADIUS,
    /// NAME=cylinder:HALF_HEIGHT,RADIUS, NAME=cone:HALF_HEIGHT,RADIUS or NAME=ellipsoid:RX,RY,RZ
    #[arg(long = "kind", value_name = "NAME=FORM", required = true)]
    kinds: Vec<Kind>,
    /// Times real time, or "max" for as fast as the server takes it
    #[arg(long, value_name = "FACTOR|max", default_value = "1", allow_hyphen_values = true)]
    speed: Speed,
    /// Begins again at the end, until interrupted
    #[arg(long = "loop")]
    again: bool,
    /// Name of the writer; a second one of the same name takes over from the first
    #[arg(long, value_name = "NAME", default_value = "play")]
    writer: String,
    #[command(flatten)]
    target: Target,
}

/// A kind of actors and its form.
#[derive(Clone, Debug)]
struct Kind {
    name: String,
    form: Form,
}

impl FromStr for Kind {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (name, form) = text.split_once('=').ok_or("a kind is NAME=FORM, such as ball=sphere:0.5")?;
        Ok(Self { name: name.to_owned(), form: form.parse()? })
    }
}

/// How fast a trace is played.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Speed {
    /// Times real time.
    Factor(f64),
    /// As fast as the server takes it.
    Max,
}

impl FromStr for Speed {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        if text == "max" {
            return Ok(Self::Max);
        }
        match text.parse::<f64>() {
            Ok(factor) if factor > 0.0 && factor.is_finite() => Ok(Self::Factor(factor)),
            _ => Err("a speed is a number above 0, such as 0.5, or max".to_owned()),
        }
    }
}

/// What was done so far.
#[derive(Clone, Copy, Debug, Default)]
struct Tally {
    frame_count: u64,
    edit_count: u64,
}

impl Play {
    pub(crate) async fn run(self, out: &mut impl Write) -> Result<(), Failure> {
        // A trace that cannot be read is told before anything is connected.
        let trace = Trace::open(&self.file)?;
        let client = self.target.connect(DEADLINE).await?;
        let mut writer = EditWriter::open(&client, &self.writer).await?;
        let started = Instant::now();
        let mut tally = Tally::default();
        // A stop is asked for by the interrupt; what was sent until then is still waited for.
        let played = tokio::select! {
            played = self.play(trace, &mut writer, &mut tally) => played,
            interrupt = tokio::signal::ctrl_c() => Ok(interrupt?),
        };
        played?;
        let tick = writer.flush().await?;
        let seconds = started.elapsed().as_secs_f64();
        let Tally { frame_count, edit_count } = tally;
        let rate = edit_count as f64 / seconds.max(1e-9);
        write!(out, "{frame_count} frames, one tick each, the last is tick {tick}; ")?;
        writeln!(out, "{edit_count} edits in {seconds:.2} s, {rate:.0} edits/s")?;
        told(&writer)
    }

    /// Plays once, or again and again.
    async fn play(&self, mut trace: Trace, writer: &mut EditWriter, tally: &mut Tally) -> Result<(), Failure> {
        let style = ProgressStyle::with_template("{spinner} {msg}")?;
        let progress = ProgressBar::new_spinner().with_style(style);
        let mut stage = Stage::new(&self.kinds);
        loop {
            let mut pace = Pace::new(self.speed);
            while let Some(frame) = trace.next_frame()? {
                pace.wait(frame.time).await;
                let edits = stage.edits(&frame)?;
                tally.edit_count += edits.len() as u64;
                tally.frame_count += 1;
                writer.commit(edits).await?;
                progress.set_message(format!("{} frames, {:.1} s", tally.frame_count, frame.time));
                progress.tick();
            }
            if !self.again {
                progress.finish_and_clear();
                return Ok(());
            }
            let left = stage.leave();
            tally.edit_count += u64::from(left.is_some());
            writer.commit(left).await?;
            trace = Trace::open(&self.file)?;
        }
    }
}

/// Edits that the server left out are a failure, told by the first of them.
fn told(writer: &EditWriter) -> Result<(), Failure> {
    let report = writer.take_report();
    let Some(first) = report.problems.first() else {
        return Ok(());
    };
    let count = report.problems.len() as u64 + report.left_out_count;
    Err(Failure::new(format!(
        "the server left {count} edits out; the first, in message {}: {}",
        first.sequence, first.message
    )))
}

/// Who is there, and what each frame changes.
#[derive(Debug)]
struct Stage {
    forms: HashMap<String, proto::Geometry>,
    present: HashSet<u64>,
}

impl Stage {
    fn new(kinds: &[Kind]) -> Self {
        let forms = kinds.iter().map(|kind| (kind.name.clone(), kind.form.geometry())).collect();
        Self { forms, present: HashSet::new() }
    }

    /// The edits of a frame.
    fn edits(&mut self, frame: &Frame) -> Result<Vec<proto::Edit>, Failure> {
        frame.rows.iter().filter_map(|row| self.edit(row).transpose()).collect()
    }

    /// An actor is put in by its first move after it appeared, because only a move says where it is.
    fn edit(&mut self, row: &Row) -> Result<Option<proto::Edit>, Failure> {
        let id = row.actor;
        let Event::Moves { position, rotation } = row.event else {
            return Ok(self.present.remove(&id).then(|| edit::remove([id])));
        };
        let (Some(form), Some(rotation)) = (self.forms.get(&row.kind), rotation) else {
            return Ok(None);
        };
        if id == 0 {
            return Err(Failure::new("the trace has an actor 0, and no shape can have the id 0"));
        }
        let (position, rotation) = (position.map(f64::from), rotation.map(f64::from));
        if self.present.insert(id) {
            Ok(Some(shape::of(id, form.clone()).at(position).rotated(rotation).insert()))
        } else {
            Ok(Some(edit::move_and_turn(id, position, rotation)))
        }
    }

    /// Everybody goes.
    fn leave(&mut self) -> Option<proto::Edit> {
        let gone: Vec<u64> = self.present.drain().collect();
        (!gone.is_empty()).then(|| edit::remove(gone))
    }
}

/// Waits until a frame is due.
#[derive(Debug)]
struct Pace {
    speed: Speed,
    /// When the first frame was played, and its time in the trace.
    start: Option<(tokio::time::Instant, f64)>,
}

impl Pace {
    fn new(speed: Speed) -> Self {
        Self { speed, start: None }
    }

    async fn wait(&mut self, time: f64) {
        let Speed::Factor(factor) = self.speed else { return };
        let (started, first_time) = *self.start.get_or_insert_with(|| (tokio::time::Instant::now(), time));
        // A trace whose time goes back, or leaps beyond all measure, is played without waiting there.
        if let Ok(due) = Duration::try_from_secs_f64((time - first_time) / factor) {
            tokio::time::sleep_until(started + due).await;
        }
    }
}

#[cfg(test)]
mod tests {
    use calipers_client::proto::edit::Op;

    use super::*;

    fn row(actor: u64, kind: &str, event: Event) -> Row {
        Row { actor, kind: kind.to_owned(), event }
    }

    fn moves() -> Event {
        Event::Moves { position: [1.0, 2.0, 3.0], rotation: Some([0.0, 0.0, 0.0, 1.0]) }
    }

    fn ops(stage: &mut Stage, rows: Vec<Row>) -> Vec<&'static str> {
        let edits = stage.edits(&Frame { time: 0.0, rows }).expect("the rows are right");
        let name = |edit: &proto::Edit| match edit.op {
            Some(Op::Insert(_)) => "insert",
            Some(Op::Move(_)) => "move",
            Some(Op::Remove(_)) => "remove",
            _ => "other",
        };
        edits.iter().map(name).collect()
    }

    #[test]
    fn an_actor_is_there_from_its_first_move_to_its_end() {
        let mut stage = Stage::new(&["ball=sphere:1".parse().expect("a kind")]);
        assert_eq!(ops(&mut stage, vec![row(5, "ball", Event::Appears)]), Vec::<&str>::new());
        assert_eq!(ops(&mut stage, vec![row(5, "ball", moves()), row(5, "ball", moves())]), ["insert", "move"]);
        assert_eq!(ops(&mut stage, vec![row(5, "", Event::Gone), row(5, "", Event::Gone)]), ["remove"]);
        assert_eq!(ops(&mut stage, vec![row(5, "ball", moves())]), ["insert"]);
        // An id used again while it is there begins anew.
        assert_eq!(
            ops(&mut stage, vec![row(5, "ball", Event::Appears), row(5, "ball", moves())]),
            ["remove", "insert"]
        );
    }

    #[test]
    fn other_kinds_and_rows_without_rotation_are_passed_over() {
        let mut stage = Stage::new(&["ball=sphere:1".parse().expect("a kind")]);
        let unturned = Event::Moves { position: [0.0; 3], rotation: None };
        assert_eq!(ops(&mut stage, vec![row(1, "car", moves()), row(2, "ball", unturned)]), Vec::<&str>::new());
    }

    #[test]
    fn a_wrong_kind_or_speed_gets_a_sentence() {
        assert!("ball".parse::<Kind>().unwrap_err().contains("NAME=FORM"));
        assert!("ball=cube:1".parse::<Kind>().unwrap_err().contains("sphere:RADIUS"));
        for wrong in ["0", "-1", "fast", "inf", "nan"] {
            assert!(wrong.parse::<Speed>().unwrap_err().contains("above 0"));
        }
    }
}
