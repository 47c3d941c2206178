//! What a question did, as text for people.

use calipers::replay::{bare, info_of};
use calipers_client::proto::{self, Method, Representation, Stop, answer::Answer, geometry::Kind, question::Question};

use super::print::{count, number, vector, word};
use super::replay_file::to_json;

/// Lines of shapes, pairs and hits that are printed; what is more is counted.
const LINES: usize = 40;

/// What was asked of which shapes, what was done when it was asked again, and what was answered then.
pub(crate) fn of(replay: &proto::Replay, again: &proto::Answer) -> String {
    let mut lines = vec![asked(replay)];
    let between =
        if replay.tick_fraction > 0.0 { format!(", {} on to the next", replay.tick_fraction) } else { String::new() };
    let since =
        if replay.ticks.is_empty() { String::new() } else { format!(", and from tick {} on", replay.earliest_tick) };
    lines.push(format!("at tick {}{between}{since}; answered by calipers {}", replay.tick, replay.program));
    lines.push(format!("it depends on {}:", count(replay.shapes.len() as u64, "shape")));
    lines.extend(cut(&replay.shapes, "shape", shape));
    if replay.shapes_left_out > 0 {
        lines.push(format!("  … and {} that are not kept: what follows may differ for that", replay.shapes_left_out));
    }
    if let Some(info) = info_of(again) {
        lines.push(work(info));
        lines.extend(cut(&info.pairs, "pair", pair));
        if info.pairs_left_out > 0 {
            lines.push(format!("  … and {} more", info.pairs_left_out));
        }
    }
    lines.extend(replay.answer.as_ref().map(answer));
    lines.join("\n")
}

/// A line for each, and one for those that are too many.
fn cut<T>(all: &[T], noun: &str, line: impl Fn(&T) -> String) -> Vec<String> {
    let mut lines: Vec<String> = all.iter().take(LINES).map(line).collect();
    if all.len() > LINES {
        lines.push(format!("  … and {}", count((all.len() - LINES) as u64, &format!("more {noun}"))));
    }
    lines
}

fn asked(replay: &proto::Replay) -> String {
    let Some(question) = replay.question.as_ref().and_then(|question| question.question.as_ref()) else {
        return "nothing was asked".to_owned();
    };
    let (name, json) = match question {
        Question::Raycast(it) => ("raycast", to_json("RaycastRequest", it)),
        Question::Overlap(it) => ("overlap", to_json("OverlapRequest", it)),
        Question::Penetration(it) => ("penetration", to_json("PenetrationRequest", it)),
        Question::TimeOfImpact(it) => ("time of impact", to_json("TimeOfImpactRequest", it)),
        Question::Distance(it) => ("distance", to_json("DistanceRequest", it)),
        Question::MoveCharacter(it) => ("move character", to_json("MoveCharacterRequest", it)),
        Question::FirstTouch(it) => ("first touch", to_json("FirstTouchRequest", it)),
        Question::Depenetrate(it) => ("depenetrate", to_json("DepenetrateRequest", it)),
        Question::Resolve(it) => ("resolve", to_json("ResolveRequest", it)),
        Question::Pairs(it) => ("pairs", to_json("PairsRequest", it)),
    };
    format!("{name} {json}")
}

fn shape(shape: &proto::Shape) -> String {
    let place = shape.pose.as_ref().map_or_else(String::new, |pose| format!(" at {}", vector(pose.position)));
    format!("  shape {}: {}{place}", shape.id, form(shape.geometry.as_ref()))
}

fn form(geometry: Option<&proto::Geometry>) -> String {
    let Some(kind) = geometry.and_then(|geometry| geometry.kind.as_ref()) else { return "no form".to_owned() };
    match kind {
        Kind::Point(_) => "a point".to_owned(),
        Kind::Sphere(it) => format!("a sphere of radius {}", number(it.radius)),
        Kind::Box(it) => format!("a box of half extents {}", vector(it.half_extents)),
        Kind::Capsule(it) => {
            format!("a capsule of half height {}, radius {}", number(it.half_height), number(it.radius))
        }
        Kind::Cylinder(it) => {
            format!("a cylinder of half height {}, radius {}", number(it.half_height), number(it.radius))
        }
        Kind::Cone(it) => format!("a cone of half height {}, radius {}", number(it.half_height), number(it.radius)),
        Kind::Ellipsoid(it) => format!("an ellipsoid of half axes {}", vector(it.radii)),
        Kind::HalfSpace(it) => format!("a half space of offset {}", number(it.offset)),
        Kind::GeometryId(id) => format!("geometry {}…", id.get(..12).unwrap_or(id)),
        Kind::Hull(_) => "a hull".to_owned(),
        Kind::Mesh(_) => "a mesh".to_owned(),
        Kind::HeightField(_) => "a height field".to_owned(),
        Kind::Compound(it) => format!("a compound of {}", count(it.parts.len() as u64, "part")),
    }
}

fn work(info: &proto::AnswerInfo) -> String {
    let work = info.work.unwrap_or_default();
    format!(
        "asked of these alone it visits {}, looks at {}, tests {} of convex pieces in {}:",
        count(work.nodes_visited, "tree node"),
        count(work.shapes_tested, "shape"),
        count(work.pairs_tested, "pair"),
        count(work.iterations, "iteration"),
    )
}

fn pair(pair: &proto::PairAccount) -> String {
    let certificate = pair.certificate.unwrap_or_default();
    let mut line = match pair.subject_id {
        0 => format!("  shape {}: ", pair.id),
        subject => format!("  shape {subject} and shape {}: ", pair.id),
    };
    line += word(certificate.verdict());
    if let Some(interval) = certificate.interval {
        line += &format!(", between {} and {}", side(interval.lower, "-∞"), side(interval.upper, "∞"));
    }
    let method = match certificate.method() {
        Method::Unspecified => "not measured",
        Method::Bounds => "from bounding volumes",
        Method::ClosedForm => "by a formula",
        Method::SeparatingAxes => "by separating axes",
        Method::Gjk => "by GJK",
        Method::Epa => "by an expanding polytope",
        Method::Advancement => "by conservative advancement",
    };
    line += &format!(", {method}");
    let on = match certificate.representation() {
        Representation::Unspecified | Representation::Exact => "",
        Representation::Box => " on boxes",
        Representation::Sphere => " on balls",
        Representation::OrientedBox => " on oriented boxes",
        Representation::SimplifiedHull => " on simplified hulls",
        Representation::Decomposition => " on convex parts",
    };
    line += on;
    line += &format!(", {}", count(certificate.iterations.into(), "iteration"));
    line += match certificate.stop() {
        Stop::Unspecified => "",
        Stop::Converged => ", until it could not get narrower",
        Stop::Tolerance => ", until that was enough",
        Stop::Budget => ", until the budget was spent",
        Stop::Deadline => ", until the deadline",
    };
    let spent = pair.work.unwrap_or_default();
    if spent.pairs_tested > 1 {
        line +=
            &format!(" ({} of pieces, {})", count(spent.pairs_tested, "pair"), count(spent.nodes_visited, "tree node"));
    }
    line
}

fn side(value: Option<f64>, open: &str) -> String {
    value.map_or_else(|| open.to_owned(), |value| value.to_string())
}

/// The answer as it was kept.
fn answer(kept: &proto::Answer) -> String {
    let Some(answer) = &bare(kept.clone()).answer else { return "there is no answer beside it".to_owned() };
    let (verdict, hits, more) = match answer {
        Answer::Raycast(it) => {
            (it.verdict(), hits(&it.hits, |hit| (hit.id, hit.distance, hit.certificate)), it.truncated)
        }
        Answer::Overlap(it) => (it.verdict(), hits(&it.hits, |hit| (hit.id, None, hit.certificate)), it.truncated),
        Answer::Penetration(it) => {
            (it.verdict(), hits(&it.contacts, |hit| (hit.id, hit.depth, hit.certificate)), it.truncated)
        }
        Answer::TimeOfImpact(it) => {
            (it.verdict(), hits(&it.hits, |hit| (hit.id, hit.fraction, hit.certificate)), it.truncated)
        }
        Answer::Distance(it) => (it.verdict(), hits(&it.hits, |hit| (hit.id, hit.distance, hit.certificate)), false),
        Answer::MoveCharacter(it) => {
            let mut lines = vec![format!("  it ends at {}", vector(it.position))];
            lines.extend(hits(&it.hits, |hit| (hit.id, hit.fraction, hit.certificate)));
            (it.verdict(), lines, false)
        }
        Answer::FirstTouch(it) => {
            let impact = |hit: &proto::PastTouch| hit.impact.unwrap_or_default();
            let hits = hits(&it.hits, |hit| (impact(hit).id, impact(hit).fraction, impact(hit).certificate));
            (it.verdict(), hits, it.truncated)
        }
        Answer::Depenetrate(it) => {
            let mut lines =
                vec![format!("  it ends at {}, {} from where it was", vector(it.position), vector(it.translation))];
            lines.extend(hits(&it.contacts, |hit| (hit.id, hit.depth, hit.certificate)));
            (it.verdict(), lines, false)
        }
        Answer::Resolve(it) => return resolved(it),
        Answer::Pairs(it) => return pairs(it),
        Answer::Problem(problem) => return format!("answer: none, {}: {}", problem.reason, problem.message),
    };
    let mut lines = vec![format!("answer: {}", word(verdict))];
    lines.extend(hits);
    if more {
        lines.push("  … and more than that, which was not asked for".to_owned());
    }
    lines.join("\n")
}

/// A line for each body, and one for each impulse.
fn resolved(answer: &proto::ResolveResponse) -> String {
    let mut lines = vec![format!("answer: {}", count(answer.impulses.len() as u64, "impulse"))];
    lines.extend(cut(&answer.changes, "body", |change| {
        let [velocity, turning] = [change.velocity, change.angular_velocity].map(vector);
        format!(
            "  shape {}: velocity {velocity}, angular velocity {turning}, moved by {}",
            change.id,
            vector(change.translation)
        )
    }));
    lines.extend(cut(&answer.impulses, "impulse", |impulse| {
        let [impulse_vector, point] = [impulse.impulse, impulse.point].map(vector);
        format!("  shape {} from shape {}: {impulse_vector} at {point}", impulse.id, impulse.other_id)
    }));
    lines.join("\n")
}

/// A line for each pair.
fn pairs(answer: &proto::PairsResponse) -> String {
    let columns = answer.pairs.clone().unwrap_or_default();
    let pairs: Vec<(usize, (u64, u64))> = columns.a.into_iter().zip(columns.b).enumerate().collect();
    let mut lines = vec![format!("answer: {}", count(pairs.len() as u64, "pair"))];
    lines.extend(cut(&pairs, "pair", |(index, (a, b))| {
        let verdict = answer.verdicts.get(*index).copied().unwrap_or_default();
        let verdict = word(proto::Verdict::try_from(verdict).unwrap_or_default());
        let change = match answer.changes.get(*index).map(|&change| proto::PairChange::try_from(change)) {
            Some(Ok(proto::PairChange::Began)) => ", began",
            Some(Ok(proto::PairChange::Persisted)) => ", went on",
            Some(Ok(proto::PairChange::Ended)) => ", ended",
            _ => "",
        };
        format!("  shape {a} and shape {b}: {verdict}{change}")
    }));
    lines.join("\n")
}

/// A line for each hit: the shape, its best value, and what that is worth.
fn hits<T>(all: &[T], of: impl Fn(&T) -> (u64, Option<f64>, Option<proto::Certificate>)) -> Vec<String> {
    cut(all, "hit", |hit| {
        let (id, value, certificate) = of(hit);
        let certificate = certificate.unwrap_or_default();
        let best = value.map_or_else(String::new, |value| format!(" at {value}"));
        let interval = certificate.interval.unwrap_or_default();
        let bounds = format!("between {} and {}", side(interval.lower, "-∞"), side(interval.upper, "∞"));
        format!("  shape {id}{best}, {}, {bounds}", word(certificate.verdict()))
    })
}
