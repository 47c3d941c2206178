//! A simple form by value: all that a kernel reads of it, without the memory in which its geometry lies.
//!
//! # Method
//! Forms of up to four numbers. A world keeps them beside the poses of its shapes, so that a question waits for one place
//! in memory and not for a second one that the first leads to.

use glam::DVec3;

use super::{Convex, Core, Form, Geometry};

/// A form of up to four numbers.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Simple {
    kind: Kind,
    radius: f64,
    sizes: DVec3,
    reach: f64,
}

#[derive(Clone, Copy, Debug)]
enum Kind {
    Point,
    Segment,
    Cuboid,
    Cylinder,
    Cone,
    Ellipsoid,
}

impl Simple {
    /// `None` for a hull, a triangle, and whatever is not convex.
    pub(crate) fn of(geometry: &Geometry) -> Option<Self> {
        let Form::Convex(Convex { core, radius }) = geometry.form() else {
            return None;
        };
        let two = |first: f64, second: f64| DVec3::new(first, second, 0.0);
        let (kind, sizes) = match core {
            Core::Point => (Kind::Point, DVec3::ZERO),
            Core::Segment { half_height } => (Kind::Segment, two(*half_height, 0.0)),
            Core::Cuboid { half_extents } => (Kind::Cuboid, *half_extents),
            Core::Cylinder { half_height, radius } => (Kind::Cylinder, two(*half_height, *radius)),
            Core::Cone { half_height, radius } => (Kind::Cone, two(*half_height, *radius)),
            Core::Ellipsoid { radii } => (Kind::Ellipsoid, *radii),
            Core::Hull(_) | Core::Triangle(_) => return None,
        };
        Some(Self { kind, radius: *radius, sizes, reach: geometry.reach() })
    }

    /// The form.
    #[inline]
    pub(crate) fn convex(&self) -> Convex {
        let DVec3 { x, y, .. } = self.sizes;
        let core = match self.kind {
            Kind::Point => Core::Point,
            Kind::Segment => Core::Segment { half_height: x },
            Kind::Cuboid => Core::Cuboid { half_extents: self.sizes },
            Kind::Cylinder => Core::Cylinder { half_height: x, radius: y },
            Kind::Cone => Core::Cone { half_height: x, radius: y },
            Kind::Ellipsoid => Core::Ellipsoid { radii: self.sizes },
        };
        Convex { core, radius: self.radius }
    }

    /// As [`Geometry::reach`].
    pub(crate) fn reach(&self) -> f64 {
        self.reach
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_simple_form_is_the_form_that_it_was_made_of() {
        let corners = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
        let forms = [
            Geometry::sphere(0.5),
            Geometry::capsule(0.25, 0.5),
            Geometry::cuboid(DVec3::new(1.0, 2.0, 3.0)),
            Geometry::cuboid(DVec3::new(1.0, 0.0, 3.0)).and_then(|plate| plate.rounded(0.125)),
            Geometry::cylinder(1.5, 0.75),
            Geometry::cone(1.5, 0.75),
            Geometry::ellipsoid(DVec3::new(1.0, 2.0, 3.0)),
            Geometry::hull(&corners),
            Geometry::mesh(&corners, &[[0, 1, 2]]),
            Geometry::half_space(DVec3::Y, 1.0),
        ];
        let mut simple_count = 0;
        for geometry in forms.into_iter().flatten().chain([Geometry::point()]) {
            if let Some(simple) = Simple::of(&geometry) {
                simple_count += 1;
                assert_eq!(format!("{:?}", Form::Convex(simple.convex())), format!("{:?}", geometry.form()));
                assert_eq!(simple.reach().to_bits(), geometry.reach().to_bits());
            }
        }
        assert_eq!(simple_count, 8);
    }
}
