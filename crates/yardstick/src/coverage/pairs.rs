//! Two forms placed so that it is hard to answer, and what is asked of them.
//!
//! Every pair is made from its own seed, so that each can be made again alone.

use std::f64::consts::FRAC_1_SQRT_2;

use collision::accuracy::{Accuracy, Tier};
use glam::{DQuat, DVec3};

use super::forms::{Kind, Style, form, power_of_ten};
use crate::{
    oracle::{PlacedSolid, Truth, scale},
    scene::Random,
};

/// A pair and what is asked of it.
#[derive(Clone, Debug)]
pub struct Question {
    /// What is hard about it.
    pub category: &'static str,
    /// The first form.
    pub a: PlacedSolid,
    /// The second form.
    pub b: PlacedSolid,
    /// How exact the answers must be.
    pub accuracy: Accuracy,
    /// The limit of the distance, metres; mostly infinite.
    pub limit: f64,
    /// The greatest gap of a contact, metres; mostly 0.
    pub max_gap: f64,
    /// Where the second form was when warm questions were asked before: near by, or anywhere.
    pub before: (DVec3, DQuat),
}

/// What is hard about a pair.
#[derive(Clone, Copy, PartialEq)]
enum Category {
    Generic,
    NearTouch,
    ExactTouch,
    Identical,
    Concentric,
    DeepInside,
    SizeRatio,
    FarOffset,
    Aspect,
    NearParallel,
    Denormal,
    Grid,
    Distant,
    Tiny,
    Huge,
}

const CATEGORIES: [(Category, &str); 15] = [
    (Category::Generic, "generic"),
    (Category::NearTouch, "near_touch"),
    (Category::ExactTouch, "exact_touch"),
    (Category::Identical, "identical"),
    (Category::Concentric, "concentric"),
    (Category::DeepInside, "deep_inside"),
    (Category::SizeRatio, "size_ratio"),
    (Category::FarOffset, "far_offset"),
    (Category::Aspect, "aspect"),
    (Category::NearParallel, "near_parallel"),
    (Category::Denormal, "denormal"),
    (Category::Grid, "coplanar"),
    (Category::Distant, "distant"),
    (Category::Tiny, "tiny"),
    (Category::Huge, "huge"),
];

/// What may be hard about a pair, by name.
pub(super) fn extremes() -> impl Iterator<Item = &'static str> {
    CATEGORIES.iter().map(|(_, name)| *name)
}

/// The question that a seed and two kinds name.
#[must_use]
pub fn question(seed: u64, kinds: (Kind, Kind)) -> Question {
    question_at(seed, kinds, None)
}

/// The same, hard in a way that is named.
pub(super) fn question_at(seed: u64, kinds: (Kind, Kind), extreme: Option<&str>) -> Question {
    let mut random = Random::new(seed);
    let (name, a, b) = placed_pair(&mut random, kinds, extreme);
    let s = scale(&a, &b);
    let accuracy = accuracy(&mut random, s);
    let limit = if random.one_in(5) { s * power_of_ten(&mut random, -3.0, 0.5) } else { f64::INFINITY };
    let max_gap = match random.bits() % 4 {
        0 => s * power_of_ten(&mut random, -9.0, 0.5),
        1 => s * 10.0,
        _ => 0.0,
    };
    let before = before(&mut random, &b, s);
    Question { category: name, a, b, accuracy, limit, max_gap, before }
}

/// Two forms of these kinds, placed so that they are hard, in any order; with the name of what is hard about them.
pub(super) fn placed_pair(
    random: &mut Random,
    kinds: (Kind, Kind),
    extreme: Option<&str>,
) -> (&'static str, PlacedSolid, PlacedSolid) {
    let any = CATEGORIES[(random.bits() % CATEGORIES.len() as u64) as usize];
    let named = |extreme| CATEGORIES.into_iter().find(|(_, name)| *name == extreme);
    let (category, name) = extreme.and_then(named).unwrap_or(any);
    let size = match category {
        Category::Tiny => power_of_ten(random, -8.5, -6.0),
        Category::Huge => power_of_ten(random, 6.0, 8.5),
        _ if random.one_in(2) => 1.0,
        _ => power_of_ten(random, -6.0, 6.0),
    };
    let (mut a, mut b) = Maker { random, kinds, size }.pair(category);
    for placed in [&mut a, &mut b] {
        if random.one_in(4) {
            placed.rotation *= stretch(random);
        }
    }
    if random.one_in(2) { (name, b, a) } else { (name, a, b) }
}

/// Where a form was before: a small way off, or anywhere, or just there.
fn before(random: &mut Random, placed: &PlacedSolid, s: f64) -> (DVec3, DQuat) {
    let near = match random.bits() % 4 {
        0 => return (placed.position, placed.rotation),
        1 => return (placed.position + random.direction() * s, random.rotation()),
        _ => power_of_ten(random, -9.0, -1.0),
    };
    let tilt = random.direction() * near;
    let turn = DQuat::from_xyzw(tilt.x, tilt.y, tilt.z, 1.0);
    (placed.position + random.direction() * (near * s), turn * placed.rotation.normalize())
}

/// Lengths of quaternions, very short ones among them.
fn stretch(random: &mut Random) -> f64 {
    match random.bits() % 8 {
        0 => 1e-150,
        1 => 1e150,
        _ => power_of_ten(random, -3.0, 3.0),
    }
}

pub(super) fn accuracy(random: &mut Random, s: f64) -> Accuracy {
    let tier = match random.bits() % 8 {
        0 => Tier::Fast,
        1 => Tier::Standard,
        _ => Tier::Exact,
    };
    let max_error = if random.one_in(4) { s * power_of_ten(random, -13.0, -1.0) } else { 0.0 };
    Accuracy { max_error, ..Accuracy::of(tier) }
}

struct Maker<'a> {
    random: &'a mut Random,
    kinds: (Kind, Kind),
    size: f64,
}

impl Maker<'_> {
    fn pair(&mut self, category: Category) -> (PlacedSolid, PlacedSolid) {
        match category {
            Category::Generic => self.generic(Style::Plain),
            Category::Tiny | Category::Huge => {
                let pair = self.generic(Style::Plain);
                if self.random.one_in(2) { self.near_touch(pair) } else { pair }
            }
            Category::Aspect => {
                let pair = self.generic(Style::Stretched);
                if self.random.one_in(2) { self.near_touch(pair) } else { pair }
            }
            Category::NearTouch => {
                let pair = self.generic(Style::Plain);
                self.near_touch(pair)
            }
            Category::ExactTouch => self.exact_touch(),
            Category::Grid => self.grid(),
            Category::Identical | Category::Concentric => self.about_one_place(category),
            Category::DeepInside => {
                let small = power_of_ten(self.random, -2.0, -0.5);
                let (a, mut b) = self.sized(Style::Plain, small);
                b.position = a.position + self.random.direction() * (self.size * self.random.uniform(0.0, 0.2));
                (a, b)
            }
            Category::SizeRatio => self.size_ratio(),
            Category::FarOffset => {
                let style = if self.random.one_in(4) { Style::Stretched } else { Style::Plain };
                let (mut a, mut b) = self.generic(style);
                let offset = self.random.direction() * power_of_ten(self.random, 3.0, 9.0);
                a.position += offset;
                b.position += offset;
                if self.random.one_in(2) { self.near_touch((a, b)) } else { (a, b) }
            }
            Category::NearParallel => self.near_parallel(),
            Category::Denormal => self.denormal(),
            Category::Distant => {
                let (a, mut b) = self.generic(Style::Plain);
                let far = (self.size * power_of_ten(self.random, 1.0, 9.0)).min(1e11);
                b.position = a.position + self.random.direction() * far;
                (a, b)
            }
        }
    }

    fn placed(&mut self, kind: Kind, style: Style, size: f64) -> PlacedSolid {
        let solid = form(self.random, kind, style, size);
        PlacedSolid { solid, position: self.random.direction() * size, rotation: self.random.rotation() }
    }

    /// Two forms, the second `part` times as large.
    fn sized(&mut self, style: Style, part: f64) -> (PlacedSolid, PlacedSolid) {
        let (kind_a, kind_b) = self.kinds;
        let a = self.placed(kind_a, style, self.size);
        let small = (self.size * part).max(1e-9);
        let b = self.placed(kind_b, style, small);
        (a, b)
    }

    /// Anyhow, some overlapping.
    fn generic(&mut self, style: Style) -> (PlacedSolid, PlacedSolid) {
        let part = self.random.uniform(0.3, 1.0);
        let (a, mut b) = self.sized(style, part);
        let reach = a.solid.reach() + b.solid.reach();
        b.position = a.position + self.random.direction() * (reach * self.random.uniform(0.05, 1.3));
        (a, b)
    }

    /// Moves the second form so that the gap is a small part of the size, of either sign.
    fn near_touch(&mut self, (a, b): (PlacedSolid, PlacedSolid)) -> (PlacedSolid, PlacedSolid) {
        let part = power_of_ten(self.random, -14.0, -1.0);
        let sign = if self.random.one_in(2) { 1.0 } else { -1.0 };
        let gap = sign * part * scale(&a, &b);
        self.at_gap(a, b, gap)
    }

    /// Moves the second form away and then back to this gap along the normal there.
    fn at_gap(&mut self, a: PlacedSolid, mut b: PlacedSolid, gap: f64) -> (PlacedSolid, PlacedSolid) {
        let reach = a.solid.reach() + b.solid.reach();
        let towards = (b.position - a.position).try_normalize().unwrap_or_else(|| self.random.direction());
        b.position = a.position + towards * (1.5 * reach);
        let truth = Truth::of(&a, &b, &[]);
        b.position += truth.normal_a_to_b() * (gap - truth.nearest());
        (a, b)
    }

    fn about_one_place(&mut self, category: Category) -> (PlacedSolid, PlacedSolid) {
        let style = if self.random.one_in(4) { Style::Stretched } else { Style::Plain };
        let (a, mut b) = self.sized(style, 1.0);
        b.position = a.position;
        if matches!(category, Category::Identical) {
            b.rotation = a.rotation;
            if self.kinds.0 == self.kinds.1 {
                b.solid = a.solid.clone();
            }
        }
        (a, b)
    }

    fn size_ratio(&mut self) -> (PlacedSolid, PlacedSolid) {
        let least = if self.random.one_in(8) { -12.0 } else { -6.0 };
        let part = power_of_ten(self.random, least, -2.0);
        let (a, b) = self.sized(Style::Plain, part);
        let gap = b.solid.reach() * self.random.uniform(-2.0, 2.0);
        self.at_gap(a, b, gap)
    }

    /// Turned alike but for a tilt, close to each other.
    fn near_parallel(&mut self) -> (PlacedSolid, PlacedSolid) {
        let (a, mut b) = self.generic(Style::Plain);
        let tilt = power_of_ten(self.random, -16.0, -3.0);
        let axis = self.random.direction() * (0.5 * tilt);
        b.rotation = a.rotation * DQuat::from_xyzw(axis.x, axis.y, axis.z, 1.0);
        // Along an axis of the first, so that faces meet faces.
        let axis = [DVec3::X, DVec3::Y, DVec3::Z][(self.random.bits() % 3) as usize];
        let reach = a.solid.reach() + b.solid.reach();
        b.position = a.position + a.rotation.normalize() * axis * reach + self.random.direction() * (0.1 * reach);
        if self.random.one_in(4) { (a, b) } else { self.near_touch((a, b)) }
    }

    fn denormal(&mut self) -> (PlacedSolid, PlacedSolid) {
        let (mut a, mut b) = self.generic(Style::Denormal);
        let mut near_zero = |position: DVec3| match self.random.bits() % 4 {
            0 => position * 1e-310,
            1 => DVec3::new(position.x, 5e-324, position.z * 1e-300),
            2 => position * 1e-160,
            _ => position,
        };
        (a.position, b.position) = (near_zero(a.position), near_zero(b.position));
        if self.random.one_in(2) {
            a.rotation = DQuat::from_xyzw(1e-310, 5e-324, 0.0, 1.0);
        }
        (a, b)
    }

    /// A power of two near the size, so that dyadic sizes stay dyadic.
    fn dyadic_size(&self) -> f64 {
        2f64.powf(self.size.log2().round())
    }

    /// A rotation by quarter turns, exactly.
    fn quarter_turns(&mut self) -> DQuat {
        let turns = [
            DQuat::IDENTITY,
            DQuat::from_xyzw(1.0, 0.0, 0.0, 1.0),
            DQuat::from_xyzw(0.0, FRAC_1_SQRT_2, 0.0, FRAC_1_SQRT_2),
            DQuat::from_xyzw(0.0, 0.0, 1.0, 0.0),
            DQuat::from_xyzw(0.5, 0.5, 0.5, 0.5),
        ];
        if self.random.one_in(2) { turns[0] } else { turns[(self.random.bits() % 5) as usize] }
    }

    fn dyadic(&mut self, kind: Kind) -> PlacedSolid {
        let size = self.dyadic_size();
        let solid = form(self.random, kind, Style::Dyadic, size);
        PlacedSolid { solid, position: self.grid_point(size), rotation: self.quarter_turns() }
    }

    fn grid_point(&mut self, size: f64) -> DVec3 {
        (self.random.direction() * 8.0).round() * (size / 8.0)
    }

    /// Forms and places on a grid: faces in one plane, corners on edges, shared corners.
    fn grid(&mut self) -> (PlacedSolid, PlacedSolid) {
        (self.dyadic(self.kinds.0), self.dyadic(self.kinds.1))
    }

    /// Forms on a grid, side by side along an axis: the supports along it are exact.
    fn exact_touch(&mut self) -> (PlacedSolid, PlacedSolid) {
        let (a, mut b) = self.grid();
        let axis = [DVec3::X, DVec3::Y, DVec3::Z][(self.random.bits() % 3) as usize];
        let truth = Truth::of(&a, &b, &[]);
        let gap = truth.gap_along(axis);
        // Across a half space there is only one way.
        b.position -= if gap.is_finite() { axis * gap } else { truth.normal_a_to_b() * truth.nearest() };
        (a, b)
    }
}
