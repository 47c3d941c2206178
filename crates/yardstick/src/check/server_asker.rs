//! Asks a running server over gRPC, through the client crate, in sessions of its own that it deletes afterwards.

use std::{collections::HashMap, sync::Arc};

use calipers_client::{Client, Error, ask, geometry, proto, shape};
use glam::{DQuat, DVec3};
use proto::{answer, question::Question as Asked};
use tokio::runtime::Runtime;

use super::{
    Answer, Asker, Claim, ContactAnswer, ImpactAnswer, Near, PairTally, Question, RayAnswer, Reply, Stage, Verdict,
    server_stage::ServerStage,
};
use crate::sets::{Form, Placed, Pose, aabb::BoxSet, toi::Motion};

/// Asks a server. Pairs are asked form against form, in batches; rays at a mesh that stands in the session's world.
pub struct ServerAsker {
    runtime: Runtime,
    client: Client,
    registered: HashMap<usize, (Form, String)>,
    standing: Option<(usize, Pose)>,
    outside: Client,
}

/// The shape that rays are cast at.
const TARGET: u64 = 1;

/// The server's limit of one message, and so of a geometry that is sent whole, with room for the rest of the message.
const MESSAGE_BYTES_MAX: usize = (4 << 20) - 4096;

impl ServerAsker {
    /// Connects and makes a session.
    ///
    /// # Errors
    /// The address is wrong, nothing answers there, or the server gives no session.
    pub fn connect(address: &str) -> Result<Self, String> {
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build();
        let runtime = runtime.map_err(|error| error.to_string())?;
        let (outside, client) = runtime
            .block_on(async {
                let outside = Client::connect(address).await?;
                let client = outside.open_session(proto::CreateSessionRequest::default()).await?;
                Ok((outside, client))
            })
            .map_err(|error: Error| error.to_string())?;
        Ok(Self { runtime, client, registered: HashMap::new(), standing: None, outside })
    }

    /// The wire's form of a geometry. Hulls and meshes are registered once and named by id: the key is the address of
    /// the shared points, which the value keeps alive.
    fn geometry(&mut self, form: &Form) -> Result<proto::Geometry, String> {
        let address = match form {
            Form::Hull(cloud) => Arc::as_ptr(cloud).addr(),
            Form::Mesh(mesh) => Arc::as_ptr(mesh).addr(),
            _ => return Ok(wire_geometry(form)),
        };
        if let Some((_, id)) = self.registered.get(&address) {
            return Ok(geometry::registered(id));
        }
        let wire = wire_geometry(form);
        let info = self.runtime.block_on(register(&self.client, wire)).map_err(|error| error.to_string())?;
        self.registered.insert(address, (form.clone(), info.geometry_id.clone()));
        Ok(geometry::registered(info.geometry_id))
    }

    fn subject(&mut self, placed: &Placed) -> Result<proto::Subject, String> {
        let geometry = self.geometry(&placed.form)?;
        let Pose { position, rotation } = placed.pose;
        Ok(ask::form_turned(geometry, position.to_array(), rotation.to_array()))
    }

    /// Writes a question for the wire.
    fn wire_question(&mut self, question: &Question) -> Result<Asked, String> {
        match question {
            Question::Distance { a, b } => {
                let against = Some(self.subject(b)?.into());
                Ok(proto::DistanceRequest { against, ..ask::distance(self.subject(a)?) }.into())
            }
            Question::Overlap { a, b } => {
                let against = Some(self.subject(b)?.into());
                Ok(proto::OverlapRequest { against, ..ask::overlap(self.subject(a)?) }.into())
            }
            Question::Penetration { a, b, max_gap } => Ok(Asked::from(proto::PenetrationRequest {
                against: Some(self.subject(b)?.into()),
                max_gap: *max_gap,
                max_contacts: CONTACTS_MAX,
                ..ask::penetration(self.subject(a)?)
            })),
            Question::Impact { a, motion_a, b, motion_b } => Ok(Asked::from(proto::TimeOfImpactRequest {
                subject: Some(self.subject(a)?),
                end: Some(end_of(a, motion_a)?),
                against: Some(self.subject(b)?.into()),
                against_end: Some(end_of(b, motion_b)?),
                ..proto::TimeOfImpactRequest::default()
            })),
            Question::Raycast { origin, direction, max_distance, .. } => Ok(Asked::from(proto::RaycastRequest {
                max_distance: max_distance.is_finite().then_some(*max_distance),
                ..ask::ray(origin.to_array(), direction.to_array())
            })),
        }
    }

    /// Puts what rays are cast at where the question wants it.
    fn stand(&mut self, target: &Placed) -> Result<(), String> {
        let Form::Mesh(mesh) = &target.form else {
            return Err("rays are cast at meshes only".to_owned());
        };
        let wanted = (Arc::as_ptr(mesh).addr(), target.pose);
        if self.standing == Some(wanted) {
            return Ok(());
        }
        let geometry = self.geometry(&target.form)?;
        let Pose { position, rotation } = target.pose;
        let shape = shape::of(TARGET, geometry).at(position.to_array()).rotated(rotation.to_array()).fixed();
        self.runtime.block_on(self.client.edit([shape.insert()])).map_err(|error| error.to_string())?;
        self.standing = Some(wanted);
        Ok(())
    }

    /// Asks questions that agree on where the target of rays stands.
    fn ask_batch(&mut self, questions: &[Question]) -> Vec<Reply> {
        let target = questions.iter().find_map(|question| match question {
            Question::Raycast { target, .. } => Some(target),
            _ => None,
        });
        if let Some(reason) = target.and_then(|target| self.stand(target).err()) {
            return refuse(questions.len(), &reason);
        }
        let written: Vec<Result<Asked, String>> =
            questions.iter().map(|question| self.wire_question(question)).collect();
        let request = ask::batch(written.iter().filter_map(|asked| asked.clone().ok()));
        let request = proto::BatchRequest { options: Some(ask::exactly()), ..request };
        let mut answers = match self.runtime.block_on(self.client.batch(request)) {
            Ok(response) => response.answers.into_iter(),
            Err(error) => return refuse(questions.len(), &error.to_string()),
        };
        written.into_iter().map(|asked| asked.and_then(|_| read_answer(answers.next()))).collect()
    }
}

/// Most contacts the API lists.
pub(super) const CONTACTS_MAX: u32 = 4096;

fn refuse(count: usize, reason: &str) -> Vec<Reply> {
    vec![Err(reason.to_owned()); count]
}

impl Asker for ServerAsker {
    fn ask(&mut self, questions: &[Question]) -> Vec<Reply> {
        let same_target = |a: &Question, b: &Question| match (a, b) {
            (Question::Raycast { target: a, .. }, Question::Raycast { target: b, .. }) => a.pose == b.pose,
            _ => true,
        };
        let mut replies = Vec::with_capacity(questions.len());
        for batch in questions.chunk_by(same_target) {
            replies.extend(self.ask_batch(batch));
        }
        replies
    }

    fn stage(&mut self) -> Result<Box<dyn Stage + '_>, String> {
        Ok(Box::new(ServerStage::open(&self.runtime, &self.outside)?))
    }

    fn overlapping_boxes(&mut self, _set: &BoxSet) -> Result<Option<PairTally>, String> {
        Ok(None)
    }
}

impl Drop for ServerAsker {
    fn drop(&mut self) {
        // The session ends by its lease anyway if this does not arrive.
        let _ = self.runtime.block_on(self.client.delete_session(proto::DeleteSessionRequest::default()));
    }
}

/// Registers a geometry in one message, or in pieces if it is too large for one.
async fn register(client: &Client, geometry: proto::Geometry) -> Result<proto::GeometryInfo, Error> {
    let numbers = match &geometry.kind {
        Some(proto::geometry::Kind::Mesh(mesh)) => mesh.vertices.len() + mesh.indices.len(),
        Some(proto::geometry::Kind::Hull(hull)) => hull.points.len(),
        _ => 0,
    };
    if numbers * size_of::<f32>() < MESSAGE_BYTES_MAX {
        return client.register(geometry).await;
    }
    let pieces = upload_pieces(client.session(), geometry);
    let response = client.geometries().upload_geometry(tokio_stream::iter(pieces)).await?.into_inner();
    Ok(response.geometry.unwrap_or_default())
}

/// Numbers in one chunk: well below the limit of 1 MiB.
const CHUNK_NUMBERS: usize = 1 << 17;

fn upload_pieces(session: &str, mut geometry: proto::Geometry) -> Vec<proto::UploadGeometryRequest> {
    use proto::geometry_piece::Piece;
    let (values, indices) = match &mut geometry.kind {
        Some(proto::geometry::Kind::Mesh(mesh)) => {
            (std::mem::take(&mut mesh.vertices), std::mem::take(&mut mesh.indices))
        }
        Some(proto::geometry::Kind::Hull(hull)) => (std::mem::take(&mut hull.points), Vec::new()),
        _ => (Vec::new(), Vec::new()),
    };
    let header = Piece::Header(proto::GeometryHeader {
        geometry: Some(geometry),
        value_count: values.len() as u64,
        index_count: indices.len() as u64,
    });
    let of_values = values.chunks(CHUNK_NUMBERS).map(|values| (values.to_vec(), Vec::new()));
    let of_indices = indices.chunks(CHUNK_NUMBERS).map(|indices| (Vec::new(), indices.to_vec()));
    let chunks =
        of_values.chain(of_indices).map(|(values, indices)| Piece::Chunk(proto::GeometryChunk { values, indices }));
    let request = |piece| proto::UploadGeometryRequest {
        session: session.to_owned(),
        piece: Some(proto::GeometryPiece { piece: Some(piece) }),
    };
    std::iter::once(header).chain(chunks).map(request).collect()
}

pub(super) fn wire_geometry(form: &Form) -> proto::Geometry {
    match form {
        Form::Sphere { radius } => geometry::sphere(*radius),
        Form::Capsule { half_height, radius } => geometry::capsule(*half_height, *radius),
        Form::Cuboid { half_extents } => geometry::cuboid(half_extents.to_array()),
        Form::Hull(cloud) => geometry::hull(cloud.points.iter().map(|point| point.as_vec3().to_array())),
        Form::Mesh(mesh) => {
            let vertices = mesh.vertices.iter().map(|vertex| vertex.as_vec3().to_array());
            geometry::mesh(vertices, mesh.triangles.iter().copied())
        }
    }
}

/// Where a motion ends.
///
/// # Errors
/// It turns by more than half a turn, which cannot be said so: the API takes the shorter arc.
fn end_of(placed: &Placed, motion: &Motion) -> Result<proto::Pose, String> {
    let Pose { position, rotation } = placed.pose;
    let vector = motion.rotation_vector;
    if vector.length() > std::f64::consts::PI {
        return Err("it turns by more than half a turn: the API asks that in pieces".to_owned());
    }
    let turned = if motion.turns() { DQuat::from_scaled_axis(vector) * rotation } else { rotation };
    Ok(wire_pose(position + motion.displacement, turned))
}

pub(super) fn wire_pose(position: DVec3, rotation: DQuat) -> proto::Pose {
    let [x, y, z] = position.to_array();
    let rotation = proto::Quat { x: rotation.x, y: rotation.y, z: rotation.z, w: rotation.w };
    proto::Pose { position: Some(proto::Vec3 { x, y, z }), rotation: Some(rotation) }
}

/// Reads an answer of the wire.
fn read_answer(answer: Option<proto::Answer>) -> Reply {
    let answer = answer.and_then(|answer| answer.answer).ok_or("the batch has no answer to this question")?;
    match answer {
        answer::Answer::Distance(found) => {
            let hits = found.hits.iter().map(near).collect::<Result<_, _>>()?;
            Ok(Answer::Distance(verdict(found.verdict)?, hits))
        }
        answer::Answer::Overlap(found) => {
            let claim = found.hits.first().map(|hit| claim(hit.certificate.as_ref())).transpose()?;
            Ok(Answer::Overlap(verdict(found.verdict)?, claim))
        }
        answer::Answer::Penetration(found) => {
            let contacts = found.contacts.iter().map(contact).collect::<Result<_, _>>()?;
            Ok(Answer::Penetration(verdict(found.verdict)?, contacts))
        }
        answer::Answer::TimeOfImpact(found) => {
            let hits = found.hits.iter().map(impact).collect::<Result<_, _>>()?;
            Ok(Answer::Impact(verdict(found.verdict)?, hits))
        }
        answer::Answer::Raycast(found) => {
            let hits = found.hits.iter().map(ray_hit).collect::<Result<_, _>>()?;
            Ok(Answer::Ray(verdict(found.verdict)?, hits))
        }
        answer::Answer::MoveCharacter(_)
        | answer::Answer::Depenetrate(_)
        | answer::Answer::FirstTouch(_)
        | answer::Answer::Resolve(_)
        | answer::Answer::Pairs(_) => Err("the answer is of another kind than the question".to_owned()),
        answer::Answer::Problem(problem) => Err(format!("{}: {}", problem.reason, problem.message)),
    }
}

pub(super) fn verdict(number: i32) -> Result<Verdict, String> {
    match proto::Verdict::try_from(number) {
        Ok(proto::Verdict::Hit) => Ok(Verdict::Hit),
        Ok(proto::Verdict::Miss) => Ok(Verdict::Miss),
        Ok(proto::Verdict::Undecided) => Ok(Verdict::Undecided),
        Ok(proto::Verdict::Unspecified) | Err(_) => Err(format!("verdict {number} is none")),
    }
}

/// A certificate; an absent side of its interval is open.
pub(super) fn claim(certificate: Option<&proto::Certificate>) -> Result<Claim, String> {
    let certificate = certificate.ok_or("a hit has no certificate")?;
    let interval = certificate.interval.unwrap_or_default();
    Ok(Claim {
        verdict: verdict(certificate.verdict)?,
        lower: interval.lower.unwrap_or(f64::NEG_INFINITY),
        upper: interval.upper.unwrap_or(f64::INFINITY),
    })
}

fn vector(vector: Option<&proto::Vec3>) -> Option<DVec3> {
    vector.map(|&proto::Vec3 { x, y, z }| DVec3::new(x, y, z))
}

pub(super) fn near(hit: &proto::Neighbor) -> Result<Near, String> {
    Ok(Near {
        distance: hit.distance.ok_or("a neighbour has no distance")?,
        point_on_a: vector(hit.point_on_subject.as_ref()).ok_or("a neighbour has no point on the subject")?,
        point_on_b: vector(hit.point_on_shape.as_ref()).ok_or("a neighbour has no point on the shape")?,
        normal_b_to_a: vector(hit.normal.as_ref()),
        claim: claim(hit.certificate.as_ref())?,
    })
}

pub(super) fn contact(contact: &proto::Contact) -> Result<ContactAnswer, String> {
    Ok(ContactAnswer {
        normal_b_to_a: vector(contact.normal.as_ref()).ok_or("a contact has no normal")?,
        depth: contact.depth.ok_or("a contact has no depth")?,
        face_of_b: contact.feature.and_then(|feature| feature.face),
        claim: claim(contact.certificate.as_ref())?,
    })
}

fn impact(hit: &proto::Impact) -> Result<ImpactAnswer, String> {
    Ok(ImpactAnswer {
        fraction: hit.fraction.ok_or("an impact has no fraction")?,
        initial: hit.initial,
        normal_b_to_a: vector(hit.normal.as_ref()),
        claim: claim(hit.certificate.as_ref())?,
    })
}

fn ray_hit(hit: &proto::RayHit) -> Result<RayAnswer, String> {
    Ok(RayAnswer {
        distance: hit.distance.ok_or("a ray hit has no distance")?,
        face: hit.feature.and_then(|feature| feature.face),
        claim: claim(hit.certificate.as_ref())?,
    })
}
