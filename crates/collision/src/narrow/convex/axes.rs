//! The depth of two cores that overlap, by separating axes.
//!
//! # Method
//! The Minkowski difference of two polytopes is bounded by faces of either and by edge pairs, so its least depth lies
//! along one of their normals. Edge pairs are first tested on the Gauss map: only pairs whose arcs cross make a face. The
//! test keeps what rounding leaves in doubt; a candidate that would win is measured by the support functions of both
//! cores, so a doubtful one can never make the depth too small. Flat and straight cores have no Gauss map worth the name:
//! all their edge pairs are measured in full. Each edge axis is normalised before anything is projected on it; only an
//! exactly zero product is passed over.
//!
//! # Source
//! Gottschalk, Lin, Manocha, "OBBTree" (1996), section 5; Gregorius, "The separating axis test between convex
//! polyhedra" (GDC 2013): Gauss map.
//!
//! # Limits
//! Where more than [`WORK_MAX`] edge pairs or corners would be looked at, only a few fixed axes are measured: the depth is
//! then a true way out, but the lower bound is open, and the answer says that the budget ended it.

use glam::DVec3;

use super::{
    body::{Body, Corner},
    frame::Pair,
    gjk,
};
use crate::{
    answer::Stop,
    math::{Norm, exact, try_unit},
    shape::{Core, Hull, Span},
    tolerance::{ARC_DOUBT, AXIS_LEAN, PAIR_ROUNDING},
};

/// Most edge pairs, and most corners under all face axes, that are looked at: some 50 ms.
const WORK_MAX: usize = 1 << 24;

/// The depth of two cores in the pair's frame: negative if an axis parts them.
pub(super) struct Depth {
    /// The best value: the width along `normal`.
    pub(super) best: f64,
    /// The depth is not below this; negative infinity unless it is above 0: of cores that are apart the axes do not tell how
    /// far, since what is nearest may be a corner.
    pub(super) lower: f64,
    /// The depth is not above this: the width along `normal`, rounding included.
    pub(super) upper: f64,
    /// Unit vector from `b` to `a`.
    pub(super) normal: DVec3,
    /// The edges whose product the normal is, if it is one.
    pub(super) edges: Option<[[Corner; 2]; 2]>,
    /// Axes measured.
    pub(super) iterations: u32,
    pub(super) stop: Stop,
}

/// The depth that is proved when no axis parts the cores by more than `highest`.
pub(super) fn proved_depth(highest: f64) -> f64 {
    let depth = -highest - AXIS_LEAN;
    if depth > 0.0 { depth } else { f64::NEG_INFINITY }
}

/// An edge in the pair's frame.
struct Edge {
    ends: [Corner; 2],
    along: DVec3,
    /// Outward normals of the faces at its sides.
    sides: [DVec3; 2],
}

/// The faces and edges of a core in the pair's frame.
struct Outline {
    normals: Vec<DVec3>,
    edges: Vec<Edge>,
    is_solid: bool,
}

/// Measures the depth of two cores along all axes that can be the least.
pub(super) fn depth(pair: &Pair<'_>) -> Depth {
    measured(pair, &outline(&pair.a), &outline(&pair.b))
}

/// The same, if the cores are polytopes and all axes can be looked at.
pub(super) fn bounded_depth(pair: &Pair<'_>) -> Option<Depth> {
    if !pair.a.core.is_polytope() || !pair.b.core.is_polytope() {
        return None;
    }
    let (a, b) = (outline(&pair.a), outline(&pair.b));
    is_few(pair, &a, &b).then(|| measured(pair, &a, &b))
}

fn measured(pair: &Pair<'_>, a: &Outline, b: &Outline) -> Depth {
    let is_bounded = is_few(pair, a, b);
    let mut best = Best {
        pair,
        separation: f64::NEG_INFINITY,
        highest: f64::NEG_INFINITY,
        normal: DVec3::X,
        edges: None,
        tested: 0,
    };
    if is_bounded {
        all_axes(&mut best, a, b);
    } else {
        let apart = pair.a.center() - pair.b.center();
        for axis in [DVec3::X, DVec3::Y, DVec3::Z, apart.try_unit().unwrap_or(DVec3::X)] {
            best.try_axis(axis);
            best.try_axis(-axis);
        }
    }
    if best.tested == 0 {
        let across = perpendicular(a.edges.first().or(b.edges.first()));
        best.try_axis(across);
        best.try_axis(-across);
    }
    let lower = if is_bounded { proved_depth(best.highest) } else { f64::NEG_INFINITY };
    Depth {
        best: -best.separation,
        lower,
        upper: -best.separation + PAIR_ROUNDING,
        normal: best.normal,
        edges: best.edges,
        iterations: best.tested,
        stop: if is_bounded { Stop::Converged } else { Stop::Budget },
    }
}

/// Whether all axes can be looked at.
fn is_few(pair: &Pair<'_>, a: &Outline, b: &Outline) -> bool {
    let corners = pair.a.corner_count().zip(pair.b.corner_count()).map(|(a, b)| a + b);
    a.edges.len().saturating_mul(b.edges.len()) <= WORK_MAX
        && corners.is_some_and(|corners| (a.normals.len() + b.normals.len()).saturating_mul(corners) <= WORK_MAX)
}

/// The faces of both and the edge pairs that can matter.
fn all_axes(best: &mut Best<'_>, a: &Outline, b: &Outline) {
    for &normal in &a.normals {
        best.try_axis(-normal);
    }
    for &normal in &b.normals {
        best.try_axis(normal);
    }
    if a.is_solid && b.is_solid {
        crossing_edges(best, a, b);
    } else {
        all_edges(best, a, b);
    }
}

/// The axis of greatest separation so far. A face is kept unless an edge pair is better by more than rounding.
struct Best<'a> {
    pair: &'a Pair<'a>,
    separation: f64,
    highest: f64,
    normal: DVec3,
    edges: Option<[[Corner; 2]; 2]>,
    tested: u32,
}

impl Best<'_> {
    fn separation_along(&mut self, normal: DVec3) -> f64 {
        self.tested += 1;
        let separation = normal.dot(gjk::support(self.pair, normal).point);
        self.highest = self.highest.max(separation);
        separation
    }

    fn try_axis(&mut self, normal: DVec3) {
        let separation = self.separation_along(normal);
        if separation > self.separation {
            (self.separation, self.normal, self.edges) = (separation, normal, None);
        }
    }

    fn try_edges(&mut self, normal: DVec3, on_a: &Edge, on_b: &Edge) {
        let separation = self.separation_along(normal);
        if separation > self.separation + PAIR_ROUNDING {
            (self.separation, self.normal) = (separation, normal);
            self.edges = Some([on_a.ends, on_b.ends]);
        }
    }
}

/// Edge pairs of two solid cores whose arcs cross on the Gauss map.
fn crossing_edges(best: &mut Best<'_>, a: &Outline, b: &Outline) {
    let middle = best.pair.b.center();
    for on_b in &b.edges {
        for on_a in &a.edges {
            if !arcs_may_cross(on_a, on_b) {
                continue;
            }
            let Some(axis) = on_a.along.cross(on_b.along).try_unit() else {
                continue;
            };
            let outward = axis.dot(on_b.ends[0].point - middle);
            let normal = if outward < 0.0 { -axis } else { axis };
            let quick = normal.dot(on_a.ends[0].point - on_b.ends[0].point);
            if quick > best.highest - PAIR_ROUNDING {
                best.try_edges(normal, on_a, on_b);
            }
        }
    }
}

/// Whether the arc of one edge's normals may cross the (mirrored) arc of the other's; doubt counts as yes.
fn arcs_may_cross(on_a: &Edge, on_b: &Edge) -> bool {
    let is_split = |[p, q]: [DVec3; 2], pole: DVec3| {
        let (p, q) = (p.dot(pole), q.dot(pole));
        !(p > ARC_DOUBT && q > ARC_DOUBT || p < -ARC_DOUBT && q < -ARC_DOUBT)
    };
    is_split(on_b.sides, on_a.along) && is_split(on_a.sides, on_b.along)
}

/// All edge pairs in both directions, each measured in full.
fn all_edges(best: &mut Best<'_>, a: &Outline, b: &Outline) {
    for on_b in &b.edges {
        for on_a in &a.edges {
            if let Some(axis) = on_a.along.cross(on_b.along).try_unit() {
                best.try_edges(axis, on_a, on_b);
                best.try_edges(-axis, on_a, on_b);
            }
        }
    }
}

/// Any direction across an edge; x where there is none.
fn perpendicular(edge: Option<&Edge>) -> DVec3 {
    edge.map_or(DVec3::X, |edge| edge.along.any_orthonormal_vector())
}

fn outline(body: &Body<'_>) -> Outline {
    match body.core {
        Core::Point | Core::Cylinder { .. } | Core::Cone { .. } | Core::Ellipsoid { .. } => {
            Outline { normals: Vec::new(), edges: Vec::new(), is_solid: false }
        }
        Core::Segment { .. } => {
            let edge = edge(body, [0, 1], body.turn(DVec3::Y), [DVec3::ZERO; 2]);
            Outline { normals: Vec::new(), edges: vec![edge], is_solid: false }
        }
        Core::Cuboid { half_extents } => cuboid(body, half_extents.min_element() > 0.0),
        Core::Hull(hull) => hull_outline(body, hull),
        Core::Triangle(corners) => triangle(body, corners),
    }
}

fn edge(body: &Body<'_>, [start, end]: [u32; 2], along: DVec3, sides: [DVec3; 2]) -> Edge {
    Edge { ends: [body.corner(start), body.corner(end)], along, sides }
}

fn cuboid(body: &Body<'_>, is_solid: bool) -> Outline {
    let axes = [body.turn(DVec3::X), body.turn(DVec3::Y), body.turn(DVec3::Z)];
    let mut edges = Vec::with_capacity(12);
    for axis in 0..3 {
        let (second, third) = ((axis + 1) % 3, (axis + 2) % 3);
        for corner in 0..4u32 {
            let (high_second, high_third) = (corner & 1, corner >> 1);
            let start = high_second << second | high_third << third;
            let side = |high: u32, axis: usize| if high == 1 { axes[axis] } else { -axes[axis] };
            let sides = [side(high_second, second), side(high_third, third)];
            edges.push(edge(body, [start, start | 1 << axis], axes[axis], sides));
        }
    }
    Outline { normals: axes.iter().flat_map(|&axis| [-axis, axis]).collect(), edges, is_solid }
}

fn hull_outline(body: &Body<'_>, hull: &Hull) -> Outline {
    let topology = hull.topology();
    let side = |face: u32| topology.faces.get(face as usize).map_or(DVec3::ZERO, |face| body.turn(face.normal));
    let vertices = hull.vertices();
    let edges = topology.edges.iter().filter_map(|e| {
        let along = try_unit(vertices[e.end as usize] - vertices[e.start as usize])?;
        Some(edge(body, [e.start, e.end], body.turn(along), [side(e.left), side(e.right)]))
    });
    Outline {
        edges: edges.collect(),
        normals: topology.faces.iter().map(|face| body.turn(face.normal)).collect(),
        is_solid: topology.span == Span::Solid,
    }
}

fn triangle(body: &Body<'_>, corners: &[DVec3; 3]) -> Outline {
    let [a, b, c] = *corners;
    let normal = try_unit(exact::cross(b - a, c - a)).map(|normal| body.turn(normal));
    let sides = [[0, 1], [1, 2], [2, 0]];
    let edges = sides.into_iter().filter_map(|[i, j]| {
        let along = try_unit(corners[j] - corners[i])?;
        Some(edge(body, [i, j].map(|corner| corner as u32), body.turn(along), [DVec3::ZERO; 2]))
    });
    Outline { edges: edges.collect(), normals: normal.into_iter().flat_map(|n| [n, -n]).collect(), is_solid: false }
}
