//! Simplices that a hull or a triangle is searched by.

use glam::DVec3;

use crate::{
    math::{Aabb, Norm},
    shape::{Hull, Span, radius_up},
};

/// A point, a segment, a triangle or a tetrahedron.
#[derive(Clone, Copy, Debug)]
pub(super) struct Simplex {
    corners: [DVec3; 4],
    count: usize,
}

impl Simplex {
    /// The hull of one to four points.
    pub(super) fn of(points: &[DVec3]) -> Self {
        let mut corners = [DVec3::ZERO; 4];
        corners[..points.len()].copy_from_slice(points);
        Self { corners, count: points.len() }
    }

    pub(super) fn corners(&self) -> &[DVec3] {
        &self.corners[..self.count]
    }

    /// A ball that holds it: the middle of its longest edge or the mean of its corners, and a radius, rounded up.
    pub(super) fn ball(&self) -> (DVec3, f64) {
        let [i, j] = self.longest_edge();
        let middle = self.corners[i] * 0.5 + self.corners[j] * 0.5;
        let mean = self.mean();
        let (about_middle, about_mean) = (radius_up(middle, self.corners()), radius_up(mean, self.corners()));
        if about_middle <= about_mean { (middle, about_middle) } else { (mean, about_mean) }
    }

    /// The mean of its corners.
    pub(super) fn mean(&self) -> DVec3 {
        self.corners().iter().sum::<DVec3>() / self.count as f64
    }

    /// Both halves, cut at the middle of the longest edge; the same twice if it is a point.
    pub(super) fn halves(&self) -> [Self; 2] {
        let [i, j] = self.longest_edge();
        let middle = self.corners[i] * 0.5 + self.corners[j] * 0.5;
        [i, j].map(|corner| {
            let mut half = *self;
            half.corners[corner] = middle;
            half
        })
    }

    pub(super) fn bounds(&self) -> Aabb {
        let first = self.corners[0];
        let around = |bounds: Aabb, &corner: &DVec3| Aabb::new(bounds.min.min(corner), bounds.max.max(corner));
        self.corners().iter().fold(Aabb::new(first, first), around)
    }

    /// Unit normals of its faces, inwards, as far as they can be told; none unless it is a tetrahedron.
    pub(super) fn inward_normals(&self) -> impl Iterator<Item = DVec3> + '_ {
        const FACES: [[usize; 4]; 4] = [[1, 2, 3, 0], [0, 2, 3, 1], [0, 1, 3, 2], [0, 1, 2, 3]];
        FACES.iter().filter(|_| self.count == 4).filter_map(|face| {
            let [a, b, c, apex] = face.map(|corner| self.corners[corner]);
            let normal = (b - a).cross(c - a).try_unit()?;
            Some(if normal.dot(apex - a) < 0.0 { -normal } else { normal })
        })
    }

    fn longest_edge(&self) -> [usize; 2] {
        let (mut longest, mut most) = ([0, 0], -1.0);
        for i in 0..self.count {
            for j in 0..i {
                let length = self.corners[i].distance_squared(self.corners[j]);
                if length > most {
                    (longest, most) = ([j, i], length);
                }
            }
        }
        longest
    }
}

/// Simplices that a hull is made up of: for a solid one its faces' triangles with its middle.
pub(super) fn simplices(hull: &Hull) -> Vec<Simplex> {
    let topology = hull.topology();
    match topology.span {
        Span::Point => vec![Simplex::of(&hull.vertices()[..1])],
        Span::Segment => {
            let ends = topology.edges[0];
            vec![Simplex::of(&[ends.start, ends.end].map(|end| hull.vertex(end)))]
        }
        Span::Polygon => {
            let count = topology.faces[0].vertices.len().saturating_sub(2);
            hull.face_triangles().take(count).map(|corners| Simplex::of(&corners)).collect()
        }
        Span::Solid => hull.face_triangles().map(|[a, b, c]| Simplex::of(&[hull.center(), a, b, c])).collect(),
    }
}
