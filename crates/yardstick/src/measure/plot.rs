//! Time across, true error up, both logarithmic, as SVG.
//!
//! # Method
//! A point for each setting, told by its title when the pointer rests on it; a line along the settings that no other beats in both.
//! Colours are readable on light and on dark ground, those of letters too where nothing says which it is.

use std::fmt::Write;

use super::{Kind, Knob, Row};

const WIDTH: f64 = 720.0;
const HEIGHT: f64 = 380.0;
/// Left, right, top, bottom.
const MARGINS: [f64; 4] = [74.0, 168.0, 34.0, 48.0];

/// Of knobs, in their order.
const COLOURS: [&str; 9] =
    ["#d1495b", "#2f7fd0", "#1f9e89", "#c77d0a", "#8a63d2", "#6b7f2a", "#c2569b", "#4a8fa8", "#9a6b4f"];

const STYLE: &str = "<style>.plot text{font:12px system-ui,sans-serif;fill:#737373}.plot .axis{stroke:#8888;stroke-width:1}\
.plot .grid{stroke:#8883;stroke-width:1}.plot .front{fill:none;stroke:#888;stroke-width:1.5;stroke-dasharray:5 4}\
.plot .name{font-weight:600}@media(prefers-color-scheme:dark){.plot text{fill:#ddd}}</style>";

/// A logarithmic axis.
struct Axis {
    /// Logarithms of its ends.
    ends: [f64; 2],
    /// Where these are, pixels.
    pixels: [f64; 2],
}

impl Axis {
    fn over(values: impl Iterator<Item = f64>, pixels: [f64; 2]) -> Self {
        let (low, high) = values
            .filter(|value| *value > 0.0 && value.is_finite())
            .map(f64::log10)
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)));
        let (low, high) = if low <= high { (low, high) } else { (-1.0, 0.0) };
        // Less than a decade would make much of little.
        let room = (0.06 * (high - low)).max(0.5 * (1.0 - (high - low)));
        Self { ends: [low - room, high + room], pixels }
    }

    /// Values that are none, or 0, lie at the lower end.
    fn at(&self, value: f64) -> f64 {
        let log = if value > 0.0 { value.log10().clamp(self.ends[0], self.ends[1]) } else { self.ends[0] };
        let share = (log - self.ends[0]) / (self.ends[1] - self.ends[0]);
        self.pixels[0] + share * (self.pixels[1] - self.pixels[0])
    }

    /// Powers of ten, or ones, twos and fives of them where there are few.
    fn ticks(&self) -> Vec<f64> {
        let decades = self.ends[1] - self.ends[0];
        let step = (decades / 6.0).ceil().max(1.0) as i32;
        let first = self.ends[0].floor() as i32;
        let last = self.ends[1].ceil() as i32;
        let factors: &[f64] = if decades < 2.0 { &[1.0, 2.0, 5.0] } else { &[1.0] };
        let all = (first..=last).filter(|power| power.rem_euclid(step) == 0);
        let all = all.flat_map(|power| factors.iter().map(move |factor| factor * 10_f64.powi(power)));
        all.filter(|value| (self.ends[0]..=self.ends[1]).contains(&value.log10())).collect()
    }
}

fn time_text(ns: f64) -> String {
    match ns {
        ns if ns < 1e3 => format!("{ns:.0} ns"),
        ns if ns < 1e6 => format!("{:.3} µs", ns / 1e3).replace(".000", ""),
        ns => format!("{:.3} ms", ns / 1e6).replace(".000", ""),
    }
}

fn error_text(error: f64, kind: Kind) -> String {
    match kind {
        Kind::Overlap => format!("{} %", (error * 1e5).round() / 1e3),
        _ if error == 0.0 => "0".to_owned(),
        _ => format!("{error:.0e} m"),
    }
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

/// The error that a plot shows.
fn error_of(row: &Row) -> f64 {
    row.error[2]
}

fn told(row: &Row) -> String {
    let [_, half, most] = row.time_ns;
    let error = match row.kind {
        Kind::Overlap => format!("left open {:.1} %", row.open * 100.0),
        _ => format!(
            "error at most {:.1e} m (half of all {:.1e}), width at most {:.1e} m",
            row.error[2], row.error[0], row.width[2]
        ),
    };
    let note = if row.note.is_empty() { String::new() } else { format!("; {}", row.note) };
    format!(
        "{} {}: p50 {}, p99 {}; {error}; {:.1} iterations, {:.1} nodes{note}; {}",
        row.knob.text(),
        row.label,
        time_text(half.round()),
        time_text(most.round()),
        row.work[0],
        row.work[1],
        row.request,
    )
}

/// A plot of the rows of one kind of question on one scene.
#[must_use]
pub fn svg(rows: &[&Row]) -> String {
    let [left, right, top, bottom] = MARGINS;
    let Some(first) = rows.first() else { return String::new() };
    let x = Axis::over(rows.iter().map(|row| row.time_ns[1]), [left, WIDTH - right]);
    // The lower end is for errors that are 0.
    let mut y = Axis::over(rows.iter().map(|row| error_of(row)), [HEIGHT - bottom, top]);
    y.ends[0] -= 0.08 * (y.ends[1] - y.ends[0]);
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"plot\" viewBox=\"0 0 {WIDTH} {HEIGHT}\" role=\"img\" \
         aria-label=\"{}\">{STYLE}",
        escaped(&format!("{}, {}: error over time", first.scene, first.kind.text()))
    );
    axes(&mut out, &x, &y, first.kind);
    let title = escaped(&format!("{}: {}", first.scene, first.kind.text()));
    let _ = write!(out, "<text class=\"name\" x=\"{left}\" y=\"18\">{title}</text>");
    let front = front(rows).into_iter().map(|row| format!("{:.1},{:.1}", x.at(row.time_ns[1]), y.at(error_of(row))));
    let _ = write!(out, "<polyline class=\"front\" points=\"{}\"/>", front.collect::<Vec<_>>().join(" "));
    let is_tier = |row: &&&Row| row.knob == Knob::Tier;
    for row in rows.iter().filter(|row| !is_tier(row)).chain(rows.iter().filter(is_tier)) {
        let (cx, cy) = (x.at(row.time_ns[1]), y.at(error_of(row)));
        let colour = COLOURS[row.knob as usize];
        let (radius, ring) =
            if row.knob == Knob::Tier { (6.5, " stroke=\"#fff\" stroke-width=\"1.5\"") } else { (4.5, "") };
        let tip = escaped(&told(row));
        let _ = write!(
            out,
            "<circle cx=\"{cx:.1}\" cy=\"{cy:.1}\" r=\"{radius}\" fill=\"{colour}\" fill-opacity=\".85\"{ring}><title>{tip}</title></circle>"
        );
        if row.knob == Knob::Tier {
            label(&mut out, [cx, cy], &row.label);
        }
    }
    legend(&mut out, rows);
    out.push_str("</svg>\n");
    out
}

/// The name of a tier over or under its point: each at a height of its own, as tiers are often in one place, and none below the axis.
fn label(out: &mut String, [x, cy]: [f64; 2], name: &str) {
    let is_low = cy + 20.0 > HEIGHT - MARGINS[3];
    let y = match name {
        "FAST" => cy - 11.0,
        "STANDARD" if is_low => cy - 37.0,
        "STANDARD" => cy + 19.0,
        _ => cy - 24.0,
    };
    let _ = write!(out, "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"middle\">{}</text>", escaped(name));
}

fn axes(out: &mut String, x: &Axis, y: &Axis, kind: Kind) {
    let [left, right, top, bottom] = MARGINS;
    let (low, far) = (HEIGHT - bottom, WIDTH - right);
    for value in x.ticks() {
        let (at, text) = (x.at(value), time_text(value));
        let _ = write!(out, "<line class=\"grid\" x1=\"{at:.1}\" x2=\"{at:.1}\" y1=\"{top}\" y2=\"{low}\"/>");
        let _ = write!(out, "<text x=\"{at:.1}\" y=\"{}\" text-anchor=\"middle\">{text}</text>", low + 18.0);
    }
    for value in y.ticks().into_iter().filter(|value| y.at(*value) < low - 13.0) {
        let (at, text) = (y.at(value), error_text(value, kind));
        let _ = write!(out, "<line class=\"grid\" x1=\"{left}\" x2=\"{far}\" y1=\"{at:.1}\" y2=\"{at:.1}\"/>");
        let _ = write!(out, "<text x=\"{}\" y=\"{:.1}\" text-anchor=\"end\">{text}</text>", left - 6.0, at + 4.0);
    }
    let _ = write!(out, "<text x=\"{}\" y=\"{:.1}\" text-anchor=\"end\">0</text>", left - 6.0, low + 4.0);
    let _ = write!(out, "<path class=\"axis\" fill=\"none\" d=\"M{left} {top}V{low}H{far}\"/>");
    let what = if kind == Kind::Overlap { "left open" } else { "largest true error" };
    let _ = write!(out, "<text x=\"{}\" y=\"{}\" text-anchor=\"end\">time of a question (p50)</text>", far, low + 38.0);
    let _ = write!(out, "<text x=\"{left}\" y=\"{}\">↑ {what}</text>", low + 38.0);
}

fn legend(out: &mut String, rows: &[&Row]) {
    let mut y = MARGINS[2] + 8.0;
    let x = WIDTH - MARGINS[1] + 16.0;
    for knob in Knob::ALL.into_iter().filter(|knob| rows.iter().any(|row| row.knob == *knob)) {
        let colour = COLOURS[knob as usize];
        let _ = write!(out, "<circle cx=\"{x}\" cy=\"{}\" r=\"4.5\" fill=\"{colour}\"/>", y - 4.0);
        let _ = write!(out, "<text x=\"{}\" y=\"{y}\">{}</text>", x + 11.0, escaped(knob.text()));
        y += 20.0;
    }
}

/// The rows that no other beats in time and error, by time.
fn front<'a>(rows: &[&'a Row]) -> Vec<&'a Row> {
    let mut sorted: Vec<&Row> = rows.to_vec();
    sorted.sort_by(|a, b| a.time_ns[1].total_cmp(&b.time_ns[1]).then(error_of(a).total_cmp(&error_of(b))));
    let mut least = f64::INFINITY;
    sorted.retain(|row| {
        let is_better = error_of(row) < least;
        least = least.min(error_of(row));
        is_better
    });
    sorted
}
