//! The points of a contact.
//!
//! # Method
//! Where a face of one core lies flat across the normal, the other core's facing feature (a face, an edge, a corner) is
//! clipped by the side planes of that face and projected onto it along the normal; two edges side by side are clipped by each
//! other's ends. So every point is one of its core, and none lies deeper than the cores are wide along the normal. Of more
//! than four points those stay that span the touch best. Anything else touches in one point.
//!
//! # Source
//! Clipping: Sutherland, Hodgman (1974). Choice of four: deepest, farthest from it, largest triangle, largest addition.

use glam::DVec3;
use smallvec::SmallVec;

use super::{
    body::Corner,
    depth::Touch,
    facing::{Facing, facing},
    frame::Pair,
    simplex::Vertex,
};
use crate::{math::Norm, tolerance::SQUARE_MIN};

/// A pair of points, on the surfaces of the rounded forms, in the pair's frame.
pub(super) struct Point {
    pub(super) on_a: DVec3,
    pub(super) on_b: DVec3,
    /// How much deeper than these two points the two surfaces may lie in each other there.
    pub(super) beyond: f64,
    pub(super) feature_pair: u32,
}

/// A corner of the clipped feature and the corner (or the side it was cut by) that names it.
#[derive(Clone, Copy)]
struct Clipped {
    point: DVec3,
    name: u16,
}

type Polygon = SmallVec<[Clipped; 12]>;
type Points = SmallVec<[Point; 8]>;

/// The points where two forms touch, deepest first; at least one, at most four.
pub(super) fn points(pair: &Pair<'_>, touch: &Touch) -> Points {
    // The second form is the simpler one: where it touches with a corner there is nothing to clip.
    let facing_b = facing(&pair.b, touch.normal);
    let mut kept = Points::new();
    let mut beyond = 0.0;
    if facing_b.corners.len() > 1 {
        let facing_a = facing(&pair.a, -touch.normal);
        if facing_a.is_reference_for(&facing_b) {
            kept = four(clip(&facing_a, &facing_b, touch.normal, Side::A), touch.normal);
        } else if facing_b.is_reference_for(&facing_a) {
            kept = four(clip(&facing_b, &facing_a, touch.normal, Side::B), touch.normal);
        }
        if !kept.is_empty() {
            let [normal, opposite] = [touch.normal, -touch.normal];
            beyond = facing_a.beyond(pair.a.radius, opposite) + facing_b.beyond(pair.b.radius, normal);
        }
    }
    if kept.is_empty() {
        kept.push(single(pair, touch));
    }
    for point in &mut kept {
        point.on_a -= touch.normal * pair.a.radius;
        point.on_b += touch.normal * pair.b.radius;
        point.beyond = beyond;
    }
    kept
}

/// Where two forms are deepest in each other, or nearest: on the surfaces of the rounded forms, in the pair's frame.
pub(super) fn deepest(pair: &Pair<'_>, touch: &Touch) -> (DVec3, DVec3) {
    // Of two faces a corner of one may lie far beside the other.
    if touch.witnesses.is_none() && touch.edges.is_none() {
        let deepest = &points(pair, touch)[0];
        return (deepest.on_a, deepest.on_b);
    }
    let (on_a, on_b) = on_cores(pair, touch, || false);
    (on_a - touch.normal * pair.a.radius, on_b + touch.normal * pair.b.radius)
}

/// The same on the cores: known nearest points, the crossing of two edges, or a corner of one and the point across from it on
/// the face of the other.
fn on_cores(pair: &Pair<'_>, touch: &Touch, is_face_of_a: impl FnOnce() -> bool) -> (DVec3, DVec3) {
    if let Some(witnesses) = touch.witnesses {
        return witnesses;
    }
    if let Some([on_a, on_b]) = touch.edges {
        return nearest_of_lines(on_a, on_b);
    }
    let (on_a, on_b) = (pair.a.support(-touch.normal).point, pair.b.support(touch.normal).point);
    let across = touch.normal * touch.normal.dot(on_b - on_a);
    if is_face_of_a() { (on_b - across, on_b) } else { (on_a, on_a + across) }
}

/// Which form the reference feature belongs to.
#[derive(Clone, Copy, PartialEq)]
enum Side {
    A,
    B,
}

/// The part of `incident` that lies over `reference`, paired with its projection.
fn clip(reference: &Facing, incident: &Facing, normal: DVec3, side: Side) -> Points {
    let mut polygon: Polygon =
        incident.corners.iter().map(|corner| Clipped { point: corner.point, name: short(corner.index) }).collect();
    let corners = &reference.corners;
    let middle = corners.iter().map(|corner| corner.point).sum::<DVec3>() / corners.len() as f64;
    for (i, corner) in corners.iter().enumerate() {
        let along = corners[(i + 1) % corners.len()].point - corner.point;
        let outward = if corners.len() == 2 { -along } else { along.cross(normal) };
        let outward = if outward.dot(middle - corner.point) > 0.0 { -outward } else { outward };
        polygon = cut(&polygon, corner.point, outward, short(corner.index));
    }
    let base = corners[0].point;
    let reference_name = corners.iter().map(|corner| short(corner.index)).min().unwrap_or(0);
    let pairs = polygon.into_iter().map(|clipped| {
        let foot = if corners.len() == 2 {
            let along = (corners[1].point - base).try_unit().unwrap_or_default();
            base + along * along.dot(clipped.point - base)
        } else {
            clipped.point - normal * reference.height(clipped.point, normal)
        };
        let (on_a, on_b, high, low) = match side {
            Side::A => (foot, clipped.point, reference_name, clipped.name),
            Side::B => (clipped.point, foot, clipped.name, reference_name),
        };
        Point { on_a, on_b, beyond: 0.0, feature_pair: u32::from(high) << 16 | u32::from(low) }
    });
    pairs.collect()
}

/// Keeps what lies behind the plane through `base` with normal `outward`.
fn cut(polygon: &[Clipped], base: DVec3, outward: DVec3, name: u16) -> Polygon {
    let height = |clipped: &Clipped| outward.dot(clipped.point - base);
    let mut kept = SmallVec::with_capacity(polygon.len() + 1);
    for (i, current) in polygon.iter().enumerate() {
        let next = &polygon[(i + 1) % polygon.len()];
        let (here, there) = (height(current), height(next));
        if here <= 0.0 {
            kept.push(*current);
        }
        // A segment is walked once: its way back would give the same crossing again.
        let is_way_back = polygon.len() == 2 && i == 1;
        if (here < 0.0 && there > 0.0 || here > 0.0 && there < 0.0) && !is_way_back {
            let point = current.point + (next.point - current.point) * (here / (here - there));
            kept.push(Clipped { point, name: crossing(current.name, next.name, name) });
        }
    }
    kept
}

/// Names the point where the side `cut_by` crosses the edge between two named corners.
fn crossing(from: u16, to: u16, cut_by: u16) -> u16 {
    hash([from, to, cut_by].map(u32::from).into_iter())
}

/// The same features always have the same name, and others hardly ever.
fn hash(names: impl Iterator<Item = u32>) -> u16 {
    let hash = names.fold(0x811C_9DC5u32, |hash, name| (hash ^ name).wrapping_mul(0x0100_0193));
    0x8000 | ((hash ^ hash >> 15) & 0x7FFF) as u16
}

/// At most four points that span the touch best, deepest first.
pub(super) fn four(mut candidates: Points, normal: DVec3) -> Points {
    let depth = |point: &Point| (point.on_b - point.on_a).dot(normal);
    let mut chosen: Points = SmallVec::with_capacity(4);
    while chosen.len() < 4 && !candidates.is_empty() {
        let gain = |point: &Point| match chosen.as_slice() {
            [] => depth(point),
            [p] => p.on_a.distance_squared(point.on_a),
            [p, q] => (q.on_a - p.on_a).cross(point.on_a - p.on_a).length_squared(),
            [p, q, r, ..] => [(p, q), (q, r), (r, p)]
                .map(|(u, v)| -area_sign(p, q, r, normal) * (v.on_a - u.on_a).cross(point.on_a - u.on_a).dot(normal))
                .into_iter()
                .fold(0.0, f64::max),
        };
        let mut best = (0, f64::NEG_INFINITY);
        for (index, candidate) in candidates.iter().enumerate() {
            let value = gain(candidate);
            if value > best.1 {
                best = (index, value);
            }
        }
        if !chosen.is_empty() && best.1 <= 0.0 {
            break;
        }
        chosen.push(candidates.remove(best.0));
    }
    chosen
}

fn area_sign(p: &Point, q: &Point, r: &Point, normal: DVec3) -> f64 {
    (q.on_a - p.on_a).cross(r.on_a - p.on_a).dot(normal).signum()
}

/// The one point of a touch that is no flat one.
fn single(pair: &Pair<'_>, touch: &Touch) -> Point {
    let facing_a = || facing(&pair.a, -touch.normal);
    let is_known = touch.witnesses.is_some() || touch.edges.is_some();
    let lines = if is_known { None } else { Some([facing_a(), facing(&pair.b, touch.normal)]) };
    let (on_a, on_b) = match &lines {
        // Plates edge on: their faces are lines, which cross.
        Some([a, b]) if a.corners.len() == 2 && b.corners.len() == 2 => {
            nearest_of_lines([a.corners[0], a.corners[1]], [b.corners[0], b.corners[1]])
        }
        _ => on_cores(pair, touch, || facing_a().is_flat_face()),
    };
    let [name_a, name_b] = touch.features.unwrap_or_else(|| {
        [pair.a.support(-touch.normal).index, pair.b.support(touch.normal).index].map(|index| name(&[index]))
    });
    Point { on_a, on_b, beyond: 0.0, feature_pair: u32::from(name_a) << 16 | u32::from(name_b) }
}

/// Names the features that some vertices of the difference come from, on `a` and on `b`.
pub(super) fn names(vertices: &[Vertex]) -> [u16; 2] {
    [0, 1].map(|side: usize| {
        let mut corners: SmallVec<[u32; 4]> = SmallVec::new();
        for corner in vertices.iter().map(|vertex| vertex.corners[side]) {
            if let Err(at) = corners.binary_search(&corner) {
                corners.insert(at, corner);
            }
        }
        name(&corners)
    })
}

/// Names a pair of edges.
pub(super) fn edge_names(edges: [[Corner; 2]; 2]) -> [u16; 2] {
    edges.map(|ends| name(&ends.map(|end| end.index)))
}

/// Names a corner by its number; an edge or a face, by its corners in order, by a hash of them.
fn name(corners: &[u32]) -> u16 {
    match corners {
        [corner] => short(*corner),
        _ => hash(corners.iter().copied()),
    }
}

/// The nearest points of the lines through two edges, or of edges that are parallel to within what has a square.
fn nearest_of_lines([p, q]: [Corner; 2], [r, s]: [Corner; 2]) -> (DVec3, DVec3) {
    let (u, v, w) = (q.point - p.point, s.point - r.point, p.point - r.point);
    let across = u.cross(v);
    let area = across.length_squared();
    if area < SQUARE_MIN {
        let onto = |start: DVec3, way: DVec3, point: DVec3| {
            let share = (point - start).dot(way) / way.length_squared().max(SQUARE_MIN);
            start + way * share.clamp(0.0, 1.0)
        };
        let on_second = onto(r.point, v, p.point);
        return (onto(p.point, u, on_second), on_second);
    }
    let on_first = (v.cross(w).dot(across) / area).clamp(0.0, 1.0);
    let on_second = (u.cross(w).dot(across) / area).clamp(0.0, 1.0);
    (p.point + u * on_first, r.point + v * on_second)
}

/// Names of corners are cut to 16 bits each; they name a pair within one contact, not in the world.
pub(super) fn short(index: u32) -> u16 {
    (index & 0x7FFF) as u16
}
