//! The questions as a world of Calipers answers them: in f64, exactly, with proof, one version for all.

use std::{num::NonZeroU64, sync::Arc, time::Duration};

use collision::{
    DVec3,
    accuracy::{Accuracy, Tier},
    answer::Verdict,
    math::Pose,
    narrow::{Faces, InitialTouch, Ray},
    shape::Geometry,
    world::{
        Edit, EditRule, Filter, HitMode, Impact, Meter, Overlap, OverlapHit, RayHit, Raycast, Shape, Snapshot, Subject,
        Time, TimeOfImpact, World,
    },
};

use crate::{
    errors::Proof,
    forms::{Form, Place, geometry, pose, vector},
    timing::spent,
    worlds::workload::{Line, Workload},
};

const EXACT: Accuracy = Accuracy::of(Tier::Exact);
/// Far more than there are.
const ALL: usize = usize::MAX;

/// A world, as it is and after a tick of far moves.
#[derive(Debug)]
pub(super) struct Side {
    pub(super) still: Arc<Snapshot>,
    pub(super) moved: Arc<Snapshot>,
}

fn id(shape: u32) -> NonZeroU64 {
    NonZeroU64::MIN.saturating_add(u64::from(shape))
}

impl Side {
    /// All shapes inserted as one tick, each with a geometry of its own; then the far moves as another.
    pub(super) fn new(workload: &Workload) -> Self {
        let mut world = World::new(Time(0));
        let shapes = (0..).zip(workload.forms.iter().zip(&workload.places));
        let inserts = shapes.map(|(number, (form, place))| Edit::Insert(shape(number, form, place))).collect();
        world.apply(inserts, Time(0), EditRule::AllOrNothing).expect("nothing is wrong with them");
        let still = world.newest();
        let moves = workload.far_moves.iter().map(|(number, place)| Edit::Move {
            id: id(*number),
            position: Some(vector(place.position)),
            rotation: None,
            velocity: None,
            angular_velocity: None,
            teleport: false,
        });
        world.apply(moves.collect(), Time(1), EditRule::AllOrNothing).expect("all are there");
        Self { still, moved: world.newest() }
    }
}

fn shape(number: u32, form: &Form, place: &Place) -> Shape {
    let shape = Shape::new(id(number), Arc::new(geometry(form)), pose(place));
    Shape { user_data: u64::from(number), ..shape }
}

/// Rays of a length in metres.
pub(super) fn rays(lines: &[Line], length: f64) -> Vec<Raycast> {
    let ray = |line: &Line| Ray {
        origin: vector(line.origin),
        direction: vector(line.direction),
        min_distance: 0.0,
        max_distance: length * vector(line.direction).length(),
        hollow: false,
        faces: Faces::Both,
    };
    lines.iter().map(|line| Raycast { ray: ray(line), mode: HitMode::Closest }).collect()
}

/// The same form at many poses.
pub(super) fn overlaps(form: &Form, poses: impl Iterator<Item = Pose>) -> Vec<Overlap> {
    let form = Arc::new(geometry(form));
    let subject = |pose| Subject::Geometry { geometry: Arc::clone(&form), pose };
    poses.map(|pose| Overlap { subject: subject(pose), against: None, max_hits: ALL }).collect()
}

/// A ball that goes a length in metres along each line.
pub(super) fn casts(form: &Form, lines: &[Line], length: f32) -> Vec<TimeOfImpact> {
    let form: Arc<Geometry> = Arc::new(geometry(form));
    let cast = |line: &Line| TimeOfImpact {
        subject: Subject::Geometry { geometry: Arc::clone(&form), pose: Pose::at(vector(line.origin)) },
        displacement: vector(line.direction.map(|part| part * length)),
        rotation: DVec3::ZERO,
        against: None,
        against_displacement: DVec3::ZERO,
        against_rotation: DVec3::ZERO,
        initial: InitialTouch::Counts,
        mode: HitMode::Closest,
    };
    lines.iter().map(cast).collect()
}

/// What a question of some kind finds.
pub(super) trait Question {
    type Hit;

    fn ask(&self, world: &Snapshot) -> Vec<Self::Hit>;
}

/// The filter that sees all; made once.
fn all() -> &'static Filter {
    static ALL: std::sync::LazyLock<Filter> = std::sync::LazyLock::new(Filter::default);
    &ALL
}

impl Question for Raycast {
    type Hit = RayHit;

    fn ask(&self, world: &Snapshot) -> Vec<RayHit> {
        world.raycast(self, all(), &EXACT, &mut Meter::new(&mut || true)).expect("nobody interrupts").hits
    }
}

impl Question for Overlap {
    type Hit = OverlapHit;

    fn ask(&self, world: &Snapshot) -> Vec<OverlapHit> {
        world.overlap(self, all(), &EXACT, &mut Meter::new(&mut || true)).expect("nobody interrupts").hits
    }
}

impl Question for TimeOfImpact {
    type Hit = Impact;

    fn ask(&self, world: &Snapshot) -> Vec<Impact> {
        world.time_of_impact(self, all(), &EXACT, &mut Meter::new(&mut || true)).expect("nobody interrupts").hits
    }
}

/// CPU time of asking the first `count`.
pub(super) fn time<Q: Question>(world: &Snapshot, questions: &[Q], count: usize) -> Duration {
    spent(questions[..count].iter(), |question| question.ask(world))
}

/// What the first hit of a ray proves: an undecided one comes first, where there is one.
pub(super) fn of_ray(hits: &[RayHit]) -> Proof {
    hits.first().map_or(Proof::NONE, |hit| Proof::of_value(&hit.touch.certificate, hit.touch.distance, 1.0))
}

/// The same of a cast over a way of `length` metres.
pub(super) fn of_cast(hits: &[Impact], length: f64) -> Proof {
    hits.first().map_or(Proof::NONE, |hit| Proof::of_value(&hit.touch.certificate, hit.touch.fraction, length))
}

/// What each hit proves, with the number of its shape, by number.
pub(super) fn of_overlap(hits: &[OverlapHit]) -> Vec<(u32, Proof)> {
    hits.iter().map(|hit| (hit.user_data as u32, Proof::of_verdict(&hit.certificate))).collect()
}

/// Whether the form has room at a place.
pub(super) fn is_free(world: &Snapshot, question: &Overlap) -> bool {
    let mut hits = question.ask(world).into_iter();
    hits.all(|hit| hit.certificate.verdict == Verdict::Miss)
}
