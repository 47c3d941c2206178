//! A world as a plain list, and what the world's answers must have to do with the kernels' answers, shape by shape.
//!
//! The world may pass over a shape, or raise a lower bound, only by what the shape's box proves. So certain answers must be
//! there, values lie in the kernel's own bounds, and an undecided answer may be missing where the box says no.

use std::collections::BTreeMap;

use collision::{
    accuracy::Accuracy,
    answer::{Certificate, Verdict, Work},
    broad::distance_at_least,
    math::Aabb,
    narrow::{self, Motion, Placed},
    shape::Form,
    world::{
        Distance, Edit, Filter, Found, HitMode, Meter, Mobility, Overlap, Penetration, QuestionError, Raycast, Shape,
        ShapeId, Snapshot, Subject, TimeOfImpact,
    },
};

use super::{
    lists::{judge_all, judge_list},
    pierced,
    script::Question,
};

const ACCURACY: Accuracy = Accuracy::of(collision::accuracy::Tier::Standard);

/// Counts, so that a test shows that it saw enough.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Tally {
    pub(crate) ticks: usize,
    pub(crate) asked: usize,
    pub(crate) errors: usize,
    /// Questions that hit something, by kind: rays, overlaps, depths, motions, distances.
    pub(crate) hits: [usize; 5],
}

/// The shapes by id.
#[derive(Debug, Default)]
pub(crate) struct Brute {
    pub(crate) shapes: BTreeMap<ShapeId, Shape>,
}

/// What a question is about, and what it sees.
struct Scene<'a> {
    subject: Placed<'a>,
    bounds: Aabb,
    seen: Vec<&'a Shape>,
}

/// A hit of the world.
#[derive(Clone, Copy, Debug)]
pub(super) struct Hit {
    pub(super) value: f64,
    pub(super) id: ShapeId,
    pub(super) certificate: Certificate,
    /// It blocks nothing.
    pub(super) pierced: bool,
}

/// A kernel's touch: its value and what it is worth.
pub(super) type Touch = (f64, Certificate);

fn placed(shape: &Shape) -> Placed<'_> {
    Placed { geometry: &shape.geometry, pose: shape.pose }
}

fn bounds(shape: &Shape) -> Aabb {
    shape.geometry.bounds(&shape.pose)
}

/// The answer, bit by bit.
pub(crate) fn debug(version: &Snapshot, question: &Question, filter: &Filter) -> String {
    let mut go_on = || true;
    let meter = &mut Meter::new(&mut go_on);
    match question {
        Question::Raycast(question) => format!("{:?}", version.raycast(question, filter, &ACCURACY, meter)),
        Question::Overlap(question) => format!("{:?}", version.overlap(question, filter, &ACCURACY, meter)),
        Question::Penetration(question) => format!("{:?}", version.penetration(question, filter, &ACCURACY, meter)),
        Question::TimeOfImpact(question) => {
            format!("{:?}", version.time_of_impact(question, filter, &ACCURACY, meter))
        }
        Question::Distance(question) => format!("{:?}", version.distance(question, filter, &ACCURACY, meter)),
    }
}

impl Brute {
    /// Does what the edit says; `Err` if it moves what is not there.
    pub(crate) fn apply(&mut self, edit: &Edit) -> Result<(), ShapeId> {
        match edit {
            Edit::Insert(shape) => {
                self.shapes.insert(shape.id, shape.clone());
            }
            Edit::Move { id, position, rotation, velocity, angular_velocity, .. } => {
                let shape = self.shapes.get_mut(id).ok_or(*id)?;
                shape.pose.position = position.unwrap_or(shape.pose.position);
                shape.pose.rotation = rotation.unwrap_or(shape.pose.rotation);
                shape.velocity = velocity.unwrap_or(shape.velocity);
                shape.angular_velocity = angular_velocity.unwrap_or(shape.angular_velocity);
            }
            Edit::Remove(id) => {
                self.shapes.remove(id);
            }
            Edit::Clear => self.shapes.clear(),
        }
        Ok(())
    }

    /// Whether a version answers as the list does; its answer, bit by bit.
    pub(crate) fn judge(&self, version: &Snapshot, question: &Question, filter: &Filter, tally: &mut Tally) -> String {
        let mut go_on = || true;
        let meter = &mut Meter::new(&mut go_on);
        let (kind, verdict) = match question {
            Question::Raycast(asked) => {
                let found = version.raycast(asked, filter, &ACCURACY, meter).expect("nobody interrupts");
                (0, Ok(self.judge_rays(version, asked, filter, &found)))
            }
            Question::Overlap(asked) => {
                let found = version.overlap(asked, filter, &ACCURACY, meter);
                (1, self.judge_subject(&asked.subject, found, |found| self.judge_overlap(asked, filter, found)))
            }
            Question::Penetration(asked) => (2, self.judge_depths(version, asked, filter)),
            Question::TimeOfImpact(asked) => {
                let found = version.time_of_impact(asked, filter, &ACCURACY, meter);
                (
                    3,
                    self.judge_subject(&asked.subject, found, |found| {
                        self.judge_impacts(version, asked, filter, found)
                    }),
                )
            }
            Question::Distance(asked) => {
                let found = version.distance(asked, filter, &ACCURACY, meter);
                (4, self.judge_subject(&asked.subject, found, |found| self.judge_distances(asked, filter, found)))
            }
        };
        tally.asked += 1;
        tally.errors += usize::from(verdict.is_err());
        tally.hits[kind] += usize::from(verdict == Ok(Verdict::Hit));
        debug(version, question, filter)
    }

    fn sees(filter: &Filter, asker: Option<&Shape>, shape: &Shape) -> bool {
        let layers = filter.layers.or(asker.map(|asker| asker.layers)).unwrap_or(u32::MAX);
        let wanted = filter.collides_with.or(asker.map(|asker| asker.collides_with)).unwrap_or(u32::MAX);
        (shape.layers & wanted) != 0
            && (shape.collides_with & layers) != 0
            && asker.is_none_or(|asker| asker.id != shape.id && (asker.group == 0 || asker.group != shape.group))
            && !filter.exclude_ids.contains(&shape.id)
            && (shape.group == 0 || !filter.exclude_groups.contains(&shape.group))
            && (!filter.exclude_sensors || !shape.sensor)
            && (!filter.exclude_static || shape.mobility != Mobility::Static)
    }

    fn scene<'a>(&'a self, subject: &'a Subject, filter: &Filter) -> Scene<'a> {
        let (subject, asker) = match subject {
            Subject::Geometry { geometry, pose } => (Placed { geometry, pose: *pose }, None),
            Subject::Shape { id, pose } => {
                let shape = &self.shapes[id];
                (Placed { geometry: &shape.geometry, pose: pose.unwrap_or(shape.pose) }, Some(shape))
            }
        };
        let seen = self.shapes.values().filter(|shape| Self::sees(filter, asker, shape)).collect();
        Scene { subject, bounds: subject.geometry.bounds(&subject.pose), seen }
    }

    /// The error that a subject leads to, if it does.
    fn fault(&self, subject: &Subject) -> Option<QuestionError> {
        let (geometry, id) = match subject {
            Subject::Geometry { geometry, .. } => (geometry, None),
            Subject::Shape { id, .. } => match self.shapes.get(id) {
                Some(shape) => (&shape.geometry, Some(*id)),
                None => return Some(QuestionError::SubjectNotFound(*id)),
            },
        };
        matches!(geometry.form(), Form::HalfSpace(_)).then_some(QuestionError::SubjectUnbounded(id))
    }

    fn judge_subject<H>(
        &self,
        subject: &Subject,
        found: Result<Found<H>, QuestionError>,
        judge: impl FnOnce(&Found<H>) -> Verdict,
    ) -> Result<Verdict, QuestionError> {
        assert_eq!(found.as_ref().err(), self.fault(subject).as_ref(), "{subject:?}");
        found.map(|found| judge(&found))
    }

    fn judge_overlap(&self, asked: &Overlap, filter: &Filter, found: &Found<collision::world::OverlapHit>) -> Verdict {
        let scene = self.scene(&asked.subject, filter);
        let mut expected = Vec::new();
        for shape in scene.seen {
            let certificate = narrow::overlap(scene.subject, placed(shape), &ACCURACY, &mut Work::default());
            let meets = bounds(shape).intersects(scene.bounds);
            assert!(meets || certificate.verdict != Verdict::Hit, "the boxes hold the forms: {asked:?} {shape:?}");
            if meets && certificate.verdict != Verdict::Miss {
                expected.push((Some(shape.id), certificate));
            }
        }
        assert_eq!(found.truncated, expected.len() > asked.max_hits, "{asked:?}");
        expected.truncate(asked.max_hits);
        let list: Vec<_> = found.hits.iter().map(|hit| (hit.id, hit.certificate)).collect();
        assert_eq!(list, expected, "{asked:?}");
        found.verdict
    }

    fn judge_depths(&self, version: &Snapshot, asked: &Penetration, filter: &Filter) -> Result<Verdict, QuestionError> {
        let found = version.penetration(asked, filter, &ACCURACY, &mut Meter::new(&mut || true));
        if let Some(fault) = self.fault(&asked.subject) {
            assert_eq!(found.as_ref().err(), Some(&fault));
            return Err(fault);
        }
        let scene = self.scene(&asked.subject, filter);
        let near = scene.bounds.inflated(asked.max_gap);
        let near = Aabb::new(near.min.map(f64::next_down), near.max.map(f64::next_up));
        let mut expected = Vec::new();
        for shape in scene.seen.into_iter().filter(|shape| bounds(shape).intersects(near)) {
            let work = &mut Work::default();
            match narrow::penetration(scene.subject, placed(shape), asked.max_gap, &ACCURACY, work) {
                Ok(contacts) => expected.extend(contacts.iter().map(|contact| (contact.depth, shape.id))),
                Err(narrow::NeedsDecomposition) => {
                    let error = QuestionError::NeedsDecomposition(Some(shape.id));
                    assert_eq!(found.as_ref().err(), Some(&error));
                    return Err(error);
                }
            }
        }
        expected.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        let found = found.unwrap_or_else(|error| panic!("{error}: {asked:?}"));
        assert_eq!(found.truncated, expected.len() > asked.max_contacts, "{asked:?}");
        expected.truncate(asked.max_contacts);
        let list: Vec<_> = found.hits.iter().filter_map(|hit| Some((hit.depth, hit.id?))).collect();
        assert_eq!(list, expected, "{asked:?}");
        Ok(found.verdict)
    }

    fn judge_distances(&self, asked: &Distance, filter: &Filter, found: &Found<collision::world::Neighbor>) -> Verdict {
        let scene = self.scene(&asked.subject, filter);
        let mut expected = Vec::new();
        for shape in scene.seen {
            let least = distance_at_least(scene.bounds, bounds(shape));
            let (subject, limit) = (scene.subject, asked.max_distance);
            let separation = narrow::distance(subject, placed(shape), limit, &ACCURACY, &mut Work::default());
            let Some(separation) = separation else { continue };
            let bound = separation.certificate.bound;
            assert!(least <= bound.upper, "the boxes hold the forms: {least} {separation:?} {asked:?} {shape:?}");
            if least <= limit {
                let value = if bound.lower < least { separation.distance.max(least) } else { separation.distance };
                expected.push((value, shape.id));
            }
        }
        expected.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        expected.truncate(asked.max_hits);
        let list: Vec<_> = found.hits.iter().filter_map(|hit| Some((hit.separation.distance, hit.id?))).collect();
        assert_eq!(list, expected, "{asked:?}");
        found.verdict
    }

    fn judge_rays(
        &self,
        version: &Snapshot,
        asked: &Raycast,
        filter: &Filter,
        found: &Found<collision::world::RayHit>,
    ) -> Verdict {
        let mut kernel = BTreeMap::new();
        for shape in self.shapes.values().filter(|shape| Self::sees(filter, None, shape)) {
            let touches = narrow::raycast(&asked.ray, placed(shape), &ACCURACY, &mut Work::default());
            let touch = |touch: narrow::RayTouch| (touch.distance, touch.certificate);
            kernel.insert(shape.id, [touches.certain.map(touch), touches.undecided.map(touch)]);
        }
        let hits = |found: &Found<collision::world::RayHit>| -> Vec<Hit> {
            let hit = |hit: &collision::world::RayHit| {
                let (value, certificate) = (hit.touch.distance, hit.touch.certificate);
                Some(Hit { value, id: hit.id?, certificate, pierced: hit.pierced })
            };
            found.hits.iter().filter_map(hit).collect()
        };
        let all = Raycast { mode: HitMode::All(usize::MAX), ..asked.clone() };
        let all = version.raycast(&all, filter, &ACCURACY, &mut Meter::new(&mut || true)).expect("nobody interrupts");
        let what = format!("{asked:?} {filter:?}");
        self.judge_mode(asked.mode, &hits(found), (found.truncated, found.verdict), &hits(&all), &kernel, &what);
        found.verdict
    }

    fn judge_impacts(
        &self,
        version: &Snapshot,
        asked: &TimeOfImpact,
        filter: &Filter,
        found: &Found<collision::world::Impact>,
    ) -> Verdict {
        let scene = self.scene(&asked.subject, filter);
        let motion = Motion {
            displacement_a: asked.displacement,
            rotation_a: asked.rotation,
            initial: asked.initial,
            ..Motion::default()
        };
        let mut kernel = BTreeMap::new();
        let goes_through = matches!(asked.mode, HitMode::Pierce { .. }) && !filter.exclude_sensors;
        for shape in scene.seen.into_iter().filter(|shape| goes_through || !shape.sensor) {
            let touch = narrow::impact(scene.subject, placed(shape), &motion, &ACCURACY, &mut Work::default());
            let touch = touch.map(|touch| (touch.fraction, touch.certificate));
            let is_certain = touch.is_some_and(|(_, certificate)| certificate.verdict == Verdict::Hit);
            kernel.insert(shape.id, if is_certain { [touch, None] } else { [None, touch] });
        }
        let hits = |found: &Found<collision::world::Impact>| -> Vec<Hit> {
            let hit = |hit: &collision::world::Impact| {
                let (value, certificate) = (hit.touch.fraction, hit.touch.certificate);
                Some(Hit { value, id: hit.id?, certificate, pierced: hit.pierced })
            };
            found.hits.iter().filter_map(hit).collect()
        };
        let all = TimeOfImpact { mode: HitMode::All(usize::MAX), ..asked.clone() };
        let mut go_on = || true;
        let meter = &mut Meter::new(&mut go_on);
        let all = match goes_through {
            true => pierced::without_sensors(self, version).time_of_impact(&all, filter, &ACCURACY, meter),
            false => version.time_of_impact(&all, filter, &ACCURACY, meter),
        };
        let all = all.expect("nobody interrupts");
        let what = format!("{asked:?} {filter:?}");
        self.judge_mode(asked.mode, &hits(found), (found.truncated, found.verdict), &hits(&all), &kernel, &what);
        found.verdict
    }

    /// `all` are the hits of the same question in the mode that lists all.
    fn judge_mode(
        &self,
        mode: HitMode,
        found: &[Hit],
        (truncated, verdict): (bool, Verdict),
        all: &[Hit],
        kernel: &BTreeMap<ShapeId, [Option<Touch>; 2]>,
        what: &str,
    ) {
        judge_all(all, kernel, what);
        if let HitMode::Pierce { layers, most } = mode {
            let blocks_nothing = |id| self.shapes.get(&id).is_some_and(|s| s.sensor || s.layers & layers != 0);
            pierced::judge(&pierced::Answer { found, truncated, verdict, most }, all, blocks_nothing, what);
        } else {
            judge_list(mode, found, truncated, all, kernel, what);
        }
    }
}
