//! Holds exact answers to the oracle, which shares nothing with the kernels.
//!
//! # Method
//! The shape that an answer names is judged against the oracle's signed distance, or stretch of a line, to 32 digits. Of a nearest
//! shape, some others whose boxes are as near must not be nearer. Of an impact, the two forms must be apart by no less than nothing at the lower end of its
//! interval, and by no more at the upper.
//!
//! # Limits
//! Convex forms of few corners only; what of an impact lies between is not looked at.

use collision::{
    DVec3,
    answer::Verdict,
    math::{Aabb, Pose},
    shape::{Convex, Core as Kept, Form, Geometry, HeightField},
    world::Subject,
};
use glam::DQuat;

use super::{
    ask::{Answer, Found},
    questions::Question,
};
use crate::{
    oracle::{Core, PlacedSolid, Solid, Truth, scale, stretch_inside},
    scenes::Scene,
};

/// More corners than this take the oracle too long.
const CORNERS_MAX: usize = 12;

/// Other shapes that are looked at beside the nearest.
const OTHERS_MAX: usize = 4;

/// What poses on the way of a motion are rounded by, as a part of the pair's extent, and of the coordinates.
const ROUNDING: [f64; 2] = [1e-12, 1e-15];

fn solid(geometry: &Geometry) -> Option<Solid> {
    let is_small = |core: &Core| !matches!(core, Core::Hull(points) if points.len() > CORNERS_MAX);
    solid_of_any_size(geometry).filter(|solid| is_small(&solid.core))
}

fn solid_of_any_size(geometry: &Geometry) -> Option<Solid> {
    let Form::Convex(Convex { core, radius }) = geometry.form() else { return None };
    let core = match core {
        Kept::Point => Core::Point,
        Kept::Segment { half_height } => Core::Segment { half_height: *half_height },
        Kept::Cuboid { half_extents } => Core::Cuboid { half_extents: *half_extents },
        Kept::Hull(hull) => Core::Hull(hull.vertices().to_vec()),
        Kept::Cylinder { half_height, radius } => Core::Cylinder { half_height: *half_height, radius: *radius },
        Kept::Cone { half_height, radius } => Core::Cone { half_height: *half_height, radius: *radius },
        Kept::Ellipsoid { radii } => Core::Ellipsoid { radii: *radii },
        Kept::Triangle(_) => return None,
    };
    Some(Solid { core, radius: *radius })
}

fn placed(geometry: &Geometry, pose: &Pose) -> Option<PlacedSolid> {
    Some(PlacedSolid { solid: solid(geometry)?, position: pose.position, rotation: pose.rotation })
}

fn of_subject(subject: &Subject) -> Option<PlacedSolid> {
    match subject {
        Subject::Geometry { geometry, pose } => placed(geometry, pose),
        Subject::Shape { .. } => None,
    }
}

/// Whether an exact answer is true; `None` if the oracle cannot tell.
pub(super) fn audit(scene: &Scene, question: &Question, answer: &Answer) -> Option<Result<(), String>> {
    let main = answer.main().filter(|main| main.verdict == Verdict::Hit)?;
    let item = scene.item(main.id)?;
    let shape = placed(&item.geometry, &item.pose)?;
    let is_true = match question {
        Question::Raycast(question) => {
            let stretch = stretch_inside(&shape, question.ray.origin, question.ray.direction);
            stretch.is_some_and(|stretch| {
                let enter = stretch.enter.map(|way| way.max(0.0));
                enter[0] <= main.bound.upper && main.bound.lower <= enter[1] && stretch.leave[1] >= 0.0
            })
        }
        Question::Overlap(question) => !Truth::of(&of_subject(&question.subject)?, &shape, &[]).is_above(0.0),
        Question::Distance(question) => {
            let subject = of_subject(&question.subject)?;
            let truth = Truth::of(&subject, &shape, &[]);
            let holds =
                !truth.is_above(main.bound.upper) && (main.bound.lower <= 0.0 || !truth.is_below(main.bound.lower));
            holds && none_is_nearer(scene, question, &subject, main)
        }
        Question::Penetration(question) => {
            let truth = Truth::of(&of_subject(&question.subject)?, &shape, &[]);
            !truth.is_above(-main.bound.lower) && !truth.is_likely_below(-main.bound.upper)
        }
        Question::Impact(question, way) => {
            let subject = of_subject(&question.subject)?;
            let at = |fraction: f64| PlacedSolid {
                position: subject.position + question.displacement * fraction,
                rotation: DQuat::from_scaled_axis(question.rotation * fraction) * subject.rotation,
                ..subject.clone()
            };
            let [before, after] = [main.bound.lower, main.bound.upper].map(|metres| at(metres / way));
            let far = subject.position.abs().max_element() + question.displacement.abs().max_element();
            let slack = ROUNDING[0] * scale(&subject, &shape) + ROUNDING[1] * far;
            let begins = main.bound.lower <= 0.0 || !Truth::of(&before, &shape, &[]).is_below(-slack);
            begins && !Truth::of(&after, &shape, &[]).is_above(slack)
        }
    };
    Some(if is_true { Ok(()) } else { Err(format!("the oracle says otherwise than {main:?}")) })
}

/// No other shape whose box is as near is surely nearer.
fn none_is_nearer(scene: &Scene, question: &collision::world::Distance, subject: &PlacedSolid, main: &Found) -> bool {
    let Subject::Geometry { geometry, pose } = &question.subject else { return true };
    let own = geometry.bounds(pose);
    let as_near = scene.items.iter().filter(|item| gap(own, item.geometry.bounds(&item.pose)) < main.bound.lower);
    let others = as_near.filter_map(|item| placed(&item.geometry, &item.pose)).take(OTHERS_MAX);
    others.into_iter().all(|other| !Truth::of(subject, &other, &[]).is_below(main.bound.lower))
}

fn gap(a: Aabb, b: Aabb) -> f64 {
    (a.min - b.max).max(b.min - a.max).max(DVec3::ZERO).length()
}

/// How deep the subject is in the triangles that a contact may mean, along the normal that it tells, and how far that may be off; metres. `None`
/// if it is none with a triangle; empty if it is one that nothing is known of, such as a wall of a height field.
///
/// Which way out a contact with a surface is told along is the answer's own choice, so its depth is held to that.
pub(super) fn depths_along(scene: &Scene, question: &Question, contact: &Found) -> Option<Vec<[f64; 2]>> {
    let (Question::Penetration(question), Some(normal)) = (question, contact.normal) else { return None };
    let Subject::Geometry { geometry, pose } = &question.subject else { return None };
    let item = scene.item(contact.id)?;
    let triangles = match (item.geometry.form(), contact.features[1].face?) {
        (Form::Mesh(mesh), face) => vec![mesh.corners(mesh.kept_number(face)?)],
        (Form::HeightField(field), cell) => surface_of_cell(field, cell as usize),
        (Form::Convex(_) | Form::HalfSpace(_) | Form::Compound(_), _) => return None,
    };
    // About the subject's own place, so that no digit is lost far from the origin.
    let place = item.pose.position - pose.position;
    let low = -support_height(&solid_of_any_size(geometry)?, pose.matrix().transpose() * -normal);
    let off = ROUNDING[0] * (place.length() + geometry.reach() + item.geometry.reach());
    let depth = |corners: [DVec3; 3]| {
        let heights = corners.map(|corner| normal.dot(place + item.pose.matrix() * corner));
        [heights.into_iter().fold(f64::MIN, f64::max) - low, off]
    };
    Some(triangles.into_iter().map(depth).collect())
}

/// Two triangles, to both sides of the diagonal through the first corner; none at the border, where there are walls.
fn surface_of_cell(field: &HeightField, cell: usize) -> Vec<[DVec3; 3]> {
    let [wide, long] = [field.columns() - 1, field.rows() - 1];
    let (column, row) = (cell % wide, cell / wide);
    if column == 0 || row == 0 || column + 1 >= wide || row + 1 >= long {
        return Vec::new();
    }
    let at = |column: usize, row: usize| {
        let height = f64::from(field.heights()[row * field.columns() + column]);
        DVec3::new(column as f64, height, row as f64) * field.spacing()
    };
    let [a, d] = [at(column, row), at(column + 1, row + 1)];
    vec![[a, at(column, row + 1), d], [a, d, at(column + 1, row)]]
}

/// How far a form reaches along a unit vector of its own frame.
fn support_height(solid: &Solid, along: DVec3) -> f64 {
    let across = along.x.hypot(along.z);
    let core = match &solid.core {
        Core::Point | Core::HalfSpace { .. } => 0.0,
        Core::Segment { half_height } => half_height * along.y.abs(),
        Core::Cuboid { half_extents } => half_extents.dot(along.abs()),
        Core::Hull(points) => points.iter().map(|point| point.dot(along)).fold(f64::MIN, f64::max),
        Core::Cylinder { half_height, radius } => half_height * along.y.abs() + radius * across,
        Core::Cone { half_height, radius } => (half_height * along.y).max(radius * across - half_height * along.y),
        Core::Ellipsoid { radii } => (*radii * along).length(),
    };
    core + solid.radius
}
