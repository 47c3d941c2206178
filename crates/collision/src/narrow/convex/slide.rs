//! When two boxes that move without turning touch first, by their fifteen axes.
//!
//! # Method
//! Along each axis the boxes are two intervals that slide over each other: they begin to overlap at one time and end at
//! another. Boxes touch while no axis parts them, so the first touch is the last of the beginnings, if no end comes before it.
//! Each time is taken once for intervals grown by the rounding and once for such shrunk by it: the first bounds the touch from
//! below, the second proves an overlap.
//!
//! ```text
//!   axis 1   ......[=======]......
//!   axis 2   [=========]..........      x: touch, when axis 3 begins
//!   axis 3   ........x[=====].....
//! ```
//!
//! # Source
//! Gottschalk, Lin, Manocha, "OBBTree" (1996), for the axes; Boyse, "Interference detection among solids and surfaces" (1979),
//! for intervals in motion.
//!
//! # Limits
//! Boxes, segments and points without radius. Where an axis begins and ends within rounding (a graze) nothing is said.

use glam::DVec3;

use super::{boxes::Boxes, frame::Pair};
use crate::{
    answer::Bound,
    math::Norm,
    tolerance::{PAIR_ROUNDING, STEP_SHORTENING},
};

/// What the axes tell of a motion.
pub(super) enum Slide {
    /// The way is free.
    Free,
    /// They touch first within these bounds, the upper of which is a proved overlap.
    Touch {
        bound: Bound,
        /// Unit, from `b` to `a`: the axis that parts them last.
        normal: DVec3,
        /// The axes of the two edges whose product that is, if it is one.
        edges: Option<[usize; 2]>,
    },
    /// Not even this is sure.
    Open,
}

/// The stretch of time in which no axis parts two boxes: grown by rounding, and shrunk by it.
struct Stretch {
    grown: Bound,
    shrunk: Bound,
    normal: DVec3,
    edges: Option<[usize; 2]>,
}

/// Asks all axes while `b` goes by `-way` over the time from 0 to 1; `None` unless both are boxes without radius.
pub(super) fn meeting(pair: &Pair<'_>, way: DVec3) -> Option<Slide> {
    if pair.radius() > 0.0 {
        return None;
    }
    let boxes = Boxes::of(pair)?;
    let whole = Bound::new(f64::NEG_INFINITY, f64::INFINITY);
    let mut stretch = Stretch { grown: whole, shrunk: whole, normal: DVec3::X, edges: None };
    let columns = [boxes.turn.x_axis, boxes.turn.y_axis, boxes.turn.z_axis];
    for axis in [DVec3::X, DVec3::Y, DVec3::Z].into_iter().chain(columns) {
        stretch.cut(&boxes, way, axis, None);
    }
    for (on_b, along) in columns.into_iter().enumerate() {
        let products = [
            DVec3::new(0.0, -along.z, along.y),
            DVec3::new(along.z, 0.0, -along.x),
            DVec3::new(-along.y, along.x, 0.0),
        ];
        for (on_a, product) in products.into_iter().enumerate() {
            if stretch.is_over() {
                return Some(Slide::Free);
            }
            if let Some(axis) = product.try_unit() {
                stretch.cut(&boxes, way, axis, Some([on_a, on_b]));
            }
        }
    }
    Some(stretch.meeting())
}

impl Stretch {
    /// Leaves what an axis leaves.
    fn cut(&mut self, boxes: &Boxes, way: DVec3, axis: DVec3, edges: Option<[usize; 2]>) {
        let on_b = DVec3::new(boxes.turn.x_axis.dot(axis), boxes.turn.y_axis.dot(axis), boxes.turn.z_axis.dot(axis));
        let reach = axis.abs().dot(boxes.half_a) + on_b.abs().dot(boxes.half_b);
        let (start, speed) = (axis.dot(boxes.position), -axis.dot(way));
        // Seen from the side to which it moves.
        let (start, speed, axis) = if speed < 0.0 { (-start, -speed, -axis) } else { (start, speed, axis) };
        let stretch = |reach: f64| {
            if speed > 0.0 {
                Bound::new((-reach - start) / speed, (reach - start) / speed)
            } else if start.abs() <= reach {
                Bound::new(f64::NEG_INFINITY, f64::INFINITY)
            } else {
                Bound::new(f64::INFINITY, f64::NEG_INFINITY)
            }
        };
        let (grown, shrunk) = (stretch(reach + PAIR_ROUNDING), stretch(reach - PAIR_ROUNDING));
        if grown.lower > self.grown.lower {
            self.grown.lower = grown.lower;
            (self.normal, self.edges) = (axis, edges);
        }
        self.grown.upper = self.grown.upper.min(grown.upper);
        self.shrunk.lower = self.shrunk.lower.max(shrunk.lower);
        self.shrunk.upper = self.shrunk.upper.min(shrunk.upper);
    }

    /// Whether surely nothing is left from 0 to 1. Quotients are off by a few roundings of themselves.
    fn is_over(&self) -> bool {
        let Bound { lower, upper } = self.grown;
        lower * STEP_SHORTENING > upper.min(1.0) || upper < 0.0
    }

    fn meeting(&self) -> Slide {
        if self.is_over() {
            return Slide::Free;
        }
        let lower = (self.grown.lower * STEP_SHORTENING).max(0.0);
        let upper = self.shrunk.lower.max(0.0) / STEP_SHORTENING;
        let is_proved = upper <= 1.0 && upper <= self.shrunk.upper * STEP_SHORTENING;
        if is_proved && lower <= upper {
            Slide::Touch { bound: Bound::new(lower, upper), normal: self.normal, edges: self.edges }
        } else {
            Slide::Open
        }
    }
}
