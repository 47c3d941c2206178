//! A form as the union of convex pieces, and the least signed distance of two of them.
//!
//! # Method
//! Every pair of pieces whose balls are not farther apart than the best so far is asked; all pairs, no tree.
//!
//! # Limits
//! The least signed distance of pieces is that of the forms where those are apart. Of forms that overlap it only tells that
//! they do.

use glam::DVec3;

use super::{double::Double, form::Solid, place::Place, truth::Truth, winding::winding_number};

/// A convex piece, with a ball around it.
#[derive(Clone, Debug)]
pub struct Piece {
    /// The form.
    pub solid: Solid,
    /// Where it is in the whole, if not at its origin.
    pub part: Option<(DVec3, glam::DQuat)>,
}

/// Convex pieces, and the surface that winds around matter if there is any.
#[derive(Clone, Debug, Default)]
pub struct Union {
    /// The pieces.
    pub pieces: Vec<Piece>,
    /// The triangles of solid meshes: what they wind around is in the form.
    pub walls: Vec<[DVec3; 3]>,
}

impl Piece {
    /// The middle of a ball around it, in the whole's frame, and its radius, metres; roughly. A half space has none.
    fn ball(&self) -> (DVec3, f64) {
        let (position, rotation) = self.part.unwrap_or((DVec3::ZERO, glam::DQuat::IDENTITY));
        match &self.solid.core {
            super::Core::Hull(points) => {
                let middle = points.iter().sum::<DVec3>() / points.len() as f64;
                let radius = points.iter().map(|point| point.distance(middle)).fold(0.0, f64::max);
                (position + rotation.normalize() * middle, radius + self.solid.radius)
            }
            super::Core::HalfSpace { .. } => (position, f64::INFINITY),
            _ => (position, self.solid.reach()),
        }
    }

    /// The place of the piece, of a whole that is at another.
    #[must_use]
    pub fn place(&self, whole: &Place) -> Place {
        Place { part: self.part, ..*whole }
    }
}

impl Union {
    /// One convex piece.
    #[must_use]
    pub fn of(solid: Solid) -> Self {
        Self { pieces: vec![Piece { solid, part: None }], walls: Vec::new() }
    }

    /// The least signed distance of two pieces at the start, and which they are.
    #[must_use]
    pub fn nearest(a: (&Self, &Place), b: (&Self, &Place)) -> Option<(Truth, [usize; 2])> {
        let balls = |(form, place): (&Self, &Place)| -> Vec<(DVec3, f64)> {
            let turn = place.rotation.normalize();
            form.pieces.iter().map(|piece| piece.ball()).map(|(middle, radius)| (turn * middle, radius)).collect()
        };
        let (of_a, of_b) = (balls(a), balls(b));
        let apart = b.1.position - a.1.position;
        let mut pairs: Vec<(f64, usize, usize)> = Vec::new();
        for (i, (middle_a, radius_a)) in of_a.iter().enumerate() {
            for (j, (middle_b, radius_b)) in of_b.iter().enumerate() {
                let way = apart + *middle_b - *middle_a;
                let reach = radius_a + radius_b;
                // Rounding of positions far off and of the products above.
                let slack = 1e-12 * (way.length() + apart.length() + middle_a.length() + middle_b.length() + reach);
                let least = if reach.is_finite() { way.length() - reach - slack } else { f64::NEG_INFINITY };
                pairs.push((least, i, j));
            }
        }
        pairs.sort_by(|one, other| one.0.total_cmp(&other.0));
        let mut best: Option<(Truth, [usize; 2])> = None;
        for (least, i, j) in pairs {
            if best.as_ref().is_some_and(|(truth, _)| least > truth.nearest()) {
                break;
            }
            let (one, other) = (&a.0.pieces[i], &b.0.pieces[j]);
            let sides = [(&one.solid, &one.place(a.1)), (&other.solid, &other.place(b.1))];
            let truth = Truth::at(sides, Double::default(), &[]);
            if best.as_ref().is_none_or(|(known, _)| truth.nearest() < known.nearest()) {
                best = Some((truth, [i, j]));
            }
        }
        best
    }

    /// Whether the walls wind around a point of the world; only of points that are off them.
    #[must_use]
    pub fn winds_around(&self, place: &Place, point: DVec3) -> bool {
        self.winds_around_seen(place, point - place.position)
    }

    /// The same of a point as it is seen from where the form is, which far off loses nothing.
    fn winds_around_seen(&self, place: &Place, seen: DVec3) -> bool {
        let local = place.rotation.normalize().inverse() * seen;
        !self.walls.is_empty() && winding_number(&self.walls, local) != 0
    }

    /// Whether the walls wind around some piece of another form, which crosses none of them.
    #[must_use]
    pub fn holds_some_of(&self, place: &Place, other: &Self, other_place: &Place) -> bool {
        let point_of = |piece: &Piece| {
            let (position, rotation) = piece.part.unwrap_or((DVec3::ZERO, glam::DQuat::IDENTITY));
            let local = match &piece.solid.core {
                super::Core::Hull(points) => *points.first()?,
                super::Core::HalfSpace { .. } => return None,
                _ => DVec3::ZERO,
            };
            let whole = position + rotation.normalize() * local;
            Some((other_place.position - place.position) + other_place.rotation.normalize() * whole)
        };
        !self.walls.is_empty()
            && other.pieces.iter().filter_map(point_of).any(|seen| self.winds_around_seen(place, seen))
    }
}

#[cfg(test)]
mod tests {
    use glam::DQuat;

    use super::*;
    use crate::oracle::{Core, PlacedSolid};

    /// A point a micrometre beside a wall, which far off is less than the rounding of a position.
    #[test]
    fn on_which_side_of_a_wall_a_form_is_does_not_depend_on_how_far_off_both_are() {
        let corner = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
        let faces = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
        let walls = faces.map(|face: [usize; 3]| face.map(|at| corner[at])).to_vec();
        let solid = Union { pieces: Vec::new(), walls };
        for far in [0.0, 1e8, 3e12] {
            let place = |position: DVec3| {
                let solid = Solid { core: Core::Point, radius: 0.0 };
                Place::of(&PlacedSolid { solid, position, rotation: DQuat::IDENTITY })
            };
            for (beside, is_held) in [(1e-6, true), (-1e-6, false)] {
                let point = DVec3::new(beside, 0.25, 0.25);
                let other = Union::of(Solid { core: Core::Hull(vec![point]), radius: 0.0 });
                let place = place(DVec3::splat(far));
                assert_eq!(solid.holds_some_of(&place, &other, &place), is_held, "{beside} at {far}");
            }
        }
    }
}
