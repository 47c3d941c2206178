//! Bytes as a script: ticks of edits, and questions between them. Shapes gather in a few neighbourhoods, each as large as a
//! power of ten says and as far out; sizes go from a millimetre to 10⁹ m and positions to 10¹² m, so that neighbours may
//! differ by all of that.

use std::{num::NonZeroU64, sync::Arc};

use collision::{
    DQuat, DVec3,
    math::Pose,
    narrow::{Faces, InitialTouch, Ray},
    shape::{Geometry, GeometryError, Limits},
    world::{
        Distance, Edit, Filter, HitMode, Mobility, Overlap, Penetration, Raycast, Shape, ShapeId, Subject, TimeOfImpact,
    },
};

use super::concave;

/// Ids in use.
const IDS: usize = 40;
/// Edits of a tick at most.
const EDITS: usize = 24;

/// What happens next.
#[derive(Clone, Debug)]
pub(crate) enum Step {
    Tick(Vec<Edit>),
    Ask(Box<(Question, Filter)>),
}

/// A question of any kind.
#[derive(Clone, Debug)]
pub(crate) enum Question {
    Raycast(Raycast),
    Overlap(Overlap),
    Penetration(Penetration),
    TimeOfImpact(TimeOfImpact),
    Distance(Distance),
}

#[derive(Clone, Copy, Debug)]
struct Neighbourhood {
    origin: DVec3,
    scale: f64,
}

/// The steps that bytes make; it ends with them.
pub(crate) struct Script<'b> {
    bytes: &'b [u8],
    neighbourhoods: [Neighbourhood; 3],
    /// Where each shape was last put.
    positions: [DVec3; IDS],
}

fn power_of_ten(exponent: usize) -> f64 {
    (0..exponent).fold(1.0, |power, _| power * 10.0)
}

impl<'b> Script<'b> {
    /// The first bytes say where the neighbourhoods are.
    pub(crate) fn new(bytes: &'b [u8]) -> Self {
        let first = Neighbourhood { origin: DVec3::ZERO, scale: 1.0 };
        let mut script = Self { bytes, neighbourhoods: [first; 3], positions: [DVec3::ZERO; IDS] };
        script.neighbourhoods = [(); 3].map(|()| {
            let scale = power_of_ten(script.below(13)) * 1e-3;
            let far = power_of_ten(script.below(13));
            let mut sign = || f64::from(script.byte() % 3) - 1.0;
            Neighbourhood { origin: DVec3::new(sign(), sign(), sign()) * far, scale }
        });
        script
    }

    /// 0 when there is none left.
    fn byte(&mut self) -> u8 {
        let Some((&first, rest)) = self.bytes.split_first() else { return 0 };
        self.bytes = rest;
        first
    }

    /// From 0 to less than `count`, which is at most 256.
    pub(super) fn below(&mut self, count: usize) -> usize {
        usize::from(self.byte()) * count / 256
    }

    /// One time in so many.
    pub(super) fn one_in(&mut self, count: usize) -> Option<()> {
        (self.below(count) == 1).then_some(())
    }

    fn id(&mut self) -> ShapeId {
        NonZeroU64::MIN.saturating_add(self.below(IDS) as u64)
    }

    fn neighbourhood(&mut self) -> Neighbourhood {
        // The first is the busiest, so that shapes meet.
        let number = [0, 0, 0, 1, 1, 2][self.below(6)];
        self.neighbourhoods[number]
    }

    /// From −1 to 1; often a multiple of a quarter, so that faces meet.
    fn share(&mut self) -> f64 {
        let part = f64::from(self.byte() as i8);
        if self.byte() & 1 == 0 { part / 127.0 } else { (part / 32.0).round() / 4.0 }
    }

    pub(super) fn shares(&mut self) -> DVec3 {
        DVec3::new(self.share(), self.share(), self.share())
    }

    fn position(&mut self, at: Neighbourhood) -> DVec3 {
        within(at.origin + self.shares() * at.scale * 3.0)
    }

    pub(super) fn rotation(&mut self) -> DQuat {
        let (axis, w) = (self.shares(), self.share());
        match self.below(3) {
            0 => DQuat::IDENTITY,
            _ if axis == DVec3::ZERO && w.abs() <= 0.0 => DQuat::IDENTITY,
            _ => DQuat::from_xyzw(axis.x, axis.y, axis.z, w),
        }
    }

    fn size(&mut self, at: Neighbourhood) -> f64 {
        ((f64::from(self.byte()) + 1.0) / 128.0 * at.scale).clamp(1e-3, Limits::SIZE_MAX)
    }

    fn geometry(&mut self, at: Neighbourhood) -> Arc<Geometry> {
        let sizes = DVec3::new(self.size(at), self.size(at), self.size(at));
        let made = self.form(at, sizes).or_else(|_| Geometry::cuboid(sizes));
        Arc::new(made.expect("sizes are within limits"))
    }

    fn form(&mut self, at: Neighbourhood, sizes: DVec3) -> Result<Geometry, GeometryError> {
        match self.below(16) {
            0..=2 => Geometry::cuboid(sizes),
            3 | 4 => Geometry::sphere(sizes.x),
            5 | 6 => Geometry::capsule(sizes.x, sizes.y),
            7 => Geometry::cylinder(sizes.x, sizes.y),
            8 => Geometry::ellipsoid(sizes),
            9 => {
                let roof = [DVec3::Y, DVec3::X, DVec3::Z, DVec3::NEG_X, DVec3::NEG_Z].map(|corner| corner * sizes);
                Geometry::mesh(&roof, &[[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 1]])
            }
            10 => {
                let points: Vec<DVec3> = (0..8).map(|_| self.shares() * at.scale.min(Limits::SIZE_MAX)).collect();
                Geometry::hull(&points)
            }
            11 => Geometry::half_space(self.shares(), 0.0),
            12 => concave::tent(self, sizes),
            13 => concave::terrain(self, sizes),
            _ => {
                let scale = [1.0, 0.5, 3.0][self.below(3)];
                concave::cluster(self, sizes, 3).and_then(|whole| whole.scaled(scale))
            }
        }
    }

    fn shape(&mut self) -> Shape {
        let (id, at) = (self.id(), self.neighbourhood());
        // Now and then a neighbour of quite another size.
        let of = if self.one_in(8).is_some() { self.neighbourhood() } else { at };
        let position = self.position(at);
        self.positions[id.get() as usize - 1] = position;
        Shape {
            id,
            geometry: self.geometry(of),
            pose: Pose::new(position, self.rotation()),
            layers: 1 << self.below(3),
            collides_with: u32::from(self.byte() % 8) | 1,
            mobility: [Mobility::Static, Mobility::Dynamic, Mobility::Dynamic, Mobility::Kinematic][self.below(4)],
            bullet: false,
            sensor: self.one_in(6).is_some(),
            group: self.below(4) as u32,
            user_data: u64::from(self.byte()),
            velocity: DVec3::ZERO,
            angular_velocity: DVec3::ZERO,
        }
    }

    fn edit(&mut self) -> Edit {
        match self.below(64) {
            0..=19 => Edit::Insert(self.shape()),
            20..=54 => self.motion(),
            55..=62 => Edit::Remove(self.id()),
            _ if self.one_in(4).is_some() => Edit::Clear,
            _ => Edit::Insert(self.shape()),
        }
    }

    /// By a hair, by about a size, to anywhere, to where it is.
    fn motion(&mut self) -> Edit {
        let (id, at) = (self.id(), self.neighbourhood());
        let slot = id.get() as usize - 1;
        let old = self.positions[slot];
        let position = match self.below(6) {
            0 | 1 => Some(within(old + self.shares() * at.scale * 0.01)),
            2 => Some(within(old + self.shares() * at.scale)),
            3 => Some(self.position(at)),
            4 => Some(old),
            _ => None,
        };
        self.positions[slot] = position.unwrap_or(old);
        Edit::Move {
            id,
            position,
            rotation: self.one_in(2).map(|()| self.rotation()),
            velocity: self.one_in(4).map(|()| self.shares() * at.scale),
            angular_velocity: self.one_in(4).map(|()| self.shares()),
            teleport: self.one_in(3).is_some(),
        }
    }

    fn subject(&mut self) -> Subject {
        let at = self.neighbourhood();
        let pose = Pose::new(self.position(at), self.rotation());
        match self.below(4) {
            0 => Subject::Shape { id: self.id(), pose: None },
            1 => Subject::Shape { id: self.id(), pose: Some(pose) },
            _ => Subject::Geometry { geometry: self.geometry(at), pose },
        }
    }

    fn mode(&mut self) -> HitMode {
        match self.below(6) {
            0 => HitMode::Closest,
            1 => HitMode::Any,
            2 => HitMode::All(usize::MAX),
            3 => HitMode::All(2),
            kind => HitMode::Pierce { layers: self.below(8) as u32, most: if kind == 4 { usize::MAX } else { 1 } },
        }
    }

    /// From one place to another, of the same neighbourhood or not.
    fn way(&mut self) -> (DVec3, DVec3) {
        let (from, to) = (self.neighbourhood(), self.neighbourhood());
        let (from, to) = (self.position(from), self.position(to));
        (from, if to == from { from + DVec3::X } else { to })
    }

    fn distance(&mut self) -> f64 {
        let at = self.neighbourhood();
        [0.0, at.scale * 0.5, at.scale * 10.0, 4e12][self.below(4)]
    }

    fn question(&mut self) -> Question {
        match self.below(5) {
            0 => {
                let (origin, to) = self.way();
                let ray = Ray {
                    origin,
                    direction: to - origin,
                    min_distance: self.one_in(5).map_or(0.0, |()| self.distance()),
                    max_distance: self.distance(),
                    hollow: self.one_in(3).is_some(),
                    faces: [Faces::Both, Faces::Both, Faces::Front, Faces::Back][self.below(4)],
                };
                Question::Raycast(Raycast { ray, mode: self.mode() })
            }
            1 => Question::Overlap(Overlap { subject: self.subject(), against: None, max_hits: 1 + self.below(60) }),
            2 => Question::Penetration(Penetration {
                subject: self.subject(),
                against: None,
                max_gap: self.distance().min(Limits::COORDINATE),
                max_contacts: 1 + self.below(60),
            }),
            3 => {
                let (from, to) = self.way();
                let motion = TimeOfImpact {
                    subject: self.subject(),
                    displacement: within(to - from),
                    rotation: self.one_in(3).map_or(DVec3::ZERO, |()| self.shares()),
                    against: None,
                    against_displacement: DVec3::ZERO,
                    against_rotation: DVec3::ZERO,
                    initial: if self.one_in(3).is_some() { InitialTouch::IsIgnored } else { InitialTouch::Counts },
                    mode: self.mode(),
                };
                Question::TimeOfImpact(motion)
            }
            _ => Question::Distance(Distance {
                subject: self.subject(),
                against: None,
                max_distance: self.distance(),
                max_hits: 1 + self.below(5),
            }),
        }
    }

    fn filter(&mut self) -> Filter {
        if self.one_in(2).is_some() {
            return Filter::default();
        }
        Filter {
            layers: self.one_in(3).map(|()| 3),
            collides_with: self.one_in(3).map(|()| 5),
            exclude_ids: (0..self.below(3)).map(|_| self.id()).collect(),
            exclude_sensors: self.one_in(3).is_some(),
            exclude_static: self.one_in(4).is_some(),
            exclude_groups: (0..self.below(2)).map(|_| self.below(4) as u32).collect(),
        }
    }
}

fn within(position: DVec3) -> DVec3 {
    position.clamp(DVec3::splat(-Limits::COORDINATE), DVec3::splat(Limits::COORDINATE))
}

impl Iterator for Script<'_> {
    type Item = Step;

    fn next(&mut self) -> Option<Step> {
        if self.bytes.is_empty() {
            return None;
        }
        if self.one_in(3).is_some() {
            let count = 1 + self.below(EDITS);
            return Some(Step::Tick((0..count).map(|_| self.edit()).collect()));
        }
        Some(Step::Ask(Box::new((self.question(), self.filter()))))
    }
}
