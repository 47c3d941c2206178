//! Answers of the domain as they are sent: finite numbers only, and no side of an interval that is not known.

use collision::{
    answer::{Bound, Certificate, Feature, Method, Representation, Stop, Verdict, Work},
    narrow::ContactPoint,
    world::{
        Contact, Found, Impact, Neighbor, OverlapHit, PAIRS_MAX, Pair, PairChanges, QuestionError, RayHit, ShapeId,
        SweepHit, Swept, Tick,
    },
};
use wire::v1 as pb;

use super::{
    place::{number_out, vec3_out},
    question::{half_space_subject, shape_not_found},
};
use crate::{
    deadline::Deadline,
    past,
    problem::{Checked, Problem, Reason},
};

/// A ray's answer; who sends it adds what was read.
///
/// # Errors
/// A number is not finite, which is a fault of the server.
pub(crate) fn raycast(found: &Found<RayHit>) -> Checked<pb::RaycastResponse> {
    Ok(pb::RaycastResponse {
        verdict: verdict(found.verdict).into(),
        hits: all_out(&found.hits, ray_hit)?,
        truncated: found.truncated,
        info: None,
    })
}

/// An overlap's answer; who sends it adds what was read.
///
/// # Errors
/// As [`raycast`].
pub(crate) fn overlap(found: &Found<OverlapHit>) -> Checked<pb::OverlapResponse> {
    let hit = |hit: &OverlapHit| {
        Ok(pb::OverlapHit {
            id: id_or_none(hit.id),
            user_data: hit.user_data,
            certificate: Some(certificate(&hit.certificate)?),
        })
    };
    Ok(pb::OverlapResponse {
        verdict: verdict(found.verdict).into(),
        hits: all_out(&found.hits, hit)?,
        truncated: found.truncated,
        info: None,
    })
}

/// A depth's answer; who sends it adds what was read.
///
/// # Errors
/// As [`raycast`].
pub(crate) fn penetration(found: &Found<Contact>) -> Checked<pb::PenetrationResponse> {
    Ok(pb::PenetrationResponse {
        verdict: verdict(found.verdict).into(),
        contacts: all_out(&found.hits, contact)?,
        truncated: found.truncated,
        info: None,
    })
}

/// A time's answer; who sends it adds what was read.
///
/// # Errors
/// As [`raycast`].
pub(crate) fn time_of_impact(found: &Found<Impact>) -> Checked<pb::TimeOfImpactResponse> {
    Ok(pb::TimeOfImpactResponse {
        verdict: verdict(found.verdict).into(),
        hits: all_out(&found.hits, impact)?,
        truncated: found.truncated,
        info: None,
    })
}

/// A distance's answer; who sends it adds what was read.
///
/// # Errors
/// As [`raycast`].
pub(crate) fn distance(found: &Found<Neighbor>) -> Checked<pb::DistanceResponse> {
    Ok(pb::DistanceResponse {
        verdict: verdict(found.verdict).into(),
        hits: all_out(&found.hits, neighbor)?,
        info: None,
    })
}

/// All of a list as it is sent, in a list that is no larger than that: what is collected with errors on the way makes room for four.
///
/// # Errors
/// The first of an item's.
pub(super) fn all_out<T, U>(found: &[T], out: impl Fn(&T) -> Checked<U>) -> Checked<Vec<U>> {
    let mut sent = Vec::with_capacity(found.len());
    for item in found {
        sent.push(out(item)?);
    }
    Ok(sent)
}

/// What bullets touched in a tick.
///
/// # Errors
/// As [`raycast`].
pub(crate) fn sweep_hits(swept: &Swept) -> Checked<Vec<pb::SweepHit>> {
    let hit = |hit: &SweepHit| Ok(pb::SweepHit { bullet_id: hit.bullet.get(), impact: Some(impact(&hit.impact)?) });
    swept.hits.iter().map(hit).collect()
}

/// A pair of a list, and what became of it if that was asked.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ListedPair {
    /// The pair.
    pub(crate) pair: Pair,
    /// What became of it.
    pub(crate) change: Option<pb::PairChange>,
}

/// Which pairs changed and how, ascending by ids.
pub(crate) fn pair_changes(changes: &PairChanges) -> Vec<ListedPair> {
    let listed = |change| move |pair: &Pair| ListedPair { pair: *pair, change: Some(change) };
    let persisted = changes.persisted.iter().map(|persisted| &persisted.pair);
    let mut all: Vec<ListedPair> = changes.began.iter().map(listed(pb::PairChange::Began)).collect();
    all.extend(persisted.map(listed(pb::PairChange::Persisted)));
    all.extend(changes.ended.iter().map(listed(pb::PairChange::Ended)));
    all.sort_unstable_by_key(|listed| (listed.pair.a, listed.pair.b));
    all
}

/// A part of a list of pairs; who sends it adds what was read.
pub(crate) fn pairs(part: &[ListedPair]) -> pb::PairsResponse {
    pb::PairsResponse {
        pairs: Some(pb::PairColumns {
            a: part.iter().map(|listed| listed.pair.a.get()).collect(),
            b: part.iter().map(|listed| listed.pair.b.get()).collect(),
        }),
        verdicts: part.iter().map(|listed| verdict(listed.pair.certificate.verdict).into()).collect(),
        info: None,
        changes: part.iter().filter_map(|listed| listed.change).map(i32::from).collect(),
    }
}

/// What an answer cost.
pub(crate) fn work(work: &Work) -> pb::Work {
    pb::Work {
        nodes_visited: work.nodes_visited,
        shapes_tested: work.shapes_tested,
        pairs_tested: work.pairs_tested,
        iterations: work.iterations,
    }
}

/// What a client is told whose question has no answer.
pub(crate) fn refused(error: &QuestionError, tick: Tick) -> Problem {
    match error {
        QuestionError::SubjectNotFound(id) => shape_not_found("subject.id", id.get(), tick),
        QuestionError::AgainstNotFound(id) => shape_not_found("against.id", id.get(), tick),
        QuestionError::SubjectUnbounded(id) => {
            let field = if id.is_some() { "subject.id" } else { "subject.geometry" };
            half_space_subject(field)
        }
        QuestionError::SubjectNotConvex(id) => {
            let field = if id.is_some() { "subject.id" } else { "subject.geometry" };
            let what = "is not convex: a character is, such as {\"capsule\": {\"half_height\": 0.5, \"radius\": 0.4}}";
            Problem::at(field, Reason::BadGeometry, what)
        }
        QuestionError::Skin(error) => Problem::at(
            "skin",
            Reason::OutOfLimits,
            format!(": {error}; the character and its skin are too large or small; leave skin out for 0.01 metres"),
        ),
        QuestionError::NeedsDecomposition(id) => {
            let with = id.map_or_else(|| "the geometry in against".to_owned(), |id| format!("shape {id}"));
            let what = format!(
                "the subject and {with} both have meshes, or one is a solid mesh and the other is deep in it: a depth needs \
                 convex parts; name an error (options.accuracy.max_error) to have some made, send a mesh with `decompose`, place \
                 hulls, or ask Overlap or Distance"
            );
            Problem::new(Reason::NeedsDecomposition, what).with_shape(id_or_none(*id))
        }
        QuestionError::PartsMissing { with, wanted } => parts_missing(*with, wanted.len(), 0.0),
        QuestionError::TooManyPairs => {
            let what = format!("{error}: leave shapes out with options.filter, or part those that lie in one place");
            Problem::new(Reason::QuotaExceeded, what).with("quota", "pairs").with("limit", PAIRS_MAX)
        }
        QuestionError::TooLong(limit) => {
            let what = format!("{error}: ask for less, with a looser accuracy or a narrower options.filter");
            Problem::new(Reason::QuotaExceeded, what).with("quota", "question_steps").with("limit", limit)
        }
        QuestionError::History(error) => past::refused(error),
        QuestionError::Interrupted => Deadline::problem(),
    }
}

/// The same where convex parts of so many meshes are missing, which are so far, from 0 to 1.
pub(crate) fn parts_missing(with: Option<ShapeId>, mesh_count: usize, progress: f32) -> Problem {
    let meshes = if mesh_count == 1 { "mesh" } else { "meshes" };
    let what = format!(
        "convex parts that this depth needs are being made, of {mesh_count} {meshes}: ask again a little later (a looser max_error \
         is ready sooner)"
    );
    Problem::new(Reason::GeometryNotReady, what).with("progress", progress).with_shape(id_or_none(with))
}

/// The same where the mesh came with the question.
pub(crate) fn parts_of_nobody() -> Problem {
    let what = "this depth needs convex parts of a mesh that is sent with the question, which nobody would find again: register it \
                with CreateGeometry and name it by `geometry_id`, or ask Overlap or Distance";
    Problem::new(Reason::NeedsDecomposition, what)
}

fn ray_hit(hit: &RayHit) -> Checked<pb::RayHit> {
    let touch = &hit.touch;
    Ok(pb::RayHit {
        id: id_or_none(hit.id),
        distance: Some(number_out(touch.distance)?),
        point: Some(vec3_out(touch.point)?),
        normal: touch.normal.map(vec3_out).transpose()?,
        inside: touch.inside,
        feature: feature(touch.feature),
        user_data: hit.user_data,
        certificate: Some(certificate(&touch.certificate)?),
        barycentric: touch.barycentric.map(vec3_out).transpose()?,
        pierced: hit.pierced,
    })
}

pub(super) fn contact(contact: &Contact) -> Checked<pb::Contact> {
    Ok(pb::Contact {
        id: id_or_none(contact.id),
        normal: Some(vec3_out(contact.normal)?),
        depth: Some(number_out(contact.depth)?),
        points: all_out(&contact.points, contact_point)?,
        subject_feature: feature(contact.subject_feature),
        feature: feature(contact.feature),
        user_data: contact.user_data,
        certificate: Some(certificate(&contact.certificate)?),
    })
}

fn contact_point(point: &ContactPoint) -> Checked<pb::ContactPoint> {
    Ok(pb::ContactPoint {
        point_on_subject: Some(vec3_out(point.point_on_a)?),
        point_on_shape: Some(vec3_out(point.point_on_b)?),
        depth: Some(number_out(point.depth)?),
        feature_pair: point.feature_pair,
    })
}

pub(super) fn impact(impact: &Impact) -> Checked<pb::Impact> {
    let touch = &impact.touch;
    Ok(pb::Impact {
        id: id_or_none(impact.id),
        fraction: Some(number_out(touch.fraction)?),
        point: Some(vec3_out(touch.point)?),
        normal: touch.normal_b_to_a.map(vec3_out).transpose()?,
        initial: touch.initial,
        feature: feature(touch.feature_b),
        user_data: impact.user_data,
        certificate: Some(certificate(&touch.certificate)?),
        pierced: impact.pierced,
    })
}

fn neighbor(neighbor: &Neighbor) -> Checked<pb::Neighbor> {
    let separation = &neighbor.separation;
    Ok(pb::Neighbor {
        id: id_or_none(neighbor.id),
        distance: Some(number_out(separation.distance)?),
        point_on_subject: Some(vec3_out(separation.point_on_a)?),
        point_on_shape: Some(vec3_out(separation.point_on_b)?),
        normal: separation.normal_b_to_a.map(vec3_out).transpose()?,
        feature: feature(separation.feature_b),
        user_data: neighbor.user_data,
        certificate: Some(certificate(&separation.certificate)?),
        subject_feature: feature(separation.feature_a),
    })
}

pub(super) fn certificate(certificate: &Certificate) -> Checked<pb::Certificate> {
    Ok(pb::Certificate {
        verdict: verdict(certificate.verdict).into(),
        interval: Some(interval(certificate.bound)?),
        representation: representation(certificate.model.representation).into(),
        outside: number_out(certificate.model.outside)?,
        inside: number_out(certificate.model.inside)?,
        method: method(certificate.method).into(),
        stop: stop(certificate.stop).into(),
        iterations: certificate.iterations,
    })
}

/// An infinite side is absent; NaN is a fault.
pub(super) fn interval(bound: Bound) -> Checked<pb::Interval> {
    let side = |value: f64| match value.is_infinite() {
        true => Ok(None),
        false => number_out(value).map(Some),
    };
    Ok(pb::Interval { lower: side(bound.lower)?, upper: side(bound.upper)? })
}

pub(super) fn verdict(verdict: Verdict) -> pb::Verdict {
    match verdict {
        Verdict::Hit => pb::Verdict::Hit,
        Verdict::Miss => pb::Verdict::Miss,
        Verdict::Undecided => pb::Verdict::Undecided,
    }
}

/// Shared with what is told of geometries.
pub(super) fn representation(representation: Representation) -> pb::Representation {
    match representation {
        Representation::Ball => pb::Representation::Sphere,
        Representation::OrientedBox => pb::Representation::OrientedBox,
        Representation::SimplifiedHull => pb::Representation::SimplifiedHull,
        Representation::Decomposition => pb::Representation::Decomposition,
        Representation::Exact => pb::Representation::Exact,
    }
}

fn method(method: Method) -> pb::Method {
    match method {
        Method::Bounds => pb::Method::Bounds,
        Method::ClosedForm => pb::Method::ClosedForm,
        Method::SeparatingAxes => pb::Method::SeparatingAxes,
        Method::Gjk => pb::Method::Gjk,
        Method::Epa => pb::Method::Epa,
        Method::Advancement => pb::Method::Advancement,
    }
}

fn stop(stop: Stop) -> pb::Stop {
    match stop {
        Stop::Converged => pb::Stop::Converged,
        Stop::Tolerance => pb::Stop::Tolerance,
        Stop::Budget => pb::Stop::Budget,
    }
}

fn feature(feature: Feature) -> Option<pb::Feature> {
    let Feature { part, face } = feature;
    (part.is_some() || face.is_some()).then_some(pb::Feature { part, face })
}

pub(super) fn id_or_none(id: Option<ShapeId>) -> u64 {
    id.map_or(0, ShapeId::get)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_open_side_of_an_interval_is_absent_and_a_negative_zero_is_none() {
        let open = interval(Bound::UNBOUNDED).unwrap();
        assert_eq!((open.lower, open.upper), (None, None));
        let touching = interval(Bound::new(-0.0, 0.5)).unwrap();
        assert!(touching.lower.unwrap().is_sign_positive());
        assert_eq!(touching.upper, Some(0.5));
        interval(Bound::new(f64::NAN, 1.0)).unwrap_err();
    }

    #[test]
    fn a_feature_that_says_nothing_is_absent() {
        assert_eq!(feature(Feature::default()), None);
        let face = Feature { part: None, face: Some(0) };
        assert_eq!(feature(face).unwrap().face, Some(0));
    }
}
