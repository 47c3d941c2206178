//! Which questions are asked of a scene.

use std::sync::Arc;

use collision::{
    DVec3,
    math::Pose,
    narrow::{Faces, InitialTouch, Ray},
    shape::{Form, Geometry, Mesh},
    world::{Distance, HitMode, Overlap, Penetration, Raycast, Subject, TimeOfImpact},
};

use crate::{
    scene::Random,
    scenes::{Item, Scene},
};

/// A kind of question.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    /// The closest hit of a ray.
    Raycast,
    /// All shapes that touch a form.
    Overlap,
    /// The shape that is nearest to a form.
    Distance,
    /// All contacts of a convex form.
    Penetration,
    /// The first touch of a form that goes straight on.
    Impact,
    /// The first touch of a form that turns as well.
    TurningImpact,
}

impl Kind {
    /// All of them.
    pub const ALL: [Self; 6] =
        [Self::Raycast, Self::Overlap, Self::Distance, Self::Penetration, Self::Impact, Self::TurningImpact];

    /// As it is written.
    #[must_use]
    pub const fn text(self) -> &'static str {
        match self {
            Self::Raycast => "raycast",
            Self::Overlap => "overlap",
            Self::Distance => "distance",
            Self::Penetration => "penetration",
            Self::Impact => "impact",
            Self::TurningImpact => "turning-impact",
        }
    }

    /// The RPC that asks it.
    #[must_use]
    pub const fn call(self) -> &'static str {
        match self {
            Self::Raycast => "Raycast",
            Self::Overlap => "Overlap",
            Self::Distance => "Distance",
            Self::Penetration => "Penetration",
            Self::Impact | Self::TurningImpact => "TimeOfImpact",
        }
    }
}

impl std::str::FromStr for Kind {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let known = || Self::ALL.map(Self::text).join(", ");
        Self::ALL.into_iter().find(|kind| kind.text() == text).ok_or_else(|| format!("questions are {}", known()))
    }
}

/// A question about a world.
#[derive(Clone, Debug)]
pub(super) enum Question {
    Raycast(Raycast),
    Overlap(Overlap),
    Distance(Distance),
    Penetration(Penetration),
    /// With the way of the fastest point, metres: a fraction times that is a length.
    Impact(TimeOfImpact, f64),
}

impl Question {
    /// In a line, with forms by their ids.
    pub(super) fn told(&self) -> String {
        let of = |subject: &Subject| match subject {
            Subject::Geometry { geometry, pose } => {
                format!("{:?} at {:?} turned by {:?}", geometry.id(), pose.position, pose.rotation)
            }
            Subject::Shape { id, .. } => format!("shape {id}"),
        };
        match self {
            Self::Raycast(question) => format!("{:?}", question.ray),
            Self::Overlap(question) => of(&question.subject),
            Self::Distance(question) => of(&question.subject),
            Self::Penetration(question) => of(&question.subject),
            Self::Impact(question, _) => {
                format!("{}, goes {:?}, turns {:?}", of(&question.subject), question.displacement, question.rotation)
            }
        }
    }
}

/// More hits than a question is likely to find.
pub(super) const HITS_MAX: usize = 4096;

/// Farther than anything is, metres.
const FAR: f64 = 1e9;

/// A shape so many times larger than the subjects is not aimed at: what lies on it is.
const TOO_LARGE: f64 = 1e5;

/// How far from the surface of something a subject is, as multiples of its own size, in turns.
const GAPS: [f64; 5] = [0.5, 1.0, 2.0, 5.0, 20.0];

/// The questions that a seed names. Question `number` is the same whatever their count.
pub(super) fn questions(scene: &Scene, kind: Kind, count: usize, seed: u64) -> Vec<Question> {
    let asked = |number: usize| {
        let mut random = Random::new(seed ^ ((kind as u64) << 32 | number as u64).wrapping_mul(0x9E37_79B9_7F4A_7C15));
        question(scene, kind, number, &mut random)
    };
    (0..count).map(asked).collect()
}

fn question(scene: &Scene, kind: Kind, number: usize, random: &mut Random) -> Question {
    let [from, to] = [surface_point(scene, random), surface_point(scene, random)];
    if kind == Kind::Raycast {
        let origin = from + random.direction() * (scene.size * random.uniform(0.5, 20.0));
        let direction = to + random.direction() * (scene.size * random.uniform(0.0, 0.5)) - origin;
        let (faces, hollow) = (Faces::Both, false);
        let ray = Ray { origin, direction, min_distance: 0.0, max_distance: FAR, hollow, faces };
        return Question::Raycast(Raycast { ray, mode: HitMode::Closest });
    }
    let geometry = subject(scene, kind, number);
    let reach = geometry.reach();
    let gap = match kind {
        Kind::Distance => GAPS[number % GAPS.len()] * reach,
        Kind::Impact | Kind::TurningImpact => reach * random.uniform(1.0, 5.0),
        Kind::Raycast | Kind::Overlap | Kind::Penetration => reach * random.uniform(0.0, 1.0),
    };
    let pose = Pose::new(from + random.direction() * gap, random.rotation());
    let subject = Subject::Geometry { geometry: geometry.clone(), pose };
    match kind {
        Kind::Raycast | Kind::Overlap => Question::Overlap(Overlap { subject, against: None, max_hits: HITS_MAX }),
        Kind::Distance => Question::Distance(Distance { subject, against: None, max_distance: FAR, max_hits: 1 }),
        Kind::Penetration => {
            Question::Penetration(Penetration { subject, against: None, max_gap: 0.0, max_contacts: HITS_MAX })
        }
        Kind::Impact | Kind::TurningImpact => {
            let way = to - pose.position;
            let displacement = way * (1.3 * (40.0 * scene.size / way.length()).min(1.0));
            let turn = random.direction() * random.uniform(0.2, 1.5);
            let rotation = if kind == Kind::Impact { DVec3::ZERO } else { turn };
            let question = TimeOfImpact {
                subject,
                displacement,
                rotation,
                against: None,
                against_displacement: DVec3::ZERO,
                against_rotation: DVec3::ZERO,
                initial: InitialTouch::Counts,
                mode: HitMode::Closest,
            };
            Question::Impact(question, displacement.length() + rotation.length() * reach)
        }
    }
}

/// Subjects take turns; only a convex one has a depth in a mesh without parts.
fn subject(scene: &Scene, kind: Kind, number: usize) -> &Arc<Geometry> {
    let is_asked = |form: &&Arc<Geometry>| kind != Kind::Penetration || matches!(form.form(), Form::Convex(_));
    let asked: Vec<&Arc<Geometry>> = scene.subjects.iter().filter(is_asked).collect();
    if asked.is_empty() { &scene.subjects[number % scene.subjects.len()] } else { asked[number % asked.len()] }
}

/// A point on or near something.
fn surface_point(scene: &Scene, random: &mut Random) -> DVec3 {
    let mut drawn = || &scene.items[(random.bits() % scene.items.len() as u64) as usize];
    let is_too_large = |item: &Item| item.geometry.reach() > TOO_LARGE * scene.size;
    let mut item = drawn();
    for _ in 0..16 {
        if is_too_large(item) {
            item = drawn();
        }
    }
    if let Form::Mesh(mesh) = item.geometry.form() {
        return item.pose.position + item.pose.matrix() * mesh_point(mesh, random);
    }
    let bounds = item.geometry.bounds(&item.pose);
    let mut share = || random.uniform(0.0, 1.0);
    bounds.min + (bounds.max - bounds.min) * DVec3::new(share(), share(), share())
}

fn mesh_point(mesh: &Mesh, random: &mut Random) -> DVec3 {
    let [a, b, c] = mesh.corners((random.bits() % mesh.triangles().len() as u64) as usize);
    let (u, v) = (random.uniform(0.0, 1.0), random.uniform(0.0, 1.0));
    let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
    a + (b - a) * u + (c - a) * v
}
