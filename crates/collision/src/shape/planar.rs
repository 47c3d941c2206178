//! Hulls of points in one plane.
//!
//! # Method
//! Andrew's monotone chain (1979) in the coordinate plane in which the polygon is largest, with exact turns.

use glam::DVec3;
use robust::{Coord, orient2d};

use super::topology::{Edge, Face, Span, Topology, index_u32};

/// The hull of points in one plane, as a polygon with two sides.
pub(super) fn polygon(points: &[DVec3], [a, b, c]: [usize; 3]) -> Topology {
    let across = exact_cross(points[a], points[b], points[c]);
    let size = across.abs();
    let project: fn(DVec3) -> Coord<f64> = if size.x >= size.y && size.x >= size.z {
        |p| Coord { x: p.y, y: p.z }
    } else if size.y >= size.z {
        |p| Coord { x: p.z, y: p.x }
    } else {
        |p| Coord { x: p.x, y: p.y }
    };
    let flat: Vec<Coord<f64>> = points.iter().map(|&p| project(p)).collect();
    let mut order: Vec<usize> = (0..points.len()).collect();
    order.sort_by(|&i, &j| flat[i].x.total_cmp(&flat[j].x).then(flat[i].y.total_cmp(&flat[j].y)));
    let mut outline = half_outline(&flat, order.iter().copied());
    outline.pop();
    outline.extend(half_outline(&flat, order.iter().rev().copied()));
    outline.pop();

    let front = Face::of(points, outline.clone());
    let back = front.turned_over(points);
    let edges = (0..outline.len())
        .map(|i| Edge { start: outline[i], end: outline[(i + 1) % outline.len()], left: 0, right: 1 })
        .collect();
    Topology { span: Span::Polygon, faces: vec![front, back], edges }
}

fn half_outline(flat: &[Coord<f64>], order: impl Iterator<Item = usize>) -> Vec<u32> {
    let mut chain: Vec<usize> = Vec::new();
    for index in order {
        while let [.., before, last] = chain[..] {
            if orient2d(flat[before], flat[last], flat[index]) > 0.0 {
                break;
            }
            chain.pop();
        }
        chain.push(index);
    }
    chain.into_iter().map(index_u32).collect()
}

/// The three projections of `(b - a) × (c - a)`, each with an exact sign.
pub(super) fn exact_cross(a: DVec3, b: DVec3, c: DVec3) -> DVec3 {
    let on = |u: fn(DVec3) -> Coord<f64>| orient2d(u(a), u(b), u(c));
    DVec3::new(on(|p| Coord { x: p.y, y: p.z }), on(|p| Coord { x: p.z, y: p.x }), on(|p| Coord { x: p.x, y: p.y }))
}
