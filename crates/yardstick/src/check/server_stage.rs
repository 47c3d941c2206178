//! A session of a server in which a stream is played through the edit stream, one commit for each frame.

use std::collections::HashMap;

use calipers_client::{Client, EditWriter, Error, ask, edit, proto, shape};
use proto::answer;
use tokio::runtime::Runtime;

use super::{
    ContactAnswer, Stage,
    ask::Neighbors,
    server_asker::{CONTACTS_MAX, contact, near, wire_geometry},
    special::{actor_form, shape_id},
};
use crate::sets::stream::{ActorKind, Change};

/// A world on a server.
pub(super) struct ServerStage<'a> {
    runtime: &'a Runtime,
    client: Client,
    writer: EditWriter,
    tick: u64,
    kinds: HashMap<u64, ActorKind>,
}

/// Most neighbours the API lists.
const NEIGHBORS_MAX: u32 = 4096;

impl<'a> ServerStage<'a> {
    /// Makes a session and opens its edit stream.
    ///
    /// # Errors
    /// The server gives no session or no stream.
    pub(super) fn open(runtime: &'a Runtime, outside: &Client) -> Result<Self, String> {
        let opened = runtime.block_on(async {
            let client = outside.open_session(proto::CreateSessionRequest::default()).await?;
            let writer = EditWriter::open(&client, "yardstick").await?;
            Ok((client, writer))
        });
        let (client, writer) = opened.map_err(|error: Error| error.to_string())?;
        Ok(Self { runtime, client, writer, tick: 0, kinds: HashMap::new() })
    }

    fn edit(&mut self, change: &Change) -> proto::Edit {
        match *change {
            Change::Remove { actor } => {
                self.kinds.remove(&actor);
                edit::remove([shape_id(actor)])
            }
            Change::Move { actor, kind, pose } => {
                let (position, rotation) = (pose.position.to_array(), pose.rotation.to_array());
                if self.kinds.insert(actor, kind) == Some(kind) {
                    return edit::move_and_turn(shape_id(actor), position, rotation);
                }
                let shape = shape::of(shape_id(actor), wire_geometry(&actor_form(kind))).user_data(actor);
                shape.at(position).rotated(rotation).insert()
            }
        }
    }

    fn options(&self) -> proto::QueryOptions {
        proto::QueryOptions { read_at: ask::seeing_tick(self.tick).read_at, ..*ask::exactly() }
    }
}

impl Stage for ServerStage<'_> {
    fn tick(&mut self, changes: &[Change]) -> Result<(), String> {
        let edits: Vec<proto::Edit> = changes.iter().map(|change| self.edit(change)).collect();
        let flushed = self.runtime.block_on(async {
            self.writer.commit(edits).await?;
            self.writer.flush().await
        });
        self.tick = flushed.map_err(|error| error.to_string())?;
        match self.writer.take_report().problems.first() {
            Some(problem) => Err(format!("{}: {}", problem.reason, problem.message)),
            None => Ok(()),
        }
    }

    fn neighbors(&mut self, actors: &[u64], limit: f64) -> Vec<Neighbors> {
        let question = |&actor: &u64| {
            proto::question::Question::from(proto::DistanceRequest {
                max_distance: Some(limit),
                max_hits: NEIGHBORS_MAX,
                ..ask::distance(ask::shape(shape_id(actor)))
            })
        };
        let request =
            proto::BatchRequest { options: Some(self.options().into()), ..ask::batch(actors.iter().map(question)) };
        match self.runtime.block_on(self.client.batch(request)) {
            Ok(response) if response.answers.len() == actors.len() => {
                response.answers.into_iter().map(|answer| neighbors_of(answer.answer)).collect()
            }
            Ok(_) => vec![Err("the batch has not one answer for each question".to_owned()); actors.len()],
            Err(error) => vec![Err(error.to_string()); actors.len()],
        }
    }

    fn contacts(&mut self, actor: u64) -> Result<Vec<(u64, ContactAnswer)>, String> {
        let request = proto::PenetrationRequest {
            max_contacts: CONTACTS_MAX,
            options: Some(self.options().into()),
            ..ask::penetration(ask::shape(shape_id(actor)))
        };
        let response = self.runtime.block_on(self.client.penetration(request)).map_err(|error| error.to_string())?;
        response.contacts.iter().map(|hit| Ok((hit.user_data, contact(hit)?))).collect()
    }
}

fn neighbors_of(answer: Option<answer::Answer>) -> Neighbors {
    match answer {
        Some(answer::Answer::Distance(found)) => found.hits.iter().map(|hit| Ok((hit.user_data, near(hit)?))).collect(),
        Some(answer::Answer::Problem(problem)) => Err(format!("{}: {}", problem.reason, problem.message)),
        _ => Err("the answer is of another kind than the question".to_owned()),
    }
}

impl Drop for ServerStage<'_> {
    fn drop(&mut self) {
        // The session ends by its lease anyway if this does not arrive.
        let _ = self.runtime.block_on(self.client.delete_session(proto::DeleteSessionRequest::default()));
    }
}
