//! A question as numbers, and finds in a file.

use collision::{
    accuracy::{Accuracy, Tier},
    narrow::{Faces, Ray},
};
use glam::{DQuat, DVec3};
use serde::{Deserialize, Serialize};

use super::{Asked, badness, straight};
use crate::{
    coverage::{self, Kind, MoveQuestion, PlacedWhole, Question, RayQuestion},
    oracle::{Core, PlacedSolid, Solid},
    scene::Random,
};

/// A placed convex form.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Form {
    /// The name of its core.
    pub core: String,
    /// Radius, position, quaternion, and what the core is made of.
    pub numbers: Vec<f64>,
}

/// A question that is nearly answered wrongly.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Find {
    /// Two of a pair or in motion, one of a ray.
    pub forms: Vec<Form>,
    /// Origin and direction of a ray, or both displacements; nothing for a pair at rest.
    pub way: Vec<f64>,
    /// How far the truth was from the middle of the interval, where its ends are 1.
    pub ratio: f64,
}

impl Form {
    fn of(placed: &PlacedSolid) -> Self {
        let (name, core): (&str, Vec<f64>) = match &placed.solid.core {
            Core::Point => ("point", vec![]),
            Core::Segment { half_height } => ("segment", vec![*half_height]),
            Core::Cuboid { half_extents } => ("box", half_extents.to_array().to_vec()),
            Core::Hull(points) => ("hull", points.iter().flat_map(|point| point.to_array()).collect()),
            Core::Cylinder { half_height, radius } => ("cylinder", vec![*half_height, *radius]),
            Core::Cone { half_height, radius } => ("cone", vec![*half_height, *radius]),
            Core::Ellipsoid { radii } => ("ellipsoid", radii.to_array().to_vec()),
            Core::HalfSpace { normal, offset } => ("half_space", vec![normal.x, normal.y, normal.z, *offset]),
        };
        let mut numbers = vec![placed.solid.radius];
        numbers.extend(placed.position.to_array());
        numbers.extend(placed.rotation.to_array());
        numbers.extend(core);
        Self { core: name.into(), numbers }
    }

    fn placed(&self) -> Option<PlacedSolid> {
        let (&radius, rest) = self.numbers.split_first()?;
        let (position, rest) = rest.split_at_checked(3)?;
        let (rotation, core) = rest.split_at_checked(4)?;
        let core = match (self.core.as_str(), core) {
            ("point", []) => Core::Point,
            ("segment", &[half_height]) => Core::Segment { half_height },
            ("box", half_extents) if half_extents.len() == 3 => {
                Core::Cuboid { half_extents: DVec3::from_slice(half_extents) }
            }
            ("hull", points) => Core::Hull(points.chunks_exact(3).map(DVec3::from_slice).collect()),
            ("cylinder", &[half_height, radius]) => Core::Cylinder { half_height, radius },
            ("cone", &[half_height, radius]) => Core::Cone { half_height, radius },
            ("ellipsoid", radii) if radii.len() == 3 => Core::Ellipsoid { radii: DVec3::from_slice(radii) },
            ("half_space", &[x, y, z, offset]) => Core::HalfSpace { normal: DVec3::new(x, y, z), offset },
            _ => return None,
        };
        let (position, rotation) = (DVec3::from_slice(position), DQuat::from_slice(rotation));
        let numbers = self.numbers.iter().all(|number| number.is_finite() && number.abs() <= 1e12);
        let is_placed = numbers && rotation.to_array() != [0.0; 4];
        // A ball that is named an ellipsoid has a radius that is a rounded sum.
        let is_ball = matches!(core, Core::Ellipsoid { radii } if radii.min_element() == radii.max_element());
        // Half spaces take no radius here, and need a normal.
        let is_no_plane = matches!(core, Core::HalfSpace { normal, .. } if normal == DVec3::ZERO || radius != 0.0);
        let is_asked = is_placed && !(is_ball && radius != 0.0) && !is_no_plane && radius >= 0.0;
        is_asked.then_some(PlacedSolid { solid: Solid { core, radius }, position, rotation })
    }
}

impl Find {
    /// A question that a seed names: pairs, rays and motions in turn.
    pub(super) fn random(seed: u64, turn: u64) -> Self {
        let mut random = Random::new(seed);
        let kinds = Kind::ALL;
        let mut kind = |count: usize| kinds[(random.bits() % count as u64) as usize];
        // No two half spaces.
        let kinds = (kind(kinds.len() - 1), kind(kinds.len()));
        if turn % 3 == 1 {
            let question = coverage::ray_question(seed, kinds.0);
            let way = [question.ray.origin, question.ray.direction].map(|v| v.to_array()).concat();
            return Self { forms: vec![Form::of(&question.target)], way, ratio: 0.0 };
        }
        let Question { a, b, .. } = coverage::question(seed, kinds);
        let mut way = Vec::new();
        if turn % 3 == 2 {
            let ahead = (a.position - b.position) * random.uniform(0.2, 2.0) + random.direction() * a.solid.reach();
            way = [DVec3::ZERO, ahead].map(|v| v.to_array()).concat();
        }
        Self { forms: vec![Form::of(&a), Form::of(&b)], way, ratio: 0.0 }
    }

    /// What is asked: a pair, a ray, a motion.
    #[must_use]
    pub fn sort(&self) -> (usize, bool) {
        (self.forms.len(), self.way.is_empty())
    }

    /// All numbers of it.
    pub(super) fn numbers_mut(&mut self) -> Vec<&mut f64> {
        self.forms.iter_mut().flat_map(|form| &mut form.numbers).chain(&mut self.way).collect()
    }

    /// The question; `None` if the numbers make none.
    #[must_use]
    pub fn asked(&self) -> Option<Asked> {
        let forms: Vec<PlacedSolid> = self.forms.iter().map(Form::placed).collect::<Option<_>>()?;
        let is_finite = self.way.iter().all(|number| number.is_finite() && number.abs() <= 1e12);
        let way: Vec<DVec3> = self.way.chunks_exact(3).map(DVec3::from_slice).collect();
        let accuracy = Accuracy::of(Tier::Exact);
        match (forms.as_slice(), way.as_slice()) {
            _ if !is_finite => None,
            ([target], &[origin, direction]) if direction != DVec3::ZERO => {
                let (target, hollow) = (target.clone(), false);
                let ray = Ray { origin, direction, min_distance: 0.0, max_distance: 4e12, hollow, faces: Faces::Both };
                Some(Asked::Ray(RayQuestion { category: "attack", target, ray }))
            }
            ([a, b], []) => {
                let (a, b, before) = (a.clone(), b.clone(), (b.position, b.rotation));
                let (limit, max_gap) = (f64::INFINITY, 0.0);
                Some(Asked::Pair(Question { category: "attack", a, b, accuracy, limit, max_gap, before }))
            }
            ([a, b], &[way_a, way_b]) => {
                let sides = [a, b].map(|placed| PlacedWhole::from(placed.clone()));
                let motion = straight([way_a, way_b]);
                Some(Asked::Move(MoveQuestion { categories: ["attack"; 2], sides, motion, accuracy }))
            }
            _ => None,
        }
    }

    /// The same with its ratio; `None` if it is no question.
    #[must_use]
    pub fn measured(&self) -> Option<Self> {
        let ratio = badness(&self.asked()?)?;
        Some(Self { ratio, ..self.clone() })
    }
}
