//! Hulls of any points: their faces, edges and supports, and what is left out of simplified ones.

use std::{cmp::Ordering, collections::HashMap, fmt};

use collision::{
    DVec3,
    accuracy::{Accuracy, Tier},
    answer::Work,
    math::{
        Pose,
        expansion::{self, ExactVector},
    },
    narrow::{self, Placed},
    shape::{Geometry, Hull, Span, Topology},
};
use robust::{Coord3D, orient3d};

use crate::{
    forms::{points, points_code},
    law,
    numbers::{Numbers, vector_code},
};

/// Panics if the hull of the points that these bytes make breaks a law.
pub fn check(bytes: &[u8]) {
    let numbers = &mut Numbers::new(bytes);
    let points = points(numbers, 64);
    let case = Case { hull: Hull::new(&points), points };
    case.vertices_are_those_sent();
    case.is_closed();
    if case.points.iter().all(|&point| expansion::is_in_range(point)) {
        case.is_convex();
    }
    for _ in 0..4 {
        let direction = if numbers.byte() & 1 == 0 { numbers.direction() } else { numbers.vector() };
        case.supports(direction, u32::from(numbers.byte()));
    }
    case.simplified(1 + numbers.below(16), numbers.number().abs());
}

/// The case that these bytes make, as code.
#[must_use]
pub fn describe(bytes: &[u8]) -> String {
    let points = points(&mut Numbers::new(bytes), 64);
    Case { hull: Hull::new(&points), points }.to_string()
}

struct Case {
    points: Vec<DVec3>,
    hull: Hull,
}

impl fmt::Display for Case {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "    let hull = Hull::new(&{});", points_code(&self.points))
    }
}

impl Case {
    fn vertex(&self, index: u32) -> DVec3 {
        self.hull.vertices()[index as usize]
    }

    fn vertices_are_those_sent(&self) {
        let vertices = self.hull.vertices();
        for &point in &self.points {
            law!(self, vertices.contains(&point), "{} is lost", vector_code(point));
        }
        for (index, vertex) in vertices.iter().enumerate() {
            law!(self, !vertices[..index].contains(vertex), "{} is there twice", vector_code(*vertex));
        }
    }

    /// Euler's formula, each edge once in each direction, spans that fit what there is.
    fn is_closed(&self) {
        let topology = self.hull.topology();
        let Topology { span, faces, edges } = topology;
        let counts = (faces.len(), edges.len());
        match span {
            Span::Point => law!(self, counts == (0, 0), "a point with {counts:?} faces and edges"),
            Span::Segment => law!(self, counts == (0, 1), "a segment with {counts:?} faces and edges"),
            Span::Polygon => {
                law!(self, faces.len() == 2 && edges.len() >= 3, "a polygon with {counts:?} faces and edges");
            }
            Span::Solid => {
                let mut corners: Vec<u32> = faces.iter().flat_map(|face| face.vertices.clone()).collect();
                corners.sort_unstable();
                corners.dedup();
                let euler = corners.len() + faces.len() == edges.len() + 2;
                law!(self, euler, "{} corners, {} faces, {} edges", corners.len(), faces.len(), edges.len());
            }
        }
        let mut sides = HashMap::new();
        for (number, face) in (0..).zip(faces) {
            law!(self, (face.normal.length() - 1.0).abs() < 1e-14, "{face:?}");
            law!(self, face.offset.is_finite() && face.vertices.len() >= 3, "{face:?}");
            for (index, &start) in face.vertices.iter().enumerate() {
                let end = face.vertices[(index + 1) % face.vertices.len()];
                law!(self, sides.insert((start, end), number).is_none(), "side {start} to {end} is there twice");
            }
        }
        if faces.is_empty() {
            return;
        }
        law!(self, sides.len() == 2 * edges.len(), "{} sides of {} edges", sides.len(), edges.len());
        for edge in edges {
            let (ahead, back) = (sides.get(&(edge.start, edge.end)), sides.get(&(edge.end, edge.start)));
            law!(self, ahead == Some(&edge.left) && back == Some(&edge.right), "{edge:?} lies at {ahead:?}, {back:?}");
        }
    }

    /// By exact signs: the span, and that every point lies inside every face.
    fn is_convex(&self) {
        let topology = self.hull.topology();
        let span = exact_span(self.hull.vertices());
        law!(self, topology.span == span, "{:?}, in truth {span:?}", topology.span);
        if span != Span::Solid {
            return;
        }
        for face in &topology.faces {
            let corner = |index: usize| self.vertex(face.vertices[index % face.vertices.len()]);
            for index in 0..face.vertices.len() {
                let [a, b, c] = [corner(index), corner(index + 1), corner(index + 2)];
                law!(self, has_area(a, b, c), "{face:?} goes straight on from {index}");
                for &vertex in self.hull.vertices() {
                    law!(self, side(a, b, c, vertex) >= 0.0, "{} is outside of {face:?}", vector_code(vertex));
                }
                for &other in &face.vertices {
                    law!(self, side(a, b, c, self.vertex(other)) == 0.0, "{other} is not in the plane of {face:?}");
                }
            }
        }
    }

    fn supports(&self, direction: DVec3, start: u32) {
        let hull = &self.hull;
        let height = |vertex: u32| {
            let point = self.vertex(vertex);
            point.x * direction.x + point.y * direction.y + point.z * direction.z
        };
        let count = hull.vertices().len() as u32;
        let along = vector_code(direction);
        let mut first = 0;
        for vertex in 1..count {
            if height(vertex) > height(first) {
                first = vertex;
            }
        }
        let found = hull.farthest(direction);
        law!(self, found == first, "farthest along {along}: {found}, in truth {first}");
        let walked = hull.climb(direction, start % count);
        let from_table = hull.climb(direction, hull.support_start(direction));
        let is_in_range = self.points.iter().chain([&direction]).all(|&point| expansion::is_in_range(point));
        let is_decided = direction != DVec3::ZERO && is_in_range;
        let is_same = walked == from_table || !is_decided;
        law!(self, is_same, "climb along {along}: {walked} from {start}, {from_table} from the table");
        let support = hull.support(direction);
        law!(self, support < count, "support along {along}: {support}");
        if !is_in_range {
            return;
        }
        let exact = ExactVector::difference(direction, DVec3::ZERO);
        for vertex in 0..count {
            let above = ExactVector::difference(self.vertex(vertex), self.vertex(walked)).dot(&exact).sign();
            law!(self, above != Ordering::Greater, "climb along {along}: {walked}, but {vertex} is higher");
        }
    }

    fn simplified(&self, most: usize, max_error: f64) {
        let extent = self.hull.reach();
        let mut last = f64::INFINITY;
        for (budget, allowed) in [(most, max_error), (most, 0.0), (most + 1, 0.0), (2 * most + 1, 0.0)] {
            let simplified = self.hull.simplified(budget, allowed);
            let (kept, outside) = (simplified.hull.vertices(), simplified.outside);
            let what = format!("simplified({budget}, {allowed:?}): {outside:?} outside, {} kept", kept.len());
            law!(self, !kept.is_empty() && kept.len() <= budget, "{what}");
            law!(self, outside >= 0.0 && outside <= 2.0 * extent * (1.0 + 1e-12) + 1e-138, "{what}");
            law!(self, kept.iter().all(|vertex| self.hull.vertices().contains(vertex)), "{what}");
            law!(self, simplified.inside == 0.0, "{what}");
            if allowed == 0.0 {
                law!(self, outside <= last, "{what}, fewer leave {last:?}");
                last = outside;
            }
            let Ok(rest) = Geometry::hull(kept) else { panic!("BROKEN {what}: no hull\n{self}") };
            for &vertex in self.hull.vertices() {
                let far = surely_apart(vertex, &rest);
                law!(self, far <= outside, "{what}, but {} is {far:?} away", vector_code(vertex));
            }
        }
    }
}

/// What the distance of a point from a form is at least.
fn surely_apart(point: DVec3, form: &Geometry) -> f64 {
    let probe = Geometry::point();
    let (probe, form) =
        (Placed { geometry: &probe, pose: Pose::at(point) }, Placed { geometry: form, pose: Pose::IDENTITY });
    let found = narrow::distance(probe, form, f64::INFINITY, &Accuracy::of(Tier::Exact), &mut Work::default());
    found.map_or(0.0, |found| found.certificate.bound.lower)
}

/// Above 0 where `d` lies below the plane of `a`, `b`, `c`, counter-clockwise from above; exact in sign.
fn side(a: DVec3, b: DVec3, c: DVec3, d: DVec3) -> f64 {
    let [a, b, c, d] = [a, b, c, d].map(|point| Coord3D { x: point.x, y: point.y, z: point.z });
    orient3d(a, b, c, d)
}

fn has_area(a: DVec3, b: DVec3, c: DVec3) -> bool {
    !ExactVector::difference(b, a).cross(&ExactVector::difference(c, a)).is_zero()
}

fn exact_span(vertices: &[DVec3]) -> Span {
    let Some((&a, rest)) = vertices.split_first() else { return Span::Point };
    let Some(&b) = rest.first() else { return Span::Point };
    let Some(&c) = rest.iter().find(|&&c| has_area(a, b, c)) else { return Span::Segment };
    if rest.iter().all(|&d| side(a, b, c, d) == 0.0) { Span::Polygon } else { Span::Solid }
}
