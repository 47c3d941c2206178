//! The questions as parry3d answers them, in f32 and in f64: the same code over both crates.

macro_rules! engine {
    ($name:ident, $parry:ident, $real:ty) => {
        pub(crate) mod $name {
            use collision::{DVec3, math};
            use $parry::{
                math::{Pose, Rotation, Vector},
                query,
                shape::{Capsule, ConvexPolyhedron, Cuboid, Cylinder, Shape},
            };

            use crate::{
                ask::{Form, Said},
                workload::Pair,
            };

            fn vector(v: DVec3) -> Vector {
                Vector::from_array(v.to_array().map(|part| part as $real))
            }

            fn shape(form: &Form) -> Option<Box<dyn Shape>> {
                Some(match form {
                    Form::Cuboid(half_extents) => Box::new(Cuboid::new(vector(*half_extents))),
                    Form::Capsule { half_height, radius } => {
                        Box::new(Capsule::new_y(*half_height as $real, *radius as $real))
                    }
                    Form::Cylinder { half_height, radius } => {
                        Box::new(Cylinder::new(*half_height as $real, *radius as $real))
                    }
                    Form::Hull(points) => {
                        let points: Vec<Vector> = points.iter().copied().map(vector).collect();
                        Box::new(ConvexPolyhedron::from_convex_hull(&points)?)
                    }
                })
            }

            fn pose(pose: &math::Pose) -> Pose {
                let rotation = Rotation::from_array(pose.rotation.to_array().map(|part| part as $real));
                Pose::from_parts(vector(pose.position), rotation.normalize())
            }

            pub(crate) fn ask(pair: &Pair) -> Option<Said> {
                let [a, b] = [shape(&pair.forms[0])?, shape(&pair.forms[1])?];
                let [at_a, at_b] = [pose(&pair.poses[0]), pose(&pair.poses[1])];
                let touches = query::intersection_test(&at_a, &*a, &at_b, &*b).ok()?.intersecting;
                let distance = f64::from(query::distance(&at_a, &*a, &at_b, &*b).ok()?.distance);
                let contact = query::contact(&at_a, &*a, &at_b, &*b, 0.0).ok()?;
                Some(Said { touches, distance, depth: contact.map(|contact| -f64::from(contact.dist)) })
            }
        }
    };
}

engine!(single, parry3d, f32);
engine!(double, parry3d_f64, f64);
