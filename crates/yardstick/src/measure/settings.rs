//! What is turned, and how far.

use collision::{
    accuracy::{Accuracy, Tier},
    shape::{Convex, Core, Form, Geometry},
    world::Mobility,
};

use super::Kind;
use crate::scenes::Scene;

/// What is turned.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Knob {
    /// `Accuracy.tier`.
    Tier,
    /// `Accuracy.max_error`, metres.
    MaxError,
    /// `Accuracy.max_error_relative`.
    MaxErrorRelative,
    /// `Accuracy.budget`, iterations.
    Budget,
    /// The same relative errors, with no stand-in allowed.
    NoStandIns,
    /// The static tree, built at once, or the dynamic one that grew shape by shape.
    Tree,
    /// `WorldSettings.margin`, metres.
    Margin,
    /// Hulls of fewer corners in place of those sent.
    HullVertices,
    /// `Decompose.max_error` of the meshes, as a part of their diagonal.
    PartsError,
}

impl Knob {
    /// All of them.
    pub const ALL: [Self; 9] = [
        Self::Tier,
        Self::MaxError,
        Self::MaxErrorRelative,
        Self::Budget,
        Self::NoStandIns,
        Self::Tree,
        Self::Margin,
        Self::HullVertices,
        Self::PartsError,
    ];

    /// As it is written.
    #[must_use]
    pub const fn text(self) -> &'static str {
        match self {
            Self::Tier => "tier",
            Self::MaxError => "max_error",
            Self::MaxErrorRelative => "max_error_relative",
            Self::Budget => "budget",
            Self::NoStandIns => "no stand-ins",
            Self::Tree => "tree",
            Self::Margin => "margin",
            Self::HullVertices => "hull vertices",
            Self::PartsError => "parts' error",
        }
    }
}

/// The world that a setting asks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Stage {
    /// As the scene is.
    Plain,
    /// Everything in the dynamic tree, put in one by one.
    OneByOne,
    /// Everything in the static tree.
    AllStatic,
    /// What moves has moved to and fro for some ticks, with this margin; `None` is the one that tunes itself.
    Moved(Option<f64>),
    /// Hulls have at most this many corners.
    Hulls(usize),
    /// Meshes have convex parts to within this part of their diagonal.
    Parts(f64),
}

/// A way to ask.
#[derive(Clone, Debug)]
pub struct Setting {
    /// What is turned.
    pub knob: Knob,
    /// How far.
    pub label: String,
    /// What is asked of answers.
    pub accuracy: Accuracy,
    /// The same as `QueryOptions.accuracy` says it, in JSON.
    pub request: String,
    /// Which world is asked.
    pub stage: Stage,
}

/// Decades of a tolerance.
const DECADES: i32 = 10;

fn tier_name(tier: Tier) -> &'static str {
    match tier {
        Tier::Fast => "TIER_FAST",
        Tier::Standard => "TIER_STANDARD",
        Tier::Exact => "TIER_EXACT",
    }
}

/// A power of ten, by its own digits: what is printed is what is asked.
fn power_of_ten(exponent: i32) -> f64 {
    format!("1e{exponent}").parse().unwrap_or(1.0)
}

impl Setting {
    /// The tier alone.
    #[must_use]
    pub fn of_tier(tier: Tier) -> Self {
        let name = tier_name(tier);
        Self {
            knob: Knob::Tier,
            label: name.trim_start_matches("TIER_").to_owned(),
            accuracy: Accuracy::of(tier),
            request: format!(r#"{{"tier":"{name}"}}"#),
            stage: Stage::Plain,
        }
    }

    /// An error in metres.
    #[must_use]
    pub fn of_error(max_error: f64) -> Self {
        Self {
            knob: Knob::MaxError,
            label: format!("{max_error:e} m"),
            accuracy: Accuracy { max_error, max_error_relative: 0.0, ..Accuracy::default() },
            request: format!(r#"{{"maxError":{max_error:e}}}"#),
            stage: Stage::Plain,
        }
    }

    fn of_relative(max_error_relative: f64) -> Self {
        Self {
            knob: Knob::MaxErrorRelative,
            label: format!("{max_error_relative:e}"),
            accuracy: Accuracy { max_error_relative, ..Accuracy::default() },
            request: format!(r#"{{"maxErrorRelative":{max_error_relative:e}}}"#),
            stage: Stage::Plain,
        }
    }

    fn of_relative_without(max_error_relative: f64) -> Self {
        Self {
            knob: Knob::NoStandIns,
            accuracy: Accuracy { max_error_relative, ..Accuracy::of(Tier::Exact) },
            request: format!(r#"{{"tier":"TIER_EXACT","maxErrorRelative":{max_error_relative:e}}}"#),
            ..Self::of_relative(max_error_relative)
        }
    }

    fn of_budget(budget: u32) -> Self {
        Self {
            knob: Knob::Budget,
            label: budget.to_string(),
            accuracy: Accuracy { budget, ..Accuracy::of(Tier::Exact) },
            request: format!(r#"{{"tier":"TIER_EXACT","budget":{budget}}}"#),
            stage: Stage::Plain,
        }
    }

    fn on(stage: Stage, knob: Knob, label: String, accuracy: Self) -> Self {
        Self { knob, label, stage, ..accuracy }
    }

    /// Settings that a request alone makes, tightest last in each knob.
    #[must_use]
    pub fn of_requests(scene: &Scene) -> Vec<Self> {
        let first = scene.size.log10().ceil() as i32;
        let mut all: Vec<Self> = [Tier::Fast, Tier::Standard, Tier::Exact].map(Self::of_tier).to_vec();
        all.extend((0..DECADES).map(|decade| Self::of_error(power_of_ten(first - decade))));
        all.extend((0..DECADES).map(|decade| Self::of_relative(power_of_ten(-decade))));
        all.extend([1, 4, 8, 16, 32, 64].map(Self::of_budget));
        all.extend((0..4).map(|decade| Self::of_relative_without(power_of_ten(-decade))));
        all
    }

    /// All that can be turned for a kind of question on a scene.
    #[must_use]
    pub fn all(scene: &Scene, kind: Kind) -> Vec<Self> {
        let mut all = Self::of_requests(scene);
        let exact = || Self::of_tier(Tier::Exact);
        if scene.items.len() > 8 {
            let tree = |stage, label: &str| Self::on(stage, Knob::Tree, label.to_owned(), exact());
            all.extend([tree(Stage::AllStatic, "static, built at once"), tree(Stage::OneByOne, "dynamic, one by one")]);
        }
        if scene.items.iter().filter(|item| item.mobility != Mobility::Static).count() > 8 {
            for part in [Some(0.0), Some(0.01), Some(0.1), Some(1.0), None] {
                let margin = part.map(|part| part * scene.size);
                let label =
                    margin.map_or("tunes itself".to_owned(), |margin| format!("{} m", (margin * 1e6).round() / 1e6));
                all.push(Self::on(Stage::Moved(margin), Knob::Margin, label, exact()));
            }
        }
        let has = |test: fn(&Geometry) -> bool| scene.items.iter().any(|item| test(&item.geometry));
        if matches!(kind, Kind::Distance | Kind::Penetration) && has(is_large_hull) {
            for count in [8, 16, 32, 64, 128] {
                all.push(Self::on(Stage::Hulls(count), Knob::HullVertices, count.to_string(), exact()));
            }
        }
        if kind == Kind::Distance && has(|geometry| matches!(geometry.form(), Form::Mesh(_))) {
            for percent in [20.0, 10.0, 5.0, 2.5] {
                let of = Self::of_relative(0.1);
                all.push(Self::on(Stage::Parts(percent / 100.0), Knob::PartsError, format!("{percent} %"), of));
            }
        }
        all
    }
}

fn is_large_hull(geometry: &Geometry) -> bool {
    matches!(geometry.form(), Form::Convex(Convex { core: Core::Hull(hull), .. }) if hull.vertices().len() > 8)
}
