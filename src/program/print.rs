//! Answers as text for people.

use calipers_client::proto::{self, Verdict};

/// A ray's answer: a line for each hit.
pub(crate) fn raycast(answer: &proto::RaycastResponse) -> String {
    let tick = tick_of(answer.info.as_ref());
    let mut lines = vec![match answer.verdict() {
        Verdict::Miss => format!("miss: the way is proved free (tick {tick})"),
        verdict => format!("{} (tick {tick})", word(verdict)),
    }];
    for hit in &answer.hits {
        let certificate = hit.certificate.as_ref();
        let mut line = format!("  {}shape {} at ", doubt(certificate), hit.id);
        line += &format!("{} m", number(hit.distance.unwrap_or_default()));
        line += &format!(" {}, point {}", interval(certificate), vector(hit.point));
        if hit.inside {
            line += ", the ray begins inside";
        } else if hit.normal.is_some() {
            line += &format!(", normal {}", vector(hit.normal));
        }
        if let Some(face) = hit.feature.and_then(|feature| feature.face) {
            line += &format!(", face {face}");
        }
        lines.push(line);
    }
    if answer.truncated {
        lines.push("  … and more than that".to_owned());
    }
    lines.join("\n")
}

/// An overlap's answer: a line for each shape.
pub(crate) fn overlap(answer: &proto::OverlapResponse) -> String {
    let tick = tick_of(answer.info.as_ref());
    let mut lines = vec![match answer.verdict() {
        Verdict::Miss => format!("miss: nothing touches it, proved (tick {tick})"),
        verdict => format!("{}: {} (tick {tick})", word(verdict), count(answer.hits.len() as u64, "shape")),
    }];
    for hit in &answer.hits {
        lines.push(format!("  {}shape {}", doubt(hit.certificate.as_ref()), hit.id));
    }
    if answer.truncated {
        lines.push("  … and more than that".to_owned());
    }
    lines.join("\n")
}

/// A world: what it holds and what that costs.
pub(crate) fn world(world: &proto::DescribeWorldResponse) -> String {
    let mut lines = vec![
        format!("tick {} (ticks from {} on can be read)", world.tick, world.oldest_tick),
        format!("{}, {} of them static", count(world.shape_count, "shape"), world.static_count),
    ];
    if let Some(bounds) = &world.bounds {
        lines.push(format!("between {} and {}", vector(bounds.min), vector(bounds.max)));
        lines.push(format!("nothing out there is known better than {:.1e} m", world.coordinate_step));
    }
    lines.push(format!(
        "{}, {}, {} of them undecided",
        count(world.edit_count, "edit"),
        count(world.question_count, "question"),
        world.undecided_count
    ));
    if world.tree_depth > 0 {
        lines.push(format!("dynamic tree: {} deep, cost {}", world.tree_depth, number(world.tree_cost)));
    }
    if let Some(took) = &world.last_commit {
        lines.push(format!("the last commit took {}", seconds(took)));
    }
    lines.push(format!("{} in memory", bytes(world.memory_bytes)));
    for built in &world.built {
        let mut line = format!("  {}: {}, {}", built.name, built.count, bytes(built.memory_bytes));
        if let Some(time) = &built.build_time {
            line += &format!(", built in {}", seconds(time));
        }
        if built.first_tick > 0 {
            line += &format!(", first needed at tick {}", built.first_tick);
        }
        lines.push(line);
    }
    lines.join("\n")
}

/// A count with its noun.
pub(crate) fn count(count: u64, noun: &str) -> String {
    if count == 1 { format!("1 {noun}") } else { format!("{count} {noun}s") }
}

pub(crate) fn word(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Hit => "hit",
        Verdict::Miss => "miss",
        Verdict::Undecided => "undecided",
        Verdict::Unspecified => "no verdict",
    }
}

fn doubt(certificate: Option<&proto::Certificate>) -> &'static str {
    match certificate.map(proto::Certificate::verdict) {
        Some(Verdict::Undecided) => "perhaps ",
        _ => "",
    }
}

fn tick_of(info: Option<&proto::AnswerInfo>) -> u64 {
    info.map_or(0, |info| info.tick)
}

/// The width of the interval says more at a glance than its ends, which agree in most of their digits.
fn interval(certificate: Option<&proto::Certificate>) -> String {
    let interval = certificate.and_then(|certificate| certificate.interval.as_ref());
    match interval.map(|interval| (interval.lower, interval.upper)) {
        Some((Some(lower), Some(upper))) => format!("(known within {:.1e} m)", upper - lower),
        Some((Some(lower), None)) => format!("(at least {lower} m)"),
        Some((None, Some(upper))) => format!("(at most {upper} m)"),
        Some((None, None)) | None => "(not bounded)".to_owned(),
    }
}

/// Six decimals at most, and no more than there are.
pub(crate) fn number(value: f64) -> String {
    let text = format!("{value:.6}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}

pub(crate) fn vector(vector: Option<proto::Vec3>) -> String {
    let proto::Vec3 { x, y, z } = vector.unwrap_or_default();
    format!("({}, {}, {})", number(x), number(y), number(z))
}

fn seconds(time: &prost_types::Duration) -> String {
    let seconds = time.seconds as f64 + f64::from(time.nanos) * 1e-9;
    if seconds < 1e-3 {
        format!("{:.1} µs", seconds * 1e6)
    } else if seconds < 1.0 {
        format!("{:.2} ms", seconds * 1e3)
    } else {
        format!("{seconds:.2} s")
    }
}

fn bytes(count: u64) -> String {
    const KIBIBYTE: f64 = 1024.0;
    let size = count as f64;
    if size < KIBIBYTE {
        format!("{count} bytes")
    } else if size < KIBIBYTE * KIBIBYTE {
        format!("{:.1} KiB", size / KIBIBYTE)
    } else {
        format!("{:.1} MiB", size / (KIBIBYTE * KIBIBYTE))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_no_idle_digits() {
        for (value, text) in [(4.0, "4"), (0.1, "0.1"), (-0.0, "0"), (-1e-9, "0"), (1.0 / 3.0, "0.333333")] {
            assert_eq!(number(value), text);
        }
    }

    #[test]
    fn a_miss_says_that_it_is_proved() {
        let answer = proto::RaycastResponse { verdict: Verdict::Miss.into(), ..Default::default() };
        assert!(raycast(&answer).starts_with("miss: the way is proved free"));
    }

    #[test]
    fn what_is_not_proved_reads_as_perhaps() {
        let certificate = proto::Certificate { verdict: Verdict::Undecided.into(), ..Default::default() };
        let hit = proto::OverlapHit { id: 7, certificate: Some(certificate), ..Default::default() };
        let answer =
            proto::OverlapResponse { verdict: Verdict::Undecided.into(), hits: vec![hit], ..Default::default() };
        let text = overlap(&answer);
        assert!(text.starts_with("undecided: 1 shape") && text.contains("perhaps shape 7"), "{text}");
    }
}
