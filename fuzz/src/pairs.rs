//! Two placed forms and every question about them.

mod motion;
mod rest;
mod warm;

use std::fmt;

use collision::{
    DVec3,
    accuracy::{Accuracy, Tier},
    math::Pose,
    narrow::Placed,
    shape::MeshMode,
};

use crate::{
    forms::{self, Made},
    numbers::{Numbers, pose_code, vector_code, vector_within, within},
};

/// Panics if an answer about the pair that these bytes make breaks a law.
pub fn check(bytes: &[u8]) {
    let numbers = &mut Numbers::new(bytes);
    let Some(case) = Case::new(numbers) else { return };
    rest::check(&case);
    warm::check(&case, numbers);
    motion::check(&case, numbers);
}

/// The case that these bytes make, as code.
#[must_use]
pub fn describe(bytes: &[u8]) -> String {
    Case::new(&mut Numbers::new(bytes)).map_or_else(String::new, |case| case.to_string())
}

/// A pair and what is asked.
pub struct Case {
    a: Made,
    b: Made,
    pose_a: Pose,
    pose_b: Pose,
    accuracy: Accuracy,
    /// The limit of distances, metres.
    limit: f64,
    /// The widest gap of contacts, metres.
    max_gap: f64,
    /// What counts as near, metres.
    margin: f64,
}

impl Case {
    fn new(numbers: &mut Numbers<'_>) -> Option<Self> {
        let a = forms::form(numbers)?;
        let b = match numbers.below(6) {
            0 => a.clone(),
            1 => {
                let scale = [0.5, 2.0, 4.0, 1.0 + f64::EPSILON, 1e-3, 1e3][numbers.below(6)];
                let code = format!("{}.scaled({scale:?}).unwrap()", a.code);
                Made { geometry: a.geometry.clone().scaled(scale).ok()?, code }
            }
            _ => forms::form(numbers)?,
        };
        let pose_a = numbers.pose();
        let pose_b = beside(numbers, &a, &b, &pose_a);
        let tier = [Tier::Exact, Tier::Exact, Tier::Standard, Tier::Fast][numbers.below(4)];
        let mut accuracy = Accuracy::of(tier);
        match numbers.below(8) {
            0 => accuracy.budget = 1 + u32::from(numbers.byte() % 16),
            1 => accuracy.max_error = numbers.number().abs(),
            2 => accuracy.max_error_relative = f64::from(numbers.byte()) / 255.0,
            _ => {}
        }
        let [limit, max_gap, margin] = [f64::INFINITY, 1e12, 1e12].map(|most| numbers.length(most));
        Some(Self { a, b, pose_a, pose_b, accuracy, limit, max_gap: max_gap.min(1e12), margin: margin.min(1e12) })
    }

    fn a(&self) -> Placed<'_> {
        self.a.at(self.pose_a)
    }

    fn b(&self) -> Placed<'_> {
        self.b.at(self.pose_b)
    }

    /// Whether an exact answer must be as narrow as the arithmetic allows.
    fn is_polytopes(&self) -> bool {
        self.a.is_polytope() && self.b.is_polytope()
    }

    /// Whether the two are the same in every number.
    fn is_twins(&self) -> bool {
        self.a.geometry.id() == self.b.geometry.id() && self.pose_a == self.pose_b
    }

    fn is_concave(&self) -> bool {
        self.a.is_concave() || self.b.is_concave()
    }

    /// Whether some mesh is of such a mode.
    fn has_mode(&self, is_such: fn(MeshMode) -> bool) -> bool {
        self.a.has_mode(is_such) || self.b.has_mode(is_such)
    }

    /// Reaches and distance, metres: what rounding is relative to.
    fn extent(&self) -> f64 {
        let reach = |made: &Made, pose: &Pose| match made.geometry.form() {
            // The plane cuts somewhere: what it is measured by is where it lies and where the other is.
            collision::shape::Form::HalfSpace(space) => space.offset.abs() + pose.position.length(),
            _ => made.geometry.reach(),
        };
        let apart = (self.pose_b.position - self.pose_a.position).length();
        reach(&self.a, &self.pose_a) + reach(&self.b, &self.pose_b) + apart
    }

    /// What a point in the world has lost by rounding, metres.
    fn world_rounding(&self) -> f64 {
        let far = self.pose_a.position.length() + self.pose_b.position.length();
        4.0 * f64::EPSILON * far
    }
}

impl fmt::Display for Case {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "    let a = {};", self.a.code)?;
        writeln!(f, "    let b = {};", self.b.code)?;
        writeln!(f, "    let pose_a = {};", pose_code(&self.pose_a))?;
        writeln!(f, "    let pose_b = {};", pose_code(&self.pose_b))?;
        let Accuracy { tier, max_error, max_error_relative, budget } = self.accuracy;
        writeln!(
            f,
            "    let accuracy = Accuracy {{ tier: Tier::{tier:?}, max_error: {max_error:?}, max_error_relative: {max_error_relative:?}, budget: {budget} }};"
        )?;
        writeln!(f, "    let (limit, max_gap, margin) = ({:?}, {:?}, {:?});", self.limit, self.max_gap, self.margin)
    }
}

/// A pose for `b`: anywhere, or where something happens.
fn beside(numbers: &mut Numbers<'_>, a: &Made, b: &Made, pose_a: &Pose) -> Pose {
    let rotation = numbers.rotation();
    let (box_a, box_b) = (a.geometry.bounds(pose_a), b.geometry.bounds(&Pose::new(DVec3::ZERO, rotation)));
    let vertex = |numbers: &mut Numbers<'_>, made: &Made| {
        let bounds = made.geometry.local_bounds();
        let pick = [0, 1, 2].map(|axis| [bounds.min[axis], 0.0, bounds.max[axis]][numbers.below(3)]);
        vector_within(DVec3::from_array(pick))
    };
    let mut position = match numbers.below(8) {
        0 => numbers.vector(),
        1 => pose_a.position,
        2 | 3 => {
            let axis = numbers.below(3);
            let mut offset = numbers.vector();
            let wall = if numbers.byte() & 1 == 0 {
                box_a.max[axis] - box_b.min[axis] - pose_a.position[axis]
            } else {
                box_a.min[axis] - box_b.max[axis] - pose_a.position[axis]
            };
            offset[axis] = if numbers.byte() & 1 == 0 { wall } else { wall * (1.0 + numbers.direction().x * 0.25) };
            pose_a.position + offset
        }
        4 => {
            let reach = |made: &Made| within(made.geometry.reach());
            let apart = (reach(a) + reach(b)) * f64::from(numbers.byte()) / 160.0;
            pose_a.position + numbers.direction().normalize_or_zero() * apart
        }
        5 => {
            let (on_a, on_b) = (vertex(numbers, a), vertex(numbers, b));
            pose_a.transform_point(on_a) - Pose::new(DVec3::ZERO, rotation).transform_point(on_b)
        }
        6 => pose_a.position + numbers.direction() * numbers.number(),
        _ => pose_a.position + numbers.vector(),
    };
    if numbers.below(8) == 0 {
        let axis = numbers.below(3);
        position[axis] = if numbers.byte() & 1 == 0 { position[axis].next_up() } else { position[axis].next_down() };
    }
    Pose::new(vector_within(position), rotation)
}

/// A vector in a message.
fn shown(vector: DVec3) -> String {
    vector_code(vector)
}
