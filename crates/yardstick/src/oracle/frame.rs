//! A pair in one frame: the origin of `a` at 0, unturned, everything scaled by one power of two so that the pair is
//! about 1 large.
//!
//! # Method
//! The difference of the positions, the scaling and the corners are exact or right to 32 digits; nothing is lost far
//! from the origin or to small numbers. The radii around the cores are kept apart from them.

use glam::DVec3;

use super::{
    double::{Double, Number},
    form::{Core, Solid},
    place::Place,
    space::{Turn, Vector, exponent_of, times_power_of_two, vector},
};

/// A core in the frame.
#[derive(Clone, Debug)]
pub(super) struct Body<T> {
    pub(super) kind: Kind<T>,
    /// From its own axes to those of the frame.
    pub(super) turn: Turn<T>,
    /// Its local origin.
    pub(super) position: Vector<T>,
}

/// What a core is made of, in its own axes, save for corners.
#[derive(Clone, Debug)]
pub(super) enum Kind<T> {
    /// Corners, in the frame.
    Corners(Vec<Vector<T>>, Wiring),
    /// Half height along y, and radius.
    Cylinder(T, T),
    /// Half height along y, and radius of the base.
    Cone(T, T),
    /// Half axes.
    Ellipsoid(Vector<T>),
}

/// Which corners edges may join.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Wiring {
    /// Corner `i` has bit 0, 1, 2 for the upper side along local x, y, z.
    Box,
    /// Any two of them, any three a face.
    All,
}

impl<T: Number> Body<T> {
    /// The point farthest along a direction.
    pub(super) fn support(&self, direction: Vector<T>) -> Vector<T> {
        let zero = T::of(0.0);
        let out = |local: Vector<T>| self.turn.out(local) + self.position;
        if let Kind::Corners(corners, _) = &self.kind {
            let higher = |best: &Vector<T>, next: &Vector<T>| next.dot(direction) > best.dot(direction);
            return corners.iter().fold(corners[0], |best, next| if higher(&best, next) { *next } else { best });
        }
        let local = self.turn.back(direction);
        let rim = |radius: T| {
            let across = (local.x * local.x + local.z * local.z).root();
            let part = if across > zero { radius / across } else { zero };
            (local.x * part, local.z * part)
        };
        match &self.kind {
            Kind::Cylinder(half, radius) => {
                let (x, z) = rim(*radius);
                out(vector(x, if local.y > zero { *half } else { -*half }, z))
            }
            Kind::Cone(half, radius) => {
                let (x, z) = rim(*radius);
                let on_base = x * local.x + z * local.z - *half * local.y;
                let is_apex = *half * local.y > on_base;
                out(if is_apex { vector(zero, *half, zero) } else { vector(x, -*half, z) })
            }
            Kind::Ellipsoid(radii) => {
                let stretched = vector(local.x * radii.x, local.y * radii.y, local.z * radii.z);
                let length = stretched.length();
                let part = if length > zero { T::of(1.0) / length } else { zero };
                let unit = stretched * part;
                out(vector(unit.x * radii.x, unit.y * radii.y, unit.z * radii.z))
            }
            Kind::Corners(..) => self.position,
        }
    }

    /// The least and the greatest coordinate along a direction.
    pub(super) fn range(&self, direction: Vector<T>) -> (T, T) {
        let Kind::Corners(corners, _) = &self.kind else {
            let low = self.support(-direction).dot(direction);
            return (low, self.support(direction).dot(direction));
        };
        let first = corners[0].dot(direction);
        corners[1..].iter().fold((first, first), |(low, high), corner| {
            let here = corner.dot(direction);
            (if here < low { here } else { low }, if here > high { here } else { high })
        })
    }

    /// The corners, if it has nothing else.
    pub(super) fn corners(&self) -> Option<(&[Vector<T>], Wiring)> {
        match &self.kind {
            Kind::Corners(corners, wiring) => Some((corners, *wiring)),
            Kind::Cylinder(..) | Kind::Cone(..) | Kind::Ellipsoid(_) => None,
        }
    }
}

impl Body<Double> {
    fn new(solid: &Solid, position: Vector<Double>, turn: Turn<Double>, exponent: i32) -> Self {
        let size = |value: f64| Double::of(times_power_of_two(value, exponent));
        let sizes = |v: DVec3| vector(size(v.x), size(v.y), size(v.z));
        let corners = |points: &[DVec3], wiring| {
            Kind::Corners(points.iter().map(|&point| turn.out(sizes(point)) + position).collect(), wiring)
        };
        let kind = match &solid.core {
            Core::Point => corners(&[DVec3::ZERO], Wiring::All),
            Core::Segment { half_height } => corners(&[DVec3::Y * -*half_height, DVec3::Y * *half_height], Wiring::All),
            Core::Cuboid { half_extents } => {
                let sign = |index: u32, bit: u32| if index >> bit & 1 == 1 { 1.0 } else { -1.0 };
                let corner = |index| DVec3::new(sign(index, 0), sign(index, 1), sign(index, 2)) * *half_extents;
                corners(&(0..8).map(corner).collect::<Vec<_>>(), Wiring::Box)
            }
            Core::Hull(points) => corners(points, Wiring::All),
            Core::Cylinder { half_height, radius } => Kind::Cylinder(size(*half_height), size(*radius)),
            Core::Cone { half_height, radius } => Kind::Cone(size(*half_height), size(*radius)),
            Core::Ellipsoid { radii } => Kind::Ellipsoid(sizes(*radii)),
            // A point of the plane: `plane` looks at the rest.
            Core::HalfSpace { .. } => corners(&[DVec3::ZERO], Wiring::All),
        };
        Self { kind, turn, position }
    }

    fn rounded(&self) -> Body<f64> {
        let kind = match &self.kind {
            Kind::Corners(corners, wiring) => {
                Kind::Corners(corners.iter().map(|corner| corner.rounded()).collect(), *wiring)
            }
            Kind::Cylinder(half, radius) => Kind::Cylinder(half.nearest(), radius.nearest()),
            Kind::Cone(half, radius) => Kind::Cone(half.nearest(), radius.nearest()),
            Kind::Ellipsoid(radii) => Kind::Ellipsoid(radii.rounded()),
        };
        Body { kind, turn: self.turn.rounded(), position: self.position.rounded() }
    }
}

/// Two cores.
#[derive(Clone, Debug)]
pub(super) struct Cores<T> {
    pub(super) a: Body<T>,
    pub(super) b: Body<T>,
}

impl<T: Number> Cores<T> {
    /// The gap between the cores along a unit vector from `a` to `b`; whatever the vector, the signed distance of the
    /// cores is not below it.
    pub(super) fn gap_along(&self, a_to_b: Vector<T>) -> T {
        self.b.range(a_to_b).0 - self.a.range(a_to_b).1
    }

    /// The better of a direction and its opposite, and the gap along that.
    pub(super) fn gap_either_way(&self, direction: Vector<T>) -> (T, Vector<T>) {
        let ((low_a, high_a), (low_b, high_b)) = (self.a.range(direction), self.b.range(direction));
        let (there, back) = (low_b - high_a, low_a - high_b);
        if there >= back { (there, direction) } else { (back, -direction) }
    }
}

/// A pair in its frame.
#[derive(Clone, Debug)]
pub(super) struct Pair {
    /// To 32 digits.
    pub(super) exact: Cores<Double>,
    /// The same to 16, for a first look.
    pub(super) rough: Cores<f64>,
    /// The sum of the radii around the cores.
    pub(super) radius: Double,
    /// Metres times two to this are lengths of the frame.
    pub(super) exponent: i32,
}

/// Cores of more corners are asked how far they are apart, and how deep they are in each other is left open.
const CORNERS_MAX: usize = 64;

impl Pair {
    /// One of the cores has so many corners that not all pairs of them can be looked at.
    pub(super) fn has_many_corners(&self) -> bool {
        let count = |body: &Body<Double>| body.corners().map_or(0, |(corners, _)| corners.len());
        count(&self.exact.a).max(count(&self.exact.b)) > CORNERS_MAX
    }

    /// At a time of their motions. The exponent is the same at all times.
    pub(super) fn at([(a, place_a), (b, place_b)]: [(&Solid, &Place); 2], time: Double) -> Self {
        let apart = place_b.position - place_a.position;
        let extent = a.reach() + b.reach() + place_a.extent() + place_b.extent() + apart.abs().max_element();
        let exponent = -exponent_of(extent);
        let size = |value: f64| times_power_of_two(value, exponent);
        let sizes = |v: DVec3| Vector::of(DVec3::new(size(v.x), size(v.y), size(v.z)));
        let way = |from: f64, to: f64| {
            // Where the scale is far up, the positions are near 0 or alike: the difference is exact, its scaling too.
            if exponent > 500 { Double::of(size(to - from)) } else { Double::difference(size(to), size(from)) }
        };
        let (p, q) = (place_a.position, place_b.position);
        let ahead = (sizes(place_b.displacement) - sizes(place_a.displacement)) * time;
        let origin_b = vector(way(p.x, q.x), way(p.y, q.y), way(p.z, q.z)) + ahead;
        let body = |solid: &Solid, place: &Place, origin: Vector<Double>| {
            let (arm, turn) = place.stand(time, sizes);
            Body::new(solid, origin + arm, turn, exponent)
        };
        let exact = Cores { a: body(a, place_a, Vector::zero()), b: body(b, place_b, origin_b) };
        Self {
            rough: Cores { a: exact.a.rounded(), b: exact.b.rounded() },
            exact,
            radius: Double::of(size(a.radius)) + Double::of(size(b.radius)),
            exponent,
        }
    }
}
