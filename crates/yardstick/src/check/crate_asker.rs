//! Asks the crate in this process, without a server.

use std::{
    collections::HashMap,
    panic::{AssertUnwindSafe, catch_unwind},
    sync::Arc,
};

use collision::{
    accuracy::{Accuracy, Tier},
    answer::{self, Certificate, Work},
    math::Pose,
    narrow,
    shape::Geometry,
    world::{self, Edit, EditRule, Filter, Meter, Shape, ShapeId, Snapshot, Subject, Time, World},
};
use glam::DVec3;

use super::{
    Answer, Asker, Claim, ContactAnswer, ImpactAnswer, Near, PairTally, Question, RayAnswer, Reply, Stage, Verdict,
    ask::Neighbors,
    special::{actor_form, shape_id},
};
use crate::sets::{self, Form, Placed, aabb::BoxSet, stream::Change};

/// Asks the kernels of the crate, pair by pair, and a world of its own for streams.
#[derive(Default)]
pub struct CrateAsker {
    geometries: GeometryCache,
}

const ACCURACY: Accuracy = Accuracy::of(Tier::Exact);

impl Asker for CrateAsker {
    fn ask(&mut self, questions: &[Question]) -> Vec<Reply> {
        questions.iter().map(|question| caught(|| answer(&mut self.geometries, question))).collect()
    }

    fn stage(&mut self) -> Result<Box<dyn Stage + '_>, String> {
        let world = caught(|| Ok(World::new(Time(0))))?;
        Ok(Box::new(CrateStage { world, tick_count: 0, kinds: HashMap::new(), geometries: GeometryCache::default() }))
    }

    fn overlapping_boxes(&mut self, set: &BoxSet) -> Result<Option<PairTally>, String> {
        caught(|| super::special::pairs_of_boxes(set)).map(Some)
    }
}

/// A panic of what is asked is no answer, and no reason to stop.
fn caught<T>(work: impl FnOnce() -> Result<T, String>) -> Result<T, String> {
    catch_unwind(AssertUnwindSafe(work)).unwrap_or_else(|payload| {
        let text = payload.downcast_ref::<&str>().map(|text| (*text).to_owned());
        let text = text.or_else(|| payload.downcast_ref::<String>().cloned());
        Err(format!("panicked: {}", text.unwrap_or_default()))
    })
}

/// Hulls and meshes are made once: the key is the address of the shared points, which the value keeps alive.
#[derive(Default)]
struct GeometryCache {
    by_address: HashMap<usize, (Form, Arc<Geometry>)>,
}

impl GeometryCache {
    fn get(&mut self, form: &Form) -> Result<Arc<Geometry>, String> {
        let address = match form {
            Form::Hull(cloud) => Arc::as_ptr(cloud).addr(),
            Form::Mesh(mesh) => Arc::as_ptr(mesh).addr(),
            _ => return make(form).map(Arc::new),
        };
        if let Some((_, geometry)) = self.by_address.get(&address) {
            return Ok(Arc::clone(geometry));
        }
        let geometry = Arc::new(make(form)?);
        self.by_address.insert(address, (form.clone(), Arc::clone(&geometry)));
        Ok(geometry)
    }
}

fn make(form: &Form) -> Result<Geometry, String> {
    let made = match form {
        Form::Sphere { radius } => Geometry::sphere(*radius),
        Form::Capsule { half_height, radius } => Geometry::capsule(*half_height, *radius),
        Form::Cuboid { half_extents } => Geometry::cuboid(*half_extents),
        Form::Hull(cloud) => Geometry::hull(&cloud.points),
        Form::Mesh(mesh) => Geometry::mesh(&mesh.vertices, &mesh.triangles),
    };
    made.map_err(|error| error.to_string())
}

fn pose(pose: &sets::Pose) -> Pose {
    Pose::new(pose.position, pose.rotation)
}

fn answer(cache: &mut GeometryCache, question: &Question) -> Reply {
    let mut work = Work::default();
    match question {
        Question::Distance { a, b } => with_pair(cache, a, b, |a, b| Ok(distance(a, b, &mut work))),
        Question::Overlap { a, b } => with_pair(cache, a, b, |a, b| {
            let certificate = narrow::overlap(a, b, &ACCURACY, &mut work);
            Ok(Answer::Overlap(verdict(certificate.verdict), Some(claim(&certificate))))
        }),
        Question::Penetration { a, b, max_gap } => with_pair(cache, a, b, |a, b| {
            let contacts =
                narrow::penetration(a, b, *max_gap, &ACCURACY, &mut work).map_err(|error| error.to_string())?;
            let mut contacts: Vec<ContactAnswer> = contacts.iter().map(contact).collect();
            contacts.sort_by(|first, second| second.depth.total_cmp(&first.depth));
            Ok(Answer::Penetration(found_verdict(contacts.iter().map(|contact| contact.claim.verdict)), contacts))
        }),
        Question::Impact { a, motion_a, b, motion_b } => with_pair(cache, a, b, |a, b| {
            let motion = narrow::Motion {
                displacement_a: motion_a.displacement,
                displacement_b: motion_b.displacement,
                rotation_a: motion_a.rotation_vector,
                rotation_b: motion_b.rotation_vector,
                initial: narrow::InitialTouch::Counts,
            };
            let touch = narrow::impact(a, b, &motion, &ACCURACY, &mut work);
            let hits: Vec<ImpactAnswer> = touch.iter().map(impact).collect();
            Ok(Answer::Impact(found_verdict(hits.iter().map(|hit| hit.claim.verdict)), hits))
        }),
        Question::Raycast { origin, direction, max_distance, target } => {
            let geometry = cache.get(&target.form)?;
            let target = narrow::Placed { geometry: &geometry, pose: pose(&target.pose) };
            Ok(raycast(*origin, *direction, *max_distance, target, &mut work))
        }
    }
}

fn with_pair(
    cache: &mut GeometryCache,
    a: &Placed,
    b: &Placed,
    ask: impl FnOnce(narrow::Placed<'_>, narrow::Placed<'_>) -> Reply,
) -> Reply {
    let (form_a, form_b) = (cache.get(&a.form)?, cache.get(&b.form)?);
    let placed_a = narrow::Placed { geometry: &form_a, pose: pose(&a.pose) };
    let placed_b = narrow::Placed { geometry: &form_b, pose: pose(&b.pose) };
    ask(placed_a, placed_b)
}

fn distance(a: narrow::Placed<'_>, b: narrow::Placed<'_>, work: &mut Work) -> Answer {
    let separation = narrow::distance(a, b, f64::INFINITY, &ACCURACY, work);
    let hits: Vec<Near> = separation.iter().map(near).collect();
    Answer::Distance(found_verdict(hits.iter().map(|hit| hit.claim.verdict)), hits)
}

fn raycast(origin: DVec3, direction: DVec3, max_distance: f64, target: narrow::Placed<'_>, work: &mut Work) -> Answer {
    let ray =
        narrow::Ray { origin, direction, min_distance: 0.0, max_distance, hollow: false, faces: narrow::Faces::Both };
    let touches = narrow::raycast(&ray, target, &ACCURACY, work);
    let hits: Vec<RayAnswer> = touches.undecided.iter().chain(&touches.certain).map(ray_touch).collect();
    Answer::Ray(found_verdict(hits.iter().map(|hit| hit.claim.verdict)), hits)
}

/// What a list of hits proves, as the API says it.
fn found_verdict(hits: impl Iterator<Item = Verdict>) -> Verdict {
    hits.fold(Verdict::Miss, |all, next| match (all, next) {
        (Verdict::Hit, _) | (_, Verdict::Hit) => Verdict::Hit,
        (Verdict::Undecided, _) | (_, Verdict::Undecided) => Verdict::Undecided,
        (Verdict::Miss, Verdict::Miss) => Verdict::Miss,
    })
}

fn verdict(verdict: answer::Verdict) -> Verdict {
    match verdict {
        answer::Verdict::Hit => Verdict::Hit,
        answer::Verdict::Miss => Verdict::Miss,
        answer::Verdict::Undecided => Verdict::Undecided,
    }
}

fn claim(certificate: &Certificate) -> Claim {
    let answer::Bound { lower, upper } = certificate.bound;
    Claim { verdict: verdict(certificate.verdict), lower, upper }
}

fn near(separation: &narrow::Separation) -> Near {
    Near {
        distance: separation.distance,
        point_on_a: separation.point_on_a,
        point_on_b: separation.point_on_b,
        normal_b_to_a: separation.normal_b_to_a,
        claim: claim(&separation.certificate),
    }
}

fn contact(contact: &narrow::Contact) -> ContactAnswer {
    ContactAnswer {
        normal_b_to_a: contact.normal_b_to_a,
        depth: contact.depth,
        face_of_b: contact.feature_b.face,
        claim: claim(&contact.certificate),
    }
}

fn impact(touch: &narrow::ImpactTouch) -> ImpactAnswer {
    ImpactAnswer {
        fraction: touch.fraction,
        initial: touch.initial,
        normal_b_to_a: touch.normal_b_to_a,
        claim: claim(&touch.certificate),
    }
}

fn ray_touch(touch: &narrow::RayTouch) -> RayAnswer {
    RayAnswer { distance: touch.distance, face: touch.feature.face, claim: claim(&touch.certificate) }
}

/// A world in this process.
struct CrateStage {
    world: World,
    tick_count: i64,
    kinds: HashMap<u64, sets::stream::ActorKind>,
    geometries: GeometryCache,
}

/// Most neighbours and contacts of one actor that are asked for.
const MOST_HITS: usize = 1024;

impl CrateStage {
    fn edit(&mut self, change: &Change) -> Result<Edit, String> {
        match *change {
            Change::Remove { actor } => {
                self.kinds.remove(&actor);
                Ok(Edit::Remove(id_of(actor)?))
            }
            Change::Move { actor, pose: at, .. } if self.kinds.get(&actor) == kind_of(change).as_ref() => {
                Ok(Edit::Move {
                    id: id_of(actor)?,
                    position: Some(at.position),
                    rotation: Some(at.rotation),
                    velocity: None,
                    angular_velocity: None,
                    teleport: false,
                })
            }
            Change::Move { actor, kind, pose: at } => {
                self.kinds.insert(actor, kind);
                let geometry = self.geometries.get(&actor_form(kind))?;
                let shape = Shape::new(id_of(actor)?, geometry, pose(&at));
                Ok(Edit::Insert(Shape { user_data: actor, ..shape }))
            }
        }
    }
}

fn kind_of(change: &Change) -> Option<sets::stream::ActorKind> {
    match change {
        Change::Move { kind, .. } => Some(*kind),
        Change::Remove { .. } => None,
    }
}

fn id_of(actor: u64) -> Result<ShapeId, String> {
    ShapeId::new(shape_id(actor)).ok_or_else(|| format!("actor {actor} has no id"))
}

impl Stage for CrateStage {
    fn tick(&mut self, changes: &[Change]) -> Result<(), String> {
        let edits = changes.iter().map(|change| self.edit(change)).collect::<Result<Vec<Edit>, String>>()?;
        self.tick_count += 1;
        let time = Time(self.tick_count);
        caught(|| self.world.apply(edits, time, EditRule::AllOrNothing).map_err(|error| error.to_string()))?;
        Ok(())
    }

    fn neighbors(&mut self, actors: &[u64], limit: f64) -> Vec<Neighbors> {
        let snapshot = match caught(|| Ok(self.world.newest())) {
            Ok(snapshot) => snapshot,
            Err(reason) => return actors.iter().map(|_| Err(reason.clone())).collect(),
        };
        actors.iter().map(|&actor| caught(|| neighbors_of(&snapshot, actor, limit))).collect()
    }

    fn contacts(&mut self, actor: u64) -> Result<Vec<(u64, ContactAnswer)>, String> {
        let question = world::Penetration {
            subject: Subject::Shape { id: id_of(actor)?, pose: None },
            against: None,
            max_gap: 0.0,
            max_contacts: MOST_HITS,
        };
        let snapshot = caught(|| Ok(self.world.newest()))?;
        let found = caught(|| {
            let mut go_on = || true;
            let found = snapshot.penetration(&question, &Filter::default(), &ACCURACY, &mut Meter::new(&mut go_on));
            found.map_err(|error| error.to_string())
        })?;
        let contact = |contact: &world::Contact| ContactAnswer {
            normal_b_to_a: contact.normal,
            depth: contact.depth,
            face_of_b: contact.feature.face,
            claim: claim(&contact.certificate),
        };
        Ok(found.hits.iter().map(|hit| (hit.user_data, contact(hit))).collect())
    }
}

fn neighbors_of(snapshot: &Snapshot, actor: u64, limit: f64) -> Neighbors {
    let question = world::Distance {
        subject: Subject::Shape { id: id_of(actor)?, pose: None },
        against: None,
        max_distance: limit,
        max_hits: MOST_HITS,
    };
    let mut go_on = || true;
    let found = snapshot.distance(&question, &Filter::default(), &ACCURACY, &mut Meter::new(&mut go_on));
    let found = found.map_err(|error| error.to_string())?;
    Ok(found.hits.iter().map(|hit| (hit.user_data, near(&hit.separation))).collect())
}
