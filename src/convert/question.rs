//! Questions: what is asked about, by whom, how exactly and of which version.

use std::sync::Arc;

use collision::{
    DVec3,
    accuracy::{Accuracy, Tier},
    math::Pose,
    narrow::{Faces, InitialTouch, Ray},
    shape::Geometry,
    world::{Distance, Filter, HitMode, Overlap, Penetration, Raycast, Snapshot, Subject, Tick, TimeOfImpact},
};
use wire::v1::{self as pb, geometry::Kind, read_at::At, subject::Form};

use super::{
    geometry::{is_half_space, of_question},
    number::{FROM_ZERO_TO_REACH, REACH, at_most, count, finite, shape_id, time, unknown_enum, within},
    place::{direction, pose, position},
};
use crate::{
    geometries::Geometries,
    problem::{Checked, Problem, Reason, Under},
    session::ReadAt,
};

const EXCLUDED_IDS: usize = 1024;
const EXCLUDED_GROUPS: usize = 64;
const LISTED_HITS: usize = 10_000;

/// Which version is asked for.
///
/// # Errors
/// A number out of range, a fraction without a tick.
pub(crate) fn read_at(sent: Option<&pb::ReadAt>) -> Checked<ReadAt> {
    let Some(sent) = sent else { return Ok(ReadAt::Newest) };
    let fraction = finite("tick_fraction", sent.tick_fraction)?;
    if !(0.0..1.0).contains(&fraction) {
        let what = format!("is {fraction}: it must be from 0 to below 1");
        return Err(Problem::at("tick_fraction", Reason::OutOfLimits, what));
    }
    if fraction > 0.0 && !matches!(sent.at, Some(At::Tick(_))) {
        let what = "goes with tick only: leave it out, or name a tick";
        return Err(Problem::at("tick_fraction", Reason::OutOfLimits, what));
    }
    let tick = |field, tick: u64| {
        Tick::new(tick).ok_or_else(|| {
            Problem::at(field, Reason::OutOfLimits, "is 0: ticks begin at 1; leave read_at out for the newest")
        })
    };
    match &sent.at {
        None => Ok(ReadAt::Newest),
        Some(At::Tick(number)) => Ok(ReadAt::Tick(tick("tick", *number)?, fraction)),
        Some(At::MinTick(number)) => Ok(ReadAt::MinTick(tick("min_tick", *number)?)),
        Some(At::Time(at)) => time("time", at).map(ReadAt::Time),
    }
}

/// How exact an answer must be.
///
/// # Errors
/// A number out of range, a tier that does not exist.
pub(crate) fn accuracy(sent: Option<&pb::Accuracy>) -> Checked<Accuracy> {
    let Some(sent) = sent else {
        return Ok(Accuracy::default());
    };
    let tier = match pb::Tier::try_from(sent.tier) {
        Ok(pb::Tier::Unspecified | pb::Tier::Standard) => Tier::Standard,
        Ok(pb::Tier::Fast) => Tier::Fast,
        Ok(pb::Tier::Exact) => Tier::Exact,
        Err(_) => {
            let names = "TIER_FAST (1), TIER_STANDARD (2), TIER_EXACT (3)";
            return Err(unknown_enum("tier", sent.tier, names));
        }
    };
    let mut accuracy = Accuracy::of(tier);
    if let Some(max_error) = sent.max_error {
        accuracy.max_error = within("max_error", max_error, 0.0..=f64::MAX, "at least 0 metres")?;
        accuracy.max_error_relative = 0.0;
    }
    if let Some(relative) = sent.max_error_relative {
        accuracy.max_error_relative = within("max_error_relative", relative, 0.0..=1.0, "0 to 1")?;
    }
    if let Some(budget) = sent.budget {
        if !(1..=65_536).contains(&budget) {
            let what = format!("is {budget}: it must be 1 to 65536");
            return Err(Problem::at("budget", Reason::OutOfLimits, what));
        }
        accuracy.budget = budget;
    }
    Ok(accuracy)
}

/// Which shapes a question sees.
///
/// # Errors
/// A list that is too long, an id 0.
pub(crate) fn filter(sent: Option<&pb::Filter>) -> Checked<Filter> {
    let Some(sent) = sent else { return Ok(Filter::default()) };
    at_most("exclude_ids", sent.exclude_ids.len(), EXCLUDED_IDS)?;
    at_most("exclude_groups", sent.exclude_groups.len(), EXCLUDED_GROUPS)?;
    let mut exclude_ids = Vec::with_capacity(sent.exclude_ids.len());
    for (index, &id) in sent.exclude_ids.iter().enumerate() {
        let checked = shape_id("", id).map_err(|problem| problem.at_field(format!("exclude_ids[{index}]")));
        exclude_ids.push(checked?);
    }
    Ok(Filter {
        layers: sent.layers,
        collides_with: sent.collides_with,
        exclude_ids,
        exclude_sensors: sent.exclude_sensors,
        exclude_static: sent.exclude_static,
        exclude_groups: sent.exclude_groups.clone(),
    })
}

/// A ray's question.
///
/// # Errors
/// What is wrong with it.
pub(crate) fn raycast(sent: &pb::RaycastRequest) -> Checked<Raycast> {
    let reach = 0.0..=REACH;
    let max_distance = sent.max_distance.unwrap_or(REACH);
    let max_distance = within("max_distance", max_distance, reach.clone(), FROM_ZERO_TO_REACH)?;
    let min_distance = within("min_distance", sent.min_distance, reach, FROM_ZERO_TO_REACH)?;
    if min_distance > max_distance {
        let what = format!(
            "is {min_distance}, above max_distance, {max_distance}: nothing lies between; leave one of the two out"
        );
        return Err(Problem::at("min_distance", Reason::OutOfLimits, what));
    }
    Ok(Raycast {
        ray: Ray {
            origin: position(sent.origin.as_ref(), DVec3::ZERO).under("origin")?,
            direction: direction("direction", sent.direction.as_ref())?,
            min_distance,
            max_distance,
            hollow: sent.hollow,
            faces: faces(sent.faces)?,
        },
        mode: hit_mode(sent.mode, sent.max_hits, sent.pierce_layers)?,
    })
}

/// An overlap's question.
///
/// # Errors
/// What is wrong with it.
pub(crate) fn overlap(sent: &pb::OverlapRequest, known: &Geometries) -> Checked<Overlap> {
    Ok(Overlap {
        subject: subject(sent.subject.as_ref(), known)?,
        against: against(sent.against.as_deref(), known)?,
        max_hits: count("max_hits", sent.max_hits, 1000, 65_536)?,
    })
}

/// A depth's question.
///
/// # Errors
/// What is wrong with it.
pub(crate) fn penetration(sent: &pb::PenetrationRequest, known: &Geometries) -> Checked<Penetration> {
    Ok(Penetration {
        subject: subject(sent.subject.as_ref(), known)?,
        against: against(sent.against.as_deref(), known)?,
        max_gap: within("max_gap", sent.max_gap, 0.0..=REACH, FROM_ZERO_TO_REACH)?,
        max_contacts: count("max_contacts", sent.max_contacts, 64, 4096)?,
    })
}

/// A distance's question.
///
/// # Errors
/// What is wrong with it.
pub(crate) fn distance(sent: &pb::DistanceRequest, known: &Geometries) -> Checked<Distance> {
    let max_distance = sent.max_distance.unwrap_or(REACH);
    Ok(Distance {
        subject: subject(sent.subject.as_ref(), known)?,
        against: against(sent.against.as_deref(), known)?,
        max_distance: within("max_distance", max_distance, 0.0..=REACH, FROM_ZERO_TO_REACH)?,
        max_hits: count("max_hits", sent.max_hits, 1, 4096)?,
    })
}

/// A time's question. The version is read for the poses of shapes that move from where they are.
///
/// # Errors
/// What is wrong with it, a shape that is not there.
pub(crate) fn time_of_impact(
    sent: &pb::TimeOfImpactRequest,
    known: &Geometries,
    world: &Snapshot,
) -> Checked<TimeOfImpact> {
    let subject = subject(sent.subject.as_ref(), known)?;
    let against = against(sent.against.as_deref(), known)?;
    let (displacement, rotation) = motion("end", &subject, sent.end.as_ref(), world, "subject.id")?;
    let (against_displacement, against_rotation) = match (&against, &sent.against_end) {
        (_, None) => (DVec3::ZERO, DVec3::ZERO),
        (Some(against), end) => motion("against_end", against, end.as_ref(), world, "against.id")?,
        (None, Some(_)) => {
            let what = "goes with against only: leave it out, or say what moves there";
            return Err(Problem::at("against_end", Reason::OutOfLimits, what));
        }
    };
    Ok(TimeOfImpact {
        subject,
        displacement,
        rotation,
        against,
        against_displacement,
        against_rotation,
        initial: if sent.ignore_initial { InitialTouch::IsIgnored } else { InitialTouch::Counts },
        mode: hit_mode(sent.mode, sent.max_hits, sent.pierce_layers)?,
    })
}

/// How a subject gets from its pose to its end: how far it goes, and how it turns along the shorter arc.
fn motion(
    field: &'static str,
    subject: &Subject,
    end: Option<&pb::Pose>,
    world: &Snapshot,
    id_field: &'static str,
) -> Checked<(DVec3, DVec3)> {
    let start = match subject {
        Subject::Shape { pose: Some(pose), .. } | Subject::Geometry { pose, .. } => *pose,
        &Subject::Shape { id, pose: None } => {
            let shape = world.shape(id).ok_or_else(|| shape_not_found(id_field, id.get(), world.tick()))?;
            shape.pose
        }
    };
    let end = pose(end, start).under(field)?;
    Ok((end.position - start.position, start.rotation_vector_to(&end)))
}

/// What is said of a shape that is not in the version that is read.
pub(crate) fn shape_not_found(field: &str, id: u64, tick: Tick) -> Problem {
    let what =
        format!("is {id}: there is no such shape at tick {tick}; insert it first, or name one that ListShapes tells");
    Problem::at(field, Reason::ShapeNotFound, what).with_shape(id)
}

pub(super) fn subject(sent: Option<&pb::Subject>, known: &Geometries) -> Checked<Subject> {
    let Some(sent) = sent else {
        let what = "is absent: say what is asked about, such as {\"geometry\": {\"sphere\": {\"radius\": 1}}}; {} is a \
                    point at the origin";
        return Err(Problem::at("subject", Reason::Missing, what));
    };
    subject_with_bounds(sent, known).under("subject")
}

/// Only what a question is asked against may be a half space.
fn subject_with_bounds(sent: &pb::Subject, known: &Geometries) -> Checked<Subject> {
    let subject = some_subject(sent, known)?;
    if let (Subject::Geometry { geometry, .. }, Some(Form::Geometry(form))) = (&subject, &sent.form) {
        check_bounded(geometry, form)?;
    }
    Ok(subject)
}

/// Checks that what a question is about is no half space.
pub(super) fn check_bounded(geometry: &Geometry, sent: &pb::Geometry) -> Checked<()> {
    if !is_half_space(geometry) {
        return Ok(());
    }
    let is_named = matches!(sent.kind, Some(Kind::GeometryId(_)));
    Err(half_space_subject(if is_named { "geometry.geometry_id" } else { "geometry.half_space" }))
}

/// What is said of a subject that is a half space.
pub(crate) fn half_space_subject(field: &'static str) -> Problem {
    let what = "is a half space: only `against` and shapes of the world may be one; ask about the other form";
    Problem::at(field, Reason::BadGeometry, what)
}

/// What a question is asked against, if it names that.
///
/// # Errors
/// What is wrong with it.
pub(crate) fn against(sent: Option<&pb::Subject>, known: &Geometries) -> Checked<Option<Subject>> {
    sent.map(|sent| some_subject(sent, known).under("against")).transpose()
}

fn some_subject(sent: &pb::Subject, known: &Geometries) -> Checked<Subject> {
    let placed = |geometry: Arc<Geometry>| {
        let pose = pose(sent.pose.as_ref(), Pose::IDENTITY).under("pose")?;
        Ok(Subject::Geometry { geometry, pose })
    };
    match &sent.form {
        None => placed(Arc::new(Geometry::point())),
        Some(Form::Geometry(form)) => placed(of_question(form, known).under("geometry")?),
        Some(Form::Id(id)) => Ok(Subject::Shape {
            id: shape_id("id", *id)?,
            pose: match &sent.pose {
                None => None,
                Some(_) => Some(pose(sent.pose.as_ref(), Pose::IDENTITY).under("pose")?),
            },
        }),
    }
}

pub(super) fn faces(faces: i32) -> Checked<Faces> {
    match pb::RayFaces::try_from(faces) {
        Ok(pb::RayFaces::Unspecified | pb::RayFaces::Both) => Ok(Faces::Both),
        Ok(pb::RayFaces::Front) => Ok(Faces::Front),
        Ok(pb::RayFaces::Back) => Ok(Faces::Back),
        Err(_) => Err(unknown_enum("faces", faces, "RAY_FACES_BOTH (1), RAY_FACES_FRONT (2), RAY_FACES_BACK (3)")),
    }
}

pub(super) fn hit_mode(mode: i32, max_hits: u32, pierce_layers: Option<u32>) -> Checked<HitMode> {
    let most = count("max_hits", max_hits, 256, LISTED_HITS)?;
    let mode = match pb::HitMode::try_from(mode) {
        Ok(pb::HitMode::Unspecified | pb::HitMode::Closest) => HitMode::Closest,
        Ok(pb::HitMode::Any) => HitMode::Any,
        Ok(pb::HitMode::All) => HitMode::All(most),
        Ok(pb::HitMode::Pierce) => HitMode::Pierce { layers: pierce_layers.unwrap_or(0), most },
        Err(_) => {
            let names = "HIT_MODE_CLOSEST (1), HIT_MODE_ANY (2), HIT_MODE_ALL (3), HIT_MODE_PIERCE (4)";
            return Err(unknown_enum("mode", mode, names));
        }
    };
    if pierce_layers.is_some() && !matches!(mode, HitMode::Pierce { .. }) {
        let what = "goes with HIT_MODE_PIERCE only: leave it out, or set \"mode\": \"HIT_MODE_PIERCE\"";
        return Err(Problem::at("pierce_layers", Reason::OutOfLimits, what));
    }
    Ok(mode)
}
