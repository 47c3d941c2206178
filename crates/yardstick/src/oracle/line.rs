//! The stretch of a line inside a placed form.
//!
//! # Method
//! The signed distance of a point that moves along a line to a convex form is convex in its way. From far outside, the plane
//! that parts point and form says how far the line is free; from there the next plane. That is Newton's method from the
//! outside of a convex function: no step is too far, and a plane that the line does not close in on proves a miss. Once
//! from each end, to 32 digits.
//!
//! # Limits
//! Where the line is a tangent the steps only halve the rest; the bound beyond the last step is a point that is inside.

use glam::DVec3;

use super::{
    apart::{self, Needed},
    double::{Double, Number},
    form::{Core, PlacedSolid, Solid},
    frame::{Kind, Pair, Wiring},
    inside,
    place::Place,
    polytope,
    space::{Vector, exponent_of, times_power_of_two},
};

/// Where a line is inside a form, as bounds of the ways to the first and the last point, metres from the origin of the ray.
#[derive(Clone, Copy, Debug)]
pub struct Inside {
    /// Bounds of the way to the first point.
    pub enter: [f64; 2],
    /// Bounds of the way to the last point.
    pub leave: [f64; 2],
    /// How deep the middle of the stretch is inside, metres; 0 for forms without volume.
    pub middle_depth: f64,
    /// Cosine between the line and the normal of the surface where it enters, and where it leaves.
    pub cosines: [f64; 2],
}

/// A line and a form in one frame.
struct Line {
    pair: Pair,
    origin: Vector<Double>,
    direction: Vector<Double>,
}

/// Steps of one end at most.
const STEPS_MAX: usize = 300;

/// A point this near to a form, in the frame, is on it.
const ON_SURFACE: f64 = 1e-27;

/// What the ways are off besides, in the frame.
const WAY_ROUNDING: f64 = 1e-24;

/// One end of a stretch: the way, how much farther it may be, and the cosine there.
struct End {
    way: Double,
    rest: f64,
    cosine: f64,
}

/// The stretch of a line inside a form that is no half space; `None` if there surely is none. `direction` is of any length
/// but 0.
#[must_use]
pub fn stretch_inside(solid: &PlacedSolid, origin: DVec3, direction: DVec3) -> Option<Inside> {
    stretch_inside_part(&solid.solid, &Place::of(solid), origin, direction)
}

/// The same of a form at a place, at the start of its motion.
#[must_use]
pub fn stretch_inside_part(solid: &Solid, place: &Place, origin: DVec3, direction: DVec3) -> Option<Inside> {
    let eye = PlacedSolid {
        solid: Solid { core: Core::Point, radius: 0.0 },
        position: origin,
        rotation: glam::DQuat::IDENTITY,
    };
    let pair = Pair::at([(solid, place), (&eye.solid, &Place::of(&eye))], Double::default());
    let exponent = -exponent_of(direction.abs().max_element());
    let parts = direction.to_array().map(|part| times_power_of_two(part, exponent));
    let origin = pair.exact.b.position;
    let direction = Vector::of(DVec3::from_array(parts)).unit()?;
    let mut line = Line { pair, origin, direction };
    // The pair is less than 2 large, its origins' distance up to the root of 3 times that.
    let far = Double::of(8.0);
    let enter = line.first(-far, Double::of(1.0))?;
    let leave = line.first(far, Double::of(-1.0))?;
    let exponent = line.pair.exponent;
    let metres = |way: f64| times_power_of_two(way, -exponent);
    let rounding = Double::of(WAY_ROUNDING);
    if enter.way - leave.way > rounding + rounding {
        return None;
    }
    let around = |end: &End, inwards: f64| {
        let (near, rest) = (end.way, Double::of(inwards * end.rest));
        let bounds = [near - Double::of(inwards) * rounding, near + rest + Double::of(inwards) * rounding];
        let [a, b] = bounds.map(|way| metres(way.nearest()));
        // The nearest f64 may be on either side of the bound.
        if inwards > 0.0 { [a.next_down(), b.next_up()] } else { [b.next_down(), a.next_up()] }
    };
    let (entered, left) = (around(&enter, 1.0), around(&leave, -1.0));
    let middle = (enter.way + leave.way) * Double::of(0.5);
    let depth = line.depth_at(middle);
    Some(Inside { enter: entered, leave: left, middle_depth: metres(depth), cosines: [enter.cosine, leave.cosine] })
}

impl Line {
    /// A lower bound of the signed distance at a way along the line, with the direction from the form to the point that
    /// proves it.
    fn gap_at(&mut self, way: Double) -> Option<(Double, Vector<Double>)> {
        let point = self.origin + self.direction * way;
        self.pair.exact.b.position = point;
        self.pair.exact.b.kind = Kind::Corners(vec![point], Wiring::All);
        self.pair.rough.b.kind = Kind::Corners(vec![point.rounded()], Wiring::All);
        let found = polytope::signed_distance(&self.pair).or_else(|| {
            let apart = apart::distance(&self.pair, Needed::All);
            (apart.normal != Vector::zero()).then_some((apart.lower, apart.normal))
        })?;
        Some((found.0 - self.pair.radius, found.1))
    }

    /// How deep the point at a way is inside, 0 outside; to about 16 digits.
    fn depth_at(&mut self, way: Double) -> f64 {
        let gap = self.gap_at(way).filter(|(gap, _)| gap.nearest() > ON_SURFACE);
        if gap.is_some() || self.pair.has_many_corners() {
            return 0.0;
        }
        let (gap, _) =
            polytope::signed_distance(&self.pair).unwrap_or_else(|| inside::signed_distance(&self.pair, &[]));
        (self.pair.radius - gap).nearest().max(0.0)
    }

    /// The first point from a way on, forwards (1) or backwards (-1).
    fn first(&mut self, from: Double, sense: Double) -> Option<End> {
        let mut end = End { way: from, rest: 0.0, cosine: 1.0 };
        for _ in 0..STEPS_MAX {
            let Some((gap, normal)) = self.gap_at(end.way) else { break };
            if gap.nearest() <= ON_SURFACE {
                break;
            }
            let closing = -(normal.dot(self.direction) * sense);
            if closing.nearest() <= 0.0 {
                return None;
            }
            let step = gap / closing;
            end.cosine = closing.nearest();
            end.way = end.way + step * sense;
            if end.way.size().nearest() > 2.0 * from.size().nearest() {
                return None;
            }
        }
        end.rest = self.rest(&end, sense);
        Some(end)
    }

    /// How much farther the form surely begins: as far as a point that is inside, or beyond a form without volume.
    fn rest(&mut self, end: &End, sense: Double) -> f64 {
        let mut rest = WAY_ROUNDING;
        while rest < 1.0 {
            match self.gap_at(end.way + Double::of(rest) * sense) {
                Some((gap, _)) if 0.0 < gap.nearest() && gap.nearest() <= 2.0 * ON_SURFACE => rest *= 8.0,
                _ => break,
            }
        }
        rest
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stretch(core: Core, radius: f64, origin: DVec3, direction: DVec3) -> Option<Inside> {
        let solid = PlacedSolid {
            solid: Solid { core, radius },
            position: DVec3::new(5.0, 0.0, 0.0),
            rotation: glam::DQuat::IDENTITY,
        };
        stretch_inside(&solid, origin, direction)
    }

    #[track_caller]
    fn expect(found: Option<Inside>, enter: f64, leave: f64) {
        let found = found.expect("a stretch");
        for (bounds, way) in [(found.enter, enter), (found.leave, leave)] {
            assert!(bounds[0] <= way && way <= bounds[1] && bounds[1] - bounds[0] < 1e-14, "{bounds:?} {way}");
        }
    }

    #[test]
    fn lines_meet_forms_where_they_do() {
        let cube = || Core::Cuboid { half_extents: DVec3::ONE };
        expect(stretch(Core::Point, 1.0, DVec3::ZERO, DVec3::X * 3.0), 4.0, 6.0);
        expect(stretch(cube(), 0.0, DVec3::ZERO, DVec3::X), 4.0, 6.0);
        expect(stretch(cube(), 0.5, DVec3::X * 5.0, DVec3::Y), -1.5, 1.5);
        expect(stretch(cube(), 0.0, DVec3::X * 9.0, DVec3::new(3.0, 0.0, 0.0)), -5.0, -3.0);
        let egg = Core::Ellipsoid { radii: DVec3::new(2.0, 1.0, 1.0) };
        expect(stretch(egg, 0.0, DVec3::ZERO, DVec3::X), 3.0, 7.0);
        let cone = Core::Cone { half_height: 1.0, radius: 2.0 };
        expect(stretch(cone, 0.0, DVec3::ZERO, DVec3::X), 4.0, 6.0);
        assert!(stretch(Core::Point, 1.0, DVec3::Y * 1.001, DVec3::X).is_none());
        assert!(stretch(cube(), 0.0, DVec3::Y * 1.001, DVec3::X).is_none());
    }
}
