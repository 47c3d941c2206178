//! Reads a recorded trace of moves, frame by frame.
//!
//! Columns are found by their names in the first line: `frame`, `op`, `actor`, `kind`, `px py pz` and `qx qy qz qw`
//! (x, y, z, w); others are passed over. `op` is N (the actor appears; it counts from its first M on), M (it moves) or
//! D (it is gone). Ids are used again. Numbers are rounded to single precision; a rotation of zeros is none.

use std::fs::File;
use std::io::{BufReader, Read};
use std::path::{Path, PathBuf};

use csv::StringRecord;
use flate2::bufread::MultiGzDecoder;

/// All that happens in one frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Frame {
    /// Seconds since the trace began.
    pub(crate) time: f64,
    /// In the order of the file.
    pub(crate) rows: Vec<Row>,
}

/// What happens to one actor.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Row {
    pub(crate) actor: u64,
    pub(crate) kind: String,
    pub(crate) event: Event,
}

#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Event {
    Appears,
    /// `rotation` is a quaternion x, y, z, w; none where the row gives none.
    Moves {
        position: [f32; 3],
        rotation: Option<[f32; 4]>,
    },
    Gone,
}

/// Why a trace cannot be read.
#[derive(Debug, thiserror::Error)]
pub(crate) enum TraceError {
    #[error("{} cannot be read: {source}", path.display())]
    Open { path: PathBuf, source: std::io::Error },
    #[error("{}: {source}", path.display())]
    Csv { path: PathBuf, source: csv::Error },
    #[error("{} has no column {name:?}; a trace has frame, time, op, actor, kind, px, py, pz, qx, qy, qz, qw", path.display())]
    Column { path: PathBuf, name: &'static str },
    #[error("{}, line {line}: {name} is {found:?}, it must be {wanted}", path.display())]
    Field { path: PathBuf, line: u64, name: &'static str, found: String, wanted: &'static str },
}

/// Names of the columns, in the order of their places.
const COLUMNS: [&str; 12] = ["frame", "time", "op", "actor", "kind", "px", "py", "pz", "qx", "qy", "qz", "qw"];

/// A trace that is being read.
pub(crate) struct Trace {
    path: PathBuf,
    records: csv::Reader<Box<dyn Read + Send>>,
    /// Where each of `COLUMNS` is.
    places: [usize; COLUMNS.len()],
    /// The row after the frame returned last: frame number, time, row.
    ahead: Option<(u64, f64, Row)>,
}

impl Trace {
    /// Opens a trace; one whose name ends in `.gz` is unpacked on the way.
    ///
    /// # Errors
    /// A file that cannot be read, or that lacks a column.
    pub(crate) fn open(path: &Path) -> Result<Self, TraceError> {
        let file = File::open(path).map_err(|source| TraceError::Open { path: path.to_owned(), source })?;
        let buffered = BufReader::new(file);
        let input: Box<dyn Read + Send> = match path.extension() {
            Some(extension) if extension == "gz" => Box::new(MultiGzDecoder::new(buffered)),
            _ => Box::new(buffered),
        };
        let mut records = csv::Reader::from_reader(input);
        let header = records.headers().map_err(|source| TraceError::Csv { path: path.to_owned(), source })?.clone();
        let mut places = [0; COLUMNS.len()];
        for (place, name) in places.iter_mut().zip(COLUMNS) {
            let found = header.iter().position(|column| column.trim() == name);
            *place = found.ok_or_else(|| TraceError::Column { path: path.to_owned(), name })?;
        }
        let mut trace = Self { path: path.to_owned(), records, places, ahead: None };
        trace.ahead = trace.next_row()?;
        Ok(trace)
    }

    /// The next frame; none at the end.
    ///
    /// # Errors
    /// A row that is not as it must be, with its line.
    pub(crate) fn next_frame(&mut self) -> Result<Option<Frame>, TraceError> {
        let Some((number, time, first)) = self.ahead.take() else {
            return Ok(None);
        };
        let mut frame = Frame { time, rows: vec![first] };
        loop {
            match self.next_row()? {
                Some((of_frame, _, row)) if of_frame == number => frame.rows.push(row),
                next => {
                    self.ahead = next;
                    return Ok(Some(frame));
                }
            }
        }
    }

    fn next_row(&mut self) -> Result<Option<(u64, f64, Row)>, TraceError> {
        let mut record = StringRecord::new();
        let read = self.records.read_record(&mut record);
        if !read.map_err(|source| TraceError::Csv { path: self.path.clone(), source })? {
            return Ok(None);
        }
        let frame = self.field(&record, "frame", "a whole number")?;
        let time = self.field(&record, "time", "a number of seconds")?;
        let actor = self.field(&record, "actor", "a whole number")?;
        let event = match self.text(&record, "op") {
            "N" => Event::Appears,
            "D" => Event::Gone,
            "M" => Event::Moves { position: self.triple(&record)?, rotation: self.rotation(&record)? },
            found => return Err(self.wrong(&record, "op", found, "N, M or D")),
        };
        Ok(Some((frame, time, Row { actor, kind: self.text(&record, "kind").to_owned(), event })))
    }

    fn triple(&self, record: &StringRecord) -> Result<[f32; 3], TraceError> {
        Ok([self.number(record, "px")?, self.number(record, "py")?, self.number(record, "pz")?])
    }

    fn rotation(&self, record: &StringRecord) -> Result<Option<[f32; 4]>, TraceError> {
        const NAMES: [&str; 4] = ["qx", "qy", "qz", "qw"];
        if NAMES.iter().all(|name| self.text(record, name).is_empty()) {
            return Ok(None);
        }
        let mut rotation = [0.0; 4];
        for (component, name) in rotation.iter_mut().zip(NAMES) {
            *component = self.number(record, name)?;
        }
        Ok((rotation != [0.0; 4]).then_some(rotation))
    }

    fn number(&self, record: &StringRecord, name: &'static str) -> Result<f32, TraceError> {
        let wanted = "a finite number of single precision";
        // Parsed in double precision and then rounded, because that is what a trace's format says: the two steps do not
        // always give what parsing straight to single precision gives.
        let number = self.field::<f64>(record, name, wanted)? as f32;
        if number.is_finite() { Ok(number) } else { Err(self.wrong(record, name, self.text(record, name), wanted)) }
    }

    fn field<T: std::str::FromStr>(
        &self,
        record: &StringRecord,
        name: &'static str,
        wanted: &'static str,
    ) -> Result<T, TraceError> {
        let text = self.text(record, name);
        text.parse().map_err(|_| self.wrong(record, name, text, wanted))
    }

    /// The field, or nothing where the row is too short to have it.
    fn text<'a>(&self, record: &'a StringRecord, name: &str) -> &'a str {
        let column = COLUMNS.iter().position(|column| *column == name);
        column.and_then(|column| record.get(self.places[column])).unwrap_or_default().trim()
    }

    fn wrong(&self, record: &StringRecord, name: &'static str, found: &str, wanted: &'static str) -> TraceError {
        let line = record.position().map_or(0, csv::Position::line);
        TraceError::Field { path: self.path.clone(), line, name, found: found.to_owned(), wanted }
    }
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use flate2::{Compression, write::GzEncoder};

    use super::*;

    const HEADER: &str = "frame,time,op,actor,kind,px,py,pz,qx,qy,qz,qw,sleep\n";

    fn open_text(name: &str, bytes: &[u8]) -> Result<Trace, TraceError> {
        let path = std::env::temp_dir().join(format!("calipers-trace-{}-{name}", std::process::id()));
        std::fs::write(&path, bytes).expect("the folder for temporary files is writable");
        let trace = Trace::open(&path);
        std::fs::remove_file(&path).expect("the file was just written");
        trace
    }

    fn all_frames(mut trace: Trace) -> Result<Vec<Frame>, TraceError> {
        std::iter::from_fn(|| trace.next_frame().transpose()).collect()
    }

    #[test]
    fn rows_are_gathered_by_frame() {
        let text = format!("{HEADER}0,0.5,N,5,ball,,,,,,,,\n0,0.5,M,5,ball,0.1,2,3,0,0,0,1,\n4,0.75,D,5,,,,,,,,,\n");
        let frames = all_frames(open_text("rows.csv", text.as_bytes()).expect("it opens")).expect("it is whole");
        let row = |kind: &str, event| Row { actor: 5, kind: kind.to_owned(), event };
        let position = [0.1_f32, 2.0, 3.0];
        let moves = Event::Moves { position, rotation: Some([0.0, 0.0, 0.0, 1.0]) };
        assert_eq!(
            frames,
            [
                Frame { time: 0.5, rows: vec![row("ball", Event::Appears), row("ball", moves)] },
                Frame { time: 0.75, rows: vec![row("", Event::Gone)] },
            ]
        );
    }

    #[test]
    fn a_rotation_of_zeros_or_of_nothing_is_none() {
        for rotation in ["0,0,0,0", ",,,"] {
            let text = format!("{HEADER}0,0,M,1,car,1,2,3,{rotation},\n");
            let frames = all_frames(open_text("none.csv", text.as_bytes()).expect("it opens")).expect("it is whole");
            assert!(matches!(frames[0].rows[0].event, Event::Moves { rotation: None, .. }));
        }
    }

    #[test]
    fn packed_and_plain_traces_read_alike() {
        let text = format!("{HEADER}0,0,M,1,car,1,2,3,0,0,0,1,\n");
        let mut packed = GzEncoder::new(Vec::new(), Compression::default());
        packed.write_all(text.as_bytes()).expect("a vector takes all");
        let packed = packed.finish().expect("a vector takes all");
        let plain = all_frames(open_text("plain.csv", text.as_bytes()).expect("it opens")).expect("it is whole");
        // The packed file is removed while it is open, which is allowed where these tests run.
        let unpacked = all_frames(open_text("packed.csv.gz", &packed).expect("it opens")).expect("it is whole");
        assert_eq!(plain, unpacked);
    }

    #[test]
    fn a_wrong_row_is_told_with_its_line_and_column() {
        for (row, said) in [
            ("0,0,X,1,car,1,2,3,0,0,0,1,", "line 2: op is \"X\""),
            ("0,0,M,one,car,1,2,3,0,0,0,1,", "line 2: actor is \"one\""),
            ("0,0,M,1,car,1,nan,3,0,0,0,1,", "line 2: py is \"nan\""),
            ("0,0,M,1,car,1,2,3,0,0,,1,", "line 2: qz is \"\""),
        ] {
            let sentence = open_text("wrong.csv", format!("{HEADER}{row}\n").as_bytes()).err().map(|e| e.to_string());
            assert!(sentence.as_ref().is_some_and(|sentence| sentence.contains(said)), "{sentence:?}");
        }
        let sentence = open_text("column.csv", b"frame,time,op\n").err().map(|error| error.to_string());
        assert!(sentence.is_some_and(|sentence| sentence.contains("no column \"actor\"")));
    }
}
