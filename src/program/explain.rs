//! `explain`: asks a question again that was kept in a file, and tells what was done.

use std::io::Write;
use std::path::PathBuf;

use calipers::replay::{ask_again, bare};
use clap::Args;
use prost::Message;

use super::Failure;
use super::{account, replay_file};

/// Asks a question again that was kept in a file.
#[derive(Debug, Args)]
#[command(
    after_help = "The file is what WorldService/Explain answers: a question, the shapes and geometries that its answer depends \
                  on, and the answer; as JSON (the output of grpcurl as it is) or as protobuf bytes, of the answer or of the \
                  replay in it. No server is asked.\n\n\
                  The exit code is 0 if the answer comes out the same, byte for byte, and 1 if it does not, or the file cannot \
                  be read.\n\n\
                  Example:\n  \
                  grpcurl -plaintext -d '{\"question\":{\"raycast\":{\"direction\":{\"z\":1}}}}' localhost:7070 \
                  calipers.v1.WorldService/Explain > ray.json\n  \
                  calipers explain ray.json"
)]
pub(crate) struct Explain {
    /// What Explain answered
    #[arg(value_name = "FILE")]
    file: PathBuf,
}

impl Explain {
    pub(crate) async fn run(self, out: &mut impl Write) -> Result<(), Failure> {
        let replay = replay_file::read(&self.file)?;
        let again = tokio::task::block_in_place(|| ask_again(&replay));
        let again = again.map_err(|error| Failure::new(format!("{}: {error}", self.file.display())))?;
        writeln!(out, "{}", account::of(&replay, &again))?;
        let [then, now] = [replay.answer.unwrap_or_default(), again].map(|answer| bare(answer).encode_to_vec());
        if then == now {
            writeln!(out, "asked again: the same answer, byte for byte ({} bytes)", now.len())?;
            return Ok(());
        }
        let first = then.iter().zip(&now).position(|(then, now)| then != now).unwrap_or(then.len().min(now.len()));
        Err(Failure::new(format!(
            "asked again, the answer is another: {} bytes then, {} now, the first difference is at byte {first}; it was \
             answered by calipers {}, this is {}",
            then.len(),
            now.len(),
            replay.program,
            env!("CARGO_PKG_VERSION"),
        )))
    }
}
