//! The least width of two cores of any kind that overlap: the best of very many directions.
//!
//! # Method
//! The width along any unit vector is an upper bound of the depth, so every direction tried is one, and the best is taken.
//! Where the width has kinks its least values lie there, so directions are sought in three ways: anywhere, by steps of a
//! shrinking compass from the best of a first net; on the circles of directions across an edge, or across a generator of
//! a cylinder or a cone; and where two circles meet (faces, pairs of edges), and at the ends of axes. Then the value is
//! computed to 32 digits.
//!
//! # Limits
//! Nothing proves that no better direction exists: the depth found is an upper bound. It is found to within about 1e-16.

use super::{
    double::{Double, Number},
    frame::{Body, Cores, Kind, Pair, Wiring},
    space::{Vector, vector},
};

/// Directions whose product with a unit vector is a constant.
#[derive(Clone, Copy, Debug)]
struct Circle<T> {
    axis: Vector<T>,
    height: T,
}

impl Circle<Double> {
    fn rounded(&self) -> Circle<f64> {
        Circle { axis: self.axis.rounded(), height: self.height.nearest() }
    }
}

impl<T: Number> Circle<T> {
    /// The nearest direction of it, and the one a quarter turn on. `None` at its pole.
    fn frame_at(&self, direction: Vector<T>) -> Option<(Vector<T>, Vector<T>)> {
        let across = direction.across(self.axis).unit()?.across(self.axis).unit()?;
        Some((across, self.axis.cross(across)))
    }

    fn at(&self, (start, quarter): (Vector<T>, Vector<T>), cos: T, sin: T) -> Vector<T> {
        let radius = (T::of(1.0) - self.height * self.height).root();
        self.axis * self.height + (start * cos + quarter * sin) * radius
    }

    /// Both directions on two circles.
    fn meets(&self, other: &Self) -> Option<[Vector<T>; 2]> {
        let one = T::of(1.0);
        let cross = self.axis.cross(other.axis);
        let sine_sq = cross.dot(cross);
        if sine_sq.nearest() < 1e-40 {
            return None;
        }
        let cosine = self.axis.dot(other.axis);
        let (along, beside) =
            ((self.height - cosine * other.height) / sine_sq, (other.height - cosine * self.height) / sine_sq);
        let within = self.axis * along + other.axis * beside;
        let rest = one - within.dot(within);
        if rest < T::of(0.0) {
            return None;
        }
        let out = cross * (rest / sine_sq).root();
        Some([(within + out).unit()?, (within - out).unit()?])
    }
}

/// Which way of a body's own outward directions those from `a` to `b` are.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Side {
    A,
    B,
}

fn circles_of(body: &Body<Double>, side: Side) -> Vec<Circle<Double>> {
    let zero = Double::of(0.0);
    let across = |axis| Circle { axis, height: zero };
    match &body.kind {
        Kind::Corners(_, Wiring::Box) => (0..3).map(|axis| across(body.turn.axis(axis))).collect(),
        Kind::Corners(corners, Wiring::All) => {
            let after = |i: usize| corners[i + 1..].iter().map(move |&end| end - corners[i]);
            (0..corners.len()).flat_map(after).filter_map(Vector::unit).map(across).collect()
        }
        Kind::Cylinder(..) => vec![across(body.turn.axis(1))],
        Kind::Cone(half, radius) => {
            let height = *half + *half;
            let sine = *radius / (*radius * *radius + height * height).root();
            vec![Circle { axis: body.turn.axis(1), height: if side == Side::A { sine } else { -sine } }]
        }
        // No kinks, but valleys that look like them if it is long or flat.
        Kind::Ellipsoid(_) => (0..3).map(|axis| across(body.turn.axis(axis))).collect(),
    }
}

/// Directions of the net that is looked at first, and how many of the best are followed.
const NET: usize = 160;
const FOLLOWED: usize = 6;

/// How often it is climbed freely and along circles in turn.
const FOLLOWS_MAX: usize = 8;

/// Circles within this sine of a direction are looked at from there, and at most so many.
const NEAR_CIRCLE: f64 = 0.15;
const CIRCLES_MAX: usize = 10;

/// The last step of a compass, radians: the square of it is below rounding.
const STEP_MIN: f64 = 1e-9;

/// The longest.
const STEP_MAX: f64 = 0.3;

/// A compass keeps its step while that gains more than this part of its square: less is rounding, and would go on forever
/// where the width is the same all along a circle.
const GAIN_MIN: f64 = 1e-5;

/// Moves and shrinkings of one compass: along a ridge that no point of it follows it gains a little without end.
const MOVES_MAX: usize = 300;

struct Search<'a> {
    pair: &'a Pair,
    circles: Vec<Circle<Double>>,
    rough_circles: Vec<Circle<f64>>,
}

/// The greatest gap along a direction that was found, negative where the cores overlap, and that direction, from `a` to
/// `b`. `hints` are directions to begin at.
pub(super) fn signed_distance(pair: &Pair, hints: &[Vector<f64>]) -> (Double, Vector<Double>) {
    let mut circles = circles_of(&pair.exact.a, Side::A);
    circles.extend(circles_of(&pair.exact.b, Side::B));
    let rough_circles = circles.iter().map(Circle::rounded).collect();
    let search = Search { pair, circles, rough_circles };
    let mut starts = search.starts(hints);
    starts.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut followed: Vec<(f64, Vector<f64>)> = Vec::new();
    for (gap, direction) in starts {
        let is_new = followed.iter().all(|(_, other)| (*other - direction).length() > 0.2);
        if is_new && followed.len() < FOLLOWED {
            followed.push((gap, direction));
        }
    }
    let hinted = hints.iter().map(|&hint| (search.rough(hint), hint));
    let ends: Vec<(f64, Vector<f64>)> = followed.into_iter().chain(hinted).map(|start| search.follow(start)).collect();
    let best = ends.iter().fold(ends[0], |best, next| if next.0 > best.0 { *next } else { best });
    search.conclude(best.1, hints)
}

impl Search<'_> {
    fn rough(&self, direction: Vector<f64>) -> f64 {
        self.pair.rough.gap_along(direction)
    }

    /// A net over the sphere (a spiral of equal areas), axes, and where circles meet axes of the other body.
    fn starts(&self, hints: &[Vector<f64>]) -> Vec<(f64, Vector<f64>)> {
        let golden = std::f64::consts::PI * (3.0 - 5f64.sqrt());
        let mut directions: Vec<Vector<f64>> = hints.to_vec();
        for index in 0..NET {
            #[allow(clippy::cast_precision_loss, reason = "a small number")]
            let (turn, height) = (golden * index as f64, 1.0 - (2 * index + 1) as f64 / NET as f64);
            let radius = (1.0 - height * height).sqrt();
            directions.push(vector(radius * turn.cos(), height, radius * turn.sin()));
        }
        let Cores { a, b } = &self.pair.rough;
        for axis in 0..3 {
            for axis in [a.turn.axis(axis), b.turn.axis(axis)] {
                directions.extend([axis, -axis]);
            }
        }
        directions.extend((b.position - a.position).unit());
        if self.rough_circles.len() <= CIRCLES_MAX {
            directions.extend(meetings(&self.rough_circles));
        }
        directions.into_iter().map(|direction| (self.rough(direction), direction)).collect()
    }

    /// Climbs from a direction, freely and along circles, until neither is better.
    fn follow(&self, start: (f64, Vector<f64>)) -> (f64, Vector<f64>) {
        let mut best = start;
        for _ in 0..FOLLOWS_MAX {
            let before = best.0;
            best = self.climb(best);
            let near = self.near_circles(best.1);
            for circle in near.iter().map(|&index| &self.rough_circles[index]) {
                best = better(best, self.climb_circle(circle, best.1));
            }
            let circles: Vec<Circle<f64>> = near.iter().map(|&index| self.rough_circles[index]).collect();
            for direction in meetings(&circles) {
                best = better(best, (self.rough(direction), direction));
            }
            if best.0 <= before {
                break;
            }
        }
        best
    }

    fn near_circles(&self, direction: Vector<f64>) -> Vec<usize> {
        let off = |index: &usize| {
            let circle = &self.rough_circles[*index];
            (direction.dot(circle.axis) - circle.height).abs()
        };
        let mut near: Vec<usize> = (0..self.circles.len()).filter(|index| off(index) < NEAR_CIRCLE).collect();
        near.sort_by(|a, b| off(a).total_cmp(&off(b)));
        near.truncate(CIRCLES_MAX);
        near
    }

    /// A compass of eight points whose step shrinks when none is better.
    fn climb(&self, start: (f64, Vector<f64>)) -> (f64, Vector<f64>) {
        let mut best = start;
        let (mut step, mut moves) = (0.1, 0);
        while step > STEP_MIN && moves < MOVES_MAX {
            moves += 1;
            step = step.min(STEP_MAX);
            let (east, north) = tangents(best.1);
            let mut next = best;
            for (x, y) in [(1.0, 0.0), (0.7, 0.7), (0.0, 1.0), (-0.7, 0.7)] {
                let aside = (east * x + north * y) * step;
                for direction in [best.1 + aside, best.1 - aside].into_iter().filter_map(Vector::unit) {
                    next = better(next, (self.rough(direction), direction));
                }
            }
            let is_gain = next.0 > best.0 + GAIN_MIN * step * step;
            if is_gain {
                // Along a valley the same way again, and longer and longer ones.
                let again = next.1 + (next.1 - best.1) * 2.0;
                best = again.unit().map_or(next, |again| better(next, (self.rough(again), again)));
                step *= 1.5;
            } else {
                best = better(best, next);
                step *= 0.4;
            }
        }
        best
    }

    /// The same with two points, on a circle, from the direction of it that is nearest.
    fn climb_circle(&self, circle: &Circle<f64>, near: Vector<f64>) -> (f64, Vector<f64>) {
        let Some(frame) = circle.frame_at(near) else { return (self.rough(near), near) };
        let at = |angle: f64| {
            let direction = circle.at(frame, angle.cos(), angle.sin());
            (self.rough(direction), direction)
        };
        let (mut best, mut angle, mut step, mut moves) = (at(0.0), 0.0, 0.1, 0);
        while step > STEP_MIN && moves < MOVES_MAX {
            moves += 1;
            let (forth, back) = (at(angle + step), at(angle - step));
            let next = better(forth, back);
            if next.0 > best.0 + GAIN_MIN * step * step {
                angle += if forth.0 >= back.0 { step } else { -step };
                best = next;
            } else {
                best = better(best, next);
                step *= 0.4;
            }
        }
        best
    }

    /// The gap to 32 digits at a direction, on the circles nearest to it and where those meet.
    fn conclude(&self, direction: Vector<f64>, hints: &[Vector<f64>]) -> (Double, Vector<Double>) {
        let widen = |v: Vector<f64>| vector(Double::of(v.x), Double::of(v.y), Double::of(v.z)).unit();
        let mut tried: Vec<Vector<Double>> = hints.iter().copied().chain([direction]).filter_map(widen).collect();
        let near: Vec<Circle<Double>> =
            self.near_circles(direction).into_iter().map(|index| self.circles[index]).collect();
        if let Some(exact) = widen(direction) {
            let (one, zero) = (Double::of(1.0), Double::of(0.0));
            tried.extend(near.iter().filter_map(|circle| Some(circle.at(circle.frame_at(exact)?, one, zero))));
        }
        tried.extend(meetings(&near));
        for body in [&self.pair.exact.a, &self.pair.exact.b] {
            tried.extend((0..3).flat_map(|axis| [body.turn.axis(axis), -body.turn.axis(axis)]));
        }
        let gaps = tried.into_iter().filter_map(Vector::unit).map(|unit| (self.pair.exact.gap_along(unit), unit));
        let first = (Double::of(f64::NEG_INFINITY), Vector::zero());
        gaps.fold(first, |best, next| if next.0 > best.0 { next } else { best })
    }
}

fn better(a: (f64, Vector<f64>), b: (f64, Vector<f64>)) -> (f64, Vector<f64>) {
    if b.0 > a.0 { b } else { a }
}

/// All directions on any two of the circles.
fn meetings<T: Number>(circles: &[Circle<T>]) -> Vec<Vector<T>> {
    let pairs =
        (0..circles.len()).flat_map(|i| circles[i + 1..].iter().filter_map(move |other| circles[i].meets(other)));
    pairs.flatten().collect()
}

/// Two unit vectors across a third and each other.
fn tangents(direction: Vector<f64>) -> (Vector<f64>, Vector<f64>) {
    let least = if direction.x.abs() < 0.6 { vector(1.0, 0.0, 0.0) } else { vector(0.0, 1.0, 0.0) };
    let east = least.across(direction).unit().unwrap_or(least);
    (east, direction.cross(east))
}
