//! What a stand-in says of how far off it is, is so.

use collision::{
    DVec3,
    accuracy::{Accuracy, Tier},
    answer::{Representation, Work},
    math::Pose,
    narrow::{self, Placed},
    shape::{Core, Form, Geometry, StandIn},
};

use crate::forms::{Noise, form};

const RUNGS: [Representation; 3] = [Representation::Ball, Representation::OrientedBox, Representation::SimplifiedHull];

/// The stand-in as a geometry of its own.
fn as_geometry(stand_in: &StandIn) -> Geometry {
    let convex = stand_in.convex(0.0);
    let form = match &convex.core {
        Core::Cuboid { half_extents } => Geometry::cuboid(*half_extents),
        Core::Hull(hull) => Geometry::hull(hull.vertices()),
        _ => Geometry::sphere(convex.radius),
    };
    form.expect("a form")
}

/// A point of its surface.
fn on_surface(stand_in: &StandIn, noise: &mut Noise) -> DVec3 {
    let convex = stand_in.convex(0.0);
    let local = match &convex.core {
        Core::Cuboid { half_extents } => {
            let mut inside = noise.vector();
            inside[(noise.between(0.0, 3.0)) as usize] = if noise.between(0.0, 1.0) < 0.5 { -1.0 } else { 1.0 };
            inside * *half_extents
        }
        Core::Hull(hull) => {
            let faces = &hull.topology().faces;
            let face = &faces[noise.between(0.0, faces.len() as f64) as usize];
            let weights: Vec<f64> = face.vertices.iter().map(|_| noise.between(0.0, 1.0)).collect();
            let sum: f64 = weights.iter().sum();
            face.vertices.iter().zip(weights).map(|(&at, weight)| hull.vertices()[at as usize] * (weight / sum)).sum()
        }
        _ => noise.unit() * convex.radius,
    };
    stand_in.center() + local
}

fn apart(a: &Geometry, at: DVec3, b: &Geometry, there: DVec3) -> f64 {
    let [a, b] = [(a, at), (b, there)].map(|(geometry, at)| Placed { geometry, pose: Pose::at(at) });
    let found = narrow::distance(a, b, f64::INFINITY, &Accuracy::of(Tier::Exact), &mut Work::default());
    found.expect("within any distance").certificate.bound.lower
}

#[test]
fn no_point_is_farther_off_than_is_said() {
    let mut noise = Noise(11);
    let point = Geometry::point();
    let mut checked = [0; 3];
    for number in 0..60 {
        let scale = [1.0, 1e-3, 1e4][number % 3];
        let geometry = form(&mut noise, number % 6, scale);
        let (vertices, radius) = match geometry.form() {
            Form::Mesh(mesh) => (mesh.vertices().to_vec(), 0.0),
            Form::Convex(convex) => match &convex.core {
                Core::Hull(hull) => (hull.vertices().to_vec(), convex.radius),
                _ => unreachable!("forms of these kinds are hulls, meshes and compounds"),
            },
            _ => (Vec::new(), 0.0),
        };
        for (at, rung) in RUNGS.into_iter().enumerate() {
            let Some(stand_in) = geometry.stand_in(rung) else { continue };
            let around = as_geometry(stand_in);
            for &vertex in &vertices {
                let off = apart(&point, vertex, &around, stand_in.center());
                assert!(off <= stand_in.outside(), "{rung:?} of {number}: {off} > {}", stand_in.outside());
            }
            // Of a rounded form the core is measured, and the form reaches farther.
            let sharp = vertices.is_empty() || radius == 0.0;
            for _ in 0..200 {
                let place = on_surface(stand_in, &mut noise);
                let off = apart(&point, place, &geometry, DVec3::ZERO);
                // Such a point lies on the surface to within roundings.
                let allowed = stand_in.inside() + 1e-12 * scale;
                assert!(!sharp || off <= allowed, "{rung:?} of {number}: {off} > {}", stand_in.inside());
            }
            checked[at] += 1;
        }
    }
    assert!(checked[0] == 60 && checked[2] >= 50, "vacuous: {checked:?}");
}

#[test]
fn a_finer_rung_is_nearer() {
    let mut noise = Noise(12);
    for number in 0..40 {
        let geometry = form(&mut noise, number % 5, 1.0);
        let off = |rung| {
            let stand_in = geometry.stand_in(rung).expect("such forms have all rungs");
            (stand_in.outside() + stand_in.inside(), stand_in.vertex_count())
        };
        let [ball, oriented_box, hull] = RUNGS.map(off);
        assert!(ball.0 >= oriented_box.0 && ball.1 <= oriented_box.1, "{number}: {ball:?} {oriented_box:?}");
        assert!(hull.1 <= 32 && hull.0 < geometry.reach(), "{number}: {hull:?}");
    }
}
