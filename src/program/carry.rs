//! `export` and `import`: a world into a file, and back.
//!
//! The file holds the pieces of the export one after the other, each with its length before it, as protobuf writes several
//! messages into one file.

use std::fs::File;
use std::io::{BufReader, BufWriter, Read, Write};
use std::path::PathBuf;
use std::time::Duration;

use calipers_client::proto::{self, world_piece::Piece};
use clap::Args;
use prost::Message;
use tokio::sync::mpsc;
use tokio_stream::wrappers::ReceiverStream;

use super::Failure;
use super::print::count;
use super::target::Target;

/// Time for the server to be reached; the world itself takes as long as it takes.
const DEADLINE: Duration = Duration::from_secs(10);
/// Largest piece, as the largest message of the server.
const PIECE_BYTES: u64 = 4 << 20;
/// Pieces that wait for the network.
const UNSENT_PIECES: usize = 2;

/// Keeps a world in a file.
#[derive(Debug, Args)]
#[command(
    after_help = "The file holds one tick, complete in itself: shapes, geometries, settings, time. It appears when it is whole.\n\n\
                  Example: calipers export arena.world --session arena"
)]
pub(crate) struct Export {
    /// The file
    #[arg(value_name = "FILE")]
    file: PathBuf,
    /// The tick, if not the newest; the world's history must still hold it
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    tick: Option<u64>,
    #[command(flatten)]
    target: Target,
}

/// Fills an empty world from a file.
#[derive(Debug, Args)]
#[command(
    after_help = "All or nothing: a file that is damaged or torn changes nothing. The world goes on from the tick of the file.\n\n\
                  Example: calipers import arena.world --session copy"
)]
pub(crate) struct Import {
    /// The file, as `calipers export` wrote it
    #[arg(value_name = "FILE")]
    file: PathBuf,
    #[command(flatten)]
    target: Target,
}

impl Export {
    pub(crate) async fn run(self, out: &mut impl Write) -> Result<(), Failure> {
        let name = self.file.display();
        let client = self.target.connect(DEADLINE).await?;
        let read_at =
            self.tick.map(|tick| proto::ReadAt { at: Some(proto::read_at::At::Tick(tick)), tick_fraction: 0.0 });
        let mut pieces = client.export_world(read_at).await?;
        let mut part = self.file.clone().into_os_string();
        part.push(".part");
        let cannot = |error: std::io::Error| Failure::new(format!("{name} cannot be written: {error}"));
        let mut file = BufWriter::new(File::create(&part).map_err(cannot)?);
        let mut header = proto::WorldHeader::default();
        let mut is_whole = false;
        while let Some(response) = pieces.message().await.map_err(calipers_client::Error::from)? {
            let piece = response.piece.unwrap_or_default();
            file.write_all(&piece.encode_length_delimited_to_vec()).map_err(cannot)?;
            match piece.piece {
                Some(Piece::Header(first)) => header = first,
                Some(Piece::End(_)) => is_whole = true,
                Some(Piece::Geometry(_) | Piece::Shapes(_)) | None => {}
            }
        }
        if !is_whole {
            return Err(Failure::new("the server ended the export before its end; export again"));
        }
        let file = file.into_inner().map_err(|error| cannot(error.into_error()))?;
        file.sync_all().map_err(cannot)?;
        std::fs::rename(&part, &self.file).map_err(cannot)?;
        let (shapes, geometries) = (count(header.shape_count, "shape"), header.geometry_count);
        writeln!(out, "{name}: tick {}, {shapes}, {geometries} geometries by id", header.tick)?;
        Ok(())
    }
}

impl Import {
    pub(crate) async fn run(self, out: &mut impl Write) -> Result<(), Failure> {
        let client = self.target.connect(DEADLINE).await?;
        let name = self.file.display().to_string();
        let file = File::open(&self.file).map_err(|error| Failure::new(format!("{name} cannot be read: {error}")))?;
        let (pieces, unsent) = mpsc::channel(UNSENT_PIECES);
        let reading = tokio::task::spawn_blocking(move || {
            let mut file = BufReader::new(file);
            while let Some(piece) = next_piece(&mut file)? {
                // A server that refuses takes no more; why is in its answer.
                if pieces.blocking_send(piece).is_err() {
                    break;
                }
            }
            Ok::<_, String>(())
        });
        let answer = client.import_world(ReceiverStream::new(unsent)).await;
        reading.await?.map_err(|why| Failure::new(format!("{name} is no whole export: {why}; nothing is changed")))?;
        let answer = answer?;
        writeln!(
            out,
            "{} at tick {}, content {}",
            count(answer.shape_count, "shape"),
            answer.tick,
            answer.content_hash
        )?;
        Ok(())
    }
}

/// The pieces of a file, all of them.
#[cfg(feature = "measure")]
pub(super) fn pieces(path: &std::path::Path) -> Result<Vec<proto::WorldPiece>, Failure> {
    let name = path.display();
    let file = File::open(path).map_err(|error| Failure::new(format!("{name} cannot be read: {error}")))?;
    let mut file = BufReader::new(file);
    let all: Result<Vec<_>, String> = std::iter::from_fn(|| next_piece(&mut file).transpose()).collect();
    all.map_err(|why| Failure::new(format!("{name} is no whole export: {why}")))
}

/// The next piece of a file; `None` at its end.
fn next_piece(file: &mut impl Read) -> Result<Option<proto::WorldPiece>, String> {
    let Some(length) = next_length(file)? else { return Ok(None) };
    if length > PIECE_BYTES {
        return Err(format!("a piece of {length} bytes is longer than any"));
    }
    let mut bytes = Vec::new();
    let found = file.take(length).read_to_end(&mut bytes).map_err(|error| error.to_string())? as u64;
    if found < length {
        return Err(format!("it ends within a piece, after {found} of {length} bytes"));
    }
    proto::WorldPiece::decode(bytes.as_slice()).map(Some).map_err(|error| error.to_string())
}

/// The length before a piece: seven bits in each byte, the lowest first.
fn next_length(file: &mut impl Read) -> Result<Option<u64>, String> {
    let mut length = 0;
    for place in 0..5 {
        let mut byte = [0];
        if file.read(&mut byte).map_err(|error| error.to_string())? == 0 {
            return if place == 0 { Ok(None) } else { Err("it ends within the length of a piece".to_owned()) };
        }
        length |= u64::from(byte[0] & 0x7F) << (7 * place);
        if byte[0] < 0x80 {
            return Ok(Some(length));
        }
    }
    Err("a length has more than five bytes".to_owned())
}
