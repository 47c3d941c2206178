//! A pair as a test to paste.

use std::fmt::Write;

use collision::{DQuat, DVec3, accuracy::Accuracy, narrow::Ray};

use super::{pairs::Question, rays::RayQuestion, whole::PlacedWhole};
use crate::oracle::{Core, Solid, Truth};

/// Rust source of a test that asks all three questions and holds the answers against the truth. Numbers are the
/// shortest that give the same bits back.
pub(super) fn test_source(name: &str, question: &Question, truth: &Truth, faults: &[String]) -> String {
    let mut out = String::new();
    let accuracy = &question.accuracy;
    for fault in faults {
        let _ = writeln!(out, "// {fault}");
    }
    let _ = writeln!(out, "// {} {}", question.category, accuracy_text(question));
    let _ = writeln!(out, "#[test]\nfn {name}() {{");
    let _ = writeln!(out, "    let (a, b) = ({}, {});", form(&question.a.solid), form(&question.b.solid));
    let _ = writeln!(
        out,
        "    let a = Placed {{ geometry: &a.unwrap(), pose: {} }};",
        pose(question.a.position, question.a.rotation)
    );
    let _ = writeln!(
        out,
        "    let b = Placed {{ geometry: &b.unwrap(), pose: {} }};",
        pose(question.b.position, question.b.rotation)
    );
    let _ = writeln!(
        out,
        "    let accuracy = Accuracy {{ max_error: {:?}, ..Accuracy::of(Tier::{:?}) }};",
        accuracy.max_error, accuracy.tier
    );
    let _ = writeln!(out, "    let truth: f64 = {:?};", truth.nearest());
    let _ = writeln!(out, "    let overlap = narrow::overlap(a, b, &accuracy, &mut Work::default());");
    let _ = writeln!(out, "    assert!(overlap.bound.contains(truth), \"{{overlap:?}}\");");
    let limit = if question.limit == f64::INFINITY { "f64::INFINITY".into() } else { format!("{:?}", question.limit) };
    let _ = writeln!(out, "    let apart = narrow::distance(a, b, {limit}, &accuracy, &mut Work::default());");
    let _ = writeln!(
        out,
        "    assert!(apart.is_none_or(|apart| apart.certificate.bound.contains(truth.max(0.0))), \"{{apart:?}}\");"
    );
    let _ = writeln!(
        out,
        "    let contacts = narrow::penetration(a, b, {:?}, &accuracy, &mut Work::default()).unwrap();",
        question.max_gap
    );
    let _ = writeln!(
        out,
        "    assert!(contacts.iter().all(|contact| contact.certificate.bound.contains(-truth)), \"{{contacts:?}}\");\n}}"
    );
    out
}

/// The same for a ray: it prints what is answered, beside the truth in the comment.
pub(super) fn ray_test_source(name: &str, question: &RayQuestion, faults: &[String]) -> String {
    let mut out = String::new();
    for fault in faults {
        let _ = writeln!(out, "// {fault}");
    }
    let _ = writeln!(out, "// {}", question.category);
    let _ = writeln!(out, "#[test]\nfn {name}() {{");
    let _ = writeln!(out, "    let target = {};", form(&question.target.solid));
    let _ = writeln!(
        out,
        "    let target = Placed {{ geometry: &target.unwrap(), pose: {} }};",
        pose(question.target.position, question.target.rotation)
    );
    out.push_str(&ray(&question.ray));
    let _ = writeln!(
        out,
        "    panic!(\"{{:?}}\", raycast(&ray, target, &Accuracy::of(Tier::Exact), &mut Work::default()));\n}}"
    );
    out
}

fn accuracy_text(question: &Question) -> String {
    format!("limit {:e}, max_gap {:e}", question.limit, question.max_gap)
}

/// A number that may be infinite.
pub(super) fn number(value: f64) -> String {
    if value == f64::INFINITY { "f64::INFINITY".into() } else { format!("{value:?}") }
}

/// Lines that place two forms as `a` and `b`.
pub(super) fn sides(a: &PlacedWhole, b: &PlacedWhole) -> String {
    let mut out = format!("    let (a, b) = ({}, {});\n", a.whole.source(), b.whole.source());
    for (name, side) in [("a", a), ("b", b)] {
        let pose = pose(side.position, side.rotation);
        let _ = writeln!(out, "    let {name} = Placed {{ geometry: &{name}, pose: {pose} }};");
    }
    out
}

/// A line that makes a ray.
pub(super) fn ray(ray: &Ray) -> String {
    format!(
        "    let ray = Ray {{ origin: {}, direction: {}, min_distance: {:?}, max_distance: {:?}, hollow: {}, faces: Faces::{:?} }};\n",
        vector(ray.origin),
        vector(ray.direction),
        ray.min_distance,
        ray.max_distance,
        ray.hollow,
        ray.faces
    )
}

/// A line that says how exact.
pub(super) fn accuracy(accuracy: &Accuracy) -> String {
    let (tier, max_error) = (accuracy.tier, accuracy.max_error);
    format!("    let accuracy = Accuracy {{ max_error: {max_error:?}, ..Accuracy::of(Tier::{tier:?}) }};\n")
}

pub(super) fn vector(v: DVec3) -> String {
    format!("DVec3::new({:?}, {:?}, {:?})", v.x, v.y, v.z)
}

pub(super) fn form(solid: &Solid) -> String {
    let core = match &solid.core {
        Core::Point if solid.radius == 0.0 => return "Ok(Geometry::point())".into(),
        Core::Point => return format!("Geometry::sphere({:?})", solid.radius),
        Core::Segment { half_height } => return format!("Geometry::capsule({half_height:?}, {:?})", solid.radius),
        Core::Cuboid { half_extents } => format!("Geometry::cuboid({})", vector(*half_extents)),
        Core::Hull(points) => {
            let points: Vec<String> = points.iter().map(|&point| vector(point)).collect();
            format!("Geometry::hull(&[{}])", points.join(", "))
        }
        Core::Cylinder { half_height, radius } => format!("Geometry::cylinder({half_height:?}, {radius:?})"),
        Core::Cone { half_height, radius } => format!("Geometry::cone({half_height:?}, {radius:?})"),
        Core::HalfSpace { normal, offset } => format!("Geometry::half_space({}, {offset:?})", vector(*normal)),
        Core::Ellipsoid { radii } => format!("Geometry::ellipsoid({})", vector(*radii)),
    };
    if solid.radius == 0.0 { core } else { format!("{core}.unwrap().rounded({:?})", solid.radius) }
}

pub(super) fn pose(position: DVec3, rotation: DQuat) -> String {
    let DQuat { x, y, z, w } = rotation;
    format!("Pose::new({}, DQuat::from_xyzw({x:?}, {y:?}, {z:?}, {w:?}))", vector(position))
}
